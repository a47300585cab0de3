// The list of machines and what each says of itself; a machine that came in by it, from simulation to diagnosis.
#include <algorithm>
#include <catch2/catch.hpp>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/identify/identification.hpp"
#include "host/log/machine_types.hpp"
#include "host/machines/rules.hpp"
#include "host/model/reader.hpp"
#include "host/sim/simulate.hpp"

using namespace furcula;
using dynamics::Effect;

TEST_CASE("The list's order is that of the kinds, and no two machines have one name") {
  CHECK(dynamics::info(dynamics::Kind::hopper_linear).name == "hopper_linear");
  CHECK(dynamics::info(dynamics::Kind::hopper_nonlinear).name == "hopper_nonlinear");
  CHECK(dynamics::info(dynamics::Kind::motor_axis).name == "motor_axis");
  CHECK(dynamics::info(dynamics::Kind::rotary_joint).name == "rotary_joint");
  CHECK(dynamics::info(dynamics::Kind::rail_carriage).name == "rail_carriage");
  CHECK(dynamics::info(dynamics::Kind::clutch_bench).name == "clutch_bench");
  CHECK(dynamics::info(dynamics::Kind::torsion_pendulum).name == "torsion_pendulum");
  for (const dynamics::MachineInfo& machine : dynamics::kMachines) {
    CHECK(dynamics::kind_named(machine.name) == machine.kind);
    dynamics::with_machine(machine.kind,
                           [&]<class Machine>() { CHECK(Machine::kInfo.name == machine.name); });
  }
}

TEST_CASE("The columns that a machine's recordings are made of are those of its rig") {
  for (const dynamics::MachineInfo& machine : dynamics::kMachines) {
    const log::MachineType* rig = log::machine_type_named(machine.rig);
    CAPTURE(std::string(machine.name));
    REQUIRE(rig != nullptr);
    const machines::Columns& c = machines::rules(machine.kind).columns;
    for (const std::string_view column :
         {c.position, c.velocity, c.input, c.command, c.report, c.leg_angle, c.coil, c.touchdown, c.stop}) {
      CAPTURE(std::string(column));
      CHECK((column.empty() || rig->column(column) != nullptr));
    }
  }
}

TEST_CASE("Every machine has a seat for an effect, and something that it can be asked to do") {
  for (const dynamics::MachineInfo& machine : dynamics::kMachines) {
    CAPTURE(std::string(machine.name));
    CHECK(std::any_of(std::begin(dynamics::kCatalogue), std::end(dynamics::kCatalogue),
                      [&](const auto& e) { return dynamics::applies(e.effect, machine.kind); }));
    model::Model m;
    m.kind = machine.kind;
    for (const dynamics::ParameterInfo& p : machine.parameters)
      m.parameters.push_back(std::max(p.lower, std::min(p.upper, 0.3)));
    machines::ExperimentLibrary experiment_library(machines::rules(machine.kind).usual_run(m));
    machines::rules(machine.kind)
        .experiments(experiment_library, m, {.input = 1.0, .lowest = -0.5, .highest = 0.5, .speed = 2.0});
    CHECK(experiment_library.take().size() >= 3);
  }
}

namespace {

model::Model torsion_pendulum(const std::string& more = "") {
  return model::parse_model(
      "[model]\nkind = \"torsion_pendulum\"\nschema = 1\n[parameters]\ninertia_kgm2 = 0.02\n"
      "stiffness_nmprad = 3.0\ndamping_nmspr = 0.05\n" +
          more,
      "pendulum.toml");
}

/// Driven near its resonance of 1.95 Hz and away from it.
std::vector<log::Log> logs(const model::Model& truth, int count, std::uint64_t seed) {
  std::vector<log::Log> all;
  for (int i = 0; i < count; ++i) {
    sim::Scenario s = sim::default_scenario(truth);
    s.amplitude = 0.3 + 0.1 * i;
    s.period_s = 0.4 + 0.17 * i;
    s.duration_s = 6.0;
    s.sensors = {.quantisation = true, .noise = true};
    all.push_back(sim::simulate(truth, s, seed + static_cast<std::uint64_t>(i)));
    all.back().path = "log" + std::to_string(i) + ".csv";
  }
  return all;
}

}  // namespace

TEST_CASE("A torsion pendulum's spring, inertia and damping are identified from its logs") {
  model::Model truth = torsion_pendulum();
  truth.parameters = {0.0213, 2.83, 0.061};
  const model::Model given = torsion_pendulum(
      "[free]\ninertia_kgm2 = [0.01, 0.04]\nstiffness_nmprad = [1.0, 6.0]\ndamping_nmspr = [0.0, 0.2]\n");
  const identify::Identification found = identify::identify(given, logs(truth, 3, 5), logs(truth, 1, 50), {});
  for (const identify::Estimation& e : found.estimations) {
    REQUIRE(e.parameters.size() == 3);
    if (e.method != identify::Method::simulation) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      CAPTURE(e.parameters[i].name);
      CHECK(e.parameters[i].value == Approx(truth.parameters[i]).epsilon(0.01));
    }
  }
}

TEST_CASE("Dry friction of a torsion pendulum is named, with its size") {
  model::Model truth = torsion_pendulum();
  truth.effects[Effect::coulomb_friction] = {0.04};
  const diagnose::Diagnosis d = diagnose::diagnose(torsion_pendulum("[free]\ndamping_nmspr = [0.0, 0.2]\n"),
                                                   logs(truth, 4, 7), logs(truth, 2, 70), {});
  CHECK(d.verdict == diagnose::Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::coulomb_friction);
  CHECK(d.findings[0].parameters.at("torque_nm").value == Approx(0.04).epsilon(0.05));
}
