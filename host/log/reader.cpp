// Reading logs, see reader.hpp.
#include "host/log/reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "host/core/byte_source.hpp"
#include "host/core/message.hpp"
#include "host/log/interval_median.hpp"
#include "host/log/layout.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/rigs.hpp"

namespace furcula::log {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// A whole field as a double, "inf" and "nan" included; false if it is no number.
bool parse_number(const std::string& field, double& value) {
  const char* begin = field.data();
  const char* const end = begin + field.size();
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (stopped != end || begin == end) return false;
  if (error == std::errc::result_out_of_range) value = std::strtod(begin, nullptr);  // 0 or infinity
  return true;
}

/// A row that is not as the others: what is wrong with it beside the message.
struct BadRow : core::DataError {
  BadRow(const std::string& message, std::string its_column, std::string its_text, std::string its_why)
      : core::DataError(message),
        column(std::move(its_column)),
        text(std::move(its_text)),
        why(std::move(its_why)) {}
  std::string column, text, why;
};

class RowReader {
 public:
  RowReader(RecordStream& records, const Layout& layout, BadRows bad)
      : records_(records),
        layout_(layout),
        hint_(bad == BadRows::refused ? " (--skip-bad-rows leaves such a row out)" : ""),
        ignored_(layout.file_columns.size(), false),
        raw_(layout.file_columns.size()),
        values_(layout.channels.size()) {}

  std::span<double> parse(std::string_view record) {
    fill_raw(record);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const Channel& channel = layout_.channels[i];
      if (channel.source == kConstant) {
        values_[i] = channel.offset;
        continue;
      }
      double value = raw_[channel.source];
      if (channel.mapped) value = value * channel.scale + channel.offset;
      if (channel.kind == ColumnKind::flag && value != 0.0 && value != 1.0)
        fail(channel.source,
             core::shortest(value) + (channel.mapped ? " after the map" : "") + "; expected 0 or 1");
      if (channel.mapped && !std::isfinite(value))
        fail(channel.source, "not finite after the map; expected a scale and offset that suit it");
      values_[i] = value;
    }
    return values_;
  }

  std::vector<std::string> ignored_columns() const {
    std::vector<std::string> names;
    for (const Channel& c : layout_.channels)
      if (c.source != kConstant && ignored_[c.source]) names.push_back(c.name);
    return names;
  }

  [[noreturn]] void fail(std::size_t file_column, const std::string& message) const {
    std::string who = "column " + core::quoted(layout_.file_columns[file_column]), ours;
    for (const Channel& c : layout_.channels)
      if (c.source == file_column && c.known && c.name != layout_.file_columns[file_column])
        who += " (mapped to '" + c.name + "')";
    for (const Channel& c : layout_.channels)
      if (c.source == file_column && (c.known || ours.empty())) ours = c.name;
    fail_row(who + ": " + message, ours, message);
  }

  [[noreturn]] void fail_row(const std::string& message, const std::string& column = {},
                             const std::string& why = {}) const {
    throw BadRow(records_.name() + ":" + std::to_string(records_.line()) + ": " + message + hint_, column, {},
                 why.empty() ? message : why);
  }

 private:
  void fill_raw(std::string_view record) {
    const char* at = record.data();
    const char* const end = at + record.size();
    const std::size_t columns = raw_.size();
    for (std::size_t i = 0; i < columns; ++i) {
      double value = 0.0;
      const auto [stopped, error] = std::from_chars(at, end, value);
      const bool last = i + 1 == columns;
      if (error == std::errc{} && std::isfinite(value) &&
          (last ? stopped == end : stopped != end && *stopped == layout_.separator)) {
        at = stopped + (last ? 0 : 1);
      } else {
        std::string_view rest(at, static_cast<std::size_t>(end - at));
        bool more = false;
        value = unusual_field(rest, i, more, record);
        at = end - rest.size();
      }
      raw_[i] = value;
    }
  }

  // Spaces, quotes, a plus sign, an extreme exponent; or no number at all.
  double unusual_field(std::string_view& rest, std::size_t i, bool& more, std::string_view record) {
    std::string field = take_field(rest, more, layout_.separator);
    if (more == (i + 1 == raw_.size())) wrong_field_count(record);
    if (layout_.decimal != '.') std::replace(field.begin(), field.end(), layout_.decimal, '.');
    double value = 0.0;
    const bool is_number = parse_number(field, value);
    if (is_number && std::isfinite(value)) return value;
    if (!layout_.needed[i]) {
      ignored_[i] = true;
      return kNoNumber;
    }
    const std::string expected = "; expected a finite decimal number";
    if (!records_.ended() && i + 1 == raw_.size())
      fail(i, core::quoted(field) + " is where the file ends: the last row is torn" + expected);
    if (is_number) fail(i, core::quoted(field) + " is not finite" + expected);
    if (field.empty()) fail(i, "no value ('')" + expected);
    fail(i, core::quoted(field) + " is not a number" + expected +
                (field.find(',') != field.npos ? " with '.' (or decimal = \",\" in a --map file)" : ""));
  }

  [[noreturn]] void wrong_field_count(std::string_view record) const {
    std::size_t fields = 0;
    std::string_view rest = record;
    for (bool more = true; more; ++fields) take_field(rest, more, layout_.separator);
    const std::string expected = "; expected " + std::to_string(raw_.size()) + " fields as in the header row";
    if (record.find('\0') != record.npos)
      fail_row("NUL bytes, " + core::quoted(record.substr(record.find('\0'), 1)) + expected);
    if (record.starts_with('#'))
      fail_row("a comment " + core::quoted(record) +
               " among the rows; expected comments before the header row only");
    const std::string has = std::to_string(fields) + (fields == 1 ? " field" : " fields");
    if (!records_.ended() && fields < raw_.size())
      fail_row("the file ends in the middle of a row: the last row is torn, it has " + has + ", " +
               core::quoted(record) + expected);
    fail_row("the row has " + has + ", " + core::quoted(record) + expected);
  }

  RecordStream& records_;
  const Layout& layout_;
  std::string hint_;
  std::vector<bool> ignored_;  // per file column
  std::vector<double> raw_;
  std::vector<double> values_;
};

/// Counters of time that wrap.
struct TimeCounter {
  double span_s;
  const char* what;
};
constexpr TimeCounter kTimeCounters[]{{65.536, "a counter of 16 bits of milliseconds"},
                                      {0.065536, "a counter of 16 bits of microseconds"},
                                      {4294967.296, "a counter of 32 bits of milliseconds"},
                                      {4294.967296, "a counter of 32 bits of microseconds"}};

/// The counter that wrapped where time goes back by so much, or null: going on, it would be within a few of the
/// longest interval so far.
const TimeCounter* wrapped(double interval_s, double longest_s) {
  constexpr double kLongest = 5.0;
  for (const TimeCounter& c : kTimeCounters)
    if (interval_s < -0.5 * c.span_s && interval_s + c.span_s > 0.0 &&
        interval_s + c.span_s <= kLongest * longest_s)
      return &c;
  return nullptr;
}

void refuse_too_many(const LogSummary& s, const std::string& name) {
  const auto bad = static_cast<double>(s.refused.size()), rows = bad + static_cast<double>(s.rows);
  if (bad <= kMostRefused * rows) return;
  throw core::DataError(name + ":" + std::to_string(s.refused.front().line) + ": the first of " +
                        std::to_string(s.refused.size()) + " bad rows of " + core::shortest(rows) + ", " +
                        s.refused.front().why +
                        "; expected at most a twentieth that --skip-bad-rows leaves out");
}

LogSummary visit(core::ByteSource& source, const std::string& name, const std::string& rig_name,
                 const ColumnMap* map, const std::function<RowVisitor(const LogHeader&)>& on_header,
                 BadRows bad) {
  const RigInfo* rig = rig_named(rig_name);
  if (rig == nullptr) throw std::invalid_argument("no rig is called " + core::quoted(rig_name));
  RecordStream records(source, name);
  const Layout layout = read_layout(records, *rig, map);
  const RowVisitor visitor = on_header(layout.header);
  RowReader rows(records, layout, bad);
  IntervalMedian median;
  LogSummary summary;
  summary.header = layout.header;
  double first_s = 0.0, last_s = 0.0, turns_s = 0.0;

  std::string_view record;
  std::uint64_t blank_line = 0;
  while (records.next(record)) {
    // Blank lines may stand at the end of the file only.
    if (record.empty()) {
      if (blank_line == 0) blank_line = records.line();
      continue;
    }
    if (blank_line != 0 && bad == BadRows::refused)
      throw core::DataError(
          name + ":" + std::to_string(blank_line) +
          ": a blank line among the rows, ''; expected a row (--skip-bad-rows leaves it out)");
    try {
      const std::span<double> values = rows.parse(record);
      double time_s = values[layout.time_channel] + turns_s;
      if (summary.rows == 0) {
        first_s = time_s;
      } else {
        double interval_s = time_s - last_s;
        if (!(interval_s > 0.0) || !std::isfinite(interval_s)) {
          const TimeCounter* counter = wrapped(interval_s, summary.interval_max_s);
          if (counter == nullptr || bad == BadRows::refused)
            rows.fail(layout.channels[layout.time_channel].source,
                      core::shortest(time_s) + " s after " + core::shortest(last_s) +
                          " s in the row before; expected time to increase" +
                          (counter == nullptr ? ""
                                              : std::string(": it seems that ") + counter->what +
                                                    " wraps here, and --skip-bad-rows goes on over it"));
          turns_s += counter->span_s;
          time_s += counter->span_s;
          interval_s += counter->span_s;
          summary.notes.push_back(name + " line " + std::to_string(records.line()) + ": time goes back by " +
                                  core::rounded(counter->span_s - interval_s, 7) + " s, as " + counter->what +
                                  " does that wraps: taken to go on.");
        }
        median.add(interval_s);
        summary.interval_min_s =
            summary.rows == 1 ? interval_s : std::min(summary.interval_min_s, interval_s);
        summary.interval_max_s = std::max(summary.interval_max_s, interval_s);
      }
      values[layout.time_channel] = time_s;
      last_s = time_s;
      ++summary.rows;
      visitor(values, records.line());
    } catch (const BadRow& row) {
      if (bad == BadRows::refused) throw;
      summary.refused.push_back({name, static_cast<std::size_t>(records.line() - layout.header.line),
                                 records.line(), row.column, kNoNumber, row.text, row.why});
    }
  }
  if (summary.rows != 0) refuse_too_many(summary, name);
  if (summary.rows == 0)
    throw core::DataError(name + ":" + std::to_string(records.line()) +
                          ": no rows after the header row; expected at least one");
  summary.duration_s = last_s - first_s;
  summary.interval_median_s = median.value();
  summary.ignored_columns = rows.ignored_columns();
  summary.last_row_ends = records.ended();
  return summary;
}

Log collect(core::ByteSource& source, const std::string& name, const std::string& rig, const ColumnMap* map,
            BadRows bad) {
  std::vector<std::vector<double>> columns;
  std::vector<std::uint32_t> lines;
  LogSummary summary = visit(
      source, name, rig, map,
      [&](const LogHeader& header) {
        columns.resize(header.columns.size());
        return [&](std::span<const double> values, std::uint64_t line) {
          for (std::size_t i = 0; i < values.size(); ++i) columns[i].push_back(values[i]);
          lines.push_back(static_cast<std::uint32_t>(line));
        };
      },
      bad);
  Log log{name,
          rig,
          std::move(summary.header.metadata),
          {},
          summary.header.line,
          std::move(lines),
          std::move(summary.refused),
          std::move(summary.notes)};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& column = summary.header.columns[i];
    const auto& ignored = summary.ignored_columns;
    if (std::find(ignored.begin(), ignored.end(), column) == ignored.end())
      log.columns.emplace(column, std::move(columns[i]));
  }
  return log;
}

}  // namespace

LogSummary visit_log(const std::string& path, const std::string& rig, const ColumnMap* map,
                     const std::function<RowVisitor(const LogHeader&)>& on_header, BadRows bad) {
  core::FileSource source(path, "a log (CSV)");
  return visit(source, path, rig, map, on_header, bad);
}

Log read_log(const std::string& path, const std::string& rig, const ColumnMap* map, BadRows bad) {
  core::FileSource source(path, "a log (CSV)");
  return collect(source, path, rig, map, bad);
}

LogSummary check_log(const std::string& path, const std::string& rig, const ColumnMap* map, BadRows bad) {
  return visit_log(
      path, rig, map, [](const LogHeader&) { return [](std::span<const double>, std::uint64_t) {}; }, bad);
}

std::string rig_line(const std::string& path) {
  core::FileSource source(path, "a log (CSV)");
  RecordStream records(source, path);
  return read_rig_line(records);
}

Log parse_log(std::string_view text, const std::string& name, const std::string& rig, const ColumnMap* map,
              BadRows bad) {
  core::TextSource source(text);
  return collect(source, name, rig, map, bad);
}

}  // namespace furcula::log
