// Recorded functions: values, Jacobians and Hessians against closed forms and against numbers that carry second derivatives.
#include "host/optimise/graph.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula::optimise;

namespace {

/// All operations, of three inputs.
template <class T>
std::vector<T> some_function(const std::vector<T>& x) {
  const T a = sin(x[0] * x[1]) / sqrt(x[1]) + x[0] * x[0] - cos(x[0]);
  return {a, -x[2] * a + 2.0, x[1] / x[2] - 3.0 * x[0] - 1.0, T(7.0)};
}

}  // namespace

TEST_CASE("a graph has the values and derivatives of its function") {
  const Graph graph(3, [](const std::vector<Recorded>& x) { return some_function(x); });
  const double x[3]{0.7, 1.3, -0.4}, by[4]{0.5, -2.0, 1.5, 3.0};
  const std::vector<Second<3>> in{Second<3>(x[0], 0), Second<3>(x[1], 1), Second<3>(x[2], 2)};
  const std::vector<Second<3>> out = some_function(in);
  double values[4], jacobian[12], hessian[9];
  graph.values(x, values);
  graph.jacobian(x, jacobian);
  graph.hessian(x, by, hessian);
  for (std::size_t m = 0; m < 4; ++m) {
    CHECK(values[m] == Approx(out[m].a));
    for (std::size_t i = 0; i < 3; ++i) CHECK(jacobian[3 * m + i] == Approx(out[m].g[i]).margin(1e-14));
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (std::size_t m = 0; m < 4; ++m) sum += by[m] * out[m].h[i * (i + 1) / 2 + j];
      CHECK(hessian[3 * i + j] == Approx(sum).margin(1e-14));
      CHECK(hessian[3 * j + i] == Approx(sum).margin(1e-14));
    }
}

TEST_CASE("a Hessian of more inputs than go at once is whole") {
  // f = sum over i < j of (i + 1) (j + 2) x_i x_j, of 19 inputs
  constexpr std::size_t kInputs = 19;
  const auto weight = [](std::size_t i, std::size_t j) { return static_cast<double>((i + 1) * (j + 2)); };
  const Graph graph(kInputs, [&](const std::vector<Recorded>& x) {
    Recorded sum;
    for (std::size_t i = 0; i < kInputs; ++i)
      for (std::size_t j = i + 1; j < kInputs; ++j) sum += x[i] * x[j] * weight(i, j);
    return std::vector<Recorded>{sum};
  });
  std::vector<double> x(kInputs, 0.3), hessian(kInputs * kInputs);
  const double by = 2.0;
  graph.hessian(x.data(), &by, hessian.data());
  for (std::size_t i = 0; i < kInputs; ++i)
    for (std::size_t j = 0; j < kInputs; ++j) {
      const double expected = i == j ? 0.0 : 2.0 * weight(std::min(i, j), std::max(i, j));
      CHECK(hessian[i * kInputs + j] == Approx(expected).margin(1e-12));
    }
}

TEST_CASE("what is known or not needed is not recorded") {
  const Graph graph(2, [](const std::vector<Recorded>& x) {
    const Recorded none = x[0] * Recorded(0.0) + Recorded(0.0);  // a constant
    const Recorded once = x[0] * x[1], again = x[1] * x[0];      // one operation
    const Recorded unused = sin(x[0]);
    (void)unused;
    return std::vector<Recorded>{(once + again * Recorded(1.0) + none) * Recorded(1.0)};
  });
  CHECK(graph.operations() == 2);  // the product, and its sum with itself
  const double x[2]{3.0, 5.0};
  double value = 0.0;
  graph.values(x, &value);
  CHECK(value == 30.0);
}

TEST_CASE("a graph as an element has the derivatives of an element of the same function") {
  const std::array<Sum, 2> inputs{Sum{{0, 2.0}, {1, -1.0}}, Sum{{1, 1.0}, {2, 1.0}}};
  const auto f = [](const auto& z) {
    using T = std::decay_t<decltype(z[0])>;
    return std::array<T, 2>{z[0] * z[1] * 3.0, sin(z[0]) * z[1]};
  };
  const auto graph = std::make_shared<const Graph>(2, [&](const std::vector<Recorded>& z) {
    return std::vector<Recorded>{z[0] * z[1], cos(z[0]), sin(z[0]) * z[1]};
  });
  // The graph's second output is left out, its first counts three times.
  const GraphElement element(graph, {inputs.begin(), inputs.end()}, {0, -1, 1}, {3.0, 1.0, 1.0});
  const ElementOf<2, 2, decltype(f)> expected(inputs, {0, 1}, f);
  const double x[3]{0.5, 0.2, -1.0}, by[2]{3.0, 0.5};
  const auto dense = [&](const Element& e) {
    Triplets jacobian, hessian;
    e.places(jacobian, hessian);
    CHECK(jacobian.row.size() == e.jacobian_entries());
    CHECK(hessian.row.size() == e.hessian_entries());
    jacobian.value.resize(jacobian.row.size());
    hessian.value.resize(hessian.row.size());
    e.derivatives(x, by, jacobian.value.data(), hessian.value.data());
    std::array<double, 17> out{};  // rows, Jacobian 2 x 3, Hessian 3 x 3
    e.values(x, out.data());
    const auto place = [](std::size_t from, int row, int column) {
      return from + 3 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column);
    };
    for (std::size_t k = 0; k < jacobian.row.size(); ++k)
      out[place(2, jacobian.row[k], jacobian.column[k])] += jacobian.value[k];
    for (std::size_t k = 0; k < hessian.row.size(); ++k)
      out[place(8, hessian.row[k], hessian.column[k])] += hessian.value[k];
    return out;
  };
  const auto is = dense(element), should = dense(expected);
  for (std::size_t i = 0; i < is.size(); ++i) CHECK(is[i] == Approx(should[i]).margin(1e-14));
}
