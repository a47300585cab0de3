// How fast the plant's millisecond is: alone, with a friction law, on numbers that carry derivatives, and
// that of the axes.
#include <benchmark/benchmark.h>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/clutch_designs.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"
#include "host/identify/dual.hpp"
#include "tests/common/dynamics/jet.hpp"

namespace {

using namespace furcula::dynamics;

constexpr double kTickS = 0.001;

/// Seconds simulated in one, a tick an iteration.
void count_times_real_time(benchmark::State& state) {
  state.counters["times_real_time"] =
      benchmark::Counter(kTickS * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

// The example of 002 section 3.2.1, hopping by a constant torque in the direction of the motion.
template <class T>
HopperLinearParameters<T> example() {
  return {T(1.5),  T(600.0), T(0.28190778623577246), T(5.0), T(1.0), T(1.0), T(1.0), T(0.15),
          T(0.35), T(9.81)};
}

template <class T>
void hop(benchmark::State& state, Hopper<T> hopper, const char* what) {
  state.SetLabel(what);
  hopper.reset(T(0.35), T(0.0));
  for (auto _ : state) {
    const bool rises = value_of(hopper.velocity_mps()) > 0.0;
    hopper.advance(T(hopper.in_stance() ? (rises ? -0.5 : 0.5) : 0.0), kTickS);
    benchmark::DoNotOptimize(hopper.height_m());
  }
}

void hopper_step(benchmark::State& state) {
  hop(state, Hopper<double>(example<double>()), "1 ms of the linear hopper");
}
BENCHMARK(hopper_step);

void hopper_step_with_friction(benchmark::State& state) {
  Effects<double> effects;
  effects.set(Effect::stribeck_friction, {0.3, 0.6, 0.1});
  hop(state, Hopper<double>(example<double>(), effects), "1 ms of it with dry friction in the guide");
}
BENCHMARK(hopper_step_with_friction);

/// As a fit runs it: six derivatives beside each value.
template <class T>
void hop_with_derivatives(benchmark::State& state, const char* what) {
  auto p = example<T>();
  int index = 0;
  for (T* free : {&p.mass_kg, &p.stiffness_npm, &p.damping_stance_nspm, &p.damping_flight_nspm})
    *free = T(value_of(*free), index++);
  hop(state, Hopper<T>(p), what);
}
void hopper_step_with_derivatives(benchmark::State& state) {
  hop_with_derivatives<furcula::identify::Dual<6>>(state, "1 ms of it with six derivatives, as fits run it");
}
BENCHMARK(hopper_step_with_derivatives);
/// The peer: Ceres' own numbers.
void hopper_step_with_ceres_jets(benchmark::State& state) {
  hop_with_derivatives<ceres::Jet<double, 6>>(state, "the same by ceres::Jet");
}
BENCHMARK(hopper_step_with_ceres_jets);

/// Table 3.1 of 002; its links in flight and in stance.
HopperNonlinearParameters<double> robot() {
  return {{1.6, 600.0, 0.289, 5.0, 1.0, 1.0, 1.0, 0.15, 0.35, 9.81}, 42e-4, 75e-4, 38e-3};
}
void nonlinear_hopper_step(benchmark::State& state) {
  state.SetLabel("1 ms of the hopper whose links have inertia");
  NonlinearHopper<double> hopper(robot());
  hopper.reset(0.35, 0.0);
  for (auto _ : state) {
    hopper.advance(hopper.in_stance() ? (hopper.velocity_mps() > 0.0 ? -0.6 : 0.6) : 0.0, kTickS);
    benchmark::DoNotOptimize(hopper.height_m());
  }
  count_times_real_time(state);
}
BENCHMARK(nonlinear_hopper_step);

/// Released, folded and caught in each flight.
void clutched_hopper_step(benchmark::State& state) {
  state.SetLabel("1 ms of it with the clutch, released in each flight");
  ClutchedHopper<double> hopper(robot(), Clutch<double>(modular_clutch<double>()));
  hopper.reset(0.35, 0.0);
  int flight = 0;
  for (auto _ : state) {
    flight = hopper.in_stance() ? 0 : flight + 1;
    hopper.set_voltage(flight > 5 && flight < 90 ? 10.0 : 0.0);
    const double pump = hopper.velocity_mps() > 0.0 ? -0.8 : 0.8;
    hopper.advance(hopper.in_stance() ? pump : flight < 40 ? 1.0 : -0.4, kTickS);
    benchmark::DoNotOptimize(hopper.height_m());
  }
  count_times_real_time(state);
}
BENCHMARK(clutched_hopper_step);

void motor_axis_step(benchmark::State& state) {
  state.SetLabel("1 ms of the motor axis, with dry friction");
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
  state.SetLabel("1 ms of the rotary joint");
  RotaryJoint<double> joint({0.05, 2.0, 0.01});
  joint.reset(1.0, 0.0);
  for (auto _ : state) {
    joint.advance(joint.velocity() > 0.0 ? 0.1 : -0.1, kTickS);
    benchmark::DoNotOptimize(joint.position());
  }
}
BENCHMARK(rotary_joint_step);

}  // namespace
