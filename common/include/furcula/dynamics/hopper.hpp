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
        rest_height_(e_.value_or(Effect::rest_height_error, p.rest_height_m)),
        restitution_touchdown_(e_.value_or(Effect::touchdown_loss, p.restitution_touchdown)),
        restitution_liftoff_(e_.value_or(Effect::liftoff_loss, p.restitution_liftoff)),
        mass_(e_.value_or(Effect::mass_error, p.mass_kg)),
        inverse_mass_(T(V(1)) / mass_),
        kappa_stance_(stiffness_ * inverse_mass_) {
    using std::cos;
    T guide = p.damping_flight_nspm;
    if (e_.has(Effect::damping_error)) guide += e_.value(Effect::damping_error);
    leg_damping_ = p.damping_stance_nspm - p.damping_flight_nspm;
    delta_flight_ = guide * inverse_mass_;
    delta_stance_ = (guide + leg_damping_) * inverse_mass_;
    touchdown_height_ = V(2) * p.link_length_m * cos(p.touchdown_angle_rad);
    leg_reach_squared_ = V(4) * p.link_length_m * p.link_length_m;
    constant_force_ = -mass_ * p.gravity_mps2;
    if (e_.has(Effect::guide_tilt)) constant_force_ *= cos(e_.value(Effect::guide_tilt));
    if (e_.has(Effect::force_offset)) constant_force_ += e_.value(Effect::force_offset);
    leg_force_at_zero_ = stiffness_ * rest_height_;
    if (e_.has(Effect::spring_preload)) leg_force_at_zero_ += e_.value(Effect::spring_preload);
  }

  /// Starts at a height (m) and velocity (m/s), in flight if above the touch-down height, else in stance.
  void reset(const T& height_m, const T& velocity_mps) {
    z_ = height_m;
    v_ = velocity_mps;
    stance_ = value_of(z_) <= value_of(touchdown_height_);
    toe_ = T(V(0));
    event_count_ = 0;
  }

  /// Moves on by `dt_s` >= 0 with the motor's torque held (what the drive makes of its command:
  /// actuation.hpp). Steps longer than kLongestStep are divided.
  void advance(const T& torque, V dt_s) {
    event_count_ = 0;
    elapsed_ = V(0);
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
  static constexpr double kStopStiffness =
      6000.0;  ///< of the leg's stop, N/m (docs/contracts.md, toe_sticking)

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
    toe_ = T(V(0));
    record(ContactEvent<V>::Kind::touchdown, before, v_);
  }
  void lift_off() {
    const T before = v_;
    v_ = restitution_liftoff_ * v_;
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
    // A toe that sticks holds the leg beyond its stop, which then stretches as a stiff spring.
    const bool sticks = stance_ && e_.has(Effect::toe_sticking);
    const bool stretched = sticks && (value_of(z_) > value_of(touchdown_height_) ||
                                      (value_of(z_) == value_of(touchdown_height_) && value_of(v_) > V(0)));
    const V most_pull = sticks ? value_of(e_.value(Effect::toe_sticking)) : V(0);
    const T stiffness = stretched ? T(stiffness_ + V(kStopStiffness)) : stiffness_;
    const T midpoint = z_ + v_ * (V(0.5) * h);
    if (stance_) {
      leg_constant = leg_force_at_zero_ + driven(torque, midpoint) * force_per_torque(midpoint);
      if (stretched) leg_constant += touchdown_height_ * V(kStopStiffness);
      if (e_.has(Effect::spring_hardening)) {
        const T stretch = midpoint - rest_height_;
        leg_constant -= e_.value(Effect::spring_hardening) * stretch * stretch * stretch;
      }
      if (e_.has(Effect::ground_compliance)) give_way(leg_constant, midpoint, h);
      const auto leg_force = [&](const T& z) {
        return value_of(leg_constant) - value_of(stiffness) * value_of(z) -
               value_of(leg_damping_) * value_of(v_);
      };
      const bool rises = value_of(v_) > V(0);
      if (rises && leg_force(z_) <= -most_pull) {
        lift_off();
        return false;
      }
      leg_acts = rises || leg_force(midpoint) > V(0);
    }
    T force = leg_acts ? T(constant_force_ + leg_constant) : constant_force_;
    const T& delta = leg_acts ? delta_stance_ : delta_flight_;
    const T kappa = !leg_acts ? T(V(0)) : stretched ? T(stiffness * inverse_mass_) : kappa_stance_;
    T acceleration = force * inverse_mass_ - kappa * z_;

    // Direction of the motion; at rest, of the motion that would begin.
    const bool at_rest = value_of(v_) == V(0);
    const bool up = at_rest ? value_of(acceleration) > V(0) : value_of(v_) > V(0);
    if (e_.any()) {
      T extra = binding(e_, z_, T(z_ + v_ * h));
      if (leg_acts && e_.has(Effect::spring_hysteresis))
        extra += e_.value(Effect::spring_hysteresis) * spring_force_size(midpoint);
      const Resisted<T> r = resisted(e_, up, at_rest, v_, acceleration, delta, inverse_mass_, extra, h);
      if (r.held) {
        elapsed_ += h;
        return true;
      }
      acceleration = r.acceleration;
      if (leg_acts && e_.has(Effect::leg_inertia)) slow_by_links(acceleration, kappa, delta, midpoint, h);
    }

    if (!stance_ && !up && value_of(z_) <= value_of(touchdown_height_)) {
      touch_down();
      return false;
    }

    const Segment<T> segment{z_, v_, acceleration, kappa, delta};
    const Flow<T>& whole =
        full && !stretched ? (leg_acts ? full_stance_ : full_flight_) : (scratch_ = segment.over(left));
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
        return leg_constant - stiffness * z - leg_damping_ * v;
      };
      const bool reaches = !stretched && value_of(z_end) >= value_of(touchdown_height_);
      const bool unloads = leg_acts && value_of(leg_force(z_end, v_end)) <= -most_pull;
      if (reaches || unloads) {
        const V to = value_of(t_end);
        T t = t_end;
        if (reaches && value_of(z_) < value_of(touchdown_height_))
          t = segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), to);
        else if (reaches)
          t = T(V(0));
        bool by_height = reaches;
        if (unloads) {
          const T pull = sticks ? T(leg_constant + e_.value(Effect::toe_sticking)) : leg_constant;
          const T t_unload = segment.crossing_time(-stiffness, -leg_damping_, pull, V(0), to);
          if (!reaches || value_of(t_unload) < value_of(t)) {
            t = t_unload;
            by_height = false;
          }
        }
        arrive(segment, t, left);
        if (by_height) z_ = touchdown_height_;
        if (!(by_height && sticks)) lift_off();
        return false;
      }
    }
    if (stretched && !up && value_of(z_end) < value_of(touchdown_height_)) {
      arrive(segment, segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), value_of(t_end)),
             left);
      z_ = touchdown_height_;
      return false;
    }
    z_ = z_end;
    if (stance_ && e_.has(Effect::ground_compliance)) toe_ = toe_after(t_end);
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
    if (stance_ && e_.has(Effect::ground_compliance)) toe_ = toe_after(t);
    left = left - t;
    elapsed_ += value_of(t);
  }

  T driven(const T& torque, const T& z) const {
    using std::acos;
    if (!e_.has(Effect::torque_ripple)) return torque;
    return torque + torque_ripple(e_, T(acos(z / (V(2) * p_.link_length_m))));
  }

  /// Size of the spring's force at a height, preload and hardening included.
  T spring_force_size(const T& z) const {
    T force = leg_force_at_zero_ - stiffness_ * z;
    if (e_.has(Effect::spring_hardening)) {
      const T stretch = z - rest_height_;
      force -= e_.value(Effect::spring_hardening) * stretch * stretch * stretch;
    }
    return value_of(force) < V(0) ? T(-force) : force;
  }

  /// The ground gives: spring and damper under a toe without mass, in series with the leg. Leg and ground
  /// force are equal, so that the toe relaxes to where the springs balance with the time constant (dl + dg) /
  /// (k + kg). Adds to the leg's force what the toe's mean place and speed over `h` seconds make of it.
  void give_way(T& leg_constant, const T& z, V h) {
    using std::exp;
    const T& ground_stiffness = e_.value(Effect::ground_compliance, 0);
    const T& ground_damping = e_.value(Effect::ground_compliance, 1);
    const T rigid = leg_constant - stiffness_ * z - leg_damping_ * v_;
    toe_rate_ = (stiffness_ + ground_stiffness) / (leg_damping_ + ground_damping + V(1e-6));
    toe_balance_ = -rigid / (stiffness_ + ground_stiffness);
    const T decay = exp(-(toe_rate_ * h));
    const T mean = toe_balance_ + (toe_ - toe_balance_) * (V(1) - decay) / (toe_rate_ * h);
    const T rate = (toe_balance_ - toe_) * (V(1) - decay) / h;
    toe_on_stop_ = value_of(z) - value_of(mean) > value_of(touchdown_height_);
    if (toe_on_stop_)  // the leg is at its full length: the body stands on the ground's spring alone
      leg_constant += -ground_stiffness * (z - touchdown_height_) - ground_damping * v_ - rigid;
    else
      leg_constant += stiffness_ * mean + leg_damping_ * rate;
  }
  T toe_after(const T& t) const {
    using std::exp;
    return toe_on_stop_ ? T(z_ - touchdown_height_)
                        : T(toe_balance_ + (toe_ - toe_balance_) * exp(-(toe_rate_ * t)));
  }

  /// The links turn with the folding leg: M(z) z'' + M'(z) z'^2 / 2 = force + g e / (2 L), with M = m - e / L
  /// + (a - 2 L b cos 2 theta) / (2 L sin theta)^2 (docs/physics.md, the non-linear leg on the ground).
  /// Changes the acceleration by the difference at the step's midpoint.
  void slow_by_links(T& acceleration, const T& kappa, const T& delta, const T& z, V h) const {
    const T& a = e_.value(Effect::leg_inertia, 0);
    const T& b = e_.value(Effect::leg_inertia, 1);
    const T& e = e_.value(Effect::leg_inertia, 2);
    const T length = V(2) * p_.link_length_m;
    const T cosine = z / length;
    const T numerator = a + length * b * (V(1) - V(2) * cosine * cosine);
    const T denominator = leg_reach_squared_ - z * z;
    if (value_of(denominator) < V(1e-3) * value_of(leg_reach_squared_)) return;
    const T mass = mass_ - V(2) * e / length + numerator / denominator;
    const T slope = (V(2) * z * numerator / denominator - V(4) * b * cosine) / denominator;
    const T speed = v_ + (acceleration - delta * v_) * (V(0.5) * h);
    const T linear = acceleration - kappa * (z - z_) - delta * speed;
    const T force = linear * mass_ + p_.gravity_mps2 * e / length - V(0.5) * slope * speed * speed;
    acceleration += force / mass - linear;
  }

  HopperLinearParameters<T> p_;
  Effects<T> e_;
  T stiffness_, rest_height_, restitution_touchdown_, restitution_liftoff_, mass_, inverse_mass_,
      kappa_stance_;
  T delta_stance_{}, delta_flight_{};
  T touchdown_height_{}, leg_reach_squared_{}, constant_force_{}, leg_force_at_zero_{}, leg_damping_{};

  T z_{}, v_{};
  bool stance_ = false;
  T toe_{};  ///< height of the toe in stance: below zero where the ground gives
  T toe_balance_{}, toe_rate_{};
  bool toe_on_stop_ = false;
  V step_ = V(-1);
  Flow<T> full_stance_{}, full_flight_{}, scratch_{};
  V elapsed_ = V(0);
  std::array<ContactEvent<V>, kMaxEvents> events_{};
  std::size_t event_count_ = 0;
};

}  // namespace furcula::dynamics
