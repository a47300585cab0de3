// The reader of scenarios, for each kind of machine.
#include "host/core/error.hpp"
#include "host/model/reader.hpp"
#include "host/sim/scenario.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

const std::string kHead = "[model]\nschema = 1\nkind = ";
const model::Model kModels[]{
    model::parse_model(kHead + R"("hopper_linear"
[parameters]
mass_kg = 1.5
stiffness_npm = 600.0
rest_height_m = 0.28
damping_stance_nspm = 5.0
damping_flight_nspm = 1.0
restitution_touchdown = 0.95
restitution_liftoff = 0.98
link_length_m = 0.15
touchdown_angle_rad = 0.35
gravity_mps2 = 9.81
)",
                       "hopper"),
    model::parse_model(kHead + "\"motor_axis\"\n[parameters]\nmass_kg = 95.0\ndamping_nspm = 200.0\n",
                       "axis"),
    model::parse_model(kHead + R"("rotary_joint"
[parameters]
inertia_kgm2 = 0.15
gravity_torque_nm = 2.6
damping_nmspr = 0.1
)",
                       "joint"),
    model::parse_model(
        kHead + "\"rail_carriage\"\n[parameters]\nmass_kg = 1.6\ndamping_nspm = 1.0\ngravity_mps2 = 9.81\n",
        "carriage"),
};

}  // namespace

bool accepts(std::string_view input) {
  bool accepted = false;
  for (const model::Model& model : kModels) {
    try {
      const sim::Scenario scenario = sim::parse_scenario(input, "input", model);
      require(scenario.duration_s > 0.0 && scenario.duration_s < 1e6, "a scenario ends");
      accepted = true;
    } catch (const core::DataError&) {
    }
  }
  return accepted;
}

}  // namespace furcula::fuzz
