// How a command ends otherwise than well. main.cpp turns each into its exit status
// (docs/contracts.md, section 4).
#pragma once

#include <stdexcept>

namespace furcula::cli {

/// Unusable arguments: exit status 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The command ran, and its result is a refusal or a failed check: exit status 4.
struct Refusal : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace furcula::cli
