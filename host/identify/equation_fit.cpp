#include "host/identify/equation_fit.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "host/core/error.hpp"
#include "host/identify/dual.hpp"
#include "host/identify/simulate.hpp"

namespace furcula::identify {
namespace {

/// What a channel's errors are measured by: its spread over the window on the hopper (002 eq. 4.4), over the
/// recording on an axis, which may rest through a window.
double spread(const std::vector<double>& values, const Recording& r, const Window& w) {
  const bool leg = dynamics::has(r.kind, dynamics::LocationType::leg);
  const std::size_t first = leg ? w.first : 0, last = leg ? w.last : r.rows() - 1;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = first; i <= last; ++i) mean += values[i] / static_cast<double>(last - first + 1);
  for (std::size_t i = first; i <= last; ++i) squares += (values[i] - mean) * (values[i] - mean);
  return std::max(std::sqrt(squares), 1e-12);
}

/// Residuals of one window: two a step, against the unknowns.
class StepCost final : public ceres::CostFunction {
 public:
  StepCost(const model::Model& model, const std::vector<Unknown>& unknowns, const Recording& recording,
           const Window& window)
      : model_(model),
        unknowns_(unknowns),
        recording_(recording),
        window_(window),
        position_weight_(1.0 / spread(recording.position, recording, window)),
        velocity_weight_(1.0 / spread(recording.velocity_smoothed, recording, window)) {
    set_num_residuals(2 * static_cast<int>(window.rows() - 1));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    if (jacobians == nullptr || jacobians[0] == nullptr) return run<double>(blocks[0], residuals, nullptr, 0);
    bool finite = true;
    for (std::size_t from = 0; from < unknowns_.size(); from += kAtOnce)
      finite = run<Dual<kAtOnce>>(blocks[0], residuals, jacobians[0], from) && finite;
    return finite;
  }

 private:
  static constexpr int kAtOnce = 12;  ///< unknowns that a run carries the derivatives by

  /// The columns of the Jacobian from unknown `from` on.
  template <class T>
  bool run(const double* at, double* residuals, double* jacobian, std::size_t from) const {
    const std::size_t count = unknowns_.size(), to = std::min<std::size_t>(count, from + kAtOnce);
    std::vector<T> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = T(at[i]);
      if constexpr (!std::is_same_v<T, double>)
        if (i >= from && i < to) values[i].set(i - from, 1.0);
    }
    bool finite = true;
    const auto put = [&](const T& error, double weight) {
      *residuals = dynamics::value_of(error) * weight;
      finite = finite && std::isfinite(*residuals);
      ++residuals;
      if constexpr (!std::is_same_v<T, double>) {
        for (std::size_t i = from; i < to; ++i) jacobian[i] = error.derivative(i - from) * weight;
        jacobian += count;
      }
    };
    const Recording& r = recording_;
    one_step_each(PlantSetup<T>(model_, unknowns_, values.data()), r, window_,
                  [&](std::size_t row, const T& position, const T& velocity) {
                    put(position - r.position[row], position_weight_);
                    put(velocity - r.velocity_smoothed[row], velocity_weight_);
                  });
    return finite;
  }

  const model::Model& model_;
  const std::vector<Unknown>& unknowns_;
  const Recording& recording_;
  const Window& window_;
  double position_weight_, velocity_weight_;
};

}  // namespace

Fit fit_by_equation(const model::Model& model, const std::vector<Unknown>& unknowns,
                    const std::vector<double>& start, const std::vector<Recording>& recordings,
                    const std::vector<Window>& windows, std::size_t layers) {
  if (windows.empty())
    throw core::DataError("equation error: no stance, flight or interval to fit on; expected at least one");
  Fit fit;
  fit.values = start;
  std::deque<StepCost> costs;
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  for (const Window& w : windows) {
    costs.emplace_back(model, unknowns, recordings[w.recording], w);
    problem.AddResidualBlock(&costs.back(), nullptr, fit.values.data());
  }
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    fit.values[i] = std::clamp(fit.values[i], unknowns[i].lower, unknowns[i].upper);
    problem.SetParameterLowerBound(fit.values.data(), static_cast<int>(i), unknowns[i].lower);
    problem.SetParameterUpperBound(fit.values.data(), static_cast<int>(i), unknowns[i].upper);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-10;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  require_finite(summary.IsSolutionUsable(), recordings, windows);
  fit.at_bound = at_bounds(fit.values, unknowns);
  const auto count = static_cast<Eigen::Index>(unknowns.size());
  for (const StepCost& cost : costs) {
    Eigen::VectorXd residual(cost.num_residuals());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(cost.num_residuals(),
                                                                                    count);
    const double* block = fit.values.data();
    double* rows = jacobian.data();
    cost.Evaluate(&block, residual.data(), &rows);
    WindowShare share;
    share.squares = residual.squaredNorm();
    share.gradient = jacobian.transpose() * residual;
    share.information = jacobian.transpose() * jacobian;
    const auto count_of_rows = static_cast<double>(residual.size());
    share.channels[0] = {share.squares, count_of_rows, count_of_rows};
    fit.squares += share.squares;
    fit.shares.push_back(std::move(share));
  }
  fit.layers = layers;
  fit.covariance = jackknife_covariance(fit.shares, fit.at_bound, layers);
  return fit;
}

}  // namespace furcula::identify
