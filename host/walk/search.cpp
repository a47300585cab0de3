#include "host/walk/search.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <limits>
#include <memory>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/parallel.hpp"
#include "host/walk/batched_rollout.hpp"
#include "host/walk/lanes.hpp"

namespace furcula::walk {
namespace {

constexpr std::size_t kMostKept = 64;  // bests to fall back on

using Vector = Eigen::VectorXd;

/// Between the walk's parameters and the search's coordinates: shares of their ranges from the start, and only those that matter.
class Space {
 public:
  Space(WalkMode mode, const std::optional<Parameters>& start) {
    for (std::size_t i = 0; i < start_.size(); ++i) start_[i] = control::kWalkParameters[i].start;
    if (start) start_ = start->values();
    for (std::size_t i = 0; i < control::kWalkParameters.size(); ++i)
      if (mode == WalkMode::active || !control::kWalkParameters[i].of_hip_pitch) used_.push_back(i);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(used_.size()); }

  /// Inside the ranges.
  Parameters walk(const Vector& x) const {
    auto values = start_;
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
  /// The ranges' lower and upper ends.
  Vector least() const { return end(&control::WalkParameterInfo::least); }
  Vector most() const { return end(&control::WalkParameterInfo::most); }

  Vector at(const Parameters& walk) const {
    const auto values = walk.values();
    Vector x(size());
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const auto& p = control::kWalkParameters[used_[k]];
      x(static_cast<Eigen::Index>(k)) = (values[used_[k]] - start_[used_[k]]) / (p.most - p.least);
    }
    return x;
  }

 private:
  double value(const Vector& x, std::size_t k) const {
    const auto& p = control::kWalkParameters[used_[k]];
    return start_[used_[k]] + x(static_cast<Eigen::Index>(k)) * (p.most - p.least);
  }
  Vector end(double control::WalkParameterInfo::*which) const {
    Vector x(size());
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const auto& p = control::kWalkParameters[used_[k]];
      x(static_cast<Eigen::Index>(k)) = (p.*which - start_[used_[k]]) / (p.most - p.least);
    }
    return x;
  }
  std::array<double, Parameters::kCount> start_;
  std::vector<std::size_t> used_;
};

/// With an ensemble one step a tick.
RolloutOptions of_ensemble(RolloutOptions options, const std::vector<Member>& ensemble) {
  if (!ensemble.empty()) options.step_s = options.tick_s(), options.steps_a_tick = 1;
  return options;
}

double cpu_now_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

std::vector<Rollout> run_walks(const dynamics::biped::Description& robot, const RolloutOptions& options,
                               const std::vector<Parameters>& walks, unsigned threads) {
  std::vector<Job> jobs;
  for (const Parameters& walk : walks) jobs.push_back({walk, 0});
  return run_jobs(robot, {}, options, jobs, threads);
}

std::vector<Rollout> run_jobs(const dynamics::biped::Description& robot, const std::vector<Member>& ensemble,
                              const RolloutOptions& options, const std::vector<Job>& jobs, unsigned threads) {
  std::vector<Rollout> out(jobs.size());
  std::atomic<std::size_t> next{0};
  const unsigned used = std::max(1u, threads);
  const RolloutOptions o = of_ensemble(options, ensemble);
  core::parallel_for(used, used, [&](std::size_t) { run_lanes(robot, ensemble, o, jobs, next, out); });
  return out;
}

std::vector<Trace> traces(const dynamics::biped::Description& robot, const std::vector<Member>& ensemble,
                          const RolloutOptions& options, const std::vector<Job>& jobs, double row_s,
                          unsigned threads) {
  std::vector<Trace> out(jobs.size());
  std::atomic<std::size_t> next{0};
  const unsigned used = std::max(1u, threads);
  const RolloutOptions o = of_ensemble(options, ensemble);
  const long ticks_a_row = std::max(1L, std::lround(row_s / o.tick_s()));
  core::parallel_for(used, used,
                     [&](std::size_t) { trace_lanes(robot, ensemble, o, jobs, next, ticks_a_row, out); });
  return out;
}

Rollout run_walk(const dynamics::biped::Description& robot, const RolloutOptions& options,
                 const Parameters& walk) {
  return BatchedRollout<double>(robot, robot, options).run_one(walk);
}

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

constexpr double kAlone = 1.0 / 3.0;  // of the budget

/// A walk on the robot and, in a robust search, on its ensemble.
struct Tried {
  Rollout rollout;       ///< on the robot
  double value = kNone;  ///< for the method to descend
  double objective = kNone;
  std::size_t stand = 0;  ///< members of the ensemble
};

/// A search as it goes on.
class Search {
 public:
  Search(const dynamics::biped::Description& robot, const SearchOptions& options)
      : robot_(robot),
        o_(options),
        space_(options.rollout.mode, start_of(options)),
        robust_(!options.ensemble.empty() && (options.start || (options.from && options.from->robust_start))),
        method_(make_method(options.method, space_.least(), space_.most(), options.seed)) {
    best_.rollout.time_s = 0.0;
    if (!o_.from) return;
    s_ = *o_.from;
    try {
      method_->restore(s_.method);
    } catch (const std::exception& e) {
      throw core::DataError(std::string("the checkpoint holds no state of its method: ") + e.what());
    }
    before_cpu_s_ = s_.cpu_s;
    before_s_ = s_.seconds;
    if (s_.bests.empty()) return;
    const std::uint64_t steps = s_.steps;  // this one was counted
    if (const auto best = tried({s_.bests.back()})) best_ = best->front();
    s_.steps = steps;
    best_.objective = s_.history.back().objective;
  }

  SearchResult run() {
    SearchResult out;
    if (o_.start && s_.rollouts == 0) begin();
    for (double share = spent(); share < 1.0; share = spent()) {
      if (o_.interrupted && o_.interrupted()) {
        out.interrupted = true;
        break;
      }
      if (o_.progress) o_.progress(share, doing());
      if (!robust_ && !o_.ensemble.empty() && share >= kAlone) ask_ensemble();
      if (!generation()) {
        out.interrupted = true;
        break;
      }
      if (o_.keep && wall_s() - kept_s_ >= o_.keep_every_s) keep();
    }
    if (o_.keep) keep();
    choose(out);
    update();
    out.restarts = method_->restarts();
    out.state = std::move(s_);
    return out;
  }

 private:
  static std::optional<Parameters> start_of(const SearchOptions& o) {
    return o.from && o.from->robust_start ? o.from->robust_start : o.start;
  }
  /// A walk to begin with is the best until another is better.
  void begin() {
    const Parameters walk = space_.walk(Vector::Zero(space_.size()));
    if (const auto begun = tried({walk})) took(walk, begun->front());
  }
  void ask_ensemble() {
    robust_ = true;
    s_.robust_start = s_.bests.empty() ? space_.walk(Vector::Zero(space_.size())) : s_.bests.back();
    space_ = Space(o_.rollout.mode, s_.robust_start);
    method_ = make_method(o_.method, space_.least(), space_.most(), o_.seed);
    best_ = {};
    best_.rollout.time_s = 0.0;
    s_.bests.clear();
    s_.history.clear();
    begin();
  }
  double wall_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  double cpu_s() const {
    return before_cpu_s_ + cpu_now_s() - cpu_begin_s_ + (o_.cpu_elsewhere_s ? o_.cpu_elsewhere_s() : 0.0);
  }

  double spent() const {
    double share = 0.0;
    if (o_.seconds) share = (before_s_ + wall_s()) / *o_.seconds;
    if (o_.steps) share = std::max(share, static_cast<double>(s_.steps) / static_cast<double>(*o_.steps));
    return share;
  }

  std::string doing() const {
    const auto text = [](double v) { return core::rounded(v, 3); };
    const Rollout& r = best_.rollout;
    if (r.ending != Ending::stands)
      return std::string(kEndingNames[static_cast<std::size_t>(r.ending)]) + " after " + text(r.time_s) +
             " s";
    const std::string on = !robust_ ? ""
                                    : ", stands on " + std::to_string(best_.stand) + " of " +
                                          std::to_string(o_.ensemble.size()) + " other robots";
    if (r.over > 0.0) return "stands, limits missed by " + text(100.0 * r.over) + " %" + on;
    return "objective " + text(best_.objective) + ", CoT " + text(r.cot) + ", " + text(r.distance_m) + " m" +
           on;
  }

  std::vector<Rollout> run(const std::vector<Job>& jobs, bool is_ensemble) const {
    if (o_.run) return o_.run(jobs);
    if (!is_ensemble) return run_jobs(robot_, {}, o_.rollout, jobs, o_.threads);
    std::vector<Job> others = jobs;
    for (Job& job : others) --job.member;
    return run_jobs(robot_, o_.ensemble, o_.rollout, others, o_.threads);
  }

  /// Nothing: they were given up.
  std::optional<std::vector<Tried>> tried(const std::vector<Parameters>& walks) {
    std::vector<Job> jobs;
    for (const Parameters& walk : walks) jobs.push_back({walk, 0});
    const std::vector<Rollout> alone = run(jobs, false);
    if (alone.size() != jobs.size()) return {};
    std::vector<Tried> out(walks.size());
    jobs.clear();
    std::uint64_t steps = 0;         // a generation that was given up is done again, and not counted
    std::vector<std::size_t> stand;  // on the robot itself
    for (std::size_t i = 0; i < walks.size(); ++i) {
      out[i] = {alone[i], alone[i].value(asked_s_), alone[i].objective(asked_s_), 0};
      steps += alone[i].steps;
      if (!robust_ || alone[i].ending != Ending::stands) continue;
      stand.push_back(i);
      for (std::size_t k = 1; k <= o_.ensemble.size(); ++k) jobs.push_back({walks[i], k});
    }
    const std::vector<Rollout> others = jobs.empty() ? std::vector<Rollout>{} : run(jobs, true);
    if (others.size() != jobs.size()) return {};
    for (std::size_t n = 0; n < stand.size(); ++n) {
      Tried& t = out[stand[n]];
      double sum = t.value;
      for (std::size_t k = 0; k < o_.ensemble.size(); ++k) {
        const Rollout& r = others[n * o_.ensemble.size() + k];
        steps += r.steps;
        if (r.ending == Ending::stands) ++t.stand;
        sum += r.value(asked_s_);
      }
      t.value = sum / static_cast<double>(o_.ensemble.size() + 1);
      // Beyond a limit on the robot itself it is above 1, as without an ensemble.
      t.objective = t.rollout.over > 0.0 ? std::max(t.objective, t.value) : t.value;
    }
    s_.steps += steps;
    return out;
  }

  /// False: it was given up.
  bool generation() {
    const std::vector<Vector>& points = method_->ask();
    std::vector<Parameters> walks;
    for (const Vector& x : points) walks.push_back(space_.walk(x));
    const auto all = tried(walks);
    if (!all) return false;
    std::vector<double> values;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      const double value = (*all)[i].value + space_.outside(points[i]);
      values.push_back(std::isfinite(value) ? value : kNone);
      took(walks[i], (*all)[i]);
    }
    method_->tell(values,
                  s_.bests.empty() ? Vector(Vector::Zero(space_.size())) : space_.at(s_.bests.back()));
    return true;
  }

  /// A walk was simulated.
  void took(const Parameters& walk, const Tried& t) {
    ++s_.rollouts;
    if (!std::isfinite(t.objective)) {
      ++s_.not_finite;
      return;
    }
    const Rollout& r = t.rollout;
    const SearchPoint here{cpu_s(), s_.steps, s_.rollouts, t.objective, r.cot};
    if (!s_.first_walk && r.keeps_limits() && r.distance_m >= o_.first_walk_m) s_.first_walk = here;
    if (!(t.objective < best_.objective)) return;
    best_ = t;
    s_.history.push_back(here);
    if (s_.bests.size() == kMostKept) s_.bests.erase(s_.bests.begin());
    s_.bests.push_back(walk);
  }

  void update() {
    s_.cpu_s = cpu_s();
    s_.seconds = before_s_ + wall_s();
    s_.method = method_->state();
  }
  void keep() {
    update();
    o_.keep(s_);
    kept_s_ = wall_s();
  }

  /// The best in double, or the best before it that keeps there what it kept in float.
  void choose(SearchResult& out) const {
    if (s_.bests.empty()) {
      out.walk = space_.walk(Vector::Zero(space_.size()));
      out.rollout = run_walk(robot_, o_.rollout, out.walk);
    }
    for (std::size_t i = s_.bests.size(); i-- > 0;) {
      const Rollout r = run_walk(robot_, o_.rollout, s_.bests[i]);
      const bool walks = r.keeps_limits() && r.distance_m >= o_.first_walk_m;
      if (i + 1 == s_.bests.size() || walks) {
        out.walk = s_.bests[i];
        out.rollout = r;
      }
      out.found = walks;
      if (walks) break;
    }
  }

  const dynamics::biped::Description& robot_;
  const SearchOptions& o_;
  Space space_;
  bool robust_;  ///< whether the ensemble is asked
  std::unique_ptr<Method> method_;
  const double asked_s_ = o_.rollout.time_s, cpu_begin_s_ = cpu_now_s();
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double before_cpu_s_ = 0.0, before_s_ = 0.0, kept_s_ = 0.0;
  SearchState s_;
  Tried best_;
};

}  // namespace

SearchResult search_walk(const dynamics::biped::Description& robot, const SearchOptions& options) {
  return Search(robot, options).run();
}

}  // namespace furcula::walk
