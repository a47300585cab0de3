#include "host/floating/causes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "host/core/parallel.hpp"

namespace furcula::floating {
namespace {

constexpr std::size_t kMostCauses = 6, kRivals = 24;
constexpr double kAsLikely = 3.0;  // odds of 20
constexpr double kTick_s =
    1e-3;  // of the board's loop and of a simulation: a command may act so much earlier or later

/// What two simulators have each of their own.
bool of_simulator(const Unknown& u) {
  return u.location == "simulator" || u.kind.starts_with("sole_") || u.kind.starts_with("contact_");
}

/// Whether the number is at its least in the model.
bool at_least(const Machine& model, const Unknown& u) {
  Machine m = model;
  u.add(m, -u.prior_sd);
  biped::make_possible(model, m);
  return u.value(m) >= u.value(model);
}

struct Candidate {
  std::size_t unknown;
  double tick = 0.0;
  bool positive = false;
};

std::vector<Candidate> candidates(const Machine& model, const std::vector<Unknown>& unknowns) {
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const Unknown& u = unknowns[i];
    if (of_simulator(u)) continue;
    all.push_back({i, u.kind == "command_delay" ? kTick_s / u.prior_sd : 0.0, at_least(model, u)});
  }
  return all;
}

/// A window's information and score of some columns, its own unknowns integrated out.
struct Reduced {
  Eigen::MatrixXd with_nuisance, nuisance;  ///< candidates by nuisance; nuisance by nuisance
  Eigen::VectorXd information, score, nuisance_score;
};

Reduced reduced(const LinearWindow& l, const Variances& v, const std::vector<std::size_t>& candidates,
                const std::vector<std::size_t>& nuisances, const std::vector<double>& spreads) {
  Eigen::VectorXd inverse_sd(l.y.size());
  for (Eigen::Index k = 0; k < l.y.size(); ++k)
    inverse_sd[k] = 1.0 / std::sqrt(v.noise[noise_of(static_cast<std::size_t>(k) % kRowSize)]);
  const Eigen::VectorXd y = inverse_sd.cwiseProduct(l.y);
  const Eigen::MatrixXd a = inverse_sd.asDiagonal() * l.a(Eigen::all, candidates),
                        n = inverse_sd.asDiagonal() * l.a(Eigen::all, nuisances);
  // Named causes are the last of the nuisances; their windows' own values are unknowns of the window.
  const auto own = l.c.cols(), named = static_cast<Eigen::Index>(spreads.size());
  Eigen::MatrixXd c(l.y.size(), own + named);
  c.leftCols(own) = inverse_sd.asDiagonal() * l.c;
  for (Eigen::Index k = 0; k < own; ++k)
    c.col(k) *= std::sqrt(v.local[group_of(l.locals[static_cast<std::size_t>(k)])]);
  for (Eigen::Index k = 0; k < named; ++k)
    c.col(own + k) = spreads[static_cast<std::size_t>(k)] * n.col(n.cols() - named + k);
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(c.cols(), c.cols());
  m.selfadjointView<Eigen::Lower>().rankUpdate(c.transpose());
  const Eigen::LLT<Eigen::MatrixXd> solver(m);
  const auto taken = [&](const auto& x) -> Eigen::MatrixXd {
    return solver.matrixL().solve(c.transpose() * x);
  };
  const Eigen::MatrixXd ca = taken(a), cn = taken(n);
  const Eigen::VectorXd cy = taken(y);
  Reduced r;
  r.information = (a.colwise().squaredNorm() - ca.colwise().squaredNorm()).transpose();
  r.with_nuisance = a.transpose() * n - ca.transpose() * cn;
  r.nuisance = n.transpose() * n - cn.transpose() * cn;
  r.score = a.transpose() * y - ca.transpose() * cy;
  r.nuisance_score = n.transpose() * y - cn.transpose() * cy;
  return r;
}

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

namespace {

/// Evidence of numbers in windows, given numbers that are known to differ.
class Evidences {
 public:
  Evidences(const std::vector<Window>& windows, const std::vector<LinearWindow>& linear,
            const std::vector<Variances>& variances, std::vector<std::size_t> simulator, unsigned threads)
      : linear_(linear), variances_(variances), simulator_(std::move(simulator)), threads_(threads) {
    constexpr std::size_t kPhases = 4;  // later ones are alike
    std::size_t further = 4 * kPhases;
    for (const Window& w : windows) {
      const std::size_t stance = (w.stance[0] ? 1 : 0) + (w.stance[1] ? 2 : 0);
      // On the stand no ground acts: each window is by itself.
      phase_.push_back(stance == 0 ? further++ : std::min(w.phase, kPhases - 1) * 4 + stance);
    }
  }

  /// Of `all`, where each of `named` differs by an amount that is sought, and from window to window by its spread.
  std::vector<RandomEffect> operator()(const std::vector<Candidate>& all,
                                       const std::vector<std::size_t>& named,
                                       const std::vector<double>& spreads) const {
    std::vector<std::size_t> columns, nuisances = simulator_;
    for (const Candidate& c : all) columns.push_back(c.unknown);
    nuisances.insert(nuisances.end(), named.begin(), named.end());
    std::vector<Reduced> parts(linear_.size());
    core::parallel_for(linear_.size(), threads_, [&](std::size_t w) {
      parts[w] = reduced(linear_[w], variances_[w], columns, nuisances, spreads);
    });
    // What is common to all windows of the nuisances, at its most likely, is taken off.
    const auto n = static_cast<Eigen::Index>(nuisances.size()), n_all = static_cast<Eigen::Index>(all.size()),
               windows = static_cast<Eigen::Index>(linear_.size());
    Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(n, n), with = Eigen::MatrixXd::Zero(n_all, n);
    for (const Reduced& r : parts) precision += r.nuisance, with += r.with_nuisance;
    const Eigen::MatrixXd share = precision.llt().solve(with.transpose()).transpose();
    Eigen::MatrixXd information(windows, n_all), score(windows, n_all);
    for (Eigen::Index w = 0; w < windows; ++w) {
      const Reduced& r = parts[static_cast<std::size_t>(w)];
      information.row(w) = (r.information - 2.0 * share.cwiseProduct(r.with_nuisance).rowwise().sum() +
                            (share * r.nuisance).cwiseProduct(share).rowwise().sum())
                               .transpose();
      score.row(w) = (r.score - share * r.nuisance_score).transpose();
    }
    std::vector<RandomEffect> out(all.size());
    core::parallel_for(all.size(), threads_, [&](std::size_t k) {
      const auto column = static_cast<Eigen::Index>(k);
      out[k] =
          random_effect(information.col(column), score.col(column), phase_, all[k].tick, all[k].positive);
    });
    return out;
  }

 private:
  const std::vector<LinearWindow>& linear_;
  const std::vector<Variances>& variances_;
  const std::vector<std::size_t> simulator_;
  const unsigned threads_;
  std::vector<std::size_t> phase_;
};

}  // namespace

std::vector<Cause> causes(const Machine& model, const std::vector<Unknown>& unknowns,
                          const std::vector<Window>& windows, const std::vector<LinearWindow>& linear,
                          const std::vector<Variances>& variances, unsigned threads) {
  std::vector<Candidate> all = candidates(model, unknowns);
  std::vector<std::size_t> simulator;
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (of_simulator(unknowns[i])) simulator.push_back(i);
  const double prior = std::log(static_cast<double>(all.size()));
  const Evidences evidences(windows, linear, variances, simulator, threads);

  std::vector<Cause> found;
  std::vector<std::size_t> named;
  std::vector<double> spreads;
  while (found.size() < kMostCauses) {
    const std::vector<RandomEffect> effects = evidences(all, named, spreads);
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return effects[a].log_bayes_factor > effects[b].log_bayes_factor;
    });
    std::vector<std::size_t> rivals;  // that can be named
    for (const std::size_t k : order)
      if (rivals.size() < kRivals && effects[k].log_bayes_factor > prior) rivals.push_back(k);
    if (rivals.empty()) break;
    // What is left of one where the other differs. A number that acts at one joint may have as much evidence by itself as one that acts at all of
    // them, but leaves the other's.
    const auto n = static_cast<Eigen::Index>(rivals.size());
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index other = 0; n > 1 && other < n; ++other) {
      const std::size_t k = rivals[static_cast<std::size_t>(other)];
      std::vector<std::size_t> and_it = named;
      std::vector<double> its_spread = spreads;
      and_it.push_back(all[k].unknown), its_spread.push_back(effects[k].spread);
      std::vector<Candidate> those;
      for (const std::size_t r : rivals) those.push_back(all[r]);
      const std::vector<RandomEffect> given = evidences(those, and_it, its_spread);
      for (Eigen::Index one = 0; one < n; ++one)
        left(one, other) = given[static_cast<std::size_t>(one)].log_bayes_factor;
    }
    // By how much each is likelier than the other: both differences are those of a model with both.
    const Eigen::MatrixXd ahead = left - left.transpose();
    Eigen::Index first = 0;
    for (Eigen::Index r = 1; r < n; ++r)
      if (ahead.row(r).minCoeff() > ahead.row(first).minCoeff()) first = r;
    const std::size_t best = rivals[static_cast<std::size_t>(first)];
    const RandomEffect& e = effects[best];
    const auto behind = [&](std::size_t k) {
      const auto at = std::find(rivals.begin(), rivals.end(), k);
      return at != rivals.end() ? ahead(first, at - rivals.begin())
                                : effects[rivals.front()].log_bayes_factor - effects[k].log_bayes_factor;
    };
    Cause cause{all[best].unknown, e.theta, e.sd, e.spread, 0.0, {}};
    double odds = std::exp(prior - e.log_bayes_factor);  // of none
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k == best) continue;
      odds += std::exp(-behind(k));
      if (behind(k) < kAsLikely) cause.correlated_with.push_back(all[k].unknown);
    }
    cause.confidence = 1.0 / (1.0 + odds);
    named.push_back(cause.unknown);
    spreads.push_back(cause.spread);
    found.push_back(std::move(cause));
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return found;
}

}  // namespace furcula::floating
