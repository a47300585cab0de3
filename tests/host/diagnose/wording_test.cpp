// What is said of causes that explain a part of the error only.
#include "host/diagnose/wording.hpp"

#include <catch2/catch.hpp>

namespace furcula::diagnose {
namespace {

std::string said_of(double unnamed_share, double confidence = 0.9) {
  Diagnosis d;
  d.kind = dynamics::Kind::motor_axis;
  d.main_channel = "position";
  d.main_unit = "m";
  d.verdict = Verdict::partly_explained;
  d.refitted["position"].rmse = 2e-3;
  d.extended["position"].rmse = 1e-3;
  d.unnamed_share = unnamed_share;
  Finding f;
  f.effect = dynamics::Effect::coulomb_friction;
  f.parameters["force_n"] = {2.5, 2.0, 3.0};
  f.confidence = confidence;
  d.findings.push_back(f);
  return summary(d);
}

}  // namespace

TEST_CASE("A cause that is hardly believed is not told as a fact") {
  const std::string said = said_of(0.2, 0.002);
  CHECK(said.starts_with("It looks as if the model lacks dry friction (coulomb_friction: 2.5 N): with it"));
  CHECK(said.find("a confidence of 0.002 is no finding") != said.npos);
}

TEST_CASE("The same law under another name is told beside the first, with its value") {
  Diagnosis d;
  d.kind = dynamics::Kind::torsion_pendulum;
  d.verdict = Verdict::explained;
  Finding f;
  f.effect = dynamics::Effect::force_offset;
  f.parameters["torque_nm"] = {3.14, 3.13, 3.15};
  f.confidence = 0.99;
  Rival zero{{"encoder_offset"}, "", {{"encoder_offset.offset_rad", {1.047, 1.04, 1.05}}}};
  zero.same_law = true;
  f.indistinguishable_from = {zero, {{"coulomb_friction"}, "", {}}};
  d.findings.push_back(f);
  CHECK(summary(d).find("(force_offset: 3.14 N m; or, the same law, encoder_offset: 1.05 rad)") !=
        std::string::npos);
}

TEST_CASE("A cause that explains most is what the model lacks, one that explains little only looks like it") {
  const std::string named = "he model lacks dry friction (coulomb_friction: 2.5 N)";
  const std::string falls = ": with it the held-out position error (RMSE) falls from 2 mm to 1 mm";
  CHECK(said_of(0.2) ==
        "T" + named + falls + ", but structure remains that no effect of the catalogue removes.");
  CHECK(said_of(0.8) ==
        "Most of what is wrong with the model is not in the catalogue. A part of it looks as if t" + named +
            falls + ".");
}

TEST_CASE(
    "What a machine does not repeat is said with its size, and so is what comes at random or is predictable") {
  Diagnosis d;
  d.kind = dynamics::Kind::motor_axis;
  d.main_channel = "position";
  d.main_unit = "m";
  d.baseline["position"].rmse = 2e-3;
  d.refitted["position"].rmse = 1e-3;
  d.remainder = Remainder{};
  d.remainder->unit = "N";
  d.remainder->typical_force = 20.0;
  d.remainder->typical_is = "the input's root mean square";
  d.remainder->random_force = d.remainder->random_force_held_out = 0.25;
  const auto holds = [&](const char* text) { return summary(d).find(text) != std::string::npos; };
  CHECK(holds(
      "nothing is left but measuring noise and what the machine does not repeat, a random force of 0.25 N (1.2 % of the input's root mean square)"));
  d.verdict = Verdict::unexplained;
  d.remainder->random_force = 1.5;
  CHECK(holds(
      "It looks like a random force of 1.5 N (7.5 % of the input's root mean square), which nothing in the recordings predicts"));
  d.correlated_with.emplace_back().description = "the remaining force swings with 2.7 Hz";
  CHECK(holds(
      "It looks like a random force of 1.5 N (7.5 % of the input's root mean square); the remaining force swings with 2.7 Hz"));
  d.remainder->random_force_held_out = 4.0;
  CHECK(holds("The held-out recordings lack 4 N that the training recordings do not"));
  d.remainder->predictable.deviations = 6.0;
  d.remainder->predictable.noises = 3.0;
  d.remainder->predictable.force = 1.1;
  d.remainder->predictable.share = 0.4;
  CHECK(holds(
      "takes off 40 % of the held-out squares, with a force of 1.1 N; the remaining force swings with 2.7 Hz"));
}

TEST_CASE("A parameter of the model that is wrong is said with both values, beside the laws that it lacks") {
  Diagnosis d;
  d.kind = dynamics::Kind::hopper_linear;
  d.main_channel = "height";
  d.main_unit = "m";
  d.verdict = Verdict::explained;
  d.refitted["height"].rmse = 2e-3;
  d.extended["height"].rmse = 1e-3;
  Finding mass;
  mass.effect = dynamics::Effect::mass_error;
  mass.parameters["mass_kg"] = {1.62, 1.6, 1.64};
  mass.confidence = 0.9;
  d.findings.push_back(mass);
  result::Parameter given;
  given.name = "mass_kg";
  given.unit = "kg";
  given.baseline = 1.55;
  d.parameters.push_back(given);
  const std::string wrong = "he model's mass is wrong (mass_error: 1.62 kg, not 1.55 kg)";
  const std::string falls = " the held-out height error (RMSE) falls from 2 mm to 1 mm.";
  CHECK(summary(d) == "T" + wrong + ": with it" + falls);
  Finding friction;
  friction.effect = dynamics::Effect::coulomb_friction;
  friction.parameters["force_n"] = {2.5, 2.0, 3.0};
  d.findings.push_back(friction);
  CHECK(summary(d) ==
        "The model lacks dry friction (coulomb_friction: 2.5 N), and t" + wrong + ": with them" + falls);
  // What is not believed is no finding, whatever the verdict.
  d.findings.pop_back();
  d.findings.front().confidence = 0.04;
  CHECK(summary(d) ==
        "It looks as if t" + wrong + ": with it" + falls + " But a confidence of 0.04 is no finding.");
  d.findings.front().lowered_by = {"the names leave a part of what there is to explain"};
  CHECK(summary(d) ==
        "It looks as if t" + wrong + ": with it" + falls +
            " But a confidence of 0.04 is no finding: the names leave a part of what there is to explain.");
}

}  // namespace furcula::diagnose
