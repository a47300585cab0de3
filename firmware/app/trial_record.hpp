// What the board keeps of the last trial on the clutch's bench, to be read after it: a bus that carries a
// reading every few milliseconds still gives all of them.
#pragma once

#include <array>
#include <cstdint>

#include "furcula/bus/registers.hpp"
#include "furcula/control/bench_trial.hpp"
#include "furcula/core/count.hpp"

namespace furcula::firmware {

class TrialRecord {
 public:
  /// A tick's row, if it is one. What is beyond bus::kTrialRowsMost is not kept.
  void add(const control::TrialEstimate& trial, std::uint32_t cable_count, float coil_duty) {
    if (!trial.runs) return;
    if (trial.row == 0) {
      ++trials_;
      rows_ = 0;
      first_count_ = cable_count;
    }
    if (rows_ >= bus::kTrialRowsMost) return;
    std::int32_t moved = count_difference(cable_count, first_count_);
    if (moved > 32767) moved = 32767;
    if (moved < -32768) moved = -32768;
    counts_[rows_] = static_cast<std::int16_t>(moved);
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): a duty is not negative
    coil_percent_[rows_] = static_cast<std::uint8_t>(coil_duty * 100.0f + 0.5f);
    ++rows_;
  }

  /// The input register at this address; false: there is none.
  bool read(std::uint16_t address, std::uint16_t& out) const {
    if (address == bus::kTrialNumberAddress) {
      out = trials_;
    } else if (address == bus::kTrialRowsAddress) {
      out = rows_;
    } else if (address >= bus::kTrialCountBase && address < bus::kTrialCountBase + bus::kTrialRowsMost) {
      out = static_cast<std::uint16_t>(counts_[address - bus::kTrialCountBase]);
    } else if (address >= bus::kTrialCoilBase && address < bus::kTrialCoilBase + bus::kTrialRowsMost) {
      out = coil_percent_[address - bus::kTrialCoilBase];
    } else {
      return false;
    }
    return true;
  }

 private:
  std::array<std::int16_t, bus::kTrialRowsMost> counts_{};
  std::array<std::uint8_t, bus::kTrialRowsMost> coil_percent_{};
  std::uint16_t rows_ = 0, trials_ = 0;
  std::uint32_t first_count_ = 0;
};

}  // namespace furcula::firmware
