// What a hop costs: the accounts add up, and say what physics says.
#include "host/energy/energy.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/app/app.hpp"
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

Robot without_spring(double contraction_m) {
  sim::Scenario s = test::clutch_scenario(10.0);
  s.contraction_m = contraction_m;
  s.release_in_flight = false;
  return springless_robot(robot(), s);
}

constexpr double kStiffness_npm = 605.0, kRest_m = 0.289, kStraight_m = test::kTouchdownM;

/// 2 L sin(theta) of a leg of this length, m/rad.
double lever_m(double length_m) { return std::sqrt(0.3 * 0.3 - length_m * length_m); }

/// What the spring holds at this length more than at touch-down, J.
double stored_j(double length_m) {
  const auto energy = [](double stretch_m) { return 0.5 * kStiffness_npm * stretch_m * stretch_m; };
  return energy(kRest_m - length_m) - energy(kRest_m - kStraight_m);
}

double lost_j(const HopEnergy& e) {
  return e.guide_damping + e.leg_damping + e.touchdown + e.stop + e.liftoff + e.clutch_friction +
         e.clutch_impacts + e.coil_heat;
}

}  // namespace

TEST_CASE("What motor and coil give in a hop is what is lost in it, and the apex is the one asked for") {
  for (const bool release : {false, true}) {
    const auto settled = energy_at_apex(hopping(robot(), 0.05, release), {}, 0.34);
    REQUIRE(settled);
    const HopEnergy& e = settled->energy;
    // Between touch-downs the energy held differs a little.
    CHECK(e.motor_work + e.coil == Approx(lost_j(e)).epsilon(1e-3));
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
  const double spring_nm = kStiffness_npm * 0.1071 * lever_m(kStraight_m - 0.10);
  CHECK(folded->energy.peak_torque_flight_nm == Approx(spring_nm).epsilon(0.1));
  CHECK(still->energy.peak_torque_flight_nm == 0.0);  // what is held from the stance on is the stance's
  // k A^2 / 2 and the pretension, and what the leg's damping takes; the spring gives it back, the motor does
  // not.
  const double work_j = 605.0 * (0.1 * 0.1 / 2 + 0.0071 * 0.1);
  const double more_j = folded->energy.motor_pushed - still->energy.motor_pushed;
  CHECK(more_j > work_j);
  CHECK(more_j < work_j + folded->energy.leg_damping);
}

TEST_CASE("Without a spring the motor pushes in stance with k (z0 - z), and never in flight") {
  Robot r = without_spring(0.0);
  r.config.torque.amplitude_nm = 0.0f;
  r.rig.duration_s = 2.0;
  sim_host::SimBoard board(r.rig);
  firmware::App app(board, r.config);
  int stances = 0;
  double before_nm = 0.0;
  while (board.wait_for_tick()) {
    app.tick();
    const auto& o = board.telemetry().outputs;
    REQUIRE(o.fault == control::Fault::none);
    stances += o.phase.touchdown;
    const double angle_rad = board.plant().leg_angle_rad(), length_m = 0.3 * std::cos(angle_rad);
    const double push_n =
        o.phase.phase == control::Phase::stance ? kStiffness_npm * (kRest_m - length_m) : 0.0;
    const double wanted_nm = -push_n * 0.3 * std::sin(angle_rad), given_nm = board.command().torque_nm;
    // By no more than 4 N m a tick.
    if (std::abs(wanted_nm - before_nm) < 4.0) CHECK(given_nm == Approx(wanted_nm).margin(2e-5));
    before_nm = given_nm;
    CHECK(board.plant().nonlinear()->energy().spring == 0.0);
    CHECK(board.command().coil_duty == 0.0f);
  }
  CHECK(stances >= 3);
}

TEST_CASE("Without a spring the motor gives in stance what the spring would, and its copper pays") {
  const auto caught = energy_at_apex(hopping(robot(), 0.0, false), {}, 0.34);
  const auto settled = energy_at_apex(without_spring(0.0), {}, 0.34);
  REQUIRE(caught);
  REQUIRE(settled);
  const HopEnergy &e = settled->energy, &sprung = caught->energy;
  CHECK(e.motor_work == Approx(lost_j(e)).epsilon(1e-3));
  CHECK(e.apex_m == Approx(0.34).margin(1e-4));
  CHECK(e.coil == 0.0);

  // The same motion, so that little more is lost in it.
  CHECK(e.compression_m == Approx(sprung.compression_m).epsilon(0.01));
  CHECK(e.motor_work == Approx(sprung.motor_work).epsilon(0.01));

  // Sinking, the motor takes back what the spring would store less what the harmonic torque pumps in by then;
  // rising, it gives the same and the rest.
  const double deepest_m = kStraight_m - e.compression_m, stores_j = stored_j(deepest_m);
  CHECK(e.motor_pushed > stores_j);
  CHECK(e.motor_pushed < stores_j + e.motor_work);
  CHECK(e.motor_pushed > sprung.motor_pushed);

  // The spring's torque is largest where the leg is shortest; the harmonic one has at most its amplitude.
  const double spring_nm = kStiffness_npm * (kRest_m - deepest_m) * lever_m(deepest_m);
  CHECK(e.peak_torque_stance_nm > spring_nm - settled->amplitude_nm);
  CHECK(e.peak_torque_stance_nm < spring_nm);  // it folds while the body sinks
  CHECK(sprung.peak_torque_stance_nm == Approx(caught->amplitude_nm).epsilon(0.001));

  // What carries the body over a hop is the motor's: of all torques with that mean over the stance the steady
  // one has the least losses, at the lever of a straight leg.
  const double stance_s = std::numbers::pi * std::sqrt(1.6 / kStiffness_npm), hop_s = e.flight_s + stance_s;
  const double steady_nm = 1.6 * 9.81 * hop_s / stance_s * lever_m(kStraight_m);
  const double least_j = 0.2 * std::pow(steady_nm / 0.1194, 2) * stance_s;
  CHECK(e.motor_copper > least_j);
  CHECK(e.motor_copper > 10.0 * sprung.motor_copper);
}

TEST_CASE("A spring that a motor plays once a millisecond is half of one late, and gives energy") {
  const auto caught = energy_at_apex(hopping(robot(), 0.0, false), {}, 0.34);
  const auto settled = energy_at_apex(without_spring(0.0), {}, 0.34);
  REQUIRE(caught);
  REQUIRE(settled);
  // The same harmonic torque on the same motion does the same work: what is missing is the spring's.
  const double share = settled->amplitude_nm / caught->amplitude_nm;
  const double gained_j = settled->energy.motor_work - share * caught->energy.motor_work;
  // k (z0 - z(t - T/2)) = k (z0 - z) + k T/2 z': a damping of -k T/2 beside the leg's own of 4 N s/m.
  const double late_j = 0.5e-3 * kStiffness_npm * settled->energy.leg_damping / 4.0;
  // And until the touch-down is detected, two ticks at most, the leg sinks without being braked.
  const double speed_mps = std::sqrt(2.0 * 9.81 * (0.34 - kStraight_m));
  CHECK(gained_j > late_j);
  CHECK(gained_j < late_j + stored_j(kStraight_m - 2e-3 * speed_mps));
}

TEST_CASE("Without a spring a leg that folds in flight lifts no more than itself") {
  const auto still = energy_at_apex(without_spring(0.0), {}, 0.34);
  const auto folded = energy_at_apex(without_spring(0.10), {}, 0.34);
  REQUIRE(still);
  REQUIRE(folded);
  CHECK(folded->energy.fold_m == Approx(0.10).margin(0.002));
  // A raised cosine of A in 0.2 s accelerates by A / 2 (2 pi / 0.2 s)^2; the leg's inertia is 3 g m^2.
  const double most_mps2 = 0.5 * 0.10 * std::pow(2.0 * std::numbers::pi / 0.2, 2);
  CHECK(folded->energy.peak_torque_flight_nm < 2.0 * 0.003 * most_mps2 / lever_m(kStraight_m));
  CHECK(folded->energy.motor_pushed - still->energy.motor_pushed < stored_j(kStraight_m - 0.10));
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
  // Of any two, and only where both can hop.
  const std::vector<Point> rising{point(0.0, 1, 2), point(0.1, 3, 2)};
  CHECK_FALSE(break_even_m(rising, Measure::mechanical, &Point::caught, &Point::clutched));
  CHECK_FALSE(break_even_m(rising, Measure::mechanical, &Point::springless, &Point::caught));
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
    REQUIRE(p.springless);
    // Direct drive: whatever the leg does in flight, the clutch saves the copper of standing and of folding.
    CHECK(cost_j(p.clutched->energy, Measure::electrical) <
          cost_j(p.springless->energy, Measure::electrical));
  }
  CHECK(cost_j(s.points[0].caught->energy, Measure::mechanical) <
        cost_j(s.points[0].springless->energy, Measure::mechanical));
  // Where folding against the spring takes what the spring saves in stance: k A^2 / 2 of some 2 J.
  REQUIRE(s.springless_mechanical_m);
  const double stores_j = stored_j(kStraight_m - s.points[0].springless->energy.compression_m);
  CHECK(*s.springless_mechanical_m == Approx(std::sqrt(2.0 * stores_j / kStiffness_npm)).epsilon(0.25));
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
  for (const char* robot : {"caught", "clutched", "springless"}) {
    CHECK(read["points"][0][robot]["peak_torque_stance_nm"] > 0.0);
    CHECK(read["points"][0][robot]["mechanical_j"] > 0.0);
  }
  CHECK_THAT(ran.out, Catch::Contains("without a spring"));
  std::ifstream page(folder.path() + "/e/report.html");
  const std::string html((std::istreambuf_iterator<char>(page)), {});
  CHECK_THAT(html, Catch::Contains("Where it goes"));
}
