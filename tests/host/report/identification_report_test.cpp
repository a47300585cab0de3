// The page of an identification, made from an axis that a constant force sets in motion: x(t) in closed form.
#include "host/report/identification_report.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/report/identification_json.hpp"
#include "tests/schema.hpp"
#include "tests/skip.hpp"

namespace furcula {
namespace {

using Catch::Contains;

/// Position of an axis of mass m and viscous damping d, at rest until a force of 20 N sets in.
double position(double mass, double damping, double t) {
  const double end_speed = 20.0 / damping, time_constant = mass / damping;
  return end_speed * (t - time_constant * (1.0 - std::exp(-t / time_constant)));
}

identify::Identification sample() {
  identify::Identification id;
  id.kind = dynamics::Kind::motor_axis;
  id.main_channel = "position";
  id.main_unit = "m";
  id.logs = 3;
  id.held_out_logs = 1;
  id.training_files = {"a.csv", "b.csv"};
  id.held_out_files = {"</script><img src=x>.csv"};
  identify::FittedTrace t{id.held_out_files[0], "position", "m", {}, {}, {}, {}};
  double error_given = 0.0;
  for (int i = 0; i < 500; ++i) {
    t.time_s.push_back(1e-3 * i);
    t.measured.push_back(position(95.0, 200.0, t.time_s.back()));
    t.as_given.push_back(position(80.0, 150.0, t.time_s.back()));
    t.identified.push_back(t.measured.back());
    error_given += std::abs(t.measured.back() - t.as_given.back()) / 500.0;
  }
  id.samples = t.time_s.size();
  id.traces.push_back(t);
  id.as_given = identify::Errors{{"position", {0.1, error_given, error_given}}};
  identify::Estimation e;
  e.parameters = {{"mass_kg", "kg", 80.0, 95.0, 94.2, 95.8, {94.8, 95.1, 95.3}, "identified", ""},
                  {"damping_nspm", "N s/m", 150.0, 200.0, 150.0, 250.0, {}, "correlated", "mass_kg"}};
  e.derived = {{"time_constant_s", "s", 95.0 / 200.0, {}}};
  e.folds = {{{"position", {0.002, 1e-4, 1e-4}}}, {{"position", {0.004, 1e-4, 1e-4}}}};
  e.held_out = identify::Errors{{"position", {0.0, 0.0, 0.0}}};
  id.estimations.push_back(e);
  return id;
}

TEST_CASE("the page of an identification names what is identified and what is not") {
  const std::string page = report::render_identification_report(sample());
  CHECK_THAT(page,
             Contains("1 of 2 free parameters is identified: damping_nspm is correlated with mass_kg."));
  CHECK_THAT(page, Contains("95.00 <small>(94.20 to 95.80)</small>"));
  CHECK_THAT(page, Contains("94.80 to 95.30"));
  CHECK_THAT(page, Contains("time_constant_s"));
  CHECK_THAT(page, Contains("0.0030"));  // mean NMSE of the two folds
  CHECK_THAT(page, Contains("Simulation error"));
  CHECK_THAT(page, !Contains("<img"));
}

TEST_CASE("with every parameter identified the page says so") {
  identify::Identification id = sample();
  id.estimations[0].parameters[1].verdict = "identified";
  CHECK_THAT(report::render_identification_report(id),
             Contains("<h1>Both free parameters are identified.</h1>"));
  id.estimations[0].parameters.push_back(id.estimations[0].parameters[0]);
  CHECK_THAT(report::render_identification_report(id),
             Contains("<h1>All 3 free parameters are identified.</h1>"));
  id.estimations[0].parameters.resize(1);
  CHECK_THAT(report::render_identification_report(id),
             Contains("<h1>The free parameter is identified.</h1>"));
}

TEST_CASE("the JSON of an identification is as its schema says") {
  identify::Identification id = sample();
  id.excluded.push_back({"the spring is let go", 3, 0.1, 1.2, {"a.csv"}});
  id.data_quality.refused.push_back(
      {"a.csv", 417, 424, "position_m", 9.99, "", "steps out of the rows around"});
  id.estimations[0].parameters.push_back({"gain", "", 1.0, 2.0, 1.5, 2.5, {}, "at_bound", "upper"});
  id.estimations.push_back(id.estimations[0]);
  const std::string text = report::to_json_text(id);
  const auto violations = test::schema_violations("furcula-identification-2", text);
  if (!violations) return test::skip(test::kNoValidator);
  CHECK(*violations == "");
  std::string other = text;
  other.replace(other.find("\"at_bound\""), 10, "\"identified\"");
  CHECK(test::schema_violations("furcula-identification-2", other).value() != "");
}

TEST_CASE("an empty identification is still a page") {
  const std::string page = report::render_identification_report({});
  CHECK_THAT(page, Contains("0 of 0 free parameters"));
  CHECK_THAT(page, !Contains("<script"));
}

}  // namespace
}  // namespace furcula
