#include "host/floating/linearised.hpp"

#include <cmath>

#include "host/core/parallel.hpp"

namespace furcula::floating {
namespace {

/// Differences are taken over such a part of what an unknown may be, so that no foot leaves the ground in between.
constexpr double kPart = 1e-3;

double step_of(std::size_t local) { return kPart * kLocalSd[group_of(local)]; }

}  // namespace

LocalGroup group_of(std::size_t i) {
  if (i < 1) return kHeight;
  if (i < 3) return kTilt;
  if (i < 6) return kAngularVelocity;
  if (i < 9) return kVelocity;
  if (i < 21) return kAngle;
  if (i < 33) return kRate;
  if (i < kStart) return (i - 33) % 3 == 2 ? kAnchorYaw : kAnchor;
  if (i >= kFilterAt) return static_cast<LocalGroup>(kFilter + (i - kFilterAt) / 3);
  const std::size_t channel = (i - kStart) / kKnots;
  if (channel < kJoints) return kTorque;
  const std::size_t part = (channel - kJoints) % 6;
  return part == 2 ? kForceUp : part < 2 ? kForceAcross : part == 5 ? kMomentUp : kMomentAcross;
}

Eigen::MatrixXd residuals(const Recording& recording, const Window& window, const Local& local,
                          std::span<const Variant> variants, double step_s) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>((window.count - 1) * kRowSize),
                      static_cast<Eigen::Index>(variants.size()));
  residuals(recording, window, std::span<const double, kLocals>(local.data(), kLocals), variants, step_s,
            std::span(out.data(), static_cast<std::size_t>(out.size())));
  return out;
}

Point at(const Machine& model, const std::vector<Unknown>& unknowns, const Eigen::VectorXd& theta,
         const std::vector<Local>& locals) {
  Point p{model, theta, locals};
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    unknowns[i].add(p.machine, theta[static_cast<Eigen::Index>(i)] * unknowns[i].prior_sd);
  if (biped::make_possible(model, p.machine))
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      p.theta[static_cast<Eigen::Index>(i)] =
          (unknowns[i].value(p.machine) - unknowns[i].value(model)) / unknowns[i].prior_sd;
  return p;
}

std::vector<LinearWindow> linearised(const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows, const std::vector<Unknown>& unknowns,
                                     const Point& point, bool with_globals, const Settings& settings) {
  const std::size_t globals = with_globals ? unknowns.size() : 0;
  std::vector<Machine> machines(globals, point.machine);
  std::vector<Plant> plants(globals);
  for (std::size_t i = 0; i < globals; ++i) {
    unknowns[i].add(machines[i], kPart * unknowns[i].prior_sd);
    plants[i] = plant_of(machines[i]);
  }
  const Plant here = plant_of(point.machine);
  std::vector<LinearWindow> out(windows.size());
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    const Window& window = windows[w];
    const Recording& recording = recordings[window.recording];
    LinearWindow& l = out[w];
    std::vector<Variant> variants{{&point.machine, &here}};
    for (std::size_t i = 0; i < kFilterAt; ++i) {
      const std::size_t channel = i < kStart ? 0 : (i - kStart) / kKnots;
      if (i >= kStart && channel >= kJoints && !window.stance[(channel - kJoints) / 6]) continue;
      l.locals.push_back(i);
      variants.push_back({&point.machine, &here, static_cast<int>(i), step_of(i)});
    }
    const auto simulated = static_cast<Eigen::Index>(l.locals.size());
    for (std::size_t i = 0; i < globals; ++i) variants.push_back({&machines[i], &plants[i]});
    const Eigen::MatrixXd r = residuals(recording, window, point.locals[w], variants, settings.step_s);
    const auto rows = r.rows();
    l.y = r.col(0);
    constexpr std::size_t kFilters = 3 * kFilterShapes;
    l.c = Eigen::MatrixXd::Zero(rows, simulated + static_cast<Eigen::Index>(kFilters));
    for (Eigen::Index k = 0; k < simulated; ++k)
      l.c.col(k) = (r.col(0) - r.col(k + 1)) / step_of(l.locals[static_cast<std::size_t>(k)]);
    for (std::size_t n = 1; n < window.count; ++n) {
      const double t = recording.rows[window.first + n].time_s - recording.rows[window.first].time_s;
      for (std::size_t k = 0; k < kFilters; ++k) {
        const std::size_t axis = k % 3, power = k / 3;
        l.c(static_cast<Eigen::Index>((n - 1) * kRowSize + kJoints + axis),
            simulated + static_cast<Eigen::Index>(k)) = std::pow(t, static_cast<double>(power));
      }
    }
    for (std::size_t k = 0; k < kFilters; ++k) l.locals.push_back(kFilterAt + k);
    for (Eigen::Index k = 0; k < l.c.cols(); ++k)
      l.y += l.c.col(k) * point.locals[w][static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])];
    l.a.resize(rows, static_cast<Eigen::Index>(globals));
    for (std::size_t i = 0; i < globals; ++i)
      l.a.col(static_cast<Eigen::Index>(i)) =
          (r.col(0) - r.col(simulated + 1 + static_cast<Eigen::Index>(i))) / kPart;
    if (with_globals) l.y += l.a * point.theta;
  });
  return out;
}

}  // namespace furcula::floating
