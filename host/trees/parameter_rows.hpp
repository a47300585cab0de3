// What a diagnosis says of parameters: of the free ones, and of the bodies' combinations that the recordings show.
#pragma once

#include "host/trees/diagnosis_state.hpp"

namespace furcula::trees {

/// Sets d.parameters.
void set_parameters(DiagnosisState& s, const Problem& problem, const Found& found);

/// Sets d.base_parameters: what the recordings tell of masses and inertias.
void set_base_parameters(DiagnosisState& s, const Problem& problem);

}  // namespace furcula::trees
