#include "host/trees/parameter_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "host/trees/base_parameters.hpp"
#include "host/trees/findings.hpp"
#include "host/trees/reported.hpp"

namespace furcula::trees {
namespace {

/// A drive that gives less than this of what moves its joint gives nothing.
constexpr double kDriven = 0.02;

/// Both fits have the same rows of bodies.
void add_bodies(DiagnosisState& s, const Problem& problem, const Found& found) {
  if (s.model.free_bodies.empty()) return;
  const Reported before = reported(s.model, found.refitted), after = reported(s.model, found.fit);
  for (std::size_t i = 0; i < after.rows.size(); ++i) {
    const Reported::Row& r = after.rows[i];
    if (!r.link) continue;
    const auto same = std::find_if(before.rows.begin(), before.rows.end(),
                                   [&](const Reported::Row& b) { return b.name == r.name; });
    const auto estimate = [](const Fit& fit, const Reported& all, std::size_t row) {
      const Interval within = interval_of(fit, all, row);
      return Estimate{all.rows[row].name, all.rows[row].unit, all.rows[row].value, within.lower,
                      within.upper};
    };
    result::Parameter row;
    row.name = r.name;
    row.unit = r.unit;
    row.baseline = r.given;
    row.extended = estimate(found.fit, after, i);
    row.refitted = estimate(found.refitted, before, static_cast<std::size_t>(same - before.rows.begin()));
    row.verdict = r.part == 0 && found.fit.at_bound[r.unknown]
                      ? "at_bound"
                      : parameter_verdict(s.model, after, i, problem.scales().still).verdict;
    s.d.parameters.push_back(std::move(row));
  }
}

}  // namespace

void set_parameters(DiagnosisState& s, const Problem& problem, const Found& found) {
  for (std::size_t k = 0; k < found.fit.unknowns.size(); ++k) {
    const Unknown& u = found.fit.unknowns[k];
    if (u.of_cause || u.of_body || u.of_inputs) continue;
    const std::string name =
        std::string(kDriveParameters[u.parameter]) + "." + s.model.robot.joints[u.joint].name;
    const std::string unit((s.model.prismatic(u.joint) ? kLinearDriveUnits : kDriveUnits)[u.parameter]);
    result::Parameter row;
    row.name = name;
    row.unit = unit;
    row.baseline = value_of(Hypothesis{s.model.drives, {}}, u);
    row.extended = interval(name, unit, found.fit, k);
    row.refitted = row.extended;
    for (std::size_t i = 0; i < found.refitted.unknowns.size(); ++i) {
      const Unknown& v = found.refitted.unknowns[i];
      if (!v.of_cause && !v.of_body && !v.of_inputs && v.joint == u.joint && v.parameter == u.parameter)
        row.refitted = interval(name, unit, found.refitted, i);
    }
    const double width = row.extended.upper - row.extended.lower;
    row.verdict = found.fit.at_bound[k]                                                  ? "at_bound"
                  : width > 0.5 * (u.upper - u.lower) || problem.scales().still[u.joint] ? "not_excited"
                                                                                         : "identified";
    s.d.parameters.push_back(row);
  }
  add_bodies(s, problem, found);
}

void set_base_parameters(DiagnosisState& s, const Problem& problem) {
  const Scales& scales = problem.scales();
  s.d.base_parameters = base_parameters(s.model, s.d.extended, s.after, scales.torque_nm);
  bool driven = false;
  for (std::size_t j = 0; j < s.model.joints(); ++j)
    driven |= scales.drive_nm[j] > kDriven * scales.torque_nm[j];
  if (!driven)
    for (BaseParameter& b : s.d.base_parameters) b.shown = false;
  const auto shown = std::count_if(s.d.base_parameters.begin(), s.d.base_parameters.end(),
                                   [](const BaseParameter& b) { return b.shown; });
  s.d.notes.push_back("Of the bodies' " + std::to_string(kInertialParameters * s.model.joints()) +
                      " inertial parameters the joints' torques depend on " +
                      std::to_string(s.d.base_parameters.size()) + " combinations; these recordings show " +
                      std::to_string(shown) + " of them.");
  if (!driven)
    s.d.notes.push_back(
        "No drive acts in them: twice all inertias, with twice all that is named, would move alike. Sizes are for the inertias given.");
}

}  // namespace furcula::trees
