// The machine types whose logs can be read, and their columns (docs/contracts.md, section 1): the one table of them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace furcula::log {

/// What the numbers of a column are.
enum class ColumnKind { time, quantity, flag };  // a flag is 0 or 1

struct ColumnInfo {
  std::string_view name;  ///< quantity_unit, or the flag's name
  bool required;
  ColumnKind kind;
  std::string_view meaning;
};

inline constexpr std::array<ColumnInfo, 11> kHopperColumns{{
    {"time_s", true, ColumnKind::time, "time since any instant, increasing"},
    {"height_m", true, ColumnKind::quantity, "height of the body's centre of mass above the ground plane"},
    {"velocity_mps", false, ColumnKind::quantity, "vertical velocity as the machine derived it"},
    {"leg_angle_rad", false, ColumnKind::quantity,
     "leg angle on the motor's side; in stance height = 2 L cos(angle)"},
    {"contact", true, ColumnKind::flag, "the raw contact switch, 1 = pressed"},
    {"torque_cmd_nm", true, ColumnKind::quantity, "torque commanded to the drive in this row"},
    {"torque_nm", false, ColumnKind::quantity, "torque as the drive makes it of its phase current"},
    {"solenoid", false, ColumnKind::flag, "1 = energised = spring released"},
    {"clutch_travel_m", false, ColumnKind::quantity, "travel of the clutch's cable"},
    {"bus_voltage_v", false, ColumnKind::quantity, "voltage of the drive's supply"},
    {"motor_temp_c", false, ColumnKind::quantity, "temperature of the motor, degrees Celsius"},
}};

inline constexpr std::array<ColumnInfo, 5> kRailCarriageColumns{{
    {"time_s", true, ColumnKind::time, "time since any instant, increasing"},
    {"height_m", true, ColumnKind::quantity, "height of the carriage"},
    {"velocity_mps", false, ColumnKind::quantity, "vertical velocity as the machine derived it"},
    {"contact", false, ColumnKind::flag, "1 = the carriage touches its stop"},
    {"force_n", false, ColumnKind::quantity, "force of the stop on the carriage, up positive"},
}};

inline constexpr std::array<ColumnInfo, 6> kMotorAxisColumns{{
    {"time_s", true, ColumnKind::time, "time since any instant, increasing"},
    {"position_m", true, ColumnKind::quantity, "position of the axis"},
    {"velocity_mps", false, ColumnKind::quantity, "velocity as the machine derived it"},
    {"reference_m", false, ColumnKind::quantity, "position that the axis was told to follow"},
    {"force_n", true, ColumnKind::quantity, "force commanded to the drive in this row"},
    {"voltage_v", false, ColumnKind::quantity, "control voltage of the drive"},
}};

inline constexpr std::array<ColumnInfo, 6> kRotaryJointColumns{{
    {"time_s", true, ColumnKind::time, "time since any instant, increasing"},
    {"angle_rad", true, ColumnKind::quantity, "angle of the joint, 0 hanging down"},
    {"velocity_radps", false, ColumnKind::quantity, "angular velocity as the machine derived it"},
    {"torque_nm", true, ColumnKind::quantity, "torque that the drive reports"},
    {"torque_cmd_nm", false, ColumnKind::quantity, "torque commanded to the drive in this row"},
    {"torque_enable", false, ColumnKind::flag, "1 = the drive is switched on"},
}};

inline constexpr std::array<ColumnInfo, 6> kClutchBenchColumns{{
    {"time_s", true, ColumnKind::time, "time since any instant, increasing"},
    {"pulley_angle_rad", true, ColumnKind::quantity, "angle of the pulley"},
    {"solenoid", true, ColumnKind::flag, "1 = energised = spring released"},
    {"load_n", false, ColumnKind::quantity, "force on the cable"},
    {"current_a", false, ColumnKind::quantity, "current of the solenoid"},
    {"voltage_v", false, ColumnKind::quantity, "voltage of the solenoid"},
}};

/// Columns of a rig with named joints: "angle_<joint>_rad" is prefix "angle_" and unit "rad". Without a unit it is of a foot.
struct ColumnPattern {
  std::string_view prefix, unit;
  ColumnInfo info;  ///< its name as in the documentation

  /// The joint's name, or nothing.
  constexpr std::string_view joint_in(std::string_view column) const {
    const std::size_t around = prefix.size() + unit.size() + (unit.empty() ? 0 : 1);
    if (column.size() <= around || !column.starts_with(prefix) || !column.ends_with(unit)) return {};
    if (!unit.empty() && column[column.size() - unit.size() - 1] != '_') return {};
    return column.substr(prefix.size(), column.size() - around);
  }
};

/// The longer prefix first: torque_cmd_ before torque_.
inline constexpr std::array<ColumnPattern, 11> kTreeColumns{{
    {"angle_cmd_",
     "rad",
     {"angle_cmd_<joint>_rad", false, ColumnKind::quantity, "set point of the drive's position law"}},
    {"angle_", "rad", {"angle_<joint>_rad", false, ColumnKind::quantity, "angle of the joint"}},
    {"velocity_",
     "radps",
     {"velocity_<joint>_radps", false, ColumnKind::quantity, "angular velocity as the machine derived it"}},
    {"torque_cmd_",
     "nm",
     {"torque_cmd_<joint>_nm", false, ColumnKind::quantity, "torque commanded to the drive"}},
    {"torque_", "nm", {"torque_<joint>_nm", false, ColumnKind::quantity, "torque that the drive reports"}},
    {"position_cmd_",
     "m",
     {"position_cmd_<joint>_m", false, ColumnKind::quantity, "set point of a prismatic joint"}},
    {"position_", "m", {"position_<joint>_m", false, ColumnKind::quantity, "position of a prismatic joint"}},
    {"velocity_",
     "mps",
     {"velocity_<joint>_mps", false, ColumnKind::quantity, "velocity of a prismatic joint"}},
    {"force_cmd_",
     "n",
     {"force_cmd_<joint>_n", false, ColumnKind::quantity, "force commanded to a prismatic joint's drive"}},
    {"force_",
     "n",
     {"force_<joint>_n", false, ColumnKind::quantity, "force that a prismatic joint's drive reports"}},
    {"contact_", "", {"contact_<foot>", false, ColumnKind::flag, "1 = the foot stands on the ground"}},
}};

inline constexpr std::array<ColumnInfo, 1> kTreeFixedColumns{{
    {"time_s", true, ColumnKind::time, "time since any instant, increasing"},
}};

struct MachineType {
  std::string_view name;
  std::span<const ColumnInfo> columns;  ///< in the order of the contract, in which logs are written
  std::span<const ColumnPattern> patterns = {};

  constexpr const ColumnInfo* column(std::string_view column_name) const {
    for (const ColumnInfo& c : columns)
      if (c.name == column_name) return &c;
    for (const ColumnPattern& p : patterns)
      if (!p.joint_in(column_name).empty()) return &p.info;
    return nullptr;
  }
};

inline constexpr std::array<MachineType, 6> kMachineTypes{{
    {"hopper", kHopperColumns},
    {"rail_carriage", kRailCarriageColumns},
    {"motor_axis", kMotorAxisColumns},
    {"rotary_joint", kRotaryJointColumns},
    {"clutch_bench", kClutchBenchColumns},
    {"tree", kTreeFixedColumns, kTreeColumns},
}};

constexpr const MachineType* machine_type_named(std::string_view name) {
  for (const MachineType& r : kMachineTypes)
    if (r.name == name) return &r;
  return nullptr;
}

}  // namespace furcula::log
