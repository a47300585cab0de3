// A log's metadata and header row, see layout.hpp.
#include "host/log/layout.hpp"

#include <algorithm>
#include <optional>

#include "host/core/message.hpp"
#include "host/log/column_units.hpp"
#include "host/log/header_row.hpp"
#include "host/log/header_search.hpp"
#include "host/log/time_columns.hpp"
#include "host/log/top.hpp"

namespace furcula::log {
namespace {

[[noreturn]] void missing(const std::string& name, const std::string& mapped_to, const Layout& layout,
                          const MachineType& rig, const ColumnMap* map, const RecordStream& records) {
  const std::vector<std::string_view> all(layout.file_columns.begin(), layout.file_columns.end());
  std::vector<std::string_view> names;
  for (const std::string_view n : all)
    if (!n.empty()) names.push_back(n);
  std::string message = place(records) + "no column " + core::quoted(name) + ", which ";
  if (mapped_to.empty())
    message += "a log of machine type " + std::string(rig.name) + " must have";
  else
    message += map->path + " maps to " + core::quoted(mapped_to);
  const std::string row = names.empty() ? std::string{} : std::string(names.front());
  if (names.size() == 1 && row.find_first_of(",;|\t ") != std::string::npos)
    throw core::DataError(
        message + "; the header row is " + core::quoted(row) + ": " +
        (layout.separator == ','
             ? "expected columns separated by commas"
             : "the map says that " + name_of(layout.separator) + " separates the columns") +
        " (in a --map file separator = \";\" or \"|\" or \"\\t\" or \" \", any blanks, says what separates them, "
        "and decimal = \",\" that numbers have a comma)");
  constexpr std::size_t kMostListed = 20;
  constexpr std::size_t kLongest = 80;  // what stands there may be no name
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(names.size(), kMostListed); ++i)
    shown.push_back(std::string(names[i].substr(0, kLongest)) + (names[i].size() > kLongest ? "..." : ""));
  message += "; the file has " + core::listed(std::vector<std::string_view>(shown.begin(), shown.end())) +
             (names.size() > kMostListed ? ", ..." : "");
  const std::string hint = core::did_you_mean(name, names);
  const std::string adds =
      name == "time_s" || mapped_to == "time_s" ? line_that_adds(layout.file_columns) : "";
  const std::string ours = core::printable(mapped_to.empty() ? name : mapped_to);
  throw core::DataError(
      message + hint +
      (!adds.empty() ? " (seconds and their fraction: a --map file with the line " + adds + ")"
       : map != nullptr && !mapped_to.empty()
           ? "; write in " + map->path + " which of them is " + ours
           : " (a --map file says which column is which: " + ours + " = { column = \"theirs\" })"));
}

/// A note of the columns that nothing asks for: without a name, or with one that another has.
void note_odd_names(const std::vector<std::size_t>& unnamed, const std::vector<std::string>& twice,
                    Layout& layout, const RecordStream& records) {
  const std::string path = core::printable(records.name()) + ": ";
  constexpr std::size_t kListed = 5;
  const auto list = [&](const auto& all, const auto& text) {
    std::string out;
    for (std::size_t i = 0; i < std::min(kListed, all.size()); ++i)
      out += (i == 0 ? "" : ", ") + text(all[i]);
    return out + (all.size() > kListed ? ", ..." : "");
  };
  if (!unnamed.empty())
    layout.notes.push_back(
        path + counted(unnamed.size(), "column without a name was", "columns without a name were") +
        " ignored: " + (unnamed.size() == 1 ? "column " : "columns ") +
        list(unnamed, [](std::size_t i) { return std::to_string(i + 1); }) + ".");
  if (!twice.empty())
    layout.notes.push_back(path + list(twice, [](const std::string& n) { return core::quoted(n); }) +
                           (twice.size() == 1 ? " stands" : " stand") +
                           " more than once in the header row: only the first column of that name was kept.");
}

/// The columns of the file that are ours, by the map or by their own names.
void add_channels(Layout& layout, const MachineType& rig, const ColumnMap* map, const RecordStream& records) {
  const std::vector<std::string>& columns = layout.file_columns;
  layout.needed.assign(columns.size(), false);
  const auto add = [&](const std::string& name, std::vector<Source> sources, const MappedColumn* mapped) {
    const ColumnInfo* info = rig.column(name);
    if (info != nullptr)
      for (const Source& s : sources) {
        const std::string& theirs = columns[s.column];
        if (std::count(columns.begin(), columns.end(), theirs) > 1)
          throw core::DataError(place(records) + "column " + core::quoted(theirs) +
                                " stands twice; expected each column once (give one of them another name)");
        layout.needed[s.column] = true;
      }
    layout.channels.push_back({name, info != nullptr ? info->kind : ColumnKind::quantity, info != nullptr,
                               std::move(sources), mapped != nullptr,
                               mapped != nullptr ? mapped->offset : 0.0, info != nullptr && info->required});
    layout.header.columns.push_back(name);
  };
  std::vector<bool> taken(columns.size(), false);
  if (map != nullptr)
    for (const auto& [ours, mapped] : map->columns) {
      std::vector<Source> sources;
      for (const MappedPart& part : mapped.parts) {
        const auto found = std::find(columns.begin(), columns.end(), part.column);
        if (found == columns.end()) missing(part.column, ours, layout, rig, map, records);
        sources.push_back({static_cast<std::size_t>(found - columns.begin()), part.scale});
        taken[sources.back().column] = true;
      }
      add(ours, std::move(sources), &mapped);
    }
  std::vector<std::size_t> unnamed;
  std::vector<std::string> twice;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    // A column of the file that bears the name of a mapped one is not ours: the map says which is.
    if (taken[i] || (map != nullptr && map->columns.contains(columns[i]))) continue;
    const auto begin = columns.begin(), here = begin + static_cast<std::ptrdiff_t>(i);
    if (columns[i].empty())
      unnamed.push_back(i);
    else if (std::find(begin, here, columns[i]) == here)
      add(columns[i], {{i, 1.0}}, nullptr);
    else if (std::find(twice.begin(), twice.end(), columns[i]) == twice.end())
      twice.push_back(columns[i]);
  }
  note_odd_names(unnamed, twice, layout, records);
}

/// A note of the title lines above the header row.
std::string excluded_above(std::uint64_t first, std::uint64_t header, const std::string& row) {
  const bool one = header == first + 1;
  return (one ? "line " : "lines ") + std::to_string(first) +
         (one ? "" : " to " + std::to_string(header - 1)) + ", above the header row, " +
         (one ? "was" : "were") + " left out: " + core::quoted(row) + (one ? "." : ", ...");
}

void refuse_map_of_another_rig(const ColumnMap& map, const MachineType& rig) {
  if (!map.rig.empty() && map.rig != rig.name)
    throw core::DataError(map.path + ": machine_type is " + core::quoted(map.rig) + "; expected " +
                          std::string(rig.name) + ", as the model or --machine says");
  for (const auto& [ours, mapped] : map.columns) {
    if (rig.column(ours) != nullptr) continue;
    std::vector<std::string_view> known;
    for (const ColumnInfo& c : rig.columns) known.push_back(c.name);
    for (const ColumnPattern& p : rig.patterns) known.push_back(p.info.name);
    throw core::DataError(map.path + ":" + std::to_string(mapped.line) + ": machine type " +
                          std::string(rig.name) + " has no column " + core::quoted(ours) +
                          "; expected one of " + core::listed(known) + core::did_you_mean(ours, known));
  }
}

}  // namespace

Layout read_layout(RecordStream& records, const MachineType& rig, const ColumnMap* map) {
  if (map != nullptr) refuse_map_of_another_rig(*map, rig);
  Layout layout;
  if (map != nullptr) layout.decimal = map->decimal;
  const Wanted wanted(rig, map);
  Top top = read_top(records, &wanted, layout.header);
  const std::string path = core::printable(records.name()) + ": ";
  const std::optional<char> in_map = map == nullptr ? std::nullopt : map->separator;
  if (in_map && top.separator && in_map != top.separator)
    layout.notes.push_back(path + "its first line says that " + name_of(*top.separator) +
                           " separates the columns, " + map->path + " says " + name_of(*in_map) +
                           ": the map was followed.");
  const std::optional<char> said = in_map ? in_map : top.separator;
  layout.separator = said ? *said : separator_in(top.row, wanted.asked());

  std::vector<std::string> names = fields_of(top.row, layout.separator);
  layout.header.line = records.line();
  if (const Top::Comment* comment = header_comment(top, names, layout.separator, wanted);
      comment != nullptr && top.flaw.empty()) {
    names = fields_of(comment->text, layout.separator);
    layout.header.line = comment->line;
    layout.notes.push_back(path + "the comment in line " + std::to_string(comment->line) +
                           " was taken as the header row.");
    records.unread();
  } else if (!top.flaw.empty() || !wanted.all_among(names)) {
    const std::uint64_t first = records.line();
    if (const auto found = find_header(records, wanted, said, top, layout.header)) {
      layout.separator = found->separator;
      names = fields_of(found->row, found->separator);
      layout.header.line = found->line;
      layout.notes.push_back(path + excluded_above(first, found->line, top.row));
    } else if (!top.flaw.empty()) {
      throw core::DataError(top.flaw);
    } else if (all_numbers(names) || (is_any_number(names.front()) && wanted.found_among(names) == 0)) {
      refuse_no_header(top, {first, top.row, layout.separator}, wanted, records);
    }
  }
  // Of another file than a log anything may begin so.
  if (!top.not_utf8.empty() && wanted.found_among(names) == 0) throw core::DataError(top.not_utf8);
  if (!top.not_utf8.empty())
    layout.notes.push_back(path + "bytes above the rows that are not UTF-8 were read as Latin-1.");
  const std::vector<std::vector<std::string>> rows = first_rows(records, layout.separator);
  strip_sign(names, rows, wanted, layout, records);
  fit_to_rows(names, rows, layout, records);
  for (const std::string& name : names)
    layout.file_columns.emplace_back(trimmed(name));  // quotes may hold blanks
  if (map == nullptr || map->columns.empty()) refuse_wrong_units(layout, rig, records);
  add_channels(layout, rig, map, records);

  const auto& ours = layout.header.columns;
  for (const ColumnInfo& column : rig.columns)
    if (column.required && std::find(ours.begin(), ours.end(), column.name) == ours.end())
      missing(std::string(column.name), {}, layout, rig, map, records);
  layout.time_channel =
      static_cast<std::size_t>(std::find(ours.begin(), ours.end(), "time_s") - ours.begin());
  if (const auto& sources = layout.channels[layout.time_channel].sources; sources.size() == 1)
    if (const std::string line =
            line_that_adds(layout.file_columns, layout.file_columns[sources.front().column]);
        !line.empty())
      layout.time_hint = " (seconds and their fraction stand in two columns: in " +
                         (map != nullptr ? map->path : "a --map file") + " the line " + line + " adds them)";
  refuse_decimal_commas(rows, layout, map, records);
  if (units_row(rows, layout.file_columns.size())) {
    refuse_units_row(rows.front(), layout, map, records);
    std::string_view record;
    do records.next(record);
    while (trimmed(record).empty() || is_comment(trimmed(record)));
    layout.notes.push_back(path + "line " + std::to_string(records.line()) + ", " + core::quoted(record) +
                           ", holds units and was left out.");
  }
  return layout;
}

std::string read_rig_line(RecordStream& records) {
  LogHeader header;
  Top top = read_top(records, nullptr, header);
  // The line may stand below titles.
  constexpr int kTitles = 1000;
  std::string_view record = top.row;
  for (int i = 0; i < kTitles && !header.metadata.contains("machine_type"); ++i) {
    if (is_comment(trimmed(record))) take_comment(trimmed(record), records, nullptr, top, header);
    if (is_any_number(fields_of(record, separator_in(record, {})).front()) || !records.next(record)) break;
    records.first_line_alone(record);
  }
  if (const auto found = header.metadata.find("machine_type"); found != header.metadata.end())
    return found->second;
  for (const std::string& message : {top.other_text, top.flaw})
    if (!message.empty()) throw core::DataError(message);
  return {};
}

}  // namespace furcula::log
