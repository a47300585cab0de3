// Logs of robots with wrong rows, and one of another robot.
#include <nlohmann/json.hpp>

#include "host/result/diagnosis_json.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/result.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Effect;
using trees::Verdict;

namespace {

const std::string kAngle = "angle_hinge_rad", kTorque = "torque_hinge_nm";

trees::TreeModel with_friction(double torque_nm) {
  trees::TreeModel truth = test::pendulum();
  truth.causes = {{Effect::coulomb_friction, {0}, {torque_nm, 0, 0, 0}}};
  return truth;
}

std::vector<log::Log> first(const std::vector<log::Log>& all, std::size_t count) {
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)};
}

void check_friction_named(const trees::Diagnosis& d, double torque_nm) {
  INFO(result::to_json_text(trees::result_of(d)).substr(0, 3000));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].cause.effect == Effect::coulomb_friction);
  CHECK(d.findings[0].parameters[0].value == Approx(torque_nm).epsilon(0.05));
  CHECK(d.verdict == Verdict::explained);
}

}  // namespace

TEST_CASE("Wrong rows of a joint's angle and torque are left out of a recording and named") {
  const trees::TreeModel model = test::pendulum();
  log::Log log = test::logs(model, 1, 5.0, 3).front();
  const trees::Recording clean = trees::recording_of(model, log);
  CHECK(clean.refused.empty());
  CHECK(clean.rows() == log.rows());
  log.columns[kAngle][200] += 2.0;
  log.columns[kTorque][700] = 1e6;
  const trees::Recording r = trees::recording_of(model, log);
  REQUIRE(r.refused.size() == 2);
  CHECK(r.refused[0].row == 201);
  CHECK(r.refused[0].column == kAngle);
  CHECK(r.refused[1].row == 701);
  CHECK(r.refused[1].value == 1e6);
  CHECK(r.rows() == log.rows() - 2);
  CHECK(r.time_s[200] == log.time_s()[201]);
}

TEST_CASE("Corrupt rows of a robot's logs are named, and the cause is found as without them") {
  const double torque_nm = 0.5;
  std::vector<log::Log> all = test::logs(with_friction(torque_nm), 4, 6.0, 20);
  all[0].columns[kAngle][300] = 40.0;
  all[1].columns[kTorque][500] = -1e5;
  all[3].columns[kAngle][0] += 3.0;
  const trees::Diagnosis d = trees::diagnose(test::pendulum(), first(all, 3), {all[3]});
  check_friction_named(d, torque_nm);
  const auto data = nlohmann::json::parse(result::to_json_text(trees::result_of(d)))["data"];
  REQUIRE(data["rejected_samples"].size() == 3);
  CHECK(data["rejected_samples"][0]["row"] == 301);
  CHECK(data["rejected_samples"][1]["column"] == kTorque);
  CHECK(data["rejected_samples"][2]["log"] == all[3].path);
  CHECK(data["rejected_sample_count"] == 3);
  CHECK(data["excluded_logs"].empty());
}

TEST_CASE("First rows from before a delay, and an encoder that stands still for a while, do no harm") {
  const double torque_nm = 0.5;
  std::vector<log::Log> all = test::logs(with_friction(torque_nm), 4, 6.0, 40);
  for (log::Log& log : all)
    for (std::size_t i = 0; i < 3; ++i) log.columns[kAngle][i] += 0.05;
  std::vector<double>& angle = all[1].columns[kAngle];
  for (std::size_t i = 700; i < 800; ++i) angle[i] = angle[699];
  const trees::Diagnosis d = trees::diagnose(test::pendulum(), first(all, 3), {all[3]});
  check_friction_named(d, torque_nm);
  CHECK(d.data_quality.refused.size() == 3 * 4 + 100);
}

TEST_CASE("One log of another robot is said to be, and the rest are diagnosed") {
  const double torque_nm = 0.5;
  std::vector<log::Log> all = test::logs(with_friction(torque_nm), 7, 5.0, 30);
  trees::TreeModel other = with_friction(torque_nm);
  other.causes[0].values[0] = 2.5 * torque_nm;
  all[2] = test::logs(other, 3, 5.0, 30).back();
  all[2].path = "other.csv";
  const trees::Diagnosis d = trees::diagnose(test::pendulum(), first(all, 6), {all[6]});
  check_friction_named(d, torque_nm);
  REQUIRE(d.data_quality.excluded.size() == 1);
  CHECK(d.data_quality.excluded[0].log == "other.csv");
  CHECK(d.logs == 6);
}
