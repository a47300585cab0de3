#include "host/trees/friction_at_rest.hpp"

#include <cmath>

namespace furcula::trees {
namespace {

/// A joint at rest is slower than this share of its usual speed; where it is for so much of a window, it does not move there.
constexpr double kSlow = 0.1, kAtRest = 0.25;
/// What friction gains in motion is by chance below so many scatters from window to window.
constexpr double kByChance = 2.0;
/// A window's gain in motion is next to nothing below this share of one's at rest.
constexpr double kOfRest = 0.05;

}  // namespace

bool is_dry_friction(Effect e) {
  return e == Effect::coulomb_friction || e == Effect::asymmetric_friction ||
         e == Effect::stribeck_friction || e == Effect::load_friction || e == Effect::binding_spot;
}

std::vector<bool> windows_in_motion(const Problem& problem, const Cause& cause) {
  const auto n = static_cast<Eigen::Index>(problem.joints());
  std::vector<bool> out;
  for (const Window& w : problem.windows()) {
    const Recording& r = problem.recordings()[w.recording];
    const Eigen::Index bins = w.measured.size() / n;
    const double bin_s = (r.time_s[w.last] - r.time_s[w.first]) / static_cast<double>(bins);
    bool moves = false;
    for (const std::size_t joint : cause.sites) {
      const double slow_rad = kSlow * problem.scales().velocity_radps[joint] * bin_s;
      Eigen::Index at_rest = 0;
      for (Eigen::Index b = 1; b < bins; ++b) {
        const auto k = b * n + static_cast<Eigen::Index>(joint);
        at_rest += std::abs(w.measured(k) - w.measured(k - n)) < slow_rad ? 1 : 0;
      }
      moves |= static_cast<double>(at_rest) < kAtRest * static_cast<double>(bins);
    }
    out.push_back(moves);
  }
  return out;
}

bool gains_in_motion(const Fit& with, const Fit& without, const std::vector<bool>& moves) {
  double gain = 0.0, squares = 0.0, windows = 0.0, gain_at_rest = 0.0, windows_at_rest = 0.0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const double of_window = without.window_loss[i] - with.window_loss[i];
    if (moves[i]) {
      gain += of_window;
      squares += of_window * of_window;
      windows += 1.0;
    } else {
      gain_at_rest += of_window;
      windows_at_rest += 1.0;
    }
  }
  return gain >= kByChance * std::sqrt(squares) || gain * windows_at_rest >= kOfRest * gain_at_rest * windows;
}

}  // namespace furcula::trees
