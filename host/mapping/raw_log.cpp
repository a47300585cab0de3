// See raw_log.hpp.
#include "host/mapping/raw_log.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/mapping/names.hpp"

namespace furcula::mapping {
namespace {

/// Between two rows of a log of a machine that drives move, s.
constexpr double kShortest_s = 4e-5, kLongest_s = 0.06;

/// A map under which a log can be read before its columns are known: time, and constants in place of what its own rig must have.
log::ColumnMap reading_map(const std::string& rig, const std::vector<std::string>& columns,
                           const log::MappedColumn& time) {
  log::ColumnMap map;
  map.all_topics = true;
  for (const log::ColumnInfo& c : log::machine_type_named(rig)->columns)
    if (c.required && std::find(columns.begin(), columns.end(), c.name) == columns.end())
      map.columns[std::string(c.name)] = {};
  map.columns["time_s"] = time;
  return map;
}

/// Does `read` with decimal points, and where the reader says that decimals have commas, with those.
template <class Read>
auto with_decimals(log::ColumnMap& map, const Read& read) {
  for (const char separator : {';', '\t', ' '}) {
    try {
      return read();
    } catch (const core::DataError& e) {
      if (std::string(e.what()).find("decimal") == std::string::npos) throw;
    }
    map.separator = separator;
    map.decimal = ',';
  }
  return read();
}

std::vector<std::string> header_of(const std::string& path, const std::string& rig) {
  const log::MappedColumn own{{{"time_s", 1.0}}, 0.0, 0};
  for (const bool has_time : {true, false}) {
    log::ColumnMap map = reading_map(rig, {}, has_time ? own : log::MappedColumn{});
    try {
      std::vector<std::string> names = with_decimals(map, [&] { return log::column_names(path, rig, &map); });
      // Constants are no columns of the file.
      std::erase_if(names, [&](const std::string& name) {
        const auto found = map.columns.find(name);
        return found != map.columns.end() && found->second.parts.empty();
      });
      return names;
    } catch (const core::DataError&) {
      if (!has_time) throw;
    }
  }
  return {};
}

/// Columns that are time: the first of those whose name says so, or its whole seconds and what is added to them.
std::optional<log::MappedColumn> time_by_name(const std::vector<std::string>& columns, std::string& unit) {
  std::optional<std::string> whole, parts;
  for (const std::string& name : columns) {
    const Meaning m = meaning_of(name);
    if (m.role != Role::time) continue;
    if (m.unit == "ns" || m.unit == "nsec" || m.unit == "nsecs" || m.unit == "nanosec")
      parts = parts.value_or(name);
    else
      whole = whole.value_or(name);
  }
  if (!whole && !parts) return std::nullopt;
  const auto says_seconds = [&] {
    const std::string word = meaning_of(*whole).unit;
    return word == "sec" || word == "secs" || word == "s";
  };
  if (whole && parts && says_seconds()) {
    unit = "s";
    return log::MappedColumn{{{*whole, 1.0}, {*parts, 1e-9}}, 0.0, 0};
  }
  const std::string& name = whole ? *whole : *parts;
  unit = meaning_of(name).unit;
  return log::MappedColumn{{{name, 1.0}}, 0.0, 0};
}

/// What the first row of `rostopic echo -p /joint_states` has in the columns field.name0, field.name1 ...
std::map<std::string, std::string> rostopic_joints(const std::string& path,
                                                   const std::vector<std::string>& columns) {
  std::map<std::string, std::string> out;
  std::ifstream file(path);
  std::string header, row, name;
  if (!std::getline(file, header) || !header.starts_with("%time,field.") || !std::getline(file, row))
    return out;
  std::istringstream names(header), values(row);
  for (std::string value; std::getline(names, name, ',') && std::getline(values, value, ',');) {
    constexpr std::string_view kName = "field.name";
    if (!name.starts_with(kName)) continue;
    const std::string number = name.substr(kName.size());
    for (const char* quantity : {"field.position", "field.velocity", "field.effort"})
      if (std::find(columns.begin(), columns.end(), quantity + number) != columns.end())
        out[quantity + number] = value;
  }
  return out;
}

double median_interval(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i)
    if (time[i] > time[i - 1]) steps.push_back(time[i] - time[i - 1]);
  return steps.empty() ? 0.0 : core::median(std::move(steps));
}

/// The unit in which rows are as far apart as those of such logs are.
void settle_unit(RawLog& raw, const std::string& named) {
  const double interval = median_interval(raw.log.time_s());
  const double by_name = si_of(Role::time, named, false);
  const auto usual = [&](double si) { return interval * si >= kShortest_s && interval * si <= kLongest_s; };
  double si = by_name > 0.0 ? by_name : 1.0;
  raw.time_why =
      by_name > 0.0 ? "its name says " + named : "rows are " + core::rounded(1e3 * interval, 3) + " ms apart";
  if (!usual(si))
    for (const double other : {1.0, 1e-3, 1e-6, 1e-9})
      if (usual(other)) {
        si = other;
        raw.time_sure = false;
        raw.time_why = "rows are " + core::rounded(interval, 3) + " apart, which is " +
                       core::rounded(1e3 * interval * si, 3) + " ms in this unit";
        break;
      }
  for (log::MappedPart& p : raw.time.parts) p.scale *= si;
}

}  // namespace

std::string quoted_list(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + core::quoted(name);
  return all;
}

RawLog read_raw(const std::string& path) {
  const log::ColumnMap any = reading_map("tree", {}, {});
  const std::string named = log::rig_line(path, &any), rig = named.empty() ? "tree" : named;
  RawLog out;
  out.columns = header_of(path, rig);
  // Of another rig's log, those that it must have, too.
  if (rig != "tree")
    for (const log::ColumnInfo& c : log::machine_type_named(rig)->columns)
      if (c.required && std::find(out.columns.begin(), out.columns.end(), c.name) == out.columns.end())
        out.columns.emplace_back(c.name);
  std::string unit;
  const auto time = time_by_name(out.columns, unit);
  if (!time)
    throw core::DataError(path + ": no column is time by its name; it has " + quoted_list(out.columns) +
                          "; expected one that is called time, t, timestamp, secs or the like");
  out.time = *time;
  log::ColumnMap map = reading_map(rig, out.columns, *time);
  out.log = with_decimals(map, [&] { return log::read_log(path, rig, &map); });
  out.separator = map.separator.value_or(',');
  out.decimal = map.decimal;
  settle_unit(out, unit);
  out.joint_of = rostopic_joints(path, out.columns);
  return out;
}

}  // namespace furcula::mapping
