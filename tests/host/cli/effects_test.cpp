// `furcula effects`: the catalogue as text, JSON and the documentation's page.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
using test::run_furcula;

TEST_CASE("one effect is told with law, unit, bounds, where to look and the experiment that shows it") {
  const test::Ran ran = run_furcula({"effects", "coulomb_friction", "--kind", "rotary_joint"});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Contains("-Fc sgn(v)") && Contains("torque_nm, in N m, from 0 to") &&
                          Contains("look at") && Contains("experiment"));
  // The motor of a hopper turns: what the model file of one takes.
  CHECK_THAT(run_furcula({"effects", "torque_saturation", "--kind", "hopper_linear"}).out,
             Contains("limit_nm, in N m"));
  CHECK_THAT(run_furcula({"effects", "torque_saturation", "--kind", "hopper_linear", "--json"}).out,
             Contains("\"limit_nm\""));
  CHECK_THAT(run_furcula({"effects", "coulomb_friction"}).out,
             Contains("force_n (torque_nm on a rotary joint)"));
}

TEST_CASE("a kind has the effects that its machine can have") {
  const test::Ran axis = run_furcula({"effects", "--kind", "motor_axis"});
  CHECK_THAT(axis.out, Contains("force_offset") && !Contains("spring_preload") && !Contains("torque_nm"));
  CHECK_THAT(run_furcula({"effects", "--kind", "hopper_linear"}).out, Contains("spring_preload"));
}

TEST_CASE("an axis has no stance and flight, so its effects have no phase") {
  CHECK_THAT(run_furcula({"effects", "coulomb_friction"}).out, Contains("mechanism, flight+stance"));
  CHECK_THAT(run_furcula({"effects", "coulomb_friction", "--kind", "motor_axis"}).out, !Contains("stance"));
  const auto phase = [](const std::string& kind) {
    const auto all = nlohmann::json::parse(run_furcula({"effects", "--json", "--kind", kind}).out);
    return all["effects"][0].contains("phase");
  };
  CHECK(phase("hopper_linear"));
  CHECK_FALSE(phase("rotary_joint"));
}

TEST_CASE("the JSON has every effect with its bounds, and null where no value means absence") {
  const auto json = nlohmann::json::parse(run_furcula({"effects", "--json"}).out);
  CHECK(json["schema"] == "furcula-effects/1");
  CHECK(json["effects"][0]["effect"] == "coulomb_friction");
  CHECK(json["effects"][0]["parameters"][0]["neutral"] == 0.0);
  CHECK(json["effects"][0]["parameters"][0]["rotary_name"] == "torque_nm");
  CHECK(json["effects"][1]["parameters"][2]["neutral"].is_null());
  const auto one = nlohmann::json::parse(run_furcula({"effects", "stiffness_error", "--json"}).out);
  REQUIRE(one["effects"].size() == 1);
  CHECK(one["effects"][0]["kinds"] == nlohmann::json::array({"hopper_linear", "hopper_nonlinear"}));
}

TEST_CASE("without an effect its parameter is what the machine does then") {
  const auto without = [](const std::string& effect, const std::string& kind = "") {
    std::vector<std::string> arguments{"effects", effect};
    if (!kind.empty()) arguments.insert(arguments.end(), {"--kind", kind});
    const std::string out = run_furcula(arguments).out, mark = "without the effect: ";
    const auto at = out.find(mark);
    REQUIRE(at != std::string::npos);
    return out.substr(at + mark.size(), out.find('\n', at) - at - mark.size());
  };
  // A ground that does not give has no stiffness, least of all the spring's.
  CHECK(without("ground_compliance") == "any");
  CHECK(without("late_catch") == "the model's catch_delay_s");
  CHECK(without("auxiliary_spring") == "the model's auxiliary_stiffness_npm");
  // A hopper has a damping of the guide and one of the leg; the effect comes on top of the guide's.
  CHECK(without("damping_error") == "the model's; 0 on a hopper");
  CHECK(without("damping_error", "hopper_linear") == "0");
  CHECK(without("damping_error", "rotary_joint") == "the model's");
  CHECK(without("mass_error", "rotary_joint") == "the model's");
  CHECK(without("stiffness_error") == "the model's");
  const auto neutral = [](const std::string& kind) {
    const auto json =
        nlohmann::json::parse(run_furcula({"effects", "damping_error", "--json", "--kind", kind}).out);
    return json["effects"][0]["parameters"][0]["neutral"];
  };
  CHECK(neutral("hopper_nonlinear") == 0.0);
  CHECK(neutral("motor_axis").is_null());
}

TEST_CASE("docs/effects.md is what the catalogue says (furcula effects --markdown > docs/effects.md)") {
  std::ostringstream page;
  page << std::ifstream(test::source("docs/effects.md")).rdbuf();
  CHECK(page.str() == run_furcula({"effects", "--markdown"}).out);
}

TEST_CASE("a robot of several joints has effects on seats, with names for both sorts of joints") {
  const test::Ran one = run_furcula({"effects", "coulomb_friction", "--kind", "tree"});
  CHECK(one.status == 0);
  CHECK_THAT(one.out, Contains("location    joint") && Contains("torque_nm (force_n on a prismatic joint)"));
  const auto all = nlohmann::json::parse(run_furcula({"effects", "--kind", "tree", "--json"}).out);
  CHECK(all["effects"].size() > 20);
  const test::Ran wrong = run_furcula({"effects", "colomb_friction", "--kind", "tree"});
  CHECK(wrong.status == 2);
  CHECK_THAT(wrong.err, Contains("on tree") && Contains("did you mean 'coulomb_friction'?"));
  CHECK(run_furcula({"effects", "--kind", "tree", "--markdown"}).status == 2);
}

TEST_CASE("an effect that only robots of several joints have needs no kind") {
  const test::Ran one = run_furcula({"effects", "load_friction"});
  CHECK(one.status == 0);
  CHECK(one.out == run_furcula({"effects", "load_friction", "--kind", "tree"}).out);
  CHECK_THAT(one.out, Contains("location    joint") && Contains("ratio, in 1, from 0 to 0.95"));
  CHECK(nlohmann::json::parse(
            run_furcula({"effects", "load_friction", "--json"}).out)["effects"][0]["location_type"] ==
        "joint");
  CHECK(run_furcula({"effects", "load_friction", "--markdown"}).status == 2);
  CHECK(run_furcula({"effects", "load_friction", "--kind", "rotary_joint"}).status == 2);
  CHECK_THAT(run_furcula({"effects", "load_fricton"}).err, Contains("did you mean 'load_friction'?"));
  CHECK_THAT(run_furcula({"effects", "coulomb_friction"}).out, Contains("on a tree   location type joint"));
  CHECK_THAT(run_furcula({"effects"}).out, Contains("\nbump_stop\n") && Contains("\nload_friction\n"));
}

TEST_CASE(
    "the page of effects has every effect of trees: seat, law, parameters on both sorts of joints, and words") {
  const std::string page = run_furcula({"effects", "--markdown"}).out;
  const auto at = page.find("\n# Effects on robots of several joints\n");
  REQUIRE(at != std::string::npos);
  const std::string trees = page.substr(at);
  const auto all = nlohmann::json::parse(run_furcula({"effects", "--kind", "tree", "--json"}).out);
  for (const auto& e : all["effects"]) {
    const auto name = e["effect"].get<std::string>();
    INFO(name);
    CHECK_THAT(trees, Contains("| [`" + name + "`](#" + name + ") | " +
                               e["location_type"].get<std::string>() + " | "));
    for (const auto& p : e["parameters"])
      CHECK_THAT(trees, Contains("`" + p["name"].get<std::string>() + "`") &&
                            Contains("`" + p["linear_name"].get<std::string>() + "`"));
    // Every link has its heading, once: with the words, above or here.
    const auto heading = page.find("\n## " + name + "\n");
    REQUIRE(heading != std::string::npos);
    CHECK(page.find("\n## " + name + "\n", heading + 1) == std::string::npos);
    CHECK(page.find(e["explanation"].get<std::string>(), heading) < page.find("\n## ", heading + 1));
  }
}
