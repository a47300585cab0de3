#include "host/flash/boards.hpp"

#include <array>

#include "host/core/error.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::flash {
namespace {

struct BoardText {
  const char* name;
  const char* text;
};

/// Made by CMakeLists.txt of boards/*/flash.toml.
constexpr BoardText kTexts[] = {
#include <flash_boards.inc>
};

}  // namespace

FlashBoard parse_board(std::string_view text, const std::string& board, const std::string& name) {
  const toml::table file = core::parse_toml(text, name);
  constexpr std::array<std::string_view, 4> kKeys{"openocd", "st_flash", "dfu", "hint"};
  core::refuse_unknown_keys(file, name, "", kKeys);
  FlashBoard result;
  result.name = board;
  if (const toml::node* node = file.get("openocd")) {
    const toml::array* files = node->as_array();
    if (files == nullptr) core::fail(name, node->source(), "openocd: expected an array of file names");
    for (const toml::node& f : *files) result.openocd.push_back(core::text(f, name, "openocd"));
  }
  if (const toml::node* node = file.get("st_flash")) {
    const auto* value = node->as_boolean();
    if (value == nullptr) core::fail(name, node->source(), "st_flash: expected true or false");
    result.st_flash = value->get();
  }
  if (const toml::node* node = file.get("dfu")) result.dfu = core::text(*node, name, "dfu");
  if (const toml::node* node = file.get("hint")) result.hint = core::text(*node, name, "hint");
  if (result.openocd.empty() && !result.st_flash && result.dfu.empty())
    throw core::DataError(name + ": no way to flash the board; expected openocd, st_flash or dfu");
  return result;
}

const std::vector<FlashBoard>& boards() {
  static const std::vector<FlashBoard> all = [] {
    std::vector<FlashBoard> parsed;
    for (const BoardText& b : kTexts)
      parsed.push_back(parse_board(b.text, b.name, "boards/" + std::string(b.name) + "/flash.toml"));
    return parsed;
  }();
  return all;
}

}  // namespace furcula::flash
