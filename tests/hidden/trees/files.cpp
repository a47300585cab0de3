// A case's folder: robot, model, logs and the truth.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/hidden/trees/cases.hpp"

namespace furcula::hidden::trees {

namespace {

std::string key(const std::string& label, double value) {
  char line[200];
  std::snprintf(line, sizeof line, "%s = %#.10g\n", label.c_str(), value);
  return line;
}

std::string free_damping(const Case& c, std::size_t from) {
  std::string out = "\n[free]\n";
  char line[200];
  for (std::size_t j = from; j < c.visible(); ++j) {
    std::snprintf(line, sizeof line, "\"damping_nmspr.%s\" = [0.0, %#.4g]\n", c.robot.joints[j].name.c_str(),
                  5 * c.model[j].damping_nmspr);
    out += line;
  }
  return out;
}

std::string model_of_a_robot(const Case& c) {
  std::string toml =
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\nbase = \"fixed\"\njoints = [";
  for (std::size_t j = 0; j < c.visible(); ++j)
    toml += (j > 0 ? ", \"" : "\"") + c.robot.joints[j].name + "\"";
  toml += "]\ngravity_mps2 = [0.0, 0.0, -9.81]\n\n[drive]\ncontrol_mode = \"";
  toml += c.lab.position_control ? "position\"\n" : "torque\"\n";
  for (std::size_t j = 0; j < c.visible(); ++j) {
    const DriveData& d = c.model[j];
    toml += "\n[drive." + c.robot.joints[j].name + "]\n";
    if (c.lab.position_control) toml += key("kp_nmprad", d.kp_nmprad) + key("kd_nmsprad", d.kd_nmsprad);
    toml += key("rotor_inertia_kgm2", d.rotor_kgm2) + key("damping_nmspr", d.damping_nmspr);
  }
  if (c.free_damping) toml += free_damping(c, 0);
  for (std::size_t j = 0; j < c.visible(); ++j)
    if (c.model[j].friction_nm > 0)
      toml += "\n[effect.coulomb_friction." + c.robot.joints[j].name + "]\n" +
              key("torque_nm", c.model[j].friction_nm);
  return toml;
}

std::string model_of_a_leg(const Case& c) {
  const Leg& leg = *c.robot.leg;
  std::string toml = "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n";
  for (std::size_t j = 0; j < c.visible(); ++j) {
    const Joint& joint = c.robot.joints[j];
    const DriveData& d = c.model[j];
    toml +=
        "\n[drive." + joint.name + "]\ncontrol_mode = \"" + (joint.prismatic ? "none" : "torque") + "\"\n";
    if (!joint.prismatic || d.damping_nmspr > 0) toml += key("damping_nmspr", d.damping_nmspr);
    if (!joint.prismatic) toml += key("rotor_inertia_kgm2", d.rotor_kgm2);
  }
  toml += "\n[spring." + c.robot.joints[leg.knee].name + "]\n" + key("stiffness_nmprad", leg.spring_nmprad);
  toml += leg.switched ? "rest = \"touch_down\"\n" : key("rest_rad", leg.rest_rad);
  char point[200];
  std::snprintf(point, sizeof point, "point_m = [%#.10g, %#.10g, %#.10g]\n", leg.toe_m.x, leg.toe_m.y,
                leg.toe_m.z);
  toml += "\n[foot.toe]\nlink = \"" + leg.link + "\"\n" + point;
  if (c.free_damping) toml += free_damping(c, leg.hip);
  return toml;
}

}  // namespace

std::vector<std::string> write_case(const Case& c, const std::string& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/robot.urdf") << urdf_of(c.robot, c.visible());

  std::ofstream(folder + "/model.toml") << (c.robot.leg ? model_of_a_leg(c) : model_of_a_robot(c));

  char line[200];
  const Machine truth = c.truth();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < c.logs.size(); ++i) {
    std::snprintf(line, sizeof line, "log_%02zu.csv", i);
    names.emplace_back(line);
    std::ofstream(folder + "/" + line)
        << log_of(truth, c.lab, c.logs[i], c.visible(), Random(c.question.seed * 1000 + i));
  }

  nlohmann::ordered_json json;
  json["tier"] = name(c.question.tier);
  json["seed"] = c.question.seed;
  json["form"] = c.robot.form;
  json["law"] = c.lab.position_control ? "position" : "torque";
  json["rate_hz"] = c.lab.rate_hz;
  json["jitter"] = c.lab.jitter;
  json["free_damping"] = c.free_damping;
  json["held_out"] =
      std::vector<std::string>(names.end() - static_cast<std::ptrdiff_t>(c.held_out), names.end());
  json["planted"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < c.planted.size(); ++i)
    json["planted"].push_back({{"effect", c.planted[i].effect},
                               {"at", c.planted[i].at},
                               {"parameters", c.planted[i].parameters},
                               {"shows", c.shows[i]}});
  if (c.robot.leg) {
    json["spring"] = c.robot.leg->switched ? "switched" : "parallel";
    json["switch_late_s"] = c.lab.switch_late_s;
    json["ground_scatter_m"] = c.lab.ground_m;
    json["redrawn"] = {{"logs", c.redrawn_logs}, {"cases", c.redrawn}};
  }
  for (std::size_t j = 0; j < c.visible(); ++j) {
    if (c.robot.leg && c.robot.joints[j].prismatic) {
      json["true_damping_nspm"][c.robot.joints[j].name] = c.drives[j].damping_nmspr;
      json["disturbance_n"][c.robot.joints[j].name] = c.lab.disturbance_nm[j];
      continue;
    }
    json["true_damping_nmspr"][c.robot.joints[j].name] = c.drives[j].damping_nmspr;
    json["rms_torque_nm"][c.robot.joints[j].name] = c.lab.rms_nm[j];
    json["disturbance_nm"][c.robot.joints[j].name] = c.lab.disturbance_nm[j];
  }
  std::ofstream(folder + "/truth.json") << json.dump(2) << "\n";
  return names;
}

}  // namespace furcula::hidden::trees
