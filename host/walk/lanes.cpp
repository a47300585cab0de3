#include "host/walk/lanes.hpp"

#include "host/walk/walkers.hpp"

namespace furcula::walk {

void run_lanes(const dynamics::biped::Description& robot, const RolloutOptions& options,
               std::span<const Parameters> walks, Taken& taken, std::span<Rollout> out) {
  using Lanes = Walkers<dynamics::Lanes<float, kEnsemble>>;
  const bool ensemble = options.ensemble.is_used();
  Lanes walkers =
      ensemble ? Lanes(ensemble_of(robot, options.ensemble), options) : Lanes(robot, robot, options);
  walkers.run(
      [&](std::size_t lane, std::size_t& number) -> const Parameters* {
        number = taken[ensemble ? lane : 0]++;
        return number < walks.size() ? &walks[number] : nullptr;
      },
      [&](std::size_t lane, std::size_t number, const Rollout& r) {
        out[ensemble ? kEnsemble * number + lane : number] = r;
      });
}

}  // namespace furcula::walk
