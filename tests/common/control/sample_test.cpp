// What travels between controller and board.
#include "furcula/control/sample.hpp"

#include <catch2/catch.hpp>

TEST_CASE("a default command is the safe state") {
  const furcula::control::Command command;
  CHECK(command.torque_nm == 0.0f);
  CHECK(command.coil_duty == 0.0f);
}
