// Hops of a linear hopper with a clutch that lets its spring go in stance now and then.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

namespace furcula::test {

/// The robot of document 002 with its clutch along the leg; mass and damping free.
inline model::Model clutched_model() {
  model::Model m = hopper_model();
  m.clutch = model::Clutch{5e-3, 12e-3, 60.0, 4.2857e-3};
  return m;
}

/// `count` recordings of 2.5 s, each with four releases of 15 to 45 ms that begin some time into a stance and
/// one that begins in flight.
inline std::vector<log::Log> clutched_hops(const model::Model& truth, int count, unsigned seed) {
  const double straight_m =
      2.0 * truth.parameter("link_length_m") * std::cos(truth.parameter("touchdown_angle_rad"));
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    const double share = std::fmod(0.381966 * (static_cast<double>(seed) + i), 1.0);
    sim::Scenario s = sim::default_scenario(truth);
    s.start_position = 0.33 + 0.02 * share;
    s.amplitude = 1.6 + 0.8 * share;
    s.period_s = 0.3;
    s.duration_s = 2.5;
    s.sensors = {.quantisation = true, .noise = true};
    // When the body is below the straight leg's height, by a recording up to then.
    double from_s = 0.3;
    for (int k = 0; k < 4; ++k) {
      const log::Log so_far = sim::simulate(truth, s, seed);
      std::size_t row = static_cast<std::size_t>(from_s * 1e3);
      while (row + 1 < so_far.rows() && so_far.at("height_m")[row] < straight_m) ++row;
      while (row + 1 < so_far.rows() && so_far.at("height_m")[row] >= straight_m) ++row;
      const double at_s = 1e-3 * static_cast<double>(row) + 0.01 + 0.02 * std::fmod(share + 0.3 * k, 1.0);
      const double for_s = 0.015 + 0.03 * std::fmod(share + 0.17 * k, 1.0);
      if (at_s + 0.3 > s.duration_s) break;
      const auto milliseconds = [](double t) { return 1e-3 * std::round(1e3 * t); };
      s.clutch.push_back({milliseconds(at_s), true});
      s.clutch.push_back({milliseconds(at_s + for_s), false});
      from_s = at_s + 0.25;
      // The cable comes home in flight.
      const log::Log later = sim::simulate(truth, s, seed);
      row = static_cast<std::size_t>((at_s + 0.1) * 1e3);
      while (row + 1 < later.rows() && later.at("height_m")[row] < straight_m + 0.003) ++row;
      if (row + 100 >= later.rows()) break;
      s.clutch.push_back({1e-3 * static_cast<double>(row) + 0.005, true});
      s.clutch.push_back({1e-3 * static_cast<double>(row) + 0.020, false});
      from_s = 1e-3 * static_cast<double>(row) + 0.05;
    }
    logs.push_back(sim::simulate(truth, s, seed + static_cast<unsigned>(i)));
    logs.back().path = "hops-" + std::to_string(seed) + "-" + std::to_string(i) + ".csv";
  }
  return logs;
}

/// The same, but each release begins 25 to 45 ms before a lift-off and ends in the flight, where the cable is
/// at home: no catch hangs on which tooth a cable comes to.
inline std::vector<log::Log> hops_let_go_late(const model::Model& truth, int count, unsigned seed) {
  const double straight_m =
      2.0 * truth.parameter("link_length_m") * std::cos(truth.parameter("touchdown_angle_rad"));
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    const double share = std::fmod(0.381966 * (static_cast<double>(seed) + i), 1.0);
    sim::Scenario s = sim::default_scenario(truth);
    s.start_position = 0.34 + 0.02 * share;
    s.amplitude = 2.0 + 0.6 * share;
    s.duration_s = 3.0;
    s.sensors = {.quantisation = true, .noise = true};
    for (double from_s = 0.2; from_s < 2.2; from_s += 0.15) {
      const log::Log so_far = sim::simulate(truth, s, seed);
      const auto& height = so_far.at("height_m");
      auto row = static_cast<std::size_t>(from_s * 1e3);
      while (row + 1 < height.size() && height[row] >= straight_m) ++row;
      while (row + 1 < height.size() && height[row] < straight_m) ++row;
      if (row + 300 > height.size()) break;
      const int before_ms = 25 + static_cast<int>(20.0 * std::fmod(share + 0.37 * from_s, 1.0));
      s.clutch.push_back({1e-3 * (static_cast<int>(row) - before_ms), true});
      s.clutch.push_back({1e-3 * (static_cast<int>(row) + 40), false});
      from_s = 1e-3 * static_cast<double>(row) + 0.25;
    }
    logs.push_back(sim::simulate(truth, s, seed + static_cast<unsigned>(i)));
    logs.back().path = "late-" + std::to_string(seed) + "-" + std::to_string(i) + ".csv";
  }
  return logs;
}

}  // namespace furcula::test
