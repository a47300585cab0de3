// A recording of a CAN bus, frame by frame, in the formats that candump (candump.hpp) and Vector's programs (asc.hpp) write.
// One odd line never costs the others: it is left out and named.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "host/bus/asc.hpp"
#include "host/bus/candump.hpp"
#include "host/core/byte_source.hpp"

namespace furcula::bus {

/// Reads a recording of any length in a fixed amount of memory. Empty lines and comments (#, ;) are passed over.
class RecordingReader {
 public:
  RecordingReader(core::ByteSource& source, std::string name) : source_(source), name_(std::move(name)) {}

  /// The next frame, or false at the end. @throws core::DataError with the file: no recording, or one of which too many lines
  /// are no frames. The latter is known at the end only, where there are thousands.
  bool next(LogFrame& frame);

  std::uint64_t frames() const { return frames_; }

  /// What was left out, and how time stamps were read, one line each; empty: nothing.
  std::string remarks() const;

 private:
  struct OddLine {
    std::uint64_t line;
    std::string why;
  };
  // More than these stand in no message.
  static constexpr std::size_t kNamed = 3;
  // The shell's own of a copied terminal: the prompt with the command, the interrupt's ^C, the next prompt.
  static constexpr std::uint64_t kAlwaysBorne = 3;
  // By then a file of something else is known for what it is.
  static constexpr std::uint64_t kFewestToJudge = 1000;
  // Of time stamps with which to tell those since the start from differences.
  static constexpr std::size_t kAhead = 64;

  bool next_line(std::string_view& line, bool& whole);
  bool next_frame(LogFrame& frame, TimeFrom& stamp);
  void refuse_other_files(std::string_view start) const;
  void note_odd(std::string why);
  void judge(bool at_end) const;
  void look_ahead();
  void take_time(LogFrame& frame, TimeFrom stamp);

  core::ByteSource& source_;
  std::string name_;
  std::array<char, 65536> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
  bool at_end_ = false, started_ = false;
  std::uint64_t line_ = 0;

  AscParser asc_;
  std::string without_colours_;
  bool after_error_ = false;
  struct Ahead {
    LogFrame frame;
    TimeFrom stamp;
    std::uint64_t line;
  };
  std::deque<Ahead> ahead_;
  bool looked_ahead_ = false, differences_ = false;
  std::int64_t sum_ns_ = 0, last_ns_ = 0, furthest_back_ns_ = 0;
  std::uint64_t frames_ = 0, odd_ = 0, events_ = 0, dropped_ = 0, back_ = 0, first_back_line_ = 0;
  bool relative_ = false;
  std::vector<OddLine> named_;
  std::string torn_;
};

}  // namespace furcula::bus
