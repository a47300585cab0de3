// Wrapping counters.
#include "furcula/core/count.hpp"

#include <catch2/catch.hpp>
#include <cstdint>

using furcula::count_difference;

TEST_CASE("a 16-bit counter's movement is right across its wrap in both directions") {
  const auto difference = [](unsigned newer, unsigned older) {
    return count_difference(static_cast<std::uint16_t>(newer), static_cast<std::uint16_t>(older));
  };
  CHECK(difference(3, 65534) == 5);
  CHECK(difference(65534, 3) == -5);
  CHECK(difference(32767, 0) == 32767);
  CHECK(difference(0, 32767) == -32767);
  CHECK(difference(1234, 1234) == 0);
}

TEST_CASE("a 32-bit counter's movement is right across its wrap in both directions") {
  CHECK(count_difference<std::uint32_t>(10, 0xfffffff6u) == 20);
  CHECK(count_difference<std::uint32_t>(0xfffffff6u, 10) == -20);
  CHECK(count_difference<std::uint32_t>(0x7fffffffu, 0) == 2147483647);
  // One path all around the counter adds up.
  std::uint32_t raw = 0x80000000u;
  std::int64_t position = 0;
  for (int i = 0; i < 5; ++i) {
    const std::uint32_t next = raw + 1000000000u;
    position += count_difference(next, raw);
    raw = next;
  }
  CHECK(position == 5000000000);
}

TEST_CASE("the nearest count is the one that rounding half up gives, above 2^24 too") {
  using furcula::nearest_count;
  CHECK(nearest_count(0.0f) == 0);
  CHECK(nearest_count(0.49f) == 0);
  CHECK(nearest_count(0.5f) == 1);
  CHECK(nearest_count(7.25f) == 7);
  CHECK(nearest_count(7.75f) == 8);
  CHECK(nearest_count(16777219.0f) == 16777220);  // the float itself is even there
}
