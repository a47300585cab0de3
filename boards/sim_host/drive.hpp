// The simulated drive and motor: what they make of the commands, one after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "furcula/dynamics/actuation.hpp"

namespace furcula::sim_host {

/// dynamics::Actuation with the commands that it looks back on, and no older ones: a rig may run for weeks. A
/// skew of the position's clock is none of its business: see sim::skew_columns.
class Drive {
 public:
  explicit Drive(const dynamics::Effects<double>& effects)
      : actuation_(without_skew(effects)),
        looks_back_s_(std::abs(effects.value_or(dynamics::Effect::actuator_delay, 0.0))),
        looks_back_(actuation_.delays()) {}

  /// What the drive's current shows once this command has arrived, which the next step holds.
  double shows(double command, double step_s) {
    send(command, step_s);
    const double shown = actuation_.at_row(commands(), command_.size() - 1, step_s);
    sent_ = true;
    return shown;
  }

  /// The mean torque on the leg (force or torque on an axis) over the next `step_s`, the command held.
  double step(double command, double step_s) {
    if (!sent_) send(command, step_s);
    sent_ = false;
    const std::size_t row = command_.size() - 1;
    command_.back() = command;
    return actuation_.motor(actuation_.drive(commands(), row, step_s), commands(), row);
  }

  /// How many commands it holds.
  std::size_t kept() const { return command_.size(); }

 private:
  /// So many at least: forgetting moves what is left, and shall be rare.
  static constexpr std::size_t kKept = 1024;

  /// What neither a delay nor the smoothing over a step (Actuation::at_row) reaches back to.
  void forget() {
    if (command_.size() < full_) return;
    const double oldest_s = time_s_.back() - looks_back_s_ - 2.0 * last_step_s_;
    const auto first = std::upper_bound(time_s_.begin(), time_s_.end(), oldest_s) - time_s_.begin();
    // The command of before then holds until then.
    for (auto* column : {&time_s_, &command_, &impulse_, &driven_s_})
      column->erase(column->begin(), column->begin() + std::max<std::ptrdiff_t>(first - 1, 0));
    full_ = std::max(kKept, 2 * command_.size());
  }

  struct Sent {
    double time_s = 0.0, impulse = 0.0, driven_s = 0.0;
  };
  void send(double command, double step_s) {
    Sent next;
    if (!command_.empty()) {
      next.time_s = time_s_.back() + last_step_s_;
      next.impulse = impulse_.back() + command_.back() * last_step_s_;
      next.driven_s = driven_s_.back() + (command_.back() != 0.0 ? last_step_s_ : 0.0);
    }
    const bool first = command_.empty();
    // Without a delay nothing before the last command matters.
    if (first || looks_back_) {
      time_s_.push_back(next.time_s);
      impulse_.push_back(next.impulse);
      driven_s_.push_back(next.driven_s);
      command_.push_back(command);
    } else {
      time_s_.back() = next.time_s;
      impulse_.back() = next.impulse;
      driven_s_.back() = next.driven_s;
      command_.back() = command;
    }
    last_step_s_ = step_s;
    if (first) actuation_.reset(commands(), 0);
    if (looks_back_) forget();
  }

  dynamics::Commands<double> commands() const { return {time_s_, command_, impulse_, driven_s_}; }

  static dynamics::Effects<double> without_skew(dynamics::Effects<double> effects) {
    effects.clear(dynamics::Effect::time_skew);
    return effects;
  }

  dynamics::Actuation<double> actuation_;
  std::vector<double> time_s_, command_, impulse_, driven_s_;
  double looks_back_s_;
  bool looks_back_;
  double last_step_s_ = 0.0;
  std::size_t full_ = kKept;  ///< at so many it forgets
  bool sent_ = false;
};

}  // namespace furcula::sim_host
