// What the named causes add, in the report's curve, against closed forms: causes in the drive and in the sensors too.
#include "host/diagnose/residual_force.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Effect;

TEST_CASE("A drive that is late adds the force that it still makes less the one that is commanded") {
  auto model = test::axis_model(95.0, 203.5);
  model.effects[Effect::actuator_delay] = {0.02};  // ten rows
  const auto r = identify::make_recording(test::axis_log(95.0, 203.5, 0.0, 1), model.kind);
  const auto out = diagnose::residual_force(model, {Effect::actuator_delay}, {r});
  REQUIRE(out.law.size() == out.time_s.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < out.law.size(); ++k) {
    const auto i = static_cast<std::size_t>(std::lround(out.time_s[k] / 0.002));
    if (i < 20 || i + 20 > r.rows()) continue;
    double expected = 0.0;  // over the 15 rows of the parabola
    for (std::size_t row = i - 7; row <= i + 7; ++row) expected += (r.input[row - 10] - r.input[row]) / 15.0;
    largest = std::max(largest, std::abs(expected));
    CHECK(out.law[k] == Approx(expected).margin(0.01));
  }
  CHECK(largest > 50.0);  // at a switch of the force all of it
}

TEST_CASE(
    "An encoder whose zero is off adds the gravity torque of the true angle less that of the measured one") {
  model::Model model;
  model.kind = dynamics::Kind::rotary_joint;
  model.parameters = {0.2, 3.7, 0.0};
  model.effects[Effect::encoder_offset] = {0.3};
  log::Log log;
  log.path = "swing.csv";
  for (int n = 0; n < 1000; ++n) {
    log.columns["time_s"].push_back(0.004 * n);
    log.columns["angle_rad"].push_back(0.3 + 0.02 * std::cos(std::sqrt(3.7 / 0.2) * 0.004 * n));
    log.columns["torque_nm"].push_back(0.0);
  }
  const auto out =
      diagnose::residual_force(model, {Effect::encoder_offset}, {identify::make_recording(log, model.kind)});
  REQUIRE(out.law.size() > 900);
  for (std::size_t k = 0; k < out.law.size(); ++k) {
    const double at = out.position[k];
    CHECK(out.law[k] == Approx(3.7 * (std::sin(at) - std::sin(at - 0.3))).epsilon(1e-3));
    CHECK(out.force[k] == Approx(out.law[k]).margin(0.02));
  }
}
