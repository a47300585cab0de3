// Vector's text format (CANoe, CANalyzer, `log2asc`, python-can): a header, then an event a line, as in
//   date Mon Jun 19 17:25:04 2017
//   base hex  timestamps absolute
//      0.012345 1  123x            Rx   d 8 01 02 03 04 05 06 07 08  Length = 242000 BitCount = 124
#pragma once

#include <cstdint>
#include <string_view>

#include "host/bus/candump.hpp"

namespace furcula::bus {

class AscParser {
 public:
  enum class Line : std::uint8_t {
    frame,
    header,  ///< or a comment: nothing to read
    event,   ///< of another kind: statistics, states, other buses
    other,   ///< no line of this format
  };

  /// A line without its end. A frame's time counts from the start of the recording. @throws core::DataError: a frame that
  /// is not whole.
  Line parse(std::string_view line, LogFrame& out);

  /// Whether a header was seen.
  bool begun() const { return begun_; }

 private:
  bool parse_header(std::string_view line);
  Line parse_event(std::string_view rest, LogFrame& out) const;
  bool take_id(std::string_view word, LogFrame& out) const;
  std::uint8_t take_byte(std::string_view word) const;
  void take_data(std::string_view& rest, std::uint32_t size, LogFrame& out) const;

  bool begun_ = false, decimal_ = false, relative_ = false;
  std::int64_t time_ns_ = 0;
};

}  // namespace furcula::bus
