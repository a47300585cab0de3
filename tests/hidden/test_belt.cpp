// The virtual clutch bench against free fall, teeth and energy.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/hidden/belt.hpp"

using namespace furcula::hidden;

namespace {

constexpr double kRadius_m = 9.5e-3, kInertia = 1.2 * kRadius_m * kRadius_m + 3e-6;
constexpr double kFall_mps2 = 1.2 * 9.81 * kRadius_m * kRadius_m / kInertia;

Truth bench(std::vector<Planted> planted = {}) {
  return {*furcula::dynamics::kind_named("clutch_bench"),
          {1.2, kRadius_m, 3e-6, 0.0, 0.0, 3e-3, 1.8e-3, 8e-3, 10e-3},
          std::move(planted)};
}

/// Where a belt that falls for so long is held, m.
double drop_m(double fall_s, std::vector<Planted> planted, int* skipped = nullptr) {
  Belt b(bench(std::move(planted)));
  b.pull_key();
  b.advance(fall_s);
  b.press_key();
  b.advance(fall_s + 0.3);
  CHECK(b.held());
  if (skipped) *skipped = b.skipped();
  return b.angle_rad() * kRadius_m;
}

}  // namespace

TEST_CASE("The virtual belt falls as its weight and pulley say, and rests at the next tooth") {
  for (double fall_s : {0.02, 0.033, 0.05}) {
    Belt b(bench());
    b.pull_key();
    b.advance(fall_s);
    const double fallen_m = 0.5 * kFall_mps2 * fall_s * fall_s;
    CHECK(b.angle_rad() * kRadius_m == Approx(fallen_m).epsilon(1e-9));
    CHECK(drop_m(fall_s, {}) == Approx(3e-3 * std::ceil(fallen_m / 3e-3)).epsilon(1e-9));
  }
}

TEST_CASE("A random torque moves the virtual belt by its double integral") {
  Truth t = bench();
  t.disturbance = {.force = 0.02, .correlation_s = 0.02};
  t.draw = 11;
  const Disturbed d(t.disturbance, t.draw);
  Belt b(t);
  b.pull_key();
  b.advance(0.05);
  double speed = 0, moved = 0;
  constexpr double kH = 1e-5;
  for (double now = 0; now < 0.05 - kH / 2; now += kH) {
    moved += kH * speed;
    speed += kH * d.force(now) / kInertia;
  }
  const double fallen_rad = 0.5 * kFall_mps2 * 0.05 * 0.05 / kRadius_m;
  CHECK(std::abs(moved) > 1e-2 * fallen_rad);
  CHECK(b.angle_rad() - fallen_rad == Approx(moved).epsilon(0.02));
}

TEST_CASE("A slipping virtual belt skips the teeth that its energy takes it over") {
  const double holding_n = 24.0, weight_n = 1.2 * 9.81;
  for (double fall_s : {0.03, 0.045, 0.06}) {
    const double first_m = drop_m(fall_s, {});
    double energy_j = weight_n * first_m;
    int teeth = 0, skipped = -1;
    for (; holding_n < weight_n + energy_j / 3e-3; ++teeth) energy_j += (weight_n - holding_n) * 3e-3;
    CHECK(drop_m(fall_s, {{"clutch_slip", {holding_n}}}, &skipped) ==
          Approx(first_m + teeth * 3e-3).epsilon(1e-9));
    CHECK(skipped == teeth);
    CHECK(teeth > 0);
  }
}

TEST_CASE("Friction and auxiliary spring of the virtual belt are those of closed forms") {
  Belt rubs(bench({{"coulomb_friction", {0.3 * 1.2 * 9.81 * kRadius_m}}}));
  rubs.pull_key();
  rubs.advance(0.04);
  CHECK(rubs.angle_rad() * kRadius_m == Approx(0.5 * 0.7 * kFall_mps2 * 1.6e-3).epsilon(1e-8));
  Belt sprung(bench({{"auxiliary_spring", {800.0}}}));
  sprung.pull_key();
  sprung.advance(0.04);
  const double rate = std::sqrt(800.0 * kRadius_m * kRadius_m / kInertia);
  CHECK(sprung.angle_rad() * kRadius_m ==
        Approx(1.2 * 9.81 / 800.0 * (1.0 - std::cos(rate * 0.04))).epsilon(1e-8));
}

TEST_CASE("The bench's log has the key's delays in it") {
  BenchExperiment e{{0.04, 0.03}, 0.3};
  BenchSensors ideal;
  ideal.quantum_rad = 1e-9;
  Random random(5);
  const auto log = record_bench(bench({{"late_catch", {0.02}}}), e, ideal, random);
  const auto& angle = log.at("pulley_angle_rad");
  const auto& coil = log.at("solenoid");
  CHECK(coil[299] == 0.0);
  CHECK(coil[300] == 1.0);
  CHECK(coil[339] == 1.0);
  CHECK(coil[340] == 0.0);
  CHECK(angle[308] == Approx(0.0).margin(2e-9));
  CHECK(angle[330] * kRadius_m == Approx(0.5 * kFall_mps2 * 0.022 * 0.022).epsilon(1e-6));
  const double fallen_m = 0.5 * kFall_mps2 * 0.052 * 0.052;
  CHECK(angle[600] * kRadius_m == Approx(3e-3 * std::ceil(fallen_m / 3e-3)).epsilon(1e-6));
}
