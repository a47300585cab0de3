// Reading logs, see reader.hpp.
#include "host/log/reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "host/core/byte_source.hpp"
#include "host/core/message.hpp"
#include "host/log/layout.hpp"
#include "host/log/number.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/rigs.hpp"
#include "host/log/stamp.hpp"
#include "host/log/time_order.hpp"

namespace furcula::log {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// A row that is not as the others: what is wrong with it beside the message.
struct BadRow : core::DataError {
  BadRow(const std::string& message, std::string its_column, std::string its_why)
      : core::DataError(message), column(std::move(its_column)), why(std::move(its_why)) {}
  std::string column, why;
};

class RowReader {
 public:
  RowReader(RecordStream& records, const Layout& layout)
      : records_(records),
        layout_(layout),
        kinds_(layout.file_columns.size(), Kind::unknown),
        raw_(layout.file_columns.size()),
        values_(layout.channels.size()),
        holes_(layout.file_columns.size(), false) {
    for (const Channel& c : layout.channels)
      for (const Source& s : c.sources) {
        if (c.known && !c.optional() && kinds_[s.column] != Kind::time) kinds_[s.column] = Kind::required;
        if (c.known && c.optional() && kinds_[s.column] == Kind::unknown) kinds_[s.column] = Kind::optional;
        if (c.kind == ColumnKind::time) kinds_[s.column] = Kind::time;
      }
    for (std::size_t i = 0; i < layout.channels.size(); ++i) {
      const Channel& c = layout.channels[i];
      plain_.push_back(c.mapped ? kMapped : c.sources.front().column);
      if (c.kind == ColumnKind::flag && !c.sources.empty()) flags_.push_back(i);
    }
    time_fields_.resize(layout.channels[layout.time_channel].sources.size());
  }

  std::span<double> parse(std::string_view record) {
    if (layout_.separator == ' ') {
      join_blanks(record, joined_);
      record = joined_;
    }
    fill_raw(record);
    for (std::size_t i = 0; i < values_.size(); ++i)
      values_[i] = plain_[i] != kMapped ? raw_[plain_[i]] : mapped(layout_.channels[i]);
    for (const std::size_t i : flags_) {
      const Channel& channel = layout_.channels[i];
      const double value = values_[i];
      if (value != 0.0 && value != 1.0 && !(std::isnan(value) && channel.optional()))
        fail(channel.sources.front().column,
             core::shortest(value) + (channel.mapped ? " after the map" : "") + "; expected 0 or 1");
    }
    return values_;
  }

  /// The time of the last row, exactly.
  Stamp stamp() const {
    const Channel& time = layout_.channels[layout_.time_channel];
    Stamp sum;
    for (std::size_t k = 0; k < time.sources.size(); ++k)
      sum.add(
          stamp_of(time_fields_[k], time.sources[k].scale, raw_[time.sources[k].column], layout_.decimal));
    return sum;
  }

  /// Columns that the rig does not know and that hold something else than numbers somewhere.
  std::vector<std::string> ignored_columns() const {
    std::vector<std::string> names;
    for (const Channel& c : layout_.channels)
      for (const Source& s : c.sources)
        if (kinds_[s.column] == Kind::ignored) names.push_back(c.name);
    return names;
  }

  /// Whether an optional column of the last row holds no number.
  bool has_holes() const { return has_holes_; }
  bool hole(std::size_t file_column) const { return holes_[file_column]; }

  [[noreturn]] void fail(std::size_t file_column, const std::string& message) const {
    std::string who = "column " + core::quoted(layout_.file_columns[file_column]), ours;
    for (const Channel& c : layout_.channels)
      for (const Source& s : c.sources) {
        if (s.column != file_column) continue;
        if (c.known && c.name != layout_.file_columns[file_column])
          who += " (mapped to '" + core::printable(c.name) + "')";
        if (c.known || ours.empty()) ours = c.name;
      }
    fail_row(who + ": " + message, ours, message);
  }

  [[noreturn]] void fail_row(const std::string& message, const std::string& column = {},
                             const std::string& why = {}) const {
    throw BadRow(message, column, why.empty() ? message : why);
  }

 private:
  static constexpr std::size_t kMapped = static_cast<std::size_t>(-1);
  enum class Kind : unsigned char { unknown, ignored, optional, required, time };

  double mapped(const Channel& channel) const {
    double value = channel.offset;
    for (const Source& s : channel.sources) value = raw_[s.column] * s.scale + value;
    if (!channel.sources.empty() && !std::isfinite(value) && channel.known)
      fail(channel.sources.front().column,
           "not finite after the map; expected a scale and offset that suit it");
    return value;
  }

  void fill_raw(std::string_view record) {
    const char* at = record.data();
    const char* const end = at + record.size();
    const std::size_t columns = raw_.size();
    if (!time_copies_.empty()) time_copies_.clear();
    has_holes_ = false;
    for (std::size_t i = 0; i < columns; ++i) {
      double value = 0.0;
      const auto [stopped, error] = std::from_chars(at, end, value);
      const bool last = i + 1 == columns;
      if (error == std::errc{} && std::isfinite(value) &&
          (last ? stopped == end : stopped != end && *stopped == layout_.separator)) {
        if (kinds_[i] == Kind::time) keep_time(i, {at, static_cast<std::size_t>(stopped - at)});
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

  void keep_time(std::size_t file_column, std::string_view field) {
    const std::vector<Source>& sources = layout_.channels[layout_.time_channel].sources;
    for (std::size_t k = 0; k < sources.size(); ++k)
      if (sources[k].column == file_column) time_fields_[k] = field;
  }

  // Spaces, quotes, a plus sign, an extreme exponent; or no number at all.
  double unusual_field(std::string_view& rest, std::size_t i, bool& more, std::string_view record) {
    const bool quoted = rest.find('"') <= rest.find_first_not_of(" \t");
    std::string field = take_field(rest, more, layout_.separator);
    if (more == (i + 1 == raw_.size())) wrong_field_count(record);
    std::string number = field;
    if (const std::size_t first = number.find_first_not_of(" \t"); first != number.npos)
      number = number.substr(first, number.find_last_not_of(" \t") + 1 - first);
    if (layout_.decimal != '.') std::replace(number.begin(), number.end(), layout_.decimal, '.');
    double value = 0.0;
    const bool is_number = parse_number(number, value);
    if (quoted && records_.open_quote() && kinds_[i] > Kind::ignored) fail(i, "a quote is not closed");
    if (is_number && std::isfinite(value)) {
      if (kinds_[i] == Kind::time) keep_time(i, time_copies_.emplace_back(number));
      return value;
    }
    if (kinds_[i] == Kind::unknown || kinds_[i] == Kind::ignored) {
      kinds_[i] = Kind::ignored;
      return kNoNumber;
    }
    const std::string expected = "; expected a finite decimal number";
    if (!records_.ended() && i + 1 == raw_.size())
      fail(i, core::quoted(field) + " is where the file ends: the last row is torn" + expected);
    if (kinds_[i] == Kind::optional) {
      if (!has_holes_) holes_.assign(holes_.size(), false);
      has_holes_ = holes_[i] = true;
      return kNoNumber;
    }
    if (is_number) fail(i, core::quoted(field) + " is not finite" + expected);
    if (field.empty()) fail(i, "no value ('')" + expected);
    fail(i, core::quoted(field) + " is not a number" + expected +
                (field.find(',') != field.npos ? " with '.' (or decimal = \",\" in a --map file)" : ""));
  }

  [[noreturn]] void wrong_field_count(std::string_view record) const {
    const std::size_t fields = fields_of(record, layout_.separator).size();
    const std::string expected = "; expected " + std::to_string(raw_.size()) + " fields as in the header row";
    if (record.find('\0') != record.npos)
      fail_row("NUL bytes, " + core::quoted(record.substr(record.find('\0'), 1)) + expected);
    const std::string has = std::to_string(fields) + (fields == 1 ? " field" : " fields");
    if (!records_.ended() && fields < raw_.size())
      fail_row("the file ends in the middle of a row: the last row is torn, it has " + has + ", " +
               core::quoted(record) + expected);
    fail_row("the row has " + has + ", " + core::quoted(record) + expected);
  }

  RecordStream& records_;
  const Layout& layout_;
  std::vector<Kind> kinds_;         // per file column
  std::vector<std::size_t> plain_;  // per channel its file column, or kMapped
  std::vector<std::size_t> flags_;  // channels
  std::vector<double> raw_;
  std::vector<double> values_;
  std::vector<bool> holes_;  // of the last row that has any
  bool has_holes_ = false;
  std::string joined_;
  std::vector<std::string_view> time_fields_;
  std::deque<std::string> time_copies_;  // of fields that are no plain numbers
};

/// Rows that are left out of one log: counted, named, and how many there may be.
class BadRows {
 public:
  BadRows(const Layout& layout, std::string name, std::size_t most_named)
      : layout_(layout), name_(std::move(name)), most_named_(most_named) {}

  void add(std::uint64_t line, const std::string& message, const std::string& column,
           const std::string& why) {
    if (count_ == 0 || line < first_line_) {
      first_line_ = line;
      first_ = message;
    }
    ++count_;
    if (column == layout_.channels[layout_.time_channel].name) ++of_time_;
    if (rows_.size() < most_named_)
      rows_.push_back(
          {name_, static_cast<std::size_t>(line - layout_.header.line), line, column, kNoNumber, {}, why});
  }

  /// An optional column without a number in a row that is otherwise good.
  void add_hole(std::size_t channel, std::uint64_t line) {
    std::vector<std::uint64_t>& lines = holes_[channel];
    if (lines.size() < kMostHoles) lines.push_back(line);
    ++hole_count_[channel];
  }

  /// Columns with so many holes that they are not used; the other holes' rows are bad. Of `rows` that were read.
  std::set<std::uint64_t> settle_holes(std::uint64_t rows, LogSummary& summary) {
    std::set<std::uint64_t> bad;
    for (const auto& [channel, lines] : holes_) {
      const std::string& column = layout_.channels[channel].name;
      if (static_cast<double>(hole_count_[channel]) > kMostRefused * static_cast<double>(rows)) {
        const std::string why = "no finite number in " + std::to_string(hole_count_[channel]) + " of " +
                                std::to_string(rows) + " rows, the first in line " +
                                std::to_string(lines.front());
        summary.unusable.emplace(column, why);
        summary.notes.push_back(name_ + ": column " + core::quoted(column) + " was not used: " + why + ".");
        continue;
      }
      for (const std::uint64_t line : lines)
        if (bad.insert(line).second)
          add(line, "column " + core::quoted(column) + ": no finite number; expected a finite decimal number",
              column, "no finite number; expected a finite decimal number");
    }
    return bad;
  }

  /// @throws core::DataError where there are too many, beside `good` rows.
  void refuse_too_many(std::uint64_t good) const {
    const std::uint64_t rows = good + count_;
    if (static_cast<double>(count_) <= kMostRefused * static_cast<double>(rows)) return;
    const bool time = 2 * of_time_ > count_;
    std::string message = name_ + ":" + std::to_string(first_line_) + ": " + first_ +
                          (time ? layout_.time_hint : layout_.rows_hint);
    if (count_ > 1 || rows > 1)
      message += "; " + std::to_string(count_) + " of " + std::to_string(rows) +
                 (count_ == 1 ? " rows is" : " rows are") + " bad, and at most a twentieth is left out";
    if (time && layout_.time_hint.empty() && count_ > 1)
      message +=
          " (a time that repeats is written with too few digits, one that jumps to and fro is of several recordings: write more "
          "digits, or a file for each)";
    throw core::DataError(message);
  }
  /// The same before the end where nearly nothing is good, so that memory stays bounded.
  void give_up_early(std::uint64_t good) const {
    if (count_ > kMostHoles && count_ > good) refuse_too_many(good);
  }

  std::uint64_t count() const { return count_; }
  std::vector<RefusedRow> take_rows() {
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const RefusedRow& a, const RefusedRow& b) { return a.line < b.line; });
    return std::move(rows_);
  }

 private:
  static constexpr std::size_t kMostHoles = 100'000;

  const Layout& layout_;
  std::string name_;
  std::size_t most_named_;
  std::uint64_t count_ = 0, of_time_ = 0, first_line_ = 0;
  std::string first_;  // its message
  std::vector<RefusedRow> rows_;
  std::map<std::size_t, std::vector<std::uint64_t>> holes_;  // per channel the first lines
  std::map<std::size_t, std::uint64_t> hole_count_;
};

struct Visited {
  LogSummary summary;
  std::set<std::uint64_t> holes;  ///< lines that the visitor has seen and that are among the refused
};

/// Goes through a log row by row. What `on_header` gives is called for each row with the values in the order of LogHeader::columns, NaN where
/// a column that is not required holds something else than a number, and the line at which it begins.
template <class OnHeader>
Visited visit(core::ByteSource& source, const std::string& name, const std::string& rig_name,
              const ColumnMap* map, const OnHeader& on_header, std::size_t most_named) {
  const RigInfo* rig = rig_named(rig_name);
  if (rig == nullptr) throw std::invalid_argument("no rig is called " + core::quoted(rig_name));
  RecordStream records(source, name);
  const Layout layout = read_layout(records, *rig, map);
  const auto visitor = on_header(layout.header);
  RowReader rows(records, layout);
  BadRows bad(layout, name, most_named);
  const Channel& time_channel = layout.channels[layout.time_channel];
  const std::string time_is = "column " +
                              core::quoted(layout.file_columns[time_channel.sources.front().column]) +
                              (time_channel.mapped ? " (mapped to 'time_s'): " : ": ");
  TimeOrder order(
      name, time_channel.sources.front().scale,
      [&](std::span<double> values, std::uint64_t line, double time_s) {
        values[layout.time_channel] = time_s;
        visitor(values, line);
      },
      [&](const TimeOrder::Row& row, const std::string& why) {
        bad.add(row.line, time_is + why, time_channel.name, why);
      });

  std::string_view record;
  std::uint64_t comments = 0, first_comment = 0;
  while (records.next(record)) {
    if (records.fault() != nullptr) {
      bad.add(records.line(), records.fault(), {}, records.fault());
      continue;
    }
    for (;;) {
      if (record.find_first_not_of(" \t") == record.npos) break;  // a blank line
      if (record.front() == '#') {
        if (comments++ == 0) first_comment = records.line();
        break;
      }
      try {
        const std::span<double> values = rows.parse(record);
        const double time_s = values[layout.time_channel];
        order.add(values, records.line(), time_s, order.needs_stamp(time_s) ? rows.stamp() : Stamp{});
        if (rows.has_holes())
          for (std::size_t i = 0; i < layout.channels.size(); ++i)
            if (const auto& s = layout.channels[i].sources; s.size() == 1 && rows.hole(s.front().column))
              bad.add_hole(i, records.line());
      } catch (const BadRow& row) {
        // A quote that is closed in another line may have swallowed good rows.
        if (records.first_line_alone(record)) continue;
        const std::string quote =
            "a quote is not closed, " + core::quoted(record) + "; expected a closing '\"'";
        if (records.open_quote())
          bad.add(records.line(), quote, {}, quote);
        else
          bad.add(records.line(), row.what(), row.column, row.why);
        bad.give_up_early(order.rows());
      }
      break;
    }
  }
  order.finish();
  Visited v;
  LogSummary& summary = v.summary;
  summary.header = layout.header;
  summary.notes = layout.notes;
  for (std::string& note : order.notes()) summary.notes.push_back(std::move(note));
  if (comments != 0)
    summary.notes.push_back(name + ": " + std::to_string(comments) +
                            (comments == 1 ? " comment line" : " comment lines") +
                            " among the rows, from line " + std::to_string(first_comment) + " on, left out.");
  v.holes = bad.settle_holes(order.rows(), summary);
  summary.rows = order.rows() - v.holes.size();
  bad.refuse_too_many(summary.rows);
  if (summary.rows == 0)
    throw core::DataError(name + ":" + std::to_string(records.line()) +
                          ": no rows after the header row; expected at least one");
  summary.refused = bad.take_rows();
  summary.refused_rows = bad.count();
  summary.duration_s = order.duration_s();
  summary.interval_min_s = order.shortest_s();
  summary.interval_max_s = order.longest_s();
  summary.interval_mean_s = order.rows() > order.steps() + 1
                                ? order.duration_s() / static_cast<double>(order.rows() - 1 - order.steps())
                                : 0.0;
  summary.interval_median_s = order.intervals().value();
  summary.ignored_columns = rows.ignored_columns();
  summary.last_row_ends = records.ended();
  return v;
}

Log collect(core::ByteSource& source, const std::string& name, const std::string& rig, const ColumnMap* map) {
  std::vector<std::vector<double>> columns;
  std::vector<std::uint32_t> lines;
  Visited v = visit(
      source, name, rig, map,
      [&](const LogHeader& header) {
        columns.resize(header.columns.size());
        return [&](std::span<const double> values, std::uint64_t line) {
          for (std::size_t i = 0; i < values.size(); ++i) columns[i].push_back(values[i]);
          lines.push_back(static_cast<std::uint32_t>(line));
        };
      },
      std::numeric_limits<std::size_t>::max());
  LogSummary& summary = v.summary;
  if (!v.holes.empty()) {
    const auto keep = [&](std::vector<double>& values) {
      std::size_t to = 0;
      for (std::size_t i = 0; i < values.size(); ++i)
        if (!v.holes.contains(lines[i])) values[to++] = values[i];
      values.resize(to);
    };
    for (std::vector<double>& column : columns) keep(column);
    std::erase_if(lines, [&](std::uint32_t line) { return v.holes.contains(line); });
  }
  Log log{name,
          rig,
          std::move(summary.header.metadata),
          {},
          summary.header.line,
          std::move(lines),
          std::move(summary.refused),
          std::move(summary.notes),
          std::move(summary.unusable)};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& column = summary.header.columns[i];
    const auto& ignored = summary.ignored_columns;
    if (std::find(ignored.begin(), ignored.end(), column) == ignored.end() && !log.unusable.contains(column))
      log.columns.emplace(column, std::move(columns[i]));
  }
  return log;
}

}  // namespace

Log read_log(const std::string& path, const std::string& rig, const ColumnMap* map) {
  core::FileSource source(path, "a log (CSV)");
  return collect(source, path, rig, map);
}

LogSummary check_log(const std::string& path, const std::string& rig, const ColumnMap* map) {
  core::FileSource source(path, "a log (CSV)");
  std::optional<StampJudge> judge;
  std::vector<std::size_t> positions;
  LogSummary summary =
      visit(
          source, path, rig, map,
          [&](const LogHeader& header) {
            const auto at = [&](const std::string& name) {
              return static_cast<std::size_t>(std::find(header.columns.begin(), header.columns.end(), name) -
                                              header.columns.begin());
            };
            for (const std::string& name : position_columns(rig, header.columns))
              positions.push_back(at(name));
            judge.emplace(path, positions.size(), map);
            return [&, time = at("time_s")](std::span<const double> values, std::uint64_t line) {
              judge->add(values[time], line, [&](std::size_t j) { return values[positions[j]]; });
            };
          },
          kMostNamed)
          .summary;
  summary.stamps = judge->finish();
  return summary;
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
