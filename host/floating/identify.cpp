#include "host/floating/identify.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
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
    throw core::DataError(
        recordings.empty() ? "no recordings"
                           : recordings.front().file + ": no window of " + core::rounded(0.5 * length_s, 3) +
                                 " s without a landing in which a foot is loaded; expected a robot that "
                                 "stands or walks, or one on its stand");
  return out;
}

double rows_of(const Window& w) { return static_cast<double>((w.count - 1) * kRowSize); }

/// Student's t over windows: a window that no parameter explains counts less.
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
  // On the stand no ground acts.
  std::vector<Window> standing;
  std::copy_if(windows.begin(), windows.end(), std::back_inserter(standing),
               [](const Window& w) { return w.stance[0] || w.stance[1]; });
  const std::vector<Window> some = some_of(standing.empty() ? windows : standing, kLooked);
  Point best{model, {}, std::vector<Local>(some.size(), Local::Zero())};
  double least = robust(some, fit_locals(recordings, some, first_variances(), best, options.settings));
  // Both begin where the windows of the best so far ended, so that costs differ by the machine and not by where a fit comes to rest.
  const auto attempt = [&](const Machine& m) {
    Point p{m, {}, best.locals};
    least = robust(some, refit_locals(recordings, some, first_variances(), best, options.settings));
    const double now = robust(some, refit_locals(recordings, some, first_variances(), p, options.settings));
    if (!(now < least)) return false;
    best = std::move(p), least = now;
    return true;
  };
  for (const double stiffer : {3.0, 10.0}) {
    if (standing.empty()) break;
    Machine m = model;
    auto& g = m.robot.ground;
    for (double* x : {&g.stiffness_npm, &g.shear_stiffness_npm, &g.damping_nspm, &g.shear_damping_nspm})
      *x *= stiffer;
    if (!attempt(m)) break;
  }
  for (const double ramp_radps : {0.01, 0.003}) {
    Machine m = best.machine;
    m.robot.creep_radps = ramp_radps;
    if (!attempt(m)) break;
  }
  return best.machine;
}

/// Gauss and Newton's method, damped, from a model on. Derivatives by all unknowns are most of its time, so they are kept as long as steps gain.
class Fit {
 public:
  Fit(const Machine& model, std::vector<Unknown> unknowns, const std::vector<Recording>& recordings,
      const std::vector<Window>& windows, const Settings& settings)
      : model_(model),
        unknowns_(std::move(unknowns)),
        recordings_(recordings),
        windows_(windows),
        settings_(settings),
        point_(at(model_, unknowns_, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns_.size())),
                  std::vector<Local>(windows.size(), Local::Zero()))) {
    costs_ = fit_locals(recordings_, windows_, variances_, point_, settings_);
    cost_ = robust(windows_, costs_);
    linearise();
    precision_ = Eigen::MatrixXd::Identity(point_.theta.size(), point_.theta.size());
  }

  const Point& point() const { return point_; }
  /// Derivatives of the last linearisation, shifted to the present point.
  const std::vector<LinearWindow>& linear() const { return linear_; }
  Eigen::VectorXd sd() const {
    return precision_.llt()
        .solve(Eigen::MatrixXd::Identity(precision_.rows(), precision_.cols()))
        .diagonal()
        .cwiseSqrt();
  }

  /// Goes on from that machine, if it is likelier.
  void begin_at(const Machine& machine) {
    Eigen::VectorXd theta(point_.theta.size());
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
      theta[static_cast<Eigen::Index>(i)] =
          (unknowns_[i].value(machine) - unknowns_[i].value(model_)) / unknowns_[i].prior_sd;
    Point there = at(model_, unknowns_, theta, std::vector<Local>(windows_.size(), Local::Zero()));
    const std::vector<double> then = fit_locals(recordings_, windows_, variances_, there, settings_);
    const double now = robust(windows_, then) + there.theta.squaredNorm();
    if (!(now < cost_)) return;
    cost_ = now, costs_ = then, point_ = std::move(there), moved_ = true;
  }

  /// Steps along the same derivatives, as long as they gain. @returns whether new ones may gain.
  bool improve() {
    constexpr int kMost = 4;
    if (moved_) linearise();
    for (int k = 0; k < kMost; ++k) {
      const double damping = damping_;
      if (step()) continue;
      if (k > 0) damping_ = damping;  // it is the derivatives that are old
      return k > 0;
    }
    return true;
  }

 private:
  /// Whether it gained much.
  bool step() {
    std::vector<double> weights(windows_.size());
    for (std::size_t w = 0; w < windows_.size(); ++w)
      weights[w] = (kFreedom + rows_of(windows_[w])) / (kFreedom + costs_[w]);
    const Evidence e = evidence(linear_, marginals_, weights);
    precision_ = e.information;
    precision_.diagonal().array() += 1.0;
    for (int attempt = 0; attempt < 4; ++attempt, damping_ *= 10.0) {
      Eigen::MatrixXd damped = precision_;
      damped.diagonal() *= 1.0 + damping_;
      const Eigen::VectorXd theta = point_.theta + damped.llt().solve(e.score - precision_ * point_.theta);
      Point there = at(model_, unknowns_, theta, point_.locals);
      there.locals = locals_at(linear_, marginals_, there.theta, point_.locals);
      const std::vector<Moved> moved =
          fit_locals_along(recordings_, windows_, linear_, marginals_, costs_, variances_, there, settings_);
      std::vector<double> then;
      for (const Moved& m : moved) then.push_back(m.cost);
      const double now = robust(windows_, then) + there.theta.squaredNorm();
      if (!(now < cost_)) continue;
      const double gain = cost_ - now;
      cost_ = now, costs_ = then, point_ = std::move(there), moved_ = true;
      damping_ *= 0.1;
      for (std::size_t w = 0; w < windows_.size(); ++w) about(linear_[w], moved[w].residual, point_, w);
      return gain >= 1e-3 * std::abs(cost_);
    }
    return false;
  }

  /// The same derivatives about another point.
  static void about(LinearWindow& l, const Eigen::VectorXd& residual, const Point& point, std::size_t w) {
    l.y = residual + l.a * point.theta;
    for (Eigen::Index k = 0; k < l.c.cols(); ++k)
      l.y += l.c.col(k) * point.locals[w][static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])];
  }

  void linearise() {
    linear_ = linearised(recordings_, windows_, variances_, unknowns_, point_, settings_);
    marginals_ = marginals(linear_, variances_, settings_.threads);
    moved_ = false;
  }

  const Machine model_;
  const std::vector<Unknown> unknowns_;
  const std::vector<Recording>& recordings_;
  const std::vector<Window>& windows_;
  const Settings& settings_;
  const Variances variances_ = first_variances();
  Point point_;
  std::vector<double> costs_;
  std::vector<LinearWindow> linear_;
  std::vector<Marginal> marginals_;
  Eigen::MatrixXd precision_;
  double cost_ = 0.0, damping_ = 1e-2;
  bool moved_ = false;
};

}  // namespace

WindowErrors window_errors(const Machine& machine, const std::vector<Recording>& recordings,
                           const IdentifyOptions& options) {
  const std::vector<Window> windows = all_windows(recordings, options.window_s);
  Variances v = first_variances();
  for (const int g : {kTorque, kForceAcross, kForceUp, kMomentAcross, kMomentUp})
    v.local[static_cast<std::size_t>(g)] = 0.0;
  Point p{machine, {}, std::vector<Local>(windows.size(), Local::Zero())};
  fit_locals(recordings, windows, v, p, options.settings);
  const Plant plant = plant_of(machine);
  WindowErrors out;
  out.windows = windows.size();
  out.predicted.resize(windows.size());
  core::parallel_for(windows.size(), options.settings.threads, [&](std::size_t w) {
    const Variant here{&machine, &plant, p.locals[w].data()};
    out.predicted[w] = {windows[w], residuals(recordings[windows[w].recording], windows[w],
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
    cost[passive] = robust(some, fit_locals(one, some, first_variances(), p, options.settings, 1));
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
  out.given = given;
  const auto say = [&](double fraction, const std::string& doing) {
    if (options.progress) options.progress(fraction, doing);
  };
  say(0.0, "windows of the model as given");
  out.before = window_errors(given, recordings, options);
  say(0.1, "the ground");
  const Machine model = with_best_simulator(given, recordings, windows, options);
  say(0.2, "derivatives");
  Fit fit(model, out.unknowns, recordings, windows, options.settings);
  std::vector<LinearWindow> linear = fit.linear();
  const std::vector<Local> locals = fit.point().locals;
  if (options.start) fit.begin_at(*options.start);
  for (bool further = true; further && out.iterations < options.iterations; ++out.iterations) {
    say(0.3 + 0.4 * out.iterations / options.iterations, "fitting all numbers");
    further = fit.improve();
  }
  out.theta = fit.point().theta;
  out.machine = fit.point().machine;
  biped::make_possible(given, out.machine);  // the ramp of dry friction, for walks
  out.sd = fit.sd();
  say(0.7, "causes");
  // The fit keeps the variances of the priors: those with the model as it is hold what the fit shall find.
  Causes named = causes(model, out.unknowns, recordings, windows, std::move(linear), locals, out.theta,
                        options.settings);
  out.causes = std::move(named.causes);
  out.all_numbers_deviate = named.all_numbers_deviate;
  say(0.95, "windows of the identified robot");
  out.after = window_errors(out.machine, recordings, options);
  return out;
}

}  // namespace furcula::floating
