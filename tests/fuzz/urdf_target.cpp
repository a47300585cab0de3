// The readers of URDF and MJCF files, the tree made of a robot, and the MJCF written of it.
#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/model/mjcf.hpp"
#include "host/model/mjcf_reader.hpp"
#include "host/model/xml_check.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  model::RobotTree tree;
  try {
    const auto nothing = [](const std::string& path) -> std::string {
      throw core::DataError(path + ": not there");
    };
    tree = model::tree_of(model::is_mjcf(input) ? model::parse_mjcf(input, "input", nothing)
                                                : model::parse_urdf(input, "input"));
  } catch (const core::DataError& e) {
    require(std::string_view(e.what()).find_first_of("\n\x1b") == std::string_view::npos,
            "a message is one printable line");
    return false;
  }
  require(tree.model.count() == tree.joints.size() && !tree.joints.empty(), "a tree has its joints");
  model::check_xml(model::format_mjcf(tree), "the MJCF", model::kMjcfDepthMax);
  dynamics::tree::accelerations(tree.model, {}, {}, {});
  return true;
}

}  // namespace furcula::fuzz
