// What a diagnosis leaves lowers the confidence of what it names.
#pragma once

#include "host/trees/diagnosis_state.hpp"

namespace furcula::trees {

/// `any_lost`: runs are further off than a joint moves.
void lower_confidences(DiagnosisState& s, bool any_lost);

}  // namespace furcula::trees
