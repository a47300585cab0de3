// Joins a link to its motor, to a spring, or to neither, by a pin (document 000, section II): the motor
// tracks the swinging link until their relative rotation is zero, then the pin moves.
#pragma once

#include <cstdint>

#include "furcula/control/leg_position.hpp"
#include "furcula/core/count.hpp"

namespace furcula::control {

/// What the pin joins the link to.
enum class PinMode : std::uint8_t {
  passive,  ///< to nothing
  active,   ///< to the motor
  spring    ///< to the spring
};

/// Encoders, control of the motor, and times of the sequence. Angles and torques are those of the joint.
struct PinClutchConfig {
  float link_rad_per_count = 3.8349519e-4f;   ///< absolute encoder, 14 bit, between body and link
  float rotor_rad_per_count = 9.5873799e-6f;  ///< incremental encoder on the motor, 4096 a turn, gear 160
  // The control of the motor that tracks the link.
  float stiffness_nmprad = 4000.0f;  ///< on the link's angle less the motor's; a quarter of it in to_rest
  float damping_nmspr = 140.0f;      ///< on the link's rate less the motor's
  float inertia_kgm2 = 1.28f;        ///< of rotor and gear
  float friction_nm = 8.0f;          ///< of the gear
  float torque_limit_nm = 200.0f;    ///< largest magnitude
  float observer_radps = 120.0f;  ///< triple pole of the observer of the link's angle, rate and acceleration
  // When the pin may move, and what is too long.
  float aligned_rad = 0.012f;    ///< largest angle between link and motor: play, and a part of the chamfer
  float aligned_radps = 0.15f;   ///< largest relative rate of link and motor
  float aligned_s = 0.010f;      ///< for which both must hold before the pin is inserted
  float tracking_max_s = 1.5f;   ///< longest time of a stage that tracks the link or withdraws the pin
  float pin_max_s = 0.25f;       ///< from the command to the end of the stroke
  float in_place = 0.95f;        ///< share of the stroke from which on the pin is in place
  float fade_s = 0.05f;          ///< in which the motor's torque grows from zero to the joint's command
  float spring_rest_rad = 0.1f;  ///< angle of the link at which the spring's rotator is aligned with it
  float to_rest_s = 0.8f;        ///< that the motor takes to bring the link to that angle
  std::uint32_t tries_max = 3;   ///< failed insertions until a request is refused
};

/// Inputs of one tick.
struct PinClutchView {
  PinMode wanted = PinMode::passive;  ///< the request
  std::uint32_t link_count = 0,       ///< absolute encoder of the link, wraps
      link_zero = 0;                  ///< what it reads where the link hangs down
  std::uint32_t rotor_count = 0,      ///< incremental encoder of the motor, wraps
      rotor_zero = 0;                 ///< what it read when the motor was aligned with a link at zero
  float pin = 0.0f;                   ///< position of the servo: 1 active, 0 middle, -1 spring
  float torque_nm = 0.0f;             ///< command to the joint; acts in active mode
};

/// Stage of the sequence.
enum class PinStage : std::uint8_t {
  passive,         ///< the pin is in neither rotator; the motor is off
  tracking,        ///< the motor follows the link until both are aligned
  inserting,       ///< the pin moves into the motor's rotator, the motor tracks the link
  active,          ///< the pin is in the motor's rotator
  unloading,       ///< the pin leaves the motor's rotator for the middle, the motor tracks the link
  to_rest,         ///< the motor brings the link to spring_rest_rad
  to_spring,       ///< the pin moves from the motor's rotator into the spring's
  spring,          ///< the pin is in the spring's rotator; the motor is off
  leaving_spring,  ///< the pin leaves the spring's rotator for the middle; the motor is off
  refused          ///< the request failed; the motor is off until the request changes
};

/// State of the sequence between two ticks.
struct PinClutchState {
  PinStage stage = PinStage::passive;      ///< current stage
  PinMode last_wanted = PinMode::passive;  ///< request on the last tick
  bool given_up = false;                   ///< the request failed; until the request changes
  bool begun = false;                      ///< the observer has had a reading
  std::uint32_t ticks_in_stage = 0,        ///< since the stage began; saturates
      ticks_aligned = 0,                   ///< in a row with link and motor aligned
      tries = 0;                           ///< failed insertions of this request
  float angle_rad = 0.0f,                  ///< of the link, observed
      rate_radps = 0.0f,                   ///< of the link, observed
      acceleration_radps2 = 0.0f;          ///< of the link, observed
  float rotor_rad = 0.0f;                  ///< angle of the motor at the joint on the last tick
  float from_rad = 0.0f;                   ///< angle of the link where to_rest began
};

/// Result of one tick.
struct PinClutchOutput {
  float torque_nm = 0.0f;              ///< of the motor, at the joint
  float pin_target = 0.0f;             ///< of the servo: 1 active, 0 middle, -1 spring
  PinStage stage = PinStage::passive;  ///< stage after this tick
  float off_rad = 0.0f,                ///< angle of the link less that of the motor
      off_radps = 0.0f;                ///< rate of the link less that of the motor
};

/// One tick of the sequence; sequence_pin_clutch() runs it.
class PinClutchTick {
 public:
  /// Keeps references to its arguments, which must outlive it. `dt_s` is the time since the last tick, above 0.
  PinClutchTick(const PinClutchConfig& config, PinClutchState& state, const PinClutchView& view, float dt_s)
      : c_(config), s_(state), view_(view), dt_s_(dt_s) {}

  /// Runs the tick and updates the state. To be called once.
  PinClutchOutput run() {
    if (s_.ticks_in_stage != 0xffffffffu) ++s_.ticks_in_stage;
    if (view_.wanted != s_.last_wanted) s_.given_up = false;
    s_.last_wanted = view_.wanted;
    observe();
    const bool aligned = size(off_rad_) <= c_.aligned_rad && size(off_radps_) <= c_.aligned_radps;
    s_.ticks_aligned = aligned ? s_.ticks_aligned + 1 : 0;
    PinClutchOutput out;
    step(out);
    // A torque that is not a number (a configuration with a time of 0) becomes 0.
    out.torque_nm =
        is_finite(out.torque_nm) ? between(-c_.torque_limit_nm, out.torque_nm, c_.torque_limit_nm) : 0.0f;
    out.stage = s_.stage;
    out.off_rad = off_rad_;
    out.off_radps = off_radps_;
    return out;
  }

 private:
  static float size(float x) { return x < 0.0f ? -x : x; }
  static float between(float low, float x, float high) { return x < low ? low : x > high ? high : x; }
  float in_stage_s() const { return static_cast<float>(s_.ticks_in_stage) * dt_s_; }
  void enter(PinStage stage) {
    s_.stage = stage;
    s_.ticks_in_stage = 0;
  }

  void observe() {
    const float link_rad =
        static_cast<float>(count_difference(view_.link_count, view_.link_zero)) * c_.link_rad_per_count;
    const float rotor_rad =
        static_cast<float>(count_difference(view_.rotor_count, view_.rotor_zero)) * c_.rotor_rad_per_count;
    if (!s_.begun) {
      s_.begun = true;
      s_.angle_rad = link_rad;
      s_.rotor_rad = rotor_rad;
    }
    const float p = c_.observer_radps;
    s_.angle_rad += dt_s_ * s_.rate_radps;
    s_.rate_radps += dt_s_ * s_.acceleration_radps2;
    const float error = link_rad - s_.angle_rad;
    s_.angle_rad += 3.0f * p * dt_s_ * error;
    s_.rate_radps += 3.0f * p * p * dt_s_ * error;
    s_.acceleration_radps2 += p * p * p * dt_s_ * error;
    rotor_radps_ = (rotor_rad - s_.rotor_rad) / dt_s_;
    s_.rotor_rad = rotor_rad;
    off_rad_ = s_.angle_rad - rotor_rad;
    off_radps_ = s_.rate_radps - rotor_radps_;
  }

  /// Torque that keeps the motor aligned with the link.
  float track() const {
    const float friction = s_.rate_radps > 0.02f    ? c_.friction_nm
                           : s_.rate_radps < -0.02f ? -c_.friction_nm
                                                    : 0.0f;
    return c_.stiffness_nmprad * off_rad_ + c_.damping_nmspr * off_radps_ +
           c_.inertia_kgm2 * s_.acceleration_radps2 + friction;
  }
  /// Torque that moves the motor, joined to the link, to an angle.
  float hold(float angle_rad, float rate_radps) const {
    return 0.25f * c_.stiffness_nmprad * (angle_rad - s_.angle_rad) +
           c_.damping_nmspr * (rate_radps - rotor_radps_);
  }

  void step(PinClutchOutput& out) {
    switch (s_.stage) {
      case PinStage::refused:
      case PinStage::passive:
        if (s_.given_up) return;
        s_.tries = 0;
        // Also on the way to the spring: the motor brings the link there.
        enter(view_.wanted == PinMode::passive ? PinStage::passive : PinStage::tracking);
        return;
      case PinStage::tracking:
        return follow(out);
      case PinStage::inserting:
        return insert(out);
      case PinStage::active: {
        out.pin_target = 1.0f;
        const float share = between(0.0f, in_stage_s() / c_.fade_s, 1.0f);
        out.torque_nm = share * view_.torque_nm;
        s_.from_rad = s_.angle_rad;
        if (s_.given_up) return;
        if (view_.wanted == PinMode::passive) enter(PinStage::unloading);
        if (view_.wanted == PinMode::spring) enter(PinStage::to_rest);
        return;
      }
      case PinStage::unloading:  // in the middle of its play the pin carries nothing
        out.torque_nm = track();
        if (view_.pin < 0.05f) return enter(PinStage::passive);
        if (in_stage_s() > c_.tracking_max_s) give_up(PinStage::active, out);
        return;
      case PinStage::to_rest:
        return bring_to_rest(out);
      case PinStage::to_spring:
        return swap_to_spring(out);
      case PinStage::spring:
        out.pin_target = -1.0f;
        if (view_.wanted != PinMode::spring && !s_.given_up) enter(PinStage::leaving_spring);
        return;
      case PinStage::leaving_spring:  // the servo pulls until the swing unloads the pin
        if (view_.pin > -0.05f) return enter(PinStage::passive);
        if (in_stage_s() > c_.tracking_max_s) give_up(PinStage::spring, out);
        return;
    }
  }

  void follow(PinClutchOutput& out) {
    out.torque_nm = track();
    if (view_.wanted == PinMode::passive) return enter(PinStage::passive);
    if (static_cast<float>(s_.ticks_aligned) * dt_s_ >= c_.aligned_s) return enter(PinStage::inserting);
    if (in_stage_s() > c_.tracking_max_s) give_up(PinStage::refused, out);
  }

  void insert(PinClutchOutput& out) {
    out.torque_nm = track();
    out.pin_target = 1.0f;
    if (view_.pin >= c_.in_place) return enter(PinStage::active);
    if (in_stage_s() <= c_.pin_max_s) return;
    // On a face, or stuck: out again, and another try.
    out.pin_target = 0.0f;
    if (++s_.tries >= c_.tries_max) return give_up(PinStage::refused, out);
    enter(PinStage::tracking);
    s_.ticks_aligned = 0;
  }

  void bring_to_rest(PinClutchOutput& out) {
    out.pin_target = 1.0f;
    const float way = c_.spring_rest_rad - s_.from_rad;
    const float share = in_stage_s() / c_.to_rest_s;
    const LegPath path =
        share < 1.0f ? raised_cosine(way, c_.to_rest_s, share, false) : LegPath{way, 0.0f, 0.0f};
    out.torque_nm = hold(s_.from_rad + path.fold_m, path.rate_mps) + c_.inertia_kgm2 * path.acceleration_mps2;
    if (view_.wanted != PinMode::spring) return enter(PinStage::active);
    const bool there = share >= 1.0f && size(s_.angle_rad - c_.spring_rest_rad) <= c_.aligned_rad &&
                       size(s_.rate_radps) <= 0.3f * c_.aligned_radps;
    if (there) return enter(PinStage::to_spring);
    if (in_stage_s() > c_.to_rest_s + c_.tracking_max_s) give_up(PinStage::active, out);
  }

  /// The pin leaves the motor's rotator and falls into the spring's, which stands beside it.
  void swap_to_spring(PinClutchOutput& out) {
    out.pin_target = -1.0f;
    out.torque_nm = view_.pin > 0.05f ? track() : 0.0f;
    if (view_.pin <= -c_.in_place) return enter(PinStage::spring);
    if (in_stage_s() <= 2.0f * c_.pin_max_s) return;
    if (++s_.tries >= c_.tries_max) return give_up(PinStage::refused, out);
    enter(PinStage::tracking);  // the link has swung away: once more from the beginning
    s_.ticks_aligned = 0;
  }

  /// Stays where it is safe, the motor off.
  void give_up(PinStage where, PinClutchOutput& out) {
    s_.given_up = true;
    out.torque_nm = 0.0f;
    s_.tries = 0;
    enter(where);
  }

  const PinClutchConfig& c_;
  PinClutchState& s_;
  const PinClutchView& view_;
  float dt_s_;
  float rotor_radps_ = 0.0f, off_rad_ = 0.0f, off_radps_ = 0.0f;
};

/// One tick, `dt_s` after the last.
inline PinClutchOutput sequence_pin_clutch(const PinClutchConfig& config, PinClutchState& state,
                                           const PinClutchView& view, float dt_s) {
  return PinClutchTick(config, state, view, dt_s).run();
}

}  // namespace furcula::control
