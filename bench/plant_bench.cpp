// How fast the plant's millisecond is: alone, with a friction law, on numbers that carry derivatives, and
// that of the axes.
#include <benchmark/benchmark.h>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "host/identify/jet.hpp"

namespace {

using namespace furcula::dynamics;

constexpr double kTickS = 0.001;

// The example of 002 section 3.2.1, hopping by a constant torque in the direction of the motion.
template <class T>
HopperLinearParameters<T> example() {
  return {T(1.5),  T(600.0), T(0.28190778623577246), T(5.0), T(1.0), T(1.0), T(1.0), T(0.15),
          T(0.35), T(9.81)};
}

template <class T>
void hop(benchmark::State& state, Hopper<T> hopper) {
  hopper.reset(T(0.35), T(0.0));
  for (auto _ : state) {
    const bool rises = value_of(hopper.velocity_mps()) > 0.0;
    hopper.advance(T(hopper.in_stance() ? (rises ? -0.5 : 0.5) : 0.0), kTickS);
    benchmark::DoNotOptimize(hopper.height_m());
  }
}

void hopper_step(benchmark::State& state) { hop(state, Hopper<double>(example<double>())); }
BENCHMARK(hopper_step);

void hopper_step_with_friction(benchmark::State& state) {
  Effects<double> effects;
  effects.set(Effect::stribeck_friction, {0.3, 0.6, 0.1});
  hop(state, Hopper<double>(example<double>(), effects));
}
BENCHMARK(hopper_step_with_friction);

/// As a fit runs it: six derivatives beside each value.
void hopper_step_with_derivatives(benchmark::State& state) {
  using Jet = ceres::Jet<double, 6>;
  auto p = example<Jet>();
  int index = 0;
  for (Jet* free : {&p.mass_kg, &p.stiffness_npm, &p.damping_stance_nspm, &p.damping_flight_nspm})
    free->v[index++] = 1.0;
  hop(state, Hopper<Jet>(p));
}
BENCHMARK(hopper_step_with_derivatives);

void motor_axis_step(benchmark::State& state) {
  Effects<double> effects;
  effects.set(Effect::coulomb_friction, {20.0});
  MotorAxis<double> axis({95.0, 200.0}, effects);
  axis.reset(0.0, 0.0);
  for (auto _ : state) {
    axis.advance(axis.position() > 0.0 ? -100.0 : 100.0, kTickS);
    benchmark::DoNotOptimize(axis.position());
  }
}
BENCHMARK(motor_axis_step);

void rotary_joint_step(benchmark::State& state) {
  RotaryJoint<double> joint({0.05, 2.0, 0.01});
  joint.reset(1.0, 0.0);
  for (auto _ : state) {
    joint.advance(joint.velocity() > 0.0 ? 0.1 : -0.1, kTickS);
    benchmark::DoNotOptimize(joint.position());
  }
}
BENCHMARK(rotary_joint_step);

}  // namespace
