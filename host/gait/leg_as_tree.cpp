#include "host/gait/leg_as_tree.hpp"

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::gait {
namespace {

using core::shortest;

/// `moment_kgm2` about the axis that the leg turns about; about the others, what a slender link has.
std::string link(const std::string& name, double mass_kg, double com_m, double moment_kgm2) {
  const std::string moment = shortest(moment_kgm2), least = shortest(0.1 * moment_kgm2);
  return "  <link name=\"" + name + "\">\n    <inertial>\n      <origin xyz=\"0 0 " + shortest(-com_m) +
         "\"/>\n      <mass value=\"" + shortest(mass_kg) + "\"/>\n      <inertia ixx=\"" + moment +
         "\" ixy=\"0\" ixz=\"0\" iyy=\"" + moment + "\" iyz=\"0\" izz=\"" + least +
         "\"/>\n    </inertial>\n  </link>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, double below_m, const std::string& axis, double damping,
                  double lower, double upper) {
  return "  <joint name=\"" + name + "\" type=\"" + type + "\">\n    <parent link=\"" + parent +
         "\"/>\n    <child link=\"" + child + "\"/>\n    <origin xyz=\"0 0 " + shortest(-below_m) +
         "\"/>\n    <axis xyz=\"" + axis + "\"/>\n    <limit lower=\"" + shortest(lower) + "\" upper=\"" +
         shortest(upper) + "\" effort=\"0\" velocity=\"0\"/>\n    <dynamics damping=\"" + shortest(damping) +
         "\"/>\n  </joint>\n";
}

}  // namespace

LegAsTree leg_as_tree(const Machine& machine) {
  const auto& p = machine.leg;
  // A slide must carry something; the torso is a point.
  constexpr double kPoint_kgm2 = 1e-6, kCart_kg = 1e-6;
  LegAsTree out;
  out.urdf = "<?xml version=\"1.0\"?>\n<robot name=\"planar_leg\">\n  <link name=\"ground\"/>\n" +
             link("boom", kCart_kg, 0.0, kPoint_kgm2) +
             link("torso", p.mass_kg - p.thigh_mass_kg - p.shank_mass_kg, 0.0, kPoint_kgm2) +
             link("thigh", p.thigh_mass_kg, p.thigh_com_m, p.thigh_inertia_kgm2) +
             link("shank", p.shank_mass_kg, p.shank_com_m, p.shank_inertia_kgm2) +
             joint("boom_travel", "prismatic", "ground", "boom", 0.0, "1 0 0", 0.0, -1e3, 1e3) +
             joint("boom_height", "prismatic", "boom", "torso", 0.0, "0 0 1", 0.0, -1e3, 1e3) +
             joint("hip", "revolute", "torso", "thigh", 0.0, "0 -1 0", p.hip_damping_nmspr, machine.least.hip,
                   machine.most.hip) +
             joint("knee", "revolute", "thigh", "shank", p.thigh_length_m, "0 -1 0", p.knee_damping_nmspr,
                   machine.least.knee, machine.most.knee) +
             "</robot>\n";
  out.model =
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"" + std::string(kLegUrdf) +
      "\"\ngravity_mps2 = [0.0, 0.0, " + core::toml_float(-p.gravity_mps2) +
      "]\n\n[drive.boom_travel]\ncontrol_mode = \"none\"\n\n[drive.boom_height]\ncontrol_mode = \"none\"\n";
  if (machine.spring != LegSpring::none) {
    out.model += "\n[spring.knee]\nstiffness_nmprad = " + core::toml_float(p.stiffness_nmprad) + "\n";
    out.model += machine.spring == LegSpring::switched
                     ? "rest = \"touch_down\"\n"
                     : "rest_rad = " + core::toml_float(p.rest_angle_rad) + "\n";
  }
  out.model +=
      "\n[foot.toe]\nlink = \"shank\"\npoint_m = [0.0, 0.0, " + core::toml_float(-p.shank_length_m) + "]\n";
  return out;
}

}  // namespace furcula::gait
