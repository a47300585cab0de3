// A diagnosis of a robot of two joints as the engine would hand it over, made by hand.
#pragma once

#include <string>

#include "host/trees/diagnosis.hpp"

namespace furcula::test {

/// A name that is markup.
inline constexpr const char* kHostileJoint = "<b>&\"x";

/// Shoulder `<b>&"x` and elbow of a planar arm. Found: dry friction of 0.31 N m at the elbow and a payload of 0.2 kg on the
/// forearm; missing torque before is that friction and a little noise, after the noise alone.
trees::Diagnosis sample_tree_diagnosis();

/// The page of a diagnosis, with the robot's picture.
std::string page_of(const trees::Diagnosis& d, const std::string& command = "");

}  // namespace furcula::test
