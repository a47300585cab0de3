#include "host/walk/search.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>

#include "host/core/message.hpp"
#include "host/core/parallel.hpp"
#include "host/walk/cma_es.hpp"
#include "host/walk/lanes.hpp"
#include "host/walk/walkers.hpp"

namespace furcula::walk {
namespace {

constexpr std::size_t kFirstPopulation = 32;
constexpr double kFirstSpread = 0.2, kNextSpread = 0.1;  // of a parameter's range
/// Converged: no better by so much in so many generations.
constexpr double kBetter = 1e-3;
constexpr std::uint64_t kPatience = 60;
constexpr std::size_t kMostKept = 64;  // bests to fall back on

using Vector = Eigen::VectorXd;

/// Between the walk's parameters and the search's coordinates: shares of their ranges from the start values, and only those that matter.
class Space {
 public:
  explicit Space(WalkMode mode) {
    for (std::size_t i = 0; i < control::kWalkParameters.size(); ++i)
      if (mode == WalkMode::active || !control::kWalkParameters[i].of_hip_pitch) used_.push_back(i);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(used_.size()); }

  /// Inside the ranges.
  Parameters walk(const Vector& x) const {
    std::array<double, Parameters::kCount> values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = control::kWalkParameters[i].start;
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const auto& p = control::kWalkParameters[used_[k]];
      values[used_[k]] = std::clamp(value(x, k), p.least, p.most);
    }
    return Parameters::of(values);
  }
  /// What lies outside of them, squared, in shares.
  double outside(const Vector& x) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const auto& p = control::kWalkParameters[used_[k]];
      const double v = value(x, k), by = std::max({0.0, p.least - v, v - p.most}) / (p.most - p.least);
      sum += by * by;
    }
    return sum;
  }
  Vector at(const Parameters& walk) const {
    const auto values = walk.values();
    Vector x(size());
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const auto& p = control::kWalkParameters[used_[k]];
      x(static_cast<Eigen::Index>(k)) = (values[used_[k]] - p.start) / (p.most - p.least);
    }
    return x;
  }

 private:
  double value(const Vector& x, std::size_t k) const {
    const auto& p = control::kWalkParameters[used_[k]];
    return p.start + x(static_cast<Eigen::Index>(k)) * (p.most - p.least);
  }
  std::vector<std::size_t> used_;
};

double cpu_now_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::string doing(const Rollout& r, double time_s) {
  const auto text = [](double v) { return core::rounded(v, 3); };
  if (r.ending != Ending::stands)
    return std::string(kEndingNames[static_cast<std::size_t>(r.ending)]) + " after " + text(r.time_s) + " s";
  if (r.over > 0.0) return "stands, limits missed by " + text(100.0 * r.over) + " %";
  return "objective " + text(r.objective(time_s)) + ", CoT " + text(r.cot) + ", " + text(r.distance_m) + " m";
}

}  // namespace

std::vector<Rollout> run_walks(const dynamics::biped::Description& robot, const RolloutOptions& options,
                               const std::vector<Parameters>& walks, unsigned threads) {
  std::vector<Rollout> out(walks.size());
  std::atomic<std::size_t> next{0};
  const unsigned used = std::max(1u, threads);
  core::parallel_for(used, used, [&](std::size_t) { run_lanes(robot, options, walks, next, out); });
  return out;
}

Rollout run_walk(const dynamics::biped::Description& robot, const RolloutOptions& options,
                 const Parameters& walk) {
  return Walkers<double>(robot, robot, options).run_one(walk);
}

SearchResult search_walk(const dynamics::biped::Description& robot, const SearchOptions& options) {
  const Space space(options.rollout.mode);
  const double asked_s = options.rollout.time_s, cpu_begin = cpu_now_s();
  const auto begin = std::chrono::steady_clock::now();
  SearchResult out;
  // The bests so far, the last the best: float may keep a limit that double misses by a hair.
  std::vector<Parameters> bests;
  Rollout best;
  best.time_s = 0.0;
  double best_value = std::numeric_limits<double>::infinity();

  std::size_t population = kFirstPopulation;
  CmaEs strategy(Vector::Zero(space.size()), kFirstSpread, population, options.seed);
  double round_best = best_value, last_better = best_value;
  std::uint64_t waited = 0;
  const auto spent = [&] {
    double share = 0.0;
    if (options.seconds)
      share =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / *options.seconds;
    if (options.steps)
      share = std::max(share, static_cast<double>(out.steps) / static_cast<double>(*options.steps));
    return share;
  };
  for (double share = 0.0; share < 1.0; share = spent()) {
    if (options.progress) options.progress(share, doing(best, asked_s));
    const std::vector<Vector>& points = strategy.ask();
    std::vector<Parameters> walks;
    for (const Vector& x : points) walks.push_back(space.walk(x));
    const std::vector<Rollout> rollouts = run_walks(robot, options.rollout, walks, options.threads);
    std::vector<double> values;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      const Rollout& r = rollouts[i];
      out.steps += r.steps;
      ++out.rollouts;
      const double value = r.objective(asked_s);
      values.push_back(r.value(asked_s) + space.outside(points[i]));
      round_best = std::min(round_best, values.back());
      const auto here = [&] {
        return SearchPoint{cpu_now_s() - cpu_begin, out.steps, out.rollouts, value, r.cot};
      };
      if (!out.first_walk && r.keeps_limits() && r.distance_m >= options.first_walk_m)
        out.first_walk = here();
      if (!(value < best_value)) continue;
      best_value = value;
      best = r;
      out.history.push_back(here());
      if (bests.size() == kMostKept) bests.erase(bests.begin());
      bests.push_back(walks[i]);
    }
    strategy.tell(values);
    if (round_best < last_better - kBetter) {
      last_better = round_best;
      waited = 0;
    } else if (++waited >= kPatience) {
      // About the best of all, a wider population; every second time from the start again.
      ++out.restarts;
      population += population / 4;
      const bool anew = out.restarts % 2 == 0;
      strategy = CmaEs(anew ? Vector(Vector::Zero(space.size())) : space.at(bests.back()),
                       anew ? kFirstSpread : kNextSpread, population,
                       options.seed + 0x9e3779b97f4a7c15u * out.restarts);
      round_best = last_better = std::numeric_limits<double>::infinity();
      waited = 0;
    }
  }
  for (std::size_t i = bests.size(); i-- > 0;) {
    const Rollout r = run_walk(robot, options.rollout, bests[i]);
    const bool walks = r.keeps_limits() && r.distance_m >= options.first_walk_m;
    if (i + 1 == bests.size() || walks) {
      out.walk = bests[i];
      out.rollout = r;
    }
    out.found = walks;
    if (walks) break;
  }
  out.cpu_s = cpu_now_s() - cpu_begin;
  return out;
}

}  // namespace furcula::walk
