// Robots that a walk has to stand on beside the one it is searched on: drawn from the priors of the model's numbers, and pushed.
#pragma once

#include <cstdint>
#include <vector>

#include "host/biped/machine.hpp"
#include "host/walk/member.hpp"

namespace furcula::walk {

SensorOffsets sensors_of(const furcula::biped::Machine& machine);

/// A machine as BatchedRollout simulates it. Attitudes of joints' frames, gear elasticity, backlash, delay and constant torques are left out.
Member member_of(const furcula::biped::Machine& machine);

struct EnsembleOptions {
  std::size_t robots = 7;
  /// How far they deviate, times the ranges of document 000, Tables I and II. With 0.5 no more robots stand, and a walk costs 9 % more
  /// (docs/studies.md).
  double deviations = 0.35;
  std::uint64_t seed = 1;
};

/// Robots about `machine`: numbers of the tables drawn uniformly, those of the simulation's own ground and friction's ramp within half of their
/// prior's range, and pushes.
std::vector<Member> drawn_robots(const furcula::biped::Machine& machine, WalkMode mode,
                                 const EnsembleOptions& options);

}  // namespace furcula::walk
