// The release/catch test, see release_catch.hpp.
#include "host/bench/release_catch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/random.hpp"

namespace furcula::bench {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kStands_s = 0.050;
constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

std::size_t ticks(double time_s) { return static_cast<std::size_t>(std::llround(time_s / kTick_s)); }

/// Of sorted values, by linear interpolation.
double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return kNever;
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

Trial run_trial(Board& board, const Conditions& conditions) {
  Trial t;
  t.conditions = conditions;
  const Timing timing{ticks(kRest_s), ticks(conditions.window_s), ticks(kWatch_s)};
  const std::size_t release = timing.rest, caught = release + timing.window, end = caught + timing.watch,
                    stands = ticks(kStands_s);
  t.readings = board.run(conditions, timing);
  require_as_told(t.readings, timing, board.name());
  const auto& r = t.readings;
  // What moves before it is told to is not held, and what does not move after it, not released: nothing to
  // catch.
  for (std::size_t n = 1; n <= release; ++n) t.held = t.held && r[n].count == r[0].count;
  if (!t.held) return t;
  for (std::size_t n = release + 1; n <= end && std::isnan(t.released_after_s); ++n)
    if (r[n].count != r[release].count) t.released_after_s = static_cast<double>(n - release) * kTick_s;
  if (!t.released()) return t;
  // The first standstill after the catch command.
  std::size_t last = caught;
  for (std::size_t n = caught + 1; n <= end && n < last + stands; ++n)
    if (r[n].count != r[n - 1].count) last = n;
  const double end_m = board.travel_m() - 0.5 * board.tooth_pitch_m();
  if (end - last < stands || r[last].count * board.metres_per_count() > end_m) return t;
  t.caught_after_s = static_cast<double>(last - caught) * kTick_s;
  t.drop_m = (r[last].count - r[0].count) * board.metres_per_count();
  t.slipped = std::abs(r[end].count - r[last].count) * board.metres_per_count() > 0.5 * board.tooth_pitch_m();
  return t;
}

void require_as_told(const std::vector<Reading>& rows, const Timing& timing, const std::string& board) {
  if (rows.size() != timing.rows())
    throw core::DataError(board + ": the trial has " + std::to_string(rows.size()) + " rows; expected " +
                          std::to_string(timing.rows()));
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool wanted = n >= timing.rest && n < timing.rest + timing.window;
    if ((rows[n].coil > 0.0) != wanted)
      throw core::DataError(board + ": " + std::to_string(n) + " ms into the trial the coil was " +
                            (wanted ? "off, expected on (has it become too hot?)" : "on, expected off"));
  }
}

log::Log to_log(const Trial& trial, const Board& board, const std::string& path) {
  log::Log log;
  log.path = path;
  log.rig = "clutch_bench";
  log.metadata = {{"sample_rate_hz", "1000"},
                  {"board", board.name()},
                  {"load_kg", core::shortest(trial.conditions.load_kg)},
                  {"window_s", core::shortest(trial.conditions.window_s)},
                  {"supply_v", core::shortest(trial.conditions.supply_v)},
                  {"pressing_n", core::shortest(trial.conditions.pressing_n)}};
  const bool voltage = std::all_of(trial.readings.begin(), trial.readings.end(),
                                   [](const Reading& r) { return std::isfinite(r.voltage_v); });
  const bool current = std::all_of(trial.readings.begin() + 1, trial.readings.end(),
                                   [](const Reading& r) { return std::isfinite(r.current_a); });
  for (std::size_t n = 0; n < trial.readings.size(); ++n) {
    const Reading& r = trial.readings[n];
    log.columns["time_s"].push_back(static_cast<double>(n) * kTick_s);
    log.columns["pulley_angle_rad"].push_back(r.count * board.metres_per_count() / board.pulley_radius_m());
    log.columns["solenoid"].push_back(r.coil > 0.0 ? 1.0 : 0.0);
    if (voltage) log.columns["voltage_v"].push_back(r.voltage_v);
    if (current) log.columns["current_a"].push_back(n == 0 ? 0.0 : r.current_a);
  }
  return log;
}

double holding_load_kg(Board& board, const Conditions& conditions) {
  const auto holds = [&](double load_kg) {
    Conditions c = conditions;
    c.load_kg = load_kg;
    const std::vector<Reading> rows = board.run(c, {ticks(1.0), 0, 0});  // near its limit it creeps
    return std::abs(rows.back().count) * board.metres_per_count() < 0.5 * board.tooth_pitch_m();
  };
  double low = 0.01, high = 0.02;
  if (!holds(low)) return 0.0;
  while (high < 1e3 && holds(high)) {
    low = high;
    high *= 2.0;
  }
  while (high - low > 0.005 * low) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

Summary summarise(const std::vector<Trial>& trials) {
  Summary s{};
  std::vector<double> caught_after, drop;
  s.trials = trials.size();
  std::vector<double> released_after;
  for (const Trial& t : trials) {
    s.slips += t.slipped;
    s.not_held += !t.held;
    s.not_released += t.held && !t.released();
    s.not_caught += t.released() && !t.caught();
    if (t.released()) released_after.push_back(t.released_after_s);
    if (!t.caught()) continue;
    caught_after.push_back(t.caught_after_s);
    drop.push_back(t.drop_m);
  }
  std::sort(caught_after.begin(), caught_after.end());
  std::sort(drop.begin(), drop.end());
  std::sort(released_after.begin(), released_after.end());
  s.released_after_worst_s = quantile(released_after, 1.0);
  s.caught_after_median_s = quantile(caught_after, 0.5);
  s.caught_after_p5_s = quantile(caught_after, 0.05);
  s.caught_after_p95_s = quantile(caught_after, 0.95);
  s.caught_after_worst_s = quantile(caught_after, 1.0);
  s.drop_median_m = quantile(drop, 0.5);
  s.drop_worst_m = quantile(drop, 1.0);
  return s;
}

namespace {

/// What of the limits is asked, of every trial.
std::vector<Check> check(const ReleaseCatch& r, const Limits& limits) {
  std::vector<Check> checks;
  const auto add = [&](std::string_view name, std::string_view unit, double measured,
                       const std::optional<double>& limit, bool at_most) {
    if (!limit) return;
    // What was never measured (NaN) does not pass.
    const bool passed = at_most ? measured <= *limit : measured >= *limit;
    checks.push_back({name, unit, measured, *limit, at_most, passed});
  };
  std::vector<Trial> all{r.standard};
  all.insert(all.end(), r.trials.begin(), r.trials.end());
  const Summary s = summarise(all);
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  const std::size_t never = s.not_held + s.not_released;
  // One that was never held, released or caught fails them.
  const auto of_all = [](double worst, std::size_t missing) { return missing == 0 ? worst : kNever; };
  add("caught_after_max_s", "s", of_all(s.caught_after_worst_s, never + s.not_caught),
      limits.caught_after_max_s, true);
  add("released_after_max_s", "s", of_all(s.released_after_worst_s, never), limits.released_after_max_s,
      true);
  add("drop_max_m", "m", of_all(s.drop_worst_m, never + s.not_caught), limits.drop_max_m, true);
  add("not_caught_max", "", count(s.not_caught), limits.not_caught_max, true);
  add("slips_max", "", count(s.slips), limits.slips_max, true);
  add("holding_min_kg", "kg", r.holding_kg, limits.holding_min_kg, false);
  if (checks.empty()) return checks;
  add("not_held_max", "", count(s.not_held), 0.0, true);
  add("not_released_max", "", count(s.not_released), limits.not_released_max.value_or(0.0), true);
  return checks;
}

}  // namespace

ReleaseCatch run_release_catch(Board& board, const Options& options, const Limits& limits) {
  ReleaseCatch out;
  out.board = board.name();
  out.options = options;
  const auto tell = [&](double fraction, std::string_view doing) {
    if (options.progress) options.progress(fraction, doing);
  };
  const bool adjusts_all = board.adjusts() == Adjusts::everything;
  if (!adjusts_all && limits.holding_min_kg)
    throw core::DataError(out.board +
                          ": holding_min_kg is asked for, and this board cannot set the load: leave it " +
                          "out of the limits");
  tell(0.0, "the trial as given");
  out.standard = run_trial(board, options.conditions);

  core::Random random(options.seed, 1);
  for (std::size_t i = 0; i < options.trials; ++i) {
    tell(0.8 * static_cast<double>(i) / static_cast<double>(options.trials), "varied trials");
    Conditions c = options.conditions;
    const double load = random.uniform(-options.load_share, options.load_share),
                 window_s = random.uniform(-options.window_s, options.window_s),
                 supply = random.uniform(-options.supply_share, options.supply_share);
    c.window_s = std::max(kTick_s, c.window_s + window_s);
    if (adjusts_all) {
      c.load_kg *= 1.0 + load;
      c.supply_v *= 1.0 + supply;
    }
    Trial t = run_trial(board, c);
    const auto badness = [](const Trial& x) { return x.caught() ? x.caught_after_s : 1e9; };
    if (out.trials.empty() || badness(t) > badness(out.trials[out.worst])) {
      if (!out.trials.empty()) out.trials[out.worst].readings.clear();
      out.worst = out.trials.size();
    } else {
      t.readings.clear();
    }
    out.trials.push_back(std::move(t));
  }
  out.summary = summarise(out.trials);

  tell(0.8, "sweeps");
  const auto sweep = [&](std::string_view of, double Conditions::*member, std::vector<double> values) {
    Sweep s{of, std::move(values), {}};
    for (const double value : s.values) {
      Conditions c = options.conditions;
      c.*member = value;
      s.trials.push_back(run_trial(board, c));
      s.trials.back().readings.clear();
    }
    out.sweeps.push_back(std::move(s));
  };
  const Conditions& c = options.conditions;
  if (adjusts_all)
    sweep("load_kg", &Conditions::load_kg,
          {0.25 * c.load_kg, 0.5 * c.load_kg, c.load_kg, 1.5 * c.load_kg, 2.0 * c.load_kg, 3.0 * c.load_kg});
  sweep("window_s", &Conditions::window_s,
        {0.5 * c.window_s, 0.75 * c.window_s, c.window_s, 1.25 * c.window_s, 1.5 * c.window_s,
         2.0 * c.window_s});
  if (adjusts_all)
    sweep("pressing_n", &Conditions::pressing_n,
          {0.5 * c.pressing_n, 0.75 * c.pressing_n, c.pressing_n, 1.25 * c.pressing_n, 1.5 * c.pressing_n});

  tell(0.9, "holding load");
  if (!adjusts_all) out.holding_kg = kNever;
  for (const double share : {0.25, 0.5, 0.75, 1.0, 1.25, 1.5}) {
    if (!adjusts_all) break;
    Conditions at = c;
    at.pressing_n = share * c.pressing_n;
    out.holding.push_back({at.pressing_n, holding_load_kg(board, at)});
    if (share == 1.0) out.holding_kg = out.holding.back().load_kg;
  }
  tell(1.0, "done");

  out.checks = check(out, limits);
  out.passed = std::all_of(out.checks.begin(), out.checks.end(), [](const Check& x) { return x.passed; });
  return out;
}

}  // namespace furcula::bench
