// See of_axis.hpp.
#include "host/traces/of_axis.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host/identify/manoeuvres.hpp"
#include "host/identify/prediction.hpp"
#include "host/identify/recording.hpp"
#include "host/identify/simulate.hpp"
#include "host/identify/units.hpp"
#include "host/identify/windows.hpp"
#include "host/machines/rules.hpp"

namespace furcula::traces {
namespace {

using identify::Recording;
using identify::Window;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kDiverged = std::numeric_limits<double>::infinity();

struct Columns {
  LogTraces traces;
  std::optional<std::size_t> velocity, leg_angle,
      drive;  ///< places among the quantities; the position is the first
};

Columns columns_of(const Recording& r, const machines::Rules& rules, std::size_t models) {
  Columns out;
  out.traces.log = r.name;
  out.traces.time_s = r.time_s;
  out.traces.window.assign(r.rows(), 0);
  const identify::ChannelNames names = identify::channel_names(r.kind);
  const auto add = [&](std::string_view column, const std::string& unit,
                       const std::vector<double>& measured) {
    const std::vector<double> none(r.rows(), kNone);
    out.traces.quantities.push_back(
        {std::string(column), unit, measured, std::vector<std::vector<double>>(models, none)});
    return out.traces.quantities.size() - 1;
  };
  add(rules.columns.position, names.position_unit, r.position);
  if (r.velocity_recorded) out.velocity = add(rules.columns.velocity, names.position_unit + "/s", r.velocity);
  if (!r.leg_angle.empty()) out.leg_angle = add(rules.columns.leg_angle, "rad", r.leg_angle);
  const std::string_view drive = rules.columns.report.empty() ? rules.columns.input : rules.columns.report;
  if (!r.drive.empty()) out.drive = add(drive, drive.ends_with("_nm") ? "N m" : "N", r.drive);
  return out;
}

double number(double predicted) { return std::isnan(predicted) ? kDiverged : predicted; }

/// Fills in what the model predicts over a window.
void predict(const model::Model& model, std::size_t index, const Recording& r, const Window& w,
             const identify::StartState& start, Columns& out) {
  const identify::PlantSetup<double> setup(model, {}, nullptr);
  const std::size_t number_of_window = out.traces.window[w.last];
  const auto put = [&](std::size_t quantity, std::size_t row, double value) {
    if (out.traces.window[row] == number_of_window)
      out.traces.quantities[quantity].predicted[index][row] = number(value);
  };
  double off = 0.0;
  std::vector<double> leg;
  identify::simulate(setup, r, w, start.position, start.velocity,
                     [&](std::size_t row, double x, double v, double, const auto& leg_angle) {
                       put(0, row, x);
                       if (out.velocity) put(*out.velocity, row, v);
                       if (!out.leg_angle) return;
                       leg.push_back(leg_angle());
                       off += (leg.back() - r.leg_angle[row]) / static_cast<double>(w.rows());
                     });
  for (std::size_t i = 0; i < leg.size(); ++i) put(*out.leg_angle, w.first + i, leg[i] - off);
  if (!out.drive) return;
  identify::simulate(setup, r, w, r.position[w.first], r.velocity_smoothed[w.first],
                     [&](std::size_t row, double, double, double drive, const auto&) {
                       if (row < w.last) put(*out.drive, row, drive);
                     });
}

std::vector<Recording> recordings_of(const std::vector<log::Log>& logs, const model::Model& model) {
  if (logs.empty()) return {};
  std::vector<Recording> all = identify::make_recordings(logs, model.kind);
  identify::follow_manoeuvres(all, model);
  identify::keep_plausible_leg_angles(all, model);
  identify::mend_velocities(all);
  return all;
}

Traces traces_of(const std::vector<AxisModel>& models, const model::Model& starts_from,
                 const std::vector<Recording>& recordings, double window_s) {
  Traces out;
  for (const AxisModel& m : models) out.models.push_back(m.name);
  const machines::Rules& rules = machines::rules(starts_from.kind);
  std::vector<Columns> all;
  for (const Recording& r : recordings) all.push_back(columns_of(r, rules, models.size()));
  const std::vector<Window> windows = identify::prediction_windows(recordings, starts_from, window_s);
  const std::vector<identify::StartState> starts = identify::start_states(recordings, windows, starts_from);
  std::vector<std::size_t> count(recordings.size(), 0);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    Columns& columns = all[w.recording];
    ++count[w.recording];
    for (std::size_t row = w.first; row <= w.last; ++row)
      if (columns.traces.window[row] == 0) columns.traces.window[row] = count[w.recording];
    for (std::size_t m = 0; m < models.size(); ++m)
      predict(models[m].model, m, recordings[w.recording], w, starts[k], columns);
  }
  for (Columns& c : all) out.logs.push_back(std::move(c.traces));
  return out;
}

}  // namespace

Traces of_axis(const std::vector<AxisModel>& models, const model::Model& starts_from,
               const std::vector<log::Log>& training, const std::vector<log::Log>& held_out,
               double window_s) {
  const std::vector<Recording> first = recordings_of(training, starts_from);
  std::vector<Recording> second = recordings_of(held_out, starts_from);
  identify::keep_warm(second, first);
  Traces of_first = traces_of(models, starts_from, first, window_s);
  return held_out.empty() ? std::move(of_first)
                          : joined(std::move(of_first), traces_of(models, starts_from, second, window_s));
}

}  // namespace furcula::traces
