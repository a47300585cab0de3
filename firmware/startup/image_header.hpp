// What an image says of itself, at a fixed place: read by `furcula flash` from the file, and back from the
// chip.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace furcula::firmware {

inline constexpr std::uint32_t kFlashBase = 0x08000000;     ///< where an image begins
inline constexpr std::uint32_t kImageHeaderOffset = 0x200;  ///< of the header from there
inline constexpr std::uint32_t kImageMagic = 0x43525546;    ///< "FURC"
inline constexpr std::uint32_t kImageHeaderVersion = 1;

/// The part that the source gives. Little-endian words.
struct ImageNames {
  std::uint32_t magic = kImageMagic;
  std::uint32_t header_version = kImageHeaderVersion;
  std::array<char, 24> board{};        ///< name of the board's folder, the rest zeros
  std::uint32_t firmware_version = 0;  ///< major << 16 | minor << 8 | patch
};

/// All of it: what the linker and scripts/finish-image add.
struct ImageHeader {
  ImageNames names;
  std::uint32_t length = 0;              ///< bytes of the image, from kFlashBase
  std::array<std::uint32_t, 4> note{};   ///< 4, 20, 3, "GNU": an ELF note with the build's SHA-1
  std::array<std::uint8_t, 20> build{};  ///< the hash; its first four bytes are the build id
  std::uint32_t crc = 0;                 ///< CRC-32 of the image's `length` bytes with this word taken as 0
};
static_assert(std::is_trivially_copyable_v<ImageHeader> && sizeof(ImageNames) == 36 &&
                  sizeof(ImageHeader) == 80 && offsetof(ImageHeader, crc) == 76,
              "the linker script lays it out");

/// The build id as a number: the first eight digits of the hash.
constexpr std::uint32_t build_id(const ImageHeader& header) {
  const auto& b = header.build;
  return static_cast<std::uint32_t>(b[0]) << 24 | static_cast<std::uint32_t>(b[1]) << 16 |
         static_cast<std::uint32_t>(b[2]) << 8 | b[3];
}

/// `name` of at most 23 characters.
constexpr ImageNames image_names(const char* name, std::uint32_t firmware_version) {
  ImageNames names;
  for (std::size_t i = 0; i + 1 < names.board.size() && name[i] != '\0'; ++i) names.board[i] = name[i];
  names.firmware_version = firmware_version;
  return names;
}

}  // namespace furcula::firmware
