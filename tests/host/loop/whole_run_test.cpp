// Eq. 3 over whole walks: closed forms of it, and a search that finds what makes it less.
#include "host/loop/whole_run.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/walk/ensemble.hpp"
#include "host/walk/roll_pitch_yaw.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/paths.hpp"

using namespace furcula;

namespace {

constexpr double kRow_s = 0.01;

const walk::Model& model() {
  static const walk::Model read = walk::read_model(test::source("models/biped/biped.toml"));
  return read;
}

/// What that robot measures of a walk in its first two seconds, after so many rows in which it waits.
floating::Recording recording_of(const floating::Machine& machine, const walk::Walk& walk,
                                 std::size_t waits) {
  walk::RolloutOptions options = walk::rollout_of(model(), walk.mode, walk.walk_until_s);
  options.time_s = 2.0;
  const walk::Trace trace =
      walk::traces(model().robot, {walk::member_of(machine)}, options, {{walk.parameters, 0}}, kRow_s, 1)
          .front();
  floating::Recording out;
  const auto put = [&](const walk::TraceRow& row) {
    floating::Row& r = out.rows.emplace_back();
    r.time_s = 7.0 + kRow_s * static_cast<double>(out.rows.size());
    for (std::size_t i = 0; i < biped::kJoints; ++i)
      r.angle_rad[i] = row.angle_rad[i], r.target_rad[i] = row.target_rad[i];
    r.attitude = walk::attitude_of({row.turn_rad[0], row.turn_rad[1], row.turn_rad[2]});
  };
  for (std::size_t k = 0; k < waits; ++k) put(trace.rows.front());
  for (const walk::TraceRow& row : trace.rows) put(row);
  return out;
}

double error_rad(const floating::Recording& recording, const walk::Walk& walk) {
  return loop::whole_run_errors_rad(model(), model().machine, {{&recording, walk}}, 1).front();
}

}  // namespace

TEST_CASE(
    "Eq. 3 of a robot on its own walk is zero, and what is added to one of its 27 numbers is the root of a 27th") {
  const walk::Walk walk = test::found_walk();
  floating::Recording recording = recording_of(model().machine, walk, 0);
  CHECK(error_rad(recording, walk) < 1e-6);
  // A robot that waits before it walks, and has another heading, is no other robot.
  floating::Recording late = recording_of(model().machine, walk, 25);
  for (floating::Row& row : late.rows) {
    walk::RollPitchYaw turn = walk::roll_pitch_yaw(row.attitude);
    turn.yaw_rad += 3.0;
    row.attitude = walk::attitude_of(turn);
  }
  CHECK(error_rad(late, walk) < 1e-6);
  SECTION("joint angle") {
    for (floating::Row& row : recording.rows) row.angle_rad[3] += 0.02;
    CHECK(error_rad(recording, walk) == Approx(0.02 / std::sqrt(27.0)).epsilon(1e-3));
  }
  SECTION("target") {
    for (floating::Row& row : recording.rows) row.target_rad[11] -= 0.05;
    CHECK(error_rad(recording, walk) == Approx(0.05 / std::sqrt(27.0)).epsilon(1e-3));
  }
  SECTION("roll, in the second half of the rows") {
    for (std::size_t k = recording.rows.size() / 2; k < recording.rows.size(); ++k) {
      walk::RollPitchYaw turn = walk::roll_pitch_yaw(recording.rows[k].attitude);
      turn.roll_rad += 0.04;
      recording.rows[k].attitude = walk::attitude_of(turn);
    }
    // The first rows, in which no target has moved yet, do not count.
    CHECK(error_rad(recording, walk) == Approx(0.04 / std::sqrt(2.0 * 27.0)).epsilon(0.03));
  }
}

TEST_CASE(
    "the rows beside a simulation are those of Eq. 3: a robot that waited, and then did as simulated but for a knee") {
  const walk::Walk walk = test::found_walk();
  constexpr std::size_t kWaits = 25, kKnee = dynamics::biped::kKnee;
  floating::Recording recording = recording_of(model().machine, walk, kWaits);
  for (floating::Row& row : recording.rows) row.angle_rad[kKnee] += 0.01;
  const loop::BesideSimulation b = loop::beside_simulation(model(), model().machine, {&recording, walk});
  CHECK(b.time_s.size() + kWaits <= recording.rows.size());
  CHECK(b.time_s.front() == 0.0);
  CHECK(b.time_s.back() == Approx(kRow_s * static_cast<double>(b.time_s.size() - 1)));
  double sum = 0.0;
  for (std::size_t i = 0; i < b.measured_rad.size(); ++i) {
    INFO("number " << i);
    REQUIRE(b.measured_rad[i].size() == b.time_s.size());
    REQUIRE(b.simulated_rad[i].size() == b.time_s.size());
    double most = 0.0, least = 1.0;
    for (std::size_t k = 0; k < b.time_s.size(); ++k) {
      const double off = b.measured_rad[i][k] - b.simulated_rad[i][k];
      most = std::max(most, off), least = std::min(least, off), sum += off * off;
    }
    CHECK(most == Approx(i == kKnee ? 0.01 : 0.0).margin(1e-6));
    CHECK(least == Approx(i == kKnee ? 0.01 : 0.0).margin(1e-6));
  }
  CHECK(std::sqrt(sum / (27.0 * static_cast<double>(b.time_s.size()))) == Approx(error_rad(recording, walk)));
}

TEST_CASE(
    "a search over whole walks lessens Eq. 3, within the ranges, and the same on any number of threads") {
  const walk::Walk walk = test::found_walk();
  floating::Machine truth = model().machine;
  truth.encoder_offset_rad[dynamics::biped::kKnee] = 0.006;
  truth.robot.slope_y_rad = 0.006;
  const floating::Recording recording = recording_of(truth, walk, 0);
  const std::vector<loop::WholeRun> runs{{&recording, walk}};
  const auto fitted = [&](unsigned threads) {
    loop::WholeRunOptions options;
    options.steps = 400'000;
    options.threads = threads;
    options.start = model().machine;
    return loop::fit_whole_runs(model(), runs, options);
  };
  const loop::WholeRunFit found = fitted(1), same = fitted(2);
  CHECK(found.start_rad == Approx(error_rad(recording, walk)).epsilon(1e-12));
  CHECK(found.error_rad < 0.8 * found.start_rad);
  CHECK(found.error_rad == same.error_rad);
  CHECK(found.simulations >= 100);
  CHECK(loop::whole_run_errors_rad(model(), found.machine, runs, 1).front() ==
        Approx(found.error_rad).epsilon(1e-6));
  for (const biped::Unknown& u : biped::unknowns(model().robot, true, false)) {
    INFO(u.name());
    const double moved = std::abs(u.value(found.machine) - u.value(model().machine));
    CHECK(moved <= (u.of_tables ? std::sqrt(3.0) * u.prior_sd * (1.0 + 1e-9) : 0.0));
  }
}
