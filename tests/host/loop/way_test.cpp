// The way that a log's joint angles, attitude and foot switches give, beside the position that the simulation knows.
#include "host/loop/way.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/roll_pitch_yaw.hpp"
#include "host/walk/simulation.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;

namespace {

floating::Machine nominal() {
  floating::Machine m;
  m.robot = dynamics::biped::design();
  return m;
}

log::Log log_of(const char* mode, std::optional<std::uint64_t> seed) {
  const walk::Walk walk = test::found_walk(mode);
  walk::RolloutOptions options;
  options.mode = walk.mode;
  return simulate_walk(dynamics::biped::design(), options, walk.parameters, 0.01, seed).log;
}

}  // namespace

TEST_CASE("the way by the stance foot is within 8 % and 2 cm of that in simulation, with sensor errors too") {
  for (const char* mode : {"active", "semi_passive"})
    for (const std::optional<std::uint64_t> seed : {std::optional<std::uint64_t>{}, {1}, {2}}) {
      const log::Log log = log_of(mode, seed);
      const auto way = loop::way_of(floating::recording_of(log), nominal());
      const auto &x = log.at("base_x_m"), &y = log.at("base_y_m");
      REQUIRE(way.size() > 300);
      INFO(mode << ", seed " << seed.value_or(0) << ", " << way.size() << " rows");
      for (std::size_t k = 0; k < way.size(); k += 50) {
        INFO(k << ": " << way[k].x_m << " of " << x[k] - x[0] << ", " << way[k].y_m << " of " << y[k] - y[0]);
        CHECK(std::abs(way[k].x_m - (x[k] - x[0])) < 0.02 + 0.08 * std::abs(x[k] - x[0]));
      }
    }
}

TEST_CASE("the way is along the heading at the begin, whatever the attitude's yaw is counted from") {
  floating::Recording r = floating::recording_of(log_of("active", {}));
  const auto way = loop::way_of(r, nominal());
  const double turn_rad = 2.0;
  for (floating::Row& row : r.rows) {
    const walk::RollPitchYaw t = walk::roll_pitch_yaw(row.attitude);
    row.attitude = walk::attitude_of({t.roll_rad, t.pitch_rad, t.yaw_rad + turn_rad});
  }
  const auto turned = loop::way_of(r, nominal());
  CHECK(turned.back().x_m == Approx(way.back().x_m).margin(1e-9));
  CHECK(turned.back().y_m == Approx(way.back().y_m).margin(1e-9));
}

TEST_CASE("a robot whose switches are open goes by its lower foot, and one that stands stays") {
  floating::Recording r = floating::recording_of(log_of("active", {}));
  const double way_m = loop::way_of(r, nominal()).back().x_m;
  for (floating::Row& row : r.rows) row.contact = {false, false};
  CHECK(loop::way_of(r, nominal()).back().x_m == Approx(way_m).epsilon(0.1));
  for (floating::Row& row : r.rows) row = r.rows.front();
  CHECK(loop::way_of(r, nominal()).back().x_m == 0.0);
  r.rows.clear();
  CHECK(loop::way_of(r, nominal()).empty());
}
