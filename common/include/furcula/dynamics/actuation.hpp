// From the commands that are sent to the torque (or force) that acts: what the drive makes of them (delay,
// limit, lag: that is what its current shows), and what becomes of that in the motor (gain, offset, heat).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The commands of a recording, each held from its instant to the next. Spans of the same length.
template <class V>
struct Commands {
  std::span<const V> time_s;
  std::span<const V> command;
  std::span<const V> impulse;   ///< integral of the command since the first instant
  std::span<const V> driven_s;  ///< seconds since then in which the command was not zero

  /// Integral of the command from the first instant to `t`; before it the first command, after the last
  /// instant the last one. Carries the derivative by `t`.
  template <class T>
  T impulse_until(const T& t) const {
    const V at = value_of(t);
    const auto after = std::upper_bound(time_s.begin(), time_s.end(), at);
    const std::size_t i = after == time_s.begin() ? 0 : static_cast<std::size_t>(after - time_s.begin()) - 1;
    return impulse[i] + command[i] * (t - time_s[i]);
  }

  /// Integral from `from` to `to` of the command kept within +-limit.
  template <class T>
  T limited_impulse(const T& from, const T& to, const T& limit) const {
    const auto after = std::upper_bound(time_s.begin(), time_s.end(), value_of(from));
    std::size_t i = after == time_s.begin() ? 0 : static_cast<std::size_t>(after - time_s.begin()) - 1;
    T sum = T(V(0));
    T at = from;
    for (bool last = false; !last; ++i) {
      last = i + 1 >= time_s.size() || time_s[i + 1] >= value_of(to);
      const T end = last ? to : T(time_s[i + 1]);
      const V c = command[i];
      const T held = c > value_of(limit) ? limit : c < -value_of(limit) ? T(-limit) : T(c);
      sum += held * (end - at);
      at = end;
    }
    return sum;
  }
};

/// What the drive does to a command, each with one parameter: its current shows it.
inline constexpr Effect kDriveEffects[] = {Effect::actuator_delay, Effect::actuator_lag,
                                           Effect::torque_saturation};

/// The drive and the motor, step by step along the commands.
template <class T>
class Actuation {
 public:
  using V = ValueOf<T>;

  explicit Actuation(const Effects<T>& effects)
      : e_(effects),
        delays_(e_.has(Effect::actuator_delay) || e_.has(Effect::time_skew)),
        lags_(e_.has(Effect::actuator_lag)),
        limits_(e_.has(Effect::torque_saturation)),
        delay_(T(V(0))) {
    if (e_.has(Effect::actuator_delay)) delay_ += e_.value(Effect::actuator_delay);
    if (e_.has(Effect::time_skew)) delay_ += e_.value(Effect::time_skew);
  }

  /// True if the drive makes exactly what is commanded.
  bool ideal_drive() const { return !delays_ && !lags_ && !limits_; }

  /// True if earlier commands than a row's own act in it, other than by a lag.
  bool delays() const { return delays_; }

  /// How long before an instant the commands matter for it, s.
  V memory_s() const {
    constexpr V kTimeConstants = V(8);
    return lags_ ? kTimeConstants * value_of(e_.value(Effect::actuator_lag)) : V(0);
  }

  /// Starts at rest with the command of row `row`: a lag has caught up with it.
  void reset(const Commands<V>& commands, std::size_t row) { drive_ = T(commands.command[row]); }

  /// What the drive's current would show at the instant of the row that drive() is called for next, once its
  /// command has arrived. A delay is smoothed over a step.
  T at_row(const Commands<V>& commands, std::size_t row, V dt_s) const {
    if (lags_) return drive_;
    if (!delays_) return target(commands, row, dt_s);
    // Sampled at an instant: the mean over up to a step about it, so that it has a derivative.
    const V width = std::min(dt_s, V(2) * std::abs(value_of(delay_)));
    T now = T(commands.command[row]);
    if (width > V(0)) {
      const T centre = commands.time_s[row] - delay_;
      const V half = V(0.5) * width;
      now = (commands.impulse_until(T(centre + half)) - commands.impulse_until(T(centre - half))) / width;
    }
    return limits_ ? limited(now, e_.value(Effect::torque_saturation)) : now;
  }

  /// Mean of what the drive makes from row `row` on over `dt_s` seconds. Call for one row after the other.
  T drive(const Commands<V>& commands, std::size_t row, V dt_s) {
    T mean = target(commands, row, dt_s);
    if (lags_) {
      using std::exp;
      const T& tau = e_.value(Effect::actuator_lag);
      if (value_of(tau) > V(1e-6)) {
        const T decay = exp(-(dt_s / tau));
        const T target = mean;
        mean = target + (drive_ - target) * (V(1) - decay) * tau / dt_s;
        drive_ = target + (drive_ - target) * decay;
      } else {  // to first order in a vanishing time constant
        const T target = mean;
        mean = target + (drive_ - target) * tau / dt_s;
        drive_ = target;
      }
    }
    return mean;
  }

  /// What the motor makes of the drive's torque at row `row`.
  T motor(const T& drive, const Commands<V>& commands, std::size_t row) const {
    T torque = drive;
    if (e_.has(Effect::torque_gain_error)) torque *= e_.value(Effect::torque_gain_error);
    if (e_.has(Effect::thermal_derating)) {
      using std::exp;
      const T& final_gain = e_.value(Effect::thermal_derating, 0);
      torque *= final_gain +
                (V(1) - final_gain) * exp(-(commands.driven_s[row] / e_.value(Effect::thermal_derating, 1)));
    }
    if (e_.has(Effect::torque_offset)) torque += e_.value(Effect::torque_offset);
    return torque;
  }

 private:
  /// Mean over the row's step of the command, delayed and limited.
  T target(const Commands<V>& commands, std::size_t row, V dt_s) const {
    if (!delays_) {
      const T now = T(commands.command[row]);
      return limits_ ? limited(now, e_.value(Effect::torque_saturation)) : now;
    }
    const T from = commands.time_s[row] - delay_, to = from + dt_s;
    if (limits_) return commands.limited_impulse(from, to, e_.value(Effect::torque_saturation)) / dt_s;
    return (commands.impulse_until(to) - commands.impulse_until(from)) / dt_s;
  }

  static T limited(const T& torque, const T& limit) {
    return value_of(torque) > value_of(limit)    ? limit
           : value_of(torque) < -value_of(limit) ? T(-limit)
                                                 : torque;
  }

  Effects<T> e_;
  bool delays_, lags_, limits_;
  T delay_;
  T drive_{};
};

}  // namespace furcula::dynamics
