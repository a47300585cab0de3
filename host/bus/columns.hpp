// Which signals of a bus become which columns of a log furcula-log/1, and how a frame's value comes into a row.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/bus/answers.hpp"
#include "host/bus/nodes.hpp"

namespace furcula::bus {

enum class Join : std::uint8_t {
  hold,  ///< a command, where a row is a tick of who sends it: from the row in which it was sent on, until the next one
  acting,  ///< a command: the mean of what acted from the row to the next; of a whole number, what acted longest
  tick,  ///< measured once a tick: of the row in which its frame came; of a lost one, on the line between its neighbours
  between,  ///< measured at its frame's stamp: on the line between the frames before and behind the row
  step,     ///< a switch that is told now and then: a change is in the middle of the two frames around it
};

struct Column {
  std::string name;
  std::string node, message, signal;
  double scale = 1.0, offset = 0.0;  ///< column = scale * signal + offset
  Join join = Join::between;
  bool required = true;  ///< else it is left out where no frame has it
};

/// The board tells now and then what it makes of a column's signal: its scale and offset follow from both.
struct Calibration {
  std::string column;
  std::string node, message, signal;  ///< what the board tells
  std::vector<std::string> torques;   ///< columns whose scale is then 1 / that of `column`
};

/// A log of a bus: its columns, and the message of which each is a row.
struct ChannelPermutation {
  std::string rig;
  std::vector<Column> columns;
  std::vector<Calibration> calibrations;
  std::string tick_node, tick_message;
  std::string drive_node;            ///< commands of 0 where it is switched off
  bool only_while_on = false;        ///< rows with this drive off are left out: somebody holds the robot
  std::vector<Answer> answers = {};  ///< of the columns' messages, as the recording tells
};

/// A robot's joint and the drive at it.
struct JointDrive {
  std::string joint, node;
  double ratio = 1.0;  ///< joint angle = motor angle / ratio; negative: it turns the other way round
};

/// `JOINT=NODE` or `JOINT=NODE:RATIO`. @throws core::DataError
JointDrive parse_joint(std::string_view text);

/// `NAME=NODE.MESSAGE.SIGNAL`, then perhaps `*SCALE` and `+OFFSET` or `-OFFSET`. @throws core::DataError
Column parse_column(std::string_view text, const std::vector<NodeMessage>& messages);

/// The columns of a rig: of a hopper those of furculad's bus, of a rotary_joint or a tree those of its drives, and of any rig
/// the `extra` ones, which take the place of one with the same name. @throws core::DataError: no such rig or node, nothing to make rows of.
ChannelPermutation arrange(std::string_view rig, const std::vector<Node>& nodes,
                           const std::vector<JointDrive>& joints, const std::vector<Column>& extra);

}  // namespace furcula::bus
