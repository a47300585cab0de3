// Physical limits of scenarios, see expectation.hpp.
#include "host/sim/expectation.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::sim {
namespace {

using core::rounded;

struct Hops {
  std::vector<double> apex_m;  ///< of flights that end in the last third
  std::size_t touchdowns = 0;  ///< that a raw switch shows, 20 ms or more apart
  std::size_t caught_touchdowns = 0;
};

Hops hops_of(const log::Log& log, double tooth_pitch_m) {
  Hops hops;
  const auto& time_s = log.time_s();
  const auto& height_m = log.at("height_m");
  const auto& contact = log.at("contact");
  const bool has_cable = log.has("clutch_travel_m");
  const double late_s = time_s.back() * 2.0 / 3.0;
  double highest_m = 0.0, left_s = -1.0;
  for (std::size_t row = 1; row < log.rows(); ++row) {
    highest_m = std::max(highest_m, height_m[row]);
    if (contact[row] == 0.0 && contact[row - 1] == 1.0) left_s = time_s[row];
    if (contact[row] == 0.0 || contact[row - 1] == 1.0) continue;
    // The switch chatters: a flight is longer than that.
    const bool flight = left_s >= 0.0 && time_s[row] - left_s > 0.02;
    if (flight) {
      ++hops.touchdowns;
      if (!has_cable || std::abs(log.at("clutch_travel_m")[row]) < 0.5 * tooth_pitch_m)
        ++hops.caught_touchdowns;
      if (left_s > late_s) hops.apex_m.push_back(highest_m);
    }
    highest_m = 0.0;
  }
  return hops;
}

}  // namespace

Expectation parse_expectation(std::string_view text, const std::string& name) {
  const toml::table file = core::parse_toml(text, name);
  Expectation e;
  const toml::node* section = file.get("expect");
  if (section == nullptr) return e;
  const toml::table& t = core::table(*section, name, "[expect]");
  static constexpr std::array<std::string_view, 7> kKeys{
      "apex_least_m",   "apex_most_m",       "fault", "torque_zero_after_s", "coil_off_after_s",
      "releases_least", "caught_share_least"};
  core::refuse_unknown_keys(t, name, "[expect]", kKeys);
  const auto number = [&](std::string_view key, double most, std::string_view unit,
                          std::optional<double>& out) {
    if (const toml::node* node = t.get(key)) out = core::number(*node, name, key, 0.0, most, unit);
  };
  number("apex_least_m", 10.0, "m", e.apex_least_m);
  number("apex_most_m", 10.0, "m", e.apex_most_m);
  number("torque_zero_after_s", 3600.0, "s", e.torque_zero_after_s);
  number("coil_off_after_s", 3600.0, "s", e.coil_off_after_s);
  number("releases_least", 1e6, "", e.releases_least);
  number("caught_share_least", 1.0, "", e.caught_share_least);
  if (const toml::node* node = t.get("fault")) {
    const std::string wanted = core::text(*node, name, "fault");
    std::vector<std::string_view> names;
    for (const control::FaultInfo& f : control::kFaults) names.push_back(f.name);
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
      core::fail(name, node->source(),
                 "fault = " + core::quoted(wanted) + "; expected one of " + core::listed(names) +
                     core::did_you_mean(wanted, names));
    e.fault = control::kFaults[static_cast<std::size_t>(found - names.begin())].fault;
  }
  return e;
}

Expectation read_expectation(const std::string& path) {
  return parse_expectation(core::read_small_file(path, "a scenario (TOML)"), path);
}

std::vector<std::string> violations(const Expectation& expected, const log::Log& log,
                                    std::optional<double> first_fault_s, double tooth_pitch_m) {
  std::vector<std::string> found;
  if (log.rows() < 2) return {"the log has no rows"};
  const auto& time_s = log.time_s();

  // The controller's fault: the expected one, and no other.
  bool met = expected.fault == control::Fault::none;
  for (std::size_t row = 0; row < log.rows(); ++row) {
    const auto number = static_cast<std::size_t>(log.at("fault")[row]);
    if (number == static_cast<std::size_t>(expected.fault)) met = true;
    if (number == 0 || number == static_cast<std::size_t>(expected.fault)) continue;
    found.push_back(
        "fault " + std::string(number < control::kFaultCount ? control::kFaults[number].name : "unknown") +
        " at " + rounded(time_s[row]) + " s; expected " + std::string(control::info(expected.fault).name));
    break;
  }
  if (!met)
    found.push_back("the fault " + std::string(control::info(expected.fault).name) + " was not found");

  const Hops hops = hops_of(log, tooth_pitch_m);
  if (expected.apex_least_m || expected.apex_most_m) {
    if (hops.apex_m.empty()) found.push_back("no flight in the last third of the run");
    for (const double apex_m : hops.apex_m) {
      if (apex_m >= expected.apex_least_m.value_or(0.0) && apex_m <= expected.apex_most_m.value_or(1e9))
        continue;
      found.push_back("an apex of " + rounded(apex_m) + " m; expected " +
                      rounded(expected.apex_least_m.value_or(0.0)) + " to " +
                      rounded(expected.apex_most_m.value_or(1e9)) + " m");
      break;
    }
  }

  if (expected.torque_zero_after_s) {
    const double from_s = first_fault_s.value_or(0.0) + *expected.torque_zero_after_s;
    bool worked = false;
    for (std::size_t row = 0; row < log.rows(); ++row) {
      const double torque_nm = std::abs(log.at("torque_cmd_nm")[row]);
      if (time_s[row] < first_fault_s.value_or(0.0)) worked = worked || torque_nm > 0.5;
      if (time_s[row] < from_s || torque_nm <= kNoTorqueNm) continue;
      found.push_back("a torque of " + rounded(torque_nm) + " N m at " + rounded(time_s[row], 6) + " s, " +
                      rounded(1e3 * (time_s[row] - first_fault_s.value_or(0.0))) +
                      " ms after the fault was planted; expected none " +
                      rounded(1e3 * *expected.torque_zero_after_s) + " ms after it");
      break;
    }
    if (first_fault_s && !worked) found.push_back("the fault met a motor that did not work yet");
  }

  if (expected.coil_off_after_s) {
    const double planted_s = first_fault_s.value_or(0.0);
    bool on_before = false;
    for (std::size_t row = 0; row < log.rows(); ++row) {
      const bool on = log.at("solenoid")[row] != 0.0;
      // A duty below 1 is a line that is off now and then.
      on_before = on_before || (on && time_s[row] > planted_s - 0.005 && time_s[row] < planted_s);
      if (!on || time_s[row] < planted_s + *expected.coil_off_after_s) continue;
      found.push_back("the solenoid is on at " + rounded(time_s[row], 6) + " s; expected off " +
                      rounded(1e3 * *expected.coil_off_after_s) + " ms after the fault was planted");
      break;
    }
    if (!on_before) found.push_back("the fault met a solenoid that was off");
  }

  if (expected.releases_least) {
    std::size_t releases = 0;
    double last_on_s = -1.0;
    for (std::size_t row = 0; row < log.rows(); ++row) {
      if (log.at("solenoid")[row] == 0.0) continue;
      // A duty below 1 is a line that is off now and then.
      if (last_on_s < 0.0 || time_s[row] - last_on_s > 0.02) ++releases;
      last_on_s = time_s[row];
    }
    if (static_cast<double>(releases) < *expected.releases_least)
      found.push_back(std::to_string(releases) + " releases; expected " + rounded(*expected.releases_least) +
                      " at least");
  }
  if (expected.caught_share_least) {
    const double share = hops.touchdowns == 0 ? 0.0
                                              : static_cast<double>(hops.caught_touchdowns) /
                                                    static_cast<double>(hops.touchdowns);
    if (share < *expected.caught_share_least)
      found.push_back("the spring was caught at " + std::to_string(hops.caught_touchdowns) + " of " +
                      std::to_string(hops.touchdowns) + " touch-downs; expected a share of " +
                      rounded(*expected.caught_share_least));
  }
  return found;
}

}  // namespace furcula::sim
