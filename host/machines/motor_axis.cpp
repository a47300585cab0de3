// A linear axis that a motor drives.
#include "boards/sim_host/sensors.hpp"
#include "host/machines/axis.hpp"

namespace furcula::machines {
namespace {

constexpr Rules kRules{
    .channel = "position",
    .columns = {.position = "position_m", .velocity = "velocity_mps", .input = "force_n"},
    .keys = {.position = "position_m",
             .position_unit = "m",
             .position_least = -1e3,
             .position_most = 1e3,
             .velocity = "velocity_mps",
             .velocity_unit = "m/s",
             .velocity_most = 1e3,
             .drive = "force",
             .amplitude = "amplitude_n",
             .amplitude_unit = "N",
             .amplitude_most = 1e6},
    .count = sim_host::kAxisCountM,
    .usual_run = usual_run_of_axis,
    .experiments = experiments_of_axis,
    .keeps_travel = true,
};

}  // namespace
}  // namespace furcula::machines

const furcula::machines::Rules& furcula::dynamics::machines::MotorAxis::rules() {
  return furcula::machines::kRules;
}
