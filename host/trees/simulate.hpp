// Simulated logs of a tree: paths that its drives are made to follow, a process that is disturbed, encoders that are not ideal.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/log.hpp"
#include "host/trees/model.hpp"
#include "host/trees/path.hpp"

namespace furcula::trees {

struct Scenario {
  double duration_s = 10.0, sample_rate_hz = 250.0;
  std::vector<Path> paths;  ///< of each joint
  /// A torque at each joint that nobody commands: random, with this root mean square as a share of the drive's, and this
  /// correlation time.
  double disturbance_share = 0.01, disturbance_time_s = 0.02;
  double angle_noise_rad = 2e-4, torque_noise_share = 0.01;
  /// Root mean square of disturbance and of the torque's noise, of each joint: in place of the shares. Empty: the shares count.
  std::vector<double> torque_noise_nm{};
};

/// Sines about the middle of the limits (of joints without, about 0), a fifth of the range at most, each joint its own period.
Scenario default_scenario(const TreeModel& model);

/// @throws core::DataError naming file, line and what was expected.
Scenario parse_scenario(std::string_view text, const std::string& name, const TreeModel& model);
Scenario read_scenario(const std::string& path, const TreeModel& model);

/// As a file that reads back the same, but for shares and the angles' noise: those are usual.
std::string format_scenario(const TreeModel& model, const Scenario& scenario);

/// Under the torque law a computer makes the joints follow their paths: inverse dynamics of the model without its causes, and a
/// spring and damper to the path, through the mass matrix. Under the position law the path is the set point. The same seed gives the same log.
/// @throws core::DataError: the motion is not finite (a drive that is too weak or a step that is too large).
log::Log simulate(const TreeModel& model, const Scenario& scenario, std::uint64_t seed);

}  // namespace furcula::trees
