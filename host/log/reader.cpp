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

class RowReader {
 public:
  RowReader(RecordStream& records, const Layout& layout)
      : records_(records),
        layout_(layout),
        ignored_(layout.file_columns.size(), false),
        raw_(layout.file_columns.size()),
        values_(layout.channels.size()) {}

  std::span<const double> parse(std::string_view record) {
    fill_raw(record);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const Channel& channel = layout_.channels[i];
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
      if (ignored_[c.source]) names.push_back(c.name);
    return names;
  }

  [[noreturn]] void fail(std::size_t file_column, const std::string& message) const {
    std::string who = "column " + core::quoted(layout_.file_columns[file_column]);
    for (const Channel& c : layout_.channels)
      if (c.source == file_column && c.known && c.name != layout_.file_columns[file_column])
        who += " (mapped to '" + c.name + "')";
    fail_row(who + ": " + message);
  }

  [[noreturn]] void fail_row(const std::string& message) const {
    throw core::DataError(records_.name() + ":" + std::to_string(records_.line()) + ": " + message);
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
          (last ? stopped == end : stopped != end && *stopped == ',')) {
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
    const std::string field = take_field(rest, more);
    if (more == (i + 1 == raw_.size())) wrong_field_count(record);
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
                (field.find(',') != field.npos ? " with '.'" : ""));
  }

  [[noreturn]] void wrong_field_count(std::string_view record) const {
    std::size_t fields = 0;
    std::string_view rest = record;
    for (bool more = true; more; ++fields) take_field(rest, more);
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
  std::vector<bool> ignored_;  // per file column
  std::vector<double> raw_;
  std::vector<double> values_;
};

LogSummary visit(core::ByteSource& source, const std::string& name, const std::string& rig_name,
                 const ColumnMap* map, const std::function<RowVisitor(const LogHeader&)>& on_header) {
  const RigInfo* rig = rig_named(rig_name);
  if (rig == nullptr) throw std::invalid_argument("no rig is called " + core::quoted(rig_name));
  RecordStream records(source, name);
  const Layout layout = read_layout(records, *rig, map);
  const RowVisitor visitor = on_header(layout.header);
  RowReader rows(records, layout);
  IntervalMedian median;
  LogSummary summary;
  summary.header = layout.header;
  double first_s = 0.0, last_s = 0.0;

  std::string_view record;
  std::uint64_t blank_line = 0;
  while (records.next(record)) {
    // Blank lines may stand at the end of the file only.
    if (record.empty()) {
      if (blank_line == 0) blank_line = records.line();
      continue;
    }
    if (blank_line != 0)
      throw core::DataError(name + ":" + std::to_string(blank_line) +
                            ": a blank line among the rows, ''; expected a row");
    const std::span<const double> values = rows.parse(record);
    const double time_s = values[layout.time_channel];
    if (summary.rows == 0) {
      first_s = time_s;
    } else {
      const double interval_s = time_s - last_s;
      if (!(interval_s > 0.0) || !std::isfinite(interval_s))
        rows.fail(layout.channels[layout.time_channel].source,
                  core::shortest(time_s) + " s after " + core::shortest(last_s) +
                      " s in the row before; expected time to increase");
      median.add(interval_s);
      summary.interval_min_s = summary.rows == 1 ? interval_s : std::min(summary.interval_min_s, interval_s);
      summary.interval_max_s = std::max(summary.interval_max_s, interval_s);
    }
    last_s = time_s;
    ++summary.rows;
    visitor(values);
  }
  if (summary.rows == 0)
    throw core::DataError(name + ":" + std::to_string(records.line()) +
                          ": no rows after the header row; expected at least one");
  summary.duration_s = last_s - first_s;
  summary.interval_median_s = median.value();
  summary.ignored_columns = rows.ignored_columns();
  summary.last_row_ends = records.ended();
  return summary;
}

Log collect(core::ByteSource& source, const std::string& name, const std::string& rig, const ColumnMap* map) {
  std::vector<std::vector<double>> columns;
  LogSummary summary = visit(source, name, rig, map, [&columns](const LogHeader& header) {
    columns.resize(header.columns.size());
    return [&columns](std::span<const double> values) {
      for (std::size_t i = 0; i < values.size(); ++i) columns[i].push_back(values[i]);
    };
  });
  Log log{name, rig, std::move(summary.header.metadata), {}};
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
                     const std::function<RowVisitor(const LogHeader&)>& on_header) {
  core::FileSource source(path, "a log (CSV)");
  return visit(source, path, rig, map, on_header);
}

Log read_log(const std::string& path, const std::string& rig, const ColumnMap* map) {
  core::FileSource source(path, "a log (CSV)");
  return collect(source, path, rig, map);
}

LogSummary check_log(const std::string& path, const std::string& rig, const ColumnMap* map) {
  return visit_log(path, rig, map, [](const LogHeader&) { return [](std::span<const double>) {}; });
}

std::string rig_line(const std::string& path) {
  core::FileSource source(path, "a log (CSV)");
  RecordStream records(source, path);
  return read_rig_line(records);
}

Log parse_log(std::string_view text, const std::string& name, const std::string& rig, const ColumnMap* map) {
  core::TextSource source(text);
  return collect(source, name, rig, map);
}

}  // namespace furcula::log
