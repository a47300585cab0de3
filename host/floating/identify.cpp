#include "host/floating/identify.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"

namespace furcula::floating {
namespace {

std::vector<Window> all_windows(const std::vector<Recording>& recordings, double length_s) {
  std::vector<Window> out;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const std::vector<Window> of = windows_of(recordings[i], i, length_s);
    out.insert(out.end(), of.begin(), of.end());
  }
  if (out.empty())
    throw core::DataError(recordings.empty()
                              ? "no recordings"
                              : recordings.front().file +
                                    ": no window of 0.15 s without a landing in which a foot carries; "
                                    "expected a robot that stands or walks");
  return out;
}

/// Student's t over windows: a window that no parameter explains counts less.
constexpr double kFreedom = 4.0;

double rows_of(const Window& w) { return static_cast<double>((w.count - 1) * kRowSize); }

double robust(const std::vector<Window>& windows, const std::vector<double>& costs) {
  double sum = 0.0;
  for (std::size_t w = 0; w < windows.size(); ++w)
    sum += (kFreedom + rows_of(windows[w])) * std::log1p(costs[w] / kFreedom);
  return sum;
}

/// Up to `most`, evenly over all.
std::vector<Window> some_of(const std::vector<Window>& windows, std::size_t most) {
  const std::size_t n = std::min(most, windows.size());
  std::vector<Window> out;
  for (std::size_t k = 0; k < n; ++k) out.push_back(windows[(2 * k + 1) * windows.size() / (2 * n)]);
  return out;
}

/// The ground and the ramp of dry friction, of which a simulation has its own: those of a few with which some windows fit best. A fit from
/// a ground that is too soft ends in weak gains and slack joints.
Machine with_best_simulator(const Machine& model, const std::vector<Recording>& recordings,
                            const std::vector<Window>& windows, const IdentifyOptions& options) {
  constexpr std::size_t kLooked = 12;
  const std::vector<Window> some = some_of(windows, kLooked);
  const auto cost = [&](const Machine& m) {
    Point p{m, {}, std::vector<Local>(some.size(), Local::Zero())};
    return robust(some, fit_locals(recordings, some, first_variances(), true, p, options.settings));
  };
  Machine best = model;
  double least = cost(model);
  const auto attempt = [&](const Machine& m) {
    const double now = cost(m);
    if (!(now < least)) return false;
    best = m, least = now;
    return true;
  };
  for (const double stiffer : {3.0, 10.0}) {
    Machine m = model;
    auto& g = m.robot.ground;
    for (double* x : {&g.stiffness_npm, &g.shear_stiffness_npm, &g.damping_nspm, &g.shear_damping_nspm})
      *x *= stiffer;
    if (!attempt(m)) break;
  }
  for (const double ramp_radps : {0.01, 0.003}) {
    Machine m = best;
    m.robot.creep_radps = ramp_radps;
    biped::make_possible(model, m);
    if (!attempt(m)) break;
  }
  return best;
}

}  // namespace

WindowErrors window_errors(const Machine& machine, const std::vector<Recording>& recordings,
                           const IdentifyOptions& options) {
  const std::vector<Window> windows = all_windows(recordings, options.window_s);
  Variances v = first_variances();
  for (const int g : {kTorque, kForceAcross, kForceUp, kMomentAcross, kMomentUp})
    v.local[static_cast<std::size_t>(g)] *= 1e-8;
  Point p{machine, {}, std::vector<Local>(windows.size(), Local::Zero())};
  fit_locals(recordings, windows, v, true, p, options.settings);
  const Plant plant = plant_of(machine);
  WindowErrors out;
  out.windows = windows.size();
  out.predicted.resize(windows.size());
  core::parallel_for(windows.size(), options.settings.threads, [&](std::size_t w) {
    const Variant here{&machine, &plant};
    out.predicted[w] = {windows[w], residuals(recordings[windows[w].recording], windows[w], p.locals[w],
                                              std::span(&here, 1), options.settings.step_s)};
  });
  std::array<double, kNoiseGroups> sum{};
  double rows = 0.0;
  for (const Predicted& of : out.predicted) {
    for (Eigen::Index k = 0; k < of.residual.size(); ++k) {
      const std::size_t channel = static_cast<std::size_t>(k) % kRowSize;
      const double square = of.residual[k] * of.residual[k];
      sum[noise_of(channel)] += square;
      out.channels[channel] += square;
    }
    rows += static_cast<double>(of.window.count - 1);
  }
  for (double& channel : out.channels) channel = std::sqrt(channel / rows);
  out.angle_rad = std::sqrt(sum[kAngleNoise] / (rows * kJoints));
  out.attitude_rad = std::sqrt(sum[kAttitudeNoise] / (3.0 * rows));
  out.gyro_radps = std::sqrt(sum[kGyroNoise] / (3.0 * rows));
  return out;
}

bool passive_hips(const Machine& model, const Recording& recording, const IdentifyOptions& options) {
  constexpr std::size_t kLooked = 8;
  std::array<double, 2> cost{};
  for (const bool passive : {false, true}) {
    std::vector<Recording> one{recording};
    one[0].passive_hips = passive;
    const std::vector<Window> windows = all_windows(one, options.window_s);
    const std::vector<Window> some = some_of(windows, kLooked);
    Point p{model, {}, std::vector<Local>(some.size(), Local::Zero())};
    cost[passive] = robust(some, fit_locals(one, some, first_variances(), true, p, options.settings, 0));
  }
  return cost[1] < cost[0];
}

Identified identify(const Machine& given, const std::vector<Recording>& recordings,
                    const IdentifyOptions& options) {
  const std::vector<Window> windows = all_windows(recordings, options.window_s);
  const auto sprung = [](const Recording& r) { return r.passive_hips; };
  Identified out;
  out.unknowns = biped::unknowns(given.robot, !std::all_of(recordings.begin(), recordings.end(), sprung),
                                 std::any_of(recordings.begin(), recordings.end(), sprung));
  const auto n = static_cast<Eigen::Index>(out.unknowns.size());
  out.theta = Eigen::VectorXd::Zero(n);
  out.given = given;
  const auto say = [&](double fraction, const std::string& doing) {
    if (options.progress) options.progress(fraction, doing);
  };
  say(0.0, "windows of the model as given");
  out.before = window_errors(given, recordings, options);
  say(0.1, "the ground");
  const Machine model = with_best_simulator(given, recordings, windows, options);
  Variances v = first_variances();
  say(0.2, "starts of the windows");
  Point p = at(model, out.unknowns, out.theta, std::vector<Local>(windows.size(), Local::Zero()));
  std::vector<double> costs = fit_locals(recordings, windows, v, true, p, options.settings);
  std::vector<LinearWindow> linear = linearised(recordings, windows, out.unknowns, p, true, options.settings);
  say(0.3, "disturbances of the windows");
  v = estimated(linear, v, options.settings.threads);
  out.causes = causes(model, out.unknowns, windows, linear, v, options.settings.threads);
  costs = fit_locals(recordings, windows, v, false, p, options.settings, 0);
  double cost = robust(windows, costs);
  Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(n, n);
  double damping = 1e-2;
  for (int k = 0; k < options.iterations; ++k) {
    if (k > 0) linear = linearised(recordings, windows, out.unknowns, p, true, options.settings);
    std::vector<double> weights(windows.size());
    for (std::size_t w = 0; w < windows.size(); ++w)
      weights[w] = (kFreedom + rows_of(windows[w])) / (kFreedom + costs[w]);
    const Evidence e = evidence(linear, v, weights, options.settings.threads);
    precision = e.information;
    precision.diagonal().array() += 1.0;
    bool better = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < 4 && !better; ++attempt, damping *= 10.0) {
      Eigen::MatrixXd damped = precision;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd theta = p.theta + damped.llt().solve(e.score - precision * p.theta);
      Point there = at(model, out.unknowns, theta, p.locals);
      there.locals = locals_at(linear, v, there.theta, p.locals);
      const std::vector<double> then = fit_locals(recordings, windows, v, false, there, options.settings, 3);
      const double now = robust(windows, then) + there.theta.squaredNorm();
      if (now < cost)
        gain = cost - now, cost = now, costs = then, p = std::move(there), better = true, damping *= 0.01;
    }
    out.iterations = k + 1;
    say(0.3 + 0.6 * (k + 1) / options.iterations, "fitting all numbers");
    if (!better || gain < 1e-3 * std::abs(cost)) break;
  }
  out.theta = p.theta;
  out.machine = p.machine;
  out.sd = precision.llt().solve(Eigen::MatrixXd::Identity(n, n)).diagonal().cwiseSqrt();
  say(0.9, "windows of the identified robot");
  out.after = window_errors(out.machine, recordings, options);
  return out;
}

}  // namespace furcula::floating
