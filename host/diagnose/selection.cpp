#include "host/diagnose/selection.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/diagnose/bootstrap.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/proposals.hpp"
#include "host/diagnose/remainder.hpp"
#include "host/diagnose/wording.hpp"
#include "host/linear/linear.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr double kLittle = 4e-3;  ///< of what the re-fitted model leaves: such a member must help plainly
constexpr double kPlainly = 2.0, kAtAll = 0.5;  ///< standard errors
constexpr std::size_t kMostFits = 8;            ///< of the first round; half of them in the later ones
constexpr std::size_t kFewestFits = 3;
constexpr double kSmallestScreening = 0.2;  ///< of the best proposal's
constexpr std::size_t kMostRivals = 4;      ///< that are fitted in the place of each member
constexpr std::size_t kMostParts = 5;       ///< effects that pairs in the place of a member are made of
constexpr int kMostSwaps = 4;
constexpr std::size_t kBeam = 4;  ///< effects that a pair may begin with

/// Two names of one law: the same free runs to within a ten-thousandth, whatever was to be expected before.
bool the_same(const Hypothesis& one, const Hypothesis& other) {
  // Of a slip between the windows no run tells.
  return holds(one.effects, Effect::encoder_slip) == holds(other.effects, Effect::encoder_slip) &&
         std::abs(one.fit.squares - other.fit.squares) < 1e-4 * other.fit.squares;
}

bool earlier_in_catalogue(const Tried& a, const Tried& b) {
  return a.hypothesis.effects < b.hypothesis.effects;
}

bool stands(const Tried& t) { return t.against_smaller.significant && t.hypothesis.meaningful; }

class Search {
 public:
  Search(const model::Model& model, const std::vector<identify::Recording>& recordings,
         const identify::TrainingWindows& training, unsigned threads, const Progress& progress,
         const WithoutRules& without)
      : trainer_{model, recordings, training, threads},
        proposer_(trainer_),
        progress_(progress),
        off_(without),
        all_(trainer_.candidates()) {}

  Selection run() {
    tell(0.0, "re-fitting the model");
    s_.refitted = trainer_.fit({}, nullptr);
    trainer_.reference_squares = squares_of_body(s_.refitted);
    s_.chosen = s_.refitted;
    remember(s_.refitted);
    const std::optional<Hypothesis> wider = trainer_.widened(s_.refitted);
    if (wider && follows_the_body(*wider)) {
      s_.beyond_bounds = wider;
      return std::move(s_);
    }
    forward(0);
    if (keeps(Rule::one_for_several)) one_for_several();
    if (keeps(Rule::beam) && beam()) {
      acted(Rule::beam);
      if (!follows_the_body(s_.chosen)) forward(s_.chosen.effects.size());
    }
    replace_by_rivals();
    if (!s_.chosen.effects.empty() && !follows_the_body(s_.chosen)) {
      // What took a place may leave what another cause explains.
      const EffectSet before = s_.chosen.effects;
      forward(before.size());
      if (s_.chosen.effects != before) replace_by_rivals();
    }
    add_friction_of_two_sizes();
    if (keeps(Rule::early_rows)) add_drive_behind_early_rows();
    if (wider && trainer_.preference(s_.chosen, *wider) > -kEqualEvidence) s_.beyond_bounds = wider;
    weigh_by_chosen();
    std::vector<const Hypothesis*> others;
    for (const auto& [effects, h] : pool_)
      if (effects != s_.chosen.effects && (h.meaningful || effects.empty())) others.push_back(&h);
    s_.pool.assign(others.size() + 1, {s_.chosen.effects, 0.0, 0.0});
    const double prior = trainer_.prior(s_.chosen.effects);
    core::parallel_for(others.size(), trainer_.threads, [&](std::size_t i) {
      const Hypothesis& h = *others[i];
      s_.pool[i + 1] = {h.effects, evidence_for(h, of_motion(h)), trainer_.prior(h.effects) - prior};
    });
    return std::move(s_);
  }

 private:
  bool keeps(Rule r) const { return !off_.contains(r); }
  void acted(Rule r) { s_.acted.insert(r); }

  void tell(double fraction, std::string_view what) const {
    if (progress_) progress_(fraction, what);
  }

  /// Keeps a set that was fitted; of several fits of one set the best that means something.
  void remember(const Hypothesis& h) {
    if (h.failed) return;
    const auto [known, is_new] = pool_.try_emplace(h.effects, h);
    if (is_new) return;
    const Hypothesis& other = known->second;
    if (h.meaningful != other.meaningful ? h.meaningful : h.fit.squares < other.fit.squares)
      known->second = h;
  }
  void remember(const std::vector<Tried>& all) {
    for (const Tried& t : all) remember(t.hypothesis);
  }

  /// A set with one effect more than `on`, from what was proposed for it; compared with `on`.
  Tried tried(const EffectSet& larger, const Hypothesis& on, const Proposal& proposal, std::size_t round,
              std::size_t tries) const {
    Tried t;
    t.round = round;
    t.hypothesis = fit_new(trainer_, larger, on, proposal);
    if (!t.hypothesis.failed) t.against_smaller = trainer_.compare(on, t.hypothesis, tries);
    return t;
  }

  /// Marked as failed where the model runs away from there.
  Hypothesis fit_if_it_runs(const EffectSet& effects, const Hypothesis& from,
                            const Starts& starts = {}) const {
    try {
      return trainer_.fit(effects, &from, starts);
    } catch (const core::DataError&) {
      Hypothesis none;
      none.effects = effects;
      none.failed = true;
      return none;
    }
  }

  /// What each effect on top of `on` promises, the most promising first.
  std::vector<Proposal> propose(const Hypothesis& on, const EffectSet& effects, double progress_from,
                                double progress_share) const {
    const double left = proposer_.squares_left(on);
    std::vector<Proposal> proposals(effects.size());
    core::parallel_for(effects.size(), trainer_.threads, [&](std::size_t i) {
      const double share = static_cast<double>(i) / static_cast<double>(effects.size());
      tell(progress_from + progress_share * share, dynamics::info(effects[i]).name);
      proposals[i] = proposer_.best(on, extended(on.effects, effects[i]), effects[i], left);
    });
    std::stable_sort(proposals.begin(), proposals.end(),
                     [](const Proposal& a, const Proposal& b) { return a.gain > b.gain; });
    return proposals;
  }

  /// How many of the proposals on top of `on` are fitted; puts them first. `promised`: those among them that no rule has to put there.
  std::size_t worth_a_fit(std::vector<Proposal>& proposals, const Hypothesis& on, std::size_t most,
                          EffectSet& promised) const {
    promised = promising(proposals, most);
    // What does not move the body promises little beside what does, dry friction that sticks is badly judged
    // by a linear step, and a slip by windows that do not hold it: those first, always; and a law that has
    // one of the set as a special case, where that does not do. What a clutch's teeth make of a start is no
    // linear step's affair either.
    const bool lacking = !on.effects.empty() && !follows_the_body(on);
    const auto always = [&](const Proposal& p) {
      if (!keeps(Rule::always_fitted)) return false;
      const identify::Channel judge = judged_on(p.effect, trainer_.recordings);
      const bool hardly_seen = judge == identify::Channel::contact || judge == identify::Channel::drive;
      const bool wider =
          std::any_of(on.effects.begin(), on.effects.end(), [&](Effect e) { return contains(p.effect, e); });
      const bool jumps = dynamics::needs_clutch(p.effect);
      return (jumps && (most >= kMostFits || lacking)) || (hardly_seen && p.gain > 0.0) ||
             (lacking && wider) || p.effect == Effect::encoder_slip ||
             ((most >= kMostFits || lacking) &&
              (p.effect == Effect::coulomb_friction ||
               (!dynamics::has(trainer_.model.kind, dynamics::LocationType::leg) &&
                (p.effect == Effect::asymmetric_friction || p.effect == Effect::stribeck_friction))));
    };
    const auto first_other = std::stable_partition(proposals.begin(), proposals.end(), always);
    const auto fixed = static_cast<std::size_t>(first_other - proposals.begin());
    return count_promising(proposals, fixed, most);
  }

  /// Of proposals of which the first `fixed` are fitted in any case.
  static std::size_t count_promising(const std::vector<Proposal>& proposals, std::size_t fixed,
                                     std::size_t most) {
    most = std::min(std::max(most, fixed + kFewestFits), proposals.size());
    double most_promising = 0.0;
    for (const Proposal& p : proposals) most_promising = std::max(most_promising, p.gain);
    std::size_t count = std::min(std::max(fixed, kFewestFits), most);
    while (count < most && proposals[count].gain > kSmallestScreening * most_promising) ++count;
    return count;
  }

  static EffectSet promising(const std::vector<Proposal>& proposals, std::size_t most) {
    EffectSet effects;
    const std::size_t count = count_promising(proposals, 0, most);
    for (std::size_t i = 0; i < count; ++i) effects.push_back(proposals[i].effect);
    return effects;
  }

  /// Whether two sets are names of one law, by what they say or by their runs.
  bool one_law(const Hypothesis& one, const Hypothesis& other) const {
    return always_same(trainer_.model, one.effects, other.effects) || the_same(one, other);
  }

  /// The effect that removes most, if that is more than chance and numerics could; of those that remove as
  /// much, the one with the fewest parameters, then the first of the catalogue. Which are worth a fit is seen
  /// from one linear step each. Then the next.
  void forward(std::size_t first_round) {
    for (std::size_t round = first_round; round < kMostEffects; ++round) {
      EffectSet left;
      for (Effect e : all_)
        if (!stands_for_a_member(trainer_.model, s_.chosen.effects, e)) left.push_back(e);
      const double from = 0.05 + 0.18 * static_cast<double>(round);
      std::vector<Proposal> proposals = propose(s_.chosen, left, from, 0.09);
      if (round == 0) first_screenings_ = proposals;
      EffectSet promised;
      std::vector<Tried> trials(
          worth_a_fit(proposals, s_.chosen, round == 0 ? kMostFits : kMostFits / 2, promised));
      core::parallel_for(trials.size(), trainer_.threads, [&](std::size_t i) {
        const EffectSet larger = extended(s_.chosen.effects, proposals[i].effect);
        tell(from + 0.09, names(larger));
        trials[i] = tried(larger, s_.chosen, proposals[i], round, left.size());
      });
      drop_failed(trials);
      remember(trials);
      add_special_cases(trials);
      std::sort(trials.begin(), trials.end(), earlier_in_catalogue);
      const EffectSet before = s_.chosen.effects;
      const Tried* best = best_of(trials);
      if (best != nullptr) s_.chosen = simplest(trials, *best).hypothesis;
      for (Effect e : s_.chosen.effects)
        if (!holds(before, e) && !holds(promised, e)) acted(Rule::always_fitted);
      const bool swapped = keeps(Rule::swap_members) && swap_members(trials, before, round);
      s_.tried.insert(s_.tried.end(), trials.begin(), trials.end());
      if (swapped) acted(Rule::swap_members);
      if (best == nullptr && !swapped) return;
      prune(s_.chosen);
    }
  }

  /// Where a larger set removes more but means nothing, because the new member explains what an old one was
  /// taken for: the new one in the place of that, if the set is better than the chosen one.
  bool swap_members(const std::vector<Tried>& trials, const EffectSet& before, std::size_t round) {
    std::vector<std::pair<EffectSet, const Hypothesis*>> sets;
    const Hypothesis* best = nullptr;
    for (const Tried& t : trials) {
      if (!t.against_smaller.significant || t.hypothesis.meaningful) continue;
      for (Effect e : before)
        if (holds(t.hypothesis.effects, e)) sets.push_back({without(t.hypothesis.effects, e), &t.hypothesis});
      if (best == nullptr || t.hypothesis.fit.squares < best->fit.squares) best = &t.hypothesis;
    }
    // An old member that was a stand-in, where the best of them leaves less than half of the body's error:
    // other single causes in its place, of one law under two names the first.
    if (best != nullptr && before.size() == 1 && squares_of_body(*best) < 0.5 * squares_of_body(s_.chosen)) {
      const Hypothesis* last = nullptr;
      std::size_t others = 0;
      for (const Tried* first : first_singles()) {
        const Effect e = first->hypothesis.effects.front();
        if (holds(best->effects, e) || (last != nullptr && the_same(first->hypothesis, *last))) continue;
        last = &first->hypothesis;
        sets.push_back({with(without(best->effects, before.front()), e), best});
        if (++others == kBeam) break;
      }
    }
    std::erase_if(sets, [&](const auto& s) { return names_twice(trainer_.model, s.first); });
    std::vector<Tried> swaps(sets.size());
    core::parallel_for(sets.size(), trainer_.threads, [&](std::size_t i) {
      swaps[i] = {fit_if_it_runs(sets[i].first, *sets[i].second), round, {}};
      if (!swaps[i].hypothesis.failed)
        swaps[i].against_smaller = trainer_.compare(s_.refitted, swaps[i].hypothesis, all_.size());
    });
    drop_failed(swaps);
    remember(swaps);
    bool swapped = false;
    for (const Tried& s : swaps)
      if (stands(s) && trainer_.preference(s_.chosen, s.hypothesis) > price_of(s.hypothesis)) {
        s_.chosen = Hypothesis(s.hypothesis);
        swapped = true;
      }
    s_.tried.insert(s_.tried.end(), swaps.begin(), swaps.end());
    return swapped;
  }

  /// A law that is not told from its special case leaves less than that one does: the fit of the special case ended elsewhere, and begins
  /// anew from there.
  void add_special_cases(std::vector<Tried>& trials) {
    struct Narrower {
      const Hypothesis *known, *without;
      const Tried* from;
      Starts starts;
    };
    std::vector<Narrower> sets;
    for (const Tried& t : trials)
      for (Effect e : t.hypothesis.effects) {
        if (told_from_special_case(t.hypothesis, e)) continue;
        const EffectSet rest = without(t.hypothesis.effects, e);
        const auto& sizes = t.hypothesis.fitted.effects.at(e);
        const double size = e == Effect::asymmetric_friction ? 0.5 * (sizes[0] + sizes[1]) : sizes[0];
        for (Effect special : all_) {
          if (!contains(e, special) || holds(rest, special)) continue;
          const auto known = pool_.find(with(rest, special));
          if (known == pool_.end() || !leaves_more(known->second, t.hypothesis, kSmallestLoss)) continue;
          const auto none = pool_.find(rest);
          sets.push_back(
              {&known->second, none != pool_.end() ? &none->second : &s_.refitted, &t, {{special, {size}}}});
        }
      }
    std::vector<Tried> narrower(sets.size());
    core::parallel_for(sets.size(), trainer_.threads, [&](std::size_t i) {
      const Tried& from = *sets[i].from;
      narrower[i] = {fit_if_it_runs(sets[i].known->effects, from.hypothesis, sets[i].starts), from.round, {}};
      if (!narrower[i].hypothesis.failed)
        narrower[i].against_smaller = trainer_.compare(*sets[i].without, narrower[i].hypothesis, all_.size());
    });
    drop_failed(narrower);
    remember(narrower);
    for (Tried& t : narrower) trials.push_back(std::move(t));
  }

  static void drop_failed(std::vector<Tried>& all) {
    std::erase_if(all, [](const Tried& t) { return t.hypothesis.failed; });
  }

  const Tried* best_of(const std::vector<Tried>& trials) const {
    const Tried* best = nullptr;
    for (const Tried& t : trials)
      if (stands(t) && (best == nullptr || trainer_.preference(best->hypothesis, t.hypothesis) > 0.0))
        best = &t;
    return best;
  }

  /// Of those that do as well as the best one.
  const Tried& simplest(const std::vector<Tried>& trials, const Tried& best) const {
    const Tried* simplest = &best;
    for (const Tried& t : trials) {
      if (!stands(t)) continue;
      const double evidence = trainer_.preference(t.hypothesis, best.hypothesis);
      const std::size_t size = parameters_of(t.hypothesis.effects),
                        now = parameters_of(simplest->hypothesis.effects);
      const bool as_good =
          size < now ? evidence < kEqualEvidence || !leaves_more(t.hypothesis, best.hypothesis, kSmallestLoss)
                     : size == now && one_law(t.hypothesis, simplest->hypothesis);
      if (as_good && (size < now || (size == now && &t < simplest))) simplest = &t;
    }
    return *simplest;
  }

  /// Backward: takes out members that the others have made needless, and takes a law's special case for one
  /// that needs no more.
  void prune(Hypothesis& chosen) {
    if (!keeps(Rule::prune)) return;
    const auto replaced_by = [&](Hypothesis smaller, bool needless) {
      if (!needless || (chosen.meaningful && !smaller.meaningful)) return false;
      acted(Rule::prune);
      chosen = std::move(smaller);
      return true;
    };
    for (bool again = true; again && chosen.effects.size() > 1;) {
      again = false;
      for (Effect e : EffectSet(chosen.effects)) {
        const EffectSet rest = without(chosen.effects, e);
        Hypothesis smaller = fit_if_it_runs(rest, chosen);
        remember(smaller);
        const bool needless = !smaller.failed && !trainer_.compare(smaller, chosen, all_.size()).significant;
        again = replaced_by(std::move(smaller), needless);
        for (Effect special : all_) {
          if (again || !contains(e, special)) continue;
          Hypothesis narrower =
              fit_if_it_runs(with(rest, special), chosen, {{special, {chosen.fitted.effects.at(e)[0]}}});
          remember(narrower);
          const bool as_good =
              !narrower.failed && !trainer_.compare(narrower, chosen, all_.size()).told_apart;
          again = replaced_by(std::move(narrower), as_good);
        }
        if (again) break;
      }
    }
  }

  /// One cause that explains as much as several is the better explanation, even where no step towards it
  /// promised so; a law that has one of them as a special case is always asked.
  void one_for_several() {
    if (s_.chosen.effects.size() < 2) return;
    tell(0.78, "one cause in the place of several");
    std::vector<Proposal> singles;
    for (const Proposal& p : first_screenings_) {
      const bool known = std::any_of(s_.tried.begin(), s_.tried.end(), [&](const Tried& t) {
        return t.round == 0 && t.hypothesis.effects == EffectSet{p.effect};
      });
      const bool wider = std::any_of(s_.chosen.effects.begin(), s_.chosen.effects.end(),
                                     [&](Effect e) { return contains(p.effect, e); });
      if (!known && (wider || (p.gain > 0.0 && singles.size() < kMostFits))) singles.push_back(p);
    }
    std::vector<Tried> trials(singles.size());
    core::parallel_for(singles.size(), trainer_.threads, [&](std::size_t i) {
      trials[i] = tried({singles[i].effect}, s_.refitted, singles[i], 0, all_.size());
    });
    drop_failed(trials);
    remember(trials);
    s_.tried.insert(s_.tried.end(), trials.begin(), trials.end());
    const Hypothesis* simpler = nullptr;
    for (const Tried& t : s_.tried)
      if (t.hypothesis.effects.size() == 1 && stands(t) &&
          trainer_.preference(s_.chosen, t.hypothesis) > -kEqualEvidence &&
          (simpler == nullptr || t.hypothesis.fit.squares < simpler->fit.squares))
        simpler = &t.hypothesis;
    if (simpler == nullptr) return;
    s_.chosen = Hypothesis(*simpler);
    acted(Rule::one_for_several);
  }

  /// The single effects of the first round, those that remove most first.
  std::vector<const Tried*> first_singles() const {
    std::vector<const Tried*> firsts;
    for (const Tried& t : s_.tried)
      if (t.round == 0 && (t.against_smaller.significant || s_.chosen.effects.empty()) &&
          t.hypothesis.effects.size() == 1)
        firsts.push_back(&t);
    std::sort(firsts.begin(), firsts.end(), [](const Tried* a, const Tried* b) {
      return a->hypothesis.fit.squares < b->hypothesis.fit.squares;
    });
    return firsts;
  }

  /// The effect that alone removes most may be a compromise between two causes, and one cause alone may
  /// remove nothing while another twists the rest: where one or none does not explain the recordings, pairs
  /// that begin with others. True if one of them took the place of the chosen set.
  bool beam() {
    if (s_.chosen.effects.size() < 2 && follows_the_body(s_.chosen)) return false;
    std::vector<const Tried*> firsts = first_singles();
    if (firsts.size() > kBeam) firsts.resize(kBeam);
    std::vector<Tried> pairs;
    for (const Tried* first : firsts) {
      const Hypothesis& on = first->hypothesis;
      EffectSet left;
      for (Effect e : all_)
        if (!stands_for_a_member(trainer_.model, on.effects, e) && !contains(e, on.effects.front()))
          left.push_back(e);
      const std::vector<Proposal> proposals = propose(on, left, 0.78, 0.02);
      std::vector<Tried> trials(std::min(proposals.size(), kFewestFits));
      core::parallel_for(trials.size(), trainer_.threads, [&](std::size_t i) {
        trials[i] = tried(with(on.effects, proposals[i].effect), on, proposals[i], 1, left.size());
      });
      drop_failed(trials);
      for (Tried& t : trials) pairs.push_back(std::move(t));
    }
    remember(pairs);
    add_special_cases(pairs);
    std::stable_sort(pairs.begin(), pairs.end(), earlier_in_catalogue);
    bool better = false;
    if (const Tried* best = best_of(pairs)) {
      const Hypothesis& pair = simplest(pairs, *best).hypothesis;
      better = trainer_.preference(s_.chosen, pair) > price_of(pair);
      if (better) {
        s_.chosen = Hypothesis(pair);
        prune(s_.chosen);
      }
    }
    s_.tried.insert(s_.tried.end(), pairs.begin(), pairs.end());
    return better;
  }

  /// By how much a set must be preferred to the chosen one to take its place: fewer causes or parameters for
  /// the same, or better ones.
  double price_of(const Hypothesis& h) const {
    const auto more =
        static_cast<double>(parameters_of(h.effects)) - static_cast<double>(parameters_of(s_.chosen.effects));
    if (more > 0.0) return chi_square_point(static_cast<double>(all_.size()), more);
    const bool simpler = more < 0.0 || h.effects.size() < s_.chosen.effects.size();
    return simpler ? -kEqualEvidence : one_law(h, s_.chosen) ? kEqualEvidence : 0.0;
  }

  /// What each member is worth, and which sets do as well in its place; one that is likelier takes its place.
  void replace_by_rivals() {
    for (int round = 0;; ++round) {
      tell(0.8 + 0.05 * round, "what cannot be told apart");
      if (keeps(Rule::friction_that_pushes)) put_friction_that_pushes_otherwise();
      const EffectSet& members = s_.chosen.effects;
      s_.without.assign(members.size(), {});
      core::parallel_for(members.size(), trainer_.threads, [&](std::size_t i) {
        const EffectSet rest = without(members, members[i]);
        s_.without[i] = fit_if_it_runs(rest, s_.chosen);
        if (s_.without[i].failed) s_.without[i] = trainer_.fit(rest, &s_.refitted);
      });
      for (const Hypothesis& h : s_.without) remember(h);
      weigh_by_chosen();
      if (const Hypothesis* fewer =
              keeps(Rule::least_agreed) && round < kMostSwaps ? without_the_least_agreed() : nullptr) {
        s_.chosen = Hypothesis(*fewer);
        acted(Rule::least_agreed);
        continue;
      }
      s_.equals = rivals();
      const Hypothesis* better = nullptr;
      double most = 0.0;
      for (const auto& r : s_.equals) {
        const double odds =
            odds_for(r.hypothesis) - (one_law(r.hypothesis, s_.chosen) ? kEqualEvidence : 0.0);
        if (keeps(Rule::rivals) && odds > most) most = odds, better = &r.hypothesis;
      }
      if (round == kMostSwaps) return;
      if (better != nullptr)
        acted(Rule::rivals);
      else if (keeps(Rule::heaviest) && (better = heaviest()) != nullptr)
        acted(Rule::heaviest);
      else if (const Hypothesis* more = keeps(Rule::larger) ? larger() : nullptr) {
        s_.chosen = Hypothesis(*more);
        acted(Rule::larger);
        continue;
      } else if (keeps(Rule::falling_friction))
        if (const std::optional<Hypothesis> falling = falling_friction()) {
          s_.chosen = *falling;
          remember(s_.chosen);
          acted(Rule::falling_friction);
          continue;
        }
      if (better == nullptr) return;
      s_.chosen = Hypothesis(*better);
      prune(s_.chosen);
    }
  }

  /// Of all sets that were fitted and hold no more causes the one that is most likely, if it is ten times as likely as the chosen one.
  const Hypothesis* heaviest() const {
    const Hypothesis* best = nullptr;
    double most = kTenTimes;
    for (const auto& [effects, h] : pool_) {
      if (effects.empty() || effects.size() > s_.chosen.effects.size() || !h.meaningful ||
          names_twice(trainer_.model, effects) || !trainer_.compare(s_.refitted, h, all_.size()).significant)
        continue;
      if (const double odds = odds_for(h); odds > most) most = odds, best = &h;
    }
    return best;
  }

  /// Of larger sets that were fitted the most likely one, if it is ten times as likely as the chosen one by the motion under disturbances, and removes
  /// what counts. Squares of free runs, which these dominate, ask for more.
  const Hypothesis* larger() const {
    if (!disturbed_) return nullptr;
    const Hypothesis* best = nullptr;
    double most = kTenTimes;
    for (const auto& [effects, h] : pool_) {
      if (effects.size() <= s_.chosen.effects.size() || effects.size() > kMostEffects || !h.meaningful ||
          names_twice(trainer_.model, effects) || !trainer_.compare(s_.chosen, h, all_.size()).counts)
        continue;
      const std::optional<double> motion = of_motion(h);
      if (!motion) continue;
      if (const double odds = odds_for(h, motion); odds > most) most = odds, best = &h;
    }
    return best;
  }

  /// A Stribeck curve in the place of dry friction of one size. Its values may be known in combination alone: then the windows' scatter does
  /// not tell its two sizes apart, and the likelihood under what disturbs does, if it is ten times as likely and worth its two parameters.
  std::optional<Hypothesis> falling_friction() {
    const EffectSet& members = s_.chosen.effects;
    if (!disturbed_ || !holds(members, Effect::coulomb_friction)) return std::nullopt;
    const EffectSet falling = with(without(members, Effect::coulomb_friction), Effect::stribeck_friction);
    const auto known = pool_.find(falling);
    Hypothesis h = known != pool_.end() ? known->second : fit_if_it_runs(falling, s_.chosen);
    if (h.failed || h.meaningful) return std::nullopt;
    for (std::size_t i = 0; i < h.unknowns.size(); ++i)
      if (h.unknowns[i].of_effect && h.fit.at_bound[i]) return std::nullopt;
    if (odds_for(h) < kTenTimes + chi_square_point(static_cast<double>(all_.size()), 2.0))
      return std::nullopt;
    h.meaningful = true;
    return h;
  }

  /// Of several causes the set without one of which there may be none, that is of little help, or that the recordings do not agree on:
  /// by evidence that is worth the
  /// less the more their pulls scatter, as in a confidence, that set is ten times as likely.
  const Hypothesis* without_the_least_agreed() const {
    const EffectSet& members = s_.chosen.effects;
    if (members.size() < 2) return nullptr;
    const Hypothesis* best = nullptr;
    double most = kTenTimes;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Hypothesis& h = s_.without[i];
      if (h.meaningful && judged_on(members[i], trainer_.recordings) == identify::Channel::motion &&
          (may_be_none(s_.chosen, trainer_.model, members[i]) || is_little(h)))
        return &h;
      if (!h.meaningful) continue;
      if (const double odds = odds_for(h); odds > most) most = odds, best = &h;
    }
    return best;
  }

  /// Whether a member is worth little, and of no plain help on recordings that its fit has not seen: what is left of a large cause looks
  /// like a small one of another sort. Or of no help there at all.
  bool is_little(const Hypothesis& without_it) const {
    // Of runs that jump a linear step tells nothing; nor does one recording in one piece, nor one that a slip spoils.
    const Units units = units_of(trainer_.training.windows);
    if (holds(s_.chosen.effects, Effect::encoder_slip) ||
        machines::rules(trainer_.model.kind).cut == machines::Cut::releases || units.size() < 2)
      return false;
    const double worth =
        (squares_of_body(without_it) - squares_of_body(s_.chosen)) / trainer_.reference_squares;
    const double help = in_standard_errors(
        gains_unseen(without_it.fit, s_.chosen.fit, trainer_.training.windows, trainer_.recordings.size()),
        units);
    return help < (worth < kLittle ? kPlainly : kAtAll);
  }

  /// A friction of two sizes of which one is below zero would push. It is friction and a constant force: named
  /// so (docs/contracts.md, section 3).
  void put_friction_that_pushes_otherwise() {
    if (!holds(s_.chosen.effects, Effect::asymmetric_friction)) return;
    const auto& [up, down, none] = s_.chosen.fitted.effects.at(Effect::asymmetric_friction);
    if (std::min(up, down) >= 0.0) return;
    EffectSet words = without(s_.chosen.effects, Effect::asymmetric_friction);
    if (!holds(words, Effect::stribeck_friction)) words = with(words, Effect::coulomb_friction);
    if (!holds(words, Effect::force_offset)) words = with(words, Effect::force_offset);
    Hypothesis other = fit_if_it_runs(
        words, s_.chosen,
        {{Effect::coulomb_friction, {0.5 * (up + down)}}, {Effect::force_offset, {0.5 * (down - up)}}});
    if (other.failed || !other.meaningful) return;
    s_.chosen = std::move(other);
    acted(Rule::friction_that_pushes);
    prune(s_.chosen);  // of a constant force alone, too, both sizes are found
  }

  /// Friction and a constant force are one law with a friction of two sizes: up = size - force, down = size + force.
  void add_friction_of_two_sizes() {
    const EffectSet& members = s_.chosen.effects;
    if (!holds(members, Effect::coulomb_friction) || !holds(members, Effect::force_offset)) return;
    Hypothesis one = s_.chosen;
    one.effects = with(without(without(members, Effect::coulomb_friction), Effect::force_offset),
                       Effect::asymmetric_friction);
    one.unknowns = unknowns_of(trainer_.model, one.effects);
    const auto n = static_cast<Eigen::Index>(one.unknowns.size());
    Eigen::MatrixXd words = Eigen::MatrixXd::Zero(n, n);  // the new values from the old ones
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index k = 0; k < n; ++k) {
        const identify::Unknown& now = one.unknowns[static_cast<std::size_t>(i)];
        const identify::Unknown& old = s_.chosen.unknowns[static_cast<std::size_t>(k)];
        if (!now.of_effect || now.effect != Effect::asymmetric_friction)
          words(i, k) = now.name == old.name ? 1.0 : 0.0;
        else if (old.of_effect && old.effect == Effect::coulomb_friction)
          words(i, k) = 1.0;
        else if (old.of_effect && old.effect == Effect::force_offset)
          words(i, k) = now.parameter == 0 ? -1.0 : 1.0;
      }
    Eigen::Map<Eigen::VectorXd>(one.fit.values.data(), n) =
        words * Eigen::Map<const Eigen::VectorXd>(s_.chosen.fit.values.data(), n);
    one.fit.covariance = words * s_.chosen.fit.covariance * words.transpose();
    const Eigen::MatrixXd back = linear::inverse(words);
    for (identify::WindowShare& share : one.fit.shares) {
      share.information = back.transpose() * share.information * back;
      share.gradient = back.transpose() * share.gradient;
    }
    one.fit.at_bound.assign(one.unknowns.size(), false);
    one.fit.ranges.clear();
    one.fitted.effects.erase(Effect::coulomb_friction);
    one.fitted.effects.erase(Effect::force_offset);
    one.fitted = identify::with_values(one.fitted, one.unknowns, one.fit.values);
    for (Effect e : {Effect::coulomb_friction, Effect::force_offset}) s_.equals.push_back({e, one});
  }

  /// A log's rows may hold the state after their input has acted: then they are early by one, and a position that is early by less is
  /// late, as by a lag of the drive (of which neither a contact switch nor the drive's report tells).
  void add_drive_behind_early_rows() {
    constexpr double kAWholeRow = 0.9, kMostOfIt = 0.5;
    const EffectSet& members = s_.chosen.effects;
    if (!holds(members, Effect::time_skew) || holds(members, Effect::actuator_delay) ||
        holds(members, Effect::actuator_lag) ||
        dynamics::has(trainer_.model.kind, dynamics::LocationType::leg) ||
        judged_on(Effect::actuator_lag, trainer_.recordings) != identify::Channel::motion)
      return;
    const double row_s = trainer_.row_s(), early_s = -s_.chosen.fitted.effects.at(Effect::time_skew)[0];
    if (early_s <= 0.0 || early_s > kAWholeRow * row_s) return;
    Hypothesis whole_row = s_.chosen;
    whole_row.fitted.effects.at(Effect::time_skew)[0] = -row_s;
    const Hypothesis lagging = fit_if_it_runs(with(members, Effect::actuator_lag), whole_row,
                                              {{Effect::actuator_lag, {row_s - early_s}}});
    if (!lagging.failed && lagging.meaningful &&
        lagging.fitted.effects.at(Effect::actuator_lag)[0] > kMostOfIt * (row_s - early_s)) {
      acted(Rule::early_rows);
      s_.equals.push_back({Effect::time_skew, lagging});
    }
  }

  EffectSet missing_of(const EffectSet& effects) const {
    EffectSet missing;
    for (Effect e : s_.chosen.effects)
      if (!holds(effects, e)) missing.push_back(e);
    return missing;
  }
  EffectSet added_by(const EffectSet& effects) const {
    EffectSet added;
    for (Effect e : effects)
      if (!holds(s_.chosen.effects, e)) added.push_back(e);
    return added;
  }

  /// The members of the chosen set that `effects` has not, if it stands in their place: one, with no more
  /// parameters, or as many as one law has under another name.
  EffectSet replaced_by(const EffectSet& effects) const {
    const EffectSet missing = missing_of(effects);
    const bool one = missing.size() == 1 && effects.size() >= s_.chosen.effects.size();
    if (parameters_of(effects) > parameters_of(s_.chosen.effects) ||
        (!one && !always_same(trainer_.model, effects, s_.chosen.effects)))
      return {};
    return missing;
  }

  /// A set with another effect, or two, in the place of one member.
  struct Replacement {
    Effect of;
    EffectSet effects;
    const Hypothesis* from;
    Starts starts;
  };

  void add_replacements(std::size_t member, std::vector<Replacement>& all) const {
    const Effect e = s_.chosen.effects[member];
    const Hypothesis& on = s_.without[member];
    const std::size_t size = dynamics::info(e).parameter_count;
    EffectSet usable;
    for (Effect a : all_)
      if (!holds(s_.chosen.effects, a) && dynamics::info(a).parameter_count <= size) usable.push_back(a);
    const double lost = on.fit.squares - s_.chosen.fit.squares;
    std::size_t singles = 0;
    std::vector<Proposal> parts;
    for (const Proposal& p : propose(on, usable, 0.85, 0.1)) {
      const bool goes_some_way = p.gain * on.fit.squares > 0.5 * lost;
      if (twins(e, p.effect))  // the others stay what they are
        all.push_back({e,
                       with(on.effects, p.effect),
                       &s_.chosen,
                       {{p.effect, in_other_words(s_.chosen.fitted, e, p.effect).value_or(p.values)}}});
      else if (goes_some_way && singles++ < kMostRivals)
        all.push_back({e, with(on.effects, p.effect), &on, {{p.effect, p.values}}});
      if (dynamics::info(p.effect).parameter_count < size && parts.size() < kMostParts) parts.push_back(p);
    }
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t k = i + 1; k < parts.size(); ++k) {
        const Effect a = parts[i].effect, b = parts[k].effect;
        if (!contains(a, b) && !contains(b, a) && parameters_of({a, b}) == size)
          all.push_back({e, with(with(on.effects, a), b), &on, {{a, parts[i].values}, {b, parts[k].values}}});
      }
  }

  /// The chosen set under its other names, whatever was promised of those.
  void add_other_names(std::vector<Replacement>& all) const {
    for (const EffectSet& effects : in_other_names(trainer_.model, s_.chosen.effects, all_)) {
      if (std::any_of(all.begin(), all.end(), [&](const Replacement& r) { return r.effects == effects; }))
        continue;
      // A friction of two sizes is a friction and a constant force.
      Starts starts;
      const auto& now = s_.chosen.fitted.effects;
      if (holds(effects, Effect::asymmetric_friction) && !now.contains(Effect::asymmetric_friction)) {
        const double friction = now.at(Effect::coulomb_friction)[0];
        const auto pull = now.find(Effect::force_offset);
        const double offset = pull == now.end() ? 0.0 : pull->second[0];
        starts[Effect::asymmetric_friction] = {friction - offset, friction + offset};
      } else if (const auto two = now.find(Effect::asymmetric_friction);
                 two != now.end() && !holds(effects, Effect::asymmetric_friction)) {
        const auto [up, down, none] = two->second;
        starts[Effect::coulomb_friction] = {std::max(0.0, 0.5 * (up + down))};
        starts[Effect::force_offset] = {0.5 * (down - up)};
      }
      if (const EffectSet gone = missing_of(effects), come = added_by(effects);
          starts.empty() && gone.size() == 1 && come.size() == 1) {
        Hypothesis bare = s_.chosen;  // the others stay what they are
        bare.effects = without(bare.effects, gone.front());
        bare.fitted.effects.erase(gone.front());
        starts[come.front()] =
            proposer_.best(bare, effects, come.front(), proposer_.squares_left(bare)).values;
      }
      all.push_back({s_.chosen.effects.front(), effects, &s_.chosen, starts});
    }
  }

  /// Twice the logarithm of the likelihood ratio of a set over the chosen one: of the motion under random forces, of other channels by the
  /// residuals that count as independent, where these scatter no more than those would.
  double evidence_for(const Hypothesis& h, const std::optional<double>& of_motion) const {
    if (!of_motion) return trainer_.evidence_over(s_.chosen, h) / misfit_;
    return *of_motion +
           evidence_of(s_.chosen.fit, h.fit, s_.chosen.fit, trainer_.training.layers, false) / misfit_;
  }
  std::optional<double> of_motion(const Hypothesis& h) const {
    return disturbed_ ? disturbed_(h.fitted) : std::nullopt;
  }
  /// Twice the logarithm of the odds for a set against the chosen one, as the confidence of a name has them (posterior.hpp).
  double odds_for(const Hypothesis& h, const std::optional<double>& of_motion) const {
    return evidence_for(h, of_motion) + trainer_.prior(h.effects) - trainer_.prior(s_.chosen.effects);
  }
  double odds_for(const Hypothesis& h) const { return odds_for(h, of_motion(h)); }
  /// What is known of the recordings once a set is chosen.
  void weigh_by_chosen() {
    misfit_ = overdispersion(s_.chosen.fit, units_of(trainer_.training.windows));
    disturbed_ = {};
    const bool slips = std::any_of(trainer_.recordings.begin(), trainer_.recordings.end(),
                                   [](const identify::Recording& r) { return !r.slips.empty(); });
    if (slips) return;
    std::vector<identify::Window> apart;  // of overlapping ones
    for (const identify::Window& w : trainer_.training.windows)
      if (apart.empty() || apart.back().recording != w.recording || w.first >= apart.back().last)
        apart.push_back(w);
    disturbed_ = evidence_under_disturbances(s_.chosen.fitted, trainer_.recordings, apart);
  }
  bool as_good(const Hypothesis& h) const {
    const std::optional<double> motion = of_motion(h);
    return the_same(h, s_.chosen) || odds_for(h, motion) > -kEqualEvidence ||
           (!motion && trainer_.preference(h, s_.chosen) < kEqualEvidence);
  }

  /// Sets with as many parameters that explain as much as the chosen one, with another effect (or two) in the
  /// place of each member.
  std::vector<Selection::Rival> rivals() {
    std::vector<Replacement> replacements;
    for (std::size_t m = 0; m < s_.chosen.effects.size(); ++m) add_replacements(m, replacements);
    std::erase_if(replacements, [&](const Replacement& r) { return names_twice(trainer_.model, r.effects); });
    const std::size_t in_place_of_one = replacements.size();
    add_other_names(replacements);
    std::vector<Hypothesis> fitted(replacements.size());
    core::parallel_for(replacements.size(), trainer_.threads, [&](std::size_t i) {
      const Replacement& r = replacements[i];
      tell(0.95, names(r.effects));
      if (r.starts.size() == 1) {
        const Proposal start{r.starts.begin()->first, r.starts.begin()->second, {}, 0.0};
        const auto from = [&](const Hypothesis& others) {
          return fit_new(trainer_, r.effects, others, start);
        };
        fitted[i] = from(*r.from);
        // Without the member the others may have run to where no fit finds back.
        if (r.from != &s_.chosen && (fitted[i].failed || !as_good(fitted[i])))
          if (Hypothesis other = from(s_.chosen);
              !other.failed && (fitted[i].failed || other.fit.squares < fitted[i].fit.squares))
            fitted[i] = std::move(other);
        return;
      }
      fitted[i] = fit_if_it_runs(r.effects, *r.from, r.starts);
    });
    std::vector<Selection::Rival> equals;
    const auto add = [&](Effect of, const Hypothesis& h) {
      if (h.failed || !h.meaningful) return;
      const bool known = std::any_of(equals.begin(), equals.end(), [&](const Selection::Rival& r) {
        return r.of == of && r.hypothesis.effects == h.effects;
      });
      if (!known && as_good(h)) equals.push_back({of, h});
    };
    for (const Hypothesis& h : fitted) remember(h);
    for (std::size_t i = 0; i < in_place_of_one; ++i) add(replacements[i].of, fitted[i]);
    // A fit that started elsewhere may have gone further.
    for (const auto& [effects, h] : pool_)
      for (const Effect of : replaced_by(effects)) add(of, h);
    return equals;
  }

  Trainer trainer_;
  Proposer proposer_;
  const Progress& progress_;
  const WithoutRules& off_;
  EffectSet all_;
  std::vector<Proposal> first_screenings_;  ///< on top of the re-fitted model
  std::map<EffectSet, Hypothesis> pool_;    ///< all sets that were fitted
  Selection s_;
  double misfit_ = 1.0;    ///< overdispersion with the chosen set
  EvidenceFor disturbed_;  ///< over the chosen set
};

}  // namespace

Selection select(const model::Model& model, const std::vector<identify::Recording>& recordings,
                 const identify::TrainingWindows& training, unsigned threads, const Progress& progress,
                 const WithoutRules& without) {
  return Search(model, recordings, training, threads, progress, without).run();
}

}  // namespace furcula::diagnose
