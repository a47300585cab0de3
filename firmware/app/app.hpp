// The application: the controller on a board, once a millisecond.
#pragma once

#include <cstdint>

#include "firmware/app/board.hpp"
#include "furcula/control/controller.hpp"

namespace furcula::firmware {

inline constexpr std::uint32_t kTickPeriodUs = 1000;
inline constexpr float kTickPeriodS = 0.001f;

template <Board B>
class App {
 public:
  /// Keeps a reference to `board`, which must outlive the application.
  App(B& board, const control::Config& config)
      : board_(board), config_(config), state_(control::begin(config)) {}

  /// Ticks until the board shuts down; leaves it in the safe state.
  void run() {
    while (board_.wait_for_tick()) tick();
    static_cast<void>(board_.actuate(control::Command{}));
  }

  const control::State& state() const { return state_; }

  /// One tick, right after wait_for_tick().
  void tick() {
    const std::uint32_t now_us = board_.now_us();
    control::Inputs inputs;
    inputs.tick_interval_us = tick_ == 0 ? kTickPeriodUs : now_us - last_us_;
    last_us_ = now_us;
    const Result<control::Sample> sample = board_.sense();
    // A drive that did not take the last command is as much a lost peer as sensors that do not answer.
    inputs.sample_valid = sample.ok() && drive_answers_;
    if (sample.ok()) inputs.sample = sample.value();
    inputs.reset = board_.take_reset_request();

    const Telemetry telemetry{tick_, control::step(config_, state_, inputs, kTickPeriodS)};
    drive_answers_ = board_.actuate(telemetry.outputs.command) == Status::ok;
    board_.kick_watchdog();
    board_.report(telemetry);
    ++tick_;
  }

 private:
  B& board_;
  control::Config config_;
  control::State state_;
  std::uint32_t tick_ = 0;
  std::uint32_t last_us_ = 0;
  bool drive_answers_ = true;
};

}  // namespace furcula::firmware
