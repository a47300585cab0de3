// What the host and the emulated board say to each other: fixed-size messages of 32-bit words over two named
// pipes, one exchange a tick. Both ends are little-endian with the same layout.
#pragma once

#include <cstdint>
#include <type_traits>

#include "boards/qemu_netduinoplus2/pipes.hpp"
#include "firmware/app/app.hpp"

namespace furcula::pil {

inline constexpr std::uint32_t kBegin = 0x46423035;  // "FB05": first message, and its version
inline constexpr std::uint32_t kTick = 1;
inline constexpr std::uint32_t kEnd = 2;

/// Host to board, first, and before any tick from which on there is another configuration.
struct Begin {
  std::uint32_t kind = kBegin;
  control::Config config;
};

/// Host to board, each tick: all that the board asks the rig.
struct Tick {
  std::uint32_t kind = kTick;  ///< kEnd: no tick, the board answers with a ShutdownReply and stops
  std::uint32_t now_us = 0;
  std::uint32_t sample_valid = 0;
  std::uint32_t reset = 0;
  control::Sample sample;
};

/// Every output of a tick, without padding.
struct Outputs {
  std::uint32_t tick = 0;
  control::Command command;
  float height_m = 0.0f, velocity_mps = 0.0f;
  float since_touchdown_s = 0.0f, since_liftoff_s = 0.0f, apex_height_m = 0.0f;
  std::uint8_t phase = 0, touchdown = 0, liftoff = 0, fault = 0;
  std::uint32_t clutch_stage = 0;
  float fold_m = 0.0f, cable_travel_m = 0.0f;
  float ground_force_n = 0.0f;
  std::uint16_t observed_contact = 0, landing = 0;
};

/// Board to host, each tick.
struct Reply {
  Outputs outputs;
  std::uint32_t instructions = 0;  ///< that the tick took, less what measuring takes
};

/// Board to host, last.
struct ShutdownReply {
  std::uint32_t watchdog_kicks = 0;
  Measured measured;
};

static_assert(std::is_trivially_copyable_v<Begin> && sizeof(Begin) == 432);
static_assert(std::is_trivially_copyable_v<Tick> && sizeof(Tick) == 52);
static_assert(std::is_trivially_copyable_v<Reply> && sizeof(Outputs) == 56 && sizeof(Reply) == 60);
static_assert(std::has_unique_object_representations_v<ShutdownReply>);

inline Outputs outputs_of(const firmware::Telemetry& telemetry) {
  const control::Outputs& out = telemetry.outputs;
  Outputs wire;
  wire.tick = telemetry.tick;
  wire.command = out.command;
  wire.height_m = out.height.height_m;
  wire.velocity_mps = out.height.velocity_mps;
  wire.since_touchdown_s = out.phase.since_touchdown_s;
  wire.since_liftoff_s = out.phase.since_liftoff_s;
  wire.apex_height_m = out.phase.apex_height_m;
  wire.phase = static_cast<std::uint8_t>(out.phase.phase);
  wire.touchdown = out.phase.touchdown ? 1 : 0;
  wire.liftoff = out.phase.liftoff ? 1 : 0;
  wire.fault = static_cast<std::uint8_t>(out.fault);
  wire.clutch_stage = static_cast<std::uint32_t>(out.clutch.stage);
  wire.fold_m = out.clutch.path.fold_m;
  wire.cable_travel_m = out.clutch.travel_m;
  wire.ground_force_n = out.contact.force_n;
  wire.observed_contact = out.contact.contact ? 1 : 0;
  wire.landing = out.landing ? 1 : 0;
  return wire;
}

}  // namespace furcula::pil
