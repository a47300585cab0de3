// Every row of the table of what breaks, at every moment of the stride.
#include "host/safety/fault_table.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>

#include "host/safety/hil_ticks.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using namespace furcula::safety;
using sim_host::RigFault;

TEST_CASE(
    "each fault is found in time and by its name, the torque goes off, and the spring is caught or known") {
  for (const RigRow& row : rig_rows()) {
    const auto& what = sim_host::info(row.breaks);
    for (const Rig rig : {Rig::on_bus, Rig::local}) {
      if (rig == Rig::local && what.part == sim_host::RigPart::bus) continue;
      for (const Tried& t : try_row(row, rig, 1)) {
        INFO(what.name << (rig == Rig::on_bus ? " on the bus, " : ", ")
                       << kMoments[static_cast<std::size_t>(t.moment)] << ": "
                       << control::info(t.trial.fault).name << " after " << t.trial.found_tick);
        CHECK(broken_limit(row, t.trial) == "");
        CHECK(t.trial.hops >= 3);  // it hopped before
        const bool key_is_broken =
            row.breaks == RigFault::coil_stuck_on || row.breaks == RigFault::key_stuck_released;
        CHECK(t.trial.caught_at_end != key_is_broken);
      }
    }
  }
}

TEST_CASE("each fault at rest is found in time and by its name") {
  for (const RigRow& row : rest_rows()) {
    const auto& what = sim_host::info(row.breaks);
    for (const Rig rig : {Rig::on_bus, Rig::local}) {
      if (rig == Rig::local && what.part == sim_host::RigPart::bus) continue;
      for (const Tried& t : try_at_rest(row, rig, 2)) {
        INFO(what.name << (rig == Rig::on_bus ? " on the bus: " : ": ") << control::info(t.trial.fault).name
                       << " after " << t.trial.found_tick);
        CHECK(broken_limit(row, t.trial) == "");
        CHECK(t.trial.caught_at_end == (row.breaks != RigFault::coil_stuck_on));
      }
    }
  }
}

TEST_CASE("a robot at rest with nothing broken raises no fault") {
  for (const Rig rig : {Rig::on_bus, Rig::local}) {
    sim::Scenario scenario = hopping(20.0);
    scenario.start_position = 0.33;
    const Trial trial = run_trial(robot(), scenario, 3, rig, {}, Use::resting);
    CHECK(trial.fault == control::Fault::none);
    CHECK(trial.unsafe == 0);
  }
}

TEST_CASE("the table has a row for every fault that the rig can have, once") {
  std::set<RigFault> rows;
  for (const RigRow& row : rig_rows()) CHECK(rows.insert(row.breaks).second);
  CHECK(rows.size() == sim_host::kRigFaults.size());
}

TEST_CASE("each fault that is to be found was found on furculad, within two ticks more than allowed") {
  for (const RigRow& row : rig_rows()) {
    const auto ticks = hil_ticks(row.breaks);
    INFO(sim_host::info(row.breaks).name);
    // One that may be borne as well need not have been found.
    if (ticks || !row.may_come_to_rest)
      CHECK(ticks.has_value() == (!row.is_borne() && tried_on_hil(row.breaks)));
    CHECK(ticks.value_or(0) <= row.found_within_ticks + 2);
  }
}

TEST_CASE("the tests that show the other rows are there") {
  for (const OtherRow& row : other_rows()) {
    INFO(row.breaks);
    CHECK(std::filesystem::exists(test::source(std::string(row.shown_by))));
  }
}

TEST_CASE("the tests that show what the signals do not tell are there") {
  for (const UntoldRow& row : untold_rows()) {
    INFO(row.what);
    CHECK(std::filesystem::exists(test::source(std::string(row.shown_by))));
  }
}

TEST_CASE("a robot with nothing broken raises no fault and is not unsafe, on a bus and without one") {
  for (const Rig rig : {Rig::on_bus, Rig::local}) {
    const Trial trial = run_trial(robot(), hopping(60.0), 5, rig);
    CHECK(trial.fault == control::Fault::none);
    CHECK(trial.unsafe == 0);
    CHECK(trial.hops > 120);
  }
}

TEST_CASE("the judge sees a flight that is too high and a landing that is too hard for what they are") {
  sim::Scenario high = hopping(1.0);
  high.start_position = 0.95;
  const Trial trial = run_trial(robot(), high, 1, Rig::local);
  CHECK(trial.is(Unsafe::off_the_rail));
  CHECK(trial.is(Unsafe::hard_impact));
  // A free fall, less what the guide's damping of 1 N s/m takes from 1.5 kg in 0.37 s.
  const double fall_mps = std::sqrt(2 * 9.81 * (0.95 - 0.2819));
  CHECK(trial.hardest_mps < fall_mps);
  CHECK(trial.hardest_mps > 0.8 * fall_mps);
}
