// The coil's drive.
#include "furcula/control/coil_drive.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula::control;

namespace {
constexpr float kDt = 0.001f;
}

TEST_CASE("a coil gets the full supply until its peak is over, then what holds the key") {
  const CoilConfig config;
  CoilState state;
  for (int n = 0; n < 35; ++n) CHECK(drive_coil(config, state, true, kDt) == 1.0f);
  for (int n = 0; n < 200; ++n) CHECK(drive_coil(config, state, true, kDt) == config.hold_duty);
  CHECK(drive_coil(config, state, false, kDt) == 0.0f);
  CHECK(drive_coil(config, state, true, kDt) == 1.0f);  // a peak each time
}

TEST_CASE("the coil's heat is the mean of the duty's square, the past fading") {
  CoilConfig config;
  config.hold_duty = 1.0f;
  config.heat_max = 2.0f;
  config.longest_s = 1e9f;
  CoilState state;
  for (int n = 0; n < 30000; ++n) drive_coil(config, state, true, kDt);
  CHECK(state.heat == Approx(1.0 - std::exp(-30.0 / 60.0)).epsilon(1e-3));
}

TEST_CASE("a coil that has become too hot stays off until it has cooled, whatever is wanted") {
  CoilConfig config;
  config.hold_duty = 1.0f;
  config.longest_s = 1e9f;
  CoilState state;
  int on = 0;
  while (drive_coil(config, state, true, kDt) > 0.0f) ++on;
  // 0.35 = 1 - exp(-t / 60 s)
  CHECK(on * 1e-3 == Approx(-60.0 * std::log(1.0 - 0.35)).epsilon(1e-3));
  for (int n = 0; n < 1000; ++n) CHECK(drive_coil(config, state, true, kDt) == 0.0f);
  CHECK(state.blocked);
  int cooling = 0;
  for (; state.blocked; ++cooling) drive_coil(config, state, false, kDt);
  CHECK(cooling > 1000);  // 0.9 of the limit: 6.3 s after it, one of which has passed
  CHECK(drive_coil(config, state, true, kDt) == 1.0f);
}

TEST_CASE("a coil is never on for longer than its limit") {
  CoilConfig config;
  CoilState state;
  int on = 0;
  while (drive_coil(config, state, true, kDt) > 0.0f) ++on;
  CHECK(on == 1000);
}
