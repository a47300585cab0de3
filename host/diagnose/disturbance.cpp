#include "host/diagnose/disturbance.hpp"

#include <algorithm>
#include <cmath>

namespace furcula::diagnose {

double deviance(const LinearRun& w, const Disturbance& disturbance, std::size_t rows) {
  double sum = 0;
  DisturbanceFilter f(w, disturbance);
  Eigen::Vector3d state = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rows; ++i) {
    f.measure(w, disturbance);
    const double is_new = w.left[i] - state(0);
    if (i >= kSettles) sum += 2 * std::log(f.deviation) + is_new * is_new / (f.deviation * f.deviation);
    if (i + 1 == rows) break;
    state += f.gain * is_new;
    f.predict(w, disturbance, i);
    state = (f.step * state).eval();
  }
  return sum;
}

namespace {

double deviance(const std::vector<LinearRun>& all, const Disturbance& disturbance) {
  double sum = 0;
  for (const LinearRun& w : all) sum += deviance(w, disturbance, w.left.size());
  return sum;
}

}  // namespace

Disturbance likeliest_disturbance(const std::vector<LinearRun>& of, double typical_force) {
  constexpr std::size_t kMostWindows = 60;
  std::vector<LinearRun> all;
  const std::size_t every = (of.size() + kMostWindows - 1) / kMostWindows;
  for (std::size_t i = 0; i < of.size(); i += every) all.push_back(of[i]);
  Disturbance best;
  double least = deviance(all, best);
  const auto try_it = [&](const Disturbance& s) {
    const double value = deviance(all, s);
    if (value < least) least = value, best = s;
  };
  const bool impacts = std::any_of(all.begin(), all.end(), [](const LinearRun& w) {
    return std::any_of(w.impact_speed.begin(), w.impact_speed.end(), [](double v) { return v > 0; });
  });
  for (int round = 0; round < 2; ++round) {
    const Disturbance from = best;
    for (const double correlation_s : {0.003, 0.01, 0.03, 0.1, 0.3})
      for (double share = 1e-4; share < 0.5; share *= round == 0 ? 2.5 : 1.6) {
        Disturbance s = from;
        s.correlation_s = correlation_s;
        s.force = share * typical_force;
        try_it(s);
      }
    if (impacts)
      for (const double impact : {0.0, 0.002, 0.004, 0.008, 0.015, 0.03, 0.06}) {
        Disturbance s = best;
        s.impact = impact;
        try_it(s);
      }
    for (const double noise : {0.5, 0.7, 1.0, 1.4, 2.0}) {
      Disturbance s = best;
      s.noise = noise;
      try_it(s);
    }
  }
  return best;
}

}  // namespace furcula::diagnose
