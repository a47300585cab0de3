#include "host/floating/linearised.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// A stand that holds the pelvis parts the legs: what differs in one moves no joint of the other.
bool on_the_stand(const Window& window) { return !window.stance[0] && !window.stance[1]; }

/// Of an angle, a rate or a torque at the left leg, that of the right one.
std::optional<std::size_t> right_of(std::size_t local) {
  const auto after = [&](std::size_t first, std::size_t of_a_joint) -> std::optional<std::size_t> {
    if (local < first || local >= first + kLegJoints * of_a_joint) return std::nullopt;
    return local + kLegJoints * of_a_joint;
  };
  for (const auto& right : {after(9, 1), after(9 + kJoints, 1), after(kStart, kKnots)})
    if (right) return right;
  return std::nullopt;
}

/// A run by which one column is differenced, or one of each leg.
struct Difference {
  std::size_t column;
  std::optional<std::size_t> right;
};

/// Rows of each leg's joints in its column; without the right one all rows in the column.
void put(const Difference& d, const Eigen::VectorXd& difference, Eigen::MatrixXd& out) {
  const auto column = static_cast<Eigen::Index>(d.column);
  if (!d.right) {
    out.col(column) = difference;
    return;
  }
  const auto right = static_cast<Eigen::Index>(*d.right);
  out.col(column).setZero(), out.col(right).setZero();
  constexpr Eigen::Index kLeg = kLegJoints;
  for (Eigen::Index row = 0; row < difference.size(); row += static_cast<Eigen::Index>(kRowSize)) {
    out.col(column).segment(row, kLeg) = difference.segment(row, kLeg);
    out.col(right).segment(row + kLeg, kLeg) = difference.segment(row + kLeg, kLeg);
  }
}

/// Runs of the unknowns; where the legs are parted, one of the left leg with one of the right.
std::vector<Difference> differences(const std::vector<Unknown>& unknowns, bool parted) {
  std::vector<Difference> out;
  std::vector<std::size_t> right;
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (parted && unknowns[i].location.starts_with("right_"))
      right.push_back(i);
    else
      out.push_back({i, std::nullopt});
  auto next = right.begin();
  for (Difference& d : out)
    if (next != right.end() && unknowns[d.column].location.starts_with("left_")) d.right = *next++;
  for (; next != right.end(); ++next) out.push_back({*next, std::nullopt});
  return out;
}

/// Those of a window that are simulated, disturbances knot by knot. A stand that holds the pelvis leaves its tilt open alone.
std::vector<std::size_t> simulated_locals(const Window& window, const Variances& variances) {
  std::vector<std::size_t> out;
  const auto put = [&](std::size_t i) {
    if (variances.local[group_of(i)] > 0.0) out.push_back(i);
  };
  const bool held = on_the_stand(window);
  for (std::size_t i = 0; i < kStart; ++i)
    if (const LocalGroup g = group_of(i); !held || g == kTilt || g == kAngle || g == kRate) put(i);
  for (std::size_t knot = 0; knot < kKnots; ++knot)
    for (std::size_t c = 0; c < kChannels; ++c)
      if (c < kJoints || window.stance[(c - kJoints) / 6]) put(kStart + c * kKnots + knot);
  return out;
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
  LinearWindow l;
  l.locals = simulated_locals(window, variances);
  const std::size_t simulated = l.locals.size();
  std::vector<Variant> variants{{&machine, &plant, local.data()}};
  std::vector<Difference> runs;
  std::vector<bool> done(simulated, false);
  for (std::size_t k = 0; k < simulated; ++k) {
    if (done[k]) continue;
    const std::size_t i = l.locals[k];
    variants.push_back({&machine, &plant, local.data(), static_cast<int>(i), step_of(i)});
    runs.push_back({k, std::nullopt});
    const auto right = on_the_stand(window) ? right_of(i) : std::nullopt;
    if (!right) continue;
    const auto at =
        static_cast<std::size_t>(std::find(l.locals.begin(), l.locals.end(), *right) - l.locals.begin());
    variants.back().other_leg = static_cast<int>(*right);
    runs.back().right = at, done[at] = true;
  }
  const Eigen::MatrixXd r = residuals(recording, window, variants, step_s);
  l.y = r.col(0);
  constexpr std::size_t kFilters = 3 * kFilterShapes;
  l.c = Eigen::MatrixXd::Zero(r.rows(), static_cast<Eigen::Index>(simulated + kFilters));
  for (std::size_t k = 0; k < runs.size(); ++k)
    put(runs[k], (r.col(0) - r.col(static_cast<Eigen::Index>(1 + k))) / step_of(l.locals[runs[k].column]),
        l.c);
  for (std::size_t n = 1; n < window.count; ++n) {
    const double t = recording.rows[window.first + n].time_s - recording.rows[window.first].time_s;
    for (std::size_t k = 0; k < kFilters; ++k) {
      const std::size_t axis = k % 3, power = k / 3;
      l.c(static_cast<Eigen::Index>((n - 1) * kRowSize + kJoints + axis),
          static_cast<Eigen::Index>(simulated + k)) = std::pow(t, static_cast<double>(power));
    }
  }
  for (std::size_t k = 0; k < kFilters; ++k) l.locals.push_back(kFilterAt + k);
  for (Eigen::Index k = 0; k < l.c.cols(); ++k)
    l.y += l.c.col(k) * local[static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])];
  return l;
}

void linearise_machine(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                       const std::vector<Unknown>& unknowns, const Point& point, const Settings& settings,
                       std::vector<LinearWindow>& linear) {
  struct Deviating {
    std::vector<Difference> runs;
    std::vector<Machine> machines;
    std::vector<Plant> plants;
  };
  std::array<Deviating, 2> of;  // on the ground, on the stand
  for (const bool parted : {false, true}) {
    if (std::none_of(windows.begin(), windows.end(),
                     [&](const Window& w) { return on_the_stand(w) == parted; }))
      continue;
    Deviating& d = of[parted];
    d.runs = differences(unknowns, parted);
    for (const Difference& run : d.runs) {
      Machine& m = d.machines.emplace_back(point.machine);
      unknowns[run.column].add(m, kPart * unknowns[run.column].prior_sd);
      if (run.right) unknowns[*run.right].add(m, kPart * unknowns[*run.right].prior_sd);
      d.plants.push_back(plant_of(m));
    }
  }
  const Plant here = plant_of(point.machine);
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    const Deviating& d = of[on_the_stand(windows[w])];
    const double* locals = point.locals[w].data();
    std::vector<Variant> variants{{&point.machine, &here, locals}};
    for (std::size_t k = 0; k < d.runs.size(); ++k)
      variants.push_back({&d.machines[k], &d.plants[k], locals});
    const Eigen::MatrixXd r =
        residuals(recordings[windows[w].recording], windows[w], variants, settings.step_s);
    LinearWindow& l = linear[w];
    l.a.resize(r.rows(), static_cast<Eigen::Index>(unknowns.size()));
    for (std::size_t k = 0; k < d.runs.size(); ++k)
      put(d.runs[k], (r.col(0) - r.col(static_cast<Eigen::Index>(1 + k))) / kPart, l.a);
    l.y += l.a * point.theta;
  });
}

std::vector<LinearWindow> linearised(const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows, const Variances& variances,
                                     const std::vector<Unknown>& unknowns, const Point& point,
                                     const Settings& settings) {
  const Plant here = plant_of(point.machine);
  std::vector<LinearWindow> out(windows.size());
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    out[w] = linearised(recordings[windows[w].recording], windows[w], variances, point.machine, here,
                        point.locals[w], settings.step_s);
  });
  linearise_machine(recordings, windows, unknowns, point, settings, out);
  return out;
}

}  // namespace furcula::floating
