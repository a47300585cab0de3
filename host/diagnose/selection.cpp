#include "host/diagnose/selection.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "host/identify/parallel.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr std::size_t kMostEffects = 4;
/// An effect that removes less than this share of what the re-fitted model leaves (measuring noise included)
/// is not worth a name: differences of numerics between two honest simulators are of that size.
constexpr double kSmallestGain = 0.04;
/// Two sets whose evidence differs by less than this explain the data equally well (odds of about 20 to 1).
constexpr double kEqualEvidence = 6.0;
constexpr double kFalseAlarmLevel = 0.005;

double squares_of(const identify::Fit& fit) { return std::max(fit.squares, 1e-300); }

double effective_rows(const identify::Fit& fit) {
  double sum = 0.0;
  for (const auto& s : fit.shares) sum += s.effective_rows;
  return sum;
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

/// Root mean square of the velocity over the training windows: the scale of a Stribeck velocity.
double velocity_scale(const Trainer& t) {
  double squares = 0.0, rows = 0.0;
  for (const auto& w : t.training.windows)
    for (std::size_t i = w.first; i <= w.last; ++i) {
      const double v = t.recordings[w.recording].velocity_smoothed[i];
      squares += v * v;
      rows += 1.0;
    }
  return rows > 0.0 ? std::sqrt(squares / rows) : 1.0;
}

/// What moves the axis: the root mean square of the input force, on the hopper the weight.
double force_scale(const Trainer& t) {
  if (t.model.kind == dynamics::Kind::hopper_linear)
    return t.model.parameter("mass_kg") * t.model.parameter("gravity_mps2");
  double squares = 0.0, rows = 0.0;
  for (const auto& r : t.recordings)
    for (double u : r.input) {
      squares += u * u;
      rows += 1.0;
    }
  return rows > 0.0 ? std::sqrt(squares / rows) : 1.0;
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

std::size_t parameters_of(const std::vector<Effect>& effects) {
  std::size_t count = 0;
  for (Effect e : effects) count += dynamics::info(e).parameter_count;
  return count;
}

/// True if every effect's parameters mean something: no effect sits where it is not there or against a
/// physical limit.
bool meaningful(const Hypothesis& h) {
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect && h.fit.at_bound[i]) return false;
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

std::vector<Effect> Trainer::candidates() const {
  std::vector<Effect> all;
  for (const auto& info : dynamics::kCatalogue) {
    if (!applies(info.effect, model.kind)) continue;  // one that is on may have the wrong size
    bool free_anyway = false;
    for (const auto& p : info.parameters()) {
      const auto same = dynamics::parameter_index(model.kind, name_on(p, model.kind));
      free_anyway = free_anyway || (same && model.free.contains(*same));
    }
    // The loss at touch-down is held in the model by the name restitution_touchdown, the spring's rate by
    // stiffness_npm: where those are free, identification has moved them already.
    if (!free_anyway) all.push_back(info.effect);
  }
  return all;
}

Hypothesis Trainer::fit(const std::vector<Effect>& effects, const Hypothesis* from) const {
  Hypothesis h;
  h.effects = effects;
  h.unknowns = identify::free_unknowns(model);
  for (Effect e : effects) {
    const auto more = identify::effect_unknowns(e, model.kind);
    h.unknowns.insert(h.unknowns.end(), more.begin(), more.end());
  }
  std::vector<double> start = identify::values_in(from != nullptr ? from->fitted : model, h.unknowns);
  std::vector<std::vector<double>> starts{start};
  const auto place = [&](Effect e, std::size_t parameter) {
    for (std::size_t i = 0; i < h.unknowns.size(); ++i)
      if (h.unknowns[i].of_effect && h.unknowns[i].effect == e && h.unknowns[i].parameter == parameter)
        return i;
    return h.unknowns.size();
  };
  const auto add_flat_start = [&](const std::vector<std::size_t>& places) {
    // Dry friction sticks, which makes a fit's landscape uneven: a second start from a twentieth of what
    // moves the axis.
    std::vector<double> other = start;
    for (std::size_t i : places) other[i] = 0.05 * force_scale(*this);
    starts.push_back(other);
  };
  const auto is_new = [&](Effect e) {
    return std::find(effects.begin(), effects.end(), e) != effects.end() &&
           (from == nullptr || !from->fitted.effects.contains(e));
  };
  if (is_new(Effect::coulomb_friction)) add_flat_start({place(Effect::coulomb_friction, 0)});
  if (is_new(Effect::asymmetric_friction))
    add_flat_start({place(Effect::asymmetric_friction, 0), place(Effect::asymmetric_friction, 1)});
  if (is_new(Effect::stribeck_friction)) {
    // The curve starts from the constant friction that fits best, twice as large at standstill, over several
    // widths.
    const bool has_coulomb =
        std::find(effects.begin(), effects.end(), Effect::coulomb_friction) != effects.end();
    double level = 0.0;
    if (!has_coulomb) {
      const Hypothesis flat =
          fit(with(without(effects, Effect::stribeck_friction), Effect::coulomb_friction), from);
      level = flat.fitted.effects.at(Effect::coulomb_friction)[0];
      start = identify::values_in(flat.fitted, h.unknowns);
    }
    starts.clear();
    const double scale = velocity_scale(*this);
    for (double width : {0.03, 0.1, 0.3}) {
      start[place(Effect::stribeck_friction, 0)] = 0.8 * level;
      start[place(Effect::stribeck_friction, 1)] = 1.6 * level + 1e-3;
      start[place(Effect::stribeck_friction, 2)] = width * scale;
      starts.push_back(start);
    }
  }
  for (const auto& s : starts) {
    identify::Fit trial = identify::fit_by_simulation(model, h.unknowns, s, recordings, training.windows,
                                                      identify::Weighting::noise, training.layers);
    if (h.fit.values.empty() || trial.squares < h.fit.squares) h.fit = std::move(trial);
  }
  h.fitted = identify::with_values(model, h.unknowns, h.fit.values);
  h.cross_validated_squares = cross_validate(h.fit, training.windows, recordings.size());
  return h;
}

Comparison Trainer::compare(const Hypothesis& smaller, const Hypothesis& larger, std::size_t tries) const {
  Comparison c;
  // The correlation time of what the larger one leaves: what the smaller one leaves holds the effect itself.
  const double rows = std::max(effective_rows(larger.fit) / static_cast<double>(training.layers), 2.0);
  const auto extra =
      static_cast<double>(larger.unknowns.size()) - static_cast<double>(smaller.unknowns.size());
  c.evidence = rows * std::log(squares_of(smaller.fit) / squares_of(larger.fit));
  // The chi-square point of the extra parameters at the level that Bonferroni's price for having tried many
  // leaves.
  c.threshold = 2.0 * std::log(static_cast<double>(std::max<std::size_t>(tries, 1)) / kFalseAlarmLevel) +
                2.5 * (std::max(extra, 1.0) - 2.0);
  c.gain = 1.0 - larger.cross_validated_squares / std::max(smaller.cross_validated_squares, 1e-300);
  c.significant = c.evidence > c.threshold && c.gain > kSmallestGain;
  return c;
}

Selection Trainer::select() const {
  Selection s;
  const std::vector<Effect> all = candidates();
  const auto tell = [&](double fraction, const std::string& what) {
    if (progress) progress(fraction, what);
  };
  tell(0.0, "re-fitting the model");
  s.refitted = fit({}, nullptr);
  s.chosen = s.refitted;

  // Forward: the effect that removes most, if that is more than chance and numerics could; of those that
  // remove as much, the one with the fewest parameters, then the first of the catalogue.
  for (std::size_t round = 0; round < kMostEffects; ++round) {
    std::vector<Effect> left;
    for (Effect e : all)
      if (std::find(s.chosen.effects.begin(), s.chosen.effects.end(), e) == s.chosen.effects.end())
        left.push_back(e);
    std::vector<Tried> trials(left.size());
    identify::parallel_for(left.size(), threads, [&](std::size_t i) {
      const std::vector<Effect> larger = extended(s.chosen.effects, left[i]);
      tell(0.1 + 0.2 * static_cast<double>(round), names(larger));
      trials[i].hypothesis = fit(larger, &s.chosen);
      trials[i].round = round;
      trials[i].against_smaller = compare(s.chosen, trials[i].hypothesis, left.size());
    });
    const Tried* best = nullptr;
    for (const Tried& t : trials)
      if (t.against_smaller.significant && meaningful(t.hypothesis) &&
          (best == nullptr || t.hypothesis.fit.squares < best->hypothesis.fit.squares))
        best = &t;
    if (best != nullptr) {
      const double rows = effective_rows(best->hypothesis.fit) / static_cast<double>(training.layers);
      const Tried* simplest = best;
      for (const Tried& t : trials) {
        if (!t.against_smaller.significant || !meaningful(t.hypothesis)) continue;
        const double lost = t.hypothesis.fit.squares - best->hypothesis.fit.squares;
        const double evidence =
            rows * std::log(squares_of(t.hypothesis.fit) / squares_of(best->hypothesis.fit));
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

    // Backward: a member that the others have made needless goes.
    for (bool removed = s.chosen.effects.size() > 1; removed;) {
      removed = false;
      for (Effect e : s.chosen.effects) {
        Hypothesis smaller = fit(without(s.chosen.effects, e), &s.chosen);
        if (compare(smaller, s.chosen, all.size()).significant) continue;
        s.chosen = std::move(smaller);
        removed = s.chosen.effects.size() > 1;
        break;
      }
    }
  }

  // What each member is worth, and which sets do as well in its place with as many parameters.
  tell(0.8, "what cannot be told apart");
  for (Effect e : s.chosen.effects) {
    s.without.push_back(fit(without(s.chosen.effects, e), &s.chosen));
    s.against_without.push_back(compare(s.without.back(), s.chosen, all.size()));
  }
  struct Replacement {
    Effect of;
    std::vector<Effect> effects;
  };
  std::vector<Replacement> replacements;
  for (Effect e : s.chosen.effects) {
    const std::vector<Effect> rest = without(s.chosen.effects, e);
    const std::size_t size = dynamics::info(e).parameter_count;
    const auto usable = [&](Effect a) {
      return std::find(s.chosen.effects.begin(), s.chosen.effects.end(), a) == s.chosen.effects.end();
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!usable(all[i])) continue;
      const std::size_t first = dynamics::info(all[i]).parameter_count;
      if (first == size) replacements.push_back({e, with(rest, all[i])});
      for (std::size_t k = i + 1; k < all.size(); ++k)
        if (usable(all[k]) && !contains(all[i], all[k]) && !contains(all[k], all[i]) &&
            first + dynamics::info(all[k]).parameter_count == size)
          replacements.push_back({e, with(with(rest, all[i]), all[k])});
    }
  }
  std::vector<Hypothesis> rivals(replacements.size());
  identify::parallel_for(replacements.size(), threads, [&](std::size_t i) {
    tell(0.9, names(replacements[i].effects));
    rivals[i] = fit(replacements[i].effects, &s.refitted);
  });
  const double rows = effective_rows(s.chosen.fit) / static_cast<double>(training.layers);
  for (std::size_t i = 0; i < rivals.size(); ++i)
    if (meaningful(rivals[i]) &&
        rows * std::log(squares_of(rivals[i].fit) / squares_of(s.chosen.fit)) < kEqualEvidence)
      s.equals.push_back({replacements[i].of, rivals[i]});
  return s;
}

}  // namespace furcula::diagnose
