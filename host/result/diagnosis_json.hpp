// The diagnosis as other programs read it: `furcula-diagnosis/2` (docs/contracts.md, section 4; diagnosis.schema.json).
#pragma once

#include <string>

#include "host/result/diagnosis.hpp"
#include "host/result/json.hpp"

namespace furcula::result {

/// Keys stand in the contract's order, the same for every family of machines. What a family does not compute is null or empty, and
/// a figure that is not finite is null.
Json to_json(const Diagnosis& diagnosis);

/// The text of diagnosis.json: indented, UTF-8 (bytes of file names that are not become U+FFFD), numbers
/// written such that reading them gives the same double.
std::string to_json_text(const Diagnosis& diagnosis);

}  // namespace furcula::result
