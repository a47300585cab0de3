// walk.toml and the model of a biped: there and back, and what is refused.
#include "host/walk/walk_file.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "host/walk/walker_config.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;
using Catch::Contains;

namespace {

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a walk is read as it was written") {
  Walk walk;
  walk.robot = "furcula_biped";
  walk.mode = WalkMode::semi_passive;
  walk.walk_until_s = 7.5;
  auto values = test::start_walk().values();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 1e-3 * static_cast<double>(i) / 7.0;
  walk.parameters = Parameters::of(values);
  const std::string text = format_walk(walk);
  const Walk read = parse_walk(text, "walk.toml");
  CHECK(read.robot == walk.robot);
  CHECK(read.mode == walk.mode);
  CHECK(read.walk_until_s == walk.walk_until_s);
  CHECK(read.parameters.values() == values);
  CHECK_THAT(text, Contains("[up.swing]\nhip_pitch_rad = ") && Contains("[stop]\nblend_s = "));
  CHECK_THAT(text, !Contains("command_delay_s") && !Contains("exercise_s"));
}

TEST_CASE("a walk file with an exercise has the board move the legs on the stand, in place of a walk") {
  Walk walk;
  walk.robot = "furcula_biped";
  walk.parameters = test::start_walk();
  walk.exercise_s = 12.5;
  const Walk read = parse_walk(format_walk(walk), "walk.toml");
  CHECK(read.exercise_s == 12.5);
  const auto robot = read_model(test::source("models/biped/biped.toml")).robot;
  CHECK(walker_config(robot, read, 30.0, DriveTurns::each_tick).exercise_s == 12.5f);
  CHECK_THAT(test::error_message([&] {
               parse_walk(changed(format_walk(read), "exercise_s = 12.5", "exercise_s = 1.0"), "walk.toml");
             }),
             Contains("walk.toml:6") && Contains("exercise_s") && Contains("4"));
  CHECK_THAT(test::error_message([&] { require_steps(read, "walk.toml"); }),
             Contains("walk.toml: an exercise"));
}

TEST_CASE("of a model that deviates the robot and its sensors do, and the controller knows it without") {
  const test::TemporaryFolder folder;
  const Model model = read_model(folder.file(
      "model.toml", "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
                        test::source("models/biped/furcula_biped.urdf") +
                        "\"\n[deviations]\n\"mass@pelvis\" = 0.5\n\"encoder_offset@right_knee\" = 0.004\n"
                        "\"imu_mounting_y@imu\" = 0.003\n\"gyro_bias_z@imu\" = -0.002\n"));
  const RolloutOptions o = rollout_of(model, WalkMode::active, 5.0);
  REQUIRE(o.known);
  CHECK(model.robot.pelvis.mass_kg == Approx(o.known->pelvis.mass_kg + 0.5));
  CHECK(o.known->pelvis.mass_kg == dynamics::biped::design().pelvis.mass_kg);
  CHECK(o.sensors.encoder_rad[dynamics::biped::kLegJoints + dynamics::biped::kKnee] == 0.004);
  CHECK(o.sensors.encoder_rad[dynamics::biped::kKnee] == 0.0);
  CHECK(o.sensors.imu_turn_rad.y == 0.003);
  CHECK(o.sensors.gyro_bias_radps.z == -0.002);
  CHECK(o.sensors.any());
  CHECK_FALSE(
      rollout_of(read_model(test::source("models/biped/biped.toml")), WalkMode::active, 5.0).sensors.any());
}

TEST_CASE("a walk that was searched for late drives tells the board when their torques are to be expected") {
  const Model model = read_model(test::source("models/biped/biped.toml"));
  Walk walk;
  walk.robot = model.name;
  walk.parameters = test::start_walk();
  const auto lag = [&](double delay_s) {
    walk.command_delay_s = delay_s;
    const Walk read = parse_walk(format_walk(walk), "walk.toml");
    CHECK(read.command_delay_s == delay_s);
    return walker_config(model.robot, read, 30.0, DriveTurns::over_buses).supervisor.torque_lag_ticks;
  };
  CHECK(lag(0.0) == 2);
  CHECK(lag(12.4e-3) == 14);
  CHECK(lag(kMostCommandDelay_s) == control::kTorqueLagMost);
  walk.command_delay_s = 0.1;
  CHECK_THAT(test::error_message([&] { parse_walk(format_walk(walk), "walk.toml"); }),
             Contains("walk.toml:6") && Contains("command_delay_s") && Contains("0.018"));
  Model late = model;
  late.machine.delay_s = 7e-3;
  CHECK(rollout_of(late, WalkMode::active, 5.0).command_delay_s == 7e-3);
}

TEST_CASE("a walk with a mistake is refused with file, line and what was expected") {
  Walk walk;
  walk.robot = "furcula_biped";
  walk.parameters = test::start_walk();
  const std::string good = format_walk(walk);
  const auto error = [&](const std::string& text) {
    return test::error_message([&] { parse_walk(text, "walk.toml"); });
  };
  CHECK(error(good).empty());
  CHECK_THAT(error(changed(good, "mode = \"active\"", "mode = \"activ\"")),
             Contains("walk.toml:4") && Contains("did you mean 'active'"));
  CHECK_THAT(error(changed(good, "schema = 1", "schema = 2")), Contains("schema = 2; expected 1"));
  CHECK_THAT(error(changed(good, "sway_rad", "sway_deg")), Contains("sway_deg") && Contains("sway_rad"));
  CHECK_THAT(error(changed(good, "[up.swing]\n", "[up.swings]\n")), Contains("swings"));
  CHECK_THAT(error(changed(good, "[stop]\n", "[halt]\n")), Contains("halt"));
  CHECK_THAT(error(changed(good, "time_s = 0.8", "time_s = 0.0")),
             Contains("[start] time_s") && Contains("0.01"));
  CHECK_THAT(error(changed(good, "knee_rad = 0.5", "knee_rad = 5.0")), Contains("[posture] knee_rad"));
  CHECK_THAT(error(changed(good, "knee_rad = 0.5", "knee_rad = nan")), Contains("knee_rad"));
  CHECK_THAT(error("[gait]\nschema = 1\n"), Contains("no section [walk]"));
}

TEST_CASE("the model of a biped names its URDF and may change limits") {
  const Model model = read_model(test::source("models/biped/biped.toml"));
  CHECK(model.name == "furcula_biped");
  CHECK(model.limits.torque_nm == 80.0);
  CHECK(model.robot.pelvis.mass_kg == Approx(16.2));

  test::TemporaryFolder folder;
  const std::string urdf = test::source("models/biped/furcula_biped.urdf"),
                    head = "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" + urdf + "\"\n";
  CHECK(read_model(folder.file("a.toml", head + "[limits]\ntorque_nm = 160\n")).limits.torque_nm == 160.0);
  const auto error = [&](const std::string& text) {
    return test::error_message([&] { read_model(folder.file("b.toml", text)); });
  };
  CHECK_THAT(error(head + "[limits]\ntorque = 160\n"), Contains("b.toml:6") && Contains("torque_nm"));
  CHECK_THAT(error(head + "[limits]\nspeed_radps = 0\n"), Contains("speed_radps"));
  CHECK_THAT(error("[model]\nkind = \"planar_leg\"\nschema = 1\n"), Contains("expected \"biped\""));
  CHECK_THAT(error("[model]\nkind = \"biped\"\nschema = 1\n"), Contains("no key 'urdf'"));
  CHECK_THAT(error("[model]\nkind = \"biped\"\nschema = 1\nurdf = \"none.urdf\"\n"), Contains("none.urdf"));
}

TEST_CASE("what a walk does not keep is said in words") {
  Rollout r;
  r.ending = Ending::stands;
  r.outside_m = -0.02;
  CHECK(broken_limits(r, {}).empty());
  r.torque_nm = 90.0;
  r.outside_m = 0.01;
  const auto words = broken_limits(r, {});
  REQUIRE(words.size() == 2);
  CHECK(words[0] == "a motor gives 90 N m of 80");
  CHECK_THAT(words[1], Contains("2 cm inside of the soles, where 3 cm inside are asked"));
  r.outside_m = 0.08;
  CHECK_THAT(broken_limits(r, {})[1], Contains("5 cm outside of the soles"));
  r.ending = Ending::fell;
  r.time_s = 2.5;
  CHECK(broken_limits(r, {})[0] == "fell after 2.5 s");
}
