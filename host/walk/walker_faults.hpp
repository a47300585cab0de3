// What breaks in a walking robot, as what it is found, and by when it must be: the rows of docs/safety.md for the biped.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/control/fault.hpp"
#include "host/walk/walker_rig.hpp"

namespace furcula::walk {

struct WalkerFaultRow {
  WalkerFault breaks;
  std::string_view name, meaning;
  std::span<const control::Fault> finds;  ///< any of these
  std::uint32_t within_ticks;  ///< of 1 ms, from the tick on which it breaks, whatever the robot was doing
  std::span<const std::size_t> joints;  ///< each is tried
  bool from_start = false;              ///< it is broken when the robot is told to walk
};
std::span<const WalkerFaultRow> walker_fault_rows();

/// Instants at which each is tried: about a stride of the test's active walk.
inline constexpr double kWalkerFaultTimes_s[] = {2.30, 2.41, 2.52, 2.63};

struct WalkerTrial {
  control::Fault found = control::Fault::none;
  std::uint32_t suspect = control::kNoJoint;
  std::uint32_t after_ticks = 0;  ///< that had the fault, before the one on which it was found
  // From then on, in 1.5 s: the robot falls.
  double torque_after_nm = 0.0;    ///< the most of a joined motor
  double work_after_j = 0.0;       ///< positive, of the joined motors: a brake does none
  double speed_after_radps = 0.0;  ///< the fastest joint
  double fall_mps = 0.0;           ///< the pelvis, downwards, at the most
};
/// The walk on the board's controller, with sensors that err by `rig.seed`. Without `supervised` nothing is found, and the walk goes on.
WalkerTrial try_walker_fault(const WalkerRigConfig& rig, bool supervised = true);

/// Every trial of a row.
std::vector<WalkerRigConfig> trials_of(const WalkerFaultRow& row, const WalkerRigConfig& rig);

/// The active walk on which docs/safety.md tries them.
Parameters tried_walk();
/// The section of docs/safety.md: each row tried.
std::string walker_fault_section();

}  // namespace furcula::walk
