#include "host/diagnose/proposals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/core/quantile.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/linear/linear.hpp"
#include "host/machines/hopper.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using dynamics::Measure;

constexpr std::size_t kSome = 24;  // windows for one step ...
constexpr std::size_t kFew = 10;   // ... and for the many of a search over frequencies

/// The minimum of squares + 2 g d + d H d with d within [low, high]: unknowns that leave it are put on the
/// limit one after the other.
Eigen::VectorXd bounded_step(const Eigen::VectorXd& gradient, const Eigen::MatrixXd& information,
                             const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  const Eigen::Index n = gradient.size();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
  std::vector<bool> held(static_cast<std::size_t>(n), false);
  for (Eigen::Index round = 0; round <= n; ++round) {
    std::vector<Eigen::Index> moving;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!held[static_cast<std::size_t>(i)] && information(i, i) > 0.0) moving.push_back(i);
    if (moving.empty()) break;
    const Eigen::VectorXd pull = (gradient + information * step)(moving);
    const Eigen::MatrixXd part = information(moving, moving);
    // Scaled: the unknowns have different units.
    const Eigen::VectorXd scale = part.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * part * scale.asDiagonal();
    const Eigen::VectorXd more =
        -(scale.asDiagonal() * linear::least_norm(scaled, scale.asDiagonal() * pull, 1e-9));
    Eigen::Index worst = -1;
    double beyond = 0.0;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Eigen::Index i = moving[k];
      const double to = step(i) + more(static_cast<Eigen::Index>(k));
      const double over = std::max(low(i) - to, to - high(i)) / std::max(high(i) - low(i), 1e-300);
      if (over > beyond) {
        beyond = over;
        worst = i;
      }
    }
    if (worst < 0) {
      for (std::size_t k = 0; k < moving.size(); ++k) step(moving[k]) += more(static_cast<Eigen::Index>(k));
      break;
    }
    for (std::size_t k = 0; k < moving.size(); ++k)
      if (moving[k] == worst)
        step(worst) =
            step(worst) + more(static_cast<Eigen::Index>(k)) < low(worst) ? low(worst) : high(worst);
    held[static_cast<std::size_t>(worst)] = true;
  }
  return step;
}

}  // namespace

Proposer::Some::Some(const Trainer& trainer, std::size_t most) {
  const std::vector<identify::Window>& all = trainer.training.windows;
  const std::size_t count = std::min(all.size(), most);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * all.size() / count;
    windows.push_back(all[at]);
    if (!trainer.whitening.empty()) whitening.push_back(trainer.whitening[at]);
  }
}

identify::Fit Proposer::Some::look(const Trainer& trainer, const model::Model& model,
                                   const std::vector<identify::Unknown>& unknowns,
                                   const std::vector<double>& values) const {
  return identify::look_by_simulation(model, unknowns, values, trainer.recordings, windows,
                                      identify::Starting::linear, trainer.training.most_squares,
                                      whitening.empty() ? nullptr : &whitening);
}

Proposer::Proposer(const Trainer& trainer) : t_(trainer), some_(trainer, kSome), few_(trainer, kFew) {
  const Trainer::Scales scales = trainer.scales();
  speed_ = scales.speed;
  force_ = scales.force;
  std::vector<double> sizes;
  for (const auto& r : t_.recordings)
    for (double u : r.input)
      if (u != 0.0) sizes.push_back(std::abs(u));
  top_input_ = core::quantile(sizes, 0.99);
  const auto [low, high] = trainer.travel();
  low_ = low;
  high_ = high;
}

std::vector<Proposer::Values> Proposer::starts(Effect effect) const {
  constexpr int kPlaces = 8;
  const dynamics::EffectInfo& e = dynamics::info(effect);
  const dynamics::Search& search = e.search;
  if (search.starts.count == 0) {
    const auto neutral = identify::values_in(t_.model, identify::effect_unknowns(effect, t_.model.kind));
    Values values{};
    std::copy(neutral.begin(), neutral.end(), values.begin());
    return {values};
  }
  const auto& measures = search.measures;
  const bool somewhere = std::any_of(measures.begin(), measures.end(),
                                     [](Measure m) { return m == Measure::place || m == Measure::depth; });
  std::vector<Values> all;
  for (int place = 0; place < (somewhere ? kPlaces : 1); ++place)
    for (std::size_t row = 0; row < search.starts.count; ++row) {
      Values values = search.starts.rows[row];
      for (std::size_t i = 0; i < e.parameter_count; ++i) switch (measures[i]) {
          case Measure::unit:
            break;
          case Measure::friction:
            values[i] *= 0.05 * force_;
            break;
          case Measure::speed:
            values[i] *= speed_;
            break;
          case Measure::input:
            values[i] *= top_input_;
            break;
          case Measure::travel:
            values[i] *= high_ - low_;
            break;
          case Measure::model:
            values[i] *= e.parameter_table[i].model_parameter.empty()
                             ? t_.model.parameter(e.parameter_table[i].name)
                             : identify::neutral_value(t_.model, e.parameter_table[i]).value();
            break;
          case Measure::load:
            values[i] *= force_ / t_.model.parameter("pulley_radius_m");
            break;
          case Measure::place:
            values[i] = low_ + (place + 0.5) / kPlaces * (high_ - low_);
            break;
          case Measure::depth:
            values[i] = (place + 0.5) / kPlaces * (machines::touchdown_height_m(t_.model) - low_);
            break;
        }
      all.push_back(values);
    }
  return all;
}

Proposer::Screening Proposer::step(const Hypothesis& on, const std::vector<Effect>& larger, Effect effect,
                                   const Values& values, const Some& some, bool shape_held) const {
  const std::vector<identify::Unknown> unknowns = unknowns_of(t_.model, larger);
  std::vector<double> at = identify::values_in(on.fitted, unknowns);
  const Values start = identify::fitted_from_law(effect, values, t_.model);
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  Eigen::VectorXd low(n), high(n);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto& u = unknowns[i];
    const bool own = u.of_effect && u.effect == effect;
    if (own) at[i] = std::clamp(start[u.parameter], u.lower, u.upper);
    const auto k = static_cast<Eigen::Index>(i);
    low(k) = u.lower - at[i];
    high(k) = u.upper - at[i];
    if (own && shape_held) {
      if (u.parameter != 0)
        low(k) = high(k) = 0.0;
      else
        low(k) = -(high(k) = 1e9);  // an amplitude of either sign
    } else if (own && dynamics::info(effect).parameter_count > 1 && std::abs(at[i]) > 0.0 &&
               std::isnan(dynamics::info(effect).parameter_table[u.parameter].neutral)) {
      // Of a shape one linear step tells the direction, not the distance.
      low(k) = std::max(low(k), -0.5 * std::abs(at[i]));
      high(k) = std::min(high(k), std::abs(at[i]));
    }
  }
  const identify::Fit look = some.look(t_, with_slips(t_.model, t_.recordings, larger), unknowns, at);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const auto& share : look.shares) {
    gradient += share.gradient;
    information += share.information;
  }
  if (!std::isfinite(look.squares) || !gradient.allFinite() || !information.allFinite())
    return {std::numeric_limits<double>::infinity(), values};
  const Eigen::VectorXd by = bounded_step(gradient, information, low, high);
  Screening screening{look.squares + 2.0 * by.dot(gradient) + by.dot(information * by), values};
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (unknowns[i].of_effect && unknowns[i].effect == effect)
      screening.values[unknowns[i].parameter] = at[i] + by(static_cast<Eigen::Index>(i));
  screening.values = identify::law_from_fitted(effect, screening.values, t_.model);
  return screening;
}

std::vector<Proposer::Values> Proposer::swings(const Hypothesis& on, const std::vector<Effect>& larger,
                                               Effect effect) const {
  constexpr std::size_t kLookedAt = 8;
  // Frequencies so dense that half a turn lies between neighbours over the travel.
  std::vector<double> shapes;
  const double pi = std::numbers::pi;
  if (effect == Effect::torque_ripple) {
    double range = high_ - low_;  // rad
    if (dynamics::has(t_.model.kind, dynamics::LocationType::leg)) {
      const double length = 2.0 * t_.model.parameter("link_length_m");
      const double stop = machines::touchdown_height_m(t_.model);
      range =
          std::acos(std::clamp(low_ / length, -1.0, 1.0)) - std::acos(std::clamp(stop / length, -1.0, 1.0));
    }
    const double spacing = std::clamp(pi / std::max(range, 1e-3), 1.0, 5.0);
    const double fewest = std::max(1.0, std::ceil(t_.fewest_ripples()));
    const double most = std::min(std::max(60.0, 3.0 * fewest), 200.0);
    for (double n = fewest; n <= most; n += spacing) shapes.push_back(n);
  } else {
    const double spacing = std::max(0.5 / std::max(high_ - low_, 1e-3), 2.0);  // turns a metre
    for (double turns = spacing; turns <= 120.0; turns += spacing) shapes.push_back(1.0 / turns);
  }
  struct Found {
    double squares;
    Values values;
  };
  std::vector<Found> found;
  for (double shape : shapes) {
    const auto position = [&](double phase) { return Values{0.0, shape, phase}; };
    const Screening sine = step(on, larger, effect, position(0.0), few_, true);
    const Screening cosine = step(on, larger, effect, position(0.5 * pi), few_, true);
    const double a = sine.values[0], b = cosine.values[0];
    found.push_back({sine.squares + cosine.squares, {std::hypot(a, b), shape, std::atan2(b, a)}});
  }
  const auto sort = [&] {
    std::stable_sort(found.begin(), found.end(),
                     [](const Found& a, const Found& b) { return a.squares < b.squares; });
  };
  sort();
  // Sine and cosine together, and the frequency free.
  if (found.size() > kLookedAt) found.resize(kLookedAt);
  for (Found& f : found) f.squares = step(on, larger, effect, f.values, few_, false).squares;
  sort();
  std::vector<Values> best;
  for (std::size_t i = 0; i < found.size() && i < 3; ++i)
    if (std::isfinite(found[i].squares)) best.push_back(found[i].values);
  return best;
}

double Proposer::squares_left(const Hypothesis& on) const {
  return some_.look(t_, on.fitted, {}, {}).squares;
}

Proposal Proposer::best(const Hypothesis& on, const std::vector<Effect>& larger, Effect effect,
                        double left) const {
  constexpr std::size_t kOthers = 2;
  Proposal proposal{effect, {}, {}, -std::numeric_limits<double>::infinity()};
  const std::vector<Values> all =
      dynamics::info(effect).search.swings ? swings(on, larger, effect) : starts(effect);
  std::vector<Screening> screenings;
  for (const Values& values : all) screenings.push_back(step(on, larger, effect, values, some_, false));
  if (screenings.empty()) return proposal;  // a travel too short for any
  std::stable_sort(screenings.begin(), screenings.end(),
                   [](const Screening& a, const Screening& b) { return a.squares < b.squares; });
  proposal.values = screenings.front().values;
  proposal.gain = 1.0 - screenings.front().squares / std::max(left, 1e-300);
  if (all.size() > 2)
    for (std::size_t i = 1; i < screenings.size() && i <= kOthers; ++i)
      if (std::isfinite(screenings[i].squares)) proposal.others.push_back(screenings[i].values);
  return proposal;
}

Hypothesis fit_new(const Trainer& trainer, const EffectSet& larger, const Hypothesis& on,
                   const Proposal& proposal) {
  const Effect e = proposal.effect;
  Hypothesis best;
  best.effects = larger;
  best.failed = true;
  const auto try_from = [&](const Hypothesis& from,
                            const std::array<double, dynamics::kMaxEffectParameters>& values) {
    Hypothesis other = trainer.fit_if_it_runs(larger, from, {{e, values}});
    if (!other.failed && (best.failed || other.fit.squares < best.fit.squares)) best = std::move(other);
  };
  try_from(on, proposal.values);
  // Where the teeth of a clutch or many shapes lie between the starts, the next best of these as well.
  if (dynamics::needs_clutch(e) || dynamics::info(e).search.shapes >= dynamics::detail::kManyShapes)
    for (const auto& values : proposal.others) try_from(on, values);
  // Dry friction sticks, which makes a fit's landscape uneven: a second start from a twentieth of what moves
  // the axis; for the Stribeck curve from the constant friction that fits best, twice as large at standstill,
  // over several widths.
  const Trainer::Scales scale = trainer.scales();
  if (e == Effect::coulomb_friction) try_from(on, {0.05 * scale.force});
  if (e == Effect::asymmetric_friction) try_from(on, {0.05 * scale.force, 0.05 * scale.force});
  if (e == Effect::stribeck_friction) {
    if (holds(larger, Effect::asymmetric_friction)) return best;
    const Hypothesis flat = fit_new(trainer, with(without(larger, e), Effect::coulomb_friction), on,
                                    {Effect::coulomb_friction, {0.02 * scale.force}, {}, 0.0});
    if (flat.failed) return best;
    const double level = flat.fitted.effects.at(Effect::coulomb_friction)[0];
    Hypothesis bare = flat;
    bare.fitted.effects.erase(Effect::coulomb_friction);
    for (double width : {0.03, 0.1, 0.3})
      try_from(bare, {0.8 * level, 1.6 * level + 1e-3 * scale.force, width * scale.speed});
  }
  return best;
}

}  // namespace furcula::diagnose
