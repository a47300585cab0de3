#include "host/walk/lanes.hpp"

#include <cmath>

#include "host/walk/batched_rollout.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::walk {
namespace {

#ifdef __AVX512F__
constexpr std::size_t kLanes = 16;
#else
constexpr std::size_t kLanes = 8;
#endif

using SimdBatch = BatchedRollout<dynamics::SimdBatch<float, kLanes>>;

SimdBatch batch_of(const dynamics::biped::Description& robot, std::span<const Member> members,
                   const RolloutOptions& options) {
  return members.empty() ? SimdBatch(robot, robot, options) : SimdBatch(members, robot, options);
}

/// Of BatchedRollout::run.
auto taker(std::span<const Job> jobs, std::atomic<std::size_t>& next) {
  return [jobs, &next](std::size_t& number) -> const Job* {
    number = next++;
    return number < jobs.size() ? &jobs[number] : nullptr;
  };
}

}  // namespace

void run_lanes(const dynamics::biped::Description& robot, std::span<const Member> members,
               const RolloutOptions& options, std::span<const Job> jobs, std::atomic<std::size_t>& next,
               std::span<Rollout> out) {
  batch_of(robot, members, options).run(taker(jobs, next), [&](std::size_t number, const Rollout& r) {
    out[number] = r;
  });
}

void trace_lanes(const dynamics::biped::Description& robot, std::span<const Member> members,
                 const RolloutOptions& options, std::span<const Job> jobs, std::atomic<std::size_t>& next,
                 long ticks_a_row, std::span<Trace> out) {
  using namespace dynamics::biped;
  using Lanes = dynamics::SimdBatch<float, kLanes>;
  const auto lane_of = [](const auto& x, std::size_t lane) { return dynamics::lane_of(x, lane); };
  SimdBatch rollouts = batch_of(robot, members, options);
  rollouts.watch = [&](const WalkMoment<Lanes>& m) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      // The tick that has just ended is number time / tick - 1.
      if (!m.job[lane]) continue;
      const long tick = std::lround(static_cast<double>(lane_of(m.time_s, lane)) / options.tick_s()) - 1;
      if (tick % ticks_a_row != 0) continue;
      TraceRow& row = out[*m.job[lane]].rows.emplace_back();
      for (std::size_t i = 0; i < kJoints; ++i) {
        row.angle_rad[i] = lane_of(joint<Lanes>(m.sample.q_rad, i), lane);
        row.target_rad[i] = lane_of(joint<Lanes>(m.out.target_rad, i), lane);
      }
      const auto& a = m.sample.attitude;
      const RollPitchYaw turn =
          roll_pitch_yaw({lane_of(a.w, lane), lane_of(a.x, lane), lane_of(a.y, lane), lane_of(a.z, lane)});
      row.turn_rad = {static_cast<float>(turn.roll_rad), static_cast<float>(turn.pitch_rad),
                      static_cast<float>(turn.yaw_rad)};
    }
  };
  rollouts.run(taker(jobs, next), [&](std::size_t number, const Rollout& r) { out[number].rollout = r; });
}

}  // namespace furcula::walk
