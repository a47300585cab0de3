// The clutch on the parallel spring's cable (002 chapter 5): solenoid, key, teeth, cable and auxiliary
// spring, as a part of a machine that Hybrid moves.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "furcula/dynamics/hybrid.hpp"
#include "furcula/dynamics/members.hpp"
#include "furcula/dynamics/scalar.hpp"
#include "furcula/dynamics/solenoid.hpp"

namespace furcula::dynamics {

/// Lengths and forces of the cable are as seen where it is driven: along the leg on a hopper (a cable that
/// moves 0.7 of what the leg shortens has its own times 0.7 and by 0.7), along the belt on a bench.
template <class T>
struct ClutchParameters {
  Solenoid<T> solenoid;  ///< pulls the key; its plunger moves with the key
  // The key: pulled back by the solenoid, pressed on the belt by the return spring.
  T key_mass_kg{},           ///< of all that moves with the key
      key_damping_nspm{};    ///< viscous friction of the key
  T pressing_force_n{};      ///< of the return spring on the seated key
  T return_stiffness_npm{};  ///< of the return spring
  T tooth_height_m{};        ///< distance of the key from its seat at which it is out of the teeth
  T hold_depth_m{};   ///< depth in the teeth from which the key stops a belt; from less a tooth throws it out
  T holding_ratio{};  ///< load that the seated teeth hold, over the pressing force
  T tip_friction{},   ///< friction coefficient of the belt under the key's tips
      flank_friction{};  ///< friction coefficient of the key along a loaded flank
  // The belt: teeth, cable and pulleys.
  T tooth_pitch_m{};            ///< distance from tooth to tooth
  T tooth_clearance_m{};        ///< stroke of a belt between the flanks of a key that is in the teeth
  T cable_mass_kg{},            ///< of cable, belt and pulleys
      cable_damping_nspm{},     ///< viscous friction of pulleys and guide
      cable_friction_n{};       ///< dry friction of pulleys and guide
  T auxiliary_stiffness_npm{},  ///< of the spring that pulls the cable back to its rest
      auxiliary_preload_n{};    ///< its force with the cable at rest
  T travel_m{};                 ///< from the cable's rest to its stop
};

/// Where the clutch's energy is, and what it took and lost since the start, J.
template <class T>
struct ClutchEnergy {
  T magnetic{},            ///< now, in the coil
      key{},               ///< now, kinetic, of the key
      return_spring{},     ///< now, zero with the key on its seat
      cable{},             ///< now, kinetic, of the cable and what moves with it
      auxiliary_spring{};  ///< now, zero with the cable at rest
  T electrical{};          ///< taken from the supply
  T copper{},              ///< lost in the coil's resistance
      flyback{},           ///< lost in the flyback path
      key_damping{},       ///< lost in the key's viscous friction
      cable_damping{},     ///< lost in the cable's viscous friction
      friction{};          ///< lost in dry friction: of cable, tips and flanks
  T impacts{};             ///< lost where key, teeth or cable stop, and where teeth are skipped

  /// Energy of now, J.
  T held() const { return magnetic + key + return_spring + cable + auxiliary_spring; }
  /// All that was lost since the start, J.
  T lost() const { return copper + flyback + key_damping + cable_damping + friction + impacts; }
};

/// What drives the cable.
template <class T>
struct CableDrive {
  T force{},   ///< N, positive away from the cable's rest
      mass{};  ///< of what moves with the cable, without the cable's own, kg
};

/// The modes of the clutch, its equations and its changes of mode. The machine that it is part of keeps the time
/// and drives the cable. The machine's State holds the clutch's; the clutch's members are called in the order in
/// which Hybrid calls the machine's.
template <class T>
class Clutch {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;

  /// What the modes move, and the energies since the start.
  struct State {
    T travel{},           ///< of the cable from its rest, m
        speed{};          ///< of the cable, m/s
    T key{},              ///< of the key from its seat, m
        key_speed{};      ///< of the key, m/s; positive out of the teeth
    T current{};          ///< in the coil, A
    T electrical{},       ///< taken from the supply, J
        copper{},         ///< lost in the coil's resistance, J
        flyback{},        ///< lost in the flyback path, J
        key_damping{},    ///< lost in the key's viscous friction, J
        cable_damping{},  ///< lost in the cable's viscous friction, J
        friction{};       ///< lost in dry friction, J
  };
  /// What moves in a step: the cable or not, the key or not. kKey is set as well where the key rests on the tips of a
  /// moving belt, since the friction there depends on the current.
  template <bool kKey_, bool kCable_>
  struct Motion {
    static constexpr bool kKey = kKey_,  ///< key and current are integrated
        kCable = kCable_;                ///< the cable is integrated
    /// Pointers to members of State.
    template <std::size_t kCount>
    using Members = std::array<T State::*, kCount>;
    /// The members that move, for Hybrid.
    static constexpr auto kMembers =
        joined(only_if<kCable>(Members<2>{&State::travel, &State::speed}),
               only_if<kKey>(Members<3>{&State::key, &State::key_speed, &State::current}));
    /// The members on which no rate depends, for Hybrid.
    static constexpr auto kIntegrals =
        joined(only_if < kCable || kKey > (Members<1>{&State::friction}),
               joined(only_if<kCable>(Members<1>{&State::cable_damping}),
                      only_if<kKey>(Members<4>{&State::electrical, &State::copper, &State::flyback,
                                               &State::key_damping})));
  };

  /// Mode of the key. jammed: a loaded flank holds it between its ends.
  enum class Key : std::uint8_t { seated, moving, jammed, on_tips, pulled };
  /// Mode of the cable. still: friction holds it. forth: away from its rest, the positive direction. back: towards it.
  /// blocked: a flank or a stop is in its path in that direction.
  enum class Cable : std::uint8_t { still, forth, back, blocked_forth, blocked_back };

  /// What can end a mode.
  enum class Change : std::uint8_t {
    key_lifts,  ///< off its seat
    key_location_types,
    key_leaves_stop,
    key_meets_stop,
    key_meets_tips,
    key_falls_in,  ///< from the tips into a gap between teeth that has come under it
    key_clears,    ///< out of the teeth
    key_turns,     ///< its speed is zero
    key_frees,     ///< from a flank that jammed it
    cable_turns,   ///< its speed is zero
    cable_starts_forth,
    cable_starts_back,
    flank,       ///< a tooth of the belt meets one of the key
    end_stop,    ///< the cable, forth or back
    slips,       ///< the load is above what the teeth hold
    next_tooth,  ///< of a belt that slips
    current_ends,
  };

  /// At rest, caught, without current.
  explicit Clutch(const ClutchParameters<T>& p) : p_(p) {}

  /// As given.
  const ClutchParameters<T>& parameters() const { return p_; }
  Key key() const { return key_; }        ///< mode of the key
  Cable cable() const { return cable_; }  ///< mode of the cable
  /// Whether the teeth hold the belt, or would stop it.
  bool caught(const State& s) const {
    return in_teeth_ && !slips_ &&
           (at_flank_ || value_of(s.key) <= value_of(p_.tooth_height_m - p_.hold_depth_m));
  }
  /// The longest step that keeps the energy to nine digits, s: the key moves for some milliseconds, and the cable
  /// oscillates between its springs at some 30 Hz.
  V longest_step() const { return key_ == Key::moving ? V(5e-5) : moves() ? V(2e-4) : V(1); }
  /// Teeth that the belt has skipped since the start, in both directions.
  std::uint32_t skipped_teeth() const { return skipped_; }
  /// f(Motion) of now. What a motion leaves out is constant, or keep_coil() computes it.
  template <class F>
  void in_motion(const F& f) const {
    const bool key = key_ == Key::moving || (key_ == Key::on_tips && moves());
    if (moves())
      key ? f(Motion<true, true>{}) : f(Motion<false, true>{});
    else
      key ? f(Motion<true, false>{}) : f(Motion<false, false>{});
  }

  /// Volts across the coil while it is on; 0 is off (current goes on through the flyback path).
  void set_voltage(const T& volts) { volts_ = volts; }

  /// At rest, caught, without current.
  void reset() {
    key_ = Key::seated;
    cable_ = Cable::blocked_back;
    in_teeth_ = true;
    at_flank_ = conducts_ = slips_ = false;
    tooth_ = 0;
    skipped_ = 0;
    volts_ = T(V(0));
  }

  /// Rates of the members that a motion moves; the others are zero.
  template <class Motion>
  [[gnu::always_inline]] State rates(Motion, const State& s, const CableDrive<T>& drive) const {
    State d;
    if constexpr (Motion::kCable) {
      const T net = drive.force - auxiliary(s);
      const T mass = p_.cable_mass_kg + drive.mass;
      const bool forth = cable_ == Cable::forth;
      const T friction = resistance(s);
      d.travel = s.speed;
      d.speed = (net - p_.cable_damping_nspm * s.speed + (forth ? T(-friction) : friction)) / mass;
      d.cable_damping = p_.cable_damping_nspm * s.speed * s.speed;
      d.friction = forth ? T(friction * s.speed) : T(-friction * s.speed);
    }
    if constexpr (Motion::kKey) {
      if (key_ == Key::moving) {
        const T rub = rubbing(s, drive);
        d.key = s.key_speed;
        d.key_speed =
            (key_force(s) - p_.key_damping_nspm * s.key_speed + (key_out_ ? T(-rub) : rub)) / p_.key_mass_kg;
        d.key_damping = p_.key_damping_nspm * s.key_speed * s.key_speed;
        d.friction += key_out_ ? T(rub * s.key_speed) : T(-rub * s.key_speed);
      }
      if (conducts_) {
        const bool on = value_of(volts_) > V(0);
        const T volts = on ? volts_ : T(-p_.solenoid.flyback_v);
        const T key_speed = key_ == Key::moving ? s.key_speed : T(V(0));
        d.current = p_.solenoid.current_rate(s.current, s.key, key_speed, volts);
        d.copper = p_.solenoid.resistance_ohm * s.current * s.current;
        if (on)
          d.electrical = volts * s.current;
        else
          d.flyback = -volts * s.current;
      }
    }
    return d;
  }

  /// While the key does not move, the coil's inductance is constant and its current has a closed form: puts the
  /// current and the coil's energies `t` seconds after `from` into `to`.
  void keep_coil(const State& from, State& to, const T& t) const {
    using std::exp;
    if (!conducts_ || key_ == Key::moving) return;
    const bool on = value_of(volts_) > V(0);
    const T volts = on ? volts_ : T(-p_.solenoid.flyback_v);
    const T& ohm = p_.solenoid.resistance_ohm;
    const T last = volts / ohm, away = from.current - last;
    const T time = p_.solenoid.inductance(from.key) / ohm, left = exp(T(-t / time));
    const T charge = last * t + away * time * (V(1) - left);
    to.current = last + away * left;
    to.copper = from.copper + ohm * (last * charge + last * away * time * (V(1) - left) +
                                     V(0.5) * away * away * time * (V(1) - left * left));
    if (on)
      to.electrical = from.electrical + volts * charge;
    else
      to.flyback = from.flyback - volts * charge;
  }

  /// f(change) of what can come next: what the state of now cannot do is left out.
  template <class F>
  [[gnu::always_inline]] void each_change(const F& f) const {
    switch (key_) {
      case Key::seated:
        f(Change::key_lifts);
        break;
      case Key::pulled:
        f(Change::key_leaves_stop);
        break;
      case Key::on_tips:
        f(Change::key_clears);
        if (moves()) f(Change::key_falls_in);
        break;
      case Key::jammed:
        f(Change::key_frees);
        break;
      case Key::moving:
        f(Change::key_turns);
        f(Change::key_meets_stop);
        if (in_teeth_) {
          f(Change::key_location_types);
          f(Change::key_clears);
        } else {
          f(Change::key_meets_tips);
        }
        break;
    }
    if (moves()) {
      f(Change::cable_turns);
      f(Change::end_stop);
      if (slips_)
        f(Change::next_tooth);
      else if (in_teeth_)
        f(Change::flank);
    } else {
      if (cable_ != Cable::blocked_forth) f(Change::cable_starts_forth);
      if (cable_ != Cable::blocked_back) f(Change::cable_starts_back);
      if (at_flank_) f(Change::slips);
    }
    if (conducts_ && !(value_of(volts_) > V(0))) f(Change::current_ends);
  }

  /// Positive while a change does not happen; its unit is that of the quantity that crosses zero: m, m/s, N or A.
  [[gnu::always_inline]] T margin(Change change, const State& s, const CableDrive<T>& drive) const {
    const T& height = p_.tooth_height_m;
    const T net = drive.force - auxiliary(s);
    const bool forth = cable_ == Cable::forth;
    switch (change) {
      case Change::key_lifts:
        return rubbing(s, drive) - key_force(s);
      case Change::key_leaves_stop:
        return key_force(s);
      case Change::key_location_types:
        return s.key;
      case Change::key_meets_stop:
        return p_.solenoid.stroke_m - s.key;
      case Change::key_meets_tips:
        return s.key - height;
      case Change::key_clears:
        return key_ == Key::on_tips ? T(-key_force(s)) : T(height - s.key);
      case Change::key_turns:
        return key_out_ ? s.key_speed : T(-s.key_speed);
      case Change::key_frees: {
        const T force = key_force(s);
        return rubbing(s, drive) - (value_of(force) < V(0) ? T(-force) : force);
      }
      case Change::key_falls_in:
        return beside_gap(s);
      case Change::cable_turns:
        return forth ? s.speed : T(-s.speed);
      case Change::cable_starts_forth:
        return resistance(s) - net;
      case Change::cable_starts_back:
        return resistance(s) + net;
      case Change::flank:
        return forth ? T(gap_end() - s.travel) : T(s.travel - gap_start());
      case Change::end_stop:
        return forth ? T(p_.travel_m - s.travel) : s.travel;
      case Change::slips:
        return holding() - flank_load(s, drive);
      case Change::next_tooth:  // or back into the gap that it slips out of
        if (forth)
          return value_of(s.travel) < value_of(gap_middle()) ? T(gap_start() - s.travel)
                                                             : T(gap_end() + p_.tooth_pitch_m - s.travel);
        return value_of(s.travel) > value_of(gap_middle()) ? T(s.travel - gap_end())
                                                           : T(s.travel - gap_start() + p_.tooth_pitch_m);
      case Change::current_ends:
        return s.current;
    }
    return T(V(1));
  }
  /// For Hybrid: margins of lengths and speeds may start at zero.
  static V tolerance(Change change) { return follows(change) ? V(0) : sizeof(V) == 4 ? V(1e-6) : V(1e-13); }
  /// For Hybrid: whether a change, one that forces make, happens at once where its margin starts at or below zero.
  static bool follows(Change change) {
    return change == Change::key_lifts || change == Change::key_leaves_stop || change == Change::key_frees ||
           change == Change::cable_starts_forth || change == Change::cable_starts_back ||
           change == Change::slips;
  }

  /// Takes the state through a change. Energy that the state has less after it is lost in an impact.
  void make(Change change, State& s, const CableDrive<T>& drive) {
    const T zero = T(V(0));
    switch (change) {
      case Change::key_lifts:
      case Change::key_leaves_stop:
      case Change::key_frees:
        move_key(s);
        break;
      case Change::key_turns: {
        s.key_speed = zero;
        const V force = value_of(key_force(s)), rub = value_of(rubbing(s, drive));
        if (force > rub || force < -rub)
          move_key(s);
        else
          key_ = Key::jammed;
        break;
      }
      case Change::key_location_types:
        key_ = Key::seated;
        s.key = s.key_speed = zero;
        break;
      case Change::key_meets_stop:
        key_ = Key::pulled;
        s.key = p_.solenoid.stroke_m;
        s.key_speed = zero;
        break;
      case Change::key_meets_tips:
        meet_tips(s);
        break;
      case Change::key_falls_in:
        fall_in(s);
        break;
      case Change::key_clears:
        in_teeth_ = at_flank_ = slips_ = false;
        move_key(s);
        break;
      case Change::cable_turns:
        s.speed = zero;
        cable_ = Cable::still;
        break;
      case Change::cable_starts_forth:
        cable_ = Cable::forth;
        at_flank_ = false;
        if (in_teeth_ && !slips_ && !(value_of(s.travel) < value_of(gap_end()))) block_at_flank(s, gap_end());
        break;
      case Change::cable_starts_back:
        cable_ = Cable::back;
        at_flank_ = false;
        if (!(value_of(s.travel) > V(0)))
          block(s, zero);
        else if (in_teeth_ && !slips_ && !(value_of(s.travel) > value_of(gap_start())))
          block_at_flank(s, gap_start());
        break;
      case Change::flank:
        meet_flank(s, drive);
        break;
      case Change::end_stop:
        at_flank_ = false;
        block(s, cable_ == Cable::forth ? p_.travel_m : zero);
        if (slips_ && value_of(beside_gap(s)) <= V(0)) {
          slips_ = false;
          tooth_ = static_cast<std::int32_t>(next_tooth(s));
        }
        break;
      case Change::slips:
        cable_ = cable_ == Cable::blocked_forth ? Cable::forth : Cable::back;
        slips_ = true;
        at_flank_ = false;
        if (key_ == Key::jammed) move_key(s);
        break;
      case Change::next_tooth: {
        const bool forth = cable_ == Cable::forth;
        if (forth == (value_of(s.travel) < value_of(gap_middle()))) {
          slips_ = false;
          break;
        }
        tooth_ += forth ? 1 : -1;
        ++skipped_;
        const T net = drive.force - auxiliary(s);
        if (value_of(forth ? net : T(-net)) - value_of(p_.cable_friction_n) < value_of(holding())) {
          slips_ = false;
          block_at_flank(s, forth ? gap_end() : gap_start());
        }
        break;
      }
      case Change::current_ends:
        s.current = zero;
        conducts_ = false;
        break;
    }
  }

  /// What follows at once from the state and its forces: call it after every change and where the voltage or
  /// the drive has changed.
  void settle(const State& s) {
    if (value_of(volts_) > V(0)) conducts_ = true;
    // Nothing is in the way of a cable whose flank has gone.
    const bool at_low = !(value_of(s.travel) > V(0)), at_high = !(value_of(s.travel) < value_of(p_.travel_m));
    if (!in_teeth_ &&
        ((cable_ == Cable::blocked_forth && !at_high) || (cable_ == Cable::blocked_back && !at_low)))
      cable_ = Cable::still;
  }

  /// Its energies; `cable_mass` is that of cable and all that moves with it, kg. The machine counts the impacts, which are
  /// zero here.
  ClutchEnergy<T> energy(const State& s, const T& cable_mass) const {
    ClutchEnergy<T> e;
    e.magnetic = p_.solenoid.magnetic_energy(s.current, s.key);
    e.key = V(0.5) * p_.key_mass_kg * s.key_speed * s.key_speed;
    e.return_spring = p_.pressing_force_n * s.key + V(0.5) * p_.return_stiffness_npm * s.key * s.key;
    e.cable = V(0.5) * cable_mass * s.speed * s.speed;
    e.auxiliary_spring =
        p_.auxiliary_preload_n * s.travel + V(0.5) * p_.auxiliary_stiffness_npm * s.travel * s.travel;
    e.electrical = s.electrical;
    e.copper = s.copper;
    e.flyback = s.flyback;
    e.key_damping = s.key_damping;
    e.cable_damping = s.cable_damping;
    e.friction = s.friction;
    return e;
  }

 private:
  bool moves() const { return cable_ == Cable::forth || cable_ == Cable::back; }
  T auxiliary(const State& s) const { return p_.auxiliary_preload_n + p_.auxiliary_stiffness_npm * s.travel; }

  /// On the key, away from its seat.
  T key_force(const State& s) const {
    return p_.solenoid.pull(s.current, s.key) - p_.pressing_force_n - p_.return_stiffness_npm * s.key;
  }
  /// Load that a key in the teeth holds: in proportion to the return spring's force, whatever the coil does.
  T holding() const { return p_.holding_ratio * p_.pressing_force_n; }
  /// Dry friction on the belt: pulleys and guide, the key's tips where it rides on them, and the teeth while
  /// they are skipped.
  T resistance(const State& s) const {
    return slips_                 ? T(p_.cable_friction_n + holding())
           : key_ == Key::on_tips ? T(p_.cable_friction_n - p_.tip_friction * key_force(s))
                                  : p_.cable_friction_n;
  }
  /// Friction of a loaded flank against the key's motion.
  T rubbing(const State& s, const CableDrive<T>& drive) const {
    return p_.flank_friction * flank_load(s, drive);
  }
  /// Of the belt on a flank of the key, >= 0.
  [[gnu::always_inline]] T flank_load(const State& s, const CableDrive<T>& drive) const {
    if (!in_teeth_ || !at_flank_) return T(V(0));
    const T net = drive.force - auxiliary(s);
    const T load = cable_ == Cable::blocked_forth  ? T(net - p_.cable_friction_n)
                   : cable_ == Cable::blocked_back ? T(-net - p_.cable_friction_n)
                                                   : T(V(0));
    return value_of(load) > V(0) ? load : T(V(0));
  }

  /// Where a belt under a key that is in stands against its flanks; forth it is a whole number of pitches.
  T gap_end() const { return static_cast<V>(tooth_) * p_.tooth_pitch_m; }
  T gap_start() const { return gap_end() - p_.tooth_clearance_m; }
  T gap_middle() const { return gap_end() - V(0.5) * p_.tooth_clearance_m; }
  /// How far the key's tips are from the next gap, in the direction of motion; negative: over one.
  T beside_gap(const State& s) const {
    const T middle = next_tooth(s) * p_.tooth_pitch_m - V(0.5) * p_.tooth_clearance_m;
    const T away = s.travel - middle;
    return (value_of(away) < V(0) ? T(-away) : away) - V(0.5) * p_.tooth_clearance_m;
  }
  /// The tooth whose gap is nearest.
  V next_tooth(const State& s) const {
    using std::floor;
    const V phase =
        (value_of(s.travel) + V(0.5) * value_of(p_.tooth_clearance_m)) / value_of(p_.tooth_pitch_m);
    return floor(phase + V(0.5));
  }

  void meet_tips(State& s) {
    if (value_of(beside_gap(s)) <= V(0)) {
      fall_in(s);
      return;
    }
    ride(s);
  }
  /// The key's tips stand on the belt's.
  void ride(State& s) {
    s.current *= p_.solenoid.inductance(s.key) / p_.solenoid.inductance(p_.tooth_height_m);  // flux stays
    s.key = p_.tooth_height_m;
    s.key_speed = T(V(0));
    key_ = Key::on_tips;
    in_teeth_ = slips_ = false;
  }
  void fall_in(const State& s) {
    in_teeth_ = true;
    at_flank_ = false;
    move_key(s);
    tooth_ = static_cast<std::int32_t>(next_tooth(s));
  }

  /// In the direction that it has, or in that of its force.
  void move_key(const State& s) {
    const V speed = value_of(s.key_speed);
    key_out_ = speed != V(0) ? speed > V(0) : value_of(key_force(s)) > V(0);
    key_ = Key::moving;
  }

  void block_at_flank(State& s, const T& at) {
    block(s, at);
    at_flank_ = true;
  }
  void block(State& s, const T& at) {
    cable_ = cable_ == Cable::forth ? Cable::blocked_forth : Cable::blocked_back;
    s.travel = at;
    s.speed = T(V(0));
  }

  /// Deep enough in the teeth the key stops the belt. From less, the tooth throws it out, if the belt has the
  /// energy that the return spring takes for it.
  void meet_flank(State& s, const CableDrive<T>& drive) {
    using std::sqrt;
    const T at = cable_ == Cable::forth ? gap_end() : gap_start();
    const T depth = p_.tooth_height_m - s.key;
    const T mass = p_.cable_mass_kg + drive.mass;
    const T lift = depth * (p_.pressing_force_n + p_.return_stiffness_npm * (s.key + V(0.5) * depth));
    const T left = s.speed * s.speed - V(2) * lift / mass;
    if (value_of(depth) >= value_of(p_.hold_depth_m) || !(value_of(left) > V(0))) {
      block_at_flank(s, at);
      return;
    }
    s.speed = cable_ == Cable::forth ? T(sqrt(left)) : T(-sqrt(left));
    ride(s);
  }

  ClutchParameters<T> p_;
  T volts_{};
  Key key_ = Key::seated;
  Cable cable_ = Cable::blocked_back;
  bool in_teeth_ = true, at_flank_ = false, conducts_ = false, key_out_ = false, slips_ = false;
  std::int32_t tooth_ = 0;
  std::uint32_t skipped_ = 0;
};

}  // namespace furcula::dynamics
