// What columns seem to be by their names.
#include "host/mapping/names.hpp"

#include <catch2/catch.hpp>
#include <numbers>

using namespace furcula;
using mapping::Role;

TEST_CASE(
    "names of ROS, moteus, ODrive and hand-made logs say quantity, joint, unit, and whether it is a command") {
  struct Case {
    std::string column;
    Role role;
    std::string joint, unit;
    bool command = false;
  };
  const std::vector<Case> cases{
      {"joint1_pos", Role::position, "joint_1", ""},
      {"position[shoulder]", Role::position, "shoulder", ""},
      {"/joint_states/elbow/position", Role::position, "joint_elbow", ""},
      {"q1", Role::position, "1", ""},
      {"qd1", Role::velocity, "1", ""},
      {"tau_2", Role::effort, "2", ""},
      {"elbow_angle [deg]", Role::position, "elbow", "deg"},
      {"elbow torque (N m)", Role::effort, "elbow", "nm"},
      {"trq_elbow_mNm", Role::effort, "elbow", "mnm"},
      {"des_tau_elbow", Role::effort, "elbow", "", true},
      {"servo_stats.1.position", Role::position, "1", "turns"},
      {"servo_stats.1.q_current", Role::current, "1", ""},
      {"servo_stats.1.d_current", Role::other, "", ""},
      {"axis0.encoder.pos_estimate", Role::position, "axis_0", "turns"},
      {"axis0.encoder.vel_estimate", Role::velocity, "axis_0", ""},
      {"axis0.motor.torque_estimate", Role::effort, "axis_0", ""},
      {"axis0.controller.input_torque", Role::effort, "axis_0", "", true},
      {"axis0.motor.current_control.Iq_measured", Role::current, "axis_0", ""},
      {"header.stamp.nanosec", Role::time, "", "nanosec"},
      {"Time [ms]", Role::time, "", "ms"},
      {"timestamp", Role::time, "", ""},
      {"motor_temperature", Role::other, "", ""},
      {"", Role::other, "", ""},
      {"\"'=[]()", Role::other, "", ""},
  };
  for (const Case& c : cases) {
    INFO(c.column);
    const mapping::Meaning m = mapping::meaning_of(c.column);
    CHECK(m.role == c.role);
    CHECK(m.command == c.command);
    if (c.role == Role::other) continue;
    CHECK(m.unit == c.unit);
    if (c.role != Role::time) CHECK(m.joint == c.joint);
  }
  CHECK(mapping::si_of(Role::position, "turns", false) == Approx(2.0 * std::numbers::pi));
  CHECK(mapping::si_of(Role::position, "mm", true) == Approx(1e-3));
  CHECK(mapping::si_of(Role::position, "mm", false) == 0.0);
}
