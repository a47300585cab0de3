#include "host/walk/postures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/core/message.hpp"
#include "host/walk/search.hpp"

namespace furcula::walk {
namespace {

/// The ranges of the posture's three angles, and their ends.
std::vector<Parameters> postures() {
  constexpr int kEach = 9;
  std::array<double, Parameters::kCount> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = control::kWalkParameters[i].start;
  const auto put = [&](std::size_t i, int at) {
    const auto& p = control::kWalkParameters[i];
    values[i] = p.least + (p.most - p.least) * at / (kEach - 1);
  };
  std::vector<Parameters> out;
  for (int knee = 0; knee < kEach; ++knee)
    for (int hip = 0; hip < kEach; ++hip)
      for (int ankle = 0; ankle < kEach; ++ankle) {
        put(0, knee), put(1, hip), put(2, ankle);
        out.push_back(Parameters::of(values));
      }
  return out;
}

/// A limit that ends a run: where it is wide open, and whether keeping it asks for less or for more.
struct Hard {
  std::string_view name, unit;
  double WalkLimits::*of;
  double open;
  std::string_view at;
};
constexpr std::array<Hard, 3> kHard{{{"height_m", "m", &WalkLimits::height_m, 0.0, "at most"},
                                     {"range_rad", "rad", &WalkLimits::range_rad, 10.0, "at least"},
                                     {"apart_m", "m", &WalkLimits::apart_m, 0.0, "at most"}}};

}  // namespace

std::string limit_of_no_posture(const dynamics::biped::Description& robot, const RolloutOptions& options) {
  const std::vector<Parameters> all = postures();
  RolloutOptions first = options;  // the first tick
  first.time_s = options.tick_s();
  const auto some_stand = [&](const WalkLimits& limits) {
    first.limits = limits;
    const auto rollouts = run_walks(robot, first, all, 1);
    return std::any_of(rollouts.begin(), rollouts.end(),
                       [](const Rollout& r) { return r.ending == Ending::stands; });
  };
  if (some_stand(options.limits)) return {};
  WalkLimits open = options.limits;
  for (const Hard& h : kHard) open.*h.of = h.open;
  std::string together;
  for (const Hard& h : kHard) {
    WalkLimits alone = open;
    const double asked = alone.*h.of = options.limits.*h.of;
    together += (together.empty() ? "" : ", ") + std::string(h.name) + " = " + core::shortest(asked);
    if (some_stand(alone)) continue;
    double kept = h.open, broken = asked;
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = alone.*h.of = 0.5 * (kept + broken);
      (some_stand(alone) ? kept : broken) = middle;
    }
    // Towards what is kept.
    kept = (h.open > asked ? std::ceil(1e3 * kept) : std::floor(1e3 * kept)) / 1e3;
    return "[limits] " + std::string(h.name) + " = " + core::shortest(asked) +
           ": no posture in the ranges that are sought keeps it; expected " + std::string(h.at) + " " +
           core::shortest(kept) + " " + std::string(h.unit);
  }
  return "[limits] " + together + ": no posture in the ranges that are sought keeps them together";
}

}  // namespace furcula::walk
