// The stage of actuation: from the commands that are sent to the torque (or force) that acts. What the drive
// makes of them (delay, limit, lag: that is what its current shows), and what becomes of that in the motor
// (gain, heat, offset). The rotor, which turns with the leg, is stepped with it: rotor.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The commands of a recording, each held from its instant to the next. Spans of the same length.
template <class V>
struct Commands {
  std::span<const V> time_s;    ///< instant of each row, increasing
  std::span<const V> command;   ///< of each row: N m, N on a linear axis, 1 (on) or 0 (off) for a coil
  std::span<const V> impulse;   ///< integral of the command since the first instant
  std::span<const V> driven_s;  ///< seconds since then in which the command was not zero

  /// Integral of the command from the first instant to `t`; before it the first command, after the last
  /// instant the last one. Carries the derivative by `t`.
  template <class T>
  T impulse_until(const T& t) const {
    const std::size_t i = row_at(value_of(t));
    return impulse[i] + command[i] * (t - time_s[i]);
  }

  /// The last row that is not after `at`, or the first. Rows are nearly evenly spaced, so it is looked for first where that would put it.
  std::size_t row_at(V at) const {
    constexpr int kSteps = 4;
    if (!(at >= time_s.front())) return 0;
    const std::size_t last = time_s.size() - 1;
    if (at >= time_s[last]) return last;
    const V share = (at - time_s.front()) / (time_s[last] - time_s.front());
    std::size_t i = std::min(static_cast<std::size_t>(share * static_cast<V>(last)), last - 1);
    for (int step = 0; step < kSteps; ++step) {
      if (at < time_s[i])
        --i;
      else if (at >= time_s[i + 1])
        ++i;
      else
        return i;
    }
    return static_cast<std::size_t>(std::upper_bound(time_s.begin(), time_s.end(), at) - time_s.begin()) - 1;
  }

  /// Integral from `from` to `to` of the command kept within +-limit.
  template <class T>
  T limited_impulse(const T& from, const T& to, const T& limit) const {
    std::size_t i = row_at(value_of(from));
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

/// The drive, step by step along the commands. All that it gives is in N m (N on a linear axis).
template <class T>
class Drive {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;

  /// `behind_s`: by how much the clock of the rows' instants is behind that of the commands, s; may carry
  /// derivatives. Nothing where it is the same clock.
  explicit Drive(const Effects<T>& effects, const std::optional<T>& behind_s = {})
      : Drive(EffectsOf<T, Stage::actuation>(effects), behind_s) {}

  /// True if it makes exactly what is commanded.
  bool ideal() const { return ideal_; }

  /// True if earlier commands than a row's own act in it, other than by a lag.
  bool delays() const { return delays_; }
  /// Delay from a command to its effect, s: that of the drive and the difference of the clocks, whose sum may be
  /// negative.
  V delay_s() const { return value_of(delay_); }

  /// How long before an instant the commands matter for its lag, s.
  V memory_s() const {
    constexpr V kTimeConstants = V(8);
    return lags_ ? kTimeConstants * value_of(time_constant_) : V(0);
  }

  /// Brings it to where it is at row `row`, from as far back as it remembers: there the lag has caught up.
  void start(const Commands<V>& commands, std::size_t row) {
    if (ideal()) return;
    std::size_t from = row;
    const V since = commands.time_s[row] - memory_s();
    while (from > 0 && commands.time_s[from] > since) --from;
    lagging_ = T(commands.command[from]);
    for (; from < row; ++from) torque(commands, from, commands.time_s[from + 1] - commands.time_s[from]);
  }

  /// What its current would show at the instant of the row that torque() is called for next, once its command
  /// has arrived. A delay is smoothed over a step.
  T shown(const Commands<V>& commands, std::size_t row, V dt_s) const {
    return ideal_ ? T(commands.command[row]) : sampled(commands, row, dt_s);
  }

  /// Mean from row `row` on over `dt_s` seconds. Call for one row after the other.
  T torque(const Commands<V>& commands, std::size_t row, V dt_s) {
    return ideal_ ? T(commands.command[row]) : follow(commands, row, dt_s);
  }

 private:
  Drive(const EffectsOf<T, Stage::actuation>& e, const std::optional<T>& behind_s)
      : delays_(e.has(Effect::actuator_delay) || behind_s.has_value()),
        lags_(e.has(Effect::actuator_lag)),
        limits_(e.has(Effect::torque_saturation)),
        ideal_(!delays_ && !lags_ && !limits_),
        delay_(e.value_or(Effect::actuator_delay, T(V(0)))),
        time_constant_(e.value(Effect::actuator_lag)),
        limit_(e.value(Effect::torque_saturation)) {
    if (behind_s) delay_ += *behind_s;
  }

  T sampled(const Commands<V>& commands, std::size_t row, V dt_s) const {
    if (lags_) return lagging_;
    if (!delays_) return target(commands, row, dt_s);
    // Sampled at an instant: the mean over up to a step about it, so that it has a derivative.
    const V width = std::min(dt_s, V(2) * std::abs(value_of(delay_)));
    T now = T(commands.command[row]);
    if (width > V(0)) {
      const T centre = commands.time_s[row] - delay_;
      const V half = V(0.5) * width;
      now = (commands.impulse_until(T(centre + half)) - commands.impulse_until(T(centre - half))) / width;
    }
    return limits_ ? limited(now) : now;
  }

  T follow(const Commands<V>& commands, std::size_t row, V dt_s) {
    const T wanted = target(commands, row, dt_s);
    if (!lags_) return wanted;
    using std::exp;
    const T& tau = time_constant_;
    T mean;
    if (value_of(tau) > V(1e-6)) {
      const T decay = exp(-(dt_s / tau));
      mean = wanted + (lagging_ - wanted) * (V(1) - decay) * tau / dt_s;
      lagging_ = wanted + (lagging_ - wanted) * decay;
    } else {  // to first order in a vanishing time constant
      mean = wanted + (lagging_ - wanted) * tau / dt_s;
      lagging_ = wanted;
    }
    return mean;
  }

  /// Mean over the row's step of the command, delayed and limited.
  T target(const Commands<V>& commands, std::size_t row, V dt_s) const {
    if (!delays_) {
      const T now = T(commands.command[row]);
      return limits_ ? limited(now) : now;
    }
    const T from = commands.time_s[row] - delay_, to = from + dt_s;
    if (limits_) return commands.limited_impulse(from, to, limit_) / dt_s;
    return (commands.impulse_until(to) - commands.impulse_until(from)) / dt_s;
  }

  T limited(const T& torque) const {
    return value_of(torque) > value_of(limit_)    ? limit_
           : value_of(torque) < -value_of(limit_) ? T(-limit_)
                                                  : torque;
  }

  bool delays_, lags_, limits_, ideal_;
  T delay_, time_constant_, limit_;
  T lagging_{};
};

/// The motor behind the drive: gain, heat, offset.
template <class T>
class Motor {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;

  /// Takes the gain, the derating by heat and the offset from the effects; the others are not looked at.
  explicit Motor(const Effects<T>& effects) : e_(effects) {}

  /// What it makes of the drive's torque after `driven_s` seconds in which there was a command.
  T torque(const T& drive, V driven_s) const {
    T torque = drive;
    if (e_.has(Effect::torque_gain_error)) torque *= e_.value(Effect::torque_gain_error);
    if (e_.has(Effect::thermal_derating)) {
      using std::exp;
      const T& final_gain = e_.value(Effect::thermal_derating, 0);
      torque *= final_gain + (V(1) - final_gain) * exp(-(driven_s / e_.value(Effect::thermal_derating, 1)));
    }
    if (e_.has(Effect::torque_offset)) torque += e_.value(Effect::torque_offset);
    return torque;
  }

 private:
  EffectsOf<T, Stage::actuation> e_;
};

/// Drive and motor.
template <class T>
struct Actuation {
  /// The value type of T: float or double.
  using V = ValueOf<T>;

  Drive<T> drive;  ///< from the command to the torque that its current shows
  Motor<T> motor;  ///< from that to the torque that acts

  /// Mean torque behind the motor from row `row` on over `dt_s` seconds. Call for one row after the other.
  T torque(const Commands<V>& commands, std::size_t row, V dt_s) {
    return motor.torque(drive.torque(commands, row, dt_s), commands.driven_s[row]);
  }
};

}  // namespace furcula::dynamics
