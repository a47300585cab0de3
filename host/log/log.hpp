// A log in memory: one uninterrupted recording, columns of equal length in SI units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/log/data_quality.hpp"

namespace furcula::log {

/// Columns by name as in `furcula-log/1`, `time_s` among them. Every column has `rows()` finite numbers and
/// `time_s` increases strictly: the reader has checked it.
struct Log {
  std::string path;                             ///< where it was read from, for messages
  std::string rig;                              ///< "hopper", "motor_axis", "rotary_joint", ...
  std::map<std::string, std::string> metadata;  ///< the `# key: value` lines
  std::map<std::string, std::vector<double>> columns;
  std::uint64_t header_line = 0;       ///< of the file, from 1
  std::vector<std::uint32_t> lines{};  ///< of the file, at which each row begins; empty: not from a file
  std::vector<RejectedRow> refused{};  ///< rows that are not among these
  std::vector<std::string> notes{};    ///< what else was done to it, in sentences
  std::map<std::string, std::string> unusable{};  ///< columns that are not among these, and why
  std::map<std::string, MappedColumn> mapped{};   ///< of the map file that it was read with

  std::size_t rows() const { return columns.empty() ? 0 : columns.begin()->second.size(); }
  bool has(const std::string& name) const { return columns.contains(name); }
  const std::vector<double>& at(const std::string& name) const { return columns.at(name); }
  const std::vector<double>& time_s() const { return columns.at("time_s"); }
};

}  // namespace furcula::log
