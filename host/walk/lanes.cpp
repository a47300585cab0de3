#include "host/walk/lanes.hpp"

#include "host/walk/walkers.hpp"

namespace furcula::walk {

void run_lanes(const dynamics::biped::Description& robot, std::span<const Member> members,
               const RolloutOptions& options, std::span<const Job> jobs, std::atomic<std::size_t>& next,
               std::span<Rollout> out) {
  using Lanes = Walkers<dynamics::Lanes<float, 8>>;
  Lanes walkers = members.empty() ? Lanes(robot, robot, options) : Lanes(members, robot, options);
  walkers.run(
      [&](std::size_t& number) -> const Job* {
        number = next++;
        return number < jobs.size() ? &jobs[number] : nullptr;
      },
      [&](std::size_t number, const Rollout& r) { out[number] = r; });
}

}  // namespace furcula::walk
