// What candump prints on a screen of one frame, behind the time stamp:
//   can0  044   [5]  2A 36 6C 2B BA          can0  RX - -  044   [5]  2A 36 6C 2B BA       (-x)
//   can0  044   [5]  BA`2B`6C`36`2A  (-S)    can0  044   [1]  00101010                     (-i)
//   can0  044   [2]  2A 36    '*6'   (-a)    can0  20000004   [8]  00 ... 00   ERRORFRAME
//   can0  044   [4]  remote request          can0  044  [12]  ...     (CAN FD: two digits; CAN XL: four)
#pragma once

#include <string_view>

#include "host/bus/candump.hpp"

namespace furcula::bus {

/// `rest`: from the id on, behind interface and direction. @throws core::DataError as parse_candump().
void parse_candump_screen(std::string_view rest, LogFrame& out);

}  // namespace furcula::bus
