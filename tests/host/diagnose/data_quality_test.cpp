// Recordings with wrong rows, of another machine, or in other units: what is said of them, and that the rest is diagnosed as without.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/core/error.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/identify/conventions.hpp"
#include "host/identify/identification.hpp"
#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "host/result/diagnosis_json.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using diagnose::Verdict;
using dynamics::Effect;

namespace {

/// Thrown up and let fall under dry friction of 1.2 N, which the model does not have.
const test::Flight kTruth{.friction = 1.2};

struct Logs {
  std::vector<log::Log> training, held_out;
  Logs()
      : training(test::flight_logs(kTruth, true, 1, 10)), held_out(test::flight_logs(kTruth, true, 50, 2)) {}
  diagnose::Diagnosis diagnosed() const {
    return diagnose::diagnose(test::carriage_model(), training, held_out);
  }
};

void check_friction_named(const diagnose::Diagnosis& d) {
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::coulomb_friction);
  const auto& force = d.findings[0].parameters.at("force_n");
  CHECK(force.value == Approx(1.2).epsilon(0.02));
  // The noise is 0.09 mm, and a start's velocity is known to 0.01 m/s: over a second that is some millimetres at most.
  CHECK(d.extended.at("height").rmse < 2e-3);
}

/// A joint without gravity under a square wave of torque, in closed form.
log::Log joint_log(unsigned seed) {
  log::Log log = test::axis_log(95.0, 200.0, 2e-5, seed);
  log.path = "joint-" + std::to_string(seed) + ".csv";
  log.rig = "rotary_joint";
  log.columns["angle_rad"] = log.columns.extract("position_m").mapped();
  log.columns["torque_nm"] = log.columns.extract("force_n").mapped();
  return log;
}

model::Model joint_model(double inertia = 95.0) {
  model::Model m;
  m.kind = dynamics::Kind::rotary_joint;
  m.parameters = {inertia, 0.0, 200.0};
  m.free = {{2, {0.0, 5000.0}}};
  return m;
}

}  // namespace

TEST_CASE("Honest recordings lose no row and none of them is left out") {
  const auto d = Logs().diagnosed();
  check_friction_named(d);
  CHECK(d.data_quality.refused.empty());
  CHECK(d.data_quality.notes.empty());
  CHECK(d.data_quality.excluded.empty());
}

TEST_CASE("Two corrupt rows are named, and the cause is found as without them") {
  Logs logs;
  logs.training[3].columns["height_m"][300] = 9.99;
  logs.training[5].columns["height_m"][200] = 0.0;
  const auto d = logs.diagnosed();
  check_friction_named(d);
  REQUIRE(d.data_quality.refused.size() == 2);
  CHECK(d.data_quality.refused[0].log == "flight-4.csv");
  CHECK(d.data_quality.refused[0].row == 301);
  CHECK(d.data_quality.refused[0].value == 9.99);
  CHECK(d.data_quality.refused[1].log == "flight-6.csv");
  const auto json = result::to_json(diagnose::result_of(d))["data"]["rejected_samples"];
  CHECK(json[0]["column"] == "height_m");
  CHECK(json[1]["row"] == 201);
}

TEST_CASE("A first row of each flight that is wrong by no more than the carriage moves does no harm") {
  Logs logs;
  for (auto* list : {&logs.training, &logs.held_out})
    for (log::Log& log : *list) log.columns["height_m"][0] += 0.008;
  const auto d = logs.diagnosed();
  check_friction_named(d);
  CHECK(d.data_quality.refused.size() == 12);
  for (const auto& r : d.data_quality.refused) CHECK(r.row == 1);
}

TEST_CASE("One row of a hundred at random does no harm") {
  Logs logs;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-0.5, 2.0);
  for (auto* list : {&logs.training, &logs.held_out})
    for (log::Log& log : *list)
      for (double& height : log.columns["height_m"])
        if (random() % 100 == 0) height = anywhere(random);
  const auto d = logs.diagnosed();
  check_friction_named(d);
}

TEST_CASE("One recording of ten from another machine_type is said to be, and the rest are diagnosed") {
  Logs logs;
  test::Flight other = kTruth;
  other.friction = 4.0;
  other.height = 0.0;
  other.velocity = 3.5;
  logs.training[6] = test::flight_log(other, 9e-5, 99);
  const auto d = logs.diagnosed();
  check_friction_named(d);
  REQUIRE(d.data_quality.excluded.size() == 1);
  CHECK(d.data_quality.excluded[0].log == "flight-99.csv");
  CHECK_THAT(d.data_quality.excluded[0].why, Catch::Contains("disagrees with the other 9"));
  CHECK(d.logs == 11);
}

TEST_CASE("Degrees where radians are named are refused, with what would mend them") {
  std::vector<log::Log> logs;
  for (unsigned seed = 1; seed <= 3; ++seed) logs.push_back(joint_log(seed));
  const auto look = [&](const model::Model& m) {
    const auto recordings = identify::make_recordings(logs, m.kind);
    identify::require_conventions(m, recordings);
  };
  // However wrong the model is within reason.
  for (const double inertia : {30.0, 60.0, 95.0, 150.0, 300.0}) CHECK_NOTHROW(look(joint_model(inertia)));
  for (log::Log& log : logs)
    for (double& angle : log.columns["angle_rad"]) angle *= 180.0 / std::numbers::pi;
  for (const double inertia : {30.0, 60.0, 95.0, 150.0, 300.0})
    CHECK_THROWS_WITH(look(joint_model(inertia)),
                      Catch::Contains("joint-1.csv and 2 more: it seems that angle_rad is in degrees") &&
                          Catch::Contains("scale = 0.01745329"));
  CHECK_THROWS_WITH(diagnose::diagnose(joint_model(), {logs[0], logs[1]}, {logs[2]}),
                    Catch::Contains("angle_rad is in degrees"));
  CHECK_THROWS_WITH(identify::identify(joint_model(), {logs[0], logs[1]}, {logs[2]}),
                    Catch::Contains("angle_rad is in degrees"));
}

TEST_CASE("A torque of the other sign is refused, with what would mend it") {
  std::vector<log::Log> logs;
  for (unsigned seed = 1; seed <= 3; ++seed) logs.push_back(joint_log(seed));
  for (log::Log& log : logs)
    for (double& torque : log.columns["torque_nm"]) torque = -torque;
  CHECK_THROWS_WITH(diagnose::diagnose(joint_model(), {logs[0], logs[1]}, {logs[2]}),
                    Catch::Contains("torque_nm has the other sign") && Catch::Contains("scale = -1"));
  CHECK_THROWS_WITH(identify::identify(joint_model(), {logs[0], logs[1]}, {logs[2]}),
                    Catch::Contains("torque_nm has the other sign"));
}

TEST_CASE("A velocity in another unit than its position's is said to be, and not used") {
  std::vector<log::Log> training, held_out;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    log::Log log = joint_log(seed);
    std::vector<double> velocity(log.rows(), 0.0);
    const auto& angle = log.at("angle_rad");
    for (std::size_t i = 1; i + 1 < log.rows(); ++i)
      velocity[i] = 180.0 / std::numbers::pi * (angle[i + 1] - angle[i - 1]) / 0.004;
    log.columns["velocity_radps"] = velocity;
    (seed < 3 ? training : held_out).push_back(log);
  }
  const auto d = diagnose::diagnose(joint_model(), training, held_out);
  CHECK(d.verdict == Verdict::adequate);
  REQUIRE(d.data_quality.notes.size() == 3);
  CHECK_THAT(d.data_quality.notes[0], Catch::Contains("joint-1.csv: velocity_radps is 57.") &&
                                          Catch::Contains("degrees for radians") &&
                                          Catch::Contains("scale = 0.0174533"));
  CHECK_FALSE(d.extended.contains("velocity"));
}

TEST_CASE("The program leaves bad rows out, and names them") {
  test::TemporaryFolder folder;
  std::vector<std::string> arguments{"diagnose", "--model",
                                     folder.file("m.toml", model::format_model(test::carriage_model())),
                                     "--out", folder.path() + "/out"};
  for (auto log : test::flight_logs(kTruth, true, 1, 4)) {
    if (log.path == "flight-2.csv") log.columns["height_m"][100] = 7.5;
    std::string text = log::format_log(log);
    if (log.path == "flight-3.csv") {
      // An empty cell.
      const std::size_t at = text.find("\n0.2,") + 5;
      text.erase(at, text.find(',', at) - at);
    }
    arguments.push_back(folder.file(log.path, text));
  }
  const auto ran = test::run_furcula(arguments, 120);
  INFO(ran.err << ran.out);
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Catch::Contains("2 rows refused: ") && Catch::Contains("height_m 7.5") &&
                          Catch::Contains("no value"));
}
