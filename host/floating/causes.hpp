// Which of a walking robot's numbers are not as its model has them: what all windows agree on.
//
// Each window has an estimate of a number. What a model lacks besides, the real ground above all, moves these estimates too: differently in
// different phases of a step, and there by another amount each time. What the robot differs in moves all by the same. So a number's deviation in
// window w of phase p is theta + f_p + e_w, where f is normal, e of Student's t, with one scale, which is sought (random effects, as in
// meta-analysis): a window in which a joint sticks or a foot slips says something else of a number, and is not to outweigh all others.
// With two variances that of the phases, of which a walk has about seven, explains any theta. A cause is a number whose theta is likelier
// to be normal with the prior's variance than to be 0.
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

/// Evidence of theta in windows' estimates: the logarithm of how much likelier they are with theta of variance 1 than with theta 0, the
/// scale of f and e being the likeliest in either case.
struct RandomEffect {
  double log_bayes_factor = 0.0, theta = 0.0, sd = 0.0, spread = 0.0;
};
/// `information`, `score` and `phase` of each window; `tick`: standard deviation of what theta may be without being a cause; `positive`: it
/// cannot be below 0.
RandomEffect random_effect(const Eigen::VectorXd& information, const Eigen::VectorXd& score,
                           const std::vector<std::size_t>& phase, double tick, bool positive);

/// The causes in the order in which they were found, none where no number is likelier to differ than not. Of those with evidence the one comes first
/// that leaves least of the others'. Prior odds are one expected cause among all candidates. Sizes are those of one linear step from the model: too
/// small where the deviation is large. Stiffness, damping and friction of the ground, the shape of the soles and the ramp of dry friction are not
/// among them: two simulators differ in these. `linear`: about `model`.
std::vector<Cause> causes(const Machine& model, const std::vector<Unknown>& unknowns,
                          const std::vector<Window>& windows, const std::vector<LinearWindow>& linear,
                          const std::vector<Variances>& variances, unsigned threads);

}  // namespace furcula::floating
