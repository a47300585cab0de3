// A robot from a file of any of the formats that are read: URDF, MJCF, and xacro where the program xacro is installed.
#pragma once

#include <string>
#include <string_view>

#include "host/model/urdf.hpp"

namespace furcula::model {

/// The format is that of the file's content; one whose name ends with .xacro is expanded first.
/// @throws core::DataError: what parse_urdf and parse_mjcf throw; a file that is not readable or larger than 1 MiB; what xacro says.
Urdf read_robot(const std::string& path);

/// The same on text; `name` stands for the path in messages. What an MJCF includes is read from beside it.
Urdf parse_robot(std::string_view text, const std::string& name);

}  // namespace furcula::model
