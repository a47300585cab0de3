// A walking robot that people talk to: its controller on a board once a millisecond, idle until a host's stream tells it to walk.
#pragma once

#include <concepts>
#include <cstdint>

#include "firmware/app/app.hpp"
#include "firmware/app/stream_rules.hpp"
#include "firmware/app/walker_link.hpp"
#include "firmware/store/fault_log.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/control/walk/walker.hpp"

namespace furcula::firmware {

/// A walker's board; beside what it has in common with firmware::Board it gives samples whose bits say who answered.
template <class B>
concept WalkerBoard = requires(B& board, const control::WalkerOutputs& outputs) {
  { board.wait_for_tick() } -> std::same_as<bool>;
  { board.now_us() } -> std::same_as<std::uint32_t>;
  { board.sense() } -> std::same_as<control::WalkerSample>;
  /// Hands the commands to the drives whose turn it is, and tells the bus how the robot is.
  { board.actuate(outputs) } -> std::same_as<void>;
  { board.kick_watchdog() } -> std::same_as<void>;
};

template <WalkerBoard B>
class WalkerNode {
 public:
  /// Keeps references to `board` and `faults`, which must outlive it.
  WalkerNode(B& board, const control::WalkerConfig& config, FaultLog& faults)
      : board_(board), faults_(faults), config_(config), walker_(control::begin_walker(config)) {}

  /// One tick, right after the board's wait_for_tick().
  void tick() {
    rules_.tick();
    if (ticks_in_state_ != 0xffffffffu) ++ticks_in_state_;
    const std::uint32_t now_us = board_.now_us();
    control::WalkerInputs in;
    in.sample = board_.sense();
    in.tick_interval_us = ticked_ ? now_us - last_us_ : kTickPeriodUs;
    ticked_ = true;
    last_us_ = now_us;
    const bool running = state_ == State::running;
    in.run = running && ticks_in_state_ > kSwitchOnTicks;
    // Who tells a robot to stop has it off at once. A host that is gone has not told it so: the robot brakes.
    if (running && rules_.silent() && in.sample.reported_fault == 0)
      in.sample.reported_fault = static_cast<std::uint32_t>(control::Fault::peer_lost);
    in.reset = reset_ || state_ == State::starting;
    reset_ = false;
    outputs_ = control::step_walker(config_, walker_, in, kTickPeriodS);
    board_.actuate(outputs_);
    board_.kick_watchdog();
    faults_.note(tick_, static_cast<std::uint8_t>(outputs_.fault));
    ++tick_;
    follow(outputs_.fault);
  }

  // As firmware::Node has them, for obey_stream().

  void stop_from_anyone(bool holds) {
    rules_.hold(holds);
    stop();
  }
  void note_hop_said() { rules_.note_hop_said(); }
  /// `hop` is to walk. @returns why it was not done.
  bus::Refusal stream(const StreamCommand& command) {
    const StreamRules::Edge edge = rules_.hear(command.request, command.follows);
    switch (command.request) {
      case bus::Request::hop:
        if (state_ == State::running) return bus::Refusal::none;
        if (!edge.starts) return bus::Refusal::no_edge;
        if (state_ != State::idle) return bus::Refusal::not_in_this_state;
        if (rules_.held()) return bus::Refusal::stop_stands;
        enter(State::running);
        return bus::Refusal::none;
      case bus::Request::stop:
      case bus::Request::none:
        stop();
        return bus::Refusal::none;
      case bus::Request::reset:
        if (!edge.changed) return bus::Refusal::none;
        if (state_ == State::running) return bus::Refusal::not_in_this_state;
        reset_ = true;
        return bus::Refusal::none;
      default:
        return bus::Refusal::unknown_request;
    }
  }

  bus::NodeState state() const { return state_; }
  /// Of the last tick.
  const control::WalkerOutputs& outputs() const { return outputs_; }
  const control::WalkerState& walker() const { return walker_; }

 private:
  using State = bus::NodeState;

  void enter(State state) {
    state_ = state;
    ticks_in_state_ = 0;
  }
  void stop() {
    if (state_ == State::running) enter(State::idle);
  }

  /// What the controller's fault makes of the state.
  void follow(control::Fault fault) {
    const bool found = fault != control::Fault::none;
    if (state_ == State::starting) {
      good_ticks_ = found ? 0 : good_ticks_ + 1;
      if (good_ticks_ >= kSettledTicks)
        enter(State::idle);
      else if (found && (fault == control::Fault::bad_configuration || ticks_in_state_ > kStartTicks))
        enter(State::fault);
    } else if (found != (state_ == State::fault)) {
      enter(found ? State::fault : State::idle);
    }
  }

  B& board_;
  FaultLog& faults_;
  control::WalkerConfig config_;
  control::WalkerState walker_;
  control::WalkerOutputs outputs_;
  StreamRules rules_;
  State state_ = State::starting;
  std::uint32_t ticks_in_state_ = 0, good_ticks_ = 0, tick_ = 0, last_us_ = 0;
  bool ticked_ = false, reset_ = false;
};

}  // namespace furcula::firmware
