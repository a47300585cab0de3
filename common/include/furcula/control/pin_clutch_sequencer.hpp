// Joins a link to its motor, to a spring, or to neither, by a pin (document 000, section II): the motor
// tracks the swinging link until their relative rotation is nothing, then the pin moves.
#pragma once

#include <cstdint>

#include "furcula/control/leg_position.hpp"
#include "furcula/core/count.hpp"

namespace furcula::control {

enum class PinMode : std::uint8_t { passive, active, spring };

struct PinClutchConfig {
  float link_rad_per_count = 3.8349519e-4f;   ///< absolute encoder, 14 bit, between body and link
  float rotor_rad_per_count = 9.5873799e-6f;  ///< incremental encoder on the motor, 4096 a turn, gear 160
  // The tracking law, at the joint.
  float stiffness_nmprad = 4000.0f;
  float damping_nmspr = 140.0f;
  float inertia_kgm2 = 1.28f;  ///< of rotor and gear
  float friction_nm = 8.0f;    ///< of the gear
  float torque_limit_nm = 200.0f;
  float observer_radps = 120.0f;  ///< three poles of the link's angle, rate and acceleration
  // When the pin may move, and what is too long.
  float aligned_rad = 0.012f;  ///< play, and a part of the chamfer
  float aligned_radps = 0.15f;
  float aligned_s = 0.010f;
  float tracking_max_s = 1.5f;
  float pin_max_s = 0.25f;  ///< from the command to the end of the stroke
  float in_place = 0.95f;   ///< share of the stroke at which the pin is there
  float fade_s = 0.05f;     ///< in which the motor's torque passes to what the joint is told
  float spring_rest_rad = 0.1f;
  float to_rest_s = 0.8f;  ///< that the motor takes to bring the link to the spring
  std::uint32_t tries_max = 3;
};

/// What one tick sees.
struct PinClutchView {
  PinMode wanted = PinMode::passive;
  std::uint32_t link_count = 0, link_zero = 0;    ///< absolute, and where the link hangs down
  std::uint32_t rotor_count = 0, rotor_zero = 0;  ///< incremental, and what it read beside a link at zero
  float pin = 0.0f;                               ///< position of the servo: 1 active, 0 middle, -1 spring
  float torque_nm = 0.0f;                         ///< that the joint is told; acts in active mode
};

/// refused: what was wanted could not be done; until something else is wanted.
enum class PinStage : std::uint8_t {
  passive,
  tracking,
  inserting,
  active,
  unloading,
  to_rest,
  to_spring,
  spring,
  leaving_spring,
  refused
};

struct PinClutchState {
  PinStage stage = PinStage::passive;
  PinMode last_wanted = PinMode::passive;
  bool given_up = false;  ///< what is wanted, until something else is
  bool begun = false;
  std::uint32_t ticks_in_stage = 0, ticks_aligned = 0, tries = 0;
  float angle_rad = 0.0f, rate_radps = 0.0f, acceleration_radps2 = 0.0f;  ///< of the link, observed
  float rotor_rad = 0.0f;                                                 ///< of the last tick
  float from_rad = 0.0f;                                                  ///< where to_rest began
};

struct PinClutchOutput {
  float torque_nm = 0.0f;   ///< of the motor, at the joint
  float pin_target = 0.0f;  ///< of the servo
  PinStage stage = PinStage::passive;
  float off_rad = 0.0f, off_radps = 0.0f;  ///< of the active rotator behind the link
};

/// One tick's step through the stages.
class PinClutchTick {
 public:
  PinClutchTick(const PinClutchConfig& config, PinClutchState& state, const PinClutchView& view, float dt_s)
      : c_(config), s_(state), view_(view), dt_s_(dt_s) {}

  PinClutchOutput run() {
    if (s_.ticks_in_stage != 0xffffffffu) ++s_.ticks_in_stage;
    if (view_.wanted != s_.last_wanted) s_.given_up = false;
    s_.last_wanted = view_.wanted;
    observe();
    const bool aligned = size(off_rad_) <= c_.aligned_rad && size(off_radps_) <= c_.aligned_radps;
    s_.ticks_aligned = aligned ? s_.ticks_aligned + 1 : 0;
    PinClutchOutput out;
    step(out);
    // What is not a number (a configuration with a time of 0) is no torque.
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

  /// The motor beside the link.
  float track() const {
    const float friction = s_.rate_radps > 0.02f    ? c_.friction_nm
                           : s_.rate_radps < -0.02f ? -c_.friction_nm
                                                    : 0.0f;
    return c_.stiffness_nmprad * off_rad_ + c_.damping_nmspr * off_radps_ +
           c_.inertia_kgm2 * s_.acceleration_radps2 + friction;
  }
  /// The motor, joined to the link, to an angle.
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
        // To the spring the motor brings the link.
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

/// One tick.
inline PinClutchOutput sequence_pin_clutch(const PinClutchConfig& config, PinClutchState& state,
                                           const PinClutchView& view, float dt_s) {
  return PinClutchTick(config, state, view, dt_s).run();
}

}  // namespace furcula::control
