// diagnosis.json: keys as in the contract, numbers that survive, nothing that a JSON reader chokes on.
#include "host/diagnose/diagnosis_json.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <memory>

#include "tests/host/report/sample.hpp"

namespace furcula {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> out;
  for (const auto& item : object.items()) out.push_back(item.key());
  return out;
}

using Keys = std::vector<std::string>;

TEST_CASE("the diagnosis of a hopper has the keys and the nesting of the contract") {
  const diagnose::Diagnosis d = test::sample_diagnosis(4, 3);
  const Json j = diagnose::to_json(d);
  CHECK(j["schema"] == "furcula-diagnosis/1");
  CHECK(j["verdict"] == "explained");
  CHECK(keys(j["data"]) == Keys{"logs", "hops", "samples", "held_out_logs", "held_out_windows_left_out"});
  CHECK(j["data"]["logs"] == 4);
  CHECK(j["data"]["held_out_logs"] == 1);
  for (const char* stage : {"baseline", "refitted", "extended"})
    CHECK(keys(j[stage]["held_out"]) == Keys{"nmse_height", "nmse_velocity", "mae_height_m",
                                             "mae_velocity_mps", "rmse_height_m", "rmse_velocity_mps"});
  CHECK(keys(j["noise_floor"]) == Keys{"nmse_height"});
  REQUIRE(j["findings"].size() == 1);
  const Json& f = j["findings"][0];
  CHECK(keys(f) == Keys{"effect", "phase", "parameters", "gain", "confidence", "confidence_lowered_by",
                        "alternatives", "indistinguishable_from", "explanation", "next_experiment"});
  CHECK(f["effect"] == "coulomb_friction");
  CHECK(f["phase"] == "flight+stance");
  CHECK(keys(f["parameters"]["force_n"]) == Keys{"value", "ci95"});
  CHECK(f["parameters"]["force_n"]["ci95"].size() == 2);
  CHECK(keys(f["gain"]) == Keys{"explainable_nmse_removed", "held_out_mae_height_m",
                                "explainable_nmse_removed_ci95", "held_out_mae_gain_ci95"});
  CHECK(f["gain"]["held_out_mae_height_m"] ==
        Json::array({d.refitted.at("height").mae, d.extended.at("height").mae}));
  CHECK(keys(f["alternatives"][0]) == Keys{"effects", "why_not", "parameters"});
  CHECK(keys(f["indistinguishable_from"][0]) == Keys{"effects", "why"});
  CHECK(f["indistinguishable_from"][0]["effects"] == Json::array({"asymmetric_friction"}));
  CHECK(keys(j["unexplained"]) ==
        Keys{"fraction_of_nmse", "white", "nothing_left", "goes_along_with", "none_of_catalogue"});
  CHECK(j["unexplained"]["white"] == true);
  CHECK(keys(j)[0] == "schema");
}

TEST_CASE("how well a machine repeats itself, and what is foretold, stand with what is unexplained") {
  diagnose::Remainder left;
  left.unit = "N m";
  left.typical_force = 2.0;
  left.typical_is = "the input's root mean square";
  left.random_force = 0.01;
  const auto d = std::make_unique<diagnose::Diagnosis>();
  d->remainder = left;
  const Json u = diagnose::to_json(*d)["unexplained"];
  CHECK(keys(u["repeatability"]) == Keys{"random_torque_nm", "random_torque_nm_held_out", "correlation_s",
                                         "impact_scatter", "share_of", "share"});
  CHECK(u["repeatability"]["share"] == 0.005);
  CHECK(keys(u["foretold"]) == Keys{"torque_nm", "share_of_squares", "standard_errors", "counts", "crossed"});
  CHECK(u["foretold"]["counts"] == false);
  CHECK(keys(u["foretold"]["crossed"]) == Keys{"torque_nm", "share_of_squares", "standard_errors", "counts"});
  CHECK(keys(u["whiteness"]) ==
        Keys{"p_value", "chi_square", "lags", "rows", "largest_correlation", "at_lag"});
}

TEST_CASE("an association is written with its signal, strength and how") {
  diagnose::Diagnosis d;
  d.goes_along_with.push_back({"motor_temp_c", 0.75, "the force falls as it rises"});
  const Json j = diagnose::to_json(d);
  CHECK(j["unexplained"]["goes_along_with"][0] ==
        Json({{"signal", "motor_temp_c"}, {"strength", 0.75}, {"how", "the force falls as it rises"}}));
}

TEST_CASE("figures carry the channel and the unit of the rig") {
  diagnose::Diagnosis d;
  d.kind = dynamics::Kind::motor_axis;
  d.baseline = {{"position", {0.1, 0.002, 0.003}}, {"velocity", {0.1, 0.02, 0.03}}};
  d.findings.resize(1);
  d.findings[0].effect = dynamics::Effect::force_offset;
  Json j = diagnose::to_json(d);
  CHECK(j["baseline"]["held_out"]["rmse_position_m"] == 0.003);
  CHECK(j["baseline"]["held_out"]["mae_velocity_mps"] == 0.02);
  CHECK(j["findings"][0]["gain"].contains("held_out_mae_position_m"));

  d.kind = dynamics::Kind::rotary_joint;
  d.baseline = {{"angle", {0.1, 0.04, 0.053}}, {"velocity", {0.1, 0.2, 0.3}}};
  j = diagnose::to_json(d);
  CHECK(j["baseline"]["held_out"]["rmse_angle_rad"] == 0.053);
  CHECK(j["baseline"]["held_out"]["mae_velocity_radps"] == 0.2);
  CHECK(j["findings"][0]["gain"].contains("held_out_mae_angle_rad"));

  d.kind = dynamics::Kind::hopper_linear;
  d.baseline = {{"height_stance", {0.1, 0.001, 0.002}}, {"contact", {0.1, 0.005, 0.006}}};
  j = diagnose::to_json(d);
  CHECK(j["baseline"]["held_out"]["mae_height_stance_m"] == 0.001);
  CHECK(j["baseline"]["held_out"]["mae_contact_s"] == 0.005);
}

TEST_CASE("a number read back is the same double") {
  diagnose::Diagnosis d;
  for (const double value : {1.0 / 3.0, 0.1 + 0.2, 5e-324, 1.7976931348623157e308, -20.4}) {
    d.unexplained_fraction = value;
    const Json back = Json::parse(diagnose::to_json_text(d));
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
  const Json j = Json::parse(diagnose::to_json_text(d));
  CHECK(j["baseline"]["held_out"]["nmse_height"].is_null());
  CHECK(j["baseline"]["held_out"]["mae_height_m"].is_null());
  CHECK(j["baseline"]["held_out"]["rmse_height_m"] == 1.0);
  CHECK(j["findings"][0]["parameters"]["force_n"] == Json({{"value", 1.0}, {"ci95", {nullptr, nullptr}}}));
}

TEST_CASE("an empty diagnosis is written with empty lists and objects, not without them") {
  const Json j = diagnose::to_json({});
  CHECK(j["verdict"] == "adequate");
  CHECK(j["findings"].is_array());
  CHECK(j["findings"].empty());
  CHECK(j["noise_floor"].is_object());
  CHECK(j["baseline"]["held_out"].is_object());
  CHECK(j["unexplained"]["goes_along_with"].is_array());
  CHECK(j["parameters"].is_object());
}

TEST_CASE("a file name that is not UTF-8 does not keep the JSON from being written") {
  diagnose::Diagnosis d;
  d.training_files = {"latin1-\xE4.csv", "quote\"back\\slash\n.csv"};
  const Json j = Json::parse(diagnose::to_json_text(d));
  CHECK(j["files"]["training"][0] == "latin1-\xEF\xBF\xBD.csv");
  CHECK(j["files"]["training"][1] == "quote\"back\\slash\n.csv");
}

TEST_CASE("the same diagnosis gives the same bytes") {
  CHECK(diagnose::to_json_text(test::sample_diagnosis(4, 2)) ==
        diagnose::to_json_text(test::sample_diagnosis(4, 2)));
}

}  // namespace
}  // namespace furcula
