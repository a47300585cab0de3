// What a model leaves of recordings: how much of it the machine does not repeat, and how much a flexible law of the state predicts.
//
// Free runs from window to window, linearised: what a small force at any instant does to the positions after it. On these a Kalman
// filter with a random force (Ornstein-Uhlenbeck) and random impacts; their sizes are those under which the measured positions are
// likeliest. What it then finds new from row to row would be white, were nothing else missing; the flexible law is fitted to that.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/diagnose/predictable.hpp"
#include "host/diagnose/whiteness.hpp"
#include "host/identify/recording.hpp"
#include "host/identify/whitening.hpp"
#include "host/identify/windows.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

/// A filtered sensor's rows go along with the rows before by less than this.
inline constexpr double kColoured = 0.9;

struct Remainder {
  std::string unit;  ///< of forces: "N" or "N m"
  double typical_force = 0.0;
  std::string typical_is;  ///< "the weight", "the input's root mean square" or "the usual inertia force"
  // Repeatability.
  double random_force = 0.0;  ///< root mean square, on the training recordings
  double random_force_held_out = 0.0;
  double correlation_s = 0.0;   ///< of it
  double impact_scatter = 0.0;  ///< standard deviation of the speed after an impact, as a share of it; hopper
  Predictable crossed;          ///< on each training recording (or stretch), by what the others teach
  Predictable predictable;      ///< on the held-out recordings, by what all training recordings teach
  Whiteness new_finds;          ///< of what the filter finds new from row to row on the held-out recordings

  /// Of training and held-out recordings.
  double largest_random_force() const { return std::max(random_force, random_force_held_out); }

  /// On the held-out recordings; on the training recordings by themselves.
  bool is_structured() const { return predictable.counts(typical_force); }
  bool is_structured_in_training() const { return crossed.counts(typical_force); }
  /// What the filter finds new is nothing new: the sensor's noise is not noise.
  bool is_coloured() const { return std::abs(new_finds.correlation) > kColoured; }
  /// The machine repeats itself well enough to say that nothing is missing.
  bool repeats() const;
  bool repeats_in_training() const;
};

/// Of a machine that a random force and random impacts disturb: twice the logarithm of how much likelier its positions are with another model
/// than with `likely`, on rows that both reach. Nothing where one of them is stuck on rows on which the other is not, which a linearised run does not
/// weigh. The sizes of the disturbances are those under which the recordings are likeliest with `likely`. Empty where remainder_of() has nothing. The
/// recordings must outlive it.
using EvidenceFor = std::function<std::optional<double>(const model::Model& other)>;
EvidenceFor evidence_under_disturbances(const model::Model& likely,
                                        const std::vector<identify::Recording>& recordings,
                                        const std::vector<identify::Window>& windows);

/// Of each window, linearised about a run of this model, up to where it stands still (no rows where it does at once). The sizes of the disturbances are those
/// under which the recordings are likeliest with it. Nothing where remainder_of() has nothing.
std::optional<std::vector<identify::Whitening>> whitening_about(
    const model::Model& likely, const std::vector<identify::Recording>& recordings,
    const std::vector<identify::Window>& windows);

/// Windows as predictions are judged on; without held-out ones what is said of those stays zero. Nothing where the machine's runs jump (clutch bench) or nothing can be told.
std::optional<Remainder> remainder_of(const model::Model& fitted,
                                      const std::vector<identify::Recording>& training,
                                      const std::vector<identify::Window>& training_windows,
                                      const std::vector<identify::Recording>& held_out = {},
                                      const std::vector<identify::Window>& held_out_windows = {});

}  // namespace furcula::diagnose
