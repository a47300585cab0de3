#include "host/trees/friction_laws.hpp"

#include <optional>
#include <utility>

#include "host/trees/compared_fits.hpp"
#include "host/trees/pruning.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;

/// A Stribeck curve's rise towards standstill is one from so many standard errors on.
constexpr double kRises = 3.0;
/// Laws of friction with fewer parameters may be worse by so much of the loss, which a few windows make.
constexpr double kHardlyWorse = 0.05;
/// Laws of friction with as many parameters must be better by so much of the loss.
constexpr double kBetter = 0.003;

/// Of a Stribeck curve's friction at standstill less that in motion.
double variance_of_rise(const Fit& fit, std::size_t cause) {
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

/// Whether other laws of friction take the place of those of `fit`. With fewer parameters: where they are worse by less than kHardlyWorse and
/// than kStands times the scatter from window to window. With as many: where they are better by kBetter. With more: where they are better by
/// kOfParameter each, and by kStands times the scatter.
bool takes_place(const Fit& anew, const Fit& fit) {
  const double more = static_cast<double>(anew.unknowns.size()) - static_cast<double>(fit.unknowns.size());
  if (more < 0.0) return anew.loss < (1.0 + kHardlyWorse) * fit.loss && against(fit, anew) < kStands;
  if (more == 0.0) return anew.loss < (1.0 - kBetter) * fit.loss;
  return anew.loss * (1.0 + kOfParameter * more) < fit.loss && against(anew, fit) > kStands;
}

bool is_resistance(Effect e) {
  return e == Effect::coulomb_friction || e == Effect::asymmetric_friction || e == Effect::damping_error ||
         e == Effect::quadratic_drag || e == Effect::load_friction || e == Effect::stribeck_friction;
}

}  // namespace

Fit friction_anew(SearchState& s, Fit fit) {
  const std::size_t given = s.problem.model().causes.size();
  for (std::size_t j = 0; j < s.problem.joints(); ++j) {
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
    s.say(0.7, "trying other models of friction at " + s.problem.model().robot.joints[j].name);
    const Scales& scales = s.problem.scales();
    const double speed = scales.velocity_radps[j], little_nm = 0.05 * scales.torque_nm[j];
    const Drive& drive = s.problem.model().drives[j];
    std::vector<std::optional<Cause>> beside{
        std::nullopt, Cause{Effect::quadratic_drag, {j}, {little_nm / (speed * speed), 0, 0, 0}},
        Cause{Effect::load_friction, {j}, {0.05, 0, 0, 0}}};
    if (!s.problem.model().is_free(j, 3))
      beside.push_back(Cause{Effect::damping_error, {j}, {drive.damping_nmspr + little_nm / speed, 0, 0, 0}});
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
        if (names(s.problem.model(), h) == names(s.problem.model(), fit.at)) continue;
        Fit anew = s.problem.fit(h, 6);
        if (!takes_place(anew, fit)) continue;
        const auto dropped = s.dropped;
        const double worth = s.dropped_worth;
        if (Fit kept = prune(s, std::move(anew), true); takes_place(kept, fit)) {
          fit = std::move(kept);
        } else {
          s.dropped = dropped;
          s.dropped_worth = worth;
        }
      }
  }
  return fit;
}

Fit without_falls(const Problem& problem, Fit fit) {
  for (std::size_t c = problem.model().causes.size(); c < fit.at.causes.size(); ++c) {
    const Cause& curve = fit.at.causes[c];
    if (curve.effect != Effect::stribeck_friction) continue;
    const double rise_nm = curve.values[1] - curve.values[0];
    const bool rises = rise_nm > 0.0 && rise_nm * rise_nm > kRises * kRises * variance_of_rise(fit, c);
    Hypothesis h = fit.at;
    h.causes[c] = {
        Effect::coulomb_friction, curve.sites, {0.5 * (curve.values[0] + curve.values[1]), 0, 0, 0}};
    Fit plain = problem.fit(h, 6);
    if (plain.loss < (rises ? 1.0 : 1.0 + kHardlyWorse) * fit.loss) fit = std::move(plain);
  }
  return fit;
}

}  // namespace furcula::trees
