// How sure each name of a diagnosis is, and why not more.
#pragma once

#include "host/diagnose/crossed.hpp"
#include "host/diagnose/data_set.hpp"
#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/held_out.hpp"
#include "host/diagnose/selection.hpp"
#include "host/diagnose/support.hpp"

namespace furcula::diagnose {

/// What the training recordings say, lowered by what the held-out ones do: confidence and lowered_by of each finding, the share of none of the
/// catalogue, and the weights of d.candidates. By all figures of `d`, and its findings; nothing without one. `slip_alone`: see VerdictInputs.
void fill_confidences(Diagnosis& d, const model::Model& model, const DataSet& data, const Crossed& crossed,
                      const Selection& selection, const Support& support, const HeldOut& held_out,
                      bool slips_predictable, bool slip_alone);

}  // namespace furcula::diagnose
