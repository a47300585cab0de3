// What breaks in a planar leg's rig, as what it is found, and by when it must be: the rows of docs/safety.md for a robot that plays a gait.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "boards/sim_host/leg_rig.hpp"
#include "furcula/control/fault.hpp"
#include "host/gait/gait.hpp"

namespace furcula::gait {

struct LegFaultRow {
  sim_host::LegFault breaks;
  std::string_view name, meaning;
  std::span<const control::Fault> finds;  ///< any of these
  std::uint32_t within_ticks;  ///< of 1 ms, from the tick on which it breaks, whatever the leg was doing
};
std::span<const LegFaultRow> leg_fault_rows();

struct LegTrial {
  control::Fault found = control::Fault::none;
  std::uint32_t after_ticks = 0;  ///< that had the fault, before the one on which it was found
  double torque_after_nm = 0.0;   ///< the most that is commanded from then on, in 0.2 s
};
/// The gait on the board's controller, ground within 1 cm, the switch 5 ms late, sensors in counts; something breaks at `at_s`, for good.
LegTrial try_leg_fault(const Gait& gait, sim_host::LegFault breaks, double at_s);

/// Instants at which each is tried: about a stride of the leg that hops in place, in flight and in stance.
inline constexpr double kLegFaultTimes_s[] = {2.00, 2.15, 2.30, 2.45};

/// The section of docs/safety.md: each row tried on the leg of document 001 that hops in place.
std::string leg_fault_section();

}  // namespace furcula::gait
