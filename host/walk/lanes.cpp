#include "host/walk/lanes.hpp"

#include "host/walk/walkers.hpp"

namespace furcula::walk {

void run_lanes(const dynamics::biped::Description& robot, const RolloutOptions& options,
               std::span<const Parameters> walks, std::atomic<std::size_t>& next, std::span<Rollout> out) {
  Walkers<dynamics::Lanes<float, 8>> walkers(robot, robot, options);
  walkers.run(
      [&](std::size_t& number) -> const Parameters* {
        number = next++;
        return number < walks.size() ? &walks[number] : nullptr;
      },
      [&](std::size_t number, const Rollout& r) { out[number] = r; });
}

}  // namespace furcula::walk
