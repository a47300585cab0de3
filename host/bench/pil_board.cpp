// The emulated board, see pil_board.hpp.
#include "host/bench/pil_board.hpp"

#include <chrono>

#include "host/core/error.hpp"
#include "host/pil/qemu.hpp"

namespace furcula::bench {

PilBoard::PilBoard(const std::string& image) {
  if (const std::string why = pil::why_not_here(image); !why.empty()) throw core::DataError("pil: " + why);
  try {
    qemu_ = std::make_unique<pil::Qemu>(image, stand_config(stand_, {}), std::chrono::seconds(10));
  } catch (const pil::LinkError& e) {
    throw core::DataError(std::string("pil: ") + e.what());
  }
}
PilBoard::~PilBoard() = default;

std::vector<Reading> PilBoard::run(const Conditions& conditions, const Timing& timing) {
  stand_.prepare(conditions, timing.rows());
  std::vector<Reading> rows;
  rows.reserve(timing.rows());
  try {
    qemu_->configure(stand_config(stand_, timing));
    while (stand_.wait_for_tick()) {
      pil::Tick tick;
      tick.now_us = stand_.now_us();
      tick.sample_valid = 1;
      tick.sample = stand_.sense().value();
      const pil::Outputs outputs = qemu_->exchange(tick).outputs;
      if (outputs.fault != 0)
        throw core::DataError("pil: " + std::to_string(rows.size()) +
                              " ms into the trial the board found fault " + std::to_string(outputs.fault));
      static_cast<void>(stand_.actuate(outputs.command));
      rows.push_back(stand_.reading());
    }
  } catch (const pil::LinkError& e) {
    throw core::DataError(std::string("pil: ") + e.what());
  }
  return rows;
}

}  // namespace furcula::bench
