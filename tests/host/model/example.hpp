// A model file for the tests: the hopper of document 002's example, one parameter free, one effect.
#pragma once

#include <string>

namespace furcula::test {

inline const std::string kHopperModel = R"([model]
kind = "hopper_linear"
schema = 1

[parameters]
mass_kg = 1.554
stiffness_npm = 605
rest_height_m = 0.282
damping_stance_nspm = 5.0
damping_flight_nspm = 1.0
restitution_touchdown = 0.95
restitution_liftoff = 0.98
link_length_m = 0.15
touchdown_angle_rad = 0.349
gravity_mps2 = 9.81

[free]
mass_kg = [1.2, 2.0]

[effect.coulomb_friction]
force_n = 1.6
)";

inline const std::string kJointModel = R"([model]
kind = "rotary_joint"
schema = 1
[parameters]
inertia_kgm2 = 0.15
gravity_torque_nm = 2.6
damping_nmspr = 0.1
)";

/// The text with the first `from` replaced by `to`.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace furcula::test
