// Where a robot answers, as the command line names it.
#include "host/core/error.hpp"
#include "host/modbus/port.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  try {
    const modbus::Port port = modbus::parse_port(input);
    require(port.text == input, "a port keeps its name");
    if (!port.can_interface.empty()) {
      require(port.host.empty() && port.device.empty(), "a CAN interface is no host and no device");
      require(port.can_node >= 1 && port.can_node <= 31, "a node is one");
      return true;
    }
    require(port.host.empty() != port.device.empty(), "it is a host or a device");
    if (port.device.empty()) {
      require(port.tcp_port >= 1 && port.tcp_port <= 65535, "a port number is one");
      require(input == "modbus:" + port.host + ":" + std::string(input.substr(input.rfind(':') + 1)),
              "the host is what was said");
    } else {
      require(port.device[0] == '/' && port.baud >= 1200, "a device has a path and a speed");
      require(std::string_view("ENO").find(port.parity) != std::string_view::npos, "a parity is one");
      require(port.stop_bits == 1 || port.stop_bits == 2, "and so are stop bits");
    }
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
