// The release/catch test: against a stand whose motion is known, and against the simulated one.
#include "host/bench/release_catch.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

#include "host/bench/sim_board.hpp"

using namespace furcula;
using namespace furcula::bench;

namespace {

/// The weight falls freely from `releases_s` after the coil went on until `catches_s` after it went off; from
/// `slips_s` after that on it is 5 mm lower. All from the law of falling.
class Falling final : public Board {
 public:
  double releases_s = 0.008, catches_s = 0.030, slips_s = 1e9;
  std::string name() const override { return "falling"; }
  double metres_per_count() const override { return 1e-5; }
  double pulley_radius_m() const override { return 0.01; }
  double tooth_pitch_m() const override { return 0.003; }
  double travel_m() const override { return 10.0; }
  std::vector<Reading> run(const Conditions&, const Timing& timing) override {
    const double on_s = 1e-3 * static_cast<double>(timing.rest),
                 off_s = on_s + 1e-3 * static_cast<double>(timing.window);
    std::vector<Reading> rows(timing.rows());
    for (std::size_t n = 0; n < rows.size(); ++n) {
      const double time_s = 1e-3 * static_cast<double>(n);
      const double fall_s = std::min(time_s, off_s + catches_s) - on_s - releases_s;
      const bool released = timing.window > 0 && fall_s > 0.0;
      const double fell = released ? 4.905 * fall_s * fall_s : 0.0;
      const double slipped = time_s > off_s + catches_s + slips_s ? 0.005 : 0.0;
      rows[n].count = static_cast<std::int32_t>(std::lround((fell + slipped) / 1e-5));
      rows[n].coil = n >= timing.rest && n < timing.rest + timing.window ? 1.0 : 0.0;
    }
    return rows;
  }
};

}  // namespace

TEST_CASE("Release, catch and drop are read from the encoder alone") {
  Falling board;
  const Trial t = run_trial(board, {});
  CHECK(t.released_after_s == Approx(0.009).margin(1.1e-3));
  CHECK(t.caught_after_s == Approx(0.030).margin(1.1e-3));
  CHECK(t.drop_m == Approx(4.905 * 0.062 * 0.062).margin(2e-5));
  CHECK_FALSE(t.slipped);
  CHECK(t.readings.size() == 561);
}

TEST_CASE("A weight that moves again after it stood has slipped, one that never stands is not caught") {
  Falling board;
  board.slips_s = 0.2;
  CHECK(run_trial(board, {}).slipped);
  board.slips_s = 1e9;
  board.catches_s = 1e9;
  const Trial falls = run_trial(board, {});
  CHECK_FALSE(falls.caught());
  CHECK(std::isfinite(falls.released_after_s));
  board.releases_s = 1e9;
  const Trial hangs = run_trial(board, {});
  CHECK(std::isnan(hangs.released_after_s));
  CHECK_FALSE(hangs.caught());
  CHECK(hangs.held);
}

TEST_CASE("On the simulated bench 1 kg is caught 20 to 50 ms after a window of 40 ms, at a tooth") {
  SimBoard board;
  const Trial t = run_trial(board, {});
  CHECK(t.caught_after_s >= 0.020);
  CHECK(t.caught_after_s <= 0.050);
  CHECK(t.released_after_s <= 0.020);
  CHECK_FALSE(t.slipped);
  const double teeth = t.drop_m / board.tooth_pitch_m();
  CHECK(teeth == Approx(std::round(teeth)).margin(0.02));
  CHECK(teeth > 0.9);
}

TEST_CASE("A weight that comes to rest at the end of its way is not caught") {
  SimBoard board;
  Conditions c;
  c.window_s = 0.080;  // too fast for the key to fall into a gap
  const Trial t = run_trial(board, c);
  CHECK_FALSE(t.caught());
  CHECK(t.readings.back().count * board.metres_per_count() == Approx(0.5).margin(1e-4));
}

TEST_CASE("What the clutch holds grows in proportion to the pressing force") {
  SimBoard board;
  const auto law = dynamics::bench_clutch<double>();
  for (const double pressing_n : {2.0, 6.0, 12.0}) {
    Conditions c;
    c.pressing_n = pressing_n;
    const double expected = (law.holding_ratio * pressing_n + law.cable_friction_n) / 9.81;
    CHECK(holding_load_kg(board, c) == Approx(expected).epsilon(0.006));
  }
}

TEST_CASE("1,000 trials with load, window and supply varied: what is caught, when, and what is not") {
  SimBoard board;
  Options options;
  options.trials = 1000;
  options.seed = 1;
  const ReleaseCatch r = run_release_catch(board, options, {});
  const Summary& s = r.summary;
  std::printf(
      "1,000 trials: caught after %.0f ms (median), %.0f to %.0f ms (5 to 95 %%), %.0f ms (worst), drop up to "
      "%.1f mm; %zu not caught, %zu slipped\n",
      1e3 * s.caught_after_median_s, 1e3 * s.caught_after_p5_s, 1e3 * s.caught_after_p95_s,
      1e3 * s.caught_after_worst_s, 1e3 * s.drop_worst_m, s.not_caught, s.slips);
  CHECK(s.trials == 1000);
  CHECK(s.not_released == 0);
  CHECK(s.slips == 0);
  CHECK(s.caught_after_median_s >= 0.020);
  CHECK(s.caught_after_median_s <= 0.050);
  CHECK(s.not_caught < 500);
  // The worst keeps its readings.
  CHECK(r.trials[r.worst].readings.size() > 500);
  const auto worse = [&](const Trial& t) {
    return r.trials[r.worst].caught() && (!t.caught() || t.caught_after_s > r.trials[r.worst].caught_after_s);
  };
  CHECK(std::none_of(r.trials.begin(), r.trials.end(), worse));
}

TEST_CASE("A coil that never pulls, or a load that is not held, passes no limit") {
  SimBoard board;
  Options options;
  options.trials = 5;
  options.conditions.supply_v = 3.0;
  Limits limits;
  limits.slips_max = 0.0;
  const ReleaseCatch dead = run_release_catch(board, options, limits);
  CHECK(dead.summary.not_released == 5);
  CHECK_FALSE(dead.passed);
  options.conditions.supply_v = 12.0;
  options.conditions.load_kg = 50.0;
  const ReleaseCatch heavy = run_release_catch(board, options, limits);
  CHECK_FALSE(heavy.standard.held);
  CHECK(std::isnan(heavy.standard.released_after_s));
  CHECK(heavy.summary.not_held == 5);
  CHECK_FALSE(heavy.passed);
}

TEST_CASE("Limits are judged on every trial: one that is never caught fails them") {
  Falling board;
  Options options;
  options.trials = 10;
  Limits limits;
  limits.caught_after_max_s = 0.035;
  limits.drop_max_m = 0.1;
  limits.slips_max = 0.0;
  ReleaseCatch r = run_release_catch(board, options, limits);
  CHECK(r.passed);
  CHECK(r.checks.size() == 5);  // and that all were held and released
  limits.caught_after_max_s = 0.025;
  r = run_release_catch(board, options, limits);
  CHECK_FALSE(r.passed);
  CHECK_FALSE(r.checks[0].passed);
  CHECK(r.checks[1].passed);
  board.catches_s = 1e9;
  limits.caught_after_max_s = 0.5;
  r = run_release_catch(board, options, limits);
  CHECK_FALSE(r.checks[0].passed);
}
