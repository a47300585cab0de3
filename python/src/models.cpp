#include "python/src/models.hpp"

#include <pybind11/pybind11.h>

#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/gait/leg_as_tree.hpp"
#include "host/gait/machine_file.hpp"
#include "host/model/reader.hpp"
#include "host/model/writer.hpp"
#include "python/src/bindings.hpp"

namespace furcula::python {
namespace {

/// The kind that a model file names; empty where it is no TOML or names none: its reader then says what is wrong.
std::string kind_of(const std::string& text, const std::string& path) {
  try {
    return core::parse_toml(text, path)["model"]["kind"].value_or(std::string());
  } catch (const core::DataError&) {
    return {};
  }
}

/// The biped on a floating base: three sliding joints along the world's axes, then yaw, pitch and roll, all without mass, under the pelvis.
void make_biped_dynamics(Model& out) {
  namespace tree = dynamics::tree;
  const dynamics::biped::Description& d = out.biped->robot;
  model::RobotModel& m = out.dynamics.emplace();
  m.gravity_mps2 = dynamics::biped::gravity_on_slope<double>(d.gravity_mps2, d.slope_x_rad, d.slope_y_rad);
  const tree::Mat3<double> straight{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  const tree::Vec3<double> axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  const auto body = [](const dynamics::biped::LinkDescription& l) {
    return tree::inertia_of(l.mass_kg, l.centre_m, l.about_centre_kgm2);
  };
  const auto add = [&](const std::string& name, int parent, tree::JointKind kind,
                       const tree::Vec3<double>& at_m, std::size_t axis, const tree::Inertia<double>& b) {
    if (m.add({parent, kind}, {straight, at_m}, axes[axis], b) != Status::ok)
      throw core::DataError(out.path + ": the biped's joint " + name + " cannot be added");
    out.joints.push_back(name);
  };
  const tree::Inertia<double> none{};
  const tree::Vec3<double> here{0.0, 0.0, 0.0};
  add("base_x", -1, tree::JointKind::prismatic, here, 0, none);
  add("base_y", 0, tree::JointKind::prismatic, here, 1, none);
  add("base_z", 1, tree::JointKind::prismatic, here, 2, none);
  add("base_yaw", 2, tree::JointKind::revolute, here, 2, none);
  add("base_pitch", 3, tree::JointKind::revolute, here, 1, none);
  add("base_roll", 4, tree::JointKind::revolute, here, 0, body(d.pelvis));
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t j = 0; j < dynamics::biped::kLegJoints; ++j) {
      const auto& link = d.legs[side][j];
      add((side == 0 ? "left_" : "right_") + std::string(dynamics::biped::kLegJointNames[j]),
          j == 0 ? 5 : static_cast<int>(m.count()) - 1, tree::JointKind::revolute, link.offset_m,
          static_cast<std::size_t>(dynamics::biped::DesignTopology::kAxes[j]), body(link));
      m.laws[m.count() - 1].armature_kgm2 = d.drives[side][j].armature_kgm2;
      m.laws[m.count() - 1].damping_nmspr = d.drives[side][j].damping_nmspr;
    }
}

void make_tree_dynamics(Model& out) {
  const trees::TreeModel& tree = *out.tree;
  model::RobotModel& m = out.dynamics.emplace(tree.robot.model);
  m.gravity_mps2 = tree.gravity_mps2;
  for (std::size_t i = 0; i < tree.joints(); ++i) {
    m.laws[i].armature_kgm2 = tree.drives[i].rotor_inertia_kgm2;
    m.laws[i].damping_nmspr = tree.drives[i].damping_nmspr;
    if (const trees::Spring& spring = tree.springs[i]; spring.both_ways)
      m.laws[i].stiffness_nmprad = spring.stiffness_nmprad, m.laws[i].rest_rad = spring.rest_rad;
    out.joints.push_back(tree.robot.joints[i].name);
  }
}

trees::TreeModel read_tree(const Model& m, std::vector<std::string> columns) {
  trees::TreeContext context{m.urdf, std::move(columns), m.accept_inertias};
  if (!gait::is_planar_leg(m.text)) return trees::parse_tree_model(m.text, m.path, context);
  const gait::LegAsTree leg = gait::leg_as_tree(gait::parse_machine(m.text, m.path));
  context.urdf = leg.urdf;
  return trees::parse_tree_model(leg.model, m.path, context);
}

pybind11::dict parameters_of(const Model& m) {
  pybind11::dict out;
  if (m.machine) {
    const auto infos = dynamics::info(m.machine->kind).parameters;
    for (std::size_t i = 0; i < infos.size(); ++i)
      out[pybind11::str(std::string(infos[i].name))] = m.machine->parameters[i];
  }
  if (m.tree)
    for (std::size_t j = 0; j < m.tree->joints(); ++j)
      for (std::size_t k = 0; k < trees::kDriveParameters.size(); ++k)
        out[pybind11::str(std::string(trees::kDriveParameters[k]) + "." + m.tree->robot.joints[j].name)] =
            m.tree->drives[j].*trees::kDriveMembers[k];
  return out;
}

/// The model file as it has to be in a folder, and the robot file beside it where that is none of its own.
pybind11::dict files_for(const Model& m, const std::string& name, const std::string& folder) {
  pybind11::dict out;
  std::string text = m.machine ? model::format_model(*m.machine) : m.text;
  if (m.tree && !gait::is_planar_leg(m.text)) {
    text = trees::format_tree_model(*m.tree, trees::urdf_seen_from(*m.tree, folder));
    if (!m.tree->urdf_text.empty()) out[path_of(m.tree->urdf_path)] = text_of(m.tree->urdf_text);
  }
  out[path_of(name)] = text_of(text);
  return out;
}

}  // namespace

Model parse_model(const std::string& text, const std::string& path, const std::string& urdf,
                  bool accept_inertias) {
  Model out;
  out.path = path;
  out.text = text;
  out.urdf = urdf;
  out.accept_inertias = accept_inertias;
  out.kind = kind_of(text, path);
  if (out.kind == "biped") {
    out.biped = walk::read_model(path);
    make_biped_dynamics(out);
  } else if (gait::is_planar_leg(text) || trees::is_tree(text)) {
    if (out.kind.empty()) out.kind = "tree";  // a robot itself
    out.tree = read_tree(out, {});
    make_tree_dynamics(out);
  } else {
    out.machine = model::parse_model(text, path);
  }
  return out;
}

Model load_model(const std::string& path, bool accept_inertias) {
  return parse_model(core::read_small_file(path, "a model file (TOML) or a robot (URDF, MJCF)"), path, "",
                     accept_inertias);
}

trees::TreeModel tree_for(const Model& model, std::vector<std::string> columns) {
  return read_tree(model, std::move(columns));
}

void add_models(py::module_& module) {
  py::class_<Model>(module, "Model")
      .def_property_readonly("path", [](const Model& m) { return path_of(m.path); })
      .def_readonly("kind", &Model::kind)
      .def_property_readonly("machine", &Model::rig)
      .def_readonly("joints", &Model::joints)
      .def_property_readonly("parameters", parameters_of)
      .def_property_readonly(
          "notes", [](const Model& m) { return m.tree ? m.tree->notes : std::vector<std::string>{}; })
      .def("to_toml", [](const Model& m) { return m.machine ? model::format_model(*m.machine) : m.text; })
      .def("_files_for", files_for)
      .def("__repr__",
           [](const Model& m) { return text_of("<furcula.Model " + m.kind + " of " + m.path + ">"); });
  module.def("load_model", load_model);
  module.def("parse_model", [](const std::string& text, const std::string& path, const std::string& urdf,
                               bool accept_inertias) {
    if (kind_of(text, path) == "biped")
      throw core::DataError(path + ": a model of kind biped is read from its file; expected load_model");
    return parse_model(text, path, urdf, accept_inertias);
  });
}

}  // namespace furcula::python
