// Free runs and single steps, with drive and encoder between the commands and what is measured.
#include "host/identify/simulate.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace furcula;
using dynamics::Effect;

namespace {

constexpr std::size_t kRows = 400;
constexpr identify::Window kAll{0, 0, kRows - 1, identify::WindowKind::interval};

model::Model joint() {
  model::Model model;
  model.kind = dynamics::Kind::rotary_joint;
  model.parameters = {0.15, 2.6, 0.02};
  model.effects[Effect::coulomb_friction] = {0.05};
  model.effects[Effect::actuator_delay] = {4.3e-3};
  model.effects[Effect::actuator_lag] = {9e-3};
  model.effects[Effect::torque_saturation] = {1.4};
  model.effects[Effect::torque_ripple] = {0.1, 14.0, 0.6};
  model.effects[Effect::encoder_offset] = {0.11};
  model.effects[Effect::time_skew] = {-2.7e-3};
  return model;
}

identify::Recording commands() {
  identify::Recording r;
  r.kind = dynamics::Kind::rotary_joint;
  for (std::size_t i = 0; i < kRows; ++i) {
    r.time_s.push_back(1e-3 * static_cast<double>(i));
    r.input.push_back(2.0 * std::sin(0.03 * static_cast<double>(i)));
    r.impulse.push_back(i == 0 ? 0.0 : r.impulse[i - 1] + 1e-3 * r.input[i - 1]);
    r.driven_s.push_back(r.time_s[i]);
  }
  r.position.assign(kRows, 0.0);
  r.velocity_smoothed.assign(kRows, 0.0);
  return r;
}

}  // namespace

TEST_CASE("Single steps from a free run's own states go where the run goes, through drive and encoder") {
  const model::Model model = joint();
  const identify::PlantSetup<double> setup(model, {}, nullptr);
  identify::Recording r = commands();
  identify::simulate(setup, r, kAll, 0.4, 0.3,
                     [&](std::size_t row, double position, double velocity, double, const auto&) {
                       r.position[row] = position;
                       r.velocity_smoothed[row] = velocity;
                     });
  std::size_t rows = 0;
  identify::one_step_each(setup, r, kAll, [&](std::size_t row, double position, double velocity) {
    ++rows;
    REQUIRE(position == Approx(r.position[row]).margin(1e-12));
    REQUIRE(velocity == Approx(r.velocity_smoothed[row]).epsilon(1e-9).margin(1e-12));
  });
  CHECK(rows == kRows - 1);
}

TEST_CASE("A free run without friction has the momentum that late commands give, on the encoder's clock") {
  // I v' = command(t - delay - skew), without gravity, friction and lag: the angular momentum is their integral.
  model::Model model = joint();
  model.effects.clear();
  model.parameters = {0.15, 0.0, 0.0};
  const double delay = 4.3e-3, skew = -2.7e-3, late = delay + skew;
  model.effects[Effect::actuator_delay] = {delay};
  model.effects[Effect::time_skew] = {skew};
  model.effects[Effect::encoder_offset] = {0.11};
  const identify::PlantSetup<double> setup(model, {}, nullptr);
  const identify::Recording r = commands();
  const auto impulse = [&](double until_s) {  // of commands held from row to row; before the first row none
    double sum = 0.0;
    for (std::size_t i = 0; i < kRows && r.time_s[i] < until_s; ++i)
      sum += r.input[i] * std::min(1e-3, until_s - r.time_s[i]);
    return sum;
  };
  identify::simulate(
      setup, r, kAll, 0.4, 0.3, [&](std::size_t row, double position, double velocity, double, const auto&) {
        REQUIRE(0.15 * (velocity - 0.3) == Approx(impulse(r.time_s[row] - late)).margin(1e-12));
        if (row == 0) CHECK(position == 0.4);
      });
}
