// The simulated bench at the other ends of a board's wires: its coil's line, and the bus with the encoder on
// its pulley.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "furcula/bus/frame.hpp"
#include "host/bench/sim_stand.hpp"
#include "host/rig/peers.hpp"

namespace furcula::bench {

/// The stand's ends of them.
class Wires {
 public:
  Wires() = default;
  Wires(const Wires&) = delete;
  Wires& operator=(const Wires&) = delete;
  virtual ~Wires() = default;

  /// Whether the board has its coil on.
  virtual bool coil() = 0;
  virtual void send(const bus::Frame& frame) = 0;
  /// What the board has sent since it was last asked for.
  virtual std::vector<bus::Frame> receive() = 0;
};

class StandPlayer {
 public:
  /// Keeps references to both.
  StandPlayer(SimStand& stand, Wires& wires) : stand_(stand), wires_(wires) { hang({}); }

  /// Another load, at rest on the caught belt.
  void hang(const Conditions& conditions) {
    stand_.prepare(conditions, std::numeric_limits<std::size_t>::max());
  }

  /// A millisecond has passed, in which the coil was as its line is now; the encoder says where that led.
  void tick() {
    control::Command command;
    command.coil_duty = wires_.coil() ? 1.0f : 0.0f;
    static_cast<void>(stand_.actuate(command));
    wires_.send(encoder_.sample(stand_.sense().value().cable_count, 0, true));
    for (const bus::Frame& frame : wires_.receive()) words_.receive(frame);
  }

  /// Of the millisecond that has passed: what the encoder said at its beginning, and the coil.
  const Reading& reading() const { return stand_.reading(); }
  const rig::BoardWords& words() const { return words_; }

 private:
  SimStand& stand_;
  Wires& wires_;
  rig::EncoderNode encoder_{rig::kCableNode};
  rig::BoardWords words_;
};

}  // namespace furcula::bench
