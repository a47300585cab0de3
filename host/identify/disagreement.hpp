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

/// The recording that disagrees with the others most, if one does grossly: fitted on the others alone, the model leaves far more of its
/// motion (by NMSE, eight times the others' median and six standard deviations of theirs, robustly) and far more than noise, though it
/// was driven, and moved, as they were. Of at least five recordings; one that was driven otherwise may show what the others do not.
///
/// `model`, `unknowns`, `fit`: what was chosen on `windows`.
std::optional<Disagreement> disagreeing(const model::Model& model, const std::vector<Unknown>& unknowns,
                                        const Fit& fit, const std::vector<Recording>& recordings,
                                        const std::vector<Window>& windows);

/// The same of held-out recordings beside those that were fitted, which nothing is left out of: sentences that name them.
std::vector<std::string> disagreeing_held_out(const model::Model& fitted,
                                              const std::vector<Recording>& training,
                                              const std::vector<Recording>& held_out,
                                              const std::vector<Window>& of_training,
                                              const std::vector<Window>& of_held_out);

}  // namespace furcula::identify
