// Plays a gait of a planar leg: a pure step from what the board measured to the torques of hip and knee, with the
// feedback that keeps the gait and the faults of its sensors. No clock, no I/O, no globals, no heap.
#pragma once

#include <cstdint>
#include <type_traits>

#include "furcula/control/fault.hpp"
#include "furcula/control/gait_config.hpp"
#include "furcula/control/gait_phase.hpp"

namespace furcula::control {

/// What a board measures. Angles and rates come from the joints' drives, the height from the boom's encoder.
struct GaitSample {
  float height_m = 0.0f;             ///< of the hip above the ground; NaN as long as the encoder is not homed
  JointPair angle_rad,               ///< joint angles
      rate_radps;                    ///< joint rates
  std::uint32_t age_us = 0;          ///< time since the sensors were read
  std::uint32_t contact = 0;         ///< raw switch: 0 open, 1 closed
  std::uint32_t reported_fault = 0;  ///< that a device or the board reports: a control::Fault, 0 none
};
static_assert(sizeof(GaitSample) == 32 && std::is_trivially_copyable_v<GaitSample>, "it travels as bytes");

/// Inputs of one tick.
struct GaitInputs {
  GaitSample sample;                   ///< counts if sample_valid
  bool sample_valid = false;           ///< false: no new sample since the last tick
  bool reset = false;                  ///< a person asks for the latched fault to be cleared
  bool run = true;                     ///< false: measures, and gives no torque
  std::uint32_t tick_interval_us = 0;  ///< measured, since the last tick
};

/// Made by begin_gait(); one that was not is in the fault bad_configuration.
struct GaitState {
  Status configuration = Status::invalid;  ///< result of check()
  Fault fault = Fault::none;               ///< latched until a reset
  GaitPhaseState phase;                    ///< begins anew while the gait is not played
  GaitSample last_sample;                  ///< the last one; angles go on at their rates where one is missed
  std::uint32_t missed_samples = 1;        ///< in a row
  std::uint32_t samples = 0;               ///< 0: nothing was ever measured; else 1
  float closed_s = 0.0f,                   ///< how long the switch has been implausibly closed
      open_s = 0.0f,                       ///< how long the switch has been implausibly open
      astray_s = 0.0f;                     ///< how long a joint in flight has been off its path
};

/// Result of one tick.
struct GaitOutputs {
  JointPair torque_nm;        ///< to the drives; zero in the safe state
  GaitPhaseEstimate phase;    ///< `ready` while the gait is not played
  float toe_m = 0.0f;         ///< height of the toe above the ground
  Fault fault = Fault::none;  ///< latched
};

/// State before the first tick.
inline GaitState begin_gait(const GaitConfig& config) {
  GaitState state;
  state.configuration = check(config);
  return state;
}

namespace detail {

inline float size(float x) { return x < 0.0f ? -x : x; }
inline float within(float most, float x) { return x > most ? most : x < -most ? -most : x; }
inline bool inside(const JointPair& least, const JointPair& x, const JointPair& most) {
  return least.hip <= x.hip && x.hip <= most.hip && least.knee <= x.knee && x.knee <= most.knee;
}

/// Of the gains. In stance it grows as the ground's force: where that carries little yet, a torque against a deviation
/// would lift the toe. A leg that falls yields close to the ground.
inline float share_of_gains(const GaitConfig& c, const GaitOutputs& out) {
  const float time_s = out.phase.since_s;
  float share = 1.0f;
  if (out.phase.phase == GaitPhase::stance) share = time_s / c.stance_ramp_s;
  if (out.phase.phase == GaitPhase::fall) share = (out.toe_m - c.yields_m) / (c.yields_from_m - c.yields_m);
  return share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
}

inline bool is_finite_sample(const GaitSample& s) {
  for (const float x : {s.height_m, s.angle_rad.hip, s.angle_rad.knee, s.rate_radps.hip, s.rate_radps.knee})
    if (!is_finite(x)) return false;
  return true;
}

/// What a sample tells by itself, and against the one before it, `step_s` ago (0: there is none).
inline Fault find_fault_of_sample(const GaitConfig& c, const GaitSample& now, const GaitSample& before,
                                  float step_s) {
  if (!is_finite_sample(now)) return Fault::non_finite_input;
  if (step_s > 0.0f) {
    const float turn = c.rate_max_radps * step_s;
    if (size(now.height_m - before.height_m) > c.speed_max_mps * step_s ||
        size(now.angle_rad.hip - before.angle_rad.hip) > turn ||
        size(now.angle_rad.knee - before.angle_rad.knee) > turn)
      return Fault::encoder_jump;
  }
  if (now.height_m < c.height_min_m || now.height_m > c.height_max_m) return Fault::height_out_of_range;
  if (!inside(c.least_rad, now.angle_rad, c.most_rad)) return Fault::leg_angle_out_of_range;
  return Fault::none;
}

/// What switch, boom and leg tell together. Times count up while something cannot be.
inline Fault find_contradiction(const GaitConfig& c, GaitState& s, const GaitOutputs& out, float off_rad,
                                float dt_s) {
  const auto lasts = [dt_s](float& time_s, bool holds) {
    time_s = holds ? time_s + dt_s : 0.0f;
    return time_s;
  };
  const bool stance = out.phase.phase == GaitPhase::stance;
  // Boom and leg: the toe is on the ground in stance, and never below it.
  if ((stance && out.phase.closed && out.toe_m > c.toe_mismatch_m) || out.toe_m < -c.toe_mismatch_m)
    return Fault::encoder_implausible;
  const bool high = out.toe_m > c.ground_m;
  if (lasts(s.closed_s, out.phase.closed && high && !stance) > c.implausible_closed_s)
    return Fault::contact_implausible;
  const bool falls = out.phase.phase == GaitPhase::fall && !out.phase.closed;
  if (lasts(s.open_s, falls && out.toe_m < c.toe_low_m) > c.implausible_open_s)
    return Fault::contact_implausible;
  const bool flies = out.phase.phase == GaitPhase::fall || out.phase.phase == GaitPhase::rise;
  if (lasts(s.astray_s, flies && off_rad > c.astray_rad) > c.astray_s) return Fault::leg_astray;
  return Fault::none;
}

}  // namespace detail

/// One tick, `dt_s` after the last (the nominal period: that a tick was late is an input). Does not block; what fails
/// is `GaitOutputs::fault`, which stays until a reset.
inline GaitOutputs step_gait(const GaitConfig& c, GaitState& s, const GaitInputs& in, float dt_s) {
  GaitOutputs out;
  Fault found = Fault::none;
  if (in.reset) s.fault = Fault::none;
  if (in.tick_interval_us > c.tick_interval_max_us) found = Fault::late_tick;
  if (in.sample_valid) {
    const float step_s = s.samples > 0 ? dt_s * static_cast<float>(s.missed_samples + 1) : 0.0f;
    const Fault told = in.sample.reported_fault < kFaultCount ? static_cast<Fault>(in.sample.reported_fault)
                                                              : Fault::drive_fault;
    if (found == Fault::none) found = told;
    if (found == Fault::none && in.sample.age_us > c.sample_age_max_us) found = Fault::stale_input;
    if (found == Fault::none) found = detail::find_fault_of_sample(c, in.sample, s.last_sample, step_s);
    // What is no number is not kept, whatever fault the tick has: a missed sample is bridged from the one that is.
    if (detail::is_finite_sample(in.sample)) {
      s.last_sample = in.sample;
      s.samples = 1;
    }
    s.missed_samples = 0;
  } else {
    // One that is lost is bridged: the leg went on at its rates.
    if (s.missed_samples != 0xffffffffu) ++s.missed_samples;
    s.last_sample.angle_rad.hip += dt_s * s.last_sample.rate_radps.hip;
    s.last_sample.angle_rad.knee += dt_s * s.last_sample.rate_radps.knee;
    if (found == Fault::none && (s.missed_samples > c.missed_samples_max || s.samples == 0))
      found = Fault::peer_lost;
  }
  const GaitSample& now = s.last_sample;
  const bool runs = in.run && s.fault == Fault::none && found == Fault::none;
  if (!runs) s.phase = {};
  out.toe_m = now.height_m + toe_below_hip_m(c, now.angle_rad);
  out.phase =
      estimate_gait_phase(c, s.phase, {now.height_m, out.toe_m, now.rate_radps, now.contact != 0}, dt_s);

  const bool stance = out.phase.phase == GaitPhase::stance;
  const GaitPath& path = stance ? c.stance : out.phase.phase == GaitPhase::rise ? c.rise : c.fall;
  const bool ready = out.phase.phase == GaitPhase::ready;
  const float time_s = ready ? 0.0f : out.phase.since_s;
  const GaitKnot wanted = motion_at(path, time_s);
  const JointPair off{wanted.angle.hip - now.angle_rad.hip, wanted.angle.knee - now.angle_rad.knee};
  if (runs) {
    const float most =
        detail::size(off.hip) > detail::size(off.knee) ? detail::size(off.hip) : detail::size(off.knee);
    found = detail::find_contradiction(c, s, out, most, dt_s);
  } else {
    s.closed_s = s.open_s = s.astray_s = 0.0f;
  }
  if (s.fault == Fault::none) s.fault = found;
  if (s.configuration != Status::ok) s.fault = Fault::bad_configuration;
  out.fault = s.fault;
  if (!runs || s.fault != Fault::none) return out;

  const bool waits = ready || out.phase.bounced;
  const float share = out.phase.bounced ? c.bounced_share : detail::share_of_gains(c, out);
  const bool stands = stance && !out.phase.bounced;
  const float kp = share * (stands ? c.stance_kp_nmprad : c.flight_kp_nmprad);
  const float kd = share * (stands ? c.stance_kd_nmsprad : c.flight_kd_nmsprad);
  JointPair back{kp * off.hip - kd * now.rate_radps.hip, kp * off.knee - kd * now.rate_radps.knee};
  if (!waits) {
    back.hip += kd * wanted.rate.hip;
    back.knee += kd * wanted.rate.knee;
  }
  if (stance)
    back = {detail::within(c.feedback_most_nm, back.hip), detail::within(c.feedback_most_nm, back.knee)};
  // The torque is held over the tick: the gait's own is that of its middle.
  const JointPair own = waits ? JointPair{} : torque_at(path, time_s + 0.5f * dt_s);
  out.torque_nm = {detail::within(c.torque_most_nm.hip, own.hip + back.hip),
                   detail::within(c.torque_most_nm.knee, own.knee + back.knee)};
  return out;
}

}  // namespace furcula::control
