// Height and velocity of the body from the counts of the rail's encoder.
#pragma once

#include <array>
#include <cstdint>

#include "furcula/core/count.hpp"

namespace furcula::control {

/// The velocity is the difference of counts over this many ticks: at 1 kHz and 0.09 mm a count one count is
/// 18 mm/s, and the velocity is that of 2.5 ms ago. (Over one tick a count would be 90 mm/s.)
inline constexpr int kVelocityWindowTicks = 5;

/// Scale of the rail's encoder.
struct HeightConfig {
  float metres_per_count = 0.00009f;  ///< 2000 counts/rev on a rack of 0.18 m a turn, 002 chapter 4
};

/// State of estimate_height() between two ticks.
struct HeightState {
  std::array<std::int32_t, kVelocityWindowTicks> counts{};  ///< counts of the last ticks, a ring buffer
  std::uint8_t next = 0;                                    ///< index in `counts` that is written next
  std::uint8_t filled = 0;                                  ///< number of counts, up to kVelocityWindowTicks
};

/// Height of the body and its velocity, positive upwards.
struct HeightEstimate {
  float height_m = 0.0f;      ///< above the ground; NaN where `home_height_m` is
  float velocity_mps = 0.0f;  ///< 0 on the first tick, then over as many ticks as there are
};

/// One tick, `dt_s` after the last. `count` is the encoder's position relative to where the height was `home_height_m`.
inline HeightEstimate estimate_height(const HeightConfig& config, HeightState& state, std::int32_t count,
                                      float home_height_m, float dt_s) {
  HeightEstimate estimate;
  estimate.height_m = home_height_m + static_cast<float>(count) * config.metres_per_count;
  if (state.filled > 0) {
    const std::uint8_t oldest = state.filled == kVelocityWindowTicks ? state.next : std::uint8_t{0};
    // Counters wrap, and a broken one may be anywhere.
    const auto moved = static_cast<float>(count_difference(static_cast<std::uint32_t>(count),
                                                           static_cast<std::uint32_t>(state.counts[oldest])));
    estimate.velocity_mps = moved * config.metres_per_count / (static_cast<float>(state.filled) * dt_s);
  }
  state.counts[state.next] = count;
  state.next =
      state.next + 1 == kVelocityWindowTicks ? std::uint8_t{0} : static_cast<std::uint8_t>(state.next + 1);
  if (state.filled < kVelocityWindowTicks) ++state.filled;
  return estimate;
}

}  // namespace furcula::control
