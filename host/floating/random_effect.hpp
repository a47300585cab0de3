// A number in windows' estimates of it: what all windows agree on, beside what each has of its own.
//
// What a model lacks besides, the real ground above all, moves windows' estimates too: differently in different phases of a step, and there by
// another amount each time. What the robot differs in moves all by the same. So a number's deviation in window w of phase p is theta + f_p + e_w, where
// f is normal, e of Student's t, with one scale, which is sought (random effects, as in meta-analysis): a window in which a joint sticks or a foot slips
// says something else of a number, and is not to outweigh all others. With two variances that of the phases, of which a walk has about seven, explains
// any theta.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

namespace furcula::floating {

/// Evidence of theta in windows' estimates: the logarithm of how much likelier they are with theta of variance 1 than with theta 0, the
/// scale of f and e being the likeliest in either case.
struct RandomEffect {
  double log_bayes_factor = 0.0, theta = 0.0, sd = 0.0, spread = 0.0;
};
/// `information`, `score` and `phase` of each window; `tick`: standard deviation of what theta may be without being a cause; `positive`: it
/// cannot be below 0.
RandomEffect random_effect(const Eigen::VectorXd& information, const Eigen::VectorXd& score,
                           const std::vector<std::size_t>& phase, double tick, bool positive);

}  // namespace furcula::floating
