// The parameters of a walk: 46 numbers, those that a search looks for (000 section III; docs/biped.md).
//
// Angles of roll are positive outwards: away from the other leg. Pitch is a rotation about the axis to the left: flexing
// a hip is negative, flexing a knee positive.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace furcula::control {

/// Targets of one leg's joints relative to the posture, rad.
template <class T>
struct LegTargets {
  T hip_pitch{},      ///< negative flexes
      knee{},         ///< positive flexes
      ankle_pitch{},  ///< positive lowers the toes
      hip_roll{},     ///< positive outwards
      ankle_roll{};   ///< positive in the same sense as hip_roll
};

/// The parameters of a walk. Names in files, ranges and starts of a search: kWalkParameters.
template <class T>
struct WalkParameters {
  static constexpr std::size_t kCount = 46,  ///< parameters
      kGains = 12;                           ///< gains among them

  // Posture, symmetric.
  T knee_rad{},     ///< angle of the knees
      hip_rad{},    ///< pitch of the hips is this less half of knee_rad
      ankle_rad{};  ///< pitch of the ankles is this less half of knee_rad
  // To begin with: sway to the left foot, lean forward.
  T start_s{},     ///< duration of the phase `start` and time in which its targets are reached
      sway_rad{},  ///< roll of hips and ankles that shifts the pelvis over the left foot
      lean_rad{};  ///< subtracted from the pitch of both ankles; positive leans forward
  // How long a foot goes up and down, and in what time the targets are reached.
  T up_s{},                ///< duration of the phase `up`
      up_blend_s{},        ///< in which its targets are reached
      down_s{},            ///< duration of the phase `down`, unless the foot touches down before
      down_blend_s{};      ///< in which its targets are reached
  LegTargets<T> up_swing,  ///< of the swing leg in `up`
      up_stance,           ///< of the stance leg in `up`
      down_swing,          ///< of the swing leg in `down`
      down_stance;         ///< of the stance leg in `down`
  /// Gains on d and v, position and velocity of the centre of mass ahead of the stance foot's ankle, and on y and vy,
  /// those towards the swing leg's side: for the swing hip's flexion (d, v), the stance ankle's pitch (d, v), the swing
  /// hip's roll (y, vy), the stance ankle's roll (y, vy), the stance hip's pitch (d, v) and roll (y, vy); rad/m and
  /// rad s/m.
  std::array<T, kGains> gains{};
  T side_m{};  ///< y at which its feedback is zero
  // To stand; d and v are relative to the middle of the ankles.
  T stop_blend_s{},     ///< in which the posture is reached
      stop_d_radpm{},   ///< gain of both ankles' pitch on d
      stop_v_radspm{};  ///< gain of both ankles' pitch on v

  /// Calls `f` with a reference to each parameter, in the order of kWalkParameters.
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
  /// All parameters, in the order of kWalkParameters.
  std::array<T, kCount> values() const {
    std::array<T, kCount> out;
    std::size_t n = 0;
    const_cast<WalkParameters*>(this)->each([&](T& x) { out[n++] = x; });
    return out;
  }
  /// From all parameters, in the order of kWalkParameters.
  static WalkParameters of(const std::array<T, kCount>& values) {
    WalkParameters out;
    std::size_t n = 0;
    out.each([&](T& x) { x = values[n++]; });
    return out;
  }
};

/// A row of the table of a walk's parameters.
struct WalkParameterInfo {
  std::string_view name;      ///< in files: table and key
  double least,               ///< lower bound of a search
      most,                   ///< upper bound of a search
      start;                  ///< where a search starts: steps on the spot, which fall
  bool of_hip_pitch = false;  ///< without effect where the hips' pitch is passive
};
/// The table, in the order of WalkParameters::each().
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
