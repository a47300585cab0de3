// A solenoid: coil with an inductance that grows as the plunger comes in, and the pull that follows from it.
#pragma once

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// L(y) = leakage + reach / (gap + stroke - y); y is the plunger's displacement inwards from its rest, m. Conservation of energy gives
/// L i' + R i + i L' y' = V and a pull of i^2 L' / 2 (docs/physics.md, the clutch).
template <class T>
struct Solenoid {
  /// Plain numbers: float or double.
  using V = ValueOf<T>;
  T resistance_ohm{};  ///< of the coil
  T leakage_h{};       ///< inductance that does not pull
  T reach_hm{};        ///< H m
  T stroke_m{};        ///< from rest to the stop
  T gap_m{};           ///< air gap that is left at the stop
  T flyback_v{};       ///< across the coil while it is switched off and current flows (a diode: about 1 V)

  /// Air gap at a displacement, m.
  T air(const T& y) const { return gap_m + stroke_m - y; }
  /// Inductance at a displacement, H.
  T inductance(const T& y) const { return leakage_h + reach_hm / air(y); }
  /// Derivative of the inductance by the displacement, H/m.
  T inductance_slope(const T& y) const { return reach_hm / (air(y) * air(y)); }
  /// Force on the plunger, inwards, at a current in A, N.
  T pull(const T& current, const T& y) const { return V(0.5) * current * current * inductance_slope(y); }
  /// Rate of the current, A/s, under `volts` across the coil; `speed` of the plunger in m/s.
  T current_rate(const T& current, const T& y, const T& speed, const T& volts) const {
    return (volts - resistance_ohm * current - current * inductance_slope(y) * speed) / inductance(y);
  }
  /// Energy in the magnetic field, J.
  T magnetic_energy(const T& current, const T& y) const { return V(0.5) * inductance(y) * current * current; }
};

}  // namespace furcula::dynamics
