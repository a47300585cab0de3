#include "host/floating/linearised.hpp"

#include <cmath>

#include "host/core/parallel.hpp"

namespace furcula::floating {
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

Eigen::MatrixXd residuals(const Recording& recording, const Window& window, std::span<const Variant> variants,
                          double step_s) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>((window.count - 1) * kRowSize),
                      static_cast<Eigen::Index>(variants.size()));
  residuals(recording, window, variants, step_s, std::span(out.data(), static_cast<std::size_t>(out.size())));
  return out;
}

Variances first_variances() {
  Variances v;
  v.noise = {1e-3 * 1e-3, 2e-3 * 2e-3, 4e-2 * 4e-2};
  for (std::size_t g = 0; g < kLocalGroups; ++g) v.local[g] = kLocalSd[g] * kLocalSd[g];
  return v;
}

namespace {

/// Differences are taken over such a part of what an unknown may be, so that no foot leaves the ground in between.
constexpr double kPart = 1e-3;

double step_of(std::size_t local) { return kPart * kLocalSd[group_of(local)]; }

/// Those of a window that are simulated, disturbances knot by knot. A stand that holds the pelvis leaves its tilt open alone.
std::vector<std::size_t> simulated_locals(const Window& window, const Variances& variances) {
  std::vector<std::size_t> out;
  const auto put = [&](std::size_t i) {
    if (variances.local[group_of(i)] > 0.0) out.push_back(i);
  };
  const bool held = !window.stance[0] && !window.stance[1];
  for (std::size_t i = 0; i < kStart; ++i)
    if (const LocalGroup g = group_of(i); !held || g == kTilt || g == kAngle || g == kRate) put(i);
  for (std::size_t knot = 0; knot < kKnots; ++knot)
    for (std::size_t c = 0; c < kChannels; ++c)
      if (c < kJoints || window.stance[(c - kJoints) / 6]) put(kStart + c * kKnots + knot);
  return out;
}

/// `deviating`: machines that differ from `here` by kPart of an unknown's prior deviation.
LinearWindow one_linearised(const Recording& recording, const Window& window, const Variances& variances,
                            const Variant& here, std::span<const Variant> deviating, double step_s) {
  LinearWindow l;
  l.locals = simulated_locals(window, variances);
  std::vector<Variant> variants{here};
  for (const std::size_t i : l.locals)
    variants.push_back({here.machine, here.plant, here.locals, static_cast<int>(i), step_of(i)});
  variants.insert(variants.end(), deviating.begin(), deviating.end());
  const Eigen::MatrixXd r = residuals(recording, window, variants, step_s);
  const auto simulated = static_cast<Eigen::Index>(l.locals.size()),
             globals = static_cast<Eigen::Index>(deviating.size());
  l.y = r.col(0);
  constexpr std::size_t kFilters = 3 * kFilterShapes;
  l.c = Eigen::MatrixXd::Zero(r.rows(), simulated + static_cast<Eigen::Index>(kFilters));
  for (Eigen::Index k = 0; k < simulated; ++k)
    l.c.col(k) = (r.col(0) - r.col(1 + k)) / step_of(l.locals[static_cast<std::size_t>(k)]);
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
    l.y += l.c.col(k) * here.locals[l.locals[static_cast<std::size_t>(k)]];
  l.a.resize(r.rows(), globals);
  for (Eigen::Index i = 0; i < globals; ++i) l.a.col(i) = (r.col(0) - r.col(1 + simulated + i)) / kPart;
  return l;
}

}  // namespace

Point at(const Machine& model, const std::vector<Unknown>& unknowns, const Eigen::VectorXd& theta,
         const std::vector<Local>& locals) {
  Point p{model, theta, locals};
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    unknowns[i].add(p.machine, theta[static_cast<Eigen::Index>(i)] * unknowns[i].prior_sd);
  const double creep_radps = p.machine.robot.creep_radps;
  const bool changed = biped::make_possible(model, p.machine);
  p.machine.robot.creep_radps = creep_radps;  // windows keep a joint's ramp as wide as it must be
  if (changed)
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      p.theta[static_cast<Eigen::Index>(i)] =
          (unknowns[i].value(p.machine) - unknowns[i].value(model)) / unknowns[i].prior_sd;
  return p;
}

LinearWindow linearised(const Recording& recording, const Window& window, const Variances& variances,
                        const Machine& machine, const Plant& plant, const Local& local, double step_s) {
  return one_linearised(recording, window, variances, {&machine, &plant, local.data()}, {}, step_s);
}

std::vector<LinearWindow> linearised(const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows, const Variances& variances,
                                     const std::vector<Unknown>& unknowns, const Point& point,
                                     const Settings& settings) {
  std::vector<Machine> machines(unknowns.size(), point.machine);
  std::vector<Plant> plants(unknowns.size());
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    unknowns[i].add(machines[i], kPart * unknowns[i].prior_sd);
    plants[i] = plant_of(machines[i]);
  }
  const Plant here = plant_of(point.machine);
  std::vector<LinearWindow> out(windows.size());
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    const double* locals = point.locals[w].data();
    std::vector<Variant> deviating;
    for (std::size_t i = 0; i < unknowns.size(); ++i) deviating.push_back({&machines[i], &plants[i], locals});
    out[w] = one_linearised(recordings[windows[w].recording], windows[w], variances,
                            {&point.machine, &here, locals}, deviating, settings.step_s);
    out[w].y += out[w].a * point.theta;
  });
  return out;
}

}  // namespace furcula::floating
