// The application: the controller on a board, once a millisecond.
#pragma once

#include <cstdint>
#include <new>
#include <type_traits>

#include "firmware/app/board.hpp"
#include "furcula/control/controller.hpp"

namespace furcula::firmware {

inline constexpr std::uint32_t kTickPeriodUs = 1000;
inline constexpr float kTickPeriodS = 0.001f;

// Of a node's start, in ticks, that is, ms.
inline constexpr std::uint32_t kSettledTicks = 50;  ///< without a fault: the start is over
inline constexpr std::uint32_t kStartTicks = 1000;  ///< a fault that still stands then is shown

/// Since the start, or since clear_statistics().
struct TickStatistics {
  std::uint32_t last_interval_us = 0;
  std::uint32_t longest_interval_us = 0;
  std::uint32_t missed_samples = 0;    ///< ticks on which the sensors did not answer
  std::uint32_t refused_by_drive = 0;  ///< ticks on which the drive did not take its command
};

template <Board B>
class App {
 public:
  /// Keeps a reference to `board`, which must outlive the application. `first_tick`: the number of the first one;
  /// they wrap after 49.7 days.
  App(B& board, const control::Config& config, std::uint32_t first_tick = 0)
      : board_(board), config_(config), state_(control::begin(config)), tick_(first_tick) {}

  /// Ticks until the board shuts down; leaves it in the safe state.
  void run() {
    while (board_.wait_for_tick()) tick();
    static_cast<void>(board_.actuate(control::Command{}));
  }

  const control::State& state() const { return state_; }
  const control::Config& config() const { return config_; }
  /// Of the last tick.
  const Telemetry& telemetry() const { return telemetry_; }
  const TickStatistics& statistics() const { return statistics_; }
  void clear_statistics() { statistics_ = {}; }

  /// Whether the controller may command more than the safe state, from the next tick on. It may unless told
  /// otherwise.
  void set_run(bool run) { run_ = run; }
  /// Clears the latched fault on the next tick.
  void request_reset() { reset_ = true; }

  /// Another configuration, for a controller that does not run. The latched fault, the last sample and the
  /// coil's heat stay; what the clutch had learned begins anew.
  void configure(const control::Config& config) {
    const control::SupervisorState supervisor = state_.supervisor;
    const control::Sample last_sample = state_.last_sample;
    const std::uint32_t missed_samples = state_.missed_samples;
    const control::CoilState coil = state_.coil;
    config_ = config;
    state_ = control::begin(config);
    state_.supervisor = supervisor;
    state_.last_sample = last_sample;
    state_.missed_samples = missed_samples;
    state_.coil = coil;
  }

  /// The robot stands on the ground: from now on the height counts from what the leg's angle says, the cable
  /// from where it is; on the bench that alone. `invalid`: the switch is open, there was no sample, or it has
  /// no leg angle.
  Status home() {
    const control::Sample& now = state_.last_sample;
    const bool on_bench = config_.bench.on_bench != 0;
    if (on_bench && state_.missed_samples == 0) {
      home_ = now;
      homed_ = true;
      return Status::ok;
    }
    if (on_bench || state_.missed_samples != 0 || now.contact == 0 || !is_finite(now.leg_angle_rad))
      return Status::invalid;
    home_ = now;
    home_.home_height_m = control::leg_height_m(config_.link_length_m, now.leg_angle_rad);
    homed_ = true;
    configure(config_);  // no velocity from here to there
    return Status::ok;
  }

  /// One tick, right after wait_for_tick().
  void tick() {
    const std::uint32_t now_us = board_.now_us();
    control::Inputs inputs;
    inputs.tick_interval_us = ticked_ ? now_us - last_us_ : kTickPeriodUs;
    ticked_ = true;
    last_us_ = now_us;
    const Result<control::Sample> sample = board_.sense();
    // A drive that did not take the last command is as much a lost peer as sensors that do not answer.
    inputs.sample_valid = sample.ok() && drive_answers_;
    if (sample.ok()) inputs.sample = sample.value();
    if (homed_) {
      inputs.sample.home_count = home_.height_count;
      inputs.sample.home_height_m = home_.home_height_m;
      inputs.sample.cable_home_count = home_.cable_count;
    }
    inputs.reset = board_.take_reset_request() || reset_;
    reset_ = false;
    inputs.run = run_;

    // Made where it stays: a copy of what has just been written in pieces costs as much as a tenth of the tick.
    static_assert(std::is_trivially_destructible_v<Telemetry>);
    ::new (&telemetry_) Telemetry{tick_, control::step(config_, state_, inputs, kTickPeriodS)};
    drive_answers_ = board_.actuate(telemetry_.outputs.command) == Status::ok;
    board_.kick_watchdog();
    board_.report(telemetry_);
    ++tick_;
    count(inputs.tick_interval_us, sample.ok());
  }

 private:
  void count(std::uint32_t interval_us, bool sensed) {
    statistics_.last_interval_us = interval_us;
    if (interval_us > statistics_.longest_interval_us) statistics_.longest_interval_us = interval_us;
    if (!sensed) ++statistics_.missed_samples;
    if (!drive_answers_) ++statistics_.refused_by_drive;
  }

  B& board_;
  control::Config config_;
  control::State state_;
  Telemetry telemetry_;
  TickStatistics statistics_;
  control::Sample home_;  ///< as it was when it was homed
  std::uint32_t tick_ = 0;
  std::uint32_t last_us_ = 0;
  bool ticked_ = false, drive_answers_ = true;
  bool run_ = true, reset_ = false, homed_ = false;
};

}  // namespace furcula::firmware
