// The simulated bench at the other ends of a board's wires, and furculad on it as far as no kernel's bus is
// needed: what is, `scripts/hil bench` shows.
#include "host/bench/hil_board.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

#include "firmware/app/can_link.hpp"
#include "host/bench/release_catch.hpp"
#include "host/rig/rig.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::bench;
using Catch::Contains;

namespace {

/// Frames and a line in memory.
struct Cable : Wires {
  bool coil() override { return on; }
  void send(const bus::Frame& frame) override { sent.push_back(frame); }
  std::vector<bus::Frame> receive() override { return {}; }

  bool on = false;
  std::vector<bus::Frame> sent;
};

/// A board whose encoder is a node on a bus, where frames come so many ticks after they were sent; in lock
/// step with the stand.
class BoardOnBus final : public StandBoard {
 public:
  explicit BoardOnBus(std::size_t late_ticks) : late_ticks_(late_ticks) {}

  std::string name() const override { return "on a bus"; }
  std::vector<Reading> run(const Conditions& conditions, const Timing& timing) override {
    Cable cable;
    StandPlayer player(stand_, cable);
    player.hang(conditions);
    Seam seam{player, cable, late_ticks_};
    firmware::App app(seam, stand_config(stand_, timing));
    std::vector<Reading> rows;
    // It hangs for a moment before the board's trial begins.
    for (int i = 0; i < 10; ++i) player.tick();
    while (rows.size() < timing.rows() && seam.wait_for_tick()) {
      app.tick();
      REQUIRE(app.telemetry().outputs.fault == control::Fault::none);
      rows.push_back({.count = static_cast<std::int32_t>(app.state().last_sample.cable_count),
                      .coil = static_cast<double>(app.telemetry().outputs.command.coil_duty)});
    }
    return rows;
  }

 private:
  struct Seam {
    StandPlayer& player;
    Cable& cable;
    std::size_t late_ticks;
    firmware::CanLink link{[] {
      firmware::CanLinkConfig c;
      c.cable_node = rig::kCableNode;
      return c;
    }()};
    std::uint32_t now = 0;
    std::size_t heard = 0;

    bool wait_for_tick() {
      now += 1000;
      link.set_on_bench(true);
      player.tick();
      for (; heard + late_ticks < cable.sent.size(); ++heard) link.receive(cable.sent[heard], now);
      return true;
    }
    std::uint32_t now_us() const { return now; }
    Result<control::Sample> sense() { return link.sample(now); }
    Status actuate(const control::Command& command) {
      cable.on = command.coil_duty > 0.0f;
      return Status::ok;
    }
    static void kick_watchdog() {}
    static bool take_reset_request() { return false; }
    static void report(const firmware::Telemetry&) {}
  };
  static_assert(firmware::Board<Seam>);

  std::size_t late_ticks_;
};

/// As far as a board on a bus sees them.
void require_same(const Trial& a, const Trial& b, std::size_t later) {
  REQUIRE(a.readings.size() == b.readings.size());
  std::size_t differing = 0;
  for (std::size_t n = later; n < a.readings.size(); ++n)
    differing +=
        a.readings[n - later].count != b.readings[n].count || a.readings[n].coil != b.readings[n].coil;
  CHECK(differing == 0);
  CHECK(b.released_after_s == Approx(a.released_after_s + 1e-3 * static_cast<double>(later)));
  CHECK(b.caught_after_s == Approx(a.caught_after_s + 1e-3 * static_cast<double>(later)));
  CHECK(b.drop_m == a.drop_m);
  CHECK(a.readings.back().count > 100);
}

/// As furcula hil-rig has them, with a program that is none.
rig::RigOptions options(const test::TemporaryFolder& folder, std::vector<std::string> command) {
  rig::RigOptions o;
  o.command = std::move(command);
  o.gpio_chip = "/dev/gpiochip0";
  o.configuration_path = folder.path() + "/furculad.toml";
  return o;
}

}  // namespace

TEST_CASE("Behind a bus and a line the trial is the simulated bench's, later by what the bus takes") {
  SimBoard here;
  for (const std::size_t late : {0u, 1u}) {
    BoardOnBus there(late);
    for (const double window_s : {0.030, 0.040, 0.055}) {
      Conditions c;
      c.window_s = window_s;
      c.supply_v = 11.5;
      c.load_kg = 1.1;
      require_same(run_trial(here, c), run_trial(there, c), late);
    }
  }
}

TEST_CASE("A program that cannot be started, or that ends, is an error that says so, and its file is gone") {
  const test::TemporaryFolder folder;
  const auto start = [&](std::vector<std::string> command) {
    return test::error_message(
        [&] { HilBoard(options(folder, std::move(command)), std::make_unique<Cable>()); });
  };
  CHECK_THAT(start({"/nowhere/furculad"}), Contains("hil: cannot start /nowhere/furculad"));
  CHECK_THAT(start({"/bin/sh", "-c", "exit 3"}), Contains("hil: the board's program ended with status 3"));
  CHECK_THAT(start({"/bin/sh", "-c", "kill -KILL $$"}),
             Contains("hil: the board's program was ended by signal 9"));
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("A line that cannot be read ends the stand, and that is what is said") {
  struct Broken : Cable {
    bool coil() override { throw rig::RigError("the solenoid's line cannot be read"); }
  };
  const test::TemporaryFolder folder;
  CHECK_THAT(test::error_message([&] {
               HilBoard(options(folder, {"/bin/sh", "-c", "exec sleep 60"}), std::make_unique<Broken>());
             }),
             Contains("hil: the solenoid's line cannot be read"));
}

TEST_CASE("A board that is idle and does not answer over Modbus is an error that names the port") {
  struct Idle : Cable {
    std::vector<bus::Frame> receive() override {
      bus::Frame frame = bus::empty_frame(bus::message::kHeartbeat, rig::kBoardNode);
      static_cast<void>(bus::put_raw(frame, bus::signal(bus::message::kHeartbeat, "State"), 1));
      return {frame};
    }
  };
  const test::TemporaryFolder folder;
  CHECK_THAT(test::error_message([&] {
               HilBoard(options(folder, {"/bin/sh", "-c", "exec sleep 60"}), std::make_unique<Idle>());
             }),
             Contains("modbus:127.0.0.1:1502: opening it"));
}
