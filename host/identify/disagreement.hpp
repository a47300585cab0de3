// A recording that is of another machine than the others are.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/identify/simulation_fit.hpp"

namespace furcula::identify {

struct Disagreement {
  std::size_t recording = 0;
  std::string why;  ///< a sentence about it, that goes on after its name
};

/// A set of causes that was fitted on the training windows.
struct FittedSet {
  model::Model model;
  const std::vector<Unknown>& unknowns;
  const Fit& fit;
};

/// Whether it is likelier that a recording is of another machine than that one machine made all: `without` is the fit of a set of `sets`
/// to the windows of the other recordings, in their order.
using LikelierOfAnother = std::function<bool(std::size_t set, std::size_t recording, const Fit& without)>;

/// The recording that disagrees with the others most, if one does grossly: with a set fitted on the others alone, runs leave far more of its
/// motion (by NMSE: core::outlier) and far more than noise, though it was driven, and moved, as they were: one that was driven otherwise
/// may show what they do not. Of at least five recordings. What a fit on the others leaves of it is no proof: they may not tell what it
/// shows. So `another` decides.
///
/// `sets`: what was chosen, and others that were tried: a cause may have been chosen to account for the odd recording.
std::optional<Disagreement> disagreeing(const std::vector<FittedSet>& sets,
                                        const std::vector<Recording>& recordings,
                                        const std::vector<Window>& windows, const LikelierOfAnother& another);

/// The same of held-out recordings beside those that were fitted, which nothing is left out of: sentences that name them.
std::vector<std::string> disagreeing_held_out(const model::Model& fitted,
                                              const std::vector<Recording>& training,
                                              const std::vector<Recording>& held_out,
                                              const std::vector<Window>& of_training,
                                              const std::vector<Window>& of_held_out);

}  // namespace furcula::identify
