// A model as Python holds it, of one of three families: machines with one joint, trees, the biped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/model/model.hpp"
#include "host/trees/model.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::python {

struct Model {
  std::string path;  ///< for messages; the URDF lies beside it
  std::string text;  ///< of the model file
  std::string urdf;  ///< its text, where it is no file
  bool accept_inertias = false;

  std::optional<model::Model> machine;
  std::optional<trees::TreeModel> tree;
  std::optional<walk::Model> biped;
  /// Of a tree, and of the biped on a floating base: bodies, rotors and damping, for the dynamics as functions of arrays.
  std::optional<model::RobotModel> dynamics;
  std::vector<std::string> joints;  ///< of `dynamics`, in the order of its arrays
  std::string kind;                 ///< as in the model file

  /// The rig of its logs.
  std::string rig() const { return machine ? std::string(dynamics::info(machine->kind).rig) : "tree"; }
};

/// A model file, or a robot (URDF, MJCF): a tree; the drives of a URDF are told torques.
/// @throws core::DataError
Model load_model(const std::string& path, bool accept_inertias);

/// The same of a model file's text; `path` stands for it in messages, and its URDF is beside it unless `urdf` is its text.
Model parse_model(const std::string& text, const std::string& path, const std::string& urdf,
                  bool accept_inertias);

/// The tree again, its joints by what the logs have columns of.
trees::TreeModel tree_for(const Model& model, std::vector<std::string> columns);

}  // namespace furcula::python
