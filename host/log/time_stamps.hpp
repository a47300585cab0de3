// What the distribution of a log's time stamps implies: bursts of a buffer, a wrong unit, steps of the clock, stamps given on receipt, rows
// that are missing. Stamps alone seldom tell: the motion says whether a row was measured when it is stamped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/log/log.hpp"

namespace furcula::log {

struct TimeStamps {
  double median_s = 0.0;  ///< of the intervals
  double mean_s = 0.0;
  std::vector<std::string> notes;    ///< what is wrong, a sentence each
  std::vector<std::string> remarks;  ///< what may be of interest, as rows that are missing
  std::string bursts;  ///< why nothing can be learnt from the log, and what to do; empty: no bursts
  std::string unit;    ///< the same of a time in another unit than seconds
  /// Rows whose interval to the row before contradicts the motion.
  std::vector<std::size_t> gaps;

  const std::string& fatal() const { return unit.empty() ? bursts : unit; }
};

/// Rows pass by; memory is bounded.
class StampJudge {
 public:
  /// `positions`: how many columns of positions a row has. `map`: how the log is read, for what the map should say.
  StampJudge(std::string name, std::size_t positions, const ColumnMap* map = nullptr);
  /// `position(j)` of the row.
  template <class Position>
  void add(double time_s, std::uint64_t line, const Position& position) {
    if (rows_ == kBlock) end_block();
    if (rows_ == time_s_.size()) grow();
    time_s_[rows_] = time_s;
    lines_[rows_] = line;
    for (std::size_t j = 0; j < x_.size(); ++j) x_[j][rows_] = position(j);
    ++rows_;
  }
  TimeStamps finish();

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 14;

  struct Block;
  void grow();
  void end_block();
  void look_for_bursts(const Block& b);
  void look_for_missing(const Block& b);
  void look_for_steps(const Block& b);
  void look_for_receipt(const Block& b);
  double median_s() const;
  std::string burst_words() const;
  std::string unit_words() const;

  std::string name_;
  const ColumnMap* map_;
  std::size_t rows_ = 0;  ///< of the block so far, in vectors that are longer
  std::vector<double> time_s_;
  std::vector<std::uint64_t> lines_;
  std::vector<std::vector<double>> x_;
  std::uint64_t before_ = 0;  ///< rows of the blocks that are done, but the last

  double first_s_ = 0.0, last_s_ = 0.0;
  std::vector<std::pair<double, std::uint64_t>> medians_;  ///< of blocks: interval, how many
  std::uint64_t intervals_ = 0;
  struct {
    std::uint64_t blocks = 0, by_motion = 0, rows = 0, bursts = 0;
    double within_s = 0.0, period_s = 0.0;
  } bursts_;
  std::uint64_t missing_ = 0, missing_places_ = 0;
  std::vector<std::string> step_words_;
  std::uint64_t steps_ = 0;
  std::vector<std::size_t> gaps_;
  std::uint64_t receipt_blocks_ = 0, receipt_looked_ = 0, uneven_blocks_ = 0;
  double receipt_low_s_ = 0.0, receipt_high_s_ = 0.0, receipt_mean_s_ = 0.0;
};

/// Columns of a log that hold positions of bodies, as its rig has them.
std::vector<std::string> position_columns(const std::string& rig, std::span<const std::string> columns);

/// Of a log in memory.
TimeStamps judge(const Log& log, const ColumnMap* map = nullptr);

/// Moves the rows behind each gap to kUnknownInterval_s after it (time_order.hpp), so that no window holds it.
void open_gaps(Log& log, const std::vector<std::size_t>& gaps);

}  // namespace furcula::log
