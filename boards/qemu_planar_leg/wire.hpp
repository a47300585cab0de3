// What the host and the emulated board that plays a gait say to each other, over the pipes of qemu_netduinoplus2: one
// exchange a tick, fixed-size messages, little-endian with the same layout on both ends.
#pragma once

#include <cstdint>
#include <type_traits>

#include "boards/qemu_netduinoplus2/pipes.hpp"
#include "furcula/control/gait_player.hpp"

namespace furcula::pil {

inline constexpr std::uint32_t kLegBegin = 0x464c3031;  // "FL01": first message, and its version
inline constexpr std::uint32_t kLegTick = 1;
inline constexpr std::uint32_t kLegEnd = 2;

/// Host to board, first.
struct LegBegin {
  std::uint32_t kind = kLegBegin;
  control::GaitConfig config;
};

/// Host to board, each tick.
struct LegTick {
  std::uint32_t kind = kLegTick;  ///< kLegEnd: no tick, the board answers with a Measured and stops
  std::uint32_t sample_valid = 0, reset = 0, run = 1, tick_interval_us = 0;
  control::GaitSample sample;
};
inline control::GaitInputs inputs_of(const LegTick& tick) {
  return {tick.sample, tick.sample_valid != 0, tick.reset != 0, tick.run != 0, tick.tick_interval_us};
}

/// Board to host, each tick: every output, without padding.
struct LegReply {
  control::JointPair torque_nm;
  float toe_m = 0.0f, since_s = 0.0f, velocity_mps = 0.0f;
  std::uint8_t phase = 0, fault = 0, closed = 0,
               events = 0;         ///< events: 1 touch-down, 2 lift-off, 4 apex, 8 bounced
  std::uint32_t instructions = 0;  ///< that the tick took, less what measuring takes
};
inline LegReply reply_of(const control::GaitOutputs& out) {
  LegReply r;
  r.torque_nm = out.torque_nm;
  r.toe_m = out.toe_m;
  r.since_s = out.phase.since_s;
  r.velocity_mps = out.phase.velocity_mps;
  r.phase = static_cast<std::uint8_t>(out.phase.phase);
  r.fault = static_cast<std::uint8_t>(out.fault);
  r.closed = out.phase.closed ? 1 : 0;
  r.events = static_cast<std::uint8_t>((out.phase.touchdown ? 1 : 0) | (out.phase.liftoff ? 2 : 0) |
                                       (out.phase.apex ? 4 : 0) | (out.phase.bounced ? 8 : 0));
  return r;
}

static_assert(std::is_trivially_copyable_v<LegBegin> && sizeof(LegBegin) < 4096);
static_assert(std::is_trivially_copyable_v<LegTick> && sizeof(LegTick) == 52);
static_assert(std::is_trivially_copyable_v<LegReply> && sizeof(LegReply) == 28);

}  // namespace furcula::pil
