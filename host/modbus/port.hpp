// Where a robot's registers are, as the command line names it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace furcula::modbus {

struct Port {
  std::string text;           ///< as it was given, for messages
  std::string can_interface;  ///< empty: Modbus
  std::uint8_t can_node = 1;
  std::string device;  ///< of a serial line; empty: TCP
  int baud = 115200;
  char parity = 'E';  ///< E, N or O; 8 data bits
  int stop_bits = 1;
  std::string host;  ///< of TCP
  int tcp_port = 502;
};

/// `modbus:/dev/ttyUSB0@115200`, `modbus:/dev/ttyUSB0@115200,8N1`, `modbus:HOST:PORT`, `can:can0` or
/// `can:can0@NODE`.
/// @throws core::DataError saying what was expected.
Port parse_port(std::string_view text);

}  // namespace furcula::modbus
