// A non-linear programme that is put together of small elements, each with exact first and second derivatives;
// solved by Ipopt.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/optimise/second.hpp"

namespace furcula::optimise {

/// A sum of variables, each times a number.
using Sum = std::vector<std::pair<int, double>>;

/// Entries of a sparse matrix; those of one place add up.
struct Triplets {
  std::vector<int> row, column;
  std::vector<double> value;
};

/// Some rows of a programme as functions of a few sums of its variables.
class Element {
 public:
  Element() = default;
  virtual ~Element() = default;
  Element(const Element&) = delete;
  Element& operator=(const Element&) = delete;
  /// Adds to the rows.
  virtual void values(const double* x, double* rows) const = 0;
  /// Places of the derivatives, then their values in the same order from `at` on, which move past them.
  virtual void places(Triplets& jacobian, Triplets& hessian) const = 0;
  virtual void derivatives(const double* x, const double* multipliers, double* jacobian,
                           double* hessian) const = 0;
  virtual std::size_t jacobian_entries() const = 0;
  virtual std::size_t hessian_entries() const = 0;
};

/// f(array<T, N>) -> array<T, M>, for T double and Second<N>. The Hessian's places are those of its lower triangle.
template <std::size_t N, std::size_t M, class F>
class ElementOf final : public Element {
 public:
  ElementOf(const std::array<Sum, N>& inputs, const std::array<int, M>& rows, F f)
      : rows_(rows), f_(std::move(f)) {
    for (const Sum& input : inputs)
      for (const auto& [variable, factor] : input) place_of(variable);
    weights_.assign(N * variables_.size(), 0.0);
    for (std::size_t i = 0; i < N; ++i)
      for (const auto& [variable, factor] : inputs[i])
        weights_[i * variables_.size() + place_of(variable)] += factor;
  }

  void values(const double* x, double* rows) const override {
    const auto out = f_(inputs(x));
    for (std::size_t m = 0; m < M; ++m) rows[rows_[m]] += out[m];
  }
  void places(Triplets& jacobian, Triplets& hessian) const override {
    for (const int row : rows_)
      for (const int v : variables_) {
        jacobian.row.push_back(row);
        jacobian.column.push_back(v);
      }
    for (std::size_t i = 0; i < variables_.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        hessian.row.push_back(std::max(variables_[i], variables_[j]));
        hessian.column.push_back(std::min(variables_[i], variables_[j]));
      }
  }
  void derivatives(const double* x, const double* multipliers, double* jacobian,
                   double* hessian) const override {
    const std::array<double, N> z = inputs(x);
    std::array<Second<N>, N> s;
    for (std::size_t i = 0; i < N; ++i) s[i] = Second<N>(z[i], i);
    const auto out = f_(s);
    const std::size_t count = variables_.size();
    if (jacobian != nullptr)
      for (std::size_t m = 0; m < M; ++m)
        for (std::size_t v = 0; v < count; ++v) {
          double sum = 0.0;
          for (std::size_t i = 0; i < N; ++i) sum += out[m].g[i] * weights_[i * count + v];
          *jacobian++ = sum;
        }
    if (hessian == nullptr) return;
    std::array<double, N * N> h{};
    for (std::size_t m = 0; m < M; ++m) {
      const double by = multipliers[rows_[m]];
      for (std::size_t i = 0, k = 0; i < N; ++i)
        for (std::size_t j = 0; j <= i; ++j, ++k) h[i * N + j] += by * out[m].h[k];
    }
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < i; ++j) h[j * N + i] = h[i * N + j];
    std::vector<double> half(N * count, 0.0);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j)
        for (std::size_t v = 0; v < count; ++v) half[i * count + v] += h[i * N + j] * weights_[j * count + v];
    for (std::size_t u = 0; u < count; ++u)
      for (std::size_t v = 0; v <= u; ++v) {
        double sum = 0.0;
        for (std::size_t i = 0; i < N; ++i) sum += weights_[i * count + u] * half[i * count + v];
        *hessian++ = sum;
      }
  }
  std::size_t jacobian_entries() const override { return M * variables_.size(); }
  std::size_t hessian_entries() const override { return variables_.size() * (variables_.size() + 1) / 2; }

 private:
  std::size_t place_of(int variable) {
    for (std::size_t k = 0; k < variables_.size(); ++k)
      if (variables_[k] == variable) return k;
    variables_.push_back(variable);
    return variables_.size() - 1;
  }
  std::array<double, N> inputs(const double* x) const {
    std::array<double, N> z{};
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t v = 0; v < variables_.size(); ++v)
        z[i] += weights_[i * variables_.size() + v] * x[variables_[v]];
    return z;
  }

  std::array<int, M> rows_;
  F f_;
  std::vector<int> variables_;
  std::vector<double> weights_;  ///< of each variable in each input
};

/// Rows as one function of all variables, f(x, rows, jacobian) with the Jacobian by rows (null: not asked for); it
/// leaves NaN in the rows where it cannot be evaluated. It has no second derivatives: the solver estimates them.
class WholeElement final : public Element {
 public:
  using Function = std::function<void(const double* x, double* rows, double* jacobian)>;
  WholeElement(std::size_t variables, std::size_t rows, Function f)
      : variables_(variables), rows_(rows), f_(std::move(f)) {}
  void values(const double* x, double* rows) const override;
  void places(Triplets& jacobian, Triplets& hessian) const override;
  void derivatives(const double* x, const double* multipliers, double* jacobian,
                   double* hessian) const override;
  std::size_t jacobian_entries() const override { return variables_ * rows_; }
  std::size_t hessian_entries() const override { return 0; }

 private:
  std::size_t variables_, rows_;
  Function f_;
};

/// The word of rows that define the cost.
inline constexpr const char* kCostRow = "the cost";

constexpr double kNoBound = 1e20;  ///< beyond Ipopt's own

/// Row 0 is the objective; the others are constraints.
class Nlp {
 public:
  Nlp() { rows_.push_back({"cost", -kNoBound, kNoBound}); }

  int variable(double lower, double upper, double start) {
    variables_.push_back({lower, upper, start});
    return static_cast<int>(variables_.size()) - 1;
  }
  /// `what` tells a person which constraint it is; rows of one kind share it.
  int row(const char* what, double lower, double upper) {
    rows_.push_back({what, lower, upper});
    return static_cast<int>(rows_.size()) - 1;
  }
  void linear(int row, const Sum& sum) {
    for (const auto& [variable, factor] : sum) {
      linear_.row.push_back(row);
      linear_.column.push_back(variable);
      linear_.value.push_back(factor);
    }
  }
  template <std::size_t N, std::size_t M, class F>
  void element(const std::array<Sum, N>& inputs, const std::array<int, M>& rows, F f) {
    elements_.push_back(std::make_unique<ElementOf<N, M, F>>(inputs, rows, std::move(f)));
  }

  void add(std::unique_ptr<Element> element) { elements_.push_back(std::move(element)); }

  /// Of rows 0 to `rows` - 1. It takes the exact Hessian away.
  void whole(std::size_t rows, WholeElement::Function f) {
    elements_.push_back(std::make_unique<WholeElement>(variables_.size(), rows, std::move(f)));
    exact_ = false;
  }
  bool has_hessian() const { return exact_; }

  struct Variable {
    double lower, upper, start;
  };
  struct Row {
    const char* what;
    double lower, upper;
  };
  std::vector<Variable>& variables() { return variables_; }
  const std::vector<Row>& rows() const { return rows_; }
  void bound_row(int row, double lower, double upper) {
    rows_[static_cast<std::size_t>(row)].lower = lower;
    rows_[static_cast<std::size_t>(row)].upper = upper;
  }
  const Triplets& linear() const { return linear_; }
  const std::vector<std::unique_ptr<Element>>& elements() const { return elements_; }

  /// All rows at x.
  std::vector<double> evaluate(const std::vector<double>& x) const;

 private:
  std::vector<Variable> variables_;
  std::vector<Row> rows_;
  Triplets linear_;
  std::vector<std::unique_ptr<Element>> elements_;
  bool exact_ = true;
};

struct SolveOptions {
  int iterations = 400;
  double tolerance = 1e-7;
  double cpu_s = 1e6;  ///< of processor time, then it ends
  bool monotone =
      false;  ///< the barrier parameter never grows: slower, and sometimes gets on where the adaptive one is stuck
  double barrier = 0.1;  ///< where the barrier parameter begins; small for a start near a solution
  /// Called once an iteration with the cost and the largest violation; false stops.
  std::function<bool(int iteration, double cost, double violation)> progress;
};

struct Solution {
  bool found = false;  ///< the constraints hold and no feasible direction is cheaper, to the tolerance
  std::string status;  ///< Ipopt's word for how it ended
  int iterations = 0;
  double cost = 0.0;
  double violation = 0.0;  ///< of the constraint that is violated most
  const char* worst = "";  ///< which one
  std::vector<double> x;
};

/// From the variables' starts.
Solution solve(Nlp& nlp, const SolveOptions& options);

}  // namespace furcula::optimise
