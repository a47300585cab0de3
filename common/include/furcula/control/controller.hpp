// The controller: a pure step from what the board measured to what the drive is told. No clock, no I/O, no
// globals, no heap; the same bits on the target and on the host.
#pragma once

#include <cstdint>

#include "furcula/control/check.hpp"
#include "furcula/control/config.hpp"
#include "furcula/control/sample.hpp"
#include "furcula/core/count.hpp"
#include "furcula/core/sine.hpp"
#include "furcula/core/status.hpp"

namespace furcula::control {

/// What the controller gets in a tick.
struct Inputs {
  Sample sample;                       ///< of sensors and drive; not read where `sample_valid` is false
  bool sample_valid = false;           ///< false: sensors or drive did not answer since the last tick
  bool reset = false;                  ///< a person asks for the latched fault to be cleared
  bool run = true;                     ///< false: measures and watches, and commands the safe state
  std::uint32_t tick_interval_us = 0;  ///< measured, since the last tick
};

/// Made by begin(); a State that was not is in the fault bad_configuration.
struct State {
  Status configuration = Status::invalid;  ///< the result of check()
  HeightState height;                      ///< of estimate_height()
  DebounceState debounce;                  ///< of debounce()
  PhaseState phase;                        ///< of estimate_phase()
  LimitsState limits;                      ///< of limit_torque()
  SupervisorState supervisor;              ///< of supervise(); holds the latched fault
  EnvelopeState envelope;                  ///< of watch_envelope() and hold_back()
  std::uint32_t longer_leg_ticks = 0;  ///< of watch_leg(): ticks in succession with a leg that is too long
  ClutchState clutch;                  ///< of sequence_clutch()
  CoilState coil;                      ///< of drive_coil()
  LegPositionState leg;                ///< of follow_path()
  float leg_fold_m = 0.0f,        ///< the leg's fold in the last tick; 0 unless the motor moved it in flight
      leg_path_m = 0.0f;          ///< target of `leg_fold_m`; 0 unless the motor moved the leg in flight
  BenchState bench;               ///< of run_trial()
  ContactObserverState observer;  ///< of observe_contact()
  RedundantSensorState
      redundant_sensor;              ///< of compare_redundant_sensors(): whether the observer can be trusted
  Sample last_sample;                ///< the last valid one, with the age that it has by now
  std::uint32_t missed_samples = 1;  ///< running; nothing was ever measured
};

/// What the controller commands and estimates in a tick.
struct Outputs {
  Command command;        ///< for drive and coil; by default that of the safe state
  HeightEstimate height;  ///< of the body; default on the clutch's bench
  PhaseEstimate phase;    ///< stance or flight; default on the clutch's bench
  ClutchEstimate
      clutch;  ///< default in a fault, while the robot does not run, and where no leg moves in flight
  TrialEstimate trial;        ///< default unless on the clutch's bench
  ContactEstimate contact;    ///< by the contact observer; `force_n` is 0 in a tick without a valid sample
  bool landing = false;       ///< the contact switch is lost: the robot lands by the contact observer
  Fault fault = Fault::none;  ///< that the supervisor has latched, or bad_configuration
};

/// A torque of the motor that stretches the leg, and no rounding of zero.
inline constexpr float kPushNm = 0.1f;

/// Height of the hip with the toe on the ground, 2 L cos(leg angle); cos as a sine a quarter turn on.
inline float leg_height_m(float link_length_m, float leg_angle_rad) {
  return 2.0f * link_length_m * sine_of_turns(leg_angle_rad * 0.159154943f + 0.25f);
}

/// The state before the first tick.
inline State begin(const Config& config) {
  State state;
  state.configuration = check(config);
  state.clutch = begin_clutch(config.clutch);
  return state;
}

/// Takes a tick's sample. @returns what the supervisor looks at, as far as the sample's arrival tells it.
inline Observation take_sample(const Config& config, State& state, const Inputs& inputs) {
  // One lost sample is bridged with the last one; what it measures is then one tick older.
  Observation seen;
  seen.step_ticks = state.missed_samples + 1;
  if (inputs.sample_valid) {
    // Counted from the start, not from home, which a person may set anew. Before the first tick there is
    // none.
    if (state.height.filled > 0)
      seen.height_step_m =
          static_cast<float>(count_difference(inputs.sample.height_count, state.last_sample.height_count)) *
          config.height.metres_per_count;
    state.last_sample = inputs.sample;
    state.missed_samples = 0;
  } else {
    state.last_sample.age_us += inputs.tick_interval_us;
    if (state.missed_samples != 0xffffffffu) ++state.missed_samples;
  }
  seen.tick_interval_us = inputs.tick_interval_us;
  seen.reported_fault = state.last_sample.reported_fault;
  seen.missed_samples = state.missed_samples;
  seen.sample_age_us = state.last_sample.age_us;
  return seen;
}

/// What the envelope sees of a tick.
inline EnvelopeView look_at(const Config& config, const HeightEstimate& height, const Sample& sample,
                            float leg_m, float cable_travel_m) {
  EnvelopeView view;
  view.height_m = height.height_m;
  view.velocity_mps = height.velocity_mps;
  view.leg_angle_rad = sample.leg_angle_rad;
  view.leg_m = leg_m;
  view.lever_m = leg_lever_m(config.link_length_m, sample.leg_angle_rad);
  view.touchdown_height_m = config.phase.touchdown_height_m;
  view.contact_reading = sample.contact != 0;
  // The spring of a robot that does not move its leg in flight is not known.
  if (moves_leg_in_flight(config.clutch) && cable_travel_m < config.clutch.tooth_pitch_m) {
    view.spring_npm = config.clutch.spring_npm;
    view.spring_rest_m = config.clutch.spring_rest_m;
  }
  return view;
}

/// The tick of a board on the clutch's bench: to run is to make one trial.
inline Outputs step_on_bench(const Config& config, State& state, const Inputs& inputs, float dt_s) {
  Observation seen = take_sample(config, state, inputs);
  const Sample& sample = state.last_sample;
  seen.has_body = false;
  seen.cable_travel_m = static_cast<float>(count_difference(sample.cable_count, sample.cable_home_count)) *
                        config.clutch.metres_per_count;
  if (inputs.run && state.missed_samples == 0) seen.envelope = watch_bench(state.envelope, sample);
  Outputs out;
  out.fault = state.configuration == Status::ok
                  ? supervise(config.supervisor, state.supervisor, seen, inputs.reset, dt_s)
                  : Fault::bad_configuration;
  if (out.fault != Fault::none || !inputs.run) {
    state.bench = {};
    state.envelope = {};
  } else
    out.trial = run_trial(config.bench, state.bench);
  out.command.coil_duty = drive_coil(config.coil, state.coil, out.trial.coil, dt_s);
  return out;
}

/// The tick of a robot.
inline Outputs step_robot(const Config& config, State& state, const Inputs& inputs, float dt_s) {
  Observation seen = take_sample(config, state, inputs);
  const Sample& sample = state.last_sample;
  Outputs out;
  out.height =
      estimate_height(config.height, state.height, count_difference(sample.height_count, sample.home_count),
                      sample.home_height_m, dt_s);
  const float leg_m = leg_height_m(config.link_length_m, sample.leg_angle_rad);
  const float lever_m = leg_lever_m(config.link_length_m, sample.leg_angle_rad);
  const float straight_m = config.phase.touchdown_height_m;
  const std::int32_t cable_count = count_difference(sample.cable_count, sample.cable_home_count);
  if (config.clutch.fitted != 0)
    seen.cable_travel_m = static_cast<float>(cable_count) * config.clutch.metres_per_count;
  const LegView leg{sample.leg_angle_rad,
                    leg_m,
                    lever_m,
                    straight_m,
                    config.leg.inertia_kgm2,
                    state.limits.last_nm,
                    spring_pull_n(config.clutch, leg_m, seen.cable_travel_m),
                    sample.age_us};
  // Of a sample that is bridged nothing is new; after a longer silence it begins anew.
  if (seen.step_ticks > 2) state.observer = {};
  if (inputs.sample_valid)
    out.contact =
        observe_contact(config.observer, state.observer, leg, dt_s * static_cast<float>(seen.step_ticks));
  else
    out.contact.contact = state.observer.contact;
  note_observer(state.redundant_sensor, out.contact.contact);
  // Without its switch the robot lands by the observer.
  const bool lands = state.supervisor.landing;
  const bool reading = lands ? out.contact.contact : sample.contact != 0;
  const bool closed = debounce(config.debounce, state.debounce, reading, dt_s) || (lands && reading);
  if (inputs.run && !lands && state.supervisor.fault == Fault::none)
    compare_redundant_sensors(state.redundant_sensor, closed, dt_s);
  out.phase = estimate_phase(config.phase, state.phase, closed, out.height, leg_m, dt_s);
  if (inputs.reset && state.supervisor.fault != Fault::none)
    restart_clutch(state.clutch, config.clutch, cable_count);

  seen.height_m = out.height.height_m;
  seen.above_touchdown_m = out.height.height_m - config.phase.touchdown_height_m;
  seen.leg_angle_rad = sample.leg_angle_rad;
  seen.leg_angle_ceiling_rad = config.envelope.leg_angle_max_rad - config.envelope.late_angle_rad;
  seen.leg_height_m = leg_m;
  seen.contact_reading = reading;
  seen.observed_contact = state.redundant_sensor.contact;
  seen.observed_ticks = state.redundant_sensor.ticks;
  seen.observer_trusted = state.redundant_sensor.agreements >= kAgreementsLeast;
  seen.runs = inputs.run;
  seen.velocity_mps = out.height.velocity_mps;
  seen.missed_catches = state.clutch.missed_running;
  seen.leg_fold_m = state.leg_fold_m;
  seen.leg_path_m = state.leg_path_m;
  state.leg_fold_m = state.leg_path_m = 0.0f;
  seen.pushes = state.limits.last_nm < -kPushNm && out.phase.phase == Phase::stance;
  seen.leg_rate_mps = lever_m * (state.leg.angle_before_rad - sample.leg_angle_rad) / (2.0f * dt_s);
  seen.gravity_mps2 = config.gravity_mps2;
  seen.rests = config.clutch.fitted != 0 && !inputs.run;
  seen.tooth_pitch_m = config.clutch.tooth_pitch_m;
  EnvelopeView view_of_envelope = look_at(config, out.height, sample, leg_m, seen.cable_travel_m);
  view_of_envelope.contact_reading = reading;
  seen.envelope = watch_leg(config.envelope, state.longer_leg_ticks, view_of_envelope);
  if (inputs.run) {
    const Fault found = watch_envelope(config.envelope, state.envelope, view_of_envelope, dt_s);
    if (found != Fault::none) seen.envelope = found;
  }
  out.fault = state.configuration == Status::ok
                  ? supervise(config.supervisor, state.supervisor, seen, inputs.reset, dt_s)
                  : Fault::bad_configuration;
  out.landing = state.supervisor.landing;
  // The command of the safe state is the default one.
  const bool safe = out.fault != Fault::none || !inputs.run;
  if (safe) {
    state.limits = {};
    state.envelope = {};
    abandon(state.clutch);
  } else if (moves_leg_in_flight(config.clutch)) {
    if (out.landing) state.clutch.tried = true;  // what is let go is caught, and nothing is let go any more
    ClutchView view;
    view.phase = out.phase;
    view.time_left_s = time_to_touchdown_s(config.gravity_mps2, out.height, straight_m, dt_s);
    view.leg_fold_m = straight_m - leg_m;
    view.cable_count = cable_count;
    view.coil_ready = !state.coil.blocked;
    out.clutch = sequence_clutch(config.clutch, state.clutch, view, dt_s);
  }
  if (config.clutch.fitted != 0) {
    out.command.coil_duty = drive_coil(config.coil, state.coil, out.clutch.coil, dt_s);
    // Where the coil gave up the key falls in: the sequencer finds the cable caught, or not.
  }
  float torque_nm = out.landing ? brake_torque_nm(state.leg, out.phase, sample.leg_angle_rad, dt_s)
                                : profile_torque_nm(config.torque, out.phase, out.height.velocity_mps, dt_s);
  if (out.clutch.drives_leg) {
    const float fold_m = straight_m - leg_m;
    // Stretched, the leg rests on its stop, and the spring helps. What it pulls with follows from where the leg is to
    // be, not from where it is: of a rate that is wrong by more than the leg's own stiffness that would make a runaway.
    const float path_m = straight_m - out.clutch.path.fold_m;
    const float pull_n =
        out.clutch.path.fold_m > 0.0f ? spring_pull_n(config.clutch, path_m, out.clutch.travel_m) : 0.0f;
    if (!safe && !out.landing && out.phase.phase == Phase::flight) {
      state.leg_fold_m = fold_m;
      state.leg_path_m = out.clutch.path.fold_m;
    }
    torque_nm = follow_path(config.leg, state.leg, out.clutch.path, fold_m, sample.leg_angle_rad, lever_m,
                            pull_n, dt_s);
  } else if (config.clutch.fitted != 0 && out.phase.phase == Phase::stance) {
    torque_nm -= lever_m * lost_push_n(config.clutch, leg_m, out.clutch.travel_m);
  }
  note_angle(state.leg, sample.leg_angle_rad);
  if (!safe) {
    const float limited_nm = limit_torque(config.limits, state.limits, torque_nm, dt_s);
    out.command.torque_nm =
        hold_back(config.envelope, state.envelope, view_of_envelope, out.clutch.drives_leg, limited_nm);
    // A leg whose motor is held back need not be where it is moved.
    if (out.command.torque_nm != limited_nm) state.leg_fold_m = state.leg_path_m = 0.0f;
    state.limits.last_nm = out.command.torque_nm;
  }
  return out;
}

/// One tick, `dt_s` after the last (the nominal period: that a tick was late is an input).
inline Outputs step(const Config& config, State& state, const Inputs& inputs, float dt_s) {
  // A function each: the outputs are then written where they go, not copied there.
  return config.bench.on_bench != 0 ? step_on_bench(config, state, inputs, dt_s)
                                    : step_robot(config, state, inputs, dt_s);
}

}  // namespace furcula::control
