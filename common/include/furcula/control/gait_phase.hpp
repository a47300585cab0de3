// The phase of a planar leg's stride: stance, rise, fall; from the switch under the toe, which bounces and is late, and
// from the heights of hip and toe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "furcula/control/debounce.hpp"
#include "furcula/control/gait_config.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Phase of a stride.
enum class GaitPhase : std::uint8_t {
  ready = 0,   ///< held by hand in the pose of the apex, until it falls
  fall = 1,    ///< from the apex to touch-down
  stance = 2,  ///< the toe is on the ground
  rise = 3     ///< from lift-off to the apex
};

/// State of estimate_gait_phase() between two ticks.
struct GaitPhaseState {
  static constexpr std::uint32_t kKept = 24;  ///< ticks: a switch may be late by as many, less four
  static constexpr std::uint32_t kSpan = 5;   ///< ticks over which the hip's velocity is measured
  GaitPhase phase = GaitPhase::ready;         ///< current phase
  float since_s = 0.0f;                       ///< time since the phase began, dated back
  DebounceState debounce;                     ///< of the switch under the toe
  std::array<float, kKept> toe_m{};           ///< last heights of the toe, a ring buffer
  std::array<float, kSpan + 1> height_m{};    ///< last heights of the hip, a ring buffer
  std::uint32_t ticks = 0;                    ///< samples since the start, up to kKept
  std::uint32_t newest = 0,                   ///< index of the newest height in toe_m
      newest_height = 0;                      ///< index of the newest height in height_m
  float ground_m = 0.0f;                      ///< height at which the toe landed last
  JointPair last_rate_radps;                  ///< joint rates on the last tick
};

/// Inputs of one tick.
struct GaitView {
  float hip_m = 0.0f,    ///< height of the hip above the ground
      toe_m = 0.0f;      ///< height of the toe above the ground
  JointPair rate_radps;  ///< joint rates
  bool contact = false;  ///< switch under the toe before debouncing
};

/// Result of one tick.
struct GaitPhaseEstimate {
  GaitPhase phase = GaitPhase::ready;  ///< phase after this tick
  float since_s = 0.0f,                ///< time since the phase began, dated back
      velocity_mps = 0.0f;             ///< of the hip, positive upwards; 0 in the first five ticks
  bool closed = false;                 ///< switch after debouncing
  bool bounced = false;                ///< in the first half of a stance the toe is off the ground
  bool touchdown = false,              ///< on this tick
      liftoff = false,                 ///< on this tick
      apex = false;                    ///< on this tick
};

/// Height of the toe relative to the hip, from the joint angles [m]; negative where the toe is below the hip.
inline float toe_below_hip_m(const GaitConfig& c, const JointPair& angle) {
  constexpr float kTurns = 0.159154943f;
  return -(c.thigh_length_m * sine_of_turns(angle.hip * kTurns + 0.25f) +
           c.shank_length_m * sine_of_turns((angle.hip + angle.knee) * kTurns + 0.25f));
}

namespace detail {

inline float kept_toe(const GaitPhaseState& s, std::uint32_t back) {
  return s.toe_m[(s.newest + GaitPhaseState::kKept - back) % GaitPhaseState::kKept];
}

/// How long ago the toe, which is on the ground at `level_m`, landed: from the sample that was more than `step_m` above
/// it, with the speed there. 0 where no sample was.
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

/// One tick, `dt_s` after the last. Touch-down, lift-off and apex are dated back where signals are late.
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
