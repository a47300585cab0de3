// Long recordings: how many windows a fit is made on, and which; that their past is not gone through again and again.
#include "host/identify/informative_windows.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <optional>

#include "host/identify/prediction.hpp"
#include "host/identify/simulate.hpp"
#include "host/identify/simulation_fit.hpp"
#include "tests/host/identify/clutched_hops.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;

namespace {

constexpr double kMass_kg = 95.0, kDamping_nspm = 203.5, kStep_s = 0.002;
constexpr std::size_t kMost = 10'000;  // rows

/// What happens in one window alone, by the time at which it begins.
struct Rare {
  std::optional<double> kick_s;   ///< for 20 ms a force that is not in the log, of six times the usual
  std::optional<double> large_s;  ///< for one half of the square wave three times the usual force
  std::optional<double> jump_s;   ///< from there on the encoder is off by 5 mm
};

/// An axis under a square wave of force, exactly (as in synthetic.hpp), 500 rows a second; noise of 0.02 mm.
log::Log long_log(double seconds, unsigned seed, const Rare& rare = {}) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 2e-5);
  const double rate = kDamping_nspm / kMass_kg, period_s = 0.7;
  double x = 0.0, v = 0.0;
  log::Log log;
  log.path = "long-" + std::to_string(seed) + ".csv";
  log.rig = "motor_axis";
  const auto within = [](double t, const std::optional<double>& from, double span_s) {
    return from && t >= *from && t < *from + span_s;
  };
  for (int n = 0; n <= static_cast<int>(seconds / kStep_s); ++n) {
    const double t = kStep_s * n;
    const double size = within(t, rare.large_s, period_s) ? 180.0 : 60.0;
    const double u = std::fmod(t, 2.0 * period_s) < period_s ? size : -size;
    const double off = rare.jump_s && t >= *rare.jump_s ? 5e-3 : 0.0;
    log.columns["time_s"].push_back(t);
    log.columns["position_m"].push_back(x + off + noise(random));
    log.columns["force_n"].push_back(u);
    const double terminal = (u + (within(t, rare.kick_s, 0.02) ? 360.0 : 0.0)) / kDamping_nspm,
                 decay = std::exp(-rate * kStep_s);
    x += terminal * kStep_s + (v - terminal) * (1.0 - decay) / rate;
    v = terminal + (v - terminal) * decay;
  }
  return log;
}

struct Chosen {
  std::vector<identify::Recording> recordings;
  identify::TrainingWindows all, some;
};

Chosen chosen(const std::vector<log::Log>& logs, std::size_t most = kMost) {
  const model::Model model = test::axis_model(60.0, 90.0);
  Chosen c{identify::make_recordings(logs, model.kind), {}, {}};
  c.all = identify::training_windows(c.recordings, model, 0.5);
  c.some = identify::informative_windows(c.recordings, model, c.all, most);
  return c;
}

std::size_t rows_of(const std::vector<identify::Window>& windows) {
  return std::accumulate(windows.begin(), windows.end(), std::size_t{0},
                         [](std::size_t sum, const identify::Window& w) { return sum + w.rows(); });
}

/// Whether a window holds the instant, and is one of them.
bool has_instant(const Chosen& c, double at_s) {
  return std::any_of(c.some.windows.begin(), c.some.windows.end(), [&](const identify::Window& w) {
    const auto& time_s = c.recordings[w.recording].time_s;
    return time_s[w.first] <= at_s && at_s < time_s[w.last];
  });
}

}  // namespace

TEST_CASE("Recordings with no more rows than a search needs are taken whole") {
  const Chosen c = chosen({long_log(18.0, 1)});
  CHECK(rows_of(c.all.windows) < kMost);
  CHECK(c.some.windows.size() == c.all.windows.size());
}

TEST_CASE(
    "Of long recordings no more rows are taken than asked for, from all of them and all of their length") {
  const Chosen c = chosen({long_log(100.0, 1), long_log(3.0, 2), long_log(200.0, 3)});
  const auto& windows = c.some.windows;
  CHECK(c.some.layers == 1);
  CHECK(rows_of(windows) <= kMost);
  CHECK(rows_of(windows) > kMost - 251);  // as many as there is room for
  CHECK(std::is_sorted(windows.begin(), windows.end(), [](const auto& a, const auto& b) {
    return a.recording != b.recording ? a.recording < b.recording : a.first < b.first;
  }));
  for (std::size_t i = 0; i < c.recordings.size(); ++i)
    CHECK(std::any_of(windows.begin(), windows.end(), [&](const auto& w) { return w.recording == i; }));
  for (int tenth = 0; tenth < 10; ++tenth)
    CHECK(std::any_of(windows.begin(), windows.end(), [&](const auto& w) {
      const double at_s = c.recordings[2].time_s[w.first];
      return w.recording == 2 && at_s >= 20.0 * tenth && at_s < 20.0 * (tenth + 1);
    }));
}

TEST_CASE("What happens once in a long recording is in the windows that are taken") {
  // Each at an instant that windows which lie evenly pass over.
  for (const double at_s : {31.6, 77.3, 141.9, 198.2}) {
    Rare kick, large, jump;
    kick.kick_s = large.large_s = jump.jump_s = at_s;
    CHECK(has_instant(chosen({long_log(220.0, 4, kick)}), at_s));
    CHECK(has_instant(chosen({long_log(220.0, 5, large)}), at_s));
    CHECK(has_instant(chosen({long_log(220.0, 6, jump)}), at_s - kStep_s));
  }
}

TEST_CASE("A fit on the windows that are taken gives the mass and damping of the closed form") {
  const model::Model model = test::axis_model(60.0, 90.0);
  const Chosen c = chosen({long_log(200.0, 7)});
  const auto unknowns = identify::free_unknowns(model);
  const identify::Fit fit = identify::fit_by_simulation(model, unknowns, identify::values_in(model, unknowns),
                                                        c.recordings, c.some.windows);
  CHECK(fit.values[0] == Approx(kMass_kg).epsilon(1e-3));
  CHECK(fit.values[1] == Approx(kDamping_nspm).epsilon(1e-3));
}

TEST_CASE("A fit on many rows begins near its end, on few rows where it was told to") {
  const model::Model model = test::axis_model(60.0, 90.0);
  const auto unknowns = identify::free_unknowns(model);
  const std::vector<double> start = identify::values_in(model, unknowns);
  const auto begin = [&](double seconds) {
    const auto recordings = identify::make_recordings({long_log(seconds, 8)}, model.kind);
    return identify::begin_on_some(model, unknowns, start, recordings,
                                   identify::training_windows(recordings, model, 0.5).windows);
  };
  CHECK_FALSE(begin(10.0));
  const auto near = begin(100.0);
  REQUIRE(near);
  CHECK(near->at(0) == Approx(kMass_kg).epsilon(3e-3));
  CHECK(near->at(1) == Approx(kDamping_nspm).epsilon(3e-3));
  // And a fit from there ends where one from afar does.
  const auto recordings = identify::make_recordings({long_log(100.0, 8)}, model.kind);
  const auto windows = identify::training_windows(recordings, model, 0.5).windows;
  const auto end = [&](const std::vector<double>& from, const identify::Effort& effort) {
    return identify::fit_by_simulation(model, unknowns, from, recordings, windows, identify::Weighting::noise,
                                       1, effort)
        .values;
  };
  const std::vector<double> far = end(start, {}), short_way = end(*near, identify::kFromNear);
  CHECK(short_way[0] == Approx(far[0]).epsilon(1e-4));
  CHECK(short_way[1] == Approx(far[1]).epsilon(1e-4));
}

TEST_CASE("Windows for a sample lie evenly, and are all where they are few") {
  const Chosen c = chosen({long_log(100.0, 9)});
  const auto some = identify::evenly(c.all.windows, 5'000, 4);
  CHECK(rows_of(some) <= 5'000);
  REQUIRE(some.size() >= 19);
  for (std::size_t i = 1; i < some.size(); ++i) {
    const auto apart = static_cast<double>(some[i].first - some[i - 1].first);
    CHECK(apart == Approx(50'000.0 / static_cast<double>(some.size())).epsilon(0.06));
  }
  CHECK(identify::evenly(c.all.windows, 100'000, 4).size() == c.all.windows.size());
}

TEST_CASE("The last row with an input is found without going through the rows") {
  log::Log log = long_log(2.0, 10);
  auto& force = log.columns["force_n"];
  for (std::size_t i = 0; i < force.size(); ++i)
    if (i < 10 || (i > 40 && i % 97 < 60)) force[i] = 0.0;
  const identify::Recording r = identify::make_recording(log, dynamics::Kind::motor_axis);
  for (std::size_t row = 0; row < r.rows(); ++row) {
    std::size_t back = row;
    while (back > 0 && r.input[back] == 0.0) --back;
    CHECK(identify::detail::last_driven(r, row) == back);
  }
}

TEST_CASE("A window runs the same after a long past as after a short one, once the coil was on in both") {
  const model::Model truth = test::clutched_model();
  const identify::PlantSetup<double> setup(truth, {}, nullptr);
  std::size_t compared = 0;
  for (const log::Log& once : test::clutched_hops(truth, 6, 3)) {
    // Twice the same recording, one after the other.
    log::Log twice = once;
    for (auto& [name, values] : twice.columns) {
      const std::vector<double> first = values;
      for (double x : first) values.push_back(name == "time_s" ? x + first.back() + 1e-3 : x);
    }
    const identify::Recording r = identify::make_recording(once, truth.kind),
                              rr = identify::make_recording(twice, truth.kind);
    const auto run = [&](const identify::Recording& of, const identify::Window& w,
                         const identify::StartState& s) {
      std::vector<double> positions;
      identify::simulate(setup, of, w, s.position, s.velocity,
                         [&](std::size_t, double x, double, double, const auto&) { positions.push_back(x); });
      return positions;
    };
    for (identify::Window w : identify::prediction_windows({r}, truth, 0.5)) {
      if (!identify::detail::surely_out(r, w.first, 0.0)) continue;
      const identify::StartState start = identify::start_state(r, w);
      const std::vector<double> early = run(r, w, start);
      w.first += r.rows(), w.last += r.rows();
      const std::vector<double> late = run(rr, w, start);
      REQUIRE(late.size() == early.size());
      for (std::size_t i = 0; i < early.size(); ++i) CHECK(late[i] == Approx(early[i]).margin(1e-9));
      ++compared;
    }
  }
  CHECK(compared >= 3);
}
