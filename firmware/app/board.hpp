// The seam between the application and everything that touches hardware, a bus or a simulation.
#pragma once

#include <concepts>
#include <cstdint>

#include "furcula/control/controller.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// What a start found, reported as a fault for a while: long enough for the node to show it and wait for a
/// reset, and then over, so that the reset clears it.
inline constexpr std::uint32_t kStartFaultTicks = 1500;

/// What a tick came to, for whoever watches. Never read back by the controller.
struct Telemetry {
  std::uint32_t tick = 0;
  control::Outputs outputs;
};

/// A board. Only wait_for_tick() may block. A board that fails to do as told reports it (Status) and makes
/// itself safe: the application has nobody else to turn to.
template <class B>
concept Board = requires(B& board, const control::Command& command, const Telemetry& telemetry) {
  /// Blocks until the next tick is due. false: the board is shutting down.
  { board.wait_for_tick() } -> std::same_as<bool>;
  /// Free-running clock, us, wraps.
  { board.now_us() } -> std::same_as<std::uint32_t>;
  /// The newest sample, or Status::disconnected where the device with the sensors did not answer.
  { board.sense() } -> std::same_as<Result<control::Sample>>;
  /// Hands the command to drive and solenoid. Acts until the next call or until the watchdog bites.
  { board.actuate(command) } -> std::same_as<Status>;
  /// Without a kick for longer than a few ticks the hardware goes to the safe state by itself.
  { board.kick_watchdog() } -> std::same_as<void>;
  /// Whether a person asked for faults to be cleared since the last call.
  { board.take_reset_request() } -> std::same_as<bool>;
  /// May be dropped.
  { board.report(telemetry) } -> std::same_as<void>;
};

}  // namespace furcula::firmware
