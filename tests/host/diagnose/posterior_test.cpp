// Confidence against closed forms: shares of sets of known evidence, and what limits them.
#include "host/diagnose/posterior.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "host/diagnose/laws.hpp"
#include "host/diagnose/rule.hpp"
#include "host/result/confidence.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using diagnose::EffectSet;
using diagnose::Posterior;
using dynamics::Effect;

namespace {

model::Model axis() { return test::axis_model(80.0, 150.0); }

model::Model axis_with(Effect e, const std::array<double, dynamics::kMaxEffectParameters>& values) {
  model::Model m = axis();
  m.effects[e] = values;
  return m;
}

/// Back and forth between two places, one window a second, in which the motor works all the time.
identify::Recording strokes(double from, double to, double seconds) {
  identify::Recording r;
  r.kind = dynamics::Kind::motor_axis;
  const double middle = 0.5 * (from + to), reach = 0.5 * (to - from), rate = 2.0 * std::numbers::pi;
  for (int i = 0; i <= static_cast<int>(100 * seconds); ++i) {
    const double t = 0.01 * i;
    r.time_s.push_back(t);
    r.position.push_back(middle - reach * std::cos(rate * t));
    r.velocity_smoothed.push_back(reach * rate * std::sin(rate * t));
    r.driven_s.push_back(t);
  }
  return r;
}

std::vector<identify::Window> seconds_of(const identify::Recording& r) {
  std::vector<identify::Window> all;
  for (std::size_t first = 0; first + 100 < r.rows(); first += 100) {
    identify::Window w;
    w.first = first;
    w.last = first + 100;
    all.push_back(w);
  }
  return all;
}

bool sees_enough(Effect e, const std::array<double, dynamics::kMaxEffectParameters>& values,
                 const identify::Recording& r) {
  return !diagnose::too_little_seen(e, axis_with(e, values), {r}, seconds_of(r));
}

}  // namespace

TEST_CASE("Of two sets the share follows from their evidence: odds of exp(half of it)") {
  const model::Model m = axis();
  const auto share = [&](double evidence, double prior, double misfit) {
    return Posterior(m, {{{Effect::coulomb_friction}, 0.0, 0.0}, {{Effect::mass_error}, evidence, prior}},
                     misfit)
        .share_with(Effect::coulomb_friction);
  };
  CHECK(share(0.0, 0.0, 1.0) == Approx(0.5));
  CHECK(share(-6.0, 0.0, 1.0) == Approx(1.0 / (1.0 + std::exp(-3.0))));
  CHECK(share(-6.0, -4.0, 1.0) == Approx(1.0 / (1.0 + std::exp(-5.0))));
  // Evidence that is worth a third; what was to be expected before is worth as much as ever.
  CHECK(share(-6.0, -4.0, 3.0) == Approx(1.0 / (1.0 + std::exp(-3.0))));
  CHECK(share(40.0, 0.0, 1.0) == Approx(std::exp(-20.0)));
  CHECK(share(-1e6, 0.0, 1.0) == 1.0);  // far beyond what a double's exponent holds
}

TEST_CASE("Sets that hold an effect add up, and names of one law count once") {
  const model::Model m = axis();
  // Nothing, friction, friction and drag, an offset: all as likely.
  const Posterior four(m,
                       {{{}, 0.0, 0.0},
                        {{Effect::coulomb_friction}, 0.0, 0.0},
                        {{Effect::coulomb_friction, Effect::quadratic_drag}, 0.0, 0.0},
                        {{Effect::force_offset}, 0.0, 0.0}},
                       1.0);
  CHECK(four.share_with(Effect::coulomb_friction) == Approx(0.5));
  CHECK(four.share_with(Effect::quadratic_drag) == Approx(0.25));
  CHECK(four.weight_of({Effect::coulomb_friction}) == Approx(0.25));
  CHECK(four.weight_of({Effect::mass_error}) == 0.0);
  // Friction of two sizes is friction with an offset: one law beside none.
  const Posterior named_twice(m,
                              {{{}, 0.0, 0.0},
                               {{Effect::asymmetric_friction}, 2.0, 0.0},
                               {{Effect::coulomb_friction, Effect::force_offset}, 2.0, 0.0}},
                              1.0);
  const double share = std::exp(1.0) / (1.0 + std::exp(1.0));
  CHECK(named_twice.share_with(Effect::asymmetric_friction) == Approx(share));
  CHECK(named_twice.share_with(Effect::coulomb_friction) == Approx(share));
}

TEST_CASE("What no name explains takes its share: a fifth of it makes the odds even") {
  CHECK(result::share_of_none(0.0) == 0.0);
  CHECK(result::share_of_none(0.2) == Approx(0.5));
  CHECK(result::share_of_none(1.0) == Approx(5.0 / 6.0));
  // 10 there are, 2 stay above a floor of 1: 1 of 9.
  CHECK(diagnose::unnamed_share(10.0, 2.0, 1.0, nullptr, false) == Approx(1.0 / 9.0));
  CHECK(diagnose::unnamed_share(10.0, 2.0, 1.0, nullptr, true) == 0.0);
  // A flexible law predicts half of it.
  diagnose::Predictable half;
  half.share = 0.5;
  CHECK(diagnose::unnamed_share(10.0, 2.0, 1.0, &half, false) == Approx(0.5 / 8.5));
}

TEST_CASE("Evidence is divided by what a flexible law finds left, if that counts") {
  diagnose::Remainder left;
  left.typical_force = 10.0;
  left.crossed.force = 1.0;
  left.crossed.share = 0.75;
  left.crossed.deviations = 8.0;
  left.crossed.noises = 5.0;
  CHECK(diagnose::misfit_of(left) == Approx(4.0));
  left.crossed.share = 0.99;
  CHECK(diagnose::misfit_of(left) == Approx(diagnose::kConfidence.largest_misfit));
  left.crossed.deviations = 2.0;
  CHECK(diagnose::misfit_of(left) == 1.0);
  CHECK(diagnose::misfit_of(std::nullopt) == 1.0);
}

TEST_CASE("A ripple below two swings, and a spot that is passed one way or not passed, are seen too little") {
  using std::numbers::pi;
  const auto metre = strokes(0.0, 1.0, 3.0);
  CHECK(sees_enough(Effect::torque_ripple, {1.0, 2.2 * 2.0 * pi, 0.0}, metre));
  CHECK_FALSE(sees_enough(Effect::torque_ripple, {1.0, 1.12 * 2.0 * pi, 0.0}, metre));
  CHECK(sees_enough(Effect::height_eccentricity, {1e-3, 0.4, 0.0}, metre));
  CHECK_FALSE(sees_enough(Effect::height_eccentricity, {1e-3, 0.6, 0.0}, metre));
  CHECK(sees_enough(Effect::binding_spot, {1.0, 0.5, 0.2}, metre));
  CHECK_FALSE(sees_enough(Effect::binding_spot, {1.0, 0.95, 0.2}, metre));  // it ends beyond the travel
  identify::Recording one_way = metre;
  one_way.position.resize(51), one_way.time_s.resize(51);
  identify::Window up;
  up.last = 50;
  CHECK(diagnose::too_little_seen(Effect::binding_spot, axis_with(Effect::binding_spot, {1.0, 0.5, 0.2}),
                                  {one_way}, {up}));
}

TEST_CASE("A motor's warming wants half its time constant, a Stribeck curve slow rows in three windows") {
  CHECK(sees_enough(Effect::thermal_derating, {0.8, 4.0, 0.0}, strokes(0.0, 1.0, 3.0)));
  CHECK_FALSE(sees_enough(Effect::thermal_derating, {0.8, 20.0, 0.0}, strokes(0.0, 1.0, 3.0)));
  // At most pi m/s; below 0.5 m/s in a tenth of the rows.
  CHECK(sees_enough(Effect::stribeck_friction, {1.0, 2.0, 0.5}, strokes(0.0, 1.0, 3.0)));
  CHECK_FALSE(sees_enough(Effect::stribeck_friction, {1.0, 2.0, 0.5}, strokes(0.0, 1.0, 2.0)));
  CHECK_FALSE(sees_enough(Effect::stribeck_friction, {1.0, 2.0, 0.01}, strokes(0.0, 1.0, 3.0)));
}

TEST_CASE("Names of one law are known, and found where they need no more parameters") {
  const model::Model m = axis();
  CHECK(diagnose::always_same(m, {Effect::actuator_delay}, {Effect::time_skew}));
  CHECK(diagnose::always_same(m, {Effect::asymmetric_friction},
                              {Effect::coulomb_friction, Effect::force_offset}));
  CHECK_FALSE(diagnose::always_same(m, {Effect::coulomb_friction}, {Effect::asymmetric_friction}));
  const model::Model hopper = test::hopper_model();
  CHECK_FALSE(diagnose::always_same(hopper, {Effect::actuator_delay}, {Effect::time_skew}));
  CHECK(diagnose::always_same(hopper, {Effect::guide_tilt}, {Effect::force_offset}));
  const EffectSet usable{Effect::coulomb_friction, Effect::asymmetric_friction, Effect::force_offset,
                         Effect::mass_error,       Effect::actuator_delay,      Effect::time_skew};
  CHECK(diagnose::in_other_names(m, {Effect::asymmetric_friction, Effect::mass_error}, usable) ==
        std::vector<EffectSet>{{Effect::coulomb_friction, Effect::force_offset, Effect::mass_error}});
  CHECK(diagnose::in_other_names(m, {Effect::coulomb_friction, Effect::force_offset}, usable) ==
        std::vector<EffectSet>{{Effect::asymmetric_friction}});
  CHECK(diagnose::in_other_names(m, {Effect::actuator_delay}, usable) ==
        std::vector<EffectSet>{{Effect::time_skew}});
  CHECK(diagnose::in_other_names(m, {Effect::mass_error}, usable).empty());
}

TEST_CASE("Each rule of the search has a name of its own, by which it is found") {
  std::set<std::string_view> names(diagnose::kRuleNames.begin(), diagnose::kRuleNames.end());
  CHECK(names.size() == diagnose::kRuleNames.size());
  CHECK(diagnose::name_of(diagnose::Rule::odd_recording) == "odd_recording");  // the last: none is forgotten
  for (const std::string_view name : names) CHECK(diagnose::name_of(*diagnose::rule_named(name)) == name);
  CHECK_FALSE(diagnose::rule_named("none"));
}
