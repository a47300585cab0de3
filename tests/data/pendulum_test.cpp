// A quasi-direct drive with a 0.5 m pendulum, irregularly sampled.
#include <catch2/catch.hpp>
#include <cstdio>

#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/identify/identification.hpp"
#include "host/result/diagnosis_json.hpp"
#include "tests/data/measured.hpp"

using namespace furcula;

namespace {

model::Model joint() {
  return model::parse_model(
      "[model]\nkind = \"rotary_joint\"\nschema = 1\n"
      "[parameters]\ninertia_kgm2 = 0.15\ngravity_torque_nm = 2.5\ndamping_nmspr = 0.02\n"
      "[free]\ninertia_kgm2 = [0.02, 0.5]\ngravity_torque_nm = [0.5, 6.0]\ndamping_nmspr = [0.0, 1.0]\n",
      "pendulum.toml");
}

}  // namespace

TEST_CASE("The pendulum lacks Coulomb friction first, and with it predicts another recording better",
          "[long]") {
  const std::string folder = test::data_folder();
  if (folder.empty()) return;
  const auto d = diagnose::diagnose(joint(), {test::pendulum(folder, "direct_collocation")},
                                    {test::pendulum(folder, "ddp")});
  INFO(result::to_json_text(diagnose::result_of(d)));
  REQUIRE_FALSE(d.findings.empty());
  CHECK(d.findings[0].effect == dynamics::Effect::coulomb_friction);
  const double before = d.refitted.at("angle").rmse, after = d.extended.at("angle").rmse;
  std::printf("pendulum: %.4f -> %.4f rad held-out, friction %.3f N m\n", before, after,
              d.findings[0].parameters.at("torque_nm").value);
  // An independent calculation by inverse dynamics gave 0.053 and 0.039 rad.
  CHECK(before < 0.060);
  CHECK(after < 0.039);
}

TEST_CASE("The pendulum the other way round is dry friction too, and nothing but friction and an offset",
          "[long]") {
  const std::string folder = test::data_folder();
  if (folder.empty()) return;
  const auto d = diagnose::diagnose(joint(), {test::pendulum(folder, "ddp")},
                                    {test::pendulum(folder, "direct_collocation")});
  INFO(result::to_json_text(diagnose::result_of(d)));
  REQUIRE_FALSE(d.findings.empty());
  const auto first = d.findings[0].effect;
  CHECK((first == dynamics::Effect::coulomb_friction || first == dynamics::Effect::asymmetric_friction));
  CHECK(d.extended.at("angle").rmse < 0.6 * d.refitted.at("angle").rmse);
}

TEST_CASE("Free swinging tells neither inertia nor gravity torque of the pendulum, and identify says so") {
  const std::string folder = test::data_folder();
  if (folder.empty()) return;
  const auto id = identify::identify(joint(), {test::pendulum(folder, "energy_shaping")}, {});
  for (const auto& p : id.estimations[0].parameters) {
    std::printf("energy_shaping: %s %.4g [%.4g, %.4g] %s %s\n", p.name.c_str(), p.value, p.lower, p.upper,
                p.verdict.c_str(), p.with.c_str());
    if (p.name == "inertia_kgm2") {
      CHECK(p.verdict == "correlated");
      CHECK(p.with == "gravity_torque_nm");
    }
    if (p.name == "gravity_torque_nm") CHECK(p.verdict == "correlated");
  }
}
