// Watches inputs and timing. A fault latches until an explicit reset; while it stands the controller is in
// its safe state: torque 0, coil off.
#pragma once

#include <cstdint>

#include "furcula/control/fault.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

struct SupervisorConfig {
  std::uint32_t tick_interval_max_us = 1500;
  std::uint32_t sample_age_max_us = 1500;
  std::uint32_t missed_samples_max = 1;  ///< running; one lost frame is bridged with the last sample
  float height_min_m = 0.03f;            ///< the rail's ends
  float height_max_m = 1.5f;
  float leg_angle_min_rad = 0.30f;  ///< the leg's stops, and a little play
  float leg_angle_max_rad = 1.45f;
  /// The leg's height 2 L cos(leg angle) is the body's as long as the toe is on the ground, and can never be
  /// above it. By how much the encoder may contradict that, on uneven ground; m.
  float height_mismatch_m = 0.035f;
  /// A leg so much shorter than at touch-down is off its stop: with the switch closed the toe is on the
  /// ground; m.
  float flexed_leg_m = 0.01f;
  /// A switch that reads closed this far above the touch-down height, or open this far below it, is wrong if
  /// it stays so for so long (it reports within 10 ms of the true instant, and bounces; a toe that meets the
  /// ground while the motor folds the leg may hover on it for a while). Only a switch that has been closed
  /// for as long says where the toe is: stretching, it moves by 2.5 cm in 10 ms; m, s.
  float contact_margin_m = 0.03f;
  float implausible_closed_s = 0.02f;
  float implausible_open_s = 0.05f;
  /// A body on the rail is no faster than a fall from its end, sqrt(2 * 9.81 * 1.5); a count that moves
  /// further between two samples has jumped. The margin is for noise and for when exactly the samples were
  /// taken; m/s, m.
  float speed_max_mps = 5.5f;
  float step_margin_m = 0.002f;
  /// The switch bounces for 4 ms after a change, and there are two changes in a stride. So many changes, less
  /// those that a rate explains, are chatter; 1/s.
  float contact_changes_max = 20.0f;
  float contact_changes_per_s = 100.0f;
  /// The clutch's cable, from home; beyond either the encoder has lost its count; m.
  float cable_travel_min_m = -0.003f;
  float cable_travel_max_m = 0.11f;
  std::uint32_t missed_catches_max = 5;  ///< running stances on a spring that was not caught
  /// A toe this far above flat ground touches nothing: the ground is within 3 cm, and the switch reports a
  /// toe that comes down up to 10 ms early. The time that the switch is closed there adds up to
  /// implausible_closed_s, and fades; m, share of the time.
  float toe_clear_m = 0.06f;
  float closed_fades = 0.02f;
  /// In flight the leg is where the motor moves it: within 3 cm of it but for 4 ms, with a drive on a bus and
  /// a toe on ground that the switch has not reported yet, and beyond a third of its way but for 5 ms. A motor
  /// that turns the wrong way leaves it straight or folds it; m, m, s.
  float leg_error_m = 0.04f;
  float leg_way_m = 0.005f;
  float leg_astray_s = 0.008f;
  /// In stance a leg that the motor pushes straight cannot fold faster and faster than a body falls: the
  /// ground does not pull at the toe. In a landing neither, where the motor brakes what folds. It may for one or two spans of 5 ms, where the toe meets the ground
  /// again. Share of gravity, m/s, spans.
  float fall_share = 1.5f;
  float fall_margin_mps = 0.03f;
  std::uint32_t falls_max = 3;
  /// A robot that is not told to run stands on its spring, wherever that is caught, once its switch has been
  /// closed for so long: the key has fallen in by then; s.
  float spring_rests_s = 0.1f;

  /// Without its switch the robot lands. It has landed when it has been slower than this for so long with its
  /// toe on the ground, or after the longest time; m/s, s.
  static constexpr float kLanded_mps = 0.08f, kLanded_s = 0.1f, kLongestLanding_s = 2.0f;
};

/// What the supervisor looks at, gathered by the controller on each tick.
struct Observation {
  std::uint32_t tick_interval_us = 0;  ///< since the last tick
  std::uint32_t reported_fault = 0;    ///< by a device or the board: a number of the table of faults
  std::uint32_t missed_samples = 0;    ///< running
  std::uint32_t sample_age_us = 0;
  bool has_body = true;  ///< false: on the clutch's bench, where there is no more than the cable
  float height_m = 0.0f;
  float above_touchdown_m = 0.0f;  ///< the height less the touch-down height
  /// By which the height's counter moved since the sample before, and so many ticks lie between them.
  float height_step_m = 0.0f;
  std::uint32_t step_ticks = 1;
  float leg_angle_rad = 0.0f;
  float leg_angle_ceiling_rad = 1e9f;  ///< below which leg_angle_max_rad counts
  float leg_height_m = 0.0f;           ///< 2 L cos(leg angle)
  bool contact_reading = false;        ///< of the switch; in a landing without it the observer's
  // Of the contact observer, which knows neither height nor switch (contact_observer.hpp).
  bool observed_contact = false;
  std::uint32_t observed_ticks = 0;  ///< since that has changed
  bool observer_trusted = false;     ///< it has agreed with the switch
  bool runs = false;                 ///< it may move
  float velocity_mps = 0.0f;
  float cable_travel_m = 0.0f;       ///< 0 without a clutch
  std::uint32_t missed_catches = 0;  ///< running
  float leg_fold_m = 0.0f;           ///< in flight, on the last tick; and where the motor was to move it
  float leg_path_m = 0.0f;           ///< both 0 where it moves it nowhere
  bool pushes = false;               ///< in stance the motor was told to push the leg straight
  float leg_rate_mps = 0.0f;         ///< of the leg's length
  float gravity_mps2 = 9.81f;
  bool rests = false;            ///< it has a clutch, and is not told to run: its coil is to be off
  float tooth_pitch_m = 0.0f;    ///< of that clutch
  Fault envelope = Fault::none;  ///< what watch_envelope() found
};

struct SupervisorState {
  Fault fault = Fault::none;       ///< latched: the first since the last reset
  std::uint32_t closed_ticks = 0;  ///< running: the switch reads closed
  std::uint32_t open_ticks = 0;    ///< running: it reads open
  std::uint32_t implausible_contact_ticks = 0;
  float contact_changes = 0.0f;  ///< of late, see SupervisorConfig
  bool last_reading = false;
  bool landing = false;  ///< without its switch, and not yet landed
  std::uint32_t landing_ticks = 0, still_ticks = 0;
  float closed_in_air_s = 0.0f;                ///< see SupervisorConfig::toe_clear_m
  std::uint32_t astray_ticks = 0;              ///< running
  std::uint32_t pushing_ticks = 0, falls = 0;  ///< running; spans of too fast a fold
  float pushed_from_mps = 0.0f;                ///< at the beginning of the span
  float least_travel_m = 0.0f;                 ///< of the cable, since the robot rests
};

/// Whether two of three witnesses say that the switch is wrong: the force on the toe, as the leg shows it, and
/// the toe's height, as height and leg show it. Where these two do not agree, nobody knows who is wrong.
inline bool switch_is_alone(const SupervisorConfig& config, const Observation& seen, float toe_m,
                            float dt_s) {
  if (!seen.observer_trusted || static_cast<float>(seen.observed_ticks) * dt_s < config.implausible_closed_s)
    return false;
  return seen.observed_contact ? toe_m <= config.height_mismatch_m && toe_m >= -config.height_mismatch_m
                               : toe_m > config.contact_margin_m;
}

/// Whether the leg folds for falls_max spans as it does only where the motor folds it, who is to push.
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

/// Of rail, leg and switch: the fault of this tick alone, or none. Counts how long the switch has been
/// closed, how long implausible, and how often it changes.
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
  // Whose fault it is that the switch contradicts height and leg.
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
  // A leg that bears the body is seen before it is 3 cm short.
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

/// The fault of this tick alone, or none.
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

/// One tick. A switch that is lost brings a robot that runs to land first (`landing` in the state), and is the
/// fault when it has; it goes on through a reset. `reset` clears a latched fault; one that is still there latches again at once.
/// @returns the latched fault.
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
