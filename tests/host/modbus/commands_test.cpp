// The commands that talk to a robot, as a person runs them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "furcula/bus/node_words.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/modbus/robot.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("furcula monitor shows why a robot does not move, in words and as JSON") {
  test::Robot robot;
  robot.rig.advance(200);
  const test::Ran ran = test::run_furcula({"monitor", "--once", "--port", robot.port()});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Contains("sim_host, 9.8.7 build 6") && Contains("state      idle, fault none") &&
                          Contains("why not    Nobody has told it to hop: arm it, then hop."));
  const test::Ran json = test::run_furcula({"monitor", "--once", "--json", "--port", robot.port()});
  const auto shown = nlohmann::json::parse(json.out);
  CHECK(shown.at("state_name") == "idle");
  CHECK(shown.at("uptime_ms") == 199);
  CHECK(shown.at("height_m").get<double>() == Approx(robot.rig.snapshot().height_m));
  CHECK(shown.at("starts") == 1);
  CHECK(shown.at("reset_cause_name") == "unknown");
  CHECK(shown.at("unique_id") == std::string(24, '0'));
  CHECK(shown.at("faults").empty());
}

TEST_CASE("furcula monitor shows the log of faults") {
  test::Robot robot("", "127.0.0.1", 0.5);
  robot.rig.advance(1000);
  const test::Ran ran = test::run_furcula({"monitor", "--once", "--port", robot.port()});
  CHECK_THAT(ran.out, Contains("fault log  peer_lost in start 1 at 0.50"));
  const auto shown =
      nlohmann::json::parse(test::run_furcula({"monitor", "--once", "--json", "--port", robot.port()}).out);
  REQUIRE(shown.at("faults").size() == 1);
  CHECK(shown.at("faults")[0].at("fault") == 3);
  CHECK(shown.at("faults")[0].at("tick").get<int>() == Approx(500).margin(3));
}

TEST_CASE("furcula serve says which build it is") {
  const test::Ran ran = test::run_furcula({"serve", "--tcp-port", "0", "--duration", "0.1"});
  CHECK_THAT(ran.out, Catch::Matches("(.|\n)*, build [0-9a-f]{8}\n(.|\n)*"));
  CHECK_THAT(ran.out, !Contains("build 00000000"));
}

TEST_CASE("furcula param and furcula request do what they say, and end with the status of a refusal") {
  test::Robot robot;
  robot.rig.advance(200);
  const std::string port = robot.port();
  CHECK(test::run_furcula({"param", "set", "torque_amplitude_nm", "2.75", "--port", port}).status == 0);
  CHECK(test::run_furcula({"param", "get", "torque_amplitude_nm", "--port", port}).out == "2.75\n");
  CHECK_THAT(test::run_furcula({"param", "list", "--port", port}).out, Contains("torque_amplitude_nm"));
  const auto list = nlohmann::json::parse(test::run_furcula({"param", "list", "--json", "--port", port}).out);
  CHECK(list.size() == bus::kParameters.size());
  CHECK(list.at("torque_amplitude_nm") == 2.75);

  CHECK(test::run_furcula({"request", "hop", "--for", "0", "--port", port}).status == 0);
  robot.rig.advance(10);
  CHECK(robot.rig.snapshot().state == static_cast<int>(bus::NodeState::running));
  const test::Ran refused = test::run_furcula({"param", "set", "torque_amplitude_nm", "1", "--port", port});
  CHECK(refused.status == 4);
  CHECK_THAT(refused.err,
             Contains("torque_amplitude_nm: refused: Not taken in the state that the node is in."));
  CHECK(test::run_furcula({"request", "stop", "--port", port}).status == 0);
  CHECK(test::run_furcula({"param", "save", "--port", port}).status == 4);  // nowhere to keep them
}

TEST_CASE("furcula request hop keeps the robot hopping for as long as it is told, and stops it") {
  test::Robot robot;
  robot.rig.advance(200);
  robot.ticks_a_request = 1000;  // from one look to the next; without a look it would stop after 2 s
  const test::Ran ran = test::run_furcula({"request", "hop", "--for", "0.5", "--port", robot.port()});
  CHECK(ran.status == 0);
  CHECK(robot.rig.snapshot().uptime_ms > 3000);
  CHECK(robot.rig.snapshot().reason == static_cast<int>(bus::Reason::stopped));
}

TEST_CASE("furcula request hop ends with the reason when the robot ends by itself") {
  test::Robot robot("", "127.0.0.1", 2.0);
  robot.rig.advance(200);
  robot.ticks_a_request = 100;
  const test::Ran ran = test::run_furcula({"request", "hop", "--port", robot.port()});
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("it hops no more: ") && Contains("peer_lost"));
}

TEST_CASE("what cannot be meant is told before anything is sent") {
  const std::string port = "modbus:127.0.0.1:9";
  const auto err = [](const std::vector<std::string>& arguments, int status) {
    const test::Ran ran = test::run_furcula(arguments);
    CHECK(ran.status == status);
    return ran.err;
  };
  CHECK_THAT(err({"param", "set", "torque_amplitude", "1", "--port", port}, 2),
             Contains("no parameter 'torque_amplitude' (did you mean 'torque_amplitude_nm'?)"));
  CHECK_THAT(err({"param", "set", "torque_amplitude_nm", "much", "--port", port}, 2),
             Contains("expected a number from -20 to 20 N m"));
  CHECK_THAT(err({"param", "set", "clutch_fitted", "0.5", "--port", port}, 2),
             Contains("expected a whole number from 0 to 1"));
  CHECK_THAT(err({"request", "fly", "--port", port}, 2), Contains("fly"));
  CHECK_THAT(err({"monitor", "--once", "--port", "can0"}, 2), Contains("expected modbus:/dev/NAME@BAUD"));
  CHECK_THAT(err({"monitor", "--once", "--port", port}, 3), Contains(port));
  CHECK_THAT(err({"monitor", "--once"}, 2), Contains("--port"));
}

TEST_CASE("furcula serve lives in real time for as long as it is told") {
  const test::Ran ran = test::run_furcula({"serve", "--tcp-port", "0", "--duration", "0.1"});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Contains("a simulated robot answers at modbus:127.0.0.1:"));
  CHECK(test::run_furcula({"serve", "--address", "nowhere", "--duration", "0.1"}).status == 3);
}
