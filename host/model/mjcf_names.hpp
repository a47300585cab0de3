// What of MJCF has been read, by name: for actuators and constraints.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/model/mjcf_document.hpp"
#include "host/model/urdf.hpp"

namespace furcula::model {

struct MjcfNames {
  using Index = std::map<std::string, std::size_t, std::less<>>;
  Index bodies, sites, geoms;  ///< index of the link
  Index joints;                ///< of the joint
};

/// Gives joints their drives, and says what was assumed. @throws core::DataError
void read_mjcf_actuators(const std::vector<const MjcfElement*>& sections, const MjcfDefaults& defaults,
                         const MjcfNames& names, Urdf& robot, std::vector<std::string>& assumed);

/// Equality constraints and tendons, as closures of the links that they join and as joints that mimic others.
/// @throws core::DataError
void read_mjcf_constraints(const std::vector<const MjcfElement*>& equalities,
                           const std::vector<const MjcfElement*>& tendons, const MjcfDefaults& defaults,
                           const MjcfNames& names, Urdf& robot);

}  // namespace furcula::model
