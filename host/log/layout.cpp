// A log's metadata and header row, see layout.hpp.
#include "host/log/layout.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "host/core/message.hpp"

namespace furcula::log {
namespace {

constexpr std::string_view kSpace = " \t\r";
constexpr std::size_t kMostMetadata = std::size_t{1} << 20;  // bytes, so that memory stays bounded

// Suffixes that are units: `height_mm` is `height_m` in another unit, `torque_enable` is not a torque.
constexpr std::string_view kUnits[]{
    "s",    "ms",    "us",    "ns",   "min", "h",       "m",     "mm",  "cm",     "um",  "km",   "in",
    "inch", "ft",    "rad",   "mrad", "deg", "degrees", "turns", "rev", "counts", "mps", "mmps", "cmps",
    "kmph", "radps", "degps", "rpm",  "rps", "hz",      "n",     "kn",  "mn",     "lbf", "kgf",  "gf",
    "nm",   "mnm",   "nmm",   "ncm",  "knm", "lbft",    "lbin",  "kg",  "g",      "v",   "mv",   "kv",
    "a",    "ma",    "c",     "k",    "f",   "degc",    "degf",  "w",   "pct"};

// "height" and "mm" of "height_mm"; no unit if the suffix is none.
struct NameParts {
  std::string_view quantity;
  std::string_view unit;
};

NameParts parts(std::string_view name) {
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string_view::npos) return {name, {}};
  const std::string_view suffix = name.substr(underscore + 1);
  if (std::find(std::begin(kUnits), std::end(kUnits), suffix) == std::end(kUnits)) return {name, {}};
  return {name.substr(0, underscore), suffix};
}

// Offset of the first byte that is not UTF-8, or npos.
std::size_t first_not_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char lead = byte(i);
    const std::size_t length = lead < 0x80                    ? 1
                               : lead >= 0xC2 && lead <= 0xDF ? 2
                               : lead >= 0xE0 && lead <= 0xEF ? 3
                               : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                              : 0;
    if (length == 0 || i + length > text.size()) return i;
    for (std::size_t k = i + 1; k < i + length; ++k)
      if ((byte(k) & 0xC0) != 0x80) return i;
    // Overlong forms, surrogates, and what lies beyond the last code point.
    if ((lead == 0xE0 && byte(i + 1) < 0xA0) || (lead == 0xED && byte(i + 1) > 0x9F) ||
        (lead == 0xF0 && byte(i + 1) < 0x90) || (lead == 0xF4 && byte(i + 1) > 0x8F))
      return i;
    i += length;
  }
  return std::string_view::npos;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) + 1 - first);
}

std::string at(const RecordStream& records) {
  return records.name() + ":" + std::to_string(records.line()) + ": ";
}

void take_metadata(std::string_view record, const RecordStream& records, const RigInfo* rig,
                   LogHeader& header) {
  const std::size_t colon = record.find(':');
  if (colon == std::string_view::npos) return;
  const std::string key(trimmed(record.substr(1, colon - 1)));
  if (key.empty()) return;
  const std::string value(trimmed(record.substr(colon + 1)));
  if (key == "format" && value != "furcula-log/1")
    throw core::DataError(at(records) + "format is " + core::quoted(value) + "; expected furcula-log/1");
  if (key == "rig" && rig != nullptr && value != rig->name)
    throw core::DataError(at(records) + "rig is " + core::quoted(value) + "; expected " +
                          std::string(rig->name) + ", as the model, the map or --rig says");
  if (key == "rig" && rig_named(value) == nullptr) {
    std::vector<std::string_view> rigs;
    for (const RigInfo& r : kRigs) rigs.push_back(r.name);
    throw core::DataError(at(records) + "rig is " + core::quoted(value) + "; expected one of " +
                          core::listed(rigs) + core::did_you_mean(value, rigs));
  }
  header.metadata.insert_or_assign(key, value);
}

// The first record that is neither blank nor a comment. The comments before it go into the header. `rig` is
// what the log must be of; none: any.
std::string_view header_row(RecordStream& records, const RigInfo* rig, LogHeader& header) {
  std::string_view record;
  std::size_t metadata_bytes = 0;
  bool anything = false;
  while (records.next(record)) {
    anything = true;
    if (record.find('\0') != std::string_view::npos)
      throw core::DataError(at(records) + "a NUL byte; expected the text of a CSV log");
    if (const std::size_t bad = first_not_utf8(record); bad != std::string_view::npos)
      throw core::DataError(at(records) + "byte " + std::to_string(bad + 1) + " of the line, " +
                            core::quoted(record.substr(bad, 1)) + ", is not UTF-8; expected UTF-8 text");
    if (trimmed(record).empty()) continue;
    if (record.front() != '#') return record;
    metadata_bytes += record.size();
    if (metadata_bytes > kMostMetadata)
      throw core::DataError(at(records) + "more than 1 MiB of '#' lines; expected a header row");
    take_metadata(record, records, rig, header);
  }
  throw core::DataError(records.name() +
                        ":1: " + (anything ? "there is no header row" : "the file is empty") +
                        "; expected a CSV log with a header row");
}

std::vector<std::string> column_names(std::string_view row, const RecordStream& records, char separator) {
  std::vector<std::string> names;
  bool more = true;
  while (more) {
    names.push_back(take_field(row, more, separator));
    if (names.back().empty())
      throw core::DataError(at(records) + "column " + std::to_string(names.size()) +
                            " has no name; expected name_unit");
  }
  std::vector<std::string_view> sorted(names.begin(), names.end());
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    throw core::DataError(at(records) + "column " + core::quoted(*twice) +
                          " stands twice; expected each column once");
  return names;
}

// Refuses `height_mm` where the rig has `height_m` and the file has not.
void refuse_wrong_units(const Layout& layout, const RigInfo& rig, const RecordStream& records) {
  for (const std::string& name : layout.file_columns) {
    const NameParts theirs = parts(name);
    if (rig.column(name) != nullptr || theirs.unit.empty()) continue;
    for (const ColumnInfo& ours : rig.columns) {
      const bool same_quantity =
          ours.kind != ColumnKind::flag && parts(ours.name).quantity == theirs.quantity;
      const auto& columns = layout.file_columns;
      if (same_quantity && std::find(columns.begin(), columns.end(), ours.name) == columns.end())
        throw core::DataError(at(records) + "column " + core::quoted(name) + " has the unit '" +
                              std::string(theirs.unit) + "'; expected '" + std::string(ours.name) +
                              "' (convert it, or give a --map file with a scale)");
    }
    // angle_knee_deg where angle_knee_rad is meant. What none of our quantities begins like stays unknown.
    const std::string_view quantity = theirs.quantity;
    std::string_view meant;
    for (const ColumnPattern& p : rig.patterns) {
      if (!quantity.starts_with(p.prefix) || quantity.size() == p.prefix.size()) continue;
      const std::string ours = std::string(quantity) + "_" + std::string(p.unit);
      const auto& columns = layout.file_columns;
      if (std::find(columns.begin(), columns.end(), ours) != columns.end()) {
        meant = {};
        break;
      }
      if (meant.empty()) meant = p.unit;
    }
    if (!meant.empty())
      throw core::DataError(at(records) + "column " + core::quoted(name) + " has the unit '" +
                            std::string(theirs.unit) + "'; expected '" + std::string(quantity) + "_" +
                            std::string(meant) + "' (convert it, or give a --map file with a scale)");
  }
}

[[noreturn]] void missing(const ColumnInfo& column, const Layout& layout, const RigInfo& rig,
                          const RecordStream& records) {
  std::string message = at(records) + "no column '" + std::string(column.name) + "', which a log of rig " +
                        std::string(rig.name) + " must have";
  const std::vector<std::string_view> names(layout.file_columns.begin(), layout.file_columns.end());
  const std::string first = layout.file_columns.front();
  if (names.size() == 1 && first.find_first_of(",;\t") != std::string::npos)
    throw core::DataError(
        message + "; the header row is " + core::quoted(first) +
        (layout.separator == ','
             ? ": expected columns separated by commas (a --map file may say separator = \";\", "
               "and decimal = \",\")"
             : ": expected columns separated by what the map says"));
  constexpr std::size_t kMostListed = 20;
  message += "; the file has " + core::listed(std::span(names).first(std::min(names.size(), kMostListed))) +
             (names.size() > kMostListed ? ", ..." : "");
  throw core::DataError(message + core::did_you_mean(column.name, names) + " (names of foreign logs: --map)");
}

}  // namespace

Layout read_layout(RecordStream& records, const RigInfo& rig, const ColumnMap* map) {
  if (map != nullptr && map->rig != rig.name)
    throw core::DataError(map->path + ": rig is " + core::quoted(map->rig) + "; expected " +
                          std::string(rig.name) + ", as the model or --rig says");
  Layout layout;
  if (map != nullptr) {
    layout.separator = map->separator;
    layout.decimal = map->decimal;
  }
  const std::string_view row = header_row(records, &rig, layout.header);
  layout.header.line = records.line();
  layout.file_columns = column_names(row, records, layout.separator);
  layout.needed.assign(layout.file_columns.size(), false);
  if (map == nullptr) refuse_wrong_units(layout, rig, records);

  const auto add = [&](const std::string& name, std::size_t source, const MappedColumn* mapped) {
    const ColumnInfo* info = rig.column(name);
    if (info != nullptr && source != kConstant) layout.needed[source] = true;
    layout.channels.push_back({name, info != nullptr ? info->kind : ColumnKind::quantity, info != nullptr,
                               source, mapped != nullptr, mapped != nullptr ? mapped->scale : 1.0,
                               mapped != nullptr ? mapped->offset : 0.0});
    layout.header.columns.push_back(name);
  };
  std::vector<bool> taken(layout.file_columns.size(), false);
  if (map != nullptr)
    for (const auto& [ours, mapped] : map->columns) {
      if (mapped.column.empty()) {
        add(ours, kConstant, &mapped);
        continue;
      }
      const auto found = std::find(layout.file_columns.begin(), layout.file_columns.end(), mapped.column);
      if (found == layout.file_columns.end()) {
        const std::vector<std::string_view> names(layout.file_columns.begin(), layout.file_columns.end());
        const bool semicolons = names.size() == 1 && names.front().find_first_of(";\t") != names.front().npos;
        throw core::DataError(at(records) + "no column " + core::quoted(mapped.column) + ", which " +
                              map->path + " maps to " + core::quoted(ours) +
                              (semicolons
                                   ? "; the header row is " + core::quoted(names.front()) +
                                         ": expected separator = \";\" in the map, and decimal = \",\" where "
                                         "numbers have a comma"
                                   : core::did_you_mean(mapped.column, names)));
      }
      const auto source = static_cast<std::size_t>(found - layout.file_columns.begin());
      taken[source] = true;
      add(ours, source, &mapped);
    }
  // A column of the file that bears the name of a mapped one is not ours: the map says which is.
  for (std::size_t i = 0; i < layout.file_columns.size(); ++i)
    if (!taken[i] && (map == nullptr || !map->columns.contains(layout.file_columns[i])))
      add(layout.file_columns[i], i, nullptr);

  const auto& ours = layout.header.columns;
  for (const ColumnInfo& column : rig.columns)
    if (column.required && std::find(ours.begin(), ours.end(), column.name) == ours.end())
      missing(column, layout, rig, records);
  layout.time_channel =
      static_cast<std::size_t>(std::find(ours.begin(), ours.end(), "time_s") - ours.begin());
  return layout;
}

std::string read_rig_line(RecordStream& records) {
  LogHeader header;
  header_row(records, nullptr, header);
  const auto found = header.metadata.find("rig");
  return found == header.metadata.end() ? std::string{} : found->second;
}

}  // namespace furcula::log
