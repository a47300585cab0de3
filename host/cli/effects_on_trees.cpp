// Effects on robots of several joints, see effects_on_trees.hpp.
#include "host/cli/effects_on_trees.hpp"

#include <algorithm>
#include <iterator>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "host/core/message.hpp"

namespace furcula::cli {
namespace {

using trees::LocationType;
using trees::Parameter;

/// "a" or, where it has another name or unit on a prismatic joint, "a (b on a prismatic joint)".
std::string with_linear(const std::string& name, const std::string& linear) {
  return name == linear ? name : name + " (" + linear + " on a prismatic joint)";
}
std::string unit_or_one(std::string_view unit) { return unit.empty() ? "1" : std::string(unit); }
std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

struct LocationTypeText {
  LocationType location_type;
  std::string_view what, site;
};
constexpr LocationTypeText kLocationTypes[] = {
    {LocationType::joint, "in a joint, between its two links", "the joint's name"},
    {LocationType::drive, "in the drive of a joint", "the joint's name"},
    {LocationType::encoder, "in the encoder of a joint", "the joint's name"},
    {LocationType::link, "in the body of a link", "the link's name"},
    {LocationType::base, "under the robot", "`base`"},
};

}  // namespace

std::string markdown_cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != text.npos; i += 2) text.insert(i, 1, '\\');
  return text;
}

bool on_trees_alone(const trees::EffectInfo& effect) {
  return std::none_of(std::begin(dynamics::kCatalogue), std::end(dynamics::kCatalogue),
                      [&](const auto& e) { return e.name == effect.name; });
}

std::string tree_effect_text(const trees::EffectInfo& e) {
  std::string out = std::string(e.name) + "\n  model       " + std::string(e.law) + "\n  location    " +
                    std::string(trees::name(e.location_type)) + "\n";
  for (const Parameter& p : e.parameters())
    out += "  parameter   " + with_linear(std::string(p.name), std::string(p.linear_name)) + ", in " +
           unit_or_one(p.unit) + ", from " + core::shortest(p.lower) + " to " + core::shortest(p.upper) +
           "\n";
  return out + "  what        " + std::string(e.explanation) + "\n  look at     " +
         std::string(e.where_to_look) + "\n  experiment  " + std::string(e.experiment) + "\n";
}

nlohmann::ordered_json tree_effect_json(const trees::EffectInfo& e) {
  nlohmann::ordered_json out{
      {"effect", e.name}, {"model", e.law}, {"location_type", trees::name(e.location_type)}};
  for (const Parameter& p : e.parameters())
    out["parameters"].push_back({{"name", p.name},
                                 {"unit", p.unit},
                                 {"linear_name", p.linear_name},
                                 {"linear_unit", p.linear_unit},
                                 {"lower", p.lower},
                                 {"upper", p.upper}});
  out["explanation"] = e.explanation;
  out["where_to_look"] = e.where_to_look;
  out["best_experiment"] = e.experiment;
  return out;
}

std::string tree_effects_markdown() {
  std::string out =
      "\n# Effects on robots of several joints\n\n"
      "For `kind = \"tree\"` ([trees](trees.md)), from `host/trees/effects.cpp`. `q` and `v` are position and velocity of the joint.\n"
      "In parentheses: on a prismatic joint. Damping, mass, rotor inertia and gains are absolute values.\n\n"
      "| location type | the model acts | a location is |\n|---|---|---|\n";
  for (const LocationTypeText& s : kLocationTypes)
    out += "| " + std::string(trees::name(s.location_type)) + " | " + std::string(s.what) + " | " +
           std::string(s.site) + " |\n";
  out +=
      "\n| effect | location type | model | parameter | unit | from | to |\n|---|---|---|---|---|---|---|\n";
  const auto with_brackets = [](const std::string& name, const std::string& linear) {
    return name == linear ? name : name + " (" + linear + ")";
  };
  for (const trees::EffectInfo& e : trees::catalogue()) {
    const std::string link = "[" + code(e.name) + "](#" + std::string(e.name) + ")";
    std::string head = link + " | " + std::string(trees::name(e.location_type)) + " | " +
                       code(markdown_cell(std::string(e.law)));
    for (const Parameter& p : e.parameters()) {
      out += "| " + head + " | " + with_brackets(code(p.name), code(p.linear_name)) + " | " +
             with_brackets(unit_or_one(p.unit), unit_or_one(p.linear_unit)) + " | " +
             core::shortest(p.lower) + " | " + core::shortest(p.upper) + " |\n";
      head = "| |";
    }
  }
  for (const trees::EffectInfo& e : trees::catalogue())
    if (on_trees_alone(e))
      out += "\n## " + std::string(e.name) + "\n\n" + std::string(e.explanation) +
             "\n\n- Check: " + std::string(e.where_to_look) + "\n- Experiment: " + std::string(e.experiment) +
             "\n";
  return out;
}

}  // namespace furcula::cli
