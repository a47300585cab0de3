// candump's text logs in and out (can-utils, `candump -L`): one frame a line, as in
//   (1436509052.249713) vcan0 044#2A366C2BBA
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "furcula/bus/frame.hpp"
#include "host/core/byte_source.hpp"

namespace furcula::bus {

struct LogFrame {
  std::int64_t time_us = 0;  ///< since 1970 or since the start of the recording
  std::string interface;     ///< 1 to 15 characters
  Frame frame;
  bool error = false;  ///< the controller reports a state of the bus (id and data: linux/can/error.h)

  bool operator==(const LogFrame&) const = default;
};

/// A line without its end. @throws core::DataError: what is wrong with it, without file and line.
LogFrame parse_candump(std::string_view line);

/// The line, with its end.
std::string format_candump(const LogFrame& frame);

/// Reads a log of any length in a fixed amount of memory. Empty lines are passed over.
class CandumpReader {
 public:
  CandumpReader(core::ByteSource& source, std::string name) : source_(source), name_(std::move(name)) {}

  /// The next frame, or false at the end. @throws core::DataError with file and line.
  bool next(LogFrame& frame);

 private:
  bool next_line(std::string_view& line);

  core::ByteSource& source_;
  std::string name_;
  std::array<char, 4096> buffer_{};  // the longest line, above all that candump writes
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool at_end_ = false;
  std::uint64_t line_ = 0;
};

}  // namespace furcula::bus
