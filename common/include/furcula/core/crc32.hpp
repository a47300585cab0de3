// CRC-32 as in IEEE 802.3, over bytes that come one after the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace furcula {

/// CRC-32 (IEEE 802.3 clause 3.2.9; polynomial 0x04C11DB7 reflected, begun with ones, inverted at the end):
/// of the nine characters "123456789" it is 0xCBF43926. A table of 16 words, two look-ups a byte.
class Crc32 {
 public:
  /// Appends one byte.
  constexpr void add(std::uint8_t byte) {
    crc_ = kTable[(crc_ ^ byte) & 0xfu] ^ (crc_ >> 4);
    crc_ = kTable[(crc_ ^ (byte >> 4)) & 0xfu] ^ (crc_ >> 4);
  }
  /// The word's four bytes, the lowest first.
  constexpr void add_word(std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) add(static_cast<std::uint8_t>(word >> shift));
  }
  /// The CRC of the bytes added so far; more may be added afterwards.
  constexpr std::uint32_t value() const { return ~crc_; }

 private:
  static constexpr std::array<std::uint32_t, 16> kTable = [] {
    std::array<std::uint32_t, 16> table{};
    for (std::uint32_t n = 0; n < 16; ++n) {
      std::uint32_t rest = n;
      for (int bit = 0; bit < 4; ++bit) rest = (rest >> 1) ^ ((rest & 1u) != 0 ? 0xedb88320u : 0u);
      table[n] = rest;
    }
    return table;
  }();
  std::uint32_t crc_ = 0xffffffffu;
};

/// The CRC-32 of `bytes`; 0 of none.
constexpr std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  Crc32 crc;
  for (const std::uint8_t byte : bytes) crc.add(byte);
  return crc.value();
}

}  // namespace furcula
