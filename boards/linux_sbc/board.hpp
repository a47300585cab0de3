// linux_sbc: a Linux computer as a board. Drive and encoders on CAN, switch and solenoid on GPIO lines.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "boards/linux_sbc/configuration.hpp"
#include "boards/linux_sbc/gpio.hpp"
#include "boards/linux_sbc/histogram.hpp"
#include "firmware/app/board.hpp"
#include "firmware/app/can_link.hpp"
#include "firmware/app/can_telemetry.hpp"
#include "firmware/app/start_fault.hpp"
#include "furcula/bus/node_words.hpp"
#include "host/core/timer.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::linux_sbc {

/// What the loop's thread tells of its time, for any thread to read.
struct LoopFigures {
  Histogram lateness;  ///< from when a tick was due to when the loop woke
  Histogram work;      ///< from there to the end of the tick
  std::atomic<std::uint64_t> overruns{0}, ticks{0}, edges{0};
  std::atomic<std::uint64_t> can_refused{0}, can_errors{0};
  std::atomic<socketcan::CanState> can_state{socketcan::CanState::on};
};

/// `Bus`, `Lines` and `Ticks` are CanSocket, Gpio and Timer, or what a test puts in their place.
template <class Bus, class Lines, class Ticks = core::Timer>
class LinuxBoard {
 public:
  LinuxBoard(const Configuration& configuration, Bus& bus, Lines& lines, const std::atomic<bool>& stop,
             LoopFigures& figures)
      : link_(configuration.link),
        telemetry_({.node = configuration.link.self_node, .period_ticks = 10}),
        bus_(bus),
        lines_(lines),
        stop_(stop),
        figures_(figures) {
    link_.set_home(configuration.home_count, configuration.home_height_m, configuration.cable_home_count);
  }

  // The board's seam.

  /// Ends with a few ticks in the safe state once `stop` is set: one frame to the drive may be lost.
  bool wait_for_tick() {
    if (!started_) {
      timer_.start();
      started_ = true;
    } else {
      figures_.work.add(Ticks::now_ns() - timer_.woke_ns());
    }
    figures_.lateness.add(timer_.wait());
    figures_.overruns.store(timer_.overruns(), std::memory_order_relaxed);
    now_us_ = static_cast<std::uint32_t>(timer_.woke_ns() / 1000);
    receive();
    return !stop_.load(std::memory_order_relaxed);
  }

  std::uint32_t now_us() const { return now_us_; }

  Result<control::Sample> sense() {
    const SwitchReading contact = lines_.read_switch();
    if (contact.edges != 0) figures_.edges.fetch_add(contact.edges, std::memory_order_relaxed);
    const Result<control::Sample> heard = link_.sample(now_us_);
    if (!heard.ok()) return heard.status();
    if (!contact.ok) return Status::disconnected;
    sample_ = heard.value();
    sample_.contact = contact.closed ? 1 : 0;
    const control::Fault of_start = start_fault_.tick();
    if (of_start != control::Fault::none) sample_.reported_fault = static_cast<std::uint32_t>(of_start);
    return sample_;
  }

  Status actuate(const control::Command& command) {
    const bool taken = send(link_.command(command, run_));
    return lines_.set_solenoid(modulate(command.coil_duty)) && taken ? Status::ok : Status::disconnected;
  }

  /// The service manager's watchdog follows this count (daemon.cpp); the drive has its own, which acts when
  /// frames stop.
  void kick_watchdog() { figures_.ticks.fetch_add(1, std::memory_order_relaxed); }

  bool take_reset_request() { return false; }

  void report(const firmware::Telemetry& telemetry) {
    firmware::FrameBatch batch = telemetry_.tick(telemetry, sample_, state_);
    if (link_.registers().answering()) {
      batch.add(link_.registers().next());
      link_.registers().advance();  // whose frame is not taken asks again
    }
    send(batch);
  }

  // What stands around the application.

  firmware::CanLink& link() { return link_; }
  void introduce(const bus::Identity& identity, const firmware::FaultLog& faults) {
    telemetry_.introduce(identity, faults);
  }
  /// Before the first tick: what the start found.
  void report_start_fault(control::Fault fault) { start_fault_.report(fault); }
  /// Before each tick: whether the drive shall be on, and what the heartbeat says.
  void set_state(bus::NodeState state) {
    run_ = state == bus::NodeState::running;
    state_ = state;
  }

 private:
  static constexpr std::int64_t kPeriodNs = 1'000'000;

  void receive() {
    for (const socketcan::Received& r : bus_.receive())
      link_.receive(r.frame, now_us_ - static_cast<std::uint32_t>(r.age_ns / 1000));
    // One that was off and is back is told as well: the controller's fault stays until a person resets it.
    const socketcan::CanState state = bus_.state();
    if (times_off_ != bus_.times_off()) link_.note(firmware::BusEvent::off);
    times_off_ = bus_.times_off();
    if (state == socketcan::CanState::on && link_.bus_is_off()) link_.note(firmware::BusEvent::recovered);
    figures_.can_state.store(state, std::memory_order_relaxed);
    const std::uint64_t errors = bus_.counters().error_frames;
    for (; errors_ < errors; ++errors_) link_.note(firmware::BusEvent::error);
    figures_.can_errors.store(errors, std::memory_order_relaxed);
  }

  bool send(const firmware::FrameBatch& frames) {
    const bool taken = bus_.send(std::span<const bus::Frame>(frames.begin(), frames.end()));
    if (!taken) figures_.can_refused.fetch_add(1, std::memory_order_relaxed);
    return taken;
  }

  /// A line is on or off: so many ticks of it are on that their mean is the duty. A coil's current is slower
  /// than that.
  bool modulate(float duty) {
    if (!(duty > 0.0f)) {
      owed_ = 0.0f;
      return false;
    }
    owed_ += duty < 1.0f ? duty : 1.0f;
    const bool on = owed_ >= 0.999f;
    if (on) owed_ -= 1.0f;
    return on;
  }

  firmware::CanLink link_;
  firmware::CanTelemetry telemetry_;
  Bus& bus_;
  Lines& lines_;
  const std::atomic<bool>& stop_;
  LoopFigures& figures_;
  Ticks timer_{kPeriodNs};
  control::Sample sample_;
  bool started_ = false, run_ = false;
  bus::NodeState state_ = bus::NodeState::starting;
  firmware::StartFault start_fault_;
  std::uint32_t now_us_ = 0;
  std::uint64_t errors_ = 0, times_off_ = 0;
  float owed_ = 0.0f;
};

using Board = LinuxBoard<socketcan::CanSocket, Gpio>;
static_assert(firmware::Board<Board>);

}  // namespace furcula::linux_sbc
