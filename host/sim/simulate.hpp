// Runs a scenario on a model and writes down what the rig would: the hopper through the very application and
// controller of the board, the axes in open loop.
#pragma once

#include <cstdint>

#include "boards/sim_host/board.hpp"
#include "furcula/control/controller.hpp"
#include "host/log/log.hpp"
#include "host/model/model.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::sim {

/// The log, a row a millisecond. What a row commands acts from its instant until the next row's. Columns:
///
/// - hopper: time_s, height_m, velocity_mps, leg_angle_rad, contact, torque_cmd_nm, torque_nm, solenoid, and
///   fault (the controller's fault number, furcula/control/fault.hpp). The velocity is, with quantisation or
///   noise, the controller's estimate (differences of counts over 5 ms, so that of 2.5 ms ago), else the
///   plant's. torque_nm is the drive's echo of the command. Rows whose height is not a number are left out.
/// - motor_axis: time_s, position_m, force_n. rotary_joint: time_s, angle_rad, torque_nm.
/// - rail_carriage: time_s, height_m, contact. Its stop is at height 0; a carriage that falls onto it lies
///   there to the end.
///
/// The same arguments give the same log.
log::Log simulate(const model::Model& model, const Scenario& scenario, std::uint64_t seed);

/// The rig of a hopper model under a scenario.
sim_host::RigConfig rig_config(const model::Model& model, const Scenario& scenario, std::uint64_t seed);

/// How the controller is configured for it: the leg's geometry, the encoder's count, the torque profile.
control::Config controller_config(const model::Model& model, const Scenario& scenario);

}  // namespace furcula::sim
