// Model files that are read, and those that are refused: with file, line, key, value, what was expected.
#include "host/model/reader.hpp"

#include <catch2/catch.hpp>

#include "host/model/writer.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;
using Catch::Contains;
using test::kHopperModel;
using test::kJointModel;
using test::with;

namespace {

std::string refused(const std::string& text) {
  const std::string message = test::error_message([&] { model::parse_model(text, "m.toml"); });
  CHECK(message.find('\n') == std::string::npos);
  return message;
}
std::string refused(const std::string& from, const std::string& to) {
  return refused(with(kHopperModel, from, to));
}

}  // namespace

TEST_CASE("a model file gives kind, parameters, bounds and effects") {
  const model::Model m = model::parse_model(kHopperModel, "m.toml");
  CHECK(m.kind == dynamics::Kind::hopper_linear);
  CHECK(m.parameters == std::vector<double>{1.554, 605.0, 0.282, 5.0, 1.0, 0.95, 0.98, 0.15, 0.349, 9.81});
  REQUIRE(m.free.size() == 1);
  CHECK(m.free.at(0).lower == 1.2);
  CHECK(m.free.at(0).upper == 2.0);
  REQUIRE(m.effects.size() == 1);
  CHECK(m.effects.at(dynamics::Effect::coulomb_friction)[0] == 1.6);
}

TEST_CASE("on a rotary joint an effect's parameters have their rotary names") {
  const std::string text =
      kJointModel +
      "[effect.stribeck_friction]\ntorque_nm = 0.1\nstatic_torque_nm = 0.2\nvelocity_radps = 0.5\n";
  const model::Model m = model::parse_model(text, "m.toml");
  CHECK(m.effects.at(dynamics::Effect::stribeck_friction) == std::array<double, 3>{0.1, 0.2, 0.5});
  CHECK_THAT(
      refused(kJointModel + "[effect.coulomb_friction]\nforce_n = 0.1\n"),
      Contains("m.toml:9: unknown key 'force_n' in [effect.coulomb_friction]; expected one of torque_nm"));
}

TEST_CASE(
    "a hopper_nonlinear has a clutch where its tooth pitch is not zero, and the file reads back the same") {
  std::string text = with(kHopperModel, "hopper_linear", "hopper_nonlinear");
  text = with(text, "[free]",
              "inertia_a_kgm2 = 42e-4\ninertia_b_kgm = 75e-4\ninertia_e_kgm = 38e-3\nrelease_delay_s = 0.02\n"
              "auxiliary_stiffness_npm = 20.0\ntooth_pitch_m = 0.0043\n[free]");
  const model::Model m = model::parse_model(text, "m.toml");
  REQUIRE(m.clutch.has_value());
  CHECK(m.clutch->release_delay_s == 0.02);
  CHECK(m.clutch->catch_delay_s == 0.0);
  CHECK(m.clutch->auxiliary_stiffness_npm == 20.0);
  CHECK(m.clutch->tooth_pitch_m == 0.0043);
  const model::Model again = model::parse_model(model::format_model(m), "again.toml");
  REQUIRE(again.clutch.has_value());
  CHECK(again.clutch->tooth_pitch_m == 0.0043);
  CHECK_THAT(refused(with(text, "tooth_pitch_m = 0.0043\n", "")),
             Contains("auxiliary_stiffness_npm = 20.0 without a tooth_pitch_m; expected one above 0"));
  CHECK_THAT(refused(with(text, "tooth_pitch_m = 0.0043", "tooth_pitch_m = 0.2")),
             Contains("tooth_pitch_m = 0.2; expected a number from 0 to 0.1 m"));
}

TEST_CASE("zero clutch parameters mean no clutch, others are refused where there is none") {
  const model::Model m = model::parse_model(
      with(kHopperModel, "[free]", "release_delay_s = 0.0\ntooth_pitch_m = 0\n[free]"), "m.toml");
  CHECK(m.parameters.size() == 10);
  const model::Model fitted = model::parse_model(
      with(kHopperModel, "[free]",
           "catch_delay_s = 0.02\ntooth_pitch_m = 0.003\n[effect.late_catch]\ndelay_s = 0.03\n[free]"),
      "m.toml");
  REQUIRE(fitted.clutch.has_value());
  CHECK(fitted.clutch->catch_delay_s == 0.02);
  CHECK(fitted.effects.at(dynamics::Effect::late_catch)[0] == 0.03);
  CHECK_THAT(
      refused("[free]", "[effect.late_catch]\ndelay_s = 0.03\n[free]"),
      Contains(
          "m.toml:17: effect 'late_catch' in a model without a clutch; expected a tooth_pitch_m above 0"));
  CHECK_THAT(refused("[free]", "[free]\ntooth_pitch_m = [0.0, 0.01]"),
             Contains("'tooth_pitch_m' in [free]; expected no such key"));
  CHECK_THAT(refused(with(kJointModel, "damping", "tooth_pitch_m = 0\ndamping")),
             Contains("unknown key 'tooth_pitch_m'"));
}

TEST_CASE("an unknown section, key, kind or effect is refused, and the nearest name shown") {
  CHECK_THAT(refused("[free]", "[fre]"),
             Contains("m.toml:17: unknown key 'fre' in the model file; expected one of model, parameters, "
                      "free, effect (did you mean 'free'?)"));
  CHECK_THAT(refused("mass_kg = 1.554", "mass_kg = 1.554\nmas_kg = 2"),
             Contains("m.toml:7: unknown key 'mas_kg' in [parameters] of hopper_linear") &&
                 Contains("(did you mean 'mass_kg'?)"));
  CHECK_THAT(refused("schema = 1", "schema = 1\nname = \"x\""),
             Contains("m.toml:4: unknown key 'name' in [model]"));
  CHECK_THAT(refused("[free]\nmass_kg", "[free]\nweight_kg"),
             Contains("m.toml:18: unknown key 'weight_kg' in [free]"));
  CHECK_THAT(refused("coulomb_friction", "columb_friction"),
             Contains("m.toml:20: unknown effect 'columb_friction'; expected one of") &&
                 Contains("(did you mean 'coulomb_friction'?)"));
  CHECK_THAT(refused("force_n", "force"),
             Contains("m.toml:21: unknown key 'force' in [effect.coulomb_friction]"));
  CHECK_THAT(
      refused("hopper_linear", "hopper_lineal"),
      Contains(
          "m.toml:2: unknown kind 'hopper_lineal'; expected one of hopper_linear, "
          "hopper_nonlinear, motor_axis, "
          "rotary_joint, rail_carriage, clutch_bench, torsion_pendulum, tree (did you mean 'hopper_linear'?)"));
}

TEST_CASE("a clutch bench has its delays and its pitch in its table, and reads back the same") {
  const std::string text =
      "[model]\nkind = \"clutch_bench\"\nschema = 1\n\n[parameters]\nload_mass_kg = 1.0\npulley_radius_m = "
      "0.0095\npulley_inertia_kgm2 = 2e-6\ndamping_nmspr = 0.0\nauxiliary_stiffness_npm = 0.0\n"
      "tooth_pitch_m = 0.003\ntooth_height_m = 0.0018\nrelease_delay_s = 0.01\ncatch_delay_s = 0.012\n\n"
      "[free]\ncatch_delay_s = [0.0, 0.06]\n\n[effect.clutch_slip]\nholding_force_n = 20.0\n";
  const model::Model m = model::parse_model(text, "m.toml");
  CHECK(m.parameter("catch_delay_s") == 0.012);
  CHECK(m.effects.at(dynamics::Effect::clutch_slip)[0] == 20.0);
  const model::Model again = model::parse_model(model::format_model(m), "again.toml");
  CHECK(again.parameters == m.parameters);
  CHECK(again.free.size() == 1);
  CHECK(again.effects == m.effects);
  CHECK_THAT(refused(with(text, "tooth_pitch_m = 0.003", "tooth_pitch_m = 0")),
             Contains("m.toml:11: tooth_pitch_m = 0; expected a number from 1e-04 to 0.1 m"));
  CHECK_THAT(refused(with(text, "clutch_slip]\nholding_force_n", "incomplete_release]\nratio")),
             Contains("'incomplete_release' does not exist on clutch_bench"));
}

TEST_CASE("what is missing is named, with what was expected") {
  CHECK_THAT(refused("schema = 1\n", ""),
             Contains("m.toml:1: no key 'schema' in [model]; expected schema = 1"));
  CHECK_THAT(refused("kind = \"hopper_linear\"\n", ""),
             Contains("no key 'kind' in [model]; expected one of hopper_linear"));
  CHECK_THAT(refused("mass_kg = 1.554\n", ""),
             Contains("m.toml:5: no key 'mass_kg' in [parameters]; expected a number from 0.001 to 1000 kg "
                      "(mass of body and leg)"));
  CHECK_THAT(
      refused("force_n = 1.6\n", ""),
      Contains(
          "m.toml:20: no key 'force_n' in [effect.coulomb_friction]; expected a number from 0 to 10000 N"));
  CHECK_THAT(refused("[model]\nkind = \"hopper_linear\"\nschema = 1\n"), Contains("no section [parameters]"));
  CHECK_THAT(refused("\n"), Contains("m.toml:1: no section [model]"));
}

TEST_CASE("a value of the wrong type is refused") {
  CHECK_THAT(refused("1.554", "\"1.554\""), Contains("m.toml:6: mass_kg is '1.554'; expected a number"));
  CHECK_THAT(refused("[1.2, 2.0]", "true"),
             Contains("m.toml:18: [free] mass_kg is true; expected two numbers, [lower, upper]"));
  CHECK_THAT(refused("[1.2, 2.0]", "[1.2, 1.6, 2.0]"),
             Contains("m.toml:18: [free] mass_kg is an array of 3; expected two numbers"));
  CHECK_THAT(refused("[1.2, 2.0]", "[1.2, \"2\"]"),
             Contains("[free] mass_kg upper bound is '2'; expected a number"));
  CHECK_THAT(refused("schema = 1", "schema = 2"), Contains("m.toml:3: schema = 2; expected 1"));
  CHECK_THAT(refused("schema = 1", "schema = 1.0"), Contains("m.toml:3: schema = 1.0; expected 1"));
  CHECK_THAT(refused("\"hopper_linear\"", "1"), Contains("m.toml:2: kind is 1; expected a string"));
  CHECK_THAT(refused("[effect.coulomb_friction]\nforce_n = 1.6", "[effect]\ncoulomb_friction = 1.6"),
             Contains("[effect.coulomb_friction] is 1.6; expected a table"));
  CHECK_THAT(refused("effect = 3\n" + kHopperModel.substr(0, kHopperModel.find("[effect"))),
             Contains("m.toml:1: [effect] is 3; expected a table"));
}

TEST_CASE("a value outside of its physical bounds is refused, NaN and infinity too") {
  CHECK_THAT(refused("1.554", "-1.554"),
             Contains("m.toml:6: mass_kg = -1.554; expected a number from 0.001 to 1000 kg"));
  CHECK_THAT(refused("1.554", "nan"), Contains("m.toml:6: mass_kg = nan; expected a number"));
  CHECK_THAT(refused("1.554", "inf"), Contains("m.toml:6: mass_kg = inf; expected a number"));
  CHECK_THAT(refused("force_n = 1.6", "force_n = -1"),
             Contains("m.toml:21: [effect.coulomb_friction] force_n = -1; expected a number from 0"));
}

TEST_CASE("bounds the wrong way round, or without the value, are refused") {
  CHECK_THAT(refused("[1.2, 2.0]", "[2.0, 1.2]"),
             Contains("m.toml:18: [free] mass_kg = [2, 1.2]: the bounds are the wrong way round or equal; "
                      "expected lower < upper"));
  CHECK_THAT(refused("[1.2, 2.0]", "[1.6, 2.0]"),
             Contains("m.toml:18: [free] mass_kg = [1.6, 2] does not hold the parameter's value 1.554"));
  CHECK_THAT(refused("[1.2, 2.0]", "[-1, 2.0]"),
             Contains("m.toml:18: [free] mass_kg lower bound = -1; expected a number from 0.001"));
}

TEST_CASE("an effect that this kind does not have is refused") {
  CHECK_THAT(
      refused(kJointModel + "[effect.spring_preload]\nforce_n = 1\n"),
      Contains(
          "m.toml:8: effect 'spring_preload' does not exist on rotary_joint; expected one of coulomb_friction"));
}

TEST_CASE("what is no TOML, or no file, is refused") {
  CHECK_THAT(refused("mass_kg = 1.554", "mass_kg = 1.5.54"), Contains("m.toml:6: no valid TOML"));
  CHECK_THAT(refused("mass_kg = 1.554", "mass_kg = 1.554\nmass_kg = 2"), Contains("m.toml:7: no valid TOML"));
  test::TemporaryFolder folder;
  const auto message = [](const std::string& path) {
    return test::error_message([&] { model::read_model(path); });
  };
  CHECK_THAT(message(folder.path()), Contains("is a directory; expected a model file (TOML)"));
  CHECK_THAT(message(folder.path() + "/none"), Contains("/none: cannot be read: No such file or directory"));
  CHECK_THAT(message(folder.file("empty", "")),
             Contains("empty:1: the file is empty; expected a model file"));
  CHECK_THAT(message(folder.file("zeros", std::string(100, '\0'))),
             Contains("zeros: byte 1 is NUL, so this is no text"));
  CHECK_THAT(message(folder.file("large", std::string(2 << 20, '\n'))),
             Contains("large: the file is larger than 1 MiB"));
}
