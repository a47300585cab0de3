#include "host/walk/lanes.hpp"

#include "host/walk/batched_rollout.hpp"

namespace furcula::walk {
namespace {

#ifdef __AVX512F__
constexpr std::size_t kLanes = 16;
#else
constexpr std::size_t kLanes = 8;
#endif

}  // namespace

void run_lanes(const dynamics::biped::Description& robot, std::span<const Member> members,
               const RolloutOptions& options, std::span<const Job> jobs, std::atomic<std::size_t>& next,
               std::span<Rollout> out) {
  using SimdBatch = BatchedRollout<dynamics::SimdBatch<float, kLanes>>;
  SimdBatch rollouts =
      members.empty() ? SimdBatch(robot, robot, options) : SimdBatch(members, robot, options);
  rollouts.run(
      [&](std::size_t& number) -> const Job* {
        number = next++;
        return number < jobs.size() ? &jobs[number] : nullptr;
      },
      [&](std::size_t number, const Rollout& r) { out[number] = r; });
}

}  // namespace furcula::walk
