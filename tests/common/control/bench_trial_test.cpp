// The trial of a board on the clutch's bench.
#include "furcula/control/bench_trial.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "furcula/control/controller.hpp"

using namespace furcula;
using namespace furcula::control;

namespace {

Config on_bench() {
  Config c;
  c.bench = {.on_bench = 1, .rest_ticks = 5, .window_ticks = 10, .watch_ticks = 20};
  c.clutch.fitted = 1;
  c.clutch.metres_per_count = 1e-4f;
  return c;
}

/// What only the cable's encoder answers: no height is known, and the leg would be beyond its stop.
Inputs cable_at(std::uint32_t count) {
  Inputs in;
  in.sample.cable_count = count;
  in.sample.home_height_m = __builtin_nanf("");
  in.sample_valid = true;
  in.tick_interval_us = 1000;
  return in;
}

}  // namespace

TEST_CASE("A trial is rest, window and watch, once, the coil is on in the window alone") {
  const Config config = on_bench();
  State state = begin(config);
  for (std::uint32_t tick = 0; tick < 100; ++tick) {
    const Outputs out = step(config, state, cable_at(7), 0.001f);
    REQUIRE(out.fault == Fault::none);
    CHECK(out.trial.runs == (tick < 36));
    if (out.trial.runs) CHECK(out.trial.row == tick);
    CHECK(out.trial.ended == (tick >= 35));
    CHECK((out.command.coil_duty > 0.0f) == (tick >= 5 && tick < 15));
    CHECK(out.command.torque_nm == 0.0f);
  }
}

TEST_CASE("A board on the bench that is stopped in the window switches the coil off, and begins anew") {
  const Config config = on_bench();
  State state = begin(config);
  Inputs in = cable_at(0);
  for (int tick = 0; tick < 8; ++tick) static_cast<void>(step(config, state, in, 0.001f));
  in.run = false;
  CHECK(step(config, state, in, 0.001f).command.coil_duty == 0.0f);
  in.run = true;
  CHECK(step(config, state, in, 0.001f).trial.row == 0);
}

TEST_CASE("On the bench a late tick, a silent encoder and a load beyond its way are faults, a leg is none") {
  const Config config = on_bench();
  const auto fault_of = [&](const Inputs& in) {
    State state = begin(config);
    static_cast<void>(step(config, state, cable_at(0), 0.001f));
    static_cast<void>(step(config, state, in, 0.001f));
    const Outputs out = step(config, state, in, 0.001f);
    if (out.fault != Fault::none) CHECK(out.command.coil_duty == 0.0f);
    return out.fault;
  };
  CHECK(fault_of(cable_at(0)) == Fault::none);
  Inputs late = cable_at(0);
  late.tick_interval_us = 3000;
  CHECK(fault_of(late) == Fault::late_tick);
  Inputs silent = cable_at(0);
  silent.sample_valid = false;
  CHECK(fault_of(silent) == Fault::peer_lost);
  CHECK(fault_of(cable_at(2000)) == Fault::cable_implausible);  // 0.2 m, where 0.11 are allowed
}

TEST_CASE("A coil that is too hot ends the window, as on the robot") {
  Config config = on_bench();
  config.bench.window_ticks = 2000;
  config.coil.longest_s = 1.0f;
  State state = begin(config);
  std::uint32_t on = 0;
  for (std::uint32_t tick = 0; tick < 2100; ++tick)
    on += step(config, state, cable_at(0), 0.001f).command.coil_duty > 0.0f ? 1 : 0;
  CHECK(on == 1000);
}

TEST_CASE("A bench's times that no trial has, or a coil that makes no sense, are refused") {
  Config config = on_bench();
  CHECK(check(config) == Status::ok);
  config.bench.window_ticks = 0xffffffffu;
  CHECK(check(config) == Status::invalid);
  config = on_bench();
  config.coil.peak_s = NAN;
  CHECK(check(config) == Status::invalid);
}
