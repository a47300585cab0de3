// The columns of a machine of one joint for the trial of conventions (host/conventions/trial.hpp).
#pragma once

#include <optional>
#include <vector>

#include "host/conventions/trial.hpp"
#include "host/identify/recording.hpp"
#include "host/model/model.hpp"

namespace furcula::identify {

/// @throws core::DataError that says what the columns of these recordings seem to be, where that is not what their names say: another
/// unit, sign or zero, columns that are exchanged, gravity that acts otherwise.
void require_conventions(const model::Model& model, const std::vector<Recording>& recordings);

/// What require_conventions() would say, as a finding; and how well the columns fit as they are named.
std::optional<conventions::Finding> find_convention(const model::Model& model,
                                                    const std::vector<Recording>& recordings);
conventions::AsNamed as_named(const model::Model& model, const std::vector<Recording>& recordings);

}  // namespace furcula::identify
