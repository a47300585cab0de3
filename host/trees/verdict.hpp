// The verdict of a diagnosis, in words too, and the experiment to do next.
#pragma once

#include "host/trees/diagnosis_state.hpp"

namespace furcula::trees {

/// From what is named and what is left: sets d.unexplained_share, the confidences, d.verdict, d.summary and the experiments.
void set_verdict(DiagnosisState& s, const Problem& problem);

}  // namespace furcula::trees
