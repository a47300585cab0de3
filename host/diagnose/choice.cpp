#include "host/diagnose/choice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/exclusion.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

/// Whether inputs are a drive's, of which a log may have what is measured at each row's time, or what acts until the next.
bool has_drive(dynamics::Kind kind) {
  const machines::Columns& columns = machines::rules(kind).columns;
  return !columns.input.empty() && columns.touchdown.empty() && !ends_on_teeth(kind);
}

/// By how much earlier than they stand there inputs act, rows: from where they are held from their rows on to where they are measured at the
/// rows' times.
constexpr double kMostEarly_rows = 0.5;

/// The share of a row by which inputs act early that leaves least with these causes. What is left is nearly a parabola of it, of each window.
/// Where the windows are not sure of it, what is usual: held inputs or measured ones, whichever leaves less; and where they are not sure of that
/// either, what it is with `data`.
double likeliest_early_rows(const model::Model& model, const DataSet& data, const EffectSet& effects,
                            const Hypothesis* from, unsigned threads) {
  constexpr double kSurely = 2.0;  // standard errors
  constexpr double kStep = 0.5 * kMostEarly_rows;
  const auto left = [&](double early_rows) {
    const DataSet of = data.with_inputs(early_rows);
    const Trainer trainer{model, of.training(), of.training_windows(), threads};
    std::vector<double> squares;
    for (const identify::WindowShare& s : trainer.fit(effects, from).fit.shares)
      squares.push_back(s[identify::Channel::motion].squares);
    return squares;
  };
  const std::vector<double> held = left(0.0), between = left(kStep), measured = left(kMostEarly_rows);
  if (held.size() != between.size() || held.size() != measured.size()) return data.early_rows();
  // y(x) = y(1) + slope (x - 1) + curve (x - 1)^2, x in steps.
  const auto at = [](double y0, double y1, double y2, double x) {
    return y1 + 0.5 * (y2 - y0) * (x - 1.0) + 0.5 * (y0 - 2.0 * y1 + y2) * (x - 1.0) * (x - 1.0);
  };
  const auto sum = [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
  };
  const double y0 = sum(held), y1 = sum(between), y2 = sum(measured), curve = y0 - 2.0 * y1 + y2;
  const double best = curve > 0.0 ? std::clamp(1.0 + 0.5 * (y0 - y2) / curve, 0.0, 2.0)
                      : y0 <= y2  ? 0.0
                                  : 2.0;
  const auto surely_less = [&](double x, double than) {
    double gain = 0.0, scatter = 0.0;
    for (std::size_t i = 0; i < held.size(); ++i) {
      const double more =
          at(held[i], between[i], measured[i], than) - at(held[i], between[i], measured[i], x);
      gain += more;
      scatter += more * more;
    }
    return gain > kSurely * std::sqrt(scatter * static_cast<double>(data.training_windows().layers));
  };
  const double usual = y0 <= y2 ? 0.0 : 2.0, now = data.early_rows() / kStep,
               likeliest = surely_less(best, usual) ? best : usual;
  return surely_less(likeliest, now) ? likeliest * kStep : data.early_rows();
}

/// Lowers the bound to what `h` leaves of most windows; whether that is clearly less.
bool bound_by(DataSet& data, const Hypothesis& h) {
  constexpr double kClearly = 0.7;
  const double most = identify::most_squares_of(h.fit.shares);
  if (!(most < kClearly * data.training_windows().most_squares)) return false;
  data.bound_squares(most);
  return true;
}

/// Of a belt, a fall that ends on another tooth must not outweigh the others: each counts by a loss that is bounded, by the size of most
/// of them as the re-fitted model leaves them, and then as what is chosen does.
Selection selected(const model::Model& model, DataSet& data, const Options& options) {
  const bool jumps = ends_on_teeth(model.kind);
  const auto select_now = [&](double from) {
    const Progress half = [&](double fraction, std::string_view what) {
      options.progress(from + 0.5 * fraction, what);
    };
    return select(model, data.training(), data.training_windows(), options.threads,
                  jumps && options.progress ? half : options.progress, options.without);
  };
  constexpr int kRounds = 4;
  for (int round = 0; jumps && round < kRounds; ++round)
    if (!bound_by(data,
                  Trainer{model, data.training(), data.training_windows(), options.threads}.fit({}, nullptr)))
      break;
  Selection selection = select_now(0.0);
  if (jumps && bound_by(data, selection.chosen)) selection = select_now(0.5);
  return selection;
}

bool is_late(const Hypothesis& h) {
  return holds(h.effects, Effect::actuator_delay) || holds(h.effects, Effect::actuator_lag) ||
         holds(h.effects, Effect::time_skew);
}

}  // namespace

DataSet with_likelier_inputs(const model::Model& model, DataSet data, unsigned threads) {
  if (!has_drive(model.kind)) return data;
  const Trainer trainer{model, data.training(), data.training_windows(), threads};
  if (trainer.widened(trainer.fit({}, nullptr))) return data;  // bounds exclude what the recordings say
  // Beside dry friction, which nearly every drive has: without it, what it leaves would look as if inputs were early or late.
  const double early_rows = likeliest_early_rows(model, data, {Effect::coulomb_friction}, nullptr, threads);
  return early_rows == data.early_rows() ? data : data.with_inputs(early_rows);
}

/// The causes may be why inputs seemed to act early: the better end of two searches counts. A drive that is late is late after a command, and
/// that is held.
Selection choose_causes(const model::Model& model, DataSet& data, const Options& options) {
  Selection selection = selected(model, data, options);
  const Hypothesis& chosen = selection.chosen;
  const bool late = is_late(chosen);
  if (chosen.effects.empty() || !has_drive(model.kind)) return selection;
  const double early_rows =
      late ? 0.0 : likeliest_early_rows(model, data, chosen.effects, &chosen, options.threads);
  if (early_rows == data.early_rows()) return selection;
  DataSet other = data.with_inputs(early_rows);
  Selection again = selected(model, other, options);
  if (late ? !is_late(again.chosen) : !(again.chosen.fit.squares < chosen.fit.squares)) return selection;
  data = std::move(other);
  return again;
}

std::optional<identify::Disagreement> odd_recording(const model::Model& model, const DataSet& data,
                                                    const Selection& selection, unsigned threads) {
  if (holds(selection.chosen.effects, Effect::encoder_slip)) return std::nullopt;
  std::vector<const Hypothesis*> sets;
  std::vector<identify::FittedSet> fitted;
  const auto add = [&](const Hypothesis& h) {
    if (h.failed) return;
    sets.push_back(&h);
    fitted.push_back({with_slips(model, data.training(), h.effects), h.unknowns, h.fit});
  };
  add(selection.chosen);
  add(selection.refitted);
  for (const Hypothesis& h : selection.without) add(h);
  for (const Tried& t : selection.tried)
    if (t.round == 0) add(t.hypothesis);
  const Trainer trainer{model, data.training(), data.training_windows(), threads};
  return identify::disagreeing(fitted, data.training(), data.training_windows().windows,
                               [&](std::size_t set, std::size_t recording, const identify::Fit& without) {
                                 return log_odds_of_another(trainer, selection, *sets[set], recording,
                                                            without) > 0.0;
                               });
}

}  // namespace furcula::diagnose
