// The two named pipes between the host and an emulated board, and the message that ends their talk.
#pragma once

#include <cstdint>

namespace furcula::pil {

/// Names of the pipes, in the directory that QEMU runs in.
inline constexpr char kToBoard[] = "to_board";
inline constexpr char kFromBoard[] = "from_board";

/// Board to host, last.
struct Measured {
  std::uint32_t deepest_stack_bytes = 0;
  std::uint32_t hundred_nops =
      0;  ///< what 100 instructions measure: 100, if the emulator counts as it should
};

}  // namespace furcula::pil
