// A planar leg as a robot of joints: what its diagnosis and identification work on.
#pragma once

#include <string>

#include "host/gait/machine.hpp"

namespace furcula::gait {

/// The name of the URDF that the model file names.
inline constexpr const char* kLegUrdf = "leg.urdf";

/// As a URDF and as a model file of `kind = "tree"`: a torso on the boom's two slides, `boom_travel` and `boom_height`, without
/// drives; `hip` and `knee`, both growing as in 001 Fig. 2; the spring at the knee; the foot `toe` at the shank's end. The
/// thigh hangs straight down at zero, x is forward and z up.
struct LegAsTree {
  std::string urdf, model;
};
LegAsTree leg_as_tree(const Machine& machine);

}  // namespace furcula::gait
