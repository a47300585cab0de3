#include "host/diagnose/hypothesis.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "host/core/quantile.hpp"
#include "host/identify/verdicts.hpp"
#include "host/linear/linear.hpp"

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
  double others = 0.0;
  for (const identify::Channel c :
       {identify::Channel::contact, identify::Channel::drive, identify::Channel::leg})
    others += channel(h.fit, c).squares;
  return h.cross_validated_squares - others;
}

bool leaves_more(const Hypothesis& one, const Hypothesis& other, double share) {
  if (squares_of_body(one) > (1.0 + share) * squares_of_body(other)) return true;
  for (const identify::Channel c :
       {identify::Channel::contact, identify::Channel::drive, identify::Channel::leg}) {
    const identify::ChannelShare of_one = channel(one.fit, c), of_other = channel(other.fit, c);
    // Of what is below a step of the drive's loop, or what links and joints give, a part is by chance.
    const double always = c == identify::Channel::contact ? 0.0 : of_other.rows;
    if (of_one.squares + always > (1.0 + share) * (of_other.squares + always)) return true;
  }
  return false;
}

double evidence_of(const identify::Fit& smaller, const identify::Fit& larger, const identify::Fit& of,
                   std::size_t layers, bool motion) {
  double evidence = 0.0;
  for (std::size_t i = 0; i < identify::kChannels; ++i) {
    const auto c = static_cast<identify::Channel>(i);
    if (c == identify::Channel::motion && !motion) continue;
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

Crossing crossing_of(const identify::Fit& fit, const std::vector<identify::Window>& windows,
                     std::size_t recordings) {
  constexpr std::size_t kFolds = 5;
  const auto count = static_cast<Eigen::Index>(fit.values.size());
  Crossing crossing;
  for (std::size_t i = 0; i < windows.size(); ++i)
    crossing.fold.push_back(recordings >= kFolds ? windows[i].recording % kFolds
                                                 : i * kFolds / windows.size());
  crossing.step.assign(kFolds, Eigen::VectorXd::Zero(count));
  const identify::LeavingOut leaving(fit.shares, fit.at_bound);
  if (leaving.moving().empty()) return crossing;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    // What shares rows with the fold has seen them.
    std::map<std::size_t, std::pair<std::size_t, std::size_t>>
        rows;  // of each recording that the fold has windows of
    for (std::size_t i = 0; i < windows.size(); ++i) {
      if (crossing.fold[i] != fold) continue;
      auto& [first, last] =
          rows.try_emplace(windows[i].recording, windows[i].first, windows[i].last).first->second;
      first = std::min(first, windows[i].first);
      last = std::max(last, windows[i].last);
    }
    Eigen::MatrixXd unseen = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      if (crossing.fold[i] == fold) continue;
      if (const auto of = rows.find(windows[i].recording); of != rows.end())
        if (windows[i].first < of->second.second && windows[i].last > of->second.first) continue;
      unseen += fit.shares[i].information;
      slope += fit.shares[i].gradient;
    }
    crossing.step[fold] = leaving.step(unseen, slope);
  }
  return crossing;
}

double squares_after(const identify::WindowShare& share, const Eigen::VectorXd& step) {
  if (step.size() == 0) return share.squares;
  return share.squares + 2.0 * step.dot(share.gradient) + step.dot(Eigen::VectorXd(share.information * step));
}

double cross_validate(const identify::Fit& fit, const std::vector<identify::Window>& windows,
                      std::size_t recordings) {
  const Crossing crossing = crossing_of(fit, windows, recordings);
  double squares = 0.0;
  for (std::size_t i = 0; i < windows.size(); ++i)
    squares += squares_after(fit.shares[i], crossing.step[crossing.fold[i]]);
  return squares;
}

std::vector<double> gains_unseen(const identify::Fit& smaller, const identify::Fit& larger,
                                 const std::vector<identify::Window>& windows, std::size_t recordings) {
  const Crossing one = crossing_of(smaller, windows, recordings),
                 other = crossing_of(larger, windows, recordings);
  std::vector<double> gains;
  for (std::size_t i = 0; i < windows.size(); ++i)
    gains.push_back(squares_after(smaller.shares[i], one.step[one.fold[i]]) -
                    squares_after(larger.shares[i], other.step[other.fold[i]]));
  return gains;
}

double overdispersion(const identify::Fit& fit, const std::vector<std::vector<std::size_t>>& units) {
  std::vector<Eigen::Index> moving;
  for (std::size_t i = 0; i < fit.values.size(); ++i)
    if (!fit.at_bound[i]) moving.push_back(static_cast<Eigen::Index>(i));
  const auto count = static_cast<Eigen::Index>(moving.size());
  if (count == 0 || units.size() < 2) return 1.0;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count), scatter = information;
  for (const auto& unit : units) {
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(count);
    for (const std::size_t i : unit) {
      information += fit.shares[i].information(moving, moving);
      pull += fit.shares[i].gradient(moving);
    }
    scatter += pull * pull.transpose();
  }
  // Independent residuals of these variances would give each channel's information times its own.
  Eigen::MatrixXd independent = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t c = 0; c < identify::kChannels; ++c) {
    const identify::ChannelShare of_channel = channel(fit, static_cast<identify::Channel>(c));
    if (!(of_channel.effective_rows > 0.0)) continue;
    for (const auto& s : fit.shares) {
      const bool alone = s.information_of[c].size() == 0;
      if (alone && c > 0) continue;
      const Eigen::MatrixXd& information_of = alone ? s.information : s.information_of[c];
      independent += of_channel.squares / of_channel.effective_rows * information_of(moving, moving);
    }
  }
  // Scaled to a unit diagonal: the unknowns have different units.
  const Eigen::VectorXd scale =
      information.diagonal().unaryExpr([](double x) { return x > 0.0 ? 1.0 / std::sqrt(x) : 0.0; });
  const auto scaled = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return scale.asDiagonal() * m * scale.asDiagonal();
  };
  const Eigen::MatrixXd known = scaled(information);
  const double trace = linear::least_norm(known, scaled(scatter)).trace(),
               expected = linear::least_norm(known, scaled(independent)).trace();
  // Windows of a unit that share rows pull alike: each row lies in so many, but for those at the unit's ends.
  const auto layers = static_cast<double>(fit.layers);
  const double windows_of_unit = static_cast<double>(fit.shares.size()) / static_cast<double>(units.size());
  double alike = 1.0;
  for (double apart = 1.0; apart < layers; apart += 1.0)
    alike += 2.0 * (1.0 - apart / layers) * std::max(0.0, 1.0 - apart / windows_of_unit);
  const auto of = static_cast<double>(units.size());
  const double ratio = of / (of - 1.0) * trace / (alike * expected);
  return std::isfinite(ratio) ? std::max(1.0, ratio) : 1.0;
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
  if (skew == model.effects.end() || dynamics::has(model.kind, dynamics::LocationType::leg)) return false;
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

namespace {

/// Wald's statistic of these unknowns, all together, being `away` from where they were. Infinite with one at a bound, which is looked at
/// elsewhere.
double wald(const Hypothesis& h, const std::vector<Eigen::Index>& sizes, const std::vector<double>& away) {
  const Eigen::MatrixXd covariance = h.fit.covariance(sizes, sizes);
  Eigen::VectorXd scaled(static_cast<Eigen::Index>(sizes.size()));
  for (Eigen::Index i = 0; i < scaled.size(); ++i) {
    const double spread = std::sqrt(covariance(i, i));
    if (!(spread > 0.0)) return std::numeric_limits<double>::infinity();
    scaled(i) = away[static_cast<std::size_t>(i)] / spread;
  }
  const Eigen::VectorXd by = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = by.asDiagonal() * covariance * by.asDiagonal();
  return scaled.dot(linear::least_norm(correlation, scaled));
}

}  // namespace

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
  return wald(h, sizes, away) >
         chi_square_point(tries * dynamics::info(e).search.shapes, static_cast<double>(sizes.size()));
}

bool may_be_none(const Hypothesis& h, const model::Model& model, Effect e) {
  const auto verdicts =
      identify::parameter_verdicts(identify::in_law_parameters(h.fit, h.unknowns, h.fitted), h.unknowns);
  const auto given = identify::values_in(model, h.unknowns);
  std::vector<Eigen::Index> sizes;
  std::vector<double> away;
  for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
    const auto& u = h.unknowns[i];
    if (!u.of_effect || u.effect != e ||
        !identify::neutral_value(model, dynamics::info(e).parameter_table[u.parameter]))
      continue;
    if (given[i] < verdicts[i].lower || given[i] > verdicts[i].upper) return false;
    sizes.push_back(static_cast<Eigen::Index>(i));
    away.push_back(h.fit.values[i] - given[i]);
  }
  // Of several that are not told from each other each may be none, and all together are not.
  return sizes.size() == 1 ||
         (sizes.size() > 1 &&
          wald(h, sizes, away) < core::chi_square_above(0.05, static_cast<double>(sizes.size())));
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
