// The table of what breaks: what the robot does, and by when it must.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "boards/sim_host/faults.hpp"
#include "furcula/control/fault.hpp"
#include "host/safety/trial.hpp"

namespace furcula::safety {

/// What the simulated rig can break. The fault lasts `duration_s` (of a late tick: by so much it is late).
struct RigRow {
  sim_host::RigFault breaks;
  double duration_s;
  /// Faults that the controller may find, at most three. None: the robot hops on, and no fault is found.
  std::array<control::Fault, 3> finds;
  /// In which the fault must be found after it began, whatever the robot was doing; ticks of 1 ms.
  std::uint32_t found_within_ticks;
  std::string_view reaction;
  /// It need not be found where the hops come down by themselves.
  bool may_come_to_rest = false;

  bool is_borne() const { return finds[0] == control::Fault::none; }
  bool may_find(control::Fault fault) const;
};

/// What the signals do not tell, or not at once: why, and what bounds the harm.
struct UntoldRow {
  std::string_view what, why, bound;
  std::string_view shown_by;  ///< the test's file
};

/// What is not the rig's to break: shown by other tests.
struct OtherRow {
  std::string_view breaks;
  std::string_view reaction;
  std::string_view shown_by;  ///< the test's file
};

std::span<const RigRow> rig_rows();
/// Rows of a robot that stands and was never told to run.
std::span<const RigRow> rest_rows();
std::span<const OtherRow> other_rows();
std::span<const UntoldRow> untold_rows();

/// A row tried out at one moment of the stride.
struct Tried {
  Moment moment;
  std::uint64_t seed;
  Trial trial;
};

/// The row at each moment, `seeds` times each. Rows that need no bus can be tried without one.
std::vector<Tried> try_row(const RigRow& row, Rig rig, unsigned seeds);

/// A row of rest_rows() on a robot at rest, a seed each; `moment` means nothing.
std::vector<Tried> try_at_rest(const RigRow& row, Rig rig, unsigned seeds);

/// What of a row's limits it broke, in words; empty: nothing.
std::string_view broken_limit(const RigRow& row, const Trial& trial);

}  // namespace furcula::safety
