// A recording that is of another machine than the others are.
#pragma once

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

/// The recording that disagrees with the others most, if one does grossly: with a set fitted on the others alone, runs leave far more of its
/// motion (by NMSE: core::odd_one) and far more than noise, though it was driven, and moved, as they were: one that was driven otherwise
/// may show what they do not. Of at least five recordings.
///
/// `sets`: what was chosen, and others that were tried. A cause may have been chosen to account for the odd recording; so another set
/// counts, too, if without the odd recording it leaves less than 0.3 of what the chosen one leaves of the others.
std::optional<Disagreement> disagreeing(const std::vector<FittedSet>& sets,
                                        const std::vector<Recording>& recordings,
                                        const std::vector<Window>& windows);

/// The same of held-out recordings beside those that were fitted, which nothing is left out of: sentences that name them.
std::vector<std::string> disagreeing_held_out(const model::Model& fitted,
                                              const std::vector<Recording>& training,
                                              const std::vector<Recording>& held_out,
                                              const std::vector<Window>& of_training,
                                              const std::vector<Window>& of_held_out);

}  // namespace furcula::identify
