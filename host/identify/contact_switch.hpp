// Whether a hopper's contact switch and its height agree on when the foot is on the ground.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/identify/recording.hpp"

namespace furcula::identify {

/// A switch reports a touchdown at most this late (or early). What is later belongs to no delay of a sensor.
inline constexpr double kLongestReportDelay_s = 0.06;

/// Phases (flights and stances, by the measured height) of all recordings, and those that the switch contradicts.
struct SwitchAgreement {
  std::size_t phases = 0;  ///< longer than kLongestReportDelay_s
  std::size_t contradicted =
      0;  ///< in which the switch says the opposite for longer than kLongestReportDelay_s on end
  double longest_s = 0.0;  ///< contradiction
  std::string longest_in;  ///< the recording of it

  /// One contradiction may be a glitch. A second one is the machine's.
  bool is_refuted() const { return contradicted >= 2; }
};

/// `height_m`: at which the straight leg touches down. Rows within 3 mm of the touchdown height, or within the noise, count as neither phase.
SwitchAgreement switch_agreement(const std::vector<Recording>& recordings, double height_m);

/// "the contact switch contradicts the measured height in 12 of 96 flights and stances, for up to 0.08 s (run03.csv)".
std::string in_words(const SwitchAgreement& agreement);

}  // namespace furcula::identify
