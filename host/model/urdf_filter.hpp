// What of a URDF the dynamics use, before urdfdom sees it: links with their inertials, joints with place and axis. Geometry, materials,
// sensors, limits and extensions of simulators are not in what urdfdom gets, and cannot make it refuse a robot.
//
// What is wrong with something that perhaps does not move is kept with it ("flaw") and told where it does.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/model/urdf.hpp"
#include "host/model/xml_check.hpp"

namespace furcula::model {

struct FilteredLink {
  std::size_t line = 0;
  std::string flaw;  ///< of its <inertial>, which urdfdom then does not get; with file and line
  std::array<double, 6> rounding_kgm2{};  ///< as UrdfInertia's
};

struct FilteredJoint {
  std::size_t line = 0;
  UrdfJoint::Kind kind = UrdfJoint::Kind::fixed;
  std::string type;         ///< as the file calls it
  std::string child, flaw;  ///< `flaw`: of axis or <dynamics>; with file and line
  std::optional<UrdfLimits> limits;
  std::string limit_flaw;
  std::string mimics;
  double damping = 0.0, friction = 0.0, reduction = 0.0, rotor_inertia_kgm2 = 0.0, spring_nmprad = 0.0,
         spring_rest_rad = 0.0;
};

struct FilteredUrdf {
  std::string text;  ///< for urdfdom
  std::map<std::string, FilteredLink> links;
  std::map<std::string, FilteredJoint> joints;
  std::vector<UrdfClosure> closures;
  std::vector<std::string> notes;
};

/// `file` begins messages. @throws core::DataError naming file, line, element and what was expected: not a robot, a xacro file, a link or joint
/// without a name or with one that another has, a joint without a type or on links that are not there, more than one parent, a loop, more than one
/// root, a number of an <origin> of a joint that is none.
FilteredUrdf filter_urdf(const std::vector<XmlElement>& elements, const std::string& file);

/// "'a', 'b', 'c' and 5 more"
std::string first_names(const std::vector<std::string>& names);

}  // namespace furcula::model
