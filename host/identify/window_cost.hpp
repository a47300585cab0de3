// The residuals of one window as the solver of a fit asks for them.
#pragma once

#include <ceres/cost_function.h>

#include <cstdint>
#include <vector>

#include "host/identify/whitening.hpp"
#include "host/identify/window_run.hpp"

namespace furcula::identify {

/// Residuals of one window against the unknowns (block 0, absent if there are none) and its start state. The last run is kept: the solver
/// asks for a point in its line search, for its cost and for its derivatives. Not for several threads at a time.
class WindowCost final : public ceres::CostFunction {
 public:
  WindowCost(const model::Model& model, const std::vector<Unknown>& unknowns, const Recording& recording,
             const Window& window, Weights weights, const Whitening* whitening = nullptr);

  const WindowRun& run() const { return run_; }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  enum class Derivatives : std::uint8_t { none, by_start, all };

  void run_to(std::vector<double> at, Derivatives wanted) const;

  struct Last {
    std::vector<double> at, residuals;
    std::vector<std::vector<double>> jacobians;  ///< of each block
    Derivatives derivatives = Derivatives::none;
    bool finite = false;
  };

  WindowRun run_;
  const Whitening* whitening_;
  mutable Last last_;
};

}  // namespace furcula::identify
