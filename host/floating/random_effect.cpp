#include "host/floating/random_effect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/floating/likelihood.hpp"

namespace furcula::floating {
namespace {

/// Of the standard normal distribution below `z`; far below, by the first term of its asymptotic series.
double log_normal_tail(double z) {
  return z > -30.0 ? std::log(0.5 * std::erfc(-z / std::sqrt(2.0)))
                   : -0.5 * z * z - std::log(-z * std::sqrt(2.0 * M_PI));
}

/// A number in windows' estimates, given the spread of the windows' own values.
class Spread {
 public:
  Spread(const Eigen::VectorXd& information, const Eigen::VectorXd& score,
         const std::vector<std::size_t>& phase) {
    for (Eigen::Index w = 0; w < information.size(); ++w)
      if (information[w] > 1e-12)
        seen_.push_back(
            {score[w] / information[w], 1.0 / information[w], phase[static_cast<std::size_t>(w)]});
    phases_.resize(phase.empty() ? 0 : 1 + *std::max_element(phase.begin(), phase.end()));
  }

  /// How likely the windows are if theta is normal with that variance, by Laplace's approximation about the likeliest theta that iterations from
  /// `from` on end at, with the weights of the last one in place of Student's curvature.
  double log_evidence(double spread, double prior_variance, double from, RandomEffect& out) {
    constexpr int kSweeps = 20;
    const double between = spread * spread;
    double posterior = 0.0;
    out = {0.0, from, 0.0, spread};
    for (Phase& p : phases_) p.at = from;
    for (int k = 0; k < kSweeps; ++k) {
      for (Phase& p : phases_) p.mean = p.precision = 0.0;
      for (const Seen& s : seen_) {
        Phase& p = phases_[s.phase];
        const double variance = s.variance + between, off = s.x - p.at;
        const double weight = (kFreedom + 1.0) / (kFreedom + off * off / variance) / variance;
        p.mean += weight * s.x, p.precision += weight;
      }
      posterior = prior_variance > 0.0 ? 1.0 / prior_variance : 0.0;
      double weighted = 0.0;
      for (Phase& p : phases_) {
        if (!(p.precision > 0.0)) continue;
        p.mean /= p.precision;
        const double of_phase = p.precision / (1.0 + between * p.precision);
        posterior += of_phase, weighted += of_phase * p.mean;
      }
      out.theta = prior_variance > 0.0 ? weighted / posterior : 0.0;
      for (Phase& p : phases_)
        p.at = out.theta + (p.mean - out.theta) * between * p.precision / (1.0 + between * p.precision);
    }
    double sum = 0.0;
    for (const Seen& s : seen_) {
      const double variance = s.variance + between, off = s.x - phases_[s.phase].at;
      sum -= 0.5 * (std::log(variance) + (kFreedom + 1.0) * std::log1p(off * off / (kFreedom * variance)));
    }
    for (const Phase& p : phases_) {
      if (!(p.precision > 0.0)) continue;
      sum -= 0.5 * std::log1p(between * p.precision);
      if (between > 0.0) sum -= 0.5 * (p.at - out.theta) * (p.at - out.theta) / between;
    }
    if (prior_variance > 0.0)
      sum -= 0.5 * (out.theta * out.theta / prior_variance + std::log(prior_variance * posterior));
    out.sd = posterior > 0.0 ? 1.0 / std::sqrt(posterior) : 0.0;
    return sum;
  }

 private:
  struct Seen {
    double x, variance;
    std::size_t phase;
  };
  struct Phase {
    double at = 0.0, mean = 0.0, precision = 0.0;
  };
  std::vector<Seen> seen_;
  std::vector<Phase> phases_;
};

}  // namespace

RandomEffect random_effect(const Eigen::VectorXd& information, const Eigen::VectorXd& score,
                           const std::vector<std::size_t>& phase, double tick, bool positive) {
  constexpr int kSpreads = 40;
  Spread windows(information, score, phase);
  RandomEffect best, here;
  double with = -std::numeric_limits<double>::infinity(), without = with, last = 0.0;
  // From the widest spread on, at which windows' values hardly pull: the mode of one is near that of the next.
  for (int k = 0; k <= kSpreads; ++k) {
    const double spread = k == kSpreads ? 0.0 : std::pow(10.0, 1.5 - 3.5 * k / (kSpreads - 1));
    without = std::max(without, windows.log_evidence(spread, tick * tick, 0.0, here));
    for (const double from : {0.0, last}) {
      double l = windows.log_evidence(spread, 1.0 + tick * tick, from, here);
      if (positive) l += std::log(2.0) + log_normal_tail(here.theta / here.sd);
      if (l > with) with = l, best = here;
    }
    last = here.theta;
  }
  best.log_bayes_factor = with - without;
  return best;
}

}  // namespace furcula::floating
