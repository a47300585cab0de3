// What a log's column seems to be by its name: "joint1_pos", "position[shoulder]", "/joint_states/elbow/position", "axis0.encoder.pos_estimate".
#pragma once

#include <string>

namespace furcula::mapping {

enum class Role { other, time, position, velocity, effort, current, contact, coil };

struct Meaning {
  Role role = Role::other;
  bool command = false;     ///< or a set point, not measured
  std::string joint;        ///< the words that say which joint; empty: none do
  std::string unit;         ///< as written, in lower case: "deg", "mnm", "turns"; empty: the name has none
  bool unit_usual = false;  ///< the name has none, but is of a drive that always writes this one
};

/// Never fails: what it does not know is Role::other.
Meaning meaning_of(const std::string& column);

/// One of a unit in rad, m, N m, N, s (by role), or 0 where it is none of the role's or its size is not known (counts, A).
double si_of(Role role, const std::string& unit, bool linear);

}  // namespace furcula::mapping
