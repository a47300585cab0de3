// Identification of a tree, see identify.hpp.
#include "host/trees/identify.hpp"

#include <cmath>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/trees/json.hpp"

namespace furcula::trees {
Identification identify(const TreeModel& model, const std::vector<log::Log>& training,
                        const std::vector<log::Log>& held_out_logs, const Options& options) {
  if (model.free.empty())
    throw core::DataError(
        model.file +
        ": no parameter in [free], so there is nothing to identify; expected at least one, as in [free] \"damping_nmspr." +
        model.robot.joints.front().name + "\" = [lower, upper]");
  std::vector<Recording> fit_on, judge_on;
  for (const log::Log& log : training) fit_on.push_back(recording_of(model, log));
  for (const log::Log& log : held_out_logs) judge_on.push_back(recording_of(model, log));
  Identification out;
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
  for (int round = 0; round < 2; ++round) {
    if (options.progress) options.progress(0.4 + 0.25 * round, "fitting again");
    problem.weigh(fit.at);
    fit = problem.fit(fit.at, 6);
  }
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    if (u.of_cause) continue;
    const auto i = static_cast<Eigen::Index>(k);
    Identification::Row row;
    row.name = std::string(kDriveParameters[u.parameter]) + "." + model.robot.joints[u.joint].name;
    row.unit = (model.prismatic(u.joint) ? kLinearDriveUnits : kDriveUnits)[u.parameter];
    row.given = value_of(given, u);
    row.value = value_of(fit.at, u);
    const double half = 1.96 * std::sqrt(fit.covariance(i, i));
    row.lower = row.value - half;
    row.upper = row.value + half;
    row.folds = fit.fold_value[k];
    row.verdict = "identified";
    double most = 0.0;
    for (std::size_t o = 0; o < fit.unknowns.size(); ++o) {
      const auto j = static_cast<Eigen::Index>(o);
      if (o == k || fit.unknowns[o].of_cause || !(fit.covariance(i, i) * fit.covariance(j, j) > 0.0))
        continue;
      const double c =
          std::abs(fit.covariance(i, j)) / std::sqrt(fit.covariance(i, i) * fit.covariance(j, j));
      if (c > most) {
        most = c;
        row.with = std::string(kDriveParameters[fit.unknowns[o].parameter]) + "." +
                   model.robot.joints[fit.unknowns[o].joint].name;
      }
    }
    if (most > 0.95)
      row.verdict = "correlated";
    else
      row.with.clear();
    if (2.0 * half > 0.5 * (u.upper - u.lower) || problem.scales().still[u.joint])
      row.verdict = "not_excited";
    if (fit.at_bound[k]) {
      row.verdict = "at_bound";
      row.with = row.value - u.lower < u.upper - row.value ? "lower" : "upper";
    }
    out.parameters.push_back(std::move(row));
  }
  if (options.progress) options.progress(0.95, "predicting the held-out logs");
  out.as_given_error = predict(model, judge_on, options.window_s, given, fit.at).errors;
  out.identified_error = predict(model, judge_on, options.window_s, fit.at, fit.at).errors;
  out.model.drives = fit.at.drives;
  return out;
}

std::string to_json_text(const Identification& found) {
  Json parameters = Json::object();
  for (const auto& p : found.parameters) {
    Json folds = Json::array();
    for (const double f : p.folds) folds.push_back(number(f));
    parameters[p.name] = {{"value", number(p.value)},
                          {"ci95", {number(p.lower), number(p.upper)}},
                          {"folds", folds},
                          {"verdict", p.verdict}};
    if (!p.with.empty()) parameters[p.name]["with"] = p.with;
    parameters[p.name]["unit"] = p.unit;
  }
  const Json out = {
      {"schema", "furcula-identification/1"},
      {"method", "simulation"},
      {"kind", "tree"},
      {"data", {{"logs", found.logs}, {"held_out_logs", found.held_out_logs}, {"windows", found.windows}}},
      {"parameters", parameters},
      {"as_given", {{"held_out", held_out(found.model, found.as_given_error)}}},
      {"held_out", held_out(found.model, found.identified_error)}};
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace furcula::trees
