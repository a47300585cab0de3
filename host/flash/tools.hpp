// The programs that flash a board, and the commands that they are run with.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/boards.hpp"

namespace furcula::flash {

/// Names of the programs, the preferred first.
inline constexpr std::string_view kTools[] = {"openocd", "st-flash", "dfu-util"};

/// Files in the folder that the commands run in: what is written, and what was read back.
inline constexpr std::string_view kImageFile = "image.bin", kReadBackFile = "read_back.bin";

/// Whether a tool can flash a board.
bool suits(std::string_view tool, const FlashBoard& board);

using Command = std::vector<std::string>;

/// Writes `length` bytes of kImageFile, reads them back into kReadBackFile, and starts the board. The
/// parameters' slots are not touched.
std::vector<Command> commands(std::string_view tool, const FlashBoard& board, std::size_t length);

/// As a person would type it.
std::string as_typed(const Command& command);

/// The program of this name in PATH, or an empty string.
std::string find_in_path(std::string_view program);

struct Ran {
  int status = 0;    ///< exit status; 128 + signal; 127: it could not be started
  std::string said;  ///< on stdout and stderr together
};

/// Runs a command in a folder and waits for its end. `program` is the path of its first word.
Ran run(const std::string& program, const Command& command, const std::string& folder);

}  // namespace furcula::flash
