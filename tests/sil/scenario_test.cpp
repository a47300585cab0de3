// Scenario files: what they mean, and what is refused with which words.
#include "host/sim/scenario.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "tests/host/error_message.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

sim::Scenario parse(const std::string& text, dynamics::Kind kind = dynamics::Kind::hopper_linear) {
  model::Model model = test::example_hopper();
  if (kind != dynamics::Kind::hopper_linear) {
    model.kind = kind;
    model.parameters = {1.0, 1.0, 1.0};
  }
  return sim::parse_scenario(text, "s.toml", model);
}

std::string message(const std::string& text, dynamics::Kind kind = dynamics::Kind::hopper_linear) {
  return test::error_message([&] { parse(text, kind); });
}

}  // namespace

TEST_CASE("every key of a scenario is read") {
  const auto s = parse(R"(
[start]
height_m = 0.4
velocity_mps = -0.5
[run]
duration_s = 12.5
[torque]
profile = "constant"
amplitude_nm = -1.5
[sensors]
quantisation = true
jitter = true
[[fault]]
time_s = 2
kind = "peer_lost"
duration_s = 0.25
[[fault]]
time_s = 3.5
kind = "late_tick"
)");
  CHECK(s.start_position == 0.4);
  CHECK(s.start_velocity == -0.5);
  CHECK(s.duration_s == 12.5);
  CHECK(s.profile == control::ProfileShape::constant);
  CHECK(s.amplitude == -1.5);
  CHECK(s.sensors.quantisation);
  CHECK_FALSE(s.sensors.noise);
  CHECK_FALSE(s.sensors.bounce);
  CHECK(s.sensors.jitter);
  REQUIRE(s.faults.size() == 2);
  CHECK(s.faults[0].kind == sim_host::RigFault::peer_lost);
  CHECK(s.faults[0].time_s == 2.0);
  CHECK(s.faults[0].duration_s == 0.25);
  CHECK(s.faults[1].kind == sim_host::RigFault::late_tick);
  CHECK(s.faults[1].duration_s == 0.005);
}

TEST_CASE("what a scenario leaves out is as without one: hopping from a quarter above touch-down") {
  const auto s = parse("# nothing\n");
  CHECK(s.start_position == Approx(1.25 * test::kTouchdownM));
  CHECK(s.start_velocity == 0.0);
  CHECK(s.duration_s == 5.0);
  CHECK(s.profile == control::ProfileShape::harmonic);
  CHECK(s.amplitude == 2.0);
  CHECK(s.period_s == 0.3);
  CHECK(s.faults.empty());
}

TEST_CASE("on the other machines the keys carry their units") {
  const auto axis =
      parse("[start]\nposition_m = -0.1\n[force]\nprofile = \"harmonic\"\namplitude_n = 30\nperiod_s = 2\n",
            dynamics::Kind::motor_axis);
  CHECK(axis.start_position == -0.1);
  CHECK(axis.amplitude == 30.0);
  CHECK(axis.period_s == 2.0);
  const auto joint = parse("[start]\nangle_rad = 3\nvelocity_radps = 1\n[torque]\nprofile = \"zero\"\n",
                           dynamics::Kind::rotary_joint);
  const auto carriage = parse("[start]\nheight_m = 0\nvelocity_mps = 3\n[run]\nduration_s = 0.5\n",
                              dynamics::Kind::rail_carriage);
  CHECK(carriage.start_position == 0.0);
  CHECK(carriage.start_velocity == 3.0);
  CHECK(carriage.profile == control::ProfileShape::zero);
  CHECK(parse("", dynamics::Kind::rail_carriage).start_position == 1.0);
  CHECK(joint.start_position == 3.0);
  CHECK(joint.start_velocity == 1.0);
  CHECK(joint.profile == control::ProfileShape::zero);
}

TEST_CASE("what is not understood is refused with file, line, value and what was expected") {
  CHECK_THAT(message("[strat]\nheight_m = 1\n"),
             Contains("s.toml:1:") && Contains("'strat'") && Contains("start"));
  CHECK_THAT(message("[start]\nhieght_m = 1\n"),
             Contains("s.toml:2:") && Contains("did you mean 'height_m'"));
  CHECK_THAT(message("[start]\nheight_m = \"high\"\n"),
             Contains("s.toml:2:") && Contains("'high'") && Contains("expected a number"));
  CHECK_THAT(message("[start]\nheight_m = -1\n"), Contains("-1") && Contains("expected a number from 0.001"));
  CHECK_THAT(message("[run]\nduration_s = 0\n"),
             Contains("s.toml:2:") && Contains("expected a number from 0.001"));
  CHECK_THAT(message("[run]\nduration_s = nan\n"), Contains("expected a number"));
  CHECK_THAT(message("[torque]\namplitude_nm = 2\n"), Contains("no key 'profile'") && Contains("harmonic"));
  CHECK_THAT(message("[torque]\nprofile = \"sine\"\n"), Contains("s.toml:2:") && Contains("'sine'"));
  CHECK_THAT(message("[torque]\nprofile = \"harmonic\"\nperiod_s = 0.3\n"),
             Contains("no key 'amplitude_nm'"));
  CHECK_THAT(message("[torque]\nprofile = \"harmonic\"\namplitude_nm = 2\n"), Contains("no key 'period_s'"));
  CHECK_THAT(message("[torque]\nprofile = \"constant\"\namplitude_nm = 21\n"),
             Contains("from -20 to 20 N m"));
  CHECK_THAT(message("[sensors]\nnoise = 1\n"), Contains("s.toml:2:") && Contains("true or false"));
  CHECK_THAT(message("fault = 3\n"), Contains("s.toml:1:") && Contains("[[fault]]"));
  CHECK_THAT(message("[[fault]]\ntime_s = 1\n"), Contains("no key 'kind'") && Contains("encoder_frozen"));
  CHECK_THAT(message("[[fault]]\nkind = \"peer_lost\"\n"), Contains("no key 'time_s'"));
  CHECK_THAT(message("[[fault]]\ntime_s = 1\nkind = \"peer_lots\"\n"),
             Contains("s.toml:3:") && Contains("did you mean 'peer_lost'"));
  CHECK_THAT(message("[start\n"), Contains("s.toml:1:") && Contains("TOML"));
}

TEST_CASE("what only the hopper has is refused on an axis") {
  CHECK_THAT(message("[torque]\nprofile = \"zero\"\n", dynamics::Kind::motor_axis),
             Contains("'torque'") && Contains("motor_axis"));
  CHECK_THAT(message("[force]\nprofile = \"zero\"\n", dynamics::Kind::rail_carriage),
             Contains("'force'") && Contains("rail_carriage"));
  CHECK_THAT(message("[start]\nheight_m = -0.1\n", dynamics::Kind::rail_carriage),
             Contains("expected a number from 0 to 100 m"));
  CHECK_THAT(message("[sensors]\nbounce = true\n", dynamics::Kind::motor_axis), Contains("'bounce'"));
  CHECK_THAT(message("[[fault]]\ntime_s = 1\nkind = \"peer_lost\"\n", dynamics::Kind::rotary_joint),
             Contains("'fault'"));
}

TEST_CASE("a scenario is written as a file that reads back as the same") {
  const std::string hopper = R"(
[start]
height_m = 0.412345678901
velocity_mps = -0.5
[run]
duration_s = 12.5
[torque]
profile = "harmonic"
amplitude_nm = -1.5
period_s = 0.31
[sensors]
noise = true
jitter = true
[[fault]]
time_s = 1.25
kind = "encoder_stuck"
duration_s = 0.5
)";
  const auto again = [](const sim::Scenario& s, dynamics::Kind kind) {
    return parse(sim::format_scenario(s, kind), kind);
  };
  const auto s = parse(hopper), same = again(s, dynamics::Kind::hopper_linear);
  CHECK(same.start_position == s.start_position);
  CHECK(same.start_velocity == s.start_velocity);
  CHECK(same.duration_s == s.duration_s);
  CHECK(same.profile == s.profile);
  CHECK(same.amplitude == s.amplitude);
  CHECK(same.period_s == s.period_s);
  CHECK(same.sensors.noise);
  CHECK(same.sensors.jitter);
  CHECK(!same.sensors.quantisation);
  REQUIRE(same.faults.size() == 1);
  CHECK(same.faults[0].kind == sim_host::RigFault::encoder_stuck);
  CHECK(same.faults[0].time_s == 1.25);
  CHECK(same.faults[0].duration_s == 0.5);
  for (auto kind :
       {dynamics::Kind::motor_axis, dynamics::Kind::rotary_joint, dynamics::Kind::rail_carriage}) {
    sim::Scenario axis = parse("", kind);
    axis.start_velocity = 0.75;
    CHECK(again(axis, kind).start_velocity == 0.75);
    CHECK(again(axis, kind).amplitude == axis.amplitude);
  }
}

TEST_CASE("releases and catches of a bench's belt are read in turn, and written back") {
  const auto bench = dynamics::Kind::clutch_bench;
  const auto standard = parse("", bench);
  REQUIRE(standard.clutch.size() == 2);
  CHECK(standard.clutch[0].release);
  CHECK(standard.clutch[1].time_s == 0.14);
  const std::string text =
      "[start]\nangle_rad = 0.5\n[[clutch]]\ntime_s = 0.2\naction = \"release\"\n[[clutch]]\ntime_s = "
      "0.25\naction = \"catch\"\n[[clutch]]\ntime_s = 0.6\naction = \"release\"\n";
  for (const sim::Scenario& s :
       {parse(text, bench), parse(sim::format_scenario(parse(text, bench), bench), bench)}) {
    CHECK(s.start_position == 0.5);
    REQUIRE(s.clutch.size() == 3);
    CHECK(s.clutch[1].time_s == 0.25);
    CHECK_FALSE(s.clutch[1].release);
    CHECK(s.clutch[2].release);
  }
  CHECK_THAT(message("[[clutch]]\ntime_s = 1\naction = \"catch\"\n", bench),
             Contains("s.toml:3: action = 'catch' where the clutch is caught"));
  CHECK_THAT(
      message("[[clutch]]\ntime_s = 1\naction = \"release\"\n[[clutch]]\ntime_s = 1\naction = \"catch\"\n",
              bench),
      Contains("not after the action before it"));
  CHECK_THAT(message("[[clutch]]\ntime_s = 1\naction = \"relaese\"\n", bench),
             Contains("did you mean 'release'?"));
  CHECK_THAT(message("[start]\nvelocity_mps = 1\n", bench), Contains("unknown key 'velocity_mps'"));
  CHECK_THAT(message("[[clutch]]\ntime_s = 1\naction = \"release\"\n", dynamics::Kind::hopper_linear),
             Contains("[[clutch]] for a model without one"));
}

TEST_CASE("clutch, contraction and ground are read where the leg is free in flight, and written back") {
  const model::Model robot = test::robot_with_clutch();
  const std::string text = R"(
[clutch]
in_flight = "release"
catch_before_touchdown_s = 0.02
[contraction]
amplitude_m = 0.08
period_s = 0.3
[ground]
steps_m = 0.03
[[fault]]
time_s = 1.5
kind = "coil_stuck_on"
duration_s = 0.2
)";
  const auto check = [](const sim::Scenario& s) {
    CHECK(s.release_in_flight);
    CHECK(s.catch_before_touchdown_s == 0.02);
    CHECK(s.contraction_m == 0.08);
    CHECK(s.contraction_period_s == 0.3);
    CHECK(s.ground_steps_m == 0.03);
    REQUIRE(s.faults.size() == 1);
    CHECK(s.faults[0].kind == sim_host::RigFault::coil_stuck_on);
  };
  const sim::Scenario s = sim::parse_scenario(text, "s.toml", robot);
  check(s);
  check(sim::parse_scenario(sim::format_scenario(s, robot.kind), "again.toml", robot));

  const auto refused = [](const std::string& words, const model::Model& model) {
    return test::error_message([&] { sim::parse_scenario(words, "s.toml", model); });
  };
  model::Model without = robot;
  without.clutch.reset();
  CHECK_THAT(refused("[clutch]\nin_flight = \"release\"\n", without),
             Contains("s.toml:1: [clutch] for a model without one; expected a tooth_pitch_m above 0"));
  CHECK_THAT(refused("[[fault]]\ntime_s = 1\nkind = \"coil_open\"\n", without),
             Contains("s.toml:3: fault 'coil_open' for a model without a clutch"));
  CHECK_THAT(refused("[clutch]\nin_flight = \"relaese\"\n", robot), Contains("did you mean 'release'?"));
  CHECK_THAT(refused("[contraction]\nperiod_s = 0.4\n", robot),
             Contains("no key 'amplitude_m' in [contraction]"));
  CHECK_THAT(message("[contraction]\namplitude_m = 0.1\n"), Contains("unknown key 'contraction'"));
}
