// furculad's own program on the simulated bench: its coil's line is one of gpio-sim, its encoder a node on
// vcan, and the host reads its trial over Modbus TCP. In the time of this kernel.
#pragma once

#include <memory>
#include <string>

#include "host/bench/sim_board.hpp"
#include "host/bench/stand_player.hpp"
#include "host/rig/rig.hpp"

namespace furcula::bench {

class HilBoard final : public StandBoard {
 public:
  /// On vcan0 and the bank of gpio-sim that scripts/hil sets up. `program`: furculad's path; empty: the one
  /// beside this program. @throws core::DataError where this kernel has not got them, or the program does not
  /// become idle on its bench within 10 s.
  explicit HilBoard(const std::string& program);
  /// On these wires.
  HilBoard(const rig::RigOptions& options, std::unique_ptr<Wires> wires);
  /// Ends the program.
  ~HilBoard() override;

  std::string name() const override { return "hil"; }
  /// Without a window the program is left idle, and the readings are what the encoder sent. @throws
  /// core::DataError also where the stand was late by a millisecond or more: what it played then does not
  /// count.
  std::vector<Reading> run(const Conditions& conditions, const Timing& timing) override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace furcula::bench
