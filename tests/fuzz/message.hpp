// What every refusal keeps to.
#pragma once

#include <string_view>

#include "host/core/error.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

inline void require_printable(const core::DataError& e) {
  require(std::string_view(e.what()).find_first_of("\n\x1b") == std::string_view::npos,
          "a message is one printable line");
}

}  // namespace furcula::fuzz
