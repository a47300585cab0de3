// CRC-32 against its published check value and against division of polynomials, bit by bit.
#include "furcula/core/crc32.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

namespace {

using furcula::crc32;

/// The remainder of the message's polynomial, as IEEE 802.3 defines it: most significant bit first, without
/// any table or reflected constant.
std::uint32_t by_long_division(const std::vector<std::uint8_t>& bytes) {
  std::vector<bool> bits;
  for (const std::uint8_t byte : bytes)
    for (int i = 0; i < 8; ++i) bits.push_back((byte >> i & 1) != 0);  // each byte leaves lowest bit first
  bits.resize(bits.size() + 32, false);
  for (int i = 0; i < 32; ++i) bits[i] = !bits[i];
  const std::uint64_t polynomial = 0x104c11db7ull;
  for (std::size_t i = 0; i + 32 < bits.size(); ++i) {
    if (!bits[i]) continue;
    for (std::size_t k = 0; k <= 32; ++k) bits[i + k] = bits[i + k] != ((polynomial >> (32 - k) & 1) != 0);
  }
  std::uint32_t crc = 0;
  for (int i = 0; i < 32; ++i)
    if (bits[bits.size() - 32 + i]) crc |= 1u << i;
  return ~crc;
}

}  // namespace

TEST_CASE("the CRC of the nine digits is the published check value") {
  const std::string_view digits = "123456789";
  const std::vector<std::uint8_t> bytes(digits.begin(), digits.end());
  CHECK(crc32(bytes) == 0xcbf43926u);
  CHECK(crc32({}) == 0u);
}

TEST_CASE("the CRC of drawn messages is the remainder of a long division") {
  std::mt19937 random(1);
  for (int size = 4; size < 80; ++size) {
    std::vector<std::uint8_t> bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    CHECK(crc32(bytes) == by_long_division(bytes));
  }
}

TEST_CASE("words and their bytes, lowest first, have the same CRC") {
  furcula::Crc32 words;
  words.add_word(0x34333231u);
  words.add_word(0x38373635u);
  words.add('9');
  CHECK(words.value() == 0xcbf43926u);
}
