// Values of a fitted set of causes as a diagnosis tells them: with names, units and intervals.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/hypothesis.hpp"

namespace furcula::diagnose {

/// Parameters of the effect by their names on this kind of machine.
std::map<std::string, Estimate> parameters_of_effect(const Hypothesis& h, dynamics::Kind kind,
                                                     dynamics::Effect effect);
/// Of all effects: "effect.parameter".
std::map<std::string, Estimate> parameters_of_effects(const Hypothesis& h);

/// Whether one of the effect's values lies on a bound, or may be anything.
bool not_held(const Hypothesis& h, dynamics::Kind kind, dynamics::Effect e);

/// Of all parameters of the model: as given, re-fitted, and with the causes of `extended`.
std::vector<result::Parameter> parameter_rows(const model::Model& model, const Hypothesis& refitted,
                                              const Hypothesis& extended);

/// Names of the catalogue.
std::vector<std::string> names_of(const std::vector<dynamics::Effect>& effects);

}  // namespace furcula::diagnose
