// A stride by the integrator of order 8: against the plant of the core, which steps and locates its events in its own
// way, and its derivatives against differences.
#include "host/gait/stride.hpp"

#include <catch2/catch.hpp>
#include <optional>

#include "furcula/dynamics/planar_leg_plant.hpp"
#include "host/identify/dual.hpp"
#include "tests/host/gait/legs.hpp"

using namespace furcula;
using namespace furcula::gait;

namespace {

/// Torques of the state alone, the same in all phases, so that a plant with held torques can follow.
struct Springy {
  template <class T>
  Joints2<T> motors(LegPhase, const T&, double, const Joints2<T>& angle, const Joints2<T>& rate) const {
    return {4.0 * (-0.45 - angle.hip) - 0.3 * rate.hip, 60.0 * (0.9 - angle.knee) - 0.3 * rate.knee};
  }
  static std::vector<double> breaks(LegPhase) { return {}; }
};

Apex<double> start() { return {0.66, 0.05, {-0.45, 0.9}, {0.0, 0.0}}; }

}  // namespace

TEST_CASE("a stride is that of the core's plant, event by event") {
  for (const LegSpring spring : {LegSpring::switched, LegSpring::parallel}) {
    const Machine machine = spear(spring);
    const Springy law;
    StrideOptions options;
    const StrideEnd<double> e = run_stride<double>(machine, law, law, start(), options);
    INFO(e.why);
    REQUIRE(e.whole);

    using Plant = dynamics::PlanarLeg<double>;
    Plant plant(machine.leg, spring, LegLiftOff::force);
    const Apex<double> a = start();
    plant.reset({0.0, a.height}, {a.speed, 0.0}, a.angle, a.rate);
    constexpr double kStep = 2e-5;
    double t = 0.0, landed = 0.0, left = 0.0, apex = 0.0;
    for (; apex == 0.0 && t < 2.0; t += kStep) {
      plant.advance(law.motors<double>(LegPhase::rise, 0.0, 0.0, plant.angle_rad(), plant.rate_radps()),
                    kStep);
      for (const auto& event : plant.events()) {
        if (event.kind == Plant::Event::Kind::touchdown) landed = t + event.offset_s;
        if (event.kind == Plant::Event::Kind::liftoff) left = t + event.offset_s;
        if (event.kind == Plant::Event::Kind::apex) apex = t + event.offset_s;
      }
    }
    // The plant's torques are held over a step of 20 us.
    CHECK(e.fall == Approx(landed).margin(2e-5));
    CHECK(e.fall + e.stance == Approx(left).margin(1e-4));
    CHECK(e.fall + e.stance + e.rise == Approx(apex).margin(2e-4));
    CHECK(e.apex.height == Approx(plant.hip_m().y).margin(1e-4));
    CHECK(e.distance == Approx(plant.hip_m().x).margin(1e-4));
  }
}

TEST_CASE("a stride's end is that of steps of a quarter to 1e-9") {
  const Machine machine = spear(LegSpring::switched);
  const Springy law;
  StrideOptions options;
  options.longest_step_s = 4e-3;
  const auto coarse = run_stride<double>(machine, law, law, start(), options);
  options.longest_step_s = 1e-3;
  const auto fine = run_stride<double>(machine, law, law, start(), options);
  REQUIRE(coarse.whole);
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(coarse.apex.values()[i] == Approx(fine.apex.values()[i]).margin(1e-9));
  CHECK(coarse.electric == Approx(fine.electric).margin(1e-8));
}

TEST_CASE("energies are the sums of the moments' powers, however often these change their signs in a step") {
  const Machine machine = spear(LegSpring::switched);
  // Torques that swing with a period of 31 ms beside those of Springy.
  struct Shaken : Springy {
    static double swing(double time) { return std::sin(200.0 * time); }
    Joints2<double> motors(LegPhase phase, double time, double middle, const Joints2<double>& angle,
                           const Joints2<double>& rate) const {
      Joints2<double> u = Springy::motors<double>(phase, time, middle, angle, rate);
      u.hip += 4.0 * swing(time);
      u.knee += 6.0 * swing(time);
      return u;
    }
  };
  const Shaken law;
  StrideOptions options;
  const auto coarse = run_stride<double>(machine, law, law, start(), options);
  REQUIRE(coarse.whole);
  // The trapezoid's rule over moments that lie close together; events have one moment on each side.
  const Joints2<double> heat = machine.motors.heat();
  const auto powers = [&](const Moment& m) {
    const auto positive = [](double p) { return std::max(p, 0.0); };
    const auto &u = m.torque, &w = m.rate;
    const double motor = u.hip * w.hip + u.knee * w.knee;
    return std::array{
        positive(u.hip * (heat.hip * u.hip + w.hip)) + positive(u.knee * (heat.knee * u.knee + w.knee)),
        positive(motor), positive(motor + m.spring_nm * w.knee)};
  };
  std::array<double, 3> sums{};
  std::optional<Moment> before;
  options.longest_step_s = 1e-5;
  options.moment = [&](const Moment& m) {
    if (before) {
      const auto a = powers(*before), b = powers(m);
      for (std::size_t i = 0; i < 3; ++i) sums[i] += 0.5 * (m.time_s - before->time_s) * (a[i] + b[i]);
    }
    before = m;
  };
  run_stride<double>(machine, law, law, start(), options);
  CHECK(coarse.electric == Approx(sums[0]).epsilon(2e-5));
  CHECK(coarse.motor == Approx(sums[1]).epsilon(2e-5));
  CHECK(coarse.joint == Approx(sums[2]).epsilon(2e-5));
}

TEST_CASE("without a feedback a step of the stance may be three times as long") {
  const Machine machine = spear(LegSpring::switched);
  // Torques over time in stance.
  struct Timed : Springy {
    Joints2<double> motors(LegPhase phase, double time, double middle, const Joints2<double>& angle,
                           const Joints2<double>& rate) const {
      if (phase != LegPhase::stance) return Springy::motors<double>(phase, time, middle, angle, rate);
      return {3.0 * std::sin(9.0 * time), 2.0 * std::cos(17.0 * time)};
    }
  };
  const Timed law;
  StrideOptions options;
  const auto fine = run_stride<double>(machine, law, law, start(), options);
  options.stance_step_s = 12e-3;
  const auto coarse = run_stride<double>(machine, law, law, start(), options);
  REQUIRE(coarse.whole);
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(coarse.apex.values()[i] == Approx(fine.apex.values()[i]).margin(1e-9));
}

TEST_CASE("derivatives of a stride pass through touch-down, lift-off and apex") {
  using Number = identify::Dual<6>;
  for (const LegSpring spring : {LegSpring::switched, LegSpring::parallel}) {
    const Machine machine = spear(spring);
    const Springy law;
    StrideOptions options;
    options.energies = false;
    options.longest_step_s = 1e-3;
    std::array<Number, 6> z;
    for (std::size_t i = 0; i < 6; ++i) z[i] = Number(start().values()[i], static_cast<int>(i));
    const auto with = run_stride<Number>(machine, law, law, Apex<Number>::of(z), options);
    REQUIRE(with.whole);
    for (std::size_t k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-5;
      auto up = start().values(), down = up;
      up[k] += kStep;
      down[k] -= kStep;
      const auto a = run_stride<double>(machine, law, law, Apex<double>::of(up), options);
      const auto b = run_stride<double>(machine, law, law, Apex<double>::of(down), options);
      for (std::size_t i = 0; i < 6; ++i)
        CHECK(with.apex.values()[i].derivative(k) ==
              Approx((a.apex.values()[i] - b.apex.values()[i]) / (2.0 * kStep)).epsilon(2e-5).margin(2e-5));
      CHECK(with.stance.derivative(k) ==
            Approx((a.stance - b.stance) / (2.0 * kStep)).epsilon(2e-5).margin(2e-5));
    }
  }
}

TEST_CASE("a toe that starts under the ground makes no stride") {
  const Machine machine = spear(LegSpring::switched);
  const Springy law;
  Apex<double> low = start();
  low.height = 0.3;
  const auto e = run_stride<double>(machine, law, law, low, {});
  CHECK_FALSE(e.whole);
  CHECK(std::string(e.why) != "");
}
