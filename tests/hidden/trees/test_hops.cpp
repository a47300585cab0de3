// Legs that hop: the computer keeps them up, restarts stay within a flight or a stance, cases are as they are
// written, and the judge knows a leg's words.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/folder.hpp"
#include "tests/hidden/trees/judge.hpp"
#include "tests/hidden/trees/questions.hpp"
#include "tests/hidden/trees/stage.hpp"

namespace furcula::hidden::trees {
namespace {

Stage stage_of(std::uint64_t seed, const std::vector<std::string>& effects = {}) {
  Random random(seed);
  for (int i = 0; i < 10; ++i) {
    auto stage = draw_leg_stage({.effects = effects, .brief = true, .leg = true}, random);
    if (stage) return *stage;
  }
  throw std::runtime_error("no leg hops");
}

// Rms of what restarts miss, over what the angles and places move there; without disturbance.
double missed(Stage& stage, const std::vector<Cause>& causes) {
  Case& c = stage.c;
  c.planted = causes;
  Random random(7);
  Experiment running = draw_hops(random, 3.0, c.robot.leg->switched ? 1.2 : 0.8);
  const auto log = record_hops(c.truth(), c, running, false, random, c.redrawn_logs);
  if (!log) return 1e9;
  c.logs = {*log};
  c.held_out = 1;
  const Restarts restarts(c);
  if (restarts.windows.size() < 4) return 1e9;
  const Values miss = rms_difference(restarts.of(restarts.truth), restarts.happened);
  return std::max(std::max(miss[0], miss[1]), std::max(miss[2], miss[3]));
}

const Case& case_of_a_late_catch() {
  static const Case kCase =
      draw_case({.seed = 5, .tier = Tier::large, .effects = {"latch_delay"}, .brief = true, .leg = true});
  return kCase;
}

Finding finding(const Cause& cause) {
  Finding f;
  f.cause = cause;
  f.confidence = 0.9;
  return f;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream out;
  out << file.rdbuf();
  return out.str();
}

}  // namespace

TEST_CASE("Legs of all sizes hop and run for five seconds", "[trees]") {
  std::size_t up = 0, all = 0;
  bool switched = false, parallel = false;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Stage stage = stage_of(seed);
    const Machine m = stage.c.with({});
    (stage.c.robot.leg->switched ? switched : parallel) = true;
    for (std::uint64_t log = 0; log < 2; ++log) {
      Random random(10 * seed + log);
      const Experiment e = draw_hops(random, 5.0, log == 0 ? 0.0 : stage.c.robot.leg->switched ? 1.5 : 1.0);
      const Recording r = record(m, m.dynamics(), stage.c.lab, e, true, random);
      up += hopped(r, stage.c.robot);
      ++all;
      CHECK(r.contacts.size() > 12);
    }
  }
  CHECK(up + 1 >= all);
  CHECK(switched);
  CHECK(parallel);
}

TEST_CASE("A leg that is not driven does not count as one that hops", "[trees]") {
  Stage stage = stage_of(1);
  Lab lab = stage.c.lab;
  lab.effort[2] = lab.effort[3] = 1.0;
  Random random(3);
  const Experiment e = draw_hops(random, 3.0, 0.0);
  const Machine m = stage.c.with({});
  CHECK_FALSE(hopped(record(m, m.dynamics(), lab, e, true, random), stage.c.robot));
}

TEST_CASE("Without disturbance the true leg, restarted in flight or stance, does what it did", "[trees]") {
  Stage stage = stage_of(2, {"latch_delay"});
  CHECK(missed(stage, {}) < 1e-6);
  CHECK(missed(stage, {{"latch_delay", {"knee"}, {{"delay_s", 0.011}}}}) < 1e-6);
  CHECK(missed(stage, {{"latch_offset", {"knee"}, {{"offset_rad", 0.06}}},
                       {"encoder_offset", {"knee"}, {{"offset_rad", 0.03}}}}) < 1e-6);
  CHECK(missed(stage, {{"second_spring", {"knee"}, {{"torque_nm", 1.0}}},
                       {"actuator_delay", {"hip"}, {{"delay_s", 0.003}}}}) < 1e-6);
  CHECK(missed(stage, {{"coulomb_friction", {"knee"}, {{"torque_nm", 0.6}}},
                       {"length_error", {"thigh"}, {{"extension_m", 0.01}}}}) < 1e-5);
}

TEST_CASE("Restarts of a leg cross no change of contact", "[trees]") {
  const Case& c = case_of_a_late_catch();
  const Restarts restarts(c);
  REQUIRE(restarts.windows.size() > 8);
  bool stance = false, flight = false;
  for (const auto& w : restarts.windows) {
    const Recording& log = c.logs[w.log];
    (log.state[w.begin].stance ? stance : flight) = true;
    CHECK(log.time_s[w.end] - log.time_s[w.begin] < 0.153);
    for (const Contact& change : log.contacts)
      CHECK_FALSE((change.time_s > log.time_s[w.begin] && change.time_s < log.time_s[w.end] - 1e-9));
    for (std::size_t row = w.begin; row <= w.end; ++row)
      CHECK(log.state[row].stance == log.state[w.begin].stance);
  }
  CHECK(stance);
  CHECK(flight);
}

TEST_CASE("The toe's switch reports late by what the laboratory's does", "[trees]") {
  Recording r;
  r.contacts = {{0.1, true, {}}, {0.25, false, {}}};
  Lab lab;
  CHECK_FALSE(switched_on(r, lab, 0.0999));
  CHECK(switched_on(r, lab, 0.1));
  CHECK_FALSE(switched_on(r, lab, 0.25));
  lab.switch_late_s = 0.0015;
  CHECK_FALSE(switched_on(r, lab, 0.1014));
  CHECK(switched_on(r, lab, 0.1016));
  CHECK(switched_on(r, lab, 0.2514));
  CHECK_FALSE(switched_on(r, lab, 0.2516));
}

TEST_CASE("Ground differs from stride to stride by what the laboratory's does", "[trees]") {
  Stage stage = stage_of(3);
  stage.c.lab.ground_m = 0.002;
  Random random(5);
  Experiment e = draw_hops(random, 6.0, 0.0);
  const Machine m = stage.c.with({});
  const auto log = record_hops(m, stage.c, e, true, random, stage.c.redrawn_logs);
  REQUIRE(log);
  double sum = 0.0, count = 0.0, last = -1.0;
  for (std::size_t row = 0; row < log->state.size(); ++row) {
    const State& s = log->state[row];
    if (!s.stance || s.touch_down_s == last) continue;
    last = s.touch_down_s;
    sum += s.toe_m.z * s.toe_m.z;
    count += 1.0;
  }
  REQUIRE(count > 8);
  CHECK(std::sqrt(sum / count) > 0.001);
  CHECK(std::sqrt(sum / count) < 0.0035);
}

TEST_CASE("A leg's folder holds its model, its robot and logs with the toe's switch", "[trees]") {
  const Case& c = case_of_a_late_catch();
  CHECK(c.shows.at(0) >= 2.0);
  const double late = c.planted.at(0).parameters.at("delay_s");
  CHECK(late >= 0.015);
  CHECK(late <= 0.025);
  const test::Folder kept;
  const std::string folder = kept.file("case");
  const auto logs = write_case(c, folder);
  CHECK(logs.size() == 4);
  std::ifstream log(folder + "/" + logs.front());
  std::string format, rig, columns, row;
  std::getline(log, format);
  std::getline(log, rig);
  std::getline(log, columns);
  for (int i = 0; i < 100; ++i) std::getline(log, row);
  std::string expected = "time_s,position_boom_travel_m,position_boom_height_m";
  for (const std::string& joint : std::vector<std::string>{"hip", "knee"}) {
    expected += ",angle_" + joint + "_rad";
    if (c.lab.torque_column) expected += ",torque_" + joint + "_nm";
    if (c.lab.command_column) expected += ",torque_cmd_" + joint + "_nm";
  }
  CHECK(columns == expected + ",contact_toe");
  CHECK((c.lab.torque_column || c.lab.command_column));
  CHECK((row.back() == '0' || row.back() == '1'));
  const std::string model = text_of(folder + "/model.toml");
  for (const char* line : {"kind = \"tree\"", "[drive.boom_travel]\ncontrol_mode = \"none\"",
                           "[drive.hip]\ncontrol_mode = \"torque\"",
                           "[spring.knee]\nstiffness_nmprad = ", "rest = \"touch_down\"",
                           "[foot.toe]\nlink = \"shank\"\npoint_m = [0.000000000, 0.000000000, -0."})
    CHECK(model.find(line) != std::string::npos);
  CHECK(text_of(folder + "/robot.urdf").find("<axis xyz=\"0 -1 0\"/>") != std::string::npos);
  CHECK(text_of(folder + "/truth.json").find("latch_delay") != std::string::npos);
}

TEST_CASE("A late catch and another rest angle are other words where the restarts say so", "[trees]") {
  const Case& c = case_of_a_late_catch();
  CHECK(judge(c, {"explained", {finding(c.planted.front())}}).how == "named");
  // The way that the knee goes until the catch differs little from stance to stance.
  double way = 0.0, count = 0.0, last = -1.0;
  for (const Recording& log : c.logs)
    for (const State& s : log.state) {
      if (!s.caught || s.touch_down_s == last) continue;
      last = s.touch_down_s;
      way += s.rest_rad - s.touch_down_rad;
      count += 1.0;
    }
  const auto offset = [&](double rad) {
    return judge(c, {"explained", {finding({"latch_offset", {"knee"}, {{"offset_rad", rad}}})}});
  };
  const Judgement near = offset(way / count), far = offset(0.3 * way / count);
  CHECK((near.removed >= 0.9) == (near.how == "other words"));
  CHECK(near.removed > 0.7);
  CHECK_FALSE(far.right);
}

TEST_CASE("A hip's rotor is inertia of the thigh, if the value is right", "[trees]") {
  Case c = case_of_a_late_catch();
  c.question.tier = Tier::medium;
  const double rotor = c.drives[2].rotor_kgm2;
  c.planted = {{"rotor_inertia_error", {"hip"}, {{"inertia_kgm2", rotor + 0.03}}}};
  Random random(2);
  for (std::size_t i = 0; i < 2; ++i) {
    Experiment e = draw_hops(random, 4.0, 0.0);
    const auto log = record_hops(c.truth(), c, e, true, random, c.redrawn_logs);
    REQUIRE(log);
    c.logs[c.logs.size() - 1 - i] = *log;
  }
  const double scale = 1.0 + 0.03 / c.robot.bodies[2].moments.y;
  CHECK(judge(c, {"explained", {finding({"inertia_error", {"thigh"}, {{"scale", scale}}})}}).how ==
        "other words");
  CHECK(judge(c, {"explained", {finding({"inertia_error", {"thigh"}, {{"scale", 1.05}}})}}).how == "wrong");
  CHECK(judge(c, {"explained", {finding({"inertia_error", {"shank"}, {{"scale", scale}}})}}).how == "wrong");
}

TEST_CASE("Questions about legs ask of all that a leg can have, and of nothing else", "[trees]") {
  const auto questions = draw_questions(3, 120, {}, "", 0, false, true);
  std::vector<std::string> asked;
  for (const Question& q : questions) {
    CHECK(q.leg);
    CHECK(q.tier != Tier::tied);
    CHECK(q.tier != Tier::triple);
    const auto& list = q.tier == Tier::outside ? leg_outside_causes() : leg_catalogue();
    for (const std::string& e : q.effects) {
      CHECK(in(list, e));
      asked.push_back(e);
    }
  }
  for (const std::string& e : leg_catalogue()) CHECK(in(asked, e));
}

}  // namespace furcula::hidden::trees
