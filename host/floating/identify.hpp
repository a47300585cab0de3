// All numbers of a walking robot from its recordings, with priors: what document 000, section IV identifies.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/floating/causes.hpp"

namespace furcula::floating {

/// A window as a machine predicts it: residuals as `residuals` gives them.
struct Predicted {
  Window window;
  Eigen::VectorXd residual;
};

/// Root mean squares over windows, measured less predicted, each window's start and the attitude filter's error fitted, no disturbance.
struct WindowErrors {
  std::size_t windows = 0;
  double angle_rad = 0.0, attitude_rad = 0.0, gyro_radps = 0.0;
  std::array<double, kRowSize> channels{};  ///< each number of a row by itself
  std::vector<Predicted> predicted;
};

struct IdentifyOptions {
  double window_s = 0.3;
  int iterations = 6;
  Settings settings;
  /// A robot that the fit begins at instead of the model, if it is likelier: what fewer recordings gave.
  std::optional<Machine> start;
  std::function<void(double fraction, const std::string& doing)> progress;
};

struct Identified {
  std::vector<Unknown> unknowns;
  /// Posterior mode and, of the last linearisation before it, standard deviation; in priors' standard deviations.
  Eigen::VectorXd theta, sd;
  Machine given, machine;  ///< the model; the robot at the mode
  std::vector<Cause> causes;
  bool all_numbers_deviate = false;  ///< as of Causes
  WindowErrors before, after;
  int iterations = 0;
};

/// identification.json, `furcula-walk-identification/1` (docs/contracts.md).
std::string to_json_text(const Identified& found, const WindowErrors* held_out_before,
                         const WindowErrors* held_out_after);

/// Whether the hips' pitch is on its springs rather than on its drives: what the windows are likelier with.
bool passive_hips(const Machine& model, const Recording& recording, const IdentifyOptions& options);

/// The ground and the ramp of dry friction are the simulation's own, and are sought first. Gauss and Newton's method, damped; robust against
/// windows that no parameter explains. @throws core::DataError where no window can be used.
Identified identify(const Machine& model, const std::vector<Recording>& recordings,
                    const IdentifyOptions& options);

/// How well a machine predicts windows that it may not have been fitted to.
WindowErrors window_errors(const Machine& machine, const std::vector<Recording>& recordings,
                           const IdentifyOptions& options);

}  // namespace furcula::floating
