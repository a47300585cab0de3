// The mini-cheetah's command and reply: bytes by hand, ends of ranges, every step of every field.
#include "furcula/bus/motor_frames.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace furcula;
using namespace furcula::bus;
using Bytes = std::array<std::uint8_t, 8>;

TEST_CASE("a command of zeros is 7FFF 7FF 000 000 7FF for every motor") {
  for (const MotorInfo& motor : kMotors) {
    INFO(std::string(motor.name));
    CHECK(pack({}, motor.motor, 1).value().data == Bytes{0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0xff});
  }
}

TEST_CASE("a command's bytes are those calculated by hand") {
  // AK80-9: 12.5, 50 and 18 to each side. Position 5: (5 + 12.5) 65535 / 25 = 45874.5, to 45874 = B332.
  // Velocity -10: (50 - 10) 4095 / 100 = 1638 = 666. kp 100: 100 * 4095 / 500 = 819 = 333.
  // kd 1: 4095 / 5 = 819 = 333. Torque 6: (6 + 18) 4095 / 36 = 2730 = AAA.
  const Frame frame = pack({5.0f, -10.0f, 100.0f, 1.0f, 6.0f}, Motor::ak80_9, 7).value();
  CHECK(frame.id == 7);
  CHECK(frame.size == 8);
  CHECK(frame.data == Bytes{0xb3, 0x32, 0x66, 0x63, 0x33, 0x33, 0x3a, 0xaa});
  // AK80-64: 8 and 144. Velocity 4: 12 * 4095 / 16 = 3071.25 = BFF. Torque -72: 72 * 4095 / 288 = 1023.75, to
  // 400.
  CHECK(pack({0.0f, 4.0f, 0.0f, 0.0f, -72.0f}, Motor::ak80_64, 1).value().data ==
        Bytes{0x7f, 0xff, 0xbf, 0xf0, 0x00, 0x00, 0x04, 0x00});
}

TEST_CASE("the ends of a motor's range are the first and the last step, and beyond them it is clamped") {
  for (const MotorInfo& m : kMotors)
    for (const float beyond : {1.0f, 1.5f, 1e30f}) {
      const MotorCommand most{beyond * m.position_max_rad, beyond * m.velocity_max_radps,
                              beyond * m.stiffness_max_nmpr, beyond * m.damping_max_nmspr,
                              beyond * m.torque_max_nm};
      const MotorCommand least{-beyond * m.position_max_rad, -beyond * m.velocity_max_radps, -beyond, -beyond,
                               -beyond * m.torque_max_nm};
      INFO(std::string(m.name) << " x " << beyond);
      CHECK(pack(most, m.motor, 1).value().data == Bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff});
      CHECK(pack(least, m.motor, 1).value().data == Bytes{});
    }
}

TEST_CASE("every step of position and torque survives the way through a number") {
  for (const MotorInfo& m : kMotors)
    for (const Signal& unscaled : table::kMotorCommand) {
      const Signal s = with_range(unscaled, m);
      for (std::uint32_t raw = 0; raw < 1u << s.width; ++raw) {
        Frame frame = empty_frame(message::kMotorCommand, 1), again = frame;
        REQUIRE(put_raw(frame, s, raw) == Status::ok);
        REQUIRE(put(again, s, get(frame, s).value()) == Put::whole);
        REQUIRE(again == frame);
      }
    }
}

TEST_CASE("a value that is not a number makes no command") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(pack({nan, 0, 0, 0, 0}, Motor::ak80_9, 1).status() == Status::invalid);
  CHECK(pack({0, 0, 0, 0, nan}, Motor::ak80_9, 1).status() == Status::invalid);
  CHECK(pack({0, 0, std::numeric_limits<float>::infinity(), 0, 0}, Motor::ak80_9, 1).status() ==
        Status::invalid);
}

TEST_CASE("a reply of 6 or of 8 bytes is read, in the motor's range") {
  // Motor 3, position FFFF = 12.5 rad, velocity 000 = -50 rad/s, torque FFF = 18 N m, 42, no error.
  const Frame eight{0, 8, false, false, {3, 0xff, 0xff, 0x00, 0x0f, 0xff, 42, 1}};
  const MotorReply reply = unpack_reply(eight, Motor::ak80_9, 3).value();
  CHECK(reply.position_rad == Approx(12.5));
  CHECK(reply.velocity_radps == Approx(-50.0));
  CHECK(reply.torque_nm == Approx(18.0));
  CHECK(reply.long_reply);
  CHECK(reply.temperature == 42);
  CHECK(reply.error == 1);
  Frame six = eight;
  six.size = 6;
  const MotorReply other = unpack_reply(six, Motor::mini_cheetah, 3).value();
  CHECK(other.velocity_radps == Approx(-65.0));
  CHECK_FALSE(other.long_reply);
  CHECK(other.error == 0);
}

TEST_CASE("a reply of another motor, id or length is invalid") {
  const Frame good{0, 8, false, false, {3, 0xff, 0xff, 0x00, 0x0f, 0xff, 42, 0}};
  CHECK(unpack_reply(good, Motor::ak80_9, 4).status() == Status::invalid);
  Frame frame = good;
  frame.size = 5;
  CHECK(unpack_reply(frame, Motor::ak80_9, 3).status() == Status::invalid);
  frame = good;
  frame.id = 3;
  CHECK(unpack_reply(frame, Motor::ak80_9, 3).status() == Status::invalid);
  frame = good;
  frame.extended = true;
  CHECK(unpack_reply(frame, Motor::ak80_9, 3).status() == Status::invalid);
  frame = good;
  frame.remote = true;
  CHECK(unpack_reply(frame, Motor::ak80_9, 3).status() == Status::invalid);
}

TEST_CASE("the range table is that of the manual") {
  // AK Series Actuator Driver Manual V1.0.8, pages 49 and 50: velocity and torque by module.
  const auto has = [](Motor motor, float velocity, float torque) {
    const MotorInfo& m = info(motor);
    return m.position_max_rad == 12.5f && m.velocity_max_radps == velocity && m.torque_max_nm == torque &&
           m.stiffness_max_nmpr == 500.0f && m.damping_max_nmspr == 5.0f;
  };
  CHECK(has(Motor::ak10_9, 50.0f, 65.0f));
  CHECK(has(Motor::ak60_6, 45.0f, 15.0f));
  CHECK(has(Motor::ak70_10, 50.0f, 25.0f));
  CHECK(has(Motor::ak80_6, 76.0f, 12.0f));
  CHECK(has(Motor::ak80_9, 50.0f, 18.0f));
  CHECK(has(Motor::ak80_64, 8.0f, 144.0f));
  CHECK(has(Motor::mini_cheetah, 65.0f, 18.0f));
}
