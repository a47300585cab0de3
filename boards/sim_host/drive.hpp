// The simulated drive and motor: what they make of the commands, one after the other.
#pragma once

#include <vector>

#include "furcula/dynamics/actuation.hpp"

namespace furcula::sim_host {

/// dynamics::Actuation with the commands that it looks back on. A skew of the position's clock is none of its
/// business: see sim::skew_columns.
class Drive {
 public:
  explicit Drive(dynamics::Effects<double> effects)
      : actuation_(without_skew(effects)), looks_back_(actuation_.delays()) {}

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

 private:
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
  }

  dynamics::Commands<double> commands() const { return {time_s_, command_, impulse_, driven_s_}; }

  static dynamics::Effects<double> without_skew(dynamics::Effects<double> effects) {
    effects.clear(dynamics::Effect::time_skew);
    return effects;
  }

  dynamics::Actuation<double> actuation_;
  std::vector<double> time_s_, command_, impulse_, driven_s_;
  bool looks_back_;
  double last_step_s_ = 0.0;
  bool sent_ = false;
};

}  // namespace furcula::sim_host
