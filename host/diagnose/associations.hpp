// What the error that no effect removes goes along with: signals, events, elapsed time, a frequency.
#pragma once

#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

/// What the remaining force (force less law) goes along with, strongest first: for each signal the share of
/// the force's variance that its means over twelve bins of equal count explain, beyond what chance would; for
/// a frequency the share of the best sinusoid, with a phase of its own in each recording. Shares below a
/// tenth are left out, and frequencies of the motion itself.
std::vector<Association> associations(const ResidualForce& r, const model::Model& model);

}  // namespace furcula::diagnose
