// Signals in frames: bits where they belong, ends of ranges, refusals.
#include "furcula/bus/codec.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace furcula;
using namespace furcula::bus;

namespace {

constexpr Signal integer(std::uint8_t start, std::uint8_t width, ByteOrder order, Encoding encoding) {
  return {"Signal", "", start, width, order, encoding, ""};
}
constexpr auto kLittle = ByteOrder::little;
constexpr auto kBig = ByteOrder::big;
constexpr auto kUnsigned = Encoding::unsigned_integer;
constexpr auto kSigned = Encoding::signed_integer;

Frame of(std::array<std::uint8_t, 8> data, std::uint8_t size = 8) {
  return {0x123, size, false, false, data};
}

}  // namespace

TEST_CASE("a little-endian signal begins at its least significant bit and runs into the next byte") {
  // Bits 4 to 15 of the data 0x..3412 are 0x341.
  const Frame frame = of({0x12, 0x34});
  CHECK(get_raw(frame, integer(4, 12, kLittle, kUnsigned)).value() == 0x341);
  CHECK(get_raw(frame, integer(0, 16, kLittle, kUnsigned)).value() == 0x3412);
  CHECK(get_raw(of({0, 0, 0, 0, 0x78, 0x56, 0x34, 0x12}), integer(32, 32, kLittle, kUnsigned)).value() ==
        0x12345678);
}

TEST_CASE("a big-endian signal begins at its most significant bit, as the mini-cheetah's fields do") {
  // Position 1234, velocity 567, kp 89A, kd BCD, torque EF0 (16 and four times 12 bits).
  const Frame frame = of({0x12, 0x34, 0x56, 0x78, 0x9a, 0xbc, 0xde, 0xf0});
  CHECK(get_raw(frame, integer(7, 16, kBig, kUnsigned)).value() == 0x1234);
  CHECK(get_raw(frame, integer(23, 12, kBig, kUnsigned)).value() == 0x567);
  CHECK(get_raw(frame, integer(27, 12, kBig, kUnsigned)).value() == 0x89a);
  CHECK(get_raw(frame, integer(47, 12, kBig, kUnsigned)).value() == 0xbcd);
  CHECK(get_raw(frame, integer(51, 12, kBig, kUnsigned)).value() == 0xef0);
}

TEST_CASE("a signal that is put leaves the bits beside it as they were") {
  Frame frame = of({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff});
  REQUIRE(put_raw(frame, integer(23, 12, kBig, kUnsigned), 0) == Status::ok);
  CHECK(frame.data == std::array<std::uint8_t, 8>{0xff, 0xff, 0x00, 0x0f, 0xff, 0xff, 0xff, 0xff});
  frame = of({});
  REQUIRE(put_raw(frame, integer(6, 4, kLittle, kUnsigned), 0xffffffff) == Status::ok);
  CHECK(frame.data == std::array<std::uint8_t, 8>{0xc0, 0x03, 0, 0, 0, 0, 0, 0});
}

TEST_CASE("signed numbers are in two's complement at every width") {
  CHECK(get(of({0xff, 0xff}), integer(0, 16, kLittle, kSigned)).value() == -1.0f);
  CHECK(get(of({0x00, 0x08}), integer(0, 12, kLittle, kSigned)).value() == -2048.0f);
  CHECK(get(of({0xff, 0x07}), integer(0, 12, kLittle, kSigned)).value() == 2047.0f);
  CHECK(get(of({0, 0, 0, 0x80}), integer(0, 32, kLittle, kSigned)).value() == -2147483648.0f);
  CHECK(get(of({0x01}), integer(0, 1, kLittle, kSigned)).value() == -1.0f);
  Frame frame = of({});
  CHECK(put(frame, integer(0, 16, kLittle, kSigned), -2.0f) == Put::whole);
  CHECK(frame.data[0] == 0xfe);
  CHECK(frame.data[1] == 0xff);
}

TEST_CASE("a value out of range becomes the end of the range, and is reported") {
  for (const bool is_signed : {false, true})
    for (const int bits : {1, 7, 8, 12, 16, 24, 31, 32}) {
      const auto width = static_cast<std::uint8_t>(bits);
      const Signal s = integer(0, width, kLittle, is_signed ? kSigned : kUnsigned);
      const std::uint32_t ones = width == 32 ? 0xffffffffu : (1u << width) - 1u;
      Frame frame = of({});
      INFO(is_signed << " " << int{width});
      CHECK(put(frame, s, 1e12f) == Put::clamped);
      CHECK(get_raw(frame, s).value() == (is_signed ? ones >> 1 : ones));
      CHECK(put(frame, s, -1e12f) == Put::clamped);
      CHECK(get_raw(frame, s).value() == (is_signed ? 1u << (width - 1) : 0u));
      CHECK(put(frame, s, -std::numeric_limits<float>::max()) == Put::clamped);
    }
}

TEST_CASE("each step of a scaled signal survives being put and got") {
  // ODrive's feed-forward: thousandths in 16 bits.
  const Signal s{"Velocity", "rev/s", 32, 16, kLittle, kSigned, "", 1.0f, 1000.0f};
  for (int raw = -32768; raw <= 32767; ++raw) {
    Frame frame = of({});
    REQUIRE(put_raw(frame, s, static_cast<std::uint32_t>(raw)) == Status::ok);
    const float value = get(frame, s).value();
    CHECK(value == Approx(raw / 1000.0));
    Frame again = of({});
    REQUIRE(put(again, s, value) == Put::whole);
    REQUIRE(again == frame);
  }
}

TEST_CASE("a value goes to the nearest step, from the middle to the lower one") {
  const Signal s = integer(0, 16, kLittle, kSigned);
  const auto raw_of = [&](float value) {
    Frame frame = of({});
    CHECK(put(frame, s, value) == Put::whole);
    return extended_sign(s, get_raw(frame, s).value());
  };
  CHECK(raw_of(2.4f) == 2);
  CHECK(raw_of(2.5f) == 2);
  CHECK(raw_of(2.6f) == 3);
  CHECK(raw_of(-2.4f) == -2);
  CHECK(raw_of(-2.5f) == -3);
  CHECK(raw_of(-2.6f) == -3);
}

TEST_CASE("what is not a finite number is refused, and the frame stays as it was") {
  for (const Encoding encoding : {kUnsigned, kSigned, Encoding::real}) {
    Frame frame = of({1, 2, 3, 4, 5, 6, 7, 8});
    const Frame before = frame;
    const Signal s = integer(0, 32, kLittle, encoding);
    CHECK(put(frame, s, std::numeric_limits<float>::quiet_NaN()) == Put::refused);
    CHECK(put(frame, s, std::numeric_limits<float>::infinity()) == Put::refused);
    CHECK(put(frame, s, -std::numeric_limits<float>::infinity()) == Put::refused);
    CHECK(frame == before);
  }
}

TEST_CASE("a real number is its IEEE 754 pattern, least significant byte first") {
  // 1.0 is 3F800000, -2.0 is C0000000.
  Frame frame = of({});
  CHECK(put(frame, integer(0, 32, kLittle, Encoding::real), 1.0f) == Put::whole);
  CHECK(put(frame, integer(32, 32, kLittle, Encoding::real), -2.0f) == Put::whole);
  CHECK(frame.data == std::array<std::uint8_t, 8>{0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0});
  CHECK(get(frame, integer(32, 32, kLittle, Encoding::real)).value() == -2.0f);
  // A drive that has no estimate sends a NaN: it is given as it stands there.
  CHECK(std::isnan(get(of({0, 0, 0xc0, 0x7f}), integer(0, 32, kLittle, Encoding::real)).value()));
}

TEST_CASE("a signal beyond the frame's end is invalid, and so is a frame that makes no sense") {
  const Signal s = integer(8, 16, kLittle, kUnsigned);
  CHECK(get_raw(of({}, 3), s).ok());
  CHECK(get_raw(of({}, 2), s).status() == Status::invalid);
  CHECK(get_raw(of({}, 0), s).status() == Status::invalid);
  CHECK(get(of({}, 9), s).status() == Status::invalid);
  CHECK(get(of({}), integer(56, 12, kLittle, kUnsigned)).status() == Status::invalid);
  CHECK(get(of({}), integer(56, 9, kBig, kUnsigned)).status() == Status::invalid);
  CHECK(get(of({}), integer(0, 33, kLittle, kUnsigned)).status() == Status::invalid);
  Frame remote = of({});
  remote.remote = true;
  CHECK(get(remote, s).status() == Status::invalid);
  Frame frame = of({}, 2);
  CHECK(put(frame, s, 1.0f) == Put::refused);
  CHECK(put_raw(frame, s, 1) == Status::invalid);
  CHECK(frame == of({}, 2));
}
