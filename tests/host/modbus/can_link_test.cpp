// The client over CAN: what it reads and does is what it reads and does over Modbus, lost frames or not.
#include "host/modbus/can_link.hpp"

#include <catch2/catch.hpp>

#include "host/core/error.hpp"
#include "host/modbus/client.hpp"
#include "tests/host/modbus/can_bus.hpp"
#include "tests/host/modbus/robot.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

struct Pair {
  test::Robot robot;
  test::CanBus bus;

  Pair() {
    bus.tick = [this] { robot.rig.advance(1); };
    bus.answer = [this](std::span<const std::uint8_t> request) { return robot.rig.answer(request); };
    robot.rig.advance(1500);
  }
  modbus::Client over_tcp() const { return modbus::Client(modbus::parse_port(robot.port())); }
};

const bus::Parameter& parameter(const char* name) { return *bus::parameter_named(name); }

}  // namespace

TEST_CASE("names, parameters and faults are over CAN what they are over Modbus") {
  Pair pair;
  modbus::Client can = pair.bus.connect(), tcp = pair.over_tcp();
  const modbus::DeviceNames names = can.names(), same = tcp.names();
  CHECK(names.vendor == "Furcula");
  CHECK(names.board == same.board);
  CHECK(names.revision == same.revision);
  CHECK(can.parameters() == tcp.parameters());
  CHECK(can.faults().size() == tcp.faults().size());
  CHECK(can.trial_number() == 0);
  const bus::Snapshot s = can.snapshot();
  CHECK(s.board_id == bus::board_id("sim_host"));
  CHECK(s.firmware_version == 0x090807);
  CHECK(s.state == static_cast<int>(bus::NodeState::idle));
}

TEST_CASE("over CAN a robot is armed, hops and stops, and its refusals are told in words") {
  Pair pair;
  modbus::Client can = pair.bus.connect();
  pair.robot.rig.advance(1500);
  CHECK_THROWS_WITH(can.request(bus::Request::hop), Contains("hop: refused: Not taken in the state"));
  can.write(parameter("torque_amplitude_nm"), 1.5f);
  CHECK(can.parameters()[parameter("torque_amplitude_nm").number - 1u] == 1.5f);
  CHECK_THROWS_WITH(can.write(parameter("torque_amplitude_nm"), 99.0f),
                    Contains("torque_amplitude_nm: refused: A parameter's value"));
  can.request(bus::Request::arm);
  can.request(bus::Request::hop);
  pair.robot.rig.advance(500);
  CHECK(can.snapshot().state == static_cast<int>(bus::NodeState::running));
  CHECK_THROWS_AS(can.write(parameter("torque_amplitude_nm"), 2.0f), modbus::Refused);
  can.request(bus::Request::stop);
  CHECK(can.snapshot().reason == static_cast<int>(bus::Reason::stopped));
}

TEST_CASE("whichever frame is lost, the client asks again, and what was done is not done twice") {
  // Of a connection, a read of 71 registers, an arming and a hop: every frame once.
  int frames = 0;
  {
    Pair pair;
    modbus::Client can = pair.bus.connect();
    can.snapshot();
    can.request(bus::Request::arm);
    can.request(bus::Request::hop);
    frames = pair.bus.frames;
  }
  CHECK(frames == 2 + 37 + 2 * 4);
  for (int lost = 1; lost <= frames; ++lost) {
    INFO("frame " << lost);
    Pair pair;
    pair.bus.loses = [lost](int frame) { return frame == lost; };
    modbus::Client can = pair.bus.connect();
    CHECK(can.snapshot().unique_id_2 == 0);
    can.request(bus::Request::arm);
    can.request(bus::Request::hop);
    const bus::Snapshot s = pair.robot.rig.snapshot();
    CHECK(s.state == static_cast<int>(bus::NodeState::running));
    CHECK(s.requests_taken == 2);
    CHECK(s.requests_refused == 0);
  }
}

TEST_CASE("what is read is of one tick also where the answer had to be asked for again") {
  Pair pair;
  modbus::Client can = pair.bus.connect();
  int seen = 0;
  pair.bus.loses = [&](int) { return ++seen == 20; };
  const std::uint32_t began = pair.robot.rig.snapshot().uptime_ms;
  const bus::Snapshot s = can.snapshot();
  // The second answer, asked for at the gap: 18 frames and a gap later.
  CHECK(s.uptime_ms >= began + 19);
  CHECK(s.uptime_ms <= began + 25);
  CHECK(pair.bus.requests == 3);
}

TEST_CASE("a bus on which nothing answers, or nothing can be sent, ends after three tries with a message") {
  Pair pair;
  modbus::Client can = pair.bus.connect();
  pair.bus.loses = [](int) { return true; };
  const int before = pair.bus.requests;
  CHECK_THROWS_WITH(can.snapshot(), "can:test: reading its registers: node 1 does not answer");
  CHECK(pair.bus.requests == before + 3);
  pair.bus.takes = false;
  CHECK_THROWS_WITH(can.request(bus::Request::stop), Contains("sending a request: nothing can be sent"));
}

TEST_CASE("a node of another version of the protocol is named") {
  struct Other final : modbus::FramePort {
    bus::Frame heard;
    bool send(const bus::Frame& frame) override {
      heard = frame;
      return true;
    }
    std::optional<bus::Frame> receive(std::chrono::milliseconds,
                                      const std::function<bool(const bus::Frame&)>& wanted) override {
      bus::RegisterAnswer answer;
      answer.version = 2;
      answer.sequence = heard.data[1];
      const bus::Frame frame = bus::pack(answer, 5);
      return wanted(frame) ? std::optional(frame) : std::nullopt;
    }
  };
  CHECK_THROWS_WITH(
      modbus::Client("can:x@5", std::make_unique<modbus::CanLink>("can:x@5", std::uint8_t{5}, std::uint8_t{0},
                                                                  std::make_unique<Other>())),
      "can:x@5: node 5 speaks version 2 of the protocol; expected 1");
}

TEST_CASE("an interface that is not there is named") {
  CHECK_THROWS_AS(modbus::Client(modbus::parse_port("can:nowhere7")), core::DataError);
  CHECK_THROWS_WITH(modbus::Client(modbus::parse_port("can:nowhere7")),
                    Contains("can:nowhere7: ") && (Contains("SocketCAN") || Contains("no CAN interface")));
}
