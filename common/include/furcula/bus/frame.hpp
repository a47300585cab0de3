// One frame of classical CAN (ISO 11898-1), as it goes over the bus.
#pragma once

#include <array>
#include <cstdint>

namespace furcula::bus {

/// A data or remote frame with a standard (11 bits) or extended (29 bits) identifier.
struct Frame {
  std::uint32_t id = 0;                ///< 11 bits; 29 bits where `extended`
  std::uint8_t size = 0;               ///< bytes of data, 0 to 8; in a remote frame the number asked for
  bool extended = false;               ///< true: the identifier has 29 bits, false: 11
  bool remote = false;                 ///< asks for the data of this id and carries none
  std::array<std::uint8_t, 8> data{};  ///< bytes in the order of transmission; only the first `size` are sent

  /// Compares all fields, and all eight bytes of `data` whatever `size` is.
  constexpr bool operator==(const Frame&) const = default;
};

}  // namespace furcula::bus
