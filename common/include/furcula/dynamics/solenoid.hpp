// A solenoid: coil with an inductance that grows as the plunger comes in, and the pull that follows from it.
#pragma once

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// L(y) = leakage + reach / (gap + far - y), y the plunger's way in from its rest, m; SI units. Energy alone
/// makes the rest: L i' + R i + i L' y' = V, and a pull of i^2 L' / 2 (docs/physics.md, the clutch).
template <class T>
struct Solenoid {
  using V = ValueOf<T>;
  T resistance_ohm{};
  T leakage_h{};  ///< inductance that does not pull
  T reach_hm{};   ///< H m
  T stroke_m{};   ///< from rest to the stop
  T gap_m{};      ///< air gap that is left at the stop
  T flyback_v{};  ///< across the coil while it is switched off and current flows (a diode: about 1 V)

  T air(const T& y) const { return gap_m + stroke_m - y; }
  T inductance(const T& y) const { return leakage_h + reach_hm / air(y); }
  T inductance_slope(const T& y) const { return reach_hm / (air(y) * air(y)); }
  T pull(const T& current, const T& y) const { return V(0.5) * current * current * inductance_slope(y); }
  T current_rate(const T& current, const T& y, const T& speed, const T& volts) const {
    return (volts - resistance_ohm * current - current * inductance_slope(y) * speed) / inductance(y);
  }
  T magnetic_energy(const T& current, const T& y) const { return V(0.5) * inductance(y) * current * current; }
};

}  // namespace furcula::dynamics
