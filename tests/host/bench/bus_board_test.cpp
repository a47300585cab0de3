// The release/catch test on a board that answers to Modbus: the simulated bench with a node on it.
#include "host/bench/bus_board.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "host/bench/live_stand.hpp"
#include "host/bench/release_catch.hpp"
#include "host/bench/sim_board.hpp"
#include "host/modbus/client.hpp"
#include "host/modbus/tcp_server.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/modbus/can_bus.hpp"

using namespace furcula;
using namespace furcula::bench;
using Catch::Contains;

namespace {

/// Its time goes on with each request, so that nothing depends on this computer's.
struct Stand {
  LiveStand live{{}, {"sim_host", "1.0.0", 0x010000, 0}, 77};
  std::atomic<int> ticks = 60;
  modbus::TcpService server{"127.0.0.1", 0, [this](std::span<const std::uint8_t> request) {
                              live.advance(ticks);
                              return live.answer(request);
                            }};
  std::string port() const { return "modbus:127.0.0.1:" + std::to_string(server.port()); }
};

BusBoard open(const std::string& port) {
  return {modbus::parse_port(port), 20, [](const Conditions&) {}};
}

}  // namespace

TEST_CASE("A trial over Modbus is the board's own: every millisecond of it, as on the simulated bench") {
  Stand stand;
  BusBoard there = open(stand.port());
  SimBoard here;
  CHECK(there.metres_per_count() == Approx(here.metres_per_count()).epsilon(1e-6));
  CHECK(there.tooth_pitch_m() == Approx(here.tooth_pitch_m()).epsilon(1e-6));
  CHECK(there.pulley_radius_m() == Approx(here.pulley_radius_m()).epsilon(1e-6));
  for (const double window_s : {0.030, 0.040, 0.055}) {
    Conditions c;
    c.window_s = window_s;
    const Trial a = run_trial(here, c), b = run_trial(there, c);
    REQUIRE(a.readings.size() == b.readings.size());
    std::size_t differing = 0;
    for (std::size_t n = 0; n < a.readings.size(); ++n)
      differing += a.readings[n].count != b.readings[n].count || a.readings[n].coil != b.readings[n].coil;
    CHECK(differing == 0);
    CHECK(a.caught_after_s == b.caught_after_s);
    CHECK(a.readings.back().count > 100);
  }
}

TEST_CASE("A trial over CAN is the one over Modbus, bit for bit, also where frames are lost") {
  Stand stand;
  BusBoard over_modbus = open(stand.port());
  LiveStand live{{}, {"sim_host", "1.0.0", 0x010000, 0}, 77};
  test::CanBus bus;
  bus.tick = [&] { live.advance(1); };
  bus.answer = [&](std::span<const std::uint8_t> request) { return live.answer(request); };
  bus.loses = [](int frame) { return frame % 97 == 0; };
  live.advance(60);
  BusBoard over_can("can:test", bus.connect(), 20, [](const Conditions&) {});
  CHECK(over_can.metres_per_count() == over_modbus.metres_per_count());
  Conditions c;
  c.window_s = 0.045;
  const Trial a = run_trial(over_modbus, c), b = run_trial(over_can, c);
  REQUIRE(a.readings.size() == b.readings.size());
  std::size_t differing = 0;
  for (std::size_t n = 0; n < a.readings.size(); ++n)
    differing += a.readings[n].count != b.readings[n].count || a.readings[n].coil != b.readings[n].coil;
  CHECK(differing == 0);
  CHECK(a.readings.size() > 500);
  CHECK(b.readings.back().count > 100);
}

TEST_CASE(
    "On a board that cannot hang weights the window alone is varied, and what is not measured not logged") {
  Stand stand;
  BusBoard board = open(stand.port());
  Options options;
  options.trials = 4;
  options.conditions.load_kg = 1.0;
  const ReleaseCatch r = run_release_catch(board, options, {});
  for (const Trial& t : r.trials) {
    CHECK(t.conditions.load_kg == 1.0);
    CHECK(t.conditions.supply_v == options.conditions.supply_v);
    CHECK(t.conditions.window_s != options.conditions.window_s);
  }
  REQUIRE(r.sweeps.size() == 1);
  CHECK(r.sweeps[0].of == "window_s");
  CHECK(r.holding.empty());
  const log::Log log = to_log(r.standard, board, "standard.csv");
  CHECK(log.columns.count("voltage_v") == 0);
  CHECK(log.columns.count("current_a") == 0);
  CHECK(log.columns.at("time_s").size() == 561);
  Limits limits;
  limits.holding_min_kg = 4.0;
  CHECK_THAT(test::error_message([&] { run_release_catch(board, options, limits); }),
             Contains("holding_min_kg is asked for, and this board cannot set the load"));
}

TEST_CASE(
    "Home is where the load hangs again, also for who asks in the same millisecond in which a trial ended") {
  Stand stand;
  modbus::Client client(modbus::parse_port(stand.port()));
  client.write(*bus::parameter_named("bench_window_ms"), 40.0f);
  client.request(bus::Request::arm);
  client.request(bus::Request::hop);
  const auto ended = [&] { return client.snapshot().reason == static_cast<int>(bus::Reason::trial_ended); };
  stand.ticks = 1;
  for (int i = 0; i < 1000 && !ended(); ++i) {
  }
  stand.ticks = 0;
  REQUIRE(ended());
  client.request(bus::Request::home);
  stand.ticks = 1;
  CHECK(client.snapshot().cable_travel_m == 0.0f);
}

TEST_CASE("A board that is not there, not on a bench, or asked for what it cannot do, says so") {
  CHECK_THAT(test::error_message([] { open("modbus:127.0.0.1:9"); }), Contains("modbus:127.0.0.1:9"));
  Stand stand;
  BusBoard board = open(stand.port());
  Conditions c;
  c.window_s = 0.600;
  CHECK_THAT(test::error_message([&] { run_trial(board, c); }),
             Contains("a window of 600 ms; this board makes 1 to 500"));
  modbus::Client client(modbus::parse_port(stand.port()));
  client.write(*bus::parameter_named("on_bench"), 0.0f);
  CHECK_THAT(test::error_message([&] { open(stand.port()); }),
             Contains("the board is not on a bench: its parameter on_bench is 0"));
}
