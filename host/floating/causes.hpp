// Which of a walking robot's numbers are not as its model has them: what all windows agree on (random_effect.hpp).
#pragma once

#include <vector>

#include "host/floating/likelihood.hpp"

namespace furcula::floating {

struct Cause {
  std::size_t unknown;
  double theta = 0.0, sd = 0.0;              ///< in prior standard deviations
  double spread = 0.0;                       ///< standard deviation of windows' own values about theta
  double confidence = 0.0;                   ///< that it is this one, and not another or none
  std::vector<std::size_t> correlated_with;  ///< what explains the windows as well, within odds of 20
};

struct Causes {
  std::vector<Cause>
      causes;  ///< in the order in which they were found; none where no number is likelier to differ than not
  /// All numbers of document 000, Tables I and II, deviate, none of which has a name: the causes are laws beyond them.
  bool all_numbers_deviate = false;
};

/// Of candidates with evidence the one comes first that leaves least of the others'; the leading ones are fitted, windows linearised about each,
/// and the likeliest is taken. The next ones are sought about it. Prior odds are one expected cause among all candidates. Where four are found, the numbers
/// of the tables may as well deviate all together, each with its prior: if that is likelier, causes are sought among the others alone, beside them. Stiffness,
/// damping and friction of the ground, the shape of the soles and the ramp of dry friction are not candidates: two simulators differ in these, each
/// window by its own amount.
/// @param linear about `model`, at `locals`
/// @param fitted a fit of all numbers, in prior standard deviations
Causes causes(const Machine& model, const std::vector<Unknown>& unknowns,
              const std::vector<Recording>& recordings, const std::vector<Window>& windows,
              std::vector<LinearWindow> linear, const std::vector<Local>& locals,
              const Eigen::VectorXd& fitted, const Settings& settings);

}  // namespace furcula::floating
