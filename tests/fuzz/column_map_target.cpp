// The reader of map files, and a log read through the map.
#include "host/core/error.hpp"
#include "host/log/column_map.hpp"
#include "host/log/reader.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  log::ColumnMap map;
  try {
    map = log::parse_column_map(input, "input");
  } catch (const core::DataError&) {
    return false;
  }
  require(!map.columns.empty() || map.separator || map.decimal == ',' || input.find("decimal") != input.npos,
          "a map says something");
  if (map.rig.empty()) map.rig = "rotary_joint";
  try {
    log::parse_log("time,position,velocity,torque,a\n0,1,2,0,1\n1,2,3,1,0\n", "log", map.rig, &map);
  } catch (const core::DataError&) {
  }
  return true;
}

}  // namespace furcula::fuzz
