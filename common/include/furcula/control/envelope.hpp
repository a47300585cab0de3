// Limits of the robot's height and speed that hold for all parameters: the torque is reduced before they are reached,
// and measurements must agree with the parameters. The figures are built into the image; no parameter changes them.
#pragma once

#include <cstdint>

#include "furcula/control/fault.hpp"
#include "furcula/control/sample.hpp"
#include "furcula/control/torque_profile.hpp"
#include "furcula/core/count.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Limits for the robot that an image is built for; the defaults are for the robot of document 002.
struct EnvelopeConfig {
  float mass_kg = 1.5f;             ///< of all that hops; too small is safe: the torque is reduced earlier
  float straight_leg_rad = 0.349f;  ///< leg angle on the stop
  float gravity_mps2 = 9.81f;       ///< acceleration of gravity along the rail, positive downwards
  /// Greatest planned apex: half of the rail, less the travel of the body in a few ticks; m.
  float apex_max_m = 0.70f;
  /// Greatest planned speed of the body at touch-down, m/s. A robot whose encoder scale has the largest error that is
  /// not detected (see flight_tolerance) lands a quarter faster, and stays below the 3 m/s of docs/safety.md.
  float touchdown_speed_max_mps = 2.6f;
  /// Touch-down speed whose ballistic apex is a fault: the torque was not reduced, or the drive does not follow its
  /// command; m/s.
  float speed_fault_mps = 2.85f;
  float apex_fault_m = 0.73f;  ///< ballistic apex that is a fault in any case
  /// The hip at 0.10 m: a leg that folds further has collapsed. A ceiling of leg_angle_max_rad.
  float leg_angle_max_rad = 1.22f;
  /// Work that the motor may put in before a flight has confirmed the scale of the height encoder, J.
  float unproven_work_j = 2.5f;
  float torque_max_nm = 20.0f;  ///< a ceiling of torque_limit_nm
  /// Largest torque magnitude while the switch is open for longer than it bounces, except when the leg is moved along
  /// its path.
  float unsupported_torque_max_nm = 4.0f;
  /// A leg that swings faster in flight is not driven further in its direction, rad/s.
  float leg_rate_max_radps = 16.0f;
  float toe_speed_max_mps = 2.5f;  ///< a toe that comes down so fast is not driven further down
  /// Share by which a flight's mean deceleration may differ from gravity: friction and a slope are within.
  float flight_tolerance = 0.25f;
  float flight_noise_mps = 0.1f;  ///< velocity that is added to flight_tolerance for the noise of the encoder
  /// A leg that is flexed by no more than this beyond the stop stores at most 0.3 J more than the straight leg, rad.
  float nearly_straight_rad = 0.25f;
  float straight_tolerance_m = 0.02f;  ///< by which a leg may measure longer than the touch-down height
  /// Factor by which the spring's energy in a stance may differ from that of the parameters, either way.
  float spring_factor = 2.0f;
  /// The weight deflects the robot's spring by more than this. A spring that is configured stiffer would make the motor
  /// push with its full torque before a stance can show the error.
  float least_sag_m = 0.005f;
  /// By which a leg folds further while its angle is transmitted: some ticks of a fall.
  float late_angle_rad = 0.05f;
};

/// State of watch_envelope() and hold_back() between two ticks. On the clutch's bench watch_bench() uses it.
struct EnvelopeState {
  bool running = false;           ///< there was a tick before this one
  bool rises = false;             ///< direction of the body, with 0.05 m/s of hysteresis; true: up
  bool has_stood = false;         ///< the switch has been closed; on the bench: the switch on the first tick
  bool above = true;              ///< in this flight the body was never lower than a straight leg
  bool proven = false;            ///< a flight has confirmed the scale of the height encoder
  std::uint8_t untold = 0;        ///< flights in a row that were long enough to confirm it and did not
  std::uint8_t beyond_ticks = 0;  ///< ticks in a row outside of the envelope
  float reference_m = 0.0f;       ///< height of the last apex
  float work_j = 0.0f;            ///< work of the motor since that apex; negative: taken out
  float flight_work_j = 0.0f;     ///< work of the motor since the switch opened
  float landed_m = 0.0f;          ///< ballistic apex when the switch closed; 0 where the leg landed bent
  float stance_work_j = 0.0f;     ///< work of the motor since the switch closed
  float highest_m = 0.0f;         ///< greatest height since the body began to rise
  float torque_nm = 0.0f;         ///< torque that hold_back() returned on the last tick
  float last_angle_rad = 0.0f,    ///< leg angle on the last tick; on the bench: on the first tick
      rate_radps = 0.0f;          ///< rate of the leg angle over the last tick
  std::uint32_t open_ticks = 0;   ///< ticks in a row with the switch open; on the bench: first height count
  float first_mps = 0.0f,         ///< velocity in this flight, 25 ticks after the switch opened
      last_mps[4] = {};           ///< velocities in this flight at each tenth tick, the newest first
};

/// Inputs of one tick of the envelope. Lengths and heights follow from the parameters.
struct EnvelopeView {
  float height_m = 0.0f;            ///< body above the ground
  float velocity_mps = 0.0f;        ///< of the body, positive upwards
  float leg_angle_rad = 0.0f;       ///< from the vertical; grows as the leg folds
  float leg_m = 0.0f;               ///< length of the leg, 2 L cos(leg angle)
  float lever_m = 0.0f;             ///< decrease of the leg's length per angle, 2 L sin(leg angle); m/rad
  float touchdown_height_m = 0.0f;  ///< height of the body when the straight leg meets the ground
  bool contact_reading = false;     ///< switch before debouncing; without a switch the contact observer
  float spring_npm = 0.0f,          ///< stiffness along the leg; 0: not known, or not caught
      spring_rest_m = 0.0f;         ///< leg length at which the spring is relaxed; 0 likewise
};

/// Height from which a fall reaches `speed_mps` at touch-down, but at most `apex_m`; m.
inline float highest_m(const EnvelopeConfig& c, float touchdown_height_m, float speed_mps, float apex_m) {
  const float by_speed_m = touchdown_height_m + speed_mps * speed_mps / (2.0f * c.gravity_mps2);
  return by_speed_m < apex_m ? by_speed_m : apex_m;
}

/// Apex of the body if nothing but gravity acted on it from now on, m.
inline float ballistic_apex_m(const EnvelopeConfig& c, float height_m, float velocity_mps) {
  return height_m + velocity_mps * velocity_mps / (2.0f * c.gravity_mps2);
}

/// Highest apex that the robot can reach without further torque, m: the last apex with all of the motor's work since
/// then and no losses, or the ballistic apex if that is higher.
inline float predicted_apex_m(const EnvelopeConfig& c, const EnvelopeState& s, const EnvelopeView& view) {
  const float by_work_m = s.reference_m + s.work_j / (c.mass_kg * c.gravity_mps2);
  const float by_motion_m = ballistic_apex_m(c, view.height_m, view.velocity_mps);
  return by_work_m > by_motion_m ? by_work_m : by_motion_m;
}

/// Largest amplitude of a torque profile, N m: in one half of a stance, from the straight leg to the deepest fold, the
/// motor must not put in more energy than the highest hop has at touch-down. No robot loses as much in the other half.
inline float amplitude_max_nm(const EnvelopeConfig& c, ProfileShape shape) {
  constexpr float kMeanOfSine = 0.636619772f;  // over half a turn, 2 / pi
  const float landing_j = 0.5f * c.mass_kg * c.touchdown_speed_max_mps * c.touchdown_speed_max_mps;
  const float constant_nm = landing_j / (c.leg_angle_max_rad - c.straight_leg_rad);
  return shape == ProfileShape::harmonic ? constant_nm / kMeanOfSine : constant_nm;
}

/// Whether the profile, limited to `torque_limit_nm`, stays within amplitude_max_nm(): a larger torque would be reduced
/// in every stance.
inline bool fits(const EnvelopeConfig& c, const TorqueProfileConfig& torque, float torque_limit_nm) {
  const float asked_nm = torque.amplitude_nm < 0.0f ? -torque.amplitude_nm : torque.amplitude_nm;
  const float most_nm = asked_nm < torque_limit_nm ? asked_nm : torque_limit_nm;
  return torque.shape == ProfileShape::zero || most_nm <= amplitude_max_nm(c, torque.shape);
}

namespace envelope_parts {

/// Compares the change of velocity in a flight with gravity, from 25 ms after the switch opened until 30 ms or more
/// before it closed. @returns parameters_implausible or none. The switch may be 10 ms early or late, and bounce; a hop
/// of less than 4 cm is mostly that. A body that stays low shows that the switch is wrong, and nothing of the scale.
inline Fault judge_flight(const EnvelopeConfig& c, EnvelopeState& s, const EnvelopeView& view, float dt_s) {
  constexpr std::uint32_t kSettled = 25, kEvery = 10, kShortest = 150;
  constexpr float kGroundM = 0.035f;  // that is lower than it was
  constexpr std::uint8_t kUntoldMax = 5;
  if (!view.contact_reading) {
    ++s.open_ticks;
    if (view.height_m < view.touchdown_height_m - kGroundM) s.above = false;
    if (s.open_ticks == kSettled) s.first_mps = view.velocity_mps;
    if (s.open_ticks % kEvery == 0) {
      s.last_mps[3] = s.last_mps[2];
      s.last_mps[2] = s.last_mps[1];
      s.last_mps[1] = s.last_mps[0];
      s.last_mps[0] = view.velocity_mps;
    }
    return Fault::none;
  }
  const std::uint32_t ticks = s.open_ticks;
  const bool above = s.above, stood = s.has_stood;
  s.open_ticks = 0;
  s.above = s.has_stood = true;
  if (!stood || ticks < kSettled + kShortest) return Fault::none;
  if (!above && s.proven) return Fault::none;
  if (!above) return ++s.untold < kUntoldMax ? Fault::none : Fault::parameters_implausible;
  const std::uint32_t until = ticks / kEvery * kEvery - 3 * kEvery;
  const float expected_mps = c.gravity_mps2 * static_cast<float>(until - kSettled) * dt_s;
  const float differs_mps = s.first_mps - s.last_mps[3] - expected_mps;
  const float most_mps = c.flight_tolerance * expected_mps + c.flight_noise_mps;
  s.untold = 0;
  s.proven = true;
  return differs_mps > most_mps || differs_mps < -most_mps ? Fault::parameters_implausible : Fault::none;
}

/// Compares the spring's energy by the parameters with the energy balance at the lowest point of a stance. Losses make
/// the spring seem softer, never stiffer. @returns parameters_implausible or none.
inline Fault judge_spring(const EnvelopeConfig& c, const EnvelopeState& s, const EnvelopeView& view) {
  constexpr float kBentM = 0.02f;
  const float stretch_m = view.spring_rest_m - view.leg_m;
  if (!s.has_stood || !(view.spring_npm > 0.0f) || view.leg_m > view.touchdown_height_m - kBentM ||
      view.height_m > view.touchdown_height_m - kBentM)
    return Fault::none;
  const float energy_j = c.mass_kg * c.gravity_mps2 * (s.landed_m - view.height_m) + s.stance_work_j;
  constexpr float kTellingJ = 0.3f;
  const float most_work_j = 0.3f * energy_j;
  if (!(s.landed_m > 0.0f) || energy_j < kTellingJ || s.stance_work_j > most_work_j ||
      s.stance_work_j < -most_work_j)
    return Fault::none;
  const float spring_j = 0.5f * view.spring_npm * stretch_m * (stretch_m > 0.0f ? stretch_m : 0.0f);
  return spring_j > c.spring_factor * energy_j || energy_j > c.spring_factor * spring_j
             ? Fault::parameters_implausible
             : Fault::none;
}

}  // namespace envelope_parts

/// A leg that is longer than the straight one for three ticks is parameters_implausible. For every tick, also of a robot
/// that does not run. `longer_ticks` is the state: ticks in a row.
inline Fault watch_leg(const EnvelopeConfig& c, std::uint32_t& longer_ticks, const EnvelopeView& view) {
  constexpr std::uint32_t kTicks = 3;
  const bool longer = view.leg_m > view.touchdown_height_m + c.straight_tolerance_m;
  longer_ticks = longer ? longer_ticks + 1 : 0;
  return longer_ticks >= kTicks ? Fault::parameters_implausible : Fault::none;
}

/// One tick on the clutch's bench, where there is neither leg nor rail nor toe: if one of them moves, the parameter
/// on_bench is wrong. @returns parameters_implausible or none.
inline Fault watch_bench(EnvelopeState& s, const Sample& sample) {
  constexpr float kTurnedRad = 0.05f;
  constexpr std::int32_t kMovedCounts = 200;
  if (!s.running) {
    s.running = true;
    s.last_angle_rad = sample.leg_angle_rad;
    s.open_ticks = sample.height_count;
    s.has_stood = sample.contact != 0;
  }
  const float turned_rad = sample.leg_angle_rad - s.last_angle_rad;
  const std::int32_t moved = count_difference(sample.height_count, s.open_ticks);
  const bool moves =
      turned_rad > kTurnedRad || turned_rad < -kTurnedRad || moved > kMovedCounts || moved < -kMovedCounts;
  return moves || (sample.contact != 0) != s.has_stood ? Fault::parameters_implausible : Fault::none;
}

/// One tick, before the torque is chosen. @returns what is outside of the envelope, or contradicts the parameters.
inline Fault watch_envelope(const EnvelopeConfig& c, EnvelopeState& s, const EnvelopeView& view, float dt_s) {
  constexpr float kTurnedMps = 0.05f;  // beyond the velocity's noise
  constexpr std::uint32_t kFlying = 5;
  constexpr float kTakenOutJ = 4.0f;  // the most that counts, as of a landing that the motor carries
  constexpr std::uint8_t kTicks = 3;
  if (!s.running) {
    s = {};
    s.running = true;
    s.reference_m = ballistic_apex_m(c, view.height_m, view.velocity_mps);
    s.last_angle_rad = view.leg_angle_rad;
  }
  const float turned_rad = view.leg_angle_rad - s.last_angle_rad;
  s.last_angle_rad = view.leg_angle_rad;
  s.rate_radps = turned_rad / dt_s;
  const float work_j = s.torque_nm * turned_rad;
  s.work_j = s.work_j + work_j > -kTakenOutJ ? s.work_j + work_j : -kTakenOutJ;
  s.flight_work_j = view.contact_reading ? 0.0f : s.flight_work_j + work_j;
  if (view.contact_reading && s.open_ticks > 0) {
    // A leg that lands bent has a spring that is bent.
    const bool straight = view.leg_angle_rad < c.straight_leg_rad + 0.5f * c.nearly_straight_rad;
    s.landed_m = straight ? ballistic_apex_m(c, view.height_m, view.velocity_mps) : 0.0f;
    s.stance_work_j = 0.0f;
  }
  s.stance_work_j += work_j;
  Fault found = envelope_parts::judge_flight(c, s, view, dt_s);

  if (s.rises && view.height_m > s.highest_m) s.highest_m = view.height_m;
  if (!s.rises && view.velocity_mps > kTurnedMps) {
    const Fault spring = envelope_parts::judge_spring(c, s, view);
    if (found == Fault::none) found = spring;
    s.rises = true;
    s.highest_m = view.height_m;
  } else if (s.rises && view.velocity_mps < -kTurnedMps) {
    s.rises = false;
    // All energy is height, and what the motor put into a leg that is folded in flight.
    const bool flies = s.open_ticks >= kFlying;
    if (flies || view.leg_angle_rad < c.straight_leg_rad + c.nearly_straight_rad) {
      s.reference_m = s.highest_m;
      s.work_j = flies && s.flight_work_j > 0.0f ? s.flight_work_j : 0.0f;
    }
  }

  const float fault_m = highest_m(c, view.touchdown_height_m, c.speed_fault_mps, c.apex_fault_m);
  const bool beyond = ballistic_apex_m(c, view.height_m, view.velocity_mps) > fault_m;
  s.beyond_ticks = static_cast<std::uint8_t>(beyond ? s.beyond_ticks + 1 : 0);
  if (s.beyond_ticks >= kTicks) return Fault::beyond_envelope;
  return found;
}

/// Reduces `wanted_nm` to the torque that may be commanded, N m. Magnitude and folding close to leg_angle_max_rad are
/// limited; besides, a torque that takes energy out passes, and one that puts energy in fades over the last 5 cm below
/// the highest apex. Call it on each tick, after all other limits. `drives_leg`: the motor moves the leg along its path.
inline float hold_back(const EnvelopeConfig& c, EnvelopeState& s, const EnvelopeView& view, bool drives_leg,
                       float wanted_nm) {
  constexpr float kFadesM = 0.05f, kFadesRad = 0.15f, kStandsMps = 1.0f;
  const auto within = [](float x, float most) { return x < -most ? -most : x > most ? most : x; };
  constexpr std::uint32_t kBounceTicks = 5;
  const bool flies = !view.contact_reading;
  float torque_nm = within(
      wanted_nm, !drives_leg && s.open_ticks > kBounceTicks ? c.unsupported_torque_max_nm : c.torque_max_nm);
  // Close to the fold at which it has fallen the leg is not pulled further.
  const float unfolded_rad = c.leg_angle_max_rad - view.leg_angle_rad;
  if (torque_nm > 0.0f && unfolded_rad < kFadesRad)
    torque_nm *= unfolded_rad > 0.0f ? unfolded_rad / kFadesRad : 0.0f;
  if (torque_nm * s.rate_radps >= 0.0f) {
    // A toe that is taken to stand and moves is in the air.
    const float toe_mps = view.velocity_mps + view.lever_m * s.rate_radps;
    const bool toe_too_fast = torque_nm < 0.0f ? toe_mps < -(flies ? c.toe_speed_max_mps : kStandsMps)
                                               : !flies && toe_mps > kStandsMps;
    const bool too_fast =
        toe_too_fast ||
        (flies && (s.rate_radps > c.leg_rate_max_radps || s.rate_radps < -c.leg_rate_max_radps));
    const float cap_m = highest_m(c, view.touchdown_height_m, c.touchdown_speed_max_mps, c.apex_max_m);
    float room_m = cap_m - predicted_apex_m(c, s, view);
    const float unproven_m = (c.unproven_work_j - s.work_j) / (c.mass_kg * c.gravity_mps2);
    if (!s.proven && unproven_m < room_m) room_m = unproven_m;
    if (too_fast || !(room_m > 0.0f))
      torque_nm = 0.0f;
    else if (room_m < kFadesM)
      torque_nm *= room_m / kFadesM;
  }
  s.torque_nm = torque_nm;
  return torque_nm;
}

}  // namespace furcula::control
