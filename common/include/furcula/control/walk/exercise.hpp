// Movements of all joints of a biped on its stand, from whose recording a model is identified (docs/biped.md): no ground acts on the robot.
//
// Each move goes from the last targets to new ones, straight in 0.7 of its time, and holds them for the rest. Targets are the walk's posture plus
// offsets from kExerciseRanges, drawn anew for each joint. A move lasts 1.6 s in the first half of the time, then 0.8 s: the
// same joint moves at different rates, which parts dry from viscous friction, and rests under different loads. Slow moves come first: a drive that is
// late obeys in them, and what is wrong otherwise shows before joints are fast. The same walk gives the same movements.
#pragma once

#include <array>
#include <cstdint>

#include "furcula/dynamics/biped/state.hpp"

namespace furcula::control {

/// Offsets from the posture, rad: in the joints' signs for the left leg, mirrored for the right one.
struct ExerciseRange {
  float least_rad,  ///< lower end
      most_rad;     ///< upper end
};
/// By LegJoint. A leg rolls outwards only: inwards the feet would meet. The fastest move is 0.7 rad/s; document 000's limit is 1.5.
inline constexpr std::array<ExerciseRange, dynamics::biped::kLegJoints> kExerciseRanges{
    {{-0.1f, 0.1f}, {0.0f, 0.2f}, {-0.2f, 0.2f}, {-0.15f, 0.25f}, {-0.2f, 0.2f}, {-0.12f, 0.12f}}};

/// Shortest exercise, s: a move and the way back.
inline constexpr double kLeastExercise_s = 4.0;
/// Longest exercise, s: its time is a sum of ticks in float, which is exact enough up to 512 s.
inline constexpr double kMostExercise_s = 500.0;

/// Joints' angles, left leg then right, rad.
using JointAngles = std::array<float, dynamics::biped::kJoints>;

/// State of step_exercise() between two ticks; as constructed, before the first one.
struct ExerciseState {
  JointAngles from_rad{},    ///< offsets from the posture at the move's beginning
      to_rad{};              ///< and at its end
  float total_s = 0.0f,      ///< time since the exercise began
      since_s = 0.0f,        ///< time since the move began
      move_s = 0.0f;         ///< time of the move
  std::uint32_t moves = 0,   ///< begun so far
      random = 0x9E3779B9u;  ///< of Marsaglia's xorshift
};

namespace detail {

/// Uniform in [0, 1).
inline float drawn(std::uint32_t& random) {
  random ^= random << 13;
  random ^= random >> 17;
  random ^= random << 5;
  return static_cast<float>(random >> 8) * (1.0f / 16777216.0f);
}

inline void begin_move(float exercise_s, ExerciseState& s) {
  using namespace dynamics::biped;
  s.since_s = 0.0f;
  s.move_s = s.total_s < 0.5f * exercise_s ? 1.6f : 0.8f;
  ++s.moves;
  s.from_rad = s.to_rad;
  // The last one ends in the posture: no further one would end in time.
  const bool last = s.total_s + 2.0f * s.move_s > exercise_s;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const std::size_t j = i % kLegJoints;
    const bool mirrored = i >= kLegJoints && (j == kHipYaw || j == kHipRoll || j == kAnkleRoll);
    const ExerciseRange& range = kExerciseRanges[j];
    const float offset_rad = range.least_rad + (range.most_rad - range.least_rad) * drawn(s.random);
    s.to_rad[i] = last ? 0.0f : mirrored ? -offset_rad : offset_rad;
  }
}

}  // namespace detail

/// One tick, `dt_s` after the last: targets about `posture_rad`. By `exercise_s`, at least kLeastExercise_s, they rest in the posture.
inline JointAngles step_exercise(const JointAngles& posture_rad, float exercise_s, float dt_s,
                                 ExerciseState& s) {
  if (s.moves == 0) detail::begin_move(exercise_s, s);
  s.total_s += dt_s;
  s.since_s += dt_s;
  if (s.since_s > s.move_s) detail::begin_move(exercise_s, s);
  const float share = s.since_s / (0.7f * s.move_s);
  JointAngles out;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = posture_rad[i] + s.from_rad[i] + (s.to_rad[i] - s.from_rad[i]) * (share < 1.0f ? share : 1.0f);
  return out;
}

}  // namespace furcula::control
