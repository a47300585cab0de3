// The boards that can be flashed, each as its folder's flash.toml has it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace furcula::flash {

struct FlashBoard {
  std::string name;                  ///< of its folder
  std::vector<std::string> openocd;  ///< configuration files in their order; empty: not by OpenOCD
  bool st_flash = false;             ///< it has, or takes, an ST-LINK
  std::string dfu;                   ///< USB id of its boot loader; empty: it has none
  std::string hint;                  ///< for a person whose board is not found
};

/// @throws core::DataError where it is no such file.
FlashBoard parse_board(std::string_view text, const std::string& board, const std::string& name);

/// All that were there when the program was built, by name.
const std::vector<FlashBoard>& boards();

}  // namespace furcula::flash
