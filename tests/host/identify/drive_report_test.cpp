// What a run predicts that the drive reports of its torque.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/identify/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Effect;

namespace {

constexpr std::size_t kRows = 200;

double command(double time_s) { return std::sin(2.0 * std::numbers::pi * time_s / 0.05); }

/// A fall of 0.2 s with a command that swings, and a drive that reports.
identify::Recording fall() {
  identify::Recording r;
  r.kind = dynamics::Kind::hopper_linear;
  for (std::size_t i = 0; i < kRows; ++i) {
    r.time_s.push_back(1e-3 * static_cast<double>(i));
    r.input.push_back(command(r.time_s[i]));
    r.impulse.push_back(i == 0 ? 0.0 : r.impulse[i - 1] + 1e-3 * r.input[i - 1]);
    r.driven_s.push_back(r.time_s[i]);
  }
  r.position.assign(kRows, 0.5);
  r.drive = r.input;
  return r;
}

/// What the drive reports in each row but the last.
std::vector<double> reports(Effect effect, double value) {
  model::Model model = test::hopper_model();
  model.effects[effect] = {value};
  const identify::PlantSetup<double> setup(model, {}, nullptr);
  std::vector<double> all;
  identify::simulate(setup, fall(), {0, 0, kRows - 1, identify::WindowKind::interval}, 0.5, 0.0,
                     [&](std::size_t, double, double, double drive, const auto&) { all.push_back(drive); });
  all.pop_back();
  return all;
}

}  // namespace

TEST_CASE("A skew of the position's clock leaves what the drive reports as it is") {
  const auto all = reports(Effect::time_skew, 0.01);
  REQUIRE(all.size() == kRows - 1);
  for (std::size_t i = 0; i < all.size(); ++i)
    CHECK(all[i] == Approx(command(1e-3 * static_cast<double>(i))));
}

TEST_CASE("A delay of the drive shows in what it reports") {
  const auto all = reports(Effect::actuator_delay, 0.01);
  REQUIRE(all.size() == kRows - 1);
  // In the middle of a row's step: half a row of the smoothing over it.
  for (std::size_t i = 20; i < all.size(); ++i)
    CHECK(all[i] == Approx(command(1e-3 * static_cast<double>(i) - 0.01)).margin(0.07));
}
