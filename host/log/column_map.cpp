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

MappedColumn parse_mapped(const toml::node& node, const std::string& name, const std::string& ours,
                          ColumnKind kind) {
  static constexpr std::array<std::string_view, 4> kKeys{"column", "scale", "offset", "value"};
  const toml::table& entry = core::table(node, name, ours);
  core::refuse_unknown_keys(entry, name, ours, kKeys);
  MappedColumn mapped;
  if (const toml::node* value = entry.get("value")) {
    if (entry.size() != 1)
      fail(name, value->source(),
           ours + " has the key 'value' beside others; expected a constant alone, " + ours +
               " = { value = 0.0 }, or a column");
    if (kind == ColumnKind::time)
      fail(name, value->source(), ours + " is a constant; expected a column, whose time increases");
    mapped.scale = 0.0;
    mapped.offset = core::number(*value, name, ours + ".value", -kLargest, kLargest);
    if (kind == ColumnKind::flag && mapped.offset != 0.0 && mapped.offset != 1.0)
      fail(name, value->source(), ours + ".value = " + core::value_text(*value) + "; expected 0 or 1");
    return mapped;
  }
  const toml::node* column = entry.get("column");
  if (column == nullptr)
    fail(name, node.source(),
         ours + " has no key 'column'; expected " + ours + " = { column = \"theirs\" } or a constant, " +
             ours + " = { value = 0.0 }");
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

/// A key that holds one of a few signs.
char sign_of(const toml::table& file, const std::string& name, std::string_view key, std::string_view signs,
             char usual, const char* expected) {
  const toml::node* node = file.get(key);
  if (node == nullptr) return usual;
  const std::string value = text(*node, name, std::string(key));
  if (value.size() != 1 || signs.find(value) == signs.npos)
    fail(name, node->source(), std::string(key) + " = " + core::value_text(*node) + "; expected " + expected);
  return value.front();
}

}  // namespace

ColumnMap parse_column_map(std::string_view text_of_file, const std::string& name) {
  const toml::table file = core::parse_toml(text_of_file, name);
  std::vector<std::string_view> rigs;
  for (const RigInfo& r : kRigs) rigs.push_back(r.name);

  const toml::node* rig_node = file.get("rig");
  if (rig_node == nullptr)
    fail(name, file.source(), "no key 'rig'; expected rig = one of " + core::listed(rigs));
  ColumnMap map{name, text(*rig_node, name, "rig"), {}, ',', '.'};
  const RigInfo* rig = rig_named(map.rig);
  if (rig == nullptr)
    fail(name, rig_node->source(),
         "unknown rig " + core::quoted(map.rig) + "; expected one of " + core::listed(rigs) +
             core::did_you_mean(map.rig, rigs));

  std::vector<std::string_view> known{"rig", "separator", "decimal"};
  for (const ColumnInfo& c : rig->columns) known.push_back(c.name);
  for (const auto& [key, node] : file)
    if (!rig->patterns.empty() && rig->column(key.str()) != nullptr) known.push_back(key.str());
  for (const ColumnPattern& p : rig->patterns) known.push_back(p.info.name);
  core::refuse_unknown_keys(file, name, "the map of rig " + map.rig, known);
  map.separator =
      sign_of(file, name, "separator", ",;\t", ',', R"("," or ";" or "\t", what stands between columns)");
  map.decimal = sign_of(file, name, "decimal", ".,", '.', R"("." or ",", what stands before the decimals)");
  if (map.separator == map.decimal)
    fail(name, file.get("decimal")->source(),
         R"(decimal = "," where the columns are separated by commas; expected separator = ";" beside it)");
  for (const auto& [key, node] : file) {
    const std::string ours(key.str());
    if (ours == "rig" || ours == "separator" || ours == "decimal") continue;
    map.columns.emplace(ours, parse_mapped(node, name, ours, rig->column(ours)->kind));
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
