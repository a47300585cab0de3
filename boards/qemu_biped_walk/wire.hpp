// What the host and the emulated board that walks a biped say to each other, over the pipes of qemu_netduinoplus2: one exchange a tick,
// fixed-size messages, little-endian with the same layout on both ends.
#pragma once

#include <cstdint>
#include <type_traits>

#include "boards/qemu_netduinoplus2/pipes.hpp"
#include "furcula/control/walk/walker.hpp"

namespace furcula::pil {

inline constexpr std::uint32_t kWalkBegin = 0x46573031;  // "FW01": first message, and its version
inline constexpr std::uint32_t kWalkTick = 1;
inline constexpr std::uint32_t kWalkAnew = 2;
inline constexpr std::uint32_t kWalkEnd = 3;

/// Host to board, first.
struct WalkBegin {
  std::uint32_t kind = kWalkBegin;
  control::WalkerConfig config;
};

/// Host to board, each tick.
struct WalkTick {
  /// kWalkAnew: before this tick the board begins as after a start. kWalkEnd: no tick, the board answers with a Measured and stops.
  std::uint32_t kind = kWalkTick;
  std::uint32_t reset = 0, run = 0, tick_interval_us = 0;
  control::WalkerSample sample;
};
inline control::WalkerInputs inputs_of(const WalkTick& tick) {
  return {tick.sample, tick.reset != 0, tick.run != 0, tick.tick_interval_us};
}

/// Board to host, each tick: every output, without padding.
struct WalkReply {
  std::array<control::JointCommand, control::kWalkerJoints> joints;
  std::array<float, control::kWalkerPins> pin_targets{};
  float upright = 0.0f, height_m = 0.0f;
  std::uint8_t fault = 0, suspect = 0, stage = 0, phase = 0;
  std::uint32_t on_left = 0;
  std::uint32_t instructions = 0;  ///< that the tick took, less what measuring takes
};
inline WalkReply reply_of(const control::WalkerOutputs& out) {
  WalkReply r;
  r.joints = out.joints;
  r.pin_targets = out.pin_targets;
  r.upright = out.upright;
  r.height_m = out.height_m;
  r.fault = static_cast<std::uint8_t>(out.fault);
  r.suspect = static_cast<std::uint8_t>(out.suspect);
  r.stage = static_cast<std::uint8_t>(out.stage);
  r.phase = static_cast<std::uint8_t>(out.phase);
  r.on_left = out.on_left ? 1 : 0;
  return r;
}

static_assert(std::is_trivially_copyable_v<WalkBegin> && sizeof(WalkBegin) < 4096);
static_assert(std::is_trivially_copyable_v<WalkTick> && sizeof(WalkTick) == 220);
static_assert(std::is_trivially_copyable_v<WalkReply> && sizeof(WalkReply) == 180);

}  // namespace furcula::pil
