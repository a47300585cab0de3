// The text of an MJCF with attributes changed: its shapes, meshes, sites and comments stay.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "host/model/urdf.hpp"

namespace furcula::trees {

/// What joints and bodies are to be.
struct MjcfChanges {
  struct Joint {
    double armature_kgm2 = 0.0, damping_nmspr = 0.0, friction_nm = 0.0, stiffness_nmprad = 0.0,
           rest_rad = 0.0;
    double kp_nmprad = 0.0, kd_nmsprad = 0.0;  ///< of a position actuator
  };
  std::map<std::string, model::UrdfInertia> bodies;  ///< of these alone
  std::map<std::string, Joint> joints;
  model::Vec3<double> gravity_mps2;
};

/// `head`: a comment at the top. Nothing where the file cannot say it in place: it includes others, a joint or body that changes has no name,
/// its masses come from shapes in any case, its springs are off. What it says is read again to know.
std::optional<std::string> edited_mjcf(const std::string& text, const model::Urdf& before,
                                       const MjcfChanges& changes, const std::string& head);

}  // namespace furcula::trees
