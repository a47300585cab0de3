// The biped as MJCF, for MuJoCo as a peer: bodies and armatures, a free joint under the pelvis, nothing to touch.
#pragma once

#include <sstream>
#include <string>

#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::test {

/// With `frames`, its joints are turned so.
inline std::string biped_mjcf(const dynamics::biped::Description& d,
                              const dynamics::biped::JointFrames* frames = nullptr) {
  using dynamics::biped::kLegJoints;
  using dynamics::biped::LinkDescription;
  std::ostringstream out;
  out.precision(17);
  const auto body = [&](const LinkDescription& l) {
    const auto& s = l.about_centre_kgm2;
    const auto& c = l.centre_m;
    out << "<inertial pos=\"" << c.x << " " << c.y << " " << c.z << "\" mass=\"" << l.mass_kg
        << "\" fullinertia=\"" << s.xx << " " << s.yy << " " << s.zz << " " << s.xy << " " << s.xz << " "
        << s.yz << "\"/>";
  };
  out << "<mujoco><option gravity=\"0 0 " << -d.gravity_mps2
      << "\"/><worldbody><body name=\"pelvis\"><freejoint name=\"base\"/>";
  body(d.pelvis);
  static constexpr const char* kAxes[] = {"1 0 0", "0 1 0", "0 0 1"};
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const auto& at = d.legs[side][j].offset_m;
      out << "<body pos=\"" << at.x << " " << at.y << " " << at.z;
      if (frames != nullptr) {
        // The link's x and y axes in the parent.
        const auto& m = (*frames)[side][j];
        out << "\" xyaxes=\"" << m.x.x << " " << m.x.y << " " << m.x.z << " " << m.y.x << " " << m.y.y << " "
            << m.y.z;
      }
      out << "\"><joint axis=\"" << kAxes[static_cast<std::size_t>(dynamics::biped::DesignTopology::kAxes[j])]
          << "\" armature=\"" << d.drives[side][j].armature_kgm2 << "\"/>";
      body(d.legs[side][j]);
    }
    for (std::size_t j = 0; j < kLegJoints; ++j) out << "</body>";
  }
  out << "</body></worldbody></mujoco>";
  return out.str();
}

}  // namespace furcula::test
