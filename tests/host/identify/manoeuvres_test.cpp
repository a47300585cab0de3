// Recordings of a leg that folds in flight and a spring that is let go: what of them is followed, and what is left out.
#include "host/identify/manoeuvres.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/identify/identification.hpp"
#include "host/identify/prediction.hpp"
#include "host/machines/hopper.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/identify/clutched_hops.hpp"
#include "tests/host/identify/manoeuvres.hpp"

using namespace furcula;
using identify::Recording;

namespace {

/// A made-up hopper: flights under gravity, stances of 0.2 s on a parabola. In flight the leg folds to an angle of
/// `folded_rad` within 50 ms, and is still there at touch-down. The switch reports 6 ms late.
log::Log folded_hops(double folded_rad, double zero_rad = 0.0) {
  const auto model = test::hopper_model();
  const double straight_m = machines::touchdown_height_m(model),
               stop_rad = model.parameter("touchdown_angle_rad");
  const double low_m = 0.3 * std::cos(folded_rad);
  // Up from the straight leg's height at 1.5 m/s, down to the folded leg's.
  const double flight_s = (1.5 + std::sqrt(1.5 * 1.5 + 2.0 * 9.81 * (straight_m - low_m))) / 9.81;
  const double period_s = flight_s + 0.2;
  log::Log log;
  log.path = "folded.csv";
  log.rig = "hopper";
  for (int n = 0; n < 4000; ++n) {
    const double t = 1e-3 * n, phase = std::fmod(t + 0.1, period_s);
    double z = 0.0, angle = 0.0;
    if (phase < flight_s) {
      z = straight_m + 1.5 * phase - 4.905 * phase * phase;
      angle = stop_rad + (folded_rad - stop_rad) * std::clamp((phase - 0.05) / 0.05, 0.0, 1.0);
    } else {
      const double s = (phase - flight_s) / 0.2;
      z = low_m + (straight_m - low_m) * s - 0.3 * s * (1.0 - s);
      angle = std::acos(z / 0.3);
    }
    log.columns["time_s"].push_back(t);
    log.columns["height_m"].push_back(z);
    log.columns["leg_angle_rad"].push_back(angle + zero_rad);
    log.columns["torque_cmd_nm"].push_back(phase > 0.05 ? 0.5 : 0.0);
    log.columns["contact"].push_back(phase > flight_s + 0.006 ? 1.0 : 0.0);
  }
  return log;
}

std::vector<Recording> followed(const std::vector<log::Log>& logs, const model::Model& model) {
  std::vector<Recording> all = identify::make_recordings(logs, model.kind);
  identify::follow_manoeuvres(all, model);
  identify::keep_plausible_leg_angles(all, model);
  return all;
}

/// Of hops whose logs do not have the cable.
std::vector<log::Log> without_cable(std::vector<log::Log> logs) {
  for (log::Log& log : logs) log.columns.erase("clutch_travel_m");
  return logs;
}

model::Model without_clutch(model::Model m) {
  m.clutch.reset();
  return m;
}

/// Strides of the recordings whose stance has the coil on at any time, counted by the height and the coil alone.
std::size_t strides_with_coil_in_stance(const std::vector<log::Log>& logs, double straight_m) {
  std::size_t count = 0;
  for (const log::Log& log : logs) {
    const auto &z = log.at("height_m"), &coil = log.at("solenoid");
    bool on = false, was_below = false;
    int stances = 0;
    std::size_t here = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
      const bool below = z[i] <= straight_m;
      if (below) on = on || coil[i] != 0.0;
      if (was_below && !below) {
        here += on;
        on = false;
        ++stances;
      }
      was_below = below;
    }
    count += here;
  }
  return count;
}

}  // namespace

TEST_CASE("The height of touch-down is that of the folded leg, 2 L cos of its angle") {
  const auto model = test::hopper_model();
  for (const double folded_rad : {0.45, 0.7, 1.0})
    for (const double zero_rad : {0.0, 0.03}) {
      const auto all = followed({folded_hops(folded_rad, zero_rad)}, model);
      const Recording& r = all.front();
      REQUIRE_FALSE(r.leg_length.empty());
      const auto strides = identify::strides(r, 0, model);
      REQUIRE(strides.size() >= 4);
      for (const auto& w : strides) {
        const double low_m = 0.3 * std::cos(folded_rad);
        CHECK(r.leg_length[w.touchdown] == Approx(low_m).margin(1e-4));
        // The row in which it happens: the first whose height is not above that.
        CHECK(r.position[w.touchdown] <= low_m + 1e-4);
        CHECK(r.position[w.touchdown - 1] > low_m);
      }
      CHECK_FALSE(r.leg_angle.empty());
    }
}

TEST_CASE("A backlash that rattles in flight, and a leg on its stop, are no fold") {
  const auto model = test::hopper_model();
  log::Log straight = folded_hops(model.parameter("touchdown_angle_rad") + 1e-6);
  CHECK(followed({straight}, model).front().leg_length.empty());
  // Of 0.1 rad, and nothing drives it.
  log::Log rattles = straight;
  for (std::size_t i = 0; i < rattles.rows(); ++i)
    if (rattles.at("contact")[i] == 0.0) {
      rattles.columns["leg_angle_rad"][i] += 0.05 + 0.05 * std::sin(0.05 * static_cast<double>(i));
      rattles.columns["torque_cmd_nm"][i] = 0.0;
    }
  CHECK(followed({rattles}, model).front().leg_length.empty());
}

TEST_CASE("The manoeuvre is predicted with and without the clutch in the model") {
  const model::Model truth = test::manoeuvring_model();
  const auto logs = test::manoeuvres(truth, 2, 1);
  for (const model::Model& m : {truth, without_clutch(truth)}) {
    const auto all = followed(logs, m);
    for (const Recording& r : all) CHECK_FALSE(r.leg_length.empty());
    CHECK(identify::excluded(all, m, 0.5).empty());
    const auto windows = identify::prediction_windows(all, m, 0.5);
    CHECK(windows.size() >= 8);
    const auto starts = identify::start_states(all, windows, m);
    // Of a stroke of 15 cm; the noise of a start alone makes some 0.5 mm by the end of a stride.
    CHECK(identify::prediction_errors(m, all, windows, starts).at("height").rmse < 1e-3);
  }
}

TEST_CASE("Mass and damping are identified from the manoeuvre") {
  model::Model truth = test::manoeuvring_model();
  truth.parameters[*dynamics::parameter_index(truth.kind, "mass_kg")] = 1.554;
  truth.parameters[*dynamics::parameter_index(truth.kind, "damping_stance_nspm")] = 6.42;
  const auto logs = test::manoeuvres(truth, 4, 1);
  for (const model::Model& m : {test::manoeuvring_model(), without_clutch(test::manoeuvring_model())}) {
    const auto found = identify::identify(m, logs, {});
    CHECK(found.excluded.empty());
    for (const auto& p : found.estimations.front().parameters) {
      if (p.name == "mass_kg") CHECK(p.value == Approx(1.554).epsilon(0.01));
      if (p.name == "damping_stance_nspm") CHECK(p.value == Approx(6.42).epsilon(0.03));
    }
  }
}

TEST_CASE("Without a clutch in the model the strides with a spring let go in stance are left out, and said") {
  const model::Model truth = test::clutched_model(), m = without_clutch(truth);
  const auto logs = without_cable(test::clutched_hops(truth, 6, 5));
  const auto all = followed(logs, m);
  const auto with = followed(logs, truth);
  const auto left = identify::excluded(all, m, 0.5);
  REQUIRE(left.size() == 1);
  const auto all_windows = identify::prediction_windows(with, truth, 0.5);
  const auto windows = identify::prediction_windows(all, m, 0.5);
  CHECK(windows.size() + left[0].windows == all_windows.size());
  CHECK(left[0].share ==
        Approx(static_cast<double>(left[0].windows) / static_cast<double>(all_windows.size())));
  // Each of those, and those after a catch that left the cable elsewhere, up to the next flight that brings it home.
  CHECK(left[0].windows + 3 >= strides_with_coil_in_stance(logs, machines::touchdown_height_m(m)));
  CHECK_FALSE(windows.empty());
  CHECK_THAT(identify::sentence(left[0]),
             Catch::Contains("strides") && Catch::Contains("hops-5-") && Catch::Contains("tooth_pitch_m"));
  // What is left is predicted as well as ever.
  const auto starts = identify::start_states(all, windows, m);
  CHECK(identify::prediction_errors(m, all, windows, starts).at("height").rmse < 1e-3);
  CHECK(identify::excluded(with, truth, 0.5).empty());
  // A cable that is seen decides: where it stayed within 2 mm, the spring was as good as held.
  const auto seen = identify::excluded(followed(test::clutched_hops(truth, 6, 5), m), m, 0.5);
  REQUIRE(seen.size() == 1);
  CHECK(seen[0].windows <= left[0].windows);
}

TEST_CASE("Recordings are refused only where nothing is left, and with the reason") {
  const model::Model m = without_clutch(test::clutched_model());
  auto logs = without_cable(test::clutched_hops(test::clutched_model(), 1, 5));
  for (double& on : logs[0].columns.at("solenoid")) on = 1.0;
  const auto all = followed(logs, m);
  CHECK(identify::prediction_windows(all, m, 0.5).empty());
  REQUIRE(identify::excluded(all, m, 0.5).size() == 1);
  CHECK(identify::excluded(all, m, 0.5).front().share == 1.0);
  CHECK_THAT(identify::nothing_left(all, m, 0.5),
             Catch::Contains("100 %") && Catch::Contains("has no clutch"));
}

TEST_CASE("A leg that is driven in flight unseen is left out where the spring is let go") {
  const model::Model m = test::manoeuvring_model();
  auto logs = test::manoeuvres(m, 1, 1);
  logs[0].columns.erase("leg_angle_rad");
  const auto all = followed(logs, m);
  const auto left = identify::excluded(all, m, 0.5);
  REQUIRE(left.size() == 1);
  CHECK_THAT(left[0].why, Catch::Contains("leg_angle_rad"));
}
