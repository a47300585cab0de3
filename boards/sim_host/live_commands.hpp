// The commands of a run that goes on: what an actuation makes of them, one after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "furcula/dynamics/actuation.hpp"

namespace furcula::sim_host {

/// Keeps those that the actuation looks back on, and no older ones: a rig may run for weeks. One actuation
/// for all of a run.
class LiveCommands {
 public:
  /// What the drive's current shows once this command has arrived, which the next step holds.
  double shown(dynamics::Actuation<double>& actuation, double command, double step_s) {
    send(actuation, command, step_s);
    sent_ = true;
    return actuation.drive.shown(commands(), command_.size() - 1, step_s);
  }

  /// The mean torque behind the motor (force on a linear axis) over the next `step_s`, the command held.
  double torque(dynamics::Actuation<double>& actuation, double command, double step_s) {
    if (!sent_) send(actuation, command, step_s);
    sent_ = false;
    command_.back() = command;
    return actuation.torque(commands(), command_.size() - 1, step_s);
  }

  /// How many commands it holds.
  std::size_t kept() const { return command_.size(); }

 private:
  /// So many at least: forgetting moves what is left, and shall be rare.
  static constexpr std::size_t kKept = 1024;

  /// What neither a delay nor the smoothing over a step (Drive::shown) reaches back to.
  void forget(double delay_s) {
    if (command_.size() < full_) return;
    const double oldest_s = time_s_.back() - std::abs(delay_s) - 2.0 * last_step_s_;
    const auto first = std::upper_bound(time_s_.begin(), time_s_.end(), oldest_s) - time_s_.begin();
    // The command of before then holds until then.
    for (auto* column : {&time_s_, &command_, &impulse_, &driven_s_})
      column->erase(column->begin(), column->begin() + std::max<std::ptrdiff_t>(first - 1, 0));
    full_ = std::max(kKept, 2 * command_.size());
  }

  struct Sent {
    double time_s = 0.0, impulse = 0.0, driven_s = 0.0;
  };
  void send(dynamics::Actuation<double>& actuation, double command, double step_s) {
    Sent next;
    if (!command_.empty()) {
      next.time_s = time_s_.back() + last_step_s_;
      next.impulse = impulse_.back() + command_.back() * last_step_s_;
      next.driven_s = driven_s_.back() + (command_.back() != 0.0 ? last_step_s_ : 0.0);
    }
    const bool first = command_.empty();
    // Without a delay nothing before the last command matters.
    if (first || actuation.drive.delays()) {
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
    if (first) actuation.drive.start(commands(), 0);
    if (actuation.drive.delays()) forget(actuation.drive.delay_s());
  }

  dynamics::Commands<double> commands() const { return {time_s_, command_, impulse_, driven_s_}; }

  std::vector<double> time_s_, command_, impulse_, driven_s_;
  double last_step_s_ = 0.0;
  std::size_t full_ = kKept;  ///< at so many it forgets
  bool sent_ = false;
};

}  // namespace furcula::sim_host
