// Derivatives carried through the simulator, event times included, against finite differences.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "host/identify/jet.hpp"
#include "tests/common/dynamics/example.hpp"

using namespace furcula::dynamics;
using Jet = ceres::Jet<double, 4>;

namespace {

template <class T>
HopperLinearParameters<T> in(const HopperLinearParameters<double>& p) {
  HopperLinearParameters<T> out;
  for (std::size_t i = 0; i < p.kMembers.size(); ++i)
    out.*HopperLinearParameters<T>::kMembers[i] = T(p.*HopperLinearParameters<double>::kMembers[i]);
  return out;
}

/// Height after 0.9 s (two touch-downs, two lift-offs, turning points with friction) as a function of four
/// unknowns.
template <class T>
T height_after(const T& mass, const T& damping, const T& friction, const T& restitution) {
  auto p = in<T>(furcula::test::example_hopper());
  p.mass_kg = mass;
  p.damping_stance_nspm = damping;
  p.restitution_touchdown = restitution;
  Effects<T> effects;
  effects.set(Effect::coulomb_friction, 0, friction);
  Hopper<T> hopper(p, effects);
  hopper.reset(T(0.35), T(0.0));
  for (int n = 0; n < 900; ++n) hopper.advance(T(0.8 * std::sin(20.0 * n * 1e-3)), 1e-3);
  return hopper.height_m();
}

}  // namespace

TEST_CASE("The height after several contacts has the derivatives that finite differences give") {
  const double at[4] = {1.55, 6.0, 0.8, 0.93};
  const Jet out = height_after(Jet(at[0], 0), Jet(at[1], 1), Jet(at[2], 2), Jet(at[3], 3));
  CHECK(out.a == height_after(at[0], at[1], at[2], at[3]));
  for (int i = 0; i < 4; ++i) {
    const double step = 1e-6 * at[i];
    double up[4], down[4];
    for (int k = 0; k < 4; ++k) up[k] = down[k] = at[k];
    up[i] += step;
    down[i] -= step;
    const double difference =
        (height_after(up[0], up[1], up[2], up[3]) - height_after(down[0], down[1], down[2], down[3])) /
        (2 * step);
    CAPTURE(i);
    CHECK(out.v[i] == Approx(difference).epsilon(1e-3));
  }
}

TEST_CASE("An axis that dry friction stops has the derivative of its stopping distance") {
  Effects<Jet> effects;
  effects.set(Effect::coulomb_friction, 0, Jet(20.0, 0));
  MotorAxis<Jet> axis({Jet(100.0, 1), Jet(0.0)}, effects);
  axis.reset(Jet(0.0), Jet(0.3, 2));
  for (int n = 0; n < 3000; ++n) axis.advance(Jet(0.0), 1e-3);
  // x = v^2 m / (2 F)
  CHECK(axis.position().v[0] == Approx(-0.09 * 100.0 / (2.0 * 400.0)).epsilon(1e-9));
  CHECK(axis.position().v[1] == Approx(0.09 / 40.0).epsilon(1e-9));
  CHECK(axis.position().v[2] == Approx(0.3 * 100.0 / 20.0).epsilon(1e-9));
}
