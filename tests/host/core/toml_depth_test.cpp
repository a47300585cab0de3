// TOML that nests too deep is refused before it is parsed, and nothing else is.
#include "host/core/toml_depth.hpp"

#include <catch2/catch.hpp>

#include "host/core/strict_toml.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string repeated(std::string_view part, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += part;
  return out;
}

std::string refused(const std::string& text) {
  return test::error_message([&] { core::parse_toml(text, "x.toml"); });
}

constexpr const char* kNames = "x.toml:2: more than 16 names joined by dots; expected at most 16";
constexpr const char* kBrackets = "x.toml:2: more than 16 brackets within each other; expected at most 16";

}  // namespace

TEST_CASE("fifty thousand levels of any kind are one message with file and line") {
  constexpr int kMany = 50'000;
  const std::string first = "title = 1\n";
  CHECK(refused(first + repeated("a.", kMany) + "a = 1\n") == kNames);
  CHECK(refused(first + repeated("a . ", kMany) + "a = 1\n") == kNames);
  CHECK(refused(first + repeated("\"a.b\".", kMany) + "a = 1\n") == kNames);
  CHECK(refused(first + repeated("'a'.", kMany) + "a = 1\n") == kNames);
  CHECK(refused(first + "[" + repeated("a.", kMany) + "a]\n") == kNames);
  CHECK(refused(first + "[[" + repeated("a.", kMany) + "a]]\n") == kNames);
  CHECK(refused(first + "x = {" + repeated("a.", kMany) + "a = 1}\n") == kNames);
  CHECK(refused(first + "x = " + repeated("[", kMany) + repeated("]", kMany) + "\n") == kBrackets);
  CHECK(refused(first + "x = " + repeated("[", kMany)) == kBrackets);
  CHECK(refused(first + "x = " + repeated("{a=", kMany) + "1" + repeated("}", kMany) + "\n") == kBrackets);
  CHECK(refused(first + "x = " + repeated("[{a=", kMany)) == kBrackets);
  CHECK(refused(first + "[" + repeated("[", kMany)) == kBrackets);
  // On a line of its own each, within one value.
  CHECK_THAT(refused(first + "x = " + repeated("[ # (\n", kMany)), Contains("x.toml:18: more than 16 brack"));
}

TEST_CASE("sixteen levels are read, and the seventeenth is not") {
  CHECK(refused(repeated("a.", 15) + "a = 1\n").empty());
  CHECK_FALSE(refused(repeated("a.", 16) + "a = 1\n").empty());
  CHECK(refused("x = " + repeated("[", 16) + repeated("]", 16) + "\n").empty());
  CHECK_FALSE(refused("x = " + repeated("[", 17) + repeated("]", 17) + "\n").empty());
  CHECK(refused("x = " + repeated("{a=", 16) + "1" + repeated("}", 16) + "\n").empty());
  CHECK_FALSE(refused("x = " + repeated("{a=", 17) + "1" + repeated("}", 17) + "\n").empty());
  CHECK(refused("[" + repeated("a.", 15) + "a]\nx = 1\n").empty());
  CHECK_FALSE(refused("[" + repeated("a.", 16) + "a]\nx = 1\n").empty());
}

TEST_CASE("what stands in strings and comments does not count, and ends where TOML says that it ends") {
  const std::string dots = repeated("a.", 40), open = repeated("[{", 40);
  for (const std::string& text : {
           "# " + dots + open + " ' \" '''\n",
           "x = \"" + dots + open + " # ' \\\" \\\\\"\n",
           "x = '" + dots + open + " # \" \\'\n",
           "\"" + dots + open + "\" = 1\n",
           "'" + dots + open + "' = 1\n",
           "x = \"\"\"\n" + dots + "\n\"\" " + open + "\\\"\"\"\"\"\n",
           "x = '''\n" + dots + "\n'' " + open + "\\'''''\n",
           "x = \"\"\"" + dots + "\"\"\"\"\"\n",
           "x = \"\" # " + dots + "\ny = ''\nz = \"\"\"\"\"\"\nu = ''''''\n",
           "x = [" + repeated("1.5, ", 100) + "]\n",
           "x = [" + repeated("[1, 2], ", 100) + "]\n",
           "x = [" + repeated("{a.b.c = 1.5}, ", 100) + "]\n",
           "x = [\n" + repeated("1.25 ,\n", 100) + "]\n",
           repeated("[[a.b]]\n", 100),
           std::string("x = 1979-05-27T00:32:00.999999-07:00\n"),
       }) {
    INFO(text);
    CHECK(refused(text).empty());
  }
  // And what stands behind them does.
  for (const char* before : {"x = \"\\\\\"\n", "x = '\\'\n", "x = \"\"\n", "x = ''\n",
                             "x = \"\"\"\\\"\"\"\"\n", "x = '''a'''''\n", "x = \"\"\"a\"\"\"\"\"\n",
                             "x = \"\"\"\"\"\"\n", "x = \"'\" # '''\n", "x = 1\r\n", "# \xe2\x80\xa8\n"}) {
    INFO(before);
    CHECK(refused(before + dots + "a = 1\n") == kNames);
  }
}

TEST_CASE("a text that is no TOML is the parser's to refuse, with its own line") {
  CHECK_THAT(refused("x = \"no end\n" + repeated("a.", 10) + "a = 1\n"), Contains("x.toml:1: no valid TOML"));
  CHECK_THAT(refused("]]]]\n"), Contains("x.toml:1: no valid TOML"));
  CHECK_FALSE(core::find_too_deep("\"").has_value());
  CHECK_FALSE(core::find_too_deep("\"\\").has_value());
  CHECK_FALSE(core::find_too_deep("\"\"\"").has_value());
  CHECK_FALSE(core::find_too_deep("'''''''").has_value());
}
