// An axis without contact: a linear motor axis, a rotary joint under gravity or on a torsion spring, or a
// carriage in free flight on a vertical rail. Dry friction, where it is switched on, holds the axis at rest
// until the applied force exceeds it; turning points are located inside the step.
#pragma once

#include <cmath>

#include "furcula/dynamics/effects/laws.hpp"
#include "furcula/dynamics/machines/motor_axis.hpp"
#include "furcula/dynamics/machines/rail_carriage.hpp"
#include "furcula/dynamics/machines/rotary_joint.hpp"
#include "furcula/dynamics/rotor.hpp"
#include "furcula/dynamics/segment.hpp"

namespace furcula::dynamics {

/// m x'' = u - d x' - load(x) + effects, with load = 0 (MotorAxisParameters), gravity_torque sin(x)
/// (RotaryJointParameters; angle 0 hanging down), stiffness x (TorsionPendulumParameters) or m g
/// (RailCarriageParameters; up positive, u = 0). The input u (N or N m) is held over a step; forces that depend
/// on position or speed are taken at the step's predicted midpoint, a spring's is in the flow.
template <class Parameters, class T>
class Axis {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;
  /// The position is an angle.
  static constexpr bool kRotary = requires(const Parameters& p) { p.inertia_kgm2; };
  /// The axis is vertical: its weight is a constant force.
  static constexpr bool kVertical = requires(const Parameters& p) { p.gravity_mps2; };
  /// A pendulum: gravity turns it towards the angle 0.
  static constexpr bool kHangs = requires(const Parameters& p) { p.gravity_torque_nm; };
  /// A torsion spring turns it towards the angle 0.
  static constexpr bool kSprung = requires(const Parameters& p) { p.stiffness_nmprad; };

  /// At rest at position 0. Of the effects it uses those of the mechanism and those of the rotor (torque ripple,
  /// backlash).
  Axis(const Parameters& p, const Effects<T>& effects = {})
      : p_(p), e_(effects), rotor_(effects), dry_(has_dry_friction(e_)) {
    T mass, damping;
    if constexpr (kRotary) {
      mass = p.inertia_kgm2;
      damping = p.damping_nmspr;
    } else {
      mass = p.mass_kg;
      damping = p.damping_nspm;
    }
    mass = e_.value_or(Effect::mass_error, mass);
    inverse_mass_ = T(V(1)) / mass;
    delta_ = e_.value_or(Effect::damping_error, damping) * inverse_mass_;
    constant_force_ = e_.has(Effect::force_offset) ? e_.value(Effect::force_offset) : T(V(0));
    if constexpr (kVertical) {
      using std::cos;
      T weight = mass * p.gravity_mps2;
      if (e_.has(Effect::guide_tilt)) weight *= cos(e_.value(Effect::guide_tilt));
      constant_force_ -= weight;
    }
  }

  /// Starts at a position (m or rad) and velocity.
  void reset(const T& position, const T& velocity) {
    x_ = position;
    v_ = velocity;
    rotor_.press(V(1));
  }

  /// Puts the rotor to the end of the backlash to which the last torque before the start that was not zero (its
  /// sign counts) pressed it. Call it after reset(), which puts it to the end of positive torque.
  void press_rotor(V torque) { rotor_.press(torque); }
  /// True if there is a backlash between rotor and joint.
  bool has_backlash() const { return rotor_.loose(); }
  /// Of a rotary joint: the motor's angle, which leads the joint's by where the rotor is in the backlash.
  T motor_angle_rad() const { return x_ + rotor_.angle(); }

  /// Moves on by `dt_s` >= 0 with the input u (N or N m) held. Steps longer than kLongestStep are divided.
  void advance(const T& input, V dt_s) {
    if (dt_s <= V(0)) return;
    const int parts = dt_s <= kLongestStep ? 1 : 1 + static_cast<int>(dt_s / kLongestStep);
    const V h = parts == 1 ? dt_s : dt_s / static_cast<V>(parts);
    if (h != step_) {
      step_ = h;
      full_ = flow(kappa(), delta_, T(h));
    }
    for (int i = 0; i < parts; ++i) {
      T left = T(h);
      for (int round = 0; round < kMaxTurns && value_of(left) > V(0); ++round)
        if (move(input, left, round == 0)) break;
    }
  }

  const T& position() const { return x_; }  ///< m or rad
  const T& velocity() const { return v_; }  ///< m/s or rad/s

 private:
  // In a step this short the gravity torque at its midpoint differs from the mean by second order of the step.
  static constexpr V kLongestStep = kRotary ? V(4e-3) : V(20e-3);
  static constexpr int kMaxTurns = 8;

  bool move(const T& input, T& left, bool full) {
    const V h = value_of(left);
    if constexpr (kRotary)
      if (full && rotor_.loose()) let_rotor_go(input);
    T force = kRotary && rotor_.crosses() ? constant_force_ : T(input + constant_force_);
    T motor{};  // what turns the rotor while it crosses the backlash
    if constexpr (kRotary) {
      motor = input;
      // At the midpoint, by the velocity and the acceleration at the start.
      const T start = (force - load(x_)) * inverse_mass_ - delta_ * v_;
      const T midpoint = full ? T(x_ + v_ * (V(0.5) * h) + start * (V(0.125) * h * h))
                              : T(x_ + (v_ + start * (V(0.25) * left)) * (V(0.5) * left));
      force -= load(kSprung ? x_ : midpoint);
      if (rotor_.ripples()) {
        const T ripple = rotor_.ripple(midpoint);
        motor += ripple;
        if (!rotor_.crosses()) force += ripple;
      }
    }
    T acceleration = force * inverse_mass_;
    const bool at_rest = value_of(v_) == V(0);
    const bool up = at_rest ? value_of(acceleration) > V(0) : value_of(v_) > V(0);
    if (e_.any()) {
      const T extra = binding(e_, x_, T(x_ + v_ * left));
      const Resisted<T> r =
          full ? resisted(e_, up, at_rest, v_, acceleration, delta_, inverse_mass_, extra, h)
               : resisted(e_, up, at_rest, v_, acceleration, delta_, inverse_mass_, extra, left);
      if (r.held) {
        if constexpr (kRotary)
          if (rotor_.crosses() && rotor_goes_on(Segment<T>{x_, zero(), zero(), zero(), delta_}, motor, left))
            return false;
        return true;
      }
      acceleration = r.acceleration;
    }
    const Segment<T> segment{x_, v_, acceleration, kappa(), delta_};
    const Flow<T> whole = full ? full_ : segment.over(left);
    const T v_end = segment.velocity_after(whole);
    if (dry_ && (up ? value_of(v_end) < V(0) : value_of(v_end) > V(0))) {
      T t = segment.turning_time(h);
      if constexpr (kRotary) {
        if (rotor_.crosses()) {
          T until = t;
          if (rotor_goes_on(segment, motor, until)) {
            left = left - (t - until);
            return false;
          }
        }
      }
      x_ = segment.position_after(segment.over(t));
      v_ = T(V(0));
      left = left - t;
      return false;
    }
    if constexpr (kRotary)
      if (rotor_.crosses() && rotor_goes_on(segment, motor, left)) return false;
    x_ = segment.position_after(whole);
    v_ = v_end;
    return true;
  }

  static T zero() { return T(V(0)); }

  /// What gravity or the spring turns a rotary axis back with.
  T load(const T& angle) const {
    using std::sin;
    if constexpr (kHangs)
      return p_.gravity_torque_nm * sin(angle);
    else
      return p_.stiffness_nmprad * angle;
  }
  T kappa() const {
    if constexpr (kSprung)
      return p_.stiffness_nmprad * inverse_mass_;
    else
      return zero();
  }

  /// At a step's start: the rotor leaves its end if torque and joint part.
  void let_rotor_go(const T& input) {
    T force = constant_force_;
    if constexpr (kRotary) force -= load(x_);
    const V v = value_of(v_);
    if (v != V(0)) force += resistance(e_, v > V(0), v_, binding(e_, x_, x_));
    V acceleration = value_of(T(force * inverse_mass_ - delta_ * v_));
    if (v == V(0) && dry_) {
      const bool up = acceleration > V(0);
      const V held = value_of(T(resistance(e_, up, v_, binding(e_, x_, x_)) * inverse_mass_));
      acceleration = (acceleration + held > V(0)) == up ? acceleration + held : V(0);
    }
    const T motor = rotor_.torque(input, x_);
    // The joint stays behind by the rotor's share of an angle that takes no time.
    x_ -= rotor_.let_go(motor, acceleration) * (Rotor<T>::kInertia * inverse_mass_);
  }
  /// Goes with the rotor for `left` seconds, or to where it has crossed the gap: then it has landed, the
  /// joint is there as well, `left` is what remains, and it returns true.
  bool rotor_goes_on(const Segment<T>& segment, const T& motor, T& left) {
    rotor_.set_out(motor, x_, v_);
    const auto angle = [&](const auto& s, const auto& t) { return s.position_after(s.over(t)); };
    const Flow<T> whole = segment.over(left);
    if (!rotor_.past(left, segment.position_after(whole))) {
      rotor_.follow(left, segment.position_after(whole), segment.velocity_after(whole));
      return false;
    }
    const Segment<V> p = segment.plain();
    const T t = rotor_.arrival_time(
        value_of(left), [&](V at) { return angle(p, at); },
        [&](V at) { return p.velocity_after(p.over(at)); }, [&](const T& at) { return angle(segment, at); });
    const Flow<T> f = segment.over(t);
    x_ = segment.position_after(f);
    v_ = segment.velocity_after(f);
    rotor_.follow(t, x_, v_);
    v_ += rotor_.land() * inverse_mass_;
    left = left - t;
    return true;
  }

  Parameters p_;
  MechanismEffects<T> e_;
  Rotor<T> rotor_;
  bool dry_;
  T inverse_mass_{}, delta_{}, constant_force_{};
  T x_{}, v_{};
  V step_ = V(-1);
  Flow<T> full_{};
};

/// A linear motor axis.
template <class T>
using MotorAxis = Axis<MotorAxisParameters<T>, T>;
/// A rotary joint under gravity.
template <class T>
using RotaryJoint = Axis<RotaryJointParameters<T>, T>;
/// A carriage in free flight on a vertical rail.
template <class T>
using RailCarriage = Axis<RailCarriageParameters<T>, T>;

}  // namespace furcula::dynamics
