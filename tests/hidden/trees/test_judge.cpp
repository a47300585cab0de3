// Cases as they are written, and the judge's words.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "tests/folder.hpp"
#include "tests/hidden/trees/cases.hpp"
#include "tests/hidden/trees/judge.hpp"

namespace furcula::hidden::trees {
namespace {

const Case& friction_case() {
  static const Case kCase = draw_case(
      {.seed = 3, .tier = Tier::large, .joints = 2, .effects = {"asymmetric_friction"}, .brief = true});
  return kCase;
}

Finding finding(const Cause& cause, double confidence = 0.9) {
  Finding f;
  f.cause = cause;
  f.confidence = confidence;
  return f;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream out;
  out << file.rdbuf();
  return out.str();
}

}  // namespace

TEST_CASE("A case is the same each time, and its cause shows in it", "[trees]") {
  const Case& c = friction_case();
  const Case again = draw_case(c.question);
  REQUIRE(c.logs.size() == 4);
  CHECK(c.held_out == 2);
  CHECK(c.shows.at(0) >= 2.0);
  CHECK(again.logs.back().state.back().q == c.logs.back().state.back().q);
}

TEST_CASE("A case's folder holds model, robot and logs of the contract's form", "[trees]") {
  const Case& c = friction_case();
  const test::Folder kept;
  const std::string folder = kept.file("case");
  const auto logs = write_case(c, folder);
  CHECK(logs.size() == 4);
  const std::string log = text_of(folder + "/log_00.csv");
  CHECK(log.rfind(
            "# format: furcula-log/1\n# machine_type: tree\ntime_s,angle_" + c.robot.joints[0].name + "_rad",
            0) == 0);
  CHECK(text_of(folder + "/model.toml").find("kind = \"tree\"") != std::string::npos);
  CHECK(text_of(folder + "/robot.urdf").find("<limit") != std::string::npos);
  CHECK(text_of(folder + "/truth.json").find("asymmetric_friction") != std::string::npos);
}

TEST_CASE("Law and place named, and nothing else, is right", "[trees]") {
  const Case& c = friction_case();
  const Cause& planted = c.planted.front();
  const std::string other = c.robot.joints[planted.at.front() == c.robot.joints[0].name ? 1 : 0].name;
  const auto how = [&](const std::vector<Finding>& findings) {
    return judge(c, {"explained", findings}).how;
  };
  CHECK(how({finding(planted)}) == "named");
  CHECK(how({}) == "nothing");
  CHECK(how({finding({planted.effect, {other}, planted.parameters})}) == "wrong");
  CHECK(how({finding({"coulomb_friction", planted.at, {{"torque_nm", 1.0}}})}) == "wrong");
  CHECK(how({finding(planted), finding({"damping_error", {other}, {{"damping_nmspr", 1.0}}})}) == "extra");
}

TEST_CASE("Two frictions are dry friction with an offset in other words, if the values are right",
          "[trees]") {
  const Case& c = friction_case();
  const Cause& planted = c.planted.front();
  const double up = planted.parameters.at("torque_up_nm"), down = planted.parameters.at("torque_down_nm");
  const auto how = [&](double friction, double offset) {
    return judge(c, {"explained",
                     {finding({"coulomb_friction", planted.at, {{"torque_nm", friction}}}),
                      finding({"force_offset", planted.at, {{"torque_nm", offset}}})}})
        .how;
  };
  CHECK(how((up + down) / 2, (down - up) / 2) == "other words");
  CHECK(how((up + down) / 2, (up - down) / 2) == "wrong");
}

TEST_CASE("A position drive's damping and its joint's are one, if their sum is right", "[trees]") {
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    const Case c = draw_case({.seed = seed,
                              .tier = Tier::pairs,
                              .joints = 2,
                              .effects = {"position_gain_error", "damping_error"},
                              .brief = true});
    if (c.planted.size() != 2 || c.planted[0].at != c.planted[1].at) continue;
    const bool gain_first = c.planted[0].effect == "position_gain_error";
    const Cause &gain = c.planted[gain_first ? 0 : 1], &damping = c.planted[gain_first ? 1 : 0];
    std::size_t joint = 0;
    while (c.robot.joints[joint].name != gain.at.front()) ++joint;
    Cause one = gain;
    CHECK(judge(c, {"explained", {finding(one)}}).how == "half");
    one.parameters["kd_nmsprad"] += damping.parameters.at("damping_nmspr") - c.drives[joint].damping_nmspr;
    const Judgement all = judge(c, {"explained", {finding(one)}});
    CHECK(all.right);
    CHECK(all.how == "other words");
    return;
  }
  FAIL("no case has both at one joint");
}

TEST_CASE("A group counts only where the named one predicts as well", "[trees]") {
  const Case& c = friction_case();
  const Cause& planted = c.planted.front();
  Finding f = finding({"stribeck_friction",
                       planted.at,
                       {{"torque_nm", 1e-6}, {"static_torque_nm", 2e-6}, {"velocity_radps", 1.0}}});
  f.alike = {{planted.effect + "@" + planted.at.front()}};
  const Judgement j = judge(c, {"not_identifiable", {f}});
  CHECK_FALSE(j.right);
  CHECK(j.removed < 0.1);
  f.cause = planted;
  CHECK(judge(c, {"not_identifiable", {f}}).removed == Approx(1.0));
}

TEST_CASE("Intervals that hold the planted value are counted", "[trees]") {
  const Case& c = friction_case();
  Finding f = finding(c.planted.front());
  const double up = c.planted.front().parameters.at("torque_up_nm");
  f.ci95 = {{"torque_up_nm", {0.9 * up, 1.1 * up}}, {"torque_down_nm", {1e3, 2e3}}};
  const Judgement j = judge(c, {"explained", {f}});
  CHECK(j.parameters == 2);
  CHECK(j.covered == 1);
}

TEST_CASE("Outside of the catalogue, doubt is honest and a sure name is not", "[trees]") {
  Case c;
  c.question.tier = Tier::outside;
  const Finding sure = finding({"coulomb_friction", {"j1"}, {}}, 0.9);
  const Finding unsure = finding({"coulomb_friction", {"j1"}, {}}, 0.4);
  CHECK(judge(c, {"unexplained", {}}).right);
  CHECK(judge(c, {"partly_explained", {sure}}).right);
  CHECK(judge(c, {"explained", {unsure}}).right);
  CHECK_FALSE(judge(c, {"explained", {sure}}).right);
  CHECK_FALSE(judge(c, {"adequate", {}}).right);
}

TEST_CASE("On a clean robot only nothing is right", "[trees]") {
  Case c;
  c.question.tier = Tier::clean;
  CHECK(judge(c, {"adequate", {}}).right);
  CHECK_FALSE(judge(c, {"unexplained", {}}).right);
  CHECK_FALSE(judge(c, {"explained", {finding({"coulomb_friction", {"j1"}, {}}, 0.3)}}).right);
}

TEST_CASE("A diagnosis is read as the contract writes it", "[trees]") {
  const test::Folder kept;
  const std::string path = kept.file("diagnosis.json");
  std::ofstream(path)
      << R"({"verdict": "explained", "findings": [{"effect": "coulomb_friction", "location_type": "joint", "locations": ["b", "a"],
    "parameters": {"torque_nm": {"value": 0.5, "ci95": [0.4, 0.6]}}, "confidence": 0.97,
    "indistinguishable_from": [{"causes": [{"effect": "viscous", "location_type": "joint", "locations": ["d", "c"]}], "reason": "slow"}]}]})";
  const Diagnosis d = read_diagnosis(path);
  CHECK(d.verdict == "explained");
  REQUIRE(d.findings.size() == 1);
  CHECK(label(d.findings[0].cause.effect, d.findings[0].cause.at) == "coulomb_friction@a,b");
  CHECK(d.findings[0].cause.parameters.at("torque_nm") == 0.5);
  CHECK(d.findings[0].ci95.at("torque_nm").second == 0.6);
  CHECK(d.findings[0].alike == std::vector<std::vector<std::string>>{{"viscous@c,d"}});
  CHECK_THROWS(read_diagnosis(path + ".not"));
}

}  // namespace furcula::hidden::trees
