// The table of messages as a whole: nothing overlaps, everything fits, no id is there twice.
#include "furcula/bus/messages.hpp"

#include <algorithm>
#include <bitset>
#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/motors.hpp"

using namespace furcula;
using namespace furcula::bus;

TEST_CASE("no two signals of a message share a bit, and all fit its size") {
  for (const Message* m : kMessages) {
    std::bitset<64> used;
    std::set<std::string_view> names;
    for (const Signal& s : m->signals) {
      INFO(m->name << " " << s.name);
      CHECK(names.insert(s.name).second);
      CHECK(s.width >= 1);
      CHECK(s.width <= 32);
      CHECK((s.encoding != Encoding::real || s.width == 32));
      CHECK(bytes_to_end(s) <= m->size);
      CHECK_FALSE(s.meaning.empty());
      for (std::uint32_t i = 0; i < s.width; ++i) {
        const std::uint32_t bit = frame_bit(s, i);
        REQUIRE(bit < 64);
        CHECK_FALSE(used[bit]);
        used.set(bit);
      }
    }
    CHECK(m->least_size <= m->size);
    CHECK(m->size <= 8);
    CHECK_FALSE(m->meaning.empty());
  }
}

TEST_CASE("no id is there twice, whatever nodes are on the bus, but where a marker or the first byte tells") {
  std::set<std::uint32_t> ids;
  for (const Message* m : kMessages)
    for (std::uint8_t node = kFirstNode; node <= kLastNode; ++node) {
      const std::uint32_t id = id_of(*m, node);
      INFO(m->name << " of node " << int{node});
      CHECK(id <= 0x7ff);
      if (m->marker == 0 && m->rule != IdRule::fixed) CHECK(ids.insert(id).second);
    }
  CHECK(ids.count(0) == 0);  // the replies' own
}

TEST_CASE("an ODrive id is node << 5 | command, as its documentation's example has it") {
  // 0x01 << 5 | 0x0C = 0x2C
  CHECK(id_of(message::kOdriveInputPosition, 1) == 0x2c);
  CHECK(id_of(message::kOdriveHeartbeat, 3) == 0x61);
}

TEST_CASE("every message of the table is in the list once") {
  const std::set<const Message*> all(kMessages.begin(), kMessages.end());
  CHECK(all.size() == kMessages.size());
  CHECK(all.count(nullptr) == 0);
  // Of the same id, the one with a marker is looked for first.
  for (std::size_t i = 0; i < kMessages.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (kMessages[i]->marker != 0 && kMessages[k]->marker == 0)
        CHECK(id_of(*kMessages[i], 1) != id_of(*kMessages[k], 1));
}

TEST_CASE("a frame is a message's by id, length, first byte and marker") {
  for (const Message* m : kMessages) {
    Frame frame = empty_frame(*m, 5);
    INFO(m->name);
    CHECK(is(frame, *m, 5));
    CHECK_FALSE(is(frame, *m, 6));
    frame.extended = true;
    CHECK_FALSE(is(frame, *m, 5));
    frame.extended = false;
    frame.remote = true;
    CHECK_FALSE(is(frame, *m, 5));
    frame.remote = false;
    if (m->size < 8) {
      frame.size = static_cast<std::uint8_t>(m->size + 1);
      CHECK_FALSE(is(frame, *m, 5));
    }
    if (m->least_size > 0) {
      frame.size = static_cast<std::uint8_t>(m->least_size - 1);
      CHECK_FALSE(is(frame, *m, 5));
    }
  }
  CHECK(is(empty_frame(message::kMotorEnter, 5), message::kMotorCommand, 5));
  CHECK_FALSE(is(empty_frame(message::kMotorEnter, 5), message::kMotorExit, 5));
  CHECK_FALSE(is(empty_frame(message::kMotorCommand, 5), message::kMotorEnter, 5));
}

TEST_CASE("the special frames are the manual's bytes") {
  using Bytes = std::array<std::uint8_t, 8>;
  CHECK(empty_frame(message::kMotorEnter, 1).data == Bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc});
  CHECK(empty_frame(message::kMotorExit, 1).data == Bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfd});
  CHECK(empty_frame(message::kMotorZero, 1).data == Bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe});
}

TEST_CASE("ODrive's signals lie where its own library has them") {
  // ODriveArduino, src/can_simple_messages.hpp: (start bit, width) of can_set_signal_raw().
  const auto lies = [](const Signal& s, int start, int width) {
    return s.start_bit == start && s.width == width && s.order == ByteOrder::little;
  };
  CHECK(lies(signal(message::kOdriveHeartbeat, "Axis_Error"), 0, 32));
  CHECK(lies(signal(message::kOdriveHeartbeat, "Axis_State"), 32, 8));
  CHECK(lies(signal(message::kOdriveHeartbeat, "Procedure_Result"), 40, 8));
  CHECK(lies(signal(message::kOdriveHeartbeat, "Trajectory_Done"), 48, 1));
  CHECK(lies(signal(message::kOdriveInputPosition, "Velocity"), 32, 16));
  CHECK(lies(signal(message::kOdriveInputPosition, "Torque"), 48, 16));
  CHECK(lies(signal(message::kOdriveIq, "Iq_Measured"), 32, 32));
  CHECK(lies(signal(message::kOdriveTorques, "Torque_Estimate"), 32, 32));
  CHECK(lies(signal(message::kOdriveClearErrors, "Identify"), 0, 8));
  const std::pair<const Message*, int> commands[] = {
      {&message::kOdriveHeartbeat, 0x01},        {&message::kOdriveEstop, 0x02},
      {&message::kOdriveGetError, 0x03},         {&message::kOdriveSetAxisState, 0x07},
      {&message::kOdriveEncoderEstimates, 0x09}, {&message::kOdriveControllerMode, 0x0b},
      {&message::kOdriveInputPosition, 0x0c},    {&message::kOdriveInputVelocity, 0x0d},
      {&message::kOdriveInputTorque, 0x0e},      {&message::kOdriveIq, 0x14},
      {&message::kOdriveTemperature, 0x15},      {&message::kOdriveBusPower, 0x17},
      {&message::kOdriveClearErrors, 0x18},      {&message::kOdriveTorques, 0x1c}};
  for (const auto& [m, command] : commands) CHECK(m->base == command);
}

TEST_CASE("an ODrive position set point is the bytes that follow from its documentation") {
  // 0.25 rev is 3E800000; 1.5 rev/s in thousandths is 1500 = 05DC; -0.2 N m is -200 = FF38.
  Frame frame = empty_frame(message::kOdriveInputPosition, 1);
  CHECK(put(frame, signal(message::kOdriveInputPosition, "Position"), 0.25f) == Put::whole);
  CHECK(put(frame, signal(message::kOdriveInputPosition, "Velocity"), 1.5f) == Put::whole);
  CHECK(put(frame, signal(message::kOdriveInputPosition, "Torque"), -0.2f) == Put::whole);
  CHECK(frame.data == std::array<std::uint8_t, 8>{0x00, 0x00, 0x80, 0x3e, 0xdc, 0x05, 0x38, 0xff});
}
