// A record of a log as numbers, by the log's layout.
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/layout.hpp"
#include "host/log/number.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/stamp.hpp"
#include "host/log/wanted.hpp"

namespace furcula::log {

/// A row that is not as the others: what is wrong with it beside the message.
struct BadRow : core::DataError {
  BadRow(const std::string& message, std::string its_column, std::string its_why)
      : core::DataError(message), column(std::move(its_column)), why(std::move(its_why)) {}
  std::string column, why;
  bool no_value = false;  ///< for want of a value
};

/// A cell without a value: empty, or as Python, R, MATLAB and databases write it.
inline bool is_no_value(std::string field) {
  for (char& c : field) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::size_t sign = field.starts_with('-') ? 1 : 0;
  for (const std::string_view word : {"nan", "na", "n/a", "<na>", "null", "none"})
    if (std::string_view(field).substr(sign) == word) return true;
  return field.find_first_not_of(" \t") == field.npos;
}

/// "1,200,000" and "1,200.5": commas (or apostrophes, as in Switzerland) between groups of three digits, more than one or before a point.
inline bool has_thousands(std::string_view field) {
  if (field.starts_with('-') || field.starts_with('+')) field.remove_prefix(1);
  const auto digits = [&] {
    std::size_t n = 0;
    while (n < field.size() && std::isdigit(static_cast<unsigned char>(field[n])) != 0) ++n;
    field.remove_prefix(n);
    return n;
  };
  if (const std::size_t first = digits(); first < 1 || first > 3) return false;
  std::size_t groups = 0;
  const char sign = field.empty() ? '\0' : field.front();
  while (!field.empty() && field.front() == sign && (sign == ',' || sign == '\'')) {
    field.remove_prefix(1);
    if (digits() != 3) return false;
    ++groups;
  }
  const bool point = field.starts_with('.');
  if (point) {
    field.remove_prefix(1);
    digits();
  }
  return field.empty() && (groups > 1 || (groups == 1 && (point || sign == '\'')));
}

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
    has_required_ = std::find(kinds_.begin(), kinds_.end(), Kind::required) != kinds_.end();
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

  /// A row of a table in which signals with times of their own are merged: it holds a time and values of columns that nothing asks for, and
  /// none of those that the rig must have or the map names (of a rig that only knows optional ones: none of these).
  bool of_other_signals(std::string_view record) const {
    const Fields fields = fields_of(record, layout_.separator);
    if (fields.size() != raw_.size()) return false;
    const Kind asked = has_required_ ? Kind::required : Kind::optional;
    bool others = false;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const bool none = is_no_value(fields[i]);
      if (kinds_[i] == Kind::time ? none : !none && kinds_[i] == asked) return false;
      others = others || (!none && kinds_[i] != Kind::time);
    }
    return others;
  }

  /// Whether all optional columns of the last row lack a number, and the rig requires none beside the time.
  bool may_be_of_other_signals() const {
    if (has_required_ || !has_holes_) return false;
    for (std::size_t i = 0; i < kinds_.size(); ++i)
      if (kinds_[i] == Kind::optional && !holes_[i]) return false;
    return true;
  }

  /// Of such a row, what it lacks.
  BadRow no_value() const {
    const auto optional = std::find(kinds_.begin(), kinds_.end(), Kind::optional);
    const std::string& column = layout_.file_columns[static_cast<std::size_t>(optional - kinds_.begin())];
    const std::string why = "no value; expected a finite decimal number";
    return {"column " + core::quoted(column) + ": " + why, column, why};
  }

  [[noreturn]] void fail(std::size_t file_column, const std::string& message, bool no_value = false) const {
    std::string who = "column " + core::quoted(layout_.file_columns[file_column]), ours;
    for (const Channel& c : layout_.channels)
      for (const Source& s : c.sources) {
        if (s.column != file_column) continue;
        if (c.known && c.name != layout_.file_columns[file_column])
          who += " (mapped to '" + core::printable(c.name) + "')";
        if (c.known || ours.empty()) ours = c.name;
      }
    BadRow bad(who + ": " + message, ours, message);
    bad.no_value = no_value;
    throw bad;
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
    std::size_t k = 0;
    while (sources[k].column != file_column) ++k;
    time_fields_[k] = field;
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
      return std::numeric_limits<double>::quiet_NaN();
    }
    const std::string expected = "; expected a finite decimal number";
    if (!records_.ended() && i + 1 == raw_.size())
      fail(i, core::quoted(field) + " is where the file ends: the last row is torn" + expected);
    if (kinds_[i] == Kind::optional) {
      if (!has_holes_) holes_.assign(holes_.size(), false);
      has_holes_ = holes_[i] = true;
      return std::numeric_limits<double>::quiet_NaN();
    }
    const bool no_value = is_no_value(field);
    if (is_number) fail(i, core::quoted(field) + " is not finite" + expected, no_value);
    if (field.empty()) fail(i, "no value ('')" + expected, true);
    const bool thousands = has_thousands(field);
    fail(
        i,
        core::quoted(field) + " is not a number" + expected +
            (thousands
                 ? " without separators of thousands (in Python, pandas.read_csv(..., thousands=\",\") reads them)"
             : field.find(',') != field.npos ? " with '.' (or decimal = \",\" in a --map file)"
                                             : ""),
        no_value);
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
  bool has_required_ = false;  // beside the time
  std::string joined_;
  std::vector<std::string_view> time_fields_;
  std::deque<std::string> time_copies_;  // of fields that are no plain numbers
};

}  // namespace furcula::log
