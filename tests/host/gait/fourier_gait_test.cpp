// The print's 49 parameters against an independent calculation; series and curves against their formulas.
#include "host/gait/fourier_gait.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/host/gait/legs.hpp"

using namespace furcula;
using namespace furcula::gait;

TEST_CASE("a law has the torques of its series and of its curves' PD law") {
  FourierParameters<double> p;
  p.omega_radps = 9.0;
  p.hip.mean = 1.0;
  p.hip.sine = {0.5, 0.0, -0.2, 0.0, 0.1};
  p.knee.cosine = {0.0, 2.0, 0.0, 0.3, 0.0};
  p.rise_s = 0.1;
  p.rise_hip = {-0.5, -0.4, -0.3, -0.3, -0.4, -0.6};
  const FourierLaw<double> law(p);
  const double t = 0.21;
  const auto u = law.motors(LegPhase::stance, t, 0.0, {}, {});
  CHECK(u.hip == Approx(1.0 + 0.5 * std::sin(9.0 * t) - 0.2 * std::sin(27.0 * t) + 0.1 * std::sin(45.0 * t)));
  CHECK(u.knee == Approx(2.0 * std::cos(18.0 * t) + 0.3 * std::cos(36.0 * t)));

  // sum of c 5! / (k! (5 - k)!) s^k (1 - s)^(5 - k), and its rate by a difference
  const auto curve = [&](double s) {
    const double choose[6]{1, 5, 10, 10, 5, 1};
    double sum = 0.0;
    for (int k = 0; k <= 5; ++k)
      sum += p.rise_hip[static_cast<std::size_t>(k)] * choose[k] * std::pow(s, k) * std::pow(1.0 - s, 5 - k);
    return sum;
  };
  const double s = 0.35, slope = (curve(s + 1e-6) - curve(s - 1e-6)) / 2e-6 / 0.1;
  const auto pd = law.motors(LegPhase::rise, 0.035, 0.0, {-0.2, 0.0}, {1.5, 0.0});
  CHECK(pd.hip == Approx(200.0 * (curve(s) + 0.2) + 5.0 * (slope - 1.5)).epsilon(1e-6));
  // Beyond a quarter past its end the curve holds.
  const auto held = law.motors(LegPhase::rise, 0.3, 0.0, {-0.2, 0.0}, {0.0, 0.0});
  CHECK(held.hip == Approx(200.0 * (curve(1.25) + 0.2)));
}

TEST_CASE("there and back again, the parameters are the same 49") {
  std::array<double, FourierParameters<double>::kCount> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5 + static_cast<double>(i);
  CHECK(FourierParameters<double>::of(values).values() == values);
  CHECK(values.size() == 49);
}

TEST_CASE("with 49 parameters a hop in place costs what an independent calculation says, or less") {
  const Search s = test::found(LegSpring::switched, test::in_place(0.075), true);
  INFO(s.refusal);
  REQUIRE(s.gait);
  CHECK(s.gait->is_fourier());
  CHECK(s.evaluation.closure < 1e-9);
  CHECK(s.evaluation.limits.empty());
  CHECK(s.evaluation.stride.highest_toe == Approx(0.075).margin(1e-8));
  CHECK(s.evaluation.cost_j < 1.01 * 2.48746);
  // No parametrisation is cheaper than free torques.
  const Search free = test::found(LegSpring::switched, test::in_place(0.075));
  CHECK(s.evaluation.cost_j > free.evaluation.cost_j);
  CHECK(std::abs(s.evaluation.multipliers.at(0)) > 1.0);
}

TEST_CASE(
    "with 49 parameters the parallel spring and none cost what an independent calculation says, or less",
    "[long]") {
  const Search parallel = test::found(LegSpring::parallel, test::in_place(0.075), true);
  REQUIRE(parallel.gait);
  CHECK(parallel.evaluation.closure < 1e-8);
  CHECK(parallel.evaluation.cost_j < 1.01 * 2.85661);
  const Search none = test::found(LegSpring::none, test::in_place(0.075), true);
  REQUIRE(none.gait);
  CHECK(none.evaluation.closure < 1e-8);
  CHECK(none.evaluation.cost_j < 1.01 * 18.78894);
}
