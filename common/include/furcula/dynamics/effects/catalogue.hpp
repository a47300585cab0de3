// The catalogue of effects: the one table from which `furcula effects`, the model file's checks, the
// diagnosis, the report and docs/effects.md come. The laws themselves stand beside it in effects/laws.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "furcula/dynamics/kinds.hpp"

namespace furcula::dynamics {

/// In the order of the contract's table: where two effects explain the data equally well, the earlier is
/// named.
enum class Effect : std::uint8_t {
  coulomb_friction,
  stribeck_friction,
  asymmetric_friction,
  quadratic_drag,
  force_offset,
  stiffness_error,
  spring_preload,
  torque_gain_error,
  touchdown_loss,
};

inline constexpr std::size_t kEffectCount = 9;
inline constexpr std::size_t kMaxEffectParameters = 3;

/// The stage of the plant that the law sits in.
enum class Stage : std::uint8_t { actuation, mechanism, contact, sensing };

struct EffectParameterInfo {
  std::string_view name;         ///< on a linear axis
  std::string_view rotary_name;  ///< on a rotary axis
  std::string_view unit;
  std::string_view rotary_unit;
  double lower;    ///< smallest value that makes physical sense
  double upper;    ///< largest value that makes physical sense
  double neutral;  ///< value at which the effect is not there; NaN: that of the model parameter of the same
                   ///< name, or any value (a width, a shape) where there is none
};

struct EffectInfo {
  Effect effect;
  std::string_view name;
  std::string_view title;  ///< in plain words, as in "the model lacks ..."
  Stage stage;
  std::uint8_t kinds;      ///< bit per Kind
  std::string_view phase;  ///< on a hopper: "flight+stance", "stance", "touch-down", ...
  std::string_view law;
  std::array<EffectParameterInfo, kMaxEffectParameters> parameter_table;
  std::size_t parameter_count;
  std::string_view explanation;      ///< one plain sentence: what it does to the machine
  std::string_view where_to_look;    ///< on the machine
  std::string_view best_experiment;  ///< that shows it best
  constexpr std::span<const EffectParameterInfo> parameters() const {
    return {parameter_table.data(), parameter_count};
  }
};

namespace detail {
constexpr std::uint8_t bit(Kind k) { return static_cast<std::uint8_t>(1u << static_cast<unsigned>(k)); }
inline constexpr std::uint8_t kAllKinds =
    bit(Kind::hopper_linear) | bit(Kind::motor_axis) | bit(Kind::rotary_joint);
inline constexpr std::uint8_t kHopper = bit(Kind::hopper_linear);
inline constexpr double kUnset = __builtin_nan("");
}  // namespace detail

inline constexpr std::array<EffectInfo, kEffectCount> kCatalogue{{
    {Effect::coulomb_friction,
     "coulomb_friction",
     "dry friction",
     Stage::mechanism,
     detail::kAllKinds,
     "flight+stance",
     "-Fc sgn(v)",
     {{{"force_n", "torque_nm", "N", "N m", 0.0, 1e4, 0.0}}},
     1,
     "Dry friction: a force of constant size against the motion, whatever the speed.",
     "Guides, bearings, seals and belts: look for dirt, preload and dry rails.",
     "Slow strokes in both directions, and a free swing or drop that dies out: the loss a cycle does not "
     "shrink "
     "with the speed."},
    {Effect::stribeck_friction,
     "stribeck_friction",
     "dry friction that rises towards standstill",
     Stage::mechanism,
     detail::kAllKinds,
     "flight+stance",
     "-(Fc + (Fs - Fc) exp(-(v/vs)^2)) sgn(v)",
     {{{"force_n", "torque_nm", "N", "N m", 0.0, 1e4, 0.0},
       {"static_force_n", "static_torque_nm", "N", "N m", 0.0, 1e4, 0.0},
       {"velocity_mps", "velocity_radps", "m/s", "rad/s", 1e-4, 50.0, detail::kUnset}}},
     3,
     "Dry friction that is larger near standstill than in motion.",
     "Plain bearings and greased guides: look at the lubricant and at stick-slip at reversals.",
     "Very slow strokes through several reversals, so that the axis spends time below the Stribeck "
     "velocity."},
    {Effect::asymmetric_friction,
     "asymmetric_friction",
     "dry friction of different size in the two directions",
     Stage::mechanism,
     detail::kAllKinds,
     "flight+stance",
     "-Fc+ for v > 0, +Fc- for v < 0",
     {{{"force_up_n", "torque_up_nm", "N", "N m", -1e4, 1e4, 0.0},
       {"force_down_n", "torque_down_nm", "N", "N m", -1e4, 1e4, 0.0}}},
     2,
     "Dry friction of a different size in the two directions.",
     "Tilted or preloaded guides, cable drag, a drive whose zero is off: look at what pulls one way.",
     "Equal strokes up and down at several constant speeds, and rests in between: at rest an offset still "
     "pushes, "
     "friction does not."},
    {Effect::quadratic_drag,
     "quadratic_drag",
     "drag that grows with the square of the speed",
     Stage::mechanism,
     detail::kAllKinds,
     "flight+stance",
     "-c v |v|",
     {{{"drag_ns2pm2", "drag_nms2prad2", "N s^2/m^2", "N m s^2/rad^2", 0.0, 1e4, 0.0}}},
     1,
     "A resistance that grows with the square of the speed, as of air or oil.",
     "Covers, fans, fluid-filled dampers and bellows.",
     "A few strokes at the highest speed and the same strokes at half of it."},
    {Effect::force_offset,
     "force_offset",
     "a constant force",
     Stage::mechanism,
     detail::kAllKinds,
     "flight+stance",
     "constant force on the axis",
     {{{"force_n", "torque_nm", "N", "N m", -1e4, 1e4, 0.0}}},
     1,
     "A constant force pushes the axis one way.",
     "Cable chains, balance weights, a tilt of the rail, an offset of the drive's current sensor.",
     "Hold the axis at rest at several places and note the force that holding takes."},
    {Effect::stiffness_error,
     "stiffness_error",
     "the spring's true rate",
     Stage::mechanism,
     detail::kHopper,
     "stance",
     "the spring's rate differs from the model's",
     {{{"stiffness_npm", "stiffness_npm", "N/m", "N/m", 1.0, 1e6, detail::kUnset}}},
     1,
     "The spring is stiffer or softer than the model says.",
     "The spring itself, its anchor points and the cam that it wraps.",
     "Slow compression against a force plate or a scale: the slope of force over height is the rate."},
    {Effect::spring_preload,
     "spring_preload",
     "preload of the spring",
     Stage::mechanism,
     detail::kHopper,
     "stance",
     "constant force while the spring is engaged",
     {{{"force_n", "force_n", "N", "N", -1e4, 1e4, 0.0}}},
     1,
     "The spring already pushes at its modelled rest height, or only begins later.",
     "The spring's adjuster, the cable's length and the tooth it is caught on.",
     "Slow compression against a force plate: where the line of force over height crosses zero."},
    {Effect::torque_gain_error,
     "torque_gain_error",
     "the motor's true torque gain",
     Stage::actuation,
     detail::kHopper,
     "stance",
     "delivered = gain x commanded",
     {{{"gain", "gain", "", "", 0.0, 10.0, 1.0}}},
     1,
     "The motor makes more or less torque than commanded, in proportion.",
     "The torque constant in the drive's settings, the gear ratio, the current sensor's scale.",
     "Hops at two torque amplitudes, or the stalled motor against a scale."},
    {Effect::touchdown_loss,
     "touchdown_loss",
     "the loss of speed at touch-down",
     Stage::contact,
     detail::kHopper,
     "touch-down",
     "velocity x alpha_td at touch-down",
     {{{"restitution_touchdown", "restitution_touchdown", "", "", 0.0, 1.5, detail::kUnset}}},
     1,
     "A part of the speed is lost in an instant at touch-down.",
     "The mass of toe and lower links that stops at once, and the pad under the toe.",
     "Drops from several heights without torque: compare the speed before and after touch-down."},
}};

constexpr const EffectInfo& info(Effect e) { return kCatalogue[static_cast<std::size_t>(e)]; }

constexpr bool applies(Effect e, Kind k) { return (info(e).kinds & detail::bit(k)) != 0; }

constexpr std::optional<Effect> effect_named(std::string_view name) {
  for (const EffectInfo& e : kCatalogue)
    if (e.name == name) return e.effect;
  return std::nullopt;
}

/// The parameter's name on an axis of this kind.
constexpr std::string_view name_on(const EffectParameterInfo& p, Kind k) {
  return info(k).rotary ? p.rotary_name : p.name;
}
constexpr std::string_view unit_on(const EffectParameterInfo& p, Kind k) {
  return info(k).rotary ? p.rotary_unit : p.unit;
}

static_assert(
    [] {
      for (std::size_t i = 0; i < kEffectCount; ++i)
        if (static_cast<std::size_t>(kCatalogue[i].effect) != i) return false;
      return true;
    }(),
    "the catalogue stands in the order of the enumeration");

}  // namespace furcula::dynamics
