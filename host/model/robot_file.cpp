// Robot files of any format, see robot_file.hpp.
#include "host/model/robot_file.hpp"

#include "host/core/strict_toml.hpp"
#include "host/model/mjcf_reader.hpp"
#include "host/model/xacro.hpp"

namespace furcula::model {

Urdf parse_robot(std::string_view text, const std::string& name) {
  if (!is_mjcf(text)) return parse_urdf(text, name);
  return parse_mjcf(text, name, [](const std::string& path) {
    return core::read_small_file(path, "a part of a robot (MJCF)");
  });
}

Urdf read_robot(const std::string& path) {
  const std::string text = core::read_small_file(
      path,
      "a robot (URDF or MJCF); copy the robot's file here again, and see that urdf or mjcf in [model] names it");
  // Where xacro is not installed, the reader says what to do.
  if (path.ends_with(".xacro") || text.find("<xacro:") != text.npos)
    if (const auto expanded = expand_xacro(path)) {
      Urdf robot = parse_robot(*expanded, path);
      robot.is_expanded = true;
      robot.notes.insert(robot.notes.begin(),
                         "Expanded by xacro; lines in messages are those of what it wrote.");
      return robot;
    }
  return parse_robot(text, path);
}

}  // namespace furcula::model
