// The rail carriage: its flights, and what can be identified from them.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/core/error.hpp"
#include "host/identify/identification.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Kind;

namespace {

/// Three throws in one recording, 50 ms on the stop after each.
log::Log three_throws() {
  log::Log all;
  all.path = "throws.csv";
  for (unsigned i = 0; i < 3; ++i) {
    const log::Log one = test::flight_log({.height = 0.0, .velocity = 2.0 + i}, 9e-5, i);
    const double begin = all.columns["time_s"].empty() ? 0.0 : all.columns["time_s"].back() + 1e-3;
    for (std::size_t row = 0; row < one.rows(); ++row) {
      all.columns["time_s"].push_back(begin + one.time_s()[row]);
      for (const char* name : {"height_m", "contact"}) all.columns[name].push_back(one.at(name)[row]);
    }
  }
  return all;
}

const identify::Identified& parameter(const identify::Estimation& e, const std::string& name) {
  for (const auto& p : e.parameters)
    if (p.name == name) return p;
  throw std::out_of_range(name);
}

}  // namespace

TEST_CASE("A carriage's windows are its flights, each whole and without a row of contact") {
  const auto r = identify::make_recording(three_throws(), Kind::rail_carriage);
  const auto found = identify::prediction_windows({r}, test::carriage_model(), 0.5);
  REQUIRE(found.size() == 3);
  for (const auto& w : found) {
    CHECK(w.kind == identify::WindowKind::flight);
    for (std::size_t i = w.first; i <= w.last; ++i) REQUIRE(r.contact[i] == 0.0);
    CHECK((w.first == 0 || r.contact[w.first - 1] == 1.0));
    CHECK(r.contact[w.last + 1] == 1.0);
  }
  // The slope of the height is that of the flight up to its last row: 2 to 4 m/s down, not half of it.
  for (const auto& w : found) CHECK(r.velocity_smoothed[w.last] < -1.7);
}

TEST_CASE("Without a contact column all rows are one flight, which a pause divides") {
  log::Log log = test::flight_log({.height = 1.2}, 9e-5, 1);
  log.columns.erase("contact");
  const auto whole = identify::free_flights(identify::make_recording(log, Kind::rail_carriage), 0, 9.81);
  REQUIRE(whole.size() == 1);
  CHECK(whole[0].first == 0);
  CHECK(whole[0].last + 1 == log.rows());
  for (std::size_t i = 200; i < log.rows(); ++i) log.columns["time_s"][i] += 0.06;
  const auto parts = identify::free_flights(identify::make_recording(log, Kind::rail_carriage), 0, 9.81);
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].last == 199);
  CHECK(parts[1].first == 200);
}

TEST_CASE("Rows in which a carriage is held before its release, or lies on its stop, are no flight") {
  log::Log log = test::flight_log({.height = 1.2}, 9e-5, 1);
  std::size_t flies = 0;
  while (flies < log.rows() && log.at("contact")[flies] == 0.0) ++flies;
  constexpr std::size_t kHeld = 60;
  log::Log held;
  held.path = log.path;
  for (std::size_t i = 0; i < kHeld + flies + kHeld; ++i) {
    const std::size_t of = i < kHeld ? 0 : std::min(i - kHeld, flies - 1);
    held.columns["time_s"].push_back(1e-3 * static_cast<double>(i));
    held.columns["height_m"].push_back(log.at("height_m")[of] + (i % 3 == 0 ? 9e-5 : 0.0));
  }
  const auto found = identify::free_flights(identify::make_recording(held, Kind::rail_carriage), 0, 9.81);
  REQUIRE(found.size() == 1);
  // It falls by eight deviations of the noise, 0.7 mm, within 12 ms; nothing of the hold before is left, and little of the fall is lost.
  CHECK(found[0].first >= kHeld);
  CHECK(found[0].first <= kHeld + 16);
  CHECK(found[0].last < kHeld + flies);
  CHECK(found[0].last + 3 > kHeld + flies);
  // A hand that throws it up, at 20 m/s^2 over 5 cm, is no flight either.
  log::Log pushed;
  pushed.path = "pushed.csv";
  const log::Log after = test::flight_log({.height = 0.05, .velocity = std::sqrt(2.0)}, 9e-5, 2);
  constexpr std::size_t kPush = 70;  // 71 ms to 1.41 m/s
  for (std::size_t i = 0; i < kPush + after.rows(); ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    pushed.columns["time_s"].push_back(t);
    pushed.columns["height_m"].push_back(i < kPush ? 10.0 * t * t : after.at("height_m")[i - kPush]);
  }
  const auto thrown_up =
      identify::free_flights(identify::make_recording(pushed, Kind::rail_carriage), 0, 9.81);
  REQUIRE(thrown_up.size() == 1);
  CHECK(thrown_up[0].first + 20 > kPush);
  CHECK(thrown_up[0].first < kPush + 40);
  // A throw stays near its apex for longer than any other flight does.
  const log::Log thrown = test::flight_log({.height = 0.0, .velocity = 3.0}, 9e-5, 1);
  const auto whole = identify::free_flights(identify::make_recording(thrown, Kind::rail_carriage), 0, 9.81);
  REQUIRE(whole.size() == 1);
  CHECK(whole[0].first == 0);
  // Without noise two rows about the apex, 2.5 m/s up after a quarter of a second, may be equal: that is no rest.
  log::Log exact;
  exact.path = "exact.csv";
  for (int i = 0; i <= 509; ++i) {
    const double t = 1e-3 * (i - 254.5);
    exact.columns["time_s"].push_back(1e-3 * i);
    exact.columns["height_m"].push_back(0.4 - 4.905 * t * t);
  }
  CHECK(identify::free_flights(identify::make_recording(exact, Kind::rail_carriage), 0, 9.81).size() == 1);
}

TEST_CASE("A flight shorter than 30 ms is none, and a log without any is refused with what was expected") {
  log::Log log = test::flight_log({.height = 1.0}, 9e-5, 1);
  for (std::size_t i = 0; i < log.rows(); ++i) log.columns["contact"][i] = i % 26 == 0 ? 1.0 : 0.0;
  CHECK(identify::free_flights(identify::make_recording(log, Kind::rail_carriage), 0, 9.81).empty());
  CHECK_THROWS_WITH(identify::identify(test::carriage_model(), {log, log}, {}),
                    Catch::Contains("flight-1.csv") && Catch::Contains("30 ms"));
}

TEST_CASE("Damping and gravity are identified from flights, by both methods, and their intervals hold") {
  auto model = test::carriage_model();
  model.parameters = {2.0, 3.0, 9.0};
  model.free = {{1, {0.0, 20.0}}, {2, {8.0, 11.0}}};
  identify::IdentifyOptions options;
  options.by_equation = true;
  const auto id = identify::identify(model, test::flight_logs({.damping = 1.3}, true, 1, 10),
                                     test::flight_logs({.damping = 1.3}, true, 50, 2), options);
  REQUIRE(id.estimations.size() == 2);
  CHECK(id.main_channel == "height");
  CHECK(id.windows == 10);
  const auto& e = id.estimations.front();
  const auto &damping = parameter(e, "damping_nspm"), &gravity = parameter(e, "gravity_mps2");
  CHECK(damping.value == Approx(1.3).epsilon(0.005));
  CHECK(gravity.value == Approx(9.81).epsilon(0.0005));
  CHECK(damping.lower < 1.3);
  CHECK(damping.upper > 1.3);
  CHECK(gravity.verdict == "identified");
  // One step of 1 ms sees more noise than motion.
  CHECK(parameter(id.estimations[1], "gravity_mps2").value == Approx(9.81).epsilon(0.03));
  // A start velocity from 50 rows of 0.09 mm noise is good to 7 mm/s (its closed form): 4 mm after 0.6 s.
  REQUIRE(e.held_out);
  CHECK(e.held_out->at("height").rmse < 6e-3);
}

TEST_CASE("Mass and damping of a free flight are one number, and the verdict says so") {
  auto model = test::carriage_model();
  model.free = {{0, {1.0, 4.0}}, {1, {0.0, 20.0}}};
  const auto id = identify::identify(model, test::flight_logs({.damping = 1.3}, true, 1, 6), {});
  const auto& e = id.estimations.front();
  const auto &mass = parameter(e, "mass_kg"), &damping = parameter(e, "damping_nspm");
  CHECK(damping.value / mass.value == Approx(1.3 / 2.0).epsilon(0.01));
  CHECK(mass.verdict != "identified");
  CHECK(damping.verdict != "identified");
}
