// The choice of causes by the training recordings: with inputs read in the way that is likelier, on a belt without falls that outweigh the
// others; and whether one of the recordings is of another machine.
#pragma once

#include <optional>

#include "host/diagnose/data_set.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/selection.hpp"
#include "host/identify/disagreement.hpp"

namespace furcula::diagnose {

/// The data set with inputs that act by the share of a row early that leaves least with the re-fitted model and dry friction, where the windows are sure of it.
DataSet with_likelier_inputs(const model::Model& model, DataSet data, unsigned threads);

/// What select() chooses. `data` becomes the one that it was chosen on: with inputs read the other way where causes were why one way seemed
/// better; on a belt with its squares bounded.
Selection choose_causes(const model::Model& model, DataSet& data, const Options& options);

/// The training recording that disagrees with the others, by what was chosen, first, and what else was tried on top of the re-fitted model
/// alone, and it. None where slips were chosen: those are each recording's own, and one that has a larger one is no other machine.
std::optional<identify::Disagreement> odd_recording(const model::Model& model, const DataSet& data,
                                                    const Selection& selection, unsigned threads);

}  // namespace furcula::diagnose
