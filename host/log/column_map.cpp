// Map files, see column_map.hpp.
#include "host/log/column_map.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/log/machine_types.hpp"

namespace furcula::log {
namespace {

using core::fail;
using core::text;

constexpr double kLargest = 1e12;  // of a scale or offset: beyond it a file is wrong, not foreign

double scale_of(const toml::node& node, const std::string& name, const std::string& key) {
  const double scale = core::number(node, name, key, -kLargest, kLargest);
  if (scale == 0.0)
    fail(name, node.source(), key + " = " + core::value_text(node) + "; expected another number than zero");
  return scale;
}

std::string column_name(const toml::node& node, const std::string& name, const std::string& key) {
  std::string column = text(node, name, key);
  if (column.empty()) fail(name, node.source(), key + " is ''; expected the name of a column of the log");
  return column;
}

const toml::array& array(const toml::node& node, const std::string& name, const std::string& key,
                         const char* expected) {
  const toml::array* values = node.as_array();
  if (values == nullptr || values->empty())
    fail(name, node.source(), key + " is " + core::value_text(node) + "; expected " + expected);
  return *values;
}

/// `columns` and `scales`: several columns that are added.
std::vector<MappedPart> parts_of(const toml::table& entry, const std::string& name, const std::string& ours) {
  const toml::node& columns = *entry.get("columns");
  for (const char* single : {"column", "scale"})
    if (const toml::node* node = entry.get(single))
      fail(name, node->source(),
           ours + " has the key '" + single + "' beside 'columns'; expected " + ours +
               " = { columns = [\"first\", \"second\"], scales = [1, 1e-9] }, a scale for each column");
  std::vector<MappedPart> parts;
  for (const toml::node& column :
       array(columns, name, ours + ".columns", "names of columns to add, as in [\"secs\", \"nsecs\"]")) {
    parts.push_back({column_name(column, name, ours + ".columns"), 1.0});
    for (std::size_t i = 0; i + 1 < parts.size(); ++i)
      if (parts[i].column == parts.back().column)
        fail(name, column.source(),
             ours + ".columns has " + core::quoted(parts[i].column) + " twice; expected each column once");
  }
  const toml::node* scales = entry.get("scales");
  if (scales == nullptr) return parts;
  const toml::array& values =
      array(*scales, name, ours + ".scales", "a scale for each column, as in [1, 1e-9]");
  if (values.size() != parts.size())
    fail(name, scales->source(),
         ours + " has " + std::to_string(parts.size()) + " columns and " + std::to_string(values.size()) +
             " scales; expected a scale for each column");
  for (std::size_t i = 0; i < parts.size(); ++i)
    parts[i].scale = scale_of(*values.get(i), name, ours + ".scales");
  return parts;
}

MappedColumn parse_mapped(const toml::node& node, const std::string& name, const std::string& ours,
                          ColumnKind kind) {
  static constexpr std::array<std::string_view, 6> kKeys{"column", "columns", "scale",
                                                         "scales", "offset",  "value"};
  const toml::table& entry = core::table(node, name, ours);
  core::refuse_unknown_keys(entry, name, ours, kKeys);
  MappedColumn mapped;
  mapped.line = node.source().begin.line;
  if (const toml::node* value = entry.get("value")) {
    if (entry.size() != 1)
      fail(name, value->source(),
           ours + " has the key 'value' beside others; expected a constant alone, " + ours +
               " = { value = 0.0 }, or a column");
    if (kind == ColumnKind::time)
      fail(name, value->source(), ours + " is a constant; expected a column, whose time increases");
    mapped.offset = core::number(*value, name, ours + ".value", -kLargest, kLargest);
    if (kind == ColumnKind::flag && mapped.offset != 0.0 && mapped.offset != 1.0)
      fail(name, value->source(), ours + ".value = " + core::value_text(*value) + "; expected 0 or 1");
    return mapped;
  }
  const toml::node* column = entry.get("column");
  if (entry.get("columns") != nullptr) {
    mapped.parts = parts_of(entry, name, ours);
  } else {
    if (column == nullptr)
      fail(name, node.source(),
           ours + " has no key 'column'; expected " + ours + " = { column = \"theirs\" }, several to add, " +
               ours + " = { columns = [\"secs\", \"nsecs\"], scales = [1, 1e-9] }, or a constant, " + ours +
               " = { value = 0.0 }");
    mapped.parts.push_back({column_name(*column, name, ours + ".column"), 1.0});
    if (const toml::node* scales = entry.get("scales"))
      fail(name, scales->source(), ours + " has the key 'scales' beside 'column'; expected 'scale'");
    if (const toml::node* scale = entry.get("scale"))
      mapped.parts.front().scale = scale_of(*scale, name, ours + ".scale");
  }
  if (const toml::node* offset = entry.get("offset"))
    mapped.offset = core::number(*offset, name, ours + ".offset", -kLargest, kLargest);
  return mapped;
}

/// A key that holds one of a few signs; none: it is not there.
std::optional<char> sign_of(const toml::table& file, const std::string& name, std::string_view key,
                            std::string_view signs, const char* expected) {
  const toml::node* node = file.get(key);
  if (node == nullptr) return std::nullopt;
  const std::string value = text(*node, name, std::string(key));
  if (value.size() != 1 || signs.find(value) == signs.npos)
    fail(name, node->source(), std::string(key) + " = " + core::value_text(*node) + "; expected " + expected);
  return value.front();
}

/// A column of the rig; of any rig where the map does not say which.
const ColumnInfo* column_of(const MachineType* rig, std::string_view name) {
  if (rig != nullptr) return rig->column(name);
  for (const MachineType& r : kMachineTypes)
    if (const ColumnInfo* column = r.column(name)) return column;
  return nullptr;
}

/// The rig that the map names, or null.
const MachineType* machine_type_of(const toml::table& file, const std::string& name) {
  const toml::node* node = file.get("machine_type");
  if (node == nullptr) return nullptr;
  std::vector<std::string_view> rigs;
  for (const MachineType& r : kMachineTypes) rigs.push_back(r.name);
  const std::string named = text(*node, name, "machine_type");
  const MachineType* rig = machine_type_named(named);
  if (rig == nullptr)
    fail(name, node->source(),
         "unknown machine type " + core::quoted(named) + "; expected one of " + core::listed(rigs) +
             core::did_you_mean(named, rigs));
  return rig;
}

}  // namespace

ColumnMap parse_column_map(std::string_view text_of_file, const std::string& name) {
  toml::table file = core::parse_toml(text_of_file, name);
  core::rename_key(file, "rig", "machine_type");
  const MachineType* rig = machine_type_of(file, name);
  ColumnMap map{name, rig == nullptr ? std::string{} : std::string(rig->name), {}, {}, '.'};

  constexpr std::ptrdiff_t kKeys = 4;  // beside columns
  std::vector<std::string_view> known{"machine_type", "separator", "decimal", "topic"};
  for (const auto& [key, node] : file)
    if (column_of(rig, key.str()) != nullptr) known.push_back(key.str());
  for (const MachineType& r : kMachineTypes) {
    if (rig != nullptr && rig != &r) continue;
    for (const ColumnInfo& c : r.columns) known.push_back(c.name);
    for (const ColumnPattern& p : r.patterns) known.push_back(p.info.name);
  }
  if (rig == nullptr) {  // rigs share names
    std::sort(known.begin() + kKeys, known.end());
    known.erase(std::unique(known.begin() + kKeys, known.end()), known.end());
  }
  core::refuse_unknown_keys(file, name, rig == nullptr ? "the map" : "the map of machine type " + map.rig,
                            known);
  map.separator = sign_of(file, name, "separator", ",;|\t ",
                          R"("," or ";" or "|" or "\t" or " " (any blanks), what stands between columns)");
  map.decimal =
      sign_of(file, name, "decimal", ".,", R"("." or ",", what stands before the decimals)").value_or('.');
  if (map.separator == map.decimal)
    fail(name, file.get("decimal")->source(),
         R"(decimal = "," where the columns are separated by commas; expected separator = ";" beside it)");
  if (const toml::node* topic = file.get("topic")) {
    map.topic = text(*topic, name, "topic");
    if (map.topic.empty())
      fail(name, topic->source(), "topic is empty; expected a topic of a ROS 2 bag, as in \"/joint_states\"");
  }
  for (const auto& [key, node] : file) {
    const std::string ours(key.str());
    if (ours == "machine_type" || ours == "separator" || ours == "decimal" || ours == "topic") continue;
    map.columns.emplace(ours, parse_mapped(node, name, ours, column_of(rig, ours)->kind));
  }
  if (map.columns.empty() && !map.separator && file.get("decimal") == nullptr && map.topic.empty())
    fail(name, file.source(),
         "no column is mapped, and no separator, decimal sign or topic is given; expected lines such as "
         "time_s = { column = \"theirs\" } or separator = \";\"");
  return map;
}

ColumnMap read_column_map(const std::string& path) {
  return parse_column_map(core::read_small_file(path, "a map file (TOML)"), path);
}

}  // namespace furcula::log
