// A leg with its motors, as gaits are sought for it.
#pragma once

#include <string>
#include <vector>

#include "furcula/dynamics/planar_leg.hpp"

namespace furcula::gait {

using dynamics::Joints2;
using dynamics::LegLiftOff;
using dynamics::LegSpring;
using dynamics::Vec2;

/// One kind of motor at both joints, each behind its gear (001 eq. 8).
struct Motors {
  double hip_gear = 1.0, knee_gear = 1.0;
  double torque_constant_nmpa = 0.0, resistance_ohm = 0.0;
  double supply_v = 0.0, current_a = 0.0;  ///< limits to report on; 0: none

  /// Heat per squared torque of the joint, W / (N m)^2: R / (n K_t)^2.
  Joints2<double> heat() const {
    const auto of = [this](double gear) {
      return resistance_ohm / (gear * torque_constant_nmpa * gear * torque_constant_nmpa);
    };
    return {of(hip_gear), of(knee_gear)};
  }
};

/// How a switched spring catches. The ideal one of 001 catches at touch-down, at any angle.
struct Catching {
  double delay_s = 0.0;  ///< after touch-down
  /// By which the knee flexes further until the clutch's next tooth holds: from nothing to a tooth's pitch.
  double lost_rad = 0.0;

  bool ideal() const { return delay_s == 0.0 && lost_rad == 0.0; }
};

/// A parameter of which an interval alone is known, and its value a guess inside.
struct OpenParameter {
  std::string name;  ///< as in the model file
  double low = 0.0, high = 0.0;
};

struct Machine {
  std::string file;  ///< for messages
  dynamics::PlanarLegParameters<double> leg;
  LegSpring spring = LegSpring::switched;
  Catching catching;
  Motors motors;
  Joints2<double> least{-1.2217304763960306, 0.0};               ///< of the joints' angles, rad
  Joints2<double> most{1.2217304763960306, 2.4434609527920612};  ///< 70 and 140 degrees
  std::vector<OpenParameter> open;
};

/// Table I of document 001, with the digits that the scan lost (docs/gaits.md).
Machine spear(LegSpring spring);

/// Mechanical power that a motor gives and its heat, W (001 eq. 9): positive from the supply.
template <class T>
T electric_power(double heat, const T& torque, const T& rate) {
  return torque * (heat * torque + rate);
}

}  // namespace furcula::gait
