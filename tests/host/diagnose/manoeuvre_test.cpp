// Causes in recordings of the robot's main manoeuvre, which the simulated robot flies with its own coil, key and free leg.
#include <catch2/catch.hpp>

#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/result/diagnosis_json.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/identify/clutched_hops.hpp"
#include "tests/host/identify/manoeuvres.hpp"

using namespace furcula;
using diagnose::Verdict;
using dynamics::Effect;

namespace {

model::Model without_clutch(model::Model m) {
  m.clutch.reset();
  return m;
}

diagnose::Diagnosis diagnosed(const model::Model& m, const model::Model& truth) {
  return diagnose::diagnose(m, test::manoeuvres(truth, 5, 1), test::manoeuvres(truth, 2, 40));
}

void expect_spring_rate_found(model::Model m) {
  model::Model truth = test::manoeuvring_model();
  truth.parameters[*dynamics::parameter_index(truth.kind, "stiffness_npm")] = 645.0;
  m.free.erase(*dynamics::parameter_index(m.kind, "mass_kg"));  // it is weighed
  const auto d = diagnosed(m, truth);
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::stiffness_error);
  CHECK(d.findings[0].parameters.at("stiffness_npm").value == Approx(645.0).epsilon(0.01));
}

}  // namespace

TEST_CASE(
    "In the manoeuvre without a hidden cause nothing is named, and it is followed to the noise, with and without the clutch in the model",
    "[slow]") {
  const model::Model truth = test::manoeuvring_model();
  for (const model::Model& m : {truth, without_clutch(truth)}) {
    const auto d = diagnosed(m, truth);
    INFO(result::to_json_text(diagnose::result_of(d)));
    CHECK(d.findings.empty());
    CHECK(d.excluded.empty());
    // Not yet `adequate`: a flexible law predicts a few percent of what is left, less than the sensor's noise.
    CHECK(d.extended.at("height").nmse < 1.3 * d.noise_floor.at("height").nmse);
  }
}

TEST_CASE("A wrong spring rate is found in the manoeuvre") {
  expect_spring_rate_found(test::manoeuvring_model());
}

TEST_CASE("A wrong spring rate is found in the manoeuvre by a model without its clutch", "[slow]") {
  expect_spring_rate_found(without_clutch(test::manoeuvring_model()));
}

TEST_CASE(
    "What is left out stands in the JSON, and a data set of which nothing is left is refused with the reason") {
  const model::Model truth = test::clutched_model(), m = without_clutch(truth);
  const auto d = diagnose::diagnose(m, test::clutched_hops(truth, 4, 1), test::clutched_hops(truth, 2, 30));
  const auto json = result::to_json(diagnose::result_of(d));
  INFO(json.dump(2));
  CHECK(d.verdict == Verdict::adequate);
  REQUIRE(json.at("data").at("excluded_windows").size() > 0);
  const auto& left = json.at("data").at("excluded_windows").at(0);
  CHECK(left.at("windows").get<int>() > 0);
  CHECK(left.at("duration_s").get<double>() > 0.1 * left.at("windows").get<double>());
  CHECK(left.at("share").get<double>() < 1.0);
  CHECK_FALSE(left.at("logs").empty());

  auto logs = test::clutched_hops(truth, 2, 1);
  for (log::Log& log : logs) {
    log.columns.erase("clutch_travel_m");
    for (double& on : log.columns.at("solenoid")) on = 1.0;
  }
  CHECK_THAT(test::error_message([&] { diagnose::diagnose(m, {logs[0]}, {logs[1]}); }),
             Catch::Contains("no stride is left") && Catch::Contains("has no clutch"));
}
