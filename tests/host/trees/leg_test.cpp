// Legs that stand on a foot: model files, phases of a recording, runs beside the planar leg's own plant, and a diagnosis of logs
// that the gait's controller made.
#include <catch2/catch.hpp>
#include <cmath>

#include "furcula/dynamics/planar_leg_plant.hpp"
#include "host/gait/gait_log.hpp"
#include "host/gait/leg_as_tree.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/next_experiment.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/gait/legs.hpp"

using namespace furcula;
using Catch::Contains;
using trees::Effect;

namespace {

trees::TreeModel tree(const gait::Machine& machine, const std::string& more = "") {
  const gait::LegAsTree leg = gait::leg_as_tree(machine);
  return trees::parse_tree_model(leg.model + more, "leg.toml", leg.urdf);
}
trees::TreeModel spear(const std::string& more = "") {
  return tree(gait::spear(gait::LegSpring::switched), more);
}

/// Rows of 1 ms: a falling leg, its stance, and its next flight; no torques. Rates as the plant has them.
struct Hop {
  log::Log log;
  std::vector<std::array<double, 4>> rate;
};
Hop hop(const gait::Machine& machine, double knee_nm) {
  dynamics::PlanarLeg<double> plant(machine.leg, machine.spring, gait::LegLiftOff::force);
  plant.reset({0.0, 0.75}, {0.1, 0.0}, {-0.55, 1.1}, {0.3, -0.2});
  Hop out;
  out.log.path = "hop.csv";
  out.log.rig = "tree";
  for (int k = 0; k < 700; ++k) {
    auto& c = out.log.columns;
    c["time_s"].push_back(1e-3 * k);
    c["position_boom_travel_m"].push_back(plant.hip_m().x);
    c["position_boom_height_m"].push_back(plant.hip_m().y);
    c["angle_hip_rad"].push_back(plant.angle_rad().hip);
    c["angle_knee_rad"].push_back(plant.angle_rad().knee);
    c["torque_hip_nm"].push_back(0.5);
    c["torque_knee_nm"].push_back(knee_nm);
    c["contact_toe"].push_back(plant.mode() == dynamics::PlanarLeg<double>::Mode::stance ? 1.0 : 0.0);
    out.rate.push_back({plant.hip_velocity_mps().x, plant.hip_velocity_mps().y, plant.rate_radps().hip,
                        plant.rate_radps().knee});
    plant.advance({0.5, knee_nm}, 1e-3);
  }
  return out;
}

}  // namespace

TEST_CASE("A foot and springs are read from the model file, written, and read back") {
  const trees::TreeModel m = spear();
  REQUIRE(m.foot);
  CHECK(m.foot->name == "toe");
  CHECK(m.foot->point_m.z == -0.327);
  CHECK(m.springs[3].stiffness_nmprad == 60.67);
  CHECK(m.springs[3].switched);
  CHECK_FALSE(m.driven(0));
  CHECK(m.driven(2));
  CHECK(trees::sites(m, trees::LocationType::spring) == std::vector<std::size_t>{3});
  const std::string text = trees::format_tree_model(m, "leg.urdf");
  CHECK(trees::format_tree_model(trees::parse_tree_model(text, "x.toml", m.urdf_text), "leg.urdf") == text);

  const trees::TreeModel parallel = tree(gait::spear(gait::LegSpring::parallel));
  CHECK_FALSE(parallel.springs[3].switched);
  CHECK(parallel.springs[3].rest_rad == Approx(61.0 * 3.14159265358979 / 180.0));
}

TEST_CASE("What is wrong with a foot or a spring is said, with its line") {
  const auto refused = [](const std::string& from, const std::string& to) {
    const gait::LegAsTree leg = gait::leg_as_tree(gait::spear(gait::LegSpring::switched));
    std::string text = leg.model;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    return test::error_message([&] { trees::parse_tree_model(text, "leg.toml", leg.urdf); });
  };
  CHECK_THAT(refused("rest = \"touch_down\"", "rest = \"landing\""),
             Contains("leg.toml:") && Contains("expected \"touch_down\""));
  CHECK_THAT(refused("rest = \"touch_down\"\n", ""),
             Contains("expected either rest = \"touch_down\" or rest_rad"));
  CHECK_THAT(refused("[spring.knee]", "[spring.kne]"),
             Contains("no joint 'kne'") && Contains("did you mean 'knee'"));
  CHECK_THAT(refused("link = \"shank\"", "link = \"shnk\""),
             Contains("no link 'shnk' that moves") && Contains("shank"));
  CHECK_THAT(refused("link = \"shank\"", "link = \"ground\""), Contains("no link 'ground' that moves"));
  CHECK_THAT(refused("point_m = [0.0, 0.0, -0.327]", "point_m = [0.0, 0.0]"),
             Contains("expected three numbers"));
  CHECK_THAT(refused("[foot.toe]", "[foot.toe]\nfriction = 0.6"), Contains("unknown key 'friction'"));
  CHECK_THAT(refused("control_mode = \"none\"", "control_mode = \"no\""),
             Contains("expected one of torque, position, none"));
  CHECK_THAT(refused("[foot.toe]", "[effect.latch_delay.hip]\ndelay_s = 0.01\n[foot.toe]"),
             Contains("no spring 'hip'; expected one of knee"));
  const gait::LegAsTree parallel = gait::leg_as_tree(gait::spear(gait::LegSpring::parallel));
  CHECK_THAT(test::error_message([&] {
               trees::parse_tree_model(parallel.model + "[effect.latch_offset.knee]\noffset_rad = 0.1\n",
                                       "leg.toml", parallel.urdf);
             }),
             Contains("its spring has a fixed rest_rad"));
}

TEST_CASE("A recording is cut where the foot's contact changes, chatter of the switch is no change") {
  const trees::TreeModel m = spear();
  Hop h = hop(gait::spear(gait::LegSpring::switched), 0.0);
  auto& contact = h.log.columns["contact_toe"];
  std::size_t down = 0, up = 0;
  for (std::size_t k = 1; k < contact.size(); ++k) {
    if (contact[k] > contact[k - 1]) down = k;
    if (contact[k] < contact[k - 1]) up = k;
  }
  REQUIRE(down > 0);
  REQUIRE(up > down);
  contact[down + 3] = 0.0;  // the switch chatters
  const trees::Recording r = trees::recording_of(m, h.log);
  REQUIRE(r.phases.size() == 3);
  CHECK_FALSE(r.phases[0].stance);
  CHECK(r.phases[1].stance);
  CHECK(r.phases[1].first == down + 5);  // after the last of these changes
  CHECK(r.phases[0].last == down - 4);   // the switch may be late
  CHECK(r.phases[1].last == up - 4);
  CHECK(r.input[2][r.phases[0].first] == 0.5);
  CHECK(r.phases[1].touchdown_s == Approx(1e-3 * (static_cast<double>(down) - 0.5)));
  // The knee's angle does not jump.
  const auto& knee = h.log.at("angle_knee_rad");
  CHECK(r.phases[1].at_touchdown_rad[3] == Approx(0.5 * (knee[down - 1] + knee[down])).margin(1e-2));
  for (const trees::Window& w : trees::windows_of(m, std::vector{r}, 0.3)) {
    const trees::Phase& p = r.phase_at(w.first);
    CHECK(w.first >= p.first);
    CHECK(w.last <= p.last);
  }

  log::Log without = h.log;
  without.columns.erase("contact_toe");
  CHECK_THAT(test::error_message([&] { trees::recording_of(m, without); }),
             Contains("hop.csv: foot 'toe' has no column 'contact_toe'"));
}

TEST_CASE("Flight and stance run as the planar leg's own plant does") {
  for (const auto spring : {gait::LegSpring::switched, gait::LegSpring::parallel}) {
    const gait::Machine machine = gait::spear(spring);
    const trees::TreeModel m = tree(machine);
    const Hop h = hop(machine, 1.5);
    const trees::Recording r = trees::recording_of(m, h.log);
    const trees::Setup setup = trees::SetupMaker(m).make({m.drives, m.causes});
    REQUIRE(r.phases.size() >= 2);
    for (const trees::Phase& p : r.phases) {
      const std::size_t last = std::min(p.last, p.first + 200);
      std::vector<double> angle, rate, out((last - p.first + 1) * 4);
      for (std::size_t j = 0; j < 4; ++j) {
        angle.push_back(r.angle_rad[j][p.first]);
        rate.push_back(h.rate[r.log_row[p.first]][j]);
      }
      trees::run(setup, r, p.first, last, angle, rate, out);
      double off = 0.0;
      for (std::size_t k = p.first; k <= last; ++k)
        for (std::size_t j = 0; j < 4; ++j)
          off = std::max(off, std::abs(out[(k - p.first) * 4 + j] - r.angle_rad[j][k]));
      // A switched spring's rest is known to half a row of the knee's motion, some mrad.
      const bool caught = p.stance && spring == gait::LegSpring::switched;
      CHECK(off < (caught ? 0.02 : 1e-4));
    }
  }
}

TEST_CASE("Effects of springs and links change what they say") {
  const trees::TreeModel m = spear();
  const Hop h = hop(gait::spear(gait::LegSpring::switched), 0.0);
  const trees::Recording r = trees::recording_of(m, h.log);
  const trees::SetupMaker maker(m);
  const trees::Phase &flight = r.phases[0], &stance = r.phases[1];
  const auto at = [&](Effect e, double value, std::size_t site, const trees::Phase& p) {
    return trees::in_phase(maker.make({m.drives, {{e, {site}, {value}}}}), r, p.first);
  };
  const trees::Setup air = trees::in_phase(maker.make({m.drives, {}}), r, flight.first),
                     ground = trees::in_phase(maker.make({m.drives, {}}), r, stance.first);
  CHECK(air.model.laws[3].one_way_nmprad == 0.0);
  CHECK(air.model.foothold.joint == -1);
  CHECK(ground.model.laws[3].one_way_nmprad == 60.67);
  CHECK(ground.model.foothold.joint == 3);
  CHECK(ground.model.laws[3].one_way_rest_rad == stance.at_touchdown_rad[3]);
  CHECK(at(Effect::spring_rate_error, 70.0, 3, stance).model.laws[3].one_way_nmprad == 70.0);
  CHECK(at(Effect::latch_offset, 0.1, 3, stance).model.laws[3].one_way_rest_rad ==
        Approx(stance.at_touchdown_rad[3] + 0.1));
  const std::size_t late = stance.first + 20;
  CHECK(at(Effect::latch_delay, r.time_s[late] - stance.touchdown_s, 3, stance)
            .model.laws[3]
            .one_way_rest_rad == Approx(r.angle_rad[3][late]).margin(1e-3));
  CHECK(at(Effect::second_spring, 0.7, 3, flight).joints[3].offset_nm == -0.7);
  CHECK(at(Effect::second_spring, 0.7, 3, stance).joints[3].offset_nm == 0.0);
  const std::size_t shank = [&] {
    std::size_t i = 0;
    while (m.robot.links[i].name != "shank") ++i;
    return i;
  }();
  CHECK(at(Effect::length_error, 0.02, shank, stance).model.foothold.at_m.z == Approx(-0.347));
  const std::size_t thigh = [&] {
    std::size_t i = 0;
    while (m.robot.links[i].name != "thigh") ++i;
    return i;
  }();
  const auto longer = at(Effect::length_error, 0.02, thigh, stance).model.tree(3).at;
  CHECK(std::sqrt(dot(longer, longer)) == Approx(0.34));
}

TEST_CASE(
    "A switch is late by one time in all recordings, and what that is not known by widens a latch's intervals") {
  const gait::Machine machine = gait::spear(gait::LegSpring::switched);
  const trees::TreeModel m = tree(machine);
  constexpr std::size_t kLate = 2;  // rows of 1 ms
  const auto late = [&](bool tells) {
    Hop h = hop(machine, 0.0);
    auto& contact = h.log.columns["contact_toe"];
    std::rotate(contact.rbegin(), contact.rbegin() + kLate, contact.rend());
    std::fill(contact.begin(), contact.begin() + kLate, 0.0);
    trees::Recording r = trees::recording_of(m, h.log);
    REQUIRE(r.switch_late_precision > 0.0);  // the toe lands hard
    if (!tells) r.switch_late_s = r.switch_late_precision = 0.0;
    return r;
  };
  const auto stance = [](const trees::Recording& r) -> const trees::Phase& { return r.phases.at(1); };
  // A recording that tells nothing learns it from the other; so do those that are held out.
  std::vector<trees::Recording> training{late(true), late(false)}, held_out{late(false)};
  // The toe lands somewhere between two rows.
  CHECK(training[0].switch_late_s == Approx(1e-3 * kLate).margin(0.6e-3));
  trees::share_lateness(training, held_out);
  for (const trees::Recording* r : {&training[0], &training[1], &held_out[0]})
    CHECK(stance(*r).touchdown_s == Approx(stance(*r).switched_s - training[0].switch_late_s).margin(2e-5));
  CHECK(training[0].switch_late_sd_s < 0.3e-3);
  // Where none tells it may be anything that is usual.
  std::vector<trees::Recording> silent{late(false), late(false)}, none;
  trees::share_lateness(silent, none);
  CHECK(stance(silent[0]).touchdown_s == stance(silent[0]).switched_s);
  CHECK(silent[0].switch_late_sd_s == Approx(1.2e-3));

  const auto sd_of_delay = [&](const std::vector<trees::Recording>& all) {
    trees::Problem problem(m, all, trees::windows_of(m, all, 0.3), 1);
    const trees::Hypothesis h{m.drives, {{Effect::latch_delay, {3}, {2e-3, 0, 0, 0}}}};
    problem.weigh(h);
    const trees::Fit fit = problem.fit(h, 2);
    std::size_t delay = 0;
    while (!fit.unknowns[delay].of_cause) ++delay;
    return std::sqrt(trees::variance_of(fit, delay));
  };
  CHECK(sd_of_delay(silent) >= 1.2e-3);
  CHECK(sd_of_delay(training) < 0.6e-3);
}

TEST_CASE(
    "The diagnosis names a softer spring of a leg that hops, and nothing on one that is as its model says") {
  const gait::Machine machine = gait::spear(gait::LegSpring::switched);
  const gait::Search low = test::found(gait::LegSpring::switched, test::in_place(0.075)),
                     high = test::found(gait::LegSpring::switched, test::in_place(0.15));
  REQUIRE(low.gait);
  REQUIRE(high.gait);
  const auto diagnosed = [&](const gait::Machine& real) {
    std::vector<log::Log> training, held_out;
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
      for (const gait::Search* g : {&low, &high}) {
        log::Log log = gait::log_of_gait(*g->gait, real, {.duration_s = 3.0, .seed = seed});
        log.path = std::to_string(seed) + (g == &low ? "low.csv" : "high.csv");
        (seed == 1 ? training : held_out).push_back(std::move(log));
      }
    return trees::diagnose(tree(machine), training, held_out);
  };
  gait::Machine soft = machine;
  soft.leg.stiffness_nmprad *= 0.85;
  const trees::Diagnosis d = diagnosed(soft);
  INFO(d.summary);
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings.front().cause.effect == Effect::spring_rate_error);
  CHECK(d.findings.front().parameters.front().value == Approx(soft.leg.stiffness_nmprad).epsilon(0.01));
  CHECK(d.extended_error[3].rmse < 0.2 * d.as_given_error[3].rmse);

  const trees::Diagnosis clean = diagnosed(machine);
  INFO(clean.summary);
  CHECK(clean.verdict == Verdict::adequate);
  CHECK(clean.findings.empty());
}

TEST_CASE("Where all recordings are in place a run is proposed, and the other way round") {
  const gait::Machine machine = gait::spear(gait::LegSpring::switched);
  const trees::TreeModel m = tree(machine);
  trees::Recording near = trees::recording_of(m, hop(machine, 0.0).log);
  for (double& x : near.angle_rad[0]) x = 0.3;
  trees::Recording far = near;
  for (std::size_t k = 0; k < far.rows(); ++k) far.angle_rad[0][k] += 1.0 * far.time_s[k];
  CHECK_THAT(trees::other_way_of_moving(m, {near, near}),
             Contains("All recordings are in place, where boom_travel"));
  CHECK_THAT(trees::other_way_of_moving(m, {far}), Contains("hops in place"));
  CHECK(trees::other_way_of_moving(m, {near, far}).empty());
}

TEST_CASE("A leg that plays a gait it cannot keep says when it fell") {
  gait::Machine weak = gait::spear(gait::LegSpring::switched);
  const gait::Search found = test::found(gait::LegSpring::switched, test::in_place(0.075));
  REQUIRE(found.gait);
  weak.leg.stiffness_nmprad = 1.0;
  CHECK_THAT(test::error_message([&] { gait::log_of_gait(*found.gait, weak); }),
             Contains("the robot falls at"));
}
