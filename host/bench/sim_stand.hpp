// The simulated bench of 002 section 5.1 (dynamics/clutch_bench.hpp) with its encoder of 2400 counts a turn,
// as the board of an application.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "firmware/app/board.hpp"
#include "furcula/dynamics/clutch_bench.hpp"
#include "furcula/dynamics/clutch_designs.hpp"
#include "host/bench/board.hpp"

namespace furcula::bench {

class SimStand {
 public:
  SimStand() { prepare({}, 0); }

  double metres_per_count() const { return 2.0 * 3.14159265358979323846 / 2400.0 * setup_.pulley_radius_m; }
  double pulley_radius_m() const { return setup_.pulley_radius_m; }
  double tooth_pitch_m() const { return setup_.clutch.tooth_pitch_m; }
  double travel_m() const { return setup_.clutch.travel_m; }

  /// The load hangs at rest on the caught belt, for so many ticks. Time goes on.
  void prepare(const Conditions& c, std::size_t ticks) {
    auto setup = setup_;
    setup.load_mass_kg = c.load_kg;
    setup.clutch.pressing_force_n = c.pressing_n;
    supply_v_ = c.supply_v;
    rig_.emplace(setup);
    next_ = {};
    ticks_left_ = ticks;
  }
  /// Of this tick: what was read, and what was commanded.
  const Reading& reading() const { return reading_; }

  // The application's seam (firmware/app/board.hpp).
  bool wait_for_tick() {
    if (ticks_left_ == 0) return false;
    --ticks_left_;
    now_us_ += 1000;
    return true;
  }
  std::uint32_t now_us() const { return now_us_; }
  Result<control::Sample> sense() const {
    control::Sample sample;
    sample.cable_count = static_cast<std::uint32_t>(next_.count);
    return sample;
  }
  Status actuate(const control::Command& command) {
    reading_ = next_;
    reading_.coil = static_cast<double>(command.coil_duty);
    const double volts = reading_.coil * supply_v_;
    rig_->advance(volts, 1e-3);
    next_ = {.count = static_cast<std::int32_t>(std::floor(rig_->travel_m() / metres_per_count() + 1e-9)),
             .current_a = rig_->current_a(),
             .voltage_v = volts};
    return Status::ok;
  }
  static void kick_watchdog() {}
  static bool take_reset_request() { return false; }
  static void report(const firmware::Telemetry&) {}

 private:
  dynamics::ClutchBenchSetup<double> setup_ = dynamics::release_catch_bench<double>();
  std::optional<dynamics::ClutchBenchRig<double>> rig_;
  double supply_v_ = 0.0;
  Reading reading_, next_;
  std::size_t ticks_left_ = 0;
  std::uint32_t now_us_ = 0;
};
static_assert(firmware::Board<SimStand>);

/// Of a board on the simulated bench: its coil gets the whole supply as long as it is on, which it stands.
inline control::Config stand_config(const SimStand& stand, const Timing& timing) {
  control::Config c;
  c.bench = {.on_bench = 1,
             .rest_ticks = static_cast<std::uint32_t>(timing.rest),
             .window_ticks = static_cast<std::uint32_t>(timing.window),
             .watch_ticks = static_cast<std::uint32_t>(timing.watch)};
  c.coil.peak_s = c.coil.longest_s = 100.0f;
  c.coil.hold_duty = 1.0f;
  c.coil.heat_max = 2.0f;
  c.clutch.fitted = 1;
  c.clutch.metres_per_count = static_cast<float>(stand.metres_per_count());
  c.clutch.tooth_pitch_m = static_cast<float>(stand.tooth_pitch_m());
  c.supervisor.cable_travel_max_m = static_cast<float>(stand.travel_m() + stand.tooth_pitch_m());
  return c;
}

}  // namespace furcula::bench
