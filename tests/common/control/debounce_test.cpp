// The contact switch's debouncing.
#include "furcula/control/debounce.hpp"

#include <catch2/catch.hpp>
#include <string>

using namespace furcula::control;

namespace {

constexpr float kDt = 0.001f;

/// Readings and answers as strings of 0 and 1.
std::string answers(const DebounceConfig& config, const std::string& readings) {
  DebounceState state;
  std::string out;
  for (const char c : readings) out += debounce(config, state, c == '1', kDt) ? '1' : '0';
  return out;
}

}  // namespace

TEST_CASE("Algorithm 1: the contact closes when the switch reads closed twice running, and not before") {
  CHECK(answers({}, "0100110111") == "0000011111");
  CHECK(answers({}, "1010101010") == "0000000000");
}

TEST_CASE("Algorithm 1: the contact opens when the switch reads open twice running") {
  CHECK(answers({}, "110101001") == "011111100");
}

TEST_CASE("settling: the contact closes after close_settle_s of closed readings, net of open ones") {
  const DebounceConfig config{DebounceRule::settling, 0.003f, 0.005f};
  CHECK(answers(config, "111") == "001");
  // An open reading takes 3/5 of what a closed one gave: 1 + 1 - 3/5 + 1 = 2.4 < 3, then 3.4.
  CHECK(answers(config, "110111") == "000011");
  CHECK(answers(config, "010101") == "000000");
}

TEST_CASE("settling: chatter shorter than open_settle_s does not open a closed contact") {
  const DebounceConfig config{DebounceRule::settling, 0.003f, 0.005f};
  CHECK(answers(config, "1110000111") == "0011111111");
  CHECK(answers(config, "11100000") == "00111110");
}

TEST_CASE("settling: the level between the thresholds keeps the last answer") {
  const DebounceConfig config{DebounceRule::settling, 0.004f, 0.004f};
  // Half-way up twice, by 2 and 2 readings: open stays open, closed stays closed.
  CHECK(answers(config, "1100") == "0000");
  CHECK(answers(config, "11110011") == "00011111");
}
