// The simulated bench of 002 section 5.1 (dynamics/clutch_bench.hpp) with its encoder of 2400 counts a turn.
#pragma once

#include <cmath>
#include <optional>

#include "furcula/dynamics/clutch_bench.hpp"
#include "furcula/dynamics/clutch_designs.hpp"
#include "host/bench/board.hpp"

namespace furcula::bench {

class SimBoard final : public Board {
 public:
  std::string name() const override { return "sim"; }
  double metres_per_count() const override {
    return 2.0 * 3.14159265358979323846 / 2400.0 * setup_.pulley_radius_m;
  }
  double pulley_radius_m() const override { return setup_.pulley_radius_m; }
  double tooth_pitch_m() const override { return setup_.clutch.tooth_pitch_m; }
  double travel_m() const override { return setup_.clutch.travel_m; }

  void prepare(const Conditions& c) override {
    auto setup = setup_;
    setup.load_mass_kg = c.load_kg;
    setup.clutch.pressing_force_n = c.pressing_n;
    supply_v_ = c.supply_v;
    rig_.emplace(setup);
  }
  Reading tick(bool coil) override {
    const double volts = coil ? supply_v_ : 0.0;
    rig_->advance(volts, 1e-3);
    return {static_cast<std::int32_t>(std::floor(rig_->travel_m() / metres_per_count() + 1e-9)),
            rig_->current_a(), volts};
  }

 private:
  dynamics::ClutchBenchSetup<double> setup_ = dynamics::release_catch_bench<double>();
  std::optional<dynamics::ClutchBenchRig<double>> rig_;
  double supply_v_ = 0.0;
};

}  // namespace furcula::bench
