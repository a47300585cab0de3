// Recordings that tell most: Fourier series whose coefficients an evolution strategy chooses by the engine's own information matrix.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "host/excite/motion.hpp"
#include "host/excite/subjects.hpp"

namespace furcula::excite {

/// Which subjects count.
enum class About : std::uint8_t { all, free, causes };

/// Of the covariance of all subjects in units of their sizes, with what is known beforehand: the determinant, or the trace (Pukelsheim, Optimal
/// Design of Experiments, 1993, sections 6.2 and 6.5).
enum class Criterion : std::uint8_t { d, a };

struct Options {
  double duration_s = 10.0, rate_hz = 250.0, highest_hz = 2.5, window_s = 0.3;
  std::size_t recordings = 3;
  std::size_t evaluations = 600;  ///< of the criterion, each recording
  std::uint64_t seed = 1;
  unsigned threads = 1;
  Criterion criterion = Criterion::d;
  About about = About::all;
  std::function<void(double, std::string_view)> progress{};
};

struct Design {
  std::vector<trees::Scenario> scenarios;
  std::vector<Subject> subjects;  ///< all, whatever the search was for
  /// Geometric mean (D) or mean (A) of the standard deviations that are left, in units of the subjects' sizes: of random series, the
  /// median, and of the design; first recording.
  double of_random = 0.0, of_design = 0.0;
};

/// One recording after the other, each for what those before it leave open.
/// @throws core::DataError: too short a recording, no motion within the limits, and what easiest_posture() throws.
Design design(const trees::TreeModel& model, const std::vector<JointLimits>& limits, const Options& options);

}  // namespace furcula::excite
