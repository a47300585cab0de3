#include "host/walk/walk_toml.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "furcula/control/walk/exercise.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/walk/toml_section.hpp"

namespace furcula::walk {
namespace {

using core::fail;

/// `up.swing.knee_rad` is the key knee_rad of the table [up.swing].
std::pair<std::string_view, std::string_view> parted(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return {name.substr(0, dot), name.substr(dot + 1)};
}

}  // namespace

std::string format_walk(const Walk& walk) {
  std::string out = "[walk]\nschema = 1\nrobot = " + core::value_text(toml::value<std::string>(walk.robot)) +
                    "\nmode = \"" + std::string(kModeNames[static_cast<std::size_t>(walk.mode)]) +
                    "\"\nwalk_until_s = " + core::toml_float(walk.walk_until_s) + "\n";
  if (walk.command_delay_s > 0.0) out += "command_delay_s = " + core::toml_float(walk.command_delay_s) + "\n";
  if (walk.exercise_s > 0.0) out += "exercise_s = " + core::toml_float(walk.exercise_s) + "\n";
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
  static constexpr std::array<std::string_view, 6> kKeys{"schema",       "robot",           "mode",
                                                         "walk_until_s", "command_delay_s", "exercise_s"};
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
  if (const toml::node* delay = head.get("command_delay_s"))
    out.command_delay_s = core::number(*delay, name, "command_delay_s", 0.0, kMostCommandDelay_s, "s");
  if (const toml::node* exercise = head.get("exercise_s"))
    out.exercise_s =
        core::number(*exercise, name, "exercise_s", control::kLeastExercise_s, control::kMostExercise_s, "s");

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

void require_steps(const Walk& walk, const std::string& name) {
  if (walk.exercise_s > 0.0)
    throw core::DataError(name + ": an exercise on the stand; expected a walk, without exercise_s");
}

Walk read_walk(const std::string& path) {
  return parse_walk(core::read_small_file(path, "a walk (TOML)"), path);
}

}  // namespace furcula::walk
