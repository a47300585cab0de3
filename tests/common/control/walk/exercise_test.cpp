// An exercise on the stand: within its ranges and the limit of speed, slow at first, from the posture to the posture.
#include "furcula/control/walk/exercise.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula::control;
using namespace furcula::dynamics::biped;

TEST_CASE("an exercise keeps its ranges and the limit of speed, and ends in the posture") {
  constexpr float kTick_s = 1e-3f, kExercise_s = 10.0f;
  JointAngles posture_rad{};
  for (std::size_t i = 0; i < kJoints; ++i) posture_rad[i] = 0.1f * static_cast<float>(i % 5);
  ExerciseState s;
  JointAngles before = posture_rad;
  std::array<float, kJoints> least{}, most{}, fastest{}, fastest_at_first{};
  for (int tick = 0; tick < 10'500; ++tick) {
    const JointAngles now = step_exercise(posture_rad, kExercise_s, kTick_s, s);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const float offset = now[i] - posture_rad[i], rate = std::abs(now[i] - before[i]) / kTick_s;
      least[i] = std::min(least[i], offset), most[i] = std::max(most[i], offset);
      fastest[i] = std::max(fastest[i], rate);
      if (tick < 5'000) fastest_at_first[i] = std::max(fastest_at_first[i], rate);
      if (tick > 10'000) CHECK(std::abs(offset) < 1e-6f);
    }
    before = now;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    INFO("joint " << i);
    const std::size_t j = i % kLegJoints;
    const ExerciseRange& range = kExerciseRanges[j];
    const bool mirrored = i >= kLegJoints && (j == kHipYaw || j == kHipRoll || j == kAnkleRoll);
    const float low = mirrored ? -range.most_rad : range.least_rad,
                high = mirrored ? -range.least_rad : range.most_rad;
    CHECK(least[i] >= low - 1e-5f);
    CHECK(most[i] <= high + 1e-5f);
    CHECK(most[i] - least[i] > 0.5f * (high - low));
    CHECK(fastest[i] < 0.75f);
    CHECK(fastest_at_first[i] < 0.375f);
  }
  CHECK(*std::max_element(fastest.begin(), fastest.end()) >
        1.3f * *std::max_element(fastest_at_first.begin(), fastest_at_first.end()));
}

TEST_CASE("the same exercise moves the same way, and both legs move by themselves") {
  const JointAngles posture_rad{};
  ExerciseState a, b;
  bool differs = false;
  for (int tick = 0; tick < 3'000; ++tick) {
    const JointAngles one = step_exercise(posture_rad, 5.0f, 1e-3f, a),
                      two = step_exercise(posture_rad, 5.0f, 1e-3f, b);
    CHECK(one == two);
    differs = differs || std::abs(one[kKnee] - one[kLegJoints + kKnee]) > 0.05f;
  }
  CHECK(differs);
}
