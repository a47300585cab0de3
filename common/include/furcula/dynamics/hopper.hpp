// The linear hopper (002 section 3.2.1 with the corrections of docs/physics.md): a body on a vertical guide,
// a virtual spring and a damper between hip and toe, a motor between the upper links. Exact inside a phase;
// touch-down, lift-off and turning points are located inside the step.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "furcula/dynamics/effects/laws.hpp"
#include "furcula/dynamics/parameters.hpp"
#include "furcula/dynamics/segment.hpp"

namespace furcula::dynamics {

/// What happened inside a step, and when after its start.
template <class V>
struct ContactEvent {
  enum class Kind { touchdown, liftoff } kind;
  V offset_s;
  V velocity_before_mps;
  V velocity_after_mps;
};

/// The plant. The equations, z the height of the centre of mass:
///   stance   m z'' = -k (z - z0) - ds z' - m g + F(tau, z) + effects      F = -tau / (2 L sin theta), z = 2
///   L cos theta flight   m z'' = -df z' - m g + effects on the guide
/// df acts in the guide in both phases, ds - df in the leg. Touch-down when z falls to 2 L cos(touchdown
/// angle); lift-off when, rising, z is back there or the ground's force is zero. The ground cannot pull:
/// while the body sinks and the leg would pull, the leg's force is zero. The torque is held over a step, its
/// lever arm and the forces that depend on speed are taken at the step's predicted midpoint (error of third
/// order in the step).
template <class T>
class Hopper {
 public:
  using V = ValueOf<T>;
  static constexpr int kMaxEvents = 16;  ///< in one step of at most kLongestStep

  Hopper(const HopperLinearParameters<T>& p, const Effects<T>& effects = {})
      : p_(p),
        e_(effects),
        stiffness_(e_.value_or(Effect::stiffness_error, p.stiffness_npm)),
        restitution_touchdown_(e_.value_or(Effect::touchdown_loss, p.restitution_touchdown)),
        inverse_mass_(T(V(1)) / p.mass_kg),
        kappa_stance_(stiffness_ * inverse_mass_),
        delta_stance_(p.damping_stance_nspm * inverse_mass_),
        delta_flight_(p.damping_flight_nspm * inverse_mass_) {
    using std::cos;
    touchdown_height_ = V(2) * p.link_length_m * cos(p.touchdown_angle_rad);
    leg_reach_squared_ = V(4) * p.link_length_m * p.link_length_m;
    constant_force_ = -p.mass_kg * p.gravity_mps2;
    if (e_.has(Effect::force_offset)) constant_force_ += e_.value(Effect::force_offset);
    leg_force_at_zero_ = stiffness_ * p.rest_height_m;
    if (e_.has(Effect::spring_preload)) leg_force_at_zero_ += e_.value(Effect::spring_preload);
    leg_damping_ = p.damping_stance_nspm - p.damping_flight_nspm;
  }

  /// Starts at a height (m) and velocity (m/s), in flight if above the touch-down height, else in stance.
  void reset(const T& height_m, const T& velocity_mps) {
    z_ = height_m;
    v_ = velocity_mps;
    stance_ = value_of(z_) <= value_of(touchdown_height_);
    event_count_ = 0;
  }

  /// Moves on by `dt_s` >= 0 with the motor's torque command held. Steps longer than kLongestStep are
  /// divided.
  void advance(const T& torque_cmd_nm, V dt_s) {
    event_count_ = 0;
    elapsed_ = V(0);
    const T torque = e_.has(Effect::torque_gain_error)
                         ? T(e_.value(Effect::torque_gain_error) * torque_cmd_nm)
                         : torque_cmd_nm;
    if (dt_s <= V(0)) return;
    const int parts = dt_s <= kLongestStep ? 1 : 1 + static_cast<int>(dt_s / kLongestStep);
    const V h = parts == 1 ? dt_s : dt_s / static_cast<V>(parts);
    if (h != step_) prepare(h);
    for (int i = 0; i < parts; ++i) step(torque);
  }

  const T& height_m() const { return z_; }
  const T& velocity_mps() const { return v_; }
  bool in_stance() const { return stance_; }
  const T& touchdown_height_m() const { return touchdown_height_; }

  /// Leg angle from the vertical, rad: on the stop in flight.
  T leg_angle_rad() const {
    using std::acos;
    return stance_ ? acos(z_ / (V(2) * p_.link_length_m)) : p_.touchdown_angle_rad;
  }

  /// Touch-downs and lift-offs inside the last advance(), in order; offsets from its start, s.
  std::span<const ContactEvent<V>> events() const { return {events_.data(), event_count_}; }

 private:
  static constexpr V kLongestStep = V(2e-3);

  void prepare(V h) {
    step_ = h;
    full_stance_ = flow(kappa_stance_, delta_stance_, T(h));
    full_flight_ = flow(T(V(0)), delta_flight_, T(h));
  }

  /// Vertical force at the toe per torque at height z: -1 / (2 L sin theta) (virtual work, 002 eq. 3.2
  /// corrected).
  T force_per_torque(const T& z) const {
    using std::sqrt;
    const T squared = leg_reach_squared_ - z * z;
    // A leg stretched to within a thousandth of its reach has no lever arm worth the name: held there.
    return value_of(squared) > V(1e-3) * value_of(leg_reach_squared_)
               ? T(V(-1) / sqrt(squared))
               : T(V(-1) / sqrt(V(1e-3) * leg_reach_squared_));
  }

  void record(typename ContactEvent<V>::Kind kind, const T& before, const T& after) {
    if (event_count_ < events_.size())
      events_[event_count_++] = {kind, elapsed_, value_of(before), value_of(after)};
  }

  void touch_down() {
    const T before = v_;
    v_ = restitution_touchdown_ * v_;
    stance_ = true;
    record(ContactEvent<V>::Kind::touchdown, before, v_);
  }
  void lift_off() {
    const T before = v_;
    v_ = p_.restitution_liftoff * v_;
    stance_ = false;
    record(ContactEvent<V>::Kind::liftoff, before, v_);
  }

  /// One step of step_ seconds.
  void step(const T& torque) {
    T left = T(step_);
    for (int round = 0; round < kMaxEvents; ++round) {
      if (!(value_of(left) > V(0))) return;
      if (move(torque, left, round == 0)) return;
    }
    // So many events in one step means contacts without end (a body bouncing down to rest): it rests.
    v_ = T(V(0));
    elapsed_ += value_of(left);
  }

  /// Moves until `left` is used up (returns true) or to the next event (takes it and shortens `left`).
  bool move(const T& torque, T& left, bool full) {
    const V h = value_of(left);
    // The leg's force but for spring and damper, and whether the leg can push at all.
    T leg_constant = T(V(0));
    bool leg_acts = false;
    if (stance_) {
      const T midpoint = z_ + v_ * (V(0.5) * h);
      leg_constant = leg_force_at_zero_ + torque * force_per_torque(midpoint);
      const auto leg_force = [&](const T& z) {
        return value_of(leg_constant) - value_of(stiffness_) * value_of(z) -
               value_of(leg_damping_) * value_of(v_);
      };
      const bool rises = value_of(v_) > V(0);
      if (rises && leg_force(z_) <= V(0)) {
        lift_off();
        return false;
      }
      leg_acts = rises || leg_force(midpoint) > V(0);
    }
    T force = leg_acts ? T(constant_force_ + leg_constant) : constant_force_;
    const T& delta = leg_acts ? delta_stance_ : delta_flight_;
    T acceleration = leg_acts ? T(force * inverse_mass_ - kappa_stance_ * z_) : T(force * inverse_mass_);

    // Direction of the motion; at rest, of the motion that would begin.
    const bool at_rest = value_of(v_) == V(0);
    const bool up = at_rest ? value_of(acceleration) > V(0) : value_of(v_) > V(0);
    if (e_.any()) {
      const Resisted<T> r = resisted(e_, up, at_rest, v_, acceleration, delta, inverse_mass_, h);
      if (r.held) {
        elapsed_ += h;
        return true;
      }
      acceleration = r.acceleration;
    }

    if (!stance_ && !up && value_of(z_) <= value_of(touchdown_height_)) {
      touch_down();
      return false;
    }

    const Segment<T> segment{z_, v_, acceleration, leg_acts ? kappa_stance_ : T(V(0)), delta};
    const Flow<T>& whole = full ? (leg_acts ? full_stance_ : full_flight_) : (scratch_ = segment.over(left));
    T z_end = segment.position_after(whole);
    T v_end = segment.velocity_after(whole);
    T t_end = left;
    // Up to a turning point the height is monotone, so that the ends tell whether it crosses anything.
    const bool turns = up ? value_of(v_end) < V(0) : value_of(v_end) > V(0);
    if (turns) {
      t_end = segment.turning_time(h);
      z_end = segment.position_after(segment.over(t_end));
      v_end = T(V(0));
    }

    if (!stance_ && !up && value_of(z_end) < value_of(touchdown_height_)) {
      const T t = segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), value_of(t_end));
      arrive(segment, t, left);
      z_ = touchdown_height_;
      touch_down();
      return false;
    }
    if (stance_ && up) {
      const auto leg_force = [&](const T& z, const T& v) {
        return leg_constant - stiffness_ * z - leg_damping_ * v;
      };
      const bool reaches = value_of(z_end) >= value_of(touchdown_height_);
      const bool unloads = leg_acts && value_of(leg_force(z_end, v_end)) <= V(0);
      if (reaches || unloads) {
        const V to = value_of(t_end);
        T t = t_end;
        if (reaches && value_of(z_) < value_of(touchdown_height_))
          t = segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), to);
        else if (reaches)
          t = T(V(0));
        bool by_height = reaches;
        if (unloads) {
          const T t_unload = segment.crossing_time(-stiffness_, -leg_damping_, leg_constant, V(0), to);
          if (!reaches || value_of(t_unload) < value_of(t)) {
            t = t_unload;
            by_height = false;
          }
        }
        arrive(segment, t, left);
        if (by_height) z_ = touchdown_height_;
        lift_off();
        return false;
      }
    }
    z_ = z_end;
    v_ = v_end;
    elapsed_ += value_of(t_end);
    if (!turns) return true;
    left = left - t_end;
    return false;
  }

  void arrive(const Segment<T>& segment, const T& t, T& left) {
    const Flow<T> f = segment.over(t);
    z_ = segment.position_after(f);
    v_ = segment.velocity_after(f);
    left = left - t;
    elapsed_ += value_of(t);
  }

  HopperLinearParameters<T> p_;
  Effects<T> e_;
  T stiffness_, restitution_touchdown_, inverse_mass_, kappa_stance_, delta_stance_, delta_flight_;
  T touchdown_height_{}, leg_reach_squared_{}, constant_force_{}, leg_force_at_zero_{}, leg_damping_{};

  T z_{}, v_{};
  bool stance_ = false;
  V step_ = V(-1);
  Flow<T> full_stance_{}, full_flight_{}, scratch_{};
  V elapsed_ = V(0);
  std::array<ContactEvent<V>, kMaxEvents> events_{};
  std::size_t event_count_ = 0;
};

}  // namespace furcula::dynamics
