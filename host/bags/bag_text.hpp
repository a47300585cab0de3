// A bag as the text of a log (furcula-log/1, docs/contracts.md): topics joined on one clock, a row a message.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/byte_source.hpp"

namespace furcula::bags {

/// What is wanted of a bag.
struct Request {
  std::string topic;  ///< whose messages give the rows; empty: it is chosen
  std::vector<std::string>
      columns;              ///< that a map names, as the bag's: "/imu/angular_velocity/x", "angle_elbow_rad"
  std::string map;          ///< its path, for messages
  bool all_topics = false;  ///< all that have numbers, not only joint states and what the map names
  bool joints_alone = false;  ///< without joint states and columns that a map names it is refused
};

/// A log, or what is a bag as the text of one.
struct Opened {
  std::unique_ptr<core::ByteSource> text;
  std::vector<std::string> notes;  ///< what was joined, interpolated and left out, in sentences
  bool bag = false;
  bool joint_states = false;  ///< the bag's columns are those of rig tree
};

/// Opens what `path` names: a directory or file of a bag is read whole and joined, anything else is handed on as it is. `what` says what was
/// expected, as in core::FileSource.
///
/// The joints of sensor_msgs/msg/JointState become angle_<joint>_rad, velocity_<joint>_radps and torque_<joint>_nm. All other numbers
/// have their topic and path as a name; those are there that `request` names. Rows are the messages of the topic with the most of them. The others
/// are interpolated between the messages around a row, commands and flags are held from one message to the next. Time is the header's stamp,
/// of messages without one when they were recorded.
/// @throws core::DataError naming file and byte, topic and message, and what to do.
Opened open_log(const std::string& path, std::string_view what, const Request& request);

/// The same of bytes; `name` stands for the path in messages.
Opened open_log(core::ByteSource& source, const std::string& name, const Request& request);

}  // namespace furcula::bags
