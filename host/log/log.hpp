// A log in memory: one uninterrupted recording, columns of equal length in SI units.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace furcula::log {

/// Columns by name as in `furcula-log/1`, `time_s` among them. Every column has `rows()` finite numbers and
/// `time_s` increases strictly: the reader has checked it.
struct Log {
  std::string path;                             ///< where it was read from, for messages
  std::string rig;                              ///< "hopper", "motor_axis", "rotary_joint", ...
  std::map<std::string, std::string> metadata;  ///< the `# key: value` lines
  std::map<std::string, std::vector<double>> columns;

  std::size_t rows() const { return columns.empty() ? 0 : columns.begin()->second.size(); }
  bool has(const std::string& name) const { return columns.contains(name); }
  const std::vector<double>& at(const std::string& name) const { return columns.at(name); }
  const std::vector<double>& time_s() const { return columns.at("time_s"); }
};

}  // namespace furcula::log
