#include "host/diagnose/likelihood_search.hpp"

#include <algorithm>
#include <map>

#include "host/core/parallel.hpp"
#include "host/diagnose/bootstrap.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/proposals.hpp"
#include "host/diagnose/remainder.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr std::size_t kFits = 4;  ///< of the most promising proposals for one place
constexpr int kMostMoves = 12;

class LikelihoodSearch {
 public:
  LikelihoodSearch(const model::Model& model, const std::vector<identify::Recording>& recordings,
                   const identify::TrainingWindows& training, unsigned threads, const Progress& progress)
      : trainer_{model, recordings, training, threads}, progress_(progress), all_(trainer_.candidates()) {}

  std::optional<Selection> run(const Selection& first) {
    trainer_.reference_squares = squares_of_body(first.refitted);
    if (!about(first.chosen.fitted)) return std::nullopt;
    chosen_ = trainer_.fit_if_it_runs(first.chosen.effects, first.chosen);
    if (chosen_.failed) return std::nullopt;
    std::vector<Move> moves = known(first);
    for (int k = 0;; ++k) {
      tell(k);
      const std::vector<Move> more = neighbours();
      moves.insert(moves.end(), more.begin(), more.end());
      const Move* best = k < kMostMoves ? best_of(moves) : nullptr;
      if (best == nullptr) break;
      const Hypothesis next = best->to;
      if (!about(next.fitted)) break;
      chosen_ = trainer_.fit_if_it_runs(next.effects, next);
      if (chosen_.failed) return std::nullopt;
      moves.clear();
    }
    // For the likelihood, what is missing is a random force; for free runs it is not.
    if (leaves_more(by_free_runs(chosen_), first.chosen, kSmallestLoss)) return std::nullopt;
    return result(first, moves);
  }

 private:
  /// A set that may take the chosen one's place.
  struct Move {
    Hypothesis to;
    double odds = 0.0;  ///< twice the logarithm, over the chosen set
  };

  void tell(int move) const {
    if (progress_) progress_(0.9 + 0.005 * move, "the likelihood under random forces");
  }

  /// Whitens by runs of this model from here on. False where they do not reach enough of the rows.
  bool about(const model::Model& likely) {
    constexpr double kMost = 0.9;
    std::optional<std::vector<identify::Whitening>> whitening =
        whitening_about(likely, trainer_.recordings, trainer_.training.windows);
    if (!whitening) return false;
    double reached = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < whitening->size(); ++i) {
      reached += static_cast<double>((*whitening)[i].rows.size());
      rows += static_cast<double>(trainer_.training.windows[i].rows());
    }
    if (reached < kMost * rows) return false;
    trainer_.whitening = std::move(*whitening);
    trainer_.fitted = std::make_shared<FittedSets>();
    return true;
  }

  double odds(const Hypothesis& h) const {
    const auto motion = [](const Hypothesis& of) {
      return channel(of.fit, identify::Channel::motion).squares;
    };
    const auto layers = static_cast<double>(trainer_.training.layers);
    const double evidence = (motion(chosen_) - motion(h)) / layers +
                            evidence_of(chosen_.fit, h.fit, chosen_.fit, trainer_.training.layers, false);
    return evidence / misfit_ + trainer_.prior(h.effects) - trainer_.prior(chosen_.effects);
  }

  /// Those that mean something. What a larger set takes off free runs must go beyond what two honest
  /// simulators differ by, too.
  std::vector<Move> weighed(std::vector<Hypothesis> sets) const {
    const Hypothesis now = by_free_runs(chosen_);
    std::vector<Move> moves;
    for (Hypothesis& h : sets) {
      if (h.failed || !h.meaningful || names_twice(trainer_.model, h.effects) || h.effects == chosen_.effects)
        continue;
      const double its = odds(h);
      if (its > 0.0 && has_more(h) && !trainer_.compare(now, by_free_runs(h), all_.size()).counts) continue;
      moves.push_back({std::move(h), its});
    }
    return moves;
  }
  bool has_more(const Hypothesis& h) const {
    return parameters_of(h.effects) > parameters_of(chosen_.effects);
  }

  /// What was fitted before, fitted again.
  std::vector<Move> known(const Selection& first) {
    std::map<EffectSet, const Hypothesis*> sets;
    const auto add = [&](const Hypothesis& h) {
      if (!h.failed && h.meaningful && h.effects.size() <= kMostEffects) sets.try_emplace(h.effects, &h);
    };
    add(first.refitted);
    for (const Hypothesis& h : first.without) add(h);
    for (const Selection::Rival& r : first.equals) add(r.hypothesis);
    for (const Tried& t : first.tried)
      if (t.against_smaller.significant) add(t.hypothesis);
    std::vector<const Hypothesis*> from;
    for (const auto& [effects, h] : sets) from.push_back(h);
    misfit_ = overdispersion(chosen_.fit, units_of(trainer_.training.windows));
    std::vector<Hypothesis> fitted(from.size());
    core::parallel_for(from.size(), trainer_.threads, [&](std::size_t i) {
      fitted[i] = trainer_.fit_if_it_runs(from[i]->effects, *from[i]);
    });
    return weighed(std::move(fitted));
  }

  /// The sets with one cause more, one less, and another one in the place of one.
  std::vector<Move> neighbours() {
    misfit_ = overdispersion(chosen_.fit, units_of(trainer_.training.windows));
    const Proposer proposer(trainer_);
    const EffectSet& members = chosen_.effects;
    without_.assign(members.size(), {});
    core::parallel_for(members.size(), trainer_.threads, [&](std::size_t i) {
      without_[i] = trainer_.fit_if_it_runs(without(members, members[i]), chosen_);
    });
    struct Place {
      std::size_t group;  ///< of those on the same set
      const Hypothesis* on;
      std::optional<Effect> of;  ///< that is not in `on`
      Effect effect;
      double left;
      Proposal proposal{};

      bool is_other_name() const { return of && twins(*of, effect); }
    };
    std::vector<Place> places;
    std::size_t groups = 0;
    const auto add = [&](const Hypothesis& on, std::optional<Effect> of) {
      const double left = proposer.squares_left(on);
      for (const Effect e : all_)
        if (!holds(members, e) && !names_twice(trainer_.model, extended(on.effects, e)) &&
            (of || !stands_for_a_member(trainer_.model, members, e)))
          places.push_back({groups, &on, of, e, left});
      ++groups;
    };
    if (members.size() < kMostEffects) add(chosen_, std::nullopt);
    for (std::size_t i = 0; i < members.size(); ++i)
      if (!without_[i].failed) add(without_[i], members[i]);
    core::parallel_for(places.size(), trainer_.threads, [&](std::size_t i) {
      Place& p = places[i];
      p.proposal = proposer.best(*p.on, extended(p.on->effects, p.effect), p.effect, p.left);
    });
    std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
      return a.group != b.group ? a.group < b.group : a.proposal.gain > b.proposal.gain;
    });
    std::vector<const Place*> fits;
    std::size_t of_this = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      of_this = i > 0 && places[i].group == places[i - 1].group ? of_this + 1 : 0;
      if (places[i].is_other_name() || (of_this < kFits && places[i].proposal.gain > 0.0))
        fits.push_back(&places[i]);
    }
    std::vector<Hypothesis> sets(fits.size());
    core::parallel_for(fits.size(), trainer_.threads, [&](std::size_t i) {
      const Place& p = *fits[i];
      const EffectSet effects = extended(p.on->effects, p.effect);
      if (!p.is_other_name()) {
        sets[i] = fit_new(trainer_, effects, *p.on, p.proposal);
        return;
      }
      Hypothesis others = chosen_;  // the other members stay what they are
      others.fitted.effects.erase(*p.of);
      sets[i] = trainer_.fit_if_it_runs(
          effects, others,
          {{p.effect, in_other_words(chosen_.fitted, *p.of, p.effect).value_or(p.proposal.values)}});
    });
    sets.insert(sets.end(), without_.begin(), without_.end());
    return weighed(std::move(sets));
  }

  const Move* best_of(const std::vector<Move>& moves) const {
    const Move* best = nullptr;
    for (const Move& m : moves) {
      if (always_same(trainer_.model, m.to.effects, chosen_.effects)) continue;
      if (chosen_.meaningful && !(m.odds > (has_more(m.to) ? kTenTimes : 0.0))) continue;
      if (best == nullptr || m.odds > best->odds) best = &m;
    }
    return best;
  }

  /// With the squares that free runs leave at its values, which all else is compared by.
  Hypothesis by_free_runs(Hypothesis h) const {
    const identify::Fit look = identify::look_by_simulation(
        trainer_.model, h.unknowns, h.fit.values, trainer_.recordings, trainer_.training.windows,
        identify::Starting::at_optimum, trainer_.training.most_squares);
    h.fit.shares = look.shares;
    h.fit.squares = look.squares;
    h.cross_validated_squares = look.squares;  // which these values are not fitted to
    return h;
  }

  /// The member in whose place a set has another cause, or more than one.
  std::optional<Effect> replaced_by(const EffectSet& effects) const {
    std::optional<Effect> missing;
    for (const Effect e : chosen_.effects)
      if (!holds(effects, e)) {
        if (missing) return std::nullopt;
        missing = e;
      }
    const bool as_many =
        effects.size() >= chosen_.effects.size() && parameters_of(effects) <= parameters_of(chosen_.effects);
    return as_many ? missing : std::nullopt;
  }

  Selection result(const Selection& first, const std::vector<Move>& moves) const {
    Selection s = first;
    s.chosen = by_free_runs(chosen_);
    s.without.clear();
    for (const Hypothesis& h : without_) s.without.push_back(h.failed ? h : by_free_runs(h));
    s.equals.clear();
    s.pool.assign(1, {chosen_.effects, 0.0, 0.0});
    const double prior = trainer_.prior(chosen_.effects);
    for (const Move& m : moves) {
      const double its = trainer_.prior(m.to.effects) - prior;
      s.pool.push_back({m.to.effects, m.odds - its, its});
      const std::optional<Effect> of = replaced_by(m.to.effects);
      if (of && m.odds > -kEqualEvidence) s.equals.push_back({*of, by_free_runs(m.to)});
    }
    for (const Selection::Rival& r : first.equals)
      if (first.chosen.effects == chosen_.effects &&
          always_same(trainer_.model, r.hypothesis.effects, chosen_.effects) &&
          std::none_of(s.equals.begin(), s.equals.end(), [&](const Selection::Rival& known) {
            return known.of == r.of && known.hypothesis.effects == r.hypothesis.effects;
          }))
        s.equals.push_back(r);
    if (chosen_.effects != first.chosen.effects) s.acted.insert(Rule::likelihood);
    return s;
  }

  Trainer trainer_;
  const Progress& progress_;
  EffectSet all_;
  Hypothesis chosen_;
  std::vector<Hypothesis> without_;  ///< the chosen set without each member
  double misfit_ = 1.0;              ///< overdispersion with the chosen set
};

}  // namespace

std::optional<Selection> select_by_likelihood(const model::Model& model,
                                              const std::vector<identify::Recording>& recordings,
                                              const identify::TrainingWindows& training, unsigned threads,
                                              const Progress& progress, const Selection& first) {
  // What is systematic and in no law shows where recordings disagree; of fewer nothing tells it from a cause.
  constexpr std::size_t kFewestRecordings = 3;
  if (recordings.size() < kFewestRecordings || first.beyond_bounds || first.chosen.failed ||
      follows_the_body(first.chosen) || machines::rules(model.kind).cut == machines::Cut::releases ||
      std::any_of(recordings.begin(), recordings.end(),
                  [](const identify::Recording& r) { return !r.slips.empty(); }))
    return std::nullopt;
  return LikelihoodSearch(model, recordings, training, threads, progress).run(first);
}

}  // namespace furcula::diagnose
