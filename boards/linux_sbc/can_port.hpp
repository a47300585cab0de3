// One CAN bus of a robot as the loop has it: frames with the time that they lay in the queue, and what its controller says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "boards/linux_sbc/figures.hpp"
#include "firmware/app/can_faults.hpp"
#include "firmware/app/can_frames.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::linux_sbc {

/// `Bus` is CanSocket, or what a test puts in its place.
template <class Bus>
class CanPort {
 public:
  /// `number`: of the bus, in the figures.
  CanPort(Bus& bus, std::size_t number, LoopFigures& figures)
      : bus_(bus), number_(number), figures_(figures) {}

  /// What came, to a link: receive(frame, when), note(event), bus_is_off().
  void receive(auto&& link, std::uint32_t now_us) {
    using firmware::BusEvent;
    for (const socketcan::Received& r : bus_.receive())
      link.receive(r.frame, now_us - static_cast<std::uint32_t>(r.age_ns / 1000));
    // One that was off and is back is told as well: the controller's fault stays until a person resets it.
    const socketcan::CanState state = bus_.state();
    if (times_off_ != bus_.times_off()) link.note(BusEvent::off);
    times_off_ = bus_.times_off();
    if (state == socketcan::CanState::on && link.bus_is_off()) link.note(BusEvent::recovered);
    figures_.can_states[number_].store(state, std::memory_order_relaxed);
    const std::uint64_t errors = bus_.counters().error_frames;
    figures_.can_errors.fetch_add(errors - errors_, std::memory_order_relaxed);
    for (; errors_ < errors; ++errors_) link.note(BusEvent::error);
  }

  /// false: some were not taken, which is counted.
  bool send(const firmware::FrameBatch& frames) {
    const bool taken = bus_.send(std::span<const bus::Frame>(frames.begin(), frames.end()));
    if (!taken) figures_.can_refused.fetch_add(1, std::memory_order_relaxed);
    return taken;
  }

 private:
  Bus& bus_;
  std::size_t number_;
  LoopFigures& figures_;
  std::uint64_t errors_ = 0, times_off_ = 0;
};

}  // namespace furcula::linux_sbc
