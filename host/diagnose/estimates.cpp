#include "host/diagnose/estimates.hpp"

#include <utility>

#include "host/identify/verdicts.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

/// For each unknown of an effect.
template <class Visit>
void visit_estimates(const Hypothesis& h, const Visit& visit) {
  const auto verdicts =
      identify::parameter_verdicts(identify::in_law_parameters(h.fit, h.unknowns, h.fitted), h.unknowns);
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect)
      visit(h.unknowns[i], Estimate{verdicts[i].value, verdicts[i].lower, verdicts[i].upper});
}

std::string own_name(const identify::Unknown& u, dynamics::Kind kind) {
  return std::string(name_on(dynamics::info(u.effect).parameter_table[u.parameter], kind));
}

}  // namespace

std::map<std::string, Estimate> parameters_of_effect(const Hypothesis& h, dynamics::Kind kind,
                                                     Effect effect) {
  std::map<std::string, Estimate> all;
  visit_estimates(h, [&](const identify::Unknown& u, const Estimate& e) {
    if (u.effect == effect) all[own_name(u, kind)] = e;
  });
  return all;
}

std::map<std::string, Estimate> parameters_of_effects(const Hypothesis& h) {
  std::map<std::string, Estimate> all;
  visit_estimates(h, [&](const identify::Unknown& u, const Estimate& e) { all[u.name] = e; });
  return all;
}

bool not_held(const Hypothesis& h, dynamics::Kind kind, Effect e) {
  if (e == Effect::leg_inertia) return false;  // one or two of three inertias may be none: they act alike
  const auto parameters = parameters_of_effect(h, kind, e);
  for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
    const auto& u = h.unknowns[i];
    if (!u.of_effect || u.effect != e) continue;
    const auto& p = parameters.at(own_name(u, kind));
    if (h.fit.at_bound[i] || (p.lower <= u.lower && p.upper >= u.upper)) return true;
  }
  return false;
}

std::vector<result::Parameter> parameter_rows(const model::Model& model, const Hypothesis& refitted,
                                              const Hypothesis& extended) {
  const auto table = dynamics::info(model.kind).parameters;
  const auto before = identify::parameter_verdicts(refitted.fit, refitted.unknowns);
  const auto after = identify::parameter_verdicts(
      identify::in_law_parameters(extended.fit, extended.unknowns, extended.fitted), extended.unknowns);
  std::vector<result::Parameter> all;
  for (std::size_t i = 0; i < table.size(); ++i) {
    result::Parameter row;
    row.name = table[i].name;
    row.unit = table[i].unit;
    row.meaning = table[i].meaning;
    row.free = false;
    row.baseline = model.parameters[i];
    row.refitted = row.extended = {row.name, row.unit, row.baseline, row.baseline, row.baseline};
    for (std::size_t k = 0; k < refitted.unknowns.size(); ++k) {
      if (refitted.unknowns[k].parameter != i) continue;
      row.free = true;
      row.refitted = {row.name, row.unit, before[k].value, before[k].lower, before[k].upper};
      row.extended = {row.name, row.unit, after[k].value, after[k].lower, after[k].upper};
      row.verdict = after[k].verdict;
      if (after[k].verdict == "correlated") row.verdict += " with " + after[k].with;
      if (after[k].verdict == "at_bound") row.verdict += " (" + after[k].with + ")";
    }
    all.push_back(std::move(row));
  }
  return all;
}

std::vector<std::string> names_of(const std::vector<Effect>& effects) {
  std::vector<std::string> all;
  for (Effect e : effects) all.emplace_back(dynamics::info(e).name);
  return all;
}

}  // namespace furcula::diagnose
