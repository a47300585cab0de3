// The identification as JSON: `furcula-identification/2` (docs/contracts.md, section 4).
#pragma once

#include <string>

#include "host/identify/identification.hpp"

namespace furcula::report {

/// The first estimation in the contract's keys; a second one under "equation_error" with the same keys. Ends
/// with a newline; numbers that are not finite become null.
std::string to_json_text(const identify::Identification& identification);

}  // namespace furcula::report
