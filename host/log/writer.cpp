// Writing logs, see writer.hpp.
#include "host/log/writer.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/log/machine_types.hpp"

namespace furcula::log {
namespace {

bool has_any(std::string_view text, std::string_view bytes) { return text.find_first_of(bytes) != text.npos; }

bool has_outer_space(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r";
  return !text.empty() &&
         (kSpace.find(text.front()) != kSpace.npos || kSpace.find(text.back()) != kSpace.npos);
}

// A column's name as a CSV field; in quotes where it would not be read back otherwise.
std::string header_field(const std::string& name) {
  if (!has_any(name, ",\"\r\n") && !has_outer_space(name) && name.front() != '#') return name;
  std::string out = "\"";
  for (const char c : name) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

void append_metadata(std::string& out, const std::string& key, const std::string& value) {
  if (key.empty() || has_any(key, ":\n") || has_any(value, "\n") || has_outer_space(key) ||
      has_outer_space(value))
    throw std::invalid_argument("metadata " + core::quoted(key) + ": " + core::quoted(value) +
                                " cannot be written as a line");
  out += "# " + key + ": " + value + "\n";
}

}  // namespace

std::string format_log(const Log& log, Comments comments) {
  std::string out;
  append_metadata(out, "format", "furcula-log/1");
  append_metadata(out, "machine_type", log.rig);
  for (const auto& [key, value] : log.metadata)
    if (key != "format" && key != "machine_type") append_metadata(out, key, value);
  if (comments == Comments::without) out.clear();

  // The contract's columns in its order, then the others by name.
  std::vector<const std::vector<double>*> columns;
  const auto add = [&](const std::string& name, const std::vector<double>& values) {
    if (name.empty() || values.size() != log.rows())
      throw std::invalid_argument("column " + core::quoted(name) +
                                  " has no name or not as many rows as the others");
    if (!columns.empty()) out += ',';
    out += header_field(name);
    columns.push_back(&values);
  };
  const MachineType* rig = machine_type_named(log.rig);
  if (rig == nullptr) throw std::invalid_argument("no machine type is called " + core::quoted(log.rig));
  for (const ColumnInfo& c : rig->columns)
    if (const auto found = log.columns.find(std::string(c.name)); found != log.columns.end())
      add(found->first, found->second);
  for (const auto& [name, values] : log.columns)
    // Those of named joints stand in the rig's table as patterns.
    if (const ColumnInfo* c = rig->column(name); c == nullptr || c->name != name) add(name, values);
  out += '\n';

  char number[32];
  for (std::size_t row = 0; row < log.rows(); ++row) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double value = (*columns[i])[row];
      if (!std::isfinite(value))
        throw std::invalid_argument("row " + std::to_string(row + 1) +
                                    " of the log holds a value that is not finite");
      if (i != 0) out += ',';
      out.append(number, std::to_chars(number, number + sizeof number, value).ptr);
    }
    out += '\n';
  }
  return out;
}

void write_log(const Log& log, const std::string& path, Comments comments) {
  core::write_file_atomically(path, format_log(log, comments));
}

}  // namespace furcula::log
