// What the robot tells the bus, read back by the table of messages.
#include "firmware/app/can_telemetry.hpp"

#include <catch2/catch.hpp>
#include <cmath>

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

TEST_CASE("a height that is not a number leaves a frame all the same") {
  CanTelemetry source({1, 10, 0});
  Telemetry telemetry;
  telemetry.outputs.height.height_m = NAN;
  telemetry.outputs.fault = control::Fault::non_finite_input;
  const FrameBatch batch = source.tick(telemetry, {}, NodeState::fault);
  REQUIRE(batch.count == 1);
  CHECK(bus::get(batch.frame[0], bus::signal(bus::message::kBodyState, "Fault")).value() == 5.0f);
}
