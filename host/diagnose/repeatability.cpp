#include "host/diagnose/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/identify/prediction.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {

using identify::Recording;
using identify::Window;

bool falls_repeat(const model::Model& m, const std::vector<Recording>& recordings,
                  const std::vector<Window>& windows, const std::vector<identify::StartState>& starts) {
  constexpr double kForces[] = {-0.04, -0.02, -0.01, 0.0, 0.01, 0.02, 0.04}, kOfFall = 0.01, kWindows = 0.9;
  const auto at = dynamics::parameter_index(m.kind, "pulley_inertia_kgm2");
  if (!at) return false;
  const double inertia = machines::rules(m.kind).inertia(m);
  double well = 0.0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Window& w = windows[i];
    const Recording& r = recordings[w.recording];
    double least = std::numeric_limits<double>::infinity(), spread = 0.0;
    for (double force : kForces) {  // so much less weight is as much more inertia
      model::Model other = m;
      other.parameters[*at] -= force * inertia;
      const identify::Run run = identify::predict(other, r, w, starts[i]);
      double squares = 0.0;
      for (std::size_t k = 0; k < w.rows(); ++k) {
        squares += std::pow(run.position[k] - r.position[w.first + k], 2) / static_cast<double>(w.rows());
        spread = std::max(spread, std::abs(r.position[w.first + k] - r.position[w.first]));
      }
      least = std::min(least, squares);
    }
    well += least <= kWithinNoise * r.position_noise * r.position_noise + std::pow(kOfFall * spread, 2);
  }
  return well >= kWindows * static_cast<double>(windows.size());
}

bool random_alone_in_training(const model::Model& m, const std::vector<Recording>& training,
                              const std::vector<Window>& windows, const std::optional<Remainder>& left) {
  if (left) return !left->is_structured_in_training() && left->repeats_in_training();
  return falls_repeat(m, training, windows, identify::start_states(training, windows, m));
}

}  // namespace furcula::diagnose
