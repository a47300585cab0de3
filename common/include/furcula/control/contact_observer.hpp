// Whether the toe is on the ground, told without switch and height: a momentum observer about the hip
// (A. De Luca, R. Mattone: Actuator failure detection and isolation using generalized momenta, ICRA 2003).
// The leg's angular momentum changes by what the motor, the spring and the damper do to it; what is left is
// the ground's push on the toe, or the stop's on a straight leg.
#pragma once

#include <cstdint>

#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Values of the contact observer.
struct ContactObserverConfig {
  float leg_damping_nspm = 4.0f;   ///< along the leg; of a stance, less the guide's
  float touchdown_force_n = 7.0f;  ///< beyond it the toe is on the ground

  static constexpr float kLiftoffForce_n = 1.0f;  ///< below it the toe is off the ground
  /// Rate at which the estimate follows the torque from outside; below 1/dt; 1/s.
  static constexpr float kRate_ps = 250.0f;
  // What the motor's torque does to the leg is known only as well as the leg's inertia.
  static constexpr float kEffortShare = 0.2f,  ///< of the motor's recent torque, added to the threshold
      kEffortForgotten_ps = 100.0f;            ///< rate at which the recent torque decays, 1/s
  static constexpr float kOffStop_m = 0.001f;  ///< a leg that is shorter by less is on its stop
  // The stop is where the leg was longest: the links may be longer or shorter than configured.
  static constexpr float kStopForgotten_mps = 0.002f,  ///< rate at which the greatest length decreases
      kStopTolerance_m = 0.008f;                       ///< by which it may be less than the configured length
  static constexpr std::uint32_t kLateAge_us = 500;    ///< an older sample has the angle of the tick before
};

/// What one tick sees.
struct LegView {
  float angle_rad = 0.0f;     ///< of the leg, from the vertical on the motor's side; greater when flexed
  float length_m = 0.0f;      ///< from hip to toe; not finite: the observer begins anew
  float lever_m = 0.0f;       ///< -d(length)/d(angle), m/rad
  float straight_m = 0.0f;    ///< the length on the stop, as configured
  float inertia_kgm2 = 0.0f;  ///< about the hip, toe in the air
  float torque_nm = 0.0f;     ///< of the motor since the last tick; positive flexes the leg
  float spring_n = 0.0f;      ///< of the spring along the leg
  std::uint32_t age_us = 0;   ///< of the angle
};

/// State of observe_contact().
struct ContactObserverState {
  bool begun = false;        ///< there was a sample before
  bool contact = false;      ///< the toe is on the ground, as of the last sample
  float angle_rad = 0.0f,    ///< of the leg, in the last sample
      momentum_nms = 0.0f,   ///< of the leg about the hip, in the last sample; N m s, positive flexes the leg
      torque_nm = 0.0f;      ///< of the motor, in the last sample; positive flexes the leg
  float residual_nm = 0.0f;  ///< external torque about the hip (r); positive flexes the leg
  float effort_nm = 0.0f;    ///< decaying maximum of the motor torque's magnitude
  float longest_m = 0.0f;    ///< length taken to be on the stop: the greatest, slowly decaying
};

/// The observer's result.
struct ContactEstimate {
  float force_n = 0.0f;  ///< of the ground along the leg; lower links' weight and inertia are not in it
  bool contact = false;  ///< the toe is on the ground
};

/// One sample, `dt_s` after the last. With I the leg's inertia, l its length, b = -dl/d(angle) its lever:
///   I angle'' = motor - b (spring - damping l') + r,   r = b force (+ what the stop gives)
///   r = K (p - integral of (motor - b (spring - damping l') + r)),   p = I angle'
inline ContactEstimate observe_contact(const ContactObserverConfig& config, ContactObserverState& state,
                                       const LegView& leg, float dt_s) {
  if (!is_finite(leg.length_m) || !is_finite(state.residual_nm)) state = {};
  if (!is_finite(leg.length_m)) return {};
  state.longest_m -= config.kStopForgotten_mps * dt_s;
  const float least_m = leg.straight_m - config.kStopTolerance_m;
  if (state.longest_m < least_m) state.longest_m = least_m;
  if (leg.length_m > state.longest_m) state.longest_m = leg.length_m;
  const bool on_stop = leg.length_m > state.longest_m - config.kOffStop_m;

  const float motor_nm = leg.age_us > config.kLateAge_us ? state.torque_nm : leg.torque_nm;
  state.torque_nm = leg.torque_nm;
  state.effort_nm -= config.kEffortForgotten_ps * dt_s * state.effort_nm;
  if (motor_nm > state.effort_nm) state.effort_nm = motor_nm;
  if (-motor_nm > state.effort_nm) state.effort_nm = -motor_nm;

  const float rate_radps = state.begun ? (leg.angle_rad - state.angle_rad) / dt_s : 0.0f;
  state.angle_rad = leg.angle_rad;
  state.begun = true;
  float momentum_nms = leg.inertia_kgm2 * rate_radps;
  float known_nm =
      motor_nm - leg.lever_m * (leg.spring_n + config.leg_damping_nspm * leg.lever_m * rate_radps);
  // What pulls or moves a straight leg straighter, the stop takes.
  if (on_stop && known_nm < 0.0f) known_nm = 0.0f;
  if (on_stop && momentum_nms < 0.0f) momentum_nms = 0.0f;
  const bool arrives = on_stop && state.momentum_nms < 0.0f;
  state.residual_nm +=
      config.kRate_ps * (momentum_nms - state.momentum_nms - (known_nm + state.residual_nm) * dt_s);
  if (arrives || (on_stop && state.residual_nm < 0.0f)) state.residual_nm = 0.0f;
  state.momentum_nms = momentum_nms;

  const float touchdown_nm = config.touchdown_force_n * leg.lever_m + config.kEffortShare * state.effort_nm;
  if (state.residual_nm > touchdown_nm)
    state.contact = true;
  else if (on_stop || state.residual_nm < config.kLiftoffForce_n * leg.lever_m)
    state.contact = false;
  ContactEstimate out;
  if (leg.lever_m > 0.0f) out.force_n = state.residual_nm / leg.lever_m;
  out.contact = state.contact;
  return out;
}

/// How far the observer can be trusted in the switch's place: as far as it has agreed with it.
inline constexpr std::uint32_t kAgreementsLeast = 4;  ///< changes running, two strides
/// Time after a change of the observer's output within which the switch should follow, s.
inline constexpr float kSwitchFollows_s = 0.025f;
/// Longest time for which both may differ; after it no agreement is left, s.
inline constexpr float kLongestQuarrel_s = 0.1f;

/// Comparison of the contact observer with the contact switch.
struct RedundantSensorState {
  bool contact = false;             ///< the observer's, of this tick
  std::uint32_t ticks = 0;          ///< since the observer's last change
  std::uint32_t quarrel_ticks = 0,  ///< ticks in succession with a switch unlike the settled observer
      agreements = 0;  ///< changes in succession that the switch followed, up to kAgreementsLeast
};

/// One tick of a robot that runs, whose switch is not known to be lost. `closed` is the debounced switch.
inline void compare_redundant_sensors(RedundantSensorState& state, bool closed, float dt_s) {
  const auto settled = static_cast<std::uint32_t>(kSwitchFollows_s / dt_s);
  const bool agree = closed == state.contact;
  if (state.ticks == settled && agree && state.agreements < kAgreementsLeast) ++state.agreements;
  state.quarrel_ticks = agree || state.ticks < settled ? 0 : state.quarrel_ticks + 1;
  if (static_cast<float>(state.quarrel_ticks) * dt_s > kLongestQuarrel_s) state.agreements = 0;
}

/// One tick, before the others: how long the observer has said what it says.
inline void note_observer(RedundantSensorState& state, bool contact) {
  if (contact != state.contact)
    state.ticks = 0;
  else if (state.ticks != 0xffffffffu)
    ++state.ticks;
  state.contact = contact;
}

}  // namespace furcula::control
