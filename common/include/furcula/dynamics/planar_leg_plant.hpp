// The planar leg as a plant: flight and stance on a pinned toe, with touch-down, lift-off and apex located inside
// the steps, and a spring at the knee that works always, in stance only, or not at all (001 section III).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "furcula/dynamics/hybrid.hpp"
#include "furcula/dynamics/members.hpp"
#include "furcula/dynamics/planar_leg.hpp"

namespace furcula::dynamics {

/// Where the leg's energy is, and where it went since reset(), J. What the motors gave less what was lost is what the
/// leg has more than at the start.
template <class T>
struct LegEnergy {
  T kinetic{},      ///< at present
      gravity{},    ///< at present; zero with hip and all mass at the ground's level
      spring{};     ///< at present
  T motors{};       ///< work of the motors since the start
  T friction{},     ///< lost since the start
      touchdown{};  ///< lost since the start
  T release{};      ///< lost with a spring that was released while it was stretched

  /// Energy of the leg at present, J.
  T held() const { return kinetic + gravity + spring; }
  /// Energy lost since the start, J.
  T lost() const { return friction + touchdown + release; }
};

/// Classic Runge-Kutta steps; in stance the state is that of the joints, so that the toe cannot drift.
template <class T>
class PlanarLeg {
 public:
  /// Plain numbers: float or double.
  using V = ValueOf<T>;
  static constexpr std::size_t kMaxEvents = 16;  ///< kept of one advance()
  static constexpr V kLongestStep = V(5e-4);     ///< of the integrator, s

  /// Whether the toe is pinned.
  enum class Mode : std::uint8_t {
    flight,  ///< it is free
    stance   ///< it is pinned to the ground
  };
  /// An event within an advance().
  struct Event {
    /// What happens.
    enum class Kind : std::uint8_t {
      touchdown,  ///< the toe meets the ground
      liftoff,    ///< the toe leaves the ground
      apex        ///< the hip is highest
    } kind;       ///< what happens
    V offset_s;   ///< from the start of the advance()
  };

  /// A leg with its spring's kind and what ends a stance; call reset() before advance().
  PlanarLeg(const PlanarLegParameters<V>& parameters, LegSpring spring, LegLiftOff lift_off)
      : leg_(parameters), spring_(spring), lift_off_(lift_off) {}

  /// In flight. The hip's place and velocity, m and m/s; the joints' angles and rates.
  void reset(const Vec2<T>& hip, const Vec2<T>& velocity, const Joints2<T>& angle, const Joints2<T>& rate) {
    s_ = {};
    s_.x = hip.x;
    s_.y = hip.y;
    s_.vx = velocity.x;
    s_.vy = velocity.y;
    s_.hip = angle.hip;
    s_.knee = angle.knee;
    s_.hip_rate = rate.hip;
    s_.knee_rate = rate.knee;
    mode_ = Mode::flight;
    account_ = {};
    torque_ = {};
    rest_ = T(leg_.parameters().rest_angle_rad);
    stretched_ = spring_ == LegSpring::parallel && value_of(s_.knee) > value_of(rest_);
    rises_ = value_of(s_.vy) > V(0);
    keeps_ = clings_ = false;
    event_count_ = 0;
    pose_ = leg_.pose({s_.hip, s_.knee});
  }

  /// The ground's height from the next touch-down on, m; reset() does not change it.
  void set_ground(const T& height_m) { ground_ = height_m; }

  /// Moves on by `dt_s` >= 0 with the motors' torques held, N m.
  void advance(const Joints2<T>& torque, V dt_s) {
    event_count_ = 0;
    torque_ = torque;
    clings_ = false;
    if (!(dt_s > V(0))) return;
    elapsed_ = V(0);
    Hybrid<PlanarLeg, T>::advance(*this, dt_s, elapsed_);
  }

  /// Flight or stance.
  Mode mode() const { return mode_; }
  /// Position of the hip, m.
  Vec2<T> hip_m() const { return {s_.x, s_.y}; }
  /// Velocity of the hip, m/s.
  Vec2<T> hip_velocity_mps() const { return {s_.vx, s_.vy}; }
  /// Angles of hip and knee, rad.
  Joints2<T> angle_rad() const { return {s_.hip, s_.knee}; }
  /// Rates of hip and knee, rad/s.
  Joints2<T> rate_radps() const { return {s_.hip_rate, s_.knee_rate}; }
  /// Position of the toe, m.
  Vec2<T> toe_m() const {
    const Vec2<T> toe = leg_.toe(pose_);
    return {s_.x + toe.x, s_.y + toe.y};
  }
  /// Whether the ground had to pull in the last advance(), as a toe that is let go would go down.
  bool clings() const { return clings_; }
  /// The knee's angle at which the spring begins; of the last touch-down where it is switched.
  const T& spring_rest_rad() const { return rest_; }
  /// Torque of the spring on the knee, N m; negative extends it.
  T spring_torque_nm() const { return spring_torque(s_.knee); }
  /// Of the ground on the toe; zero in flight.
  Vec2<T> ground_force_n() const { return motion(s_, pose_).ground_force; }
  /// Events of the last advance(), at most kMaxEvents.
  std::span<const Event> events() const { return {events_.data(), event_count_}; }

  /// Energies at present and since reset(), J.
  LegEnergy<T> energy() const {
    LegEnergy<T> out = account_;
    out.kinetic = leg_.kinetic_energy(pose_, {s_.vx, s_.vy}, {s_.hip_rate, s_.knee_rate});
    out.gravity = leg_.height_energy(pose_, s_.y);
    const T stretch = s_.knee - rest_;
    out.spring = works() && value_of(stretch) > V(0)
                     ? T(V(0.5) * leg_.parameters().stiffness_nmprad * stretch * stretch)
                     : T(V(0));
    out.motors = s_.motors;
    out.friction = s_.friction;
    return out;
  }

 private:
  friend Hybrid<PlanarLeg, T>;
  using Leg = LegEquations<T, V>;
  using Pose = typename Leg::Pose;

  struct State {
    T x{}, y{}, vx{}, vy{};
    T hip{}, knee{}, hip_rate{}, knee_rate{};
    T motors{}, friction{};  ///< energy, J
  };
  template <Mode kMode_>
  struct Motion {
    static constexpr Mode kMode = kMode_;
    static constexpr auto members() {
      if constexpr (kMode == Mode::stance)
        return std::array{&State::hip, &State::knee, &State::hip_rate, &State::knee_rate};
      else
        return std::array{&State::x,   &State::y,    &State::vx,       &State::vy,
                          &State::hip, &State::knee, &State::hip_rate, &State::knee_rate};
    }
    static constexpr auto kMembers = members();
    static constexpr std::array kIntegrals{&State::motors, &State::friction};
  };
  template <class F>
  void in_motion(const F& f) const {
    if (mode_ == Mode::stance)
      f(Motion<Mode::stance>{});
    else
      f(Motion<Mode::flight>{});
  }

  bool works() const {
    return spring_ == LegSpring::parallel || (spring_ == LegSpring::switched && mode_ == Mode::stance);
  }
  /// Smooth inside a step: whether the spring is stretched is a mode, too.
  T spring_torque(const T& knee) const {
    return works() && stretched_ ? T(-leg_.parameters().stiffness_nmprad * (knee - rest_)) : T(V(0));
  }
  typename Leg::Motion motion(const State& s, const Pose& pose) const {
    const Joints2<T> rate{s.hip_rate, s.knee_rate};
    const Joints2<T> torque{torque_.hip, torque_.knee + spring_torque(s.knee)};
    return mode_ == Mode::stance ? leg_.in_stance(pose, rate, torque) : leg_.in_flight(pose, rate, torque);
  }

  struct Look {
    State state;
    Pose pose;
    typename Leg::Motion motion;
  };
  Look look() const { return {s_, pose_, motion(s_, pose_)}; }
  void take(const Look& look) {
    s_ = look.state;
    pose_ = look.pose;
  }
  template <class M>
  State rates(M, const Look& look) const {
    return rates_of(look.state, look.motion);
  }
  template <class M>
  State rates(M, const State& s, const Look&) const {
    return rates_of(s, motion(s, leg_.pose({s.hip, s.knee})));
  }
  State rates_of(const State& s, const typename Leg::Motion& m) const {
    State d;
    d.x = s.vx;
    d.y = s.vy;
    d.vx = m.hip_acceleration.x;
    d.vy = m.hip_acceleration.y;
    d.hip = s.hip_rate;
    d.knee = s.knee_rate;
    d.hip_rate = m.acceleration.hip;
    d.knee_rate = m.acceleration.knee;
    d.motors = torque_.hip * s.hip_rate + torque_.knee * s.knee_rate;
    d.friction = leg_.parameters().hip_damping_nmspr * s.hip_rate * s.hip_rate +
                 leg_.parameters().knee_damping_nmspr * s.knee_rate * s.knee_rate;
    return d;
  }
  template <class M>
  void arrive(M, const Look&, const T&, Look& end) const {
    State& s = end.state;
    end.pose = leg_.pose({s.hip, s.knee});
    if constexpr (M::kMode == Mode::stance) pin(s, end.pose);
    end.motion = motion(s, end.pose);
  }
  /// The hip where the pinned toe puts it.
  void pin(State& s, const Pose& pose) const {
    const Vec2<T> toe = leg_.toe(pose);
    const Vec2<T> velocity = leg_.pinned_hip_velocity(pose, {s.hip_rate, s.knee_rate});
    s.x = pin_.x - toe.x;
    s.y = pin_.y - toe.y;
    s.vx = velocity.x;
    s.vy = velocity.y;
  }
  static V longest_step() { return kLongestStep; }

  enum class Change : std::uint8_t {
    touches_down,
    leaves_ground,
    knee_is_back,
    apex,
    spring_begins,
    spring_ends
  };

  T margin(Change change, const Look& look) const {
    const State& s = look.state;
    switch (change) {
      case Change::touches_down:
        return s.y + leg_.toe(look.pose).y - ground_;
      case Change::leaves_ground:
        return look.motion.ground_force.y;
      case Change::knee_is_back:
      case Change::spring_ends:
        return s.knee - rest_;
      case Change::spring_begins:
        return rest_ - s.knee;
      case Change::apex:
        return s.vy;
    }
    return T(V(1));
  }
  /// A margin that is zero at its start, of a toe that has just left or a knee that has just latched, must not end by
  /// a rounding.
  static V tolerance(Change change) { return follows(change) ? V(0) : sizeof(V) == 4 ? V(1e-6) : V(1e-13); }
  static bool follows(Change change) { return change == Change::leaves_ground; }

  template <class F>
  void each_change(const F& f) const {
    if (mode_ == Mode::stance) {
      if (!clings_) f(Change::leaves_ground);
      if (lift_off_ == LegLiftOff::knee && !keeps_) f(Change::knee_is_back);
    } else {
      f(Change::touches_down);
      if (rises_) f(Change::apex);
    }
    if (works()) f(stretched_ ? Change::spring_ends : Change::spring_begins);
  }

  void make(Change change) {
    switch (change) {
      case Change::touches_down:
        touch_down();
        break;
      case Change::leaves_ground:
        // A toe that would go down if it were let go would slip; this model has no slip, and pins it.
        if (lifts())
          leave_ground();
        else
          clings_ = true;
        break;
      case Change::knee_is_back:
        // The ground may still push: the toe leaves only where the motors lift it at once.
        if (lifts())
          leave_ground();
        else
          keeps_ = true;
        break;
      case Change::apex:
        rises_ = false;
        record(Event::Kind::apex);
        break;
      case Change::spring_begins:
        stretched_ = true;
        break;
      case Change::spring_ends:
        stretched_ = false;
        break;
    }
  }

  void touch_down() {
    const T before = energy().held();
    const auto impact = leg_.impact(pose_, {s_.vx, s_.vy}, {s_.hip_rate, s_.knee_rate});
    s_.hip_rate = impact.rate.hip;
    s_.knee_rate = impact.rate.knee;
    const Vec2<T> toe = leg_.toe(pose_);
    pin_ = {s_.x + toe.x, ground_};
    mode_ = Mode::stance;
    keeps_ = false;
    pin(s_, pose_);
    if (spring_ == LegSpring::switched) {
      rest_ = s_.knee;
      stretched_ = value_of(s_.knee_rate) > V(0);
    }
    account_.touchdown += before - energy().held();
    record(Event::Kind::touchdown);
  }

  void leave_ground() {
    const T before = energy().held();
    mode_ = Mode::flight;
    rises_ = value_of(s_.vy) > V(0);
    account_.release += before - energy().held();
    record(Event::Kind::liftoff);
  }

  /// Whether the toe accelerates upward once the ground lets it go.
  bool lifts() const {
    const Joints2<T> rate{s_.hip_rate, s_.knee_rate};
    const T spring = spring_ == LegSpring::switched ? T(V(0)) : spring_torque(s_.knee);
    const auto m = leg_.in_flight(pose_, rate, {torque_.hip, torque_.knee + spring});
    const T shank = rate.hip + rate.knee;
    const T up = m.hip_acceleration.y + Leg::dot(pose_.toe_y, m.acceleration) +
                 leg_.parameters().thigh_length_m * pose_.cos_hip * rate.hip * rate.hip +
                 leg_.parameters().shank_length_m * pose_.cos_shank * shank * shank;
    // At a force of zero the toe's own acceleration is zero, too.
    return value_of(up) > (sizeof(V) == 4 ? V(-1e-2) : V(-1e-6));
  }

  void record(typename Event::Kind kind) {
    if (event_count_ < events_.size()) events_[event_count_++] = {kind, elapsed_};
  }

  Leg leg_;
  LegSpring spring_;
  LegLiftOff lift_off_;
  Mode mode_ = Mode::flight;
  bool stretched_ = false, rises_ = false;
  bool clings_ = false;
  bool keeps_ = false;  ///< of this stance: the knee came back, and the toe stayed
  State s_{};
  Pose pose_{};
  Joints2<T> torque_{};
  Vec2<T> pin_{};
  T rest_{}, ground_{};
  LegEnergy<T> account_{};
  V elapsed_ = V(0);
  std::array<Event, kMaxEvents> events_{};
  std::size_t event_count_ = 0;
};

}  // namespace furcula::dynamics
