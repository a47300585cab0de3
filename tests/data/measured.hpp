// Where the measured recordings are, and how they are read.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "host/log/reader.hpp"
#include "host/model/reader.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

namespace furcula::test {

/// The folder of the recordings: FURCULA_DATA, or ../shared/data beside the checkout; empty (and the test
/// skipped) if it is not there.
inline std::string data_folder() {
  const char* named = std::getenv("FURCULA_DATA");
  const std::string folder = named != nullptr ? named : source("../shared/data");
  if (std::filesystem::is_directory(folder)) return folder;
  skip(("no measured recordings at " + folder + " (FURCULA_DATA names another place)").c_str());
  return {};
}

inline log::Log emps(const std::string& folder, const std::string& name) {
  // force = 35.1507 N/V x drive voltage, as published with the recordings
  static const log::ColumnMap map = log::parse_column_map(
      "machine_type = \"motor_axis\"\n"
      "time_s = { column = \"t\" }\n"
      "position_m = { column = \"qm\" }\n"
      "force_n = { column = \"vir\", scale = 35.1507 }\n",
      "emps-map");
  return log::read_log(folder + "/emps/" + name + ".csv", "motor_axis", &map);
}

inline log::Log pendulum(const std::string& folder, const std::string& name) {
  static const log::ColumnMap map = log::parse_column_map(
      "machine_type = \"rotary_joint\"\n"
      "time_s = { column = \"time\" }\n"
      "angle_rad = { column = \"position\" }\n"
      "torque_nm = { column = \"torque\" }\n",
      "pendulum-map");
  return log::read_log(folder + "/torque_limited_pendulum/" + name + ".csv", "rotary_joint", &map);
}

}  // namespace furcula::test
