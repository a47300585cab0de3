// A robot that is not as its model says: drawn from the ranges of document 000, Tables I and II, with a cause beyond the tables.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::robot {

/// A cause that no parameter of the tables has.
enum class Cause : std::uint8_t {
  none,
  coulomb,         ///< more dry friction in a joint's gear, N m
  viscous,         ///< more damping of it, N m s/rad
  elasticity,      ///< of the gear: its stiffness, N m/rad
  backlash,        ///< of the gear, its whole width, rad
  delay,           ///< of all drives' commands, s
  payload,         ///< on a link, at its centre, kg
  slope,           ///< of the ground about y, positive downhill, rad
  slope_sideways,  ///< about x
  sole,            ///< the left foot's is so much thicker, m
  friction,        ///< of the ground
  encoder,         ///< offset of a joint's, rad
};
inline constexpr std::array<std::string_view, 12> kCauseNames{
    "none",    "coulomb", "viscous",        "elasticity", "backlash", "delay",
    "payload", "slope",   "slope_sideways", "sole",       "friction", "encoder"};

struct Planted {
  Cause cause = Cause::none;
  std::size_t joint =
      0;  ///< left leg's from the hip down, then the right's; of `payload` the joint's link, kJoints the pelvis
  double size = 0.0;
};

/// All that the robot in MuJoCo is made of.
struct Truth {
  dynamics::biped::Description robot;
  /// Turns of the joints' axes against the parents, about x, y, z, rad.
  std::array<std::array<dynamics::tree::Vec3<double>, dynamics::biped::kLegJoints>, 2> turns_rad{};
  std::array<double, dynamics::biped::kJoints> encoder_offset_rad{};
  std::array<double, dynamics::biped::kJoints> kp_change{}, kd_change{};  ///< shares, of the drives' gains
  dynamics::tree::Vec3<double> imu_turn_rad{};
  double foot_threshold_change_n = 0.0;                   ///< the feet's sensors read so much less
  double contact_stiffness = 1.0, contact_damping = 1.0;  ///< times MuJoCo's
  std::array<double, dynamics::biped::kJoints> elasticity_nmprad{}, backlash_rad{};  ///< 0: a stiff gear
  double delay_s = 0.0;
};

/// As the description says.
Truth as_described(const dynamics::biped::Description& robot);

/// Every number of the tables uniformly within `scale` times its range. A mass is at least a fifth of the nominal one, and an inertia that of some body.
Truth drawn(const dynamics::biped::Description& robot, double scale, std::uint64_t seed);

void plant(const Planted& planted, Truth& truth);

/// A size and a place: Coulomb 4 to 6 N m, viscous 6, gear elasticity 1e4 N m/rad, backlash 4 mrad, delay 5 to 15 ms, payload 3 kg on the pelvis or 1.5 kg on a
/// thigh, slope 1 degree, sole 4 mm, friction 0.3, encoder 1 degree.
Planted drawn_cause(Cause cause, std::uint64_t seed);

std::string in_words(const Planted& planted);

}  // namespace furcula::robot
