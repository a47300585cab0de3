// Traces of machines of one joint against closed forms.
#include "host/traces/of_axis.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/host/identify/synthetic.hpp"

using namespace furcula;

namespace {

/// Mass on a rail without friction under a constant force: x = F t^2 / 2 m. 1 kHz, with steps of a micrometre.
log::Log pushed(double mass_kg, double force_n) {
  log::Log log;
  log.path = "pushed.csv";
  log.rig = "motor_axis";
  for (int n = 0; n <= 2100; ++n) {
    const double t = 1e-3 * n;
    log.columns["time_s"].push_back(t);
    log.columns["position_m"].push_back(1e-6 * std::round(1e6 * 0.5 * force_n / mass_kg * t * t));
    log.columns["force_n"].push_back(force_n);
  }
  return log;
}

model::Model mass(double mass_kg) {
  model::Model m = test::axis_model(mass_kg, 0.0);
  m.free.clear();
  return m;
}

}  // namespace

TEST_CASE("a wrong mass's prediction leaves a window's measurement as the square of time") {
  const log::Log log = pushed(2.0, 4.0);
  const traces::Traces t =
      traces::of_axis({{"given", mass(4.0)}, {"refitted", mass(2.0)}}, mass(2.0), {log}, {}, 0.5);
  REQUIRE(t.logs.size() == 1);
  const traces::LogTraces& l = t.logs[0];
  REQUIRE(l.quantities.size() == 1);
  CHECK(l.quantities[0].column == "position_m");
  CHECK(l.held_out.empty());
  // A log that begins under a command: its first window begins 0.1 s later.
  CHECK(l.window.front() == 0);
  CHECK(std::isnan(l.quantities[0].predicted[0].front()));
  REQUIRE(l.window[150] == 1);
  std::size_t first = 0;
  while (l.window[first] == 0) ++first;
  for (std::size_t row = first; l.window[row] == 1; ++row) {
    const double since = l.time_s[row] - l.time_s[first];
    // 4 N on 4 kg in place of 2 kg: 1 m/s^2 less.
    CHECK(l.quantities[0].predicted[0][row] - l.quantities[0].measured[row] ==
          Approx(-0.5 * since * since).margin(2e-5));
    CHECK(l.quantities[0].predicted[1][row] == Approx(l.quantities[0].measured[row]).margin(2e-5));
  }
  // Four whole windows. The mean square of t^2 / 2 over 0.5 s is 0.5^4 / 20.
  CHECK(traces::error_of(l, l.quantities[0], 0).rmse ==
        Approx(std::sqrt(std::pow(0.5, 4) / 20.0)).epsilon(0.02));
  CHECK(traces::error_of(l, l.quantities[0], 1).rmse < 1e-5);
}

TEST_CASE("rows of held-out logs are marked, a flight is one window, and its stop is in none") {
  const std::vector<log::Log> flights = test::flight_logs({}, true, 0, 2);
  const model::Model model = test::carriage_model();
  const traces::Traces t = traces::of_axis({{"given", model}}, model, {flights[0]}, {flights[1]}, 0.5);
  REQUIRE(t.logs.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const traces::LogTraces& l = t.logs[i];
    CHECK(l.held_out.front() == (i == 1));
    CHECK(l.window.back() == 0);
    CHECK(*std::max_element(l.window.begin(), l.window.end()) == 1);
    // 2 kg with 1 N s/m falls as the model says, to an encoder's count of 90 um and what that does to the start's velocity in 50 ms.
    CHECK(traces::error_of(l, l.quantities[0], 0).rmse < 2e-3);
  }
}
