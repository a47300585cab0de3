// The rig's body and leg: which machine_type is simulated, and what the switch sees of a leg that folds in flight.
#include "boards/sim_host/plant.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "boards/sim_host/contact_switch.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

/// The example with links; a, b, e of table 3.1 of document 002.
model::Model robot(double share_of_links) {
  model::Model m = example_hopper();
  m.kind = dynamics::Kind::hopper_nonlinear;
  for (const double inertia : {42e-4, 75e-4, 38e-3}) m.parameters.push_back(share_of_links * inertia);
  return m;
}

}  // namespace

TEST_CASE("a robot whose links have inertia hops in the rig, with rough sensors too") {
  auto scenario = example_scenario(20.0);
  scenario.amplitude = 3.0;  // its impacts lose more
  scenario.sensors = {true, true, true, true};
  const log::Log log = sim::simulate(robot(1.0), scenario, 3);
  const auto& height_m = log.at("height_m");
  REQUIRE(height_m.size() == 20000);
  const auto last_second = height_m.end() - 1000;
  CHECK(*std::max_element(last_second, height_m.end()) > 0.30);
  CHECK(*std::min_element(height_m.begin(), height_m.end()) > 0.15);
}

TEST_CASE("with links that weigh nothing, which no step could follow, it is the linear machine") {
  const auto scenario = example_scenario(5.0);
  const log::Log with = sim::simulate(robot(0.0), scenario, 1);
  const log::Log linear = sim::simulate(example_hopper(), scenario, 1);
  double most = 0.0;
  for (std::size_t i = 0; i < linear.rows(); ++i)
    most = std::max(most, std::abs(with.at("height_m")[i] - linear.at("height_m")[i]));
  CHECK(most < 1e-9);  // and a number
}

TEST_CASE("a switch that is early is as early under a leg that folds") {
  constexpr double kEarly_s = 0.008, kTorque_nm = 6.0;
  const auto parameters = dynamics::from_table<dynamics::HopperNonlinearParameters<double>>(
      std::span<const double>(robot(1.0).parameters));
  sim_host::Plant plant(parameters);
  plant.reset(0.36, 0.0);
  sim_host::ContactSwitch early({}, -kEarly_s, 1);
  double reported_s = -1.0, touched_s = -1.0;
  for (int n = 0; n < 400 && touched_s < 0.0; ++n) {
    const double now_s = 1e-3 * n;
    if (early.read(plant, kTorque_nm, now_s) && reported_s < 0.0) reported_s = now_s;
    plant.advance(kTorque_nm, 1e-3);
    early.follow(plant, now_s);
    for (const auto& event : plant.events())
      if (event.kind == dynamics::ContactEvent<double>::Kind::touchdown) touched_s = now_s + event.offset_s;
  }
  REQUIRE(touched_s > 0.0);
  CHECK(plant.height_m() < plant.touchdown_height_m() - 0.03);  // the leg is folded
  CHECK(touched_s - reported_s > kEarly_s - 0.0011);
  CHECK(touched_s - reported_s <= kEarly_s);
}
