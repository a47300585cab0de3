// The sentences of a diagnosis, in plain words.
#pragma once

#include <string>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "host/diagnose/diagnosis.hpp"

namespace furcula::diagnose {

/// "1.61 N (1.52 to 1.70)": three significant digits.
std::string with_interval(const Estimate& e, const std::string& unit);
std::string number(double value, int digits = 3);
std::string names(const std::vector<dynamics::Effect>& effects);
std::string names(const std::vector<std::string>& effects);

/// A length or angle in the unit that a reader likes: mm for m, degrees stay rad.
std::string readable(double value, const std::string& unit);

/// Whether a finding is more likely than not.
bool any_believed(const Diagnosis& d);

/// Whether the effect is the true value of one of the model's own parameters: its title is then "the model's ...".
bool is_wrong_parameter(dynamics::Effect effect);

/// The verdict in one sentence, from everything else in the diagnosis.
std::string summary(const Diagnosis& d);

/// What to do next, from the verdict and the findings.
std::string next_experiment(const Diagnosis& d);

/// What to record so that these sets of effects can be told apart, by d.experiments.
std::string experiment_that_tells(const Diagnosis& d, const std::vector<std::string>& sets);

}  // namespace furcula::diagnose
