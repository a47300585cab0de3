// What a walk is made of: 46 numbers, those that a search looks for (000 section III; docs/biped.md).
//
// Angles of roll are outwards: away from the other leg. Pitch is positive forward: flexing a hip is negative, flexing a knee positive.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace furcula::control {

/// Of one leg's joints, beside the posture, rad.
template <class T>
struct LegTargets {
  T hip_pitch{}, knee{}, ankle_pitch{}, hip_roll{}, ankle_roll{};
};

template <class T>
struct WalkParameters {
  static constexpr std::size_t kCount = 46, kGains = 12;

  // Posture: the knee's angle, and what hip and ankle differ from half of it, the other way.
  T knee_rad{}, hip_rad{}, ankle_rad{};
  // To begin with: sway to the left foot, lean forward.
  T start_s{}, sway_rad{}, lean_rad{};
  // How long a foot goes up and down, and in what time the targets are reached.
  T up_s{}, up_blend_s{}, down_s{}, down_blend_s{};
  LegTargets<T> up_swing, up_stance, down_swing, down_stance;
  // On d and v, the centre of mass before the stance foot's ankle and its speed, and on y and vy, those to the swing leg's side: of the
  // swing hip's pitch (d, v), the stance ankle's pitch (d, v), the swing hip's roll (y, vy), the stance ankle's roll (y, vy), the stance
  // hip's pitch (d, v) and roll (y, vy); rad/m and rad s/m.
  std::array<T, kGains> gains{};
  T side_m{};  ///< of y, where its feedback is zero
  // To stand: the posture is reached in this time; both ankles' pitch on d and v, from the middle of the feet.
  T stop_blend_s{}, stop_d_radpm{}, stop_v_radspm{};

  /// All of them, in the order above.
  template <class F>
  void each(const F& f) {
    for (T* x : {&knee_rad, &hip_rad, &ankle_rad, &start_s, &sway_rad, &lean_rad, &up_s, &up_blend_s, &down_s,
                 &down_blend_s})
      f(*x);
    for (LegTargets<T>* t : {&up_swing, &up_stance, &down_swing, &down_stance})
      for (T* x : {&t->hip_pitch, &t->knee, &t->ankle_pitch, &t->hip_roll, &t->ankle_roll}) f(*x);
    for (T& x : gains) f(x);
    for (T* x : {&side_m, &stop_blend_s, &stop_d_radpm, &stop_v_radspm}) f(*x);
  }
  std::array<T, kCount> values() const {
    std::array<T, kCount> out;
    std::size_t n = 0;
    const_cast<WalkParameters*>(this)->each([&](T& x) { out[n++] = x; });
    return out;
  }
  static WalkParameters of(const std::array<T, kCount>& values) {
    WalkParameters out;
    std::size_t n = 0;
    out.each([&](T& x) { x = values[n++]; });
    return out;
  }
};

/// As `each` has them: name in files, the range in which a search looks and where it starts (steps on the spot, which fall), and whether the
/// pitch of the hips is concerned, which means nothing where these are passive.
struct WalkParameterInfo {
  std::string_view name;
  double least, most, start;
  bool of_hip_pitch = false;
};
inline constexpr std::array<WalkParameterInfo, WalkParameters<double>::kCount> kWalkParameters{{
    {"posture.knee_rad", 0.25, 0.8, 0.5},
    {"posture.hip_rad", -0.2, 0.2, 0.0, true},
    {"posture.ankle_rad", -0.15, 0.15, 0.0},
    {"start.time_s", 0.4, 1.2, 0.8},
    {"start.sway_rad", 0.0, 0.25, 0.12},
    {"start.lean_rad", -0.1, 0.1, 0.0},
    {"up.time_s", 0.15, 0.7, 0.3},
    {"up.blend_s", 0.15, 0.6, 0.3},
    {"down.time_s", 0.1, 0.6, 0.3},
    {"down.blend_s", 0.1, 0.6, 0.3},
    {"up.swing.hip_pitch_rad", -0.7, 0.3, -0.3, true},
    {"up.swing.knee_rad", 0.0, 0.9, 0.4},
    {"up.swing.ankle_pitch_rad", -0.5, 0.3, -0.1},
    {"up.swing.hip_roll_rad", -0.3, 0.3, 0.05},
    {"up.swing.ankle_roll_rad", -0.3, 0.3, 0.0},
    {"up.stance.hip_pitch_rad", -0.3, 0.3, 0.0, true},
    {"up.stance.knee_rad", -0.3, 0.3, 0.0},
    {"up.stance.ankle_pitch_rad", -0.3, 0.3, 0.0},
    {"up.stance.hip_roll_rad", -0.3, 0.3, -0.12},
    {"up.stance.ankle_roll_rad", -0.3, 0.3, 0.12},
    {"down.swing.hip_pitch_rad", -0.7, 0.3, 0.0, true},
    {"down.swing.knee_rad", -0.3, 0.5, 0.0},
    {"down.swing.ankle_pitch_rad", -0.3, 0.3, 0.0},
    {"down.swing.hip_roll_rad", -0.3, 0.3, 0.0},
    {"down.swing.ankle_roll_rad", -0.3, 0.3, 0.0},
    {"down.stance.hip_pitch_rad", -0.3, 0.3, 0.0, true},
    {"down.stance.knee_rad", -0.3, 0.3, 0.0},
    {"down.stance.ankle_pitch_rad", -0.3, 0.3, 0.0},
    {"down.stance.hip_roll_rad", -0.3, 0.3, -0.05},
    {"down.stance.ankle_roll_rad", -0.3, 0.3, 0.05},
    {"gain.swing_hip_pitch_d_radpm", -1.0, 3.0, 0.3, true},
    {"gain.swing_hip_pitch_v_radspm", -0.5, 1.0, 0.2, true},
    {"gain.stance_ankle_pitch_d_radpm", -1.0, 3.0, 0.3},
    {"gain.stance_ankle_pitch_v_radspm", -0.5, 1.0, 0.1},
    {"gain.swing_hip_roll_y_radpm", -1.0, 3.0, 0.3},
    {"gain.swing_hip_roll_vy_radspm", -0.5, 1.0, 0.2},
    {"gain.stance_ankle_roll_y_radpm", -3.0, 3.0, 0.0},
    {"gain.stance_ankle_roll_vy_radspm", -1.0, 1.0, 0.0},
    {"gain.stance_hip_pitch_d_radpm", -1.0, 1.0, 0.0, true},
    {"gain.stance_hip_pitch_v_radspm", -0.5, 0.5, 0.0, true},
    {"gain.stance_hip_roll_y_radpm", -1.0, 1.0, 0.0},
    {"gain.stance_hip_roll_vy_radspm", -0.5, 0.5, 0.0},
    {"gain.side_m", 0.04, 0.14, 0.09},
    {"stop.blend_s", 0.1, 1.0, 0.4},
    {"stop.ankle_pitch_d_radpm", -1.0, 3.0, 0.3},
    {"stop.ankle_pitch_v_radspm", -0.5, 1.0, 0.1},
}};

}  // namespace furcula::control
