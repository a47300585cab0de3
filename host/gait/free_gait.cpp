#include "host/gait/free_gait.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "host/gait/gait_nlp.hpp"

namespace furcula::gait {
namespace {

JointPath path_through(double duration_s, std::size_t intervals, const std::vector<double>& hip,
                       const std::vector<double>& knee) {
  const Spline s(intervals);
  return {duration_s, s.fitted(hip), s.fitted(knee)};
}

/// The same path over another number of intervals.
JointPath resampled(const JointPath& path, std::size_t intervals) {
  if (path.spline().intervals() == intervals) return path;
  std::vector<double> hip, knee;
  const std::size_t values = 6 * intervals + 1;
  for (std::size_t i = 0; i < values; ++i) {
    const JointPath::At at =
        path.at(path.duration_s * static_cast<double>(i) / static_cast<double>(values - 1));
    hip.push_back(at.angle.hip);
    knee.push_back(at.angle.knee);
  }
  return path_through(path.duration_s, intervals, hip, knee);
}

}  // namespace

JointPath::At JointPath::at(double time_s) const {
  const std::size_t interval = spline().interval_at(time_s / duration_s);
  return {derivative(time_s, 0, interval), derivative(time_s, 1, interval), derivative(time_s, 2, interval)};
}

Joints2<double> JointPath::derivative(double time_s, std::size_t n, std::size_t interval) const {
  const Spline::Basis b = spline().basis(time_s / duration_s, interval);
  const double scale = std::pow(duration_s, -static_cast<double>(n));
  Joints2<double> out;
  for (std::size_t i = 0; i < Spline::kOrder; ++i) {
    out.hip += scale * b.share[n][i] * hip[b.first + i];
    out.knee += scale * b.share[n][i] * knee[b.first + i];
  }
  return out;
}

FreeGait rough_gait(const Machine& machine, const Task& task, std::uint64_t variety) {
  std::mt19937_64 random(variety);
  const auto vary = [&](double middle, double by) {
    if (variety == 0) return middle;
    return middle + by * (2.0 * static_cast<double>(random() >> 11) / 9007199254740992.0 - 1.0);
  };
  const bool rigid = machine.spring == LegSpring::none;
  const double speed = task.speed_mps.value_or(0.0);
  const double stance = vary(rigid ? 0.2 : 0.35 / (1.0 + 0.25 * std::abs(speed)), rigid ? 0.08 : 0.1);
  const double flight = vary(0.1, 0.04);
  double landed = task.touchdown_knee_rad.value_or(rigid                                   ? 0.8
                                                   : machine.spring == LegSpring::parallel ? 1.1
                                                                                           : 1.4);
  if (!task.touchdown_knee_rad) landed = vary(landed, 0.3);
  const double fold = vary(0.5, 0.2), tuck = landed + vary(0.35, 0.3);
  const double sweep = std::clamp(speed * stance / 0.9, -1.2, 1.2);
  // The hip stands over the toe where the thigh leans back by half of the knee's angle, the links being alike.
  constexpr std::size_t kValues = 60;
  std::array<std::vector<double>, 3> hip, knee;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < kValues; ++i) {
      const double s = static_cast<double>(i) / (kValues - 1);
      double flexed = landed, lean = 0.0;
      if (k == 0) {
        flexed = landed + fold * std::sin(std::numbers::pi * s);
        lean = sweep * (0.5 - s);
      } else {
        const double whole = k == 1 ? 0.5 * s : 0.5 + 0.5 * s;
        flexed = landed + (tuck - landed) * std::sin(std::numbers::pi * whole);
        lean = sweep * (whole - 0.5);
      }
      knee[k].push_back(flexed);
      hip[k].push_back(-0.5 * flexed + lean);
    }
  FreeGait out;
  const FreeOptions usual;
  out.phases[0] = path_through(stance, usual.stance_intervals, hip[0], knee[0]);
  for (std::size_t k = 1; k < 3; ++k)
    out.phases[k] = path_through(flight, usual.flight_intervals, hip[k], knee[k]);
  return out;
}

FreeResult find_free_gait(const Machine& machine, const Task& task, const FreeGait& start,
                          const FreeOptions& options) {
  const bool kinks = has_kinks(machine, task);
  FreeResult out;
  for (std::size_t k = 0; k < 3; ++k)
    out.gait.phases[k] =
        resampled(start.phases[k], k == 0 ? options.stance_intervals : options.flight_intervals);
  // A kink is rounded over less and less.
  bool near = options.near;
  std::vector<double> roundings = kinks ? std::vector<double>{2e-2, 2e-3, 3e-4} : std::vector<double>{1e-5};
  // Until the share of the stance at which a spring catches stays.
  if (machine.catching.delay_s > 0.0) roundings.insert(roundings.end(), {3e-4, 3e-4});
  for (const double rounding : roundings) {
    GaitNlp builder(machine, task, {out.gait.phases.begin(), out.gait.phases.end()},
                    {task.clearance_m ? Turn::top : Turn::apex}, rounding, options.margin);
    SolveOptions s;
    s.iterations = options.iterations;
    s.progress = options.progress;
    if (near) s.barrier = 1e-4;
    Solution solution = solve(builder.nlp(), s);
    out.iterations += solution.iterations;
    out.found = solution.found;
    out.status = solution.status;
    out.violation = solution.violation;
    out.worst = solution.worst;
    if (!solution.x.empty()) {
      const std::vector<JointPath> paths = builder.paths(solution.x);
      std::copy(paths.begin(), paths.end(), out.gait.phases.begin());
      out.gait.cost = solution.cost;
    }
    if (!out.found) break;
    near = true;
  }
  return out;
}

}  // namespace furcula::gait
