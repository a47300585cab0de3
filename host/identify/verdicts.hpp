// What can be said of each fitted parameter: interval, and whether the data hold it at all.
#pragma once

#include <string>
#include <vector>

#include "host/identify/simulation_fit.hpp"

namespace furcula::identify {

struct ParameterVerdict {
  double value = 0.0;
  double lower = 0.0;  ///< 95 % interval
  double upper = 0.0;
  std::string verdict;  ///< "identified", "correlated", "at_bound", "not_excited"
  std::string with;     ///< correlated: the other parameter; at_bound: "lower" or "upper"
};

/// One a parameter of the fit. "correlated": an exchange against another parameter changes the fit so little
/// that the data tell a combination of the two, not each; "not_excited": the interval is as wide as the value
/// itself.
std::vector<ParameterVerdict> parameter_verdicts(const Fit& fit, const std::vector<Unknown>& unknowns);

}  // namespace furcula::identify
