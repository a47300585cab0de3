// Robots and logs that nobody meant: each ends in a diagnosis or in an error that says what was expected, and soon.
#include <cmath>
#include <random>

#include "host/core/error.hpp"
#include "host/log/reader.hpp"
#include "host/log/writer.hpp"
#include "host/result/diagnosis_json.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/exports.hpp"
#include "host/trees/identify.hpp"
#include "host/trees/result.hpp"
#include "tests/folder.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"
#include "tests/schema.hpp"

using namespace furcula;
using Catch::Contains;
using trees::Effect;
using trees::Verdict;

namespace {

using Logs = std::vector<log::Log>;

/// A diagnosis whose figures are finite; an exception other than DataError fails the test.
trees::Diagnosis diagnosed(const trees::TreeModel& m, const Logs& training, const Logs& held_out) {
  trees::Diagnosis d = trees::diagnose(m, training, held_out);
  INFO(d.summary);
  for (std::size_t j = 0; j < m.joints(); ++j) {
    CHECK(std::isfinite(d.extended_error[j].rmse));
    CHECK(std::isfinite(d.missing[j].rms_after_nm));
  }
  CHECK(std::isfinite(d.unexplained_share));
  for (const trees::Finding& f : d.findings)
    for (const trees::Estimate& e : f.parameters) CHECK(std::isfinite(e.value));
  const std::string json = result::to_json_text(trees::result_of(d));
  CHECK_THAT(json, Contains("\"furcula-diagnosis/2\""));
  CHECK(test::schema_violations("furcula-diagnosis-2", json).value_or("") == "");
  CHECK_THAT(trees::extended_mjcf(d), Contains("<mujoco"));
  return d;
}
std::string refused(const trees::TreeModel& m, const Logs& training, const Logs& held_out) {
  return test::error_message([&] { trees::diagnose(m, training, held_out); });
}
bool at(const trees::Diagnosis& d, const std::string& site) {
  for (const trees::Finding& f : d.findings)
    if (std::find(f.at.begin(), f.at.end(), site) != f.at.end()) return true;
  return false;
}
void fill(Logs& logs, const std::string& column, double value) {
  for (log::Log& log : logs) std::fill(log.columns.at(column).begin(), log.columns.at(column).end(), value);
}
trees::TreeModel rough_pendulum() {
  trees::TreeModel m = test::pendulum();
  m.causes = {{Effect::coulomb_friction, {0}, {0.15, 0, 0, 0}}};
  return m;
}
void check_friction(const trees::Diagnosis& d) {
  INFO(d.summary);
  REQUIRE_FALSE(d.findings.empty());
  CHECK(d.findings[0].cause.effect == Effect::coulomb_friction);
  CHECK(d.findings[0].parameters[0].value == Approx(0.15).epsilon(0.2));
}

/// A chain of equal rods on hinges by turns about y and x.
std::string chain(const std::vector<std::string>& joints) {
  std::string out = "<robot name=\"chain\"><link name=\"l0\"/>";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string link = "l" + std::to_string(i + 1);
    out +=
        "<link name=\"" + link +
        "\"><inertial><origin xyz=\"0 0 -0.1\"/><mass value=\"0.5\"/><inertia ixx=\"0.002\" ixy=\"0\" ixz=\"0\" iyy=\"0.002\" "
        "iyz=\"0\" izz=\"0.001\"/></inertial></link><joint name=\"" +
        joints[i] + "\" type=\"continuous\"><parent link=\"l" + std::to_string(i) + "\"/><child link=\"" +
        link + "\"/><origin xyz=\"0 0 " + (i == 0 ? "0" : "-0.2") + "\"/><axis xyz=\"" +
        (i % 2 == 0 ? "0 1 0" : "1 0 0") + "\"/><dynamics damping=\"0.05\" friction=\"0\"/></joint>";
  }
  return out + "</robot>";
}
trees::TreeModel written(const test::Folder& folder, const std::string& urdf,
                         const std::string& settings = "") {
  folder.write("robot.urdf", urdf);
  return trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n" + settings,
                                 folder.file("model.toml"));
}

}  // namespace

TEST_CASE("A robot of one joint is diagnosed, from one log or two") {
  const Logs logs = test::logs(rough_pendulum(), 3, 8.0, 1);
  check_friction(diagnosed(test::pendulum(), {logs[0]}, {logs[1]}));
  check_friction(diagnosed(test::pendulum(), {logs[0], logs[1]}, {logs[2]}));
  check_friction(diagnosed(test::pendulum(), {logs[0], logs[1]}, {logs[0]}));
}

TEST_CASE("A diagnosis without held-out or training logs is refused") {
  const Logs logs = test::logs(rough_pendulum(), 1, 3.0, 1);
  CHECK_THAT(refused(test::pendulum(), {}, logs), Contains("training"));
  CHECK_THAT(refused(test::pendulum(), logs, {}), Contains("held-out"));
}

TEST_CASE("A robot of seven joints is diagnosed", "[slow]") {
  const test::Folder folder;
  const trees::TreeModel m = written(folder, chain({"a", "b", "c", "d", "e", "f", "g"}));
  const Logs logs = test::logs(m, 3, 3.0, 4);
  const trees::Diagnosis d = diagnosed(m, {logs[0], logs[1]}, {logs[2]});
  CHECK(d.missing.size() == 7);
}

TEST_CASE("Nothing is said of a joint that never moves") {
  const trees::TreeModel m = test::arm3();
  Logs logs = test::logs(m, 3, 4.0, 9);
  trees::Scenario s = trees::default_scenario(m);
  s.paths[0].profile = trees::Path::Profile::hold;
  s.disturbance_share = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    s.paths[1].phase_rad = static_cast<double>(i);
    s.duration_s = 4.0;
    logs[i] = trees::simulate(m, s, i);
  }
  fill(logs, "angle_yaw_rad", 0.0);
  fill(logs, "torque_yaw_nm", 0.0);
  const trees::Diagnosis d = diagnosed(m, {logs[0], logs[1]}, {logs[2]});
  INFO(d.summary);
  CHECK_FALSE(at(d, "yaw"));
}

TEST_CASE("Torques of zero are no torques, not an error") {
  const trees::TreeModel m = test::pendulum();
  Logs logs;
  // It swings freely from 1 rad.
  for (int i = 0; i < 3; ++i) {
    const trees::Recording r = test::inputs(m, 6.0, 0.004, [](std::size_t, double) { return 0.0; });
    const trees::Setup setup = trees::SetupMaker(m).make({m.drives, {}});
    std::vector<double> q(r.rows());
    trees::run(setup, r, 0, r.rows() - 1, std::vector{1.0 - 0.2 * i}, std::vector{0.0}, q);
    log::Log log;
    log.path = "free.csv";
    log.rig = "tree";
    log.columns["time_s"] = r.time_s;
    log.columns["angle_hinge_rad"] = q;
    log.columns["torque_hinge_nm"] = r.input[0];
    logs.push_back(log);
  }
  const trees::Diagnosis d = diagnosed(m, {logs[0], logs[1]}, {logs[2]});
  INFO(d.summary);
  CHECK(d.findings.empty());
}

TEST_CASE("Torque that comes from elsewhere, and that no state predicts, is not adequate") {
  const trees::TreeModel m = test::pendulum();
  for (const double push_nm : {0.0, 0.1}) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise(0.0, 1e-4);
    Logs logs;
    for (int i = 0; i < 3; ++i) {
      // Of a frequency of its own, begun at another time in each recording.
      const auto push = [&](double t) { return push_nm * std::sin(10.7 * t + 1.9 * i * i); };
      const trees::Recording r = test::inputs(m, 10.0, 0.004, [&](std::size_t, double t) {
        return 0.4 * std::sin(2.1 * t + i) + 0.3 * std::sin(5.3 * t + 2 * i) + push(t + 0.002);
      });
      std::vector<double> q(r.rows());
      trees::run(trees::SetupMaker(m).make({m.drives, {}}), r, 0, r.rows() - 1, std::vector{0.0},
                 std::vector{0.0}, q);
      log::Log log;
      log.path = "pushed.csv";
      log.rig = "tree";
      log.columns["time_s"] = r.time_s;
      for (double& angle : q) angle += noise(random);
      log.columns["angle_hinge_rad"] = q;
      std::vector<double> torque = r.input[0];
      for (std::size_t k = 0; k < torque.size(); ++k) torque[k] -= push(r.time_s[k] + 0.002);
      log.columns["torque_hinge_nm"] = torque;
      logs.push_back(log);
    }
    const trees::Diagnosis d = diagnosed(m, {logs[0], logs[1]}, {logs[2]});
    INFO(d.summary << " " << d.missing[0].persistent_after_nm);
    if (push_nm == 0.0) {
      CHECK(d.verdict == Verdict::adequate);
    } else {
      CHECK((d.verdict == Verdict::unexplained || d.verdict == Verdict::partly_explained));
      CHECK_THAT(d.summary, Contains("hinge"));
      CHECK(d.missing[0].persistent_after_nm == Approx(push_nm / std::sqrt(2.0)).epsilon(0.3));
    }
  }
}

TEST_CASE("Logs with gaps, of other rates, and with times since 1970 are fitted as others are") {
  Logs logs = test::logs(rough_pendulum(), 3, 8.0, 1);
  for (std::size_t k = 0; k < logs[0].rows(); ++k)
    if (k > 700) logs[0].columns["time_s"][k] += 3.7;
  log::Log thin = logs[1];
  for (auto& [name, values] : thin.columns) {
    std::vector<double> every;
    for (std::size_t k = 0; k < values.size(); k += 2) every.push_back(values[k]);
    values = every;
  }
  for (double& t : logs[2].columns["time_s"]) t += 1.7e9;
  const trees::Diagnosis d = diagnosed(test::pendulum(), {logs[0], logs[2]}, {logs[1]});
  check_friction(d);
  check_friction(diagnosed(test::pendulum(), {logs[0], thin}, {logs[2]}));
}

TEST_CASE("Logs that are too short for a window are refused, and do no harm beside longer ones") {
  const Logs logs = test::logs(rough_pendulum(), 3, 8.0, 1);
  log::Log brief = logs[0];
  for (auto& [name, values] : brief.columns) values.resize(60);  // 0.24 s
  CHECK_THAT(refused(test::pendulum(), {brief}, {logs[1]}), Contains("0.3 s without a gap"));
  CHECK_THAT(refused(test::pendulum(), {logs[1]}, {brief}), Contains("0.3 s without a gap"));
  check_friction(diagnosed(test::pendulum(), {brief, logs[0], logs[1]}, {logs[2]}));
  // A row a second.
  log::Log slow = logs[0];
  for (std::size_t k = 0; k < slow.rows(); ++k) slow.columns["time_s"][k] = static_cast<double>(k);
  CHECK_THAT(refused(test::pendulum(), {slow}, {logs[1]}),
             Contains("gap") || Contains("time_s is in milliseconds"));
  CHECK_THAT(test::error_message([&] {
               trees::identify(test::pendulum("[free]\n\"damping_nmspr.hinge\" = [0, 1]\n"), {slow},
                               {logs[1]});
             }),
             Contains("window"));
}

TEST_CASE("A log of another robot is refused by the joint that is not in it") {
  const Logs logs = test::logs(test::arm3(), 2, 2.0, 1);
  CHECK_THAT(refused(test::pendulum(), {logs[0]}, {logs[1]}),
             Contains("joint 'hinge' has no column 'angle_hinge_rad'"));
}

TEST_CASE("A joint of the other sign and joints whose columns are swapped are said, and no cause is named") {
  // The robot that was recorded has dry friction and rotors that the model does not know.
  trees::TreeModel truth = test::arm3();
  truth.causes = {{Effect::coulomb_friction, {1}, {0.2, 0, 0, 0}},
                  {Effect::rotor_inertia_error, {0}, {0.02, 0, 0, 0}}};
  const Logs as_they_are = test::logs(truth, 3, 4.0, 3);
  const auto negate = [](log::Log& log, const char* column) {
    for (double& q : log.columns[column]) q = -q;
  };
  struct Case {
    const char* said;
    std::function<void(log::Log&)> mistake;
  };
  const std::vector<Case> cases{
      {"angle_elbow_rad is of the other sign", [&](log::Log& log) { negate(log, "angle_elbow_rad"); }},
      {"torque_shoulder_nm has the other sign", [&](log::Log& log) { negate(log, "torque_shoulder_nm"); }},
      {"torque_shoulder_nm and torque_elbow_nm are exchanged",
       [](log::Log& log) { std::swap(log.columns["torque_shoulder_nm"], log.columns["torque_elbow_nm"]); }},
      {"angle_shoulder_rad and angle_elbow_rad are exchanged, and torque_shoulder_nm and torque_elbow_nm are exchanged",
       [](log::Log& log) {
         std::swap(log.columns["torque_shoulder_nm"], log.columns["torque_elbow_nm"]);
         std::swap(log.columns["angle_shoulder_rad"], log.columns["angle_elbow_rad"]);
       }},
      {"torque_yaw_nm, torque_shoulder_nm and torque_elbow_nm have the other sign",
       [&](log::Log& log) {
         for (const char* column : {"torque_yaw_nm", "torque_shoulder_nm", "torque_elbow_nm"})
           negate(log, column);
       }},
      {"torque_elbow_nm is in N mm",
       [](log::Log& log) {
         for (double& torque : log.columns["torque_elbow_nm"]) torque *= 1e3;
       }},
  };
  for (const Case& c : cases) {
    Logs logs = as_they_are;
    for (log::Log& log : logs) c.mistake(log);
    const std::string said = refused(test::arm3(), {logs[0], logs[1]}, {logs[2]});
    CHECK_THAT(said, Contains("it seems that " + std::string(c.said)) && Contains("--trust-columns"));
  }
  const trees::Diagnosis d = diagnosed(test::arm3(), {as_they_are[0], as_they_are[1]}, {as_they_are[2]});
  CHECK(!d.findings.empty());
}

TEST_CASE("An angle that is one value in every row is refused: a dead encoder, or a joint that is held") {
  Logs logs = test::logs(test::arm3(), 3, 2.0, 1);
  for (std::size_t i = 0; i < 2; ++i)
    for (double& angle : logs[i].columns["angle_elbow_rad"]) angle = 0.25;
  CHECK_THAT(refused(test::arm3(), {logs[0], logs[1]}, {logs[2]}),
             Contains("angle_elbow_rad is 0.25 in every row") && Contains("[locked_joints]"));
}

TEST_CASE("Where nothing weighs a robot is diagnosed without its weight") {
  const std::string weightless = "gravity_mps2 = [0.0, 0.0, 0.0]\n";
  trees::TreeModel truth = test::pendulum(weightless);
  truth.causes = {{Effect::coulomb_friction, {0}, {0.15, 0, 0, 0}}};
  const Logs logs = test::logs(truth, 3, 8.0, 1);
  check_friction(diagnosed(test::pendulum(weightless), {logs[0], logs[1]}, {logs[2]}));
}

TEST_CASE("A log of 100000 rows is diagnosed") {
  const Logs logs = test::logs(rough_pendulum(), 1, 400.0, 1);
  REQUIRE(logs[0].rows() > 100000);
  const Logs held_out = test::logs(rough_pendulum(), 1, 8.0, 7);
  check_friction(diagnosed(test::pendulum(), logs, held_out));
}

TEST_CASE("Torques that no drive has end soon") {
  const trees::TreeModel m = test::pendulum();
  Logs logs = test::logs(m, 2, 1.0, 1);
  fill(logs, "torque_hinge_nm", 1e9);
  CHECK(diagnosed(m, {logs[0]}, {logs[1]}).verdict != Verdict::adequate);
}

TEST_CASE("Gains that no step follows end soon") {
  Logs logs = test::logs(test::pendulum(), 2, 1.0, 1);
  const trees::TreeModel stiff = test::pendulum("[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 1e8\n");
  for (log::Log& log : logs) log.columns["angle_cmd_hinge_rad"] = log.at("angle_hinge_rad");
  diagnosed(stiff, {logs[0]}, {logs[1]});
}

TEST_CASE("Joints may have any name that a URDF and a log's header can have") {
  const std::vector<std::string> names{
      "../../etc/passwd", "with space",           "quote&quot;d", "&lt;script&gt;",
      "\xC3\xA9paule",    std::string(4000, 'n'), "a.b"};
  const test::Folder folder;
  const trees::TreeModel m = written(folder, chain(names));
  REQUIRE(m.joints() == 7);
  trees::TreeModel free = m;
  for (std::size_t j = 0; j < 7; ++j) free.free.push_back({3, j, 0.0, 1.0});
  const trees::TreeModel back = trees::parse_tree_model(trees::format_tree_model(free, "robot.urdf"), m.file);
  for (std::size_t j = 0; j < 7; ++j) CHECK(back.robot.joints[j].name == m.robot.joints[j].name);
  REQUIRE(back.free.size() == 7);
  std::vector<bool> freed(7);
  for (const trees::FreeParameter& f : back.free) freed[f.joint] = true;
  CHECK(std::all_of(freed.begin(), freed.end(), [](bool f) { return f; }));
  const trees::TreeModel two = written(folder, chain({"../../etc/passwd", "quote&quot;d"}));
  Logs logs = test::logs(two, 3, 3.0, 1);
  for (log::Log& log : logs) log = log::parse_log(log::format_log(log), "odd.csv", "tree");
  const trees::Diagnosis d = diagnosed(two, {logs[0], logs[1]}, {logs[2]});
  CHECK(d.traces.size() == 2);
}
