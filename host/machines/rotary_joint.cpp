// A rotary joint under gravity, with a motor.
#include "boards/sim_host/sensors.hpp"
#include "host/machines/axis.hpp"

namespace furcula::machines {
namespace {

constexpr Rules kRules{
    .channel = "angle",
    .columns = {.position = "angle_rad",
                .velocity = "velocity_radps",
                .input = "torque_nm",
                .command = "torque_cmd_nm"},
    .keys = {.position = "angle_rad",
             .position_unit = "rad",
             .position_least = -1e3,
             .position_most = 1e3,
             .velocity = "velocity_radps",
             .velocity_unit = "rad/s",
             .velocity_most = 1e3,
             .drive = "torque",
             .amplitude = "amplitude_nm",
             .amplitude_unit = "N m",
             .amplitude_most = 1e6},
    .count = sim_host::kJointCountRad,
    .usual_run = usual_run_of_axis,
    .experiments = experiments_of_axis,
};

}  // namespace
}  // namespace furcula::machines

const furcula::machines::Rules& furcula::dynamics::machines::RotaryJoint::rules() {
  return furcula::machines::kRules;
}
