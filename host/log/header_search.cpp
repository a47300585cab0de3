// Header rows below title lines, see header_search.hpp.
#include "host/log/header_search.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace furcula::log {
namespace {

constexpr std::size_t kAhead = std::size_t{1} << 16;  // bytes

struct Line {
  std::string text;  ///< without the sign of a comment
  std::uint64_t line;
  bool comment;
};

/// The first record, and what stands below it in the next 64 KiB.
std::vector<Line> lines_ahead(RecordStream& records, const std::string& first) {
  std::vector<Line> lines{{first, records.line(), false}};
  // A quote in a title ("rail: 40\" long") may have taken the header row along.
  std::string_view alone;
  if (records.first_line_alone(alone)) lines.front().text = std::string(alone);
  const std::uint64_t before = records.next_line() - 1;
  const std::string_view text = records.ahead(kAhead);
  core::TextSource source(text);
  RecordStream ahead(source, records.name());
  std::string_view record;
  while (ahead.next(record)) {
    if (ahead.fault() != nullptr || (!ahead.ended() && text.size() >= kAhead)) continue;
    ahead.first_line_alone(record);  // names do not hold line ends
    const std::string_view content = trimmed(record);
    if (content.empty()) continue;
    const bool comment = is_comment(content);
    lines.push_back({std::string(comment ? comment_text(content) : record), ahead.line() + before, comment});
  }
  return lines;
}

/// The first row below the first record that has all columns that are asked for.
const Line* named_row(const std::vector<Line>& lines, const Wanted& wanted, std::optional<char> separator,
                      char& its_separator) {
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].text.find(wanted.asked().front()) == std::string::npos) continue;
    its_separator = separator ? *separator : separator_in(lines[i].text, wanted.asked());
    const Fields fields = fields_of(lines[i].text, its_separator);
    if (fields.size() < 2 || !wanted.all_among(fields)) continue;
    // One name or a comment may stand in a sentence: the next row must fit to it.
    if (wanted.asked().size() == 1 || lines[i].comment) {
      std::size_t next = i + 1;
      while (next < lines.size() && lines[next].comment) ++next;
      if (next == lines.size()) continue;
      const std::size_t columns = fields_of(lines[next].text, its_separator).size();
      if (columns + 1 < fields.size() || columns > fields.size() + 1) continue;
    }
    return &lines[i];
  }
  return nullptr;
}

/// What separates the columns of most of the later rows, and how many they have; 0: nothing does.
std::size_t columns_of(const std::vector<Line>& lines, char& separator) {
  const std::vector<char> tried =
      separator != '\0' ? std::vector<char>{separator} : std::vector<char>{';', '\t', '|', ',', ' '};
  const std::size_t from = lines.size() / 2;
  for (const char sign : tried) {
    std::map<std::size_t, std::size_t> rows_with;
    for (std::size_t i = from; i < lines.size(); ++i) ++rows_with[fields_of(lines[i].text, sign).size()];
    for (const auto& [columns, rows] : rows_with)
      if (columns > 1 && 2 * rows > lines.size() - from) {
        separator = sign;
        return columns;
      }
  }
  return 0;
}

/// The names above the first two rows of numbers. @throws core::DataError: there are none.
const Line* row_above_numbers(const std::vector<Line>& lines, const Wanted& wanted,
                              std::optional<char> separator, const Top& top, const RecordStream& records,
                              char& its_separator) {
  its_separator = separator.value_or('\0');
  const std::size_t columns = columns_of(lines, its_separator);
  if (columns == 0) return nullptr;
  const auto fields = [&](std::size_t i) { return fields_of(lines[i].text, its_separator); };
  const auto numbers = [&](std::size_t i) {
    const Fields f = fields(i);
    return !lines[i].comment && f.size() == columns && std::any_of(f.begin(), f.end(), is_any_number);
  };
  // A field at the end may lack its name.
  const auto names = [&](std::size_t i) {
    Fields f = fields(i);
    if (f.size() > 1 && f.back().empty()) f.pop_back();
    const bool fits = f.size() == columns || (f.size() > 1 && f.size() + 1 == columns);
    return fits && std::none_of(f.begin(), f.end(),
                                [](const std::string& s) { return s.empty() || is_any_number(s); });
  };
  std::size_t row = 0;
  while (row < lines.size() && !(numbers(row) && (row + 1 == lines.size() || numbers(row + 1)))) ++row;
  if (row == 0 || row == lines.size()) return nullptr;
  std::size_t top_row = row;
  while (top_row > 0 && names(top_row - 1)) --top_row;
  if (top_row == 0) return nullptr;
  if (top_row == row) {
    // Names beside which the rows do not fit are still names.
    if (row > 1 || fields(0).size() == 1)
      refuse_no_header(top, {lines[row].line, lines[row].text, its_separator}, wanted, records);
    return nullptr;
  }
  return &lines[top_row];
}

}  // namespace

std::optional<FoundHeader> find_header(RecordStream& records, const Wanted& wanted,
                                       std::optional<char> separator, Top& top, LogHeader& header) {
  const std::vector<Line> lines = lines_ahead(records, top.row);
  FoundHeader found;
  const Line* row = named_row(lines, wanted, separator, found.separator);
  if (row == nullptr && !top.other_text.empty()) throw core::DataError(top.other_text);
  if (row == nullptr && top.flaw.empty() &&
      wanted.found_among(
          fields_of(top.row, separator ? *separator : separator_in(top.row, wanted.asked()))) == 0)
    row = row_above_numbers(lines, wanted, separator, top, records, found.separator);
  if (row == nullptr) return std::nullopt;
  found.row = row->text;
  found.line = row->line;
  std::string_view record;
  while (records.next(record) && records.line() < found.line) {
    records.first_line_alone(record);
    const std::string_view content = trimmed(record);
    if (is_comment(content)) take_comment(content, records, &wanted, top, header);
  }
  if (records.line() != found.line) return std::nullopt;
  records.first_line_alone(record);
  return found;
}

}  // namespace furcula::log
