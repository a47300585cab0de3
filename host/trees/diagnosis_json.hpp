// A tree's diagnosis as `furcula-diagnosis/1` (docs/contracts.md).
#pragma once

#include <string>

#include "host/trees/diagnosis.hpp"

namespace furcula::trees {

std::string to_json_text(const Diagnosis& diagnosis);

}  // namespace furcula::trees
