// The reader of a tree's scenarios, and a short run of what it reads.
#include <cmath>

#include "host/core/error.hpp"
#include "host/trees/simulate.hpp"
#include "tests/fuzz/message.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/paths.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  static const trees::TreeModel model = trees::parse_tree_model(
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"branched.urdf\"\n"
      "joints = [\"left_shoulder\", \"left_elbow\", \"left_reach\"]\n",
      test::source("tests/host/model/robots/robot.toml"));
  constexpr double kMostRows = 100.0;
  trees::Scenario scenario;
  try {
    scenario = trees::parse_scenario(input, "input", model);
  } catch (const core::DataError& e) {
    require_printable(e);
    return false;
  }
  require(scenario.paths.size() == model.joints(), "a joint has its path");
  for (const trees::Path& p : scenario.paths)
    for (const double t : {0.0, 0.1, scenario.duration_s})
      require(std::isfinite(p.at(t).q), "a path is finite");
  if (scenario.duration_s * scenario.sample_rate_hz > kMostRows) return true;
  try {
    const log::Log log = trees::simulate(model, scenario, 1);
    require(log.rows() > 0, "a run has rows");
  } catch (const core::DataError& e) {
    require_printable(e);
  }
  return true;
}

}  // namespace furcula::fuzz
