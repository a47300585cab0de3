#include "host/floating/causes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "host/core/parallel.hpp"
#include "host/floating/random_effect.hpp"

namespace furcula::floating {
namespace {

constexpr std::size_t kMostCauses = 6, kRivals = 24, kFitted = 4;
constexpr double kAsLikely = 3.0;  // odds of 20
constexpr double kLittle = 0.05;   // of a prior's deviation: two simulators of one robot differ by as much
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
  double tick = 0.0;  ///< as of random_effect
  bool positive = false;
};

std::vector<Candidate> candidates(const Machine& model, const std::vector<Unknown>& unknowns) {
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const Unknown& u = unknowns[i];
    if (of_simulator(u)) continue;
    all.push_back({i, u.kind == "command_delay" ? std::max(kLittle, kTick_s / u.prior_sd) : kLittle,
                   at_least(model, u)});
  }
  return all;
}

/// A window's squares of some columns of theta, its own unknowns integrated out: those of the window, and numbers of which each window has its own value.
struct Squares {
  Eigen::VectorXd information, score;                 ///< of the columns, each by itself
  Eigen::MatrixXd with_last;                          ///< information of the last columns and each
  double y = 0.0, log_determinant = 0.0, rows = 0.0;  ///< of y; of its covariance; how many numbers

  /// Where all columns are among the last.
  double at(const Eigen::VectorXd& theta) const {
    return y - 2.0 * score.dot(theta) + theta.dot(with_last * theta);
  }
};

/// Numbers whose values differ from window to window with a spread.
struct Own {
  std::vector<std::size_t> unknowns;
  std::vector<double> spreads;
};

/// @param last how many columns are the last
Squares squares(const LinearWindow& l, const Variances& v, const std::vector<std::size_t>& columns,
                std::size_t last, const Own& own) {
  Squares s;
  Eigen::VectorXd inverse_sd(l.y.size());
  for (Eigen::Index k = 0; k < l.y.size(); ++k) {
    const double variance = v.noise[noise_of(static_cast<std::size_t>(k) % kRowSize)];
    inverse_sd[k] = 1.0 / std::sqrt(variance);
    s.log_determinant += std::log(variance);
  }
  const auto of_window = l.c.cols(), further = static_cast<Eigen::Index>(own.unknowns.size());
  Eigen::MatrixXd c(l.y.size(), of_window + further);
  c.leftCols(of_window) = inverse_sd.asDiagonal() * l.c;
  for (Eigen::Index k = 0; k < of_window; ++k)
    c.col(k) *= std::sqrt(v.local[group_of(l.locals[static_cast<std::size_t>(k)])]);
  c.rightCols(further) = inverse_sd.asDiagonal() * l.a(Eigen::all, own.unknowns);
  for (Eigen::Index k = 0; k < further; ++k) c.col(of_window + k) *= own.spreads[static_cast<std::size_t>(k)];
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(c.cols(), c.cols());
  m.selfadjointView<Eigen::Lower>().rankUpdate(c.transpose());
  const Eigen::LLT<Eigen::MatrixXd> solver(m);
  const Eigen::VectorXd y = inverse_sd.cwiseProduct(l.y), cy = solver.matrixL().solve(c.transpose() * y);
  const Eigen::MatrixXd a = inverse_sd.asDiagonal() * l.a(Eigen::all, columns),
                        ca = solver.matrixL().solve(c.transpose() * a);
  s.information = (a.colwise().squaredNorm() - ca.colwise().squaredNorm()).transpose();
  const auto n = static_cast<Eigen::Index>(last);
  s.with_last = a.rightCols(n).transpose() * a - ca.rightCols(n).transpose() * ca;
  s.score = a.transpose() * y - ca.transpose() * cy;
  s.y = y.squaredNorm() - cy.squaredNorm();
  s.rows = static_cast<double>(y.size());
  s.log_determinant += 2.0 * Eigen::MatrixXd(solver.matrixL()).diagonal().array().log().sum();
  return s;
}

/// Numbers that were named: where they are, and how far windows' own values scatter about it. Prior standard deviations.
struct Named {
  std::vector<std::size_t> unknowns;
  Eigen::VectorXd theta;
  std::vector<double> spreads;

  Named with(std::size_t unknown, double at, double spread) const {
    Named n = *this;
    n.unknowns.push_back(unknown), n.spreads.push_back(spread);
    n.theta.conservativeResize(theta.size() + 1);
    n.theta[theta.size()] = at;
    return n;
  }

  Named without(std::size_t k) const {
    Named n;
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      if (i != k) n = n.with(unknowns[i], theta[static_cast<Eigen::Index>(i)], spreads[i]);
    return n;
  }
};

/// Windows about a machine, and what they say of numbers.
class Evidences {
 public:
  Evidences(const Machine& model, const std::vector<Unknown>& unknowns,
            const std::vector<Recording>& recordings, const std::vector<Window>& windows,
            std::vector<LinearWindow> linear, std::vector<Local> locals, const Settings& settings)
      : model_(model),
        unknowns_(unknowns),
        recordings_(recordings),
        windows_(windows),
        settings_(settings),
        linear_(std::move(linear)),
        locals_(std::move(locals)) {
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      if (of_simulator(unknowns[i])) simulator_.unknowns.push_back(i), simulator_.spreads.push_back(1.0);
    constexpr std::size_t kPhases = 4;  // later ones are alike
    std::size_t further = 4 * kPhases;
    for (const Window& w : windows) {
      const std::size_t stance = (w.stance[0] ? 1 : 0) + (w.stance[1] ? 2 : 0);
      // On the stand no ground acts: each window is by itself.
      phase_.push_back(stance == 0 ? further++ : std::min(w.phase, kPhases - 1) * 4 + stance);
    }
    estimate_variances();
  }

  /// Of `all`, where each of `named` differs by an amount that is sought, and from window to window by its spread.
  std::vector<RandomEffect> operator()(const std::vector<Candidate>& all, const Named& named) const {
    std::vector<std::size_t> columns;
    for (const Candidate& c : all) columns.push_back(c.unknown);
    columns.insert(columns.end(), named.unknowns.begin(), named.unknowns.end());
    Own own = simulator_;
    own.unknowns.insert(own.unknowns.end(), named.unknowns.begin(), named.unknowns.end());
    own.spreads.insert(own.spreads.end(), named.spreads.begin(), named.spreads.end());
    const std::vector<Squares> parts = squares_of(linear_, columns, named.unknowns.size(), own);
    // What is common to all windows of the named ones, at its most likely, is taken off.
    const auto n_all = static_cast<Eigen::Index>(all.size()),
               n = static_cast<Eigen::Index>(named.unknowns.size()),
               count = static_cast<Eigen::Index>(parts.size());
    Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(n, n), with = Eigen::MatrixXd::Zero(n, n_all);
    Eigen::VectorXd score_of_named = Eigen::VectorXd::Zero(n);
    for (const Squares& s : parts) {
      precision += s.with_last.rightCols(n);
      with += s.with_last.leftCols(n_all);
      score_of_named += s.score.tail(n);
    }
    const Eigen::LLT<Eigen::MatrixXd> solver(precision);
    const Eigen::MatrixXd share = solver.solve(with);  // of a named one in each candidate
    const Eigen::VectorXd common = solver.solve(score_of_named);
    Eigen::MatrixXd information(count, n_all), score(count, n_all);
    for (Eigen::Index w = 0; w < count; ++w) {
      const Squares& s = parts[static_cast<std::size_t>(w)];
      const auto both = s.with_last.leftCols(n_all);
      const auto of_named = s.with_last.rightCols(n);
      information.row(w) = s.information.head(n_all).transpose() -
                           2.0 * share.cwiseProduct(both).colwise().sum() +
                           share.cwiseProduct(of_named * share).colwise().sum();
      score.row(w) = (s.score.head(n_all) - both.transpose() * common).transpose() -
                     (s.score.tail(n) - of_named * common).transpose() * share;
    }
    std::vector<RandomEffect> out(all.size());
    core::parallel_for(all.size(), settings_.threads, [&](std::size_t k) {
      const auto column = static_cast<Eigen::Index>(k);
      out[k] =
          random_effect(information.col(column), score.col(column), phase_, all[k].tick, all[k].positive);
    });
    return out;
  }

  /// Moves the named numbers to where they are likeliest, the same in all windows, which are linearised about them. @returns the logarithm of the
  /// posterior there, by Laplace's approximation and with the present variances: by its difference one set of numbers is likelier than another.
  double fit(Named& named) const {
    constexpr int kSteps = 3;
    std::vector<Unknown> those;
    for (const std::size_t i : named.unknowns) those.push_back(unknowns_[i]);
    std::vector<std::size_t> columns(those.size());
    std::iota(columns.begin(), columns.end(), std::size_t{0});
    Point point = at(model_, those, named.theta, locals_);
    double best = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < kSteps; ++k) {
      refit_locals(recordings_, windows_, first_variances(), point, settings_);
      const std::vector<Squares> parts =
          squares_of(linearised(recordings_, windows_, first_variances(), those, point, settings_), columns,
                     columns.size(), {});
      const auto n = point.theta.size();
      Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(n, n);
      Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
      double here = -0.5 * point.theta.squaredNorm();
      for (const Squares& s : parts) {
        // Student's t over windows, as in a fit of all numbers.
        const double left = s.at(point.theta), weight = (kFreedom + s.rows) / (kFreedom + left);
        precision += weight * s.with_last, score += weight * s.score;
        here -= 0.5 * (s.log_determinant + (kFreedom + s.rows) * std::log1p(left / kFreedom));
      }
      const Eigen::LLT<Eigen::MatrixXd> solver(precision);
      here -= Eigen::MatrixXd(solver.matrixL()).diagonal().array().log().sum();
      if (!(here > best)) break;
      best = here, named.theta = point.theta;
      point = at(model_, those, solver.solve(score), point.locals);
    }
    return best;
  }

  /// Goes to these numbers: windows are linearised about them from here on.
  void go_to(const Named& named) {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns_.size()));
    for (std::size_t k = 0; k < named.unknowns.size(); ++k)
      theta[static_cast<Eigen::Index>(named.unknowns[k])] = named.theta[static_cast<Eigen::Index>(k)];
    Point point = at(model_, unknowns_, theta, locals_);
    refit_locals(recordings_, windows_, first_variances(), point, settings_);
    linear_ = linearised(recordings_, windows_, first_variances(), unknowns_, point, settings_);
    locals_ = point.locals;
    estimate_variances();
  }

 private:
  void estimate_variances() { variances_ = estimated(linear_, first_variances(), settings_.threads); }

  std::vector<Squares> squares_of(const std::vector<LinearWindow>& linear,
                                  const std::vector<std::size_t>& columns, std::size_t last,
                                  const Own& own) const {
    std::vector<Squares> out(linear.size());
    core::parallel_for(linear.size(), settings_.threads, [&](std::size_t w) {
      out[w] = squares(linear[w], variances_[w], columns, last, own);
    });
    return out;
  }

  const Machine& model_;
  const std::vector<Unknown>& unknowns_;
  const std::vector<Recording>& recordings_;
  const std::vector<Window>& windows_;
  const Settings& settings_;
  std::vector<LinearWindow> linear_;
  std::vector<Local> locals_;
  std::vector<Variances> variances_;
  Own simulator_;
  std::vector<std::size_t> phase_;
};

/// Numbers that can be named, indices into the candidates: those with evidence beyond the prior odds, most first.
std::vector<std::size_t> rivals_of(const std::vector<RandomEffect>& effects, double log_prior_odds) {
  std::vector<std::size_t> order(effects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return effects[a].log_bayes_factor > effects[b].log_bayes_factor;
  });
  std::erase_if(order, [&](std::size_t k) { return !(effects[k].log_bayes_factor > log_prior_odds); });
  order.resize(std::min(order.size(), kRivals));
  return order;
}

/// Which rival leads, and by how much each is behind it.
struct Ranking {
  std::size_t first = 0;       ///< of the rivals
  std::vector<double> behind;  ///< logarithms
  Named named;                 ///< with the first one, fitted
};

/// A number that acts at one joint may have as much evidence by itself as one that acts at all of them, but leaves the other's: what counts is what
/// is left of one where the other differs.
Ranking ranked(const Evidences& evidences, const std::vector<Candidate>& all,
               const std::vector<RandomEffect>& effects, const std::vector<std::size_t>& rivals,
               const Named& named) {
  std::vector<Candidate> those;
  for (const std::size_t r : rivals) those.push_back(all[r]);
  const auto with = [&](std::size_t r) {
    return named.with(those[r].unknown, effects[rivals[r]].theta, effects[rivals[r]].spread);
  };
  const std::size_t n = rivals.size();
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  for (std::size_t other = 0; n > 1 && other < n; ++other) {
    const std::vector<RandomEffect> given = evidences(those, with(other));
    for (std::size_t one = 0; one < n; ++one)
      left(static_cast<Eigen::Index>(one), static_cast<Eigen::Index>(other)) = given[one].log_bayes_factor;
  }
  // By how much each is likelier than the other: both differences are those of a model with both.
  const Eigen::MatrixXd ahead = left - left.transpose();
  Eigen::Index first = 0;
  ahead.rowwise().minCoeff().maxCoeff(&first);
  Ranking out;
  for (std::size_t r = 0; r < n; ++r) out.behind.push_back(ahead(first, static_cast<Eigen::Index>(r)));
  // The leading ones by themselves: a law is not linear where a joint sticks, and one step from the model may favour another.
  std::vector<std::size_t> leading(n);
  std::iota(leading.begin(), leading.end(), std::size_t{0});
  std::stable_sort(leading.begin(), leading.end(),
                   [&](std::size_t a, std::size_t b) { return out.behind[a] < out.behind[b]; });
  leading.resize(std::min(n, kFitted));
  std::vector<double> likely;
  for (const std::size_t r : leading) {
    Named fitted = with(r);
    likely.push_back(evidences.fit(fitted));
    if (likely.size() > 1 && !(likely.back() > *std::max_element(likely.begin(), likely.end() - 1))) continue;
    out.first = r, out.named = std::move(fitted);
  }
  const double most = *std::max_element(likely.begin(), likely.end()), moved = out.behind[out.first];
  if (!std::isfinite(most)) return out;  // no window can be simulated about any
  for (double& b : out.behind) b -= moved;
  for (std::size_t k = 0; k < leading.size(); ++k) out.behind[leading[k]] = most - likely[k];
  return out;
}

}  // namespace

std::vector<Cause> causes(const Machine& model, const std::vector<Unknown>& unknowns,
                          const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                          std::vector<LinearWindow> linear, const std::vector<Local>& locals,
                          const Settings& settings) {
  std::vector<Candidate> all = candidates(model, unknowns);
  const double prior = std::log(static_cast<double>(all.size()));
  Evidences evidences(model, unknowns, recordings, windows, std::move(linear), locals, settings);

  std::vector<Cause> found;
  Named named;
  std::vector<Candidate> of_named;
  while (found.size() < kMostCauses) {
    const std::vector<RandomEffect> effects = evidences(all, named);
    const std::vector<std::size_t> rivals = rivals_of(effects, prior);
    if (rivals.empty()) break;
    Ranking ranking = ranked(evidences, all, effects, rivals, named);
    const std::size_t best = rivals[ranking.first];
    const RandomEffect& e = effects[best];
    Cause cause{all[best].unknown, e.theta, e.sd, e.spread, 0.0, {}};
    double odds = std::exp(prior - e.log_bayes_factor);  // of none
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k == best) continue;
      const auto at = std::find(rivals.begin(), rivals.end(), k);
      const double b = at != rivals.end()
                           ? ranking.behind[static_cast<std::size_t>(at - rivals.begin())]
                           : effects[rivals.front()].log_bayes_factor - effects[k].log_bayes_factor;
      odds += std::exp(-b);
      if (b < kAsLikely) cause.correlated_with.push_back(all[k].unknown);
    }
    cause.confidence = 1.0 / (1.0 + odds);
    found.push_back(std::move(cause));
    named = std::move(ranking.named);
    of_named.push_back(all[best]);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(best));
    // What windows say of each about where all are.
    evidences.go_to(named);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const RandomEffect now = evidences({of_named[k]}, named.without(k)).front();
      found[k].theta = now.theta, found[k].sd = now.sd, found[k].spread = named.spreads[k] = now.spread;
    }
  }
  return found;
}

}  // namespace furcula::floating
