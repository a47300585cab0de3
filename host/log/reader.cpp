// Reading logs, see reader.hpp.
#include "host/log/reader.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "host/bags/bag_text.hpp"
#include "host/core/byte_source.hpp"
#include "host/core/message.hpp"
#include "host/log/bad_rows.hpp"
#include "host/log/layout.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/row_reader.hpp"
#include "host/log/stamp.hpp"
#include "host/log/time_order.hpp"

namespace furcula::log {
namespace {

struct Visited {
  LogSummary summary;
  std::set<std::uint64_t> holes;  ///< lines that the visitor has seen and that are among the refused
};

const MachineType& known_rig(const std::string& name) {
  const MachineType* rig = machine_type_named(name);
  if (rig == nullptr) throw std::invalid_argument("no machine type is called " + core::quoted(name));
  return *rig;
}

constexpr const char* kExpected = "a log (CSV)";

/// A log that is open, and the map to read it with.
struct Input {
  bags::Opened opened;
  std::optional<ColumnMap> of_bag;  ///< the map without what says how a CSV file is written
  const ColumnMap* map;

  Input(bags::Opened log, const ColumnMap* given) : opened(std::move(log)), map(given) {
    if (!opened.bag || map == nullptr) return;
    of_bag = *map;
    of_bag->separator.reset();
    of_bag->decimal = '.';
    map = &*of_bag;
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
};

bags::Request request_of(const ColumnMap* map) {
  bags::Request request;
  if (map == nullptr) return request;
  request.topic = map->topic;
  request.map = map->path;
  request.all_topics = map->all_topics;
  for (const auto& [ours, mapped] : map->columns)
    for (const MappedPart& part : mapped.parts) request.columns.push_back(part.column);
  return request;
}

Input open(const std::string& path, const ColumnMap* map) {
  return {bags::open_log(path, kExpected, request_of(map)), map};
}

/// Goes through a log row by row. What `on_header` gives is called for each row with the values in the order of LogHeader::columns, NaN where
/// a column that is not required holds something else than a number, and the line at which it begins.
template <class OnHeader>
Visited visit(const Input& input, const std::string& name, const std::string& rig_name,
              const OnHeader& on_header, std::size_t most_named) {
  const ColumnMap* map = input.map;
  RecordStream records(*input.opened.text, name);
  const Layout layout = read_layout(records, known_rig(rig_name), map);
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
        bad.add(row.line, time_is + why, time_channel.name, why, BadRows::Fault::time_order);
      });

  std::string_view record;
  std::uint64_t comments = 0, first_comment = 0;
  while (records.next(record)) {
    if (records.fault() != nullptr) {
      bad.add(records.line(), records.fault(), {}, records.fault());
      continue;
    }
    for (;;) {
      if (record.empty() || (record.front() <= ' ' && record.find_first_not_of(" \t") == record.npos)) break;
      if (is_comment(record)) {
        if (comments++ == 0) first_comment = records.line();
        break;
      }
      try {
        const std::span<double> values = rows.parse(record);
        if (rows.may_be_of_other_signals() && rows.of_other_signals(record)) {
          bad.add_of_others(records.line(), rows.no_value());
          break;
        }
        const double time_s = values[layout.time_channel];
        const Stamp stamp = order.needs_stamp(time_s) ? rows.stamp() : Stamp{};
        if (order.follows(time_s, stamp, values[layout.time_channel]))
          visitor(values, records.line());
        else
          order.add(values, records.line(), time_s, stamp);
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
        else if (row.no_value && rows.of_other_signals(record))
          bad.add_of_others(records.line(), row);
        else
          bad.add(records.line(), row.what(), row.column, row.why,
                  row.no_value ? BadRows::Fault::no_value : BadRows::Fault::other);
        bad.give_up_early(order.rows());
      }
      break;
    }
  }
  order.finish();
  Visited v;
  LogSummary& summary = v.summary;
  summary.header = layout.header;
  summary.notes = input.opened.notes;
  summary.notes.insert(summary.notes.end(), layout.notes.begin(), layout.notes.end());
  for (std::string& note : order.notes()) summary.notes.push_back(std::move(note));
  if (comments != 0)
    summary.notes.push_back(name + ": " + std::to_string(comments) +
                            (comments == 1 ? " comment line" : " comment lines") +
                            " among the rows, from line " + std::to_string(first_comment) + " on, left out.");
  bad.settle_others(order.rows(), summary);
  v.holes = bad.settle_holes(order.rows(), summary);
  summary.rows = order.rows() - v.holes.size();
  bad.refuse_too_many(summary.rows);
  if (summary.rows == 0)
    throw core::DataError(name + ":" + std::to_string(records.line()) +
                          ": no rows after the header row; expected at least one");
  summary.refused = bad.take_rows();
  summary.rejected_rows = bad.count();
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

Log collect(const Input& input, const std::string& name, const std::string& rig) {
  std::vector<std::vector<double>> columns;
  std::vector<std::uint32_t> lines;
  Visited v = visit(
      input, name, rig,
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
          std::move(summary.unusable),
          input.map == nullptr ? std::map<std::string, MappedColumn>{} : input.map->columns};
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
  std::string own = rig;
  if (own.empty() && map != nullptr) own = map->rig;
  bags::Request request = request_of(map);
  request.joints_alone = own.empty();
  const Input input(bags::open_log(path, kExpected, request), map);
  if (own.empty()) own = input.opened.bag ? (input.opened.joint_states ? "tree" : "") : rig_line(path, map);
  if (own.empty()) throw core::DataError(no_rig(path));
  return collect(input, path, own);
}

LogSummary check_log(const std::string& path, const std::string& rig, const ColumnMap* map) {
  const Input input = open(path, map);
  std::optional<StampJudge> judge;
  std::vector<std::size_t> positions;
  LogSummary summary =
      visit(
          input, path, rig,
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

std::string rig_line(const std::string& path, const ColumnMap* map) {
  const Input input = open(path, map);
  if (input.opened.bag) return input.opened.joint_states ? "tree" : "";
  RecordStream records(*input.opened.text, path);
  return read_rig_line(records);
}

std::string no_rig(const std::string& path) {
  return path +
         ":1: no line '# machine_type: ...' tells the machine type; expected one, or --machine, --model or --map";
}

std::vector<std::string> column_names(const std::string& path, const std::string& rig, const ColumnMap* map) {
  const Input input = open(path, map);
  RecordStream records(*input.opened.text, path);
  return read_layout(records, known_rig(rig), input.map).header.columns;
}

Log parse_log(std::string_view text, const std::string& name, const std::string& rig, const ColumnMap* map) {
  core::TextSource source(text);
  return collect({bags::open_log(source, name, request_of(map)), map}, name, rig);
}

}  // namespace furcula::log
