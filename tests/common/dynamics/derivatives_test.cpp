// Derivatives carried through the simulator, event times included, against finite differences.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/clutch_designs.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"
#include "tests/common/dynamics/example.hpp"
#include "tests/common/dynamics/jet.hpp"

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

namespace {

/// Height of the robot with a clutch after a hop with the leg folded in flight, by mass, stance damping,
/// inertia e and auxiliary stiffness.
template <class T>
T clutched_height_after(const T& mass, const T& damping, const T& inertia_e, const T& auxiliary) {
  HopperNonlinearParameters<T> p;
  p.mass_kg = mass;
  p.stiffness_npm = T(600.0);
  p.rest_height_m = T(0.289);
  p.damping_stance_nspm = damping;
  p.damping_flight_nspm = T(1.0);
  p.restitution_touchdown = p.restitution_liftoff = T(1.0);
  p.link_length_m = T(0.15);
  p.touchdown_angle_rad = T(0.349);
  p.gravity_mps2 = T(9.81);
  p.inertia_a_kgm2 = T(42e-4);
  p.inertia_b_kgm = T(75e-4);
  p.inertia_e_kgm = inertia_e;
  auto clutch = modular_clutch<T>();
  clutch.auxiliary_stiffness_npm = auxiliary;
  ClutchedHopper<T> robot(p, Clutch<T>(clutch));
  robot.reset(T(0.36), T(0.0));
  for (int n = 0; n < 420; ++n) {
    robot.set_voltage(T(n < 80 || (n > 330 && n < 400) ? 10.0 : 0.0));
    robot.advance(T(n < 40 || (n > 350 && n < 390) ? 0.6 : 0.0), ValueOf<T>(1e-3));
  }
  return robot.height_m();
}

}  // namespace

TEST_CASE("The robot with a clutch carries derivatives through release, catch and contacts") {
  const double at[4] = {2.5, 6.0, 0.038, 20.0};
  const Jet out = clutched_height_after(Jet(at[0], 0), Jet(at[1], 1), Jet(at[2], 2), Jet(at[3], 3));
  CHECK(out.a == Approx(clutched_height_after(at[0], at[1], at[2], at[3])).epsilon(1e-12));
  for (int i = 0; i < 4; ++i) {
    const double step = 1e-4 * at[i];  // a smaller one sees the integrator's own steps
    double up[4], down[4];
    for (int k = 0; k < 4; ++k) up[k] = down[k] = at[k];
    up[i] += step;
    down[i] -= step;
    const double difference = (clutched_height_after(up[0], up[1], up[2], up[3]) -
                               clutched_height_after(down[0], down[1], down[2], down[3])) /
                              (2 * step);
    CAPTURE(i, out.v[i], difference);
    CHECK(out.v[i] == Approx(difference).epsilon(5e-3).margin(1e-8));
  }
}

TEST_CASE("In single precision the robot with a clutch hops the same") {
  const double exact = clutched_height_after(2.5, 6.0, 0.038, 20.0);
  CHECK(static_cast<double>(clutched_height_after(2.5F, 6.0F, 0.038F, 20.0F)) == Approx(exact).margin(1e-4));
}
