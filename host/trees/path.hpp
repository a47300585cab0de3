// What one joint of a tree is made to do in a scenario.
#pragma once

#include <vector>

namespace furcula::trees {

/// Of a Fourier series: sine sin(2 pi number t / period) + cosine cos(2 pi number t / period).
struct Harmonic {
  double number = 1.0, sine_rad = 0.0, cosine_rad = 0.0;
};

/// centre + amplitude sin(2 pi t / period + phase); of `steps` its sign alone. A sine starts from rest within half a second.
/// Of `fourier`: centre + its harmonics; with a ramp from rest at the centre to rest at the centre, and there after end_s.
struct Path {
  enum class Profile { hold, sine, steps, fourier } profile = Profile::sine;
  double centre_rad = 0.0, amplitude_rad = 0.0, period_s = 2.0, phase_rad = 0.0;
  std::vector<Harmonic> harmonics{};
  double ramp_s = 0.0, end_s = 0.0;  ///< no ramp: 0

  /// Position, velocity and acceleration.
  struct Point {
    double q, v, a;
  };
  Point at(double time_s) const;
};

}  // namespace furcula::trees
