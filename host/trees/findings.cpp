#include "host/trees/findings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/trees/reported.hpp"
#include "host/trees/result.hpp"

namespace furcula::trees {
namespace {

/// Drives that are all late, and angles that are late in the log.
bool one_law(const TreeModel& model, const Cause& a, const Cause& b) {
  const auto all_late = [&](const Cause& c) {
    return c.effect == Effect::actuator_delay && c.sites.size() == model.joints();
  };
  return (all_late(a) && b.effect == Effect::time_skew && b.values[0] > 0.0) ||
         (all_late(b) && a.effect == Effect::time_skew);
}

std::vector<Estimate> estimates(const TreeModel& model, const Fit& fit, std::size_t cause) {
  std::vector<Estimate> out;
  const Cause& c = fit.at.causes[cause];
  const EffectInfo& e = info(c.effect);
  const bool linear = is_linear(model, e.location_type, c.sites.front());
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    if (!u.of_cause || u.cause != cause) continue;
    const Parameter& p = e.parameters()[u.parameter];
    out.push_back(interval(std::string(name_on(p, linear)), std::string(unit_on(p, linear)), fit, k));
  }
  return out;
}

/// Whether its parameters are within their scatter, taken together, of values with which the cause is not there.
bool covers_none(const TreeModel& model, const Fit& fit, std::size_t cause) {
  const Away away = away_from_none(model, fit, cause);
  return away.parameters > 0 &&
         away.squares < core::chi_square_above(0.05, static_cast<double>(away.parameters));
}

/// Over joints, each by its own motion.
double total(const std::vector<ChannelError>& e) {
  double sum = 0.0;
  for (const ChannelError& c : e) sum += c.nmse;
  return sum;
}

}  // namespace

bool undecided(const Finding& f) {
  return std::any_of(f.indistinguishable_from.begin(), f.indistinguishable_from.end(),
                     [](const result::Rival& r) { return !r.same_law; });
}

void limit(Finding& f, double most, std::string why) {
  if (!(f.confidence > most)) return;
  f.confidence = most;
  f.lowered_by.push_back(std::move(why));
}

Estimate interval(const std::string& name, const std::string& unit, const Fit& fit, std::size_t unknown) {
  const Interval within = interval_of(fit, unknown);
  return {name, unit, value_of(fit.at, fit.unknowns[unknown]), within.lower, within.upper};
}

void add_findings(DiagnosisState& s, Problem& problem, const Found& found) {
  const std::size_t given = s.model.causes.size();
  double explainable = 0.0;
  for (const double g : found.gain) explainable += g;
  for (std::size_t c = given; c < found.fit.at.causes.size(); ++c) {
    const Cause& cause = found.fit.at.causes[c];
    const EffectInfo& e = info(cause.effect);
    Finding f;
    f.cause = cause;
    for (const std::size_t site : cause.sites) f.at.push_back(site_name(s.model, e.location_type, site));
    f.parameters = estimates(s.model, found.fit, c);
    f.explainable_removed = explainable > 0.0 ? found.gain[c - given] / explainable : 0.0;
    const Fit off = problem.fit(without(found.fit.at, c), 4, &found.fit);
    f.without = predict(s.model, s.held_out, s.options.window_s, off.at).errors;
    double others = 0.0;  // their odds
    for (const Rival& r : found.rivals[c - given]) {
      result::Rival text;
      text.causes = {named(s.model, r.causes.front())};
      const EffectInfo& other = info(r.causes.front().effect);
      for (std::size_t k = 0; k < other.parameter_count; ++k) {
        const bool linear = is_linear(s.model, other.location_type, r.causes.front().sites.front());
        text.causes.front().parameters.push_back({std::string(name_on(other.parameters()[k], linear)),
                                                  std::string(unit_on(other.parameters()[k], linear)),
                                                  r.causes.front().values[k], NAN, NAN});
      }
      if (one_law(s.model, cause, r.causes.front())) {
        text.same_law = true;
        text.reason = "the same law under another name: no recording tells them apart";
        f.indistinguishable_from.push_back(text);
        continue;
      }
      others += std::exp(-r.log_odds);
      text.reason =
          "in its place and fitted, the training recordings are less likely by a factor of " +
          (r.log_odds < std::log(1e6) ? core::rounded(std::exp(r.log_odds), 2) : "a million or more");
      if (r.stands()) s.undecided.push_back(r.at);
      (r.stands() ? f.indistinguishable_from : f.alternatives).push_back(text);
    }
    f.confidence = std::min(0.99, 1.0 / (1.0 + others));
    if (f.confidence < kClear)
      f.lowered_by.push_back("another cause in its place fits the training recordings nearly as well");
    if (undecided(f)) limit(f, 0.5, "another cause explains the training recordings as well");
    // A value that a fit wanted beyond what there can be stands for something else.
    for (std::size_t k = 0; k < found.fit.unknowns.size(); ++k)
      if (found.fit.unknowns[k].of_cause && found.fit.unknowns[k].cause == c && found.fit.at_bound[k]) {
        limit(f, 0.3, "one of its values is at a bound");
        s.at_bound = true;
      }
    if (covers_none(s.model, found.fit, c))
      limit(f, 0.4, "the interval of its size holds the value at which there is nothing");
    if (total(f.without) < total(s.d.extended_error))
      limit(f, 0.4, "the held-out recordings are predicted worse with it than without it");
    f.explanation = std::string(e.explanation);
    f.where_to_look = std::string(e.where_to_look);
    f.next_experiment = std::string(e.experiment);
    s.d.findings.push_back(std::move(f));
  }
  std::stable_sort(s.d.findings.begin(), s.d.findings.end(),
                   [&](const Finding& a, const Finding& b) { return total(a.without) > total(b.without); });
}

}  // namespace furcula::trees
