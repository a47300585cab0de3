// Walks for tests: one that a search found, and those near where searches start.
#pragma once

#include <cmath>
#include <vector>

#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/walk_file.hpp"
#include "tests/paths.hpp"

namespace furcula::test {

inline walk::Walk found_walk(const char* mode = "active") {
  return walk::read_walk(source("tests/host/walk/" + std::string(mode) + "_walk.toml"));
}

inline walk::Parameters start_walk() {
  std::array<double, walk::Parameters::kCount> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = control::kWalkParameters[i].start;
  return walk::Parameters::of(values);
}

/// All within the ranges, and most of them fall.
inline std::vector<walk::Parameters> walks_about_the_start(std::size_t count) {
  std::vector<walk::Parameters> out;
  for (std::size_t k = 0; k < count; ++k) {
    auto values = start_walk().values();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& p = control::kWalkParameters[i];
      const double share = 0.15 * std::sin(2.3 * static_cast<double>(i) + 1.1 * static_cast<double>(k * k));
      values[i] = std::fmin(p.most, std::fmax(p.least, values[i] + share * (p.most - p.least)));
    }
    out.push_back(walk::Parameters::of(values));
  }
  return out;
}

/// Does not begin to walk.
inline walk::Parameters standing_walk() {
  walk::Parameters w = start_walk();
  w.start_s = 1e3;
  w.sway_rad = 0.0;
  return w;
}

}  // namespace furcula::test
