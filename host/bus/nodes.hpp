// The nodes of one bus, and each one's messages: the table of messages with ids, names and ranges filled in.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/bus/messages.hpp"
#include "furcula/bus/motors.hpp"

namespace furcula::bus {

struct Node {
  std::string name;
  Protocol protocol;
  std::uint8_t id;
  Motor motor = Motor::mini_cheetah;  ///< of mini_cheetah nodes
};

struct NodeMessage {
  std::string name;  ///< "<node>_<message>"
  const Message* message;
  const Node* node;
  std::uint32_t id;
  std::uint8_t size;            ///< bytes that this node sends
  std::vector<Signal> signals;  ///< in the range of the node's motor
};

std::string_view name_of(Protocol protocol);

/// The robot of this project with one of each: a board, a motor, an ODrive axis, a height encoder.
std::vector<Node> usual_nodes();

/// `NAME=PROTOCOL:ID`, for a mini_cheetah drive `NAME=mini_cheetah:ID:MOTOR`. @throws core::DataError
Node parse_node(std::string_view text);

/// @throws core::DataError: two nodes of one name, or of one protocol and id.
void check_nodes(const std::vector<Node>& nodes);

/// In the order of the nodes and of the table. The nodes must outlive what is returned.
std::vector<NodeMessage> messages_of(const std::vector<Node>& nodes);

}  // namespace furcula::bus
