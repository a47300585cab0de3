// A contact switch that sticks: no effect of the catalogue, so the model must not be called adequate. And ideal recordings of the model itself.
#include <catch2/catch.hpp>
#include <functional>

#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/result/diagnosis_json.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using Catch::Contains;
using diagnose::Verdict;

namespace {

std::vector<log::Log> hops(unsigned seed, int count, const sim_host::SensorErrors& sensors) {
  const model::Model truth = test::hopper_model();
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    sim::Scenario s = sim::default_scenario(truth);
    s.start_position = 0.33 + 0.01 * i;
    s.duration_s = 3.0;
    s.amplitude = 1.5 + 0.2 * i;
    s.period_s = 0.31 + 0.02 * i;
    s.sensors = sensors;
    logs.push_back(sim::simulate(truth, s, seed + static_cast<unsigned>(i)));
    logs.back().path = "hops-" + std::to_string(seed) + "-" + std::to_string(i) + ".csv";
  }
  return logs;
}

constexpr sim_host::SensorErrors kSensors{
    .quantisation = true, .noise = true, .bounce = true, .jitter = false};

/// After every third change to `closed` reversed, the switch stays as it was for 80 ms.
void stick(log::Log& log, bool closed) {
  std::vector<double>& contact = log.columns.at("contact");
  const std::vector<double>& time_s = log.columns.at("time_s");
  const double kept = closed ? 1.0 : 0.0;
  int changes = 0;
  double free_from_s = 0.0;
  for (std::size_t i = 1; i < contact.size(); ++i) {
    const bool changes_now = contact[i - 1] == kept && contact[i] != kept && time_s[i] > free_from_s;
    if (!changes_now) continue;
    free_from_s = time_s[i] + 0.1;
    if (++changes % 3 != 0) continue;
    for (std::size_t k = i; k < contact.size() && time_s[k] < time_s[i] + 0.08; ++k) contact[k] = kept;
  }
}

}  // namespace

TEST_CASE("A contact switch that sticks for 80 ms is not adequate, whether it sticks closed or open") {
  for (const bool closed : {true, false}) {
    auto training = hops(1, 5, kSensors), held_out = hops(40, 2, kSensors);
    for (auto* logs : {&training, &held_out})
      for (log::Log& log : *logs) stick(log, closed);
    const auto d = diagnose::diagnose(test::hopper_model(), training, held_out);
    const auto said = diagnose::result_of(d);
    INFO(result::to_json_text(said));
    CHECK(d.verdict == Verdict::unexplained);
    CHECK(d.findings.empty());
    CHECK_THAT(said.summary, Contains("the contact switch contradicts the measured height in "));
    CHECK_THAT(said.next_experiment, Contains("does it stick"));
  }
}

TEST_CASE("The same hops with a switch that only bounces are adequate") {
  const auto d = diagnose::diagnose(test::hopper_model(), hops(1, 5, kSensors), hops(40, 2, kSensors));
  CHECK(d.verdict == Verdict::adequate);
  CHECK(d.contact_switch.contradicted == 0);
  CHECK(d.contact_switch.phases > 50);
}

TEST_CASE("Ideal recordings of the model itself are adequate, though numerics leave no white noise") {
  const auto d = diagnose::diagnose(test::hopper_model(), hops(1, 5, {}), hops(40, 2, {}));
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict == Verdict::adequate);
}
