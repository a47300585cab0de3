// The biped from a URDF: its links and where their joints are. What a URDF has no room for (drives, clutches, feet, ground) is as in
// furcula/dynamics/biped/design.hpp.
#pragma once

#include <string>

#include "furcula/dynamics/biped/design.hpp"
#include "host/model/urdf.hpp"

namespace furcula::biped {

/// @throws core::DataError, and what read_urdf and tree_of throw: a root without mass; a joint that is missing, on another link or
/// about another axis than `dynamics::biped::DesignTopology` has, turned against its parent, or one too many, so that a foot is no
/// leaf.
dynamics::biped::Description read_biped(const std::string& path);

/// The same of a robot that has been read.
dynamics::biped::Description biped_of(const model::Urdf& robot);

}  // namespace furcula::biped
