// What is fitted to a joint's equation, against cases that are known in closed form.
#include "host/conventions/equation.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula::conventions;

namespace {

constexpr double kMass = 3.0;

/// mass x acceleration = input, under two sines; the logged input is `scale` times the true one. The mass may be a quarter to four times.
Equation pushed(double scale, double friction_n = 0.0) {
  Equation e;
  e.columns = {
      {{}, 0.0, 1e9, true}, {{}, 0.0, 1e9, true}, {{}, -0.75 * kMass, 3.0 * kMass}, {{}, -1e9, 1e9, true}};
  for (int i = 0; i < 500; ++i) {
    const double t = 0.01 * i;
    const double a = 4.0 * std::sin(3.0 * t) + 2.0 * std::sin(7.7 * t);
    const double v = -4.0 / 3.0 * std::cos(3.0 * t) - 2.0 / 7.7 * std::cos(7.7 * t);
    e.needed.push_back(kMass * a);
    e.given.push_back(scale * (kMass * a + (v > 0.0 ? friction_n : -friction_n)));
    e.of_drive.push_back(0.0);
    e.passive.push_back(0.0);
    e.columns[kCoulomb].values.push_back(v > 0.0 ? 1.0 : -1.0);
    e.columns[kViscous].values.push_back(v);
    e.columns[kRotor].values.push_back(a);
    e.columns[kConstant].values.push_back(1.0);
    e.rotor_share += 1.0 / kMass;
  }
  return e;
}

}  // namespace

TEST_CASE("Where the inertia and an input's scale undo each other, the inertia stays as it is") {
  for (const double scale : {1.0, 1000.0, -0.2}) {
    const Rest r = pushed(scale).solve({1.0, true});
    CHECK(r.input_scale == Approx(1.0 / scale).epsilon(1e-6));
    CHECK(r.inertia == Approx(0.0).margin(1e-6 * kMass));
    CHECK(r.inertia_factor == Approx(1.0).epsilon(1e-6));
  }
}

TEST_CASE("Friction is fitted up to its bound, and beyond it as a cause of the catalogue") {
  const double rms = kMass * std::sqrt(8.0 + 2.0);
  const Rest small = pushed(1.0, 0.1 * rms).solve({});
  CHECK(std::sqrt(small.mean_square) < 1e-3 * rms);
  const Equation large = pushed(1.0, 0.8 * rms);
  CHECK(std::sqrt(large.solve({}).mean_square) > 0.1 * rms);
  CHECK(std::sqrt(large.solve({}, true).mean_square) < 1e-3 * rms);
}
