// What a hop costs: the accounts add up, and say what physics says.
#include "host/energy/energy.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/energy/study.hpp"
#include "host/model/writer.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::energy;

namespace {

/// Document 002, section 5.2: 605 N/m, 1.6 kg.
model::Model robot() {
  model::Model m = test::robot_with_clutch();
  m.parameters[0] = 1.6;
  m.parameters[1] = 605.0;
  return m;
}

Robot hopping(const model::Model& model, double contraction_m, bool release) {
  sim::Scenario s = test::clutch_scenario(10.0);
  s.contraction_m = contraction_m;
  s.release_in_flight = release;
  return {sim::rig_config(model, s, 1), sim::controller_config(model, s)};
}

}  // namespace

TEST_CASE("What motor and coil give in a hop is what is lost in it, and the apex is the one asked for") {
  for (const bool release : {false, true}) {
    const auto settled = energy_at_apex(hopping(robot(), 0.05, release), {}, 0.34);
    REQUIRE(settled);
    const HopEnergy& e = settled->energy;
    const double given = e.motor_work + e.coil;
    const double lost = e.guide_damping + e.leg_damping + e.touchdown + e.stop + e.liftoff +
                        e.clutch_friction + e.clutch_impacts + e.coil_heat;
    CHECK(given == Approx(lost).epsilon(1e-3));  // between touch-downs the energy held differs a little
    CHECK(e.apex_m == Approx(0.34).margin(1e-4));
    CHECK(e.fold_m == Approx(0.05).margin(0.002));
    CHECK((e.coil > 0.0) == release);
  }
}

TEST_CASE("Folding against a caught spring takes the torque and the work of the spring") {
  const auto still = energy_at_apex(hopping(robot(), 0.0, false), {}, 0.34);
  const auto folded = energy_at_apex(hopping(robot(), 0.10, false), {}, 0.34);
  REQUIRE(still);
  REQUIRE(folded);
  // k (A + 7 mm) at the lever 2 L sin(theta) of a leg that is 10 cm shorter.
  const double length_m = 0.2819 - 0.10, lever_m = 0.3 * std::sqrt(1.0 - std::pow(length_m / 0.3, 2));
  CHECK(folded->energy.peak_torque_flight_nm == Approx(605.0 * 0.1071 * lever_m).epsilon(0.1));
  // k A^2 / 2 and the pretension, and what the leg's damping takes; the spring gives it back, the motor does
  // not.
  const double work_j = 605.0 * (0.1 * 0.1 / 2 + 0.0071 * 0.1);
  const double more_j = folded->energy.motor_pushed - still->energy.motor_pushed;
  CHECK(more_j > work_j);
  CHECK(more_j < work_j + folded->energy.leg_damping);
}

TEST_CASE("Copper losses are resistance times the current's square") {
  const auto one = energy_per_hop(hopping(robot(), 0.0, false), {0.1194, 0.2});
  const auto two = energy_per_hop(hopping(robot(), 0.0, false), {0.1194 / 2, 0.2});
  CHECK(two.motor_copper == Approx(4.0 * one.motor_copper).epsilon(1e-9));
  CHECK(two.motor_work == one.motor_work);
}

TEST_CASE("The break-even lies where the lines cross") {
  const auto point = [](double contraction_m, double caught_j, double clutched_j) {
    Point p;
    p.contraction_m = contraction_m;
    p.caught = p.clutched = Settled{};
    p.caught->energy.motor_pushed = caught_j;
    p.clutched->energy.motor_pushed = clutched_j;
    return p;
  };
  CHECK(*break_even_m({point(0.0, 1, 2), point(0.1, 3, 2)}, Measure::mechanical) == Approx(0.05));
  CHECK(*break_even_m({point(0.02, 2, 1), point(0.1, 3, 2)}, Measure::mechanical) == 0.02);
  // What holds at first and not later is none.
  CHECK(*break_even_m({point(0.0, 3, 2), point(0.02, 1, 2), point(0.1, 3, 2)}, Measure::mechanical) ==
        Approx(0.06));
  CHECK_FALSE(break_even_m({point(0.0, 1, 2), point(0.1, 1, 2)}, Measure::mechanical));
}

TEST_CASE("The study finds the published figures by the published accounting, and its own by its own") {
  Options options;
  options.points = 6;
  options.threads = 2;
  const Study s = run_study(robot(), options);
  CHECK(s.published.coil_j == Approx(3.0).epsilon(0.15));   // 10 V, 1.5 A, 0.2 s
  CHECK(s.published.mass_j == Approx(0.35).epsilon(0.15));  // 1 kg more
  CHECK(s.published.break_even_m == Approx(0.10).epsilon(0.1));
  REQUIRE(s.mechanical_m);
  CHECK(*s.mechanical_m > 0.03);
  CHECK(*s.mechanical_m < s.published.break_even_m);  // the coil's peak and hold takes less
  for (const Point& p : s.points) {
    REQUIRE(p.caught);
    REQUIRE(p.clutched);
  }
  // One thread gives the same.
  options.threads = 1;
  const Study again = run_study(robot(), options);
  CHECK(again.points[3].clutched->energy.motor_pushed == s.points[3].clutched->energy.motor_pushed);
  CHECK(*again.mechanical_m == *s.mechanical_m);
  model::Model without = robot();
  without.clutch.reset();
  CHECK_THAT(test::error_message([&] { run_study(without, options); }), Catch::Contains("has no clutch"));
  model::Model sticky = robot();
  sticky.effects[dynamics::Effect::coulomb_friction] = {1.0};
  CHECK_THAT(test::error_message([&] { run_study(sticky, options); }),
             Catch::Contains("[effect.coulomb_friction]; expected none"));
  model::Model light = robot();
  for (std::size_t i = 10; i < 13; ++i) light.parameters[i] = 0.0;
  CHECK_THAT(test::error_message([&] { run_study(light, options); }), Catch::Contains("inertia_a_kgm2"));
}

TEST_CASE("furcula energy writes its page and its figures") {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("robot.toml", model::format_model(robot()));
  const auto ran =
      test::run_furcula({"energy", "--model", file, "--points", "3", "--out", folder.path() + "/e"}, 120);
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Catch::Contains("break-even: mechanical") && Catch::Contains("as published"));
  std::ifstream json(folder.path() + "/e/energy.json");
  const auto read = nlohmann::json::parse(json);
  CHECK(read["schema"] == "furcula-energy/1");
  CHECK(read["points"].size() == 3);
  std::ifstream page(folder.path() + "/e/report.html");
  const std::string html((std::istreambuf_iterator<char>(page)), {});
  CHECK_THAT(html, Catch::Contains("Where it goes"));
}
