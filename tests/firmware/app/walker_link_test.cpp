// The biped's link: what of a frame becomes whose reading, and what is told to whom when.
#include "firmware/app/walker_link.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <set>

using namespace furcula;
using namespace furcula::firmware;
using control::Fault;
using control::WalkerStage;

namespace {

using Bytes = std::array<std::uint8_t, 8>;
bus::Frame frame(std::uint32_t id, std::uint8_t size, const Bytes& data) {
  return {id, size, false, false, data};
}
/// Of the drive `node`, at 0x9000 of 0xffff of its range, at its rate of zero, with a torque of 0x900 of 0xfff.
bus::Frame reply(std::uint8_t node, std::uint8_t temperature = 25, std::uint8_t error = 0) {
  return frame(0x000, 8, {node, 0x90, 0x00, 0x7f, 0xf9, 0x00, temperature, error});
}
bus::Frame gyro(std::uint8_t number, std::uint8_t status = 0) {
  // 100, -200 and 300 of 2000 to 1 rad/s.
  return frame(0x541, 8,
               {static_cast<std::uint8_t>(0x01 | status << 4), number, 0x64, 0x00, 0x38, 0xff, 0x2c, 0x01});
}
/// 25, 50 and -1 of 25 to 1 m/s^2, in 13 bits each from bit 24 on; `age` of 0.1 ms.
bus::Frame acceleration(std::uint8_t number, std::uint8_t age = 0) {
  const std::uint64_t raw = 0x01ull | std::uint64_t{number} << 8 | std::uint64_t{age} << 16 | 25ull << 24 |
                            50ull << 37 | 0x1fffull << 50;
  bus::Frame out = frame(0x561, 8, {});
  for (std::size_t i = 0; i < 8; ++i) out.data[i] = static_cast<std::uint8_t>(raw >> 8 * i);
  return out;
}
bool answered(const control::WalkerSample& sample, std::uint32_t device) {
  return (sample.answered >> device & 1u) != 0;
}
Fault fault(const control::WalkerSample& sample) { return static_cast<Fault>(sample.reported_fault); }
bool is_exit(const bus::Frame& f) { return f.data == Bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfd}; }
bool is_enter(const bus::Frame& f) { return f.data == Bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc}; }

control::WalkerOutputs walking() {
  control::WalkerOutputs out;
  out.stage = WalkerStage::walking;
  for (auto& joint : out.joints) joint = {0.0f, 4000.0f, 100.0f};
  return out;
}

}  // namespace

TEST_CASE("a drive's reply is its joint's, on its own leg's bus alone, and answers once") {
  WalkerLink link({});
  link.receive(0, reply(4), 1000);  // the left knee
  link.receive(1, reply(5), 1000);  // the left ankle's, in the wrong socket
  link.receive(1, reply(10), 1000);
  const control::WalkerSample sample = link.sample(1000);
  CHECK(sample.answered == (1u << 3 | 1u << 9));
  CHECK(sample.joints[3].angle_rad == Approx(0x9000 / 65535.0 * 6.4 - 3.2));
  CHECK(sample.joints[3].rate_radps == 0.0f);
  CHECK(sample.joints[3].torque_nm == Approx(0x900 / 4095.0 * 440.0 - 220.0));
  CHECK(sample.joints[4].angle_rad == 0.0f);
  CHECK(link.statistics().foreign == 1);
  // The readings stay, for whoever bridges.
  CHECK(link.sample(2000).answered == 0);
  CHECK(link.sample(2000).joints[3].angle_rad == sample.joints[3].angle_rad);
}

TEST_CASE("an IMU's sample is both of its halves, with one number, fresh and in order") {
  WalkerLink link({});
  const auto hears = [&](std::initializer_list<bus::Frame> frames) {
    for (const bus::Frame& f : frames) link.receive(kBodyBus, f, 1000);
    return answered(link.sample(1000), control::kImuDevice);
  };
  CHECK(hears({gyro(1), acceleration(1)}));
  const control::WalkerSample sample = link.sample(1000);
  CHECK(sample.gyro_radps.x == 0.05f);
  CHECK(sample.gyro_radps.y == -0.1f);
  CHECK(sample.gyro_radps.z == 0.15f);
  CHECK(sample.acc_mps2.x == 1.0f);
  CHECK(sample.acc_mps2.y == 2.0f);
  CHECK(sample.acc_mps2.z == -0.04f);
  CHECK_FALSE(hears({gyro(2)}));
  CHECK(hears({acceleration(2)}));        // in the next tick
  CHECK_FALSE(hears({acceleration(3)}));  // without its other half
  CHECK_FALSE(hears({gyro(3), acceleration(4)}));
  CHECK_FALSE(hears({gyro(5, 2), acceleration(5)}));   // no signal
  CHECK_FALSE(hears({gyro(6), acceleration(6, 51)}));  // 5.1 ms old
  CHECK(hears({gyro(7), acceleration(7, 50)}));
  CHECK_FALSE(hears({gyro(7), acceleration(7)}));  // again
  CHECK_FALSE(hears({gyro(6), acceleration(6)}));  // from before
  bus::Frame other = gyro(8);
  other.data[0] = 0x02;
  CHECK_FALSE(hears({other, acceleration(8)}));  // of another version
  bus::Frame cut = gyro(9);
  cut.size = 7;
  CHECK_FALSE(hears({cut, acceleration(9)}));
}

TEST_CASE("feet and pins have the units of docs/bus.md") {
  WalkerLink link({});
  // 300.0 N and 12.5 N; 1, 0.97, -1 and 0 of a stroke.
  link.receive(kBodyBus, frame(0x581, 7, {0x01, 0x07, 0x00, 0xb8, 0x0b, 0x7d, 0x00}), 1000);
  link.receive(kBodyBus, frame(0x5a1, 7, {0x01, 0x07, 0x00, 0x64, 0x61, 0x9c, 0x00}), 1000);
  const control::WalkerSample sample = link.sample(1000);
  CHECK(answered(sample, control::kFeetDevice));
  CHECK(sample.foot_n == std::array<float, 2>{300.0f, 12.5f});
  CHECK(answered(sample, control::kPinsDevice));
  CHECK(sample.pins == std::array<float, 4>{1.0f, 0.97f, -1.0f, 0.0f});
  // A node that says that it has no signal does not answer for it.
  link.receive(kBodyBus, frame(0x581, 7, {0x21, 0x08, 0x00, 0xb8, 0x0b, 0x7d, 0x00}), 2000);
  link.receive(kBodyBus, frame(0x5a1, 7, {0x21, 0x08, 0x00, 0x64, 0x61, 0x9c, 0x00}), 2000);
  CHECK(link.sample(2000).answered == 0);
}

TEST_CASE("what a drive reports is its joint's fault, and a bus that was off nobody's") {
  WalkerLink link({});
  CHECK(fault(link.sample(0)) == Fault::none);
  const auto [temperature, error, found] =
      GENERATE(std::array<std::uint32_t, 3>{91, 0, static_cast<std::uint32_t>(Fault::drive_hot)},
               std::array<std::uint32_t, 3>{25, 1, static_cast<std::uint32_t>(Fault::drive_hot)},
               std::array<std::uint32_t, 3>{25, 3, static_cast<std::uint32_t>(Fault::supply_too_high)},
               std::array<std::uint32_t, 3>{25, 2, static_cast<std::uint32_t>(Fault::drive_fault)});
  link.receive(1, reply(8, static_cast<std::uint8_t>(temperature), static_cast<std::uint8_t>(error)), 1000);
  control::WalkerSample sample = link.sample(1000);
  CHECK(sample.reported_fault == found);
  CHECK(sample.reported_by == 7);
  link.receive(1, reply(8), 3000);
  CHECK(fault(link.sample(3000)) == Fault::none);
  // Off and back between two ticks is told once.
  link.note(1, BusEvent::off);
  link.note(1, BusEvent::recovered);
  sample = link.sample(4000);
  CHECK(fault(sample) == Fault::bus_off);
  CHECK(sample.reported_by == control::kNoJoint);
  CHECK(fault(link.sample(5000)) == Fault::none);
}

TEST_CASE("who commands a drive of this robot, or beats with its node's heart, has its id") {
  WalkerLink link({.self_node = 3});
  const bool heart = GENERATE(false, true);
  if (heart)
    link.receive(kBodyBus, frame(0x703, 7, {0x11}), 1000);
  else
    link.receive(1, frame(0x007, 8, {}), 1000);
  CHECK(fault(link.sample(200000)) == Fault::node_id_taken);
  CHECK(fault(link.sample(260000)) == Fault::none);
}

TEST_CASE(
    "each drive has its turn in every second tick, three of a leg at a time, and is switched on first") {
  WalkerLink link({});
  std::array<int, 12> entered{}, commanded{};
  for (int tick = 0; tick < 10; ++tick) {
    const auto frames = link.command(walking(), true);
    for (std::size_t bus = 0; bus < 2; ++bus) {
      REQUIRE(frames[bus].count == 3);
      for (const bus::Frame& f : frames[bus]) {
        const std::size_t joint = f.id - 1;
        CHECK(joint / 6 == bus);
        CHECK(joint % 2 == static_cast<std::size_t>(tick) % 2);
        if (is_enter(f)) {
          ++entered[joint];
          continue;
        }
        // The ends of the gains' ranges, and zeros of the others.
        CHECK(f.data == Bytes{0x7f, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xf7, 0xff});
        ++commanded[joint];
        CHECK(entered[joint] == 3);
      }
    }
  }
  for (std::size_t joint = 0; joint < 12; ++joint) {
    CHECK(entered[joint] == 3);
    CHECK(commanded[joint] == 2);
  }
}

TEST_CASE("a robot that does not run has its drives off, and after a fault those that were on brake") {
  WalkerLink link({});
  const auto each = [&](const control::WalkerOutputs& told, bool run, auto&& holds) {
    for (int tick = 0; tick < 2; ++tick) {
      const auto frames = link.command(told, run);
      for (std::size_t bus = 0; bus < 2; ++bus)
        for (const bus::Frame& f : frames[bus]) CHECK(holds(f));
    }
  };
  control::WalkerOutputs damped;
  damped.stage = WalkerStage::damped;
  for (auto& joint : damped.joints) joint.damping_nmsprad = 50.0f;
  damped.joints[3].damping_nmsprad = 0.0f;
  each({}, false, is_exit);
  each(damped, false, is_exit);  // never on: it stays off
  for (int tick = 0; tick < 8; ++tick) static_cast<void>(link.command(walking(), true));
  each(damped, false, [](const bus::Frame& f) { return is_exit(f) == (f.id == 4); });
  each({}, false, is_exit);  // reset
  each(damped, false, is_exit);
}

TEST_CASE("a command that is no number switches its drive off") {
  WalkerLink link({});
  for (int tick = 0; tick < 8; ++tick) static_cast<void>(link.command(walking(), true));
  control::WalkerOutputs told = walking();
  told.joints[0].target_rad = std::numeric_limits<float>::quiet_NaN();
  const auto frames = link.command(told, true);
  CHECK(is_exit(*frames[0].begin()));
  CHECK_FALSE(is_exit(*frames[1].begin()));
}

TEST_CASE("pins are told their places every 10 ms, and at once when these change") {
  WalkerLink link({});
  control::WalkerOutputs told = walking();
  told.pin_targets = {-1.0f, 1.0f, -1.0f, 1.0f};
  std::set<int> said;
  for (int tick = 0; tick < 25; ++tick) {
    if (tick == 13) told.pin_targets[0] = 1.0f;
    const auto frames = link.command(told, true);
    if (frames[kBodyBus].count == 0) continue;
    said.insert(tick);
    const bus::Frame& f = *frames[kBodyBus].begin();
    CHECK(f.id == 0x5c1);
    CHECK(f.data[3] == (tick < 13 ? 0x9c : 0x64));
    CHECK(f.data[4] == 0x64);
  }
  CHECK(said == std::set<int>{0, 10, 13, 20});
}

TEST_CASE("a link whose configuration makes no sense hears nothing and says nothing") {
  WalkerLink link({.body_node = 0});
  link.receive(0, reply(4), 1000);
  CHECK(link.sample(1000).answered == 0);
  for (const FrameBatch& batch : link.command(walking(), true)) CHECK(batch.count == 0);
}

TEST_CASE("the ids that a board's receivers let pass are those that the link hears, on each of its buses") {
  for (std::size_t bus = 0; bus < kWalkerLinks; ++bus) {
    const WalkerHeardIds ids(WalkerLinkConfig{.self_node = 3, .body_node = 5}, bus);
    for (std::uint32_t id = 0; id < 0x800; ++id) {
      WalkerLink link({.self_node = 3, .body_node = 5});
      bus::Frame f = frame(id, 8, {static_cast<std::uint8_t>(bus == 1 ? 7 : 1)});
      link.receive(bus, f, 1000);
      const bool passes = std::find(ids.begin(), ids.end(), id) != ids.end();
      if ((link.statistics().foreign == 0) != passes) FAIL("bus " << bus << ", id " << id);
    }
  }
}
