// How a port is written.
#include "host/modbus/port.hpp"

#include <catch2/catch.hpp>

#include "host/log/error.hpp"

using namespace furcula;
using Catch::Matchers::Contains;

TEST_CASE("a port is a serial line with its speed and format, or a host and a port number") {
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
}

TEST_CASE("what is no port is told what was expected") {
  for (const char* text : {"", "modbus:", "modbus:host", "modbus::502", "modbus:host:0", "modbus:host:65536",
                           "modbus:host:5x", "modbus:/dev/x@", "modbus:/dev/x@12345",
                           "modbus:/dev/x@9600,7E1", "modbus:/dev/x@9600,8E", "can:can0", "/dev/ttyUSB0"}) {
    INFO(text);
    CHECK_THROWS_WITH(modbus::parse_port(text), Contains("expected modbus:/dev/NAME@BAUD"));
  }
}
