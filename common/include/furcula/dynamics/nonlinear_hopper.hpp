// The non-linear hopper (002 section 3.2.2 with the corrections of docs/physics.md): links with inertia, a
// leg that is free to fold in flight, a stop that it comes back to, and the ground as a constraint.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "furcula/dynamics/clutch.hpp"
#include "furcula/dynamics/contact_event.hpp"
#include "furcula/dynamics/hybrid.hpp"
#include "furcula/dynamics/links.hpp"
#include "furcula/dynamics/machines/hopper_nonlinear.hpp"
#include "furcula/dynamics/members.hpp"

namespace furcula::dynamics {

/// Where the energy is, and where it went since reset(), J. The energy held is that of the start plus what the motor
/// gave less what was lost.
template <class T>
struct EnergyAccount {
  T kinetic{},        ///< now, of body and links
      gravity{},      ///< now, zero with body and links at height 0
      spring{};       ///< now, in the leg's spring
  T motor{};          ///< given by the motor since the start
  T guide_damping{},  ///< lost in the guide since the start
      leg_damping{},  ///< lost in the leg's damper since the start
      touchdown{},    ///< lost in impacts of the toe since the start
      stop{},         ///< lost in impacts of the leg on its stop since the start
      liftoff{};      ///< lost by the restitution at lift-off since the start

  /// Energy of now, J.
  T held() const { return kinetic + gravity + spring; }
  /// All that was lost since the start, J.
  T lost() const { return guide_damping + leg_damping + touchdown + stop + liftoff; }
};

/// The spring's far end on a robot without a clutch: it does not move.
template <class T>
struct FixedEnd {
  /// It has no state.
  struct State {};
  /// Nothing of it moves.
  struct Motion {
    static constexpr std::array<T State::*, 0> kMembers{},  ///< none
        kIntegrals{};                                       ///< none
  };
  /// f(Motion).
  template <class F>
  void in_motion(const F& f) const {
    f(Motion{});
  }
};

/// The plant, with the guide's damping df in both phases and ds - df in the leg, along its length:
///   M q'' + B + G = [torque - lever (Fs - dl l'), -df z'] + J^T F_c
///   l = 2 L cos theta,   lever = 2 L sin theta,   Fs = k (z0 - l)
/// In four modes: on its stop in flight (theta held), swinging in flight (both move), in stance (the toe
/// rests on the ground; the ground does not pull, and where it would have to, the leg is free), standing on
/// stop and ground. Touch-down and the stop are plastic impacts; restitution_touchdown and
/// restitution_liftoff multiply all speeds that these leave. Classic Runge-Kutta steps, as long as each mode
/// allows; every change of mode is located inside a step, and after each the mode is chosen by the
/// forces and accelerations that follow, so that a contact is taken or left once and does not chatter. `End`
/// holds the spring's far end: FixedEnd, or a Clutch, whose cable follows the spring while it is released;
/// then the spring is one that can only pull its cable, and slackens.
template <class T, class End = FixedEnd<T>>
class NonlinearHopper {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;
  /// A touch-down or a lift-off.
  using Event = ContactEvent<V>;
  static constexpr std::size_t kMaxEvents = 16;  ///< kept of one advance()
  static constexpr V kLongestStep = V(2.5e-4);   ///< of a leg that swings

  /// on_stop: in flight, the leg on its stop. swings: in flight, the leg free. stance: the toe on the ground, the leg free.
  /// stands: the toe on the ground and the leg on its stop, at rest.
  enum class Mode : std::uint8_t { on_stop, swings, stance, stands };

  /// At height 0 until reset(); `end` holds the spring's far end.
  explicit NonlinearHopper(const HopperNonlinearParameters<T>& p, const End& end = End{})
      : p_(p),
        end_(end),
        links_{p.inertia_a_kgm2, p.inertia_b_kgm, p.inertia_e_kgm, p.link_length_m, p.mass_kg},
        leg_damping_(p.damping_stance_nspm - p.damping_flight_nspm),
        straight_(links_.pose(p.touchdown_angle_rad)) {}

  /// Starts at a height (m) above the ground and a velocity (m/s): in flight with the leg on its stop if
  /// above the touch-down height, else in stance.
  void reset(const T& height_m, const T& velocity_mps) {
    using std::acos;
    account_ = {};
    event_count_ = 0;
    elapsed_ = V(0);
    ground_ = torque_ = T(V(0));
    left_ = false;
    s_ = {};
    if constexpr (kClutch) end_.reset();
    if (value_of(height_m) > value_of(straight_.length)) {
      mode_ = Mode::on_stop;
      s_.angle = p_.touchdown_angle_rad;
    } else {
      mode_ = Mode::stance;
      s_.angle = acos(T(height_m / (V(2) * p_.link_length_m)));
      s_.rate = -velocity_mps / links_.pose(s_.angle).lever;
    }
    s_.height = height_m;
    s_.velocity = velocity_mps;
    pose_ = links_.pose(s_.angle);
    taut_ = !kClutch || value_of(stretch(s_, pose_)) >= V(0);
    clutch_impacts_ = {};
  }

  /// Moves the ground, m (0 at the start). Has no effect on a stance: call it in flight, below the toe.
  void set_ground(const T& height_m) { ground_ = height_m; }

  /// Moves on by `dt_s` >= 0 with the motor's torque held, N m (positive folds the leg).
  void advance(const T& torque, V dt_s) {
    event_count_ = 0;
    torque_ = torque;
    if (!(dt_s > V(0))) return;
    elapsed_ = V(0);
    settle();  // the new torque may take the leg off its stop or the toe off the ground
    Hybrid<NonlinearHopper, T>::advance(*this, dt_s, elapsed_);
  }

  /// Volts across the clutch's coil while it is on, 0 off; held until the next call.
  void set_voltage(const T& volts) {
    end_.set_voltage(volts);
    end_.settle(s_);
  }
  const End& clutch() const { return end_; }       ///< its modes and counts
  bool caught() const { return end_.caught(s_); }  ///< the clutch's teeth hold the belt, or would stop it
  const T& cable_travel_m() const { return s_.travel; }  ///< of the cable from its rest, along the leg
  /// Speed of the cable along the leg, positive away from its rest.
  const T& cable_speed_mps() const { return s_.speed; }
  const T& coil_current_a() const { return s_.current; }  ///< in the clutch's coil
  /// Energies of the clutch (ClutchEnergy), J; not part of energy().
  auto clutch_energy() const {
    auto e = end_.energy(s_, end_.parameters().cable_mass_kg);
    e.impacts = clutch_impacts_;
    return e;
  }

  Mode mode() const { return mode_; }  ///< of contact and stop
  /// The toe is on the ground.
  bool in_stance() const { return mode_ == Mode::stance || mode_ == Mode::stands; }
  /// Height of the body above the level that the ground has at the start.
  const T& height_m() const { return s_.height; }
  const T& velocity_mps() const { return s_.velocity; }        ///< of the body, positive upwards
  const T& leg_angle_rad() const { return s_.angle; }          ///< from the vertical; grows as the leg folds
  const T& leg_rate_radps() const { return s_.rate; }          ///< positive while the leg folds
  T toe_height_m() const { return s_.height - pose_.length; }  ///< above the same level
  T toe_velocity_mps() const { return s_.velocity + pose_.lever * s_.rate; }  ///< positive upwards
  /// Height of the body above the ground at touch-down with the leg on its stop.
  T touchdown_height_m() const { return straight_.length; }

  /// Whether the steps resolve the leg's own oscillation: not where its links have almost no inertia.
  static bool resolves(const HopperNonlinearParameters<T>& p) {
    using std::sqrt;
    const Links<T> links{p.inertia_a_kgm2, p.inertia_b_kgm, p.inertia_e_kgm, p.link_length_m, p.mass_kg};
    const auto straight = links.pose(p.touchdown_angle_rad);
    const V inertia =
        value_of(straight.inertia.angle) -
        value_of(straight.inertia.coupling * straight.inertia.coupling / straight.inertia.height);
    const V lever = V(2) * value_of(p.link_length_m);  // at its longest
    const V stiff = value_of(p.stiffness_npm) * lever * lever;
    const V damped = value_of(p.damping_stance_nspm - p.damping_flight_nspm) * lever * lever;
    return inertia > V(0) && sqrt(stiff / inertia) * kLongestStep < V(0.2) &&
           damped / inertia * kLongestStep < V(0.2);
  }
  /// Of the ground on the toe, N; zero in flight.
  T ground_force_n() const { return in_stance() ? accelerations(s_, pose_).ground_force : T(V(0)); }
  /// Touch-downs and lift-offs inside the last advance(), in order; offsets from its start, s.
  std::span<const Event> events() const { return {events_.data(), event_count_}; }

  /// Energies without those of the clutch, J.
  EnergyAccount<T> energy() const {
    EnergyAccount<T> out = account_;
    const T pull = stretch(s_, pose_);
    out.kinetic = links_.kinetic_energy(pose_, s_.rate, s_.velocity);
    out.gravity = p_.gravity_mps2 * (p_.mass_kg * s_.height - p_.inertia_e_kgm * pose_.cosine);
    out.spring = taut_ ? T(V(0.5) * p_.stiffness_npm * pull * pull) : T(V(0));
    out.motor = s_.motor;
    out.guide_damping = s_.guide_damping;
    out.leg_damping = s_.leg_damping;
    return out;
  }

 private:
  friend Hybrid<NonlinearHopper, T>;

  using Pose = typename Links<T>::Pose;
  static constexpr bool kClutch = !std::is_same_v<End, FixedEnd<T>>;

  struct State : End::State {
    T angle{}, height{}, rate{}, velocity{};
    T motor{}, guide_damping{}, leg_damping{};  ///< energy, J
  };
  template <std::size_t kCount>
  using Members = std::array<T State::*, kCount>;
  /// What moves in a mode. In stance the toe's rest gives the height; on its stop the leg does not turn.
  template <Mode kMode>
  static constexpr auto members_of() {
    if constexpr (kMode == Mode::swings)
      return Members<4>{&State::angle, &State::height, &State::rate, &State::velocity};
    else if constexpr (kMode == Mode::stance)
      return Members<3>{&State::angle, &State::rate, &State::velocity};
    else if constexpr (kMode == Mode::on_stop)
      return Members<2>{&State::height, &State::velocity};
    else
      return Members<0>{};
  }
  template <Mode kMode>
  static constexpr auto integrals_of() {
    if constexpr (kMode == Mode::on_stop)
      return Members<1>{&State::guide_damping};
    else if constexpr (kMode == Mode::stands)
      return Members<0>{};
    else
      return Members<3>{&State::motor, &State::guide_damping, &State::leg_damping};
  }
  /// A mode, and how the spring's far end moves.
  template <Mode kMode_, class EndMotion>
  struct Motion {
    static constexpr Mode kMode = kMode_;
    static constexpr bool kTurns = kMode == Mode::swings || kMode == Mode::stance;
    using OfEnd = EndMotion;
    static constexpr auto kMembers = joined(EndMotion::kMembers, members_of<kMode>());
    static constexpr auto kIntegrals = joined(EndMotion::kIntegrals, integrals_of<kMode>());
  };
  /// f(Motion) of now.
  template <class F>
  void in_motion(const F& f) const {
    end_.in_motion([&]<class OfEnd>(OfEnd) {
      in_mode([&]<Mode kMode>(std::integral_constant<Mode, kMode>) { f(Motion<kMode, OfEnd>{}); });
    });
  }
  template <class F>
  auto in_mode(const F& f) const {
    switch (mode_) {
      case Mode::on_stop:
        return f(std::integral_constant<Mode, Mode::on_stop>{});
      case Mode::swings:
        return f(std::integral_constant<Mode, Mode::swings>{});
      case Mode::stance:
        return f(std::integral_constant<Mode, Mode::stance>{});
      case Mode::stands:
        break;
    }
    return f(std::integral_constant<Mode, Mode::stands>{});
  }
  struct Accelerations {
    T angle{}, height{};
    T ground_force{};  ///< in stance
    T stop_torque{};   ///< on the stop: of the stop on the leg, positive
  };

  /// By which the spring is longer than relaxed, m.
  T stretch(const State& s, const Pose& p) const {
    T out = p_.rest_height_m - p.length;
    if constexpr (kClutch) out -= s.travel;
    return out;
  }
  T spring_force(const State& s, const Pose& p) const {
    return taut_ ? T(p_.stiffness_npm * stretch(s, p)) : T(V(0));
  }
  V longest_step() const {
    // The body's swing on the spring is slower than the leg's own; on its stop nothing swings.
    V longest = mode_ == Mode::swings ? kLongestStep : mode_ == Mode::stance ? V(1e-3) / V(3) : V(1e-3);
    if constexpr (kClutch)
      if (end_.longest_step() < longest) longest = end_.longest_step();
    return longest;
  }

  Accelerations accelerations(const State& s, const Pose& p) const {
    return in_mode([&](auto mode) { return accelerations<mode.value>(s, p); });
  }
  template <Mode kMode>
  [[gnu::always_inline]] Accelerations accelerations(const State& s, const Pose& p) const {
    const auto& m = p.inertia;
    const T shortening = p.lever * s.rate;
    const T push = spring_force(s, p) + leg_damping_ * shortening;
    const T on_angle =
        torque_ - p.lever * push - links_.turning_torque(p, s.rate) - p_.gravity_mps2 * links_.hanging(p);
    const T on_height =
        -p_.damping_flight_nspm * s.velocity - links_.turning_force(p, s.rate) - p_.gravity_mps2 * p_.mass_kg;
    Accelerations out;
    if constexpr (kMode == Mode::on_stop) {
      out.height = on_height / m.height;
      out.stop_torque = m.coupling * out.height - on_angle;
    } else if constexpr (kMode == Mode::stands) {
      out.ground_force = -on_height;
      out.stop_torque = p.lever * on_height - on_angle;
    } else if constexpr (kMode == Mode::swings) {
      const T determinant = m.angle * m.height - m.coupling * m.coupling;
      out.angle = (m.height * on_angle - m.coupling * on_height) / determinant;
      out.height = (m.angle * on_height - m.coupling * on_angle) / determinant;
    } else {
      // z'' = -(lever theta'' + l theta'^2), and the ground's force does no work on that motion.
      const T drop = p.length * s.rate * s.rate;
      out.angle = (on_angle - p.lever * on_height + (m.coupling - p.lever * m.height) * drop) /
                  links_.standing_inertia(p);
      out.height = -(p.lever * out.angle + drop);
      out.ground_force = m.coupling * out.angle + m.height * out.height - on_height;
    }
    return out;
  }

  /// A state with what its angle and its mode make of it.
  struct Look {
    State state;
    Pose pose;
    Accelerations accelerations;
  };
  Look look() const { return {s_, pose_, accelerations(s_, pose_)}; }
  void take(const Look& look) {
    s_ = look.state;
    pose_ = look.pose;
  }
  template <class Motion>
  [[gnu::always_inline]] State rates(Motion motion, const Look& look) const {
    return rates(motion, look.state, look.pose, look.accelerations);
  }
  template <class Motion>
  [[gnu::always_inline]] State rates(Motion motion, const State& s, const Look& near) const {
    if constexpr (Motion::kTurns) {
      const Pose p = links_.turned(near.pose, T(s.angle - near.state.angle));
      return rates(motion, s, p, accelerations<Motion::kMode>(s, p));
    } else {
      return rates(motion, s, near.pose, accelerations<Motion::kMode>(s, near.pose));
    }
  }
  template <class Motion>
  [[gnu::always_inline]] State rates(Motion, const State& s, const Pose& p, const Accelerations& a) const {
    const T shortening = p.lever * s.rate;
    State d;
    if constexpr (kClutch)
      static_cast<typename End::State&>(d) =
          end_.rates(typename Motion::OfEnd{}, s, {spring_force(s, p), T(V(0))});
    d.angle = s.rate;
    d.height = s.velocity;
    d.rate = a.angle;
    d.velocity = a.height;
    d.motor = torque_ * s.rate;
    d.guide_damping = p_.damping_flight_nspm * s.velocity * s.velocity;
    d.leg_damping = leg_damping_ * shortening * shortening;
    return d;
  }
  template <class Motion>
  void arrive(Motion, const Look& from, [[maybe_unused]] const T& t, Look& end) const {
    State& s = end.state;
    if constexpr (kClutch) end_.keep_coil(from.state, s, t);
    end.pose = Motion::kTurns ? links_.pose(s.angle) : from.pose;
    if constexpr (Motion::kMode == Mode::stance) {  // the toe rests
      s.height = ground_ + end.pose.length;
      s.velocity = -(end.pose.lever * s.rate);
    }
    end.accelerations = accelerations<Motion::kMode>(s, end.pose);
  }

  /// What ends a mode: of the leg, or of the clutch.
  struct Change {
    enum class Leg : std::uint8_t {
      touches_down,
      meets_stop,
      leaves_stop,
      leaves_ground,
      spring_slackens,
      spring_tautens,
      none
    } leg = Leg::none;
    std::uint8_t clutch = 0;  ///< where leg is none
  };
  using Leg = typename Change::Leg;

  [[gnu::always_inline]] T margin(const Change& change, const Look& look) const {
    const State& s = look.state;
    switch (change.leg) {
      case Leg::touches_down:
        return s.height - look.pose.length - ground_;
      case Leg::meets_stop:
        return s.angle - p_.touchdown_angle_rad;
      case Leg::leaves_stop:
        return look.accelerations.stop_torque;
      case Leg::leaves_ground:
        return look.accelerations.ground_force;
      case Leg::spring_slackens:
        return stretch(s, look.pose);
      case Leg::spring_tautens:
        return -stretch(s, look.pose);
      case Leg::none:
        break;
    }
    if constexpr (kClutch)
      return end_.margin(static_cast<typename End::Change>(change.clutch), s,
                         {spring_force(s, look.pose), T(V(0))});
    else
      return T(V(1));
  }
  /// A margin that is zero at its start, of a toe or a leg that has just left, must not end by a rounding.
  static V tolerance(const Change& change) {
    if constexpr (kClutch)
      if (change.leg == Leg::none) return End::tolerance(static_cast<typename End::Change>(change.clutch));
    return follows(change) ? V(0) : sizeof(V) == 4 ? V(1e-6) : V(1e-13);
  }
  static bool follows(const Change& change) {
    if constexpr (kClutch)
      if (change.leg == Leg::none) return End::follows(static_cast<typename End::Change>(change.clutch));
    return change.leg == Leg::leaves_stop || change.leg == Leg::leaves_ground;
  }

  template <class F>
  [[gnu::always_inline]] void each_change(const F& f) const {
    if (mode_ == Mode::on_stop || mode_ == Mode::stands)
      f(Change{Leg::leaves_stop});
    else
      f(Change{Leg::meets_stop});
    if (in_stance())
      f(Change{Leg::leaves_ground});
    else
      f(Change{Leg::touches_down});
    if constexpr (kClutch) {
      if (taut_)
        f(Change{Leg::spring_slackens});
      else
        f(Change{Leg::spring_tautens});
      const auto of_end = [&](typename End::Change c) __attribute__((always_inline)) {
        f(Change{Leg::none, static_cast<std::uint8_t>(c)});
      };
      end_.each_change(of_end);
    }
  }

  void make(const Change& change) {
    switch (change.leg) {
      case Leg::touches_down:
        touch_down();
        break;
      case Leg::meets_stop:
        meet_stop();
        break;
      case Leg::leaves_stop:
        mode_ = mode_ == Mode::stands ? Mode::stance : Mode::swings;
        break;
      case Leg::leaves_ground:
        if (mode_ == Mode::stands)
          mode_ = Mode::on_stop;
        else
          leave_ground();
        break;
      case Leg::spring_slackens:
        taut_ = false;
        break;
      case Leg::spring_tautens:
        taut_ = true;
        break;
      case Leg::none:
        change_clutch(change);
        break;
    }
    settle();
  }
  void change_clutch([[maybe_unused]] const Change& change) {
    if constexpr (kClutch) {
      const T before = energy().held() + clutch_energy().held();
      end_.make(static_cast<typename End::Change>(change.clutch), s_, {spring_force(s_, pose_), T(V(0))});
      end_.settle(s_);
      clutch_impacts_ += before - energy().held() - clutch_energy().held();
    }
  }

  /// Of the toe, upwards, m/s^2.
  T toe_acceleration() const {
    const Accelerations a = accelerations(s_, pose_);
    return a.height + pose_.lever * a.angle + pose_.length * s_.rate * s_.rate;
  }

  void touch_down() {
    const T before = energy().held(), fell = s_.velocity;
    mode_ = Mode::stance;
    if (value_of(fell) < V(0)) left_ = false;
    s_.rate = p_.restitution_touchdown * links_.rate_after_touchdown(pose_, s_.rate, s_.velocity);
    s_.height = ground_ + pose_.length;
    s_.velocity = -(pose_.lever * s_.rate);
    account_.touchdown += before - energy().held();
    record(Event::Kind::touchdown, fell);
  }

  /// The loss at lift-off is the stance's: once, and not that of a toe that bounces under a sinking body.
  void lose_at_liftoff() {
    if (left_ || !(value_of(s_.velocity) > V(0))) return;
    const T before = energy().held();
    left_ = true;
    s_.rate = p_.restitution_liftoff * s_.rate;
    s_.velocity = p_.restitution_liftoff * s_.velocity;
    account_.liftoff += before - energy().held();
  }

  /// The ground would have to pull. What is slowed by the loss may stay for a while.
  void leave_ground() {
    const T rose = s_.velocity;
    lose_at_liftoff();
    mode_ = Mode::swings;
    const V rounding = sizeof(V) == 4 ? V(1e-2) : V(1e-6);  // m/s^2, of where the force is zero
    if (value_of(toe_acceleration()) < -rounding)
      mode_ = Mode::stance;
    else
      record(Event::Kind::liftoff, rose);
  }

  /// In flight the leg stays on its stop; from the ground it takes off, or stands if it comes there as good
  /// as at rest and is pressed on both.
  void meet_stop() {
    const bool stood = mode_ == Mode::stance;
    const T before = energy().held(), rose = s_.velocity;
    const V slow = V(1e-3);  // m/s
    s_.angle = p_.touchdown_angle_rad;
    pose_ = straight_;
    if (stood && value_of(s_.velocity) < slow) {
      mode_ = Mode::stands;
      const Accelerations a = accelerations(s_, pose_);
      if (value_of(a.stop_torque) >= V(0) && value_of(a.ground_force) >= V(0)) {
        s_.rate = s_.velocity = T(V(0));
        account_.stop += before - energy().held();
        return;
      }
    }
    s_.velocity = links_.velocity_after_stop(straight_, s_.rate, s_.velocity);
    s_.rate = T(V(0));
    mode_ = Mode::on_stop;
    account_.stop += before - energy().held();
    if (!stood) return;
    lose_at_liftoff();
    record(Event::Kind::liftoff, rose);
  }

  /// The mode that the forces ask for where the state alone leaves it open: on the stop, and with the toe on
  /// the ground.
  void settle() {
    if (mode_ == Mode::on_stop && value_of(accelerations(s_, pose_).stop_torque) < V(0)) mode_ = Mode::swings;
    if (mode_ == Mode::stands) {
      const Accelerations a = accelerations(s_, pose_);
      if (value_of(a.stop_torque) < V(0)) mode_ = Mode::stance;
      if (value_of(a.ground_force) < V(0)) mode_ = Mode::on_stop;
    }
    if (mode_ != Mode::stance) return;
    const bool at_stop =
        !(value_of(s_.angle) > value_of(p_.touchdown_angle_rad)) && !(value_of(s_.rate) > V(0));
    const Accelerations a = accelerations(s_, pose_);
    if (at_stop && (value_of(s_.rate) < V(0) || value_of(a.angle) < V(0))) return meet_stop();
    if (value_of(a.ground_force) < V(0)) leave_ground();
  }

  void record(typename Event::Kind kind, const T& before) {
    if (event_count_ < events_.size())
      events_[event_count_++] = {kind, elapsed_, value_of(before), value_of(s_.velocity)};
  }

  HopperNonlinearParameters<T> p_;
  End end_;
  Links<T> links_;
  T leg_damping_;
  typename Links<T>::Pose straight_;
  T torque_{}, ground_{};
  State s_{};
  Pose pose_ = straight_;  ///< of the state's angle
  Mode mode_ = Mode::on_stop;
  bool left_ = false;  ///< the loss at lift-off of this stance is taken
  bool taut_ = true;   ///< the spring pulls; without a clutch also where it would have to push
  T clutch_impacts_{};
  EnergyAccount<T> account_{};
  V elapsed_ = V(0);
  std::array<Event, kMaxEvents> events_{};
  std::size_t event_count_ = 0;
};

/// The robot of 002 chapter 5: the leg's spring ends on a cable that the clutch holds or lets go.
template <class T>
using ClutchedHopper = NonlinearHopper<T, Clutch<T>>;

}  // namespace furcula::dynamics
