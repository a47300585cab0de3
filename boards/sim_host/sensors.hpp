// What is wrong with the simulated rig's sensors, and the encoders' figures.
#pragma once

#include <cmath>
#include <cstdint>

#include "host/core/random.hpp"

namespace furcula::sim_host {

/// Each is off unless switched on: then the sensors are ideal.
struct SensorErrors {
  bool quantisation = false;  ///< positions in whole counts
  bool noise = false;         ///< Gaussian, standard deviation one count
  bool bounce = false;        ///< the contact switch chatters after each change
  bool jitter = false;        ///< the contact switch reports up to 10 ms early or late
};

inline constexpr double kHeightCountM = 0.00009;  ///< 2000 counts/rev on 0.18 m a turn (002 chapter 4)
inline constexpr double kAxisCountM = 0.00001;    ///< a linear scale
inline constexpr double kJointCountRad = 6.283185307179586 / 8192;  ///< a 13-bit encoder
inline constexpr double kPulleyCountRad =
    6.283185307179586 / 2400;  ///< of the clutch bench (002 section 5.1)
/// The controller always reads whole counts; with quantisation off they are this small.
inline constexpr double kFineCountM = 1e-6;

/// A position sensor: noise, then counts.
class Encoder {
 public:
  Encoder(const SensorErrors& errors, double count, std::uint64_t seed)
      : quantised_(errors.quantisation), noisy_(errors.noise), count_(count), random_(seed, 1) {}

  double measure(double position) {
    if (noisy_) position += count_ * random_.gaussian();
    return quantised_ ? count_ * std::nearbyint(position / count_) : position;
  }

 private:
  bool quantised_, noisy_;
  double count_;
  core::Random random_;
};

}  // namespace furcula::sim_host
