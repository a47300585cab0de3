// A walking biped's buses as a board: a CAN interface a leg, and one for its body (docs/bus.md).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "boards/linux_sbc/can_port.hpp"
#include "boards/linux_sbc/figures.hpp"
#include "boards/linux_sbc/loop_clock.hpp"
#include "firmware/app/can_presence.hpp"
#include "firmware/app/walker_link.hpp"
#include "firmware/app/walker_node.hpp"
#include "host/core/timer.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::linux_sbc {

/// `Bus` and `Ticks` are CanSocket and Timer, or what a test puts in their place.
template <class Bus, class Ticks = core::Timer>
class LinuxWalkerBoard {
 public:
  static_assert(firmware::kWalkerLinks == kMostBuses);

  /// `buses`: the left leg's, the right one's, the body's.
  LinuxWalkerBoard(const firmware::WalkerLinkConfig& config, const std::array<Bus*, kMostBuses>& buses,
                   const std::atomic<bool>& stop, LoopFigures& figures)
      : link_(config),
        presence_(config.self_node, kHeartbeatTicks),
        body_node_(config.body_node),
        ports_{CanPort<Bus>(*buses[0], 0, figures), CanPort<Bus>(*buses[1], 1, figures),
               CanPort<Bus>(*buses[2], 2, figures)},
        clock_(stop, figures) {}

  // The node's seam (firmware/app/walker_node.hpp).

  /// Ends with a few ticks in the safe state once `stop` is set: one frame to a drive may be lost.
  bool wait_for_tick() {
    clock_.wait();
    for (std::size_t bus = 0; bus < ports_.size(); ++bus) ports_[bus].receive(Receiver{link_, bus}, now_us());
    return clock_.goes_on();
  }
  std::uint32_t now_us() const { return clock_.now_us(); }
  control::WalkerSample sense() { return link_.sample(now_us()); }
  void kick_watchdog() { clock_.kick_watchdog(); }

  /// A batch that a bus does not take is counted; of its drives no answer comes, which is found.
  void actuate(const control::WalkerOutputs& told) {
    std::array<firmware::FrameBatch, kMostBuses> frames =
        link_.command(told, state_ == bus::NodeState::running);
    if (tick_ % kWalkStateTicks == 0 || told.stage != stage_)
      frames[firmware::kBodyBus].add(walk_state(told));
    stage_ = told.stage;
    presence_.tick(frames[firmware::kBodyBus], tick_, state_, told.fault);
    ++tick_;
    for (std::size_t bus = 0; bus < ports_.size(); ++bus)
      if (frames[bus].count != 0) static_cast<void>(ports_[bus].send(frames[bus]));
  }

  // What stands around the node.

  firmware::WalkerLink& link() { return link_; }
  void introduce(const bus::Identity& identity, const firmware::FaultLog& faults) {
    presence_.introduce(identity, faults);
  }
  /// Before each tick: whether the drives shall be on, and what the heartbeat says.
  void set_state(bus::NodeState state) { state_ = state; }

 private:
  static constexpr std::uint32_t kHeartbeatTicks = 100, kWalkStateTicks = 10;

  /// The link as one of its buses has it.
  struct Receiver {
    firmware::WalkerLink& link;
    std::size_t bus;
    void receive(const bus::Frame& frame, std::uint32_t now_us) const { link.receive(bus, frame, now_us); }
    void note(firmware::BusEvent event) const { link.note(bus, event); }
    bool bus_is_off() const { return link.bus_is_off(bus); }
  };

  bus::Frame walk_state(const control::WalkerOutputs& told) {
    using namespace firmware;
    using bus::message::kWalkState;
    bus::Frame frame = versioned(kWalkState, body_node_);
    put_code(frame, bus::signal(kWalkState, "Stage"), static_cast<std::uint32_t>(told.stage));
    put_code(frame, bus::table::sequence(), sequence_++);
    put_code(frame, bus::signal(kWalkState, "Fault"), static_cast<std::uint32_t>(told.fault));
    put_code(frame, bus::signal(kWalkState, "Suspect"), told.suspect);
    put_code(frame, bus::signal(kWalkState, "Phase"), static_cast<std::uint32_t>(told.phase));
    put_value(frame, bus::signal(kWalkState, "Height"), told.height_m);
    put_value(frame, bus::signal(kWalkState, "Upright"), told.upright);
    return frame;
  }

  firmware::WalkerLink link_;
  firmware::CanPresence presence_;
  std::uint8_t body_node_;
  std::array<CanPort<Bus>, kMostBuses> ports_;
  LoopClock<Ticks> clock_;
  bus::NodeState state_ = bus::NodeState::starting;
  control::WalkerStage stage_ = control::WalkerStage::idle;
  std::uint32_t tick_ = 0;
  std::uint8_t sequence_ = 0;
};

using WalkerBoard = LinuxWalkerBoard<socketcan::CanSocket>;
static_assert(firmware::WalkerBoard<WalkerBoard>);

}  // namespace furcula::linux_sbc
