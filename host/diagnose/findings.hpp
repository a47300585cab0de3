// What is said of each chosen cause: its values, what it removes of the held-out errors, and which others compete with it.
#pragma once

#include <vector>

#include "host/diagnose/data_set.hpp"
#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/held_out.hpp"
#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

/// The causes of selection.chosen, without confidences; first the one without which the held-out position is predicted worst. `extended`:
/// the errors of the chosen set; `floor`: the NMSE at which there is nothing left to explain.
std::vector<Finding> findings_of(const model::Model& model, const DataSet& data, const Selection& selection,
                                 const HeldOut& held_out, const Errors& extended, double floor);

/// Whether no finding is judged on the motion (true of none).
bool other_channels_alone(const std::vector<Finding>& findings);

}  // namespace furcula::diagnose
