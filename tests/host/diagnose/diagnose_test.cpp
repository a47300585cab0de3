// The diagnosis: what it may see, what it must not depend on, and the command.
#include "host/diagnose/diagnose.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/core/error.hpp"
#include "host/diagnose/result.hpp"
#include "host/log/writer.hpp"
#include "host/model/reader.hpp"
#include "host/model/writer.hpp"
#include "host/result/diagnosis_json.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using diagnose::Verdict;

namespace {

/// An axis that coasts from one push to the next: with dry friction Fc and viscous friction d, between
/// switches of the force, v' = (u - Fc sgn v - d v)/m in closed form, from stop to stop.
log::Log coasting(double friction, double offset, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 2e-5);
  std::uniform_real_distribution<double> uniform(0.7, 1.3);
  const double mass = 95.0, damping = 200.0, rate = damping / mass, h = 0.001;
  double x = 0.0, v = 0.0;
  log::Log log;
  log.path = "coasting-" + std::to_string(seed) + ".csv";
  log.rig = "motor_axis";
  double u = 0.0, next = 0.0, sign = 1.0;
  for (int n = 0; n < 6000; ++n) {
    const double t = h * n;
    if (t >= next) {
      u = std::abs(u) > 0.0 ? 0.0 : sign * 80.0 * uniform(random);
      if (u != 0.0) sign = -sign;
      next = t + 0.35 * uniform(random);
    }
    log.columns["time_s"].push_back(t);
    log.columns["position_m"].push_back(x + noise(random));
    log.columns["force_n"].push_back(u);
    for (double left = h; left > 0.0;) {  // exact, with a stop inside the step if there is one
      const double push = u + offset;
      if (v == 0.0 && std::abs(push) <= friction) break;
      const double direction = v != 0.0 ? std::copysign(1.0, v) : std::copysign(1.0, push);
      const double terminal = (push - direction * friction) / damping;
      double time = left;
      bool stops = false;
      if (v != 0.0 && (terminal == 0.0 || std::signbit(terminal) != std::signbit(v))) {
        const double stop = std::log1p(-v / terminal) / rate;
        if (stop < left) {
          time = stop;
          stops = true;
        }
      }
      const double decay = std::exp(-rate * time);
      x += terminal * time + (v - terminal) * (1.0 - decay) / rate;
      v = stops ? 0.0 : terminal + (v - terminal) * decay;
      left -= time;
    }
  }
  return log;
}

std::vector<log::Log> coastings(double friction, double offset, unsigned first, unsigned count) {
  std::vector<log::Log> logs;
  for (unsigned i = 0; i < count; ++i) logs.push_back(coasting(friction, offset, first + i));
  return logs;
}

/// The position jumps by 10 mm in this row of each log.
std::vector<log::Log> with_slip(std::vector<log::Log> logs, const std::vector<std::size_t>& rows) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    auto& position = logs[i].columns["position_m"];
    for (std::size_t row = rows[i]; row < position.size(); ++row) position[row] += 0.01;
  }
  return logs;
}

std::string text(const diagnose::Diagnosis& d) { return result::to_json_text(diagnose::result_of(d)); }

}  // namespace

TEST_CASE("Dry friction of a closed form is named, with its size in the interval") {
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), coastings(20.0, 0.0, 1, 4),
                                    coastings(20.0, 0.0, 50, 1));
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == dynamics::Effect::coulomb_friction);
  const auto& force = d.findings[0].parameters.at("force_n");
  CHECK(force.value == Approx(20.0).epsilon(0.01));
  CHECK(force.lower < 20.0);
  CHECK(force.upper > 20.0);
  CHECK(d.findings[0].explainable_nmse_removed > 0.9);
}

TEST_CASE("Friction with an offset is one law under two names, and the diagnosis says so", "[long]") {
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), coastings(20.0, 4.0, 1, 4),
                                    coastings(20.0, 4.0, 50, 1));
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == dynamics::Effect::asymmetric_friction);
  REQUIRE(d.findings[0].indistinguishable_from.size() == 1);
  const auto& rival = d.findings[0].indistinguishable_from[0];
  CHECK(rival.names == std::vector<std::string>{"coulomb_friction", "force_offset"});
  CHECK(rival.parameters.at("force_offset.force_n").value == Approx(4.0).epsilon(0.02));
}

TEST_CASE("A friction that would push one way is named friction and a constant force", "[long][slow]") {
  // It pushes with 6 N on the way up and brakes with 14 N on the way down.
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), coastings(4.0, 10.0, 1, 4),
                                    coastings(4.0, 10.0, 50, 1));
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 2);
  for (const auto& f : d.findings) {
    const bool friction = f.effect == dynamics::Effect::coulomb_friction;
    CHECK((friction || f.effect == dynamics::Effect::force_offset));
    const auto& force = f.parameters.at("force_n");
    const double planted = friction ? 4.0 : 10.0;
    CHECK(force.value == Approx(planted).epsilon(0.02));
    CHECK(force.lower < planted);
    CHECK(force.upper > planted);
    CHECK(force.upper - force.lower < 1.0);
    CHECK(f.confidence > 0.9);
    REQUIRE(f.indistinguishable_from.size() == 1);
    const auto& rival = f.indistinguishable_from[0];
    CHECK(rival.names == std::vector<std::string>{"asymmetric_friction"});
    CHECK(rival.same_law);
    CHECK(rival.parameters.at("asymmetric_friction.force_up_n").value == Approx(-6.0).epsilon(0.02));
    CHECK(rival.parameters.at("asymmetric_friction.force_down_n").value == Approx(14.0).epsilon(0.02));
  }
}

TEST_CASE("An axis without a hidden cause is adequate, though its parameters are off", "[long]") {
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), coastings(0.0, 0.0, 1, 4),
                                    coastings(0.0, 0.0, 50, 1));
  INFO(text(d));
  CHECK(d.verdict == Verdict::adequate);
  CHECK(d.findings.empty());
}

TEST_CASE("Diagnosing with the extended model finds nothing more", "[long]") {
  const auto training = coastings(20.0, 4.0, 1, 4), held_out = coastings(20.0, 4.0, 50, 1);
  const auto first = diagnose::diagnose(test::axis_model(80.0, 150.0), training, held_out);
  // As it is written and read.
  const auto model = model::parse_model(model::format_model(first.extended_model), "extended_model.toml");
  const auto second = diagnose::diagnose(model, training, held_out);
  INFO(text(second));
  CHECK(second.findings.empty());
  CHECK(second.verdict == Verdict::adequate);
}

TEST_CASE("No fit and no choice sees the held-out recordings", "[long]") {
  const auto training = coastings(20.0, 0.0, 1, 3);
  const auto a = diagnose::diagnose(test::axis_model(80.0, 150.0), training, coastings(20.0, 0.0, 50, 1));
  // Held out: another machine altogether.
  const auto b = diagnose::diagnose(test::axis_model(80.0, 150.0), training, coastings(3.0, -9.0, 70, 1));
  REQUIRE(a.findings.size() == 1);
  REQUIRE(b.findings.size() == 1);
  CHECK(a.findings[0].effect == b.findings[0].effect);
  CHECK(a.findings[0].parameters.at("force_n").value == b.findings[0].parameters.at("force_n").value);
  CHECK(a.extended_model.parameters == b.extended_model.parameters);
  REQUIRE(a.candidates.size() == b.candidates.size());
  for (std::size_t i = 0; i < a.candidates.size(); ++i)
    CHECK(a.candidates[i].training_gain == b.candidates[i].training_gain);
  // And the held-out figures tell: on the other machine the finding helps less, and is less sure.
  CHECK(b.findings[0].explainable_nmse_removed < a.findings[0].explainable_nmse_removed);
  CHECK(b.findings[0].confidence <= a.findings[0].confidence);
}

TEST_CASE("A name that the held-out recordings do not bear out stays, without confidence", "[long]") {
  // Trained with dry friction, held out a machine that has none and is pushed on instead.
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), coastings(20.0, 0.0, 1, 3),
                                    coastings(0.0, 15.0, 50, 2));
  INFO(text(d));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == dynamics::Effect::coulomb_friction);
  CHECK(d.findings[0].parameters.at("force_n").value == Approx(20.0).epsilon(0.02));
  CHECK(d.findings[0].confidence <= 0.4);
  CHECK(d.verdict != Verdict::explained);
}

TEST_CASE("A slip that nothing predicts is in no held-out figure, and is told as it was seen",
          "[long][slow]") {
  const auto training = with_slip(coastings(20.0, 0.0, 1, 3), {1500, 2600, 3900});
  const auto clean = diagnose::diagnose(test::axis_model(80.0, 150.0), training, coastings(20.0, 0.0, 50, 2));
  const auto slipped = diagnose::diagnose(test::axis_model(80.0, 150.0), training,
                                          with_slip(coastings(20.0, 0.0, 50, 2), {3200, 4700}));
  INFO(text(slipped));
  for (const auto& d : {clean, slipped}) {
    REQUIRE(d.findings.size() == 2);
    for (const auto& f : d.findings) {
      const bool slip = f.effect == dynamics::Effect::encoder_slip;
      CHECK((slip || f.effect == dynamics::Effect::coulomb_friction));
      if (!slip) continue;
      CHECK(f.events.size() == 3);
      CHECK(f.parameters.at("step_m").value == Approx(0.01).epsilon(0.02));
    }
    CHECK(d.verdict == Verdict::explained);
  }
  CHECK(clean.windows_excluded == 0);
  for (const auto& f : slipped.findings)
    if (f.effect == dynamics::Effect::encoder_slip) CHECK(f.observed_events.size() == 2);
  // Of six seconds each, what holds or follows the slip at 3.2 s and at 4.7 s: from 3.0 s and from 4.5 s on.
  CHECK(slipped.windows_excluded == 9);
  CHECK(clean.extended_model.parameters == slipped.extended_model.parameters);
  // Without it the error is that of the recordings without a slip.
  CHECK(slipped.extended.at("position").rmse < 2.0 * clean.extended.at("position").rmse);
}

TEST_CASE("A slip that comes at the same time in each recording is predictable", "[long][slow]") {
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0),
                                    with_slip(coastings(20.0, 0.0, 1, 3), {2200, 2200, 2200}),
                                    with_slip(coastings(20.0, 0.0, 50, 2), {2200, 2200}));
  INFO(text(d));
  CHECK(d.windows_excluded == 0);
  CHECK(d.refitted.at("position").rmse > 1e-3);
  CHECK(d.extended.at("position").rmse < 5e-4);
  // One that does not come is missed by its whole step.
  const auto missed = diagnose::diagnose(test::axis_model(80.0, 150.0),
                                         with_slip(coastings(20.0, 0.0, 1, 3), {2200, 2200, 2200}),
                                         coastings(20.0, 0.0, 50, 2));
  REQUIRE(missed.findings.size() == 2);
  CHECK(missed.extended.at("position").rmse > 1e-3);
}

TEST_CASE("One thread and two give the same bytes", "[long]") {
  diagnose::Options one, two;
  one.threads = 1;
  two.threads = 2;
  const auto training = coastings(20.0, 0.0, 1, 3), held_out = coastings(20.0, 0.0, 50, 1);
  CHECK(text(diagnose::diagnose(test::axis_model(80.0, 150.0), training, held_out, one)) ==
        text(diagnose::diagnose(test::axis_model(80.0, 150.0), training, held_out, two)));
}

TEST_CASE("Recordings without a stride, or shorter than a window, are refused with what was expected") {
  log::Log still;
  still.path = "still.csv";
  for (int n = 0; n < 500; ++n) {
    still.columns["time_s"].push_back(1e-3 * n);
    still.columns["height_m"].push_back(0.30 + 0.01 * std::sin(0.02 * n));
    still.columns["torque_cmd_nm"].push_back(0.0);
  }
  CHECK_THROWS_WITH(
      diagnose::diagnose(test::hopper_model(), {still}, {still}),
      Catch::Contains("still.csv") && Catch::Contains("apex to apex") && Catch::Contains("0.2819"));
  const std::vector<log::Log> brief{test::axis_log(95.0, 200.0, 1e-4, 1, 0.2)};
  CHECK_THROWS_WITH(diagnose::diagnose(test::axis_model(80.0, 150.0), brief, brief),
                    Catch::Contains("--window-s"));
}

TEST_CASE("A machine that differs from the one recorded in training is not called adequate", "[long]") {
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), coastings(0.0, 0.0, 1, 4),
                                    coastings(10.0, 0.0, 50, 1));
  INFO(text(d));
  CHECK(d.verdict == Verdict::unexplained);
}

TEST_CASE("An effect that is on with a wrong size is named with the true one", "[long]") {
  auto model = test::axis_model(80.0, 150.0);
  model.effects[dynamics::Effect::coulomb_friction] = {5.0};
  const auto d = diagnose::diagnose(model, coastings(20.0, 0.0, 1, 4), coastings(20.0, 0.0, 50, 1));
  INFO(text(d));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == dynamics::Effect::coulomb_friction);
  CHECK(d.extended_model.effects.at(dynamics::Effect::coulomb_friction)[0] == Approx(20.0).epsilon(0.01));
}

TEST_CASE("Axes that never move are refused, and one still recording does not outweigh those that do") {
  auto still = coasting(20.0, 0.0, 9);
  for (double& x : still.columns["position_m"]) x = 0.125;
  CHECK_THROWS_WITH(diagnose::diagnose(test::axis_model(80.0, 150.0), {still}, {still}),
                    Catch::Contains("never moves"));
  for (double& u : still.columns["force_n"]) u = 0.0;
  auto training = coastings(20.0, 0.0, 1, 3);
  training.push_back(still);
  const auto d = diagnose::diagnose(test::axis_model(80.0, 150.0), training, coastings(20.0, 0.0, 50, 1));
  INFO(text(d));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == dynamics::Effect::coulomb_friction);
}

TEST_CASE("diagnose writes its three files and traces, and the extended model is one that sim reads") {
  const test::TemporaryFolder folder;
  const std::string model = folder.file("model.toml", model::format_model(test::axis_model(80.0, 150.0)));
  std::vector<std::string> arguments{"diagnose", "--model", model, "--out", folder.path() + "/out"};
  for (const auto& log : coastings(20.0, 0.0, 1, 3))
    arguments.push_back(folder.file(log.path, log::format_log(log)));
  const auto ran = test::run_furcula(arguments, 120);
  INFO(ran.err);
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Catch::Contains("explained") && Catch::Contains("coulomb_friction"));
  CHECK(ran.err.empty());  // no bar where there is no terminal, and no library talking
  CHECK(test::run_program("/bin/ls", {folder.path() + "/out"}).out ==
        "diagnosis.json\nextended_model.toml\nreport.html\ntraces\n");
  const auto sim = test::run_furcula(
      {"sim", "--model", folder.path() + "/out/extended_model.toml", "--out", folder.path() + "/sim.csv"},
      60);
  INFO(sim.err);
  CHECK(sim.status == 0);
}

TEST_CASE("Bounds below zero that exclude the data are widened away from zero and towards it") {
  // A pendulum whose zero is at the top: gravity pulls away from it, by -0.5 N m instead of -3 to -1.
  const auto truth = model::parse_model(
      "[model]\nkind = \"rotary_joint\"\nschema = 1\n"
      "[parameters]\ninertia_kgm2 = 0.15\ngravity_torque_nm = -0.5\ndamping_nmspr = 0.3\n",
      "truth.toml");
  model::Model model = truth;
  model.parameters[1] = -2.0;
  model.free[1] = {-3.0, -1.0};
  std::vector<log::Log> logs;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    sim::Scenario s = sim::default_scenario(truth);
    s.amplitude = 1.0 + 0.2 * seed;
    s.period_s = 1.5;
    s.duration_s = 4.0;
    s.sensors = {.quantisation = true, .noise = true};
    logs.push_back(sim::simulate(truth, s, seed));
    logs.back().path = "joint-" + std::to_string(seed) + ".csv";
  }
  const auto d = diagnose::diagnose(model, {logs[0], logs[1], logs[2]}, {logs[3]});
  INFO(text(d));
  REQUIRE(d.beyond_bounds.size() == 1);
  CHECK(d.beyond_bounds[0].name == "gravity_torque_nm");
  CHECK(d.beyond_bounds[0].value == Approx(-0.5).epsilon(0.05));
}

TEST_CASE("Bounds that exclude the data are said to, and no cause is named in their place") {
  std::vector<log::Log> training, held_out;
  for (unsigned seed = 1; seed <= 4; ++seed)
    (seed < 4 ? training : held_out).push_back(test::axis_log(20.0, 30.0, 1e-5, seed));
  model::Model model = test::axis_model(26.0, 30.0);
  model.free[0] = {25.0, 28.0};
  const auto d = diagnose::diagnose(model, training, held_out);
  CHECK(d.verdict == Verdict::not_identifiable);
  CHECK(d.findings.empty());
  REQUIRE(d.beyond_bounds.size() == 1);
  CHECK(d.beyond_bounds[0].name == "mass_kg");
  CHECK(d.beyond_bounds[0].value == Approx(20.0).epsilon(1e-3));
  CHECK_THAT(d.summary, Catch::Contains("mass_kg = 20 kg (bounds 25 to 28)"));
}
