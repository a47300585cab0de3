// Where in its stride a planar leg is: stance, rising, falling; by the switch under the toe, which bounces and is late,
// and by the heights of hip and toe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "furcula/control/debounce.hpp"
#include "furcula/control/gait_config.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// ready: held by hand in the pose of the apex, until it falls.
enum class GaitPhase : std::uint8_t { ready = 0, fall = 1, stance = 2, rise = 3 };

struct GaitPhaseState {
  static constexpr std::uint32_t kKept = 24;  ///< ticks: a switch may be late by as many, less four
  static constexpr std::uint32_t kSpan = 5;   ///< ticks over which the hip's velocity is measured
  GaitPhase phase = GaitPhase::ready;
  float since_s = 0.0f;  ///< of the phase
  DebounceState debounce;
  std::array<float, kKept> toe_m{};         ///< the last heights of the toe, in a ring
  std::array<float, kSpan + 1> height_m{};  ///< and of the hip
  std::uint32_t ticks = 0;                  ///< that these rings have, up to kKept
  std::uint32_t newest = 0, newest_height = 0;
  float ground_m = 0.0f;  ///< where the toe stands, or last stood
  JointPair last_rate_radps;
};

struct GaitView {
  float hip_m = 0.0f, toe_m = 0.0f;  ///< heights
  JointPair rate_radps;
  bool contact = false;  ///< raw
};

struct GaitPhaseEstimate {
  GaitPhase phase = GaitPhase::ready;
  float since_s = 0.0f, velocity_mps = 0.0f;
  bool closed = false;
  bool bounced = false;  ///< in the first half of a stance the toe is off the ground
  bool touchdown = false, liftoff = false, apex = false;  ///< on this tick
};

/// The toe's height over the hip's, from the joints' angles.
inline float toe_below_hip_m(const GaitConfig& c, const JointPair& angle) {
  constexpr float kTurns = 0.159154943f;
  return -(c.thigh_length_m * sine_of_turns(angle.hip * kTurns + 0.25f) +
           c.shank_length_m * sine_of_turns((angle.hip + angle.knee) * kTurns + 0.25f));
}

namespace detail {

inline float kept_toe(const GaitPhaseState& s, std::uint32_t back) {
  return s.toe_m[(s.newest + GaitPhaseState::kKept - back) % GaitPhaseState::kKept];
}

/// How long ago the toe, which stands at `level_m`, landed: from where it was `step_m` above it, it went on with the speed
/// that it had. 0 where it was not.
inline float since_landing_s(const GaitPhaseState& s, float level_m, float step_m, float dt_s) {
  for (std::uint32_t back = 1; back + 1 < s.ticks; ++back) {
    const float above = kept_toe(s, back) - level_m;
    if (above <= step_m) continue;
    const float way = kept_toe(s, back + 1) - kept_toe(s, back);
    return dt_s * (static_cast<float>(back) - (way > above ? above / way : 1.0f));
  }
  return 0.0f;
}
/// How long the toe has been above a level.
inline float since_above_s(const GaitPhaseState& s, float level_m, float dt_s) {
  std::uint32_t back = 0;
  while (back + 1 < s.ticks && kept_toe(s, back) > level_m) ++back;
  return dt_s * static_cast<float>(back);
}

}  // namespace detail

/// One tick, `dt_s` after the last.
inline GaitPhaseEstimate estimate_gait_phase(const GaitConfig& c, GaitPhaseState& s, const GaitView& view,
                                             float dt_s) {
  GaitPhaseEstimate out;
  s.newest = (s.newest + 1) % GaitPhaseState::kKept;
  s.toe_m[s.newest] = view.toe_m;
  s.newest_height = (s.newest_height + 1) % (GaitPhaseState::kSpan + 1);
  s.height_m[s.newest_height] = view.hip_m;
  if (s.ticks < GaitPhaseState::kKept) ++s.ticks;
  out.closed = debounce({}, s.debounce, view.contact, dt_s);
  s.since_s += dt_s;
  const bool known = s.ticks > GaitPhaseState::kSpan;
  if (known) {
    constexpr float kCount = static_cast<float>(GaitPhaseState::kSpan);
    const float oldest = s.height_m[(s.newest_height + 1) % (GaitPhaseState::kSpan + 1)];
    // The difference is the velocity of half of its span ago; in flight the hip falls nearly as a stone.
    out.velocity_mps = (view.hip_m - oldest) / (kCount * dt_s) - 0.5f * kCount * dt_s * c.gravity_mps2;
  }
  const auto enter = [&](GaitPhase phase, float since_s) {
    s.phase = phase;
    s.since_s = since_s;
  };
  const auto jumps = [&](float now, float before) {
    return now - before > c.impact_radps || before - now > c.impact_radps;
  };
  const bool struck = s.ticks > 1 && (jumps(view.rate_radps.hip, s.last_rate_radps.hip) ||
                                      jumps(view.rate_radps.knee, s.last_rate_radps.knee));
  s.last_rate_radps = view.rate_radps;
  const bool low = view.toe_m <= c.ground_m;
  const float fallen_s = -out.velocity_mps / c.gravity_mps2;
  switch (s.phase) {
    case GaitPhase::ready:
      if (known && !out.closed && out.velocity_mps < -0.1f) {
        enter(GaitPhase::fall, fallen_s);
        out.apex = true;
      }
      break;
    case GaitPhase::rise:
      // A toe that comes down before the apex stumbles: it stands, too.
      if (out.closed && low && s.since_s > c.shortest_rise_s) {
        out.touchdown = true;
      } else if (s.since_s > c.shortest_rise_s && out.velocity_mps <= 0.0f) {
        enter(GaitPhase::fall, fallen_s);
        out.apex = true;
      }
      break;
    case GaitPhase::fall:
      out.touchdown = low && (out.closed || struck);
      break;
    case GaitPhase::stance: {
      const float above_m = view.toe_m - s.ground_m;
      const bool early = s.since_s < 0.5f * c.stance.duration_s;
      if (early) {
        // A toe that bounced: its stance waits for it. One that is thrown lands anew.
        out.bounced = above_m > c.bounce_m;
        if (out.bounced) s.since_s -= dt_s;
        if (above_m > c.ground_m) enter(GaitPhase::fall, c.fall.duration_s);
      } else if (!out.closed || above_m > c.ground_m) {
        out.liftoff = true;
        enter(GaitPhase::rise, detail::since_above_s(s, s.ground_m + c.toe_step_m, dt_s));
      } else if (s.since_s > c.stance.duration_s + c.longest_stance_s) {
        // The motors lift the toe.
        out.liftoff = true;
        enter(GaitPhase::rise, 0.0f);
      }
      break;
    }
  }
  if (out.touchdown) {
    s.ground_m = view.toe_m;
    enter(GaitPhase::stance, detail::since_landing_s(s, view.toe_m, c.toe_step_m, dt_s));
  }
  out.phase = s.phase;
  out.since_s = s.since_s;
  return out;
}

}  // namespace furcula::control
