// The catalogue of effects: the table from which `furcula effects`, the model file's checks, the diagnosis, the report and
// docs/effects.md are generated. Force models are in effects/laws.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>

#include "furcula/dynamics/machines.hpp"

namespace furcula::dynamics {

/// The effects, in the order of the contract's table: where two explain the data equally well, the earlier is named. What
/// each one does: kCatalogue.
enum class Effect : std::uint8_t {
  coulomb_friction,
  stribeck_friction,
  asymmetric_friction,
  quadratic_drag,
  binding_spot,
  damping_error,
  force_offset,
  guide_tilt,
  mass_error,
  stiffness_error,
  rest_height_error,
  spring_preload,
  spring_hardening,
  spring_hysteresis,
  leg_inertia,
  torque_gain_error,
  torque_offset,
  actuator_delay,
  actuator_lag,
  torque_saturation,
  torque_ripple,
  thermal_derating,
  backlash,
  touchdown_loss,
  liftoff_loss,
  ground_compliance,
  toe_sticking,
  encoder_offset,
  height_scale_error,
  height_eccentricity,
  encoder_slip,
  contact_delay,
  time_skew,
  clutch_slip,
  late_catch,
  incomplete_release,
  auxiliary_spring,
  bump_stop,
};

/// Largest number of parameters of an effect.
inline constexpr std::size_t kMaxEffectParameters = 3;

/// The stage of the plant that contains the effect's model.
enum class Stage : std::uint8_t { actuation, mechanism, contact, sensing };

/// For EffectParameterInfo::model_parameter: no parameter of the model.
inline constexpr std::string_view kNotOfModel = "-";

/// One parameter of an effect.
struct EffectParameterInfo {
  std::string_view name;         ///< name on a linear axis
  std::string_view rotary_name;  ///< name on a rotary axis
  std::string_view unit;         ///< unit on a linear axis; empty: none
  std::string_view rotary_unit;  ///< unit on a rotary axis; empty: none
  double lower;                  ///< smallest physically possible value
  double upper;                  ///< largest physically possible value
  double neutral;  ///< value without the effect; NaN: that of the model parameter of the same name, or any
                   ///< value (a width, a shape) where there is none
  bool of_motor = false;  ///< of the motor, which is rotary on a hopper: there it has the rotary name
  /// The model parameter that it replaces, where that has another name; empty: the one of the same name, if any;
  /// kNotOfModel: none, the one of the same name has another meaning.
  std::string_view model_parameter = {};
  /// On a machine with a leg it is added to the model's value, so its neutral value there is zero.
  bool added_on_leg = false;
};

/// The unit of a start value in Search::starts.
enum class Measure : std::uint8_t {
  unit,      ///< the parameter's own unit
  friction,  ///< 5 % of the force that moves the axis (on a hopper, of the weight), N or N m
  speed,     ///< RMS speed
  input,     ///< 99 % quantile of the input's magnitude
  travel,    ///< length of the travel
  model,     ///< the model parameter that it replaces, else the one of the same name
  place,     ///< not a multiple: eight positions along the travel are tried in turn
  depth,     ///< likewise, measured down from the touch-down height of a hopper
  load,      ///< the weight on the belt of a clutch bench, N
};

/// Start values of the fits of an effect, one row for each fit.
struct Starts {
  static constexpr std::size_t kMost = 8;  ///< largest number of rows
  /// [row][parameter], in units of Search::measures.
  std::array<std::array<double, kMaxEffectParameters>, kMost> rows{};
  std::size_t count = 0;  ///< rows used; 0: the only start is the neutral values
  constexpr Starts() = default;
  /// From at most kMost rows; more do not compile in a constant expression.
  constexpr Starts(std::initializer_list<std::array<double, kMaxEffectParameters>> all) {
    for (const auto& row : all) rows[count++] = row;  // more than kMost: no constant expression
  }
};

/// An interval of values.
struct Range {
  double low = 0.0,  ///< lower bound
      high = 0.0;    ///< upper bound
};

/// How a diagnosis searches for an effect, and the effect's sizes in hidden-fault cases. The defaults suffice where the screening
/// score of one linear step from the neutral values finds the effect.
struct Search {
  std::array<Measure, kMaxEffectParameters> measures{};  ///< units of the parameters in `starts`
  Starts starts{};      ///< where a fit cannot start at the neutral values (stick, shape)
  double shapes = 1.0;  ///< approximate number of different shapes of the model: the penalty of its fit
  /// Prior odds against the effect, in units of the evidence (2 ln): for rare effects that can imitate a common one where the
  /// recordings are short.
  double doubt = 0.0;
  /// Its parameters are an amplitude, a frequency or pitch, and a phase over the position.
  bool swings = false;
  /// Clearly detectable sizes of each parameter, as distances from the neutral value (from zero where there is none), on either
  /// side where the bounds allow both. Empty: host/sim/hidden_case.cpp draws the size for the machine.
  std::array<Range, kMaxEffectParameters> clear{};
};

/// One row of the catalogue.
struct EffectInfo {
  Effect effect;          ///< the row's effect
  std::string_view name;  ///< in model files, results and commands
  /// Short description, as in "the model lacks ..."; "the model's ..." where a parameter is wrong.
  std::string_view title;
  Stage stage;                  ///< that contains its model
  LocationType location_types;  ///< location types: it exists on every machine that has one of them
  std::string_view phase;       ///< on a hopper: "flight+stance", "stance", "touch-down", ...; empty: none
  std::string_view law;         ///< its model as a formula or phrase, for documentation
  std::array<EffectParameterInfo, kMaxEffectParameters> parameter_table;  ///< its parameters, then empty rows
  std::size_t parameter_count;                                            ///< rows of parameter_table in use
  std::string_view explanation;      ///< one sentence: what it does to the machine
  std::string_view where_to_look;    ///< where on the machine to look for the cause
  std::string_view best_experiment;  ///< experiment that shows it best
  Search search{};                   ///< how a diagnosis searches for it
  /// Its parameters.
  constexpr std::span<const EffectParameterInfo> parameters() const {
    return {parameter_table.data(), parameter_count};
  }
};

namespace detail {
inline constexpr double kUnset = __builtin_nan("");
/// `shapes` of a model that fits part of any recording.
inline constexpr double kManyShapes = 30.0;
/// Odds of about 1 to 150 against dry friction, which is in every machine.
inline constexpr double kSeldomMet = 10.0;
}  // namespace detail

/// The catalogue, indexed by Effect.
inline constexpr EffectInfo kCatalogue[] = {
    {Effect::coulomb_friction,
     "coulomb_friction",
     "dry friction",
     Stage::mechanism,
     LocationType::axis | LocationType::belt,
     "flight+stance",
     "-Fc sgn(v)",
     {{{"force_n", "torque_nm", "N", "N m", 0.0, 1e4, 0.0}}},
     1,
     "Dry friction: a force of constant size against the motion, whatever the speed.",
     "Guides, bearings, seals and belts: look for dirt, preload and dry rails.",
     "Slow strokes in both directions, and a free swing or drop that dies out: the loss a cycle does not "
     "shrink with the speed. On a rail, throws upwards beside falls: friction brakes both ways.",
     {.measures = {Measure::friction}, .starts = {{1.0}}}},
    {Effect::stribeck_friction,
     "stribeck_friction",
     "dry friction that rises towards standstill",
     Stage::mechanism,
     LocationType::axis,
     "flight+stance",
     "-(Fc + (Fs - Fc) exp(-(v/vs)^2)) sgn(v)",
     {{{"force_n", "torque_nm", "N", "N m", 0.0, 1e4, 0.0},
       {"static_force_n", "static_torque_nm", "N", "N m", 0.0, 1e4, 0.0},
       {"velocity_mps", "velocity_radps", "m/s", "rad/s", 1e-4, 50.0, detail::kUnset}}},
     3,
     "Dry friction that is larger near standstill than in motion.",
     "Plain bearings and greased guides: look at the lubricant and at stick-slip at reversals.",
     "Very slow strokes through several reversals, so that the axis spends time below the Stribeck velocity.",
     {.measures = {Measure::friction, Measure::friction, Measure::speed},
      .starts = {{0.8, 1.6, 0.03}, {0.8, 1.6, 0.1}, {0.8, 1.6, 0.3}},
      .shapes = 4.0}},
    {Effect::asymmetric_friction,
     "asymmetric_friction",
     "dry friction of different size in the two directions",
     Stage::mechanism,
     LocationType::axis,
     "flight+stance",
     "-Fc+ for v > 0, +Fc- for v < 0",
     {{{"force_up_n", "torque_up_nm", "N", "N m", -1e4, 1e4, 0.0},
       {"force_down_n", "torque_down_nm", "N", "N m", -1e4, 1e4, 0.0}}},
     2,
     "Dry friction of a different size in the two directions.",
     "Tilted or preloaded guides, cable drag, a drive whose zero is off: look at what pulls one way.",
     "Equal strokes up and down at several constant speeds, and rests in between: at rest an offset still pushes, "
     "friction does not.",
     {.measures = {Measure::friction, Measure::friction}, .starts = {{1.0, 1.0}}}},
    {Effect::quadratic_drag,
     "quadratic_drag",
     "drag that grows with the square of the speed",
     Stage::mechanism,
     LocationType::axis,
     "flight+stance",
     "-c v |v|",
     {{{"drag_ns2pm2", "drag_nms2prad2", "N s^2/m^2", "N m s^2/rad^2", 0.0, 1e4, 0.0}}},
     1,
     "A resistance that grows with the square of the speed, as of air or oil.",
     "Covers, fans, fluid-filled dampers and bellows.",
     "A few strokes at the highest speed and the same strokes at half of it."},
    {Effect::binding_spot,
     "binding_spot",
     "a spot where the guide binds",
     Stage::mechanism,
     LocationType::axis,
     "flight+stance",
     "extra Coulomb force within a stretch of the travel",
     {{{"force_n", "torque_nm", "N", "N m", 0.0, 1e4, 0.0},
       {"centre_m", "centre_rad", "m", "rad", -1e3, 1e3, detail::kUnset},
       {"width_m", "width_rad", "m", "rad", 1e-4, 10.0, detail::kUnset}}},
     3,
     "The axis rubs harder along one stretch of its travel, in both directions.",
     "The guide at that place: a dent, a tight carriage, a cable that touches.",
     "Slow strokes through the whole travel in both directions, the force noted over the position.",
     {.measures = {Measure::friction, Measure::place, Measure::travel},
      .starts = {{1.0, 0.0, 0.1}, {1.0, 0.0, 0.25}},
      .shapes = detail::kManyShapes,
      .doubt = detail::kSeldomMet}},
    {Effect::damping_error,
     "damping_error",
     "the model's viscous damping",
     Stage::mechanism,
     LocationType::axis | LocationType::belt,
     "flight+stance",
     "viscous damping differs from a held value (on a hopper: added to the guide's)",
     {{{"damping_nspm", "damping_nmspr", "N s/m", "N m s/rad", -1e4, 1e6, detail::kUnset, false, {}, true}}},
     1,
     "The resistance in proportion to the speed is larger or smaller than the model says.",
     "Grease and seals of the guide and the bearings, at the temperature of the day.",
     "Strokes at several constant speeds: the slope of the force over the speed."},
    {Effect::force_offset,
     "force_offset",
     "a constant force",
     Stage::mechanism,
     LocationType::axis,
     "flight+stance",
     "constant force on the axis",
     {{{"force_n", "torque_nm", "N", "N m", -1e4, 1e4, 0.0}}},
     1,
     "A constant force pushes the axis one way.",
     "Cable chains, balance weights, a tilt of the rail, an offset of the drive's current sensor.",
     "Hold the axis at rest at several places and note the force that holding takes."},
    {Effect::guide_tilt,
     "guide_tilt",
     "a tilt of the guide",
     Stage::mechanism,
     LocationType::rail,
     "flight+stance",
     "gravity scaled by cos(tilt)",
     {{{"tilt_rad", "tilt_rad", "rad", "rad", 0.0, 1.3, 0.0}}},
     1,
     "The guide is not vertical, so that less of gravity acts along it.",
     "The guide against a plumb line.",
     "A level on the guide. Or long falls without torque: the acceleration in free flight is below g, by as much on the "
     "way up as on the way down.",
     {.starts = {{0.2}}, .clear = {{{0.3, 0.5}}}}},
    {Effect::mass_error,
     "mass_error",
     "the model's mass",
     Stage::mechanism,
     LocationType::axis,
     "flight+stance",
     "mass differs from the model's",
     {{{"mass_kg", "inertia_kgm2", "kg", "kg m^2", 1e-6, 1e6, detail::kUnset}}},
     1,
     "What moves is heavier or lighter than the model says.",
     "What was added or taken off since the mass was found: cables, covers, batteries.",
     "A scale; or the same motion with a known mass added."},
    {Effect::stiffness_error,
     "stiffness_error",
     "the model's spring rate",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "the spring's rate differs from the model's",
     {{{"stiffness_npm", "stiffness_npm", "N/m", "N/m", 1.0, 1e6, detail::kUnset}}},
     1,
     "The spring is stiffer or softer than the model says.",
     "The spring itself, its anchor points and the cam that it wraps.",
     "Slow compression against a force plate or a scale: the slope of force over height is the rate."},
    {Effect::rest_height_error,
     "rest_height_error",
     "the model's rest height of the spring",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "the spring's rest height differs",
     {{{"rest_height_m", "rest_height_m", "m", "m", 1e-3, 10.0, detail::kUnset}}},
     1,
     "The spring begins to push at another height than the model says.",
     "The length of the spring's cable, the tooth it is caught on, the encoder's zero.",
     "Slow compression against a force plate: the height at which the force begins."},
    {Effect::spring_preload,
     "spring_preload",
     "preload of the spring",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "constant force while the spring is engaged",
     {{{"force_n", "force_n", "N", "N", -1e4, 1e4, 0.0}}},
     1,
     "The spring already pushes at its modelled rest height, or only begins later.",
     "The spring's adjuster, the cable's length and the tooth it is caught on.",
     "Slow compression against a force plate: where the line of force over height crosses zero."},
    {Effect::spring_hardening,
     "spring_hardening",
     "a spring that hardens",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "-k3 (z - z0)^3",
     {{{"cubic_npm3", "cubic_npm3", "N/m^3", "N/m^3", -1e9, 1e9, 0.0}}},
     1,
     "The spring's force grows faster (or slower) than in proportion to the compression.",
     "The cam that the spring wraps, coils that close, a rubber part in series.",
     "Slow compression over the whole travel against a force plate: the bend of the line of force over height."},
    {Effect::spring_hysteresis,
     "spring_hysteresis",
     "hysteresis of the spring",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "-h |Fs| sgn(v)",
     {{{"ratio", "ratio", "", "", 0.0, 1.0, 0.0}}},
     1,
     "The spring gives back less than it took: a loss in proportion to its force.",
     "Friction of the cable on cam and pulleys, rubber in the load path.",
     "Slow compression and release against a force plate: the area between the two lines.",
     {.clear = {{{0.06, 0.15}}}}},
    {Effect::leg_inertia,
     "leg_inertia",
     "the inertia of the links",
     Stage::mechanism,
     LocationType::light_leg,
     "stance",
     "the links' inertia (a, b, e), which the linear model leaves out",
     {{{"inertia_a_kgm2", "inertia_a_kgm2", "kg m^2", "kg m^2", 0.0, 1.0, 0.0},
       {"inertia_b_kgm", "inertia_b_kgm", "kg m", "kg m", 0.0, 1.0, 0.0},
       {"inertia_e_kgm", "inertia_e_kgm", "kg m", "kg m", 0.0, 1.0, 0.0}}},
     3,
     "The links turn while the leg folds, and their inertia resists that.",
     "The masses of the links and where their centres are: a heavy knee counts most.",
     "Hops of different depth with the spring caught: the stance of a deep hop takes longer than the spring and the mass say.",
     {.starts = {{1e-3, 2e-3, 5e-3}, {4e-3, 7e-3, 3e-2}},
      .clear = {{{4.2e-3, 4.2e-3}, {7.5e-3, 7.5e-3}, {38e-3, 38e-3}}}}},
    {Effect::torque_gain_error,
     "torque_gain_error",
     "the model's torque gain",
     Stage::actuation,
     LocationType::leg,
     "stance",
     "delivered = gain x commanded",
     {{{"gain", "gain", "", "", 0.0, 10.0, 1.0}}},
     1,
     "The motor makes more or less torque than commanded, in proportion.",
     "The torque constant in the drive's settings, the gear ratio, the current sensor's scale.",
     "Hops at two torque amplitudes, or the stalled motor against a scale.",
     {.clear = {{{0.12, 0.25}}}}},
    {Effect::torque_offset,
     "torque_offset",
     "an offset of the motor's torque",
     Stage::actuation,
     LocationType::leg,
     "stance",
     "delivered = commanded + offset",
     {{{"torque_nm", "torque_nm", "N m", "N m", -1e3, 1e3, 0.0}}},
     1,
     "The motor makes a constant torque on top of the commanded one.",
     "The zero of the drive's current sensor, cogging, a cable that twists.",
     "Stalled motor on a scale at zero command; or hops with the torque off against hops with it on."},
    {Effect::actuator_delay,
     "actuator_delay",
     "a delay of the drive",
     Stage::actuation,
     LocationType::drive,
     "stance",
     "pure delay",
     {{{"delay_s", "delay_s", "s", "s", 0.0, 0.2, 0.0}}},
     1,
     "The torque arrives later than it was commanded.",
     "The bus's cycle time, a filter in the drive, buffering on the way to it.",
     "A torque step against a stop, command and torque on one clock.",
     {.starts = {{2e-3}, {8e-3}, {20e-3}}, .clear = {{{0.01, 0.03}}}}},
    {Effect::actuator_lag,
     "actuator_lag",
     "a lag of the drive",
     Stage::actuation,
     LocationType::drive,
     "stance",
     "first-order lag",
     {{{"time_constant_s", "time_constant_s", "s", "s", 0.0, 1.0, 0.0}}},
     1,
     "The torque follows the command with a first-order lag.",
     "The current loop's bandwidth, the winding's inductance at low supply voltage.",
     "A torque step against a stop: the rise time.",
     {.starts = {{3e-3}, {10e-3}, {30e-3}}, .clear = {{{0.01, 0.03}}}}},
    {Effect::torque_saturation,
     "torque_saturation",
     "a limit of the drive",
     Stage::actuation,
     LocationType::drive,
     "stance",
     "magnitude limited",
     {{{"limit_n", "limit_nm", "N", "N m", 0.0, 1e4, detail::kUnset, true}}},
     1,
     "The drive cuts off what is commanded beyond a limit.",
     "The drive's current limit, the supply's voltage at speed.",
     "Torque steps of growing size against a stop.",
     {.measures = {Measure::input},
      .starts = {{0.9}, {0.75}, {0.6}, {0.4}},
      .shapes = 4.0,
      .clear = {{{1.0, 1.2}}}}},
    {Effect::torque_ripple,
     "torque_ripple",
     "ripple of the motor's torque",
     Stage::actuation,
     LocationType::motor,
     "stance",
     "A sin(n theta + phi)",
     {{{"amplitude_nm", "amplitude_nm", "N m", "N m", 0.0, 1e3, 0.0},
       {"cycles_per_rev", "cycles_per_rev", "", "", 0.5, 200.0, detail::kUnset},
       {"phase_rad", "phase_rad", "rad", "rad", -10.0, 10.0, detail::kUnset}}},
     3,
     "The motor's torque swings with its angle: cogging or commutation.",
     "The motor's cogging torque, the drive's commutation angle and encoder calibration.",
     "Turn slowly under position control and note the torque over the angle.",
     {.shapes = detail::kManyShapes, .doubt = detail::kSeldomMet, .swings = true}},
    {Effect::thermal_derating,
     "thermal_derating",
     "a motor that weakens as it warms",
     Stage::actuation,
     LocationType::drive,
     "stance",
     "gain falls exponentially with the seconds that torque was commanded",
     {{{"final_gain", "final_gain", "", "", 0.0, 1.0, 1.0},
       {"time_constant_s", "time_constant_s", "s", "s", 0.1, 1e4, detail::kUnset}}},
     2,
     "The torque for one command falls while the motor works.",
     "The motor's and the drive's temperature, the drive's thermal limit.",
     "One long run of equal hops: the apex over the time.",
     {.starts = {{0.8, 1.0}, {0.8, 5.0}, {0.8, 25.0}}, .shapes = 4.0}},
    {Effect::backlash,
     "backlash",
     "backlash between motor and leg",
     Stage::actuation,
     LocationType::motor,
     "stance",
     "dead zone between motor and leg, crossed by the rotor, plastic at its ends",
     {{{"gap_rad", "gap_rad", "rad", "rad", 0.0, 0.5, 0.0}}},
     1,
     "The motor turns through a dead zone before it moves the leg, wherever its torque changes sign.",
     "Gears, couplings, keys and the screws of the links: hold the motor and turn the leg by hand.",
     "Small torques of both signs on a leg that is held: the angle on the motor's side over the torque.",
     {.starts = {{0.02}, {0.05}}}},
    {Effect::touchdown_loss,
     "touchdown_loss",
     "the loss of speed at touch-down",
     Stage::contact,
     LocationType::leg,
     "touch-down",
     "velocity x alpha_td at touch-down",
     {{{"restitution_touchdown", "restitution_touchdown", "", "", 0.0, 1.5, detail::kUnset}}},
     1,
     "A part of the speed is lost in an instant at touch-down.",
     "The mass of toe and lower links that stops at once, and the pad under the toe.",
     "Drops from several heights without torque: compare the speed before and after touch-down."},
    {Effect::liftoff_loss,
     "liftoff_loss",
     "the loss of speed at lift-off",
     Stage::contact,
     LocationType::leg,
     "lift-off",
     "velocity x alpha_lo at lift-off",
     {{{"restitution_liftoff", "restitution_liftoff", "", "", 0.0, 1.5, detail::kUnset}}},
     1,
     "A part of the speed is lost in an instant at lift-off.",
     "The leg's stop, and the mass of toe and lower links that it pulls along.",
     "Hops without torque: the speed before and after lift-off.",
     {.clear = {{{0.85, 0.93}}}}},
    {Effect::ground_compliance,
     "ground_compliance",
     "a ground that gives",
     Stage::contact,
     LocationType::leg,
     "stance",
     "spring and damper under the toe",
     {{{"stiffness_npm", "stiffness_npm", "N/m", "N/m", 100.0, 1e6, detail::kUnset, false, kNotOfModel},
       {"damping_nspm", "damping_nspm", "N s/m", "N s/m", 0.0, 1e4, detail::kUnset}}},
     2,
     "The ground or the pad under the toe gives way under the load.",
     "The floor, the pad under the toe, the frame that carries the rail.",
     "A gauge under the toe while the body is pressed down slowly.",
     {.starts = {{2.5e3, 10.0}, {5e3, 20.0}, {1e4, 20.0}, {2e4, 50.0}, {6e4, 100.0}},
      .clear = {{{4e3, 8e3}, {10.0, 40.0}}}}},
    {Effect::toe_sticking,
     "toe_sticking",
     "a toe that sticks to the ground",
     Stage::contact,
     LocationType::leg,
     "lift-off",
     "the toe holds on until the pull exceeds a force",
     {{{"force_n", "force_n", "N", "N", 0.0, 1e3, 0.0}}},
     1,
     "The toe holds on to the ground at lift-off.",
     "The pad under the toe and the floor: rubber, suction, glue, dirt.",
     "Pull the leg off the ground slowly with a scale.",
     {.starts = {{1.0}, {4.0}, {10.0}}, .clear = {{{5.0, 12.0}}}}},
    {Effect::encoder_offset,
     "encoder_offset",
     "an offset of the encoder's zero",
     Stage::sensing,
     LocationType::leg | LocationType::swing,
     "flight+stance",
     "measured = true + offset",
     {{{"offset_m", "offset_rad", "m", "rad", -10.0, 10.0, 0.0}}},
     1,
     "The position is measured from another zero than the model's.",
     "The homing of the encoder: where the reference mark was.",
     "Rest the machine at a known position and read the encoder.",
     {.clear = {{{0.004, 0.01}}}}},
    {Effect::height_scale_error,
     "height_scale_error",
     "a scale error of the height",
     Stage::sensing,
     LocationType::rail,
     "flight+stance",
     "measured = scale x true, about the touch-down height (on a rail carriage about zero)",
     {{{"scale", "scale", "", "", 0.5, 2.0, 1.0}}},
     1,
     "The height is measured in too large or too small steps.",
     "Counts a revolution, and the pitch circle of the pinion.",
     "Move the body by a known length and read the encoder.",
     {.clear = {{{0.03, 0.08}}}}},
    {Effect::height_eccentricity,
     "height_eccentricity",
     "an eccentric encoder",
     Stage::sensing,
     LocationType::rail,
     "flight+stance",
     "measured = true + A sin(2 pi z / pitch + phi)",
     {{{"amplitude_m", "amplitude_m", "m", "m", 0.0, 0.1, 0.0},
       {"pitch_m", "pitch_m", "m", "m", 1e-3, 1.0, detail::kUnset},
       {"phase_rad", "phase_rad", "rad", "rad", -10.0, 10.0, detail::kUnset}}},
     3,
     "The height's error swings once a revolution of the encoder's wheel.",
     "The encoder's disc or the pinion sits off its centre.",
     "Move the body slowly along a straight edge and compare, over some revolutions of the wheel.",
     {.shapes = detail::kManyShapes, .doubt = detail::kSeldomMet, .swings = true}},
    {Effect::encoder_slip,
     "encoder_slip",
     "a slip of the encoder",
     Stage::sensing,
     LocationType::axis | LocationType::belt,
     "flight+stance",
     "the measured position jumps by a step at an instant and stays there",
     {{{"step_m", "step_rad", "m", "rad", -10.0, 10.0, 0.0},
       {"time_s", "time_s", "s", "s", 0.0, 1e6, detail::kUnset}}},
     2,
     "The measured position jumps at an instant while the machine does not, and stays off by that step.",
     "The pinion on its rack, the coupling of the encoder, counts lost on a noisy line.",
     "Return to a reference mark after each run and compare the counts."},
    {Effect::contact_delay,
     "contact_delay",
     "a contact switch that reports late or early",
     Stage::sensing,
     LocationType::leg,
     "touch-down",
     "the switch reports late (+) or early (-)",
     {{{"delay_s", "delay_s", "s", "s", -0.1, 0.1, 0.0}}},
     1,
     "The contact switch reports later, or earlier, than the toe touches.",
     "The switch's travel and spring, and the filter on its line.",
     "Tap the toe on a plate with an accelerometer on it, both on one clock.",
     {.clear = {{{0.01, 0.02}}}}},
    {Effect::time_skew,
     "time_skew",
     "a skew between the clocks of position and torque",
     Stage::sensing,
     LocationType::drive,
     "flight+stance",
     "measured(t) = true(t - skew)",
     {{{"skew_s", "skew_s", "s", "s", -0.1, 0.1, 0.0}}},
     1,
     "The position stands in the log later, or earlier, than the torque of the same instant.",
     "Time stamps taken at reception, filters on the encoder's line, buffering.",
     "A tap or a torque step that both channels see: compare the instants.",
     {.starts = {{-5e-3}, {0.0}, {5e-3}}, .doubt = detail::kSeldomMet}},
    {Effect::clutch_slip,
     "clutch_slip",
     "a clutch that slips over its teeth",
     Stage::mechanism,
     LocationType::belt,
     "",
     "the key skips a tooth while pull + kinetic energy / pitch > holding force; each tooth turns holding force x "
     "pitch into heat",
     {{{"holding_force_n", "holding_force_n", "N", "N", 0.0, 1e4, detail::kUnset}}},
     1,
     "The key cannot stop the falling load at once: the belt slips on over whole teeth, each of which takes "
     "some of its energy.",
     "The key's return spring, worn or printed teeth, a belt that is not pressed on along its whole length.",
     "Releases of growing length with one load: the longer the fall, the more teeth the catch skips.",
     {.measures = {Measure::load}, .starts = {{1.1}, {1.4}, {2.0}, {3.0}, {5.0}}, .shapes = 4.0}},
    {Effect::late_catch,
     "late_catch",
     "the model's delay of the catch",
     Stage::mechanism,
     LocationType::leg | LocationType::belt,
     "",
     "the catch engages delay_s after the coil is switched off, in place of the model's catch_delay_s",
     {{{"delay_s", "delay_s", "s", "s", 0.0, 1.0, detail::kUnset, false, "catch_delay_s"}}},
     1,
     "The key presses on the belt later, or earlier, after the coil is switched off than the model says.",
     "The coil's flyback path, a key that is heavy, dirty or sticks to the yoke, a weak return spring.",
     "Releases of many different lengths: the tooth on which each catch ends shows when the key came.",
     {.starts = {{2e-3}, {8e-3}, {16e-3}, {28e-3}, {45e-3}}, .shapes = 4.0}},
    {Effect::incomplete_release,
     "incomplete_release",
     "a release that leaves a part of the spring's force",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "F = F_released + ratio (F_caught - F_released) while released",
     {{{"ratio", "ratio", "", "", 0.0, 1.0, 0.0}}},
     1,
     "The released spring still pushes with a part of the force that it has when it is caught.",
     "A key that is not pulled out of the teeth, a cable that rubs on its guide, a solenoid with too little stroke.",
     "Releases in stance at several depths: the leg that should go soft stays stiff in part.",
     {.starts = {{0.02}, {0.06}, {0.12}, {0.2}, {0.3}, {0.45}, {0.65}, {0.85}},
      .shapes = 4.0,
      .clear = {{{0.15, 0.4}}}}},
    {Effect::auxiliary_spring,
     "auxiliary_spring",
     "the model's rate of the auxiliary spring",
     Stage::mechanism,
     LocationType::leg | LocationType::belt,
     "stance",
     "when released, the auxiliary spring's force is k_aux x stretch with another k_aux than the model's",
     {{{"stiffness_npm", "stiffness_npm", "N/m", "N/m", 0.0, 1e4, detail::kUnset, false,
        "auxiliary_stiffness_npm"}}},
     1,
     "The soft spring that takes the cable home pulls harder, or less, than the model says.",
     "The auxiliary spring itself, its pretension, and the pulleys between it and the clutch.",
     "On the bench several releases one after the other: each fall begins with less force. On the robot "
     "releases in stance at several depths.",
     {.measures = {Measure::model},
      .starts = {{0.3}, {1.0}, {2.0}, {4.0}, {7.0}, {11.0}, {16.0}, {22.0}},
      .shapes = 4.0}},
    {Effect::bump_stop,
     "bump_stop",
     "a bump stop at the end of the leg's travel",
     Stage::mechanism,
     LocationType::leg,
     "stance",
     "k (c - c0) upwards while the leg's compression c, from its length at touch-down, is beyond c0",
     {{{"compression_m", "compression_m", "m", "m", 1e-3, 1.0, detail::kUnset},
       {"stiffness_npm", "stiffness_npm", "N/m", "N/m", 0.0, 1e6, 0.0}}},
     2,
     "Folded far enough, the leg runs onto an elastic stop that pushes it back.",
     "Rubber stops on the links or the rail, coils that touch, a cable or cover that is squeezed at the deepest point.",
     "Slow compression to the deepest point against a force plate: the height at which the line of force over height has a kink.",
     {.measures = {Measure::depth, Measure::model},
      .starts = {{0.0, 0.0}, {0.0, 2.0}},
      .shapes = 4.0,
      .clear = {{{0.03, 0.045}, {1.5e3, 4e3}}}}},
};
/// Number of effects.
inline constexpr std::size_t kEffectCount = std::size(kCatalogue);

/// The catalogue's row of an effect.
constexpr const EffectInfo& info(Effect e) { return kCatalogue[static_cast<std::size_t>(e)]; }

/// Whether the effect exists on machines of this kind.
constexpr bool applies(Effect e, Kind k) { return has(k, info(e).location_types); }

/// Whether the effect is one of a clutch, which a hopper need not have.
constexpr bool needs_clutch(Effect e) {
  return e == Effect::clutch_slip || e == Effect::late_catch || e == Effect::incomplete_release ||
         e == Effect::auxiliary_spring;
}

/// The effect of this name; none if there is no such effect.
constexpr std::optional<Effect> effect_named(std::string_view name) {
  for (const EffectInfo& e : kCatalogue)
    if (e.name == name) return e.effect;
  return std::nullopt;
}

/// The parameter's name on machines of this kind.
constexpr std::string_view name_on(const EffectParameterInfo& p, Kind k) {
  return info(k).rotary || (p.of_motor && has(k, LocationType::leg)) ? p.rotary_name : p.name;
}
/// The parameter's unit on machines of this kind.
constexpr std::string_view unit_on(const EffectParameterInfo& p, Kind k) {
  return info(k).rotary || (p.of_motor && has(k, LocationType::leg)) ? p.rotary_unit : p.unit;
}

static_assert(
    [] {
      for (std::size_t i = 0; i < kEffectCount; ++i)
        if (static_cast<std::size_t>(kCatalogue[i].effect) != i) return false;
      return true;
    }(),
    "the catalogue stands in the order of the enumeration");

}  // namespace furcula::dynamics
