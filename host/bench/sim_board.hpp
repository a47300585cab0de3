// The simulated bench with the controller on the host.
#pragma once

#include "firmware/app/app.hpp"
#include "host/bench/board.hpp"
#include "host/bench/sim_stand.hpp"

namespace furcula::bench {

/// What the simulated stand is, whoever commands it.
class StandBoard : public Board {
 public:
  double metres_per_count() const override { return stand_.metres_per_count(); }
  double pulley_radius_m() const override { return stand_.pulley_radius_m(); }
  double tooth_pitch_m() const override { return stand_.tooth_pitch_m(); }
  double travel_m() const override { return stand_.travel_m(); }

 protected:
  SimStand stand_;
};

class SimBoard final : public StandBoard {
 public:
  std::string name() const override { return "sim"; }
  std::vector<Reading> run(const Conditions& conditions, const Timing& timing) override {
    stand_.prepare(conditions, timing.rows());
    firmware::App app(stand_, stand_config(stand_, timing));
    std::vector<Reading> rows;
    rows.reserve(timing.rows());
    while (stand_.wait_for_tick()) {
      app.tick();
      rows.push_back(stand_.reading());
    }
    return rows;
  }
};

}  // namespace furcula::bench
