// What the robot tells the bus, read back by the table of messages.
#include "firmware/app/can_telemetry.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "firmware/app/start_fault.hpp"

using namespace furcula;
using namespace furcula::firmware;

TEST_CASE("body, leg and heartbeat leave ten times a second each, on different ticks, with what happened") {
  CanTelemetry source({4, 100, 100});
  Telemetry telemetry;
  telemetry.outputs.height = {0.3125f, -1.25f};
  telemetry.outputs.phase.phase = control::Phase::stance;
  telemetry.outputs.fault = control::Fault::drive_silent;
  telemetry.outputs.command = {-2.5f, 0.4f};
  control::Sample sample;
  sample.leg_angle_rad = 0.8f;
  sample.age_us = 700;
  sample.contact = 1;
  int bodies = 0, legs = 0, beats = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    const FrameBatch batch = source.tick(telemetry, sample, NodeState::fault);
    REQUIRE(batch.count <= 1);
    for (const bus::Frame& f : batch) {
      const auto value = [&](const bus::Message& m, std::string_view name) {
        for (const bus::Signal& s : m.signals)
          if (s.name == name) return bus::get(f, s).value();
        return NAN;
      };
      using namespace bus::message;
      if (bus::is(f, kBodyState, 4)) {
        CHECK(value(kBodyState, "Height") == Approx(0.3125).margin(6e-5));
        CHECK(value(kBodyState, "Velocity") == Approx(-1.25));
        CHECK(value(kBodyState, "Phase") == 1.0f);
        CHECK(value(kBodyState, "Fault") == 13.0f);
        CHECK(value(kBodyState, "Sequence") == static_cast<float>(bodies));
        CHECK(value(kBodyState, "Age") == Approx(0.0007));
        ++bodies;
      } else if (bus::is(f, kLegState, 4)) {
        CHECK(value(kLegState, "Leg_Angle") == Approx(0.8));
        CHECK(value(kLegState, "Torque") == Approx(-2.5));
        CHECK(value(kLegState, "Contact") == 1.0f);
        CHECK(value(kLegState, "Solenoid") == 1.0f);
        ++legs;
      } else if (bus::is(f, kHeartbeat, 4)) {
        CHECK(value(kHeartbeat, "State") == 3.0f);
        CHECK(value(kHeartbeat, "Fault") == 13.0f);
        CHECK(value(kHeartbeat, "Uptime") == Approx(1e-3 * tick));
        ++beats;
      }
    }
  }
  CHECK(bodies == 10);
  CHECK(legs == 10);
  CHECK(beats == 10);
}

TEST_CASE("who it is, its number and its log of faults come in turn, all of them within 1.2 s") {
  CanTelemetry source({4, 100, 100});
  FaultLog faults{};
  faults.begin();
  faults.note(5, 3);
  faults.note(1234, 13);
  const bus::Identity identity{.board = "x",
                               .text = "",
                               .firmware_version = 0x010203,
                               .build_id = 0xcafe0123,
                               .reset_cause = bus::ResetCause::watchdog,
                               .unique_id = {0x11111111, 0x89abcdef, 3}};
  source.introduce(identity, faults);
  using namespace bus::message;
  const auto raw = [](const bus::Frame& f, const bus::Signal& s) { return bus::get_raw(f, s).value(); };
  std::map<std::uint32_t, std::uint32_t> parts;
  std::map<std::uint32_t, std::array<std::uint32_t, 3>> entries;
  int identities = 0;
  for (int tick = 0; tick < 1200; ++tick) {
    const FrameBatch batch = source.tick({}, {}, NodeState::idle);
    REQUIRE(batch.count <= 1);
    for (const bus::Frame& f : batch) {
      if (bus::is(f, kIdentity, 4)) {
        ++identities;
        CHECK(raw(f, bus::signal(kIdentity, "Reset_Cause")) == 4);
        CHECK(raw(f, bus::signal(kIdentity, "Firmware_Version")) == 0x010203);
        CHECK(raw(f, bus::signal(kIdentity, "Build_Id")) == 0xcafe0123);
      } else if (bus::is(f, kUniqueId, 4)) {
        parts[raw(f, bus::signal(kUniqueId, "Part"))] = raw(f, bus::signal(kUniqueId, "Bits"));
      } else if (bus::is(f, kLoggedFault, 4)) {
        entries[raw(f, bus::signal(kLoggedFault, "Entry"))] = {raw(f, bus::signal(kLoggedFault, "Fault")),
                                                               raw(f, bus::signal(kLoggedFault, "Start")),
                                                               raw(f, bus::signal(kLoggedFault, "Tick"))};
      }
    }
  }
  CHECK(identities == 1);
  CHECK(parts == std::map<std::uint32_t, std::uint32_t>{{0, 0x11111111}, {1, 0x89abcdef}, {2, 3}});
  REQUIRE(entries.size() == 8);
  CHECK(entries[0] == std::array<std::uint32_t, 3>{13, 1, 1234});
  CHECK(entries[1] == std::array<std::uint32_t, 3>{3, 1, 5});
  CHECK(entries[7] == std::array<std::uint32_t, 3>{0, 0, 0});
}

TEST_CASE("a height that is not a number leaves a frame all the same") {
  CanTelemetry source({1, 10, 0});
  Telemetry telemetry;
  telemetry.outputs.height.height_m = NAN;
  telemetry.outputs.fault = control::Fault::non_finite_input;
  const FrameBatch batch = source.tick(telemetry, {}, NodeState::fault);
  REQUIRE(batch.count == 1);
  CHECK(bus::get(batch.frame[0], bus::signal(bus::message::kBodyState, "Fault")).value() == 5.0f);
}

TEST_CASE("no two heartbeats are farther apart than 100 ms where the ticks' number wraps, after 49.7 days") {
  CanTelemetry telemetry({.node = 2, .period_ticks = 100, .heartbeat_ticks = 100, .first_tick = 0u - 1000u});
  int since = 0, longest = 0, heartbeats = 0;
  for (int i = 0; i < 3000; ++i) {
    ++since;
    for (const bus::Frame& frame : telemetry.tick({}, {}, NodeState::idle))
      if (bus::is(frame, bus::message::kHeartbeat, 2)) {
        if (heartbeats++ > 0) longest = std::max(longest, since);
        since = 0;
      }
  }
  CHECK(longest == 100);
  CHECK(heartbeats >= 30);
}

TEST_CASE("a fault that the start found is reported for a while and never again") {
  StartFault found;
  CHECK(found.tick() == control::Fault::none);
  found.report(control::Fault::parameters_lost);
  for (int i = 0; i < 1500; ++i) REQUIRE(found.tick() == control::Fault::parameters_lost);
  for (int i = 0; i < 10'000; ++i) REQUIRE(found.tick() == control::Fault::none);
}
