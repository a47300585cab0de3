// Which joints move where a model file does not say so, and which column of a recording is which joint's: by the names that a URDF and a log use.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/urdf.hpp"

namespace furcula::trees {

struct TreeModel;

struct JointChoice {
  std::vector<std::string> moving;            ///< empty: model::default_joints
  std::map<std::string, std::string> logged;  ///< of joints that the log calls otherwise: its name for them
  std::map<std::string, std::string> held;    ///< of joints that could move, and why they do not
  std::vector<std::string> notes;
  std::string
      map_lines;  ///< of joints that no column is found of: what a map file could say; empty: nothing is near
};

/// `wanted` are the joints of the model file, empty where it names none; `columns` those of all recordings, empty where there are none. A joint
/// has a column "angle_NAME_rad", a prismatic one "position_NAME_m". Where it has none, the log's name is taken that is alike (joint_names.hpp), if
/// just one is, and of just this joint. A joint that several names are like, or whose name is like that of another joint, moves without a column:
/// reading a recording then asks for it, with the lines of a map file.
JointChoice choose_joints(const model::Urdf& robot, const std::vector<std::string>& wanted,
                          const std::map<std::string, double>& hold, const std::vector<std::string>& columns);

/// Of joints that are held though the recordings have a column of their position: where they are, and what to write.
std::vector<std::string> notes_on_held(const TreeModel& model, const std::vector<const log::Log*>& logs);

}  // namespace furcula::trees
