// Masses and moments of inertia of MJCF: of a body's <inertial>, or of its shapes.
#pragma once

#include <utility>
#include <vector>

#include "host/model/mjcf_document.hpp"
#include "host/model/urdf.hpp"

namespace furcula::model {

/// What a body has: shapes, each in a frame of the body, and at most one <inertial>.
struct MjcfBody {
  std::vector<std::pair<MjcfFields, Frame<double>>> geoms;
  const MjcfElement* inertial = nullptr;
  const MjcfElement* element = nullptr;
  Frame<double> in_parent{dynamics::tree::identity<double>(), {0.0, 0.0, 0.0}};
  Frame<double> to_body{
      dynamics::tree::identity<double>(),
      {0.0, 0.0, 0.0}};  ///< of the world's coordinates, where <compiler coordinate="global">
};

/// A body's inertia by the rules of <compiler>; nothing where it has none.
/// @throws core::DataError: a mesh whose mass counts, a size that is missing or not above 0, moments that no body has.
std::optional<UrdfInertia> inertia_of_body(const MjcfBody& body, const MjcfCompiler& compiler);

}  // namespace furcula::model
