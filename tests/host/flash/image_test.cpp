// Images, their headers, the boards' flash.toml and the commands of the tools.
#include "host/flash/image.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/core/error.hpp"
#include "host/flash/boards.hpp"
#include "host/flash/tools.hpp"
#include "tests/host/flash/made_image.hpp"

namespace {

using namespace furcula;
using Catch::Contains;
using core::DataError;

std::string refusal(const std::string& elf) {
  try {
    static_cast<void>(flash::read_elf(elf, "x.elf"));
  } catch (const DataError& e) {
    return e.what();
  }
  return "taken";
}

}  // namespace

TEST_CASE("an ELF file gives the bytes as they lie in the flash memory, and what the image says of itself") {
  const std::string bytes = test::made_image("some_board");
  const flash::Image image = flash::read_elf(test::made_elf(bytes), "x.elf");
  CHECK(std::string(image.bytes.begin(), image.bytes.end()) == bytes);
  CHECK(image.board() == "some_board");
  CHECK(image.version() == "1.2.3, build 0badcafe");
}

TEST_CASE("a damaged, cut or foreign file is refused with the reason") {
  const std::string bytes = test::made_image("some_board"), elf = test::made_elf(bytes);
  CHECK_THAT(refusal(""), Contains("x.elf: not an ELF file"));
  CHECK_THAT(refusal("\x7f"
                     "ELF\x02\x01 of 64 bits"),
             Contains("not an ELF file"));
  std::string other = elf;
  test::put(other, 18, 62, 2);  // x86-64
  CHECK_THAT(refusal(other), Contains("not an ELF file for a Cortex-M"));
  for (std::size_t size = 20; size < elf.size(); ++size) REQUIRE(refusal(elf.substr(0, size)) != "taken");
  CHECK_THAT(refusal(elf.substr(0, 600)), Contains("ends too early"));

  other = elf;
  test::put(other, 52 + 12, 0x20000000);
  CHECK_THAT(refusal(other), Contains("a segment at 20000000 that is not in the flash memory"));
  other = elf;
  test::put(other, 52 + 12, 0x080fffff);
  CHECK_THAT(refusal(other), Contains("not in the flash memory"));
  CHECK_THAT(refusal(test::made_elf(std::string(1000, 'x'))),
             Contains("no header of a Furcula image at 08000200"));
  CHECK_THAT(refusal(test::made_elf(std::string(300, 'x'))), Contains("no header"));

  std::string changed = bytes;
  test::put(changed, 0x204, 2);
  CHECK_THAT(refusal(test::made_elf(changed)), Contains("version 2; expected 1"));
  CHECK_THAT(refusal(test::made_elf(bytes + "x")), Contains("says 1000 bytes, and it has 1001"));
  // Any bit of the image.
  for (std::size_t at = 0; at < bytes.size(); at += 13) {
    changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    REQUIRE(refusal(test::made_elf(changed)) != "taken");
  }
  changed = bytes;
  changed[10] = 'x';
  CHECK_THAT(refusal(test::made_elf(changed)), Contains("CRC-32"));
}

TEST_CASE("every board of the tree can be flashed, and says what to do if it is not found") {
  REQUIRE(flash::boards().size() >= 2);
  for (const flash::FlashBoard& board : flash::boards()) {
    INFO(board.name);
    CHECK_FALSE(board.hint.empty());
    int tools = 0;
    for (const std::string_view tool : flash::kTools) tools += flash::suits(tool, board);
    CHECK(tools > 0);
  }
}

TEST_CASE("a board's flash.toml that makes no sense is refused with the key") {
  const auto parse = [](const char* text) { return flash::parse_board(text, "b", "flash.toml"); };
  CHECK(parse("dfu = \"0483:df11\"").dfu == "0483:df11");
  CHECK_THROWS_WITH(parse("dfu = 1"), Contains("dfu"));
  CHECK_THROWS_WITH(parse("st_flash = 1"), Contains("st_flash: expected true or false"));
  CHECK_THROWS_WITH(parse("openocd = \"x\""), Contains("openocd: expected an array"));
  CHECK_THROWS_WITH(parse("hint = \"x\""), Contains("no way to flash"));
  CHECK_THROWS_WITH(parse("opnocd = []"), Contains("openocd"));
}

TEST_CASE("no command erases or writes where the parameters are") {
  const flash::FlashBoard board{"b", {"x.cfg"}, true, "0483:df11", ""};
  for (const std::string_view tool : flash::kTools)
    for (const flash::Command& command : flash::commands(tool, board, 65536)) {
      const std::string typed = flash::as_typed(command);
      INFO(typed);
      CHECK(typed.find("mass") == std::string::npos);
      CHECK(typed.find(" erase_") == std::string::npos);
      // Of addresses only the image's own.
      for (std::size_t at = typed.find("0x"); at != std::string::npos; at = typed.find("0x", at + 1))
        CHECK(typed.substr(at, 10) == "0x08000000");
    }
}
