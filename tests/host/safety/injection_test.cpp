// Random faults in random experiments.
#include "host/safety/injection.hpp"

#include <catch2/catch.hpp>
#include <cstdio>

using namespace furcula;
using namespace furcula::safety;

TEST_CASE("of 2,000 random injections none is unsafe and none raises a false alarm") {
  const Tally tally = inject(20261122, 2000, 2);
  std::printf("%s", format_tally(tally).c_str());
  for (const UnsafeRun& run : tally.unsafe) {
    CAPTURE(run.number, run.trial.unsafe, run.trial.false_alarm);
    CHECK(false);
  }
  CHECK(tally.runs == 2000);
  CHECK(tally.false_alarms == 0);
  CHECK(tally.found + tally.borne == 2000);
  CHECK(tally.found > 1000);
  CHECK(tally.borne > 200);
  for (const auto& kind : tally.kinds) CHECK(kind.runs > 20);
}

TEST_CASE("a switch that reports a fast toe early, on raised ground, raises no false alarm") {
  // The first touch-down is that of a stretching leg, on 2.5 cm. Nothing is broken: any fault is a false alarm.
  Injection injection = draw_injection(1, 59588);
  injection.scenario.faults.clear();
  const Trial trial = run_trial(robot(), injection.scenario, injection.seed, injection.rig);
  INFO(format_run(injection, trial));
  CHECK_FALSE(trial.false_alarm);
  CHECK(trial.unsafe == 0);
}

TEST_CASE("the same seed gives the same tally on one thread and on two, another seed another") {
  const std::string one = format_tally(inject(3, 60, 1));
  CHECK(format_tally(inject(3, 60, 2)) == one);
  CHECK(format_tally(inject(4, 60, 2)) != one);
}
