// What one joint of a tree is made to do in a scenario.
#pragma once

namespace furcula::trees {

/// centre + amplitude sin(2 pi t / period + phase); of `steps` its sign alone. A sine starts from rest within half a second.
struct Path {
  enum class Profile { hold, sine, steps } profile = Profile::sine;
  double centre_rad = 0.0, amplitude_rad = 0.0, period_s = 2.0, phase_rad = 0.0;

  /// Position, velocity and acceleration.
  struct Point {
    double q, v, a;
  };
  Point at(double time_s) const;
};

}  // namespace furcula::trees
