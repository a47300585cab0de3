// Map files, see column_map.hpp.
#include "host/log/column_map.hpp"

#include <array>
#include <vector>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/log/rigs.hpp"

namespace furcula::log {
namespace {

using core::fail;
using core::text;

constexpr double kLargest = 1e12;  // of a scale or offset: beyond it a file is wrong, not foreign

MappedColumn parse_mapped(const toml::node& node, const std::string& name, const std::string& ours) {
  static constexpr std::array<std::string_view, 3> kKeys{"column", "scale", "offset"};
  const toml::table& entry = core::table(node, name, ours);
  core::refuse_unknown_keys(entry, name, ours, kKeys);
  MappedColumn mapped;
  const toml::node* column = entry.get("column");
  if (column == nullptr)
    fail(name, node.source(), ours + " has no key 'column'; expected " + ours + " = { column = \"theirs\" }");
  mapped.column = text(*column, name, ours + ".column");
  if (mapped.column.empty())
    fail(name, column->source(), ours + ".column is ''; expected the name of a column of the log");
  if (const toml::node* scale = entry.get("scale")) {
    mapped.scale = core::number(*scale, name, ours + ".scale", -kLargest, kLargest);
    if (mapped.scale == 0.0)
      fail(name, scale->source(),
           ours + ".scale = " + core::value_text(*scale) + "; expected another number than zero");
  }
  if (const toml::node* offset = entry.get("offset"))
    mapped.offset = core::number(*offset, name, ours + ".offset", -kLargest, kLargest);
  return mapped;
}

}  // namespace

ColumnMap parse_column_map(std::string_view text_of_file, const std::string& name) {
  const toml::table file = core::parse_toml(text_of_file, name);
  std::vector<std::string_view> rigs;
  for (const RigInfo& r : kRigs) rigs.push_back(r.name);

  const toml::node* rig_node = file.get("rig");
  if (rig_node == nullptr)
    fail(name, file.source(), "no key 'rig'; expected rig = one of " + core::listed(rigs));
  ColumnMap map{name, text(*rig_node, name, "rig"), {}};
  const RigInfo* rig = rig_named(map.rig);
  if (rig == nullptr)
    fail(name, rig_node->source(),
         "unknown rig " + core::quoted(map.rig) + "; expected one of " + core::listed(rigs) +
             core::did_you_mean(map.rig, rigs));

  std::vector<std::string_view> known{"rig"};
  for (const ColumnInfo& c : rig->columns) known.push_back(c.name);
  for (const auto& [key, node] : file)
    if (!rig->patterns.empty() && rig->column(key.str()) != nullptr) known.push_back(key.str());
  for (const ColumnPattern& p : rig->patterns) known.push_back(p.info.name);
  core::refuse_unknown_keys(file, name, "the map of rig " + map.rig, known);
  for (const auto& [key, node] : file)
    if (key.str() != "rig") {
      const std::string ours(key.str());
      map.columns.emplace(ours, parse_mapped(node, name, ours));
    }
  if (map.columns.empty())
    fail(name, rig_node->source(),
         "no column is mapped; expected lines such as time_s = { column = \"theirs\" }");
  return map;
}

ColumnMap read_column_map(const std::string& path) {
  return parse_column_map(core::read_small_file(path, "a map file (TOML)"), path);
}

}  // namespace furcula::log
