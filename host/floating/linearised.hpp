// Windows linearised about a machine and their own unknowns: y = A theta + C x + noise, where theta are the machine's deviations from the
// model in units of their prior standard deviations, and x a window's own unknowns in their units.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <span>
#include <vector>

#include "host/floating/simulate.hpp"

namespace furcula::floating {

/// One window's own unknowns.
using Local = Eigen::Matrix<double, static_cast<int>(kLocals), 1>;

/// Residuals of every run, a column each.
Eigen::MatrixXd residuals(const Recording& recording, const Window& window, std::span<const Variant> variants,
                          double step_s);

/// Kinds of a window's unknowns; those of one kind have one variance.
enum LocalGroup : int {
  kHeight,
  kTilt,
  kAngularVelocity,
  kVelocity,
  kAngle,
  kRate,
  kAnchor,
  kAnchorYaw,
  kTorque,
  kForceAcross,
  kForceUp,
  kMomentAcross,
  kMomentUp,
  kFilter,
  kFilterRate,
  kFilterCurve,
  kLocalGroups
};
LocalGroup group_of(std::size_t local);
/// Standard deviations of their priors: what encoders, IMU and a foot on the ground leave open; disturbances of a few N m and N
/// (docs/decisions/0042-walking-robot-windows.md).
inline constexpr std::array<double, kLocalGroups> kLocalSd{1e-3, 3e-2, 5e-2, 8e-2, 5e-4, 1e-1, 2e-3, 5e-3,
                                                           1.0,  15.0, 15.0, 3.0,  3.0,  3e-2, 6e-2, 2e-1};

enum NoiseGroup : int { kAngleNoise, kAttitudeNoise, kGyroNoise, kNoiseGroups };
constexpr NoiseGroup noise_of(std::size_t channel) {
  return channel < kJoints ? kAngleNoise : channel < kJoints + 3 ? kAttitudeNoise : kGyroNoise;
}

struct Variances {
  std::array<double, kNoiseGroups> noise{};
  std::array<double, kLocalGroups> local{};  ///< 0: there is no such unknown
};
Variances first_variances();

struct Settings {
  double step_s = 1e-3;
  unsigned threads = 2;
};

struct LinearWindow {
  std::vector<std::size_t>
      locals;  ///< those that this window has: no wrench at a foot in the air, none of variance 0
  Eigen::VectorXd y;
  Eigen::MatrixXd a, c;  ///< rows by theta, rows by `locals`
};

/// A machine with its deviations.
struct Point {
  Machine machine;
  Eigen::VectorXd theta;      ///< per unknown, in prior standard deviations
  std::vector<Local> locals;  ///< per window
};

/// Where such a machine cannot be, the nearest that can, and its theta.
Point at(const Machine& model, const std::vector<Unknown>& unknowns, const Eigen::VectorXd& theta,
         const std::vector<Local>& locals);

/// A window in its own unknowns alone.
LinearWindow linearised(const Recording& recording, const Window& window, const Variances& variances,
                        const Machine& machine, const Plant& plant, const Local& local, double step_s);

/// Adds the machine's derivatives to windows linearised in their own unknowns.
void linearise_machine(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                       const std::vector<Unknown>& unknowns, const Point& point, const Settings& settings,
                       std::vector<LinearWindow>& linear);

std::vector<LinearWindow> linearised(const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows, const Variances& variances,
                                     const std::vector<Unknown>& unknowns, const Point& point,
                                     const Settings& settings);

}  // namespace furcula::floating
