// Where a robot answers to Modbus, as the command line names it.
#pragma once

#include <string>
#include <string_view>

namespace furcula::modbus {

struct Port {
  std::string text;    ///< as it was given, for messages
  std::string device;  ///< of a serial line; empty: TCP
  int baud = 115200;
  char parity = 'E';  ///< E, N or O; 8 data bits
  int stop_bits = 1;
  std::string host;  ///< of TCP
  int tcp_port = 502;
};

/// `modbus:/dev/ttyUSB0@115200`, `modbus:/dev/ttyUSB0@115200,8N1` or `modbus:HOST:PORT`.
/// @throws log::DataError saying what was expected.
Port parse_port(std::string_view text);

}  // namespace furcula::modbus
