// The simulated bench with the controller on the emulated Cortex-M4F, in lock step.
#pragma once

#include <memory>
#include <string>

#include "host/bench/sim_board.hpp"

namespace furcula::pil {
class Qemu;
}

namespace furcula::bench {

class PilBoard final : public StandBoard {
 public:
  /// `image`: of the board qemu_netduinoplus2. @throws core::DataError where QEMU or the image is not there.
  explicit PilBoard(const std::string& image);
  ~PilBoard() override;

  std::string name() const override { return "pil"; }
  std::vector<Reading> run(const Conditions& conditions, const Timing& timing) override;

 private:
  std::unique_ptr<pil::Qemu> qemu_;
};

}  // namespace furcula::bench
