// Robot files of any format, see robot_file.hpp.
#include "host/model/robot_file.hpp"

#include "host/core/strict_toml.hpp"
#include "host/model/mjcf_reader.hpp"

namespace furcula::model {

Urdf parse_robot(std::string_view text, const std::string& name) {
  if (!is_mjcf(text)) return parse_urdf(text, name);
  return parse_mjcf(text, name, [](const std::string& path) {
    return core::read_small_file(path, "a part of a robot (MJCF)");
  });
}

Urdf read_robot(const std::string& path) {
  return parse_robot(
      core::read_small_file(path,
                            "a robot (URDF or MJCF); copy the robot's file here again, and see that "
                            "urdf or mjcf in [model] names it"),
      path);
}

}  // namespace furcula::model
