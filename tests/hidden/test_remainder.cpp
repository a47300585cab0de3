// What the diagnosis says of a machine's repeatability, and of what a flexible law predicts, against disturbances and laws that are
// known here.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/diagnose/remainder.hpp"
#include "host/identify/recording.hpp"
#include "host/identify/windows.hpp"
#include "tests/hidden/cases.hpp"

namespace furcula::hidden {
namespace {

constexpr double kWindow_s = 0.5;

/// Of a case, with the parameters that its machine really has; a spring that rests lower by so much.
diagnose::Remainder remainder_of(const Case& c, double lower_m = 0.0) {
  model::Model model = c.model;
  model.parameters = c.truth.parameters;
  if (lower_m > 0.0) model.parameters[*dynamics::parameter_index(c.kind, "rest_height_m")] -= lower_m;
  const auto training = identify::make_recordings(c.training, c.kind),
             held_out = identify::make_recordings(c.held_out, c.kind);
  const auto left =
      diagnose::remainder_of(model, training, identify::prediction_windows(training, model, kWindow_s),
                             held_out, identify::prediction_windows(held_out, model, kWindow_s));
  REQUIRE(left);
  return *left;
}

Question question(const char* kind, std::uint64_t seed, bool disturbed, const char* law = nullptr,
                  Size size = Size::medium) {
  Question q;
  q.seed = seed;
  q.kind = *dynamics::kind_named(kind);
  q.disturbed = disturbed;
  q.size = size;
  if (law) q.laws = {law};
  return q;
}

}  // namespace

TEST_CASE(
    "The random force that a machine meets is estimated from its recordings, and nothing is predictable of it") {
  for (const char* kind : {"motor_axis", "rotary_joint", "rail_carriage", "hopper_linear"})
    for (std::uint64_t seed : {901, 902}) {
      const Case c = draw_case(question(kind, seed, true));
      const diagnose::Remainder left = remainder_of(c);
      INFO(kind << " seed " << seed << ": random force " << c.truth.disturbance.force << " over "
                << c.truth.disturbance.correlation_s << " s, found " << left.random_force << " over "
                << left.correlation_s);
      // What a force does to the positions tells its size and its duration together: longer and smaller looks much the same.
      CHECK(left.random_force > 0.55 * c.truth.disturbance.force);
      CHECK(left.random_force < 1.8 * c.truth.disturbance.force);
      CHECK(left.repeats());
      CHECK_FALSE(left.is_structured());
    }
}

TEST_CASE("A machine that nothing disturbs repeats itself") {
  for (const char* kind : {"motor_axis", "rotary_joint", "rail_carriage"}) {
    const diagnose::Remainder left = remainder_of(draw_case(question(kind, 911, false)));
    INFO(kind << ": " << left.random_force << " of " << left.typical_force);
    CHECK(left.random_force < 3e-3 * left.typical_force);
    CHECK_FALSE(left.is_structured());
  }
}

TEST_CASE("Impacts that scatter are told from forces that do") {
  Question q = question("hopper_linear", 921, true);
  const Case c = draw_case(q);
  const diagnose::Remainder left = remainder_of(c);
  INFO("scatter " << c.truth.disturbance.restitution << ", found " << left.impact_scatter);
  CHECK(left.impact_scatter > 0.4 * c.truth.disturbance.restitution);
  CHECK(left.impact_scatter < 2.5 * c.truth.disturbance.restitution);
}

TEST_CASE("A law that the model lacks is predictable under disturbance") {
  // Held against the force that was really missing: dry friction has one size at all times.
  for (const char* kind : {"motor_axis", "rotary_joint", "rail_carriage", "hopper_linear"}) {
    const Case c = draw_case(question(kind, 931, true, "coulomb_friction"));
    const diagnose::Remainder left = remainder_of(c);
    INFO(kind << ": friction " << c.truth.planted[0].values[0] << ", predictable " << left.predictable.force
              << ", share " << left.predictable.share << ", " << left.predictable.deviations
              << " standard errors");
    CHECK(left.is_structured());
    CHECK(left.predictable.force == Approx(c.truth.planted[0].values[0]).epsilon(0.35));
    CHECK(left.predictable.share > 0.7);
  }
}

TEST_CASE("What a spring gives up the longer it was compressed is predictable, of its past") {
  // Most of it is that of a spring which rests lower: the model has the one that leaves the least.
  const Case c = draw_case(question("hopper_linear", 951, true, "creeping_spring"));
  diagnose::Remainder left = remainder_of(c);
  for (const double lower_m : {1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3})
    if (auto other = remainder_of(c, lower_m); other.random_force < left.random_force)
      left = std::move(other);
  INFO("predictable " << left.predictable.force << ", share " << left.predictable.share << ", "
                      << left.predictable.deviations << " standard errors; crossed " << left.crossed.share);
  CHECK(left.is_structured());
  CHECK(left.predictable.share > 0.85);
}

TEST_CASE("A force that swings with the time, in no state's step, is no repeatability") {
  const diagnose::Remainder left =
      remainder_of(draw_case(question("motor_axis", 941, true, "periodic_force")));
  INFO(left.random_force << " of " << left.typical_force);
  CHECK((left.is_structured() || !left.repeats()));
}

}  // namespace furcula::hidden
