// Between the thread that speaks with people and the loop: a request goes in, its answer comes out.
#pragma once

#include <array>
#include <cstdint>

#include "boards/linux_sbc/slot.hpp"
#include "furcula/bus/modbus_pdu.hpp"

namespace furcula::linux_sbc {

/// A Modbus request or answer without what wraps it on the wire: function code and data.
struct Pdu {
  static constexpr std::size_t kMostBytes = bus::kPduBytesMax;
  std::uint32_t number = 0;  ///< an answer has that of its request
  std::uint16_t size = 0;
  std::array<std::uint8_t, kMostBytes> bytes{};
};

struct Hatch {
  Slot<Pdu> request;  ///< put by the server, taken by the loop
  Slot<Pdu> answer;   ///< the other way round
};

}  // namespace furcula::linux_sbc
