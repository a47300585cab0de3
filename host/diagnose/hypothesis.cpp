#include "host/diagnose/hypothesis.hpp"

#include <array>
#include <cmath>

#include "host/core/quantile.hpp"

namespace furcula::diagnose {

using dynamics::Effect;

identify::ChannelShare channel(const identify::Fit& fit, identify::Channel which) {
  identify::ChannelShare sum;
  const auto c = static_cast<std::size_t>(which);
  for (const auto& s : fit.shares) {
    sum.squares += s.channels[c].squares;
    sum.rows += s.channels[c].rows;
    sum.effective_rows += s.channels[c].effective_rows;
  }
  return sum;
}

bool follows_the_body(const Hypothesis& h) {
  constexpr double kOfNoiseAlone = 1.5;
  const identify::ChannelShare motion = channel(h.fit, identify::Channel::motion);
  return motion.squares < kOfNoiseAlone * motion.rows;
}

double squares_of_body(const Hypothesis& h) {
  return h.cross_validated_squares - channel(h.fit, identify::Channel::leg).squares;
}

double evidence_of(const identify::Fit& smaller, const identify::Fit& larger, const identify::Fit& of,
                   std::size_t layers) {
  double evidence = 0.0;
  for (std::size_t i = 0; i < identify::kChannels; ++i) {
    const auto c = static_cast<identify::Channel>(i);
    const identify::ChannelShare share = channel(of, c);
    const double rows = share.effective_rows / static_cast<double>(layers);
    if (rows < 2.0) continue;
    // What the leg angle's errors are below what links and joints give, and the drive's below a step of its
    // loop, they are by chance.
    const bool of_position = c == identify::Channel::motion || c == identify::Channel::contact;
    const double always = of_position ? 1e-300 : share.rows;
    evidence +=
        rows * std::log((channel(smaller, c).squares + always) / (channel(larger, c).squares + always));
  }
  return evidence;
}

double cross_validate(const identify::Fit& fit, const std::vector<identify::Window>& windows,
                      std::size_t recordings) {
  const auto count = static_cast<Eigen::Index>(fit.values.size());
  if (count == 0) return fit.squares;
  constexpr std::size_t kFolds = 5;
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < count; ++i)
    if (!fit.at_bound[static_cast<std::size_t>(i)]) moving.push_back(i);
  const auto part = [&](const Eigen::MatrixXd& m) { return Eigen::MatrixXd(m(moving, moving)); };
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
  for (const auto& s : fit.shares) {
    information += s.information;
    gradient += s.gradient;
  }
  double squares = 0.0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    Eigen::MatrixXd inside = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
    double own = 0.0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const std::size_t of =
          recordings >= kFolds ? windows[i].recording % kFolds : i * kFolds / windows.size();
      if (of != fold) continue;
      inside += fit.shares[i].information;
      slope += fit.shares[i].gradient;
      own += fit.shares[i].squares;
    }
    if (!moving.empty()) {
      const Eigen::MatrixXd rest = part(information - inside);
      const Eigen::VectorXd pull = (gradient - slope)(moving);
      const Eigen::VectorXd step = -rest.completeOrthogonalDecomposition().solve(pull);
      own += 2.0 * step.dot(Eigen::VectorXd(slope(moving))) + step.dot(part(inside) * step);
    }
    squares += own;
  }
  return squares;
}

double chi_square_point(double tries, double freedom) {
  constexpr double kFalseAlarmLevel = 0.005;
  return core::chi_square_above(kFalseAlarmLevel / std::max(tries, 1.0), std::max(freedom, 1.0));
}

namespace {

/// Whether the dry friction of a whole cycle, all of its laws together, is one.
bool takes_energy(const model::Model& model) {
  double both_ways = 0.0;
  for (const auto& [effect, values] : model.effects) {
    if (effect == Effect::asymmetric_friction) both_ways += values[0] + values[1];
    if (effect == Effect::coulomb_friction || effect == Effect::stribeck_friction)
      both_ways += 2.0 * values[0];
  }
  return both_ways >= 0.0;
}

/// Whether drive and clocks shift an axis' input to and fro: what little is left of the two, anything may ask for. (A leg's contact
/// switch tells the clocks.)
bool shifts_undo_each_other(const model::Model& model) {
  constexpr double kLeft = 0.25;
  const auto skew = model.effects.find(Effect::time_skew);
  if (skew == model.effects.end() || dynamics::has(model.kind, dynamics::Seat::leg)) return false;
  double late_s = 0.0;
  for (const Effect e : {Effect::actuator_delay, Effect::actuator_lag})
    if (const auto on = model.effects.find(e); on != model.effects.end()) late_s += on->second[0];
  return std::abs(skew->second[0] + late_s) < kLeft * late_s;
}

}  // namespace

bool within_limits(const Hypothesis& h) {
  std::size_t inertias = 0;
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect && h.fit.at_bound[i]) {
      // Of the three inertias of the links one or two may be none: they act alike.
      if (h.unknowns[i].effect != Effect::leg_inertia || ++inertias == 3) return false;
    }
  for (Effect e : h.effects)
    if (e == Effect::stribeck_friction) {
      const auto& p = h.fitted.effects.at(e);
      if (p[1] <= p[0]) return false;  // no rise towards standstill: not the Stribeck effect
    }
  if (shifts_undo_each_other(h.fitted)) return false;
  return !std::count(h.effects.begin(), h.effects.end(), Effect::asymmetric_friction) ||
         takes_energy(h.fitted);
}

bool stands_out(const Hypothesis& h, const model::Model& model, Effect e, double tries) {
  std::vector<Eigen::Index> sizes;
  std::vector<double> away;
  const auto neutral = identify::values_in(model, h.unknowns);
  for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
    const auto& u = h.unknowns[i];
    if (!u.of_effect || u.effect != e) continue;
    const auto& p = dynamics::info(e).parameter_table[u.parameter];
    const auto none = identify::neutral_value(model, p);
    if (!none && u.parameter != 0) continue;
    if (i < h.fit.ranges.size() && h.fit.ranges[i].first < h.fit.ranges[i].second) {
      // All of the range explains the windows as well: is the effect not there in it? (A clutch that holds
      // anything does not slip.)
      const auto [low, high] = h.fit.ranges[i];
      if (none ? low <= *none && *none <= high : high >= identify::jumps(u, model.kind)->upper) return false;
      continue;
    }
    sizes.push_back(static_cast<Eigen::Index>(i));
    away.push_back(h.fit.values[i] - neutral[i]);
  }
  if (sizes.empty()) return true;
  Eigen::MatrixXd covariance = h.fit.covariance(sizes, sizes);
  Eigen::VectorXd scaled(static_cast<Eigen::Index>(sizes.size()));
  for (Eigen::Index i = 0; i < scaled.size(); ++i) {
    const double spread = std::sqrt(covariance(i, i));
    if (!(spread > 0.0)) return true;  // at a bound, which is looked at elsewhere
    scaled(i) = away[static_cast<std::size_t>(i)] / spread;
  }
  const Eigen::VectorXd by = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = by.asDiagonal() * covariance * by.asDiagonal();
  const double statistic = scaled.dot(correlation.completeOrthogonalDecomposition().solve(scaled));
  return statistic >
         chi_square_point(tries * dynamics::info(e).search.shapes, static_cast<double>(sizes.size()));
}

bool told_from_special_case(const Hypothesis& h, Effect e) {
  if (e != Effect::asymmetric_friction && e != Effect::stribeck_friction) return true;
  constexpr double kSizes = 4.0, kVelocity = 2.0;
  std::array<Eigen::Index, 3> at{-1, -1, -1};
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect && h.unknowns[i].effect == e && !h.fit.at_bound[i])
      at[h.unknowns[i].parameter] = static_cast<Eigen::Index>(i);
  const auto value = [&](std::size_t k) { return h.fit.values[static_cast<std::size_t>(at[k])]; };
  const auto covariance = [&](std::size_t i, std::size_t k) { return h.fit.covariance(at[i], at[k]); };
  if (at[0] >= 0 && at[1] >= 0) {
    const double apart = value(1) - value(0);
    const double variance = covariance(0, 0) + covariance(1, 1) - 2.0 * covariance(0, 1);
    if (apart * apart < kSizes * kSizes * variance) return false;
  }
  return e != Effect::stribeck_friction || at[2] < 0 ||
         value(2) * value(2) > kVelocity * kVelocity * covariance(2, 2);
}

}  // namespace furcula::diagnose
