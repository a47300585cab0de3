// The search for causes on a tree, see search.hpp.
#include "host/trees/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "host/core/quantile.hpp"
#include "host/trees/friction_at_rest.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/missing_torque.hpp"
#include "host/trees/score_test.hpp"
#include "host/trees/swings.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;

/// So many are fitted before one is taken.
constexpr std::size_t kLeaders = 5;
/// A window's residuals over its motion, squared, from which on nothing is linear any more.
constexpr double kGrosslyWrong = 0.02;
/// A cause without which the loss is so many times as much stays.
constexpr double kMissed = 2.0;
/// A cause is dropped whose parameters are nearer to none than so many of their own variances; at the end, also one whose size the
/// recordings agree on by less than this share of what the linear test asks: half of that where they predict each other with it by so
/// much better, of the loss.
constexpr double kHolds = 12.0, kAgree = 0.7, kPredicts = 0.05;
/// A cause alone that makes the recordings predict each other better by this share is no chance, however few they are.
constexpr double kPredictsMuch = 0.15;
/// At the end a cause must be as far from none as chance is with this probability, all its parameters together, by windows and recordings:
/// five standard deviations of one. A hundred causes are tried, and neighbouring windows are not independent.
constexpr double kChance = 5.7e-7;
/// And it must be worth so much of what all causes are, by squares.
constexpr double kOfAll = 0.004;
/// What a spring is worth of a joint's share of the loss counts, where it is so many times its scatter from window to window.
constexpr double kRingsSurely = 3.5;
/// So often does a rival that fits better take a cause's place.
constexpr int kMostSwaps = 4;
/// So many rivals of a cause are fitted; so many of them since they change the motion as it does, by this share of its squares.
constexpr std::size_t kMostRivals = 5, kMostAlike = 3;
constexpr double kNearlyOneLaw = 0.5;
/// One that is behind a cause by less than so many times the scatter stands for it.
constexpr double kStands = 2.0;
/// Of a rare law in a common one's place, the odds against it beforehand; of every other, one.
constexpr double kRare = 20.0;
/// A second search is given up after so many times the steps of the first.
constexpr std::size_t kMoreWork = 2;
/// What a parameter more must be worth, of the loss.
constexpr double kOfParameter = 0.01;
/// A delay, lag or skew of less than this share of the rows' interval is none: a time anywhere in it, of which a row does not tell, scatters by
/// as much, one over the square root of twelve.
constexpr double kResolved = 0.2887;
/// A Stribeck curve's rise towards standstill is one from so many standard errors on.
constexpr double kRises = 3.0;
/// Laws of friction with fewer parameters may be worse by so much of the loss, which a few windows make.
constexpr double kHardlyWorse = 0.05;
/// Laws of friction with as many parameters must be better by so much of the loss.
constexpr double kBetter = 0.003;

double sum_of(const std::vector<double>& x) {
  double out = 0.0;
  for (const double v : x) out += v;
  return out;
}

class Search {
 public:
  Search(Problem& problem, const Progress& progress, bool swings, std::size_t most_work = kMostWork)
      : problem_(problem), progress_(progress), swings_(swings), most_work_(most_work) {}

  Found run(Problem* coarse) {
    Found found;
    Hypothesis h{problem_.model().drives, problem_.model().causes};
    say(0.02, "fitting the free parameters");
    problem_.weigh(h);
    found.refitted = problem_.fit(h, 8);
    problem_.weigh(found.refitted.at);
    found.refitted = problem_.fit(found.refitted.at, 4);
    Fit fit = found.refitted;
    if (coarse != nullptr && problem_.misfit(fit.at) > kGrosslyWrong) {
      // Where the model flies apart within a window, nothing is linear: the large causes are found on short windows.
      Search on_short(*coarse, progress_, false);
      fit = fitted_anew(on_short.rounds(on_short.fitted_anew(fit.at), 4, &found).at);
      first_pick_ = on_short.first_pick_;
    }
    const std::size_t before = problem_.steps();
    problem_.stop_after(most_work_ * before);
    fit = path(std::move(fit), &found);
    found.ended_early = problem_.spent();
    problem_.stop_after(std::numeric_limits<std::size_t>::max());
    if (!found.ended_early) fit = another_path(std::move(fit), found, problem_.steps() - before);
    fit = common_path(std::move(fit), coarse, found, most_work_ * before);
    for (Candidate& spring : springs_) spring.fitted_gain = 0.0;  // that was beside fewer causes
    const std::size_t steps = most_work_ * before;
    judge(found, std::move(fit), steps);
    // Rivals that took a place may be two wrong laws of friction, too.
    const auto by_squares = [&] {
      problem_.weigh(found.fit.at);
      return problem_.fit(found.fit.at, 4);
    };
    if (!found.ended_early)
      if (Fit anew = without_falls(friction_anew(by_squares())); names(anew.at) != names(found.fit.at))
        judge(found, std::move(anew), steps);
    if (Fit anew = without_doubtful_latches(by_squares()); names(anew.at) != names(found.fit.at))
      judge(found, std::move(anew), steps);
    found.ended_early = found.ended_early || found.unjudged;
    found.disputed = std::max(disputed_, dropped_worth_);
    return found;
  }

  /// A rival that took a cause's place may be a latch that the switch's own lateness accounts for.
  Fit without_doubtful_latches(Fit fit) const {
    for (std::size_t c = fit.at.causes.size(); c-- > problem_.model().causes.size();) {
      const Effect e = fit.at.causes[c].effect;
      if (e != Effect::latch_delay && e != Effect::latch_offset) continue;
      if (away_from_none(problem_.model(), fit, c).squares < kHolds)
        fit = problem_.fit(without(fit.at, c), 4, &fit);
    }
    return fit;
  }

  /// From a fit to what the recordings agree on.
  Fit path(Fit fit, Found* found) {
    for (int again = 0; again < 3 && !problem_.spent(); ++again) {
      const std::size_t pruned = fit.at.causes.size();
      fit = rounds(std::move(fit), again == 0 ? 7 : 3, again == 0 ? found : nullptr);
      const std::size_t before = fit.at.causes.size();
      if (before != pruned) dropped_worth_ = 0.0;  // something else may account for it
      fit = prune(merge(std::move(fit)), true);
      if (fit.at.causes.size() == before || dropped_.empty()) break;
      problem_.weigh(fit.at);
      fit = problem_.fit(fit.at, 4);
    }
    return without_falls(friction_anew(std::move(fit)));
  }

  /// Of a Stribeck curve's friction at standstill less that in motion.
  static double variance_of_rise(const Fit& fit, std::size_t cause) {
    double sum = 0.0;
    for (std::size_t k = 0; k < fit.unknowns.size(); ++k)
      for (std::size_t l = 0; l < fit.unknowns.size(); ++l) {
        const Unknown &u = fit.unknowns[k], &w = fit.unknowns[l];
        if (!u.of_cause || !w.of_cause || u.cause != cause || w.cause != cause || u.parameter > 1 ||
            w.parameter > 1)
          continue;
        const double sign = u.parameter == w.parameter ? 1.0 : -1.0;
        sum += sign * fit.covariance(static_cast<Index>(k), static_cast<Index>(l));
      }
    return sum;
  }

  /// Dry friction of one size takes a Stribeck curve's place where its loss is less. Where the curve does not rise towards standstill by kRises
  /// standard errors, the loss may be more by kHardlyWorse.
  Fit without_falls(Fit fit) const {
    for (std::size_t c = problem_.model().causes.size(); c < fit.at.causes.size(); ++c) {
      const Cause& curve = fit.at.causes[c];
      if (curve.effect != Effect::stribeck_friction) continue;
      const double rise_nm = curve.values[1] - curve.values[0];
      const bool rises = rise_nm > 0.0 && rise_nm * rise_nm > kRises * kRises * variance_of_rise(fit, c);
      Hypothesis h = fit.at;
      h.causes[c] = {
          Effect::coulomb_friction, curve.sites, {0.5 * (curve.values[0] + curve.values[1]), 0, 0, 0}};
      Fit plain = problem_.fit(h, 6);
      if (plain.loss < (rises ? 1.0 : 1.0 + kHardlyWorse) * fit.loss) fit = std::move(plain);
    }
    return fit;
  }

  /// What was taken first, of a model that is still wrong, may have led astray. Where torque is missing at the end, another search begins
  /// with something else; the better end of the two counts. It is given up where it takes many times the first one's `steps`.
  Fit another_path(Fit fit, Found& found, std::size_t steps) {
    if (!first_pick_ || !much_is_missing(fit.at, found.refitted.at)) return fit;
    Search other(problem_, progress_, swings_);
    other.not_first_ = first_pick_;
    problem_.stop_after(problem_.steps() + kMoreWork * steps);
    Fit anew = other.path(other.fitted_anew(found.refitted.at), nullptr);
    const bool given_up = problem_.spent();
    problem_.stop_after(std::numeric_limits<std::size_t>::max());
    if (given_up || !better(anew, fit)) {
      problem_.weigh(fit.at);
      return problem_.fit(fit.at, 4);
    }
    take_over(other);
    problem_.weigh(anew.at);
    return problem_.fit(anew.at, 4);
  }
  void take_over(Search& other) {
    springs_ = std::move(other.springs_);
    ripples_ = std::move(other.ripples_);
    dropped_ = std::move(other.dropped_);
    dropped_worth_ = other.dropped_worth_;
    disputed_ = other.disputed_;
  }

  /// Common laws that act together may look like rare ones, and the search be lost among these. Where it has not come to its end, or torque is
  /// missing there, another begins with the common laws at every joint and adds what is worth it beside them. The better end of the two counts.
  /// It takes at most so many `steps`.
  Fit common_path(Fit fit, Problem* coarse, Found& found, std::size_t steps) {
    if (!found.ended_early && !much_is_missing(fit.at, found.refitted.at)) return fit;
    say(0.65, "trying the common laws at every joint");
    // A late command is nearly one law with damping and inertia under a position law: it comes in where these leave something.
    Hypothesis h = found.refitted.at;
    for (const Candidate& c : candidates(problem_, h, {}))
      if (is_common(c.effect) && c.effect != Effect::actuator_delay && c.sites.size() == 1 &&
          !problem_.scales().still[c.sites.front()])
        h.causes.push_back(c.columns.front());
    if (coarse != nullptr && problem_.misfit(found.refitted.at) > kGrosslyWrong) {
      coarse->weigh(h);
      h = coarse->fit(h, 8).at;
    }
    problem_.stop_after(problem_.steps() + steps);
    Search other(problem_, progress_, swings_);
    other.beside_common_ = true;
    Fit common = other.predictive(other.fitted_anew(h));
    found.common = common.at;
    Fit anew = other.path(std::move(common), nullptr);
    const bool ended_early = problem_.spent();
    problem_.stop_after(std::numeric_limits<std::size_t>::max());
    if (!better(anew, fit)) {
      problem_.weigh(fit.at);
      return problem_.fit(fit.at, 4);
    }
    found.ended_early = ended_early;
    take_over(other);
    problem_.weigh(anew.at);
    return problem_.fit(anew.at, 4);
  }
  /// Without the common laws that do not help the recordings to predict each other.
  Fit predictive(Fit fit) const {
    for (;;) {
      std::optional<Fit> least;
      for (std::size_t c = problem_.model().causes.size(); c < fit.at.causes.size(); ++c) {
        if (!is_common(fit.at.causes[c].effect)) continue;
        Fit off = problem_.fit(without(fit.at, c), 4, &fit);
        if (!least || off.held_out_loss < least->held_out_loss) least = std::move(off);
      }
      if (!least || least->held_out_loss > (1.0 + kWorth) * fit.held_out_loss) return fit;
      fit = std::move(*least);
    }
  }
  /// Beside common laws a rare cause must help the recordings to predict each other.
  bool is_worth_it(const Fit& with, const Fit& fit) const {
    const auto rare = [](const Fit& f) {
      return std::count_if(f.at.causes.begin(), f.at.causes.end(),
                           [](const Cause& c) { return !is_common(c.effect); });
    };
    return !beside_common_ || rare(with) <= rare(fit) ||
           with.held_out_loss < (1.0 - kPredicts) * fit.held_out_loss;
  }
  /// Weighed as either of them says, each parameter more being worth what it must.
  bool better(const Fit& a, const Fit& b) {
    for (const Hypothesis* weighed : {&a.at, &b.at}) {
      problem_.weigh(*weighed);
      const Fit of_a = problem_.fit(a.at, 2), of_b = problem_.fit(b.at, 2);
      const auto worth = [](const Fit& f) {
        return f.loss * (1.0 + kOfParameter * static_cast<double>(f.unknowns.size()));
      };
      if (worth(of_a) > worth(of_b)) return false;
    }
    return true;
  }
  /// As a verdict asks, but for the held-out recordings.
  bool much_is_missing(const Hypothesis& h, const Hypothesis& refitted) const {
    if (std::max(disputed_, dropped_worth_) > kDisputed) return true;
    const auto lacking = [&](const Hypothesis& of) {
      return missing_torque(problem_, problem_.recordings(), of, problem_.windows().front().span_s);
    };
    const std::vector<TorqueSamples> before = lacking(refitted), after = lacking(h);
    double of_before = 0.0, of_after = 0.0;
    bool structured = false;
    for (std::size_t j = 0; j < problem_.joints(); ++j) {
      const double torque_nm = problem_.scales().torque_nm[j];
      const Remainder was = remainder_of(before[j], problem_.recordings().size()),
                      left = remainder_of(after[j], problem_.recordings().size());
      if (left.is_another(torque_nm) || left.lasts(torque_nm)) return true;
      structured |= left.is_structured(torque_nm);
      // What one recording alone has nothing predicts from the others: then by what is gone.
      const double gone = (std::pow(was.rms_nm, 2) - std::pow(left.rms_nm, 2)) / std::pow(torque_nm, 2);
      of_after += std::pow(left.predictable_nm() / torque_nm, 2);
      of_before += std::max(std::pow(was.predictable_nm() / torque_nm, 2), gone);
    }
    return structured && of_after > kOfBefore * of_before;
  }

  Fit fitted_anew(const Hypothesis& h) {
    problem_.weigh(h);
    const Fit fit = problem_.fit(h, 6);
    problem_.weigh(fit.at);
    return problem_.fit(fit.at, 4);
  }

  /// Adds causes until none is worth it.
  Fit rounds(Fit fit, int most, Found* found) {
    std::set<std::string> refused;  // proposed, and gone in the fit
    springs_.clear();
    ripples_.clear();
    bool looked_for_swings = false;  // since something was found
    bool first_alone = false;        // of the picks
    // A spring that is not there yet makes everything else look wrong.
    if (found != nullptr && swings_) springs_ = likely_springs(problem_, fit);
    for (int round = 0; round < most && !problem_.spent(); ++round) {
      say(0.08 + 0.09 * round, "testing causes at sites");
      const ScoreTest linear(problem_, fit.at, fit.unknowns, tried(fit.at));
      if (found != nullptr) found->tried = std::max(found->tried, linear.candidates().size());
      std::vector<ScoreTest::Score> picks = pick(linear, fit, refused, round == 0 ? found : nullptr);
      if (first_alone && !picks.empty()) picks.resize(1);
      if (picks.empty()) {
        if (looked_for_swings) break;
        if (swings_) {
          springs_ = likely_springs(problem_, fit);
          ripples_ = likely_ripples(problem_, fit);
        }
        looked_for_swings = true;
        continue;
      }
      const std::size_t before = fit.at.causes.size();
      if (!first_pick_) first_pick_ = linear.candidates()[picks.front().candidate];
      Hypothesis next = fit.at;
      std::vector<std::ptrdiff_t> replaced;
      for (const auto& s : picks) {
        Candidate c = linear.candidates()[s.candidate];
        if (c.replaces >= 0) {
          // Those before it in the list have moved up.
          std::ptrdiff_t shift = 0;
          for (const std::ptrdiff_t r : replaced) shift += r < c.replaces ? 1 : 0;
          replaced.push_back(c.replaces);
          c.replaces -= shift;
        }
        next = with_candidate(problem_.model(), next, c, coefficients(s));
      }
      say(0.12 + 0.09 * round,
          "fitting " + std::to_string(next.causes.size()) + (next.causes.size() == 1 ? " cause" : " causes"));
      const bool spring = springs_in(next) != springs_in(fit.at);
      if (spring) {
        problem_.weigh(fit.at, &next);
        fit = problem_.fit(fit.at, 1);
      }
      Fit with = prune(problem_.fit(next, 6), false);
      if ((with.loss > fit.loss * (1.0 - kWorth) && with.at.causes.size() >= before) ||
          !is_worth_it(with, fit)) {
        // What was taken beside the first may be what spoils it.
        first_alone = picks.size() > 1;
        if (!first_alone)
          refused.insert(
              cause_name(problem_.model(), linear.candidates()[picks.front().candidate].columns.front()));
        if (spring) {
          problem_.weigh(fit.at);
          fit = problem_.fit(fit.at, 1);
        }
        continue;
      }
      fit = std::move(with);
      looked_for_swings = first_alone = false;
      problem_.weigh(fit.at);
      fit = apart(problem_.fit(fit.at, 3));
    }
    return fit;
  }

 private:
  void say(double fraction, const std::string& doing) const {
    if (progress_) progress_(std::min(fraction, 0.99), doing);
  }

  static std::span<const double> coefficients(const ScoreTest::Score& s) {
    return {s.coefficients.data(), static_cast<std::size_t>(s.coefficients.size())};
  }
  Guesses guesses(const Hypothesis& h) const {
    const std::vector<TorqueSamples> samples =
        missing_torque(problem_, problem_.recordings(), h, problem_.windows().front().span_s, 3000);
    Guesses out{ripple_cycles(problem_, samples), limits_nm(samples), springs_};
    for (const Candidate& c : ripples_) {
      std::vector<double>& cycles = out.ripple_cycles[c.sites.front()];
      const double n = c.columns.front().values[1];
      if (std::find(cycles.begin(), cycles.end(), n) == cycles.end()) cycles.push_back(n);
    }
    return out;
  }

  /// All candidates but those that the recordings did not agree on, and those that have a law in them that is found already: a position
  /// law's kd is a damping.
  std::vector<Candidate> tried(const Hypothesis& h) const {
    std::vector<Candidate> out = candidates(problem_, h, guesses(h));
    std::erase_if(out, [&](const Candidate& c) {
      if (not_first_ && h.causes.size() == problem_.model().causes.size() && overlap(c, *not_first_))
        return true;
      if (dropped_.contains(cause_name(problem_.model(), c.columns.front()))) return true;
      if (c.effect != Effect::position_gain_error && c.effect != Effect::damping_error) return false;
      const Effect other =
          c.effect == Effect::damping_error ? Effect::position_gain_error : Effect::damping_error;
      return std::any_of(h.causes.begin(), h.causes.end(), [&](const Cause& found) {
        return found.effect == other && std::any_of(c.sites.begin(), c.sites.end(), [&](std::size_t site) {
                 return std::find(found.sites.begin(), found.sites.end(), site) != found.sites.end();
               });
      });
    });
    return out;
  }

  static bool overlap(const Candidate& a, const Candidate& b) {
    return a.effect == b.effect && std::any_of(a.sites.begin(), a.sites.end(), [&](std::size_t site) {
             return std::find(b.sites.begin(), b.sites.end(), site) != b.sites.end();
           });
  }

  /// The candidates to take in this round, by a greedy solution of the linear problem.
  std::vector<ScoreTest::Score> pick(const ScoreTest& linear, const Fit& fit,
                                     const std::set<std::string>& refused, Found* table) {
    std::vector<ScoreTest::Score> out;
    ScoreTest::Columns base = linear.fitted();
    std::set<std::pair<LocationType, std::size_t>> taken;
    for (std::size_t k = 0; k < problem_.joints() + 1; ++k) {
      double sure = 0.0;
      const auto scores = linear.scores(base, 40, &sure);
      if (k == 0) disputed_ = sure;
      const ScoreTest::Score* best = nullptr;
      std::vector<const ScoreTest::Score*> leaders;
      std::set<std::string> seen;
      for (const auto& s : scores) {
        const Candidate& c = linear.candidates()[s.candidate];
        // Of one name the best; but a spring of another stiffness is another one.
        if (!seen.insert(cause_name(problem_.model(), c.columns.front())).second && !c.of_one_size) continue;
        const bool free = std::none_of(c.sites.begin(), c.sites.end(), [&](std::size_t site) {
          return taken.contains({location_type_of(c), site});
        });
        if (!free || refused.contains(cause_name(problem_.model(), c.columns.front()))) continue;
        if (best == nullptr) best = &s;
        leaders.push_back(&s);
        if (k > 0 || leaders.size() == kLeaders) break;
      }
      if (table != nullptr && k == 0 && table->table.empty())
        for (const auto& s : scores)
          table->table.push_back(
              {linear.candidates()[s.candidate].columns.front(), s.gain / linear.loss(), false});
      if (leaders.size() > 1) best = best_fitted(linear, fit, leaders);
      // The linear test is about the wrong model yet: what is small beside the best waits for the next round.
      if (best == nullptr || (!out.empty() && best->gain < 0.2 * out.front().gain)) break;
      out.push_back(*best);
      const Candidate& c = linear.candidates()[best->candidate];
      for (const std::size_t site : c.sites) taken.insert({location_type_of(c), site});
      for (const Index column : linear.columns_of(best->candidate)) base.push_back(column);
    }
    return out;
  }
  /// Of the first few by the linear test, the one that is best when it is fitted.
  const ScoreTest::Score* best_fitted(const ScoreTest& linear, const Fit& fit,
                                      const std::vector<const ScoreTest::Score*>& leaders) const {
    const ScoreTest::Score* best = leaders.front();
    double least = 1e300;
    for (const ScoreTest::Score* s : leaders) {
      if (s->gain < 0.5 * leaders.front()->gain) continue;
      const Hypothesis h =
          with_candidate(problem_.model(), fit.at, linear.candidates()[s->candidate], coefficients(*s));
      const Fit with = fit_beside(problem_, h, fit, 4);
      // A parameter more must be worth a hundredth of the residuals.
      const double loss = with.loss * (1.0 + kOfParameter * static_cast<double>(with.unknowns.size()));
      if (loss < least) {
        least = loss;
        best = s;
      }
    }
    return best;
  }
  static LocationType location_type_of(const Candidate& c) {
    const LocationType s = info(c.effect).location_type;
    return is_of_joints(s) ? LocationType::joint : s;
  }

  /// Between two rows nobody knows when a command came.
  bool is_unresolved(const Cause& c) const {
    return (c.effect == Effect::actuator_delay || c.effect == Effect::actuator_lag ||
            c.effect == Effect::time_skew) &&
           std::abs(c.values[0]) < kResolved * problem_.interval_s();
  }

  /// How far the cause's parameters are from having no effect, in their own scatter, squared.
  /// `steady`: what the recordings must agree on its size, of what the linear test asks.
  double distance(const Fit& fit, std::size_t cause, double steady) const {
    double most = 0.0;
    const Cause& c = fit.at.causes[cause];
    if (is_unresolved(c)) return 0.0;
    std::size_t moving = 0;
    for (std::size_t k = 0; k < fit.unknowns.size(); ++k)
      if (fit.unknowns[k].of_cause && fit.unknowns[k].cause == cause &&
          fit.covariance(static_cast<Index>(k), static_cast<Index>(k)) > 0.0)
        ++moving;
    for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
      const Unknown& u = fit.unknowns[k];
      if (!u.of_cause || u.cause != cause) continue;
      const double neutral = neutral_value(problem_.model(), c.effect, u.parameter, c.sites.front());
      if (std::isnan(neutral)) continue;
      const double variance = fit.covariance(static_cast<Index>(k), static_cast<Index>(k));
      const double away = value_of(fit.at, u) - neutral;
      std::vector<double> apart = fit.fold_value[k];
      for (double& x : apart) x -= neutral;
      if (variance > 0.0 && (steady == 0.0 || steadiness(apart, fit.fold_information[k]) >
                                                  steady * agreement(moving, problem_)))
        most = std::max(most, away * away / variance);
      if (fit.at_bound[k] && std::abs(away) > 0.5 * u.scale) most = std::max(most, 50.0);
    }
    if (c.effect == Effect::torque_saturation || c.effect == Effect::joint_elasticity)
      most = std::max(most, 50.0);
    return most;
  }

  bool by_chance(const Fit& fit, std::size_t cause, double Away::*by = &Away::squares) const {
    const Away away = away_from_none(problem_.model(), fit, cause);
    return away.parameters > 0 &&
           away.*by < core::chi_square_above(kChance, static_cast<double>(away.parameters));
  }

  /// Drops causes that do not hold, the weakest first. `strict`: the recordings must agree on what stays.
  Fit prune(Fit fit, bool strict) {
    if (strict) fit = without_friction_at_rest(without_doubtful_springs(std::move(fit)));
    std::set<std::string> predicts;
    for (;;) {
      std::size_t weakest = fit.at.causes.size();
      double least = kHolds;
      for (std::size_t c = problem_.model().causes.size(); c < fit.at.causes.size(); ++c) {
        const double d = strict && by_chance(fit, c) ? 0.0 : distance(fit, c, strict ? kAgree : 0.0);
        if (d >= least || predicts.contains(cause_name(problem_.model(), fit.at.causes[c]))) continue;
        least = d;
        weakest = c;
      }
      if (weakest == fit.at.causes.size()) return fit;
      Fit off = problem_.fit(without(fit.at, weakest), 4, &fit);
      const bool unresolved = is_unresolved(fit.at.causes[weakest]);
      // Much is there in a few windows only: their scatter then says little.
      if (!strict && !unresolved && off.loss > kMissed * fit.loss) return fit;
      const std::string name = cause_name(problem_.model(), fit.at.causes[weakest]);
      const double predicts_more = off.held_out_loss / fit.held_out_loss - 1.0;
      const bool alone = fit.at.causes.size() == problem_.model().causes.size() + 1;
      if (strict && !unresolved &&
          ((alone && predicts_more > kPredictsMuch) ||
           (!by_chance(fit, weakest) && distance(fit, weakest, 0.5 * kAgree) >= kHolds &&
            predicts_more > kPredicts))) {
        predicts.insert(name);
        continue;
      }
      // What chance makes in windows alone is nothing; what the windows are sure of and the recordings are not is something.
      if (strict && !by_chance(fit, weakest, &Away::by_windows)) drop(name, fit, off);
      if (strict) dropped_.insert(name);
      fit = std::move(off);
    }
  }

  /// Dry friction must gain where its joint moves.
  Fit without_friction_at_rest(Fit fit) {
    const std::size_t given = problem_.model().causes.size();
    for (std::size_t c = given; c < fit.at.causes.size();) {
      const Cause cause = fit.at.causes[c];
      const std::vector<bool> moves =
          is_dry_friction(cause.effect) ? windows_in_motion(problem_, cause) : std::vector<bool>{};
      if (std::find(moves.begin(), moves.end(), false) != moves.end()) {
        Fit off = problem_.fit(without(fit.at, c), 4, &fit);
        if (!gains_in_motion(fit, off, moves)) {
          dropped_.insert(cause_name(problem_.model(), cause));
          fit = std::move(off);
          c = given;
          continue;
        }
      }
      ++c;
    }
    return fit;
  }

  void drop(const std::string& name, const Fit& with, const Fit& off) {
    dropped_.insert(name);
    dropped_worth_ = std::max(dropped_worth_, (off.loss - with.loss) / off.loss);
  }

  std::set<std::string> names(const Hypothesis& at) const {
    std::set<std::string> out;
    for (const Cause& c : at.causes) out.insert(cause_name(problem_.model(), c));
    return out;
  }

  /// Dry friction beside another resistance of the same joint or a constant torque, or of two sizes in the two directions, or a Stribeck curve
  /// may be other laws: dry friction or a Stribeck curve, alone or beside a third. Once two wrong laws are in, the right ones gain little, one
  /// by one.
  Fit friction_anew(Fit fit) {
    const std::size_t given = problem_.model().causes.size();
    for (std::size_t j = 0; j < problem_.joints(); ++j) {
      Hypothesis bare{fit.at.drives, {}, fit.at.bodies, fit.at.inputs_late_rows};
      double dry_nm = 0.0, offset_nm = 0.0;  // the latter of friction that has two sizes
      std::size_t resistances = 0, constants = 0;
      bool curved = false;
      for (std::size_t c = 0; c < fit.at.causes.size(); ++c) {
        const Cause& cause = fit.at.causes[c];
        if (c < given || cause.sites != std::vector<std::size_t>{j} || !is_resistance(cause.effect)) {
          bare.causes.push_back(cause);
          constants += cause.effect == Effect::force_offset && cause.sites.front() == j ? 1 : 0;
          continue;
        }
        ++resistances;
        if (cause.effect == Effect::coulomb_friction) dry_nm = cause.values[0];
        if (cause.effect == Effect::asymmetric_friction) {
          dry_nm = 0.5 * (cause.values[0] + cause.values[1]);
          offset_nm = 0.5 * (cause.values[1] - cause.values[0]);
        }
        if (cause.effect == Effect::stribeck_friction) {
          dry_nm = 0.5 * (cause.values[0] + cause.values[1]);
          curved = true;
        }
      }
      if ((resistances + constants < 2 && offset_nm == 0.0 && !curved) || dry_nm <= 0.0) continue;
      say(0.7, "trying other models of friction at " + problem_.model().robot.joints[j].name);
      const Scales& scales = problem_.scales();
      const double speed = scales.velocity_radps[j], little_nm = 0.05 * scales.torque_nm[j];
      const Drive& drive = problem_.model().drives[j];
      std::vector<std::optional<Cause>> beside{
          std::nullopt, Cause{Effect::quadratic_drag, {j}, {little_nm / (speed * speed), 0, 0, 0}},
          Cause{Effect::load_friction, {j}, {0.05, 0, 0, 0}}};
      if (!problem_.model().is_free(j, 3))
        beside.push_back(
            Cause{Effect::damping_error, {j}, {drive.damping_nmspr + little_nm / speed, 0, 0, 0}});
      const Cause laws[] = {{Effect::coulomb_friction, {j}, {dry_nm, 0, 0, 0}},
                            {Effect::stribeck_friction, {j}, {dry_nm, 1.5 * dry_nm, 0.2 * speed, 0}},
                            {Effect::stribeck_friction, {j}, {dry_nm, 1.5 * dry_nm, 0.6 * speed, 0}}};
      for (const auto& other : beside)
        for (const Cause& law : laws) {
          // A curve alone has been fitted; so has friction of two sizes, which is dry friction beside a constant torque.
          if (!other &&
              (law.effect == Effect::stribeck_friction ? curved && resistances == 1 : offset_nm != 0.0))
            continue;
          Hypothesis h = bare;
          h.causes.push_back(law);
          if (other) h.causes.push_back(*other);
          // Of two sizes in the two directions: a curve beside a constant torque.
          if (offset_nm != 0.0) h.causes.push_back({Effect::force_offset, {j}, {offset_nm, 0, 0, 0}});
          if (names(h) == names(fit.at)) continue;
          Fit anew = problem_.fit(h, 6);
          if (!takes_place(anew, fit)) continue;
          const auto dropped = dropped_;
          const double worth = dropped_worth_;
          if (Fit kept = prune(std::move(anew), true); takes_place(kept, fit)) {
            fit = std::move(kept);
          } else {
            dropped_ = dropped;
            dropped_worth_ = worth;
          }
        }
    }
    return fit;
  }
  /// Whether other laws of friction take the place of those of `fit`. With fewer parameters: where they are worse by less than kHardlyWorse and
  /// than kStands times the scatter from window to window. With as many: where they are better by kBetter. With more: where they are better by
  /// kOfParameter each, and by kStands times the scatter.
  static bool takes_place(const Fit& anew, const Fit& fit) {
    const double more = static_cast<double>(anew.unknowns.size()) - static_cast<double>(fit.unknowns.size());
    if (more < 0.0) return anew.loss < (1.0 + kHardlyWorse) * fit.loss && against(fit, anew) < kStands;
    if (more == 0.0) return anew.loss < (1.0 - kBetter) * fit.loss;
    return anew.loss * (1.0 + kOfParameter * more) < fit.loss && against(anew, fit) > kStands;
  }
  static bool is_resistance(Effect e) {
    return e == Effect::coulomb_friction || e == Effect::asymmetric_friction || e == Effect::damping_error ||
           e == Effect::quadratic_drag || e == Effect::load_friction || e == Effect::stribeck_friction;
  }
  /// A stiffness is never near to having no effect: what tells is how much is lost without it. The least first.
  Fit without_doubtful_springs(Fit fit) {
    for (;;) {
      std::optional<Fit> least;
      std::string name;
      for (std::size_t c = problem_.model().causes.size(); c < fit.at.causes.size(); ++c) {
        if (fit.at.causes[c].effect != Effect::joint_elasticity) continue;
        Fit off = problem_.fit(without(fit.at, c), 4, &fit);
        const double share = kRings / static_cast<double>(problem_.joints());
        const bool much = off.loss > (1.0 + kRings) * fit.loss,
                   surely = off.loss > (1.0 + share) * fit.loss && against(fit, off) > kRingsSurely;
        if (much || surely || (least && off.loss > least->loss)) continue;
        least = std::move(off);
        name = cause_name(problem_.model(), fit.at.causes[c]);
      }
      if (!least) return fit;
      drop(name, fit, *least);
      fit = std::move(*least);
    }
  }

  /// A cause that has one value at several sites may have one of its own at each: where that predicts better.
  Fit apart(Fit fit) {
    Hypothesis h{fit.at.drives, {}, fit.at.bodies, fit.at.inputs_late_rows};
    for (std::size_t c = 0; c < fit.at.causes.size(); ++c) {
      const Cause& cause = fit.at.causes[c];
      for (const std::size_t site : cause.sites) {
        if (c >= problem_.model().causes.size()) h.causes.push_back({cause.effect, {site}, cause.values});
      }
      if (c < problem_.model().causes.size()) h.causes.push_back(cause);
    }
    if (h.causes.size() == fit.at.causes.size()) return fit;
    Fit each = prune(problem_.fit(h, 4), false);
    each = merge(std::move(each));
    return each.held_out_loss < (1.0 - kWorth) * fit.held_out_loss ? each : fit;
  }

  /// One effect with about one value at several sites is one cause.
  Fit merge(Fit fit) const {
    for (;;) {
      bool merged = false;
      for (std::size_t a = problem_.model().causes.size(); a < fit.at.causes.size() && !merged; ++a)
        for (std::size_t b = a + 1; b < fit.at.causes.size() && !merged; ++b) {
          const Cause &x = fit.at.causes[a], &y = fit.at.causes[b];
          const EffectInfo& e = info(x.effect);
          if (x.effect != y.effect || e.parameter_count != 1 || e.location_type == LocationType::link ||
              x.effect == Effect::force_offset || x.effect == Effect::encoder_offset)
            continue;
          double vx = 0.0, vy = 0.0, both = 0.0;
          for (std::size_t k = 0; k < fit.unknowns.size(); ++k)
            for (std::size_t l = 0; l < fit.unknowns.size(); ++l) {
              const Unknown &u = fit.unknowns[k], &w = fit.unknowns[l];
              if (!u.of_cause || !w.of_cause) continue;
              const double c = fit.covariance(static_cast<Index>(k), static_cast<Index>(l));
              if (u.cause == a && w.cause == a) vx = c;
              if (u.cause == b && w.cause == b) vy = c;
              if (u.cause == a && w.cause == b) both = c;
            }
          const double apart = x.values[0] - y.values[0],
                       neutral = neutral_value(problem_.model(), x.effect, 0, x.sites.front());
          const double size = std::abs(0.5 * (x.values[0] + y.values[0]) - neutral);
          const double variance = vx + vy - 2.0 * both;
          if (!(variance > 0.0) || apart * apart > 4.0 * variance || std::abs(apart) > 0.25 * size) continue;
          Hypothesis h = without(fit.at, b);
          h.causes[a].sites.insert(h.causes[a].sites.end(), y.sites.begin(), y.sites.end());
          std::sort(h.causes[a].sites.begin(), h.causes[a].sites.end());
          h.causes[a].values[0] = 0.5 * (x.values[0] + y.values[0]);
          fit = problem_.fit(h, 4);
          merged = true;
        }
      if (!merged) return fit;
    }
  }

  /// Each cause against none in its place, and against the others. It is given up after so many `steps`: what is named then stays.
  void judge(Found& found, Fit fit, std::size_t steps) {
    fit = with_common_laws(without_negligible(std::move(fit)));
    random_ = !much_is_missing(fit.at, found.refitted.at);
    fit = settled(fit.at);
    problem_.stop_after(problem_.steps() + steps);
    const std::size_t given = problem_.model().causes.size();
    for (int swaps = 0; swaps <= kMostSwaps; ++swaps) {
      found.gain.clear();
      found.rivals.clear();
      bool swapped = false;
      // All in one linear problem, at the whole hypothesis: each cause taken out of it, and what stands in for it.
      std::vector<Hypothesis> outs;
      std::vector<Fit> offs;
      for (std::size_t c = given; c < fit.at.causes.size(); ++c) {
        outs.push_back(without(fit.at, c));
        offs.push_back(problem_.fit(outs.back(), 4, &fit));
      }
      if (outs.empty()) break;
      if (const std::size_t least = doubtful(fit, offs); least < offs.size() && !problem_.spent()) {
        fit = settled(offs[least].at);
        --swaps;
        continue;
      }
      say(0.72, "comparing the causes with the others");
      const ScoreTest all(problem_, fit.at, fit.unknowns, candidates(problem_, fit.at, guesses(fit.at)),
                          outs);
      for (std::size_t c = given; c < fit.at.causes.size() && !swapped; ++c) {
        say(0.75 + 0.2 * static_cast<double>(c - given) / static_cast<double>(fit.at.causes.size()),
            "comparing " + cause_name(problem_.model(), fit.at.causes[c]) + " with the others");
        const Fit& off = offs[c - given];
        found.gain.push_back((off.loss - fit.loss) / fit.loss);
        std::vector<Rival> rivals;
        const ScoreTest linear = all.seen_from(c - given);
        ScoreTest::Columns others_fitted;
        for (const Index column : linear.fitted()) {
          const Unknown& u = fit.unknowns[static_cast<std::size_t>(column - 1)];
          if (!u.of_cause || u.cause != c) others_fitted.push_back(column);
        }
        // What is nearly one law with it first, then what would gain about as much.
        std::vector<ScoreTest::Score> scores = all.in_place_of(c - given, others_fitted, kNearlyOneLaw);
        const std::size_t alike = scores.size();
        std::vector<ScoreTest::Score> by_gain = linear.scores(others_fitted, 60);
        std::stable_sort(by_gain.begin(), by_gain.end(),
                         [](const auto& a, const auto& b) { return a.gain > b.gain; });
        scores.insert(scores.end(), by_gain.begin(), by_gain.end());
        std::set<std::string> seen{cause_name(problem_.model(), fit.at.causes[c])};
        std::vector<Hypothesis> others;
        const auto add = [&](const Candidate& candidate, std::span<const double> size) {
          if (candidate.replaces < 0 &&
              seen.insert(cause_name(problem_.model(), candidate.columns.front())).second)
            others.push_back(with_candidate(problem_.model(), off.at, candidate, size));
        };
        // In a rare law's place the common ones, too, whatever the linear problem says.
        for (const Candidate& candidate : linear.candidates())
          if (!is_common(fit.at.causes[c].effect) && is_common(candidate.effect) &&
              candidate.sites == fit.at.causes[c].sites)
            add(candidate, std::vector<double>(candidate.columns.size(), 1.0));
        const std::size_t common = others.size();
        for (std::size_t k = 0; k < scores.size() && others.size() < common + kMostRivals; ++k) {
          if (k < alike ? others.size() == common + kMostAlike : scores[k].gain < 0.3 * (off.loss - fit.loss))
            continue;
          add(linear.candidates()[scores[k].candidate], coefficients(scores[k]));
        }
        for (const Hypothesis& h : others) {
          const Fit other = problem_.fit(h, 5, &off);
          if (is_unresolved(other.at.causes.back())) continue;
          // The same law in another dress has the name that it had before.
          const Rival r{
              {other.at.causes.back()}, other.at, log_odds(fit, other), random_ ? kOdds : kOddsOfWrong};
          if (swaps < kMostSwaps && r.log_odds < 0.0 && !problem_.spent()) {
            fit = settled(other.at);
            swapped = true;
            break;
          }
          rivals.push_back(r);
        }
        found.rivals.push_back(std::move(rivals));
      }
      if (!swapped && (problem_.spent() || !(swaps < kMostSwaps && one_for_two(found, fit)))) break;
    }
    found.unjudged = problem_.spent();
    problem_.stop_after(std::numeric_limits<std::size_t>::max());
    found.fit = std::move(fit);
  }
  /// Without the causes that are worth next to nothing of what all are, by squares: no law is a law to much less than that, and what is left of
  /// a large cause looks like a small one of another sort. The least first.
  Fit without_negligible(Fit fit) const {
    for (;;) {
      problem_.weigh(fit.at);
      fit = problem_.fit(fit.at, 4);
      std::optional<Fit> least;
      double all = 0.0;
      for (std::size_t c = problem_.model().causes.size(); c < fit.at.causes.size(); ++c) {
        Fit off = problem_.fit(without(fit.at, c), 4, &fit);
        all += std::max(0.0, off.loss - fit.loss);
        if (!least || off.loss < least->loss) least = std::move(off);
      }
      if (!least || least->at.causes.size() == problem_.model().causes.size() ||
          least->loss - fit.loss >= kOfAll * all)
        return fit;
      fit = std::move(*least);
    }
  }
  /// A common law in the place of a rare one at the same joints, where the squares are less with it.
  Fit with_common_laws(Fit fit) const {
    const std::vector<Candidate> all = candidates(problem_, fit.at, {});
    for (std::size_t c = problem_.model().causes.size(); c < fit.at.causes.size(); ++c)
      for (const Candidate& candidate : all) {
        const Cause& rare = fit.at.causes[c];
        if (is_common(rare.effect) || !is_common(candidate.effect) || candidate.sites != rare.sites ||
            candidate.replaces >= 0)
          continue;
        Hypothesis h = fit.at;
        h.causes[c] = candidate.columns.front();
        if (Fit other = problem_.fit(h, 6); other.loss < fit.loss) fit = std::move(other);
      }
    return fit;
  }
  /// The cause for which the odds are least, where the recordings hardly tell that it is there; else their number.
  std::size_t doubtful(const Fit& fit, const std::vector<Fit>& offs) const {
    std::size_t least = offs.size();
    double odds = random_ ? kOdds : kOddsOfWrong;
    for (std::size_t c = 0; c < offs.size(); ++c)
      if (const double with = log_odds(fit, offs[c]); with < odds) {
        odds = with;
        least = c;
      }
    return least;
  }
  /// What stands for either of two causes may stand for both: then it is the one.
  bool one_for_two(const Found& found, Fit& fit) const {
    const std::size_t given = problem_.model().causes.size();
    for (std::size_t a = 0; a < found.rivals.size(); ++a)
      for (std::size_t b = a + 1; b < found.rivals.size(); ++b)
        for (const Rival& of_a : found.rivals[a])
          for (const Rival& of_b : found.rivals[b]) {
            const Cause& cause = of_a.causes.front();
            if (!of_a.stands() || !of_b.stands() || cause.effect != of_b.causes.front().effect ||
                cause.sites != of_b.causes.front().sites)
              continue;
            // In it `a` is gone already, and what stands for it is there.
            Fit one = problem_.fit(without(of_a.at, given + b - 1), 6);
            if (log_odds(fit, one) > 0.0) continue;
            fit = settled(one.at);
            return true;
          }
    return false;
  }
  /// A fit by the likelihood under what disturbs; what that is depends on the fit. Where what is left is not random, by squares: of wrong
  /// models they find the one that predicts best.
  Fit settled(const Hypothesis& h) const {
    problem_.weigh(h);
    Fit fit = problem_.fit(h, 4);
    for (int again = 0; random_ && again < 2; ++again) {
      problem_.whiten(fit.at);
      fit = problem_.fit(fit.at, 6);
    }
    return fit;
  }
  /// Of `fit` against `other`, natural logarithm: of their likelihoods, of their parameters (Schwarz, Annals of Statistics 6(2), 1978, the
  /// windows being what is independent), and of what is known beforehand. A window has Student's distribution, with as many degrees of
  /// freedom as residuals. Where the difference of two fits scatters from window to window by more than that of Gaussian residuals, twice
  /// the square of its distance from 0 is less than the likelihoods' logarithm, and right.
  double log_odds(const Fit& fit, const Fit& other) const {
    const double size = static_cast<double>(problem_.windows().front().measured.size());
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < fit.window_loss.size(); ++i) {
      const double more =
          2.0 * size * (std::log(size + other.window_loss[i]) - std::log(size + fit.window_loss[i]));
      sum += more;
      squares += more * more;
    }
    const double n = static_cast<double>(fit.window_loss.size());
    const double of_scatter = 2.0 * sum * sum / std::max(squares - sum * sum / n, 1e-300);
    const auto beforehand = [&](const Fit& f) {
      double out = 0.5 * static_cast<double>(f.unknowns.size()) * std::log(n);
      for (const Cause& c : f.at.causes) out += is_common(c.effect) ? 0.0 : std::log(kRare);
      return out;
    };
    return std::copysign(std::min(0.5 * std::abs(sum), of_scatter), sum) + beforehand(other) -
           beforehand(fit);
  }
  /// By how much `fit` is better than `other`, in the scatter of the difference from window to window.
  static double against(const Fit& fit, const Fit& other) {
    const std::size_t n = fit.window_loss.size();
    std::vector<double> d(n);
    for (std::size_t i = 0; i < n; ++i) d[i] = other.window_loss[i] - fit.window_loss[i];
    const double mean = sum_of(d) / static_cast<double>(n);
    double squares = 0.0;
    for (const double x : d) squares += (x - mean) * (x - mean);
    return mean * static_cast<double>(n) / std::sqrt(std::max(squares, 1e-300));
  }

  Problem& problem_;
  const Progress& progress_;
  std::optional<Candidate> first_pick_, not_first_;  ///< of the first round; what must not be that
  bool swings_;                                      ///< are looked for
  bool random_ = true;                               ///< what is left, as far as the recordings tell
  bool beside_common_ = false;                       ///< laws that are there from the first
  std::size_t most_work_;                            ///< see search()
  std::vector<Candidate> springs_, ripples_;         ///< that may be
  double disputed_ = 0.0;                            ///< see Found, of the last round
  double dropped_worth_ = 0.0;  ///< of causes that were dropped, and nothing came in their place: of the loss
  std::set<std::string> dropped_;  ///< causes that did not hold at the end of a search
};

}  // namespace

Found search(Problem& problem, Problem* coarse, const Progress& progress, std::size_t most_work) {
  return Search(problem, progress, true, most_work).run(coarse);
}

}  // namespace furcula::trees
