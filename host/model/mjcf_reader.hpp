// Robots from MJCF, the file format of the simulator MuJoCo, in the form in which URDF files are (docs/mjcf.md).
#pragma once

#include <string>
#include <string_view>

#include "host/model/mjcf_document.hpp"
#include "host/model/urdf.hpp"

namespace furcula::model {

/// A link for each body, with the body's frame, under the root "world"; a body that is one of a kind, free and not turned is the root itself.
/// A body with several joints has a link without mass before each but the last; one whose joint is not at its origin has a link there.
/// Links and joints are in the order of the file, q as in MuJoCo's qpos. `files` reads what is included.
/// @throws core::DataError naming file, line, element, what was expected and what to do: what read_mjcf_elements throws; numbers that are none; a
/// ball joint, a free joint that is not the root's; meshes whose mass counts; what makes bodies out of others (composite, flexcomp, replicate,
/// attach). Equality constraints and tendons become closures and mimicking joints, which tree_of refuses where they move.
Urdf parse_mjcf(std::string_view text, const std::string& name, const MjcfFiles& files);

/// Whether the text's first element is <mujoco>.
bool is_mjcf(std::string_view text);

}  // namespace furcula::model
