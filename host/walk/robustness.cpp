#include "host/walk/robustness.hpp"

#include <atomic>
#include <numbers>

#include "host/core/message.hpp"
#include "host/core/parallel.hpp"
#include "host/walk/search.hpp"

namespace furcula::walk {
namespace {

constexpr unsigned kNoisy = 64;

}  // namespace

dynamics::biped::Description heavier(dynamics::biped::Description robot, double factor) {
  const auto scale = [factor](dynamics::biped::LinkDescription& link) {
    link.mass_kg *= factor;
    auto& s = link.about_centre_kgm2;
    for (double* x : {&s.xx, &s.xy, &s.xz, &s.yy, &s.yz, &s.zz}) *x *= factor;
  };
  scale(robot.pelvis);
  for (auto& leg : robot.legs)
    for (auto& link : leg) scale(link);
  return robot;
}

Robustness robustness_of(const dynamics::biped::Description& robot, const RolloutOptions& options,
                         const Parameters& walk, const std::vector<Member>& drawn, unsigned threads,
                         const std::function<void(double)>& told) {
  struct Run {
    std::string what;
    dynamics::biped::Description robot;
    RolloutOptions options;
    bool noisy = false;
  };
  std::vector<Run> jobs;
  for (const int k : {1, 2, 4, 8}) {
    RolloutOptions o = options;
    o.steps_a_tick = k;
    o.step_s = options.tick_s() / k;
    jobs.push_back({"step " + core::shortest(1e3 * o.step_s) + " ms", robot, o});
  }
  const std::size_t steps = jobs.size();
  for (const double degrees : {1.0, -1.0}) {
    dynamics::biped::Description on = robot;
    // About y, positive forward: the ground's x axis then points down.
    on.slope_y_rad += degrees * std::numbers::pi / 180.0;
    jobs.push_back({degrees > 0.0 ? "1 degree downhill" : "1 degree uphill", on, options});
  }
  for (const double factor : {1.05, 0.95})
    jobs.push_back({factor > 1.0 ? "5 % heavier" : "5 % lighter", heavier(robot, factor), options});
  RolloutOptions longer = options;
  longer.time_s += 10.0;
  jobs.push_back({"10 s more to stand", robot, longer});
  const std::size_t changed = jobs.size();
  for (unsigned i = 0; i < kNoisy; ++i) jobs.push_back({"", robot, options, true});

  Robustness out;
  std::vector<Rollout> rollouts(jobs.size());  // and one more, the return map
  std::atomic<std::size_t> finished{0};
  core::parallel_for(jobs.size() + 1, threads, [&](std::size_t i) {
    if (i == jobs.size()) {
      out.map = return_map_of(robot, options, walk);
      return;
    }
    BatchedRollout<double> batch(jobs[i].robot, robot, jobs[i].options);
    if (jobs[i].noisy) batch.senses = Sensors(out.errors, i - changed + 1);
    rollouts[i] = batch.run_one(walk);
    if (told) told(static_cast<double>(++finished) / static_cast<double>(jobs.size()));
  });
  for (std::size_t i = 0; i < changed; ++i)
    (i < steps ? out.steps : out.changed).push_back({jobs[i].what, rollouts[i]});
  out.drawn = static_cast<unsigned>(drawn.size());
  std::vector<Job> others(drawn.size(), {walk, 0});
  for (std::size_t k = 0; k < others.size(); ++k) others[k].member = k;
  for (const Rollout& r : run_jobs(robot, drawn, options, others, threads))
    if (r.ending == Ending::stands) ++out.drawn_stand;
  out.noisy = kNoisy;
  for (std::size_t i = changed; i < jobs.size(); ++i) {
    if (rollouts[i].ending == Ending::stands) ++out.noisy_stand;
    if (rollouts[i].keeps_limits()) ++out.noisy_keep_limits;
  }
  return out;
}

}  // namespace furcula::walk
