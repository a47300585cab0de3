// diagnosis.json: keys as in the contract and its schema, numbers that survive, nothing that a JSON reader chokes on.
#include "host/result/diagnosis_json.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <memory>

#include "host/diagnose/result.hpp"
#include "host/trees/result.hpp"
#include "tests/host/report/sample.hpp"
#include "tests/host/report/tree_sample.hpp"
#include "tests/schema.hpp"
#include "tests/skip.hpp"

namespace furcula {
namespace {

using Catch::Contains;
using Json = result::Json;

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> out;
  for (const auto& item : object.items()) out.push_back(item.key());
  return out;
}

using Keys = std::vector<std::string>;

Json json_of(const diagnose::Diagnosis& d) { return result::to_json(diagnose::result_of(d)); }
std::string text_of(const diagnose::Diagnosis& d) { return result::to_json_text(diagnose::result_of(d)); }

/// With every section that a machine with one joint can have.
diagnose::Diagnosis full_diagnosis() {
  diagnose::Diagnosis d = test::sample_diagnosis(4, 2);
  diagnose::Remainder left;
  left.unit = "N";
  left.typical_force = 15.0;
  left.typical_is = "the weight";
  left.random_force = 0.3;
  left.random_force_held_out = 0.6;
  d.remainder = left;
  d.correlated_with.push_back({"", "motor_temp_c", 0.75, "the force falls as it rises"});
  d.findings[0].removed_interval = diagnose::Interval{0.8, 0.9};
  d.findings[0].events.push_back({"a.csv", 0.5, 0.013, "m"});
  d.findings[0].indistinguishable_from.push_back(
      {{"force_offset", "damping_stance_nspm"},
       "explains the training recordings equally well",
       {{"force_offset.force_n", {1.0, 0.9, 1.1}}, {"coulomb_friction.force_n", {0.4, 0.3, 0.5}}}});
  d.experiments.push_back({"a drop from 0.4 m", {}, 12.0, 0.002, 3});
  d.excluded.push_back({"the spring is let go", 3, 0.1, 1.2, {"a.csv"}});
  d.data_quality.refused.push_back(
      {"a.csv", 417, 424, "height_m", 9.99, "", "steps out of the rows around and back"});
  d.data_quality.refused.push_back({"a.csv", 9, 0, "", std::nan(""), "torn", "cannot be read"});
  d.data_quality.excluded.push_back({"b.csv", "disagrees with the other 7"});
  d.data_quality.notes.push_back("a.csv: angle_rad wraps.");
  return d;
}

TEST_CASE("the diagnosis of a hopper has the keys and the nesting of the contract") {
  const diagnose::Diagnosis d = test::sample_diagnosis(4, 3);
  const Json j = json_of(d);
  CHECK(keys(j) == Keys{"schema", "kind", "verdict", "summary", "data", "baseline", "refitted", "extended",
                        "noise_floor", "findings", "unexplained", "missing_force", "next_experiment",
                        "experiments", "parameters", "base_parameters", "candidates", "notes", "files"});
  CHECK(j["schema"] == "furcula-diagnosis/2");
  CHECK(j["kind"] == "hopper_linear");
  CHECK(j["verdict"] == "explained");
  CHECK(keys(j["data"]) == Keys{"logs", "held_out_logs", "samples", "hops", "windows", "fitted_windows",
                                "window_s", "held_out_windows_excluded", "excluded_windows",
                                "rejected_samples", "rejected_sample_count", "excluded_logs", "notes"});
  CHECK(j["data"]["logs"] == 4);
  CHECK(j["data"]["held_out_logs"] == 1);
  for (const char* stage : {"baseline", "refitted", "extended"})
    CHECK(keys(j[stage]["held_out"]) == Keys{"nmse_height", "nmse_velocity", "mae_height_m",
                                             "mae_velocity_mps", "rmse_height_m", "rmse_velocity_mps"});
  CHECK(keys(j["noise_floor"]) == Keys{"nmse_height"});
  REQUIRE(j["findings"].size() == 1);
  const Json& f = j["findings"][0];
  CHECK(keys(f) == Keys{"effect", "location_type", "locations", "parameters", "phase", "gain", "confidence",
                        "confidence_lowered_by", "events", "observed_events", "alternatives",
                        "indistinguishable_from", "explanation", "where_to_look", "next_experiment"});
  CHECK(f["effect"] == "coulomb_friction");
  CHECK(f["location_type"].is_null());
  CHECK(f["locations"].empty());
  CHECK(f["phase"] == "flight+stance");
  CHECK(keys(f["parameters"]["force_n"]) == Keys{"unit", "value", "ci95"});
  CHECK(f["parameters"]["force_n"]["unit"] == "N");
  CHECK(f["gain"]["channel"] == "height");
  CHECK(f["gain"]["held_out_mae_height_m"] ==
        Json::array({d.refitted.at("height").mae, d.extended.at("height").mae}));
  CHECK(f["gain"]["explainable_training_loss_removed"].is_null());
  const Json& other = f["alternatives"][0]["causes"][0];
  CHECK(other["effect"] == "touchdown_loss");
  CHECK(other["parameters"]["restitution_touchdown"]["value"] ==
        d.candidates[1].parameters.begin()->second.value);
  CHECK(f["indistinguishable_from"][0]["causes"][0]["effect"] == "asymmetric_friction");
  CHECK(f["indistinguishable_from"][0]["same_law"] == false);
  CHECK(keys(j["unexplained"]) == Keys{"fraction_of_nmse", "fraction_of_missing_force", "white",
                                       "only_noise_left", "none_of_catalogue", "correlated_with",
                                       "repeatability", "predictable", "whiteness"});
  CHECK(j["unexplained"]["white"] == true);
  CHECK(j["unexplained"]["repeatability"].is_null());
}

TEST_CASE("a robot's diagnosis has the same keys, and its causes have their locations") {
  const Json one = json_of(test::sample_diagnosis(4, 2));
  const Json robot = result::to_json(trees::result_of(test::sample_tree_diagnosis()));
  CHECK(keys(robot) == keys(one));
  for (const char* part : {"data", "unexplained", "files"}) CHECK(keys(robot[part]) == keys(one[part]));
  const Json& f = robot["findings"][1];
  CHECK(keys(f) == keys(one["findings"][0]));
  CHECK(f["effect"] == "payload");
  CHECK(f["location_type"] == "link");
  CHECK(f["locations"] == Json::array({"forearm"}));
  CHECK(f["gain"]["channel"].is_null());
  CHECK(f["gain"]["held_out_mae_angle_elbow_rad"] == Json::array({0.02, 0.002}));
  const Json& set = f["indistinguishable_from"][0]["causes"];
  REQUIRE(set.size() == 2);
  CHECK(set[1]["effect"] == "com_error");
  CHECK(set[1]["locations"] == Json::array({"forearm"}));
  CHECK(robot["missing_force"][1]["location"] == "elbow");
  CHECK(robot["missing_force"][1]["rms_refitted_nm"] == 0.31);
  CHECK(robot["unexplained"]["fraction_of_missing_force"] == 0.013);
  CHECK(robot["unexplained"]["fraction_of_nmse"].is_null());
  CHECK(robot["unexplained"]["correlated_with"][0]["location"] == "elbow");
  CHECK(robot["unexplained"]["correlated_with"][0]["signal"] == "velocity_elbow");
  CHECK(robot["candidates"][2]["causes"][0]["effect"] == "damping_error");
  CHECK(robot["candidates"][2]["score_test_gain"] == 0.53);
  CHECK(robot["base_parameters"][1]["sd"].is_null());
}

TEST_CASE("what is written is as the schema says, for every family") {
  const auto violations = [](const std::string& text) {
    return test::schema_violations("furcula-diagnosis-2", text);
  };
  if (!violations(text_of({}))) return test::skip(test::kNoValidator);
  const std::string robot = result::to_json_text(trees::result_of(test::sample_tree_diagnosis()));
  CHECK(violations(text_of({})).value() == "");
  CHECK(violations(text_of(full_diagnosis())).value() == "");
  CHECK(violations(robot).value() == "");
  trees::Diagnosis undecided = test::sample_tree_diagnosis();
  undecided.experiments = {{"Record more like log-00.csv", {}, 0.0123}};
  CHECK(violations(result::to_json_text(trees::result_of(undecided))).value() == "");
  diagnose::Diagnosis joint;
  joint.kind = dynamics::Kind::rotary_joint;
  joint.baseline = {{"angle", {0.1, 0.04, 0.053}}, {"velocity", {0.1, 0.2, 0.3}}};
  joint.findings.resize(1);
  joint.findings[0].effect = dynamics::Effect::encoder_slip;
  joint.findings[0].events.push_back({"a.csv", 0.5, 0.1, "rad"});
  joint.remainder.emplace().unit = "N m";
  CHECK(violations(text_of(joint)).value() == "");

  // The schema refuses what it should.
  const auto changed = [&](const auto& change) {
    Json j = Json::parse(robot);
    change(j);
    return violations(j.dump()).value();
  };
  CHECK_THAT(changed([](Json& j) { j["schema"] = "furcula-diagnosis/1"; }), Contains(": schema: "));
  CHECK_THAT(changed([](Json& j) { j["verdict"] = "perhaps"; }), Contains(": verdict: "));
  CHECK_THAT(changed([](Json& j) { j["data"].erase("hops"); }), Contains("'hops' is a required property"));
  CHECK_THAT(changed([](Json& j) { j["findings"][0]["at"] = "elbow"; }), Contains("'at' was unexpected"));
  CHECK_THAT(changed([](Json& j) { j["findings"][0]["locations"] = Json::array(); }), Contains("locations"));
  CHECK_THAT(changed([](Json& j) { j["missing_force"][0].erase("rms_drive_nm"); }),
             Contains(": missing_force/0: "));
  CHECK_THAT(changed([](Json& j) { j["baseline"]["held_out"]["mae_angle_elbow"] = 0.1; }),
             Contains(": baseline/held_out: "));
}

TEST_CASE("what a rival leaves of the other findings keeps its values beside the rival's") {
  const Json j = json_of(full_diagnosis());
  const Json& rival = j["findings"][0]["indistinguishable_from"][1];
  REQUIRE(rival["causes"].size() == 2);
  CHECK(rival["causes"][0]["parameters"]["force_n"]["ci95"] == Json::array({0.9, 1.1}));
  CHECK(rival["causes"][1] ==
        Json({{"model_parameter", "damping_stance_nspm"}, {"parameters", Json::object()}}));
  REQUIRE(rival["retained_causes"].size() == 1);
  CHECK(rival["retained_causes"][0]["effect"] == "coulomb_friction");
  CHECK(rival["retained_causes"][0]["parameters"]["force_n"]["value"] == 0.4);
}

TEST_CASE("what is excluded and rejected is listed with its reason") {
  const Json data = json_of(full_diagnosis())["data"];
  CHECK(data["rejected_sample_count"] == 2);
  CHECK(data["rejected_samples"][0] == Json({{"log", "a.csv"},
                                             {"row", 417},
                                             {"line", 424},
                                             {"column", "height_m"},
                                             {"value", 9.99},
                                             {"reason", "steps out of the rows around and back"}}));
  CHECK(data["rejected_samples"][1]["value"] == "torn");
  CHECK(data["rejected_samples"][1]["line"].is_null());
  CHECK(data["excluded_logs"][0]["reason"] == "b.csv disagrees with the other 7");
  CHECK(data["excluded_windows"][0]["duration_s"] == 1.2);
  CHECK(data["notes"].size() == 1);
}

TEST_CASE("how well a machine repeats itself, and what is predictable, stand with what is unexplained") {
  diagnose::Remainder left;
  left.unit = "N m";
  left.typical_force = 2.0;
  left.typical_is = "the input's root mean square";
  left.random_force = 0.01;
  const auto d = std::make_unique<diagnose::Diagnosis>();
  d->remainder = left;
  const Json u = json_of(*d)["unexplained"];
  CHECK(keys(u["repeatability"]) == Keys{"random_torque_nm", "random_held_out_torque_nm", "correlation_s",
                                         "impact_scatter", "share_of", "share"});
  CHECK(u["repeatability"]["share"] == 0.005);
  CHECK(keys(u["predictable"]) ==
        Keys{"torque_nm", "share_of_squares", "standard_errors", "significant", "cross_validated"});
  CHECK(u["predictable"]["significant"] == false);
  CHECK(keys(u["predictable"]["cross_validated"]) ==
        Keys{"torque_nm", "share_of_squares", "standard_errors", "significant"});
  CHECK(keys(u["whiteness"]) ==
        Keys{"p_value", "chi_square", "lags", "rows", "largest_correlation", "at_lag"});
}

TEST_CASE("an association is written with its signal, strength and description") {
  diagnose::Diagnosis d;
  d.correlated_with.push_back({"", "motor_temp_c", 0.75, "the force falls as it rises"});
  CHECK(json_of(d)["unexplained"]["correlated_with"][0] ==
        Json({{"location", nullptr},
              {"signal", "motor_temp_c"},
              {"strength", 0.75},
              {"description", "the force falls as it rises"}}));
}

TEST_CASE("figures carry the channel and the unit of the machine") {
  diagnose::Diagnosis d;
  d.kind = dynamics::Kind::motor_axis;
  d.baseline = {{"position", {0.1, 0.002, 0.003}}, {"velocity", {0.1, 0.02, 0.03}}};
  d.findings.resize(1);
  d.findings[0].effect = dynamics::Effect::force_offset;
  Json j = json_of(d);
  CHECK(j["baseline"]["held_out"]["rmse_position_m"] == 0.003);
  CHECK(j["baseline"]["held_out"]["mae_velocity_mps"] == 0.02);
  CHECK(j["findings"][0]["gain"].contains("held_out_mae_position_m"));

  d.kind = dynamics::Kind::rotary_joint;
  d.baseline = {{"angle", {0.1, 0.04, 0.053}}, {"velocity", {0.1, 0.2, 0.3}}};
  j = json_of(d);
  CHECK(j["baseline"]["held_out"]["rmse_angle_rad"] == 0.053);
  CHECK(j["baseline"]["held_out"]["mae_velocity_radps"] == 0.2);
  CHECK(j["findings"][0]["gain"].contains("held_out_mae_angle_rad"));

  d.kind = dynamics::Kind::hopper_linear;
  d.baseline = {{"height_stance", {0.1, 0.001, 0.002}}, {"contact", {0.1, 0.005, 0.006}}};
  j = json_of(d);
  CHECK(j["baseline"]["held_out"]["mae_height_stance_m"] == 0.001);
  CHECK(j["baseline"]["held_out"]["mae_contact_s"] == 0.005);
  CHECK_FALSE(j["baseline"]["held_out"].contains("nmse_contact"));
}

TEST_CASE("a number read back is the same double") {
  diagnose::Diagnosis d;
  for (const double value : {1.0 / 3.0, 0.1 + 0.2, 5e-324, 1.7976931348623157e308, -20.4}) {
    d.unexplained_fraction = value;
    const Json back = Json::parse(text_of(d));
    CHECK(back["unexplained"]["fraction_of_nmse"].get<double>() == value);
  }
}

TEST_CASE("a figure that is not finite becomes null") {
  diagnose::Diagnosis d;
  d.baseline["height"] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          1.0};
  diagnose::Finding f{};
  f.effect = dynamics::Effect::coulomb_friction;
  f.parameters["force_n"] = {1.0, -std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()};
  d.findings.push_back(f);
  const Json j = Json::parse(text_of(d));
  CHECK(j["baseline"]["held_out"]["nmse_height"].is_null());
  CHECK(j["baseline"]["held_out"]["mae_height_m"].is_null());
  CHECK(j["baseline"]["held_out"]["rmse_height_m"] == 1.0);
  CHECK(j["findings"][0]["parameters"]["force_n"] ==
        Json({{"unit", "N"}, {"value", 1.0}, {"ci95", {nullptr, nullptr}}}));
}

TEST_CASE("an empty diagnosis is written with empty lists and objects, not without them") {
  const Json j = json_of({});
  CHECK(j["verdict"] == "adequate");
  CHECK(j["findings"].is_array());
  CHECK(j["findings"].empty());
  CHECK(j["noise_floor"].is_object());
  CHECK(j["baseline"]["held_out"].is_object());
  CHECK(j["unexplained"]["correlated_with"].is_array());
  CHECK(j["parameters"].is_object());
}

TEST_CASE("a file name that is not UTF-8 does not keep the JSON from being written") {
  diagnose::Diagnosis d;
  d.training_files = {"latin1-\xE4.csv", "quote\"back\\slash\n.csv"};
  const Json j = Json::parse(text_of(d));
  CHECK(j["files"]["training"][0] == "latin1-\xEF\xBF\xBD.csv");
  CHECK(j["files"]["training"][1] == "quote\"back\\slash\n.csv");
}

TEST_CASE("the same diagnosis gives the same bytes") {
  CHECK(text_of(test::sample_diagnosis(4, 2)) == text_of(test::sample_diagnosis(4, 2)));
}

}  // namespace
}  // namespace furcula
