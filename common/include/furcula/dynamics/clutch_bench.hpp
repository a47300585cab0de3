// The release/catch bench of 002 section 5.1: a dead weight hangs on the clutch's belt, an encoder counts the
// pulley's turns.
#pragma once

#include "furcula/dynamics/clutch.hpp"
#include "furcula/dynamics/hybrid.hpp"

namespace furcula::dynamics {

/// The belt runs over the pulley without slip; its way is the clutch's travel.
template <class T>
struct ClutchBenchSetup {
  ClutchParameters<T> clutch;
  T load_mass_kg{}, pulley_radius_m{}, pulley_inertia_kgm2{}, gravity_mps2{};
};

/// Starts at rest, caught, at travel 0.
template <class T>
class ClutchBenchRig {
 public:
  using V = ValueOf<T>;
  using State = typename Clutch<T>::State;
  using Change = typename Clutch<T>::Change;

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

  const T& travel_m() const { return s_.travel; }
  const T& speed_mps() const { return s_.speed; }
  T pulley_angle_rad() const { return s_.travel / p_.pulley_radius_m; }
  const T& current_a() const { return s_.current; }
  const T& key_m() const { return s_.key; }
  const Clutch<T>& clutch() const { return clutch_; }
  bool caught() const { return clutch_.caught(s_); }

  ClutchEnergy<T> energy() const {
    ClutchEnergy<T> e = clutch_.energy(s_, T(p_.clutch.cable_mass_kg + drive_.mass));
    e.impacts = impacts_;
    return e;
  }
  /// Of the weight, from where it hung at the start, J.
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
