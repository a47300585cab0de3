// Monitors inputs and timing. A fault latches until an explicit reset; while it is latched the controller is in
// its safe state: torque 0, coil off.
#pragma once

#include <cstdint>

#include "furcula/control/fault.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Limits of the supervisor; beyond each is a fault.
struct SupervisorConfig {
  std::uint32_t tick_interval_max_us = 1500;  ///< between two ticks; more is late_tick
  std::uint32_t sample_age_max_us = 1500;     ///< age of a sample; more is stale_input
  std::uint32_t missed_samples_max = 1;       ///< in a row; one lost frame is bridged with the last sample
  float height_min_m = 0.03f;                 ///< of the body at the rail's lower end
  float height_max_m = 1.5f;                  ///< of the body at the rail's upper end
  float leg_angle_min_rad = 0.30f;            ///< the straight leg's stop, and a little play
  float leg_angle_max_rad = 1.45f;            ///< the folded leg's stop, and a little play
  /// The leg's height 2 L cos(leg angle) is the body's as long as the toe is on the ground, and can never be
  /// above it. By how much the encoder may contradict that, on uneven ground; m.
  float height_mismatch_m = 0.035f;
  /// A leg so much shorter than at touch-down is off its stop: with the switch closed the toe is on the
  /// ground; m.
  float flexed_leg_m = 0.01f;
  /// A switch that reads closed this far above the touch-down height, or open this far below it, is wrong if
  /// it stays so for so long (it reports within 10 ms of the true instant, and bounces; a toe that meets the
  /// ground while the motor folds the leg may hover on it for a while). Only a switch that has been closed
  /// for as long tells where the toe is: stretching, it moves by 2.5 cm in 10 ms; m.
  float contact_margin_m = 0.03f;
  float implausible_closed_s = 0.02f;  ///< for which the switch may be closed where it cannot be
  float implausible_open_s = 0.05f;    ///< for which the switch may be open where it cannot be
  /// A body on the rail is no faster than a fall from its end, sqrt(2 * 9.81 * 1.5); a count that moves
  /// further between two samples has jumped; m/s.
  float speed_max_mps = 5.5f;
  float step_margin_m = 0.002f;  ///< added to that distance, for noise and the exact times of the samples
  /// The switch bounces for 4 ms after a change, and there are two changes in a stride. So many changes, less
  /// those that contact_changes_per_s explains, are chatter.
  float contact_changes_max = 20.0f;
  float contact_changes_per_s = 100.0f;  ///< changes in a second that are not chatter
  /// Travel of the clutch's cable from home; beyond either limit the encoder has lost its count; m.
  float cable_travel_min_m = -0.003f;
  float cable_travel_max_m = 0.11f;      ///< upper limit of that travel
  std::uint32_t missed_catches_max = 5;  ///< stances in a row on a spring that was not caught
  /// A toe this far above flat ground touches nothing: the ground is within 3 cm, and the switch reports a
  /// toe that comes down up to 10 ms early. The time that the switch is closed there adds up to
  /// implausible_closed_s; m.
  float toe_clear_m = 0.06f;
  float closed_fades = 0.02f;  ///< by which that sum decreases in the rest of the time, s/s
  /// In flight the leg is where the motor moves it: within 3 cm of it except for 4 ms, with a drive on a bus and
  /// a toe on ground that the switch has not reported yet, and beyond a third of its path except for 5 ms. A motor
  /// that turns the wrong way leaves it straight or folds it. Largest distance of the leg from its path; m.
  float leg_error_m = 0.04f;
  float leg_way_m = 0.005f;     ///< length of the path from which on the leg must have done a third of it
  float leg_astray_s = 0.008f;  ///< for which the leg may be off
  /// In stance a leg that the motor pushes straight cannot fold ever faster than a body falls: the ground does not
  /// pull at the toe. Nor can it in a landing, where the motor brakes. Largest acceleration of the fold, as a share of
  /// gravity.
  float fall_share = 1.5f;
  float fall_margin_mps = 0.03f;  ///< added to the change of rate that this allows in a span of 5 ticks
  /// Spans of 5 ticks in a row with a faster fold that are a fault; where the toe meets the ground again there may be
  /// one or two.
  std::uint32_t falls_max = 3;
  /// A robot that does not run stands on its spring, wherever that is caught, once its switch has been closed for
  /// so long: the key has fallen in by then; s.
  float spring_rests_s = 0.1f;

  // Without its switch the robot lands. It has landed when it has been slow for long enough with its toe on the
  // ground, or after the longest time.
  static constexpr float kLanded_mps = 0.08f,  ///< speed of a body that is at rest in a landing, at most
      kLanded_s = 0.1f,                        ///< for which it must be at rest to have landed
      kLongestLanding_s = 2.0f;                ///< longest time of a landing
};

/// Inputs of one tick of the supervisor, gathered by the controller.
struct Observation {
  std::uint32_t tick_interval_us = 0;  ///< since the last tick
  std::uint32_t reported_fault = 0;    ///< by a device or the board: a number of the table of faults
  std::uint32_t missed_samples = 0;    ///< in a row
  std::uint32_t sample_age_us = 0;     ///< age of the last sample
  bool has_body = true;            ///< false: on the clutch's bench, where there is no more than the cable
  float height_m = 0.0f;           ///< of the body above the ground
  float above_touchdown_m = 0.0f;  ///< the height less the touch-down height
  float height_step_m = 0.0f;      ///< by which the height's counter moved since the sample before
  std::uint32_t step_ticks = 1;    ///< ticks between these two samples
  float leg_angle_rad = 0.0f;      ///< from the vertical; grows as the leg folds
  float leg_angle_ceiling_rad = 1e9f;  ///< a second upper limit of the leg angle, from the envelope
  float leg_height_m = 0.0f;           ///< 2 L cos(leg angle)
  bool contact_reading = false;        ///< of the switch; in a landing without it the observer's
  // Of the contact observer, which knows neither height nor switch (contact_observer.hpp).
  bool observed_contact = false;     ///< the toe is on the ground
  std::uint32_t observed_ticks = 0;  ///< since observed_contact changed
  bool observer_trusted = false;     ///< the observer has agreed with the switch for some changes
  bool runs = false;                 ///< the robot may move
  float velocity_mps = 0.0f;         ///< of the body, positive upwards
  float cable_travel_m = 0.0f;       ///< from home; 0 without a clutch
  std::uint32_t missed_catches = 0;  ///< stances in a row
  float leg_fold_m = 0.0f;     ///< on the last tick in flight, by which the leg was shorter than on its stop
  float leg_path_m = 0.0f;     ///< by which it was to be shorter; both 0 where the motor does not move it
  bool pushes = false;         ///< in stance the motor was commanded to push the leg straight
  float leg_rate_mps = 0.0f;   ///< derivative of the leg's length; negative as it folds
  float gravity_mps2 = 9.81f;  ///< acceleration of gravity, positive downwards
  bool rests = false;          ///< the robot has a clutch and does not run: its coil is to be off
  float tooth_pitch_m = 0.0f;  ///< of that clutch's belt, as seen along the leg
  Fault envelope = Fault::none;  ///< what watch_leg(), watch_envelope() or watch_bench() found
};

/// State of supervise() between two ticks.
struct SupervisorState {
  Fault fault = Fault::none;                    ///< latched: the first since the last reset
  std::uint32_t closed_ticks = 0;               ///< in a row: the switch reads closed
  std::uint32_t open_ticks = 0;                 ///< in a row: the switch reads open
  std::uint32_t implausible_contact_ticks = 0;  ///< in a row: the switch contradicts height and leg
  float contact_changes = 0.0f;  ///< recent changes of the switch, see SupervisorConfig::contact_changes_max
  bool last_reading = false;     ///< of the switch, on the last tick
  bool landing = false;          ///< the robot has lost its switch and has not landed yet
  std::uint32_t landing_ticks = 0,  ///< since the landing began
      still_ticks = 0;              ///< in a row: the body is still, with the toe on the ground
  float closed_in_air_s = 0.0f;     ///< see SupervisorConfig::toe_clear_m
  std::uint32_t astray_ticks = 0;   ///< in a row: the leg is off its path
  std::uint32_t pushing_ticks = 0,  ///< in a row: the motor pushes the leg straight
      falls = 0;                    ///< spans in a row with too fast a fold
  float pushed_from_mps = 0.0f;     ///< rate of the leg's length at the beginning of the span
  float least_travel_m = 0.0f;      ///< smallest travel of the cable since the robot rests
};

/// Whether both other signals contradict the switch: the force on the toe from the contact observer, and the height
/// of the toe `toe_m` from height and leg. Where these two do not agree, the wrong one cannot be identified.
inline bool switch_is_alone(const SupervisorConfig& config, const Observation& seen, float toe_m,
                            float dt_s) {
  if (!seen.observer_trusted || static_cast<float>(seen.observed_ticks) * dt_s < config.implausible_closed_s)
    return false;
  return seen.observed_contact ? toe_m <= config.height_mismatch_m && toe_m >= -config.height_mismatch_m
                               : toe_m > config.contact_margin_m;
}

/// Whether the leg has folded for falls_max spans as it does only where the motor, which is to push, folds it.
inline bool is_pushed_wrong_way(const SupervisorConfig& config, SupervisorState& state,
                                const Observation& seen, float dt_s) {
  constexpr std::uint32_t kSpanTicks = 5;
  if (!seen.pushes) {
    state.pushing_ticks = state.falls = 0;
    return false;
  }
  if (state.pushing_ticks % kSpanTicks == 0) {
    const float least_mps = state.pushed_from_mps - config.fall_margin_mps -
                            config.fall_share * seen.gravity_mps2 * dt_s * static_cast<float>(kSpanTicks);
    state.falls = state.pushing_ticks != 0 && seen.leg_rate_mps < least_mps ? state.falls + 1 : 0;
    state.pushed_from_mps = seen.leg_rate_mps;
  }
  ++state.pushing_ticks;
  return state.falls >= config.falls_max;
}

/// The fault of rail, leg and switch on this tick alone, or none. Counts how long the switch has been closed, how long
/// implausible, and how often it changes.
inline Fault find_body_fault(const SupervisorConfig& config, SupervisorState& state, const Observation& seen,
                             float dt_s) {
  if (!is_finite(seen.height_m) || !is_finite(seen.leg_angle_rad)) return Fault::non_finite_input;
  if (seen.height_m < config.height_min_m || seen.height_m > config.height_max_m)
    return Fault::height_out_of_range;
  if (seen.leg_angle_rad < config.leg_angle_min_rad || seen.leg_angle_rad > config.leg_angle_max_rad ||
      seen.leg_angle_rad > seen.leg_angle_ceiling_rad)
    return Fault::leg_angle_out_of_range;
  const float step_max_m =
      config.speed_max_mps * dt_s * static_cast<float>(seen.step_ticks) + config.step_margin_m;
  if (seen.height_step_m > step_max_m || seen.height_step_m < -step_max_m) return Fault::encoder_jump;
  const float mismatch_m = seen.height_m - seen.leg_height_m;
  // How much shorter the leg is than at touch-down.
  const float leg_flexed_m = mismatch_m - seen.above_touchdown_m;
  // A toe that has just come down may still be on its way.
  if (!seen.contact_reading) state.closed_ticks = 0;
  if (seen.contact_reading && state.closed_ticks != 0xffffffffu) ++state.closed_ticks;
  const bool toe_on_ground = static_cast<float>(state.closed_ticks) * dt_s > config.implausible_closed_s &&
                             leg_flexed_m > config.flexed_leg_m;
  if (mismatch_m < -config.height_mismatch_m) return Fault::encoder_implausible;
  // Whether it is the switch that is wrong where it contradicts height and leg.
  const bool alone = !state.landing && switch_is_alone(config, seen, mismatch_m, dt_s);
  if (toe_on_ground && mismatch_m > config.height_mismatch_m)
    return alone && !seen.observed_contact ? Fault::contact_switch_lost : Fault::encoder_implausible;

  // A leg that is folded in flight lets the body come lower than at touch-down with the toe in the air.
  const bool implausible = seen.contact_reading ? seen.above_touchdown_m > config.contact_margin_m
                                                : seen.above_touchdown_m < -config.contact_margin_m &&
                                                      mismatch_m < config.contact_margin_m;
  state.implausible_contact_ticks = implausible ? state.implausible_contact_ticks + 1 : 0;
  if (static_cast<float>(state.implausible_contact_ticks) * dt_s >
      (seen.contact_reading ? config.implausible_closed_s : config.implausible_open_s))
    return alone && seen.observed_contact != seen.contact_reading ? Fault::contact_switch_lost
                                                                  : Fault::contact_implausible;
  const bool in_air = mismatch_m > config.toe_clear_m && leg_flexed_m > config.flexed_leg_m;
  state.closed_in_air_s += seen.contact_reading && in_air ? dt_s : -config.closed_fades * dt_s;
  if (state.closed_in_air_s < 0.0f) state.closed_in_air_s = 0.0f;
  if (state.closed_in_air_s > config.implausible_closed_s)
    return alone && !seen.observed_contact ? Fault::contact_switch_lost : Fault::contact_implausible;
  state.contact_changes -= config.contact_changes_per_s * dt_s;
  if (state.contact_changes < 0.0f) state.contact_changes = 0.0f;
  if (seen.contact_reading != state.last_reading) state.contact_changes += 1.0f;
  state.last_reading = seen.contact_reading;
  if (state.contact_changes > config.contact_changes_max)
    return alone ? Fault::contact_switch_lost : Fault::contact_implausible;
  // A leg that bears the body is detected before it is 3 cm short.
  state.open_ticks = seen.contact_reading ? 0 : state.open_ticks + 1;
  const std::uint32_t borne_ticks =
      state.open_ticks < seen.observed_ticks ? state.open_ticks : seen.observed_ticks;
  if (alone && seen.runs && seen.observed_contact &&
      static_cast<float>(borne_ticks) * dt_s > config.implausible_open_s)
    return Fault::contact_switch_lost;
  const float off_path_m = seen.leg_fold_m - seen.leg_path_m;
  const bool stays = seen.leg_path_m > config.leg_way_m && 3.0f * seen.leg_fold_m < seen.leg_path_m;
  const bool astray = stays || off_path_m > config.leg_error_m || off_path_m < -config.leg_error_m;
  state.astray_ticks = astray ? state.astray_ticks + 1 : 0;
  if (static_cast<float>(state.astray_ticks) * dt_s > config.leg_astray_s) return Fault::leg_astray;
  if (is_pushed_wrong_way(config, state, seen, dt_s)) return Fault::leg_astray;
  // Within a tooth's pitch a caught cable has its play.
  const bool rests = seen.rests && static_cast<float>(state.closed_ticks) * dt_s > config.spring_rests_s;
  if (!rests || seen.cable_travel_m < state.least_travel_m) state.least_travel_m = seen.cable_travel_m;
  if (seen.cable_travel_m > state.least_travel_m + seen.tooth_pitch_m && rests) return Fault::spring_loose;
  return Fault::none;
}

/// The fault of this tick alone, or none; of several the first that is looked for.
inline Fault find_fault(const SupervisorConfig& config, SupervisorState& state, const Observation& seen,
                        float dt_s) {
  if (seen.tick_interval_us > config.tick_interval_max_us) return Fault::late_tick;
  if (seen.reported_fault != 0)
    return seen.reported_fault < kFaultCount ? static_cast<Fault>(seen.reported_fault) : Fault::peer_lost;
  if (seen.missed_samples > config.missed_samples_max) return Fault::peer_lost;
  if (seen.sample_age_us > config.sample_age_max_us) return Fault::stale_input;
  if (seen.has_body) {
    const Fault found = find_body_fault(config, state, seen, dt_s);
    if (found != Fault::none) return found;
  }
  if (seen.cable_travel_m < config.cable_travel_min_m || seen.cable_travel_m > config.cable_travel_max_m)
    return Fault::cable_implausible;
  if (seen.missed_catches >= config.missed_catches_max) return Fault::clutch_not_caught;
  if (seen.envelope != Fault::none) return seen.envelope;
  return Fault::none;
}

/// One tick of a landing without the switch. @returns whether it is over.
inline bool has_landed(const SupervisorConfig& config, SupervisorState& state, const Observation& seen,
                       float dt_s) {
  const bool still = seen.observed_contact && seen.velocity_mps < config.kLanded_mps &&
                     seen.velocity_mps > -config.kLanded_mps;
  state.still_ticks = still ? state.still_ticks + 1 : 0;
  ++state.landing_ticks;
  return !seen.runs || static_cast<float>(state.still_ticks) * dt_s > config.kLanded_s ||
         static_cast<float>(state.landing_ticks) * dt_s > config.kLongestLanding_s;
}

/// One tick, `dt_s` after the last. A robot that runs and loses its switch lands first (`landing` in the state),
/// through a reset as well; then contact_switch_lost latches. `reset` clears a latched fault; one that is still there
/// latches again at once. @returns the latched fault.
inline Fault supervise(const SupervisorConfig& config, SupervisorState& state, const Observation& seen,
                       bool reset, float dt_s) {
  if (reset && !state.landing) state = {};
  Fault found = find_fault(config, state, seen, dt_s);
  if (found == Fault::contact_switch_lost) {
    state.landing = state.fault == Fault::none;
    state.contact_changes = 0.0f;
    state.implausible_contact_ticks = 0;
    found = Fault::none;
  }
  if (state.landing && found == Fault::none && has_landed(config, state, seen, dt_s))
    found = Fault::contact_switch_lost;
  if (found != Fault::none) state.landing = false;
  if (state.fault == Fault::none) state.fault = found;
  return state.fault;
}

}  // namespace furcula::control
