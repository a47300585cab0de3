// A recording of a bus as a log with one row a tick (furcula-log/1), for check, identify and diagnose.
//
// A row is a frame of the permutation's tick message, at the instant of its content: the frame's stamp less its age. The
// recording is read twice: what frames there are and what counts mean, then the rows, as they come and in a fixed amount of memory.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "furcula/bus/stream.hpp"
#include "host/bus/candump.hpp"
#include "host/bus/columns.hpp"
#include "host/bus/line_fit.hpp"
#include "host/bus/nodes.hpp"

namespace furcula::bus {

/// Finds the messages of a bus' nodes among frames.
class MessageFinder {
 public:
  explicit MessageFinder(std::vector<Node> nodes);
  /// nullptr where it is none of them.
  const NodeMessage* find(const LogFrame& frame) const;
  const std::vector<NodeMessage>& messages() const { return messages_; }
  /// @throws core::DataError: there is none.
  const NodeMessage& named(const std::string& node, const std::string& message) const;

 private:
  std::vector<Node> nodes_;
  std::vector<NodeMessage> messages_;
};

/// First reading: which columns there are, and the calibrations.
class Survey {
 public:
  Survey(const MessageFinder& finder, const ChannelPermutation& permutation);
  void add(const LogFrame& frame);
  /// The permutation with what was found. @throws core::DataError: a column that must be there has no frame, or what its numbers
  /// mean is not told; says what to do. `notes`: what was found, a sentence each.
  ChannelPermutation finish(std::vector<std::string>& notes) const;

 private:
  struct CalibrationPair {
    const Calibration* calibration;
    const NodeMessage *of, *from;
    Signal value, paired_value;
    std::optional<double> before, last;
    bool usable = true;
    PairSample sample;
  };
  void take_pairs(const LogFrame& frame, const NodeMessage& message);
  void calibrate(const CalibrationPair& pair, ChannelPermutation& out, std::vector<std::string>& notes) const;

  std::string instead_of(const Column& column, const NodeMessage& missing) const;

  const MessageFinder& finder_;
  const ChannelPermutation& permutation_;
  std::vector<std::uint64_t> counts_;  ///< of the finder's messages
  std::vector<AnswerFinder> answers_;
  std::vector<CalibrationPair> calibrations_;
};

/// Second reading: rows.
class RowMaker {
 public:
  /// `write`: a row of the run (from 1), time first.
  using Write = std::function<void(std::size_t run, const std::vector<double>& row)>;
  RowMaker(const MessageFinder& finder, const ChannelPermutation& permutation, Write write);
  void add(const LogFrame& frame);
  void finish();

  std::uint64_t rows() const { return rows_; }
  std::size_t runs() const { return runs_; }
  /// What was lost of the tick's own frames.
  std::uint64_t lost_ticks() const { return stream_.lost; }
  /// What was held, lost and left out, a sentence each.
  std::vector<std::string> notes() const;

 private:
  struct Sent {
    std::int64_t time_ns;
    double value;
  };
  struct Cell {
    const NodeMessage* message;
    Signal signal;
    double scale, offset;
    Join join;
    std::optional<double> before, last;  ///< measurements; before: none where a gap is between both
    std::int64_t before_ns = 0, last_ns = 0, interval_ns = 0;
    bool in_row = false;
    std::deque<Sent> sent;  ///< of Join::acting, since the last row at least
    std::uint64_t held = 0, filled = 0;
  };
  struct Asked {
    Answer answer;
    std::optional<std::int64_t> at_ns;  ///< as stamped
  };
  struct Row {
    std::int64_t time_ns;
    std::vector<double> values;  ///< NaN: not known yet
    bool breaks;                 ///< the rows before are of another run
  };

  bool tick_of(const LogFrame& frame, std::int64_t& time_ns);
  void open_row(const LogFrame& frame, std::int64_t time_ns);
  void close_row();
  std::int64_t instant_of(const NodeMessage& message, const LogFrame& frame);
  void note_sent(Cell& cell, double value, std::int64_t time_ns);
  void complete_row(std::int64_t end_ns);
  static double acting(const Cell& cell, std::int64_t from_ns, std::int64_t to_ns);
  static double between(const Cell& cell, std::int64_t time_ns);
  void take(Cell& cell, double value, std::int64_t time_ns);
  void note_drive(const Message& message);
  void flush(bool at_end);
  void write_row(Row& row);

  const MessageFinder& finder_;
  ChannelPermutation permutation_;
  Write write_;
  std::vector<Cell> cells_;
  std::vector<Asked> asked_;
  const NodeMessage* tick_;
  std::deque<Row> waiting_;
  bool row_open_ = false, break_ = true, break_before_write_ = false, drive_on_ = false, switched_on_ = false,
       any_tick_ = false;
  Stream stream_;
  std::int64_t last_tick_ns_ = 0, last_row_ns_ = 0, last_command_ns_ = 0, last_written_ns_ = 0;
  std::int64_t shift_ns_ = 0, interval_ns_ = 0, start_ns_ = 0;
  std::size_t runs_ = 0;
  std::uint64_t rows_ = 0, off_ = 0, incomplete_ = 0, repeated_ = 0, not_good_ = 0, set_back_ = 0;
  std::vector<double> out_;
};

}  // namespace furcula::bus
