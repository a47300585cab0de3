// The faults that bring the controller to its safe state: each number, name, meaning and remedy stands here
// once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace furcula::control {

/// Reason for the safe state; meanings and remedies: kFaults. Numbers are stable: logs and telemetry carry them. Of
/// several faults on one tick the one that find_fault() (supervisor.hpp) looks for first is reported.
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
  drive_fault = 12,
  drive_silent = 13,
  drive_disobeys = 14,
  bus_off = 15,
  command_lost = 16,
  encoder_jump = 17,
  task_stuck = 18,
  processor_fault = 19,
  parameters_lost = 20,
  bus_unreliable = 21,
  node_id_taken = 22,
  contact_switch_lost = 23,
  drive_hot = 24,
  supply_too_high = 25,
  drive_doubled = 26,
  drive_mismatch = 27,
  leg_astray = 28,
  spring_loose = 29,
  beyond_envelope = 30,
  parameters_implausible = 31,
  falling = 32,
  clutch_not_engaged = 33,
  imu_implausible = 34,
};

/// A row of the table of faults.
struct FaultInfo {
  Fault fault;               ///< its number is the row's index
  std::string_view name;     ///< as in logs and telemetry; the enumerator's
  std::string_view meaning;  ///< what is wrong, one sentence
  std::string_view remedy;   ///< what a person should do
};

inline constexpr std::size_t kFaultCount = 35;  ///< faults, with `none`
/// The table of faults, in the order of their numbers. docs/safety.md is generated from it.
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
     "Look at the clutch's key and its return spring, and at the coil's supply: it may be on all the time; then reset."},
    {Fault::drive_fault, "drive_fault", "The motor's drive reports an error of its own.",
     "Look up the drive's error code; check its supply, its temperature and its encoder; then reset."},
    {Fault::drive_silent, "drive_silent", "The motor's drive does not answer its commands.",
     "Check the drive's supply, its node id and the bus's cable; then reset."},
    {Fault::drive_disobeys, "drive_disobeys",
     "The torque that the drive reports is not the one that it was told.",
     "Switch the drive's supply off; check the motor's type in the configuration, its phases and the drive; "
     "then reset."},
    {Fault::bus_off, "bus_off",
     "The CAN controller went off the bus after too many errors, or its interface was taken down.",
     "Check the bus's cable, its terminating resistors and that all nodes have the same bit rate; then "
     "reset."},
    {Fault::command_lost, "command_lost", "The one who commands the running robot fell silent.",
     "Check the host's program and its cable; then reset."},
    {Fault::encoder_jump, "encoder_jump",
     "The height changed by more than a body can move, or against the way that it must.",
     "Check the height encoder's cable, its shield and the order of its two channels; home it again; then "
     "reset."},
    {Fault::task_stuck, "task_stuck", "The watchdog started the board anew: a task had not come to its end.",
     "Read the fault log; report the build id with it; then reset."},
    {Fault::processor_fault, "processor_fault",
     "The processor stopped the program and the board started anew, as after an overflow of the stack.",
     "Read the fault log; report the build id with it; then reset."},
    {Fault::parameters_lost, "parameters_lost",
     "No slot of the flash, or not the file, holds whole parameters: those built in are in use.",
     "Set the parameters and save them; then reset."},
    {Fault::bus_unreliable, "bus_unreliable",
     "Too many of the bus's frames were lost, unanswered or out of order in a short time.",
     "Look at the bus's load, its cable and its terminating resistors; then reset."},
    {Fault::node_id_taken, "node_id_taken",
     "Another device on the bus sends with this node's id, or commands its drive.",
     "Give each controller an id of its own, or switch the other one off; then reset."},
    {Fault::contact_switch_lost, "contact_switch_lost",
     "The contact switch contradicts both the force on the leg and the height of its toe: the robot has landed without it.",
     "Check the switch under the toe and its cable: it sticks, chatters, or a wire is broken; then reset."},
    {Fault::drive_hot, "drive_hot", "The motor or its drive is too hot, as the drive reports.",
     "Let it cool; look for a leg that is blocked and a torque that is too large; then reset."},
    {Fault::supply_too_high, "supply_too_high", "The voltage of the drive's supply is too high.",
     "Look at the supply: it must take what the motor feeds back, or have a brake resistor; then reset."},
    {Fault::drive_doubled, "drive_doubled", "Two drives answer to the node id of the motor's drive.",
     "Give each drive on the bus a node id of its own; then reset."},
    {Fault::drive_mismatch, "drive_mismatch",
     "The velocity that the drive reports is not that of its position: it is not the configured motor's.",
     "Set the motor's type in the configuration to that of the motor, or fit the right one; then reset."},
    {Fault::leg_astray, "leg_astray", "The leg does not go where the motor moves it in flight.",
     "Check that the motor turns the way that it is configured to, its coupling and the leg; then reset."},
    {Fault::spring_loose, "spring_loose",
     "The robot stands, the coil is to be off, and the spring does not bear.",
     "Measure the coil's output: it may be shorted to its supply; look at the clutch's key; then reset."},
    {Fault::beyond_envelope, "beyond_envelope",
     "The robot is or will be higher than it may, or will land faster, though the torque was held back.",
     "Look at what gives it energy: the drive's torque, a person's hand, the height encoder's scale; then reset."},
    {Fault::parameters_implausible, "parameters_implausible",
     "What is measured contradicts the parameters: a flight does not fall as gravity has it, the leg is longer "
     "than at touch-down, or a stance's spring is not the one of the parameters.",
     "Correct the parameters that describe the robot (height_metres_per_count, link_length_m, touchdown_height_m, "
     "spring_npm, spring_rest_m), or look at the height encoder and the leg angle's reference; then reset."},
    {Fault::falling, "falling", "The walking robot tips over or sinks: its drives only brake.",
     "Look at what pushed it or where it stepped; lift it onto its stand; then reset."},
    {Fault::clutch_not_engaged, "clutch_not_engaged",
     "A joint's pin did not come to its place in time, or left it in a walk.",
     "Look at the pin, its servo and its supply, and at what lies in its hole; then reset."},
    {Fault::imu_implausible, "imu_implausible",
     "The IMU repeats itself, measures what cannot be, or contradicts the joints of the leg that stands.",
     "Check that it is screwed on and which way, its supply and its range; then reset."},
}};

/// The row of a fault, which must be an enumerator.
constexpr const FaultInfo& info(Fault fault) { return kFaults[static_cast<std::size_t>(fault)]; }

static_assert(
    [] {
      for (std::size_t i = 0; i < kFaultCount; ++i)
        if (static_cast<std::size_t>(kFaults[i].fault) != i) return false;
      return true;
    }(),
    "the faults stand in the order of their numbers");

}  // namespace furcula::control
