// A proposed map as a file, see propose.hpp.
#include <algorithm>

#include "host/core/message.hpp"
#include "host/mapping/propose.hpp"

namespace furcula::mapping {
namespace {

/// A TOML string.
std::string text(const std::string& value) {
  std::string out = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\t')
      out += "\\t";
    else
      out += c;
  }
  return out + '"';
}

/// A TOML key: quoted where it is not a bare one.
std::string key(const std::string& name) {
  const bool bare = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  return bare ? name : text(name);
}

/// A number that TOML takes for one with decimals or without.
std::string number(double value) { return core::shortest(value); }

std::string line_text(const Line& line) {
  std::string out = key(line.ours) + " = { ";
  const auto& parts = line.column.parts;
  if (parts.size() == 1) {
    out += "column = " + text(parts.front().column);
    if (parts.front().scale != 1.0) out += ", scale = " + number(parts.front().scale);
  } else {
    std::string columns, scales;
    for (const log::MappedPart& p : parts) {
      columns += (columns.empty() ? "" : ", ") + text(p.column);
      scales += (scales.empty() ? "" : ", ") + number(p.scale);
    }
    out += "columns = [" + columns + "], scales = [" + scales + "]";
  }
  if (line.column.offset != 0.0) out += ", offset = " + number(line.column.offset);
  return out + " }";
}

std::string comment(const std::string& sentence) { return "# " + core::printable(sentence) + "\n"; }

}  // namespace

std::string map_text(const Proposal& p) {
  static constexpr const char* kSure[]{"sure", "likely", "CONFIRM"};
  std::string out =
      comment("Proposed by furcula map from " + p.log + ". Look at the lines that are not sure.");
  for (const std::string& sentence : p.confirm) out += comment(sentence);
  out += "machine_type = " + text(p.rig) + "\n";
  if (p.decimal != '.')
    out += "separator = " + text(std::string(1, p.separator)) +
           "\ndecimal = " + text(std::string(1, p.decimal)) + "\n";
  for (const Line& line : p.lines) {
    std::string why;
    for (const std::string& reason : line.why) why += (why.empty() ? "" : "; ") + reason;
    out += "\n" + comment(std::string(kSure[static_cast<int>(line.sureness)]) + ": " + why) +
           line_text(line) + "\n";
  }
  if (!p.expected.empty()) {
    out += "\n# No column was found for these:\n";
    for (const std::string& name : p.expected) out += comment("  " + name);
  }
  if (!p.left.empty()) {
    out += "\n# Columns of the log that are not used:\n";
    for (const std::string& name : p.left) out += comment("  " + name);
  }
  return out;
}

}  // namespace furcula::mapping
