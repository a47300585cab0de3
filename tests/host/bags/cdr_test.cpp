// CDR by the rules of its specification: bytes that were laid out by hand.
#include "host/bags/cdr.hpp"

#include <catch2/catch.hpp>

#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace std::string_literals;
using Catch::Contains;

namespace {

bags::CdrDecoder decoder(const std::string& text) {
  return bags::CdrDecoder(bags::parse_definition(text, "a_msgs/msg/A"));
}

std::vector<double> decoded(const std::string& text, const std::string& bytes) {
  bags::Decoded to;
  CHECK(decoder(text).decode(bytes, to).empty());
  return to.values;
}

std::string refused(const std::string& text) {
  return test::error_message([&] { bags::parse_definition(text, "a_msgs/msg/A"); });
}

const std::string kLittle = "\0\1\0\0"s, kBig = "\0\0\0\0"s, kLittle2 = "\0\7\0\0"s;
const std::string kOne = "\0\0\0\0\0\0\xf0\x3f"s;  // 1.0

}  // namespace

TEST_CASE("numbers are aligned to their size from behind the encapsulation on") {
  CHECK(decoded("uint8 a\nfloat64 b", kLittle + "\5" + std::string(7, '\xff') + kOne) ==
        std::vector<double>{5.0, 1.0});
  CHECK(decoded("uint8 a\nint16 b\nint32 c", kLittle + "\5\xff\xfe\xff\3\0\0\0"s) ==
        std::vector<double>{5, -2, 3});
}

TEST_CASE("XCDR2 aligns to four bytes at most") {
  CHECK(decoded("uint8 a\nfloat64 b", kLittle2 + "\5\xff\xff\xff" + kOne) == std::vector<double>{5.0, 1.0});
}

TEST_CASE("big-endian messages are read") {
  CHECK(decoded("uint16 a\nfloat64 b", kBig + "\1\2"s + std::string(6, '\0') + "\x3f\xf0\0\0\0\0\0\0"s) ==
        std::vector<double>{258.0, 1.0});
}

TEST_CASE("behind an empty sequence nothing is aligned to its elements") {
  // Length 0 of a at 0, of b at 4, then one element of c, aligned from 12 to 16.
  CHECK(decoded("float64[] a\nfloat64[] b\nfloat64[] c",
                kLittle + std::string(8, '\0') + "\1\0\0\0\0\0\0\0"s + kOne) == std::vector<double>{1.0});
}

TEST_CASE("constants, defaults, bounds and comments are no fields") {
  const bags::CdrDecoder d = decoder(
      "# a comment\nuint8 OFF=0\nstring NAME = \"a # b\"\nuint8 mode 3 # default\nint32[<=4] few\nstring<=5 label \"x\"\n"
      "a_msgs/B[2] pairs\n=====\nMSG: a_msgs/B\nbool yes true\n");
  bags::Decoded to;
  const std::string bytes = kLittle + "\7\0\0\0\1\0\0\0\x2a\0\0\0\2\0\0\0x\0\1\0"s;
  CHECK(d.decode(bytes, to).empty());
  CHECK(to.values == std::vector<double>{7, 42, 1, 0});
  CHECK(d.names(bytes) == std::vector<std::string>{"mode", "few[0]", "pairs[0]/yes", "pairs[1]/yes"});
}

TEST_CASE("a message without fields has one byte") {
  CHECK(
      decoded("std_msgs/Empty e\nuint8 a\n===\nMSG: std_msgs/Empty\n# nothing\n", kLittle + "\0\5"s).back() ==
      5.0);
}

TEST_CASE("long sequences are passed over and what follows is read") {
  std::string bytes = kLittle + "\0\4\0\0"s + std::string(1024, 'x') + "\5";
  CHECK(decoded("uint8[] image\nuint8 a", bytes) == std::vector<double>{5.0});
}

TEST_CASE("a message that ends before its fields, or claims more than it holds, is refused") {
  bags::Decoded to;
  CHECK_THAT(decoder("float64 a").decode(kLittle + "\0\0\0\0"s, to),
             Contains("its 8 bytes end before its fields do"));
  CHECK_THAT(decoder("float64[] a").decode(kLittle + "\xff\xff\xff\xff", to),
             Contains("end before its fields do"));
  CHECK_THAT(decoder("string a").decode(kLittle + "\xff\xff\xff\x7f", to),
             Contains("end before its fields do"));
  CHECK_THAT(decoder("float64 a").decode("\0\1"s, to), Contains("it has 2 bytes; expected at least four"));
  CHECK_THAT(decoder("float64 a").decode("\0\3\0\0"s + kOne, to),
             Contains("the CDR representation 3; expected plain CDR"));
}

TEST_CASE("parts without any byte cost no time, however many a definition claims") {
  bags::Decoded to;
  CHECK(decoder("B[4000000000] b\nuint8 a\n===\nMSG: a_msgs/B\nuint8[0] none\n")
            .decode(kLittle + "\5", to)
            .empty());
  CHECK(to.values == std::vector<double>{5.0});
  std::string text = "P0 p\n";
  for (int i = 0; i < 30; ++i) {
    const std::string next =
        i < 29 ? "P" + std::to_string(i + 1) + " a\nP" + std::to_string(i + 1) + " b\n" : "uint8[0] a\n";
    text += "===\nMSG: a_msgs/P" + std::to_string(i) + "\n" + next;
  }
  CHECK_THAT(decoder(text).decode(kLittle, to), Contains("it has too many parts"));
}

TEST_CASE("definitions that no message can have are refused") {
  CHECK_THAT(refused("a_msgs/B b\n===\nMSG: a_msgs/B\na_msgs/B again\n"),
             Contains("'a_msgs/B', which contains itself"));
  CHECK_THAT(refused("other_msgs/Thing b\n"), Contains("lacks the type 'other_msgs/Thing'"));
  CHECK_THAT(refused("float64\n"), Contains("has the line 'float64'"));
  CHECK_THAT(refused("float64[x] a\n"), Contains("has the line 'float64[x] a'"));
  CHECK_THAT(refused("float64 a\n====\nfloat64 b\n"), Contains("has no line \"MSG: package/Type\""));
}

TEST_CASE("types that databases do not describe are built in") {
  for (const char* type :
       {"sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu", "std_msgs/msg/Float64MultiArray"})
    CHECK_FALSE(bags::parse_definition(bags::built_in_definition(type), type).messages.empty());
  CHECK(bags::built_in_definition("sensor_msgs/msg/Image").empty());
}
