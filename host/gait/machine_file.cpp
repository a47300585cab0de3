#include "host/gait/machine_file.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::gait {
namespace {

using core::fail;
using core::shortest;

#define FURCULA_KEY(name, unit, lower, upper, member)                        \
  MachineKey {                                                               \
    name, unit, lower, upper, [](Machine& m) -> double& { return m.member; } \
  }
#define FURCULA_OPTIONAL(name, unit, lower, upper, member)                          \
  MachineKey {                                                                      \
    name, unit, lower, upper, [](Machine& m) -> double& { return m.member; }, false \
  }

constexpr double kTurn = 3.141592653589793;
constexpr std::array kParameters{
    FURCULA_KEY("mass_kg", "kg", 0.1, 1000.0, leg.mass_kg),
    FURCULA_KEY("thigh_mass_kg", "kg", 0.0, 1000.0, leg.thigh_mass_kg),
    FURCULA_KEY("shank_mass_kg", "kg", 0.001, 1000.0, leg.shank_mass_kg),
    FURCULA_KEY("thigh_inertia_kgm2", "kg m^2", 0.0, 1000.0, leg.thigh_inertia_kgm2),
    FURCULA_KEY("shank_inertia_kgm2", "kg m^2", 0.0, 1000.0, leg.shank_inertia_kgm2),
    FURCULA_KEY("thigh_length_m", "m", 0.01, 10.0, leg.thigh_length_m),
    FURCULA_KEY("shank_length_m", "m", 0.01, 10.0, leg.shank_length_m),
    FURCULA_KEY("thigh_com_m", "m", 0.0, 10.0, leg.thigh_com_m),
    FURCULA_KEY("shank_com_m", "m", 0.001, 10.0, leg.shank_com_m),
    FURCULA_KEY("hip_damping_nmspr", "N m s/rad", 0.0, 1000.0, leg.hip_damping_nmspr),
    FURCULA_KEY("knee_damping_nmspr", "N m s/rad", 0.0, 1000.0, leg.knee_damping_nmspr),
    FURCULA_KEY("stiffness_nmprad", "N m/rad", 0.0, 1e5, leg.stiffness_nmprad),
    FURCULA_KEY("rest_angle_rad", "rad", 0.0, kTurn, leg.rest_angle_rad),
    FURCULA_KEY("gravity_mps2", "m/s^2", 0.1, 100.0, leg.gravity_mps2)};
constexpr std::array kMotors{
    FURCULA_KEY("hip_gear", "", 0.1, 1e4, motors.hip_gear),
    FURCULA_KEY("knee_gear", "", 0.1, 1e4, motors.knee_gear),
    FURCULA_KEY("torque_constant_nmpa", "N m/A", 1e-4, 100.0, motors.torque_constant_nmpa),
    FURCULA_KEY("resistance_ohm", "ohm", 1e-4, 1e4, motors.resistance_ohm),
    FURCULA_OPTIONAL("supply_v", "V", 0.0, 1e4, motors.supply_v),
    FURCULA_OPTIONAL("current_a", "A", 0.0, 1e4, motors.current_a)};
constexpr std::array kRange{FURCULA_KEY("hip_least_rad", "rad", -kTurn, kTurn, least.hip),
                            FURCULA_KEY("hip_most_rad", "rad", -kTurn, kTurn, most.hip),
                            FURCULA_KEY("knee_least_rad", "rad", 0.0, kTurn, least.knee),
                            FURCULA_KEY("knee_most_rad", "rad", 0.0, kTurn, most.knee)};
constexpr std::array kClutch{FURCULA_KEY("catch_delay_s", "s", 0.0, 0.2, catching.delay_s),
                             FURCULA_KEY("lost_knee_rad", "rad", 0.0, 1.0, catching.lost_rad)};
#undef FURCULA_KEY
#undef FURCULA_OPTIONAL

void read_keys(const toml::table& file, const std::string& name, const std::string& section,
               std::span<const MachineKey> keys, Machine& machine) {
  const std::string where = "[" + section + "]";
  const toml::node* node = file.get(section);
  if (node == nullptr) fail(name, file.source(), "no section " + where + "; expected one");
  const toml::table& table = core::table(*node, name, where);
  std::vector<std::string_view> known;
  for (const MachineKey& k : keys) known.push_back(k.name);
  core::refuse_unknown_keys(table, name, where, known);
  for (const MachineKey& k : keys) {
    const toml::node* value = table.get(k.name);
    if (value == nullptr) {
      if (!k.needed) continue;
      fail(name, table.source(),
           "no key '" + std::string(k.name) + "' in " + where + "; expected a number from " +
               shortest(k.lower) + " to " + shortest(k.upper) +
               (k.unit.empty() ? "" : " " + std::string(k.unit)));
    }
    k.of(machine) = core::number(*value, name, where + " " + std::string(k.name), k.lower, k.upper, k.unit);
  }
}

std::string format_keys(const std::string& section, std::span<const MachineKey> keys,
                        const Machine& machine) {
  std::string out = "\n[" + section + "]\n";
  for (const MachineKey& k : keys)
    if (k.needed || k.value(machine) != 0.0)
      out += std::string(k.name) + " = " + core::toml_float(k.value(machine)) + "\n";
  return out;
}

/// [open]: intervals of parameters.
void read_open(const toml::table& file, const std::string& name, Machine& machine) {
  constexpr std::size_t kMost = 4;  // a gait is found at each of 2^n corners
  const toml::table& table = core::table(*file.get("open"), name, "[open]");
  std::vector<std::string_view> known;
  for (const MachineKey& k : kParameters) known.push_back(k.name);
  core::refuse_unknown_keys(table, name, "[open], which has intervals of parameters", known);
  if (table.size() > kMost)
    fail(name, table.source(),
         "[open] has " + std::to_string(table.size()) + " parameters; expected at most 4");
  for (const MachineKey& k : kParameters) {
    const toml::node* node = table.get(k.name);
    if (node == nullptr) continue;
    const std::string key = "[open] " + std::string(k.name);
    const toml::array* ends = node->as_array();
    if (ends == nullptr || ends->size() != 2)
      fail(name, node->source(), key + " = " + core::value_text(*node) + "; expected [low, high]");
    OpenParameter open{std::string(k.name), core::number(*ends->get(0), name, key, k.lower, k.upper, k.unit),
                       core::number(*ends->get(1), name, key, k.lower, k.upper, k.unit)};
    if (!(open.low <= k.value(machine) && k.value(machine) <= open.high))
      fail(name, node->source(),
           key + " = [" + shortest(open.low) + ", " + shortest(open.high) +
               "]; expected an interval that has the value of [parameters] in it, " +
               shortest(k.value(machine)));
    machine.open.push_back(open);
  }
}

}  // namespace

std::span<const MachineKey> parameter_keys() { return kParameters; }
std::span<const MachineKey> motor_keys() { return kMotors; }
std::span<const MachineKey> range_keys() { return kRange; }

bool is_planar_leg(std::string_view text) {
  try {
    const toml::table file = core::parse_toml(text, "");
    return file["model"]["kind"].value<std::string_view>() == "planar_leg";
  } catch (const core::DataError&) {
    return false;
  }
}

Machine parse_machine(std::string_view text, const std::string& path) {
  static constexpr std::array<std::string_view, 6> kSections{"model", "parameters", "motors",
                                                             "range", "clutch",     "open"};
  static constexpr std::array<std::string_view, 3> kModelKeys{"kind", "schema", "spring"};
  const toml::table file = core::parse_toml(text, path);
  core::refuse_unknown_keys(file, path, "the model file of a planar leg", kSections);
  const toml::node* section = file.get("model");
  if (section == nullptr) fail(path, file.source(), "no section [model]; expected one");
  const toml::table& model = core::table(*section, path, "[model]");
  core::refuse_unknown_keys(model, path, "[model] of a planar leg", kModelKeys);
  const toml::node* kind = model.get("kind");
  if (kind == nullptr) fail(path, model.source(), "no key 'kind' in [model]; expected kind = \"planar_leg\"");
  if (const std::string which = core::text(*kind, path, "kind"); which != "planar_leg")
    fail(path, kind->source(),
         "kind = " + core::quoted(which) + "; expected \"planar_leg\": gaits are of a planar leg");
  const toml::node* schema = model.get("schema");
  if (schema == nullptr) fail(path, model.source(), "no key 'schema' in [model]; expected schema = 1");
  if (!schema->is_integer() || schema->value<std::int64_t>() != 1)
    fail(path, schema->source(), "schema = " + core::value_text(*schema) + "; expected 1");
  const toml::node* spring = model.get("spring");
  if (spring == nullptr)
    fail(path, model.source(),
         "no key 'spring' in [model]; expected one of " + core::listed(dynamics::kLegSpringNames));
  const std::string which = core::text(*spring, path, "spring");
  const auto found = std::find(dynamics::kLegSpringNames.begin(), dynamics::kLegSpringNames.end(), which);
  if (found == dynamics::kLegSpringNames.end())
    fail(path, spring->source(),
         "spring = " + core::quoted(which) + "; expected one of " + core::listed(dynamics::kLegSpringNames) +
             core::did_you_mean(which, dynamics::kLegSpringNames));

  Machine machine;
  machine.file = path;
  machine.spring = static_cast<LegSpring>(found - dynamics::kLegSpringNames.begin());
  read_keys(file, path, "parameters", kParameters, machine);
  read_keys(file, path, "motors", kMotors, machine);
  if (file.contains("range")) read_keys(file, path, "range", kRange, machine);
  if (const toml::node* clutch = file.get("clutch")) {
    if (machine.spring != LegSpring::switched)
      fail(path, clutch->source(),
           "[clutch] of a leg whose spring is " + core::quoted(which) + "; expected spring = \"switched\"");
    read_keys(file, path, "clutch", kClutch, machine);
  }
  if (file.contains("open")) read_open(file, path, machine);

  const auto& leg = machine.leg;
  const toml::source_region& at = file.get("parameters")->source();
  if (leg.thigh_mass_kg + leg.shank_mass_kg > leg.mass_kg)
    fail(path, at,
         "thigh_mass_kg and shank_mass_kg are " + shortest(leg.thigh_mass_kg + leg.shank_mass_kg) +
             " kg together; expected at most mass_kg, " + shortest(leg.mass_kg) +
             " kg, which is that of all");
  for (const auto& [what, com, length] : {std::tuple{"thigh_com_m", leg.thigh_com_m, leg.thigh_length_m},
                                          std::tuple{"shank_com_m", leg.shank_com_m, leg.shank_length_m}})
    if (com > length)
      fail(path, at,
           std::string(what) + " = " + shortest(com) + "; expected at most the link's length, " +
               shortest(length) + " m");
  if (!(machine.least.hip < machine.most.hip && machine.least.knee < machine.most.knee))
    fail(path, file.get("range")->source(), "a least angle is not below its most; expected least < most");
  return machine;
}

Machine read_machine(const std::string& path) {
  return parse_machine(core::read_small_file(path, "a model file (TOML)"), path);
}

std::string format_machine(const Machine& machine) {
  std::string open = machine.open.empty() ? "" : "\n[open]\n";
  for (const OpenParameter& o : machine.open)
    open += o.name + " = [" + core::toml_float(o.low) + ", " + core::toml_float(o.high) + "]\n";
  return "[model]\nkind = \"planar_leg\"\nschema = 1\nspring = \"" +
         std::string(dynamics::kLegSpringNames[static_cast<std::size_t>(machine.spring)]) + "\"\n" +
         format_keys("parameters", kParameters, machine) + format_keys("motors", kMotors, machine) +
         format_keys("range", kRange, machine) +
         (machine.catching.ideal() ? "" : format_keys("clutch", kClutch, machine)) + open;
}

}  // namespace furcula::gait
