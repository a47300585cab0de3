// The catalogue's table.
#include "furcula/dynamics/effects/catalogue.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <string>

#include "furcula/dynamics/machines.hpp"

using namespace furcula::dynamics;

TEST_CASE("Every effect has a law, parameters with ordered bounds, an explanation and an experiment") {
  std::set<std::string_view> names;
  for (const EffectInfo& e : kCatalogue) {
    CAPTURE(std::string(e.name));
    CHECK(names.insert(e.name).second);
    CHECK(effect_named(e.name) == e.effect);
    CHECK_FALSE(e.law.empty());
    CHECK_FALSE(e.explanation.empty());
    CHECK_FALSE(e.where_to_look.empty());
    CHECK_FALSE(e.best_experiment.empty());
    CHECK(e.location_types != furcula::dynamics::LocationType{});
    REQUIRE(e.parameter_count >= 1);
    for (const auto& p : e.parameters()) {
      CHECK(p.lower < p.upper);
      if (!std::isnan(p.neutral)) CHECK((p.lower <= p.neutral && p.neutral <= p.upper));
    }
  }
}

TEST_CASE("Parameters on a rotary axis have rotary names and units") {
  const auto& force = info(Effect::coulomb_friction).parameter_table[0];
  CHECK(name_on(force, Kind::motor_axis) == "force_n");
  CHECK(name_on(force, Kind::rotary_joint) == "torque_nm");
  CHECK(unit_on(force, Kind::rotary_joint) == "N m");
}

TEST_CASE("Spring, torque and touch-down effects exist on the hopper alone") {
  for (const Effect e :
       {Effect::spring_preload, Effect::stiffness_error, Effect::torque_gain_error, Effect::touchdown_loss,
        Effect::ground_compliance, Effect::toe_sticking, Effect::contact_delay}) {
    CHECK(applies(e, Kind::hopper_linear));
    CHECK_FALSE(applies(e, Kind::motor_axis));
    CHECK_FALSE(applies(e, Kind::rotary_joint));
  }
}

TEST_CASE("A rail carriage, which nothing drives and nothing springs, has no effects of either") {
  for (const EffectInfo& e : kCatalogue) {
    CAPTURE(std::string(e.name));
    const bool possible = e.effect <= Effect::mass_error || e.effect == Effect::height_scale_error ||
                          e.effect == Effect::height_eccentricity || e.effect == Effect::encoder_slip;
    CHECK(applies(e.effect, Kind::rail_carriage) == possible);
  }
}
