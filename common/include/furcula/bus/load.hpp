// How much of a CAN bus its frames take, at worst: every bit that can be stuffed is.
//
// A classical frame with an 11-bit id and s bytes has 34 + 8 s bits that are stuffed, from its start to the end of its CRC, and 13 that are not:
// delimiters, acknowledgement, end of frame and the 3 bits to the next frame. After five equal bits one is stuffed, which counts as the
// first of the next five: at most one in four (ISO 11898-1; R. Davis et al., "Controller Area Network (CAN) schedulability analysis",
// Real-Time Systems 35, 2007, eq. 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/message.hpp"

namespace furcula::bus {

/// Of the buses that docs/bus.md describes.
inline constexpr std::uint32_t kBitRate_bps = 1000000;

/// Bits of a frame with `bytes` of data and all the stuffing that there can be, with the gap behind it.
constexpr std::uint32_t worst_bits(std::uint8_t bytes) {
  const std::uint32_t stuffed = 34u + 8u * bytes;
  return stuffed + (stuffed - 1u) / 4u + 13u;
}

/// A message that is sent so many times a second.
struct Traffic {
  const Message* message;        ///< row of the table of messages, not null; its full size is counted
  std::uint32_t times_a_second;  ///< frames per second, of all nodes together
};

/// Share of the bus that all of it takes, at worst; above 1 the bus cannot hold it.
constexpr double worst_load(std::span<const Traffic> all, std::uint32_t bit_rate_bps = kBitRate_bps) {
  std::uint64_t bits_a_second = 0;
  for (const Traffic& t : all) bits_a_second += std::uint64_t{worst_bits(t.message->size)} * t.times_a_second;
  return static_cast<double>(bits_a_second) / static_cast<double>(bit_rate_bps);
}

}  // namespace furcula::bus
