// Model files and gait files: what is read back, and what is refused with which words.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "host/gait/gait_file.hpp"
#include "host/gait/machine_file.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/gait/legs.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using namespace furcula::gait;
using Catch::Contains;

namespace {

std::string text_of(const std::string& name) {
  std::ostringstream out;
  out << std::ifstream(test::source("tests/host/gait/" + name)).rdbuf();
  return out.str();
}
std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}
std::string refusal(const std::string& text) {
  return test::error_message([&] { parse_machine(text, "leg.toml"); });
}

}  // namespace

TEST_CASE("a leg's model file reads as document 001 has it, and writes the same") {
  for (const LegSpring spring : {LegSpring::switched, LegSpring::parallel, LegSpring::none}) {
    const std::string name(dynamics::kLegSpringNames[static_cast<std::size_t>(spring)]);
    const std::string text = text_of("spear_" + name + ".toml");
    const Machine machine = parse_machine(text, "leg.toml");
    CHECK(is_planar_leg(text));
    CHECK(machine.spring == spring);
    CHECK(machine.leg.mass_kg == 6.71);
    CHECK(machine.leg.rest_angle_rad == Approx(61.0 * 3.14159265358979 / 180.0));
    CHECK(machine.motors.knee_gear == 20.0);
    CHECK(machine.most.knee == Approx(140.0 * 3.14159265358979 / 180.0));
    CHECK(format_machine(parse_machine(format_machine(machine), "again")) == format_machine(machine));
    const Machine table = spear(spring);
    CHECK(format_machine(table) == format_machine(machine));
  }
}

TEST_CASE("a model file that is wrong is refused with line, value and what was expected") {
  const std::string text = text_of("spear_switched.toml");
  CHECK_THAT(refusal(replaced(text, "\"switched\"", "\"switch\"")),
             Contains("leg.toml:4") && Contains("did you mean 'switched'?"));
  CHECK_THAT(refusal(replaced(text, "thigh_mass_kg = 2.43\n", "")),
             Contains("no key 'thigh_mass_kg' in [parameters]"));
  CHECK_THAT(refusal(replaced(text, "thigh_mass_kg = 2.43", "thigh_mass_kg = 6.43")),
             Contains("7.16 kg together") && Contains("6.71"));
  CHECK_THAT(refusal(replaced(text, "thigh_com_m = 0.092", "thigh_com_m = 0.92")),
             Contains("at most the link's length"));
  CHECK_THAT(refusal(replaced(text, "mass_kg = 6.71", "mass_kg = -1")), Contains("mass_kg"));
  CHECK_THAT(refusal(replaced(text, "stiffness_nmprad", "stiffnes_nmprad")), Contains("did you mean"));
  CHECK_THAT(refusal(replaced(text, "planar_leg", "tree")), Contains("gaits are of a planar leg"));
  CHECK_THAT(
      refusal(
          text +
          "\n[range]\nhip_least_rad = 1.0\nhip_most_rad = 0.5\nknee_least_rad = 0.0\nknee_most_rad = 2.0\n"),
      Contains("expected least < most"));
  const auto open = [&](const std::string& line) { return refusal(text + "\n[open]\n" + line + "\n"); };
  CHECK_THAT(open("stiffness_nmprad = 60.0"), Contains("expected [low, high]"));
  CHECK_THAT(open("stiffness_nmprad = [61.0, 70.0]"), Contains("has the value of [parameters] in it, 60.67"));
  CHECK_THAT(open("stifness_nmprad = [50.0, 70.0]"), Contains("did you mean 'stiffness_nmprad'?"));
  CHECK_THAT(open("mass_kg = [-1.0, 7.0]"), Contains("mass_kg") && Contains("-1"));
  CHECK_THAT(open("mass_kg = [6.0, 7.0]\nthigh_mass_kg = [2.0, 3.0]\nshank_mass_kg = [0.7, 0.8]\n"
                  "thigh_com_m = [0.09, 0.1]\nshank_com_m = [0.09, 0.1]"),
             Contains("5 parameters; expected at most 4"));
  CHECK_FALSE(is_planar_leg("[model]\nkind = \"tree\"\n"));
  CHECK_FALSE(is_planar_leg("no toml"));
}

TEST_CASE("a clutch that catches late is read, written again, and of a switched spring alone") {
  const std::string clutch = "\n[clutch]\ncatch_delay_s = 0.01\nlost_knee_rad = 0.05\n";
  const Machine m = parse_machine(text_of("spear_switched.toml") + clutch, "leg.toml");
  CHECK(m.catching.delay_s == 0.01);
  CHECK(m.catching.lost_rad == 0.05);
  CHECK(parse_machine(format_machine(m), "again").catching.lost_rad == 0.05);
  CHECK_THAT(refusal(text_of("spear_parallel.toml") + clutch), Contains("expected spring = \"switched\""));
  CHECK_THAT(
      refusal(text_of("spear_switched.toml") + "\n[clutch]\ncatch_delay_s = -0.01\nlost_knee_rad = 0\n"),
      Contains("catch_delay_s") && Contains("-0.01"));
}

TEST_CASE("intervals of open parameters are read, and written again") {
  const Machine m = parse_machine(
      text_of("spear_switched.toml") + "\n[open]\nhip_damping_nmspr = [0.301, 0.351]\n", "leg.toml");
  REQUIRE(m.open.size() == 1);
  CHECK(m.open[0].name == "hip_damping_nmspr");
  CHECK(m.open[0].high == 0.351);
  const Machine again = parse_machine(format_machine(m), "again");
  REQUIRE(again.open.size() == 1);
  CHECK(again.open[0].low == 0.301);
}

TEST_CASE("a gait file reads back the same gait, with its robot") {
  for (const bool fourier : {false, true}) {
    const Search s = test::found(LegSpring::switched, test::in_place(0.075), fourier);
    REQUIRE(s.gait);
    const std::string text = format_gait(*s.gait);
    const Gait again = parse_gait(text, "gait.toml");
    CHECK(format_gait(again) == text);
    CHECK(again.is_fourier() == fourier);
    CHECK(evaluate(again).cost_j == s.evaluation.cost_j);
  }
}

TEST_CASE("a gait file of another robot, or one that is damaged, is refused") {
  const Search s = test::found(LegSpring::switched, test::in_place(0.075));
  REQUIRE(s.gait);
  Machine heavier = spear(LegSpring::switched);
  heavier.leg.mass_kg = 7.0;
  heavier.file = "heavy.toml";
  CHECK_THAT(test::error_message([&] { require_same_robot(*s.gait, heavier, "gait.toml"); }),
             Contains("another robot: mass_kg = 6.71 there, 7 in heavy.toml"));
  require_same_robot(*s.gait, spear(LegSpring::parallel), "gait.toml");
  const std::string text = format_gait(*s.gait);
  const auto broken = [&](const std::string& what, const std::string& by) {
    return test::error_message([&] { parse_gait(replaced(text, what, by), "gait.toml"); });
  };
  CHECK_THAT(broken("\"free\"", "\"fourier\""), Contains("gait.toml"));
  CHECK_THAT(broken("schema = 1", "schema = 2"), Contains("expected 1"));
  CHECK_THAT(broken("clearance_m = ", "clearance = "), Contains("did you mean"));
  CHECK_THAT(broken("[flight_2]", "[flight_3]"), Contains("flight_3"));
  CHECK_THAT(broken("hip_rad = [", "hip_rad = [1.0, "), Contains("expected"));
}
