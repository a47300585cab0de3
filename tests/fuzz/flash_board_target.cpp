// The reader of a board's flash.toml.
#include "host/core/error.hpp"
#include "host/flash/boards.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  try {
    require(flash::parse_board(input, "board", "input").name == "board", "the board's name");
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
