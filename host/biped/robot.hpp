// The biped from a URDF: its links, where their joints are, and the drives' largest torques (effort). The joints' range and largest
// speed are not read. What a URDF has no room for (the drives' other numbers, clutches, feet, ground) is as in
// furcula/dynamics/biped/design.hpp.
#pragma once

#include <string>

#include "furcula/dynamics/biped/design.hpp"
#include "host/model/urdf.hpp"

namespace furcula::biped {

/// @throws core::DataError, and what read_urdf and tree_of throw: a root without mass; a joint that is missing, not revolute, that
/// follows another, has damping, friction or no effort, is on another link, in another place or about another axis than
/// `dynamics::biped::DesignTopology` has, is turned against its parent, or is one too many, so that a foot is no leaf.
dynamics::biped::Description read_biped(const std::string& path);

/// The same of a robot that has been read.
dynamics::biped::Description biped_of(const model::Urdf& robot);

}  // namespace furcula::biped
