// The rig's devices with what breaks on the bus.
#include "host/rig/devices.hpp"

#include <linux/can/error.h>

#include <catch2/catch.hpp>
#include <vector>

#include "furcula/bus/motor_frames.hpp"
#include "host/safety/trial.hpp"
#include "host/sim/simulate.hpp"

using namespace furcula;
using sim_host::RigFault;

namespace {

const bus::Frame kEnter{0x001, 8, false, false, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc}};

/// A robot held at its start, on which something is broken from the first tick on, and its devices.
struct Bench {
  explicit Bench(std::optional<RigFault> broken) : rig(config(broken)) {
    static_cast<void>(rig.wait_for_tick());
  }

  static sim_host::RigConfig config(std::optional<RigFault> broken) {
    sim::Scenario scenario = safety::hopping(1.0);
    if (broken) scenario.faults = {{0.0, *broken, 10.0}};
    return sim::rig_config(safety::robot(), scenario, 1);
  }
  /// A tick on which the board says `frames`. @returns how many frames it got: two encoders', the supply's, and replies.
  std::size_t tick(const std::vector<bus::Frame>& frames) {
    got.clear();
    devices.begin_tick(rig, true);
    for (const bus::Frame& frame : frames) CHECK(devices.hear(frame));
    return got.size();
  }
  std::size_t command() { return tick({bus::pack({.torque_nm = 3.0f}, rig::kMotor, 1).value()}); }

  sim_host::SimBoard rig;
  std::vector<bus::Frame> got;
  std::vector<std::uint32_t> errors;
  rig::Devices devices{[this](const bus::Frame& frame) { got.push_back(frame); },
                       [this](std::uint32_t classes) { errors.push_back(classes); }, true};
};

}  // namespace

TEST_CASE(
    "on a sound bus both encoders and the supply speak on each tick, the drive answers at once and obeys") {
  Bench bench({});
  CHECK(bench.tick({kEnter}) == 4);
  CHECK(bench.command() == 4);
  CHECK(bench.devices.torque_nm() == Approx(3.0).margin(0.01));
  CHECK(bench.errors.empty());
  CHECK_FALSE(bench.devices.hear({0x123, 8, false, false, {}}));
}

TEST_CASE("a drive that hears nothing for more than 5 ms is off by itself") {
  Bench bench({});
  bench.tick({kEnter});
  bench.command();
  for (int i = 0; i < 5; ++i) bench.tick({});
  CHECK(bench.devices.drive().on());
  bench.tick({});
  CHECK_FALSE(bench.devices.drive().on());
  CHECK(bench.devices.torque_nm() == 0.0f);
}

TEST_CASE("frames that are lost come nowhere, late ones two ticks later, repeated ones twice") {
  Bench lost(RigFault::frame_lost);
  CHECK(lost.tick({kEnter}) == 0);
  CHECK_FALSE(lost.devices.drive().on());
  Bench late(RigFault::frame_late);
  CHECK(late.tick({kEnter}) == 0);
  CHECK(late.tick({}) == 0);
  CHECK(late.tick({}) == 3);  // the sensors' of the first tick; the drive's reply has its own way to go
  CHECK(late.devices.drive().on());
  Bench twice(RigFault::frame_repeated);
  CHECK(twice.tick({kEnter}) == 10);  // two encoders, the supply, and two answers to two commands, twice each
}

TEST_CASE("of corrupted frames the board gets error frames, and after 32 it is off the bus") {
  Bench bench(RigFault::frame_corrupted);
  for (int i = 0; i < 31; ++i) CHECK(bench.tick({kEnter}) == 0);
  REQUIRE(bench.errors.size() == 31);
  for (const std::uint32_t e : bench.errors) CHECK((e & CAN_ERR_BUSERROR) != 0);
  bench.tick({});
  CHECK((bench.errors.back() & CAN_ERR_BUSOFF) != 0);
}

TEST_CASE("a bus that is off says so once") {
  Bench bench(RigFault::bus_off);
  for (int i = 0; i < 10; ++i) CHECK(bench.tick({kEnter}) == 0);
  REQUIRE(bench.errors.size() == 1);
  CHECK(bench.errors[0] == CAN_ERR_BUSOFF);
}

TEST_CASE("a broken drive gives no torque: a dead one is silent, another answers, with or without an error") {
  for (const RigFault broken : {RigFault::drive_silent, RigFault::drive_error, RigFault::drive_off}) {
    Bench bench(broken);
    const std::size_t got = bench.tick({kEnter});
    bench.command();
    CHECK(bench.devices.torque_nm() == 0.0f);
    CHECK(got == (broken == RigFault::drive_silent ? 3 : 4));
    if (broken == RigFault::drive_silent) continue;
    const auto reply = bus::unpack_reply(bench.got.back(), rig::kMotor, 1);
    REQUIRE(reply.ok());
    CHECK((reply.value().error != 0) == (broken == RigFault::drive_error));
  }
}

TEST_CASE("a lost peer is the sensors alone") {
  Bench bench(RigFault::peer_lost);
  CHECK(bench.tick({kEnter}) == 1);
}

TEST_CASE(
    "a drive that is hot, has an offset, or is another motor's says so in its replies as a real one would") {
  const auto reply_of = [](RigFault broken, bus::Motor motor) {
    Bench bench(broken);
    bench.tick({kEnter});
    bench.command();
    bench.devices.show_torque(bench.devices.torque_nm());
    bench.command();
    return bus::unpack_reply(bench.got.back(), motor, 1).value();
  };
  CHECK(reply_of(RigFault::drive_hot, rig::kMotor).temperature == 110);
  CHECK(reply_of(RigFault::torque_offset, rig::kMotor).torque_nm == Approx(4.2).margin(0.02));
  // 3 N m of 18 is 2 of an AK80-6's 12, which reports it in its own range: 3 of 18 again.
  CHECK(reply_of(RigFault::drive_of_other_motor, bus::Motor::ak80_6).torque_nm == Approx(2.0).margin(0.02));
  CHECK(reply_of(RigFault::drive_of_other_motor, rig::kMotor).torque_nm == Approx(3.0).margin(0.02));
}

TEST_CASE("a second drive with the node id of the first answers each frame from its own place") {
  Bench bench(RigFault::drive_doubled);
  CHECK(bench.tick({kEnter}) == 5);
  CHECK(bus::unpack_reply(bench.got.back(), rig::kMotor, 1).value().position_rad ==
        Approx(1.0).margin(0.001));
}

TEST_CASE("a supply that is too high is in the frame of its node") {
  Bench bench(RigFault::supply_high);
  bench.tick({});
  using bus::message::kSupply;
  REQUIRE(bus::is(bench.got.back(), kSupply, rig::kSupplyNode));
  CHECK(bus::get(bench.got.back(), bus::signal(kSupply, "Voltage")).value() == 60.0f);
}
