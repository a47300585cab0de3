// Splines and points of Gauss against polynomials, the Runge-Kutta step against a closed form.
#include "host/optimise/spline.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/gait/free_gait.hpp"
#include "host/gait/runge_kutta.hpp"

using namespace furcula::gait;
using furcula::optimise::GaussPoint;
using furcula::optimise::kGauss;

TEST_CASE("a spline gives back a polynomial of its degree with all derivatives") {
  const Spline spline(7);
  const auto p = [](double s) { return 1.0 - s + 2.0 * s * s - 0.5 * std::pow(s, 5); };
  std::vector<double> values;
  for (int i = 0; i <= 60; ++i) values.push_back(p(i / 60.0));
  const std::vector<double> c = spline.fitted(values);
  REQUIRE(c.size() == 12);
  CHECK(c.front() == Approx(p(0.0)));
  CHECK(c.back() == Approx(p(1.0)));
  for (const double s : {0.0, 0.1, 3.0 / 7.0, 0.5, 0.99, 1.0}) {
    const Spline::Basis b = spline.basis(s);
    std::array<double, Spline::kOrder> v{};
    for (std::size_t d = 0; d < v.size(); ++d)
      for (std::size_t i = 0; i < Spline::kOrder; ++i) v[d] += b.share[d][i] * c[b.first + i];
    CHECK(v[0] == Approx(p(s)).margin(1e-10));
    CHECK(v[1] == Approx(-1.0 + 4.0 * s - 2.5 * std::pow(s, 4)).margin(1e-8));
    CHECK(v[2] == Approx(4.0 - 10.0 * std::pow(s, 3)).margin(1e-6));
    CHECK(v[5] == Approx(-60.0).epsilon(1e-3));
  }
}

TEST_CASE("points of Gauss integrate polynomials up to degree 7 exactly") {
  for (int n = 0; n <= 7; ++n) {
    double sum = 0.0;
    for (const GaussPoint& g : kGauss) sum += g.weight * std::pow(g.at, n);
    CHECK(sum == Approx(1.0 / (n + 1)).epsilon(1e-14));
  }
}

TEST_CASE("a path's rates are by time, and go on beyond its end") {
  const Spline spline(4);
  std::vector<double> hip, knee;
  for (int i = 0; i <= 30; ++i) {
    const double t = 0.4 * i / 30.0;
    hip.push_back(3.0 * t * t);
    knee.push_back(1.0 - t);
  }
  const JointPath path{0.4, spline.fitted(hip), spline.fitted(knee)};
  for (const double t : {0.0, 0.13, 0.4, 0.45}) {
    const auto at = path.at(t);
    CHECK(at.angle.hip == Approx(3.0 * t * t).margin(1e-10));
    CHECK(at.rate.hip == Approx(6.0 * t).margin(1e-8));
    CHECK(at.acceleration.hip == Approx(6.0).margin(1e-6));
    CHECK(at.angle.knee == Approx(1.0 - t).margin(1e-10));
    CHECK(at.rate.knee == Approx(-1.0).margin(1e-8));
  }
}

TEST_CASE("a Runge-Kutta step has order 8") {
  // x'' = -x from (1, 0): after h, (cos h, -sin h). The error of a step falls by 2^9.
  const auto error = [](double h) {
    const auto x = runge_kutta_8<double, 2>(0.0, {1.0, 0.0}, h, [](double, const std::array<double, 2>& s) {
      return std::array<double, 2>{s[1], -s[0]};
    });
    return std::hypot(x[0] - std::cos(h), x[1] + std::sin(h));
  };
  CHECK(error(0.5) < 1e-9);
  CHECK(std::log2(error(1.0) / error(0.5)) == Approx(9.0).margin(0.4));
  // An integral over time alone, of t^7: exact.
  const auto q = runge_kutta_8<double, 1>(0.0, {0.0}, 1.0, [](double t, const std::array<double, 1>&) {
    return std::array<double, 1>{std::pow(t, 7)};
  });
  CHECK(q[0] == Approx(0.125).epsilon(1e-13));
}
