// Writes the messages of a bus as a DBC file, which other tools decode recordings with.
#pragma once

#include <string>
#include <vector>

#include "host/bus/nodes.hpp"

namespace furcula::bus {

/// The text of the file. Messages that a marker alone tells from another of the same id (the mini-cheetah's
/// special frames) are comments on that other one; the replies of all mini-cheetah drives are one message
/// with the motor's id as its multiplexor, because they share an id.
std::string to_dbc(const std::vector<Node>& nodes);

}  // namespace furcula::bus
