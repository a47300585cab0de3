// Where a walk's energy goes, joint by joint, and what another drive, foot, spring or clutch would change.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/walk/walk_file.hpp"

namespace furcula::walk {

/// A walk over 10 s with start and stop, over 100 s, and joint by joint.
struct EnergyBalance {
  Rollout ten_s;
  Rollout hundred_s;                                         ///< the same walk until 95 s; it may fall
  std::array<JointEnergy, dynamics::biped::kJoints> joints;  ///< of ten_s
};
EnergyBalance energy_of(const dynamics::biped::Description& robot, const RolloutOptions& options,
                        const Parameters& walk);

/// Cases that document 000 prints something of.
inline constexpr std::string_view kGear500 = "gear 500, the rotor's inertia as with 160",
                                  kGear500Charged = "gear 500, the rotor's inertia charged for";

/// One thing otherwise.
struct EnergyCase {
  std::string what;
  dynamics::biped::Description robot;
  WalkMode mode;
  bool hips_follow;
  EnergyBalance same;                   ///< the walk as it was
  std::optional<EnergyBalance> sought;  ///< the best that a search from it found; within all limits
  Parameters walk;                      ///< of `sought`, else the walk as it was
};

struct EnergyStudyOptions {
  std::uint64_t steps = 60'000'000;  ///< of simulation, of each case's search; 0: none
  std::uint64_t seed = 1;
  unsigned threads = 1;
  std::function<void(double fraction, const std::string& doing)> progress;
};

/// The first case is the robot as it is, and its search gets the same budget: without it a case would be put down to what a longer search
/// finds. The same for any number of threads.
std::vector<EnergyCase> study_energy(const Model& model, const Walk& walk, const EnergyStudyOptions& options);

/// The robot with another gear. `charged`: the rotor's inertia as seen at the joint grows with the ratio's square, and so do the drive's
/// gains, which are those of the motor; else it stays, as in document 000's equation 1.
dynamics::biped::Description with_gear(dynamics::biped::Description robot, double ratio, bool charged);

}  // namespace furcula::walk
