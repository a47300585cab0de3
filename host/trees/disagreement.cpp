// Which recording disagrees, see disagreement.hpp.
#include "host/trees/disagreement.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/message.hpp"
#include "host/core/outlier.hpp"
#include "host/trees/diagnose.hpp"

namespace furcula::trees {
namespace {

constexpr std::size_t kFewest = 5;
constexpr double kSuspect = 3.0;    // times the others' median: that it pulled the fit, too, hides a part
constexpr double kOverNoise = 9.0;  // of the squares

/// [joint][recording]: what runs leave, over the motion, and over noise.
struct Left {
  std::vector<std::vector<double>> nmse, over_noise;
};

Left left_by(const TreeModel& model, const std::vector<Recording>& recordings, double window_s,
             const Hypothesis& h) {
  Left left{std::vector<std::vector<double>>(model.joints()),
            std::vector<std::vector<double>>(model.joints())};
  for (const Recording& r : recordings) {
    const Predictions p = predict(model, {r}, window_s, h);
    for (std::size_t j = 0; j < model.joints(); ++j) {
      const double nmse = p.errors[j].nmse, floor = p.floor[j];
      left.nmse[j].push_back(std::isfinite(nmse) ? nmse : 0.0);
      left.over_noise[j].push_back(floor > 0.0 && std::isfinite(floor) ? nmse / floor : 0.0);
    }
  }
  return left;
}

/// Whether the others span how its joints were driven and how fast they moved.
bool within_others(const TreeModel& model, const std::vector<Recording>& recordings, std::size_t index) {
  for (std::size_t j = 0; j < model.joints(); ++j) {
    std::vector<double> torque, speed;
    for (const Recording& r : recordings) {
      const Scales s = scales_of(model, std::span(&r, 1));
      torque.push_back(s.torque_nm[j]);
      speed.push_back(s.velocity_radps[j]);
    }
    if (!core::within_others(torque, index, core::kHarder) ||
        !core::within_others(speed, index, core::kFaster))
      return false;
  }
  return true;
}

}  // namespace

std::optional<Disagreement> disagreeing(const TreeModel& model, const std::vector<Recording>& recordings,
                                        const Hypothesis& chosen, double window_s, std::size_t most_windows,
                                        unsigned threads) {
  if (recordings.size() < kFewest) return std::nullopt;
  const Left before = left_by(model, recordings, window_s, chosen);
  std::optional<std::size_t> worst;
  double most = kSuspect;
  for (std::size_t j = 0; j < model.joints(); ++j)
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      const double times = core::outlier(before.nmse[j], i).times;
      if (times <= most || before.over_noise[j][i] <= kOverNoise) continue;
      most = times;
      worst = i;
    }
  if (!worst || !within_others(model, recordings, *worst)) return std::nullopt;
  std::vector<Recording> others;
  for (std::size_t i = 0; i < recordings.size(); ++i)
    if (i != *worst) others.push_back(recordings[i]);
  Problem problem(model, others, windows_of(model, others, window_s, most_windows), threads);
  problem.weigh(chosen);
  const Hypothesis without = problem.fit(chosen, 6).at;
  const Left after = left_by(model, recordings, window_s, without);
  for (std::size_t j = 0; j < model.joints(); ++j) {
    const core::Outlier found = core::outlier(after.nmse[j], *worst);
    if (found.far && after.over_noise[j][*worst] > kOverNoise)
      return Disagreement{*worst, "disagrees with the other " + std::to_string(others.size()) +
                                      ": fitted on those, the model leaves " + core::rounded(found.times, 2) +
                                      " times as much of its motion as of theirs, at " +
                                      model.robot.joints[j].name};
  }
  return std::nullopt;
}

}  // namespace furcula::trees
