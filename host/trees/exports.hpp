// The robot with the causes of a diagnosis in it, as other programs read it: URDF and MJCF.
#pragma once

#include <string>

#include "host/trees/diagnosis.hpp"

namespace furcula::trees {

/// The text of the model's URDF, which lies beside the model file, with what the extended model changes: <dynamics> damping
/// and friction (N m s/rad, N m; N s/m, N) of joints, <mass>, <origin xyz> and <inertia> of links. A payload becomes a part of
/// its link; a link whose inertial parameters are free has the fitted ones. All other bytes stay as they are; of a robot from MJCF or xacro it is a URDF of the
/// parts that the dynamics use. A comment at the top names each change with its reason, and what a URDF cannot
/// hold.
/// @throws core::DataError: the file is not readable, or has no such joint or link any more.
std::string extended_urdf(const Diagnosis& diagnosis);

/// The same with these bodies alone changed: <mass>, <origin xyz> and <inertia> of their links.
/// @throws core::DataError as extended_urdf.
std::string urdf_with_bodies(const TreeModel& model, const std::vector<FittedBody>& bodies);

/// The extended model by model::format_mjcf: bodies, armature, damping, frictionloss, gravity, and the gains of position laws
/// as actuators. A comment at the top names what is left out.
std::string extended_mjcf(const Diagnosis& diagnosis);

}  // namespace furcula::trees
