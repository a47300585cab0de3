// Foreign text in messages: what a terminal would act on is shown, all else is kept.
#include "host/core/message.hpp"

#include <catch2/catch.hpp>

using namespace furcula;

TEST_CASE("text that a terminal would act on is shown as bytes, and UTF-8 is kept") {
  CHECK(core::printable("height_m") == "height_m");
  CHECK(core::printable("Höhe µm 高さ 🦗 – é") == "Höhe µm 高さ 🦗 – é");
  CHECK(core::printable("\x1b[2J\x1b]0;title\x07") == "\\x1b[2J\\x1b]0;title\\x07");
  CHECK(core::printable(std::string_view("a\0b\n\r\t\x7f", 7)) == "a\\x00b\\x0a\\x0d\\x09\\x7f");
  // C1: U+009B is ESC [ in one character. Also as a byte of its own, which is no UTF-8.
  CHECK(core::printable("\xc2\x9b-J") == "\\xc2\\x9b-J");
  CHECK(core::printable("\x9b-J") == "\\x9b-J");
  CHECK(core::printable("\xc2\xa0") == "\xc2\xa0");
  // Right to left (U+202E) writes a file's name backwards; U+2028 ends a line; U+2066 isolates.
  CHECK(core::printable("-\xe2\x80\xae-\xe2\x80\xa8\xe2\x81\xa6") ==
        "-\\xe2\\x80\\xae-\\xe2\\x80\\xa8\\xe2\\x81\\xa6");
  CHECK(core::printable("\xe2\x80\x94") == "\xe2\x80\x94");
}

TEST_CASE("bytes that are no UTF-8 are shown one by one") {
  CHECK(core::printable("\xf6") == "\\xf6");                             // Latin-1
  CHECK(core::printable("\xc3") == "\\xc3");                             // cut
  CHECK(core::printable("\xc0\x9b") == "\\xc0\\x9b");                    // overlong ESC
  CHECK(core::printable("\xe0\x80\x9b") == "\\xe0\\x80\\x9b");           // overlong
  CHECK(core::printable("\xed\xa0\x80") == "\\xed\\xa0\\x80");           // surrogate
  CHECK(core::printable("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");  // above U+10FFFF
  CHECK(core::printable("\xff\x80g") == "\\xff\\x80g");
}

TEST_CASE("a message of several lines keeps its line ends, and those alone") {
  CHECK(core::printable_lines("a\nb\r\x1b") == "a\nb\\x0d\\x1b");
}

TEST_CASE("a quoted value is printable, and is not cut within a character") {
  CHECK(core::quoted("\x1b[31mred") == "'\\x1b[31mred'");
  CHECK(core::quoted("Höhe") == "'Höhe'");
  CHECK(core::quoted(std::string(40, 'a')) == "'" + std::string(40, 'a') + "'");
  CHECK(core::quoted(std::string(41, 'a')) == "'" + std::string(40, 'a') + "...'");
  CHECK(core::quoted(std::string(39, 'a') + "éb") == "'" + std::string(39, 'a') + "...'");
  CHECK(core::quoted(std::string(37, 'a') + "🦗b") == "'" + std::string(37, 'a') + "...'");
}
