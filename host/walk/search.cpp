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
#include "host/walk/lanes.hpp"
#include "host/walk/walkers.hpp"

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

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// A search as it goes on.
class Search {
 public:
  Search(const dynamics::biped::Description& robot, const SearchOptions& options)
      : robot_(robot),
        o_(options),
        space_(options.rollout.mode, options.start),
        method_(make_method(options.method, space_.least(), space_.most(), options.seed)) {
    best_.time_s = 0.0;
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
    best_ = run_walks(robot_, o_.rollout, {s_.bests.back()}, 1).front();
    best_objective_ = s_.history.back().objective;
  }

  SearchResult run() {
    SearchResult out;
    // A walk to begin with is the best until another is better.
    if (o_.start && s_.rollouts == 0) {
      const Parameters walk = space_.walk(Vector::Zero(space_.size()));
      took(walk, run_walks(robot_, o_.rollout, {walk}, 1).front());
    }
    for (double share = spent(); share < 1.0; share = spent()) {
      if (o_.interrupted && o_.interrupted()) {
        out.interrupted = true;
        break;
      }
      if (o_.progress) o_.progress(share, doing(best_, asked_s_));
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

  /// False: it was given up.
  bool generation() {
    const std::vector<Vector>& points = method_->ask();
    std::vector<Parameters> walks;
    for (const Vector& x : points) walks.push_back(space_.walk(x));
    const std::vector<Rollout> rollouts =
        o_.run ? o_.run(walks) : run_walks(robot_, o_.rollout, walks, o_.threads);
    if (rollouts.size() != walks.size()) return false;
    std::vector<double> values;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      const double value = rollouts[i].value(asked_s_) + space_.outside(points[i]);
      values.push_back(std::isfinite(value) ? value : kNone);
      took(walks[i], rollouts[i]);
    }
    method_->tell(values,
                  s_.bests.empty() ? Vector(Vector::Zero(space_.size())) : space_.at(s_.bests.back()));
    return true;
  }

  /// A walk was simulated.
  void took(const Parameters& walk, const Rollout& r) {
    s_.steps += r.steps;
    ++s_.rollouts;
    const double objective = r.objective(asked_s_);
    if (!std::isfinite(objective)) {
      ++s_.not_finite;
      return;
    }
    const SearchPoint here{cpu_s(), s_.steps, s_.rollouts, objective, r.cot};
    if (!s_.first_walk && r.keeps_limits() && r.distance_m >= o_.first_walk_m) s_.first_walk = here;
    if (!(objective < best_objective_)) return;
    best_objective_ = objective;
    best_ = r;
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
  const Space space_;
  std::unique_ptr<Method> method_;
  const double asked_s_ = o_.rollout.time_s, cpu_begin_s_ = cpu_now_s();
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double before_cpu_s_ = 0.0, before_s_ = 0.0, kept_s_ = 0.0;
  SearchState s_;
  Rollout best_;
  double best_objective_ = kNone;
};

}  // namespace

SearchResult search_walk(const dynamics::biped::Description& robot, const SearchOptions& options) {
  return Search(robot, options).run();
}

}  // namespace furcula::walk
