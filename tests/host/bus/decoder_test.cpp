// Recordings as rows of signals, and the program's way to give them.
#include "host/bus/decoder.hpp"

#include <catch2/catch.hpp>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Contains;

namespace {

std::string rows_of(const std::string& line, std::vector<Node> nodes = usual_nodes()) {
  Decoder decoder(std::move(nodes));
  std::string rows;
  decoder.decode(parse_candump("(12.000345) can0 " + line), rows);
  return rows + decoder.remarks();
}

}  // namespace

TEST_CASE("a frame becomes a row for each of its signals") {
  CHECK(rows_of("049#0000803F000000C0") ==
        "12.000345,can0,Axis_Get_Encoder_Estimates,Position,1,rev\n"
        "12.000345,can0,Axis_Get_Encoder_Estimates,Velocity,-2,rev/s\n");
  // Counters keep all of their digits: 2^31 - 1 and below 0.
  CHECK_THAT(rows_of("461#0105FF00FFFFFF7F"), Contains("Sample,Count,2147483647,\n") &&
                                                  Contains(",Sequence,5,\n") && Contains(",Age,0.0255,s\n"));
  CHECK_THAT(rows_of("461#0105FF0000000080"), Contains("Sample,Count,-2147483648,\n"));
  CHECK_THAT(rows_of("043#FFFFFFFF01000000"), Contains("Active_Errors,4294967295,\n"));
  CHECK_THAT(rows_of("049#0000C07F00000000"), Contains("Position,nan,rev"));
}

TEST_CASE("nanoseconds of a stamp stay where they are there") {
  Decoder decoder(usual_nodes());
  std::string rows;
  decoder.decode(parse_candump("(12.000345678) can0 001#FFFFFFFFFFFFFFFC"), rows);
  CHECK(rows == "12.000345678,can0,Knee_Enter_Motor_Mode,,,\n");
}

TEST_CASE("a motor's special frames are named, and its reply is read at both lengths") {
  CHECK(rows_of("001#FFFFFFFFFFFFFFFC") == "12.000345,can0,Knee_Enter_Motor_Mode,,,\n");
  CHECK(rows_of("001#FFFFFFFFFFFFFFFD") == "12.000345,can0,Knee_Exit_Motor_Mode,,,\n");
  CHECK(rows_of("001#FFFFFFFFFFFFFFFE") == "12.000345,can0,Knee_Set_Zero_Position,,,\n");
  CHECK_THAT(rows_of("001#FFFFFFFFFFFFFFFF"), Contains("Knee_Command,Torque,18,N m\n"));
  CHECK_THAT(rows_of("000#01FFFF000FFF"),
             Contains("Knee_Reply,Velocity,-50,rad/s\n") && !Contains("Temperature"));
  CHECK_THAT(rows_of("000#01FFFF000FFF2A00"), Contains("Knee_Reply,Temperature,42,degC\n"));
  // The two legs' motors share id 0; the first byte tells whose range it is.
  const std::vector<Node> legs{{"L", Protocol::mini_cheetah, 1, Motor::ak80_9},
                               {"R", Protocol::mini_cheetah, 2, Motor::ak80_64}};
  CHECK_THAT(rows_of("000#01FFFF000FFF", legs), Contains("L_Reply,Torque,18,N m"));
  CHECK_THAT(rows_of("000#02FFFF000FFF", legs), Contains("R_Reply,Torque,144,N m"));
}

TEST_CASE("what cannot be decoded is counted, with its id") {
  CHECK(rows_of("123#00") == "1 frame of ids that no message has: 0x123 (1)\n");
  CHECK(rows_of("00000049#0000803F000000C0") == "1 frame of ids that no message has: 0x00000049 (1)\n");
  CHECK(rows_of("000#07FFFF000FFF") == "1 frame of ids that no message has: 0x000 (1)\n");
  CHECK(rows_of("049#00") == "1 frame of a length that their message does not have: 0x049 (1)\n");
  CHECK(rows_of("000#01FFFF") == "1 frame of a length that their message does not have: 0x000 (1)\n");
  CHECK(rows_of("049#R8") == "1 frame asking for data (remote)\n");
  CHECK(rows_of("049##10000803F000000C0") == "1 frame of CAN FD, not decoded\n");
  CHECK(rows_of("20000004#0000000000000000") == "1 frame reporting an error of the bus\n");
}

TEST_CASE("noise of many ids is counted in bounded memory") {
  Decoder decoder(usual_nodes());
  std::string rows;
  for (std::uint32_t id = 0; id < 5000; ++id)
    decoder.decode({0, "can0", {id, 0, true, false, {}}, false}, rows);
  CHECK(rows.empty());
  CHECK(decoder.decoded() == 0);
  CHECK_THAT(decoder.remarks(),
             Contains("5000 frames of ids that no message has: ") && Contains("and 991 more"));
}

TEST_CASE("furcula bus decode prints rows, says what it left out, and ends with the contract's statuses") {
  const test::TemporaryFolder folder;
  const std::string good = folder.file("can.log",
                                       "(1.000000) can0 049#0000803F000000C0\n"
                                       "(1.000100) can0 123#\n");
  const test::Ran ran = test::run_furcula({"bus", "decode", good});
  CHECK(ran.status == 0);
  CHECK(ran.out == std::string(kDecodedHeader) +
                       "1.000000,can0,Axis_Get_Encoder_Estimates,Position,1,rev\n"
                       "1.000000,can0,Axis_Get_Encoder_Estimates,Velocity,-2,rev/s\n");
  CHECK(ran.err == good + ": 2 frames, 1 decoded\n1 frame of ids that no message has: 0x123 (1)\n");

  const test::Ran other = test::run_furcula({"bus", "decode", "--node", "Other=odrive:3", good});
  CHECK_THAT(other.err, Contains("0x049 (1), 0x123 (1)"));

  const std::string bad =
      folder.file("bad.log", "(1.000000) can0 049#0000803F000000C0\n(1.000100) can0 049#0\n");
  const test::Ran refused = test::run_furcula({"bus", "decode", bad});
  CHECK(refused.status == 3);
  CHECK_THAT(refused.err, Contains("bad.log:2: data '0'; expected up to 8 bytes"));
  CHECK(test::run_furcula({"bus", "decode", folder.file("empty.log", "")}).status == 3);
  CHECK(test::run_furcula({"bus", "decode", folder.path() + "/none.log"}).status == 3);
  CHECK(test::run_furcula({"bus", "decode"}).status == 2);
  CHECK(test::run_furcula({"bus"}).status == 2);
  const test::Ran node = test::run_furcula({"bus", "dbc", "--node", "K=mini_cheetah:1:ak80"});
  CHECK(node.status == 2);
  CHECK_THAT(node.err, Contains("--node: node 'K=mini_cheetah:1:ak80': no motor 'ak80'"));
  CHECK(test::run_furcula({"bus", "--help"}).status == 0);
}

TEST_CASE("furcula bus dbc and docs print what the rest of the project takes") {
  CHECK_THAT(test::run_furcula({"bus", "dbc"}).out, Contains("BO_ 1025 Board_Command: 8 Host\n"));
  const test::Ran two = test::run_furcula(
      {"bus", "dbc", "--node", "L=mini_cheetah:1:ak80_9", "--node", "R=mini_cheetah:2:ak80_9"});
  CHECK_THAT(two.out, Contains("L_Command") && Contains("R_Command"));
  CHECK_THAT(test::run_furcula({"bus", "docs"}).out, Contains("# CAN messages\n"));
}
