// What a controller needs to play a gait of a planar leg: the gait as a table, the feedback about it, and the limits of
// plausible sensor readings. docs/gaits.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "furcula/core/sine.hpp"
#include "furcula/core/status.hpp"

namespace furcula::control {

/// A value of each joint. Angles are counter-clockwise; a positive torque flexes the joint.
struct JointPair {
  float hip = 0.0f,  ///< of the hip; its angle is that of the thigh from straight down
      knee = 0.0f;   ///< of the knee; its angle is that of the shank from the thigh's direction
};

/// A point of the gait in time.
struct GaitKnot {
  JointPair angle,  ///< rad
      rate,         ///< rad/s
      torque;       ///< N m, of the gait without feedback
};

/// One phase of the gait, as knots at equal distances in time, both ends included.
struct GaitPath {
  static constexpr std::size_t kIntervals = 48;  ///< between knots
  float duration_s = 0.0f;                       ///< from the first knot to the last, between 1 ms and 10 s
  std::array<GaitKnot, kIntervals + 1> knots{};  ///< in the order of time
};

/// The gait, its feedback, the leg, and limits of what is plausible. check() says whether it makes sense.
struct GaitConfig {
  GaitPath fall,                    ///< from the apex to touch-down
      stance,                       ///< from touch-down to lift-off
      rise;                         ///< from lift-off to the apex
  float flight_kp_nmprad = 200.0f,  ///< stiffness of the feedback at each joint in flight
      flight_kd_nmsprad = 5.0f;     ///< damping of the feedback at each joint in flight
  // With zero gains in stance the gait's torques are played over time alone.
  float stance_kp_nmprad = 200.0f,  ///< stiffness of the feedback at each joint in stance
      stance_kd_nmsprad = 10.0f,    ///< damping of the feedback at each joint in stance
      feedback_most_nm = 40.0f;     ///< largest magnitude of the feedback at each joint in stance
  float stance_ramp_s = 0.08f;      ///< in which the gains of stance grow from zero after touch-down
  // The gains decrease close to the ground: the switch is late, and a leg that resists the jump of its rates at
  // touch-down bounces.
  float yields_from_m = 0.03f,  ///< height of the toe below which the gains of the fall decrease
      yields_m = 0.01f;         ///< height of the toe below which they are zero: the gait's torque acts alone
  float bounced_share = 0.25f;  ///< of the flight's gains, while a leg that bounced waits for the ground
  JointPair torque_most_nm{80.0f, 80.0f};  ///< largest magnitude of each joint's torque
  float thigh_length_m = 0.0f,             ///< from hip to knee
      shank_length_m = 0.0f,               ///< from knee to toe
      gravity_mps2 = 9.81f;                ///< acceleration of gravity, positive downwards

  // Touch-down and lift-off.
  /// The ground is level within this height: a switch that is closed while the toe is higher is no touch-down, and a toe
  /// that is higher above its place of landing has left the ground, whatever the switch reads; m.
  float ground_m = 0.03f;
  float longest_stance_s = 0.003f;  ///< by which a stance may last longer than the gait's; then the leg rises
  float bounce_m = 0.0015f;  ///< a toe so far above where it landed, in the first half of stance, has bounced
  float shortest_rise_s = 0.03f;  ///< until then a closed switch is the bounce of lift-off
  /// Height from which the toe's last samples date touch-down and lift-off back, since the switch is late; m.
  float toe_step_m = 0.001f;
  /// A joint's rate that jumps by so much in a tick, close above the ground, is the impact of touch-down: it is seen
  /// before the switch; rad/s.
  float impact_radps = 1.0f;

  // Limits of what is plausible; beyond each is a fault.
  std::uint32_t tick_interval_max_us = 1500,  ///< between two ticks; more is late_tick
      sample_age_max_us = 1500,               ///< age of a sample; more is stale_input
      missed_samples_max = 1;                 ///< samples missed in a row; more is peer_lost
  float height_min_m = 0.25f,                 ///< of the hip; lower: the robot has fallen
      height_max_m = 1.2f;                    ///< of the hip; higher: the robot was thrown
  JointPair least_rad{-1.3f, -0.1f},          ///< smallest angle of each joint
      most_rad{1.3f, 2.55f};                  ///< largest angle of each joint
  float rate_max_radps = 60.0f,               ///< of a joint; a faster change of an angle is encoder_jump
      speed_max_mps = 6.0f;                   ///< of the hip; a faster change of its height is encoder_jump
  float toe_mismatch_m = 0.035f;  ///< height of the toe in stance, and its depth below the ground at any time
  float implausible_closed_s =
      0.02f;                         ///< with the switch closed and the toe above ground_m, except in stance
  float implausible_open_s = 0.06f;  ///< with the switch open and the toe below toe_low_m, in the fall
  float toe_low_m = 0.012f;          ///< height of the toe for implausible_open_s
  float astray_rad = 0.6f,           ///< by which a joint may be off its path in flight
      astray_s = 0.03f;              ///< for which it may be further off
};
static_assert(std::is_trivially_copyable_v<GaitConfig>, "it travels as bytes");

/// Whether the configuration makes sense. `invalid`: a number is not finite, not positive where it must be, or a range
/// is empty.
inline Status check(const GaitConfig& c) {
  for (const GaitPath* p : {&c.fall, &c.stance, &c.rise}) {
    if (!(p->duration_s > 0.001f && p->duration_s < 10.0f)) return Status::invalid;
    for (const GaitKnot& k : p->knots)
      for (const JointPair& v : {k.angle, k.rate, k.torque})
        if (!is_finite(v.hip) || !is_finite(v.knee)) return Status::invalid;
  }
  for (const float x :
       {c.thigh_length_m, c.shank_length_m, c.gravity_mps2, c.torque_most_nm.hip, c.torque_most_nm.knee,
        c.ground_m, c.toe_step_m, c.impact_radps, c.rate_max_radps, c.speed_max_mps, c.toe_mismatch_m,
        c.implausible_closed_s, c.implausible_open_s, c.astray_rad, c.astray_s, c.stance_ramp_s})
    if (!is_finite(x) || x <= 0.0f) return Status::invalid;
  for (const float x :
       {c.flight_kp_nmprad, c.flight_kd_nmsprad, c.stance_kp_nmprad, c.stance_kd_nmsprad, c.feedback_most_nm,
        c.longest_stance_s, c.yields_m, c.bounce_m, c.shortest_rise_s, c.toe_low_m})
    if (!is_finite(x) || x < 0.0f) return Status::invalid;
  const bool ranges = c.yields_m < c.yields_from_m && c.height_min_m < c.height_max_m &&
                      c.least_rad.hip < c.most_rad.hip && c.least_rad.knee < c.most_rad.knee;
  return ranges ? Status::ok : Status::invalid;
}

/// After the end of a phase the angles continue at their last rate for this time and then stay, as in
/// host/gait/path_pieces.hpp.
inline constexpr float kDrifts_s = 0.05f;

namespace detail {

struct GaitPlace {
  std::size_t knot;
  float share, step_s;  ///< of the way to the next knot; s between knots
};
inline GaitPlace place_in(const GaitPath& path, float time_s) {
  constexpr float kCount = static_cast<float>(GaitPath::kIntervals);
  const float at = time_s > 0.0f ? time_s * (kCount / path.duration_s) : 0.0f;
  const float step = path.duration_s / kCount;
  if (at >= kCount) return {GaitPath::kIntervals - 1, 1.0f, step};
  const auto knot = static_cast<std::uint32_t>(at);
  return {knot, at - static_cast<float>(knot), step};
}
/// Hermite's cubic: value and rate.
inline void cubic(float y0, float v0, float y1, float v1, const GaitPlace& p, float& y, float& v) {
  const float d = y1 - y0, a = v0 * p.step_s - d, b = d - v1 * p.step_s;
  const float s = p.share, r = 1.0f - s;
  y = y0 + s * d + s * r * (r * a + s * b);
  v = (d + (r - s) * (r * a + s * b) + s * r * (b - a)) / p.step_s;
}
/// Through four values at equal distances, between the second and the third, as Catmull and Rom have it.
inline float between(float y0, float y1, float y2, float y3, float s) {
  const float m1 = 0.5f * (y2 - y0), m2 = 0.5f * (y3 - y1), d = y2 - y1, r = 1.0f - s;
  return y1 + s * d + s * r * (r * (m1 - d) + s * (d - m2));
}

}  // namespace detail

/// Angle and rate of the gait `time_s` after the beginning of a phase, also after its end (kDrifts_s); no torque.
inline GaitKnot motion_at(const GaitPath& path, float time_s) {
  const detail::GaitPlace p = detail::place_in(path, time_s);
  const GaitKnot &k = path.knots[p.knot], &n = path.knots[p.knot + 1];
  GaitKnot out;
  if (time_s > path.duration_s) {
    const float past = time_s - path.duration_s;
    const bool stands = past > kDrifts_s;
    const float drift = stands ? kDrifts_s : past;
    out.angle = {n.angle.hip + drift * n.rate.hip, n.angle.knee + drift * n.rate.knee};
    if (!stands) out.rate = n.rate;
    return out;
  }
  detail::cubic(k.angle.hip, k.rate.hip, n.angle.hip, n.rate.hip, p, out.angle.hip, out.rate.hip);
  detail::cubic(k.angle.knee, k.rate.knee, n.angle.knee, n.rate.knee, p, out.angle.knee, out.rate.knee);
  return out;
}

/// Torque of the gait without feedback `time_s` after the beginning of a phase, N m; after its end the last one.
inline JointPair torque_at(const GaitPath& path, float time_s) {
  const detail::GaitPlace p = detail::place_in(path, time_s);
  const std::size_t i = p.knot;
  const JointPair &b = path.knots[i].torque, &c = path.knots[i + 1].torque;
  // At the ends the line goes on.
  const JointPair first{2.0f * b.hip - c.hip, 2.0f * b.knee - c.knee},
      last{2.0f * c.hip - b.hip, 2.0f * c.knee - b.knee};
  const JointPair a = i > 0 ? path.knots[i - 1].torque : first;
  const JointPair d = i + 2 <= GaitPath::kIntervals ? path.knots[i + 2].torque : last;
  return {detail::between(a.hip, b.hip, c.hip, d.hip, p.share),
          detail::between(a.knee, b.knee, c.knee, d.knee, p.share)};
}

}  // namespace furcula::control
