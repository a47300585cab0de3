// A function as a graph of operations, recorded once by running it on numbers that write down what is done to them; then its values,
// its Jacobian and the Hessian of a weighted sum of its outputs, exactly and as often as wanted.
//
// For functions of tens of inputs and thousands of operations, where numbers that carry all second derivatives are too large: the
// Jacobian goes forwards over the graph, the Hessian forwards and back (Griewank and Walther, Evaluating Derivatives, 2008), eight
// directions at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "furcula/dynamics/scalar.hpp"
#include "host/optimise/nlp.hpp"

namespace furcula::optimise {

/// A number of a function that is being recorded: a constant, or what an operation gave. Of one recording, on one thread.
struct Recorded {
  std::int32_t at = -1;  ///< below zero: a constant
  double constant = 0.0;

  Recorded() = default;
  Recorded(double value) : constant(value) {}  // NOLINT(google-explicit-constructor): as a double anywhere
};
Recorded operator+(const Recorded& x, const Recorded& y);
Recorded operator-(const Recorded& x, const Recorded& y);
Recorded operator*(const Recorded& x, const Recorded& y);
Recorded operator/(const Recorded& x, const Recorded& y);
Recorded operator-(const Recorded& x);
Recorded sin(const Recorded& x);
Recorded cos(const Recorded& x);
Recorded sqrt(const Recorded& x);
inline Recorded& operator+=(Recorded& x, const Recorded& y) { return x = x + y; }
inline Recorded& operator-=(Recorded& x, const Recorded& y) { return x = x - y; }

class Graph {
 public:
  using Function = std::function<std::vector<Recorded>(const std::vector<Recorded>&)>;
  /// Runs f once. It must not branch on its numbers.
  Graph(std::size_t inputs, const Function& f);

  std::size_t inputs() const { return inputs_; }
  std::size_t outputs() const { return outputs_.size(); }
  std::size_t operations() const { return steps_.size() - inputs_; }

  void values(const double* x, double* out) const;
  /// By rows, outputs x inputs.
  void jacobian(const double* x, double* out) const;
  /// Of the sum of by[m] times output m: inputs x inputs.
  void hessian(const double* x, const double* by, double* out) const;

  enum class Operation : std::uint8_t {
    input,
    add,
    subtract,
    multiply,
    scale,
    shift,
    inverse,
    sine,
    cosine,
    root
  };
  struct Step {
    Operation what;
    std::int32_t a, b;
    double constant;  ///< of scale and shift
  };

 private:
  void forwards(const double* x, std::vector<double>& v) const;

  std::size_t inputs_;
  std::vector<Step> steps_;
  std::vector<Recorded> outputs_;
};

/// A graph's outputs, each times a factor, as rows of a programme; the graph's inputs are sums of variables. An output of row -1 is
/// left out.
class GraphElement final : public Element {
 public:
  GraphElement(std::shared_ptr<const Graph> graph, std::vector<Sum> inputs, std::vector<int> rows,
               std::vector<double> factors);
  void values(const double* x, double* rows) const override;
  void places(Triplets& jacobian, Triplets& hessian) const override;
  void derivatives(const double* x, const double* multipliers, double* jacobian,
                   double* hessian) const override;
  std::size_t jacobian_entries() const override { return used_.size() * variables_.size(); }
  std::size_t hessian_entries() const override { return variables_.size() * (variables_.size() + 1) / 2; }

 private:
  std::vector<double> inputs_at(const double* x) const;

  std::shared_ptr<const Graph> graph_;
  std::vector<Sum> sums_;  ///< by places in variables_
  std::vector<int> rows_, variables_;
  std::vector<double> factors_;
  std::vector<std::size_t> used_;  ///< outputs
};

}  // namespace furcula::optimise

namespace furcula::dynamics {

template <>
struct ScalarTraits<optimise::Recorded> {
  using Value = double;
};

}  // namespace furcula::dynamics
