// Robots of several joints for tests: models on the URDFs beside these tests, inputs that a test chooses.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "host/trees/model.hpp"
#include "host/trees/recording.hpp"
#include "host/trees/simulate.hpp"
#include "tests/paths.hpp"

namespace furcula::test {

/// A model on tests/host/<urdf>. `settings` are the model file's lines after `urdf`, those of [model] first.
inline trees::TreeModel robot(const std::string& urdf, const std::string& settings = "") {
  const std::string path = source("tests/host/" + urdf);
  const auto slash = path.rfind('/');
  return trees::parse_tree_model(
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"" + path.substr(slash + 1) + "\"\n" + settings,
      path.substr(0, slash) + "/robot.toml");
}
inline trees::TreeModel wheel(const std::string& settings = "") {
  return robot("trees/robots/wheel.urdf", settings);
}
inline trees::TreeModel arm3(const std::string& settings = "") {
  return robot("trees/robots/arm3.urdf", settings);
}
inline trees::TreeModel pendulum(const std::string& settings = "") {
  return robot("model/robots/pendulum.urdf", settings);
}
inline trees::TreeModel double_pendulum(const std::string& settings = "") {
  return robot("model/robots/double_pendulum.urdf", settings);
}

/// Rows every `interval_s` with the joints' inputs from a function of joint and time. No joint moves in it.
inline trees::Recording inputs(const trees::TreeModel& model, double duration_s, double interval_s,
                               const std::function<double(std::size_t, double)>& input) {
  trees::Recording r;
  r.path = "made";
  r.interval_s = interval_s;
  const std::size_t n = model.joints();
  r.angle_rad.resize(n);
  r.input.resize(n);
  r.angle_noise_rad.assign(n, 1e-4);
  r.input_measured.assign(n, true);
  const auto rows = static_cast<std::size_t>(std::lround(duration_s / interval_s)) + 1;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = interval_s * static_cast<double>(k);
    r.time_s.push_back(t);
    for (std::size_t j = 0; j < n; ++j) {
      r.angle_rad[j].push_back(0.0);
      r.input[j].push_back(input(j, t));
    }
  }
  return r;
}

inline std::size_t link(const trees::TreeModel& m, const std::string& name) {
  for (std::size_t i = 0; i < m.robot.links.size(); ++i)
    if (m.robot.links[i].name == name) return i;
  FAIL("no link " + name);
  return 0;
}
inline std::size_t joint(const trees::TreeModel& m, const std::string& name) {
  for (std::size_t i = 0; i < m.joints(); ++i)
    if (m.robot.joints[i].name == name) return i;
  FAIL("no joint " + name);
  return 0;
}

/// Logs of the robot on sines of different sizes and speeds.
inline std::vector<log::Log> logs(const trees::TreeModel& model, std::size_t count, double duration_s,
                                  unsigned seed) {
  std::vector<log::Log> out;
  for (std::size_t i = 0; i < count; ++i) {
    trees::Scenario s = trees::default_scenario(model);
    s.duration_s = duration_s;
    for (std::size_t j = 0; j < s.paths.size(); ++j) {
      s.paths[j].period_s *= 1.0 - 0.13 * static_cast<double>(i % 4);
      s.paths[j].phase_rad += 1.1 * static_cast<double>(i) * static_cast<double>(j + 1);
    }
    out.push_back(trees::simulate(model, s, seed + i));
    out.back().path = "log_" + std::to_string(seed + i) + ".csv";
  }
  return out;
}

}  // namespace furcula::test
