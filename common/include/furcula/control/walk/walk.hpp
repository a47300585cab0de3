// The walk of a biped with position-controlled joints: SIMBICON (Yin, Loken, van de Panne 2007) with a start and a stop,
// as a pure step from what the board measures to the drives' targets.
//
//   target = from + (to - from) min(1, t / blend) + clamp(feedback, +-0.3 rad)     from: the last target, no feedback
//
//   start  shifts the weight over the left foot
//   up     the swing foot rises, for a time                                            -> down
//   down   until the swing foot touches down, after 30 ms at the earliest, or a time   -> up on the other foot,
//                                                                                         or stop after walk_until_s
//   stop   the posture, balanced by the ankles
//
// Feedback (equations: 000 section III; gains: walk_parameters.hpp): of the centre of mass relative to the stance foot's
// ankle, from joints, gyro and attitude. One code for a robot in float or double and for a SIMD batch of robots.
#pragma once

#include <cstdint>

#include "furcula/control/walk/attitude_filter.hpp"
#include "furcula/control/walk/walk_parameters.hpp"
#include "furcula/control/walk/walker_pose.hpp"

namespace furcula::control {

/// Phase of a walk.
enum class WalkPhase : std::uint8_t {
  start,  ///< shifts the weight over the left foot
  up,     ///< the swing foot rises
  down,   ///< the swing foot comes down
  stop    ///< stands in the posture
};

/// What a board measures in a tick. T: float, double or a SIMD batch of robots.
template <class T>
struct WalkSample {
  dynamics::biped::Joints<T> q_rad,  ///< joint angles
      qd_radps;                      ///< joint rates
  Vec3<T> gyro_radps;                ///< angular velocity of the pelvis, in its axes
  Quaternion<T> attitude;            ///< from the pelvis' axes to level axes
  T left_carries,                    ///< 1 where the left foot is on the ground (FootSwitch), else 0
      right_carries;                 ///< 1 where the right foot is on the ground, else 0
};

/// A walk and the model of the robot for its feedback.
template <class T>
struct WalkConfig {
  using V = dynamics::ValueOf<T>;  ///< the scalar of one robot

  WalkParameters<T> walk;               ///< targets, times and gains
  dynamics::biped::Parameters<T> body;  ///< model of the robot: geometry and masses for balance()
  T inverse_mass_1pkg{};                ///< of the whole robot
  V walk_until_s = V(5);                ///< the walk stops at the first change of legs after this time
  V lands_after_s = V(0.03);            ///< time in `down` until which a touch-down does not count
  V feedback_most_rad = V(0.3);         ///< largest magnitude of each joint's feedback

  /// All numbers zero except times and limits: no walk.
  WalkConfig() = default;
  /// Takes copies; the mass is that of all links of `of`.
  WalkConfig(const WalkParameters<T>& parameters, const dynamics::biped::Parameters<T>& of)
      : walk(parameters), body(of) {
    using namespace dynamics::biped;
    T mass = of.pelvis.mass_kg;
    for (const std::size_t side : {kLeft, kRight})
      for (std::size_t j = 0; j < kLegJoints; ++j) mass += of.link(side, j).mass_kg;
    inverse_mass_1pkg = V(1) / mass;
  }
};

/// State of step_walk() between two ticks. begin_walk() makes it.
template <class T>
struct WalkState {
  using V = dynamics::ValueOf<T>;                                  ///< the scalar of one robot
  static constexpr std::size_t kRobots = dynamics::lanes_in<T>();  ///< robots in the SIMD batch, or 1

  std::array<WalkPhase, kRobots> phase{};      ///< of each robot
  std::array<bool, kRobots> on_left{};         ///< of each robot: the left foot is the stance foot
  std::array<std::uint32_t, kRobots> steps{};  ///< of each robot: ends of `down` so far
  T total_s{},                                 ///< time since the walk began
      since_s{};                               ///< time since the phase began
  T inverse_blend_1ps{},                       ///< 1 / time in which the phase's targets are reached
      end_s{};                                 ///< time in the phase at which it ends
  T left{},                                    ///< 1: the left foot is the stance foot, else 0
      walks{},                                 ///< 1: the phase is `up` or `down`, else 0
      stops{},                                 ///< 1: the phase is `stop`, else 0
      lands{};                                 ///< 1: the phase is `down`, else 0
  dynamics::biped::Joints<T> from_rad{},       ///< targets at the phase's beginning, without feedback
      change_rad{};                            ///< by which the phase changes them
};

/// Targets of a leg's joints, by LegJoint, rad.
template <class V>
using LegAngles = std::array<V, dynamics::biped::kLegJoints>;

/// The posture plus the offsets `beside` of a phase, for the leg on `side`, in the joints' signs; hip yaw is 0.
template <class V>
LegAngles<V> leg_angles(const WalkParameters<V>& w, const LegTargets<V>& beside, std::size_t side) {
  const V outwards = side == dynamics::biped::kLeft ? V(1) : V(-1);
  return {V(0),
          outwards * beside.hip_roll,
          w.hip_rad - V(0.5) * w.knee_rad + beside.hip_pitch,
          w.knee_rad + beside.knee,
          w.ankle_rad - V(0.5) * w.knee_rad + beside.ankle_pitch,
          outwards * beside.ankle_roll};
}

namespace detail {

/// Targets of a phase for the leg on `side`.
template <class V>
LegAngles<V> wanted(const WalkParameters<V>& w, WalkPhase phase, bool on_left, std::size_t side) {
  const bool stands = on_left == (side == dynamics::biped::kLeft);
  switch (phase) {
    case WalkPhase::start: {
      // The pelvis over the left foot: the left leg leans in, the right one out.
      const V out = side == dynamics::biped::kLeft ? -w.sway_rad : w.sway_rad;
      return leg_angles(w, {V(0), V(0), -w.lean_rad, out, -out}, side);
    }
    case WalkPhase::up:
      return leg_angles(w, stands ? w.up_stance : w.up_swing, side);
    case WalkPhase::down:
      return leg_angles(w, stands ? w.down_stance : w.down_swing, side);
    case WalkPhase::stop:
      break;
  }
  return leg_angles(w, {}, side);
}

template <class T>
WalkParameters<dynamics::ValueOf<T>> parameters_of(const WalkParameters<T>& w, std::size_t lane) {
  std::array<dynamics::ValueOf<T>, WalkParameters<T>::kCount> out;
  const auto values = w.values();
  for (std::size_t i = 0; i < values.size(); ++i) out[i] = dynamics::lane_of(values[i], lane);
  return WalkParameters<dynamics::ValueOf<T>>::of(out);
}

/// Progress of the targets' blend, 0 to 1.
template <class T>
FURCULA_INLINE T blended(const WalkState<T>& s) {
  return dynamics::smaller(T(s.since_s * s.inverse_blend_1ps), T(dynamics::ValueOf<T>(1)));
}

/// Robot `lane` of the batch enters a phase; its targets begin where they are.
template <class T>
void enter(const WalkConfig<T>& c, WalkPhase phase, bool on_left, std::size_t lane, WalkState<T>& s) {
  using namespace dynamics::biped;
  using V = dynamics::ValueOf<T>;
  const auto w = parameters_of(c.walk, lane);
  const V share = dynamics::lane_of(blended(s), lane);
  for (const std::size_t side : {kLeft, kRight}) {
    const LegAngles<V> to = wanted(w, phase, on_left, side);
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const std::size_t i = side * kLegJoints + j;
      T from = joint<T>(s.from_rad, i), change = joint<T>(s.change_rad, i);
      const V here = dynamics::lane_of(from, lane) + dynamics::lane_of(change, lane) * share;
      dynamics::set_lane(from, lane, here);
      dynamics::set_lane(change, lane, to[j] - here);
      set_joint<T>(s.from_rad, i, from);
      set_joint<T>(s.change_rad, i, change);
    }
  }
  V blend = w.start_s, end = w.start_s;
  if (phase == WalkPhase::up) blend = w.up_blend_s, end = w.up_s;
  if (phase == WalkPhase::down) blend = w.down_blend_s, end = w.down_s;
  if (phase == WalkPhase::stop) blend = w.stop_blend_s, end = V(1e9);
  s.phase[lane] = phase;
  s.on_left[lane] = on_left;
  dynamics::set_lane(s.since_s, lane, V(0));
  dynamics::set_lane(s.inverse_blend_1ps, lane, V(1) / blend);
  dynamics::set_lane(s.end_s, lane, end);
  dynamics::set_lane(s.left, lane, on_left ? V(1) : V(0));
  dynamics::set_lane(s.walks, lane, phase == WalkPhase::up || phase == WalkPhase::down ? V(1) : V(0));
  dynamics::set_lane(s.lands, lane, phase == WalkPhase::down ? V(1) : V(0));
  dynamics::set_lane(s.stops, lane, phase == WalkPhase::stop ? V(1) : V(0));
}

/// Begins the phase after the one of robot `lane` of the batch, which has ended.
template <class T>
void go_on(const WalkConfig<T>& c, std::size_t lane, WalkState<T>& s) {
  const bool on_left = s.on_left[lane];
  switch (s.phase[lane]) {
    case WalkPhase::start:
      enter(c, WalkPhase::up, true, lane, s);
      break;
    case WalkPhase::up:
      enter(c, WalkPhase::down, on_left, lane, s);
      break;
    case WalkPhase::down:
      ++s.steps[lane];
      enter(c, dynamics::lane_of(s.total_s, lane) > c.walk_until_s ? WalkPhase::stop : WalkPhase::up,
            !on_left, lane, s);
      break;
    case WalkPhase::stop:
      break;
  }
}

}  // namespace detail

/// Begins the walk of robot `lane` of the batch anew: in the posture, phase `start`.
template <class T>
void begin_walk(const WalkConfig<T>& c, std::size_t lane, WalkState<T>& s) {
  using namespace dynamics::biped;
  using V = dynamics::ValueOf<T>;
  const auto w = detail::parameters_of(c.walk, lane);
  for (const std::size_t side : {kLeft, kRight}) {
    const auto posture = detail::wanted(w, WalkPhase::stop, true, side);
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const std::size_t i = side * kLegJoints + j;
      T from = joint<T>(s.from_rad, i), change = joint<T>(s.change_rad, i);
      dynamics::set_lane(from, lane, posture[j]);
      dynamics::set_lane(change, lane, V(0));
      set_joint<T>(s.from_rad, i, from);
      set_joint<T>(s.change_rad, i, change);
    }
  }
  dynamics::set_lane(s.total_s, lane, V(0));
  s.steps[lane] = 0;
  detail::enter(c, WalkPhase::start, true, lane, s);
}
/// The state before the first tick, for all robots of the batch.
template <class T>
WalkState<T> begin_walk(const WalkConfig<T>& c) {
  WalkState<T> s{};
  for (std::size_t lane = 0; lane < WalkState<T>::kRobots; ++lane) begin_walk(c, lane, s);
  return s;
}

/// Result of one tick.
template <class T>
struct WalkOutputs {
  dynamics::biped::Joints<T> target_rad;  ///< angles for the drives
  Balance<T> balance;    ///< about the stance foot's ankle; in `stop` about the middle of the ankles
  Vec3<T> apart_m;       ///< position of the left ankle relative to the right one, in the pelvis frame's axes
  Vec3<T> left_ankle_m;  ///< position relative to the pelvis frame's origin, in its axes
};

/// One tick, `dt_s` after the last.
template <class T>
FURCULA_INLINE void step_walk(const WalkConfig<T>& c, const WalkSample<T>& in, dynamics::ValueOf<T> dt_s,
                              WalkState<T>& s, WalkOutputs<T>& out) {
  using namespace dynamics::biped;
  using dynamics::clamped;
  using dynamics::select;
  using L = LegScalar<T>;
  using V = dynamics::ValueOf<T>;
  const T zero = T(V(0)), one = T(V(1));

  s.total_s += T(dt_s);
  s.since_s += T(dt_s);
  const T swing_carries = select(s.left > V(0.5), in.right_carries, in.left_carries);
  const T landed = select(s.since_s > c.lands_after_s, T(s.lands * swing_carries), zero);
  const auto over = select(landed > V(0.5), zero, s.end_s) < s.since_s;
  if (dynamics::any(over)) {
    const T ends = select(over, one, zero);
    for (std::size_t lane = 0; lane < WalkState<T>::kRobots; ++lane)
      if (dynamics::lane_of(ends, lane) > V(0.5)) detail::go_on(c, lane, s);
  }

  PerLeg<T, LegPose<L>> legs;
  leg_poses(c.body, in.q_rad, in.qd_radps, legs);
  // About the stance ankle in a walk, about the middle of the ankles after it.
  const T middle = V(0.5) * s.stops, left = select(s.stops > V(0.5), middle, s.left), right = one - left;
  out.balance = balance(c.body, c.inverse_mass_1pkg, legs, in.attitude, in.gyro_radps, left, right);
  out.apart_m = ankles_apart<T>(legs);
  out.left_ankle_m = left_ankle<T>(legs);
  const Balance<T>& b = out.balance;
  const auto& g = c.walk.gains;
  const T swings_left = one - V(2) * s.left;  // the swing leg's side
  const T d = b.forward_m, v = b.forward_mps, y = swings_left * b.left_m - c.walk.side_m,
          vy = swings_left * b.left_mps;
  const auto walking = [&](const T& of) { return s.walks * clamped(of, T(c.feedback_most_rad)); };
  const T swing_hip_pitch = walking(T(-(g[0] * d + g[1] * v)));
  const T swing_hip_roll = walking(T(g[4] * y + g[5] * vy));
  const T stands =
      s.stops * clamped(T(c.walk.stop_d_radpm * d + c.walk.stop_v_radspm * v), T(c.feedback_most_rad));
  const T stance_ankle_pitch = walking(T(g[2] * d + g[3] * v)) + stands;
  const T stance_ankle_roll = walking(T(g[6] * y + g[7] * vy));
  const T stance_hip_pitch = walking(T(g[8] * d + g[9] * v));
  const T stance_hip_roll = walking(T(g[10] * y + g[11] * vy));

  const L share = L(detail::blended(s));
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
    for (std::size_t j = 0; j < kLegJoints; ++j)
      out.target_rad[pass][j] = s.from_rad[pass][j] + s.change_rad[pass][j] * share;
  const auto on_left = s.left > V(0.5);
  const auto add = [&](std::size_t j, const T& on_stance, const T& on_swing, V right_leg) {
    const T to_left = select(on_left, on_stance, on_swing),
            to_right = select(on_left, on_swing, on_stance) * right_leg;
    set_joint<T>(out.target_rad, j, T(joint<T>(out.target_rad, j) + to_left));
    set_joint<T>(out.target_rad, kLegJoints + j, T(joint<T>(out.target_rad, kLegJoints + j) + to_right));
  };
  add(kHipRoll, stance_hip_roll, swing_hip_roll, V(-1));
  add(kHipPitch, stance_hip_pitch, swing_hip_pitch, V(1));
  add(kAnklePitch, stance_ankle_pitch, stands, V(1));
  add(kAnkleRoll, stance_ankle_roll, zero, V(-1));
}

/// Contact switch of a foot from its load: on at once above the threshold, off after 10 ms below half of it.
template <class T>
struct FootSwitch {
  static constexpr double kOffAfter_s = 0.01;  ///< below half of the threshold until it is off

  T carries{};  ///< 1: the foot is on the ground, else 0
  T below_s{};  ///< how long the load has been below half of the threshold

  /// One tick, `dt_s` after the last, with the foot's normal force.
  FURCULA_INLINE void step(const T& normal_n, dynamics::ValueOf<T> threshold_n, dynamics::ValueOf<T> dt_s) {
    using V = dynamics::ValueOf<T>;
    using dynamics::select;
    const T zero = T(V(0)), one = T(V(1));
    below_s = select(normal_n < T(V(0.5) * threshold_n), T(below_s + dt_s), zero);
    const V off = V(kOffAfter_s) - V(0.5) * dt_s;  // ticks add up to it but for rounding
    carries = select(normal_n > threshold_n, one, select(below_s > off, zero, carries));
  }
};

}  // namespace furcula::control
