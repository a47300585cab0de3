// Derivatives by the parameters of every effect through some hops, against finite differences.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "tests/common/dynamics/example.hpp"
#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;
using Jet = ceres::Jet<double, 3>;

namespace {

/// Heights after some hops, weighed: a number that everything moves.
template <class T>
T hops(const Effects<T>& effects, double step) {
  const auto d = furcula::test::example_hopper();
  HopperLinearParameters<T> p;
  for (std::size_t i = 0; i < d.kMembers.size(); ++i)
    p.*HopperLinearParameters<T>::kMembers[i] = T(d.*HopperLinearParameters<double>::kMembers[i]);
  p.rest_height_m = T(0.289);
  p.restitution_touchdown = T(0.92);
  p.restitution_liftoff = T(0.97);
  Hopper<T> hopper(p, effects);
  hopper.reset(T(0.34), T(0.0));
  T sum = T(0.0);
  const int steps = static_cast<int>(std::lround(0.8 / step)),
            held = static_cast<int>(std::lround(4e-3 / step));
  for (int n = 0; n < steps; ++n) {
    const int command = n / held;  // of 4 ms each
    hopper.advance(T(1.2 * std::sin(0.021 * command * 4)), step);
    sum += hopper.height_m() * (step * (1.0 + n * step)) + hopper.leg_angle_rad() * (0.1 * step);
  }
  return sum;
}

template <class T>
T swings(const Effects<T>& effects, double step) {
  RotaryJoint<T> joint({T(0.02), T(0.9), T(0.01)}, effects);
  joint.reset(T(0.3), T(0.0));
  T sum = T(0.0);
  for (int n = 0; n < static_cast<int>(std::lround(1.0 / step)); ++n) {
    joint.advance(T(0.5 * std::sin(9.0 * n * step)), step);
    sum += joint.position() * (step * (1.0 + n * step));
  }
  return sum;
}

struct Case {
  Effect effect;
  std::vector<double> at;
};

/// The plant's derivative leaves out how an event's instant moves the midpoint at which the rest of that step
/// takes its forces: a share of the step, so that it must halve with it.
template <class Run>
void check(const Case& c, const Run& run, double within) {
  CAPTURE(std::string(info(c.effect).name));
  Effects<Jet> jets;
  Effects<double> values;
  for (std::size_t i = 0; i < c.at.size(); ++i) {
    jets.set(c.effect, i, Jet(c.at[i], static_cast<int>(i)));
    values.set(c.effect, i, c.at[i]);
  }
  const double step = 1e-3;
  const Jet out = run(jets, step);
  CHECK(out.a == Approx(run(values, step)).epsilon(1e-13));
  for (std::size_t i = 0; i < c.at.size(); ++i) {
    CAPTURE(i);
    const double width = 1e-6 * std::max(std::abs(c.at[i]), 1e-3);
    Effects<double> up = values, down = values;
    up.set(c.effect, i, c.at[i] + width);
    down.set(c.effect, i, c.at[i] - width);
    const double difference = (run(up, step) - run(down, step)) / (2 * width);
    CHECK(out.v[static_cast<int>(i)] == Approx(difference).epsilon(within).margin(1e-9));
  }
}

}  // namespace

TEST_CASE("Hops have the derivatives by each effect's parameters that finite differences give") {
  const std::vector<Case> cases{
      {Effect::binding_spot, {2.0, 0.301, 0.011}},
      {Effect::damping_error, {1.3}},
      {Effect::guide_tilt, {0.2}},
      {Effect::mass_error, {1.61}},
      {Effect::rest_height_error, {0.2913}},
      {Effect::spring_preload, {1.7}},
      {Effect::spring_hardening, {4e5}},
      {Effect::spring_hysteresis, {0.06}},
      {Effect::leg_inertia, {42e-4, 75e-4, 38e-3}},
      {Effect::torque_ripple, {0.3, 14.0, 0.6}},
      {Effect::backlash, {0.05}},
      {Effect::touchdown_loss, {0.9}},
      {Effect::liftoff_loss, {0.9}},
      {Effect::ground_compliance, {6000.0, 30.0}},
      {Effect::toe_sticking, {9.0}},
      {Effect::bump_stop, {0.041, 2500.0}},
  };
  for (const Case& c : cases)
    check(
        c, [](const auto& effects, double step) { return hops(effects, step); }, 1e-5);
}

TEST_CASE("A swinging joint has the derivatives by each effect's parameters that finite differences give") {
  const std::vector<Case> cases{
      {Effect::coulomb_friction, {0.05}},
      {Effect::stribeck_friction, {0.03, 0.06, 0.7}},
      {Effect::binding_spot, {0.2, 0.05, 0.11}},
      {Effect::damping_error, {0.03}},
      {Effect::mass_error, {0.021}},
      {Effect::torque_ripple, {0.1, 14.0, 0.6}},
      {Effect::backlash, {0.05}},
  };
  for (const Case& c : cases)
    check(
        c, [](const auto& effects, double step) { return swings(effects, step); }, 1e-5);
}
