// The kinds of machine that can be simulated, and their parameters: each name, unit and bound stands here
// once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace furcula::dynamics {

enum class Kind : std::uint8_t {
  hopper_linear,
  hopper_nonlinear,
  motor_axis,
  rotary_joint,
  rail_carriage,
  clutch_bench
};

inline constexpr std::size_t kKindCount = 6;

/// One parameter of a kind. `lower` and `upper` are the values that make physical sense at all; a file
/// outside of them is refused. They are not the bounds of a fit: those stand in the model's [free] table.
struct ParameterInfo {
  std::string_view name;  ///< carries the unit, as in the model file
  std::string_view unit;
  double lower;
  double upper;
  std::string_view meaning;
};

// In the order of the members of HopperLinearParameters.
inline constexpr std::array<ParameterInfo, 10> kHopperLinearParameters{{
    {"mass_kg", "kg", 1e-3, 1e3, "mass of body and leg"},
    {"stiffness_npm", "N/m", 0.0, 1e6, "virtual spring between hip and toe"},
    {"rest_height_m", "m", 1e-3, 10.0, "height at which the spring is relaxed"},
    {"damping_stance_nspm", "N s/m", 0.0, 1e4, "viscous damping in stance, guide and leg together"},
    {"damping_flight_nspm", "N s/m", 0.0, 1e4, "viscous damping of the guide, in both phases"},
    {"restitution_touchdown", "", 0.0, 1.5, "velocity after touch-down over velocity before"},
    {"restitution_liftoff", "", 0.0, 1.5, "velocity after lift-off over velocity before"},
    {"link_length_m", "m", 1e-3, 5.0, "length of each of the four links"},
    {"touchdown_angle_rad", "rad", 0.0, 1.5, "leg angle from the vertical on the leg's stop"},
    {"gravity_mps2", "m/s^2", 0.0, 30.0, "gravity"},
}};

// In the order of the members of HopperNonlinearParameters: those of the linear hopper, then the links'.
inline constexpr std::array<ParameterInfo, 13> kHopperNonlinearParameters{{
    kHopperLinearParameters[0],
    kHopperLinearParameters[1],
    kHopperLinearParameters[2],
    kHopperLinearParameters[3],
    kHopperLinearParameters[4],
    {"restitution_touchdown", "", 0.0, 1.5, "speeds after touch-down over what the plastic impact leaves"},
    {"restitution_liftoff", "", 0.0, 1.5, "speeds after lift-off over what the leg's stop leaves"},
    kHopperLinearParameters[7],
    kHopperLinearParameters[8],
    kHopperLinearParameters[9],
    {"inertia_a_kgm2", "kg m^2", 0.0, 10.0, "links: sum I + m_L (r_L^2 + L^2) + m_U r_U^2"},
    {"inertia_b_kgm", "kg m", 0.0, 10.0, "links: sum m_L r_L"},
    {"inertia_e_kgm", "kg m", 0.0, 10.0, "links: sum m_L (r_L + L) + m_U r_U"},
}};

// Of a hopper that has a clutch; without one they are all 0, or not there.
inline constexpr std::array<ParameterInfo, 4> kClutchParameters{{
    {"release_delay_s", "s", 0.0, 1.0, "from the coil's switching on until the belt is free"},
    {"catch_delay_s", "s", 0.0, 1.0, "from its switching off until the belt is held"},
    {"auxiliary_stiffness_npm", "N/m", 0.0, 1e4, "auxiliary spring, as seen along the leg"},
    {"tooth_pitch_m", "m", 0.0, 0.1, "of the belt, as seen along the leg; 0: no clutch"},
}};

// In the order of the members of MotorAxisParameters.
inline constexpr std::array<ParameterInfo, 2> kMotorAxisParameters{{
    {"mass_kg", "kg", 1e-6, 1e6, "moving mass, the motor's inertia included"},
    {"damping_nspm", "N s/m", 0.0, 1e6, "viscous friction"},
}};

// In the order of the members of RotaryJointParameters.
inline constexpr std::array<ParameterInfo, 3> kRotaryJointParameters{{
    {"inertia_kgm2", "kg m^2", 1e-9, 1e4, "inertia about the joint, the rotor's included"},
    {"gravity_torque_nm", "N m", -1e4, 1e4,
     "m g l: torque = gravity_torque sin(angle), angle 0 hanging down"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e4, "viscous friction"},
}};

// In the order of the members of RailCarriageParameters.
inline constexpr std::array<ParameterInfo, 3> kRailCarriageParameters{{
    {"mass_kg", "kg", 1e-3, 1e3, "mass of the carriage"},
    {"damping_nspm", "N s/m", 0.0, 1e4, "viscous friction of the rail"},
    {"gravity_mps2", "m/s^2", 0.0, 30.0, "gravity"},
}};

/// Of the release/catch bench, whose model has no other, m/s^2.
inline constexpr double kBenchGravity_mps2 = 9.81;

// In the order of the members of ClutchBenchParameters.
inline constexpr std::array<ParameterInfo, 9> kClutchBenchParameters{{
    {"load_mass_kg", "kg", 1e-3, 1e3, "weight that hangs on the belt"},
    {"pulley_radius_m", "m", 1e-4, 1.0, "of the belt on the pulley"},
    {"pulley_inertia_kgm2", "kg m^2", 0.0, 10.0, "of pulley and encoder"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e3, "viscous friction, about the pulley"},
    {"auxiliary_stiffness_npm", "N/m", 0.0, 1e4, "auxiliary spring on the belt, slack at the angle 0"},
    {"tooth_pitch_m", "m", 1e-4, 0.1, "of the belt"},
    {"tooth_height_m", "m", 0.0, 0.1, "way of the key; its times are in the delays"},
    {"release_delay_s", "s", 0.0, 1.0, "from the coil's switching on until the belt is free"},
    {"catch_delay_s", "s", 0.0, 1.0, "from its switching off until the key presses on the belt"},
}};

struct KindInfo {
  Kind kind;
  std::string_view name;  ///< in the model file
  std::string_view rig;   ///< in the log
  std::span<const ParameterInfo> parameters;
  bool rotary;
};

inline constexpr std::array<KindInfo, kKindCount> kKinds{{
    {Kind::hopper_linear, "hopper_linear", "hopper", kHopperLinearParameters, false},
    {Kind::hopper_nonlinear, "hopper_nonlinear", "hopper", kHopperNonlinearParameters, false},
    {Kind::motor_axis, "motor_axis", "motor_axis", kMotorAxisParameters, false},
    {Kind::rotary_joint, "rotary_joint", "rotary_joint", kRotaryJointParameters, true},
    {Kind::rail_carriage, "rail_carriage", "rail_carriage", kRailCarriageParameters, false},
    {Kind::clutch_bench, "clutch_bench", "clutch_bench", kClutchBenchParameters, true},
}};

constexpr const KindInfo& info(Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

constexpr std::optional<Kind> kind_named(std::string_view name) {
  for (const KindInfo& k : kKinds)
    if (k.name == name) return k.kind;
  return std::nullopt;
}

/// A body on a leg, with stances and flights.
constexpr bool is_hopper(Kind kind) { return kind == Kind::hopper_linear || kind == Kind::hopper_nonlinear; }

/// Whether the parameters of a clutch can stand in a model of this kind: in its table, or beside it
/// (kClutchParameters).
constexpr bool can_have_clutch(Kind kind) { return is_hopper(kind) || kind == Kind::clutch_bench; }

/// Index of a parameter in the kind's table.
constexpr std::optional<std::size_t> parameter_index(Kind kind, std::string_view name) {
  const auto table = info(kind).parameters;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].name == name) return i;
  return std::nullopt;
}

}  // namespace furcula::dynamics
