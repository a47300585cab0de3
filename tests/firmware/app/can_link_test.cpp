// The link between the bus and the controller: what each thing that a bus does becomes.
#include "firmware/app/can_link.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace furcula;
using namespace furcula::firmware;
using control::Fault;

namespace {

constexpr std::uint8_t kDrive = 3, kRail = 5, kPulley = 6, kSelf = 2;

CanLinkConfig config() {
  CanLinkConfig c;
  c.drive_node = kDrive;
  c.height_node = kRail;
  c.cable_node = kPulley;
  c.self_node = kSelf;
  return c;
}

/// By hand from the manual's table, not through the codec: position 16 bits, velocity 12, torque 12.
bus::Frame reply(double position_rad, double torque_nm, std::uint8_t error = 0, double velocity_radps = 0.0,
                 std::uint8_t temperature = 41) {
  const auto v = static_cast<std::uint32_t>(std::lround((velocity_radps + 50.0) / 100.0 * 4095));
  const auto p = static_cast<std::uint32_t>(std::lround((position_rad + 12.5) / 25.0 * 65535));
  const auto t = static_cast<std::uint32_t>(std::lround((torque_nm + 18.0) / 36.0 * 4095));
  bus::Frame f;
  f.id = 0;
  f.size = 8;
  f.data = {kDrive,
            static_cast<std::uint8_t>(p >> 8),
            static_cast<std::uint8_t>(p),
            static_cast<std::uint8_t>(v >> 4),
            static_cast<std::uint8_t>((v & 0xf) << 4 | t >> 8),
            static_cast<std::uint8_t>(t),
            temperature,
            error};
  return f;
}

bus::Frame encoder(std::uint8_t node, std::uint8_t sequence, std::int32_t count, std::uint8_t age_100us = 0,
                   std::uint8_t status = 0, std::uint8_t version = 1) {
  const auto c = static_cast<std::uint32_t>(count);
  bus::Frame f;
  f.id = 0x460u + node;
  f.size = 8;
  f.data = {static_cast<std::uint8_t>(version | status << 4),
            sequence,
            age_100us,
            0,
            static_cast<std::uint8_t>(c),
            static_cast<std::uint8_t>(c >> 8),
            static_cast<std::uint8_t>(c >> 16),
            static_cast<std::uint8_t>(c >> 24)};
  return f;
}

bus::Frame request(std::uint8_t kind, std::uint8_t sequence, std::uint8_t age_100us = 0) {
  bus::Frame f;
  f.id = 0x400u + kSelf;
  f.size = 8;
  // 3 N m is 3000 = 0x0BB8, 0.3 s is 3000 as well; the clutch's bit is set.
  f.data = {static_cast<std::uint8_t>(1 | kind << 4), sequence, age_100us, 0xb8, 0x0b, 0xb8, 0x0b, 1};
  return f;
}

/// By hand from docs/bus.md: node 7, 0.01 V a step.
bus::Frame supply(double volts, std::uint8_t sequence) {
  const auto v = static_cast<std::uint32_t>(std::lround(100.0 * volts));
  bus::Frame f;
  f.id = 0x520u + 7;
  f.size = 7;
  f.data = {1, sequence, 0, static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v >> 8), 0, 0};
  return f;
}

/// A bus on which all goes well, but for what a test leaves out.
struct Bus {
  CanLink link{config()};
  std::uint32_t now_us = 0xffffff00u;  // the clock wraps in each test
  std::uint8_t sequence = 250;
  float torque_nm = 0.0f;

  Bus() { link.set_home(100, 0.25f, 200); }

  /// One millisecond: the drive is told, all answer 0.2 ms later.
  void tick(bool drive = true, bool rail = true, double reports_nm = 0.0, std::uint8_t error = 0) {
    link.command({torque_nm, 0.0f}, true);
    now_us += 200;
    if (drive) link.receive(reply(0.8, reports_nm, error), now_us);
    if (rail) link.receive(encoder(kRail, sequence, 1234), now_us);
    link.receive(encoder(kPulley, sequence, -7), now_us);
    ++sequence;
    now_us += 800;
  }
  Fault fault() {
    const auto sample = link.sample(now_us);
    return sample.ok() ? static_cast<Fault>(sample.value().reported_fault) : Fault::peer_lost;
  }
};

}  // namespace

TEST_CASE("a sample has the newest count, angle and home of each source and the age of the oldest") {
  Bus b;
  CHECK(b.link.sample(b.now_us).status() == Status::disconnected);
  b.tick();
  const auto sample = b.link.sample(b.now_us);
  REQUIRE(sample.ok());
  CHECK(sample.value().height_count == 1234);
  CHECK(sample.value().home_count == 100);
  CHECK(sample.value().home_height_m == 0.25f);
  CHECK(sample.value().cable_count == 0xfffffff9u);
  CHECK(sample.value().cable_home_count == 200);
  CHECK(sample.value().leg_angle_rad == Approx(0.8).margin(25.0 / 65535));
  CHECK(sample.value().age_us == 800);
  CHECK(sample.value().reported_fault == 0);
  CHECK(b.link.drive().temperature == 41);
  // An age that is stated counts as well.
  b.link.receive(encoder(kRail, b.sequence, 1300, 12), b.now_us);
  CHECK(b.link.sample(b.now_us + 100).value().age_us == 1300);
}

TEST_CASE("zero, sign and gear of the leg hold for angle and torque, both ways") {
  CanLinkConfig c = config();
  c.leg_zero_rad = 0.2f;
  c.leg_sign = -1.0f;
  c.gear = 2.0f;
  CanLink link(c);
  link.receive(reply(-1.2, 3.0), 0);
  CHECK(link.drive().leg_angle_rad == Approx(0.8).margin(4e-4));
  CHECK(link.drive().torque_nm == Approx(-6.0).margin(0.01));
  const FrameBatch batch = link.command({4.0f, 0.0f}, true);
  REQUIRE(batch.count == 2);
  CHECK(batch.frame[0].data[7] == 0xfc);
  // -2 N m on the motor: (-2 + 18) / 36 * 4095 = 1820 = 0x71C; the gains are 0.
  CHECK(batch.frame[1].id == kDrive);
  CHECK(batch.frame[1].data == std::array<std::uint8_t, 8>{0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x07, 0x1c});
}

TEST_CASE("the drive is switched on when the robot starts to run and off while it does not") {
  Bus b;
  const auto markers = [](const FrameBatch& batch) {
    std::string text;
    for (const bus::Frame& f : batch)
      text += f.data[7] == 0xfc ? "enter " : f.data[7] == 0xfd ? "exit " : "command ";
    return text;
  };
  CHECK(markers(b.link.command({2.0f, 0.0f}, false)) == "exit ");
  for (int i = 0; i < 3; ++i) CHECK(markers(b.link.command({}, true)) == "enter command ");
  CHECK(markers(b.link.command({}, true)) == "command ");
  CHECK(markers(b.link.command({}, false)) == "exit ");
  CHECK(markers(b.link.command({}, true)) == "enter command ");
  // A torque that is not a number is none.
  const FrameBatch batch = b.link.command({NAN, 0.0f}, true);
  CHECK(batch.frame[1].data == std::array<std::uint8_t, 8>{0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x07, 0xff});
}

TEST_CASE("one lost reply makes the sample older, the second running is a silent drive") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  CHECK(b.fault() == Fault::none);
  b.tick(false);
  CHECK(b.fault() == Fault::none);
  CHECK(b.link.sample(b.now_us).value().age_us == 1800);
  CHECK(1800 < kCanSampleAgeMaxUs);
  b.tick(false);
  CHECK(b.fault() == Fault::drive_silent);
  b.tick();
  CHECK(b.fault() == Fault::none);  // the supervisor is who remembers
  CHECK(b.link.statistics().unanswered >= 2);
}

TEST_CASE("a silent encoder is a lost peer, one without a signal only grows old") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  SECTION("silent") {
    b.tick(true, false);
    CHECK(b.fault() == Fault::none);
    b.tick(true, false);
    CHECK(b.fault() == Fault::peer_lost);
  }
  SECTION("silent for an hour and eleven minutes and longer, when the clock has wrapped") {
    for (int i = 0; i < 1500; ++i) b.tick(true, false);
    CHECK(b.fault() == Fault::peer_lost);
    b.now_us -= 1500000;  // as if it had wrapped to just after the last frame
    CHECK(b.fault() == Fault::peer_lost);
  }
  SECTION("no signal") {
    for (std::uint8_t i = 0; i < 10; ++i) {
      b.tick(true, false);
      b.link.receive(encoder(kRail, static_cast<std::uint8_t>(b.sequence - 1), 99, 0, 2), b.now_us);
    }
    const auto sample = b.link.sample(b.now_us);
    REQUIRE(sample.ok());
    CHECK(sample.value().reported_fault == 0);
    CHECK(sample.value().height_count == 1234);
    CHECK(sample.value().age_us == 10800);
  }
  SECTION("not homed") {
    b.link.receive(encoder(kRail, b.sequence, 99, 0, 1), b.now_us);
    CHECK(std::isnan(b.link.sample(b.now_us).value().home_height_m));
  }
}

TEST_CASE("a drive that reports an error or does not obey is a fault by its own name") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  SECTION("an error") {
    b.tick(true, true, 0.0, 4);
    CHECK(b.fault() == Fault::drive_fault);
    CHECK(b.link.drive().error == 4);
    CHECK(b.link.statistics().drive_errors == 1);
  }
  SECTION("torque where none was told, after 50 ms") {
    int ticks = 0;
    while (b.fault() == Fault::none && ticks < 100) {
      b.tick(true, true, 4.0);
      ++ticks;
    }
    CHECK(b.fault() == Fault::drive_disobeys);
    CHECK(ticks == Approx(51).margin(1));
  }
  SECTION("a motor that is off") {
    b.torque_nm = 3.0f;
    for (int i = 0; i < 60; ++i) b.tick(true, true, 0.0);
    CHECK(b.fault() == Fault::drive_disobeys);
  }
  SECTION("torque that follows two ticks behind is fine") {
    double last[2] = {0.0, 0.0};
    for (int i = 0; i < 1000; ++i) {
      b.torque_nm = static_cast<float>(8.0 * std::sin(0.06 * i));
      b.tick(true, true, last[i % 2]);
      last[i % 2] = static_cast<double>(b.torque_nm);
      REQUIRE(b.fault() == Fault::none);
    }
  }
}

TEST_CASE("a drive that is too hot says so by its temperature or by its error code") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  const auto says = [&](std::uint8_t temperature, std::uint8_t error) {
    b.link.command({}, true);
    b.link.receive(reply(0.8, 0.0, error, 0.0, temperature), b.now_us);
    return b.fault();
  };
  CHECK(says(90, 0) == Fault::none);
  CHECK(says(91, 0) == Fault::drive_hot);
  CHECK(says(40, 0) == Fault::none);    // the supervisor is who remembers
  CHECK(says(0xf6, 0) == Fault::none);  // -10 degrees
  // CubeMars, "AK Series Actuator Driver Manual": 1 motor too hot, 2 current, 3 voltage too high, 4 too low,
  // 5 encoder, 6 inverter too hot, 7 stalled.
  CHECK(says(40, 1) == Fault::drive_hot);
  CHECK(says(40, 2) == Fault::drive_fault);
  CHECK(says(40, 3) == Fault::supply_too_high);
  CHECK(says(40, 4) == Fault::drive_fault);
  CHECK(says(40, 6) == Fault::drive_hot);
}

TEST_CASE("a supply above 52 V is a fault, and a node of the supply that is silent a lost peer") {
  CanLinkConfig c = config();
  c.supply_node = 7;
  Bus b;
  b.link = CanLink(c);
  b.link.set_home(100, 0.25f, 200);
  for (int i = 0; i < 5; ++i) b.tick();
  CHECK(b.link.sample(b.now_us).status() == Status::disconnected);  // it has never spoken
  b.link.receive(supply(51.9, 1), b.now_us);
  CHECK(b.fault() == Fault::none);
  b.link.receive(supply(52.1, 1), b.now_us);  // the same once more
  CHECK(b.fault() == Fault::none);
  b.link.receive(supply(52.1, 2), b.now_us);
  CHECK(b.fault() == Fault::supply_too_high);
  b.link.receive(supply(48.0, 3), b.now_us);
  CHECK(b.fault() == Fault::none);
  for (int i = 0; i < 2; ++i) b.tick();
  CHECK(b.fault() == Fault::none);
  b.tick();
  CHECK(b.fault() == Fault::peer_lost);
  for (int i = 0; i < 2000; ++i) b.tick();
  CHECK(b.link.sample(b.now_us).status() == Status::disconnected);
  b.link.receive(supply(48.0, 4), b.now_us);
  CHECK(b.fault() == Fault::none);
  bus::Frame cut = supply(48.0, 5);
  cut.size = 6;
  const std::uint32_t before = b.link.statistics().malformed;
  b.link.receive(cut, b.now_us);
  CHECK(b.link.statistics().malformed == before + 1);
  // Without such a node its frames are nobody's.
  Bus other;
  other.link.receive(supply(60.0, 1), other.now_us);
  CHECK(other.link.statistics().foreign == 1);
}

TEST_CASE("two drives with one id are told by second answers from another place, and the first one is used") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  SECTION("another shaft") {
    int ticks = 0;
    for (; b.fault() == Fault::none && ticks < 20; ++ticks) {
      b.tick();
      b.link.receive(reply(-3.0, 0.0), b.now_us);
      CHECK(b.link.drive().leg_angle_rad == Approx(0.8).margin(25.0 / 65535));
    }
    CHECK(b.fault() == Fault::drive_doubled);
    CHECK(ticks == 3);
  }
  SECTION("the same reply twice is a repeated frame") {
    for (int i = 0; i < 1000; ++i) {
      b.tick();
      b.link.receive(reply(0.8, 0.0), b.now_us);
      REQUIRE(b.fault() == Fault::none);
    }
  }
  SECTION("as is a reply that comes a tick late with the leg at 30 rad/s") {
    for (int i = 0; i < 1000; ++i) {
      b.tick();
      b.link.receive(reply(0.77, 0.0), b.now_us);
      REQUIRE(b.fault() == Fault::none);
    }
  }
}

TEST_CASE("an offset of the torque shows in the mean of many replies, a lag or a wave does not") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  SECTION("1 N m, within what one reply may be off") {
    int ticks = 0;
    while (b.fault() == Fault::none && ticks < 2000) {
      b.tick(true, true, 1.0);
      ++ticks;
    }
    CHECK(b.fault() == Fault::drive_disobeys);
    // 0.512 s ln(1 / (1 - 0.5)) = 355 ms
    CHECK(ticks == Approx(355).margin(5));
  }
  SECTION("0.4 N m") {
    for (int i = 0; i < 5000; ++i) {
      b.tick(true, true, 0.4);
      REQUIRE(b.fault() == Fault::none);
    }
  }
  SECTION("a wave of 1.4 N m at 4 Hz") {
    for (int i = 0; i < 5000; ++i) {
      b.tick(true, true, 1.4 * std::sin(0.025 * i));
      REQUIRE(b.fault() == Fault::none);
    }
  }
}

TEST_CASE("a drive whose velocity is not that of its position is another motor's") {
  const double share = GENERATE(0.66, 0.78, 0.9, 1.0, 1.2, 1.3, 6.25);
  Bus b;
  Fault found = Fault::none;
  double turned_rad = 0.0;
  // A leg that swings by 0.4 rad at 3 Hz; by hand its velocity.
  for (int i = 0; i < 3000 && found == Fault::none; ++i) {
    const double angle = 0.019 * i;
    b.link.command({}, true);
    b.now_us += 1000;
    b.link.receive(reply(0.8 + 0.4 * std::sin(angle), 0.0, 0, share * 0.4 * 19.0 * std::cos(angle)),
                   b.now_us);
    b.link.receive(encoder(kRail, b.sequence, 1234), b.now_us);
    b.link.receive(encoder(kPulley, b.sequence++, -7), b.now_us);
    turned_rad += 0.4 * 0.019 * std::abs(std::cos(angle));
    found = b.fault();
  }
  INFO("reports " << share << " of its velocity; turned by " << turned_rad);
  CHECK(found == (share < 0.75 || share > 1.25 ? Fault::drive_mismatch : Fault::none));
  // Of the way 70 % is faster than 5 rad/s and counts: 2 rad of 2.8.
  if (found == Fault::none) return;
  CHECK(turned_rad < 3.5);
  // At rest it stands for half a second; a reset may then clear it.
  for (int i = 0; i < 400; ++i) {
    b.tick();
    REQUIRE(b.fault() == Fault::drive_mismatch);
  }
  for (int i = 0; i < 200; ++i) {
    b.tick();
    found = b.fault();
  }
  CHECK(found == Fault::none);
}

TEST_CASE("repeated, reordered, stale and foreign frames and other versions are counted and not used") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  const CanStatistics before = b.link.statistics();
  const std::uint8_t last = static_cast<std::uint8_t>(b.sequence - 1);
  const auto after = [&](const bus::Frame& frame) {
    b.link.receive(frame, b.now_us);
    CHECK(b.link.sample(b.now_us).value().height_count == 1234);
    return b.link.statistics();
  };
  CHECK(after(encoder(kRail, last, 1)).repeated == before.repeated + 1);
  CHECK(after(encoder(kRail, static_cast<std::uint8_t>(last - 3), 2)).out_of_order ==
        before.out_of_order + 1);
  CHECK(after(encoder(kRail, b.sequence, 3, 200)).stale == before.stale + 1);
  CHECK(after(encoder(kRail, b.sequence, 4, 0, 0, 9)).other_version == before.other_version + 1);
  CHECK(after(encoder(kRail, b.sequence, 5, 0, 7)).malformed == before.malformed + 1);
  bus::Frame half = encoder(kRail, b.sequence, 6);
  half.size = 4;
  CHECK(after(half).malformed == before.malformed + 2);
  bus::Frame cut = reply(0.1, 0.0);
  cut.size = 5;
  CHECK(after(cut).malformed == before.malformed + 3);
  CHECK(after(encoder(9, 0, 7)).foreign == before.foreign + 1);
  bus::Frame neighbour = reply(0.1, 0.0);
  neighbour.data[0] = 9;
  CHECK(after(neighbour).foreign == before.foreign + 2);
  CHECK(after(reply(0.8, 0.0)).repeated == before.repeated + 2);
  // The stale one had this sequence number: the three after it never came.
  b.link.receive(encoder(kRail, static_cast<std::uint8_t>(b.sequence + 4), 8), b.now_us);
  CHECK(b.link.statistics().lost == before.lost + 3);
  CHECK(b.link.sample(b.now_us).value().height_count == 8);
}

TEST_CASE(
    "single frames are lost now and then without a fault, one in three is a bus that cannot be relied on") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  for (int i = 0; i < 3600; ++i) {
    b.tick(i % 20 != 0, i % 20 != 10);
    REQUIRE(b.fault() == Fault::none);
  }
  int ticks = 0;
  Fault found = Fault::none;
  for (; found == Fault::none && ticks < 1000; ++ticks) {
    b.tick(ticks % 3 != 0);
    found = b.fault();
  }
  CHECK(found == Fault::bus_unreliable);
  CHECK(ticks < 60);
}

TEST_CASE("a bus that is off is a fault until it has recovered") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  b.link.note(BusEvent::error);
  CHECK(b.fault() == Fault::none);
  b.link.note(BusEvent::off);
  b.link.note(BusEvent::off);
  CHECK(b.fault() == Fault::bus_off);
  b.link.note(BusEvent::recovered);
  CHECK(b.fault() == Fault::none);
  CHECK(b.link.statistics().error_frames == 1);
  CHECK(b.link.statistics().bus_off == 1);
}

TEST_CASE("a request is taken once, with its numbers, a replayed or stale one never") {
  Bus b;
  CHECK(b.link.request_age_us(b.now_us) == kForgottenUs);
  b.link.receive(request(2, 10), b.now_us);
  const CanRequest taken = b.link.take_request();
  CHECK(taken.kind == CanRequest::Kind::hop);
  CHECK(taken.torque_amplitude_nm == 3.0f);
  CHECK(taken.torque_period_s == 0.3f);
  CHECK(taken.release_in_flight);
  CHECK(b.link.take_request().kind == CanRequest::Kind::none);
  CHECK(b.link.request_age_us(b.now_us + 5000) == 5000);
  b.link.receive(request(3, 10), b.now_us + 1000);       // again
  b.link.receive(request(3, 9), b.now_us + 2000);        // from before
  b.link.receive(request(3, 11, 255), b.now_us + 3000);  // older than can be told
  b.link.receive(request(7, 12), b.now_us + 4000);       // there is no request 7
  CHECK(b.link.take_request().kind == CanRequest::Kind::none);
  CHECK(b.link.request_age_us(b.now_us + 5000) == 5000);
  b.link.receive(request(3, 13), b.now_us + 6000);
  CHECK(b.link.take_request().kind == CanRequest::Kind::reset);
  CHECK(b.link.statistics().stops_apart == 0);
}

TEST_CASE(
    "a stop is heard in any order, at any age, of any version and length, and leaves the stream as it was") {
  for (int number = 0; number < 256; ++number) {
    Bus b;
    b.link.receive(request(2, 100), b.now_us);
    CHECK(b.link.take_request().kind == CanRequest::Kind::hop);
    bus::Frame stop = request(1, static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(3 * number));
    stop.data[0] = static_cast<std::uint8_t>(0x10 | number % 16);
    stop.size =
        static_cast<std::uint8_t>(number % 16);  // more than 8: a length code as a driver may hand it on
    if (stop.size == 0) stop.size = 8;
    b.link.receive(stop, b.now_us + 1000);
    const CanRequest heard = b.link.take_request();
    CAPTURE(number, int{stop.size});
    const bool next = number == 101 && stop.size == 8;  // never: 101 has 2 bytes
    REQUIRE(heard.stop_apart != next);
    REQUIRE_FALSE(heard.came);
    CHECK(b.link.statistics().stops_apart == 1);
    // The stream goes on where it was; nothing counts as lost.
    b.link.receive(request(2, 101), b.now_us + 10000);
    const CanRequest on = b.link.take_request();
    CHECK(on.kind == CanRequest::Kind::hop);
    CHECK(on.follows);
    CHECK(b.link.statistics().lost + b.link.statistics().out_of_order == 0);
  }
}

TEST_CASE("the stream's own stop is the stream's, also when it comes twice, and nothing takes its place") {
  Bus b;
  b.link.receive(request(2, 10), b.now_us);
  CHECK(b.link.take_request().hop_said);
  b.link.receive(request(1, 11), b.now_us + 1000);
  b.link.receive(request(2, 12), b.now_us + 1000);  // in the same millisecond
  CanRequest heard = b.link.take_request();
  CHECK(heard.kind == CanRequest::Kind::stop);
  CHECK(heard.hop_said);
  CHECK_FALSE(heard.stop_apart);
  b.link.receive(request(1, 13), b.now_us + 2000);
  CHECK(b.link.take_request().kind == CanRequest::Kind::stop);
  b.link.receive(request(1, 13), b.now_us + 3000);
  heard = b.link.take_request();
  CHECK(heard.stop_again);
  CHECK_FALSE(heard.stop_apart);
  b.link.receive(request(1, 13), b.now_us + 300000);  // after a silence: another host, or this one anew
  CHECK(b.link.take_request().kind == CanRequest::Kind::stop);
  // A frame without a byte says nothing, one for another node neither.
  bus::Frame none = request(1, 20);
  none.size = 0;
  b.link.receive(none, b.now_us + 4000);
  bus::Frame others = request(1, 21);
  ++others.id;
  b.link.receive(others, b.now_us + 5000);
  heard = b.link.take_request();
  CHECK_FALSE(heard.came);
  CHECK_FALSE(heard.stop_apart);
  CHECK_FALSE(heard.stop_again);
}

TEST_CASE("a hop is noted in whatever order it comes, and one behind a lost command does not follow") {
  Bus b;
  b.link.receive(request(0, 10), b.now_us);
  b.link.receive(request(2, 9), b.now_us + 1000);  // from before: not used
  CanRequest heard = b.link.take_request();
  CHECK(heard.kind == CanRequest::Kind::none);
  CHECK(heard.hop_said);
  b.link.receive(request(0, 11), b.now_us + 2000);
  CHECK_FALSE(b.link.take_request().hop_said);
  b.link.receive(request(2, 13), b.now_us + 3000);  // 12 is missing
  heard = b.link.take_request();
  CHECK(heard.kind == CanRequest::Kind::hop);
  CHECK_FALSE(heard.follows);
}

TEST_CASE("frames that this node alone sends are another's: a fault for as long as they come") {
  for (const bool heartbeat : {true, false}) {
    Bus b;
    for (int i = 0; i < 5; ++i) b.tick();
    REQUIRE(b.fault() == Fault::none);
    bus::Frame frame;  // by hand from docs/bus.md: a heartbeat is 0x700 + n, a motor's command n
    frame.id = heartbeat ? 0x700u + kSelf : kDrive;
    frame.size = heartbeat ? 7 : 8;
    int ticks = 0;
    for (; ticks < 300; ++ticks) {  // one each 100 ms
      if (ticks % 100 == 0) b.link.receive(frame, b.now_us);
      b.tick();
      REQUIRE(b.fault() == Fault::node_id_taken);
    }
    CHECK(b.link.statistics().own_ids == 3);
    while (b.fault() != Fault::none && ticks < 1000) {
      b.tick();
      ++ticks;
    }
    CHECK(ticks == Approx(450).margin(2));  // 250 ms after the last, which came at 200
  }
  // On the clutch's bench the motor is not ours.
  Bus b;
  b.link.set_on_bench(true);
  bus::Frame command;
  command.id = kDrive;
  command.size = 8;
  b.link.receive(encoder(kPulley, 0, 1), b.now_us);
  b.link.receive(command, b.now_us);
  CHECK(b.fault() == Fault::none);
}

TEST_CASE("off the bus and back before anybody asked is told once") {
  Bus b;
  for (int i = 0; i < 5; ++i) b.tick();
  b.link.note(BusEvent::off);
  b.link.note(BusEvent::recovered);
  CHECK(b.fault() == Fault::bus_off);
  CHECK(b.fault() == Fault::none);
}

TEST_CASE("what was said an hour and eleven minutes ago, when the clock has wrapped, is forgotten") {
  Bus b;
  b.link.receive(request(3, 10), b.now_us);
  b.link.receive(encoder(kRail, 7, 1234), b.now_us);
  const std::uint32_t then_us = b.now_us;
  b.link.set_on_bench(true);  // the rail's encoder is not listened to
  for (int i = 0; i < 1500; ++i) {
    b.link.receive(encoder(kPulley, b.sequence++, 0), b.now_us += 1000);
    b.fault();
  }
  CHECK(b.link.take_request().kind == CanRequest::Kind::reset);
  b.now_us = then_us + 20000;  // 2^32 us later, and 20 ms
  b.link.set_on_bench(false);
  // A host that starts anew has any number, and is no stream that goes backwards.
  b.link.receive(request(3, 9), b.now_us);
  CHECK(b.link.take_request().kind == CanRequest::Kind::reset);
  b.link.receive(reply(0.8, 0.0), b.now_us);
  CHECK(b.link.sample(b.now_us).status() == Status::disconnected);  // no rail was heard
}

TEST_CASE("a configuration that makes no sense neither hears nor speaks") {
  CanLinkConfig c = config();
  SECTION("a node that cannot be") { c.drive_node = 32; }
  SECTION("two encoders of one number") { c.cable_node = kRail; }
  SECTION("no gear") { c.gear = 0.0f; }
  SECTION("a sign that is none") { c.leg_sign = 0.5f; }
  SECTION("a zero that is no number") { c.leg_zero_rad = NAN; }
  SECTION("a supply without a limit") { c.supply_max_v = NAN; }
  SECTION("a node of the supply that cannot be") { c.supply_node = 32; }
  CHECK(check(c) == Status::invalid);
  CanLink link(c);
  link.receive(reply(0.8, 0.0), 0);
  link.receive(encoder(kRail, 0, 1), 0);
  CHECK_FALSE(link.sample(0).ok());
  CHECK(link.command({1.0f, 0.0f}, true).count == 0);
}

TEST_CASE("on the clutch's bench the cable's encoder alone is asked for, and nothing is sent to a drive") {
  Bus b;
  b.link.set_on_bench(true);
  CHECK(b.link.sample(b.now_us).status() == Status::disconnected);
  for (int i = 0; i < 100; ++i) {
    CHECK(b.link.command({}, true).count == 0);
    b.link.receive(encoder(kPulley, b.sequence++, 77), b.now_us += 1000);
    CHECK(b.fault() == Fault::none);
  }
  CHECK(b.link.sample(b.now_us).value().cable_count == 77);
  CHECK(b.link.statistics().unanswered == 0);
  b.now_us += 5000;
  CHECK(b.fault() == Fault::peer_lost);
}

TEST_CASE("the filters of a board's receiver let through what is heard, and nothing else") {
  CanLinkConfig c = config();
  c.cable_node = 9;
  c.supply_node = 10;
  // By hand from docs/bus.md: a reply of a drive, samples of two encoders, the supply, a command, a request for
  // registers.
  // And what this node alone sends, its heartbeat and the drive's command: another one's.
  const std::set<std::uint32_t> expected{0x000,          0x460u + c.height_node, 0x469,          0x52a,
                                         0x400u + kSelf, 0x4e0u + kSelf,         0x700u + kSelf, kDrive};
  const HeardIds ids(c);
  CHECK(std::set<std::uint32_t>(ids.begin(), ids.end()) == expected);
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    CanLink link(c);
    bus::Frame frame;
    frame.id = id;
    frame.size = 8;
    frame.data[0] = kDrive;
    link.receive(frame, 1000);
    CAPTURE(id);
    REQUIRE((link.statistics().foreign == 0) == (expected.count(id) != 0));
  }
  c.height_node = c.cable_node = c.supply_node = 0;
  const HeardIds fewer(c);
  CHECK(std::set<std::uint32_t>(fewer.begin(), fewer.end()) ==
        std::set<std::uint32_t>{0x000, 0x400u + kSelf, 0x4e0u + kSelf, 0x700u + kSelf, kDrive});
}
