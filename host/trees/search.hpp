// The search for causes on a tree: a linear score test over all effects and sites proposes, fits by simulation decide.
//
// 1. At the present hypothesis every candidate is probed by simulation. What the probes leave of the residuals, with everything that is
//    fitted already and the windows' starts eliminated, is a linear problem: it is solved greedily, one candidate at a time, and again
//    without each recording in turn.
// 2. What was picked is fitted together by simulation, and what does not hold is dropped.
// 3. Where torque is still missing then, a second search begins with another cause; the better end counts.
// 4. Where torque is still missing, or the search did not come to its end, another begins with the common laws at every joint.
// 5. At the end each cause is left out once, and the others in its place are fitted: what does as well cannot be told from it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/trees/candidates.hpp"

namespace furcula::trees {

/// What a candidate gains that the recordings do not agree on, of the loss: from then on something is missing.
inline constexpr double kDisputed = 0.05;
/// So much of the torque that could be predictable before is no remainder.
inline constexpr double kOfBefore = 0.1;

/// From these odds on a cause is told from another: twenty to one, natural logarithm.
inline constexpr double kOdds = 3.0;
/// Where something else is missing, both are wrong: then by two standard deviations of their windows' difference (Vuong, Econometrica
/// 57(2), 1989), of which twice the square is the logarithm of the odds.
inline constexpr double kOddsOfWrong = 8.0;

/// Another cause in the place of a finding.
struct Rival {
  std::vector<Cause> causes;
  Hypothesis at;             ///< with it, all else fitted again
  double log_odds = 0.0;     ///< of the finding against it, natural logarithm
  double told_from = kOdds;  ///< from such odds on
  /// It explains the recordings about as well.
  bool stands() const { return log_odds < told_from; }
};

struct Found {
  Fit fit;       ///< of the hypothesis with all causes
  Fit refitted;  ///< free parameters alone
  std::vector<double>
      gain;  ///< of each cause: loss without it, all else fitted again, less that with it, over the latter
  std::vector<std::vector<Rival>> rivals;  ///< of each cause
  std::size_t tried = 0;                   ///< candidates
  struct Tried {
    Cause cause;
    double gain;  ///< share of the residuals that it would remove, by the linear test at the model re-fitted
  };
  std::vector<Tried> table;  ///< the best of the first round
  /// What a candidate would gain at the end that the windows are sure of, and the recordings do not agree on: of the loss.
  double disputed = 0.0;
  std::optional<Hypothesis> common;  ///< with the common laws alone, where a search began with them
  bool ended_early = false;          ///< it had not come to its end after much work
  bool unjudged = false;             ///< nor had the comparison of what it found with other causes
};

using Progress =
    std::function<void(double, std::string_view)>;  ///< share that is done, and what is being done

/// A search, one that begins with the common laws, and judging what was found end after so many times the steps of integration that led to the
/// first point. Chosen by what it takes at most: about as long as 20 did when each run of a derivative went by itself.
inline constexpr std::size_t kMostWork = 60;

/// `coarse`, the same recordings in short windows, is used where the model as given is grossly wrong; it may be null.
Found search(Problem& problem, Problem* coarse, const Progress& progress, std::size_t most_work = kMostWork);

}  // namespace furcula::trees
