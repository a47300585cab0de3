// libmodbus as master over TCP against our server with the simulated robot behind it.
#include "host/modbus/client.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "host/core/error.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/modbus/robot.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

const bus::Parameter& parameter(const char* name) { return *bus::parameter_named(name); }

float value(modbus::Client& client, const char* name) {
  return client.parameters()[parameter(name).number - 1u];
}

}  // namespace

TEST_CASE("a robot says who it is and what it does") {
  test::Robot robot;
  modbus::Client client(modbus::parse_port(robot.port()));
  const modbus::DeviceNames names = client.names();
  CHECK(names.vendor == "Furcula");
  CHECK(names.board == "sim_host");
  CHECK(names.revision == "9.8.7 build 6");
  CHECK(client.snapshot().state == static_cast<int>(bus::NodeState::starting));
  robot.rig.advance(1500);
  const bus::Snapshot s = client.snapshot();
  CHECK(s.state == static_cast<int>(bus::NodeState::idle));
  CHECK(s.uptime_ms == 1499);
  CHECK(s.board_id == bus::board_id("sim_host"));
  CHECK(s.firmware_version == 0x090807);
  CHECK(s.build_id == 6);
  CHECK(s.longest_interval_us == 1000);
}

TEST_CASE("armed and told to hop over the bus the simulated robot hops, and stop lets it come to rest") {
  test::Robot robot;
  modbus::Client client(modbus::parse_port(robot.port()));
  robot.rig.advance(3000);  // at rest, on its spring
  CHECK_THROWS_WITH(client.request(bus::Request::hop), Contains("hop: refused: Not taken in the state"));
  client.request(bus::Request::arm);
  client.request(bus::Request::hop);
  bus::Snapshot hopping;
  for (int s = 0; s < 6; ++s) {
    robot.rig.advance(1000);
    hopping = client.snapshot();
  }
  CHECK(hopping.state == static_cast<int>(bus::NodeState::running));
  CHECK(hopping.fault == 0);
  // The toe leaves the ground at 0.2819 m; with 2 N m the robot of 002 section 3.2.1 flies to some 0.36 m.
  CHECK(hopping.apex_height_m > 0.33f);
  CHECK(hopping.apex_height_m < 0.40f);
  CHECK_THROWS_WITH(client.write(parameter("torque_amplitude_nm"), 3.0f), Contains("Not taken in the state"));
  client.request(bus::Request::stop);
  robot.rig.advance(5000);
  const bus::Snapshot resting = client.snapshot();
  CHECK(resting.torque_nm == 0.0f);
  CHECK(std::abs(resting.velocity_mps) < 0.02f);
  CHECK(resting.reason == static_cast<int>(bus::Reason::stopped));
}

TEST_CASE("the simulated robot comes to rest when the host that made it hop is gone") {
  test::Robot robot;
  {
    modbus::Client client(modbus::parse_port(robot.port()));
    robot.rig.advance(3000);
    client.request(bus::Request::arm);
    client.request(bus::Request::hop);
  }
  robot.rig.advance(1900);
  CHECK(robot.rig.snapshot().state == static_cast<int>(bus::NodeState::running));
  CHECK(robot.rig.snapshot().apex_height_m > 0.30f);
  robot.rig.advance(102);
  CHECK(robot.rig.snapshot().reason == static_cast<int>(bus::Reason::host_silent));
  robot.rig.advance(5000);
  const bus::Snapshot resting = robot.rig.snapshot();
  CHECK(resting.torque_nm == 0.0f);
  CHECK(std::abs(resting.velocity_mps) < 0.02f);
}

TEST_CASE("parameters are written and read, refused where they must be, and kept in a file") {
  test::TemporaryFolder folder;
  const std::string file = folder.path() + "/parameters";
  {
    test::Robot robot(file);
    modbus::Client client(modbus::parse_port(robot.port()));
    robot.rig.advance(100);
    CHECK(value(client, "torque_amplitude_nm") == 2.0f);
    client.write(parameter("torque_amplitude_nm"), 2.5f);
    CHECK(value(client, "torque_amplitude_nm") == 2.5f);
    CHECK_THROWS_AS(client.write(parameter("torque_amplitude_nm"), 99.0f), modbus::Refused);
    CHECK_THROWS_WITH(client.write(parameter("tooth_play_m"), 0.01f), Contains("makes no sense"));
    client.request(bus::Request::save);
  }
  test::Robot again(file);
  modbus::Client client(modbus::parse_port(again.port()));
  CHECK(value(client, "torque_amplitude_nm") == 2.5f);
  CHECK(client.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store));
}

TEST_CASE("a damaged file of parameters leaves the defaults, and it is told") {
  test::TemporaryFolder folder;
  const std::string file = folder.file("parameters", "nothing of the kind");
  test::Robot robot(file);
  CHECK(robot.rig.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store_unusable));
  // As on a controller board: it waits for a person, who may set, save and reset.
  robot.rig.advance(1400);
  CHECK(robot.rig.snapshot().state == static_cast<int>(bus::NodeState::fault));
  CHECK(robot.rig.snapshot().fault == static_cast<int>(control::Fault::parameters_lost));
  robot.rig.advance(200);
  CHECK(robot.rig.snapshot().fault == static_cast<int>(control::Fault::parameters_lost));
  modbus::Client client(modbus::parse_port(robot.port()));
  client.request(bus::Request::save);
  client.request(bus::Request::reset);
  robot.rig.advance(100);
  CHECK(robot.rig.snapshot().state == static_cast<int>(bus::NodeState::idle));
  CHECK(test::Robot(file).rig.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store));
}

TEST_CASE("a folder in the place of the file of parameters is a damaged file, not an unexpected error") {
  const test::TemporaryFolder folder;
  test::Robot robot(folder.path());
  CHECK(robot.rig.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store_unusable));
  robot.rig.advance(1600);
  CHECK(robot.rig.snapshot().fault == static_cast<int>(control::Fault::parameters_lost));
  modbus::Client client(modbus::parse_port(robot.port()));
  CHECK_THROWS_AS(client.request(bus::Request::save), modbus::Refused);
}

TEST_CASE("a host that does not answer ends with the port's name") {
  std::string port;
  {
    const test::Robot robot;
    port = robot.port();
  }
  CHECK_THROWS_WITH(modbus::Client(modbus::parse_port(port)),
                    Contains(port) && Contains("Connection refused"));
}
