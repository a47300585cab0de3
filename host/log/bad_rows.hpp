// Rows of a log that cannot be read: counted, named, and how many there may be.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/data_quality.hpp"
#include "host/log/layout.hpp"
#include "host/log/reader.hpp"
#include "host/log/row_reader.hpp"

namespace furcula::log {

/// ": python3 ...", a command that makes rows of one signal's times, with the others interpolated; empty where the time is of several columns.
inline std::string interpolation(const Layout& layout, const std::string& path) {
  const std::vector<Source>& time = layout.channels[layout.time_channel].sources;
  if (time.size() != 1) return {};
  std::string base, flags;
  for (const Channel& c : layout.channels) {
    if (!c.known || c.kind == ColumnKind::time || c.sources.empty()) continue;
    const std::string name = "d[" + core::python_string(layout.file_columns[c.sources.front().column]) + "]";
    if (c.kind == ColumnKind::flag)
      flags += name + " = " + name + ".ffill(); ";
    else if (base.empty())
      base = name;
  }
  if (base.empty()) return {};
  const std::string options =
      (layout.separator == ',' ? "" : ", sep=" + core::python_string(std::string(1, layout.separator))) +
      (layout.decimal == '.' ? "" : ", decimal=" + core::python_string(std::string(1, layout.decimal))) +
      (layout.header.line > 1 ? ", skiprows=" + std::to_string(layout.header.line - 1) : "");
  return ": " + core::printable(core::python_command(
                    "import pandas as pd; d = pd.read_csv(" + core::python_string(path) +
                    ", index_col=" + core::python_string(layout.file_columns[time.front().column]) + options +
                    ").select_dtypes(\"number\"); " + flags + "d.interpolate(\"index\")[" + base +
                    ".notna()].to_csv(" + core::python_string(core::with_ending(path, "_even.csv")) + ")"));
}

class BadRows {
 public:
  BadRows(const Layout& layout, std::string name, std::size_t most_named)
      : layout_(layout), name_(std::move(name)), most_named_(most_named) {}

  /// What is wrong with it, where a hint depends on that.
  enum class Fault { other, no_value, time_order };

  void add(std::uint64_t line, const std::string& message, const std::string& column, const std::string& why,
           Fault fault = Fault::other) {
    if (count_ == 0 || line < first_line_) {
      first_line_ = line;
      first_ = message;
    }
    ++count_;
    if (fault == Fault::time_order) ++of_time_;
    if (fault == Fault::no_value) ++without_value_;
    if (rows_.size() < most_named_)
      rows_.push_back({name_,
                       static_cast<std::size_t>(line - layout_.header.line),
                       line,
                       column,
                       std::numeric_limits<double>::quiet_NaN(),
                       {},
                       why});
  }

  /// A row that holds values of other signals than those asked for. `bad` gives what would be wrong with it.
  void add_of_others(std::uint64_t line, const BadRow& bad) {
    if (of_others_.empty()) first_of_others_ = bad;
    if (of_others_.size() < kMostHoles) of_others_.push_back(line);
    ++of_others_count_;
  }

  /// Few rows of others are bad; many are noted. Beside `rows` that were read.
  void settle_others(std::uint64_t rows, LogSummary& summary) {
    if (of_others_count_ == 0) return;
    const std::uint64_t all = rows + count_ + of_others_count_;
    if (rows == 0)
      throw core::DataError(
          name_ + ":" + std::to_string(of_others_.front()) + ": " + first_of_others_.what() + "; " +
          (of_others_count_ == 1 ? "the row holds"
                                 : "all " + std::to_string(of_others_count_) + " rows hold") +
          " values of other columns only (does the file hold the signals that are asked for?)");
    if (static_cast<double>(of_others_count_) > kMostRefused * static_cast<double>(all)) {
      summary.notes.push_back(
          name_ + ": " + std::to_string(of_others_count_) + " of " + std::to_string(all) +
          " rows, from line " + std::to_string(of_others_.front()) +
          " on, have values of other columns only, with times of their own, and were left out.");
    } else {
      for (const std::uint64_t line : of_others_)
        add(line, first_of_others_.what(), first_of_others_.column, first_of_others_.why, Fault::no_value);
      count_ += of_others_count_ - of_others_.size();
    }
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
    const bool no_value = 2 * without_value_ > count_;
    std::string message = name_ + ":" + std::to_string(first_line_) + ": " + first_ +
                          (time ? layout_.time_hint : layout_.rows_hint);
    if (count_ > 1 || rows > 1)
      message += "; " + std::to_string(count_) + " of " + std::to_string(rows) +
                 (count_ == 1 ? " rows is" : " rows are") + " bad, and at most a twentieth is left out";
    if (no_value && count_ > 1)
      message += "; if the signals have times of their own, interpolate them" + interpolation(layout_, name_);
    if (time && layout_.time_hint.empty() && count_ > 1)
      message +=
          " (a time that repeats is written with too few digits, or was given to all rows of a buffer when it was read; one that jumps to and fro is of several recordings: write more "
          "digits, or the device's own time, or a file for each)";
    throw core::DataError(message);
  }
  /// The same before the end where nearly nothing is good, so that memory stays bounded.
  void give_up_early(std::uint64_t good) const {
    if (count_ > kMostHoles && count_ > good) refuse_too_many(good);
  }

  std::uint64_t count() const { return count_; }
  std::vector<RejectedRow> take_rows() {
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const RejectedRow& a, const RejectedRow& b) { return a.line < b.line; });
    return std::move(rows_);
  }

 private:
  static constexpr std::size_t kMostHoles = 100'000;

  const Layout& layout_;
  std::string name_;
  std::size_t most_named_;
  std::uint64_t count_ = 0, of_time_ = 0, without_value_ = 0, of_others_count_ = 0, first_line_ = 0;
  std::vector<std::uint64_t> of_others_;  // lines of the first of them
  BadRow first_of_others_{"", "", ""};
  std::string first_;  // its message
  std::vector<RejectedRow> rows_;
  std::map<std::size_t, std::vector<std::uint64_t>> holes_;  // per channel the first lines
  std::map<std::size_t, std::uint64_t> hole_count_;
};

}  // namespace furcula::log
