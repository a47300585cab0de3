// The search that begins with the common laws at every joint.
#include "host/trees/search.hpp"

#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Effect;

namespace {

/// A cause's first value at a joint; nothing where it is not there.
std::optional<double> value_at(const trees::Hypothesis& h, Effect effect, std::size_t joint) {
  for (const trees::Cause& c : h.causes)
    if (c.effect == effect && std::find(c.sites.begin(), c.sites.end(), joint) != c.sites.end())
      return c.values[0];
  return std::nullopt;
}

trees::Found found(const trees::TreeModel& model, const trees::TreeModel& truth, std::size_t most_work) {
  std::vector<trees::Recording> recordings;
  for (const log::Log& log : test::logs(truth, 3, 5.0, 31))
    recordings.push_back(trees::recording_of(model, log));
  trees::Problem problem(model, recordings, trees::windows_of(model, recordings, 0.3), 2);
  return trees::search(problem, nullptr, {}, most_work);
}

}  // namespace

TEST_CASE("Where a search is ended early, the common laws of every joint are found together") {
  const trees::TreeModel model = test::arm3();
  trees::TreeModel truth = model;
  const double dry_nm[] = {0.5, 0.7, 0.25}, rotor_kgm2[] = {0.03, 0.04, 0.01};
  for (std::size_t j = 0; j < 3; ++j) {
    truth.causes.push_back({Effect::coulomb_friction, {j}, {dry_nm[j], 0, 0, 0}});
    truth.causes.push_back(
        {Effect::rotor_inertia_error, {j}, {model.drives[j].rotor_inertia_kgm2 + rotor_kgm2[j], 0, 0, 0}});
  }
  const trees::Found ended = found(model, truth, 1);
  REQUIRE(ended.common);
  for (std::size_t j = 0; j < 3; ++j) {
    INFO(model.robot.joints[j].name);
    const auto dry = value_at(ended.fit.at, Effect::coulomb_friction, j),
               rotor = value_at(ended.fit.at, Effect::rotor_inertia_error, j);
    REQUIRE(dry);
    CHECK(*dry == Approx(dry_nm[j]).epsilon(0.1));
    REQUIRE(rotor);
    CHECK(*rotor == Approx(model.drives[j].rotor_inertia_kgm2 + rotor_kgm2[j]).epsilon(0.1));
  }
}

TEST_CASE("Where nothing is missing, the common laws are not tried") {
  const trees::TreeModel model = test::arm3();
  trees::TreeModel truth = model;
  truth.causes.push_back({Effect::torque_gain_error, {1}, {0.8, 0, 0, 0}});
  const trees::Found one = found(model, truth, trees::kMostWork);
  CHECK_FALSE(one.common);
  CHECK(value_at(one.fit.at, Effect::torque_gain_error, 1).value_or(0.0) == Approx(0.8).epsilon(0.02));
}
