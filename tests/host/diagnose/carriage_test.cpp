// Causes planted in the flights of a rail carriage: what falls show, what only throws do, and what neither
// can.
#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "host/core/error.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/result/diagnosis_json.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using diagnose::Verdict;
using dynamics::Effect;
using test::Flight;

namespace {

diagnose::Diagnosis diagnosed(const Flight& truth, bool throws,
                              const model::Model& model = test::carriage_model()) {
  return diagnose::diagnose(model, test::flight_logs(truth, throws, 1, 10),
                            test::flight_logs(truth, throws, 50, 2));
}

std::string text(const diagnose::Diagnosis& d) { return result::to_json_text(diagnose::result_of(d)); }

/// Single effects that a finding cannot be told from.
std::set<std::string> rivals(const diagnose::Finding& f) {
  std::set<std::string> all;
  for (const auto& r : f.indistinguishable_from)
    if (r.names.size() == 1) all.insert(r.names.front());
  return all;
}

/// A flight under a force of its own beside that of `truth`: what disturbs a machine.
log::Log disturbed_flight(Flight truth, bool thrown, unsigned seed) {
  std::mt19937_64 random(seed + 1000);
  std::normal_distribution<double> disturbance(0.0, 0.02);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  truth.force += disturbance(random);
  truth.height = thrown ? 0.0 : 0.8 + 0.4 * share(random);
  truth.velocity = thrown ? 2.0 + 1.5 * share(random) : 0.0;
  return test::flight_log(truth, 9e-5, seed);
}

std::vector<log::Log> disturbed_flights(const Flight& truth, bool thrown, unsigned first, unsigned count) {
  std::vector<log::Log> logs;
  for (unsigned seed = first; seed < first + count; ++seed)
    logs.push_back(disturbed_flight(truth, thrown, seed));
  return logs;
}

/// The size of dry friction, up and down the same, whichever of its names it has.
diagnose::Estimate coulomb(const diagnose::Diagnosis& d) {
  for (const auto& f : d.findings) {
    if (f.effect == Effect::coulomb_friction) return f.parameters.at("force_n");
    if (f.effect != Effect::asymmetric_friction) continue;
    const auto &up = f.parameters.at("force_up_n"), &down = f.parameters.at("force_down_n");
    return {0.5 * (up.value + down.value), 0.5 * (up.lower + down.lower), 0.5 * (up.upper + down.upper)};
  }
  return {};
}

}  // namespace

TEST_CASE("A carriage without a hidden cause is adequate, in falls and in throws") {
  for (const bool throws : {false, true}) {
    const auto d = diagnosed({.damping = 1.4}, throws);
    INFO(text(d));
    CHECK(d.verdict == Verdict::adequate);
    CHECK(d.findings.empty());
  }
}

TEST_CASE("Falls alone do not tell friction from an offset or a tilt, and the diagnosis says so") {
  for (const Flight& truth : {Flight{.friction = 1.2}, Flight{.force = 1.2}}) {
    const auto d = diagnosed(truth, false);
    INFO(text(d));
    CHECK(d.verdict == Verdict::not_identifiable);
    REQUIRE(d.findings.size() == 1);
    CHECK(d.findings[0].effect == Effect::coulomb_friction);  // the first of the catalogue
    CHECK(d.findings[0].parameters.at("force_n").value == Approx(1.2).epsilon(0.02));
    CHECK(rivals(d.findings[0]).contains("force_offset"));
    CHECK(rivals(d.findings[0]).contains("guide_tilt"));
    CHECK(d.findings[0].confidence <= 0.5);
    CHECK_THAT(d.next_experiment, Catch::Contains("pushed up from the stop"));
  }
}

TEST_CASE("Throws upwards name dry friction, with its size in the interval") {
  const auto d = diagnosed({.friction = 1.2}, true);
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::coulomb_friction);
  CHECK(d.findings[0].indistinguishable_from.empty());
  const auto& force = d.findings[0].parameters.at("force_n");
  CHECK(force.value == Approx(1.2).epsilon(0.01));
  CHECK(force.lower < 1.2);
  CHECK(force.upper > 1.2);
}

TEST_CASE("A constant force, a tilt and a wrong scale are one law in free flight, named by the first",
          "[long]") {
  for (const double force : {1.2, -1.2}) {
    const auto d = diagnosed({.force = force}, true);
    INFO(text(d));
    CHECK(d.verdict == Verdict::explained);
    REQUIRE(d.findings.size() == 1);
    CHECK(d.findings[0].effect == Effect::force_offset);
    CHECK(d.findings[0].parameters.at("force_n").value == Approx(force).epsilon(0.01));
    CHECK(rivals(d.findings[0]).contains("guide_tilt") == (force > 0.0));  // a tilt takes weight off
    CHECK(rivals(d.findings[0]).contains("height_scale_error"));
  }
}

TEST_CASE("Friction of different size up and down is told from friction alone by throws") {
  const auto d = diagnosed({.friction = 1.5, .force = 0.5}, true);
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::asymmetric_friction);
  CHECK(d.findings[0].parameters.at("force_up_n").value == Approx(1.0).epsilon(0.02));
  CHECK(d.findings[0].parameters.at("force_down_n").value == Approx(2.0).epsilon(0.02));
}

TEST_CASE("Where nothing is free, a wrong damping and a wrong mass cannot be told apart") {
  auto model = test::carriage_model();
  model.free.clear();
  const auto d = diagnosed({.damping = 3.0}, true, model);
  INFO(text(d));
  CHECK(d.verdict == Verdict::not_identifiable);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::damping_error);
  CHECK(d.findings[0].parameters.at("damping_nspm").value == Approx(3.0).epsilon(0.01));
  CHECK(rivals(d.findings[0]) == std::set<std::string>{"mass_error"});
}

TEST_CASE(
    "The one recording that is pushed up among falls is not another machine: it tells friction from a constant force") {
  // Falls show 1.2 N, whatever it is of; a throw shows 2 N.
  const Flight truth{.damping = 1.4, .friction = 1.6, .force = -0.4};
  auto training = disturbed_flights(truth, false, 1, 14);
  const auto held_out = disturbed_flights(truth, true, 50, 3);
  const auto falls = diagnose::diagnose(test::carriage_model(), training, held_out);
  training.push_back(disturbed_flight(truth, true, 15));
  const auto d = diagnose::diagnose(test::carriage_model(), training, held_out);
  INFO(text(d));
  CHECK(d.data_quality.excluded.empty());
  CHECK(d.verdict == Verdict::explained);
  const auto size = coulomb(d);
  CHECK(size.lower < 1.6);
  CHECK(size.upper > 1.6);
  CHECK(size.value == Approx(1.6).epsilon(0.05));
  CHECK(d.extended.at("height").rmse < falls.extended.at("height").rmse / 3.0);
}

TEST_CASE("One fall of another carriage among falls and a throw is still left out") {
  const Flight truth{.damping = 1.4, .friction = 1.6, .force = -0.4}, other{.damping = 1.4, .friction = 4.0};
  auto training = disturbed_flights(truth, false, 1, 13);
  training.push_back(disturbed_flight(truth, true, 14));
  training.push_back(disturbed_flight(other, false, 15));
  const auto d = diagnose::diagnose(test::carriage_model(), training, disturbed_flights(truth, true, 50, 2));
  INFO(text(d));
  REQUIRE(d.data_quality.excluded.size() == 1);
  CHECK(d.data_quality.excluded[0].log == "flight-15.csv");
  CHECK(coulomb(d).value == Approx(1.6).epsilon(0.05));
}

TEST_CASE("Logs without a flight are refused with what was expected") {
  auto logs = test::flight_logs({}, false, 1, 3);
  for (auto& log : logs) log.columns["contact"].assign(log.rows(), 1.0);
  CHECK_THROWS_WITH(diagnose::diagnose(test::carriage_model(), logs, logs),
                    Catch::Contains("flight-1.csv") && Catch::Contains("no free flight"));
}

TEST_CASE(
    "A slip of the encoder while the carriage lies on its stop is named: no flight shows it, and nothing else moves it within a row") {
  auto training = test::flight_logs({.damping = 1.4}, true, 1, 10);
  auto& height = training[3].columns.at("height_m");
  for (std::size_t row = height.size() - 20; row < height.size(); ++row) height[row] += 5e-3;
  const auto d =
      diagnose::diagnose(test::carriage_model(), training, test::flight_logs({.damping = 1.4}, true, 50, 2));
  INFO(text(d));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::encoder_slip);
  REQUIRE(d.findings[0].events.size() == 1);
  CHECK(d.findings[0].events[0].log == training[3].path);
  CHECK(d.findings[0].events[0].step ==
        Approx(5e-3).margin(6e-4));  // of six rows to either side, 0.09 mm of noise
}

TEST_CASE(
    "Of falls that leave causes open, a throw that is held out is said to tell them apart, and another fall is not") {
  const Flight truth{.friction = 1.6};
  const auto noted = [&](bool thrown) {
    const auto d =
        diagnose::diagnose(test::carriage_model(), disturbed_flights(truth, false, 1, 8),
                           {disturbed_flight(truth, false, 60), disturbed_flight(truth, thrown, 61)});
    INFO(text(d));
    CHECK(d.verdict == Verdict::not_identifiable);
    return d.notes;
  };
  const std::vector<std::string> with_throw = noted(true);
  REQUIRE(with_throw.size() == 1);
  CHECK_THAT(with_throw[0], Catch::StartsWith("flight-61.csv, which is held out, tells them apart"));
  CHECK(noted(false).empty());
}

TEST_CASE(
    "Mass and damping of an axis that are wrong by one factor are noted as one scale, by two factors not") {
  const auto notes = [](double mass, double damping) {
    std::vector<log::Log> training;
    for (unsigned seed = 1; seed <= 4; ++seed) training.push_back(test::axis_log(mass, damping, 1e-5, seed));
    model::Model held = test::axis_model(12.0, 30.0);
    held.free.clear();
    const auto d = diagnose::diagnose(held, training, {test::axis_log(mass, damping, 1e-5, 9)});
    INFO(text(d));
    CHECK(d.findings.size() == 2);
    return d.notes;
  };
  const std::vector<std::string> one = notes(1.25 * 12.0, 1.25 * 30.0);
  REQUIRE(one.size() == 1);
  CHECK_THAT(one[0],
             Catch::StartsWith("Mass and damping are both 1.25 times the model's: a force of 0.8 times"));
  CHECK(notes(1.25 * 12.0, 0.8 * 30.0).empty());
}
