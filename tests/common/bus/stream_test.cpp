// Versions, sequence numbers and ages: what a receiver takes, and what it does not.
#include "furcula/bus/stream.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace furcula;
using namespace furcula::bus;

namespace {
constexpr StreamLimits kLimits{0.005f, 0.1f};
Arrival next(Stream& stream, std::uint8_t sequence, float age_s = 0.0f, float since_s = 0.001f) {
  return arrive(stream, kLimits, {kProtocolVersion, sequence, age_s}, since_s);
}
}  // namespace

TEST_CASE("messages in order are fresh, over the wrap too") {
  Stream stream;
  CHECK(next(stream, 250) == Arrival::fresh);
  for (int i = 251; i < 600; ++i) CHECK(next(stream, static_cast<std::uint8_t>(i)) == Arrival::fresh);
  CHECK(stream.lost == 0);
}

TEST_CASE("a gap is taken and counted") {
  Stream stream;
  CHECK(next(stream, 254) == Arrival::fresh);
  CHECK(next(stream, 1) == Arrival::after_gap);  // 255 and 0 are lost
  CHECK(stream.lost == 2);
  CHECK(usable(Arrival::after_gap));
}

TEST_CASE("the same again and what is behind are not taken, and what comes after is fresh") {
  Stream stream;
  CHECK(next(stream, 10) == Arrival::fresh);
  CHECK(next(stream, 10) == Arrival::repeated);
  CHECK(next(stream, 9) == Arrival::out_of_order);
  CHECK(next(stream, 11) == Arrival::fresh);
  CHECK_FALSE(usable(Arrival::repeated));
  CHECK_FALSE(usable(Arrival::out_of_order));
}

TEST_CASE("content that is too old is stale, and an age that cannot be told is so under any limit") {
  Stream stream;
  CHECK(next(stream, 0, 0.005f) == Arrival::fresh);
  CHECK(next(stream, 1, 0.0051f) == Arrival::stale);
  CHECK(next(stream, 2) == Arrival::fresh);  // not a gap: the stale one did arrive
  const Stamp oldest{kProtocolVersion, 3, kOldestAge};
  CHECK(arrive(stream, {1.0f, 0.1f}, oldest, 0.001f) == Arrival::stale);
  CHECK(arrive(stream, {1.0f, 0.1f}, {kProtocolVersion, 4, 0.0254f}, 0.001f) == Arrival::fresh);
  CHECK(arrive(stream, kLimits, {kProtocolVersion, 5, 0.003f}, 0.001f, 0.003f) == Arrival::stale);
  CHECK(arrive(stream, kLimits, {kProtocolVersion, 6, std::numeric_limits<float>::quiet_NaN()}, 0.001f) ==
        Arrival::stale);
}

TEST_CASE("after a silence the sender counts as started anew") {
  Stream stream;
  CHECK(next(stream, 200) == Arrival::fresh);
  CHECK(next(stream, 0, 0.0f, 0.05f) == Arrival::after_gap);
  CHECK(next(stream, 0, 0.0f, 0.1f) == Arrival::fresh);
  CHECK(next(stream, 150, 0.0f, 0.2f) == Arrival::fresh);
}

TEST_CASE("another protocol version is refused and changes nothing") {
  Stream stream;
  CHECK(next(stream, 5) == Arrival::fresh);
  CHECK(arrive(stream, kLimits, {kProtocolVersion + 1, 6, 0.0f}, 0.001f) == Arrival::other_version);
  CHECK(next(stream, 6) == Arrival::fresh);
}

TEST_CASE("the stamp is the first three bytes: version, number, age in tenths of a millisecond") {
  Frame frame = empty_frame(message::kCommand, 1);
  CHECK(put_stamp(frame, {1, 0xab, 0.0123f}) == Status::ok);
  CHECK(frame.data == std::array<std::uint8_t, 8>{0x01, 0xab, 123, 0, 0, 0, 0, 0});
  const Stamp stamp = get_stamp(frame).value();
  CHECK(stamp.version == 1);
  CHECK(stamp.sequence == 0xab);
  CHECK(stamp.age_s == Approx(0.0123));
  CHECK(put_stamp(frame, {1, 0, 7.0f}) == Status::ok);
  CHECK(frame.data[2] == 255);
  CHECK(put_stamp(frame, {1, 0, -1.0f}) == Status::ok);
  CHECK(frame.data[2] == 0);
  CHECK(put_stamp(frame, {1, 0, std::numeric_limits<float>::quiet_NaN()}) == Status::invalid);
  frame.size = 2;
  CHECK(put_stamp(frame, {}) == Status::invalid);
  CHECK(get_stamp(frame).status() == Status::invalid);
}
