// The linear hopper (002 section 3.2.1 with the corrections of docs/physics.md): a body on a vertical guide,
// a virtual spring and a damper between hip and toe, a motor between the upper links. Exact inside a phase;
// touch-down, lift-off and turning points are located inside the step.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/dynamics/contact_event.hpp"
#include "furcula/dynamics/effects/laws.hpp"
#include "furcula/dynamics/key_timing.hpp"
#include "furcula/dynamics/links.hpp"
#include "furcula/dynamics/machines/hopper_nonlinear.hpp"
#include "furcula/dynamics/rotor.hpp"
#include "furcula/dynamics/segment.hpp"

namespace furcula::dynamics {

/// The plant. The equations, z the height of the centre of mass:
///   stance   m z'' = -k (z - z0) - ds z' - m g + F(tau, z) + effects
///            F = -tau / (2 L sin theta),   z = 2 L cos theta
///   flight   m z'' = -df z' - m g + effects on the guide
/// df acts in the guide in both phases, ds - df in the leg. Touch-down when z falls to 2 L cos(touchdown
/// angle); lift-off when, rising, z is back there or the ground's force is zero. The ground cannot pull:
/// while the body sinks and the leg would pull, the leg's force is zero. The torque is held over a step, its
/// lever arm and the forces that depend on speed are taken at the step's predicted midpoint (error of third
/// order in the step). A toe that sticks, a bump stop, a ground that gives and a rotor in its backlash add
/// states of the leg (Leg::State, straight_, rotor_), whose changes are located inside the step as well.
///
/// With a clutch (fit_clutch) the spring's far end is on a cable without mass, whose travel x is counted
/// along the leg. Held, the spring's rest height is z0 - x. Let go, the cable is in balance between the
/// spring and an auxiliary spring that is pretensioned to what the spring pulls with the leg straight (length
/// l0), so that the cable is home then:
///   k (z0 - x - l) = k (z0 - l0) + k_aux x
/// The leg's spring then has the rate k k_aux / (k + k_aux) below l0; of what it lacks to the rate k an
/// incomplete release leaves the ratio. Its times: dynamics/key_timing.hpp; the pressed key holds the cable at
/// the next whole pitch that its travel comes to.
///
/// A leg that the motor folds in flight has a prescribed motion (lead_leg): its length l is given, the toe is at
/// z - l, and the cable of a clutch follows it. Links of inertia share the momentum, m z' - e / (2 L) l' = constant but for
/// gravity and guide, and touch down with the plastic impact of the folded leg.
template <class T>
class Hopper {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;
  static constexpr int kMaxEvents = 16;  ///< in one step of at most kLongestStep

  /// A leg without inertia of its links; at rest at height 0 until reset(). Of the effects it uses those of mechanism and
  /// contact and those of the rotor (torque ripple, backlash).
  Hopper(const HopperLinearParameters<T>& p, const Effects<T>& effects = {})
      : p_(p),
        e_(effects),
        contact_(effects),
        rotor_(effects),
        stiffness_(e_.value_or(Effect::stiffness_error, p.stiffness_npm)),
        rest_height_(e_.value_or(Effect::rest_height_error, p.rest_height_m)),
        restitution_touchdown_(contact_.value_or(Effect::touchdown_loss, p.restitution_touchdown)),
        restitution_liftoff_(contact_.value_or(Effect::liftoff_loss, p.restitution_liftoff)),
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
    leg_is_more_ = e_.has(Effect::spring_hysteresis) || e_.has(Effect::leg_inertia);
    more_ = leg_is_more_ || contact_.has(Effect::toe_sticking) || contact_.has(Effect::ground_compliance) ||
            e_.has(Effect::spring_hardening) || e_.has(Effect::bump_stop) || !rotor_.ideal();
    stretched_stiffness_ = stiffness_ + V(kStopStiffness);
    kappa_stretched_ = stretched_stiffness_ * inverse_mass_;
    if (e_.has(Effect::bump_stop)) {
      stop_length_ = touchdown_height_ - e_.value(Effect::bump_stop, 0);
      stopped_stiffness_ = stiffness_ + e_.value(Effect::bump_stop, 1);
      kappa_stopped_ = stopped_stiffness_ * inverse_mass_;
    }
    if (contact_.has(Effect::ground_compliance)) {
      kappa_straight_ = contact_.value(Effect::ground_compliance, 0) * inverse_mass_;
      delta_straight_ = delta_flight_ + contact_.value(Effect::ground_compliance, 1) * inverse_mass_;
    }
    if (e_.has(Effect::guide_tilt))
      links_gravity_ = p.gravity_mps2 * cos(e_.value(Effect::guide_tilt));
    else
      links_gravity_ = p.gravity_mps2;
    led_length_ = touchdown_height_;
    if (e_.has(Effect::leg_inertia))
      share_of_folding_ = e_.value(Effect::leg_inertia, 2) / (V(2) * p.link_length_m * mass_);
  }

  /// With links that have inertia (hopper_nonlinear), the leg on its stop in flight. Their impacts are
  /// plastic (dynamics/links.hpp), and the model's restitutions multiply what these leave.
  Hopper(const HopperNonlinearParameters<T>& p, Effects<T> effects = {})
      : Hopper(static_cast<const HopperLinearParameters<T>&>(p), with_links(p, effects)) {
    const Links<T> links{p.inertia_a_kgm2, p.inertia_b_kgm, p.inertia_e_kgm, p.link_length_m, mass_};
    const auto straight = links.pose(p.touchdown_angle_rad);
    const T fall = T(V(1));
    plastic_ = true;
    led_restitution_ = restitution_touchdown_;
    restitution_touchdown_ *= -straight.lever * links.rate_after_touchdown(straight, zero_, fall);
    restitution_liftoff_ *= links.velocity_after_stop(straight, T(V(-1) / straight.lever), fall);
  }

  /// Gives it a clutch, caught, with its cable at rest. Not for a leg whose spring hardens: its stretch is computed
  /// for a cable at rest.
  void fit_clutch(const HopperClutchParameters<T>& p) {
    clutched_ = more_ = true;
    key_ = KeyTiming<T>(p.release_delay_s, e_.value_or(Effect::late_catch, p.catch_delay_s));
    pitch_ = p.tooth_pitch_m;
    caught_stiffness_ = stiffness_;
    const T auxiliary = e_.value_or(Effect::auxiliary_spring, p.auxiliary_stiffness_npm);
    loose_stiffness_ = stiffness_ * auxiliary / (stiffness_ + auxiliary);
    if (e_.has(Effect::incomplete_release))
      loose_stiffness_ += e_.value(Effect::incomplete_release) * (stiffness_ - loose_stiffness_);
    travel_per_shortening_ = T(V(1)) - loose_stiffness_ / stiffness_;
    home_force_ = leg_force_at_zero_;
    hold_cable(T(V(0)));
  }
  /// True after fit_clutch().
  bool has_clutch() const { return clutched_; }
  /// The key; after reset() in the teeth, its coil off.
  const KeyTiming<T>& key() const { return key_; }
  /// Switches the coil on or off from now on.
  void energise(bool on) { key_.energise(on); }
  /// After reset(): the clutch at the start. A held cable's travel is `teeth` pitches.
  void start_clutch(const KeyTiming<T>& key, bool held, int teeth) {
    key_ = key;
    if (held) return hold_cable(T(static_cast<V>(teeth) * pitch_));
    let_cable_go();
    if (!key_.out()) press_key();
  }
  /// Travel of the cable for a length of the leg while it is let go, m.
  T loose_travel_m(const T& length_m) const {
    return value_of(length_m) < value_of(touchdown_height_)
               ? T((touchdown_height_ - length_m) * travel_per_shortening_)
               : T(V(0));
  }
  /// Travel of the cable from its rest, along the leg.
  T cable_travel_m() const { return cable_ == Cable::held ? travel_ : loose_travel_m(cable_length()); }
  bool cable_held() const { return cable_ == Cable::held; }  ///< the key holds the cable

  /// Starts at a height (m) and velocity (m/s), in flight if above the touch-down height, else in stance. A
  /// clutch starts caught, its cable at rest.
  void reset(const T& height_m, const T& velocity_mps) {
    if (clutched_) {
      key_.reset();
      hold_cable(zero_);
    }
    z_ = height_m;
    v_ = velocity_mps;
    stance_ = value_of(z_) <= value_of(touchdown_height_);
    toe_ = T(V(0));
    straight_ = false;
    rotor_.press(V(1));
    event_count_ = 0;
    led_ = false;
    led_length_ = touchdown_height_;
    led_rate_ = zero_;
  }

  /// Prescribes the leg's motion in flight for the next advance(): its length at the start, m, and its rate, m/s.
  void lead_leg(const T& length_m, const T& rate_mps) {
    if (!stance_) v_ += share_of_folding_ * (rate_mps - led_rate_);
    led_ = more_ = true;
    led_length_ = length_m;
    led_rate_ = rate_mps;
  }
  /// After reset(): the start is in flight with a leg of this length, m, and rate, m/s; the velocity given to reset()
  /// includes the body's motion due to that rate.
  void start_led(const T& length_m, const T& rate_mps) {
    stance_ = false;
    led_rate_ = rate_mps;
    lead_leg(length_m, rate_mps);
  }

  /// Puts the rotor to the end of the backlash to which the last torque before the start that was not zero (its
  /// sign counts) pressed it. Call it after reset(), which puts it to the end of positive torque.
  void press_rotor(V torque) { rotor_.press(torque); }
  /// True if there is a backlash between motor and leg.
  bool has_backlash() const { return rotor_.loose(); }

  /// Places the rotor for a start in flight: the leg's angle, rad, and its rate, rad/s, are those that an encoder on
  /// the motor's side measures.
  void place_rotor(V leg_angle_rad, V rate_radps) {
    rotor_.place(leg_angle_rad - value_of(leg_angle(T(z_ - toe_))), rate_radps);
  }

  /// Moves on by `dt_s` >= 0 with the motor's torque held (what the drive makes of its command:
  /// actuation.hpp). Steps longer than kLongestStep are divided.
  void advance(const T& torque, V dt_s) {
    event_count_ = 0;
    elapsed_ = V(0);
    if (dt_s <= V(0)) return;
    if (clutched_) {
      advance_clutched(torque, dt_s);
    } else {
      const int parts = dt_s <= kLongestStep ? 1 : 1 + static_cast<int>(dt_s / kLongestStep);
      const V h = parts == 1 ? dt_s : dt_s / static_cast<V>(parts);
      if (h != step_) prepare(h);
      for (int i = 0; i < parts; ++i) step(torque);
    }
    if (led_) end_leading(dt_s);
  }

  const T& height_m() const { return z_; }      ///< of the body's centre of mass above the ground
  const T& velocity_mps() const { return v_; }  ///< of the body, positive upwards
  bool in_stance() const { return stance_; }    ///< between a touch-down and the next lift-off
  /// Height of the body at touch-down with a straight leg.
  const T& touchdown_height_m() const { return touchdown_height_; }

  /// Leg angle from the vertical on the motor's side, rad: that of the stop in flight, except where the leg's motion is
  /// prescribed.
  T leg_angle_rad() const {
    using std::acos;
    if (led_ && !stance_ && value_of(led_length_) < value_of(touchdown_height_))
      return acos(led_length_ / (V(2) * p_.link_length_m));
    const T angle = leg_angle(T(z_ - toe_));
    return rotor_.loose() ? T(angle + rotor_.angle()) : angle;
  }

  /// Touch-downs and lift-offs inside the last advance(), in order; offsets from its start, s.
  std::span<const ContactEvent<V>> events() const { return {events_.data(), event_count_}; }

 private:
  static constexpr V kLongestStep = V(2e-3);
  static constexpr double kStopStiffness =
      6000.0;  ///< of the leg's stop, N/m (docs/contracts.md, toe_sticking)

  static Effects<T> with_links(const HopperNonlinearParameters<T>& p, Effects<T> effects) {
    effects.set(Effect::leg_inertia, {p.inertia_a_kgm2, p.inertia_b_kgm, p.inertia_e_kgm});
    return effects;
  }

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
    straight_ = true;
    if (led_ && value_of(led_now()) < value_of(touchdown_height_))
      touch_down_folded(led_now());
    else
      v_ = restitution_touchdown_ * v_;
    stance_ = true;
    toe_ = T(V(0));
    if (led_ && cable_ == Cable::pressed) aim(true, value_of(loose_travel_m(z_)) / value_of(pitch_));
    record(ContactEvent<V>::Kind::touchdown, before, v_);
  }
  void lift_off() {
    const T before = v_;
    v_ = restitution_liftoff_ * v_;
    if (led_) v_ += share_of_folding_ * led_rate_;
    stance_ = false;
    toe_ = T(V(0));
    if (cable_ == Cable::pressed) hold_cable(zero_);  // the leg is straight, the cable home
    record(ContactEvent<V>::Kind::liftoff, before, v_);
  }

  /// Length of a led leg now, and in `t`.
  T led_now() const { return led_length_ + led_rate_ * elapsed_; }
  T led_after(const T& t) const { return led_now() + led_rate_ * t; }
  void touch_down_folded(const T& length) {
    using std::acos;
    straight_ = false;
    if (!plastic_) {
      v_ = restitution_touchdown_ * v_;
      return;
    }
    const Links<T> links{e_.value(Effect::leg_inertia, 0), e_.value(Effect::leg_inertia, 1),
                         e_.value(Effect::leg_inertia, 2), p_.link_length_m, mass_};
    const auto pose = links.pose(T(acos(length / (V(2) * p_.link_length_m))));
    v_ =
        -(led_restitution_ * pose.lever * links.rate_after_touchdown(pose, T(-(led_rate_ / pose.lever)), v_));
  }
  /// When the toe of a led leg, above the ground now, meets it; before `t_end`.
  T landing_time(const Segment<T>& segment, const T& t_end) const {
    const Segment<V> p = segment.plain();
    const V length = value_of(led_now()), rate = value_of(led_rate_);
    const V time = event_time<V>(
        V(0), value_of(t_end), [&](V t) { return p.position_after(p.over(t)) - length - rate * t; },
        [&](V t) { return p.velocity_after(p.over(t)) - rate; });
    const V slope = p.velocity_after(p.over(time)) - rate;
    if (slope == V(0)) return T(time);
    const T at = T(time);
    return at - (segment.position_after(segment.over(at)) - led_after(at)) / slope;
  }
  /// The leg's length after `dt_s`; a pressed key that a tooth of the cable has come to holds it.
  void end_leading(V dt_s) {
    using std::ceil;
    using std::floor;
    const V from = value_of(loose_travel_m(led_length_));
    led_length_ += led_rate_ * dt_s;
    elapsed_ = V(0);
    if (stance_ || cable_ != Cable::pressed) return;
    const V a = from / value_of(pitch_), b = value_of(loose_travel_m(led_length_)) / value_of(pitch_);
    const V tooth = b > a ? floor(b) : ceil(b);
    if (!(b > V(0)) || (b > a ? tooth > a : tooth < a)) hold_cable(T(tooth * pitch_));
  }
  /// That the cable follows.
  T cable_length() const { return led_ && !stance_ ? led_now() : T(z_ - toe_); }

  /// One step of step_ seconds.
  void step(const T& torque) {
    T left = T(step_);
    for (int round = 0; round < kMaxEvents; ++round) {
      if (!(value_of(left) > V(0))) return;
      if (more_ ? move<true>(torque, left, round == 0) : move<false>(torque, left, round == 0)) return;
    }
    // So many events in one step means contacts without end (a body bouncing down to rest): it rests.
    v_ = T(V(0));
    elapsed_ += value_of(left);
  }

  /// The same for a leg with a clutch, whose key may come or go at any time.
  void advance_clutched(const T& torque, V dt_s) {
    constexpr V kShortest = V(1e-12);  // so that a piece of no length has its derivative
    T left = T(dt_s);
    while (value_of(left) > V(0)) {
      T until = value_of(left) > kLongestStep ? T(kLongestStep) : left;
      const bool changes = key_.changes_within(value_of(until));
      if (changes) until = key_.change_in() + kShortest;
      // Steps of one length, in which no key comes or goes, share their flow.
      const bool full = !changes && value_of(until) == dt_s;
      if (full && dt_s != step_) prepare(dt_s);
      T rest = until;
      bool moved = !(value_of(rest) > V(0));
      for (int round = 0; round < kMaxEvents && !moved && value_of(rest) > V(0); ++round)
        moved = move<true>(torque, rest, full && round == 0);
      if (!moved && value_of(rest) > V(0)) {  // contacts without end, as in step()
        v_ = T(V(0));
        elapsed_ += value_of(rest);
      }
      key_.pass(until);
      left = left - until;
      if (!changes) continue;
      key_.change();
      if (key_.out())
        let_cable_go();
      else
        press_key();
    }
  }

  void hold_cable(const T& travel) {
    cable_ = Cable::held;
    travel_ = travel;
    set_spring(caught_stiffness_, T(home_force_ - caught_stiffness_ * travel));
  }
  /// Straight, the spring pulls with what it does when it is caught with the cable home.
  void let_cable_go() {
    cable_ = Cable::loose;
    set_spring(loose_stiffness_, T(home_force_ - (caught_stiffness_ - loose_stiffness_) * touchdown_height_));
  }
  void press_key() {
    const V at = value_of(loose_travel_m(cable_length())) / value_of(pitch_);
    const bool led = led_ && !stance_;
    const bool shortens = led ? value_of(led_rate_) < V(0) : stance_ && !(value_of(v_) > V(0));
    // In flight nothing pulls at the belt: within half a pitch the key comes down into the gap that it left.
    if (led ? at < V(0.5) : !(at > V(0)) && !shortens) return hold_cable(T(V(0)));
    cable_ = Cable::pressed;
    aim(shortens, at);
  }
  /// At the next whole pitch of the cable's travel.
  void aim(bool shortens, V at) {
    using std::ceil;
    using std::floor;
    constexpr V kJust = V(1e-9);
    tooth_ = shortens ? floor(at + kJust) + V(1) : ceil(at - kJust) - V(1);
    if (tooth_ < V(0)) tooth_ = V(0);
    tooth_shortens_ = shortens;
    tooth_height_ = value_of(travel_per_shortening_) > V(1e-6)
                        ? T(touchdown_height_ - tooth_ * pitch_ / travel_per_shortening_)
                        : T(V(-1));
  }
  void set_spring(const T& stiffness, const T& force_at_zero) {
    step_ = V(-1);
    stiffness_ = stiffness;
    kappa_stance_ = stiffness * inverse_mass_;
    leg_force_at_zero_ = force_at_zero;
    stretched_stiffness_ = stiffness_ + V(kStopStiffness);
    kappa_stretched_ = stretched_stiffness_ * inverse_mass_;
    if (e_.has(Effect::bump_stop)) {
      stopped_stiffness_ = stiffness_ + e_.value(Effect::bump_stop, 1);
      kappa_stopped_ = stopped_stiffness_ * inverse_mass_;
    }
  }

  /// What the leg does to the body over the rest of a step: constant - stiffness z - damping v, all of it
  /// through the toe.
  struct Leg {
    enum class State : std::uint8_t {
      away,       ///< in flight, or the ground would have to pull
      flexes,     ///< spring, damper and motor act
      stretched,  ///< held by a toe that sticks: its stop pulls as well
      stopped,    ///< so short that its bump stop pushes as well
      straight    ///< on its stop on a ground that gives
    } state = State::away;
    T constant{};
    T hysteresis{};  ///< >= 0, against the motion; not in `constant`
  };

  const T& leg_stiffness() const {
    return leg_.state == Leg::State::stretched  ? stretched_stiffness_
           : leg_.state == Leg::State::stopped  ? stopped_stiffness_
           : leg_.state == Leg::State::straight ? contact_.value(Effect::ground_compliance, 0)
                                                : stiffness_;
  }
  const T& leg_damping() const {
    return leg_.state == Leg::State::straight ? contact_.value(Effect::ground_compliance, 1) : leg_damping_;
  }

  /// Moves until `left` is used up (returns true) or to the next event (takes it and shortens `left`).
  /// `kMore` false: the leg is spring, damper and motor, and what only other legs need is left out.
  template <bool kMore>
  bool move(const T& torque, T& left, bool full) {
    const V h = value_of(left);
    const T midpoint = !stance_ ? z_ : full ? T(z_ + v_ * (V(0.5) * h)) : T(z_ + v_ * (V(0.5) * left));
    const bool sticks = kMore && stance_ && contact_.has(Effect::toe_sticking);
    const bool soft = kMore && stance_ && contact_.has(Effect::ground_compliance);
    const bool links = kMore && stance_ && e_.has(Effect::leg_inertia);
    const V most_pull = sticks ? value_of(contact_.value(Effect::toe_sticking)) : V(0);
    const bool rises = value_of(v_) > V(0);
    if (kMore && full && rotor_.loose()) let_rotor_go(torque);

    leg_.state = Leg::State::away;
    if (stance_) {
      take_leg<kMore>(torque, midpoint, left);
      if (links) turn_links(midpoint);
      if (kMore && leg_is_more_) toe_force_ = force_on_toe(rises);
      if (rises && toe_force_at<kMore>(z_, v_) <= -most_pull) {
        lift_off();
        return false;
      }
      if (!rises && toe_force_at<kMore>(midpoint, v_) <= -most_pull) leg_.state = Leg::State::away;
    }
    const bool leg_acts = leg_.state != Leg::State::away;
    const bool flexes = leg_.state == Leg::State::flexes;  // within its length
    const bool stretched = kMore && leg_.state == Leg::State::stretched;
    const bool stopped = kMore && leg_.state == Leg::State::stopped;
    const bool straight = kMore && leg_.state == Leg::State::straight;
    const bool folds = flexes || stretched || stopped;  // with spring and damper
    T force = leg_acts ? T(constant_force_ + leg_.constant) : constant_force_;
    if (links && leg_acts) force += links_weight_;
    const T& delta = folds ? delta_stance_ : straight ? delta_straight_ : delta_flight_;
    const T& kappa = flexes      ? kappa_stance_
                     : stretched ? kappa_stretched_
                     : stopped   ? kappa_stopped_
                     : straight  ? kappa_straight_
                                 : zero_;
    T acceleration = leg_acts ? T(force * inverse_mass_ - kappa * z_) : T(force * inverse_mass_);

    // Direction of the motion; at rest, of the motion that would begin.
    const bool at_rest = value_of(v_) == V(0);
    const bool up = at_rest ? value_of(acceleration) > V(0) : value_of(v_) > V(0);
    if (e_.any()) {
      T extra = binding(e_, z_, T(z_ + v_ * left));
      if (kMore && folds && e_.has(Effect::spring_hysteresis)) extra += leg_.hysteresis;
      const Resisted<T> r =
          full ? resisted(e_, up, at_rest, v_, acceleration, delta, inverse_mass_, extra, h)
               : resisted(e_, up, at_rest, v_, acceleration, delta, inverse_mass_, extra, left);
      if (r.held) {
        if (kMore && rotor_.crosses() && rotor_lands_on_still_leg(torque, left)) return false;
        elapsed_ += h;
        return true;
      }
      acceleration = r.acceleration;
      if (links && folds) slow_by_links(acceleration, kappa, delta, left);
    }

    const bool led = kMore && led_ && !stance_;
    if (!stance_ && !up &&
        (led ? value_of(z_) <= value_of(led_now()) && !(value_of(v_) > value_of(led_rate_))
             : value_of(z_) <= value_of(touchdown_height_))) {
      touch_down();
      return false;
    }

    const Segment<T> segment{z_, v_, acceleration, kappa, delta};
    const Flow<T>& whole = full && (flexes || !leg_acts) ? (leg_acts ? full_stance_ : full_flight_)
                                                         : (scratch_ = segment.over(left));
    T z_end = segment.position_after(whole);
    T v_end = segment.velocity_after(whole);
    T t_end = left;
    // Up to a turning point the height is monotone, so that the ends tell whether it crosses anything.
    bool turns = up ? value_of(v_end) < V(0) : value_of(v_end) > V(0);
    if (turns) {
      t_end = segment.turning_time(h);
      z_end = segment.position_after(segment.over(t_end));
      v_end = zero_;
    }
    // So it may be up to where the rotor is through the backlash, or the leg comes to a stop or leaves it.
    Change change = Change::none;
    if (soft ||
        (kMore && (rotor_.crosses() || (stance_ && (e_.has(Effect::bump_stop) || cable_ == Cable::pressed)))))
      change = cut_short(segment, torque, up, t_end, z_end, v_end, turns);

    if (led && !up && value_of(z_) > value_of(led_now()) && value_of(z_end) < value_of(led_after(t_end))) {
      const T t = landing_time(segment, t_end);
      const T length = led_after(t);
      arrive<kMore>(segment, t, left);
      z_ = length;
      touch_down();
      return false;
    }
    if (!stance_ && !led && !up && value_of(z_end) < value_of(touchdown_height_)) {
      const T t = segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), value_of(t_end));
      arrive<kMore>(segment, t, left);
      z_ = touchdown_height_;
      touch_down();
      return false;
    }
    if (stance_ && up) {
      const bool reaches = !stretched && !soft && value_of(z_end) >= value_of(touchdown_height_);
      const bool unloads = leg_acts && toe_force_at<kMore>(z_end, v_end) <= -most_pull;
      if (reaches || unloads) {
        const V to = value_of(t_end);
        T t = t_end;
        if (reaches && value_of(z_) < value_of(touchdown_height_))
          t = segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), to);
        else if (reaches)
          t = T(V(0));
        bool by_height = reaches;
        if (unloads) {
          ToeForce f = kMore && leg_is_more_ ? toe_force_ : force_on_toe(rises);
          if (sticks) f.constant += contact_.value(Effect::toe_sticking);
          const T t_unload = segment.crossing_time(f.per_height, f.per_speed, f.constant, V(0), to);
          if (!reaches || value_of(t_unload) < value_of(t)) {
            t = t_unload;
            by_height = false;
          }
        }
        arrive<kMore>(segment, t, left);
        if (by_height) z_ = touchdown_height_;
        if (!(by_height && sticks)) lift_off();
        return false;
      }
    }
    if (stretched && !up && value_of(z_end) < value_of(touchdown_height_)) {
      arrive<kMore>(segment,
                    segment.crossing_time(T(V(1)), T(V(0)), -touchdown_height_, V(0), value_of(t_end)), left);
      z_ = touchdown_height_;
      return false;
    }
    if (soft) toe_ = toe_after(t_end, z_end, true);
    z_ = z_end;
    v_ = v_end;
    elapsed_ += value_of(t_end);
    if (kMore && rotor_.crosses()) rotor_.follow(t_end, leg_angle(T(z_ - toe_)), leg_speed(z_, v_));
    if (change == Change::rotor) land_rotor();
    if (change == Change::stop) z_ = stop_length_;
    if (change == Change::tooth) {
      z_ = tooth_height_;
      hold_cable(T(tooth_ * pitch_));
    }
    if (change == Change::straightens || change == Change::flexes) straight_ = change == Change::straightens;
    if (!turns && change == Change::none) return true;
    left = left - t_end;
    return false;
  }

  /// What ends a piece of a step besides turning points, touch-down and lift-off: the rotor arrives, a leg on
  /// a ground that gives comes to its full length or leaves it, a leg on hard ground comes to its bump stop
  /// or leaves it, the pressed key meets a tooth (by the body's height, on a ground that gives too).
  enum class Change : std::uint8_t { none, rotor, straightens, flexes, stop, tooth };
  Change cut_short(const Segment<T>& segment, const T& torque, bool up, T& t_end, T& z_end, T& v_end,
                   bool& turns) {
    const bool soft = stance_ && contact_.has(Effect::ground_compliance);
    Change change = Change::none;
    const auto end_at = [&](const T& t, Change what) {
      const Flow<T> f = segment.over(t);
      t_end = t;
      z_end = segment.position_after(f);
      v_end = segment.velocity_after(f);
      turns = false;
      change = what;
    };
    if (rotor_.crosses()) {
      rotor_.set_out(motor_torque(torque, T(z_ - toe_)), leg_angle(T(z_ - toe_)), leg_speed(z_, v_));
      if (rotor_.past(t_end, leg_angle(T(z_end - toe_after(t_end, z_end, soft)))))
        end_at(rotor_arrival(segment, value_of(t_end), soft), Change::rotor);
    }
    if (soft && up && leg_.state == Leg::State::flexes) {
      const T t = straightening_time(segment, t_end, z_end);
      if (value_of(t) < value_of(t_end)) end_at(t, Change::straightens);
    } else if (leg_.state == Leg::State::straight && toe_force_at(z_end, v_end) > value_of(leg_push_)) {
      // From where the ground pushes more than the leg, the leg flexes.
      if (toe_force_at(z_, v_) >= value_of(leg_push_))
        end_at(zero_, Change::flexes);
      else
        end_at(segment.crossing_time(-leg_stiffness(), -leg_damping(), T(leg_.constant - leg_push_), V(0),
                                     value_of(t_end)),
               Change::flexes);
    }
    const V stop = value_of(stop_length_);
    const bool led = led_ && !stance_;
    if (!led && e_.has(Effect::bump_stop) && !soft &&
        (on_bump_stop() ? up && value_of(z_end) > stop : !up && value_of(z_end) < stop))
      end_at(segment.crossing_time(T(V(1)), T(V(0)), -stop_length_, V(0), value_of(t_end)), Change::stop);
    if (!led && cable_ == Cable::pressed) {
      if (tooth_shortens_ == up) aim(!up, value_of(loose_travel_m(z_)) / value_of(pitch_));
      const V tooth = value_of(tooth_height_);
      if (up ? value_of(z_end) > tooth && tooth < value_of(touchdown_height_) : value_of(z_end) < tooth)
        end_at(segment.crossing_time(T(V(1)), T(V(0)), -tooth_height_, V(0), value_of(t_end)), Change::tooth);
    }
    return change;
  }

  template <bool kMore>
  void arrive(const Segment<T>& segment, const T& t, T& left) {
    const Flow<T> f = segment.over(t);
    z_ = segment.position_after(f);
    v_ = segment.velocity_after(f);
    if (kMore && stance_ && contact_.has(Effect::ground_compliance)) toe_ = toe_after(t, z_, true);
    if (kMore && rotor_.crosses()) rotor_.follow(t, leg_angle(T(z_ - toe_)), leg_speed(z_, v_));
    left = left - t;
    elapsed_ += value_of(t);
  }

  /// The ground's force on the toe, linear in height and speed over the rest of a step.
  struct ToeForce {
    T constant{}, per_height{}, per_speed{};
  };
  ToeForce force_on_toe(bool rises) const {
    ToeForce out{leg_.constant, -leg_stiffness(), -leg_damping()};
    if (leg_.state == Leg::State::straight) return out;
    if (e_.has(Effect::spring_hysteresis)) {
      if (rises)
        out.constant -= leg_.hysteresis;
      else
        out.constant += leg_.hysteresis;
    }
    if (!e_.has(Effect::leg_inertia)) return out;
    // The momentum of body and links is (m - e / (2 L)) z': it changes by gravity, guide and ground alone.
    const T share = (mass_ - links_lift_) / links_mass_;
    const T guide = constant_force_ + resistance(e_, rises, v_, binding(e_, z_, z_));
    out.constant =
        share * (out.constant + links_weight_ - V(0.5) * links_slope_ * v_ * v_) + (share - V(1)) * guide;
    out.per_height *= share;
    out.per_speed = share * out.per_speed - (share - V(1)) * delta_flight_ * mass_;
    return out;
  }
  template <bool kMore = true>
  V toe_force_at(const T& z, const T& v) const {
    if (kMore && leg_is_more_)
      return value_of(toe_force_.constant) + value_of(toe_force_.per_height) * value_of(z) +
             value_of(toe_force_.per_speed) * value_of(v);
    const V stiffness = value_of(kMore ? leg_stiffness() : stiffness_);
    const V damping = value_of(kMore ? leg_damping() : leg_damping_);
    return value_of(leg_.constant) - stiffness * value_of(z) - damping * value_of(v);
  }

  /// What the leg does over the next `h` seconds of stance.
  template <bool kMore>
  void take_leg(const T& torque, const T& midpoint, const T& h) {
    leg_.state = Leg::State::flexes;
    if (!kMore) {
      leg_.constant = leg_force_at_zero_ + torque * force_per_torque(midpoint);
      return;
    }
    const T& top = touchdown_height_;
    if (contact_.has(Effect::ground_compliance)) {
      stand_on_soft_ground(torque, midpoint, h);
      return;
    }
    leg_.constant = push_at(torque, midpoint);
    // Beyond its bump stop the leg is a stiffer spring.
    if (e_.has(Effect::bump_stop) && on_bump_stop()) {
      leg_.state = Leg::State::stopped;
      leg_.constant += e_.value(Effect::bump_stop, 1) * stop_length_;
    }
    // A toe that sticks holds the leg beyond its full length, where its stop is a stiff spring.
    if (contact_.has(Effect::toe_sticking) &&
        (value_of(z_) > value_of(top) || (value_of(z_) == value_of(top) && value_of(v_) > V(0)))) {
      leg_.state = Leg::State::stretched;
      leg_.constant += top * V(kStopStiffness);
    }
    if (e_.has(Effect::spring_hysteresis))
      leg_.hysteresis = e_.value(Effect::spring_hysteresis) * spring_force_size(midpoint);
  }

  /// Whether a leg on hard ground is at its bump stop, for the way that it moves.
  bool on_bump_stop() const {
    return value_of(z_) < value_of(stop_length_) ||
           (value_of(z_) == value_of(stop_length_) && value_of(v_) < V(0));
  }
  /// Force of the bump stop at a length.
  T bump_stop_at(const T& length) const {
    return e_.has(Effect::bump_stop) && value_of(length) < value_of(stop_length_)
               ? T(e_.value(Effect::bump_stop, 1) * (stop_length_ - length))
               : zero_;
  }

  /// The leg's force without spring (but its constant part and its hardening) and damper, at a length. On a
  /// ground that gives with its bump stop, which on hard ground is a state of the leg.
  T push_at(const T& torque, const T& length) const {
    T push = leg_force_at_zero_;
    if (!rotor_.crosses()) push += motor_torque(torque, length) * force_per_torque(length);
    if (e_.has(Effect::spring_hardening)) {
      const T stretch = length - rest_height_;
      push -= e_.value(Effect::spring_hardening) * stretch * stretch * stretch;
    }
    if (contact_.has(Effect::ground_compliance)) push += bump_stop_at(length);
    return push;
  }

  /// Angle of the leg from the vertical at a length, on its stop in flight and beyond its full length.
  T leg_angle(const T& length) const {
    using std::acos;
    return stance_ && value_of(length) <= value_of(touchdown_height_)
               ? T(acos(length / (V(2) * p_.link_length_m)))
               : p_.touchdown_angle_rad;
  }
  /// Its rate, rad/s.
  T leg_speed(const T& z, const T& v) const {
    return stance_ && value_of(z - toe_) <= value_of(touchdown_height_) ? T(force_per_torque(T(z - toe_)) * v)
                                                                        : zero_;
  }
  T motor_torque(const T& torque, const T& length) const {
    return rotor_.ripples() ? T(torque + rotor_.ripple(leg_angle(length))) : torque;
  }

  /// Size of the spring's force at a length, preload and hardening included.
  T spring_force_size(const T& length) const {
    T force = leg_force_at_zero_ - stiffness_ * length;
    if (e_.has(Effect::spring_hardening)) {
      const T stretch = length - rest_height_;
      force -= e_.value(Effect::spring_hardening) * stretch * stretch * stretch;
    }
    return value_of(force) < V(0) ? T(-force) : force;
  }

  /// The ground gives: spring kg and damper dg under a toe without mass. Leg and ground push on it equally:
  ///   push - k (z - y) - dl (z' - y') = -kg y - dg y'
  /// so that the toe y relaxes to where the springs balance with the time constant (dl + dg) / (k + kg),
  /// which is solved exactly for a balance that moves evenly over the step. A leg at its full length takes
  /// the toe along until the ground pushes more than the leg.
  void stand_on_soft_ground(const T& torque, const T& midpoint, const T& h) {
    using std::exp;
    const T& ground_stiffness = contact_.value(Effect::ground_compliance, 0);
    const T& ground_damping = contact_.value(Effect::ground_compliance, 1);
    const auto opposed = [&](const T& length) {  // the motion's direction is the body's
      if (!e_.has(Effect::spring_hysteresis) || value_of(v_) == V(0)) return zero_;
      const T size = e_.value(Effect::spring_hysteresis) * spring_force_size(length);
      return value_of(v_) > V(0) ? T(-size) : size;
    };
    if (straight_) {
      const T& top = touchdown_height_;
      leg_push_ = push_at(torque, top) + opposed(top) - stiffness_ * top;
      const V ground = -value_of(ground_stiffness) * (value_of(z_) - value_of(top)) -
                       value_of(ground_damping) * value_of(v_);
      const V push = value_of(leg_push_);
      straight_ =
          ground - push <= V(1e-9) * ((ground < V(0) ? -ground : ground) + (push < V(0) ? -push : push));
      if (straight_) {
        leg_.state = Leg::State::straight;
        leg_.constant = ground_stiffness * top;
        return;
      }
    }
    toe_rate_ = (stiffness_ + ground_stiffness) / (leg_damping_ + ground_damping + V(1e-6));
    const T total = stiffness_ + ground_stiffness;
    const T slow = T(V(1)) / toe_rate_;
    T push{};
    T length = midpoint - toe_;
    for (int pass = 0; pass < 2; ++pass) {  // first the balance, then what moves it, at the toe's true place
      push = push_at(torque, length) + opposed(length);
      const T start = -(push - stiffness_ * z_ - leg_damping_ * v_) / total;
      const T toe_speed = (start - toe_) * toe_rate_;
      const T acceleration =
          (push - stiffness_ * (z_ - toe_) - leg_damping_ * (v_ - toe_speed) + constant_force_) *
              inverse_mass_ -
          delta_flight_ * v_;
      const T v_middle = v_ + acceleration * (V(0.5) * h);
      toe_drift_ = (stiffness_ * v_middle + leg_damping_ * acceleration) / total;
      toe_balance_ =
          -(push - stiffness_ * midpoint - leg_damping_ * v_middle) / total - toe_drift_ * (V(0.5) * h);
      if (pass == 0) length = midpoint - toe_relaxed(T(V(0.5) * h));
    }
    const T end = toe_relaxed(h);
    const T mean = toe_balance_ + toe_drift_ * (V(0.5) * h - slow) +
                   (toe_ - toe_balance_ + toe_drift_ * slow) * (V(1) - exp(-(toe_rate_ * h))) * slow / h;
    leg_.constant = push + stiffness_ * mean + leg_damping_ * (end - toe_) / h;
    leg_.hysteresis = zero_;  // is in the push, but for what holds at rest
    if (e_.has(Effect::spring_hysteresis) && value_of(v_) == V(0))
      leg_.hysteresis = e_.value(Effect::spring_hysteresis) * spring_force_size(length);
  }
  /// Where the toe under a flexing leg is `t` into the piece of the step.
  T toe_relaxed(const T& t) const {
    using std::exp;
    const T lag = toe_drift_ / toe_rate_;
    return toe_balance_ + toe_drift_ * t - lag + (toe_ - toe_balance_ + lag) * exp(-(toe_rate_ * t));
  }
  T toe_after(const T& t, const T& z, bool soft) const {
    return !soft ? toe_ : straight_ ? T(z - touchdown_height_) : toe_relaxed(t);
  }
  /// When a rising leg on a ground that gives comes to its full length; `t_end` if not before.
  T straightening_time(const Segment<T>& segment, const T& t_end, const T& z_end) const {
    const V top = value_of(touchdown_height_);
    if (value_of(z_end) - value_of(toe_relaxed(t_end)) <= top) return t_end;
    const Segment<V> p = segment.plain();
    const V rate = value_of(toe_rate_), drift = value_of(toe_drift_), lag = drift / rate;
    const V balance = value_of(toe_balance_), excess = value_of(toe_) - balance + lag;
    const auto decay = [&](V t) {
      using std::exp;
      return excess * exp(-rate * t);
    };
    const V time = event_time<V>(
        V(0), value_of(t_end),
        [&](V t) { return p.position_after(p.over(t)) - (balance + drift * t - lag + decay(t)) - top; },
        [&](V t) { return p.velocity_after(p.over(t)) - drift + rate * decay(t); });
    // A leg that has just left its stop is not back at once.
    if (!(time > V(1e-6) * value_of(t_end))) return t_end;
    const V slope = p.velocity_after(p.over(time)) - drift + rate * decay(time);
    if (slope == V(0)) return T(time);
    const T at = T(time);
    return at - (segment.position_after(segment.over(at)) - toe_relaxed(at) - touchdown_height_) / slope;
  }

  /// At a step's start: the rotor leaves its end if torque and leg part.
  void let_rotor_go(const T& torque) {
    V turning = V(0);  // acceleration of the leg without the motor's torque, rad/s^2
    if (stance_) {
      const V z = value_of(z_), v = value_of(v_), m = value_of(inverse_mass_);
      const V per_torque = value_of(force_per_torque(T(z_ - toe_)));
      const bool up = v > V(0);
      const V push = value_of(push_at(zero_, T(z_ - toe_)));
      const V stop = contact_.has(Effect::ground_compliance) ? V(0) : value_of(bump_stop_at(z_));
      const V leg = push + stop - value_of(stiffness_) * (z - value_of(toe_)) - value_of(leg_damping_) * v;
      V a = (value_of(constant_force_) + (leg > V(0) ? leg : V(0))) * m - value_of(delta_flight_) * v;
      if (v != V(0)) a += value_of(resistance(e_, up, v_, binding(e_, z_, z_))) * m;
      const V speed = per_torque * v;  // z = 2 L cos theta, differentiated twice
      turning = per_torque * (a + (z - value_of(toe_)) * speed * speed);
    }
    const T crossed = rotor_.let_go(motor_torque(torque, T(z_ - toe_)), turning);
    // The leg stays behind by the rotor's share of the angle.
    if (stance_ && value_of(crossed) != V(0))
      z_ -= force_per_torque(T(z_ - toe_)) * inverse_mass_ * Rotor<T>::kInertia * crossed;
  }
  T rotor_arrival(const Segment<T>& segment, V to, bool soft) const {
    const Segment<V> p = segment.plain();
    const auto place = [&](V t) { return p.position_after(p.over(t)); };
    const auto toe = [&](V t, V z) { return value_of(toe_after(T(t), T(z), soft)); };
    return rotor_.arrival_time(
        to, [&](V t) { return value_of(leg_angle(T(place(t) - toe(t, place(t))))); },
        [&](V t) { return value_of(leg_speed(T(place(t)), T(p.velocity_after(p.over(t))))); },
        [&](const T& t) {
          const T z = segment.position_after(segment.over(t));
          return leg_angle(T(z - toe_after(t, z, soft)));
        });
  }
  void land_rotor() {
    const T impulse = rotor_.land();
    if (stance_)
      v_ += force_per_torque(T(z_ - toe_)) * impulse / (e_.has(Effect::leg_inertia) ? links_mass_ : mass_);
  }
  /// While friction holds the leg. True if the rotor arrives before `left` is used up: then it has landed.
  bool rotor_lands_on_still_leg(const T& torque, T& left) {
    const T angle = leg_angle(T(z_ - toe_));
    rotor_.set_out(motor_torque(torque, T(z_ - toe_)), angle, zero_);
    const bool lands = rotor_.past(left, angle);
    const T t = lands ? rotor_.arrival_time(
                            value_of(left), [&](V) { return value_of(angle); }, [](V) { return V(0); },
                            [&](const T&) { return angle; })
                      : left;
    rotor_.follow(t, angle, zero_);
    if (!lands) return false;
    land_rotor();
    left = left - t;
    elapsed_ += value_of(t);
    return true;
  }

  /// The links turn with the folding leg: M(z) z'' + M'(z) z'^2 / 2 = force + g e / (2 L), with M = m - e / L
  /// + (a - 2 L b cos 2 theta) / (2 L sin theta)^2 (docs/physics.md, the non-linear leg on the ground). Takes
  /// M, M' and the links' share of the weight at the step's midpoint.
  void turn_links(const T& z) {
    const T& a = e_.value(Effect::leg_inertia, 0);
    const T& b = e_.value(Effect::leg_inertia, 1);
    const T& e = e_.value(Effect::leg_inertia, 2);
    const T length = V(2) * p_.link_length_m;
    const T cosine = z / length;
    const T numerator = a + length * b * (V(1) - V(2) * cosine * cosine);
    T denominator = leg_reach_squared_ - z * z;
    if (value_of(denominator) < V(1e-3) * value_of(leg_reach_squared_))
      denominator = V(1e-3) * leg_reach_squared_;
    links_mass_ = mass_ - V(2) * e / length + numerator / denominator;
    links_slope_ = (V(2) * z * numerator / denominator - V(4) * b * cosine) / denominator;
    links_lift_ = e / length;
    links_weight_ = links_gravity_ * links_lift_;
  }
  /// Changes the acceleration of the body alone by the difference at the step's midpoint.
  void slow_by_links(T& acceleration, const T& kappa, const T& delta, const T& h) const {
    const T half = V(0.5) * h;
    const T spring = kappa * v_ * half;
    T speed = v_ + (acceleration - delta * v_) * half;
    T difference = zero_;
    for (int pass = 0; pass < 2; ++pass) {  // the turning depends on the speed that it slows itself
      const T linear = acceleration - spring - delta * speed;
      const T force = linear * mass_ - V(0.5) * links_slope_ * speed * speed;
      difference = force / links_mass_ - linear;
      speed = v_ + (acceleration + difference - delta * v_) * half;
    }
    acceleration += difference;
  }

  HopperLinearParameters<T> p_;
  MechanismEffects<T> e_;
  EffectsOf<T, Stage::contact> contact_;
  Rotor<T> rotor_;
  T zero_ = T(V(0));
  T stiffness_, rest_height_, restitution_touchdown_, restitution_liftoff_, mass_, inverse_mass_,
      kappa_stance_;
  T delta_stance_{}, delta_flight_{};
  T touchdown_height_{}, leg_reach_squared_{}, constant_force_{}, leg_force_at_zero_{}, leg_damping_{};

  T z_{}, v_{};
  bool stance_ = false;
  T toe_{};                ///< height of the toe in stance: below zero where the ground gives
  bool straight_ = false;  ///< on a ground that gives: the leg is at its full length
  bool led_ = false;       ///< lead_leg()
  T led_length_{}, led_rate_{};
  T share_of_folding_{};  ///< of the leg's rate, that the body moves by
  bool plastic_ = false;  ///< links' impact at touch-down
  T led_restitution_{};   ///< the model's alone
  T toe_balance_{}, toe_drift_{}, toe_rate_{}, leg_push_{};
  T stretched_stiffness_{}, links_gravity_{}, links_mass_{}, links_slope_{}, links_lift_{}, links_weight_{};
  T kappa_stretched_{}, kappa_straight_{}, delta_straight_{};
  T stop_length_{}, stopped_stiffness_{}, kappa_stopped_{};  ///< of the leg at its bump stop
  enum class Cable : std::uint8_t { held, loose, pressed };  ///< pressed: on its way to a tooth
  bool clutched_ = false, tooth_shortens_ = true;
  Cable cable_ = Cable::held;
  KeyTiming<T> key_;
  V tooth_ = V(0);
  T pitch_{}, travel_{}, tooth_height_{}, travel_per_shortening_{};
  T caught_stiffness_{}, loose_stiffness_{}, home_force_{};

  bool leg_is_more_ = false;  ///< its force on the ground is more than spring, damper and motor: toe_force_
  bool more_ = false;         ///< leg_is_more_, or the leg, its toe or its rotor is in one of several states
  Leg leg_{};
  ToeForce toe_force_{};
  V step_ = V(-1);
  Flow<T> full_stance_{}, full_flight_{}, scratch_{};
  V elapsed_ = V(0);
  std::array<ContactEvent<V>, kMaxEvents> events_{};
  std::size_t event_count_ = 0;
};

}  // namespace furcula::dynamics
