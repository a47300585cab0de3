// Identification of a tree, see identify.hpp.
#include "host/trees/identify.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/result/json.hpp"
#include "host/trees/conventions.hpp"
#include "host/trees/reported.hpp"
#include "host/trees/result.hpp"

namespace furcula::trees {
namespace {

/// Rounds of weighing and fitting; where bodies are fitted, until the loss hardly falls any more.
constexpr int kRounds = 2, kMostRounds = 8;
constexpr double kSettled = 0.01;

}  // namespace

Identification identify(const TreeModel& model, const std::vector<log::Log>& training,
                        const std::vector<log::Log>& held_out_logs, const Options& options) {
  if (model.free.empty() && model.free_bodies.empty())
    throw core::DataError(
        model.file +
        ": no parameter in [free], so there is nothing to identify; expected at least one, as in [free] \"damping_nmspr." +
        model.robot.joints.front().name + "\" = [lower, upper]");
  std::vector<Recording> fit_on, judge_on;
  for (const log::Log& log : training) fit_on.push_back(recording_of(model, log));
  for (const log::Log& log : held_out_logs) judge_on.push_back(recording_of(model, log));
  if (!options.trust_columns) require_conventions(model, fit_on, options.window_s);
  share_lateness(fit_on, judge_on);
  Identification out;
  for (const auto* recordings : {&fit_on, &judge_on})
    for (const Recording& r : *recordings) add_data_quality(out.data_quality, r);
  out.model = model;
  out.logs = training.size() + held_out_logs.size();
  out.held_out_logs = held_out_logs.size();
  std::vector<Window> windows = windows_of(model, fit_on, options.window_s);
  out.windows = windows.size();
  if (windows_of(model, judge_on, options.window_s, 1).empty())
    throw core::DataError("no held-out log has " + core::shortest(options.window_s) +
                          " s without a gap; expected longer logs, or a smaller --window-s");
  Problem problem(model, fit_on, std::move(windows), options.threads);
  const Hypothesis given{model.drives, model.causes};
  if (options.progress) options.progress(0.1, "fitting");
  problem.weigh(given);
  Fit fit = problem.fit(given, 10);
  // The weights are of residuals: of those at the model given first, then of those that are left.
  for (int round = 0; round < (model.free_bodies.empty() ? kRounds : kMostRounds); ++round) {
    if (options.progress) options.progress(std::min(0.4 + 0.25 * round, 0.9), "fitting again");
    problem.weigh(fit.at);
    const Fit before = problem.fit(fit.at, 0);
    fit = problem.fit(fit.at, 6, &before);
    if (round + 1 >= kRounds && fit.loss > (1.0 - kSettled) * before.loss) break;
  }
  const Reported all = reported(model, fit);
  out.covariance = all.covariance;
  for (std::size_t k = 0; k < all.rows.size(); ++k) {
    const Reported::Row& r = all.rows[k];
    const Unknown& u = fit.unknowns[r.unknown];
    const auto i = static_cast<Eigen::Index>(k);
    Identification::Row row{r.name, r.unit, {}, {}, r.given, r.value, 0.0, 0.0, r.folds};
    const double half = 1.96 * std::sqrt(all.covariance(i, i));
    row.lower = row.value - half;
    row.upper = row.value + half;
    const ParameterVerdict verdict = parameter_verdict(model, all, k, problem.scales().still);
    row.verdict = verdict.verdict;
    row.with = verdict.with;
    if (r.link) {
      const Interval within = interval_of(fit, all, k);
      row.lower = within.lower;
      row.upper = within.upper;
    } else if (2.0 * half > 0.5 * (u.upper - u.lower) || problem.scales().still[u.joint]) {
      row.verdict = "not_excited";
    }
    // Of a body the mass alone has bounds.
    if (fit.at_bound[r.unknown] && (!r.link || r.part == 0)) {
      row.verdict = "at_bound";
      const double at = value_of(fit.at, u);
      row.with = at - u.lower < u.upper - at ? "lower" : "upper";
    }
    out.parameters.push_back(std::move(row));
  }
  if (options.progress) options.progress(0.95, "predicting the held-out logs");
  out.as_given_error = predict(model, judge_on, options.window_s, given).errors;
  out.identified_error = predict(model, judge_on, options.window_s, fit.at).errors;
  out.model.drives = fit.at.drives;
  out.bodies = fit.at.bodies;
  return out;
}

std::string to_json_text(const Identification& found) {
  using result::Json, result::number;
  Json parameters = Json::object();
  for (const auto& p : found.parameters) {
    Json folds = Json::array();
    for (const double f : p.folds) folds.push_back(number(f));
    parameters[p.name] = {{"value", number(p.value)},
                          {"ci95", {number(p.lower), number(p.upper)}},
                          {"folds", folds},
                          {"verdict", p.verdict}};
    parameters[p.name]["unit"] = p.unit;
    parameters[p.name]["given"] = number(p.given);
    if (!p.with.empty()) parameters[p.name][p.verdict == "at_bound" ? "bound" : "correlated_with"] = p.with;
  }
  Json data = {{"logs", found.logs}, {"held_out_logs", found.held_out_logs}, {"windows", found.windows}};
  result::add_data_quality(data, found.data_quality);
  Json out = {{"schema", "furcula-identification/2"},
              {"kind", "tree"},
              {"method", "simulation"},
              {"data", data},
              {"parameters", parameters},
              {"as_given", result::errors_json(channel_errors(found.model, found.as_given_error))},
              {"held_out", result::errors_json(channel_errors(found.model, found.identified_error))}};
  out["notes"] = found.notes;
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace furcula::trees
