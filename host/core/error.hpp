// Unusable data or model files: the message names file, line, column or key, value, and what was expected.
#pragma once

#include <stdexcept>

namespace furcula::core {

/// Ends a command with exit status 3.
struct DataError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace furcula::core
