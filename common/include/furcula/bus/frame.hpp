// One frame of classical CAN (ISO 11898-1), as it goes over the bus.
#pragma once

#include <array>
#include <cstdint>

namespace furcula::bus {

struct Frame {
  std::uint32_t id = 0;   ///< 11 bits; 29 bits where `extended`
  std::uint8_t size = 0;  ///< bytes of data, 0 to 8; in a remote frame the number asked for
  bool extended = false;
  bool remote = false;  ///< asks for the data of this id and carries none
  std::array<std::uint8_t, 8> data{};

  constexpr bool operator==(const Frame&) const = default;
};

}  // namespace furcula::bus
