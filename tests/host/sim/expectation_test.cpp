// Physical limits of scenarios, on logs whose answer is known.
#include "host/sim/expectation.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/core/error.hpp"
#include "host/sim/simulate.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

/// Three seconds of flights of 0.4 s to `apex_m` and stances of 0.1 s with a torque of 1 N m.
log::Log hops(double apex_m) {
  log::Log log;
  for (const char* name :
       {"time_s", "height_m", "contact", "torque_cmd_nm", "solenoid", "fault", "clutch_travel_m"})
    log.columns[name];
  for (int ms = 0; ms < 3000; ++ms) {
    const int phase = ms % 500;
    const bool stance = phase >= 400;
    const double s = (phase - 200) / 200.0;
    log.columns["time_s"].push_back(ms * 1e-3);
    log.columns["height_m"].push_back(stance ? 0.27 : 0.28 + (apex_m - 0.28) * (1.0 - s * s));
    log.columns["contact"].push_back(stance ? 1.0 : 0.0);
    log.columns["torque_cmd_nm"].push_back(stance ? 1.0 : 0.0);
    log.columns["solenoid"].push_back(phase > 50 && phase < 100 ? 1.0 : 0.0);
    log.columns["clutch_travel_m"].push_back(phase > 50 && phase < 200 ? 0.05 : 0.0);
    log.columns["fault"].push_back(0.0);
  }
  return log;
}

std::string first_violation(const std::string& expect, const log::Log& log,
                            std::optional<double> fault_s = {}) {
  const auto found =
      sim::violations(sim::parse_expectation("[expect]\n" + expect, "s.toml"), log, fault_s, 0.004);
  return found.empty() ? "" : found.front();
}

}  // namespace

TEST_CASE("apices within their limits are no violation, higher or lower ones are") {
  CHECK(first_violation("apex_least_m = 0.355\napex_most_m = 0.365", hops(0.36)).empty());
  CHECK_THAT(first_violation("apex_least_m = 0.365", hops(0.36)), Contains("an apex of 0.36 m"));
  CHECK_THAT(first_violation("apex_most_m = 0.355", hops(0.36)), Contains("an apex of 0.36 m"));
  log::Log still = hops(0.36);
  for (double& c : still.columns["contact"]) c = 1.0;
  CHECK_THAT(first_violation("apex_least_m = 0.3", still), Contains("no flight"));
}

TEST_CASE("the expected fault must be found, and no other") {
  log::Log log = hops(0.36);
  CHECK_THAT(first_violation("fault = \"peer_lost\"", log), Contains("peer_lost was not found"));
  for (std::size_t row = 2000; row < 3000; ++row) log.columns["fault"][row] = 3.0;
  CHECK(first_violation("fault = \"peer_lost\"", log).empty());
  CHECK_THAT(first_violation("", log), Contains("fault peer_lost at 2 s; expected none"));
}

TEST_CASE(
    "a torque after the time allowed from the fault on is a violation, and a motor that had not worked too") {
  log::Log log = hops(0.36);
  CHECK_THAT(first_violation("torque_zero_after_s = 0.002", log, 1.45),
             Contains("a torque of 1 N m at 1.452 s") && Contains("2 ms after"));
  for (std::size_t row = 1452; row < 3000; ++row)
    log.columns["torque_cmd_nm"][row] = 0.0044;  // a drive's zero
  CHECK(first_violation("torque_zero_after_s = 0.002", log, 1.45).empty());
  for (double& t : log.columns["torque_cmd_nm"]) t = 0.0;
  CHECK_THAT(first_violation("torque_zero_after_s = 0.002", log, 1.45), Contains("did not work yet"));
}

TEST_CASE("a solenoid that stays on after the fault is a violation, and one that was off before it too") {
  log::Log log = hops(0.36);  // it is on from 1.051 s to 1.099 s
  CHECK_THAT(first_violation("coil_off_after_s = 0.002", log, 1.07), Contains("on at 1.072 s"));
  for (std::size_t row = 1072; row < 3000; ++row) log.columns["solenoid"][row] = 0.0;
  CHECK(first_violation("coil_off_after_s = 0.002", log, 1.07).empty());
  CHECK_THAT(first_violation("coil_off_after_s = 0.002", log, 1.2), Contains("a solenoid that was off"));
}

TEST_CASE("releases are counted as a person would, and a spring that is not caught at touch-down is seen") {
  log::Log log = hops(0.36);
  CHECK(first_violation("releases_least = 6\ncaught_share_least = 1.0", log).empty());
  CHECK_THAT(first_violation("releases_least = 7", log), Contains("6 releases"));
  for (std::size_t row = 2000; row < 3000; ++row) log.columns["clutch_travel_m"][row] = 0.02;
  CHECK_THAT(first_violation("caught_share_least = 0.9", log), Contains("the spring was caught at"));
}

TEST_CASE("what an expectation cannot mean is said with its line") {
  const auto message = [](const std::string& text) {
    try {
      sim::parse_expectation(text, "s.toml");
    } catch (const core::DataError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK_THAT(message("[expect]\napex_m = 1\n"), Contains("s.toml:2: unknown key 'apex_m'"));
  CHECK_THAT(message("[expect]\nfault = \"peer_losst\"\n"), Contains("did you mean 'peer_lost'"));
  CHECK_THAT(message("[expect]\ncaught_share_least = 1.5\n"), Contains("from 0 to 1"));
  CHECK(sim::parse_expectation("", "s.toml").fault == control::Fault::none);
}
