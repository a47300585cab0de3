// How a port is written.
#include "host/modbus/port.hpp"

#include <catch2/catch.hpp>

#include "host/core/error.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE(
    "a port is a serial line with its speed and format, a host and a port number, or a CAN interface and a node") {
  const modbus::Port line = modbus::parse_port("modbus:/dev/ttyUSB0@19200");
  CHECK(line.device == "/dev/ttyUSB0");
  CHECK(line.baud == 19200);
  CHECK(line.parity == 'E');
  CHECK(line.stop_bits == 1);
  CHECK(modbus::parse_port("modbus:/dev/ttyACM0").baud == 115200);
  const modbus::Port plain = modbus::parse_port("modbus:/dev/x@9600,8N2");
  CHECK(plain.parity == 'N');
  CHECK(plain.stop_bits == 2);
  const modbus::Port tcp = modbus::parse_port("modbus:robot.local:1502");
  CHECK(tcp.device.empty());
  CHECK(tcp.host == "robot.local");
  CHECK(tcp.tcp_port == 1502);
  CHECK(modbus::parse_port("modbus:::1:502").host == "::1");
  CHECK(tcp.can_interface.empty());
  const modbus::Port can = modbus::parse_port("can:can0");
  CHECK(can.can_interface == "can0");
  CHECK(can.can_node == 1);
  CHECK(can.text == "can:can0");
  CHECK(modbus::parse_port("can:vcan0@31").can_interface == "vcan0");
  CHECK(modbus::parse_port("can:vcan0@31").can_node == 31);
}

TEST_CASE("what is no port is told what was expected") {
  for (const char* text :
       {"", "modbus:", "modbus:host", "modbus::502", "modbus:host:0", "modbus:host:65536", "modbus:host:5x",
        "modbus:/dev/x@", "modbus:/dev/x@12345", "modbus:/dev/x@9600,7E1", "modbus:/dev/x@9600,8E",
        "can:", "can:@1", "can:can0@", "can:can0@0", "can:can0@32", "can:can0@1x", "/dev/ttyUSB0"}) {
    INFO(text);
    CHECK_THROWS_WITH(modbus::parse_port(text), Contains("expected modbus:/dev/NAME@BAUD"));
  }
}
