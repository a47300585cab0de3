// Second derivatives against closed forms, and the programme's elements against differences.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/optimise/nlp.hpp"

using namespace furcula::optimise;

TEST_CASE("numbers carry first and second derivatives of the four operations and the functions") {
  using S = Second<2>;
  const double a = 0.7, b = 1.3;
  const S x(a, 0), y(b, 1);
  // f = sin(x y) / sqrt(y) + x^2 - cos(x)
  const S f = sin(x * y) / sqrt(y) + x * x - cos(x);
  const double s = std::sin(a * b), c = std::cos(a * b), r = std::sqrt(b);
  CHECK(f.a == Approx(s / r + a * a - std::cos(a)));
  CHECK(f.g[0] == Approx(c * b / r + 2.0 * a + std::sin(a)));
  CHECK(f.g[1] == Approx(c * a / r - 0.5 * s / (b * r)));
  CHECK(f.h[0] == Approx(-s * b * r + 2.0 + std::cos(a)));
  CHECK(f.h[1] == Approx(c / r - s * a * r - 0.5 * c / r));
  CHECK(f.h[2] ==
        Approx(-s * a * a / r - 0.5 * c * a / (b * r) - 0.5 * (c * a / (b * r) - 1.5 * s / (b * b * r))));
}

TEST_CASE("an element's derivatives are those of its function of sums of variables") {
  // Rows z0 z1 and z0^2 with z0 = 2 x0 - x1, z1 = x1 + x2.
  const std::array<Sum, 2> inputs{Sum{{0, 2.0}, {1, -1.0}}, Sum{{1, 1.0}, {2, 1.0}}};
  const auto f = [](const auto& z) {
    using T = std::decay_t<decltype(z[0])>;
    return std::array<T, 2>{z[0] * z[1], z[0] * z[0]};
  };
  const ElementOf<2, 2, decltype(f)> element(inputs, {0, 1}, f);
  const double x[3]{0.5, 2.0, -1.0}, by[2]{3.0, 0.5};  // z = (-1, 1)
  double rows[2]{};
  element.values(x, rows);
  CHECK(rows[0] == Approx(-1.0));
  CHECK(rows[1] == Approx(1.0));
  Triplets jacobian, hessian;
  element.places(jacobian, hessian);
  jacobian.value.resize(jacobian.row.size());
  hessian.value.resize(hessian.row.size());
  element.derivatives(x, by, jacobian.value.data(), hessian.value.data());
  const auto at = [](const Triplets& t, int row, int column) {
    double sum = 0.0;
    for (std::size_t k = 0; k < t.row.size(); ++k)
      if (t.row[k] == row && t.column[k] == column) sum += t.value[k];
    return sum;
  };
  // d(z0 z1) = z1 (2, -1, 0) + z0 (0, 1, 1);  d(z0^2) = 2 z0 (2, -1, 0)
  CHECK(at(jacobian, 0, 0) == Approx(2.0));
  CHECK(at(jacobian, 0, 1) == Approx(-2.0));
  CHECK(at(jacobian, 0, 2) == Approx(-1.0));
  CHECK(at(jacobian, 1, 0) == Approx(-4.0));
  CHECK(at(jacobian, 1, 1) == Approx(2.0));
  // 3 of z0 z1: x0 x1: 2, x1 x1: -2, x0 x2: 2, x1 x2: -1;  0.5 of z0^2: 2 (2, -1)(2, -1)'
  CHECK(at(hessian, 0, 0) == Approx(0.5 * 8.0));
  CHECK(at(hessian, 1, 0) == Approx(3.0 * 2.0 - 0.5 * 4.0));
  CHECK(at(hessian, 1, 1) == Approx(-3.0 * 2.0 + 0.5 * 2.0));
  CHECK(at(hessian, 2, 0) == Approx(3.0 * 2.0));
  CHECK(at(hessian, 2, 1) == Approx(-3.0));
}

TEST_CASE("a programme's optimum is the one that can be worked out by hand, and what cannot be met is said") {
  // Least x^2 + y^2 with x + y = 2 and x >= 1.5: (1.5, 0.5).
  const auto build = [](double least) {
    Nlp p;
    const int x = p.variable(least, 10.0, 3.0), y = p.variable(-10.0, 10.0, 0.0);
    p.linear(p.row("the sum", 2.0, 2.0), {{x, 1.0}, {y, 1.0}});
    p.element(std::array<Sum, 2>{Sum{{x, 1.0}}, Sum{{y, 1.0}}}, std::array<int, 1>{0}, [](const auto& z) {
      using T = std::decay_t<decltype(z[0])>;
      return std::array<T, 1>{z[0] * z[0] + z[1] * z[1]};
    });
    return p;
  };
  Nlp p = build(1.5);
  const Solution s = solve(p, {});
  REQUIRE(s.found);
  CHECK(s.x[0] == Approx(1.5).margin(1e-5));
  CHECK(s.x[1] == Approx(0.5).margin(1e-5));
  CHECK(s.cost == Approx(2.5).margin(1e-5));

  Nlp none = build(1.5);
  none.linear(none.row("the difference", 50.0, 60.0), {{0, 1.0}, {1, -1.0}});
  const Solution refused = solve(none, {});
  CHECK_FALSE(refused.found);
  CHECK(refused.violation > 1.0);
}
