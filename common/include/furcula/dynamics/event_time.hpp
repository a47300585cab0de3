// Locates an event inside a step: the time at which a function of the flow crosses zero.
#pragma once

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The time t in [from, to] at which f crosses zero, f(from) and f(to) having opposite signs (or f(to) = 0).
/// `f(t)` returns the value, `rate(t)` its derivative. Newton's method kept inside a shrinking bracket; ends
/// when a step no longer moves t by more than a few roundings of `to`, after at most 60 rounds.
template <class V, class F, class R>
V event_time(V from, V to, const F& f, const R& rate) {
  const bool rising = f(to) > V(0) || f(from) < V(0);
  V low = from;
  V high = to;
  V t = to;
  for (int round = 0; round < 60; ++round) {
    const V value = f(t);
    if (value == V(0)) return t;
    if ((value > V(0)) == rising)
      high = t;
    else
      low = t;
    const V slope = rate(t);
    V next = slope != V(0) ? t - value / slope : low;
    if (!(next > low && next < high)) next = low + (high - low) * V(0.5);
    const V moved = next > t ? next - t : t - next;
    t = next;
    if (moved <= to * (sizeof(V) == 4 ? V(1e-7) : V(1e-15))) break;
  }
  return t;
}

/// The same for an f whose derivative costs as much as f does: the secant method from the end of the bracket,
/// for f(to) < 0.
template <class V, class F>
V event_time(V from, V to, const F& f) {
  V low = from, high = to;
  V last = to, last_value = f(to);
  V t = to - V(0.01) * (to - from);
  for (int round = 0; round < 60; ++round) {
    const V value = f(t);
    if (value == V(0)) return t;
    (value < V(0) ? high : low) = t;
    V next = value != last_value ? t - value * (t - last) / (value - last_value) : low;
    if (!(next > low && next < high)) next = low + (high - low) * V(0.5);
    const V moved = next > t ? next - t : t - next;
    last = t;
    last_value = value;
    t = next;
    if (moved <= to * (sizeof(V) == 4 ? V(1e-7) : V(1e-15))) break;
  }
  return t;
}

}  // namespace furcula::dynamics
