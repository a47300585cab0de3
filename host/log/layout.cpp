// A log's metadata and header row, see layout.hpp.
#include "host/log/layout.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "host/core/message.hpp"
#include "host/log/number.hpp"
#include "host/log/time_columns.hpp"

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

/// Bytes that are no UTF-8 are taken as Latin-1, in which each byte is the code point of its number.
std::string from_latin1(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (byte >> 6));
      out += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return out;
}

/// Above the rows: Excel's line "sep=;", comments, and the first record that is neither blank nor a comment.
struct Top {
  struct Comment {
    std::string text;  ///< behind the '#'
    std::uint64_t line;
  };
  std::optional<char> separator;  ///< that "sep=" names
  std::vector<Comment> comments;  ///< the last few
  std::string row;                ///< the first record
  std::string not_utf8;           ///< what was not, as a message; empty: all was UTF-8
};

/// Excel's first line "sep=;".
std::optional<char> separator_line(std::string_view record) {
  if (record.size() > 2 && record.front() == '"' && record.back() == '"')
    record = record.substr(1, record.size() - 2);
  if (record.size() != 5 || std::tolower(static_cast<unsigned char>(record[0])) != 's' ||
      std::tolower(static_cast<unsigned char>(record[1])) != 'e' ||
      std::tolower(static_cast<unsigned char>(record[2])) != 'p' || record[3] != '=')
    return std::nullopt;
  const char sign = record[4];
  constexpr std::string_view kOfNumbers = "+-.\"";
  if (std::isalnum(static_cast<unsigned char>(sign)) != 0 || kOfNumbers.find(sign) != kOfNumbers.npos)
    return std::nullopt;
  return sign;
}

// The comments go into the header. `rig` is what the log must be of; none: any.
Top read_top(RecordStream& records, const RigInfo* rig, LogHeader& header) {
  constexpr std::size_t kComments = 8;
  Top top;
  std::string_view record;
  std::size_t metadata_bytes = 0;
  bool anything = false;
  while (records.next(record)) {
    if (records.fault() != nullptr) throw core::DataError(at(records) + records.fault());
    if (records.open_quote() && !record.starts_with('#'))
      throw core::DataError(at(records) +
                            "a quote is not closed; expected a header row of a CSV log, with a closing '\"'");
    if (!anything) top.separator = separator_line(record);
    if (!anything && top.separator) {
      anything = true;
      continue;
    }
    anything = true;
    if (record.find('\0') != std::string_view::npos)
      throw core::DataError(at(records) + "a NUL byte; expected the text of a CSV log");
    std::string text(record);
    if (const std::size_t bad = first_not_utf8(record); bad != std::string_view::npos) {
      if (top.not_utf8.empty())
        top.not_utf8 = at(records) + "byte " + std::to_string(bad + 1) + " of the line, " +
                       core::quoted(record.substr(bad, 1)) + ", is not UTF-8; expected UTF-8 text";
      text = from_latin1(record);
    }
    const std::string_view content = trimmed(text);
    if (content.empty()) continue;
    if (content.front() != '#') {
      top.row = std::move(text);
      return top;
    }
    metadata_bytes += text.size();
    if (metadata_bytes > kMostMetadata)
      throw core::DataError(at(records) + "more than 1 MiB of '#' lines; expected a header row");
    take_metadata(content, records, rig, header);
    if (top.comments.size() == kComments) top.comments.erase(top.comments.begin());
    top.comments.push_back({std::string(trimmed(content.substr(1))), records.line()});
  }
  throw core::DataError(records.name() +
                        ":1: " + (anything ? "there is no header row" : "the file is empty") +
                        "; expected a CSV log with a header row");
}

bool is_number(std::string field, char decimal = '.') {
  if (decimal != '.') std::replace(field.begin(), field.end(), decimal, '.');
  double value = 0.0;
  return parse_number(field, value);
}

bool any_number(const std::vector<std::string>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const std::string& f) { return is_number(f) || is_number(f, ','); });
}

/// A row of numbers, empty fields among them.
bool all_numbers(const std::vector<std::string>& fields) {
  return any_number(fields) && std::all_of(fields.begin(), fields.end(), [](const std::string& f) {
           return f.empty() || is_number(f) || is_number(f, ',');
         });
}

/// The names that the file must have, as it calls them; those of time first.
std::vector<std::string> names_asked_for(const RigInfo& rig, const ColumnMap* map) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& ours) {
    if (map != nullptr)
      if (const auto mapped = map->columns.find(ours); mapped != map->columns.end()) {
        for (const MappedPart& p : mapped->second.parts) names.push_back(p.column);
        return;
      }
    names.push_back(ours);
  };
  for (const ColumnInfo& c : rig.columns)
    if (c.required) add(std::string(c.name));
  return names;
}

std::size_t found_among(const std::vector<std::string>& fields, const std::vector<std::string>& asked) {
  return static_cast<std::size_t>(std::count_if(asked.begin(), asked.end(), [&](const std::string& name) {
    return std::find(fields.begin(), fields.end(), name) != fields.end();
  }));
}

/// What stands between the columns: with which most of the names that are asked for are there, else what cuts the row most often; a comma
/// where none does. Blanks stand within names and beside other separators: only where there is none of those.
char separator_in(std::string_view row, const std::vector<std::string>& asked) {
  char best = ',';
  std::size_t best_found = 0, best_fields = 1;
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    if (separator == ' ' && best_fields > 1) break;
    const std::vector<std::string> fields = fields_of(row, separator);
    const std::size_t found = found_among(fields, asked);
    if (found < best_found || (found == best_found && fields.size() <= best_fields)) continue;
    best = separator;
    best_found = found;
    best_fields = fields.size();
  }
  return best;
}

/// The first few rows, in fields, without those that a buffer's end may cut.
std::vector<std::vector<std::string>> first_rows(RecordStream& records, char separator) {
  constexpr std::size_t kRows = 20, kBytes = std::size_t{1} << 16;
  const std::string_view text = records.ahead(kBytes);
  core::TextSource source(text);
  RecordStream ahead(source, records.name());
  std::vector<std::vector<std::string>> rows;
  std::string_view record;
  while (rows.size() < kRows && ahead.next(record))
    if (!trimmed(record).empty() && !trimmed(record).starts_with('#') &&
        (ahead.ended() || text.size() < kBytes))
      rows.push_back(fields_of(record, separator));
  return rows;
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string name_of(char separator) {
  return separator == '\t' ? "a tab" : separator == ' ' ? "blanks" : "'" + std::string(1, separator) + "'";
}

/// The comment above the rows that holds the names of their columns, or null.
const Top::Comment* header_comment(const Top& top, const std::vector<std::string>& row, char separator,
                                   const std::vector<std::string>& asked) {
  const auto named = [&](const Top::Comment& c) {
    const std::vector<std::string> fields = fields_of(c.text, separator);
    return fields.size() == row.size() && !any_number(fields) ? found_among(fields, asked) : 0;
  };
  const Top::Comment* best = nullptr;
  for (const Top::Comment& c : top.comments)
    if (named(c) > (best == nullptr ? 0 : named(*best))) best = &c;
  if (best != nullptr && found_among(row, asked) == 0) return best;
  if (!all_numbers(row) || top.comments.empty()) return nullptr;
  const std::vector<std::string> last = fields_of(top.comments.back().text, separator);
  return last.size() == row.size() && last.size() > 1 && !any_number(last) ? &top.comments.back() : nullptr;
}

[[noreturn]] void refuse_no_header(const Top& top, const std::vector<std::string>& row, char separator,
                                   const std::vector<std::string>& asked, const RecordStream& records) {
  std::string message = at(records) + "there is no header row: the first row holds numbers, " +
                        core::quoted(top.row) + "; expected a line above it that names the " +
                        counted(row.size(), "column", "columns") + ", as in ";
  const std::string between(1, separator);
  std::string names;
  for (const std::string& name : asked) names += (names.empty() ? "" : between) + name;
  if (asked.size() < row.size()) names += between + "...";
  message += core::quoted(names);
  if (!top.comments.empty()) {
    const std::size_t fields = fields_of(top.comments.back().text, separator).size();
    message += "; the last comment above, " + core::quoted("# " + top.comments.back().text) + ", has " +
               counted(fields, "field", "fields");
  }
  throw core::DataError(message);
}

/// Ends of rows: a separator that stands behind the last field in the header row and not in the rows, or the other way round; an index in
/// front of the rows alone (R's write.table).
void fit_to_rows(std::vector<std::string>& names, const std::vector<std::vector<std::string>>& rows,
                 Layout& layout, const RecordStream& records) {
  const auto most = [&](const auto& is) {
    return 2 * static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), is)) > rows.size();
  };
  const std::size_t n = names.size();
  const std::string path = core::printable(records.name()) + ": ";
  using Row = std::vector<std::string>;
  if (n > 1 && names.back().empty() && most([&](const Row& r) { return r.size() == n - 1; })) {
    names.pop_back();
    layout.notes.push_back(path + "the header row ends in a separator, the rows do not: it was left out.");
    return;
  }
  if (most([&](const Row& r) { return r.size() == n + 1 && r.back().empty(); })) {
    names.emplace_back();
    return;
  }
  std::size_t in_order = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    double before = 0.0, now = 0.0;
    if (rows[i].size() == n + 1 && rows[i - 1].size() == n + 1 && parse_number(rows[i - 1].front(), before) &&
        parse_number(rows[i].front(), now) && now == before + 1.0)
      ++in_order;
  }
  if (rows.size() > 2 && in_order + 1 == rows.size()) {
    names.insert(names.begin(), std::string{});
    return;
  }
  const std::size_t other = rows.empty() ? n : rows[rows.size() / 2].size();
  if (other == n || !most([&](const Row& r) { return r.size() == other; })) return;
  layout.rows_hint = " (most rows have " + counted(other, "field", "fields") + ", the header row " +
                     std::to_string(n) +
                     (other >= 2 * n - 1 && layout.separator == ','
                          ? ": are the decimals behind commas, too? Write '.', or other separators"
                          : "") +
                     ")";
}

/// A row of units below the header row ("s,rad,Nm") is left out; a unit that is not ours is refused.
bool units_row(const std::vector<std::vector<std::string>>& rows, std::size_t columns) {
  if (rows.empty() || rows.front().size() != columns) return false;
  bool letters = false;
  for (const std::string& field : rows.front()) {
    if (is_number(field) || is_number(field, ',')) return false;
    letters = letters || std::any_of(field.begin(), field.end(),
                                     [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
  }
  return letters && (rows.size() == 1 || any_number(rows[1]));
}

/// Numbers such as 0,001 where a point is expected.
void refuse_decimal_commas(const std::vector<std::vector<std::string>>& rows, const Layout& layout,
                           const ColumnMap* map, const RecordStream& records) {
  if (layout.decimal != '.' || layout.separator == ',') return;
  const std::string* example = nullptr;
  std::size_t with = 0;
  for (const auto& row : rows) {
    const std::string* found = nullptr;
    for (std::size_t i = 0; i < std::min(row.size(), layout.needed.size()); ++i)
      if (layout.needed[i] && !is_number(row[i]) && is_number(row[i], ',')) found = &row[i];
    if (found == nullptr) continue;
    ++with;
    if (example == nullptr) example = found;
  }
  if (2 * with <= rows.size() || example == nullptr) return;
  const std::string separator = layout.separator == '\t' ? "\\t" : std::string(1, layout.separator);
  throw core::DataError(at(records) + "the numbers below this header row have a decimal comma, " +
                        core::quoted(*example) + "; expected '.', or " +
                        (map != nullptr ? "in " + map->path + " the line decimal = \",\""
                                        : "a --map file with the two lines separator = \"" + separator +
                                              "\" and decimal = \",\""));
}

/// Other units of ours, and what makes ours of them.
struct OtherUnit {
  std::string_view unit, ours;
  const char* scale;
};
constexpr OtherUnit kOtherUnits[]{{"ms", "s", "1e-3"},
                                  {"us", "s", "1e-6"},
                                  {"ns", "s", "1e-9"},
                                  {"min", "s", "60"},
                                  {"mm", "m", "1e-3"},
                                  {"cm", "m", "1e-2"},
                                  {"um", "m", "1e-6"},
                                  {"km", "m", "1e3"},
                                  {"deg", "rad", "0.0174532925199433"},
                                  {"degrees", "rad", "0.0174532925199433"},
                                  {"mrad", "rad", "1e-3"},
                                  {"turns", "rad", "6.28318530717959"},
                                  {"rev", "rad", "6.28318530717959"},
                                  {"mmps", "mps", "1e-3"},
                                  {"cmps", "mps", "1e-2"},
                                  {"degps", "radps", "0.0174532925199433"},
                                  {"rpm", "radps", "0.104719755119660"},
                                  {"rps", "radps", "6.28318530717959"},
                                  {"mnm", "nm", "1e-3"},
                                  {"nmm", "nm", "1e-3"},
                                  {"ncm", "nm", "1e-2"},
                                  {"knm", "nm", "1e3"},
                                  {"kn", "n", "1e3"},
                                  {"mn", "n", "1e-3"},
                                  {"kgf", "n", "9.80665"},
                                  {"gf", "n", "9.80665e-3"},
                                  {"mv", "v", "1e-3"},
                                  {"ma", "a", "1e-3"}};

const OtherUnit* other_unit(std::string_view unit, std::string_view ours) {
  for (const OtherUnit& u : kOtherUnits)
    if (u.unit == unit && u.ours == ours) return &u;
  return nullptr;
}

[[noreturn]] void refuse_unit(const std::string& name, std::string_view unit, const std::string& ours,
                              const RecordStream& records) {
  const OtherUnit* known = other_unit(unit, parts(ours).unit);
  throw core::DataError(
      at(records) + "column " + core::quoted(name) + " has the unit '" + std::string(unit) + "'; expected '" +
      core::printable(ours) + "' (convert it, or give a --map file with " +
      (known == nullptr ? "a scale"
                        : "the line " + core::printable(ours) + " = { column = \"" + core::printable(name) +
                              "\", scale = " + known->scale + " }") +
      ")");
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
        refuse_unit(name, theirs.unit, std::string(ours.name), records);
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
      refuse_unit(name, theirs.unit, std::string(quantity) + "_" + std::string(meant), records);
  }
}

/// A row of units that says another unit than a column's name, where no scale makes ours of it.
void refuse_units_row(const std::vector<std::string>& units, const Layout& layout, const ColumnMap* map,
                      const RecordStream& records) {
  for (const Channel& c : layout.channels) {
    if (!c.known || c.sources.size() != 1 || c.sources.front().scale != 1.0) continue;
    std::string unit;
    for (const char sign : units[c.sources.front().column])
      if (std::isalnum(static_cast<unsigned char>(sign)) != 0)
        unit += static_cast<char>(std::tolower(static_cast<unsigned char>(sign)));
    const OtherUnit* other = other_unit(unit, parts(c.name).unit);
    if (other == nullptr) continue;
    const std::string& theirs = layout.file_columns[c.sources.front().column];
    throw core::DataError(at(records) + "the row of units below the header row says '" + unit +
                          "' of column " + core::quoted(theirs) + "; expected '" + std::string(other->ours) +
                          "' (in " + (map != nullptr ? map->path : "a --map file") + " the line " +
                          core::printable(c.name) + " = { column = \"" + core::printable(theirs) +
                          "\", scale = " + other->scale + " })");
  }
}

[[noreturn]] void missing(const std::string& name, const std::string& mapped_to, const Layout& layout,
                          const RigInfo& rig, const ColumnMap* map, const RecordStream& records) {
  const std::vector<std::string_view> all(layout.file_columns.begin(), layout.file_columns.end());
  std::vector<std::string_view> names;
  for (const std::string_view n : all)
    if (!n.empty()) names.push_back(n);
  std::string message = at(records) + "no column " + core::quoted(name) + ", which ";
  if (mapped_to.empty())
    message += "a log of rig " + std::string(rig.name) + " must have";
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
  message += "; the file has " + core::listed(std::span(names).first(std::min(names.size(), kMostListed))) +
             (names.size() > kMostListed ? ", ..." : "");
  const std::string hint = core::did_you_mean(name, names);
  const std::string adds =
      name == "time_s" || mapped_to == "time_s" ? line_that_adds(layout.file_columns) : "";
  throw core::DataError(message + hint +
                        (adds.empty()
                             ? " (a --map file says which column is which: " +
                                   core::printable(mapped_to.empty() ? name : mapped_to) +
                                   " = { column = \"theirs\" })"
                             : " (seconds and their fraction: a --map file with the line " + adds + ")"));
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
void add_channels(Layout& layout, const RigInfo& rig, const ColumnMap* map, const RecordStream& records) {
  const std::vector<std::string>& columns = layout.file_columns;
  layout.needed.assign(columns.size(), false);
  const auto add = [&](const std::string& name, std::vector<Source> sources, const MappedColumn* mapped) {
    const ColumnInfo* info = rig.column(name);
    if (info != nullptr)
      for (const Source& s : sources) {
        const std::string& theirs = columns[s.column];
        if (std::count(columns.begin(), columns.end(), theirs) > 1)
          throw core::DataError(at(records) + "column " + core::quoted(theirs) +
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

void refuse_map_of_another_rig(const ColumnMap& map, const RigInfo& rig) {
  if (!map.rig.empty() && map.rig != rig.name)
    throw core::DataError(map.path + ": rig is " + core::quoted(map.rig) + "; expected " +
                          std::string(rig.name) + ", as the model or --rig says");
  for (const auto& [ours, mapped] : map.columns) {
    if (rig.column(ours) != nullptr) continue;
    std::vector<std::string_view> known;
    for (const ColumnInfo& c : rig.columns) known.push_back(c.name);
    for (const ColumnPattern& p : rig.patterns) known.push_back(p.info.name);
    throw core::DataError(map.path + ":" + std::to_string(mapped.line) + ": rig " + std::string(rig.name) +
                          " has no column " + core::quoted(ours) + "; expected one of " +
                          core::listed(known) + core::did_you_mean(ours, known));
  }
}

}  // namespace

Layout read_layout(RecordStream& records, const RigInfo& rig, const ColumnMap* map) {
  if (map != nullptr) refuse_map_of_another_rig(*map, rig);
  Layout layout;
  if (map != nullptr) layout.decimal = map->decimal;
  Top top = read_top(records, &rig, layout.header);
  const std::string path = core::printable(records.name()) + ": ";
  const std::vector<std::string> asked = names_asked_for(rig, map);
  const std::optional<char> in_map = map == nullptr ? std::nullopt : map->separator;
  if (in_map && top.separator && in_map != top.separator)
    layout.notes.push_back(path + "its first line says that " + name_of(*top.separator) +
                           " separates the columns, " + map->path + " says " + name_of(*in_map) +
                           ": the map was followed.");
  layout.separator = in_map ? *in_map : top.separator ? *top.separator : separator_in(top.row, asked);

  std::vector<std::string> names = fields_of(top.row, layout.separator);
  layout.header.line = records.line();
  if (const Top::Comment* comment = header_comment(top, names, layout.separator, asked); comment != nullptr) {
    names = fields_of(comment->text, layout.separator);
    layout.header.line = comment->line;
    layout.notes.push_back(path + "the comment in line " + std::to_string(comment->line) +
                           " was taken as the header row.");
    records.unread();
  } else if (all_numbers(names)) {
    refuse_no_header(top, names, layout.separator, asked, records);
  }
  // Of another file than a log anything may begin so.
  if (!top.not_utf8.empty() && found_among(names, asked) == 0) throw core::DataError(top.not_utf8);
  if (!top.not_utf8.empty())
    layout.notes.push_back(path + "bytes above the rows that are not UTF-8 were read as Latin-1.");
  const std::vector<std::vector<std::string>> rows = first_rows(records, layout.separator);
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
    while (trimmed(record).empty() || trimmed(record).starts_with('#'));
    layout.notes.push_back(path + "line " + std::to_string(records.line()) + ", " + core::quoted(record) +
                           ", holds units and was left out.");
  }
  return layout;
}

std::string read_rig_line(RecordStream& records) {
  LogHeader header;
  read_top(records, nullptr, header);
  const auto found = header.metadata.find("rig");
  return found == header.metadata.end() ? std::string{} : found->second;
}

}  // namespace furcula::log
