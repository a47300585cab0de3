// `furcula effects`: the catalogue of effects, for reading, for programs and for the documentation.
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/effects_on_trees.hpp"
#include "host/cli/errors.hpp"
#include "host/core/message.hpp"
#include "host/model/reader.hpp"
#include "host/trees/effects.hpp"

namespace furcula::cli {
namespace {

using core::shortest;
using dynamics::EffectInfo;
using dynamics::EffectParameterInfo;
using dynamics::Kind;

struct EffectsOptions {
  std::string name;
  std::string kind;
  bool json = false;
  bool markdown = false;
};

std::string_view stage_name(dynamics::Stage stage) {
  switch (stage) {
    case dynamics::Stage::actuation:
      return "actuation";
    case dynamics::Stage::mechanism:
      return "mechanism";
    case dynamics::Stage::contact:
      return "contact";
    case dynamics::Stage::sensing:
      return "sensing";
  }
  return "";
}

std::vector<Kind> kinds_of(const EffectInfo& effect) {
  std::vector<Kind> kinds;
  for (const auto& k : dynamics::kMachines)
    if (dynamics::applies(effect.effect, k.kind)) kinds.push_back(k.kind);
  return kinds;
}

std::string kind_list(const EffectInfo& effect) {
  std::vector<std::string_view> names;
  for (const Kind k : kinds_of(effect)) names.push_back(dynamics::info(k).name);
  return core::listed(names);
}

// "N" or, where the effect exists on both sorts of axis and differs, "N (N m on a rotary joint)".
std::string with_rotary(std::string_view linear, std::string_view rotary, const EffectInfo& effect) {
  bool on_rotary = false;
  for (const Kind k : kinds_of(effect)) on_rotary = on_rotary || dynamics::info(k).rotary;
  std::string out(linear);
  if (on_rotary && linear != rotary) out += " (" + std::string(rotary) + " on a rotary joint)";
  return out;
}

bool has_leg(Kind kind) { return dynamics::has(kind, dynamics::LocationType::leg); }

/// The parameter's value while the effect is off, in words where it depends on the model or the kind.
std::string neutral_text(const EffectInfo& effect, const EffectParameterInfo& p, std::optional<Kind> kind) {
  if (!std::isnan(p.neutral)) return shortest(p.neutral);
  if (p.model_parameter == dynamics::kNotOfModel) return "any";
  if (!p.model_parameter.empty()) return "the model's " + std::string(p.model_parameter);
  bool of_model = false, of_leg = false, elsewhere = false;
  for (const Kind k : kind ? std::vector{*kind} : kinds_of(effect)) {
    (has_leg(k) ? of_leg : elsewhere) = true;
    of_model = of_model || dynamics::parameter_index(k, dynamics::name_on(p, k));
  }
  if (p.added_on_leg && of_leg) return elsewhere ? "the model's; 0 on a hopper" : "0";
  return of_model ? "the model's" : "any";
}

/// A parameter's name; `quote` on both sides of it.
std::string name_text(const EffectParameterInfo& p, const EffectInfo& effect, std::optional<Kind> kind,
                      const std::string& quote = "") {
  const auto quoted = [&](std::string_view name) { return quote + std::string(name) + quote; };
  return kind ? quoted(dynamics::name_on(p, *kind))
              : with_rotary(quoted(p.name), quoted(p.rotary_name), effect);
}
std::string unit_text(const EffectParameterInfo& p, const EffectInfo& effect, std::optional<Kind> kind) {
  if (p.unit.empty()) return "1";
  return kind ? std::string(dynamics::unit_on(p, *kind)) : with_rotary(p.unit, p.rotary_unit, effect);
}

/// Stance and flight are the hopper's.
bool has_phases(std::optional<Kind> kind) { return !kind || has_leg(*kind); }

void print_text(const EffectInfo& e, std::optional<Kind> kind) {
  std::cout << e.name << "\n  model       " << e.law << "\n  stage       " << stage_name(e.stage)
            << (has_phases(kind) ? ", " + std::string(e.phase) : "") << "\n  kinds       " << kind_list(e)
            << "\n";
  if (const auto on_tree = trees::effect_named(e.name); on_tree && !kind)
    std::cout << "  on a tree   location type " << trees::name(trees::info(*on_tree).location_type)
              << " (--kind tree)\n";
  for (const auto& p : e.parameters())
    std::cout << "  parameter   " << name_text(p, e, kind) << ", in " << unit_text(p, e, kind) << ", from "
              << shortest(p.lower) << " to " << shortest(p.upper)
              << "; without the effect: " << neutral_text(e, p, kind) << "\n";
  std::cout << "  what        " << e.explanation << "\n  look at     " << e.where_to_look
            << "\n  experiment  " << e.best_experiment << "\n";
}

/// `a` or, where the effect exists on both sorts of axis and differs, `a` (`b`).
std::string with_brackets(const std::string& linear, const std::string& rotary, const EffectInfo& effect) {
  return with_rotary(linear, rotary, effect) == linear ? linear : linear + " (" + rotary + ")";
}

void print_markdown(const std::vector<const EffectInfo*>& effects, std::optional<Kind> kind) {
  std::cout
      << "# Effects\n\n"
         "The causes that a simulation can have and a diagnosis can name. This page is what `furcula effects --markdown` prints, from\n"
         "`common/include/furcula/dynamics/effects/catalogue.hpp`. `v` is the velocity of the axis; forces are positive in the direction of\n"
         "growing position. In parentheses: on a rotary joint. Off: the parameter's value without the effect. "
         "Robots of several joints:\n[below](#effects-on-robots-of-several-joints).\n";
  for (const EffectInfo* e : effects) {
    std::cout << "\n## " << e->name << "\n\n"
              << e->explanation << "\n\n- Model: `" << e->law << "`; " << stage_name(e->stage)
              << (e->phase.empty() ? "" : ", " + std::string(e->phase)) << "\n- Machines: " << kind_list(*e)
              << "\n";
    for (const auto& p : e->parameters()) {
      const auto quoted = [](std::string_view name) { return "`" + std::string(name) + "`"; };
      std::cout << "- "
                << (kind ? name_text(p, *e, kind, "`")
                         : with_brackets(quoted(p.name), quoted(p.rotary_name), *e));
      if (!p.unit.empty())
        std::cout << ", "
                  << (kind ? unit_text(p, *e, kind)
                           : with_brackets(std::string(p.unit), std::string(p.rotary_unit), *e));
      std::cout << ": " << shortest(p.lower) << " to " << shortest(p.upper)
                << "; off: " << neutral_text(*e, p, kind) << "\n";
    }
    std::cout << "- Check: " << e->where_to_look << "\n- Experiment: " << e->best_experiment << "\n";
  }
}

nlohmann::ordered_json to_json(const EffectInfo& e, std::optional<Kind> kind) {
  nlohmann::ordered_json out{{"effect", e.name}, {"model", e.law}, {"stage", stage_name(e.stage)}};
  if (has_phases(kind)) out["phase"] = e.phase;
  for (const Kind k : kinds_of(e)) out["kinds"].push_back(dynamics::info(k).name);
  for (const auto& p : e.parameters()) {
    nlohmann::ordered_json parameter{{"name", kind ? dynamics::name_on(p, *kind) : p.name},
                                     {"unit", kind ? dynamics::unit_on(p, *kind) : p.unit}};
    if (!kind) {
      parameter["rotary_name"] = p.rotary_name;
      parameter["rotary_unit"] = p.rotary_unit;
    }
    parameter["lower"] = p.lower;
    parameter["upper"] = p.upper;
    const double neutral = p.added_on_leg && kind && has_leg(*kind) ? 0.0 : p.neutral;
    parameter["neutral"] = std::isnan(neutral) ? nlohmann::ordered_json() : nlohmann::ordered_json(neutral);
    out["parameters"].push_back(parameter);
  }
  out["explanation"] = e.explanation;
  out["where_to_look"] = e.where_to_look;
  out["best_experiment"] = e.best_experiment;
  return out;
}

/// What a robot of several joints can have: effects at locations (host/trees/effects.hpp).
void run_on_trees(const EffectsOptions& options) {
  if (options.markdown)
    throw UsageError(
        "--markdown writes docs/effects.md: expected neither --kind tree nor an effect of trees alone with it");
  std::vector<std::string_view> names;
  nlohmann::ordered_json out{{"schema", "furcula-effects/1"}, {"effects", nlohmann::ordered_json::array()}};
  std::string text;
  for (const trees::EffectInfo& e : trees::catalogue()) {
    names.push_back(e.name);
    if (!options.name.empty() && options.name != e.name) continue;
    text += (text.empty() ? "" : "\n") + tree_effect_text(e);
    out["effects"].push_back(tree_effect_json(e));
  }
  if (text.empty())
    throw UsageError("no effect " + core::quoted(options.name) + " on tree; expected one of " +
                     core::listed(names) + core::did_you_mean(options.name, names));
  std::cout << (options.json ? out.dump(2) + "\n" : text);
}

/// One that trees alone have needs no --kind.
bool of_trees_alone(const std::string& name) {
  const auto effect = trees::effect_named(name);
  return effect && on_trees_alone(trees::info(*effect));
}

void run(const EffectsOptions& options) {
  if (options.json && options.markdown) throw UsageError("--json and --markdown: expected one of them");
  if (options.kind == "tree" || (options.kind.empty() && of_trees_alone(options.name)))
    return run_on_trees(options);
  std::optional<Kind> kind;
  if (!options.kind.empty()) {
    kind = dynamics::kind_named(options.kind);
    if (!kind) throw UsageError("--kind: " + model::no_such_kind(options.kind));
  }
  std::vector<std::string_view> names;
  std::vector<const EffectInfo*> effects;
  for (const EffectInfo& e : dynamics::kCatalogue) {
    if (kind && !dynamics::applies(e.effect, *kind)) continue;
    names.push_back(e.name);
    if (options.name.empty() || options.name == e.name) effects.push_back(&e);
  }
  if (!kind)
    for (const trees::EffectInfo& e : trees::catalogue())
      if (on_trees_alone(e)) names.push_back(e.name);
  if (effects.empty())
    throw UsageError("no effect " + core::quoted(options.name) + (kind ? " on " + options.kind : "") +
                     "; expected one of " + core::listed(names) + core::did_you_mean(options.name, names));

  if (options.markdown) {
    print_markdown(effects, kind);
    if (!kind && options.name.empty()) std::cout << tree_effects_markdown();
  } else if (options.json) {
    nlohmann::ordered_json out{{"schema", "furcula-effects/1"}};
    for (const EffectInfo* e : effects) out["effects"].push_back(to_json(*e, kind));
    std::cout << out.dump(2) << "\n";
  } else {
    for (const EffectInfo* e : effects) {
      if (e != effects.front()) std::cout << "\n";
      print_text(*e, kind);
    }
    if (!kind && options.name.empty())
      for (const trees::EffectInfo& e : trees::catalogue())
        if (on_trees_alone(e)) std::cout << "\n" << tree_effect_text(e);
  }
}

}  // namespace

void add_effects_command(CLI::App& app) {
  const auto options = std::make_shared<EffectsOptions>();
  CLI::App* command =
      app.add_subcommand("effects", "The catalogue of effects: models, units, bounds, experiments");
  command->add_option("NAME", options->name, "One effect only");
  command->add_option("--kind", options->kind,
                      "Effects and parameter names of this kind of machine; tree: a robot of several joints");
  command->add_flag("--json", options->json, "For programs");
  command->add_flag("--markdown", options->markdown, "For docs/effects.md");
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
