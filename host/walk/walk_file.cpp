#include "host/walk/walk_file.hpp"

#include <toml++/toml.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host/biped/robot.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::walk {
namespace {

using core::fail;

const toml::table& section(const toml::table& file, const std::string& name, const char* key) {
  const toml::node* node = file.get(key);
  if (node == nullptr) fail(name, file.source(), "no section [" + std::string(key) + "]; expected one");
  return core::table(*node, name, "[" + std::string(key) + "]");
}
const toml::node& entry(const toml::table& table, const std::string& name, std::string_view key,
                        const std::string& where) {
  const toml::node* node = table.get(key);
  if (node == nullptr)
    fail(name, table.source(), "no key '" + std::string(key) + "' in " + where + "; expected one");
  return *node;
}
void expect_schema(const toml::table& table, const std::string& name, const std::string& where) {
  const toml::node& schema = entry(table, name, "schema", where);
  if (!schema.is_integer() || schema.value<std::int64_t>() != 1)
    fail(name, schema.source(), "schema = " + core::value_text(schema) + "; expected 1");
}
void expect_kind(const toml::table& table, const std::string& name) {
  const toml::node& kind = entry(table, name, "kind", "[model]");
  if (const std::string which = core::text(kind, name, "kind"); which != "biped")
    fail(name, kind.source(), "kind = " + core::quoted(which) + "; expected \"biped\": walks are of a biped");
}

/// `up.swing.knee_rad` is the key knee_rad of the table [up.swing].
std::pair<std::string_view, std::string_view> parted(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return {name.substr(0, dot), name.substr(dot + 1)};
}
}  // namespace

Model read_model(const std::string& path) {
  static constexpr std::array<std::string_view, 2> kSections{"model", "limits"};
  static constexpr std::array<std::string_view, 3> kKeys{"kind", "schema", "urdf"};
  const toml::table file = core::parse_toml(core::read_small_file(path, "a model file (TOML)"), path);
  const toml::table& model = section(file, path, "model");
  expect_kind(model, path);
  core::refuse_unknown_keys(file, path, "the model file of a biped", kSections);
  core::refuse_unknown_keys(model, path, "[model] of a biped", kKeys);
  expect_schema(model, path, "[model]");
  Model out;
  out.file = path;
  const std::string urdf = core::text(entry(model, path, "urdf", "[model]"), path, "urdf");
  const model::Urdf robot = model::read_urdf((std::filesystem::path(path).parent_path() / urdf).string());
  out.name = robot.name;
  out.robot = biped::biped_of(robot);
  if (file.contains("limits")) {
    const toml::table& limits = section(file, path, "limits");
    std::vector<std::string_view> known;
    for (const LimitKey& k : kLimitKeys) known.push_back(k.name);
    core::refuse_unknown_keys(limits, path, "[limits]", known);
    for (const LimitKey& k : kLimitKeys)
      if (const toml::node* value = limits.get(k.name))
        out.limits.*k.of =
            core::number(*value, path, "[limits] " + std::string(k.name), k.least, k.most, k.unit);
  }
  return out;
}

std::string format_walk(const Walk& walk) {
  std::string out = "[walk]\nschema = 1\nrobot = " + core::value_text(toml::value<std::string>(walk.robot)) +
                    "\nmode = \"" + std::string(kModeNames[static_cast<std::size_t>(walk.mode)]) +
                    "\"\nwalk_until_s = " + core::toml_float(walk.walk_until_s) + "\n";
  const auto values = walk.parameters.values();
  std::string_view table;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [in, key] = parted(control::kWalkParameters[i].name);
    if (in != table) out += "\n[" + std::string(in) + "]\n";
    table = in;
    out += std::string(key) + " = " + core::toml_float(values[i]) + "\n";
  }
  return out;
}

Walk parse_walk(std::string_view text, const std::string& name) {
  static constexpr std::array<std::string_view, 4> kKeys{"schema", "robot", "mode", "walk_until_s"};
  const toml::table file = core::parse_toml(text, name);
  const toml::table& head = section(file, name, "walk");
  core::refuse_unknown_keys(head, name, "[walk]", kKeys);
  expect_schema(head, name, "[walk]");
  Walk out;
  out.robot = core::text(entry(head, name, "robot", "[walk]"), name, "robot");
  const toml::node& mode = entry(head, name, "mode", "[walk]");
  const std::string which = core::text(mode, name, "mode");
  const auto found = std::find(kModeNames.begin(), kModeNames.end(), which);
  if (found == kModeNames.end())
    fail(name, mode.source(),
         "mode = " + core::quoted(which) + "; expected one of " + core::listed(kModeNames) +
             core::did_you_mean(which, kModeNames));
  out.mode = static_cast<WalkMode>(found - kModeNames.begin());
  out.walk_until_s =
      core::number(entry(head, name, "walk_until_s", "[walk]"), name, "walk_until_s", 0.0, 1e4, "s");

  // Each table's keys, and the tables of tables.
  std::vector<std::string_view> top{"walk"};
  std::vector<std::pair<std::string_view, std::vector<std::string_view>>> tables;
  for (const auto& p : control::kWalkParameters) {
    const auto [in, key] = parted(p.name);
    if (tables.empty() || tables.back().first != in) tables.emplace_back(in, std::vector<std::string_view>{});
    tables.back().second.push_back(key);
    const std::string_view first = in.substr(0, in.find('.'));
    if (std::find(top.begin(), top.end(), first) == top.end()) top.push_back(first);
  }
  core::refuse_unknown_keys(file, name, "a walk", top);
  for (const std::string_view of : {"up", "down"}) {
    static constexpr std::array<std::string_view, 4> kUnder{"time_s", "blend_s", "swing", "stance"};
    if (const toml::table* t = file.at_path(of).as_table())
      core::refuse_unknown_keys(*t, name, "[" + std::string(of) + "]", kUnder);
  }
  std::array<double, Parameters::kCount> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& p = control::kWalkParameters[i];
    const auto [in, key] = parted(p.name);
    const std::string where = "[" + std::string(in) + "]";
    const toml::table* table = file.at_path(in).as_table();
    if (table == nullptr) fail(name, file.source(), "no section " + where + "; expected one");
    if (in != "up" && in != "down")
      for (const auto& [path, keys] : tables)
        if (path == in) core::refuse_unknown_keys(*table, name, where, keys);
    // A search stays between least and most; by hand one may go as far again.
    const double room = p.most - p.least, least = key.ends_with("_s") ? 0.01 : p.least - room;
    const auto round = [](double v) { return std::round(v * 1e6) / 1e6; };
    values[i] = core::number(entry(*table, name, key, where), name, where + " " + std::string(key),
                             round(least), round(p.most + room));
  }
  out.parameters = Parameters::of(values);
  return out;
}

Walk read_walk(const std::string& path) {
  return parse_walk(core::read_small_file(path, "a walk (TOML)"), path);
}

std::vector<std::string> broken_limits(const Rollout& r, const WalkLimits& m) {
  std::vector<std::string> out;
  const auto said = [](double v) { return core::rounded(v, 3); };
  const auto over = [&](bool broken, const std::string& what) {
    if (broken) out.push_back(what);
  };
  over(r.ending != Ending::stands,
       std::string(kEndingNames[static_cast<std::size_t>(r.ending)]) + " after " + said(r.time_s) + " s");
  over(r.torque_nm > m.torque_nm, "a motor gives " + said(r.torque_nm) + " N m of " + said(m.torque_nm));
  over(r.speed_radps > m.speed_radps,
       "a joint turns with " + said(r.speed_radps) + " rad/s of " + said(m.speed_radps));
  over(r.moment_nm > m.moment_nm, "a foot's moment is " + said(r.moment_nm) + " N m of " + said(m.moment_nm));
  const double inside_m = kSoleMargin_m - r.outside_m;
  over(r.ending == Ending::stands && r.outside_m > 0.0,
       "it has not stopped at the end: its capture point is " + said(100.0 * std::abs(inside_m)) + " cm " +
           (inside_m > 0.0 ? "inside" : "outside") + " of the soles, where " + said(100.0 * kSoleMargin_m) +
           " cm inside are asked");
  return out;
}

std::string to_json_text(const SearchResult& found, const std::optional<Evidence>& evidence,
                         const SearchOptions& options, const Model& model) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  const double asked_s = options.rollout.time_s;
  const Rollout& r = found.rollout;
  std::vector<std::string> limits = broken_limits(r, options.rollout.limits);
  if (!found.found && limits.empty())
    limits.push_back("it gets ahead by " + core::rounded(r.distance_m, 3) + " m, where " +
                     core::rounded(options.first_walk_m, 3) + " m are asked");

  const auto trial = [&](const Trial& t) {
    return Json{{"what", t.what},
                {"ending", kEndingNames[static_cast<std::size_t>(t.rollout.ending)]},
                {"keeps_limits", t.rollout.keeps_limits()},
                {"time_s", t.rollout.time_s},
                {"distance_m", t.rollout.distance_m},
                {"cot", number(t.rollout.cot)}};
  };
  Json history = Json::array();
  for (const SearchPoint& p : found.state.history)
    history.push_back({p.cpu_s, p.objective, number(p.cot), p.steps});
  Json out = {{"schema", "furcula-walk/1"},
              {"robot", model.name},
              {"mode", kModeNames[static_cast<std::size_t>(options.rollout.mode)]},
              {"seed", options.seed},
              {"method", kMethodNames[static_cast<std::size_t>(options.method)]},
              {"ended", found.interrupted ? "interrupted" : "budget"},
              {"found", found.found},
              {"first_walk", found.state.first_walk ? Json{{"cpu_s", found.state.first_walk->cpu_s},
                                                           {"steps", found.state.first_walk->steps},
                                                           {"rollouts", found.state.first_walk->rollouts}}
                                                    : Json(nullptr)},
              {"steps", found.state.steps},
              {"rollouts", found.state.rollouts},
              {"not_finite", found.state.not_finite},
              {"restarts", found.restarts},
              {"cpu_s", found.state.cpu_s},
              {"objective", r.objective(asked_s)},
              {"cot", number(r.cot)},
              {"distance_m", r.distance_m},
              {"landings", r.landings},
              {"energy_j",
               {{"total", r.energy_j()},
                {"copper", r.copper_j},
                {"work", r.work_j},
                {"positive_work", r.positive_work_j},
                {"constant", r.constant_j}}},
              {"most",
               {{"torque_nm", r.torque_nm},
                {"speed_radps", r.speed_radps},
                {"moment_nm", r.moment_nm},
                {"capture_point_outside_m", r.outside_m - kSoleMargin_m}}},
              {"limits", limits},
              {"history", history}};
  if (evidence) {
    Json steps = Json::array(), changed = Json::array();
    for (const Trial& t : evidence->steps) steps.push_back(trial(t));
    for (const Trial& t : evidence->changed) changed.push_back(trial(t));
    out["evidence"] = {{"steps", steps},
                       {"changed", changed},
                       {"noisy",
                        {{"walks", evidence->noisy},
                         {"stand", evidence->noisy_stand},
                         {"keep_limits", evidence->noisy_keep_limits}}}};
    const ReturnMap& map = evidence->map;
    Json& to = out["evidence"]["return_map"];
    if (map.found)
      to = {{"stride_s", map.stride_s},
            {"stride_m", map.stride_m},
            {"cot", map.cot},
            {"closure", map.closure},
            {"multipliers", map.multipliers}};
    else
      to = {{"none", map.none}};
  }
  return out.dump(1) + "\n";
}

}  // namespace furcula::walk
