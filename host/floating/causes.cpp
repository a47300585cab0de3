#include "host/floating/causes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "host/core/parallel.hpp"
#include "host/floating/random_effect.hpp"

namespace furcula::floating {
namespace {

constexpr std::size_t kRivals = 24, kFitted = 4;
constexpr std::size_t kMostCauses = 6;
/// Of one that is expected, four or more have a probability of 2 %: then all numbers of the tables may deviate, each a little.
constexpr std::size_t kMany = 4;
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

/// A window's squares of all columns and of y, its own unknowns integrated out: what other Squares are made of.
struct Gram {
  Eigen::MatrixXd all;  ///< y is the last
  double log_determinant = 0.0, rows = 0.0;

  Gram() = default;
  Gram(const LinearWindow& l, const Variances& v) {
    const Marginal s = scaled(l, v);
    Eigen::MatrixXd a(l.y.size(), l.a.cols() + 1);
    a << s.row_sd.cwiseInverse().asDiagonal() * l.a, l.y.cwiseQuotient(s.row_sd);
    const Eigen::MatrixXd ca = s.m.matrixL().solve(s.c.transpose() * a);
    all = Eigen::MatrixXd::Zero(a.cols(), a.cols());
    all.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
    all.selfadjointView<Eigen::Lower>().rankUpdate(ca.transpose(), -1.0);
    all.triangularView<Eigen::StrictlyUpper>() = all.transpose();
    rows = static_cast<double>(l.y.size());
    log_determinant =
        2.0 * (s.row_sd.array().log().sum() + Eigen::MatrixXd(s.m.matrixL()).diagonal().array().log().sum());
  }

  /// The window has its own value of that column, with such a standard deviation.
  void integrate(Eigen::Index column, double spread) {
    const Eigen::VectorXd with = all.col(column);
    const double own = spread * spread, share = 1.0 + own * with[column];
    all -= own / share * with * with.transpose();
    log_determinant += std::log(share);
  }

  /// @param last how many columns are the last
  Squares squares(const std::vector<std::size_t>& columns, std::size_t last, const Own& own) const {
    // The columns, y, and those that are integrated out.
    std::vector<Eigen::Index> of;
    for (const std::size_t c : columns) of.push_back(static_cast<Eigen::Index>(c));
    of.push_back(all.cols() - 1);
    for (const std::size_t c : own.unknowns) of.push_back(static_cast<Eigen::Index>(c));
    Gram g;
    g.all = all(of, of);
    g.log_determinant = log_determinant;
    const auto n = static_cast<Eigen::Index>(columns.size()), m = static_cast<Eigen::Index>(last);
    for (std::size_t k = 0; k < own.spreads.size(); ++k)
      if (own.spreads[k] > 0.0) g.integrate(n + 1 + static_cast<Eigen::Index>(k), own.spreads[k]);
    Squares s;
    s.information = g.all.diagonal().head(n);
    s.score = g.all.col(n).head(n);
    s.with_last = g.all.block(n - m, 0, m, n);
    s.y = g.all(n, n);
    s.rows = rows;
    s.log_determinant = g.log_determinant;
    return s;
  }
};

/// Numbers that were named: where they are, and how far windows' own values scatter about it. Prior standard deviations. The first `free` of
/// them have no name: all of a kind that may deviate, the same in all windows.
struct Named {
  std::size_t free = 0;
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

  /// Of those with a name, the k-th.
  Named without(std::size_t k) const {
    Named n;
    n.free = free;
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      if (i != free + k) n = n.with(unknowns[i], theta[static_cast<Eigen::Index>(i)], spreads[i]);
    return n;
  }
};

/// Windows about a machine, and what they say of numbers.
class Evidences {
 public:
  /// Windows linearised about some numbers.
  struct About {
    std::vector<LinearWindow> linear;
    std::vector<Marginal> own;  ///< of `linear`, with the first variances
    std::vector<Local> locals;
    std::vector<Variances> variances;
    std::vector<Gram> grams;
  };

  Evidences(const Machine& model, const std::vector<Unknown>& unknowns,
            const std::vector<Recording>& recordings, const std::vector<Window>& windows,
            std::vector<LinearWindow> linear, std::vector<Local> locals, const Settings& settings)
      : model_(model),
        unknowns_(unknowns),
        recordings_(recordings),
        windows_(windows),
        settings_(settings),
        about_{std::move(linear), std::vector<Marginal>(windows.size()), std::move(locals), {}, {}} {
    core::parallel_for(about_.linear.size(), settings.threads,
                       [&](std::size_t w) { about_.own[w] = scaled(about_.linear[w], first_variances()); });
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      if (of_simulator(unknowns[i])) simulator_.push_back(i);
    constexpr std::size_t kPhases = 4;  // later ones are alike
    std::size_t further = 4 * kPhases;
    for (const Window& w : windows) {
      const std::size_t stance = (w.stance[0] ? 1 : 0) + (w.stance[1] ? 2 : 0);
      // On the stand no ground acts: each window is by itself.
      phase_.push_back(stance == 0 ? further++ : std::min(w.phase, kPhases - 1) * 4 + stance);
    }
    estimate_variances(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns.size())));
  }

  /// Of `all`, where each of `named` differs by an amount that is sought, and from window to window by its spread.
  std::vector<RandomEffect> operator()(const std::vector<Candidate>& all, const Named& named) const {
    std::vector<std::size_t> columns;
    for (const Candidate& c : all) columns.push_back(c.unknown);
    columns.insert(columns.end(), named.unknowns.begin(), named.unknowns.end());
    const auto free = static_cast<std::ptrdiff_t>(named.free);
    const std::vector<Squares> parts = squares_of(columns, named.unknowns.size(),
                                                  {{named.unknowns.begin() + free, named.unknowns.end()},
                                                   {named.spreads.begin() + free, named.spreads.end()}});
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
    constexpr int kSteps = 3, kManySteps = 6, kManyHalvings = 2;
    // Those without a name keep the derivatives that are there: they are many, and where they are. They move with the last one, which begins at none
    // of it, and a step that is too long for their derivatives is halved.
    const auto free = static_cast<Eigen::Index>(named.free), n = named.theta.size();
    const int most = free > 0 ? kManySteps : kSteps;
    int halvings = free > 0 ? kManyHalvings : 0;
    if (free > 0) named.theta[n - 1] = 0.0;
    const std::vector<std::size_t> kept(named.unknowns.begin(), named.unknowns.begin() + free);
    std::vector<Unknown> those;
    for (std::size_t k = named.free; k < named.unknowns.size(); ++k)
      those.push_back(unknowns_[named.unknowns[k]]);
    std::vector<std::size_t> columns(named.unknowns.size());
    std::iota(columns.begin(), columns.end(), std::size_t{0});
    Point point = at(model_, unknowns_, all_of(named), about_.locals);
    // Windows begin where the derivatives of the point before have them, if they are likelier there.
    std::vector<Local> also = locals_at(about_.linear, about_.own, point.theta, about_.locals);
    double best = -std::numeric_limits<double>::infinity();
    Eigen::VectorXd to;
    for (int k = 0; k < most; ++k) {
      Refitted here = refit_linear(recordings_, windows_, first_variances(), also, point, settings_);
      const Eigen::VectorXd theta = point.theta(named.unknowns);
      linearise_machine(recordings_, windows_, those, {point.machine, theta.tail(n - free), point.locals},
                        settings_, here.linear);
      std::vector<Squares> parts(here.linear.size());
      core::parallel_for(parts.size(), settings_.threads, [&](std::size_t w) {
        LinearWindow& l = here.linear[w];
        Eigen::MatrixXd a(l.y.size(), n);
        a << about_.linear[w].a(Eigen::all, kept), l.a;
        l.a = std::move(a);
        l.y += l.a.leftCols(free) * theta.head(free);
        parts[w] = Gram(l, about_.variances[w]).squares(columns, columns.size(), {});
      });
      const Step step = step_of(parts, theta);
      if (step.log_posterior > best)
        best = step.log_posterior, named.theta = theta, to = step.to;
      else if (halvings-- > 0)
        to = 0.5 * (named.theta + to);
      else
        break;
      Eigen::VectorXd all = all_of(named);
      all(named.unknowns) = to;
      point = at(model_, unknowns_, all, point.locals);
      also = locals_at(here.linear, here.own, point.theta(named.unknowns), point.locals);
    }
    return best;
  }

  /// Goes to these numbers: windows are linearised about them from here on.
  void go_to(const Named& named) {
    Point point = at(model_, unknowns_, all_of(named), about_.locals);
    Refitted here =
        refit_linear(recordings_, windows_, first_variances(),
                     locals_at(about_.linear, about_.own, point.theta, about_.locals), point, settings_);
    linearise_machine(recordings_, windows_, unknowns_, point, settings_, here.linear);
    about_.linear = std::move(here.linear), about_.own = std::move(here.own);
    about_.locals = point.locals;
    estimate_variances(point.theta);
  }

  const About& about() const { return about_; }
  void go_back(About to) { about_ = std::move(to); }

  /// Where the windows' linear model has these numbers, and the logarithm of the posterior there, each window with its own ground.
  double settle(Named& named) const {
    const Step step = step_of(squares_of(named.unknowns, named.unknowns.size(), {}), named.theta);
    named.theta = step.to;
    return step.log_posterior;
  }

 private:
  /// Of all unknowns.
  Eigen::VectorXd all_of(const Named& named) const {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns_.size()));
    theta(named.unknowns) = named.theta;
    return theta;
  }

  /// A step of Gauss and Newton from `theta`, and the logarithm of the posterior there by Laplace's approximation; Student's t over windows, as in
  /// a fit of all numbers.
  struct Step {
    Eigen::VectorXd to;
    double log_posterior = 0.0;
  };
  static Step step_of(const std::vector<Squares>& parts, const Eigen::VectorXd& theta) {
    const auto n = theta.size();
    Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
    Step out;
    out.log_posterior = -0.5 * theta.squaredNorm();
    for (const Squares& s : parts) {
      const double left = s.at(theta), weight = (kFreedom + s.rows) / (kFreedom + left);
      precision += weight * s.with_last, score += weight * s.score;
      out.log_posterior -= 0.5 * (s.log_determinant + (kFreedom + s.rows) * std::log1p(left / kFreedom));
    }
    const Eigen::LLT<Eigen::MatrixXd> solver(precision);
    out.log_posterior -= Eigen::MatrixXd(solver.matrixL()).diagonal().array().log().sum();
    out.to = solver.solve(score);
    return out;
  }

  /// About `theta`: what the windows leave there is what disturbs them.
  void estimate_variances(const Eigen::VectorXd& theta) {
    for (LinearWindow& l : about_.linear) l.y -= l.a * theta;
    about_.variances = estimated(about_.linear, first_variances(), settings_.threads);
    about_.grams.resize(about_.linear.size());
    core::parallel_for(about_.linear.size(), settings_.threads, [&](std::size_t w) {
      about_.linear[w].y += about_.linear[w].a * theta;
      about_.grams[w] = Gram(about_.linear[w], about_.variances[w]);
      // Each window has its own ground.
      for (const std::size_t i : simulator_) about_.grams[w].integrate(static_cast<Eigen::Index>(i), 1.0);
    });
  }

  std::vector<Squares> squares_of(const std::vector<std::size_t>& columns, std::size_t last,
                                  const Own& own) const {
    std::vector<Squares> out(about_.grams.size());
    core::parallel_for(about_.grams.size(), settings_.threads,
                       [&](std::size_t w) { out[w] = about_.grams[w].squares(columns, last, own); });
    return out;
  }

  const Machine& model_;
  const std::vector<Unknown>& unknowns_;
  const std::vector<Recording>& recordings_;
  const std::vector<Window>& windows_;
  const Settings& settings_;
  About about_;
  std::vector<std::size_t> simulator_;
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

/// Causes that are found about what is named already, and how likely all is with them.
struct Found {
  std::vector<Candidate> all;  ///< candidates that are left
  Named named;
  std::vector<Cause> causes;
  std::vector<Candidate> of_named{};
  double log_posterior = 0.0;
};

/// Goes on until so many are found, or no more, or twice as many were tried.
void find(Evidences& evidences, std::size_t most, Found& out) {
  const double prior = std::log(static_cast<double>(out.all.size() + out.causes.size()));
  std::vector<Candidate>& all = out.all;
  Named& named = out.named;
  const auto log_posterior = [&](Named n) {
    return evidences.settle(n) - prior * static_cast<double>(n.unknowns.size() - n.free);
  };
  out.log_posterior = log_posterior(named);
  for (std::size_t tried = 0; tried < 2 * most && out.causes.size() < most; ++tried) {
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
    const Candidate candidate = all[best];
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(best));
    // What derivatives promise may not be there: a cause is one with which all is likelier where windows are linearised about it.
    Evidences::About before = evidences.about();
    evidences.go_to(ranking.named);
    const double now = log_posterior(ranking.named);
    if (!(now > out.log_posterior)) {
      evidences.go_back(std::move(before));
      continue;
    }
    out.log_posterior = now;
    named = std::move(ranking.named);
    out.causes.push_back(std::move(cause));
    out.of_named.push_back(candidate);
    for (std::size_t k = 0; k < out.causes.size(); ++k) {
      const RandomEffect effect = evidences({out.of_named[k]}, named.without(k)).front();
      Cause& c = out.causes[k];
      c.theta = effect.theta, c.sd = effect.sd, c.spread = named.spreads[named.free + k] = effect.spread;
    }
  }
}

/// All numbers of the tables, none of which has a name: from where `theta` has them to where they are likeliest with the others as in the model.
/// `evidences` goes there. None where windows cannot be simulated with them.
std::optional<Named> settled_tables(Evidences& evidences, const std::vector<Unknown>& unknowns,
                                    const Eigen::VectorXd& theta) {
  constexpr int kSteps = 8;
  Named tables;
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (unknowns[i].of_tables && !of_simulator(unknowns[i]))
      tables = tables.with(i, theta[static_cast<Eigen::Index>(i)], 0.0);
  tables.free = tables.unknowns.size();
  std::optional<Named> best;
  double most = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < kSteps; ++k) {
    Evidences::About before = evidences.about();
    evidences.go_to(tables);
    Named here = tables;
    const double now = evidences.settle(here);
    if (!(now > most)) {
      evidences.go_back(std::move(before));
      break;
    }
    most = now, best = std::exchange(tables, std::move(here));
  }
  return best;
}

}  // namespace

Causes causes(const Machine& model, const std::vector<Unknown>& unknowns,
              const std::vector<Recording>& recordings, const std::vector<Window>& windows,
              std::vector<LinearWindow> linear, const std::vector<Local>& locals,
              const Eigen::VectorXd& fitted, const Settings& settings) {
  Evidences evidences(model, unknowns, recordings, windows, std::move(linear), locals, settings);
  Found few{candidates(model, unknowns), {}, {}};
  find(evidences, kMany, few);
  if (few.causes.size() < kMany) return {std::move(few.causes), false};
  {
    Evidences about_tables = evidences;
    if (std::optional<Named> tables = settled_tables(about_tables, unknowns, fitted)) {
      Found beyond{candidates(model, unknowns), std::move(*tables), {}};
      std::erase_if(beyond.all, [&](const Candidate& c) { return unknowns[c.unknown].of_tables; });
      find(about_tables, kMostCauses, beyond);
      if (beyond.log_posterior > few.log_posterior) return {std::move(beyond.causes), true};
    }
  }
  find(evidences, kMostCauses, few);
  return {std::move(few.causes), false};
}

}  // namespace furcula::floating
