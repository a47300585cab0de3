// candump's logs: what is read, what is written, what is refused and how.
#include "host/bus/candump.hpp"

#include <catch2/catch.hpp>

#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Matchers::Contains;

namespace {

std::string message_of(const std::string& text) {
  return test::error_message([&] {
    core::TextSource source(text);
    CandumpReader reader(source, "can.log");
    LogFrame frame;
    while (reader.next(frame)) {
    }
  });
}

/// One byte at a time, so that lines end anywhere in what is read.
class Drops final : public core::ByteSource {
 public:
  explicit Drops(std::string_view text) : text_(text) {}
  std::size_t read(char* to, std::size_t size) override {
    if (text_.empty() || size == 0) return 0;
    *to = text_.front();
    text_.remove_prefix(1);
    return 1;
  }

 private:
  std::string_view text_;
};

}  // namespace

TEST_CASE("the example of can-utils is read and written again") {
  const std::string line = "(1436509052.249713) vcan0 044#2A366C2BBA";
  const LogFrame f = parse_candump(line);
  CHECK(f.time_us == 1436509052249713);
  CHECK(f.interface == "vcan0");
  CHECK(f.frame == Frame{0x44, 5, false, false, {0x2a, 0x36, 0x6c, 0x2b, 0xba}});
  CHECK_FALSE(f.error);
  CHECK(format_candump(f) == line + "\n");
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
  CHECK(parse_candump("(0.000001) can1 123#abcdef T").frame.size == 3);  // candump -x
  for (const LogFrame& f : {extended, largest, error}) {
    const std::string text = format_candump(f);
    CHECK(parse_candump(text.substr(0, text.size() - 1)) == f);
  }
  CHECK(format_candump(parse_candump("(1.000002) can1 104#R4")) == "(0000000001.000002) can1 104#R4\n");
}

TEST_CASE("what is wrong is said with file, line, value and what was expected") {
  const std::string good = "(1.000000) can0 123#00\n";
  CHECK(message_of(good + "\r\n" + good) == "");
  CHECK(message_of(good + "what\n") == "can.log:2: 'what'; expected (SECONDS) INTERFACE ID#DATA");
  CHECK_THAT(message_of("(1.5) can0 123#00"),
             Contains("can.log:1: time '1.5'; expected seconds with six decimals"));
  CHECK_THAT(message_of("(9999999999999.000000) can0 123#00"), Contains("expected seconds"));
  CHECK_THAT(message_of("(-1.000000) can0 123#00"), Contains("expected seconds"));
  CHECK_THAT(message_of("(1.000000) can0123#00"), Contains("interface 'can0123#00'; expected"));
  CHECK_THAT(message_of("(1.000000) can0123456789abcdef 123#00"), Contains("up to 15 characters"));
  CHECK_THAT(message_of("(1.000000) can0 123"), Contains("frame '123'; expected ID#DATA"));
  CHECK_THAT(message_of("(1.000000) can0 1234#00"),
             Contains("id '1234'; expected 3 hexadecimal digits, or 8"));
  CHECK_THAT(message_of("(1.000000) can0 12G#00"), Contains("id '12G'"));
  CHECK_THAT(message_of("(1.000000) can0 800#00"), Contains("id '800'; expected at most 7FF"));
  CHECK_THAT(message_of("(1.000000) can0 40000000#00"), Contains("expected at most 1FFFFFFF"));
  CHECK_THAT(message_of("(1.000000) can0 123##100"), Contains("CAN FD frame") && Contains("classical CAN"));
  CHECK_THAT(message_of("(1.000000) can0 123#0"), Contains("data '0'; expected up to 8 bytes"));
  CHECK_THAT(message_of("(1.000000) can0 123#001122334455667788"), Contains("expected up to 8 bytes"));
  CHECK_THAT(message_of("(1.000000) can0 123#0x"), Contains("data '0x'"));
  CHECK_THAT(message_of("(1.000000) can0 123#R9"),
             Contains("remote frame 'R9'; expected R, or R and a length"));
  CHECK_THAT(message_of(std::string(5000, 'x')), Contains("can.log:1: a line of more than 4096 characters"));
  CHECK_THAT(message_of(std::string("\0\0\0", 3)), Contains("'\\x00\\x00\\x00'; expected"));
}

TEST_CASE("a long log is read line by line, the last one without a line end too") {
  std::string text;
  for (int i = 0; i < 3000; ++i)
    text += format_candump({i, "can0", {static_cast<std::uint32_t>(i % 0x800), 1, false, false, {1}}, false});
  text.pop_back();
  Drops source(text);
  CandumpReader reader(source, "can.log");
  LogFrame frame;
  int n = 0;
  for (; reader.next(frame); ++n) REQUIRE(frame.time_us == n);
  CHECK(n == 3000);
}
