// The release/catch bench of 002 section 5.1: a dead weight hangs on the clutch's belt, an encoder measures the
// pulley's angle.
#pragma once

#include "furcula/dynamics/clutch.hpp"
#include "furcula/dynamics/hybrid.hpp"

namespace furcula::dynamics {

/// The belt runs over the pulley without slip; its displacement is the clutch's travel.
template <class T>
struct ClutchBenchSetup {
  ClutchParameters<T> clutch;  ///< lengths and forces along the belt
  T load_mass_kg{},            ///< weight that hangs on the belt
      pulley_radius_m{},       ///< of the belt on the pulley
      pulley_inertia_kgm2{},   ///< of pulley and encoder
      gravity_mps2{};          ///< acceleration of gravity, positive downwards
};

/// The bench with coil, key and teeth.
template <class T>
class ClutchBenchRig {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;
  /// The clutch's state is all that moves, for Hybrid.
  using State = typename Clutch<T>::State;
  /// The clutch's changes of mode are all that there are, for Hybrid.
  using Change = typename Clutch<T>::Change;

  /// Starts at rest, caught, at travel 0.
  explicit ClutchBenchRig(const ClutchBenchSetup<T>& p)
      : p_(p),
        clutch_(p.clutch),
        drive_{p.load_mass_kg * p.gravity_mps2,
               p.load_mass_kg + p.pulley_inertia_kgm2 / (p.pulley_radius_m * p.pulley_radius_m)} {
    clutch_.reset();
    clutch_.settle(s_);
  }

  /// Moves on by `dt_s` with the voltage across the coil held, V; 0 is off.
  void advance(const T& volts, V dt_s) {
    clutch_.set_voltage(volts);
    clutch_.settle(s_);
    V elapsed;
    Hybrid<ClutchBenchRig, T>::advance(*this, dt_s, elapsed);
  }

  const T& travel_m() const { return s_.travel; }  ///< of the belt since the start, positive downwards
  const T& speed_mps() const { return s_.speed; }  ///< of the belt, positive downwards
  T pulley_angle_rad() const { return s_.travel / p_.pulley_radius_m; }  ///< positive while the weight sinks
  const T& current_a() const { return s_.current; }                      ///< in the coil
  const T& key_m() const { return s_.key; }            ///< distance of the key from its seat
  const Clutch<T>& clutch() const { return clutch_; }  ///< its modes and counts
  bool caught() const { return clutch_.caught(s_); }   ///< the teeth hold the belt, or would stop it

  /// Energies of the clutch, J; `cable` has the kinetic energy of weight and pulley in it.
  ClutchEnergy<T> energy() const {
    ClutchEnergy<T> e = clutch_.energy(s_, T(p_.clutch.cable_mass_kg + drive_.mass));
    e.impacts = impacts_;
    return e;
  }
  /// Potential energy of the weight, zero where it hung at the start, J.
  T weight_energy() const { return -(drive_.force * s_.travel); }

 private:
  friend Hybrid<ClutchBenchRig, T>;
  struct Look {
    State state;
  };
  Look look() const { return {s_}; }
  void take(const Look& look) { s_ = look.state; }
  template <class F>
  void in_motion(const F& f) const {
    clutch_.in_motion(f);
  }
  template <class Motion>
  State rates(Motion motion, const Look& look) const {
    return clutch_.rates(motion, look.state, drive_);
  }
  template <class Motion>
  State rates(Motion motion, const State& s, const Look&) const {
    return clutch_.rates(motion, s, drive_);
  }
  template <class Motion>
  void arrive(Motion, const Look& from, const T& t, Look& end) const {
    clutch_.keep_coil(from.state, end.state, t);
  }
  V longest_step() const { return clutch_.longest_step(); }
  template <class F>
  void each_change(const F& f) const {
    clutch_.each_change(f);
  }
  T margin(Change c, const Look& look) const { return clutch_.margin(c, look.state, drive_); }
  static V tolerance(Change c) { return Clutch<T>::tolerance(c); }
  static bool follows(Change c) { return Clutch<T>::follows(c); }
  void make(Change c) {
    const T before = energy().held() + weight_energy();
    clutch_.make(c, s_, drive_);
    clutch_.settle(s_);
    impacts_ += before - energy().held() - weight_energy();
  }

  ClutchBenchSetup<T> p_;
  Clutch<T> clutch_;
  CableDrive<T> drive_;
  State s_{};
  T impacts_{};
};

}  // namespace furcula::dynamics
