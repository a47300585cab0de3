// Random faults in random experiments.
#include "host/safety/injection.hpp"

#include <catch2/catch.hpp>
#include <cstdio>

using namespace furcula;
using namespace furcula::safety;

TEST_CASE("of 2,000 random injections none is unsafe and none raises a false alarm") {
  const Tally tally = inject(20261122, 2000, 2);
  std::printf("%s", format_tally(tally).c_str());
  for (const UnsafeRun& one : tally.unsafe) {
    CAPTURE(one.number, one.trial.unsafe, one.trial.false_alarm);
    CHECK(false);
  }
  CHECK(tally.runs == 2000);
  CHECK(tally.false_alarms == 0);
  CHECK(tally.found + tally.borne + tally.refused == 2000);
  CHECK(tally.found > 1000);
  CHECK(tally.borne > 200);
  // Every parameter was drawn alone, and most configurations ran.
  CHECK(tally.refused < 400);
  for (const Tally::Parameters& p : tally.by_drawn) CHECK(p.runs - p.refused > 100);
  for (const Tally::Parameters& p : tally.by_parameter) CHECK(p.runs > 2);
  for (const auto& kind : tally.kinds) CHECK(kind.runs > 10);
}

TEST_CASE("a switch that reports a fast toe early, on raised ground, raises no false alarm") {
  // The first touch-down is that of a stretching leg, on 2.5 cm. Nothing is broken: any fault is a false alarm.
  Injection injection = draw_injection(1, 59588);
  injection.scenario.faults.clear();
  injection.parameters.clear();
  const Trial trial = run(robot(), injection);
  INFO(format_run(injection, trial));
  CHECK_FALSE(trial.false_alarm);
  CHECK(trial.unsafe == 0);
}

TEST_CASE("hops of two centimetres, which the switch runs together, raise no false alarm") {
  // The switch was open for 116 to 131 ms, in which the body's speed changed by half of what gravity makes of it.
  struct Drawn {
    std::uint64_t seed, number;
  };
  for (const auto& [seed, number] :
       {Drawn{20261123, 34014}, Drawn{20261123, 38782}, Drawn{20261123, 50881}, Drawn{20261123, 69003},
        Drawn{20261123, 42908}, Drawn{202, 3251}, Drawn{202, 22077}}) {
    Injection injection = draw_injection(seed, number);
    injection.scenario.faults.clear();
    const Trial trial = run(robot(), injection);
    INFO(format_run(injection, trial));
    CHECK(trial.fault == control::Fault::none);
    CHECK(trial.hops > 2);
  }
}

TEST_CASE("a motor that turns the wrong way is found in a landing, where its brake would throw the leg") {
  // Switch and force disagree, so that the robot lands; what is to brake the leg folds it faster and faster, and its spring
  // would bring the toe down at 5.4 m/s.
  const Injection injection = draw_injection(20261123, 84856);
  const Trial trial = run(robot(), injection);
  INFO(format_run(injection, trial));
  CHECK(trial.lands);
  CHECK(trial.fault == control::Fault::leg_astray);
  CHECK(trial.unsafe == 0);
  CHECK(trial.fastest_toe_mps < 2.0);
}

TEST_CASE("the same seed gives the same tally on one thread and on two, another seed another") {
  const std::string one = format_tally(inject(3, 60, 1));
  CHECK(format_tally(inject(3, 60, 2)) == one);
  CHECK(format_tally(inject(4, 60, 2)) != one);
}

TEST_CASE("parameters are drawn within the table's bounds, none, one, a few or all of them") {
  std::array<int, kDrawn.size()> count{};
  for (std::uint64_t number = 0; number < 400; ++number) {
    const Injection injection = draw_injection(7, number);
    ++count[static_cast<std::size_t>(drawn(injection))];
    for (const DrawnParameter& d : injection.parameters) {
      CAPTURE(number, d.parameter->name, d.value);
      CHECK(bus::allows(*d.parameter, d.value));
    }
  }
  for (const int n : count) CHECK(n > 30);
}
