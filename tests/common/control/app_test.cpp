// The application on a board that only plays back.
#include "firmware/app/app.hpp"

#include <catch2/catch.hpp>
#include <utility>
#include <vector>

using namespace furcula;

namespace {

/// Stands compressed on the ground; writes down what it is told.
struct RecordingBoard {
  std::vector<std::uint32_t> clock_us;
  std::size_t ticks_done = 0;
  bool answers = true;
  bool drive_answers = true;
  bool reset = false;
  std::vector<control::Command> commands;
  std::vector<firmware::Telemetry> reports;
  int kicks = 0;

  bool wait_for_tick() { return ticks_done < clock_us.size(); }
  std::uint32_t now_us() { return clock_us[ticks_done++]; }
  Result<control::Sample> sense() const {
    if (!answers) return Status::disconnected;
    control::Sample sample;
    sample.home_height_m = 0.22f;
    sample.leg_angle_rad = 0.747584f;  // acos(0.22 / 0.3)
    sample.contact = 1;
    return sample;
  }
  Status actuate(const control::Command& command) {
    commands.push_back(command);
    return drive_answers ? Status::ok : Status::disconnected;
  }
  void kick_watchdog() { ++kicks; }
  bool take_reset_request() { return std::exchange(reset, false); }
  void report(const firmware::Telemetry& telemetry) { reports.push_back(telemetry); }
};
static_assert(firmware::Board<RecordingBoard>);

control::Config harmonic() {
  control::Config config;
  config.torque = {control::ProfileShape::harmonic, 2.0f, 0.3f};
  return config;
}

}  // namespace

TEST_CASE("each tick senses, actuates, kicks the watchdog and reports, and the end leaves the safe state") {
  RecordingBoard board;
  for (std::uint32_t i = 0; i < 50; ++i) board.clock_us.push_back(0xffffb000u + 1000 * i);  // wraps at 20 ms
  firmware::App app(board, harmonic());
  app.run();
  CHECK(board.kicks == 50);
  REQUIRE(board.reports.size() == 50);
  CHECK(board.reports.back().tick == 49);
  CHECK(board.reports.back().outputs.fault == control::Fault::none);
  CHECK(board.commands[49].torque_nm > 0.5f);  // T sin(2 pi 0.05 / 0.3) would be 1.7
  REQUIRE(board.commands.size() == 51);
  CHECK(board.commands.back().torque_nm == 0.0f);
}

TEST_CASE("the application measures the time between ticks: one that is late is a fault, a reset clears it") {
  RecordingBoard board;
  for (std::uint32_t i = 0; i < 30; ++i) board.clock_us.push_back(1000 * i + (i >= 20 ? 3000 : 0));
  firmware::App app(board, harmonic());
  for (int i = 0; i < 20; ++i) app.tick();
  CHECK(board.reports.back().outputs.fault == control::Fault::none);
  app.tick();
  CHECK(board.reports.back().outputs.fault == control::Fault::late_tick);
  app.tick();
  CHECK(board.reports.back().outputs.fault == control::Fault::late_tick);
  board.reset = true;
  app.tick();
  CHECK(board.reports.back().outputs.fault == control::Fault::none);
}

TEST_CASE("a board without sensors is a lost peer within two ticks, and the watchdog is still kicked") {
  RecordingBoard board;
  for (std::uint32_t i = 0; i < 30; ++i) board.clock_us.push_back(1000 * i);
  firmware::App app(board, harmonic());
  for (int i = 0; i < 20; ++i) app.tick();
  REQUIRE(board.commands.back().torque_nm > 0.0f);
  board.answers = false;
  app.tick();
  app.tick();
  CHECK(board.commands.back().torque_nm == 0.0f);
  CHECK(board.reports.back().outputs.fault == control::Fault::peer_lost);
  CHECK(board.kicks == 22);
}

TEST_CASE("a drive that takes no command is a lost peer within two ticks") {
  RecordingBoard board;
  for (std::uint32_t i = 0; i < 30; ++i) board.clock_us.push_back(1000 * i);
  firmware::App app(board, harmonic());
  for (int i = 0; i < 20; ++i) app.tick();
  board.drive_answers = false;
  app.tick();  // the first command that is not taken
  CHECK(board.reports.back().outputs.fault == control::Fault::none);
  app.tick();
  app.tick();
  CHECK(board.reports.back().outputs.fault == control::Fault::peer_lost);
  CHECK(board.commands.back().torque_nm == 0.0f);
}
