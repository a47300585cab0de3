// A walking robot's numbers that a fit may change, and the list of them with their prior standard deviations.
//
// Ranges are those of document 000, Tables I and II; a prior's standard deviation is the range over the root of three (a uniform
// distribution's). Laws that the tables lack have sizes of their own (machine.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::biped {

using dynamics::biped::kJoints;
using dynamics::biped::kLegJoints;

/// The robot with its drives, sensors and ground.
struct Machine {
  dynamics::biped::Description robot;
  std::array<std::array<dynamics::tree::Vec3<double>, kLegJoints>, 2>
      turns_rad{};  ///< of joints' frames against their parents, about x, y, z
  std::array<double, kJoints> encoder_offset_rad{};  ///< measured less true
  std::array<double, kJoints> torque_nm{};           ///< constant, on the joint
  std::array<double, kJoints> compliance_radpnm{};   ///< of the gear; the encoder is on the motor
  std::array<double, kJoints> backlash_rad{};        ///< of the gear, its whole width
  double delay_s = 0.0;                              ///< of all drives' commands
  dynamics::tree::Vec3<double> imu_turn_rad{};       ///< of the IMU against the pelvis
  dynamics::tree::Vec3<double> gyro_bias_radps{};
};

/// Where it acts and what it is; `kind` names a law, or a parameter of the model.
struct Unknown {
  std::string kind;  ///< "mass", "coulomb_friction", ...
  /// Of a joint, link, foot, "imu", "ground", "drives"; "simulator": what the simulation has and no robot, its ground's springs and its
  /// friction's ramp. Values of these are logarithms.
  std::string location;
  std::string unit;
  double prior_sd;  ///< of its deviation from the model, in `unit`
  double (*get)(const Machine&, std::size_t place, std::size_t part);
  void (*set)(Machine&, std::size_t place, std::size_t part, double value);
  std::size_t place, part;
  bool of_tables =
      true;  ///< of document 000, Tables I and II, and the simulation's own; else a law beyond them

  std::string name() const { return kind + "@" + location; }
  double value(const Machine& m) const { return get(m, place, part); }
  void add(Machine& m, double change) const { set(m, place, part, value(m) + change); }
};

/// The numbers of the tables that move a robot (a foot switch's threshold does not), and those beyond them. Of the hips' pitch the drives' numbers
/// where some recording has them on their drives, the springs' where some has them on their springs.
std::vector<Unknown> unknowns(const dynamics::biped::Description& robot, bool driven_hips, bool sprung_hips);

/// Brings what cannot exist back to where it can: a mass at least a fifth of the model's, the inertia of some body, friction not below 0,
/// gains and rotors at least a fifth of the model's, the ramp of dry friction no steeper than steps of 1 ms can follow. @returns whether anything was changed
bool make_possible(const Machine& model, Machine& machine);

/// "left_knee", "pelvis"
std::string link_name(std::size_t link);

}  // namespace furcula::biped
