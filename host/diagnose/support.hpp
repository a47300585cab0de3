// Whether the chosen causes stand on training recordings that their fit has not seen.
#pragma once

#include <vector>

#include "host/diagnose/crossed.hpp"
#include "host/diagnose/data_set.hpp"
#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/rule.hpp"
#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

struct Support {
  bool withdrawn = false;  ///< the training recordings do not bear the chosen causes out: none is named
  bool by_rule = false;    ///< ... for which Rule::withdrawal is why
  bool undecided = false;  ///< another law does as well
  /// NMSE of training recordings by estimates that have not seen them: of the re-fitted model, with the chosen causes, and of noise alone.
  double before = 0.0, after = 0.0, floor = 0.0;
};

/// Nothing is named where the re-fitted model leaves noise alone, and the causes are undecided or of no sure help; where there is no more
/// to explain than numerics; or where bounds keep the model from the recordings. `crossed`: of the data set's training recordings.
Support support_of(const model::Model& model, const DataSet& data, const Crossed& crossed,
                   const Selection& selection, const WithoutRules& without, unsigned threads);

/// What the diagnosis ends with: the chosen set, unless it is withdrawn.
inline const Hypothesis& extension(const Selection& selection, const Support& support) {
  return support.withdrawn ? selection.refitted : selection.chosen;
}

/// The free parameters that selection.beyond_bounds has outside of their bounds.
std::vector<Diagnosis::BeyondBounds> beyond_bounds(const model::Model& model, const Selection& selection);

}  // namespace furcula::diagnose
