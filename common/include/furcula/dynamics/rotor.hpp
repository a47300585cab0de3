// The end of the actuation, which turns with the leg and is stepped with it: the motor's rotor, whose torque has
// a ripple over its angle, in the backlash between motor and leg (docs/contracts.md, `torque_ripple`, `backlash`).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// Rests on one end of the gap, where the leg gets the motor's torque, or crosses it as a free mass, and the
/// leg gets none. At an end it stops against the leg (plastic): what it has gained against the leg goes to
/// the leg, so that no impulse is lost; else its inertia counts as the leg's. Angles in rad, of the motor
/// against the leg; the gap is centred on zero.
template <class T>
class Rotor {
 public:
  /// Plain numbers: float or double.
  using V = ValueOf<T>;
  static constexpr V kInertia = V(4e-4);  ///< kg m^2 (docs/contracts.md)

  /// With the backlash and the torque ripple of `effects`; pressed to the positive end.
  explicit Rotor(const Effects<T>& effects) : Rotor(EffectsOf<T, Stage::actuation>(effects)) {}

  /// True if it is one with the leg and gives it the torque as it comes.
  bool ideal() const { return !loose_ && !ripples_; }
  /// Whether the motor's torque has a ripple.
  bool ripples() const { return ripples_; }
  /// A sin(n theta + phi), theta the rotor's own angle with a leg at this one; only where it ripples.
  T ripple(const T& leg_angle) const {
    using std::sin;
    return ripple_[0] * sin(ripple_[1] * (loose_ ? T(leg_angle + angle_) : leg_angle) + ripple_[2]);
  }
  /// Of the torque that the motor makes, with the ripple.
  T torque(const T& motor, const T& leg_angle) const {
    return ripples_ ? T(motor + ripple(leg_angle)) : motor;
  }

  /// Whether there is backlash.
  bool loose() const { return loose_; }
  /// Whether the rotor crosses the gap, at neither end.
  bool crosses() const { return end_ == 0; }
  /// Angle of the motor against the leg, rad; zero in the middle of the gap.
  const T& angle() const { return angle_; }

  /// Puts it where a torque of this sign, the last that was not zero, holds it; zero counts as positive.
  void press(V torque) {
    end_ = torque < V(0) ? -1 : 1;
    angle_ = end_ < 0 ? T(-half_gap_) : half_gap_;
    speed_ = T(V(0));
  }

  /// Puts it at this angle against a leg that stands still, moving with this speed; to rest on an end where
  /// that is near or passed.
  void place(V angle, V speed) {
    constexpr V kNear = V(0.8);  // of the way from the middle
    press(angle);
    if (std::abs(angle) >= kNear * value_of(half_gap_)) return;
    end_ = 0;
    angle_ = T(angle);
    speed_ = T(speed);
  }

  /// Lets it leave its end if that torque takes it away from a leg that turns with this acceleration. Returns
  /// what angle it has crossed at once: all of a gap too small to take time, else zero.
  T let_go(const T& torque, V leg_acceleration) {
    if (end_ == 0 || V(end_) * (value_of(torque) / kInertia - leg_acceleration) >= V(0)) return T(V(0));
    if (value_of(half_gap_) < kSmallest) {
      press(V(-end_));
      return V(2) * angle_;
    }
    end_ = 0;
    return T(V(0));
  }

  /// Sets out across the gap from a leg at this angle and speed, under a held torque.
  void set_out(const T& torque, const T& leg_angle, const T& leg_speed) {
    from_ = angle_ + leg_angle;
    from_speed_ = speed_ + leg_speed;
    acceleration_ = torque / kInertia;
  }
  /// Against a leg that is at this angle `t` after it set out.
  T angle_after(const T& t, const T& leg_angle) const {
    return from_ + (from_speed_ + V(0.5) * acceleration_ * t) * t - leg_angle;
  }
  /// True if it is past an end against a leg at this angle `t` after it set out.
  bool past(const T& t, const T& leg_angle) const {
    const V angle = value_of(angle_after(t, leg_angle));
    return angle > value_of(half_gap_) || angle < -value_of(half_gap_);
  }
  /// When it arrives, before `to`, at which it is past an end. `angle(t)` and `speed(t)` are the leg's in
  /// plain numbers, `leg(t)` its angle with derivatives.
  template <class Angle, class Speed, class Leg>
  T arrival_time(V to, const Angle& angle, const Speed& speed, const Leg& leg) const {
    const V a = value_of(from_), b = value_of(from_speed_), c = value_of(acceleration_);
    const V at_to = a + (b + V(0.5) * c * to) * to - angle(to);
    const T target = at_to > V(0) ? half_gap_ : T(-half_gap_);
    const V end = value_of(target);
    const auto rate = [&](V t) { return b + c * t - speed(t); };
    const V time = event_time<V>(
        V(0), to, [&](V t) { return a + (b + V(0.5) * c * t) * t - angle(t) - end; }, rate);
    const V slope = rate(time);
    if (slope == V(0)) return T(time);
    return T(time) - (angle_after(T(time), leg(T(time))) - target) / slope;
  }
  /// Goes along with the leg, which is at this angle and speed `t` after it set out.
  void follow(const T& t, const T& leg_angle, const T& leg_speed) {
    angle_ = angle_after(t, leg_angle);
    speed_ = from_speed_ + acceleration_ * t - leg_speed;
  }
  /// Stops at the end that it has come to. Returns the angular impulse on the leg, N m s.
  T land() {
    const T impulse = kInertia * speed_;
    press(value_of(angle_));
    return impulse;
  }

 private:
  explicit Rotor(const EffectsOf<T, Stage::actuation>& e)
      : loose_(e.has(Effect::backlash)),
        ripples_(e.has(Effect::torque_ripple)),
        half_gap_(loose_ ? T(V(0.5) * e.value(Effect::backlash)) : T(V(0))),
        ripple_(e.values(Effect::torque_ripple)) {
    press(V(1));
  }

  static constexpr V kSmallest = V(1e-7);  // rad
  bool loose_, ripples_;
  T half_gap_;
  std::array<T, kMaxEffectParameters> ripple_;  ///< amplitude, cycles a revolution, phase
  std::int8_t end_ = 1;                         // -1 or 1: the end it rests on; 0 while it crosses
  T angle_{}, speed_{};
  T from_{}, from_speed_{}, acceleration_{};
};

}  // namespace furcula::dynamics
