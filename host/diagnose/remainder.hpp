// What a model leaves of recordings: how much of it the machine does not repeat, and how much a flexible law of the state foretells.
//
// Free runs from window to window, linearised: what a small force at any instant does to the positions after it. On these a Kalman
// filter with a random force (Ornstein-Uhlenbeck) and random impacts; their sizes are those under which the measured positions are
// likeliest. What it then finds new from row to row would be white, were nothing else missing; the flexible law is fitted to that.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/identify/windows.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

struct Remainder {
  std::string unit;  ///< of forces: "N" or "N m"
  double typical_force = 0.0;
  std::string typical_is;  ///< "the weight", "the input's root mean square" or "the usual inertia force"
  // Repeatability.
  double random_force = 0.0;  ///< root mean square, on the training recordings
  double random_force_held_out = 0.0;
  double correlation_s = 0.0;   ///< of it
  double impact_scatter = 0.0;  ///< standard deviation of the speed after an impact, as a share of it; hopper
  // The flexible law, learned on the training recordings, on the held-out ones.
  double foretold_force = 0.0;  ///< root mean square of what it adds
  double foretold_share =
      0.0;  ///< of the squares that free runs with their best start leave, what it takes off; below 0: it adds
  /// What it gains, in standard errors of that over the windows: by what the filter finds new, or by free runs.
  double deviations = 0.0;
  double foretold_noises =
      0.0;  ///< root mean square of what it changes in the positions of free runs, over the sensor's noise
  /// What windows' new finds share with the ones before, in standard deviations of chance: the largest of 20 lags.
  double correlation_of_new = 0.0;

  /// It takes off something that counts.
  bool is_structured() const;
  /// The machine repeats itself well enough to say that nothing is missing.
  bool repeats() const;
};

/// Windows as predictions are judged on. Nothing where the machine's runs jump (clutch bench) or nothing can be told.
std::optional<Remainder> remainder_of(const model::Model& fitted,
                                      const std::vector<identify::Recording>& training,
                                      const std::vector<identify::Window>& training_windows,
                                      const std::vector<identify::Recording>& held_out,
                                      const std::vector<identify::Window>& held_out_windows);

}  // namespace furcula::diagnose
