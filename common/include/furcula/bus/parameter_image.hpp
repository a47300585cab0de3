// The parameters as bytes, for a store: number and value of each, so that a later table reads an older image.
// The store itself sees to it that what it gives is what it was given (checksum, power cut).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/parameters.hpp"

namespace furcula::bus {

/// Byte 0: the image's version; byte 1: how many entries follow, each a number of 16 bits and a value of IEEE
/// 754, both with the least significant byte first.
inline constexpr std::uint8_t kImageVersion = 1;
/// Bytes of the header.
inline constexpr std::size_t kImageHeaderBytes = 2;
/// Bytes of an entry: number and value.
inline constexpr std::size_t kImageEntryBytes = 6;
/// Greatest size of an image, that of a later table included.
inline constexpr std::size_t kImageBytesMax = kImageHeaderBytes + 80 * kImageEntryBytes;
/// Bytes of an image of this table.
inline constexpr std::size_t kImageBytes = kImageHeaderBytes + kParameters.size() * kImageEntryBytes;
static_assert(kImageBytes <= kImageBytesMax);

/// An image of this table: kImageHeaderBytes, then an entry for each parameter in the table's order.
using ParameterImage = std::array<std::uint8_t, kImageBytes>;

/// The image of the parameters of `config`.
inline ParameterImage to_image(const control::Config& config) {
  ParameterImage out{};
  out[0] = kImageVersion;
  out[1] = static_cast<std::uint8_t>(kParameters.size());
  std::size_t at = kImageHeaderBytes;
  for (const Parameter& p : kParameters) {
    const auto bits = std::bit_cast<std::uint32_t>(p.get(config));
    out[at] = static_cast<std::uint8_t>(p.number & 0xffu);
    out[at + 1] = static_cast<std::uint8_t>(p.number >> 8);
    for (std::size_t i = 0; i < 4; ++i) out[at + 2 + i] = static_cast<std::uint8_t>(bits >> 8 * i & 0xffu);
    at += kImageEntryBytes;
  }
  return out;
}

/// Sets what the image has; numbers that the table does not have are skipped. `invalid`: another version, a
/// wrong length, a value that is not allowed, or a configuration that makes no sense; `config` is then as it
/// was.
inline Status from_image(std::span<const std::uint8_t> image, control::Config& config) {
  if (image.size() < kImageHeaderBytes || image[0] != kImageVersion ||
      image.size() != kImageHeaderBytes + image[1] * kImageEntryBytes)
    return Status::invalid;
  control::Config edited = config;
  for (std::size_t at = kImageHeaderBytes; at < image.size(); at += kImageEntryBytes) {
    const Parameter* p = parameter_numbered(static_cast<std::uint32_t>(image[at]) |
                                            static_cast<std::uint32_t>(image[at + 1]) << 8);
    if (p == nullptr) continue;
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(image[at + 2 + i]) << 8 * i;
    const auto value = std::bit_cast<float>(bits);
    if (!allows(*p, value)) return Status::invalid;
    p->put(edited, value);
  }
  if (control::check(edited) != Status::ok) return Status::invalid;
  config = edited;
  return Status::ok;
}

}  // namespace furcula::bus
