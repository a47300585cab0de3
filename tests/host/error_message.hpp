// The message of the DataError that a call ends with.
#pragma once

#include <string>

#include "host/core/error.hpp"

namespace furcula::test {

/// Empty if the call does not throw.
template <typename Call>
std::string error_message(Call&& call) {
  try {
    call();
  } catch (const core::DataError& e) {
    return e.what();
  }
  return {};
}

}  // namespace furcula::test
