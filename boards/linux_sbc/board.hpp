// linux_sbc: a Linux computer as a board. Drive and encoders on CAN, switch and solenoid on GPIO lines.
#pragma once

#include <atomic>
#include <cstdint>

#include "boards/linux_sbc/can_port.hpp"
#include "boards/linux_sbc/configuration.hpp"
#include "boards/linux_sbc/figures.hpp"
#include "boards/linux_sbc/gpio.hpp"
#include "boards/linux_sbc/loop_clock.hpp"
#include "firmware/app/board.hpp"
#include "firmware/app/can_link.hpp"
#include "firmware/app/can_telemetry.hpp"
#include "firmware/app/start_fault.hpp"
#include "furcula/bus/node_words.hpp"
#include "host/core/timer.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::linux_sbc {

/// `Bus`, `Lines` and `Ticks` are CanSocket, Gpio and Timer, or what a test puts in their place.
template <class Bus, class Lines, class Ticks = core::Timer>
class LinuxBoard {
 public:
  LinuxBoard(const Configuration& configuration, Bus& bus, Lines& lines, const std::atomic<bool>& stop,
             LoopFigures& figures)
      : link_(configuration.link),
        telemetry_({.node = configuration.link.self_node, .period_ticks = 10}),
        port_(bus, 0, figures),
        lines_(lines),
        clock_(stop, figures),
        figures_(figures) {
    link_.set_home(configuration.home_count, configuration.home_height_m, configuration.cable_home_count);
  }

  // The board's seam.

  /// Ends with a few ticks in the safe state once `stop` is set: one frame to the drive may be lost.
  bool wait_for_tick() {
    clock_.wait();
    port_.receive(link_, now_us());
    return clock_.goes_on();
  }

  std::uint32_t now_us() const { return clock_.now_us(); }

  Result<control::Sample> sense() {
    const SwitchReading contact = lines_.read_switch();
    if (contact.edges != 0) figures_.edges.fetch_add(contact.edges, std::memory_order_relaxed);
    const Result<control::Sample> heard = link_.sample(now_us());
    if (!heard.ok()) return heard.status();
    if (!contact.ok) return Status::disconnected;
    sample_ = heard.value();
    sample_.contact = contact.closed ? 1 : 0;
    const control::Fault of_start = start_fault_.tick();
    if (of_start != control::Fault::none) sample_.reported_fault = static_cast<std::uint32_t>(of_start);
    return sample_;
  }

  Status actuate(const control::Command& command) {
    const bool taken = port_.send(link_.command(command, run_));
    return lines_.set_solenoid(modulate(command.coil_duty)) && taken ? Status::ok : Status::disconnected;
  }

  void kick_watchdog() { clock_.kick_watchdog(); }

  bool take_reset_request() { return false; }

  void report(const firmware::Telemetry& telemetry) {
    firmware::FrameBatch batch = telemetry_.tick(telemetry, sample_, state_);
    if (link_.registers().answering()) {
      batch.add(link_.registers().next());
      link_.registers().advance();  // whose frame is not taken asks again
    }
    port_.send(batch);
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
  CanPort<Bus> port_;
  Lines& lines_;
  LoopClock<Ticks> clock_;
  LoopFigures& figures_;
  control::Sample sample_;
  bool run_ = false;
  bus::NodeState state_ = bus::NodeState::starting;
  firmware::StartFault start_fault_;
  float owed_ = 0.0f;
};

using Board = LinuxBoard<socketcan::CanSocket, Gpio>;
static_assert(firmware::Board<Board>);

}  // namespace furcula::linux_sbc
