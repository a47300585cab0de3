#include "host/diagnose/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "host/core/error.hpp"
#include "host/core/quantile.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

/// An effect that removes less than this share of what the re-fitted model leaves (measuring noise included)
/// is not worth a name: differences of numerics between two honest simulators are of that size.
constexpr double kSmallestGain = 0.04;
/// Nor is one that removes less than this of what the re-fitted model without any effect leaves: another's law for the largest cause may
/// be off by so much, 1.7 % of its size.
constexpr double kSmallestWorth = 3e-4;

double shapes_of(Effect e) { return dynamics::info(e).search.shapes; }

double doubt_of(const std::vector<Effect>& effects) {
  double doubt = 0.0;
  for (Effect e : effects) doubt += dynamics::info(e).search.doubt;
  return doubt;
}

/// Start values of the unknowns: those of `from`, of an effect that is new to it those proposed.
std::vector<double> values_from(const Trainer& t, const std::vector<identify::Unknown>& unknowns,
                                const Hypothesis* from, const Starts& starts) {
  const model::Model& base = from != nullptr ? from->fitted : t.model;
  std::vector<double> values = identify::values_in(base, unknowns);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto& u = unknowns[i];
    if (!u.of_effect || base.effects.contains(u.effect)) continue;
    if (const auto proposed = starts.find(u.effect); proposed != starts.end())
      values[i] = identify::fitted_from_law(u.effect, proposed->second, t.model)[u.parameter];
  }
  return values;
}

}  // namespace

std::vector<identify::Unknown> unknowns_of(const model::Model& model, const std::vector<Effect>& effects) {
  auto all = identify::free_unknowns(model);
  for (Effect e : effects) {
    const auto more = identify::effect_unknowns(e, model.kind);
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

identify::Channel judged_on(Effect e, const std::vector<identify::Recording>& recordings) {
  if (e == Effect::contact_delay) return identify::Channel::contact;
  const bool of_drive = std::find(std::begin(dynamics::kDriveEffects), std::end(dynamics::kDriveEffects),
                                  e) != std::end(dynamics::kDriveEffects);
  const bool answered = std::any_of(recordings.begin(), recordings.end(),
                                    [](const auto& r) { return !r.drive_command.empty(); });
  if (of_drive && answered) return identify::Channel::drive;
  const bool seen =
      std::any_of(recordings.begin(), recordings.end(), [](const auto& r) { return !r.leg_angle.empty(); });
  return e == Effect::backlash && seen ? identify::Channel::leg : identify::Channel::motion;
}

model::Model with_slips(model::Model model, const std::vector<identify::Recording>& recordings,
                        const std::vector<Effect>& effects) {
  if (!holds(effects, Effect::encoder_slip)) return model;
  auto& largest = model.effects[Effect::encoder_slip] = {};
  for (const auto& r : recordings)
    for (const auto& slip : r.slips)
      if (std::abs(slip.step) > std::abs(largest[0]))
        largest = {slip.step, r.time_s[slip.row] - r.time_s.front()};
  return model;
}

std::vector<Effect> Trainer::candidates() const {
  std::vector<Effect> all;
  for (const auto& info : dynamics::kCatalogue) {
    if (info.effect == Effect::encoder_slip &&
        std::none_of(recordings.begin(), recordings.end(), [](const auto& r) { return !r.slips.empty(); }))
      continue;
    if (!applies(info.effect, model.kind)) continue;  // one that is on may have the wrong size
    if (dynamics::needs_clutch(info.effect) && !clutch_works()) continue;
    if (!shows(info.effect)) continue;
    bool free_anyway = false;
    for (const auto& p : info.parameters()) {
      const auto same = identify::parameter_meant(model.kind, p);
      free_anyway = free_anyway || (same && model.free.contains(*same));
    }
    // The loss at touch-down is held in the model by the name restitution_touchdown, the spring's rate by
    // stiffness_npm: where those are free, identification has moved them already.
    if (!free_anyway) all.push_back(info.effect);
  }
  return all;
}

Hypothesis Trainer::fit(const std::vector<Effect>& effects, const Hypothesis* from,
                        const Starts& starts) const {
  Hypothesis h;
  h.effects = effects;
  h.unknowns = unknowns_of(model, effects);
  const model::Model base = with_slips(model, recordings, effects);
  const std::vector<double> start = values_from(*this, h.unknowns, from, starts);
  {
    const std::lock_guard held(fitted->lock);
    if (const auto known = fitted->all.find({effects, start}); known != fitted->all.end())
      return known->second;
  }
  const auto near = whitening.empty()
                        ? identify::begin_on_some(base, h.unknowns, start, recordings, training.windows)
                        : std::nullopt;
  identify::Effort effort = near ? identify::kFromNear : identify::Effort{};
  effort.most_squares = training.most_squares;
  if (!whitening.empty()) effort.whitening = &whitening;
  h.fit = identify::fit_by_simulation(base, h.unknowns, near.value_or(start), recordings, training.windows,
                                      identify::Weighting::noise, training.layers, effort);
  h.fitted = identify::with_values(base, h.unknowns, h.fit.values);
  h.cross_validated_squares = cross_validate(h.fit, training.windows, recordings.size());
  h.meaningful = within_limits(h) && beyond_resolution(h);
  const auto tries = static_cast<double>(candidates().size());
  for (Effect e : effects) {
    // A rate of which none would be infinite (a ground that gives) fits anything by being large: it must be known, too.
    const bool has_none = identify::neutral_value(model, dynamics::info(e).parameter_table[0]).has_value();
    // Whitened, whether it is there is told by the likelihood of the set without it.
    if (h.meaningful)
      h.meaningful =
          told_from_special_case(h, e) &&
          (!whitening.empty() || (shapes_of(e) == 1.0 && has_none) || stands_out(h, model, e, tries));
  }
  const std::lock_guard held(fitted->lock);
  fitted->all.try_emplace({effects, start}, h);
  return h;
}

Hypothesis Trainer::fit_if_it_runs(const std::vector<Effect>& effects, const Hypothesis& from,
                                   const Starts& starts) const {
  try {
    return fit(effects, &from, starts);
  } catch (const core::DataError&) {
    Hypothesis none;
    none.effects = effects;
    none.failed = true;
    return none;
  }
}

bool Trainer::clutch_works() const {
  return dynamics::has(model.kind, dynamics::LocationType::belt) ||
         (model.clutch && std::any_of(recordings.begin(), recordings.end(),
                                      [](const auto& r) { return !r.solenoid.empty(); }));
}

bool Trainer::shows(Effect e) const {
  const auto in_one = [&](const auto& of_commands) {
    return std::any_of(recordings.begin(), recordings.end(), [&](const identify::Recording& r) {
      return of_commands(r.input) || of_commands(r.drive_command);
    });
  };
  switch (e) {
    case Effect::time_skew:  // a leg's contact switch has the commands' clock, too
      if (dynamics::has(model.kind, dynamics::LocationType::leg)) return true;
      [[fallthrough]];
    case Effect::actuator_delay:
    case Effect::actuator_lag:
    case Effect::torque_saturation:
      return in_one([](const std::vector<double>& commands) {
        return std::adjacent_find(commands.begin(), commands.end(), std::not_equal_to<>()) != commands.end();
      });
    case Effect::torque_gain_error:
    case Effect::thermal_derating:
      return in_one([](const std::vector<double>& commands) {
        return std::any_of(commands.begin(), commands.end(), [](double u) { return u != 0.0; });
      });
    default:
      return true;
  }
}

Trainer::Scales Trainer::scales() const {
  double squares = 0.0, inputs = 0.0, forces = 0.0, rows = 0.0;
  const machines::Rules& rules = machines::rules(model.kind);
  for (const auto& w : training.windows) {
    const auto& r = recordings[w.recording];
    for (std::size_t i = w.first; i <= w.last; ++i) {
      squares += r.velocity_smoothed[i] * r.velocity_smoothed[i];
      inputs += r.input[i] * r.input[i];
      if (i > w.first) {
        const double rise = r.velocity_smoothed[i] - r.velocity_smoothed[i - 1];
        forces += std::pow(rules.inertia(model) * rise / (r.time_s[i] - r.time_s[i - 1]), 2);
      }
      rows += 1.0;
    }
  }
  if (rows == 0.0) return {};
  const double force = rules.weight != nullptr ? rules.weight(model)
                       : inputs > 0.0          ? std::sqrt(inputs / rows)
                                               : std::sqrt(forces / rows);
  return {force, std::sqrt(squares / rows)};
}

Trainer::Travel Trainer::travel() const {
  std::vector<double> positions;
  for (const auto& w : training.windows) {
    const auto& position = recordings[w.recording].position;
    positions.insert(positions.end(), position.begin() + static_cast<std::ptrdiff_t>(w.first),
                     position.begin() + static_cast<std::ptrdiff_t>(w.last) + 1);
  }
  return {core::quantile(positions, 0.01), core::quantile(positions, 0.99)};
}

double Trainer::fewest_ripples() const {
  constexpr double kCycles = 1.25;  // a quarter of the first swing comes again
  if (dynamics::has(model.kind, dynamics::LocationType::leg)) return 0.0;
  const auto [low, high] = travel();
  return kCycles * 2.0 * std::numbers::pi / std::max(high - low, 1e-3);
}

double Trainer::row_s() const {
  const auto& time_s = recordings.front().time_s;
  return (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
}

bool Trainer::beyond_resolution(const Hypothesis& h) const {
  const double interval_s = row_s();
  const auto beyond = [&](Effect e, double rows) {
    return !holds(h.effects, e) || std::abs(h.fitted.effects.at(e)[0]) > rows * interval_s;
  };
  // A spot as wide as the travel is plain friction.
  if (holds(h.effects, Effect::binding_spot)) {
    constexpr double kWidest = 0.7;
    const auto& spot = h.fitted.effects.at(Effect::binding_spot);
    const auto [low, high] = travel();
    const double covered = std::min(spot[1] + 0.5 * spot[2], high) - std::max(spot[1] - 0.5 * spot[2], low);
    if (covered > kWidest * (high - low)) return false;
  }
  if (holds(h.effects, Effect::torque_ripple) &&
      h.fitted.effects.at(Effect::torque_ripple)[1] < fewest_ripples())
    return false;
  // What ends soon after the start is no heat: the loss goes on for a fifth of the time that the motor worked, at least.
  if (holds(h.effects, Effect::thermal_derating)) {
    constexpr double kTimeConstants = 3.0, kShare = 0.2;
    double worked_s = 0.0;
    for (const auto& r : recordings) worked_s = std::max(worked_s, r.driven_s.back());
    if (kTimeConstants * h.fitted.effects.at(Effect::thermal_derating)[1] < kShare * worked_s) return false;
  }
  // A switch is read once a row, and bounces; what a row's input is worth until the next one is known to a
  // part of the interval, less where it was measured and not commanded.
  const bool answered = !recordings.front().drive_command.empty();
  return beyond(Effect::contact_delay, 2.0) && beyond(Effect::time_skew, answered ? 1.0 : 0.5) &&
         beyond(Effect::actuator_delay, 0.5) &&
         (judged_on(Effect::actuator_lag, recordings) != identify::Channel::motion ||
          holds(h.effects, Effect::time_skew) ||  // rows that are early by a whole one, less by a lag
          beyond(Effect::actuator_lag, 0.5));
}

Comparison Trainer::compare(const Hypothesis& smaller, const Hypothesis& larger, std::size_t tries) const {
  Comparison c;
  // The correlation time of what the larger one leaves: what the smaller one leaves holds the effect itself.
  const auto extra =
      static_cast<double>(larger.unknowns.size()) - static_cast<double>(smaller.unknowns.size());
  c.evidence = evidence_of(smaller.fit, larger.fit, larger.fit, training.layers);
  double shapes = 1.0;
  for (Effect e : larger.effects)
    if (!holds(smaller.effects, e)) shapes = std::max(shapes, shapes_of(e));
  double slips = 0.0;  // each has a place and a size
  for (const auto& r : recordings) slips += static_cast<double>(r.slips.size());
  const bool slipped =
      !holds(smaller.effects, Effect::encoder_slip) && holds(larger.effects, Effect::encoder_slip);
  c.threshold = chi_square_point(static_cast<double>(tries) * shapes, extra + (slipped ? 2.0 * slips : 0.0));
  const double before = squares_of_body(smaller), after = squares_of_body(larger);
  c.gain = 1.0 - after / std::max(before, 1e-300);
  double worth = (before - after) / std::max(reference_squares, 1e-300);
  // An effect that does not move the body is judged by the channel that it moves.
  for (Effect e : larger.effects)
    if (const auto judge = judged_on(e, recordings);
        judge != identify::Channel::motion && !holds(smaller.effects, e)) {
      c.gain =
          1.0 - channel(larger.fit, judge).squares / std::max(channel(smaller.fit, judge).squares, 1e-300);
      worth = c.gain;
    }
  if (slipped) {
    double without_slip = 0.0, with_slip = 0.0;
    for (std::size_t i = 0; i < training.windows.size(); ++i) {
      const identify::Window& w = training.windows[i];
      const auto& of_recording = recordings[w.recording].slips;
      if (std::none_of(of_recording.begin(), of_recording.end(),
                       [&](const identify::Slip& s) { return s.row > w.first && s.row <= w.last; }))
        continue;
      without_slip += smaller.fit.shares[i][identify::Channel::motion].squares;
      with_slip += larger.fit.shares[i][identify::Channel::motion].squares;
    }
    c.evidence += evidence_of_jumps();
    c.gain = without_slip > 0.0 ? 1.0 - with_slip / without_slip
                                : 1.0;  // between the windows nothing contradicts it
  }
  c.told_apart = c.evidence > c.threshold && c.gain > kSmallestGain;
  // No simulator's numerics jump from one row to the next.
  const bool beyond_numerics = slipped || worth > kSmallestWorth;
  c.counts = c.gain > kSmallestGain && beyond_numerics;
  c.significant = c.told_apart && beyond_numerics;
  return c;
}

double Trainer::evidence_of_jumps() const {
  constexpr double kCertain =
      1e3;  // of a sensor without noise it would be all there is, and swallow the rest
  double evidence = 0.0;
  for (const auto& r : recordings)
    for (const identify::Slip& slip : r.slips)
      evidence += slip.step * slip.step < kCertain * slip.deviation * slip.deviation
                      ? std::pow(slip.step / slip.deviation, 2)
                      : kCertain;
  return evidence;
}

double Trainer::preference(const Hypothesis& one, const Hypothesis& other) const {
  const double slips = static_cast<double>(holds(other.effects, Effect::encoder_slip)) -
                       static_cast<double>(holds(one.effects, Effect::encoder_slip));
  return evidence_of(one.fit, other.fit, other.fit, training.layers) + doubt_of(one.effects) -
         doubt_of(other.effects) + (slips != 0.0 ? slips * evidence_of_jumps() : 0.0);
}

double Trainer::prior(const std::vector<Effect>& effects) const {
  double slips = 0.0;
  for (const auto& r : recordings) slips += static_cast<double>(r.slips.size());
  const auto tries = static_cast<double>(candidates().size());
  double price = 0.0;
  for (Effect e : effects) {
    const double freedom = e == Effect::encoder_slip
                               ? 2.0 * slips
                               : static_cast<double>(identify::effect_unknowns(e, model.kind).size());
    price += chi_square_point(tries * shapes_of(e), freedom);
  }
  return (holds(effects, Effect::encoder_slip) ? evidence_of_jumps() : 0.0) - price - doubt_of(effects);
}

double Trainer::evidence_over(const Hypothesis& reference, const Hypothesis& h) const {
  return evidence_of(reference.fit, h.fit, reference.fit, training.layers);
}

std::optional<Hypothesis> Trainer::widened(const Hypothesis& refitted) const {
  constexpr double kWider = 4.0;
  model::Model wide = model;
  bool held = false;
  for (std::size_t i = 0; i < refitted.unknowns.size(); ++i) {
    if (!refitted.fit.at_bound[i] || refitted.fit.values[i] == 0.0) continue;
    auto& bounds = wide.free.at(refitted.unknowns[i].parameter);
    bounds = {bounds.lower < 0.0 ? bounds.lower * kWider : bounds.lower / kWider,
              bounds.upper < 0.0 ? bounds.upper / kWider : bounds.upper * kWider};
    held = true;
  }
  if (!held) return std::nullopt;
  const Trainer trainer{wide, recordings, training, threads};
  const Hypothesis wider = trainer.fit_if_it_runs({}, refitted);
  if (wider.failed) return std::nullopt;
  const double evidence = evidence_of(refitted.fit, wider.fit, wider.fit, training.layers);
  if (evidence < chi_square_point(1.0, static_cast<double>(wider.unknowns.size())) ||
      wider.fit.squares > (1.0 - kSmallestGain) * refitted.fit.squares)
    return std::nullopt;
  return wider;
}

}  // namespace furcula::diagnose
