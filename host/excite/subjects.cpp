// What recordings are to tell, see subjects.hpp.
#include "host/excite/subjects.hpp"

#include <algorithm>
#include <cmath>

#include "host/trees/candidates.hpp"

namespace furcula::excite {
namespace {

using trees::Effect;

bool is_excluded(const trees::Candidate& c) {
  switch (c.effect) {
    case Effect::torque_saturation:
    case Effect::binding_spot:
    case Effect::torque_ripple:
    case Effect::joint_elasticity:
      return true;
    default:
      return c.sites.size() > 1;
  }
}

Subject of_cause(const trees::TreeModel& m, const trees::Hypothesis& given, const trees::Candidate& c) {
  const trees::EffectInfo& e = trees::info(c.effect);
  Subject out{trees::cause_name(m, c.columns.front()), false, c.columns.front(), {}, 0};
  const bool linear = trees::is_linear(m, e.location_type, c.sites.front());
  for (std::size_t k = 0; k < c.columns.size(); ++k) {
    // The parameter that this column moves.
    std::size_t moved = 0;
    double size = 0.0;
    for (std::size_t i = 0; i < e.parameter_count; ++i) {
      const double none = trees::neutral_value(m, c.effect, i, c.sites.front());
      if (std::isnan(none) || std::abs(c.columns[k].values[i] - none) <= std::abs(size)) continue;
      // Of a gain error's second column both gains are there, the first as it is.
      moved = i;
      size = c.columns[k].values[i] - none;
    }
    const trees::Parameter& p = e.parameters()[moved];
    out.numbers.push_back({std::string(trees::name_on(p, linear)), std::string(trees::unit_on(p, linear)),
                           std::abs(size), trees::with_column(given, c, k), std::abs(size)});
  }
  return out;
}

}  // namespace

std::vector<Subject> subjects(const trees::Problem& reference) {
  const trees::TreeModel& m = reference.model();
  const trees::Hypothesis given{m.drives, m.causes};
  std::vector<Subject> out;
  std::vector<trees::Unknown> unknowns = trees::unknowns_of(m, reference.scales(), given);
  for (const trees::Unknown& u : unknowns) {
    if (u.of_inputs) continue;
    const bool more = u.of_body && u.parameter > 0;
    if (!more)
      out.push_back(
          {u.of_body ? "inertial." + m.robot.links[u.link].name
                     : std::string(trees::kDriveParameters[u.parameter]) + "." + m.robot.joints[u.joint].name,
           true,
           {},
           {},
           0});
    // A small change: of bodies the columns are derivatives.
    const double value = trees::value_of(given, u), change = 1e-3 * u.scale,
                 to = !u.of_body && value + change > u.upper ? value - change : value + change;
    Subject::Number n{out.back().name, "", 0.0, given, change};
    n.size = u.of_body ? u.prior_sd : (u.upper - u.lower) / std::sqrt(12.0);
    if (!u.of_body)
      n.unit = (m.prismatic(u.joint) ? trees::kLinearDriveUnits : trees::kDriveUnits)[u.parameter];
    trees::set_value(n.changed, u, to);
    out.back().numbers.push_back(std::move(n));
  }
  for (const trees::Candidate& c : trees::candidates(reference, given, {})) {
    if (is_excluded(c)) continue;
    // Of a delay several sizes are tried, of a payload several places: the first of them.
    const bool again = std::any_of(out.begin(), out.end(), [&](const Subject& s) {
      return s.cause && s.cause->effect == c.effect && s.cause->sites == c.sites;
    });
    if (!again) out.push_back(of_cause(m, given, c));
  }
  Eigen::Index columns = 0;
  for (Subject& s : out) {
    s.first = columns;
    columns += s.columns();
  }
  return out;
}

Probes probes_of(const std::vector<Subject>& subjects) {
  Probes out;
  std::vector<double> scale;
  for (const Subject& s : subjects)
    for (const Subject::Number& n : s.numbers) {
      out.changed.push_back(n.changed);
      scale.push_back(n.size / n.change);
    }
  out.scale = Eigen::Map<const Eigen::VectorXd>(scale.data(), static_cast<Eigen::Index>(scale.size()));
  return out;
}

Eigen::MatrixXd information(const trees::TreeModel& model, const std::vector<Subject>& subjects,
                            const trees::Scenario& scenario, std::uint64_t seed, double window_s,
                            std::size_t every, std::size_t first) {
  const std::vector<trees::Recording> recording{
      trees::recording_of(model, trees::simulate(model, scenario, seed))};
  std::vector<trees::Window> windows;
  std::vector<trees::Window> all = trees::windows_of(model, recording, window_s);
  for (std::size_t i = first; i < all.size(); i += every) windows.push_back(std::move(all[i]));
  const double each = static_cast<double>(all.size()) / static_cast<double>(windows.size());
  trees::Problem problem(model, recording, std::move(windows), 1);
  const trees::Hypothesis given{model.drives, model.causes};
  problem.weigh(given);
  const auto [changed, scale] = probes_of(subjects);
  return each * scale.asDiagonal() *
         problem.products(given, {}, changed).all.bottomRightCorner(scale.size(), scale.size()) *
         scale.asDiagonal();
}

}  // namespace furcula::excite
