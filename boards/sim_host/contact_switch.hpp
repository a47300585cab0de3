// The switch under the toe: bounces, and reports early or late (002 section 4.1, figure 4.4).
#pragma once

#include <cmath>
#include <cstdint>

#include "boards/sim_host/plant.hpp"
#include "boards/sim_host/sensors.hpp"
#include "host/core/random.hpp"

namespace furcula::sim_host {

/// Each touch-down and each lift-off draws by how much it is reported early (negative) or late, uniform
/// within +-10 ms. To report early the switch knows the future: a copy of the plant runs ahead with the command
/// held. (Where the torque does not move the leg in flight, an early touch-down report is exact.) Each
/// change is followed by a time in which the reading is drawn anew on each tick: 1 to 4 ms after closing, up
/// to 2 ms after opening.
class ContactSwitch {
 public:
  static constexpr double kJitterS = 0.010;

  /// `delay_s`: by how much every change is reported late (early below zero) on top of that.
  ContactSwitch(const SensorErrors& errors, double delay_s, std::uint64_t seed)
      : errors_(errors), delay_s_(delay_s), jitter_(seed, 2), bounce_(seed, 3), offset_s_(draw_offset()) {}

  /// Takes note of what happened in the plant's last advance(), which began at `start_s`.
  void follow(const Plant& plant, double start_s) {
    for (const auto& event : plant.events()) {
      const bool touchdown = event.kind == dynamics::ContactEvent<double>::Kind::touchdown;
      (touchdown ? touchdown_s_ : liftoff_s_) = start_s + event.offset_s;
      if (touchdown == closed_) caught_up_ = true;
    }
  }

  /// The raw reading at `now_s`; `torque_nm` is the command that the plant runs under.
  bool read(const Plant& plant, double torque_nm, double now_s) {
    if (changes(plant, torque_nm, now_s)) {
      closed_ = !closed_;
      changed_s_ = now_s;
      caught_up_ = plant.in_stance() == closed_;
      offset_s_ = draw_offset();
      if (errors_.bounce)
        bounces_until_s_ = now_s + (closed_ ? bounce_.uniform(0.001, 0.004) : bounce_.uniform(0.0, 0.002));
    }
    return now_s < bounces_until_s_ ? bounce_.coin() : closed_;
  }

 private:
  double draw_offset() { return delay_s_ + (errors_.jitter ? jitter_.uniform(-kJitterS, kJitterS) : 0.0); }
  double earliest_s() const { return kJitterS + std::abs(delay_s_); }

  bool changes(const Plant& plant, double torque_nm, double now_s) const {
    // Reported early: the event itself is still to come. (A lift-off that was foreseen may fail to come.)
    if (!caught_up_ && now_s - changed_s_ < 2.0 * earliest_s()) return false;
    if (plant.in_stance() != closed_) return now_s - (closed_ ? liftoff_s_ : touchdown_s_) >= offset_s_;
    const bool towards_change = closed_ ? plant.velocity_mps() > 0.0 : plant.toe_velocity_mps() < 0.0;
    return offset_s_ < 0.0 && towards_change && will_change(plant, torque_nm);
  }

  /// Whether the plant changes phase within the (early) offset.
  bool will_change(const Plant& plant, double torque_nm) const {
    // Further away than this it cannot get there in time: spares the run in most ticks.
    const double distance_m =
        closed_ ? std::abs(plant.height_m() - plant.touchdown_height_m()) : plant.toe_height_m();
    const double speed_mps = closed_ ? plant.velocity_mps() : plant.toe_velocity_mps();
    if (distance_m > 1.5 * earliest_s() * std::abs(speed_mps) + 0.005) return false;
    Plant ahead = plant;
    ahead.advance(torque_nm, -offset_s_);
    return !ahead.events().empty();
  }

  SensorErrors errors_;
  double delay_s_;
  core::Random jitter_, bounce_;
  bool closed_ = false;
  bool caught_up_ = true;  ///< the plant has been in the phase that the switch reports since it changed
  double offset_s_;        ///< of the next change
  double touchdown_s_ = -1.0, liftoff_s_ = -1.0, changed_s_ = -1.0, bounces_until_s_ = -1.0;
};

}  // namespace furcula::sim_host
