#include "host/reproduce/plain_fit.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "furcula/dynamics/links.hpp"
#include "furcula/dynamics/machines.hpp"

namespace furcula::reproduce {
namespace {

using identify::Recording;
using identify::Window;
using State = std::array<double, 2>;  // height, velocity

/// Height's acceleration in one phase of one of the two models.
class Motion {
 public:
  Motion(const model::Model& m, const Recording& r, const Window& w) : r_(r), w_(w) {
    using Nonlinear = dynamics::HopperNonlinearParameters<double>;
    if (dynamics::has(m.kind, dynamics::LocationType::heavy_links)) {
      p_ = dynamics::from_table<Nonlinear>(std::span<const double>(m.parameters));
    } else {
      static_cast<dynamics::HopperLinearParameters<double>&>(p_) =
          dynamics::from_table<dynamics::HopperLinearParameters<double>>(
              std::span<const double>(m.parameters));
    }
    links_ = {p_.inertia_a_kgm2, p_.inertia_b_kgm, p_.inertia_e_kgm, p_.link_length_m, p_.mass_kg};
  }

  State rates(double time_s, const State& x) const {
    if (w_.kind == identify::WindowKind::flight)
      return {x[1], -p_.gravity_mps2 - p_.damping_flight_nspm / p_.mass_kg * x[1]};
    // In stance along z = 2 L cos theta, z' = -lever theta'.
    const double cosine = std::min(x[0] / (2.0 * p_.link_length_m), 0.999999);
    const auto pose = links_.pose(std::acos(cosine));
    const double rate = -x[1] / pose.lever;
    const double along = p_.stiffness_npm * (p_.rest_height_m - x[0]) - p_.damping_stance_nspm * x[1] -
                         p_.mass_kg * p_.gravity_mps2;
    const double torque = torque_nm(time_s) - links_.turning_torque(pose, rate) -
                          p_.gravity_mps2 * links_.hanging(pose) +
                          pose.lever * (links_.turning_force(pose, rate) - along);
    // theta'' on the ground; the toe does not move: z'' = -lever theta'' - lever' theta'^2.
    const double lever_slope = 2.0 * p_.link_length_m * pose.cosine;
    const double inertia = links_.standing_inertia(pose);
    const double bend = lever_slope * rate * rate;
    const double angle_acceleration =
        (torque + (pose.inertia.coupling - pose.lever * pose.inertia.height) * bend) / inertia;
    return {x[1], -pose.lever * angle_acceleration - bend};
  }

 private:
  double torque_nm(double time_s) const {
    while (row_ > w_.first && r_.time_s[row_] > time_s) --row_;
    while (row_ + 2 <= w_.last && r_.time_s[row_ + 1] <= time_s) ++row_;
    const double share = (time_s - r_.time_s[row_]) / (r_.time_s[row_ + 1] - r_.time_s[row_]);
    return r_.input[row_] + std::clamp(share, 0.0, 1.0) * (r_.input[row_ + 1] - r_.input[row_]);
  }

  dynamics::HopperNonlinearParameters<double> p_;
  dynamics::Links<double> links_{};
  const Recording& r_;
  const Window& w_;
  mutable std::size_t row_ = w_.first;
};

State at(const State& x, double h, std::initializer_list<std::pair<double, const State*>> slopes) {
  State y = x;
  for (const auto& [weight, k] : slopes)
    for (int i = 0; i < 2; ++i) y[i] += h * weight * (*k)[i];
  return y;
}

/// Visits every row's time with the state there (cubic interpolation inside the integrator's steps).
/// ode45's default tolerances: 1e-3 relative, 1e-6 absolute.
template <class Visit>
void integrate(const Motion& f, const Recording& r, const Window& w, State x, const Visit& visit) {
  double t = r.time_s[w.first];
  const double end = r.time_s[w.last];
  double h = 0.01;
  std::size_t row = w.first;
  visit(row++, x);
  State k1 = f.rates(t, x);
  for (int steps = 0; row <= w.last && steps < 10000; ++steps) {
    h = std::min(h, end - t);
    const State k2 = f.rates(t + h / 5, at(x, h, {{1.0 / 5, &k1}}));
    const State k3 = f.rates(t + 3 * h / 10, at(x, h, {{3.0 / 40, &k1}, {9.0 / 40, &k2}}));
    const State k4 = f.rates(t + 4 * h / 5, at(x, h, {{44.0 / 45, &k1}, {-56.0 / 15, &k2}, {32.0 / 9, &k3}}));
    const State k5 = f.rates(
        t + 8 * h / 9,
        at(x, h,
           {{19372.0 / 6561, &k1}, {-25360.0 / 2187, &k2}, {64448.0 / 6561, &k3}, {-212.0 / 729, &k4}}));
    const State k6 = f.rates(t + h, at(x, h,
                                       {{9017.0 / 3168, &k1},
                                        {-355.0 / 33, &k2},
                                        {46732.0 / 5247, &k3},
                                        {49.0 / 176, &k4},
                                        {-5103.0 / 18656, &k5}}));
    const State y = at(x, h,
                       {{35.0 / 384, &k1},
                        {500.0 / 1113, &k3},
                        {125.0 / 192, &k4},
                        {-2187.0 / 6784, &k5},
                        {11.0 / 84, &k6}});
    const State k7 = f.rates(t + h, y);
    double error = 0.0;
    for (int i = 0; i < 2; ++i) {
      const double e = h * (71.0 / 57600 * k1[i] - 71.0 / 16695 * k3[i] + 71.0 / 1920 * k4[i] -
                            17253.0 / 339200 * k5[i] + 22.0 / 525 * k6[i] - 1.0 / 40 * k7[i]);
      error = std::max(error, std::abs(e) / std::max(1e-6, 1e-3 * std::max(std::abs(x[i]), std::abs(y[i]))));
    }
    if (!std::isfinite(error)) return;
    if (error <= 1.0) {
      for (; row <= w.last && r.time_s[row] <= t + h + 1e-12; ++row) {
        const double s = (r.time_s[row] - t) / h, s2 = s * s, s3 = s2 * s;
        State z;
        for (int i = 0; i < 2; ++i)
          z[i] = (1 - 3 * s2 + 2 * s3) * x[i] + (3 * s2 - 2 * s3) * y[i] + h * (s - 2 * s2 + s3) * k1[i] +
                 h * (s3 - s2) * k7[i];
        visit(row, z);
      }
      t += h;
      x = y;
      k1 = k7;
    }
    h *= std::clamp(0.8 * std::pow(std::max(error, 1e-10), -0.2), 0.2, 5.0);
  }
}

double mean(const std::vector<double>& v, const Window& w) {
  double sum = 0.0;
  for (std::size_t i = w.first; i <= w.last; ++i) sum += v[i];
  return sum / static_cast<double>(w.rows());
}

class Cost final : public ceres::FirstOrderFunction {
 public:
  Cost(const model::Model& model, const std::vector<identify::Unknown>& unknowns,
       const std::vector<Recording>& recordings, const std::vector<Window>& windows,
       std::vector<double> scales)
      : model_(model),
        unknowns_(unknowns),
        recordings_(recordings),
        windows_(windows),
        scales_(std::move(scales)) {}

  int NumParameters() const override { return static_cast<int>(unknowns_.size()); }

  /// Forward differences, as fmincon unless told otherwise.
  bool Evaluate(const double* at, double* cost, double* gradient) const override {
    std::vector<double> x(at, at + unknowns_.size());
    *cost = of(x);
    if (gradient != nullptr)
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double step = 1.5e-8 * std::max(1.0, std::abs(x[i])), before = x[i];
        x[i] += step;
        gradient[i] = (of(x) - *cost) / step;
        x[i] = before;
      }
    return std::isfinite(*cost);
  }

  std::vector<double> values(const std::vector<double>& scaled) const {
    std::vector<double> v(scaled.size());
    for (std::size_t i = 0; i < v.size(); ++i)
      v[i] = std::clamp(scaled[i] * scales_[i], unknowns_[i].lower, unknowns_[i].upper);
    return v;
  }

  /// Eq. 4.5 over eq. 4.4.
  double of(const std::vector<double>& scaled) const {
    ++evaluations_;
    const model::Model m = identify::with_values(model_, unknowns_, values(scaled));
    double sum = 0.0;
    for (const Window& w : windows_) {
      const Recording& r = recordings_[w.recording];
      const double z_mean = mean(r.position, w), v_mean = mean(r.velocity_smoothed, w);
      double z = 0.0, v = 0.0, z_spread = 0.0, v_spread = 0.0;
      std::size_t rows = 0;
      integrate(Motion(m, r, w), r, w, {r.position[w.first], r.velocity_smoothed[w.first]},
                [&](std::size_t row, const State& x) {
                  const auto square = [](double e) { return e * e; };
                  z += square(x[0] - r.position[row]);
                  v += square(x[1] - r.velocity_smoothed[row]);
                  z_spread += square(r.position[row] - z_mean);
                  v_spread += square(r.velocity_smoothed[row] - v_mean);
                  ++rows;
                });
      if (rows != w.rows()) return std::nan("");
      sum += z / z_spread + v / v_spread;
    }
    return sum;
  }

  std::size_t evaluations() const { return evaluations_; }

 private:
  const model::Model& model_;
  const std::vector<identify::Unknown>& unknowns_;
  const std::vector<Recording>& recordings_;
  const std::vector<Window>& windows_;
  std::vector<double> scales_;
  mutable std::size_t evaluations_ = 0;
};

}  // namespace

PlainFit fit_plainly(const model::Model& model, const std::vector<identify::Unknown>& unknowns,
                     const std::vector<double>& start, const std::vector<Recording>& recordings,
                     const std::vector<Window>& windows) {
  std::vector<double> scales, x;
  for (const double value : start) {
    scales.push_back(value != 0.0 ? std::abs(value) : 1.0);
    x.push_back(value / scales.back());
  }
  auto* cost = new Cost(model, unknowns, recordings, windows, scales);  // the problem's
  const ceres::GradientProblem problem(cost);
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-8;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, x.data(), &summary);
  return {cost->values(x), summary.final_cost, cost->evaluations(),
          summary.termination_type == ceres::CONVERGENCE};
}

}  // namespace furcula::reproduce
