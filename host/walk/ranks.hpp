// A search on several processes, by MPI: rank 0 seeks, every rank runs its share of each generation.
//
// The walk that is found is that of one process: a walk hangs on no other, and shares are put together by number.
#pragma once

#include <functional>
#include <vector>

#include "host/walk/search.hpp"

namespace furcula::walk {

class Ranks {
 public:
  /// Begins MPI. One of them a process.
  Ranks();
  /// Rank 0 lets the others end. Ends MPI, unless a generation was given up.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }

  /// Of a rank above 0: runs the shares that rank 0 sends, until it sends no more.
  void serve() const;

  /// Of rank 0: lets the ranks run a search's generations. While a rank does not answer `options.interrupted` is asked; where it says
  /// so the generation is given up, for who is waited for may be dead.
  void run_for(const dynamics::biped::Description& robot, SearchOptions& options);

 private:
  bool finished(void* requests, int count, const std::function<bool()>& interrupted) const;

  int rank_ = 0, count_ = 1;
  bool given_up_ = false;
  // Of a generation, a rank above 0 each. They stay where it was given up: MPI may still write there.
  std::vector<std::vector<Job>> sent_;
  std::vector<std::vector<Rollout>> received_;
  std::vector<double> took_cpu_s_;
  double others_cpu_s_ = 0.0;
};

}  // namespace furcula::walk
