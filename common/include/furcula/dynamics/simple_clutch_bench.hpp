// The release/catch bench of 002 section 5.1 as a law that can be fitted: a weight on a belt over a pulley,
// two delays, teeth. Exact between its events; those are located inside the step and carry derivatives. The
// bench with coil, key and flanks is dynamics/clutch_bench.hpp.
#pragma once

#include <cmath>
#include <cstdint>

#include "furcula/dynamics/effects/laws.hpp"
#include "furcula/dynamics/key_timing.hpp"
#include "furcula/dynamics/machines/clutch_bench.hpp"
#include "furcula/dynamics/segment.hpp"

namespace furcula::dynamics {

/// Angle of the pulley, rad; growing while the load goes down.
///   held    angle = that of a tooth
///   loose   (m r^2 + I) angle'' = m g r - d angle' - k_aux r^2 angle - friction
///           (auxiliary spring slack at the angle 0)
/// From a release delay after the coil is switched on the belt is loose. A catch delay after it is switched
/// off the key presses, and stops the belt (plastically) at the next tooth that it comes to in its motion;
/// the teeth lie pitch / radius apart, counted from where the belt was held when the run began. A clutch that
/// slips (clutch_slip) holds the belt at a tooth only where holding force >= pull + kinetic energy / pitch,
/// the pull at the middle of the way to the next tooth; else the belt goes on to that tooth against the
/// holding force.
template <class T>
class SimpleClutchBench {
 public:
  /// Plain numbers: float or double.
  using V = ValueOf<T>;

  /// With the effects that act on the belt and the key: late_catch, damping_error, auxiliary_spring, clutch_slip, friction.
  SimpleClutchBench(const ClutchBenchParameters<T>& p, const Effects<T>& effects = {})
      : e_(effects),
        key_(p.release_delay_s, e_.value_or(Effect::late_catch, p.catch_delay_s)),
        radius_(p.pulley_radius_m),
        pitch_(p.tooth_pitch_m / p.pulley_radius_m) {
    const T lever_squared = radius_ * radius_;
    inverse_inertia_ = T(V(1)) / (p.load_mass_kg * lever_squared + p.pulley_inertia_kgm2);
    weight_ = p.load_mass_kg * radius_ * V(kBenchGravity_mps2);
    damping_ = e_.value_or(Effect::damping_error, p.damping_nmspr);
    stiffness_ = e_.value_or(Effect::auxiliary_spring, p.auxiliary_stiffness_npm) * lever_squared;
    if (e_.has(Effect::clutch_slip)) holding_ = e_.value(Effect::clutch_slip) * radius_;
  }

  /// The belt rests on a tooth at this angle, the coil has been off for long. (A held belt has no velocity:
  /// the second argument is there because other plants have it.)
  void reset(const T& angle_rad, const T& = T(V(0))) {
    origin_ = angle_ = angle_rad;
    speed_ = T(V(0));
    belt_ = Belt::held;
    tooth_ = V(0);
    skipped_ = 0;
    key_.reset();
  }
  /// The belt is loose at this angle and speed, the coil has been on for long.
  void reset_loose(const T& angle_rad, const T& speed_radps) {
    reset(angle_rad);
    speed_ = speed_radps;
    belt_ = Belt::loose;
    key_.reset(true);
  }

  /// Moves on by `dt_s` >= 0 with the coil held on (input above a half) or off.
  void advance(const T& input, V dt_s) {
    key_.energise(value_of(input) > V(0.5));
    T left = T(dt_s);
    for (int round = 0; round < kMostChanges && value_of(left) > V(0); ++round) {
      const bool changes = key_.changes_within(value_of(left));
      T until = changes ? key_.change_in() : left;
      const bool whole = moves() ? run(until) : rest();
      key_.pass(until);
      left = left - until;
      if (changes && whole) {
        key_.change();
        turn_key();
      }
    }
  }

  const T& position() const { return angle_; }  ///< rad
  const T& velocity() const { return speed_; }  ///< rad/s
  /// Whether the belt is held at a tooth.
  bool held() const { return belt_ == Belt::held; }
  /// Since the start, by a clutch that slips.
  std::uint32_t skipped_teeth() const { return skipped_; }

 private:
  static constexpr int kMostChanges = 256;  ///< in one advance(): a belt may pass many teeth
  /// pressed: the key lies on the belt, which has yet to come to a tooth. slips: from one tooth to the next.
  enum class Belt : std::uint8_t { held, loose, pressed, slips };

  static T zero() { return T(V(0)); }

  /// A held belt whose load has grown beyond what the clutch holds slips.
  bool moves() {
    if (belt_ != Belt::held) return true;
    if (!e_.has(Effect::clutch_slip)) return false;
    const V load = value_of(pull(true));
    const bool down = load > V(0);
    if (holds(down)) return false;
    begin_slip(down);
    return true;
  }
  static bool rest() { return true; }

  void turn_key() {
    if (key_.out()) {
      belt_ = Belt::loose;
      return;
    }
    belt_ = Belt::pressed;
    const V speed = value_of(speed_);
    aim(speed != V(0) ? speed > V(0) : value_of(weight_ - stiffness_ * angle_) > V(0));
  }

  /// The next tooth in that direction; a belt at rest on a tooth is there.
  void aim(bool down) {
    using std::ceil;
    using std::floor;
    const V at = value_of(angle_ - origin_) / value_of(pitch_);
    const V nearest = floor(at + V(0.5));
    const V off = at - nearest;
    if (value_of(speed_) == V(0) && (off < V(0) ? -off : off) < V(1e-6))
      tooth_ = nearest;
    else
      tooth_ = down ? floor(at + kJust) + V(1) : ceil(at - kJust) - V(1);
    down_ = down;
  }
  T tooth_angle() const { return origin_ + tooth_ * pitch_; }

  /// What pulls the belt on, about the pulley, in the middle of the way to the next tooth.
  T pull(bool down) const {
    const T half = V(0.5) * pitch_;
    const T middle = down ? T(angle_ + half) : T(angle_ - half);
    T force = weight_ - stiffness_ * middle - damping_ * speed_;
    force += resistance(e_, down, speed_, zero());
    return force;
  }
  bool holds(bool down) const {
    if (!e_.has(Effect::clutch_slip)) return true;
    const V load = value_of(pull(down)), speed = value_of(speed_);
    const V energy = V(0.5) * speed * speed / value_of(inverse_inertia_);
    return value_of(holding_) >= (down ? load : -load) + energy / value_of(pitch_);
  }
  void begin_slip(bool down) {
    belt_ = Belt::slips;
    tooth_ += down ? V(1) : V(-1);
    down_ = down;
    ++skipped_;
  }

  /// Goes on for `until`, or to where the belt turns or comes to a tooth: then `until` is shortened, and it
  /// returns false.
  bool run(T& until) {
    const V h = value_of(until);
    const T delta = damping_ * inverse_inertia_, kappa = stiffness_ * inverse_inertia_;
    T torque = weight_ - stiffness_ * angle_;
    if (belt_ == Belt::slips) torque += down_ ? T(-holding_) : holding_;
    T acceleration = torque * inverse_inertia_;
    const bool at_rest = value_of(speed_) == V(0);
    const bool down = at_rest ? value_of(acceleration) > V(0) : value_of(speed_) > V(0);
    if (has_dry_friction(e_)) {
      const Resisted<T> r =
          resisted(e_, down, at_rest, speed_, acceleration, delta, inverse_inertia_, zero(), h);
      if (r.held) return true;
      acceleration = r.acceleration;
    }
    const Segment<T> segment{angle_, speed_, acceleration, kappa, delta};
    const Flow<T> whole = segment.over(until);
    T angle = segment.position_after(whole), speed = segment.velocity_after(whole);
    bool turns = down ? value_of(speed) < V(0) : value_of(speed) > V(0);
    if (turns) {
      until = segment.turning_time(h);
      angle = segment.position_after(segment.over(until));
      speed = zero();
    }
    if (belt_ == Belt::pressed || belt_ == Belt::slips) {
      if (belt_ == Belt::pressed && down != down_) aim(down);
      const T tooth = tooth_angle();
      const V beyond = value_of(angle - tooth);
      if (down_ == down && (down ? beyond >= V(0) : beyond <= V(0))) {
        arrive(segment, tooth, until);
        return false;
      }
      if (belt_ == Belt::slips && turns) belt_ = Belt::pressed;  // short of the tooth: it may go back
    }
    angle_ = angle;
    speed_ = speed;
    return !turns;
  }

  void arrive(const Segment<T>& segment, const T& tooth, T& until) {
    const V gap = value_of(tooth - angle_);
    until = gap == V(0) ? zero() : segment.crossing_time(T(V(1)), zero(), -tooth, V(0), value_of(until));
    speed_ = segment.velocity_after(segment.over(until));
    angle_ = tooth;
    if (holds(down_)) {
      belt_ = Belt::held;
      speed_ = zero();
      return;
    }
    begin_slip(down_);
  }

  static constexpr V kJust = V(1e-9);  ///< of a pitch

  MechanismEffects<T> e_;
  KeyTiming<T> key_;
  T radius_, pitch_;
  T inverse_inertia_{}, weight_{}, damping_{}, stiffness_{}, holding_{};
  T origin_{}, angle_{}, speed_{};
  Belt belt_ = Belt::held;
  V tooth_ = V(0);  ///< the next one, counted from the origin
  bool down_ = true;
  std::uint32_t skipped_ = 0;
};

}  // namespace furcula::dynamics
