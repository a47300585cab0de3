// A few frames that leave together.
#pragma once

#include <array>
#include <cstdint>

#include "furcula/bus/frame.hpp"

namespace furcula::firmware {

/// In the order in which they are to be sent. Holds four; what does not fit is left out (the links below
/// never make more).
struct FrameBatch {
  std::array<bus::Frame, 4> frame{};
  std::uint32_t count = 0;

  constexpr void add(const bus::Frame& next) {
    if (count < frame.size()) frame[count++] = next;
  }
  constexpr const bus::Frame* begin() const { return frame.data(); }
  constexpr const bus::Frame* end() const { return frame.data() + count; }
};

}  // namespace furcula::firmware
