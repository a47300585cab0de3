// A firmware image as the linker left it: its bytes in the chip's flash memory, and what it says of itself.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/startup/image_header.hpp"

namespace furcula::flash {

struct Image {
  std::vector<std::uint8_t> bytes;  ///< from firmware::kFlashBase on
  firmware::ImageHeader header;

  std::string board() const;
  /// "0.1.0, build 1a2b3c4d"
  std::string version() const;
};

/// The segments of an ELF file (32 bits, little-endian, ARM) that lie in flash memory, and their header.
/// @throws core::DataError, which names the file: no such ELF file, segments elsewhere, no header, a length or
/// a CRC that is not the image's.
Image read_elf(std::string_view file, const std::string& name);

/// The image in bytes that were read back from a chip. @throws core::DataError as above.
Image image_of(std::vector<std::uint8_t> bytes, const std::string& name);

}  // namespace furcula::flash
