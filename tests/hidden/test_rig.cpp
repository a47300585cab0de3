// The virtual rigs' sensors and the drawing of cases.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/hidden/cases.hpp"
#include "tests/hidden/rig.hpp"

namespace furcula::hidden {
namespace {

Truth published_hopper() {
  return {.kind = Kind::hopper_linear,
          .parameters = {1.554, 605.0, 0.289, 6.42, 1.18, 1.0, 1.0, 0.15, 20 * std::numbers::pi / 180, 9.81},
          .planted = {}};
}
const double kTouchdownHeight_m = 0.30 * std::cos(20 * std::numbers::pi / 180);

// Instants at which the switch has read closed twice running after a flight (open twice running, and 50 ms
// after the last touch-down at the earliest: the switch chatters).
std::vector<double> reported_touchdowns(const HopperRecording& r) {
  std::vector<double> found;
  const auto& contact = r.log.at("contact");
  bool stance = false;
  for (std::size_t i = 1; i < contact.size(); ++i) {
    const double now = r.log.time_s()[i];
    if (!stance && contact[i] == 1 && contact[i - 1] == 1) {
      stance = true;
      found.push_back(now);
    } else if (stance && contact[i] == 0 && contact[i - 1] == 0 && now - found.back() > 0.05) {
      stance = false;
    }
  }
  return found;
}

// True instants, to the row, at which the body passes the touch-down height.
std::vector<double> crossings(const Trajectory& t, bool downwards) {
  std::vector<double> found;
  for (std::size_t i = 1; i < t.time_s.size(); ++i) {
    const bool above = t.position[i] > kTouchdownHeight_m, was_above = t.position[i - 1] > kTouchdownHeight_m;
    if (above != was_above && above != downwards) found.push_back(t.time_s[i]);
  }
  return found;
}

double nearest(const std::vector<double>& values, double to) {
  double best = 1e9;
  for (double v : values) best = std::min(best, std::abs(v - to));
  return best;
}

}  // namespace

TEST_CASE("The switch reports every touch-down, up to 10 ms early or late") {
  Random random(7);
  HopperSensors sensors;
  sensors.report_error_s = 10e-3;
  const HopperRecording r = record_hopper(published_hopper(), {.amplitude_nm = 2.0}, sensors, random);
  const std::vector<double> true_instants = crossings(r.truth, true), told = reported_touchdowns(r);
  REQUIRE(true_instants.size() >= 8);
  double earliest = 0, latest = 0;
  for (double t : true_instants) {
    // Two more rows: the true instant is known to a row, and the report is the second row running.
    CHECK(nearest(told, t) <= 12e-3);
    for (double report : told)
      if (std::abs(report - t) < 0.02) {
        earliest = std::min(earliest, report - t);
        latest = std::max(latest, report - t);
      }
  }
  CHECK(earliest < -2e-3);
  CHECK(latest > 3e-3);
}

TEST_CASE("Without a report error the switch follows touch-down within two rows") {
  Random random(7);
  const HopperRecording r = record_hopper(published_hopper(), {.amplitude_nm = 2.0}, {}, random);
  for (double t : crossings(r.truth, true)) CHECK(nearest(reported_touchdowns(r), t) <= 2.01e-3);
}

TEST_CASE("The torque begins anew at the reported touch-down and is zero in reported flight") {
  Random random(7);
  HopperSensors sensors;
  sensors.report_error_s = 10e-3;
  const HopperExperiment experiment{.amplitude_nm = 2.0, .period_s = 0.3};
  const HopperRecording r = record_hopper(published_hopper(), experiment, sensors, random);
  const auto& torque = r.log.at("torque_cmd_nm");
  int begun = 0;
  for (double t : reported_touchdowns(r)) {
    const auto row = static_cast<std::size_t>(std::lround(t * 1000));
    if (row + 30 >= torque.size()) continue;
    ++begun;
    CHECK(torque[row - 1] == 0.0);
    CHECK(torque[row + 30] == Approx(2.0 * std::sin(2 * std::numbers::pi * 0.030 / 0.3)));
  }
  CHECK(begun >= 8);
}

TEST_CASE("The height is the true one, on a grid of encoder counts, to noise and a count") {
  Random random(3);
  HopperSensors sensors;
  sensors.noise_m = 3e-5;
  const HopperRecording r = record_hopper(published_hopper(), {}, sensors, random);
  const auto& height = r.log.at("height_m");
  const double first_counts = height[0] / sensors.quantum_m;
  double squares = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    const double steps = height[i] / sensors.quantum_m - first_counts;
    REQUIRE(steps == Approx(std::round(steps)).margin(1e-6));
    squares += std::pow(height[i] - r.truth.position[i], 2);
  }
  const double rms = std::sqrt(squares / static_cast<double>(height.size()));
  // A uniform error of one count and the noise together: sqrt(0.09^2/12 + 0.03^2) = 0.040 mm.
  CHECK(rms == Approx(0.040e-3).epsilon(0.05));
}

TEST_CASE("The body vibrates on the encoder for 30 ms after touch-down, and not before") {
  HopperSensors still, shaken;
  still.noise_m = shaken.noise_m = 0.0;
  still.quantum_m = shaken.quantum_m = 1e-9;
  shaken.vibration_m = 2e-4;
  Random random(3), again(3);
  const HopperRecording a = record_hopper(published_hopper(), {.profile = Profile::none}, still, random);
  const HopperRecording b = record_hopper(published_hopper(), {.profile = Profile::none}, shaken, again);
  const double touchdown = crossings(a.truth, true).front();
  double before = 0, just_after = 0, later = 0;
  for (std::size_t i = 0; i < a.log.rows(); ++i) {
    const double since = a.log.time_s()[i] - touchdown;
    const double difference = std::abs(a.log.at("height_m")[i] - b.log.at("height_m")[i]);
    double& largest = since < -2e-3 ? before : since < 0.02 ? just_after : later;
    largest = std::max(largest, difference);
    if (since > 0.1) break;
  }
  CHECK(before < 1e-8);
  CHECK(just_after > 5e-5);
  CHECK(later < 3e-5);
}

TEST_CASE("Dropped rows are gone from every column, and time still increases") {
  Random random(3);
  HopperSensors sensors;
  sensors.dropped_fraction = 0.05;
  const HopperRecording r = record_hopper(published_hopper(), {}, sensors, random);
  const double lost = static_cast<double>(r.truth.time_s.size() - r.log.rows());
  CHECK(lost / static_cast<double>(r.truth.time_s.size()) == Approx(0.05).margin(0.02));
  for (const auto& [name, column] : r.log.columns) CHECK(column.size() == r.log.rows());
  for (std::size_t i = 1; i < r.log.rows(); ++i) REQUIRE(r.log.time_s()[i] > r.log.time_s()[i - 1]);
}

TEST_CASE("A seed draws the same case again, and another seed another") {
  const Case a = draw_case(5, Kind::motor_axis, "quadratic_drag", Size::large);
  const Case b = draw_case(5, Kind::motor_axis, "quadratic_drag", Size::large);
  const Case other = draw_case(6, Kind::motor_axis, "quadratic_drag", Size::large);
  CHECK(a.description() == b.description());
  CHECK(a.training[3].columns == b.training[3].columns);
  CHECK(a.held_out[1].columns == b.held_out[1].columns);
  CHECK(a.training[0].columns != other.training[0].columns);
}

TEST_CASE("A drawn case's model is near the truth, exact where it is held, and knows of no effect") {
  for (const auto& kind : dynamics::kMachines)
    for (std::uint64_t seed = 1; seed <= 5 && can_be_planted("coulomb_friction", kind.kind); ++seed) {
      const Case c = draw_case(seed, kind.kind, "coulomb_friction", Size::medium);
      REQUIRE(c.model.effects.empty());
      for (std::size_t i = 0; i < c.model.parameters.size(); ++i) {
        INFO(c.description() << ", parameter " << kind.parameters[i].name);
        if (const auto free = c.model.free.find(i); free != c.model.free.end()) {
          CHECK(c.truth.parameters[i] == Approx(c.model.parameters[i]).epsilon(0.11));
          CHECK(c.truth.parameters[i] > free->second.lower);
          CHECK(c.truth.parameters[i] < free->second.upper);
        } else {
          CHECK(c.truth.parameters[i] == c.model.parameters[i]);
        }
      }
    }
}

TEST_CASE("No drawn hopper has the ground pull, and with its torque on it hops", "[slow]") {
  std::uint64_t seed = 0;
  for (const LawInfo& law : laws())
    for (Size size : {Size::medium, Size::large}) {
      if (!can_be_planted(law.name, Kind::hopper_linear)) continue;
      // A spring that is let go in stance leaves the leg slack, and the hop dies.
      if (const auto effect = dynamics::effect_named(law.name); effect && dynamics::needs_clutch(*effect))
        continue;
      if (law.acts == Acts::outside_catalogue && size != Size::medium) continue;
      const Case c = draw_case(1 + seed++ % 3, Kind::hopper_linear, law.name, size);
      INFO(c.description());
      CHECK_FALSE(c.ground_pulled);
      for (const Trajectory& t : c.held_out_truth) CHECK(crossings(t, true).size() >= 5);
    }
}

TEST_CASE("A motor axis stays on its rail and a joint's rows come at irregular times") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Case axis = draw_case(seed, Kind::motor_axis, "force_offset", Size::large);
    INFO(axis.description());
    for (const log::Log& log : axis.training)
      for (double x : log.at("position_m")) REQUIRE(std::abs(x) < 0.2);
    const Case joint = draw_clean_case(seed, Kind::rotary_joint);
    double shortest = 1, longest = 0;
    const auto& time = joint.held_out[0].time_s();
    for (std::size_t i = 1; i < time.size(); ++i) {
      shortest = std::min(shortest, time[i] - time[i - 1]);
      longest = std::max(longest, time[i] - time[i - 1]);
    }
    CHECK(shortest < 1.5e-3);
    CHECK(longest > 5.5e-3);
  }
}

namespace {

// Sensors without errors, but for what is planted.
HopperRecording ideally_recorded(std::vector<Planted> planted, bool more_columns = false) {
  Truth truth = published_hopper();
  truth.planted = std::move(planted);
  HopperSensors sensors;
  sensors.quantum_m = 1e-9;
  sensors.noise_m = 0.0;
  sensors.torque_column = sensors.leg_angle_column = more_columns;
  Random random(7);
  return record_hopper(truth, {.amplitude_nm = 2.0}, sensors, random);
}

}  // namespace

TEST_CASE("An offset, a scale and an eccentric wheel do to the height what their laws say") {
  struct Expected {
    Planted planted;
    double (*seen)(double);
  };
  for (const auto& [planted, seen] :
       {Expected{{"encoder_offset", {0.004}}, [](double z) { return z + 0.004; }},
        Expected{{"height_scale_error", {1.05}},
                 [](double z) { return kTouchdownHeight_m + 1.05 * (z - kTouchdownHeight_m); }},
        Expected{{"height_eccentricity", {0.002, 0.18, 0.7}},
                 [](double z) { return z + 0.002 * std::sin(2 * std::numbers::pi * z / 0.18 + 0.7); }}}) {
    const HopperRecording r = ideally_recorded({planted});
    INFO(planted.law);
    for (std::size_t i = 0; i < r.log.rows(); i += 7)
      REQUIRE(r.log.at("height_m")[i] == Approx(seen(r.truth.position[i])).margin(1e-8));
  }
}

TEST_CASE("A slipped encoder is off by its step from its instant on") {
  const HopperRecording r = ideally_recorded({{"encoder_slip", {-0.003, 1.0}}});
  const auto& height = r.log.at("height_m");
  CHECK(height[999] - r.truth.position[999] == Approx(0.0).margin(1e-8));
  CHECK(height[1000] - r.truth.position[1000] == Approx(-0.003).margin(1e-8));
  CHECK(height.back() - r.truth.position.back() == Approx(-0.003).margin(1e-8));
}

TEST_CASE("A skew shifts the height against the torque by its time, either way") {
  for (int rows : {6, -6}) {
    const HopperRecording r = ideally_recorded({{"time_skew", {rows * 1e-3}}});
    const auto& height = r.log.at("height_m");
    for (std::size_t i = 10; i < r.log.rows(); ++i)
      REQUIRE(height[i] == Approx(r.truth.position[i - static_cast<std::size_t>(rows)]).margin(1e-8));
    CHECK(r.truth.time_s.size() - r.log.rows() == (rows < 0 ? 6u : 0u));
    CHECK(r.log.at("torque_cmd_nm")[300] == r.truth.command[300]);
  }
  // Between two rows: in free fall, 0.34 - g t^2 / 2 with hardly any drag.
  const HopperRecording r = ideally_recorded({{"time_skew", {2.5e-3}}});
  CHECK(r.log.at("height_m")[80] == Approx(0.34 - 0.5 * 9.81 * 0.0775 * 0.0775).margin(1e-3));
  CHECK(r.log.at("height_m")[80] == Approx(0.5 * (r.truth.position[77] + r.truth.position[78])).margin(3e-6));
}

TEST_CASE("A late switch reports late, an early one early, by its delay") {
  for (double delay : {0.015, -0.012}) {
    const HopperRecording r = ideally_recorded({{"contact_delay", {delay}}});
    const auto touchdowns = crossings(r.truth, true);
    REQUIRE(touchdowns.size() >= 6);
    for (double told : reported_touchdowns(r)) {
      double off = 1e9;
      for (double t : touchdowns)
        if (std::abs(told - t) < std::abs(off)) off = told - t;
      // The true instant is known to a row, and the report is the second row running.
      CHECK(off == Approx(delay + 1e-3).margin(1.1e-3));
    }
  }
}

TEST_CASE("The drive's own torque shows its lag, and neither gain nor offset") {
  const HopperRecording lagging = ideally_recorded({{"actuator_lag", {0.01}}}, true);
  const auto& command = lagging.log.at("torque_cmd_nm");
  const auto& made = lagging.log.at("torque_nm");
  double expected = 0.0;
  for (std::size_t i = 1; i < lagging.log.rows(); ++i) {
    expected = command[i - 1] + (expected - command[i - 1]) * std::exp(-0.1);
    REQUIRE(made[i] == Approx(expected).margin(0.06));  // six times the current sensor's noise
  }
  const HopperRecording weak =
      ideally_recorded({{"torque_gain_error", {0.8}}, {"torque_offset", {-0.1}}}, true);
  for (std::size_t i = 0; i < weak.log.rows(); ++i)
    REQUIRE(weak.log.at("torque_nm")[i] == Approx(weak.log.at("torque_cmd_nm")[i]).margin(0.06));
}

TEST_CASE("The leg's angle and the height agree in stance, and in flight the leg is on its stop") {
  const HopperRecording r = ideally_recorded({}, true);
  const auto& angle = r.log.at("leg_angle_rad");
  for (std::size_t i = 0; i < r.log.rows(); ++i) {
    const double z = std::min(r.truth.position[i], kTouchdownHeight_m);
    REQUIRE(angle[i] == Approx(std::acos(z / 0.30)).margin(4e-4));  // a count of 14 bit
  }
}

TEST_CASE("A reading that sticks moves on by more than its width at a time") {
  const HopperRecording r = ideally_recorded({{"sticking_counts", {0.0015}}});
  const auto& height = r.log.at("height_m");
  std::size_t moved = 0;
  for (std::size_t i = 1; i < height.size(); ++i) {
    const double step = std::abs(height[i] - height[i - 1]);
    CHECK((step == 0.0 || step >= 0.0015 - 1e-9));
    CHECK(std::abs(height[i] - r.truth.position[i]) < 0.0015 + 1e-9);
    moved += step > 0;
  }
  CHECK(moved > 100);
}

TEST_CASE("A slipped zero comes at another instant in each recording, the largest in the case's truth") {
  if (!can_be_planted("encoder_slip", Kind::hopper_linear)) return;
  const Case c = draw_case(5, Kind::hopper_linear, "encoder_slip", Size::large);
  CHECK(std::abs(c.truth.planted[0].values[0]) > 0.007);
}

TEST_CASE("The suite asks about every law that the catalogue knows, on every kind, and about eight others") {
  for (Tier tier : {Tier::large, Tier::outside}) {
    std::vector<std::string> asked;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Question q = question_of(tier, 77, i);
      for (const std::string& law : q.laws)
        asked.push_back(law + " " + std::string(dynamics::info(q.kind).name));
    }
    std::size_t outside = 0;
    for (const LawInfo& law : laws())
      for (const auto& kind : dynamics::kMachines) {
        if ((law.acts == Acts::outside_catalogue) != (tier == Tier::outside)) continue;
        if (!can_be_planted(law.name, kind.kind)) continue;
        const std::string wanted = std::string(law.name) + " " + std::string(kind.name);
        INFO(wanted);
        CHECK(std::count(asked.begin(), asked.end(), wanted) > 0);
        outside += kind.kind == Kind::hopper_linear && tier == Tier::outside;
      }
    if (tier == Tier::outside) CHECK(outside >= 8);
  }
}

TEST_CASE("Every effect of the catalogue can be planted on every kind that has it") {
  for (const auto& effect : dynamics::kCatalogue)
    for (const auto& kind : dynamics::kMachines)
      if (machine_has(kind.kind) && dynamics::applies(effect.effect, kind.kind)) {
        INFO(effect.name << " on " << kind.name);
        const LawInfo* law = law_named(effect.name);
        REQUIRE(law != nullptr);
        // This joint's encoder sits behind the gap and its rotor is not modelled.
        if (std::string(effect.name) != "backlash" || kind.kind != Kind::rotary_joint)
          CHECK(law->on(kind.kind));
        for (std::size_t i = 0; i < effect.parameter_count; ++i)
          CHECK(parameter_name(*law, i, kind.kind) ==
                std::string(dynamics::name_on(effect.parameter_table[i], kind.kind)));
      }
}

TEST_CASE("Exact nominal parameters are the truth's, wrong ones are off by 5 %") {
  for (Nominal nominal : {Nominal::exact, Nominal::wrong}) {
    Question q;
    q.seed = 3;
    q.kind = Kind::motor_axis;
    q.laws = {"coulomb_friction"};
    q.nominal = nominal;
    const Case c = draw_case(q);
    for (std::size_t i = 0; i < c.model.parameters.size(); ++i)
      CHECK(std::abs(c.model.parameters[i] / c.truth.parameters[i] - 1) ==
            Approx(nominal == Nominal::exact ? 0.0 : 0.05).margin(1e-12));
  }
}

TEST_CASE("A carriage thrown up is back on its stop after twice its speed over gravity") {
  const auto kind = dynamics::kind_named("rail_carriage");
  if (!kind) return;  // a build that does not know it
  Random random(3);
  const Truth truth{.kind = *kind, .parameters = {1.2, 0.0, 9.81}, .planted = {{"guide_tilt", {0.5}}}};
  const AxisRecording r = record_carriage(truth, {.speeds_mps = {2.0, 1.0}, .rest_s = 0.1}, {}, random);
  double flight_s = 0.0, highest = 0.0;
  for (std::size_t i = 0; i < r.log.rows(); ++i) {
    flight_s += r.log.at("contact")[i] == 0 ? 1e-3 : 0.0;
    highest = std::max(highest, r.log.at("height_m")[i]);
  }
  const double gravity = 9.81 * std::cos(0.5);
  CHECK(flight_s == Approx(2 * 3.0 / gravity).margin(3e-3));
  CHECK(highest == Approx(4.0 / (2 * gravity)).margin(1e-5));
}

TEST_CASE("An effect's size on an axis is a share of the input that the axis is used to") {
  const Case c = draw_case(4, Kind::rotary_joint, "coulomb_friction", Size::large);
  CHECK(c.truth.planted[0].values[0] / c.typical_input == Approx(0.20).epsilon(0.101));
  const Case drag = draw_case(4, Kind::motor_axis, "quadratic_drag", Size::medium);
  CHECK(drag.truth.planted[0].values[0] * drag.top_speed * drag.top_speed / drag.typical_input ==
        Approx(0.08).epsilon(0.101));
}

}  // namespace furcula::hidden
