// Which build this program is.
#pragma once

#include <cstdint>
#include <string>

namespace furcula::core {

/// The first eight digits of the hash that the linker put into this program (an ELF note, --build-id), as an
/// image's build id (firmware/startup/image_header.hpp); 0: it put none there.
std::uint32_t own_build_id();

/// Eight digits.
std::string hexadecimal(std::uint32_t number);

}  // namespace furcula::core
