// The force that a model lacks, sample by sample: measured acceleration times mass, less the model's force.
#pragma once

#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/identify/recording.hpp"

namespace furcula::diagnose {

/// Against `model` with the effects `named` taken out; `law` is what those effects add at the same states.
/// Samples near touch-down and lift-off, where the acceleration jumps, and those of a rail carriage's contact
/// with its stop are left out. At most about `most` samples.
ResidualForce residual_force(const model::Model& model, const std::vector<dynamics::Effect>& named,
                             const std::vector<identify::Recording>& recordings, std::size_t most = 6000);

}  // namespace furcula::diagnose
