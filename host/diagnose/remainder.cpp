// See remainder.hpp.
#include "host/diagnose/remainder.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "host/diagnose/disturbance.hpp"
#include "host/diagnose/flexible_law.hpp"
#include "host/diagnose/linear_runs.hpp"

namespace furcula::diagnose {

namespace {

using dynamics::Effect;
using identify::Recording;
using identify::Window;

constexpr double kMostRandom = 0.04;  // of the typical force
constexpr std::size_t kFewestWindows = 4;

}  // namespace

bool Remainder::repeats() const { return largest_random_force() <= kMostRandom * typical_force; }

bool Remainder::repeats_in_training() const { return random_force <= kMostRandom * typical_force; }

std::optional<Remainder> remainder_of(const model::Model& fitted, const std::vector<Recording>& training,
                                      const std::vector<Window>& training_windows,
                                      const std::vector<Recording>& held_out,
                                      const std::vector<Window>& held_out_windows) {
  if (!dynamics::applies(Effect::force_offset, fitted.kind)) return std::nullopt;
  const std::vector<LinearRun> fit = linearised(fitted, training, training_windows),
                               judge = linearised(fitted, held_out, held_out_windows);
  const bool judged = !held_out_windows.empty();
  if (fit.size() < kFewestWindows || (judged && judge.size() < 2)) return std::nullopt;
  Remainder out;
  out.unit = dynamics::info(fitted.kind).rotary ? "N m" : "N";
  std::tie(out.typical_force, out.typical_is) = typical_force(fitted, fit);
  const bool driven = std::any_of(training.begin(), training.end(), [](const Recording& r) {
    return std::any_of(r.input.begin(), r.input.end(), [](double u) { return u != 0; });
  });
  const Disturbance disturbance = likeliest_disturbance(fit, out.typical_force);
  out.random_force = disturbance.force;
  out.correlation_s = disturbance.correlation_s;
  out.impact_scatter = disturbance.impact;
  if (judged) out.random_force_held_out = likeliest_disturbance(judge, out.typical_force).force;
  const PredictedByLaw predicted =
      predict_by_flexible_law(fit, judge, disturbance, driven,
                              dynamics::has(fitted.kind, dynamics::LocationType::leg), out.typical_force);
  out.crossed = predicted.crossed;
  out.predictable = predicted.predictable;
  out.new_finds = predicted.new_finds;
  return out;
}

std::optional<std::vector<identify::Whitening>> whitening_about(const model::Model& likely,
                                                                const std::vector<Recording>& recordings,
                                                                const std::vector<Window>& windows) {
  if (!dynamics::applies(Effect::force_offset, likely.kind)) return std::nullopt;
  std::vector<identify::Whitening> out(windows.size());
  std::vector<std::optional<LinearRun>> of;
  std::vector<LinearRun> all;
  for (const Window& w : windows) {
    of.push_back(linearised(likely, recordings[w.recording], w));
    if (of.back()) all.push_back(*of.back());
  }
  if (all.size() < kFewestWindows) return std::nullopt;
  const Disturbance disturbance = likeliest_disturbance(all, typical_force(likely, all).first);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (!of[k]) continue;
    const LinearRun& w = *of[k];
    DisturbanceFilter f(w, disturbance);
    f.spread.topLeftCorner<2, 2>().setZero();  // the start is sought
    for (std::size_t i = 0; i < w.left.size(); ++i) {
      f.measure(w, disturbance);
      const double scale = w.noise / f.deviation;
      if (i + 1 < w.left.size()) {
        const Eigen::Vector3d gain = f.gain;
        f.predict(w, disturbance, i);
        out[k].rows.push_back({gain, scale, f.step});
      } else
        out[k].rows.push_back({f.gain, scale, Eigen::Matrix3d::Zero()});
    }
  }
  return out;
}

EvidenceFor evidence_under_disturbances(const model::Model& likely, const std::vector<Recording>& recordings,
                                        const std::vector<Window>& windows) {
  if (!dynamics::applies(Effect::force_offset, likely.kind)) return {};
  std::vector<LinearRun> all;
  std::vector<Window> of;
  for (const Window& w : windows)
    if (auto one = linearised(likely, recordings[w.recording], w)) {
      all.push_back(std::move(*one));
      of.push_back(w);
    }
  if (all.size() < kFewestWindows) return {};
  const Disturbance disturbance = likeliest_disturbance(all, typical_force(likely, all).first);
  return [&recordings, all = std::move(all), of = std::move(of),
          disturbance](const model::Model& other) -> std::optional<double> {
    constexpr double kHardly = 0.01;  // of the rows
    double evidence = 0.0, one_alone = 0.0, rows_of_both = 0.0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const std::optional<LinearRun> its = linearised(other, recordings[of[i].recording], of[i]);
      const std::size_t own_rows = all[i].left.size(), its_rows = its ? its->left.size() : 0,
                        rows = std::min(own_rows, its_rows);
      one_alone += static_cast<double>(std::max(own_rows, its_rows) - rows);
      rows_of_both += static_cast<double>(rows);
      if (rows > 0) evidence += deviance(all[i], disturbance, rows) - deviance(*its, disturbance, rows);
    }
    if (one_alone > kHardly * rows_of_both) return std::nullopt;
    return evidence;
  };
}

}  // namespace furcula::diagnose
