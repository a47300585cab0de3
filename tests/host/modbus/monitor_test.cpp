// A robot's page as a person reads it: what a device says of itself reaches no terminal as it is.
#include "host/modbus/monitor.hpp"

#include <catch2/catch.hpp>

#include "furcula/bus/node_words.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("A device's identification has no control characters on the page") {
  modbus::View view;
  view.names = {"vendor\x1b[2J", "board\x1b]0;owned\x07", "1.2.3\r\nrobot      fine"};
  const std::string page = modbus::to_text(view);
  for (const char c : page) {
    INFO(static_cast<int>(c));
    CHECK((c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f)));
  }
  // No line of the device's own.
  CHECK(page.find("\nrobot      fine") == std::string::npos);
}

TEST_CASE("A robot that stands still under a constant torque does not move, and the page says why") {
  modbus::View view;
  view.snapshot.state = static_cast<std::uint16_t>(bus::NodeState::running);
  view.snapshot.reason = static_cast<std::uint16_t>(bus::Reason::standing_still);
  CHECK_THAT(modbus::to_text(view), Contains("why not    It stands still"));
  view.snapshot.reason = static_cast<std::uint16_t>(bus::Reason::none);
  CHECK_THAT(modbus::to_text(view), Contains("moves      Nothing holds it"));
}
