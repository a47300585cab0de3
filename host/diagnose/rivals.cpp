#include "host/diagnose/rivals.hpp"

#include <algorithm>
#include <utility>

#include "host/core/parallel.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/wording.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr std::size_t kMostRivals = 4;  // that are fitted in the place of each member
constexpr std::size_t kMostParts = 5;   // effects that pairs in the place of a member are made of

/// Those of `effects` that `others` has not.
EffectSet beyond(const EffectSet& effects, const EffectSet& others) {
  EffectSet all;
  for (Effect e : effects)
    if (!holds(others, e)) all.push_back(e);
  return all;
}

/// The members of the chosen set that `effects` has not, if it stands in their place: one, with no more
/// parameters, or as many as one law has under another name.
EffectSet replaced_by(const SearchState& s, const EffectSet& effects) {
  const EffectSet missing = beyond(s.chosen.effects, effects);
  const bool one = missing.size() == 1 && effects.size() >= s.chosen.effects.size();
  if (parameters_of(effects) > parameters_of(s.chosen.effects) ||
      (!one && !always_same(s.model(), effects, s.chosen.effects)))
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

void add_replacements(const SearchState& s, std::size_t member, std::vector<Replacement>& all) {
  const Effect e = s.chosen.effects[member];
  const Hypothesis& on = s.without[member];
  const std::size_t size = dynamics::info(e).parameter_count;
  EffectSet usable;
  for (Effect a : s.all)
    if (!holds(s.chosen.effects, a) && dynamics::info(a).parameter_count <= size) usable.push_back(a);
  const double lost = on.fit.squares - s.chosen.fit.squares;
  std::size_t singles = 0;
  std::vector<Proposal> parts;
  for (const Proposal& p : s.propose(on, usable, 0.85, 0.1)) {
    const bool goes_some_way = p.gain * on.fit.squares > 0.5 * lost;
    if (twins(e, p.effect))  // the others stay what they are
      all.push_back({e,
                     with(on.effects, p.effect),
                     &s.chosen,
                     {{p.effect, in_other_words(s.chosen.fitted, e, p.effect).value_or(p.values)}}});
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
void add_other_names(const SearchState& s, std::vector<Replacement>& all) {
  for (const EffectSet& effects : in_other_names(s.model(), s.chosen.effects, s.all)) {
    if (std::any_of(all.begin(), all.end(), [&](const Replacement& r) { return r.effects == effects; }))
      continue;
    // A friction of two sizes is a friction and a constant force.
    Starts starts;
    const auto& now = s.chosen.fitted.effects;
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
    if (const EffectSet gone = beyond(s.chosen.effects, effects), come = beyond(effects, s.chosen.effects);
        starts.empty() && gone.size() == 1 && come.size() == 1) {
      Hypothesis bare = s.chosen;  // the others stay what they are
      bare.effects = without(bare.effects, gone.front());
      bare.fitted.effects.erase(gone.front());
      starts[come.front()] =
          s.proposer.best(bare, effects, come.front(), s.proposer.squares_left(bare)).values;
    }
    all.push_back({s.chosen.effects.front(), effects, &s.chosen, starts});
  }
}

}  // namespace

std::vector<Selection::Rival> rivals(SearchState& s, const Weighing& w) {
  std::vector<Replacement> replacements;
  for (std::size_t m = 0; m < s.chosen.effects.size(); ++m) add_replacements(s, m, replacements);
  std::erase_if(replacements, [&](const Replacement& r) { return names_twice(s.model(), r.effects); });
  const std::size_t in_place_of_one = replacements.size();
  add_other_names(s, replacements);
  std::vector<Hypothesis> fitted(replacements.size());
  core::parallel_for(replacements.size(), s.trainer.threads, [&](std::size_t i) {
    const Replacement& r = replacements[i];
    s.tell(0.95, names(r.effects));
    if (r.starts.size() == 1) {
      const Proposal start{r.starts.begin()->first, r.starts.begin()->second, {}, 0.0};
      const auto from = [&](const Hypothesis& others) {
        return fit_new(s.trainer, r.effects, others, start);
      };
      fitted[i] = from(*r.from);
      // Without the member the others may have run to where no fit finds back.
      if (r.from != &s.chosen && (fitted[i].failed || !w.as_good(fitted[i])))
        if (Hypothesis other = from(s.chosen);
            !other.failed && (fitted[i].failed || other.fit.squares < fitted[i].fit.squares))
          fitted[i] = std::move(other);
      return;
    }
    fitted[i] = s.trainer.fit_if_it_runs(r.effects, *r.from, r.starts);
  });
  std::vector<Selection::Rival> equals;
  const auto add = [&](Effect of, const Hypothesis& h) {
    if (h.failed || !h.meaningful) return;
    const bool known = std::any_of(equals.begin(), equals.end(), [&](const Selection::Rival& r) {
      return r.of == of && r.hypothesis.effects == h.effects;
    });
    if (!known && w.as_good(h)) equals.push_back({of, h});
  };
  for (const Hypothesis& h : fitted) s.remember(h);
  for (std::size_t i = 0; i < in_place_of_one; ++i) add(replacements[i].of, fitted[i]);
  // A fit that started elsewhere may have gone further.
  for (const auto& [effects, h] : s.known)
    for (const Effect of : replaced_by(s, effects)) add(of, h);
  return equals;
}

}  // namespace furcula::diagnose
