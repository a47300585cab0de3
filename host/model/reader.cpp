// Reading model files, see reader.hpp.
#include "host/model/reader.hpp"

#include <toml++/toml.h>

#include <array>
#include <vector>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::model {
namespace {

using core::fail;
using core::quoted;
using core::shortest;
using dynamics::Kind;

bool is_clutch_parameter(Kind kind, std::string_view name) {
  if (!dynamics::has(kind, dynamics::LocationType::leg)) return false;
  for (const auto& p : dynamics::kClutchParameters)
    if (p.name == name) return true;
  return false;
}

std::vector<std::string_view> parameter_names(Kind kind) {
  std::vector<std::string_view> names;
  for (const auto& p : dynamics::info(kind).parameters) names.push_back(p.name);
  return names;
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : name_(name), file_(core::parse_toml(text, name)) {}

  Model read() {
    static constexpr std::array<std::string_view, 4> kSections{"model", "parameters", "free", "effect"};
    // Kinds with a room of their own have sections of their own.
    if (const auto kind = file_["model"]["kind"].value<std::string_view>(); kind == "planar_leg")
      fail(name_, file_["model"]["kind"].node()->source(), no_such_kind(*kind));
    core::refuse_unknown_keys(file_, name_, "the model file", kSections);
    read_kind();
    read_parameters();
    if (const toml::node* free = file_.get("free")) read_free(core::table(*free, name_, "[free]"));
    if (const toml::node* effects = file_.get("effect"))
      read_effects(core::table(*effects, name_, "[effect]"));
    return std::move(model_);
  }

 private:
  const toml::table& section(std::string_view key) {
    const std::string header = "[" + std::string(key) + "]";
    const toml::node* node = file_.get(key);
    if (node == nullptr) fail(name_, file_.source(), "no section " + header + "; expected one");
    return core::table(*node, name_, header);
  }

  const toml::node& entry(const toml::table& table, const std::string& where, std::string_view key,
                          const std::string& expected) {
    const toml::node* node = table.get(key);
    if (node == nullptr)
      fail(name_, table.source(), "no key '" + std::string(key) + "' in " + where + "; expected " + expected);
    return *node;
  }

  void read_kind() {
    static constexpr std::array<std::string_view, 2> kKeys{"kind", "schema"};
    const toml::table& table = section("model");
    core::refuse_unknown_keys(table, name_, "[model]", kKeys);
    const toml::node& schema = entry(table, "[model]", "schema", "schema = 1");
    if (!schema.is_integer() || schema.value<std::int64_t>() != 1)
      fail(name_, schema.source(), "schema = " + core::value_text(schema) + "; expected 1");

    std::vector<std::string_view> kinds;
    for (const auto& k : dynamics::kMachines) kinds.push_back(k.name);
    const toml::node& node = entry(table, "[model]", "kind", "one of " + core::listed(kinds));
    const std::string name = core::text(node, name_, "kind");
    const auto kind = dynamics::kind_named(name);
    if (!kind) fail(name_, node.source(), no_such_kind(name));
    model_.kind = *kind;
  }

  void read_parameters() {
    const toml::table& table = section("parameters");
    const auto& kind = dynamics::info(model_.kind);
    std::vector<std::string_view> known = parameter_names(model_.kind);
    if (dynamics::has(model_.kind, dynamics::LocationType::leg))
      for (const auto& p : dynamics::kClutchParameters) known.push_back(p.name);
    core::refuse_unknown_keys(table, name_, "[parameters] of " + std::string(kind.name), known);
    for (const auto& p : kind.parameters) {
      const toml::node& node = entry(table, "[parameters]", p.name, expected(p));
      model_.parameters.push_back(core::number(node, name_, p.name, p.lower, p.upper, p.unit));
    }
    if (dynamics::has(model_.kind, dynamics::LocationType::leg)) read_clutch(table);
  }

  static std::string expected(const dynamics::ParameterInfo& p) {
    return "a number from " + shortest(p.lower) + " to " + shortest(p.upper) +
           (p.unit.empty() ? "" : " " + std::string(p.unit)) + " (" + std::string(p.meaning) + ")";
  }

  void read_clutch(const toml::table& table) {
    Clutch clutch;
    const toml::node* given = nullptr;  // a key that is not 0
    std::string_view which;
    for (std::size_t i = 0; i < kClutchMembers.size(); ++i) {
      const auto& p = dynamics::kClutchParameters[i];
      const toml::node* node = table.get(p.name);
      if (node == nullptr) continue;
      double& value = clutch.*kClutchMembers[i];
      value = core::number(*node, name_, p.name, p.lower, p.upper, p.unit);
      if (value == 0.0) continue;
      given = node;
      which = p.name;
    }
    if (given == nullptr) return;
    if (clutch.tooth_pitch_m == 0.0)
      fail(name_, given->source(),
           std::string(which) + " = " + core::value_text(*given) +
               " without a tooth_pitch_m; expected one above 0, or 0 for a robot without a clutch");
    model_.clutch = clutch;
  }

  void read_free(const toml::table& table) {
    for (const auto& [key, node] : table)
      if (is_clutch_parameter(model_.kind, key.str()))
        fail(name_, key.source(),
             "'" + std::string(key.str()) + "' in [free]; expected no such key: this version fits no clutch");
    core::refuse_unknown_keys(table, name_, "[free]", parameter_names(model_.kind));
    for (const auto& [key, node] : table) {
      const std::size_t index = *dynamics::parameter_index(model_.kind, key.str());
      const auto& p = dynamics::info(model_.kind).parameters[index];
      const std::string who = "[free] " + std::string(p.name);
      const toml::array* pair = node.as_array();
      if (pair == nullptr || pair->size() != 2)
        fail(name_, node.source(),
             who + " is " +
                 (pair == nullptr ? core::value_text(node) : "an array of " + std::to_string(pair->size())) +
                 "; expected two numbers, [lower, upper]");
      const double lower = core::number((*pair)[0], name_, who + " lower bound", p.lower, p.upper, p.unit);
      const double upper = core::number((*pair)[1], name_, who + " upper bound", p.lower, p.upper, p.unit);
      const std::string bounds = "[" + shortest(lower) + ", " + shortest(upper) + "]";
      if (!(lower < upper))
        fail(name_, node.source(),
             who + " = " + bounds + ": the bounds are the wrong way round or equal; expected lower < upper");
      const double value = model_.parameters[index];
      if (value < lower || value > upper)
        fail(name_, node.source(),
             who + " = " + bounds + " does not hold the parameter's value " + shortest(value) +
                 "; expected bounds around it");
      model_.free.emplace(index, Bounds{lower, upper});
    }
  }

  void read_effects(const toml::table& table) {
    const std::string_view kind = dynamics::info(model_.kind).name;
    std::vector<std::string_view> all, here;
    for (const auto& e : dynamics::kCatalogue) {
      all.push_back(e.name);
      if (dynamics::applies(e.effect, model_.kind)) here.push_back(e.name);
    }
    for (const auto& [key, node] : table) {
      const auto effect = dynamics::effect_named(key.str());
      if (!effect)
        fail(name_, key.source(),
             "unknown effect " + quoted(key.str()) + "; expected one of " + core::listed(here) +
                 core::did_you_mean(key.str(), all));
      if (!dynamics::applies(*effect, model_.kind))
        fail(name_, key.source(),
             "effect " + quoted(key.str()) + " does not exist on " + std::string(kind) +
                 "; expected one of " + core::listed(here));
      if (dynamics::needs_clutch(*effect) && !has_clutch(model_))
        fail(name_, key.source(),
             "effect " + quoted(key.str()) +
                 " in a model without a clutch; expected a tooth_pitch_m above 0 in [parameters]");
      read_effect(*effect, node);
    }
  }

  void read_effect(dynamics::Effect effect, const toml::node& node) {
    const auto& info = dynamics::info(effect);
    const std::string where = "[effect." + std::string(info.name) + "]";
    const toml::table& table = core::table(node, name_, where);
    std::vector<std::string_view> known;
    for (const auto& p : info.parameters()) known.push_back(dynamics::name_on(p, model_.kind));
    core::refuse_unknown_keys(table, name_, where, known);
    std::array<double, dynamics::kMaxEffectParameters> values{};
    for (std::size_t i = 0; i < known.size(); ++i) {
      const auto& p = info.parameters()[i];
      const std::string_view unit = dynamics::unit_on(p, model_.kind);
      const std::string expected = "a number from " + shortest(p.lower) + " to " + shortest(p.upper) +
                                   (unit.empty() ? "" : " " + std::string(unit));
      const toml::node& value = entry(table, where, known[i], expected);
      values[i] = core::number(value, name_, where + " " + std::string(known[i]), p.lower, p.upper, unit);
    }
    model_.effects.emplace(effect, values);
  }

  const std::string& name_;
  toml::table file_;
  Model model_;
};

}  // namespace

std::string no_such_kind(std::string_view name) {
  std::vector<std::string_view> kinds;
  for (const auto& k : dynamics::kMachines) kinds.push_back(k.name);
  if (name == "tree")
    return "kind 'tree', a robot from a URDF, is taken by sim, identify, diagnose and effects alone; expected one of " +
           core::listed(kinds);
  if (name == "planar_leg")
    return "kind 'planar_leg', a leg whose gaits are sought, is taken by furcula gait alone; expected one of " +
           core::listed(kinds);
  kinds.emplace_back("tree");
  const std::string expected = "; expected one of " + core::listed(kinds);
  return "unknown kind " + quoted(name) + expected + core::did_you_mean(name, kinds);
}

Model parse_model(std::string_view text, const std::string& name) { return Reader(text, name).read(); }

Model read_model(const std::string& path) {
  return parse_model(core::read_small_file(path, "a model file (TOML)"), path);
}

}  // namespace furcula::model
