// What a hop costs, and where the energy goes: from the plant's own accounts.
#pragma once

#include <optional>

#include "boards/sim_host/board.hpp"
#include "furcula/control/controller.hpp"

namespace furcula::energy {

/// The leg's motor, direct drive: a T-Motor U10 of 80 rpm/V (002 chapter 4) has 60 / (2 pi 80) N m/A; its
/// resistance is chosen.
struct Motor {
  double torque_constant_nmpa = 0.1194;
  double resistance_ohm = 0.2;
};

/// Mean over whole strides, J a hop unless it says otherwise. What motor and coil give is what is lost.
struct HopEnergy {
  double motor_work = 0.0;    ///< mechanical, net
  double motor_pushed = 0.0;  ///< mechanical, what it gave; the rest, what it took back, is not fed back
  double motor_copper = 0.0;  ///< resistance times the current's square
  double coil = 0.0;          ///< taken from the supply
  double guide_damping = 0.0, leg_damping = 0.0, touchdown = 0.0, stop = 0.0, liftoff = 0.0;
  double clutch_friction = 0.0;  ///< of cable, key and tips, with their damping
  double clutch_impacts = 0.0;
  double coil_heat = 0.0;  ///< copper and flyback

  double apex_m = 0.0;
  double peak_torque_flight_nm = 0.0, peak_torque_stance_nm = 0.0;  ///< of what is commanded there
  double fold_m = 0.0;         ///< by which the leg was shorter at most in flight
  double compression_m = 0.0;  ///< the same in stance, of the deepest
  double flight_s = 0.0;
  int hops = 0;
  bool fell = false;  ///< no hops, or a fault

  /// From the supply, nothing fed back.
  double electrical() const { return motor_pushed + motor_copper + coil; }
};

/// A rig and its controller.
struct Robot {
  sim_host::RigConfig rig;
  control::Config config;
};

/// Of hops that have settled: the mean of `count` after `settle` hops. @throws core::DataError where the plant
/// keeps no account: it must be a hopper_nonlinear, without effects of mechanism or contact.
HopEnergy energy_per_hop(Robot robot, const Motor& motor, int settle = 25, int count = 15);

/// The same with the torque's amplitude that reaches `apex_m` (to 0.1 mm, or 0.5 mm where the hops do not
/// settle to that); absent if none up to 20 N m does.
struct Settled {
  double amplitude_nm = 0.0;
  HopEnergy energy;
};
std::optional<Settled> energy_at_apex(Robot robot, const Motor& motor, double apex_m);

}  // namespace furcula::energy
