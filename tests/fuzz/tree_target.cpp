// The reader of model files of trees. Names of URDF files are those beside tests/host/model/robots.
#include "host/core/error.hpp"
#include "host/trees/model.hpp"
#include "tests/fuzz/message.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/paths.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  static const std::string path = test::source("tests/host/model/robots/robot.toml");
  trees::TreeModel model;
  try {
    model = trees::parse_tree_model(input, path);
  } catch (const core::DataError& e) {
    require_printable(e);
    return false;
  }
  require(model.joints() > 0 && model.drives.size() == model.joints(), "a joint has its drive");
  const std::string written = trees::format_tree_model(model, model.urdf_path);
  const trees::TreeModel again = trees::parse_tree_model(written, path);
  require(
      again.moving == model.moving && again.hold == model.hold && again.causes.size() == model.causes.size(),
      "a written model reads back the same");
  require(trees::format_tree_model(again, again.urdf_path) == written,
          "a model that was read is written the same");
  return true;
}

}  // namespace furcula::fuzz
