// Header rows, see header_row.hpp.
#include "host/log/header_row.hpp"

#include <algorithm>
#include <cctype>

#include "host/core/message.hpp"
#include "host/log/number.hpp"

namespace furcula::log {
namespace {

bool is_number(std::string field, char decimal = '.') {
  if (decimal != '.') std::replace(field.begin(), field.end(), decimal, '.');
  double value = 0.0;
  return parse_number(field, value);
}

bool any_number(const std::vector<std::string>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const std::string& f) { return is_number(f) || is_number(f, ','); });
}

}  // namespace

bool all_numbers(const std::vector<std::string>& fields) {
  return any_number(fields) && std::all_of(fields.begin(), fields.end(), [](const std::string& f) {
           return f.empty() || is_number(f) || is_number(f, ',');
         });
}

bool is_any_number(const std::string& field) { return is_number(field) || is_number(field, ','); }

char separator_in(std::string_view row, const std::vector<std::string>& asked) {
  const auto found_in = [&](const Fields& fields) {
    return static_cast<std::size_t>(std::count_if(asked.begin(), asked.end(), [&](const std::string& name) {
      return std::find(fields.begin(), fields.end(), name) != fields.end();
    }));
  };
  char best = ',';
  std::size_t best_found = 0, best_fields = 1;
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    const std::vector<std::string> fields = fields_of(row, separator);
    const std::size_t found = found_in(fields);
    const bool more_fields = fields.size() > best_fields && (separator != ' ' || best_fields == 1);
    if (found < best_found || (found == best_found && !more_fields)) continue;
    best = separator;
    best_found = found;
    best_fields = fields.size();
  }
  return best;
}

std::vector<std::vector<std::string>> first_rows(RecordStream& records, char separator) {
  constexpr std::size_t kRows = 20, kBytes = std::size_t{1} << 16;
  const std::string_view text = records.ahead(kBytes);
  core::TextSource source(text);
  RecordStream ahead(source, records.name());
  std::vector<std::vector<std::string>> rows;
  std::string_view record;
  while (rows.size() < kRows && ahead.next(record))
    if (!trimmed(record).empty() && !is_comment(trimmed(record)) && (ahead.ended() || text.size() < kBytes))
      rows.push_back(fields_of(record, separator));
  return rows;
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string name_of(char separator) {
  return separator == '\t' ? "a tab" : separator == ' ' ? "blanks" : "'" + std::string(1, separator) + "'";
}

const Top::Comment* header_comment(const Top& top, const Fields& row, char separator, const Wanted& wanted) {
  const auto named = [&](const Top::Comment& c) -> std::size_t {
    const Fields fields = fields_of(c.text, separator);
    if (any_number(fields)) return 0;
    // A separator at the end of the rows, or an index in front of them.
    const bool fits =
        fields.size() == row.size() || (fields.size() + 1 == row.size() && wanted.all_among(fields));
    return fits ? wanted.found_among(fields) : 0;
  };
  const Top::Comment* best = nullptr;
  for (const Top::Comment& c : top.comments)
    if (named(c) > (best == nullptr ? 0 : named(*best))) best = &c;
  if (best != nullptr && wanted.found_among(row) == 0) return best;
  if (!all_numbers(row) || top.comments.empty()) return nullptr;
  const Fields last = fields_of(top.comments.back().text, separator);
  return last.size() == row.size() && last.size() > 1 && !any_number(last) ? &top.comments.back() : nullptr;
}

[[noreturn]] void refuse_no_header(const Top& top, const Headless& first, const Wanted& wanted,
                                   const RecordStream& records) {
  const std::size_t columns = fields_of(first.row, first.separator).size();
  const bool titles = first.row != top.row;
  std::string message = records.name() + ":" + std::to_string(first.line) +
                        ": there is no header row: the first row holds numbers, " + core::quoted(first.row) +
                        (titles ? ", below " + core::quoted(top.row) : "") +
                        "; expected a line above it that names the " + counted(columns, "column", "columns") +
                        ", as in ";
  const std::string between(1, first.separator);
  std::string names;
  for (const std::string& name : wanted.asked()) names += (names.empty() ? "" : between) + name;
  if (wanted.asked().size() < columns) names += between + "...";
  message += core::quoted(names);
  if (!top.comments.empty()) {
    const std::size_t fields = fields_of(top.comments.back().text, first.separator).size();
    message += "; the last comment above, " + core::quoted("# " + top.comments.back().text) + ", has " +
               counted(fields, "field", "fields");
  }
  throw core::DataError(message);
}

void strip_sign(Fields& names, const std::vector<Fields>& rows, const Wanted& wanted, Layout& layout,
                const RecordStream& records) {
  constexpr std::string_view kSigns = "#%/!;*'\"-$&@ \t";
  std::string& first = names.front();
  const std::size_t sign = std::min(first.find_first_not_of(kSigns), first.size());
  if (sign == 0 || wanted.uses(first)) return;
  const std::string found = first;
  if (sign < first.size() && wanted.uses(first.substr(sign)))
    first.erase(0, sign);
  else if (sign == first.size() && !first.empty() && names.size() > 1 && wanted.uses(names[1]) &&
           !rows.empty() && rows[rows.size() / 2].size() + 1 == names.size())
    names.erase(names.begin());
  else
    return;
  layout.notes.push_back(core::printable(records.name()) + ": the header row begins with " +
                         core::quoted(found) + ", which was read as " + core::quoted(names.front()) + ".");
}

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
  throw core::DataError(place(records) + "the numbers below this header row have a decimal comma, " +
                        core::quoted(*example) + "; expected '.', or " +
                        (map != nullptr ? "in " + map->path + " the line decimal = \",\""
                                        : "a --map file with the two lines separator = \"" + separator +
                                              "\" and decimal = \",\""));
}

}  // namespace furcula::log
