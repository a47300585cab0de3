#include "host/gait/stability.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "host/core/message.hpp"

namespace furcula::gait {
namespace {

/// What one start comes to.
bool returns(const HeldGait& gait, Apex<double> at, const BasinOptions& options) {
  StrideOptions stride;
  stride.lift_off = gait.gait().task.lift_off;
  stride.energies = false;
  const auto home = gait.apex().values(), spread = options.spread.values();
  for (unsigned k = 0; k < options.strides; ++k) {
    const StrideEnd<double> e = gait.stride(at, stride);
    // A toe that the ground would have to hold just after touch-down bounces.
    if (!e.whole || e.joint_excess_rad > options.joint_excess_rad || e.least_force_n < -1.0) return false;
    at = e.apex;
    const auto now = at.values();
    bool near = true;
    for (std::size_t i = 0; i < 6; ++i) near &= std::abs(now[i] - home[i]) <= options.near * spread[i];
    if (near) return true;
  }
  return false;
}

}  // namespace

Basin basin_of(const HeldGait& gait, const BasinOptions& options) {
  std::mt19937_64 random(options.seed);
  const auto drawn = [&] { return 2.0 * static_cast<double>(random() >> 11) / 9007199254740992.0 - 1.0; };
  const auto home = gait.apex().values(), spread = options.spread.values();
  Basin out;
  for (; out.starts < options.starts; ++out.starts) {
    std::array<double, 6> at = home;
    for (std::size_t i = 0; i < 6; ++i) at[i] += spread[i] * drawn();
    out.returned += returns(gait, Apex<double>::of(at), options) ? 1 : 0;
  }
  return out;
}

Stability stability_of(const Gait& gait, const StanceGains& gains) {
  HeldGait held(gait);
  Stability out;
  out.gains = gains;
  out.open_loop = basin_of(held);
  held.set_gains(gains);
  out.multipliers = held.multipliers();
  out.basin = basin_of(held);
  return out;
}

std::optional<StableGait> cheapest_stable(const Query& query, const Search& found,
                                          const std::function<void(std::string_view)>& tell) {
  const auto judged = [](double speed, const Gait& gait, const Evaluation& e) -> std::optional<StableGait> {
    const auto multipliers = HeldGait(gait, kStanceGains).multipliers();
    if (multipliers.empty() || !(std::abs(multipliers.front()) < 1.0)) return std::nullopt;
    return StableGait{speed, gait, e, stability_of(gait)};
  };
  if (auto itself = judged(query.task.landing_speed_mps, *found.gait, found.evaluation)) return itself;
  constexpr double kStep = 0.25, kMost = 3.0;
  Query q = query;
  q.starts = 1;
  q.explains = false;
  q.progress = nullptr;
  q.from = found.free;
  for (double speed = kStep; speed <= kMost; speed += kStep) {
    if (speed <= std::max(query.task.landing_speed_mps, found.evaluation.stride.touchdown_speed_mps))
      continue;
    tell("a stable gait: the toe lands with " + core::rounded(speed, 3) + " m/s");
    q.task.landing_speed_mps = speed;
    // Free torques tell which speed it takes; the print's parameters are fitted there.
    q.fourier = false;
    const Search free = find_gait(q);
    if (!free.gait) continue;
    q.from = free.free;
    auto stable = judged(speed, *free.gait, free.evaluation);
    if (!stable) continue;
    if (!query.fourier) return stable;
    q.fourier = true;
    const Search fitted = find_gait(q);
    if (!fitted.gait) continue;
    if (auto both = judged(speed, *fitted.gait, fitted.evaluation)) return both;
  }
  return std::nullopt;
}

}  // namespace furcula::gait
