// The faults that bring the controller to its safe state: each number, name, meaning and remedy stands here
// once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace furcula::control {

/// Numbers are stable: logs and telemetry carry them. The order is also the order of the checks: of several
/// faults on one tick the first is reported.
enum class Fault : std::uint8_t {
  none = 0,
  bad_configuration = 1,
  late_tick = 2,
  peer_lost = 3,
  stale_input = 4,
  non_finite_input = 5,
  height_out_of_range = 6,
  leg_angle_out_of_range = 7,
  encoder_implausible = 8,
  contact_implausible = 9,
  cable_implausible = 10,
  clutch_not_caught = 11,
};

struct FaultInfo {
  Fault fault;
  std::string_view name;
  std::string_view meaning;
  std::string_view remedy;  ///< what a person should do
};

inline constexpr std::size_t kFaultCount = 12;
inline constexpr std::array<FaultInfo, kFaultCount> kFaults{{
    {Fault::none, "none", "No fault.", "Nothing."},
    {Fault::bad_configuration, "bad_configuration",
     "A value of the controller's configuration makes no sense.",
     "Correct the configuration and start again: a reset does not clear this fault."},
    {Fault::late_tick, "late_tick", "The control loop ran later than allowed after its last run.",
     "Look for another load on the processor or for a debugger that stopped it; then reset."},
    {Fault::peer_lost, "peer_lost", "The device with the sensors, or the drive, did not answer.",
     "Check its supply, its cable and the terminating resistors of the bus; then reset."},
    {Fault::stale_input, "stale_input",
     "The sensors' sample is older than allowed: the device answers, but measures no more.",
     "Restart the device that reads the sensors; look at its load; then reset."},
    {Fault::non_finite_input, "non_finite_input",
     "A measured value is not a number, or the height is not homed.",
     "Home the height encoder; look at the drive's angle; then reset."},
    {Fault::height_out_of_range, "height_out_of_range", "The height is not on the rail.",
     "Home the height encoder again: its counter or its reference has slipped; then reset."},
    {Fault::leg_angle_out_of_range, "leg_angle_out_of_range", "The leg angle is beyond the leg's stops.",
     "Check the motor's angle reference and the stops; then reset."},
    {Fault::encoder_implausible, "encoder_implausible", "Height encoder and leg angle contradict each other.",
     "Check that rack and pinion turn the height encoder and that its cable is whole; then reset."},
    {Fault::contact_implausible, "contact_implausible",
     "The contact switch reads closed high above the ground, or open while the leg is compressed.",
     "Check the switch under the toe and its cable: it sticks, or a wire is broken; then reset."},
    {Fault::cable_implausible, "cable_implausible", "The clutch's cable is where it cannot be.",
     "Home the cable's encoder again: its counter has slipped, or the cable is torn; then reset."},
    {Fault::clutch_not_caught, "clutch_not_caught",
     "Several stances running stood on a spring that was not caught.",
     "Look at the clutch's key and its return spring, and at the coil's supply: it may be on all the time; "
     "then "
     "reset."},
}};

constexpr const FaultInfo& info(Fault fault) { return kFaults[static_cast<std::size_t>(fault)]; }

static_assert(
    [] {
      for (std::size_t i = 0; i < kFaultCount; ++i)
        if (static_cast<std::size_t>(kFaults[i].fault) != i) return false;
      return true;
    }(),
    "the faults stand in the order of their numbers");

}  // namespace furcula::control
