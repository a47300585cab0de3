// Traces of robots against a closed form.
#include "host/traces/of_tree.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/trees/model.hpp"

using namespace furcula;

namespace {

const char* kLift = R"(<robot name="lift">
  <link name="base"/>
  <link name="load"><inertial><mass value="2"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="base"/><child link="load"/><axis xyz="0 0 1"/>
    <limit lower="-100" upper="100" effort="100" velocity="100"/></joint>
</robot>)";

trees::TreeModel lift() {
  trees::TreeContext context;
  context.urdf = kLift;
  return trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"lift.urdf\"\n", "lift.toml",
                                 context);
}

/// A load of 2 kg under its weight and a constant force: z = (F/2 - 9.81) t^2 / 2, to a micrometre, 500 Hz.
log::Log lifted(double force_n) {
  log::Log log;
  log.path = "lifted.csv";
  log.rig = "tree";
  for (int n = 0; n <= 500; ++n) {
    const double t = 2e-3 * n;
    log.columns["time_s"].push_back(t);
    log.columns["position_rail_m"].push_back(1e-6 * std::round(1e6 * 0.5 * (force_n / 2.0 - 9.81) * t * t));
    log.columns["force_rail_n"].push_back(force_n);
  }
  return log;
}

}  // namespace

TEST_CASE(
    "a load that is lifted is predicted in metres, and a force that is missing leaves the square of time") {
  const trees::TreeModel model = lift();
  const trees::Hypothesis given{model.drives, model.causes};
  log::Log log = lifted(24.0);
  log::Log weaker = log;
  for (double& force : weaker.columns["force_rail_n"]) force = 20.0;
  const traces::Traces right = traces::of_tree(model, {{"given", given}}, {log}, {}, 0.25);
  REQUIRE(right.logs.size() == 1);
  REQUIRE(right.logs[0].quantities.size() == 1);
  CHECK(right.logs[0].quantities[0].column == "position_rail_m");
  CHECK(right.logs[0].quantities[0].unit == "m");
  CHECK(traces::error_of(right.logs[0], right.logs[0].quantities[0], 0).rmse < 1e-4);
  // 4 N on 2 kg are missing: 2 m/s^2. The start is estimated beside that, from 50 ms.
  const traces::Traces wrong = traces::of_tree(model, {{"given", given}}, {weaker}, {}, 0.25);
  const traces::LogTraces& l = wrong.logs[0];
  std::size_t row = 0;
  while (l.window[row + 1] == 1) ++row;
  CHECK(l.time_s[row] - l.time_s[0] == Approx(0.25).margin(2.1e-3));
  const double since = l.time_s[row];
  CHECK(l.quantities[0].predicted[0][row] - l.quantities[0].measured[row] ==
        Approx(-since * since).epsilon(0.02));
}
