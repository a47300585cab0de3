// Encoder counters that wrap: positions stay integers until the last moment.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace furcula {

/// How far a free-running counter of 16 or 32 bits moved from `older` to `newer`, whatever wraps lie between.
/// Right as long as it moved by less than half of its range.
template <std::unsigned_integral Raw>
constexpr std::int32_t count_difference(Raw newer, Raw older) {
  static_assert(sizeof(Raw) == 2 || sizeof(Raw) == 4);
  return static_cast<std::make_signed_t<Raw>>(static_cast<Raw>(newer - older));
}

/// The nearest whole number to `x`, from 0 to below 2^32.
constexpr std::uint32_t nearest_count(float x) {
  const auto below = static_cast<std::uint32_t>(x);
  return x - static_cast<float>(below) >= 0.5f ? below + 1 : below;
}

}  // namespace furcula
