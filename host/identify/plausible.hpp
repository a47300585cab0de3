// Recordings that cannot be what they say: nothing can be learnt from them, and a wrong cause would be.
#pragma once

#include <vector>

#include "host/identify/recording.hpp"

namespace furcula::identify {

/// @throws core::DataError naming the recording and what was expected
/// - where the position stands at its largest (smallest) value while the body passes: a saturated encoder;
/// - where one recording moves 30 times as much as another of the same kind under the same input: its unit is
///   another.
void require_plausible(const std::vector<Recording>& training, const std::vector<Recording>& held_out);

}  // namespace furcula::identify
