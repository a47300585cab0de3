// What candump (can-utils) writes: its log format, of `candump -L`, one frame a line, in and out, as in
//   (1436509052.249713) vcan0 044#2A366C2BBA
// and what it prints on a screen (candump_screen.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "furcula/bus/frame.hpp"

namespace furcula::bus {

struct LogFrame {
  std::int64_t time_ns = 0;  ///< since 1970 or since the start of the recording
  std::string interface;     ///< 1 to 64 characters
  Frame frame;
  bool error = false;   ///< the controller reports a state of the bus (id and data: linux/can/error.h)
  bool longer = false;  ///< CAN FD or CAN XL: its data is not kept

  bool operator==(const LogFrame&) const = default;
};

/// What a line's time stamp counts from.
enum class TimeFrom : std::uint8_t {
  absolute,  ///< an instant: 1970, or that of `candump -L`, whichever a writer takes
  relative,  ///< on a screen: the start (`candump -tz`), or the frame before (-td)
  none,
};

/// A line without its end, of the log format or of a screen. @throws core::DataError: what is wrong with it, without file
/// and line; `out` is then in no defined state.
TimeFrom parse_candump(std::string_view line, LogFrame& out);
LogFrame parse_candump(std::string_view line);

/// The line of the log format, with its end; of a frame that is not `longer`.
std::string format_candump(const LogFrame& frame);

/// How to record what can be read, for messages.
inline constexpr std::string_view kRecordWith = "record with: candump -L can0 > can.log";

}  // namespace furcula::bus
