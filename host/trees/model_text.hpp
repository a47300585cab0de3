// The text of a model file, or of the one that a robot file stands for: commands and Python take `robot.urdf` in place of `robot.toml`.
#pragma once

#include <string>

namespace furcula::trees {

/// Of a URDF: a tree, in its folder, whose drives are told torques. Here is the place for other formats of robots.
/// @throws core::DataError: what core::read_small_file throws.
std::string read_model_text(const std::string& path);

}  // namespace furcula::trees
