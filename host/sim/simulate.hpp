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
/// - hopper: time_s, height_m, velocity_mps, leg_angle_rad, contact, torque_cmd_nm, torque_nm, solenoid,
///   clutch_travel_m where there is a clutch, and fault (the controller's fault number,
///   furcula/control/fault.hpp). The velocity is, with quantisation or noise, the controller's estimate
///   (differences of counts over 5 ms, so that of 2.5 ms ago), else the plant's. torque_nm is the drive's
///   echo of the command. Rows whose height is not a number are left out.
/// - motor_axis: time_s, position_m, force_n. rotary_joint: time_s, angle_rad, torque_nm.
/// - rail_carriage: time_s, height_m, contact. Its stop is at height 0; a carriage that falls onto it lies
///   there to the end.
/// - clutch_bench: time_s, pulley_angle_rad, solenoid.
///
/// The same arguments give the same log.
log::Log simulate(const model::Model& model, const Scenario& scenario, std::uint64_t seed);

/// The modular clutch of 002 section 5.2 (dynamics/clutch_designs.hpp) with the tooth pitch and the auxiliary
/// spring of the model, which has a clutch. The model's delays are what the controller starts from; what
/// the clutch takes follows from its coil and key.
dynamics::ClutchParameters<double> clutch_of(const model::Model& model);

/// Of the clutch's encoder, 2400 a turn of 60 mm of cable, as seen along the leg.
inline constexpr double kCableCountM = 0.06 / 2400.0 / 0.7;

/// The body and leg of a hopper model.
sim_host::Plant plant_of(const model::Model& model, const dynamics::Effects<double>& effects);

/// The rig of a hopper model under a scenario.
sim_host::RigConfig rig_config(const model::Model& model, const Scenario& scenario, std::uint64_t seed);

/// Whether a fault of the scenario is one of a bus: then the drive and the encoders are on one
/// (boards/sim_host/can_board.hpp), and the controller's configuration is adapted to it.
bool needs_bus(const Scenario& scenario);

/// How the controller is configured for it: the leg's geometry, the encoder's count, the torque profile.
control::Config controller_config(const model::Model& model, const Scenario& scenario);

}  // namespace furcula::sim
