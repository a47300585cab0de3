// Motions that tell causes apart, against what a constant torque does to a wheel.
#include "host/trees/next_experiment.hpp"

#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Effect;

namespace {

/// The wheel within 1 rad of 0, which is what a plan starts from.
std::vector<trees::Recording> moved(const trees::TreeModel& model) {
  auto r = test::inputs(model, 2.0, 0.004, [](std::size_t, double) { return 0.0; });
  for (std::size_t k = 0; k < r.rows(); ++k) r.angle_rad[0][k] = std::sin(3.0 * r.time_s[k]);
  return {r};
}

}  // namespace

TEST_CASE(
    "Two constant torques drive a wheel apart by half their difference over its inertia times the time squared") {
  const trees::TreeModel model = test::wheel();
  const auto recordings = moved(model);
  const trees::Hypothesis one{model.drives, {{Effect::force_offset, {0}, {0.2, 0, 0, 0}}}},
      other{model.drives, {{Effect::force_offset, {0}, {0.5, 0, 0, 0}}}};
  const auto all = trees::next_experiments(model, recordings, one, {other}, 0.3, 3);
  REQUIRE(all.size() == 3);
  // RMS of a t^2 / 2 over a window T: a T^2 / sqrt(20).
  const double expected = 0.3 / 0.5 * 0.3 * 0.3 / std::sqrt(20.0);
  for (const trees::Experiment& e : all) CHECK(e.apart_rad == Approx(expected).epsilon(0.03));
  // Of several others, the one that is least apart counts.
  const auto both = trees::next_experiments(model, recordings, one, {one, other}, 0.3, 1);
  REQUIRE(both.size() == 1);
  CHECK(both[0].apart_rad < 1e-3 * expected);
}

TEST_CASE(
    "A rotor's inertia against friction shows best where the wheel is fast, and the scenario can be simulated") {
  const trees::TreeModel model = test::wheel();
  const trees::Hypothesis inertia{model.drives, {{Effect::rotor_inertia_error, {0}, {0.05, 0, 0, 0}}}},
      friction{model.drives, {{Effect::coulomb_friction, {0}, {0.1, 0, 0, 0}}}};
  const auto all = trees::next_experiments(model, moved(model), inertia, {friction}, 0.3, 6);
  REQUIRE(all.size() == 6);
  for (std::size_t i = 1; i < all.size(); ++i) CHECK(all[i].apart_rad <= all[i - 1].apart_rad);
  // The torque of an inertia grows with the square of the frequency, that of friction does not.
  CHECK(all.front().paths[0].period_s == 0.35);
  const auto scenario = trees::parse_scenario(trees::scenario_of(model, all.front()), "next.toml", model);
  CHECK(scenario.paths[0].period_s == all.front().paths[0].period_s);
  CHECK(scenario.paths[0].amplitude_rad == all.front().paths[0].amplitude_rad);
  CHECK(trees::simulate(model, scenario, 1).rows() > 2000);
}
