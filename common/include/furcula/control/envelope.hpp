// How high and how fast the robot may get at most, whatever its parameters: the torque is held back before, and
// what is measured must go with the parameters. The figures are the image's; no parameter moves them.
#pragma once

#include <cstdint>

#include "furcula/control/fault.hpp"
#include "furcula/control/sample.hpp"
#include "furcula/control/torque_profile.hpp"
#include "furcula/core/count.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Of the robot that an image is built for; the defaults are the robot's of document 002.
struct EnvelopeConfig {
  float mass_kg = 1.5f;             ///< of all that hops; too small is safe: the torque is held back earlier
  float straight_leg_rad = 0.349f;  ///< the leg's angle on its stop
  float gravity_mps2 = 9.81f;
  /// Highest that a hop may be planned to go: half of the rail, less what the body goes on in a few ticks; m.
  float apex_max_m = 0.70f;
  /// With which the body may be planned to land, m/s. A robot whose encoder's scale is wrong by as much as is not
  /// found (see flight_tolerance) lands with a quarter more, and stays below the 3 m/s of docs/safety.md.
  float touchdown_speed_max_mps = 2.6f;
  /// Beyond this the torque was not held back, or does not do what it is told: a fault; m/s, m.
  float speed_fault_mps = 2.85f;
  float apex_fault_m = 0.73f;
  /// The hip at 0.10 m: what folds further has fallen. A ceiling of leg_angle_max_rad.
  float leg_angle_max_rad = 1.22f;
  /// Before the first flight has shown that the height's scale is right, a hop gets no more than this, J.
  float unproven_work_j = 2.5f;
  float torque_max_nm = 20.0f;  ///< a ceiling of torque_limit_nm
  float unsupported_torque_max_nm =
      4.0f;  ///< with a switch that is open for longer than it bounces, but for the leg's path
  /// A leg that swings faster in flight is not driven further in its direction, rad/s.
  float leg_rate_max_radps = 16.0f;
  float toe_speed_max_mps = 2.5f;  ///< a toe that comes down so fast is not driven further down
  /// Share by which a flight's mean deceleration may differ from gravity: friction and a slope are within.
  float flight_tolerance = 0.25f;
  float flight_noise_mps = 0.1f;
  /// A spring that is bent by no more than that holds 0.3 J beyond the straight leg's, rad.
  float nearly_straight_rad = 0.25f;
  float straight_tolerance_m = 0.02f;  ///< of the leg on its stop against the touch-down height
  /// By which the spring of a stance may be stiffer or softer than its parameter.
  float spring_factor = 2.0f;
  /// The weight bends the robot's spring by more. One that is taken to be stiffer is pushed against with all that the
  /// motor has, before a stance can tell.
  float least_sag_m = 0.005f;
  /// By which a leg folds on while its angle is on the way: some ticks of a fall.
  float late_angle_rad = 0.05f;
};

struct EnvelopeState {
  bool running = false;           ///< there was a tick before this one
  bool rises = false;             ///< the body, since it last sank
  bool has_stood = false;         ///< a flight began with a lift-off
  bool above = true;              ///< in this flight the body was nowhere lower than a straight leg
  bool proven = false;            ///< a flight has shown that heights are what they are taken for
  std::uint8_t untold = 0;        ///< flights running that could have and did not
  std::uint8_t beyond_ticks = 0;  ///< running: outside
  float reference_m = 0.0f;       ///< height of the last apex
  float work_j = 0.0f;            ///< of the motor since; negative: taken out
  float flight_work_j = 0.0f;     ///< of the motor since the switch opened
  float landed_m = 0.0f;          ///< apex that height and velocity said when the switch closed
  float stance_work_j = 0.0f;     ///< of the motor since then
  float highest_m = 0.0f;         ///< since the body last sank
  float torque_nm = 0.0f;         ///< of the last tick
  float last_angle_rad = 0.0f, rate_radps = 0.0f;
  std::uint32_t open_ticks = 0;              ///< of the switch
  float first_mps = 0.0f, last_mps[4] = {};  ///< in this flight; the last ones every ten ticks
};

/// What one tick of it sees. Lengths and heights are as the parameters have them.
struct EnvelopeView {
  float height_m = 0.0f;
  float velocity_mps = 0.0f;
  float leg_angle_rad = 0.0f;
  float leg_m = 0.0f;
  float lever_m = 0.0f;  ///< of the leg's length over its angle
  float touchdown_height_m = 0.0f;
  bool contact_reading = false;
  float spring_npm = 0.0f, spring_rest_m = 0.0f;  ///< 0: not known, or not caught
};

/// The height whose fall is as fast as the touch-down may be, and no higher than the apex may.
inline float highest_m(const EnvelopeConfig& c, float touchdown_height_m, float speed_mps, float apex_m) {
  const float by_speed_m = touchdown_height_m + speed_mps * speed_mps / (2.0f * c.gravity_mps2);
  return by_speed_m < apex_m ? by_speed_m : apex_m;
}

/// Apex of the body if nothing but gravity acted on it from now on, m.
inline float ballistic_apex_m(const EnvelopeConfig& c, float height_m, float velocity_mps) {
  return height_m + velocity_mps * velocity_mps / (2.0f * c.gravity_mps2);
}

/// Apex that the robot reaches at most with no more torque, m: all of the motor's work since the last apex, with
/// nothing lost, and all that the spring holds of it; or what height and velocity say.
inline float predicted_apex_m(const EnvelopeConfig& c, const EnvelopeState& s, const EnvelopeView& view) {
  const float by_work_m = s.reference_m + s.work_j / (c.mass_kg * c.gravity_mps2);
  const float by_motion_m = ballistic_apex_m(c, view.height_m, view.velocity_mps);
  return by_work_m > by_motion_m ? by_work_m : by_motion_m;
}

/// Largest amplitude of a torque over a stance: in one half of it, from the straight leg to the deepest fold, the
/// motor must not give more than the highest hop has at touch-down. No robot loses as much in the other half.
inline float amplitude_max_nm(const EnvelopeConfig& c, ProfileShape shape) {
  constexpr float kMeanOfSine = 0.636619772f;  // over half a turn, 2 / pi
  const float landing_j = 0.5f * c.mass_kg * c.touchdown_speed_max_mps * c.touchdown_speed_max_mps;
  const float constant_nm = landing_j / (c.leg_angle_max_rad - c.straight_leg_rad);
  return shape == ProfileShape::harmonic ? constant_nm / kMeanOfSine : constant_nm;
}

/// Whether the robot may be asked for that torque at all: what is more would be held back in every stance.
inline bool fits(const EnvelopeConfig& c, const TorqueProfileConfig& torque, float torque_limit_nm) {
  const float asked_nm = torque.amplitude_nm < 0.0f ? -torque.amplitude_nm : torque.amplitude_nm;
  const float most_nm = asked_nm < torque_limit_nm ? asked_nm : torque_limit_nm;
  return torque.shape == ProfileShape::zero || most_nm <= amplitude_max_nm(c, torque.shape);
}

namespace envelope_parts {

/// A flight from 25 ms after the switch opened until 30 ms or more before it closed: how much slower did its body get?
/// The switch may be 10 ms early or late, and bounce; a hop of less than 4 cm is mostly that. A body that went on being
/// low says that the switch is wrong, and nothing of the scale.
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

/// At the lowest point all energy is the spring's. Losses make it seem softer, never stiffer.
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

/// No leg is longer than the straight one that touches down. For every tick, also of a robot that stands and waits.
/// The angle may err for a tick or two.
inline Fault watch_leg(const EnvelopeConfig& c, std::uint32_t& longer_ticks, const EnvelopeView& view) {
  constexpr std::uint32_t kTicks = 3;
  const bool longer = view.leg_m > view.touchdown_height_m + c.straight_tolerance_m;
  longer_ticks = longer ? longer_ticks + 1 : 0;
  return longer_ticks >= kTicks ? Fault::parameters_implausible : Fault::none;
}

/// On the clutch's bench there is neither leg nor rail nor toe: where one of them moves, the parameter
/// on_bench is wrong. One tick; counts in `height_count`.
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

/// The torque that may be commanded of the one that is wanted: one that takes energy out always, one that puts
/// energy in fades over the last 5 cm below the highest apex. To be called on each tick, after all other limits.
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
