// candump's lines: what is read, what is written, what is refused and how.
#include "host/bus/candump.hpp"

#include <catch2/catch.hpp>

#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Contains;

namespace {

std::string refusal_of(const std::string& line) {
  return test::error_message([&] { parse_candump(line); });
}

const Frame kFive{0x44, 5, false, false, {0x2a, 0x36, 0x6c, 0x2b, 0xba}};

}  // namespace

TEST_CASE("the example of can-utils is read and written again") {
  const std::string line = "(1436509052.249713) vcan0 044#2A366C2BBA";
  const LogFrame f = parse_candump(line);
  CHECK(f.time_ns == 1436509052249713000);
  CHECK(f.interface == "vcan0");
  CHECK(f.frame == kFive);
  CHECK_FALSE(f.error);
  CHECK(format_candump(f) == line + "\n");
}

TEST_CASE("a time stamp has 1 to 9 decimals, or a date") {
  CHECK(parse_candump("(1.5) can0 123#00").time_ns == 1'500'000'000);
  CHECK(parse_candump("(1732672000.000123456) can0 123#00").time_ns == 1732672000000123456);
  CHECK(format_candump(parse_candump("(0000000001.000000001) can0 123#00")) ==
        "(0000000001.000000001) can0 123#00\n");
  // 2024-02-29 is day 19782 since 1970: 54 years, 13 leap days, 59 days.
  CHECK(parse_candump(" (2024-02-29 01:02:03.000004)  can0  123   [0] ").time_ns ==
        (19782LL * 86400 + 3723) * 1'000'000'000 + 4000);
  for (const char* time : {"1", "1.", ".5", "1.0000000000", "-1.000000", "9999999999999.000000",
                           "2024-13-01 00:00:00.0", "2024-01-01 00:00:00", "1.5e3"})
    CHECK_THAT(refusal_of("(" + std::string(time) + ") can0 123#00"),
               Contains("expected seconds with 1 to 9 decimals"));
}

TEST_CASE("extended ids, remote frames, empty ones and errors are told apart") {
  const LogFrame extended = parse_candump("(0000000000.000000) can1 00000123#DE");
  CHECK(extended.frame == Frame{0x123, 1, true, false, {0xde}});
  const LogFrame largest = parse_candump("(0.000000) can1 1FFFFFFF#");
  CHECK(largest.frame == Frame{0x1fffffff, 0, true, false, {}});
  CHECK(parse_candump("(0.000001) can1 7ff#R").frame == Frame{0x7ff, 0, false, true, {}});
  CHECK(parse_candump("(0.000001) can1 104#R4").frame == Frame{0x104, 4, false, true, {}});
  const LogFrame error = parse_candump("(0.000001) can1 20000080#0000000000000000");
  CHECK(error.error);
  CHECK(error.frame.id == 0x80);
  for (const LogFrame& f : {extended, largest, error}) {
    const std::string text = format_candump(f);
    CHECK(parse_candump(text.substr(0, text.size() - 1)) == f);
  }
  CHECK(format_candump(parse_candump("(1.000002) can1 104#R4")) == "(0000000001.000002) can1 104#R4\n");
}

TEST_CASE("directions, raw length codes, points between bytes and aligned names of the log format are read") {
  CHECK(parse_candump("(0.000001) can1 123#abcdef T").frame.size == 3);  // -x
  CHECK(parse_candump("(0.000001) can1 123#abcdef R").frame.size == 3);
  const Frame whole{0x123, 8, false, false, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}};
  CHECK(parse_candump("(0.000001) can1 123#1122334455667788_9").frame == whole);  // -8
  CHECK(parse_candump("(0.000001) can1 123#R8_F").frame == Frame{0x123, 8, false, true, {}});
  CHECK(parse_candump("(0.000001) can1 123#11.22.33.44.55.66.77.88").frame == whole);
  CHECK(parse_candump("(0.000001)   can1 123#1122334455667788").frame == whole);  // beside a longer name
  CHECK(parse_candump("(0.000001) /dev/ttyUSB0@115200 123#00").interface == "/dev/ttyUSB0@115200");
}

TEST_CASE("a frame of CAN FD or CAN XL is told from a classical one, and its data is not kept") {
  for (const char* frame :
       {"123##0", "123##1112233", "1FFFFFFF##3AA.BB", "45123#81:00:12345678#11223344.556677"}) {
    const LogFrame f = parse_candump("(1.000000) can0 " + std::string(frame));
    CHECK(f.longer);
    CHECK(f.frame.size == 0);
  }
  CHECK_FALSE(parse_candump("(1.000000) can0 123#00").longer);
  CHECK_THAT(refusal_of("(1.000000) can0 123##1xx"), Contains("expected hexadecimal digits"));
}

TEST_CASE("what candump prints on a screen is the same frame with each of its options") {
  for (const char* line :
       {" (1436509052.249713)  can0  044   [5]  2A 36 6C 2B BA",
        " (1436509052.249713)  can0  044   {5}  2A 36 6C 2B BA",
        " (1436509052.249713)  can0       044   [5]  2A 36 6C 2B BA",
        "(1436509052.249713)  can0  044   [5]  2A 36 6C 2B BA",
        " (1436509052.249713)  can0  RX - -  044   [5]  2A 36 6C 2B BA",
        " (1436509052.249713)  can0  TX B E  044   [5]  2A 36 6C 2B BA",
        " (1436509052.249713)  can0  044   [5]  BA`2B`6C`36`2A",
        " (1436509052.249713)  can0  044   [5]  2A 36 6C 2B BA            '*6l+.'",
        " (1436509052.249713)  can0  044   [5]  BA`2B`6C`36`2A            `.+l6*`",
        " (1436509052.249713)  can0  044   [5]  00101010 00110110 01101100 00101011 10111010",
        " (1436509052.249713)  can0  044   [5]  10111010`00101011`01101100`00110110`00101010"}) {
    INFO(line);
    LogFrame f;
    CHECK(parse_candump(line, f) == TimeFrom::absolute);
    CHECK(f == parse_candump("(1436509052.249713) can0 044#2A366C2BBA"));
  }
  LogFrame f;
  CHECK(parse_candump(" (003.000123)  can0  044   [0] ", f) == TimeFrom::relative);
  CHECK(parse_candump("  can0  044   [0] ", f) == TimeFrom::none);
  CHECK(parse_candump(" (1.5)  can0  044   [4]  remote request").frame == Frame{0x44, 4, false, true, {}});
  CHECK(parse_candump(" (1.5)  can0  20000004   [8]  00 04 00 00 00 00 00 00   ERRORFRAME").error);
  CHECK(parse_candump(" (1.5)  can0  123   {9}  00 01 02 03 04 05 06 07").frame.size == 8);
  for (const char* longer : {"[08]", "[64]", "[0128]"})
    CHECK(parse_candump(" (1.5)  can0  123  " + std::string(longer) + "  00 01 02 03 04 05 06 07").longer);
}

TEST_CASE("what is wrong with a line is said with its value and what was expected") {
  CHECK(refusal_of("what") == "'what'; expected (SECONDS) INTERFACE ID#DATA");
  CHECK_THAT(refusal_of("(1.000000"), Contains("expected (SECONDS) INTERFACE ID#DATA"));
  CHECK_THAT(refusal_of("(1.000000) can0123#00"), Contains("interface 'can0123#00'; expected"));
  CHECK_THAT(refusal_of("(1.000000) " + std::string(65, 'c') + " 123#00"), Contains("up to 64 characters"));
  CHECK_THAT(refusal_of("(1.000000) can0 123"), Contains("frame '123'; expected ID#DATA"));
  CHECK_THAT(refusal_of("(1.000000) can0 1234#00"),
             Contains("id '1234'; expected 3 hexadecimal digits, or 8"));
  CHECK_THAT(refusal_of("(1.000000) can0 12G#00"), Contains("id '12G'"));
  CHECK_THAT(refusal_of("(1.000000) can0 800#00"), Contains("id '800'; expected at most 7FF"));
  CHECK_THAT(refusal_of("(1.000000) can0 40000000#00"), Contains("expected at most 1FFFFFFF"));
  CHECK_THAT(refusal_of("(1.000000) can0 123#0"), Contains("data '0'; expected up to 8 bytes"));
  CHECK_THAT(refusal_of("(1.000000) can0 123#001122334455667788"), Contains("expected up to 8 bytes"));
  CHECK_THAT(refusal_of("(1.000000) can0 123#0x"), Contains("data '0x'"));
  CHECK_THAT(refusal_of("(1.000000) can0 123#R9"),
             Contains("remote frame 'R9'; expected R, or R and a length"));
  CHECK_THAT(refusal_of("(1.000000) can0 123#00 what"), Contains("'what' after the frame"));
  CHECK_THAT(refusal_of(" (1.5)  can0  123   [9]  00"), Contains("length '[9]'; expected bytes of data"));
  CHECK_THAT(refusal_of(" (1.5)  can0  123   [3]  00 01"), Contains("data ''; expected as many bytes"));
  CHECK_THAT(refusal_of(" (1.5)  can0  123   [1]  00 01"), Contains("'01' after 1 bytes"));
  CHECK_THAT(refusal_of(std::string("\0\0\0", 3)), Contains("'\\x00\\x00\\x00'; expected"));
}
