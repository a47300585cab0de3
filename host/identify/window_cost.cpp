// The residuals of one window, see window_cost.hpp.
#include "host/identify/window_cost.hpp"

#include <algorithm>
#include <utility>

#include "host/identify/dual.hpp"

namespace furcula::identify {
namespace {

/// With numbers that hold no more derivatives than needed.
bool run_with(const WindowRun& run, bool of_unknowns, double const* const* blocks, double* residuals,
              double** jacobians) {
  const std::size_t size = (of_unknowns ? run.unknowns.size() : 0) + kStartSize;
  if (size <= 2) return run_window<Dual<2>>(run, blocks, residuals, jacobians);
  if (size <= 4) return run_window<Dual<4>>(run, blocks, residuals, jacobians);
  if (size <= 6) return run_window<Dual<6>>(run, blocks, residuals, jacobians);
  if (size <= 8) return run_window<Dual<8>>(run, blocks, residuals, jacobians);
  if (size <= 10) return run_window<Dual<10>>(run, blocks, residuals, jacobians);
  if (size <= 12) return run_window<Dual<12>>(run, blocks, residuals, jacobians);
  if (size <= 20) return run_window<Dual<20>>(run, blocks, residuals, jacobians);
  static_assert(kMostUnknowns + kStartSize <= 32);
  return run_window<Dual<32>>(run, blocks, residuals, jacobians);
}

}  // namespace

WindowCost::WindowCost(const model::Model& model, const std::vector<Unknown>& unknowns,
                       const Recording& recording, const Window& window, Weights weights,
                       const Whitening* whitening)
    : run_{model, unknowns, recording, window, weights}, whitening_(whitening) {
  set_num_residuals(
      static_cast<int>(run_.motion_rows() + run_.contact_rows() + run_.drive_rows() + run_.leg_rows()));
  if (!unknowns.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns.size()));
  mutable_parameter_block_sizes()->push_back(kStartSize);
}

bool WindowCost::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  std::vector<double> at;
  for (std::size_t b = 0; b < parameter_block_sizes().size(); ++b)
    at.insert(at.end(), blocks[b], blocks[b] + parameter_block_sizes()[b]);
  Derivatives wanted = Derivatives::none;
  if (jacobians != nullptr)
    wanted = run_.unknowns.empty() || jacobians[0] == nullptr ? Derivatives::by_start : Derivatives::all;
  if (at != last_.at || wanted > last_.derivatives) run_to(std::move(at), wanted);
  std::copy(last_.residuals.begin(), last_.residuals.end(), residuals);
  for (std::size_t b = 0; jacobians != nullptr && b < last_.jacobians.size(); ++b)
    if (jacobians[b] != nullptr)
      std::copy(last_.jacobians[b].begin(), last_.jacobians[b].end(), jacobians[b]);
  return last_.finite;
}

void WindowCost::run_to(std::vector<double> at, Derivatives wanted) const {
  const auto rows = static_cast<std::size_t>(num_residuals());
  last_.at = std::move(at);
  last_.derivatives = wanted;
  last_.residuals.resize(rows);
  last_.jacobians.resize(parameter_block_sizes().size());
  const double* blocks[2] = {};
  double* jacobians[2] = {};
  const double* block = last_.at.data();
  for (std::size_t b = 0; b < last_.jacobians.size(); ++b) {
    const auto size = static_cast<std::size_t>(parameter_block_sizes()[b]);
    blocks[b] = block;
    block += size;
    const bool of_start = b + 1 == last_.jacobians.size();
    if (wanted == Derivatives::none || (wanted == Derivatives::by_start && !of_start)) continue;
    last_.jacobians[b].resize(rows * size);
    jacobians[b] = last_.jacobians[b].data();
  }
  last_.finite = wanted == Derivatives::none
                     ? run_window<double>(run_, blocks, last_.residuals.data(), nullptr)
                     : run_with(run_, wanted == Derivatives::all, blocks, last_.residuals.data(), jacobians);
  if (whitening_ == nullptr || !last_.finite) return;
  whitening_->apply(last_.residuals.data(), run_.window.rows(), 1);
  for (std::size_t b = 0; b < last_.jacobians.size(); ++b)
    if (jacobians[b] != nullptr)
      whitening_->apply(jacobians[b], run_.window.rows(),
                        static_cast<std::size_t>(parameter_block_sizes()[b]));
}

}  // namespace furcula::identify
