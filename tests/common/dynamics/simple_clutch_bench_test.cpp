// The release/catch bench of two delays against free fall, teeth counted by hand, and the energy that skipped
// teeth take.
#include "furcula/dynamics/simple_clutch_bench.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;

namespace {

constexpr double kRadius_m = 60e-3 / 6.283185307179586;  // 20 teeth of 3 mm

ClutchBenchParameters<double> bench() { return {1.0, kRadius_m, 2e-6, 0.0, 0.0, 3e-3, 1.8e-3, 6e-3, 9e-3}; }

double inertia(const ClutchBenchParameters<double>& p) {
  return p.load_mass_kg * p.pulley_radius_m * p.pulley_radius_m + p.pulley_inertia_kgm2;
}
/// Of the belt in free fall, with the pulley turning along, m/s^2.
double fall(const ClutchBenchParameters<double>& p) {
  return p.load_mass_kg * 9.81 * p.pulley_radius_m * p.pulley_radius_m / inertia(p);
}

/// Rests 20 ms, is released for `window_s`, and watched for `then_s`, a millisecond a step.
template <class T>
void release(SimpleClutchBench<T>& b, double window_s, double then_s = 0.2) {
  const auto run = [&](double input, double for_s) {
    for (int i = 0; i < static_cast<int>(std::lround(for_s * 1e3)); ++i) b.advance(T(input), 1e-3);
  };
  run(0.0, 0.02);
  run(1.0, window_s);
  run(0.0, then_s);
}

double drop_m(const ClutchBenchParameters<double>& p, double window_s, const Effects<double>& e = {}) {
  SimpleClutchBench<double> b(p, e);
  b.reset(0.0);
  release(b, window_s);
  CHECK(b.held());
  CHECK(b.velocity() == 0.0);
  return b.position() * p.pulley_radius_m;
}

}  // namespace

TEST_CASE("A belt let go falls as the weight with the pulley's inertia says, from the release delay on") {
  const auto p = bench();
  SimpleClutchBench<double> b(p);
  b.reset(0.3);
  for (int i = 0; i < 5; ++i) b.advance(1.0, 1e-3);
  CHECK(b.position() == 0.3);
  CHECK(b.held());
  for (int i = 0; i < 31; ++i) b.advance(1.0, 1e-3);
  const double fallen_s = 36e-3 - p.release_delay_s;
  CHECK((b.position() - 0.3) * kRadius_m == Approx(0.5 * fall(p) * fallen_s * fallen_s).epsilon(1e-9));
  CHECK(b.velocity() * kRadius_m == Approx(fall(p) * fallen_s).epsilon(1e-9));
}

TEST_CASE("A viscous friction brings the falling belt to the speed at which it bears the weight") {
  auto p = bench();
  p.damping_nmspr = 0.05;
  SimpleClutchBench<double> b(p);
  b.reset(0.0);
  for (int i = 0; i < 500; ++i) b.advance(1.0, 1e-3);
  CHECK(b.velocity() == Approx(9.81 * kRadius_m / 0.05).epsilon(1e-6));
}

TEST_CASE("The belt is held at the tooth after the one that it passed when the key came") {
  const auto p = bench();
  for (double window_s : {0.020, 0.030, 0.035, 0.040, 0.052, 0.060}) {
    const double fallen_s = window_s + p.catch_delay_s - p.release_delay_s;
    const double free_m = 0.5 * fall(p) * fallen_s * fallen_s;
    CAPTURE(window_s);
    CHECK(drop_m(p, window_s) == Approx(p.tooth_pitch_m * std::ceil(free_m / p.tooth_pitch_m)).epsilon(1e-9));
  }
}

TEST_CASE("A pulse that ends before the key is out moves nothing, and one released again falls on") {
  auto p = bench();
  p.release_delay_s = 0.02;
  CHECK(drop_m(p, 0.010) == 0.0);  // back after 10 + 9 ms
  p = bench();
  SimpleClutchBench<double> b(p);
  b.reset(0.0);
  release(b, 0.030, 0.004);  // off for 4 ms of the catch delay's 9
  for (int i = 0; i < 20; ++i) b.advance(1.0, 1e-3);
  CHECK_FALSE(b.held());
  const double fallen_s = 0.054 - p.release_delay_s;
  CHECK(b.position() * kRadius_m == Approx(0.5 * fall(p) * fallen_s * fallen_s).epsilon(1e-9));
}

TEST_CASE("The auxiliary spring stops and turns the belt, which is then held on its way back") {
  auto p = bench();
  p.auxiliary_stiffness_npm = 3000.0;
  const double rate = std::sqrt(3000.0 * kRadius_m * kRadius_m / inertia(p));
  const double middle_m = 9.81 / 3000.0;
  SimpleClutchBench<double> b(p);
  b.reset(0.0);
  for (int i = 0; i < 70; ++i) b.advance(1.0, 1e-3);
  CHECK(b.position() * kRadius_m == Approx(middle_m * (1.0 - std::cos(rate * 0.064))).epsilon(1e-8));
  CHECK(b.velocity() < 0.0);
  for (int i = 0; i < 100; ++i) b.advance(0.0, 1e-3);
  const double at_key_m = middle_m * (1.0 - std::cos(rate * 0.073));
  CHECK(b.held());
  CHECK(b.position() * kRadius_m == Approx(3e-3 * std::floor(at_key_m / 3e-3)).margin(1e-9));
}

TEST_CASE("A clutch that slips takes its holding force times the pitch at each tooth that it skips") {
  const auto p = bench();
  Effects<double> slips;
  const double holding_n = 20.0;
  slips.set(Effect::clutch_slip, 0, holding_n);
  for (double window_s : {0.03, 0.04, 0.06}) {
    CAPTURE(window_s);
    // Where it would be held, and how fast it comes there.
    const double first_m = drop_m(p, window_s);
    double energy_j = p.load_mass_kg * 9.81 * first_m;
    double drop = first_m;
    while (holding_n < 9.81 + energy_j / p.tooth_pitch_m) {
      energy_j += (9.81 - holding_n) * p.tooth_pitch_m;
      drop += p.tooth_pitch_m;
    }
    CHECK(drop_m(p, window_s, slips) == Approx(drop).epsilon(1e-9));
    SimpleClutchBench<double> b(p, slips);
    b.reset(0.0);
    release(b, window_s);
    CHECK(b.skipped_teeth() == std::lround((drop - first_m) / p.tooth_pitch_m));
  }
  // Between two teeth: speed^2 falls by 2 (holding - weight) pitch over the moving mass.
  SimpleClutchBench<double> b(p, slips);
  b.reset(0.0);
  std::vector<double> at_m, speed;
  release(b, 0.060, 0.0);
  std::uint32_t teeth = 0;
  for (int i = 0; i < 200000 && !b.held(); ++i) {
    b.advance(0.0, 1e-6);
    if (b.skipped_teeth() == teeth) continue;
    teeth = b.skipped_teeth();
    at_m.push_back(b.position() * kRadius_m);
    speed.push_back(b.velocity());
  }
  REQUIRE(speed.size() >= 3);
  const double lost_j = 0.5 * inertia(p) * (speed[0] * speed[0] - speed[1] * speed[1]);
  CHECK(lost_j == Approx((holding_n - 9.81) * (at_m[1] - at_m[0])).epsilon(1e-4));
}

TEST_CASE(
    "A clutch that slips upwards takes its holding force times the pitch from what the spring gives back") {
  // The auxiliary spring throws the weight back up; the key comes on the way. Up to a tooth the energy is that of weight and spring from
  // rest at the top, and each tooth that is skipped takes the holding force times the pitch of it.
  auto p = bench();
  p.auxiliary_stiffness_npm = 3000.0;
  p.tooth_pitch_m = 1e-3;
  const auto free_j = [&](double down_m) { return 9.81 * down_m - 0.5 * 3000.0 * down_m * down_m; };
  for (const double holding_n : {9.0, 11.0, 14.0}) {
    CAPTURE(holding_n);
    Effects<double> slips;
    slips.set(Effect::clutch_slip, 0, holding_n);
    SimpleClutchBench<double> b(p, slips);
    b.reset(0.0);
    for (int i = 0; i < 66; ++i) b.advance(1.0, 1e-3);
    double lowest_m = 0.0;
    std::uint32_t teeth = 0;
    std::vector<double> at_m, energy_j;  // where each skip began, and the kinetic energy then
    for (int i = 0; i < 200000 && !b.held(); ++i) {
      const double before = b.position() * kRadius_m;
      b.advance(0.0, 1e-6);
      lowest_m = std::max(lowest_m, b.position() * kRadius_m);
      if (b.skipped_teeth() == teeth) continue;
      teeth = b.skipped_teeth();
      at_m.push_back(1e-3 * std::round(before / 1e-3));
      energy_j.push_back(0.5 * inertia(p) * b.velocity() * b.velocity());
      CHECK(b.velocity() < 0.0);
    }
    REQUIRE(teeth >= 1);
    CHECK(b.held());
    CHECK(at_m.front() < lowest_m);
    const double upward_n = 3000.0 * (at_m.back() - 1.5e-3) - 9.81,
                 left_j = free_j(at_m.back() - 1e-3) - holding_n * 1e-3 * teeth;
    CHECK(b.position() * kRadius_m == Approx(at_m.back() - 1e-3).margin(1e-9));  // one tooth further up
    CHECK(holding_n >= upward_n + left_j / 1e-3);
    for (std::size_t i = 0; i < at_m.size(); ++i) {
      const double taken_j = holding_n * 1e-3 * static_cast<double>(i);
      CHECK(energy_j[i] == Approx(free_j(at_m[i]) - taken_j).margin(2e-5));
      // It could not have been held there: pull in the middle of the way up, and the energy over the pitch.
      const double pull_n = 3000.0 * (at_m[i] - 0.5e-3) - 9.81;
      CHECK(holding_n < pull_n + (free_j(at_m[i]) - taken_j) / 1e-3);
    }
  }
}

TEST_CASE("A bench that is reset counts its teeth anew") {
  const auto p = bench();
  Effects<double> slips;
  slips.set(Effect::clutch_slip, 0, 9.0);
  SimpleClutchBench<double> used(p, slips), fresh(p, slips);
  used.reset(0.0);
  for (int i = 0; i < 300; ++i) used.advance(0.0, 1e-3);
  used.reset(0.0);
  fresh.reset(0.0);
  for (int i = 0; i < 300; ++i) {
    used.advance(0.0, 1e-3);
    fresh.advance(0.0, 1e-3);
  }
  CHECK(used.position() == fresh.position());
  CHECK(used.skipped_teeth() == fresh.skipped_teeth());
}

TEST_CASE("A clutch that holds less than the weight slips from the start, and one that holds more does not") {
  const auto p = bench();
  for (double holding_n : {9.0, 10.0}) {
    Effects<double> slips;
    slips.set(Effect::clutch_slip, 0, holding_n);
    SimpleClutchBench<double> b(p, slips);
    b.reset(0.0);
    for (int i = 0; i < 100; ++i) b.advance(0.0, 1e-3);
    CHECK(b.held() == (holding_n > 9.81));
    const double acceleration = (9.81 - holding_n) * kRadius_m * kRadius_m / inertia(p);
    CHECK(b.position() * kRadius_m ==
          Approx(holding_n > 9.81 ? 0.0 : 0.5 * acceleration * 0.01).margin(1e-9));
  }
}

TEST_CASE("A late catch and the auxiliary spring's true rate take the place of the model's") {
  auto p = bench();
  Effects<double> e;
  e.set(Effect::late_catch, 0, 0.021);
  auto late = p;
  late.catch_delay_s = 0.021;
  CHECK(drop_m(p, 0.04, e) == drop_m(late, 0.04));
  CHECK(drop_m(p, 0.04, e) > drop_m(p, 0.04));
  Effects<double> spring;
  spring.set(Effect::auxiliary_spring, 0, 200.0);
  auto sprung = p;
  sprung.auxiliary_stiffness_npm = 200.0;
  CHECK(drop_m(p, 0.06, spring) == drop_m(sprung, 0.06));
}

TEST_CASE("Dry friction of the pulley takes its torque from the weight's") {
  const auto p = bench();
  Effects<double> e;
  e.set(Effect::coulomb_friction, 0, 0.25 * 9.81 * kRadius_m);
  SimpleClutchBench<double> b(p, e);
  b.reset(0.0);
  for (int i = 0; i < 46; ++i) b.advance(1.0, 1e-3);
  CHECK(b.position() * kRadius_m == Approx(0.5 * 0.75 * fall(p) * 0.04 * 0.04).epsilon(1e-9));
}

TEST_CASE("Where the belt is depends on mass, friction, release delay and pitch as differences say") {
  using Jet = ceres::Jet<double, 9>;
  auto p = bench();
  p.damping_nmspr = 1e-3;
  p.auxiliary_stiffness_npm = 50.0;
  const auto run = [](auto parameters, double holding_n, int steps) {
    using T = decltype(parameters.load_mass_kg);
    Effects<T> e;
    if (holding_n > 0.0) e.set(Effect::clutch_slip, 0, T(holding_n));
    SimpleClutchBench<T> b(parameters, e);
    b.reset(T(0.1));
    for (int i = 0; i < steps; ++i) b.advance(T(i >= 20 && i < 62 ? 1.0 : 0.0), 1e-3);
    return b.position();
  };
  for (double holding_n : {0.0, 25.0})
    for (int steps : {45, 72, 78, 200}) {
      ClutchBenchParameters<Jet> jets;
      for (int k = 0; k < 9; ++k)
        jets.*ClutchBenchParameters<Jet>::kMembers[static_cast<std::size_t>(k)] =
            Jet(p.*ClutchBenchParameters<double>::kMembers[static_cast<std::size_t>(k)], k);
      const Jet at = run(jets, holding_n, steps);
      for (int k = 0; k < 9; ++k) {
        const auto member = ClutchBenchParameters<double>::kMembers[static_cast<std::size_t>(k)];
        const double h = 1e-6 * std::max(p.*member, 1e-6);
        auto more = p, less = p;
        more.*member += h;
        less.*member -= h;
        CAPTURE(holding_n, steps, k);
        const double slope = (run(more, holding_n, steps) - run(less, holding_n, steps)) / (2.0 * h);
        CHECK(at.v[k] ==
              Approx(slope).epsilon(1e-4).margin(1e-4 * std::abs(at.a) / std::max(p.*member, 1e-6)));
      }
    }
}

TEST_CASE("The bench runs in single precision as on a host, to its rounding") {
  const auto p = bench();
  ClutchBenchParameters<float> f;
  for (std::size_t k = 0; k < 9; ++k)
    f.*ClutchBenchParameters<float>::kMembers[k] =
        static_cast<float>(p.*ClutchBenchParameters<double>::kMembers[k]);
  SimpleClutchBench<float> b(f);
  b.reset(0.0f);
  for (int i = 0; i < 200; ++i) b.advance(i >= 20 && i < 60 ? 1.0f : 0.0f, 1e-3f);
  CHECK(b.held());
  CHECK(b.position() * f.pulley_radius_m == Approx(drop_m(p, 0.04)).epsilon(1e-5));
}
