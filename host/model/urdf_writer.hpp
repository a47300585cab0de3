// Writes robots as URDF.
#pragma once

#include <string>

#include "host/model/urdf.hpp"

namespace furcula::model {

/// What the dynamics use, links and joints in their order: inertials, places, axes, ranges, damping and friction, mimicking joints. parse_urdf of it
/// gives the same robot but for the last digits of turns, which URDF has as angles. Springs, actuators and gravity are no part of the format; rotor
/// inertias are an attribute of <dynamics>, "armature", which parse_urdf reads and others ignore.
std::string format_urdf(const Urdf& robot);

}  // namespace furcula::model
