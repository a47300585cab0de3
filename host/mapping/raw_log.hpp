// A log's columns under their own names, before any map.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/log/log.hpp"

namespace furcula::mapping {

struct RawLog {
  log::Log log;                      ///< columns that hold numbers, and time_s
  std::vector<std::string> columns;  ///< all, in the order of the file
  /// Joints that another column names, by column: field.name0 of `rostopic echo -p` names that of field.position0.
  std::map<std::string, std::string> joint_of;
  log::MappedColumn time;
  std::string time_why;  ///< what says that this is time, and its unit
  bool time_sure = true;
  char separator = ',', decimal = '.';
};

/// @throws core::DataError where it cannot be read, or no column of it is time.
RawLog read_raw(const std::string& path);

/// "'t', 'q1', 'tau1'"
std::string quoted_list(const std::vector<std::string>& names);

}  // namespace furcula::mapping
