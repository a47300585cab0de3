// Reading scenarios, see scenario.hpp.
#include "host/sim/scenario.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::sim {
namespace {

using core::fail;
using core::quoted;
using dynamics::has;
using dynamics::Kind;
using dynamics::LocationType;
using machines::ClutchAction;

class Reader {
 public:
  Reader(std::string_view text, const std::string& name, const model::Model& model)
      : name_(name),
        file_(core::parse_toml(text, name)),
        kind_(model.kind),
        clutch_(model::has_clutch(model)),
        keys_(machines::rules(model.kind).keys),
        scenario_(default_scenario(model)) {}

  Scenario read() {
    std::vector<std::string_view> sections{"start", "run", "sensors"};
    if (!keys_.drive.empty()) sections.insert(sections.begin() + 2, keys_.drive);
    if (has(kind_, LocationType::leg))
      sections.insert(sections.end(), {"fault", "expect"});  // expectation.hpp reads that
    const bool free_leg = has(kind_, LocationType::heavy_links);
    const bool timed_clutch = has(kind_, LocationType::belt | LocationType::leg) && !free_leg;
    if (timed_clutch) sections.push_back("clutch");
    if (free_leg) sections.insert(sections.end(), {"clutch", "contraction", "ground"});
    core::refuse_unknown_keys(file_, name_, "a scenario for " + std::string(dynamics::info(kind_).name),
                              sections);
    if (const toml::table* t = section("start")) read_start(*t);
    if (const toml::table* t = section("run")) {
      static constexpr std::array<std::string_view, 1> kKeys{"duration_s"};
      core::refuse_unknown_keys(*t, name_, "[run]", kKeys);
      number(*t, "duration_s", 0.001, 3600.0, "s", scenario_.duration_s);
    }
    if (!keys_.drive.empty())
      if (const toml::table* t = section(keys_.drive)) read_drive(*t);
    if (const toml::table* t = section("sensors")) read_sensors(*t);
    if (free_leg) {
      if (const toml::table* t = section("clutch")) read_clutch(*t);
      if (const toml::table* t = section("contraction")) {
        static constexpr std::array<std::string_view, 2> kKeys{"amplitude_m", "period_s"};
        core::refuse_unknown_keys(*t, name_, "[contraction]", kKeys);
        required(*t, "[contraction]", "amplitude_m", "a number of metres");
        number(*t, "amplitude_m", 0.0, 1.0, "m", scenario_.contraction_m);
        number(*t, "period_s", 0.05, 10.0, "s", scenario_.contraction_period_s);
      }
      if (const toml::table* t = section("ground")) {
        static constexpr std::array<std::string_view, 1> kKeys{"steps_m"};
        core::refuse_unknown_keys(*t, name_, "[ground]", kKeys);
        required(*t, "[ground]", "steps_m", "a number of metres");
        number(*t, "steps_m", 0.0, 0.03, "m", scenario_.ground_steps_m);  // what the supervisor bears
      }
    }
    if (timed_clutch)
      if (const toml::node* actions = file_.get("clutch")) read_actions(*actions);
    if (const toml::node* faults = file_.get("fault")) read_faults(*faults);
    return std::move(scenario_);
  }

 private:
  const toml::table* section(std::string_view key) {
    const toml::node* node = file_.get(key);
    return node == nullptr ? nullptr : &core::table(*node, name_, "[" + std::string(key) + "]");
  }

  bool number(const toml::table& t, std::string_view key, double lower, double upper, std::string_view unit,
              double& value) {
    const toml::node* node = t.get(key);
    if (node != nullptr) value = core::number(*node, name_, key, lower, upper, unit);
    return node != nullptr;
  }

  const toml::node& required(const toml::table& t, std::string_view where, std::string_view key,
                             const std::string& expected) {
    const toml::node* node = t.get(key);
    if (node == nullptr)
      fail(name_, t.source(),
           "no key '" + std::string(key) + "' in " + std::string(where) + "; expected " + expected);
    return *node;
  }

  void read_start(const toml::table& t) {
    const std::array known{keys_.position, keys_.velocity};
    core::refuse_unknown_keys(t, name_, "[start]", std::span(known).first(keys_.velocity.empty() ? 1 : 2));
    number(t, keys_.position, keys_.position_least, keys_.position_most, keys_.position_unit,
           scenario_.start_position);
    if (!keys_.velocity.empty())
      number(t, keys_.velocity, -keys_.velocity_most, keys_.velocity_most, keys_.velocity_unit,
             scenario_.start_velocity);
  }

  void read_drive(const toml::table& t) {
    const std::string where = "[" + std::string(keys_.drive) + "]";
    static constexpr std::array<std::string_view, 3> kProfiles{"harmonic", "constant", "zero"};
    const std::array<std::string_view, 3> known{"profile", keys_.amplitude, "period_s"};
    core::refuse_unknown_keys(t, name_, where, known);
    const toml::node& node = required(t, where, "profile", "one of " + core::listed(kProfiles));
    const std::string profile = core::text(node, name_, "profile");
    if (profile == "harmonic")
      scenario_.profile = control::ProfileShape::harmonic;
    else if (profile == "constant")
      scenario_.profile = control::ProfileShape::constant;
    else if (profile == "zero")
      scenario_.profile = control::ProfileShape::zero;
    else
      fail(name_, node.source(),
           "profile = " + quoted(profile) + "; expected one of " + core::listed(kProfiles) +
               core::did_you_mean(profile, kProfiles));
    const bool amplitude = number(t, keys_.amplitude, -keys_.amplitude_most, keys_.amplitude_most,
                                  keys_.amplitude_unit, scenario_.amplitude);
    const bool period = number(t, "period_s", 0.01, 3600.0, "s", scenario_.period_s);
    if (!amplitude && profile != "zero")
      required(t, where, keys_.amplitude, "a number of " + std::string(keys_.amplitude_unit));
    if (!period && profile == "harmonic") required(t, where, "period_s", "a number of seconds");
  }

  void read_clutch(const toml::table& t) {
    if (!clutch_)
      fail(name_, t.source(),
           "[clutch] for a model without one; expected a tooth_pitch_m above 0 in the model");
    static constexpr std::array<std::string_view, 2> kKeys{"in_flight", "catch_before_touchdown_s"};
    static constexpr std::array<std::string_view, 2> kActions{"release", "hold"};
    core::refuse_unknown_keys(t, name_, "[clutch]", kKeys);
    const toml::node& node = required(t, "[clutch]", "in_flight", "one of " + core::listed(kActions));
    const std::string action = core::text(node, name_, "in_flight");
    if (action != "release" && action != "hold")
      fail(name_, node.source(),
           "in_flight = " + quoted(action) + "; expected one of " + core::listed(kActions) +
               core::did_you_mean(action, kActions));
    scenario_.release_in_flight = action == "release";
    number(t, "catch_before_touchdown_s", 0.0, 1.0, "s", scenario_.catch_before_touchdown_s);
  }

  void read_actions(const toml::node& node) {
    if (!clutch_)
      fail(name_, node.source(),
           "[[clutch]] for a model without one; expected a tooth_pitch_m above 0 in the model");
    const toml::array* actions = node.as_array();
    if (actions == nullptr)
      fail(name_, node.source(), "clutch is " + core::value_text(node) + "; expected sections [[clutch]]");
    static constexpr std::array<std::string_view, 2> kKeys{"time_s", "action"};
    static constexpr std::array<std::string_view, 2> kActions{"release", "catch"};
    scenario_.clutch.clear();
    for (const toml::node& item : *actions) {
      const toml::table& t = core::table(item, name_, "[[clutch]]");
      core::refuse_unknown_keys(t, name_, "[[clutch]]", kKeys);
      const toml::node& time = required(t, "[[clutch]]", "time_s", "a number of seconds");
      const toml::node& node_of_action =
          required(t, "[[clutch]]", "action", "one of " + core::listed(kActions));
      const std::string action = core::text(node_of_action, name_, "action");
      if (action != "release" && action != "catch")
        fail(name_, node_of_action.source(),
             "action = " + quoted(action) + "; expected one of " + core::listed(kActions) +
                 core::did_you_mean(action, kActions));
      ClutchAction next{core::number(time, name_, "time_s", 0.0, 3600.0, "s"), action == "release"};
      const bool caught = scenario_.clutch.empty() || !scenario_.clutch.back().release;
      if (next.release != caught)
        fail(name_, node_of_action.source(),
             "action = " + quoted(action) + " where the clutch is " + (caught ? "caught" : "released") +
                 "; expected releases and catches in turn, a release first");
      if (!scenario_.clutch.empty() && !(next.time_s > scenario_.clutch.back().time_s))
        fail(name_, time.source(),
             "time_s = " + core::value_text(time) +
                 " is not after the action before it; expected growing times");
      scenario_.clutch.push_back(next);
    }
  }

  void read_sensors(const toml::table& t) {
    static constexpr std::array<std::string_view, 4> kKeys{"quantisation", "noise", "bounce", "jitter"};
    const bool leg = has(kind_, LocationType::leg);
    // Bounce and jitter are the contact switch's.
    core::refuse_unknown_keys(t, name_, "[sensors]", std::span(kKeys).first(leg ? 4 : 2));
    const std::array<bool*, 4> switches{&scenario_.sensors.quantisation, &scenario_.sensors.noise,
                                        &scenario_.sensors.bounce, &scenario_.sensors.jitter};
    for (std::size_t i = 0; i < kKeys.size(); ++i) {
      const toml::node* node = t.get(kKeys[i]);
      if (node == nullptr) continue;
      if (!node->is_boolean())
        fail(name_, node->source(),
             std::string(kKeys[i]) + " is " + core::value_text(*node) + "; expected true or false");
      *switches[i] = *node->value<bool>();
    }
  }

  void read_faults(const toml::node& node) {
    const toml::array* faults = node.as_array();
    if (faults == nullptr)
      fail(name_, node.source(), "fault is " + core::value_text(node) + "; expected sections [[fault]]");
    static constexpr std::array<std::string_view, 3> kKeys{"time_s", "kind", "duration_s"};
    std::array<std::string_view, sim_host::kRigFaults.size()> kinds;
    for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = sim_host::kRigFaults[i].name;
    for (const toml::node& item : *faults) {
      const toml::table& t = core::table(item, name_, "[[fault]]");
      core::refuse_unknown_keys(t, name_, "[[fault]]", kKeys);
      const toml::node& kind_node = required(t, "[[fault]]", "kind", "one of " + core::listed(kinds));
      const std::string kind = core::text(kind_node, name_, "kind");
      const auto found = sim_host::rig_fault_named(kind);
      if (!found)
        fail(name_, kind_node.source(),
             "unknown fault " + quoted(kind) + "; expected one of " + core::listed(kinds) +
                 core::did_you_mean(kind, kinds));
      if (!clutch_ && sim_host::info(*found).part == sim_host::RigPart::clutch)
        fail(name_, kind_node.source(),
             "fault " + quoted(kind) +
                 " for a model without a clutch; expected a tooth_pitch_m above 0 in the model");
      required(t, "[[fault]]", "time_s", "a number of seconds");
      sim_host::PlannedFault fault;
      fault.kind = *found;
      fault.duration_s = *found == sim_host::RigFault::late_tick ? 0.005
                         : sim_host::delays_tick(*found)         ? 0.05
                                                                 : 3600.0;
      number(t, "time_s", 0.0, 3600.0, "s", fault.time_s);
      number(t, "duration_s", 0.001, 3600.0, "s", fault.duration_s);
      scenario_.faults.push_back(fault);
    }
  }

  const std::string& name_;
  toml::table file_;
  Kind kind_;
  bool clutch_;
  const machines::Keys& keys_;
  Scenario scenario_;
};

}  // namespace

Scenario default_scenario(const model::Model& model) {
  return Scenario(machines::rules(model.kind).usual_run(model));
}

Scenario parse_scenario(std::string_view text, const std::string& name, const model::Model& model) {
  return Reader(text, name, model).read();
}

std::string format_scenario(const Scenario& s, dynamics::Kind kind) {
  const machines::Keys& keys = machines::rules(kind).keys;
  const auto key = [](std::string_view name, double value) {
    return std::string(name) + " = " + core::shortest(value) + "\n";
  };
  std::string text = "[start]\n" + key(keys.position, s.start_position) +
                     (keys.velocity.empty() ? "" : key(keys.velocity, s.start_velocity)) + "\n[run]\n" +
                     key("duration_s", s.duration_s);
  if (!keys.drive.empty()) {
    static constexpr const char* kProfiles[] = {"zero", "harmonic", "constant"};
    text +=
        "\n[" + std::string(keys.drive) + "]\nprofile = \"" + kProfiles[static_cast<int>(s.profile)] + "\"\n";
    if (s.profile != control::ProfileShape::zero)
      text += key(keys.amplitude, s.amplitude) + key("period_s", s.period_s);
  }
  const auto flag = [](const char* name, bool on) {
    return std::string(name) + (on ? " = true\n" : " = false\n");
  };
  text += "\n[sensors]\n" + flag("quantisation", s.sensors.quantisation) + flag("noise", s.sensors.noise);
  if (has(kind, LocationType::leg))
    text += flag("bounce", s.sensors.bounce) + flag("jitter", s.sensors.jitter);
  const Scenario standard;
  if (s.release_in_flight || s.catch_before_touchdown_s != standard.catch_before_touchdown_s)
    text += std::string("\n[clutch]\nin_flight = \"") + (s.release_in_flight ? "release" : "hold") + "\"\n" +
            key("catch_before_touchdown_s", s.catch_before_touchdown_s);
  if (s.contraction_m > 0.0)
    text +=
        "\n[contraction]\n" + key("amplitude_m", s.contraction_m) + key("period_s", s.contraction_period_s);
  for (const ClutchAction& a : s.clutch)
    text += "\n[[clutch]]\n" + key("time_s", a.time_s) + "action = \"" + (a.release ? "release" : "catch") +
            "\"\n";
  if (s.ground_steps_m > 0.0) text += "\n[ground]\n" + key("steps_m", s.ground_steps_m);
  for (const sim_host::PlannedFault& f : s.faults) {
    const auto& fault = *std::find_if(sim_host::kRigFaults.begin(), sim_host::kRigFaults.end(),
                                      [&](const auto& row) { return row.fault == f.kind; });
    text += "\n[[fault]]\n" + key("time_s", f.time_s) + "kind = \"" + std::string(fault.name) + "\"\n" +
            key("duration_s", f.duration_s);
  }
  return text;
}

Scenario read_scenario(const std::string& path, const model::Model& model) {
  return parse_scenario(core::read_small_file(path, "a scenario (TOML)"), path, model);
}

}  // namespace furcula::sim
