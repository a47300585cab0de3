// The DBC file and the page, as text. That others read the file so as it is meant: dbc_parser/.
#include "host/bus/dbc.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "host/bus/document.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Contains;

TEST_CASE(
    "a motor's command has the range of the motor and big-endian signals by their most significant bit") {
  const std::string dbc = to_dbc({{"Knee", Protocol::mini_cheetah, 3, Motor::ak80_64}});
  CHECK_THAT(dbc, Contains("BO_ 3 Knee_Command: 8 Vector__XXX\n"));
  // 16 / 4095 and 25 / 65535
  CHECK_THAT(dbc,
             Contains(" SG_ Position : 7|16@0+ (0.00038147554741741054,-12.5) [-12.5|12.5] \"rad\" Knee\n"));
  CHECK_THAT(dbc, Contains(" SG_ Velocity : 23|12@0+ (0.003907203907203907,-8) [-8|8] \"rad/s\" Knee\n"));
  CHECK_THAT(dbc, Contains("Seven bytes FF and then FC: Enter_Motor_Mode."));
}

TEST_CASE("an ODrive axis has signed fixed-point numbers and IEEE floats") {
  const std::string dbc = to_dbc({{"Axis", Protocol::odrive, 1}, {"Board", Protocol::controller, 1}});
  CHECK_THAT(dbc,
             Contains("BO_ 44 Axis_Set_Input_Pos: 8 Board\n SG_ Position : 0|32@1- (1,0) [0|0] \"rev\" Axis\n"
                      " SG_ Velocity : 32|16@1- (0.001,0) [-32.768|32.767] \"rev/s\" Axis\n"));
  CHECK_THAT(dbc, Contains("\nSIG_VALTYPE_ 44 Position : 1;\n"));
  CHECK_THAT(dbc, Contains("BO_ 33 Axis_Heartbeat: 8 Axis\n"));
}

TEST_CASE("the replies of several motors are one message, multiplexed by the motor's id") {
  const std::string dbc = to_dbc({{"Knee", Protocol::mini_cheetah, 1, Motor::mini_cheetah},
                                  {"Hip", Protocol::mini_cheetah, 2, Motor::ak80_9}});
  CHECK_THAT(dbc, Contains("BO_ 0 Motor_Reply: 8 Knee\n SG_ Motor_Id M : 7|8@0+"));
  CHECK_THAT(dbc, Contains(" SG_ Knee_Velocity m1 : 31|12@0+ (0.031746031746031744,-65)"));  // 130 / 4095
  CHECK_THAT(dbc, Contains(" SG_ Hip_Velocity m2 : 31|12@0+"));
  CHECK_THAT(dbc, Contains("Hip_Temperature m2") && !Contains("Knee_Temperature"));
  CHECK_THAT(dbc, Contains("BO_TX_BU_ 0 : Knee,Hip;\n"));
}

TEST_CASE(
    "every line of the file has one of the forms that a DBC file knows, and names are no longer than 32") {
  std::vector<Node> nodes = usual_nodes();
  nodes.push_back({"Eight_ch", Protocol::odrive, 31});
  nodes.push_back({"Body_8ch", Protocol::walker, 31});
  std::istringstream lines(to_dbc(nodes));
  const std::regex form(
      R"(|VERSION "[^"]*"|NS_ :|\t[A-Z_]+|BS_:|BU_:( \w{1,32})+|BO_ \d+ \w{1,32}: \d \w{1,32}|)"
      R"( SG_ \w{1,32}( M| m\d+)? : \d+\|\d+@[01][+-] \(\d+(\.\d+)?,-?\d+(\.\d+)?\) \[-?\d+(\.\d+)?\|-?\d+(\.\d+)?\] "[^"]*" \w{1,32}|)"
      R"(BO_TX_BU_ \d+ : \w+(,\w+)*;|CM_ (BO_ \d+|SG_ \d+ \w+) "[^"]*";|SIG_VALTYPE_ \d+ \w+ : 1;)");
  std::set<std::string> heads;
  for (std::string line; std::getline(lines, line);) {
    INFO(line);
    CHECK(std::regex_match(line, form));
    if (line.starts_with("BO_ ")) CHECK(heads.insert(line.substr(0, line.find(' ', 4))).second);
  }
  // Without those that have a marker: 9 of the board, 1 of the knee, 14 of each axis, 3 of the rail, the replies, 6 of the biped's body.
  CHECK(heads.size() == 48);
}

TEST_CASE("docs/bus.md is what the table says (furcula bus docs > docs/bus.md)") {
  std::ostringstream page;
  page << std::ifstream(test::source("docs/bus.md")).rdbuf();
  CHECK(page.str() == to_markdown());
}
