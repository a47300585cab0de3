// Diagnoses and identifications of an arm of three joints, on logs of an arm with a known cause.
#include "host/trees/diagnose.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "host/result/diagnosis_json.hpp"
#include "host/trees/identify.hpp"
#include "host/trees/result.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"
#include "tests/schema.hpp"

using namespace furcula;
using Catch::Contains;
using trees::Effect;
using trees::Verdict;

namespace {

struct Logs {
  std::vector<log::Log> training, held_out;
};
Logs logs_of(const trees::TreeModel& truth, unsigned seed) {
  Logs out;
  out.training = test::logs(truth, 3, 5.0, seed);
  out.held_out = test::logs(truth, 1, 5.0, seed + 50);
  return out;
}

std::set<Effect> effects_named(const trees::Diagnosis& d) {
  std::set<Effect> out;
  for (const trees::Finding& f : d.findings) out.insert(f.cause.effect);
  return out;
}

}  // namespace

TEST_CASE("A cause at one joint of an arm is found there, within three standard deviations") {
  struct Case {
    Effect effect;
    std::string at;
    double value;
  };
  for (const Case& c :
       {Case{Effect::coulomb_friction, "elbow", 0.3}, Case{Effect::force_offset, "shoulder", -0.4}}) {
    trees::TreeModel truth = test::arm3();
    truth.causes = {{c.effect, {test::joint(truth, c.at)}, {c.value, 0, 0, 0}}};
    const Logs logs = logs_of(truth, 40);
    const trees::Diagnosis d = trees::diagnose(test::arm3(), logs.training, logs.held_out);
    INFO(result::to_json_text(trees::result_of(d)).substr(0, 4000));
    CHECK((d.verdict == Verdict::explained || d.verdict == Verdict::not_identifiable));
    REQUIRE_FALSE(d.findings.empty());
    const trees::Finding& f = d.findings.front();
    CHECK(f.cause.effect == c.effect);
    CHECK(f.at == std::vector<std::string>{c.at});
    REQUIRE(f.parameters.size() == 1);
    const double deviation = (f.parameters[0].upper - f.parameters[0].lower) / (2.0 * 1.96);
    CHECK(std::abs(f.parameters[0].value - c.value) < 3.0 * deviation);
    CHECK(deviation < 0.05 * std::abs(c.value));
    CHECK(d.findings.size() == 1);
    const std::size_t j = test::joint(truth, c.at);
    CHECK(d.extended_error[j].rmse < 0.6 * d.refitted_error[j].rmse);
    // One of the column, seven of each link behind it; all joints move.
    CHECK(d.base_parameters.size() == 15);
    const auto json = nlohmann::json::parse(result::to_json_text(trees::result_of(d)));
    REQUIRE(json["base_parameters"].size() == 15);
    const auto& fore = json["base_parameters"].back();
    CHECK(fore["combination"] == "Iyz(fore)");
    CHECK(fore["unit"] == "kg m^2");
    CHECK(fore["location"].is_string());
    CHECK(fore["torque_rms_nm"].is_number());
    CHECK(fore["baseline"] == fore["extended"]);
    std::size_t shown = 0;
    for (const auto& b : json["base_parameters"]) shown += b["identified"] == true ? 1 : 0;
    CHECK(shown > 7);
    CHECK(
        d.notes.back() ==
        "Of the bodies' 30 inertial parameters the joints' torques depend on 15 combinations; these recordings show " +
            std::to_string(shown) + " of them.");
  }
}

TEST_CASE("A lag that one recording of four shows best, by its steps, is found") {
  const char* const drives = "[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 60.0\nkd_nmsprad = 2.0\n";
  trees::TreeModel truth = test::arm3(drives);
  const std::size_t elbow = test::joint(truth, "elbow");
  truth.causes = {{Effect::actuator_lag, {elbow}, {0.008, 0, 0, 0}}};
  Logs logs;
  for (unsigned i = 0; i < 5; ++i) {
    trees::Scenario s = trees::default_scenario(truth);
    s.duration_s = 5.0;
    for (trees::Path& path : s.paths) path.phase_rad += 1.1 * i;
    if (i == 1 || i == 4)
      for (trees::Path& path : s.paths) path.profile = trees::Path::Profile::steps;
    (i < 4 ? logs.training : logs.held_out).push_back(trees::simulate(truth, s, 70 + i));
  }
  const trees::Diagnosis d = trees::diagnose(test::arm3(drives), logs.training, logs.held_out);
  INFO(d.summary);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].cause.effect == Effect::actuator_lag);
  CHECK(d.findings[0].at == std::vector<std::string>{"elbow"});
  CHECK(d.findings[0].parameters[0].value == Approx(0.008).epsilon(0.1));
  CHECK(d.verdict != Verdict::unexplained);
}

TEST_CASE("What is not known of a position law's rate is noted, and a confidence says what lowers it") {
  trees::TreeModel truth =
      test::arm3("[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 40.0\nkd_nmsprad = 2.0\n");
  truth.causes = {{Effect::actuator_delay, {test::joint(truth, "elbow")}, {0.004, 0, 0, 0}}};
  const Logs logs = logs_of(truth, 90);
  trees::TreeModel model = truth;
  model.causes.clear();
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out);
  const auto noted = [](const trees::Diagnosis& all) {
    return std::count_if(all.notes.begin(), all.notes.end(), [](const std::string& note) {
      return note.find("loop_rate_hz") != std::string::npos;
    });
  };
  REQUIRE(noted(d) == 1);
  CHECK_THAT(d.notes.front(), Contains("0.02 N m s/rad less damping and 0.001 kg m^2"));
  for (const trees::Finding& f : d.findings) CHECK((f.confidence >= 0.9 || !f.lowered_by.empty()));
  for (trees::Drive& drive : model.drives) drive.loop_rate_hz = 1e5;
  CHECK(noted(trees::diagnose(model, logs.training, logs.held_out)) == 0);
}

TEST_CASE("Dry friction of a joint that nothing drives is found, that no inertia shows is said") {
  const trees::TreeModel given = test::pendulum();
  // The same rod by its equation of motion, let go from some angle: m g l and the inertia about the hinge.
  const double gravity_nm = 0.8 * 9.80665 * 0.3, inertia_kgm2 = 0.025 + 0.8 * 0.3 * 0.3;
  const auto swings = [&](double friction_nm, double from_rad, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> white(0.0, 1.0);
    log::Log log = test::logs(given, 1, 5.0, seed).front();
    const double dt = 2e-4;
    const auto& time = log.time_s();
    double angle = from_rad, rate = 0.0, t = 0.0, push_nm = 0.0;
    for (std::size_t k = 0; k < log.rows(); ++k) {
      for (; t < time[k] - 0.5 * dt; t += dt) {
        push_nm += dt / 0.02 * (-push_nm + 0.005 * std::sqrt(2.0 * 0.02 / dt) * white(random));
        rate += dt / inertia_kgm2 * (push_nm - gravity_nm * std::sin(angle) - 0.02 * rate);
        const double stops = dt / inertia_kgm2 * friction_nm;
        rate = std::abs(rate) < stops ? 0.0 : rate - std::copysign(stops, rate);
        angle += dt * rate;
      }
      log.columns["angle_hinge_rad"][k] = angle + 1e-4 * white(random);
      log.columns["torque_hinge_nm"][k] = log.columns["torque_cmd_hinge_nm"][k] = 0.0;
    }
    return log;
  };
  for (const double friction_nm : {0.0, 0.05}) {
    const trees::Diagnosis d = trees::diagnose(
        given, {swings(friction_nm, 1.9, 1), swings(friction_nm, -1.4, 2)}, {swings(friction_nm, 1.6, 3)});
    INFO(result::to_json_text(trees::result_of(d)).substr(0, 4000));
    CHECK(std::none_of(d.base_parameters.begin(), d.base_parameters.end(),
                       [](const auto& b) { return b.shown; }));
    REQUIRE(d.notes.size() == 2);
    CHECK_THAT(d.notes[1], Contains("No drive acts"));
    REQUIRE(d.findings.size() == (friction_nm > 0.0 ? 1 : 0));
    CHECK(d.verdict == (friction_nm > 0.0 ? Verdict::explained : Verdict::adequate));
    if (d.findings.empty()) continue;
    CHECK(d.findings[0].cause.effect == Effect::coulomb_friction);
    CHECK(d.findings[0].parameters[0].value == Approx(friction_nm).epsilon(0.03));
    CHECK(d.extended_error[0].rmse < 0.3 * d.refitted_error[0].rmse);
  }
}

TEST_CASE("A drive that gives much less than its position law asks for has a limit") {
  const trees::TreeModel model =
      test::pendulum("[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 40\nkd_nmsprad = 2\n");
  // What the spring of the law asks for without a limit; its damper takes most of that back.
  double squares = 0.0, rows = 0.0;
  for (const log::Log& log : test::logs(model, 4, 6.0, 5))
    for (std::size_t k = 0; k < log.rows(); ++k, rows += 1.0)
      squares += std::pow(
          40.0 * (log.columns.at("angle_cmd_hinge_rad")[k] - log.columns.at("angle_hinge_rad")[k]), 2);
  const double limit_nm = 0.08 * std::sqrt(squares / rows);
  trees::TreeModel truth = model;
  truth.causes = {{Effect::torque_saturation, {0}, {limit_nm, 0, 0, 0}}};
  const std::vector<log::Log> all = test::logs(truth, 4, 6.0, 5);
  const trees::Diagnosis d = trees::diagnose(model, {all[0], all[1], all[2]}, {all[3]});
  INFO(d.summary);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].cause.effect == Effect::torque_saturation);
  CHECK(d.findings[0].parameters[0].value == Approx(limit_nm).epsilon(0.03));
}

TEST_CASE("A search that is ended says so and leaves room for more") {
  const trees::TreeModel model = test::arm3();
  trees::TreeModel truth = model;
  truth.causes.push_back({Effect::coulomb_friction, {2}, {0.3, 0, 0, 0}});
  const Logs logs = logs_of(truth, 5);
  const trees::Diagnosis whole = trees::diagnose(model, logs.training, logs.held_out);
  CHECK(whole.verdict == Verdict::explained);
  trees::Options little;
  little.most_work = 1;
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out, little);
  INFO(d.summary);
  CHECK(d.verdict != Verdict::explained);
  CHECK(d.verdict != Verdict::adequate);
  CHECK(std::any_of(d.notes.begin(), d.notes.end(), [](const std::string& note) {
    return note.find("The search was ended") != std::string::npos;
  }));
}

TEST_CASE("A Stribeck curve beside damping is not Coulomb friction beside drag", "[slow]") {
  const trees::TreeModel model = test::arm3();
  trees::TreeModel truth = model;
  const std::size_t elbow = test::joint(truth, "elbow");
  truth.causes = {{Effect::stribeck_friction, {elbow}, {0.15, 0.35, 0.6, 0}},
                  {Effect::damping_error, {elbow}, {model.drives[elbow].damping_nmspr + 0.4, 0, 0, 0}}};
  const Logs logs = logs_of(truth, 70);
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out);
  INFO(d.summary);
  CHECK(effects_named(d) == std::set<Effect>{Effect::stribeck_friction, Effect::damping_error});
}

TEST_CASE("A Stribeck curve beside a constant torque is not friction of two sizes in the two directions",
          "[slow]") {
  const trees::TreeModel model = test::arm3();
  trees::TreeModel truth = model;
  const std::size_t elbow = test::joint(truth, "elbow");
  truth.causes = {{Effect::stribeck_friction, {elbow}, {0.12, 0.4, 0.5, 0}},
                  {Effect::force_offset, {elbow}, {0.15, 0, 0, 0}}};
  const Logs logs = logs_of(truth, 74);
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out);
  INFO(d.summary);
  CHECK(effects_named(d) == std::set<Effect>{Effect::stribeck_friction, Effect::force_offset});
}

TEST_CASE("Friction of two sizes in the two directions is not a curve that falls towards standstill",
          "[slow]") {
  const trees::TreeModel model = test::arm3();
  trees::TreeModel truth = model;
  const std::size_t elbow = test::joint(truth, "elbow");
  truth.causes = {{Effect::asymmetric_friction, {elbow}, {0.12, 0.4, 0, 0}}};
  const Logs logs = logs_of(truth, 78);
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out);
  INFO(d.summary);
  const auto names = effects_named(d);
  CHECK((names == std::set<Effect>{Effect::asymmetric_friction} ||
         names == std::set<Effect>{Effect::coulomb_friction, Effect::force_offset}));
}

TEST_CASE(
    "Dry friction beside a drag is not a Stribeck curve beside damping, and a curve that does not rise is none",
    "[slow]") {
  trees::TreeModel truth = test::arm3();
  const std::size_t elbow = test::joint(truth, "elbow");
  truth.causes = {{Effect::coulomb_friction, {elbow}, {0.137, 0, 0, 0}},
                  {Effect::quadratic_drag, {elbow}, {0.0885, 0, 0, 0}}};
  Logs logs = logs_of(truth, 113);
  const trees::Diagnosis drag = trees::diagnose(test::arm3(), logs.training, logs.held_out);
  INFO(drag.summary);
  CHECK(effects_named(drag) == std::set<Effect>{Effect::coulomb_friction, Effect::quadratic_drag});

  truth.causes = {{Effect::asymmetric_friction, {elbow}, {0.178, 0.682, 0, 0}}};
  logs = logs_of(truth, 103);
  const trees::Diagnosis two_sizes = trees::diagnose(test::arm3(), logs.training, logs.held_out);
  INFO(two_sizes.summary);
  CHECK(effects_named(two_sizes).count(Effect::stribeck_friction) == 0);
}

TEST_CASE("Clocks that are apart are named, where a delay of all drives would do the same, both are") {
  for (const double skew_s : {-0.015, 0.015}) {
    INFO(skew_s);
    trees::TreeModel truth = test::arm3();
    truth.causes = {{Effect::time_skew, {0}, {skew_s, 0, 0, 0}}};
    const Logs logs = logs_of(truth, 90);
    const trees::Diagnosis d = trees::diagnose(test::arm3(), logs.training, logs.held_out);
    INFO(d.summary);
    REQUIRE(d.findings.size() == 1);
    const trees::Finding& f = d.findings.front();
    CHECK(f.parameters[0].value == Approx(skew_s).margin(0.001));
    if (skew_s < 0.0) {
      CHECK(f.cause.effect == Effect::time_skew);
      CHECK(f.at == std::vector<std::string>{"log"});
      CHECK_THAT(d.summary, Contains("a skew between the clocks of position and torque in the log"));
    } else {
      // Both do the same to the last digit: either may be the finding, the other is told beside it.
      const bool delay = f.cause.effect == Effect::actuator_delay;
      CHECK((delay || f.cause.effect == Effect::time_skew));
      CHECK(f.at.size() == (delay ? 3 : 1));
      REQUIRE_FALSE(f.indistinguishable_from.empty());
      CHECK(label(f.indistinguishable_from.front().causes) ==
            (delay ? "time_skew@log" : "actuator_delay@yaw,shoulder,elbow"));
      // One law under two names: that is explained (docs/contracts.md, section 3).
      CHECK(d.verdict == Verdict::explained);
    }
  }
}

TEST_CASE("The torque that is missing before and after is of the same instants") {
  // The same measured motion is in both, with all its noise: their difference is the friction that was found.
  trees::TreeModel truth = test::arm3();
  const std::size_t elbow = test::joint(truth, "elbow");
  truth.causes = {{Effect::coulomb_friction, {elbow}, {0.3, 0, 0, 0}}};
  const Logs logs = logs_of(truth, 40);
  const trees::Diagnosis d = trees::diagnose(test::arm3(), logs.training, logs.held_out);
  const trees::MissingTorque& m = d.missing[elbow];
  REQUIRE(m.before_nm.size() == m.after_nm.size());
  REQUIRE(m.before_nm.size() == m.velocity_radps.size());
  REQUIRE(m.before_nm.size() > 300);
  std::vector<double> apart;
  for (std::size_t i = 0; i < m.before_nm.size(); ++i)
    apart.push_back(
        std::abs(m.before_nm[i] - m.after_nm[i] + 0.3 * (m.velocity_radps[i] > 0.0 ? 1.0 : -1.0)));
  std::sort(apart.begin(), apart.end());
  CHECK(apart[apart.size() / 2] < 0.02);
}

TEST_CASE("A model that was extended lacks nothing more, and keeps the values that it has") {
  trees::TreeModel truth = test::arm3();
  truth.causes = {{Effect::coulomb_friction, {test::joint(truth, "elbow")}, {0.3, 0, 0, 0}}};
  const Logs logs = logs_of(truth, 40);
  const trees::Diagnosis again = trees::diagnose(truth, logs.training, logs.held_out);
  INFO(again.summary);
  CHECK(again.verdict == Verdict::adequate);
  CHECK(again.extended.causes == truth.causes);
}

TEST_CASE("Logs of an arm as it is modelled are adequate, with the same bytes on one thread and on two") {
  const trees::TreeModel model = test::arm3();
  const Logs logs = logs_of(model, 70);
  trees::Options options;
  options.threads = 1;
  const trees::Diagnosis d = trees::diagnose(model, logs.training, logs.held_out, options);
  INFO(d.summary);
  CHECK(d.verdict == Verdict::adequate);
  CHECK(d.findings.empty());
  CHECK(d.logs == 4);
  CHECK(d.held_out_logs == 1);
  options.threads = 2;
  CHECK(result::to_json_text(trees::result_of(trees::diagnose(
            model, logs.training, logs.held_out, options))) == result::to_json_text(trees::result_of(d)));
}

TEST_CASE("Identification finds what shows and says what does not") {
  const trees::TreeModel truth = test::arm3("[drive.elbow]\ndamping_nmspr = 0.25\n");
  const Logs logs = logs_of(truth, 90);
  const trees::TreeModel model = test::arm3(
      "[free]\n\"damping_nmspr.elbow\" = [0.0, 2.0]\n\"damping_nmspr.yaw\" = [0.0, 2.0]\n\"rotor_inertia_kgm2.elbow\" = [0.0, 0.1]\n");
  const trees::Identification found = trees::identify(model, logs.training, logs.held_out);
  REQUIRE(found.parameters.size() == 3);
  for (const auto& p : found.parameters) {
    INFO(p.name << " " << p.value << " [" << p.lower << ", " << p.upper << "] " << p.verdict);
    if (p.name == "damping_nmspr.elbow") {
      CHECK(p.verdict == "identified");
      CHECK(p.unit == "N m s/rad");
      CHECK(p.given == 0.1);
      CHECK(p.value == Approx(0.25).epsilon(0.1));
    }
    if (p.name == "damping_nmspr.yaw") CHECK(p.value == Approx(0.1).epsilon(0.2));
    // There is none, and it cannot be less.
    if (p.name == "rotor_inertia_kgm2.elbow") CHECK(p.value < 0.002);
  }
  CHECK(found.model.drives[2].damping_nmspr == Approx(0.25).epsilon(0.1));
  CHECK(found.identified_error[2].rmse < found.as_given_error[2].rmse);
  CHECK_THAT(trees::to_json_text(found),
             Contains("\"furcula-identification/2\"") && Contains("damping_nmspr.elbow"));
  CHECK(test::schema_violations("furcula-identification-2", trees::to_json_text(found)).value_or("") == "");
  CHECK_THAT(test::error_message([&] { trees::identify(test::arm3(), logs.training, logs.held_out); }),
             Contains("no parameter in [free]") && Contains("damping_nmspr.yaw"));
}

TEST_CASE("What a joint that stands still would tell is not excited") {
  const trees::TreeModel model =
      test::arm3("[free]\n\"damping_nmspr.yaw\" = [0.0, 0.5]\n\"damping_nmspr.elbow\" = [0.0, 0.5]\n");
  std::vector<log::Log> logs;
  for (unsigned seed = 0; seed < 4; ++seed) {
    trees::Scenario s = trees::default_scenario(model);
    s.duration_s = 4.0;
    s.paths[0].profile = trees::Path::Profile::hold;
    s.paths[2].phase_rad = seed;
    s.disturbance_share = 0.0;
    logs.push_back(trees::simulate(model, s, seed));
    logs.back().path = "still.csv";
  }
  const trees::Identification found = trees::identify(model, {logs[0], logs[1], logs[2]}, {logs[3]});
  for (const auto& p : found.parameters) {
    INFO(p.name << " " << p.value << " [" << p.lower << ", " << p.upper << "] " << p.verdict);
    if (p.name == "damping_nmspr.yaw") CHECK(p.verdict != "identified");
    if (p.name == "damping_nmspr.elbow") CHECK(p.verdict == "identified");
  }
}
