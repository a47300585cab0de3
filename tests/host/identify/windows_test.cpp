// Windows and their start states.
#include "host/identify/windows.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/machines/hopper.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using identify::Window;

namespace {

/// Free flights and parabolic stances of a made-up bouncer: hops of 0.3 s above the touch-down height, 0.2 s
/// below.
log::Log bouncer(int hops) {
  log::Log log;
  log.path = "bouncer.csv";
  const double touchdown = machines::touchdown_height_m(test::hopper_model());
  for (int n = 0; n < 500 * hops; ++n) {
    const double t = 1e-3 * n, phase = std::fmod(t, 0.5);
    const double z = phase < 0.3 ? touchdown + 4.905 * phase * (0.3 - phase)
                                 : touchdown - 7.36 * (phase - 0.3) * (0.5 - phase);
    log.columns["time_s"].push_back(t);
    log.columns["height_m"].push_back(z);
    log.columns["torque_cmd_nm"].push_back(0.0);
  }
  return log;
}

}  // namespace

TEST_CASE("Strides run from apex to apex, with the rows where the height crosses touch-down") {
  const auto model = test::hopper_model();
  const auto r = identify::make_recording(bouncer(6), model.kind);
  const auto found = identify::strides(r, 0, model);
  REQUIRE(found.size() == 5);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double begin = 0.15 + 0.5 * static_cast<double>(i);
    CHECK(r.time_s[found[i].first] == Approx(begin).margin(0.0035));
    CHECK(r.time_s[found[i].last] == Approx(begin + 0.5).margin(0.0035));
    CHECK(r.time_s[found[i].touchdown] == Approx(begin + 0.15).margin(0.0015));
    CHECK(r.time_s[found[i].liftoff] == Approx(begin + 0.35).margin(0.0015));
  }
}

TEST_CASE("Stances begin after the impact's vibration and flights end before the next impact") {
  const auto model = test::hopper_model();
  const auto r = identify::make_recording(bouncer(4), model.kind);
  const auto stances = identify::stances(r, 0, model);
  const auto flights = identify::flights(r, 0, model);
  REQUIRE(stances.size() == 4);
  REQUIRE(flights.size() == 4);
  CHECK(r.time_s[stances[1].first] == Approx(0.8 + 0.015).margin(0.002));
  CHECK(r.time_s[flights[1].first] == Approx(0.5 + 0.007).margin(0.002));
  CHECK(r.time_s[flights[1].last] < 0.8);
}

TEST_CASE("Windows of an axis follow one another without a gap and cover the recording") {
  const auto r = identify::make_recording(test::axis_log(95.0, 200.0, 1e-5, 1), dynamics::Kind::motor_axis);
  const auto windows = identify::intervals(r, 0, 0.5);
  REQUIRE(windows.size() == 12);
  for (std::size_t i = 1; i < windows.size(); ++i) CHECK(windows[i].first == windows[i - 1].last);
  CHECK(r.time_s[windows.back().last] == Approx(6.0));
}

TEST_CASE("A start state has the scatter that its variance says, and no bias") {
  // Free fall under white noise of 0.03 mm, 1 kHz: an exact parabola.
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 3e-5);
  double sum = 0.0, squares = 0.0, predicted = 0.0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    identify::Recording r;
    r.kind = dynamics::Kind::hopper_linear;
    r.position_noise = 3e-5;
    for (int n = 0; n <= 500; ++n) {
      const double t = 1e-3 * n;
      r.time_s.push_back(t);
      r.position.push_back(0.36 - 0.2 * t - 4.905 * t * t + noise(random));
    }
    const auto s = identify::start_state(r, Window{0, 0, 500, identify::WindowKind::stride, 0, 0});
    sum += s.velocity + 0.2;
    squares += (s.velocity + 0.2) * (s.velocity + 0.2);
    predicted = 3e-5 * std::sqrt(s.velocity_variance);
  }
  const double scatter = std::sqrt(squares / kRuns);
  CHECK(std::abs(sum / kRuns) < 4.0 * scatter / std::sqrt(1.0 * kRuns));
  CHECK(scatter == Approx(predicted).epsilon(0.15));
}

TEST_CASE("A start state looks at the first 50 ms alone") {
  const auto model = test::axis_model(95.0, 200.0);
  auto log = test::axis_log(95.0, 200.0, 1e-5, 5);
  auto r = identify::make_recording(log, model.kind);
  const Window w = identify::intervals(r, 0, 0.5)[3];
  const auto before = identify::start_state(r, w, model);
  for (std::size_t i = w.first; i <= w.last; ++i)
    if (r.time_s[i] > r.time_s[w.first] + 0.0505) r.position[i] += 1.0;
  const auto after = identify::start_state(r, w, model);
  CHECK(before.velocity == after.velocity);
  CHECK(before.position == after.position);
}

TEST_CASE("A start state survives a wrong first row") {
  const auto model = test::carriage_model();
  const test::Flight thrown{.height = 0.0, .velocity = 3.0};
  for (const double wrong : {0.0, 0.004, 0.03, 0.2}) {
    log::Log log = test::flight_log(thrown, 9e-5, 4);
    auto r = identify::make_recording(log, model.kind);
    r.position[0] += wrong;  // past what is refused on reading
    const Window w{0, 0, 400, identify::WindowKind::flight, 0, 0};
    const auto start = identify::start_state(r, w, model);
    // 41 rows of 0.09 mm tell a parabola's slope at its end to about 8 mm/s; three times that.
    CHECK(start.velocity == Approx(3.0).margin(0.025));
    CHECK(start.position == Approx(0.0).margin(3e-4));
  }
}

TEST_CASE("A pause ends an interval: what drove the axis meanwhile is not known") {
  log::Log log = test::axis_log(95.0, 200.0, 2e-5, 2, 4.0);  // 500 Hz
  log::Log paused = log;
  for (auto& [name, values] : paused.columns) values.erase(values.begin() + 600, values.begin() + 630);
  const auto r = identify::make_recording(paused, dynamics::Kind::motor_axis);
  CHECK(r.refused.empty());
  for (const Window& w : identify::intervals(r, 0, 0.5)) CHECK((w.last < 600 || w.first >= 600));
  CHECK(identify::intervals(r, 0, 0.5).size() >= 7);
}

TEST_CASE("Intervals of a recording that begins under a command begin a tenth of a second later") {
  log::Log log;
  log.path = "step.csv";
  for (int i = 0; i < 2000; ++i) {
    log.columns["time_s"].push_back(1e-3 * i);
    log.columns["position_m"].push_back(1e-4 * i);
    log.columns["force_n"].push_back(i % 1000 < 500 ? 40.0 : -40.0);
  }
  const auto first_row = [](const log::Log& l) {
    return identify::intervals(identify::make_recording(l, dynamics::Kind::motor_axis), 0, 0.5).at(0).first;
  };
  CHECK(first_row(log) == 100);
  log.columns["force_n"].front() = 0.0;  // it began at rest
  CHECK(first_row(log) == 0);
}
