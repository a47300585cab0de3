#include "host/diagnose/selection.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "host/diagnose/proposals.hpp"
#include "host/identify/parallel.hpp"
#include "host/log/error.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr std::size_t kMostEffects = 4;
/// An effect that removes less than this share of what the re-fitted model leaves (measuring noise included)
/// is not worth a name: differences of numerics between two honest simulators are of that size.
constexpr double kSmallestGain = 0.04;
/// Nor is one that removes less than this of what the re-fitted model without any effect leaves.
constexpr double kSmallestWorth = 2e-3;
/// Two sets whose evidence differs by less than this explain the data equally well (odds of about 20 to 1).
constexpr double kEqualEvidence = 6.0;
constexpr double kFalseAlarmLevel = 0.005;
constexpr std::size_t kMostFits =
    8;  ///< of the forward selection's first round; half of them in the later ones
constexpr std::size_t kFewestFits = 3;
constexpr double kSmallestPromise = 0.2;  ///< of the best proposal's
constexpr std::size_t kMostRivals = 4;    ///< that are fitted in the place of each member
constexpr int kMostSwaps = 2;
constexpr std::size_t kBeam = 4;      ///< effects that a pair may begin with
constexpr double kWithinNoise = 1.5;  ///< squares over what noise alone leaves

/// One channel of all windows.
identify::ChannelShare channel(const identify::Fit& fit, std::size_t which) {
  identify::ChannelShare sum;
  for (const auto& s : fit.shares) {
    sum.squares += s.channels[which].squares;
    sum.rows += s.channels[which].rows;
    sum.effective_rows += s.channels[which].effective_rows;
  }
  return sum;
}

/// Cross-validated, without the leg angle: a backlash that is not in the model yet would hide beside it what
/// moves the body.
double squares_of_body(const Hypothesis& h) {
  return h.cross_validated_squares - channel(h.fit, static_cast<std::size_t>(identify::Channel::leg)).squares;
}

/// Twice the log-likelihood ratio of `larger` over `smaller`, with as many independent samples as the
/// residuals of `of` are worth; each channel with a noise level of its own.
double evidence_of(const identify::Fit& smaller, const identify::Fit& larger, const identify::Fit& of,
                   std::size_t layers) {
  double evidence = 0.0;
  for (std::size_t c = 0; c < identify::kChannels; ++c) {
    const identify::ChannelShare share = channel(of, c);
    const double rows = share.effective_rows / static_cast<double>(layers);
    if (rows < 2.0) continue;
    // What the leg angle's errors are below what links and joints give, and the drive's below a step of its
    // loop, they are by chance.
    const bool of_position = c == static_cast<std::size_t>(identify::Channel::motion) ||
                             c == static_cast<std::size_t>(identify::Channel::contact);
    const double always = of_position ? 1e-300 : share.rows;
    evidence +=
        rows * std::log((channel(smaller, c).squares + always) / (channel(larger, c).squares + always));
  }
  return evidence;
}

/// Squares on windows that the estimate has not seen: the training recordings (or, of a single one, its
/// stretches) in folds, each predicted with the estimate that one Gauss-Newton step makes without the fold.
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

/// Start values of the unknowns: those of `from`, of an effect that is new to it those proposed.
std::vector<double> values_from(const Trainer& t, const std::vector<identify::Unknown>& unknowns,
                                const Hypothesis* from, const Starts& starts) {
  const model::Model& base = from != nullptr ? from->fitted : t.model;
  std::vector<double> values = identify::values_in(base, unknowns);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto& u = unknowns[i];
    if (!u.of_effect || base.effects.contains(u.effect)) continue;
    if (const auto proposed = starts.find(u.effect); proposed != starts.end())
      values[i] = proposed->second[u.parameter];
  }
  return values;
}

std::vector<Effect> with(std::vector<Effect> effects, Effect more) {
  effects.push_back(more);
  std::sort(effects.begin(), effects.end());
  return effects;
}

std::vector<Effect> without(std::vector<Effect> effects, Effect less) {
  effects.erase(std::remove(effects.begin(), effects.end(), less), effects.end());
  return effects;
}

/// True if `larger` with some values of its parameters is `smaller`: then it takes its place rather than
/// stand beside it.
bool contains(Effect larger, Effect smaller) {
  return smaller == Effect::coulomb_friction &&
         (larger == Effect::stribeck_friction || larger == Effect::asymmetric_friction);
}

/// The set with one effect more, less what that effect contains.
std::vector<Effect> extended(std::vector<Effect> effects, Effect more) {
  effects.erase(std::remove_if(effects.begin(), effects.end(), [&](Effect e) { return contains(more, e); }),
                effects.end());
  return with(std::move(effects), more);
}

bool lacks(const Hypothesis& h, Effect e) {
  return std::find(h.effects.begin(), h.effects.end(), e) == h.effects.end();
}

std::size_t parameters_of(const std::vector<Effect>& effects) {
  std::size_t count = 0;
  for (Effect e : effects) count += dynamics::info(e).parameter_count;
  return count;
}

/// The chi-square point of `freedom` degrees at the level that Bonferroni's price for `tries` leaves, from
/// above.
double chi_square_point(double tries, double freedom) {
  return 2.0 * std::log(std::max(tries, 1.0) / kFalseAlarmLevel) + 2.5 * (std::max(freedom, 1.0) - 2.0);
}

double shapes_of(Effect e) { return dynamics::info(e).search.shapes; }

double doubt_of(const std::vector<Effect>& effects) {
  double doubt = 0.0;
  for (Effect e : effects) doubt += dynamics::info(e).search.doubt;
  return doubt;
}

/// Of a law that can take many shapes: whether its size is away from where the effect is not there, by the
/// scatter between windows: a law that fits what differs from window to window is no cause. (Wald's test of
/// the parameters that have such a value; of an effect without one, of its first parameter against zero.)
bool stands_out(const Hypothesis& h, const model::Model& model, Effect e, double tries) {
  std::vector<Eigen::Index> sizes;
  std::vector<double> away;
  const auto neutral = identify::values_in(model, h.unknowns);
  for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
    const auto& u = h.unknowns[i];
    if (!u.of_effect || u.effect != e) continue;
    const auto& p = dynamics::info(e).parameter_table[u.parameter];
    const bool of_model = dynamics::parameter_index(model.kind, name_on(p, model.kind)).has_value();
    if (std::isnan(p.neutral) && !of_model && u.parameter != 0) continue;
    sizes.push_back(static_cast<Eigen::Index>(i));
    away.push_back(h.fit.values[i] -
                   (model.effects.contains(e) ? model.effects.at(e)[u.parameter] : neutral[i]));
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
  return statistic > chi_square_point(tries * shapes_of(e), static_cast<double>(sizes.size()));
}

/// True if every effect's parameters mean something: no effect sits where it is not there or against a
/// physical limit.
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
  return true;
}

std::string names(const std::vector<Effect>& effects) {
  std::string text;
  for (Effect e : effects) text += (text.empty() ? "" : " + ") + std::string(dynamics::info(e).name);
  return text;
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
  if (std::find(effects.begin(), effects.end(), Effect::encoder_slip) == effects.end()) return model;
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
    bool free_anyway = false;
    for (const auto& p : info.parameters()) {
      const auto same = dynamics::parameter_index(model.kind, name_on(p, model.kind));
      free_anyway = free_anyway || (std::isnan(p.neutral) && same && model.free.contains(*same));
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
  const std::vector<double> start = values_from(*this, h.unknowns, from, starts);
  const model::Model base = with_slips(model, recordings, effects);
  h.fit = identify::fit_by_simulation(base, h.unknowns, start, recordings, training.windows,
                                      identify::Weighting::noise, training.layers);
  h.fitted = identify::with_values(base, h.unknowns, h.fit.values);
  h.cross_validated_squares = cross_validate(h.fit, training.windows, recordings.size());
  h.meaningful = within_limits(h) && beyond_resolution(h);
  const auto tries = static_cast<double>(candidates().size());
  for (Effect e : effects)
    if (h.meaningful && shapes_of(e) > 1.0) h.meaningful = stands_out(h, model, e, tries);
  return h;
}

Trainer::Scales Trainer::scales() const {
  double squares = 0.0, inputs = 0.0, rows = 0.0;
  for (const auto& w : training.windows) {
    const auto& r = recordings[w.recording];
    for (std::size_t i = w.first; i <= w.last; ++i) {
      squares += r.velocity_smoothed[i] * r.velocity_smoothed[i];
      inputs += r.input[i] * r.input[i];
      rows += 1.0;
    }
  }
  if (rows == 0.0) return {};
  return {dynamics::info(model.kind).rig == "hopper"
              ? model.parameter("mass_kg") * model.parameter("gravity_mps2")
              : std::sqrt(inputs / rows),
          std::sqrt(squares / rows)};
}

bool Trainer::beyond_resolution(const Hypothesis& h) const {
  const auto& time_s = recordings.front().time_s;
  const double interval_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  const auto beyond = [&](Effect e, double rows) {
    return lacks(h, e) || std::abs(h.fitted.effects.at(e)[0]) > rows * interval_s;
  };
  // A spot as wide as the travel is plain friction.
  if (!lacks(h, Effect::binding_spot)) {
    constexpr double kWidest = 0.7;
    const auto& spot = h.fitted.effects.at(Effect::binding_spot);
    const Proposer::Travel travel = Proposer(*this).travel();
    const double covered =
        std::min(spot[1] + 0.5 * spot[2], travel.high) - std::max(spot[1] - 0.5 * spot[2], travel.low);
    if (covered > kWidest * (travel.high - travel.low)) return false;
  }
  // A switch is read once a row, and bounces; what a row's input is worth until the next one is known to a
  // part of the interval, less where it was measured and not commanded.
  const bool answered = !recordings.front().drive_command.empty();
  return beyond(Effect::contact_delay, 2.0) && beyond(Effect::time_skew, answered ? 1.0 : 0.5) &&
         beyond(Effect::actuator_delay, 0.5);
}

Hypothesis Trainer::fit_new(const std::vector<Effect>& larger, const Hypothesis& on,
                            const Proposal& proposal) const {
  const Effect e = proposal.effect;
  Hypothesis best;
  best.effects = larger;
  best.failed = true;
  const auto try_from = [&](const Hypothesis& from,
                            const std::array<double, dynamics::kMaxEffectParameters>& values) {
    try {
      Hypothesis other = fit(larger, &from, {{e, values}});
      if (best.failed || other.fit.squares < best.fit.squares) best = std::move(other);
    } catch (const log::DataError&) {  // from there the model runs away: no start
    }
  };
  try_from(on, proposal.values);
  if (shapes_of(e) >= dynamics::detail::kManyShapes)
    for (const auto& values : proposal.others) try_from(on, values);
  // Dry friction sticks, which makes a fit's landscape uneven: a second start from a twentieth of what moves
  // the axis; for the Stribeck curve from the constant friction that fits best, twice as large at standstill,
  // over several widths.
  const Scales scale = scales();
  if (e == Effect::coulomb_friction) try_from(on, {0.05 * scale.force});
  if (e == Effect::asymmetric_friction) try_from(on, {0.05 * scale.force, 0.05 * scale.force});
  if (e == Effect::stribeck_friction) {
    if (std::find(larger.begin(), larger.end(), Effect::asymmetric_friction) != larger.end()) return best;
    const Hypothesis flat = fit_new(with(without(larger, e), Effect::coulomb_friction), on,
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

Comparison Trainer::compare(const Hypothesis& smaller, const Hypothesis& larger, std::size_t tries) const {
  Comparison c;
  // The correlation time of what the larger one leaves: what the smaller one leaves holds the effect itself.
  const auto extra =
      static_cast<double>(larger.unknowns.size()) - static_cast<double>(smaller.unknowns.size());
  c.evidence = evidence_of(smaller.fit, larger.fit, larger.fit, training.layers);
  double shapes = 1.0;
  for (Effect e : larger.effects)
    if (std::find(smaller.effects.begin(), smaller.effects.end(), e) == smaller.effects.end())
      shapes = std::max(shapes, shapes_of(e));
  double slips = 0.0;  // each has a place and a size
  for (const auto& r : recordings) slips += static_cast<double>(r.slips.size());
  const bool slipped = lacks(smaller, Effect::encoder_slip) && !lacks(larger, Effect::encoder_slip);
  c.threshold = chi_square_point(static_cast<double>(tries) * shapes, extra + (slipped ? 2.0 * slips : 0.0));
  const double before = squares_of_body(smaller), after = squares_of_body(larger);
  c.gain = 1.0 - after / std::max(before, 1e-300);
  double worth = (before - after) / std::max(reference_squares, 1e-300);
  // An effect that does not move the body is judged by the channel that it moves.
  for (Effect e : larger.effects)
    if (const auto judge = judged_on(e, recordings);
        judge != identify::Channel::motion && lacks(smaller, e)) {
      const auto which = static_cast<std::size_t>(judge);
      c.gain =
          1.0 - channel(larger.fit, which).squares / std::max(channel(smaller.fit, which).squares, 1e-300);
      worth = c.gain;
    }
  c.significant = c.evidence > c.threshold && c.gain > kSmallestGain && worth > kSmallestWorth;
  return c;
}

namespace {

/// Two names of one law: the same free runs to within a ten-thousandth, whatever was to be expected before.
bool the_same(const Hypothesis& one, const Hypothesis& other) {
  return std::abs(one.fit.squares - other.fit.squares) < 1e-4 * other.fit.squares;
}

}  // namespace

double Trainer::preference(const Hypothesis& one, const Hypothesis& other) const {
  return evidence_of(one.fit, other.fit, other.fit, training.layers) + doubt_of(one.effects) -
         doubt_of(other.effects);
}

std::optional<Hypothesis> Trainer::widened(const Hypothesis& refitted) const {
  constexpr double kWider = 4.0;
  model::Model wide = model;
  bool held = false;
  for (std::size_t i = 0; i < refitted.unknowns.size(); ++i) {
    if (!refitted.fit.at_bound[i] || refitted.fit.values[i] == 0.0) continue;
    auto& bounds = wide.free.at(refitted.unknowns[i].parameter);
    bounds = {bounds.lower / kWider, bounds.upper * kWider};
    held = true;
  }
  if (!held) return std::nullopt;
  const Trainer trainer{wide, recordings, training, threads, {}};
  const Hypothesis wider = trainer.fit({}, &refitted);
  const double evidence = evidence_of(refitted.fit, wider.fit, wider.fit, training.layers);
  if (evidence < chi_square_point(1.0, static_cast<double>(wider.unknowns.size())) ||
      wider.fit.squares > (1.0 - kSmallestGain) * refitted.fit.squares)
    return std::nullopt;
  return wider;
}

Selection Trainer::select() {
  Selection s;
  const std::vector<Effect> all = candidates();
  const Proposer proposer(*this);
  const auto tell = [&](double fraction, const std::string& what) {
    if (progress) progress(fraction, what);
  };
  tell(0.0, "re-fitting the model");
  s.refitted = fit({}, nullptr);
  reference_squares = squares_of_body(s.refitted);
  std::vector<Proposal> first_promises;
  s.chosen = s.refitted;
  const std::optional<Hypothesis> wider = widened(s.refitted);
  if (wider && channel(wider->fit, 0).squares < kWithinNoise * channel(wider->fit, 0).rows) {
    s.beyond_bounds = wider;
    return s;
  }

  // Forward: the effect that removes most, if that is more than chance and numerics could; of those that
  // remove as much, the one with the fewest parameters, then the first of the catalogue. Which are worth a
  // fit is seen from one linear step each.
  for (std::size_t round = 0; round < kMostEffects; ++round) {
    std::vector<Effect> left;
    for (Effect e : all)
      if (lacks(s.chosen, e)) left.push_back(e);
    const double from = 0.05 + 0.18 * static_cast<double>(round);
    std::vector<Proposal> proposals = propose(proposer, s.chosen, left, from, 0.09);
    if (round == 0) first_promises = proposals;
    std::vector<Tried> trials(worth_a_fit(proposals, round == 0 ? kMostFits : kMostFits / 2));
    identify::parallel_for(trials.size(), threads, [&](std::size_t i) {
      const std::vector<Effect> larger = extended(s.chosen.effects, proposals[i].effect);
      tell(from + 0.09, names(larger));
      trials[i].hypothesis = fit_new(larger, s.chosen, proposals[i]);
      trials[i].round = round;
      if (!trials[i].hypothesis.failed)
        trials[i].against_smaller = compare(s.chosen, trials[i].hypothesis, left.size());
    });
    std::sort(trials.begin(), trials.end(),
              [](const Tried& a, const Tried& b) { return a.hypothesis.effects < b.hypothesis.effects; });
    const Tried* best = nullptr;
    for (const Tried& t : trials)
      if (t.against_smaller.significant && t.hypothesis.meaningful &&
          (best == nullptr || preference(best->hypothesis, t.hypothesis) > 0.0))
        best = &t;
    if (best != nullptr) {
      const Tried* simplest = best;
      for (const Tried& t : trials) {
        if (!t.against_smaller.significant || !t.hypothesis.meaningful) continue;
        const double lost = t.hypothesis.fit.squares - best->hypothesis.fit.squares;
        const double evidence = preference(t.hypothesis, best->hypothesis);
        const std::size_t size = parameters_of(t.hypothesis.effects),
                          now = parameters_of(simplest->hypothesis.effects);
        const bool as_good =
            size < now ? evidence < kEqualEvidence || lost < kSmallestGain * best->hypothesis.fit.squares
                       : size == now && evidence < kEqualEvidence;
        if (as_good && (size < now || (size == now && &t < simplest))) simplest = &t;
      }
      s.chosen = simplest->hypothesis;
    }
    s.tried.insert(s.tried.end(), trials.begin(), trials.end());
    if (best == nullptr) break;
    prune(s.chosen, all.size());
  }

  // One cause that explains as much as several is the better explanation, even where no step towards it
  // promised so.
  if (s.chosen.effects.size() > 1) {
    tell(0.78, "one cause in the place of several");
    std::vector<Proposal> singles;
    for (const Proposal& p : first_promises)
      if (std::none_of(s.tried.begin(), s.tried.end(),
                       [&](const Tried& t) {
                         return t.round == 0 && t.hypothesis.effects == std::vector<Effect>{p.effect};
                       }) &&
          p.gain > 0.0 && singles.size() < kMostFits)
        singles.push_back(p);
    std::vector<Tried> trials(singles.size());
    identify::parallel_for(singles.size(), threads, [&](std::size_t i) {
      trials[i].hypothesis = fit_new({singles[i].effect}, s.refitted, singles[i]);
      if (!trials[i].hypothesis.failed)
        trials[i].against_smaller = compare(s.refitted, trials[i].hypothesis, all.size());
    });
    std::erase_if(trials, [](const Tried& t) { return t.hypothesis.failed; });
    s.tried.insert(s.tried.end(), trials.begin(), trials.end());
    const Hypothesis* simpler = nullptr;
    for (const Tried& t : s.tried) {
      const Hypothesis& h = t.hypothesis;
      if (h.effects.size() == 1 && t.against_smaller.significant && h.meaningful &&
          preference(s.chosen, h) > -kEqualEvidence &&
          (simpler == nullptr || h.fit.squares < simpler->fit.squares))
        simpler = &h;
    }
    if (simpler != nullptr) s.chosen = Hypothesis(*simpler);
  }

  beam(s, all, proposer);

  // What each member is worth, and which sets do as well in its place with as many parameters; one that does
  // better takes its place.
  for (int round = 0;; ++round) {
    tell(0.8 + 0.05 * round, "what cannot be told apart");
    s.without.assign(s.chosen.effects.size(), {});
    s.against_without.assign(s.chosen.effects.size(), {});
    identify::parallel_for(s.chosen.effects.size(), threads, [&](std::size_t i) {
      s.without[i] = fit(without(s.chosen.effects, s.chosen.effects[i]), &s.chosen);
      s.against_without[i] = compare(s.without[i], s.chosen, all.size());
    });
    s.equals = rivals(s, all, proposer);
    const Selection::Rival* better = nullptr;
    for (const auto& r : s.equals)
      if (preference(s.chosen, r.hypothesis) > kEqualEvidence &&
          (better == nullptr || r.hypothesis.fit.squares < better->hypothesis.fit.squares))
        better = &r;
    if (better == nullptr || round == kMostSwaps) break;
    s.chosen = Hypothesis(better->hypothesis);
    prune(s.chosen, all.size());
  }
  if (wider && preference(s.chosen, *wider) > -kEqualEvidence) s.beyond_bounds = wider;
  return s;
}

std::size_t Trainer::worth_a_fit(std::vector<Proposal>& proposals, std::size_t most) const {
  // What does not move the body promises little beside what does, and dry friction that sticks is badly
  // judged by a linear step: those first, always.
  const auto always = [&](const Proposal& p) {
    const identify::Channel judge = judged_on(p.effect, recordings);
    const bool hardly_seen = judge == identify::Channel::contact || judge == identify::Channel::drive;
    return (hardly_seen && p.gain > 0.0) ||
           (most >= kMostFits &&
            (p.effect == Effect::coulomb_friction ||
             (model.kind != dynamics::Kind::hopper_linear &&
              (p.effect == Effect::asymmetric_friction || p.effect == Effect::stribeck_friction))));
  };
  std::stable_partition(proposals.begin(), proposals.end(), always);
  if (proposals.empty()) return 0;
  const double most_promising =
      std::max_element(proposals.begin(), proposals.end(), [](const auto& a, const auto& b) {
        return a.gain < b.gain;
      })->gain;
  std::size_t count = 0;
  while (count < std::min(most, proposals.size()) &&
         (count < kFewestFits || always(proposals[count]) ||
          proposals[count].gain > kSmallestPromise * most_promising))
    ++count;
  return count;
}

void Trainer::beam(Selection& s, const std::vector<Effect>& all, const Proposer& proposer) const {
  const identify::ChannelShare motion = channel(s.chosen.fit, 0);
  const bool noise_alone = motion.squares < kWithinNoise * motion.rows;
  if (s.chosen.effects.empty() || (s.chosen.effects.size() == 1 && noise_alone)) return;
  // The effect that alone removes most may be a compromise between two causes: pairs that begin with others.
  std::vector<const Tried*> firsts;
  for (const Tried& t : s.tried)
    if (t.round == 0 && t.against_smaller.significant && t.hypothesis.effects.size() == 1)
      firsts.push_back(&t);
  std::sort(firsts.begin(), firsts.end(), [](const Tried* a, const Tried* b) {
    return a->hypothesis.fit.squares < b->hypothesis.fit.squares;
  });
  if (firsts.size() > kBeam) firsts.resize(kBeam);
  std::vector<Tried> pairs;
  for (const Tried* first : firsts) {
    const Hypothesis on = first->hypothesis;
    std::vector<Effect> left;
    for (Effect e : all)
      if (lacks(on, e) && !contains(e, on.effects.front())) left.push_back(e);
    const std::vector<Proposal> proposals = propose(proposer, on, left, 0.78, 0.02);
    std::vector<Tried> trials(std::min(proposals.size(), kFewestFits));
    identify::parallel_for(trials.size(), threads, [&](std::size_t i) {
      trials[i].round = 1;
      trials[i].hypothesis = fit_new(with(on.effects, proposals[i].effect), on, proposals[i]);
      if (!trials[i].hypothesis.failed)
        trials[i].against_smaller = compare(on, trials[i].hypothesis, left.size());
    });
    for (Tried& t : trials)
      if (!t.hypothesis.failed) pairs.push_back(std::move(t));
  }
  const Hypothesis* best = nullptr;
  for (const Tried& t : pairs)
    if (t.against_smaller.significant && t.hypothesis.meaningful &&
        (best == nullptr || preference(*best, t.hypothesis) > 0.0))
      best = &t.hypothesis;
  if (best != nullptr) {
    const auto more = static_cast<double>(parameters_of(best->effects)) -
                      static_cast<double>(parameters_of(s.chosen.effects));
    // Fewer causes for the same; or better ones.
    const double price = more > 0.0 ? chi_square_point(static_cast<double>(all.size()), more)
                         : best->effects.size() < s.chosen.effects.size() ? -kEqualEvidence
                                                                          : kEqualEvidence;
    if (preference(s.chosen, *best) > price) {
      s.chosen = Hypothesis(*best);
      prune(s.chosen, all.size());
    }
  }
  s.tried.insert(s.tried.end(), pairs.begin(), pairs.end());
}

void Trainer::prune(Hypothesis& chosen, std::size_t tries) const {
  for (bool removed = chosen.effects.size() > 1; removed;) {
    removed = false;
    for (Effect e : chosen.effects) {
      Hypothesis smaller = fit(without(chosen.effects, e), &chosen);
      if (compare(smaller, chosen, tries).significant) continue;
      chosen = std::move(smaller);
      removed = chosen.effects.size() > 1;
      break;
    }
  }
}

std::vector<Proposal> Trainer::propose(const Proposer& proposer, const Hypothesis& on,
                                       const std::vector<Effect>& effects, double progress_from,
                                       double progress_share) const {
  std::vector<Proposal> all(effects.size());
  identify::parallel_for(effects.size(), threads, [&](std::size_t i) {
    if (progress)
      progress(progress_from + progress_share * static_cast<double>(i) / static_cast<double>(effects.size()),
               dynamics::info(effects[i]).name);
    all[i] = proposer.best(on, extended(on.effects, effects[i]), effects[i]);
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const Proposal& a, const Proposal& b) { return a.gain > b.gain; });
  return all;
}

std::vector<Selection::Rival> Trainer::rivals(const Selection& s, const std::vector<Effect>& all,
                                              const Proposer& proposer) const {
  struct Replacement {
    Effect of;
    std::vector<Effect> effects;
    const Hypothesis* from;
    Starts starts;
  };
  std::vector<Replacement> replacements;
  for (std::size_t m = 0; m < s.chosen.effects.size(); ++m) {
    const Effect e = s.chosen.effects[m];
    const std::vector<Effect> rest = without(s.chosen.effects, e);
    const std::size_t size = dynamics::info(e).parameter_count;
    std::vector<Effect> usable;
    for (Effect a : all)
      if (std::find(s.chosen.effects.begin(), s.chosen.effects.end(), a) == s.chosen.effects.end() &&
          dynamics::info(a).parameter_count <= size)
        usable.push_back(a);
    const std::vector<Proposal> proposals = propose(proposer, s.without[m], usable, 0.85, 0.1);
    const double lost = s.without[m].fit.squares - s.chosen.fit.squares;
    std::vector<Proposal> single;  // those that alone go some way
    for (const Proposal& p : proposals) {
      if (p.gain * s.without[m].fit.squares > 0.5 * lost && replacements.size() < kMostRivals * (m + 1))
        replacements.push_back({e, with(rest, p.effect), &s.without[m], {{p.effect, p.values}}});
      if (dynamics::info(p.effect).parameter_count < size && single.size() < 5) single.push_back(p);
    }
    for (std::size_t i = 0; i < single.size(); ++i)
      for (std::size_t k = i + 1; k < single.size(); ++k) {
        const Effect a = single[i].effect, b = single[k].effect;
        if (!contains(a, b) && !contains(b, a) &&
            dynamics::info(a).parameter_count + dynamics::info(b).parameter_count == size)
          replacements.push_back(
              {e, with(with(rest, a), b), &s.without[m], {{a, single[i].values}, {b, single[k].values}}});
      }
  }
  std::vector<Hypothesis> fitted(replacements.size());
  identify::parallel_for(replacements.size(), threads, [&](std::size_t i) {
    if (progress) progress(0.95, names(replacements[i].effects));
    const Replacement& r = replacements[i];
    if (r.starts.size() == 1) {
      fitted[i] = fit_new(r.effects, *r.from, {r.starts.begin()->first, r.starts.begin()->second, {}, 0.0});
    } else {
      try {
        fitted[i] = fit(r.effects, r.from, r.starts);
      } catch (const log::DataError&) {
        fitted[i].failed = true;
      }
    }
  });
  std::vector<Selection::Rival> equals;
  for (std::size_t i = 0; i < fitted.size(); ++i)
    if (!fitted[i].failed && fitted[i].meaningful &&
        (preference(fitted[i], s.chosen) < kEqualEvidence || the_same(fitted[i], s.chosen)))
      equals.push_back({replacements[i].of, fitted[i]});
  return equals;
}

}  // namespace furcula::diagnose
