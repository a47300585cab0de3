// The search for a walk without a first guess: CMA-ES over the parameters, from steps on the spot that fall, restarted where it has converged.
//
// One seed gives one result on any number of threads, if the budget is of steps.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// Whole walks, on several threads; results by number.
std::vector<Rollout> run_walks(const dynamics::biped::Description& robot, const RolloutOptions& options,
                               const std::vector<Parameters>& walks, unsigned threads);

/// One walk in double.
Rollout run_walk(const dynamics::biped::Description& robot, const RolloutOptions& options,
                 const Parameters& walk);

struct SearchPoint {
  double cpu_s = 0.0;
  std::uint64_t steps = 0, rollouts = 0;
  double objective = 0.0;
  double cot = 0.0;  ///< infinite where it does not get ahead
};

struct SearchOptions {
  RolloutOptions rollout;
  std::uint64_t seed = 1;
  std::optional<double> seconds;       ///< of wall time
  std::optional<std::uint64_t> steps;  ///< of simulation, of all walks together
  unsigned threads = 1;
  /// A walk that gets this far counts as the first one, m.
  double first_walk_m = 0.1;
  std::function<void(double fraction, const std::string& doing)> progress;
};

struct SearchResult {
  bool found = false;  ///< a walk that keeps all limits, in double too
  Parameters walk;     ///< the best; where none is found the one that came nearest
  Rollout rollout;     ///< in double
  std::optional<SearchPoint> first_walk;
  std::uint64_t steps = 0, rollouts = 0;
  unsigned restarts = 0;
  double cpu_s = 0.0;                ///< of all threads
  std::vector<SearchPoint> history;  ///< whenever the best got better; in float
};

SearchResult search_walk(const dynamics::biped::Description& robot, const SearchOptions& options);

}  // namespace furcula::walk
