// What must hold in a scenario, whatever test level it runs in: physical limits, read from its section [expect] and
// asked of its log.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/control/fault.hpp"
#include "host/log/log.hpp"

namespace furcula::sim {

/// What is absent is not asked.
struct Expectation {
  /// Every apex in the last third of the run, m; there must be one.
  std::optional<double> apex_least_m, apex_most_m;
  control::Fault fault = control::Fault::none;  ///< the only one that the controller finds
  /// From so long after the start of the first planted fault on the drive commands no torque (none above
  /// kNoTorqueNm), s.
  std::optional<double> torque_zero_after_s;
  /// The same of the solenoid, which must have been on until then, s.
  std::optional<double> coil_off_after_s;
  std::optional<double> releases_least;  ///< times that the solenoid was switched on
  /// Share of the touch-downs at which the clutch's cable was home (less than half a tooth from it).
  std::optional<double> caught_share_least;
};

/// Twice the half step of 4.4 mN m by which a zero is off in the packing of an AK80-9 (docs/board_link.md).
inline constexpr double kNoTorqueNm = 0.01;

/// The section of a scenario file; without one nothing but that no fault is found. @throws core::DataError.
Expectation parse_expectation(std::string_view text, const std::string& name);
Expectation read_expectation(const std::string& path);

/// What does not hold, a sentence each. `log` is one of a hopper (sim::simulate(), or a rig's);
/// `first_fault_s` when the first fault was planted, absent without one; `tooth_pitch_m` of the clutch.
std::vector<std::string> violations(const Expectation& expected, const log::Log& log,
                                    std::optional<double> first_fault_s, double tooth_pitch_m);

}  // namespace furcula::sim
