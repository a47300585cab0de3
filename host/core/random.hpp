// Seeded random numbers whose sequence is the same with every compiler and library.
#pragma once

#include <cmath>
#include <cstdint>

namespace furcula::core {

/// SplitMix64. Every use has its own stream, so that switching one sensor's error on or off does not change
/// another's draws.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : state_(seed + 0x632be59bd9b4e019u * (stream + 1)) {
    next();
  }

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  bool coin() { return (next() >> 63) != 0; }

  /// Uniform in [lower, upper).
  double uniform(double lower, double upper) {
    return lower + (upper - lower) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }

  /// Gaussian of mean 0 and standard deviation 1 (polar method: only sqrt and log).
  double gaussian() {
    for (;;) {
      const double x = uniform(-1.0, 1.0);
      const double y = uniform(-1.0, 1.0);
      const double s = x * x + y * y;
      if (s > 0.0 && s < 1.0) return x * std::sqrt(-2.0 * std::log(s) / s);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace furcula::core
