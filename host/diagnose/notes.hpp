// Sentences that a diagnosis adds to its figures: what to check beside the causes that it names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/held_out.hpp"
#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

/// Mass and damping of an axis that are wrong by one factor are a wrong scale of its force, or of its position. Nothing where they are not.
std::optional<std::string> note_one_scale(const model::Model& model, const std::vector<Finding>& findings);

/// Of causes that the training recordings cannot tell apart: a held-out recording that does, if there is one. `unit`: of the position.
std::optional<std::string> note_held_out_that_tells(const model::Model& model, const Selection& selection,
                                                    const HeldOut& held_out, const std::string& unit);

}  // namespace furcula::diagnose
