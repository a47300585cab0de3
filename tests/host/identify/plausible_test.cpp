// Recordings that cannot be what they say are refused; what only looks like it is not.
#include "host/identify/plausible.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "tests/host/error_message.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

/// A joint that swings as 0.8 sin(5 t) rad, 1 kHz, in counts of 0.5 mrad.
log::Log swing(const std::function<double(double)>& sensor, double duration_s = 4.0) {
  log::Log log;
  log.path = "swing.csv";
  log.rig = "rotary_joint";
  for (int n = 0; n < static_cast<int>(1e3 * duration_s); ++n) {
    const double t = 1e-3 * n, count = 5e-4;
    log.columns["time_s"].push_back(t);
    log.columns["angle_rad"].push_back(sensor(count * std::round(0.8 * std::sin(5.0 * t) / count)));
    log.columns["torque_nm"].push_back(0.0);
  }
  return log;
}

std::string refused(const std::vector<log::Log>& logs, dynamics::Kind kind) {
  return test::error_message([&] { identify::require_plausible(identify::make_recordings(logs, kind), {}); });
}

}  // namespace

TEST_CASE("An encoder that saturates is refused, with where and for how long") {
  const auto clipped = swing([](double x) { return std::min(x, 0.7); });
  // 0.8 sin(5 t) is above 0.7 for 2 acos(0.7 / 0.8) / 5 s = 202 ms.
  CHECK_THAT(refused({clipped}, dynamics::Kind::rotary_joint),
             Contains("swing.csv: the angle stands at its largest value, 0.7 rad, for up to 20"));
  const auto below = swing([](double x) { return std::max(x, -0.5); });
  CHECK_THAT(refused({below}, dynamics::Kind::rotary_joint), Contains("smallest value, -0.5 rad"));
}

TEST_CASE("A turning point that a coarse count hides is no saturation") {
  identify::require_plausible(
      identify::make_recordings({swing([](double x) { return x; })}, dynamics::Kind::rotary_joint), {});
  identify::require_plausible(
      identify::make_recordings({swing([](double x) { return 0.02 * std::round(x / 0.02); })},
                                dynamics::Kind::rotary_joint),
      {});
}

TEST_CASE("A carriage that lies on its stop between throws is no saturation") {
  log::Log log = test::flight_log({.height = 0.0, .velocity = 2.0}, 0.0, 1);
  for (int n = 0; n < 2; ++n)
    for (auto& [name, column] : log.columns) {
      const std::vector<double> once(column.begin(),
                                     column.begin() + static_cast<std::ptrdiff_t>(column.size()));
      const double shift = name == "time_s" ? once.back() + 1e-3 : 0.0;
      for (double value : once) column.push_back(value + shift);
    }
  identify::require_plausible(identify::make_recordings({log}, dynamics::Kind::rail_carriage), {});
}

TEST_CASE("Two recordings in different units are refused") {
  log::Log metres = test::axis_log(20.0, 30.0, 1e-5, 1), millimetres = test::axis_log(20.0, 30.0, 1e-5, 2);
  for (double& x : millimetres.columns["position_m"]) x *= 1e3;
  CHECK_THAT(
      refused({metres, millimetres}, dynamics::Kind::motor_axis),
      Contains("axis-2.csv: moves ") && Contains("times as fast as axis-1.csv") && Contains("same unit"));
  // Little motion under little force is no clash.
  log::Log gentle = test::axis_log(20.0, 30.0, 1e-8, 3);
  for (const char* column : {"position_m", "force_n"})
    for (double& x : gentle.columns[column]) x *= 1e-2;
  identify::require_plausible(
      identify::make_recordings({gentle, test::axis_log(20.0, 30.0, 1e-8, 4)}, dynamics::Kind::motor_axis),
      {});
}
