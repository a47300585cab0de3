// The rig's devices against the link that a board has to them, and frames written out by hand.
#include "host/rig/peers.hpp"

#include <catch2/catch.hpp>

#include "firmware/app/can_link.hpp"
#include "furcula/bus/motor_frames.hpp"

using namespace furcula;

TEST_CASE("the drive obeys torques only between being switched on and off, and answers each frame") {
  rig::Drive drive;
  const auto torque = bus::pack({.torque_nm = 3.0f}, rig::kMotor, 1).value();
  REQUIRE(drive.receive(torque, 0.4f, 0.0f));
  CHECK(drive.torque_nm() == 0.0f);
  const bus::Frame enter{0x001, 8, false, false, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc}};
  const bus::Frame exit{0x001, 8, false, false, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfd}};
  REQUIRE(drive.receive(enter, 0.4f, 0.0f));
  CHECK(drive.on());
  const auto reply = drive.receive(torque, 0.4f, 1.5f);
  REQUIRE(reply);
  CHECK(drive.torque_nm() == Approx(3.0).margin(36.0 / 4095.0));
  const auto read = bus::unpack_reply(*reply, rig::kMotor, 1);
  REQUIRE(read.ok());
  CHECK(read.value().position_rad == Approx(0.4).margin(25.0 / 65535.0));
  CHECK(read.value().torque_nm == Approx(1.5).margin(36.0 / 4095.0));
  CHECK(read.value().error == 0);
  REQUIRE(drive.receive(exit, 0.4f, 0.0f));
  CHECK(drive.torque_nm() == 0.0f);
  CHECK_FALSE(drive.receive({0x123, 8, false, false, {}}, 0.0f, 0.0f));
  CHECK(drive.complaint().empty());
}

TEST_CASE("a stiffness or a damping told to the drive is complained of") {
  rig::Drive drive;
  drive.receive(bus::pack({.damping_nmspr = 1.0f}, rig::kMotor, 1).value(), 0.0f, 0.0f);
  CHECK_THAT(drive.complaint(), Catch::Contains("stiffness or a damping"));
}

TEST_CASE("a board's link hears drive, encoders and host of the rig") {
  firmware::CanLinkConfig config;
  config.cable_node = rig::kCableNode;
  firmware::CanLink link(config);
  link.set_home(100, 0.3f, 5);
  rig::Drive drive;
  rig::EncoderNode height(rig::kHeightNode), cable(rig::kCableNode);
  rig::Host host;
  for (const bus::Frame& frame : link.command({}, false))
    if (const auto reply = drive.receive(frame, 0.5f, 0.0f)) link.receive(*reply, 1000);
  link.receive(height.sample(4294967295u, 0, true), 1000);
  link.receive(cable.sample(7, 0, true), 1000);
  link.receive(host.command(rig::Host::Request::hop, 2.5f, 0.25f, true), 1000);
  const auto sample = link.sample(1000);
  REQUIRE(sample.ok());
  CHECK(sample.value().height_count == 4294967295u);
  CHECK(sample.value().cable_count == 7);
  CHECK(sample.value().leg_angle_rad == Approx(0.5).margin(25.0 / 65535.0));
  CHECK(sample.value().reported_fault == 0);
  const firmware::CanRequest request = link.take_request();
  CHECK(request.kind == firmware::CanRequest::Kind::hop);
  CHECK(request.torque_amplitude_nm == Approx(2.5));
  CHECK(request.torque_period_s == Approx(0.25));
  CHECK(request.release_in_flight);
  // An encoder that is not homed says so.
  link.receive(height.sample(1, 0, false), 2000);
  CHECK_FALSE(is_finite(link.sample(2000).value().home_height_m));
}
