// The exact flow of y'' + delta y' + kappa y = a with a held: what an exact zero-order hold (002 eq. 3.8)
// needs, for any length of step, so that events can be located inside a tick.
#pragma once

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// Response over a time t, from y(0) = 0 and y'(0) = v under the held acceleration a = (force - k z)/m at the
/// start:
///   y(t) = v g + a G,   y'(t) = v g' + a g.
/// g is the impulse response, G its integral, g' = 1 - delta g - kappa G.
template <class T>
struct Flow {
  T impulse;           ///< g(t), s
  T impulse_integral;  ///< G(t), s^2
  T impulse_rate;      ///< g'(t), 1
};

/// The flow over `t` seconds for damping delta = d/m (1/s) and stiffness kappa = k/m (1/s^2), both >= 0;
/// exact to the rounding of T. A power series over a time short enough to converge fast, then doublings: no
/// trigonometry, no branch on the damping ratio, and smooth in every argument.
template <class T>
Flow<T> flow(const T& kappa, const T& delta, const T& t) {
  using V = ValueOf<T>;
  constexpr int kMaxTerms = 18;
  constexpr int kMaxDoublings = 40;
  constexpr V kNegligible = sizeof(V) == 4 ? V(1e-16) : V(1e-34);  // squared, relative to h
  int doublings = 0;
  V reach = value_of(t) * value_of(delta) + value_of(t) * value_of(t) * value_of(kappa);
  T h = t;
  while (reach > V(0.25) && doublings < kMaxDoublings) {
    h = h * V(0.5);
    reach = value_of(h) * value_of(delta) + value_of(h) * value_of(h) * value_of(kappa);
    ++doublings;
  }
  // g = sum of c_n h^n with c_1 = 1 and c_{n+1} = -(delta c_n + kappa c_{n-1}/n)/(n+1); `term` is c_n h^n.
  T previous = T(V(0));
  T term = h;
  T g = h;
  T integral = h * h * V(0.5);
  const T delta_h = delta * h;
  const T kappa_hh = kappa * h * h;
  for (int n = 1; n < kMaxTerms; ++n) {
    const T next = -(delta_h * term + kappa_hh * previous / V(n)) / V(n + 1);
    previous = term;
    term = next;
    g += term;
    integral += h * term / V(n + 2);
    // Two terms in a row, since every other one vanishes without damping.
    const V size = value_of(term) * value_of(term) + value_of(previous) * value_of(previous);
    if (size <= value_of(h) * value_of(h) * kNegligible) break;
  }
  T rate = T(V(1)) - delta * g - kappa * integral;
  for (int i = 0; i < doublings; ++i) {
    const T stay = T(V(1)) - kappa * integral;
    integral = integral + g * g + stay * integral;
    const T g_doubled = g * (stay + rate);
    rate = rate * rate - kappa * g * g;
    g = g_doubled;
  }
  return {g, integral, rate};
}

}  // namespace furcula::dynamics
