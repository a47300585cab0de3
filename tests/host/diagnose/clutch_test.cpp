// Causes in a clutch: on the release/catch bench, and on a hopper that lets its spring go in stance.
#include <catch2/catch.hpp>

#include "host/diagnose/crossed.hpp"
#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/diagnose/trainer.hpp"
#include "host/model/reader.hpp"
#include "host/model/writer.hpp"
#include "host/result/diagnosis_json.hpp"
#include "tests/host/identify/clutched_hops.hpp"

using namespace furcula;
using diagnose::Verdict;
using dynamics::Effect;

namespace {

/// Recordings of three releases each, with windows that differ.
std::vector<log::Log> releases(const model::Model& truth, int count, unsigned seed) {
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    auto s = sim::default_scenario(truth);
    s.clutch.clear();
    for (int k = 0; k < 3; ++k) {
      const double share = std::fmod(0.381966 * (seed + 3.0 * i + k), 1.0);
      s.clutch.push_back({0.1 + 0.4 * k, true});
      s.clutch.push_back({0.1 + 0.4 * k + 1e-3 * std::round(25.0 + 30.0 * share), false});
    }
    s.duration_s = 1.3;
    s.sensors.quantisation = true;
    logs.push_back(sim::simulate(truth, s, seed));
    logs.back().path = "releases-" + std::to_string(seed) + "-" + std::to_string(i) + ".csv";
  }
  return logs;
}

/// Friction and release delay free, the rest believed.
model::Model bench_model() {
  model::Model m = test::clutch_bench_model(true);
  m.free.erase(5);
  m.free.erase(8);
  return m;
}

diagnose::Diagnosis bench_diagnosed(const model::Model& truth) {
  return diagnose::diagnose(bench_model(), releases(truth, 6, 1), releases(truth, 2, 40));
}

std::string text(const diagnose::Diagnosis& d) { return result::to_json_text(diagnose::result_of(d)); }

void expect_on_bench(Effect effect, double value, double within) {
  model::Model truth = bench_model();
  truth.effects[effect] = {value};
  const auto d = bench_diagnosed(truth);
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == effect);
  const auto& found = d.findings[0].parameters.begin()->second;
  CHECK(found.value == Approx(value).margin(within));
  CHECK(found.lower <= value);
  CHECK(found.upper >= value);
  // With it in the model nothing is missing any more, and the model reads back.
  const auto again = diagnose::diagnose(model::parse_model(model::format_model(d.extended_model), "extended"),
                                        releases(truth, 6, 80), releases(truth, 2, 120));
  CHECK(again.verdict == Verdict::adequate);
}

}  // namespace

TEST_CASE("A bench without a hidden cause is adequate") {
  model::Model truth = bench_model();
  truth.parameters[7] = 0.0076;
  truth.parameters[3] = 3e-5;
  const auto d = bench_diagnosed(truth);
  INFO(text(d));
  CHECK(d.verdict == Verdict::adequate);
  CHECK(d.findings.empty());
}

TEST_CASE("A clutch that slips is found on the bench, with what it holds") {
  expect_on_bench(Effect::clutch_slip, 19.0, 1.0);
}
TEST_CASE("A late catch is found on the bench, with its delay") {
  expect_on_bench(Effect::late_catch, 0.021, 1.5e-3);
}
TEST_CASE("An auxiliary spring is found on the bench, with its rate") {
  expect_on_bench(Effect::auxiliary_spring, 70.0, 7.0);
}

TEST_CASE("Of a belt a recording is predictable by fits that have not seen it") {
  const auto predictable = [](const std::vector<log::Log>& logs, Effect effect, double start) {
    const model::Model model = bench_model();
    const auto recordings = identify::make_recordings(logs, model.kind);
    const auto training = identify::training_windows(recordings, model, 0.5);
    const diagnose::Crossed crossed(recordings, training,
                                    identify::prediction_windows(recordings, model, 0.5));
    const diagnose::Trainer trainer{model, recordings, training, 2};
    const diagnose::Hypothesis without = trainer.fit({}, nullptr),
                               with = trainer.fit({effect}, &without, {{effect, {start}}});
    return crossed.fitted_again(model, without, with, 2);
  };
  model::Model late = bench_model();
  late.effects[Effect::late_catch] = {0.021};
  const auto there = predictable(releases(late, 4, 1), Effect::late_catch, 0.018),
             not_there = predictable(releases(bench_model(), 4, 1), Effect::damping_error, 1e-4);
  INFO(there.smaller << " " << there.larger << " " << there.gain << ", " << not_there.smaller << " "
                     << not_there.larger << " " << not_there.gain);
  CHECK(there.larger < 0.01 * there.smaller);
  CHECK(there.gain > 3.0);
  CHECK(not_there.gain < 2.0);
  // Of two recordings one is late: of neither does the other tell.
  std::vector<log::Log> one_late = releases(late, 1, 1);
  one_late.push_back(releases(bench_model(), 1, 2).front());
  const auto in_one = predictable(one_late, Effect::late_catch, 0.018);
  INFO(in_one.smaller << " " << in_one.larger << " " << in_one.gain);
  CHECK(in_one.larger >= 0.9 * in_one.smaller);
}

namespace {

void expect_on_hopper(Effect effect, double value, double within) {
  model::Model truth = test::clutched_model();
  truth.effects[effect] = {value};
  const auto d = diagnose::diagnose(test::clutched_model(), test::hops_let_go_late(truth, 6, 1),
                                    test::hops_let_go_late(truth, 2, 40));
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE_FALSE(d.findings.empty());
  CHECK(d.findings[0].effect == effect);
  CHECK(d.findings[0].parameters.begin()->second.value == Approx(value).margin(within));
}

}  // namespace

TEST_CASE("A hopper with a clutch and without a hidden cause is adequate") {
  const auto d =
      diagnose::diagnose(test::clutched_model(), test::hops_let_go_late(test::clutched_model(), 6, 1),
                         test::hops_let_go_late(test::clutched_model(), 2, 40));
  INFO(text(d));
  CHECK(d.verdict == Verdict::adequate);
}
TEST_CASE("A release that leaves a part of the spring's force is found on the hopper", "[slow]") {
  expect_on_hopper(Effect::incomplete_release, 0.25, 0.05);
}
TEST_CASE("On the hopper the auxiliary spring's rate is another name of that, with its value beside it",
          "[slow]") {
  model::Model truth = test::clutched_model();
  truth.effects[Effect::auxiliary_spring] = {200.0};
  const auto d = diagnose::diagnose(test::clutched_model(), test::hops_let_go_late(truth, 6, 1),
                                    test::hops_let_go_late(truth, 2, 40));
  INFO(text(d));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::incomplete_release);
  REQUIRE(d.findings[0].indistinguishable_from.size() == 1);
  const auto& other = d.findings[0].indistinguishable_from[0];
  CHECK(other.same_law);
  CHECK(other.names == std::vector<std::string>{"auxiliary_spring"});
  CHECK(other.parameters.at("auxiliary_spring.stiffness_npm").value == Approx(200.0).margin(20.0));
}
