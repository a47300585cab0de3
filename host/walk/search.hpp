// The search for a walk, without a first guess from steps on the spot that fall, by one of several methods (method.hpp).
//
// One seed gives one result on any number of threads, if the budget is of steps, and however often the search was interrupted.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/member.hpp"
#include "host/walk/method.hpp"
#include "host/walk/rollout.hpp"
#include "host/walk/trace.hpp"

namespace furcula::walk {

/// Whole walks, on several threads; results by number.
std::vector<Rollout> run_walks(const dynamics::biped::Description& robot, const RolloutOptions& options,
                               const std::vector<Parameters>& walks, unsigned threads);

/// Jobs of the members of an ensemble that has the controller of `robot`, likewise; with one step a tick: what a longer step changes is
/// little beside how the members deviate.
std::vector<Rollout> run_jobs(const dynamics::biped::Description& robot, const std::vector<Member>& ensemble,
                              const RolloutOptions& options, const std::vector<Job>& jobs, unsigned threads);

/// The same with what each robot measures, every `row_s`, a whole number of ticks.
std::vector<Trace> traces(const dynamics::biped::Description& robot, const std::vector<Member>& ensemble,
                          const RolloutOptions& options, const std::vector<Job>& jobs, double row_s,
                          unsigned threads);

/// One walk in double.
Rollout run_walk(const dynamics::biped::Description& robot, const RolloutOptions& options,
                 const Parameters& walk);

struct SearchPoint {
  double cpu_s = 0.0;
  std::uint64_t steps = 0, rollouts = 0;
  double objective = 0.0;  ///< of a robust search, over the robot and its ensemble
  double cot = 0.0;        ///< infinite where it does not get ahead
};

/// All that a search goes on from, between two generations.
struct SearchState {
  std::uint64_t steps = 0, rollouts = 0;
  std::uint64_t not_finite = 0;  ///< rollouts whose objective was no number
  double cpu_s = 0.0;            ///< of all threads
  double seconds = 0.0;          ///< of wall time
  std::optional<SearchPoint> first_walk;
  /// Whenever the best got better, in float; of a robust search from when it asks the ensemble.
  std::vector<SearchPoint> history;
  /// The bests so far, the last the best: float may keep a limit that double misses by a hair.
  std::vector<Parameters> bests;
  std::string method;  ///< Method::state
  /// Of a robust search, once it asks the ensemble: the walk that it began with then.
  std::optional<Parameters> robust_start;
};

struct SearchOptions {
  RolloutOptions rollout;
  MethodKind method = MethodKind::cmaes;
  std::uint64_t seed = 1;
  /// Robots that the walk has to stand on, too: a robust search. Without `start` the first third of its budget is a search for a walk on the
  /// robot alone, which the rest begins with: from steps on the spot, steps on the spot stand on all. The value of a walk that stands on the robot itself is then the mean over
  /// the robot and all of these.
  std::vector<Member> ensemble;
  /// Where it begins; without it with steps on the spot, which fall.
  std::optional<Parameters> start;
  // The whole search's, with what was done before an interruption.
  std::optional<double> seconds;       ///< of wall time
  std::optional<std::uint64_t> steps;  ///< of simulation, of all walks together
  unsigned threads = 1;
  /// A walk that gets this far counts as the first one, m.
  double first_walk_m = 0.1;
  std::function<void(double fraction, const std::string& doing)> progress;

  /// Where it goes on.
  std::optional<SearchState> from;
  /// Asked between two generations: whether to end now.
  std::function<bool()> interrupted;
  /// Gets the state every `keep_every_s` of wall time, and at the end.
  std::function<void(const SearchState&)> keep;
  double keep_every_s = 10.0;
  /// Runs jobs, of member 0 on the robot and of member k on ensemble[k - 1]; without it threads do. Nothing: they were given up, and the
  /// search ends as interrupted.
  std::function<std::vector<Rollout>(const std::vector<Job>&)> run;
  /// Processor time that `run` has taken in other processes so far, s.
  std::function<double()> cpu_elsewhere_s;
};

struct SearchResult {
  bool found = false;        ///< a walk that keeps all limits, in double too
  bool interrupted = false;  ///< before its budget was spent
  Parameters walk;           ///< the best; where none is found the one that came nearest
  Rollout rollout;           ///< in double
  unsigned restarts = 0;
  SearchState state;  ///< at the end
};

/// @throws core::DataError where options.from holds no state of the method.
SearchResult search_walk(const dynamics::biped::Description& robot, const SearchOptions& options);

}  // namespace furcula::walk
