// Columns of a log, see columns.hpp.
#include "host/bus/columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/machine_types.hpp"

namespace furcula::bus {
namespace {

using core::DataError;
using core::quoted;

const Node* first_of(const std::vector<Node>& nodes, Protocol protocol) {
  const auto found =
      std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.protocol == protocol; });
  return found == nodes.end() ? nullptr : &*found;
}

const Node& needed(const std::vector<Node>& nodes, Protocol protocol) {
  const Node* node = first_of(nodes, protocol);
  if (node == nullptr)
    throw DataError("a hopper's log needs a node of the protocol " + std::string(name_of(protocol)) +
                    "; add it with --node NAME=" + std::string(name_of(protocol)) + ":ID");
  return *node;
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size() ||
      !std::isfinite(value))
    return std::nullopt;
  return value;
}

ChannelPermutation hopper(const std::vector<Node>& nodes, const std::vector<JointDrive>& joints) {
  if (joints.size() > 1)
    throw DataError("--joint: a hopper has one drive; expected one at most, or --machine tree");
  const Node& rail = needed(nodes, Protocol::encoder);
  const Node& board = needed(nodes, Protocol::controller);
  std::string drive = joints.empty() ? needed(nodes, Protocol::mini_cheetah).name : joints[0].node;
  const double ratio = joints.empty() ? 1.0 : joints[0].ratio;
  ChannelPermutation a{"hopper", {}, {}, rail.name, "Sample", drive, true};
  a.columns = {{"height_m", rail.name, "Sample", "Count", 1.0, 0.0, Join::tick},
               {"leg_angle_rad", drive, "Reply", "Position", 1.0 / ratio, 0.0, Join::tick, false},
               {"contact", board.name, "Leg_State", "Contact", 1.0, 0.0, Join::step},
               {"torque_cmd_nm", drive, "Command", "Torque", ratio, 0.0, Join::hold},
               {"torque_nm", drive, "Reply", "Torque", ratio, 0.0, Join::tick, false},
               {"solenoid", board.name, "Leg_State", "Solenoid", 1.0, 0.0, Join::step, false}};
  a.calibrations = {{"height_m", board.name, "Body_State", "Height", {}}};
  if (joints.empty())
    a.calibrations.push_back(
        {"leg_angle_rad", board.name, "Leg_State", "Leg_Angle", {"torque_cmd_nm", "torque_nm"}});
  return a;
}

/// The four columns of a joint; `suffix` is "" or "_NAME".
void add_joint(ChannelPermutation& a, const Node& node, const JointDrive& j, const std::string& middle) {
  const bool odrive = node.protocol == Protocol::odrive;
  const double turn = odrive ? 2.0 * std::numbers::pi : 1.0;
  const std::string measured = odrive ? "Get_Encoder_Estimates" : "Reply";
  a.columns.push_back(
      {"angle" + middle + "_rad", node.name, measured, "Position", turn / j.ratio, 0.0, Join::between});
  a.columns.push_back({"velocity" + middle + "_radps", node.name, measured, "Velocity", turn / j.ratio, 0.0,
                       Join::between, false});
  a.columns.push_back({"torque" + middle + "_nm", node.name, odrive ? "Get_Torques" : "Reply",
                       odrive ? "Torque_Estimate" : "Torque", j.ratio, 0.0, Join::between, false});
  a.columns.push_back({"torque_cmd" + middle + "_nm", node.name, odrive ? "Set_Input_Torque" : "Command",
                       "Torque", j.ratio, 0.0, Join::acting, false});
}

void add_joints(ChannelPermutation& a, const std::vector<Node>& nodes,
                const std::vector<JointDrive>& joints) {
  if (joints.empty())
    throw DataError("a " + a.rig + " needs its drives; add " +
                    (a.rig == "tree" ? "--joint JOINT=NODE for each joint" : "--joint angle=NODE"));
  for (const JointDrive& j : joints) {
    const auto node =
        std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.name == j.node; });
    std::vector<std::string_view> names;
    for (const Node& n : nodes) names.push_back(n.name);
    if (node == nodes.end())
      throw DataError("--joint: no node " + quoted(j.node) + "; expected one of " + core::listed(names) +
                      ", or another --node" + core::did_you_mean(j.node, names));
    if (node->protocol != Protocol::mini_cheetah && node->protocol != Protocol::odrive)
      throw DataError("--joint: node " + quoted(j.node) + " is of the protocol " +
                      std::string(name_of(node->protocol)) + "; expected a drive, mini_cheetah or odrive");
    add_joint(a, *node, j, a.rig == "tree" ? "_" + j.joint : "");
  }
}

}  // namespace

JointDrive parse_joint(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string where = "--joint " + quoted(text) + ": ";
  if (equals == text.npos || equals == 0 || equals + 1 == text.size())
    throw DataError(where + "expected JOINT=NODE, or JOINT=NODE:RATIO");
  JointDrive j{std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
  if (const std::size_t colon = j.node.find(':'); colon != j.node.npos) {
    const std::optional<double> ratio = number(std::string_view(j.node).substr(colon + 1));
    if (!ratio || *ratio == 0.0)
      throw DataError(where + "ratio " + quoted(j.node.substr(colon + 1)) +
                      "; expected turns of the motor for one of the joint, negative where it is reversed");
    j.ratio = *ratio;
    j.node.resize(colon);
  }
  return j;
}

Column parse_column(std::string_view text, const std::vector<NodeMessage>& messages) {
  const std::string where = "--column " + quoted(text) + ": ";
  const std::size_t equals = text.find('=');
  if (equals == text.npos || equals == 0)
    throw DataError(where + "expected NAME=NODE.MESSAGE.SIGNAL, then perhaps *SCALE and +OFFSET");
  Column c;
  c.name = text.substr(0, equals);
  if (c.name.find_first_of(",\"# \t\r\n") != c.name.npos || c.name == "time_s")
    throw DataError(where + "column " + quoted(c.name) + "; expected a name as height_m");
  std::string_view rest = text.substr(equals + 1);
  const std::size_t end = std::min(rest.find_first_of("*+-"), rest.size());
  const std::string_view path = rest.substr(0, end);
  rest.remove_prefix(end);
  if (rest.starts_with('*')) {
    std::size_t n = 1;
    while (n < rest.size() &&
           ((rest[n] != '+' && rest[n] != '-') || n == 1 || rest[n - 1] == 'e' || rest[n - 1] == 'E'))
      ++n;
    const std::optional<double> scale = number(rest.substr(1, n - 1));
    if (!scale || *scale == 0.0)
      throw DataError(where + "scale " + quoted(rest.substr(1, n - 1)) + "; expected a number other than 0");
    c.scale = *scale;
    rest.remove_prefix(n);
  }
  if (!rest.empty()) {
    const std::optional<double> offset = number(rest);
    if (!offset) throw DataError(where + "offset " + quoted(rest) + "; expected a number");
    c.offset = *offset;
  }
  const std::size_t first = path.find('.'), second = path.find('.', std::min(first, path.size() - 1) + 1);
  if (path.empty() || first == path.npos || second == path.npos)
    throw DataError(where + quoted(path) + "; expected NODE.MESSAGE.SIGNAL");
  c.node = path.substr(0, first);
  c.message = path.substr(first + 1, second - first - 1);
  c.signal = path.substr(second + 1);
  std::vector<std::string> known;
  for (const NodeMessage& m : messages)
    for (const Signal& s : m.signals) {
      known.push_back(m.node->name + "." + std::string(m.message->name) + "." + std::string(s.name));
      if (m.node->name != c.node || m.message->name != c.message || s.name != c.signal) continue;
      const bool flag = s.width == 1;
      c.join = m.message->sender != Sender::node ? Join::hold : flag ? Join::step : Join::between;
      return c;
    }
  const std::vector<std::string_view> names(known.begin(), known.end());
  throw DataError(where + "no signal " + quoted(path) + " (see furcula bus docs, and --node)" +
                  core::did_you_mean(path, names));
}

ChannelPermutation arrange(std::string_view rig, const std::vector<Node>& nodes,
                           const std::vector<JointDrive>& joints, const std::vector<Column>& extra) {
  const log::MachineType* info = log::machine_type_named(rig);
  if (info == nullptr) {
    std::vector<std::string_view> names;
    for (const log::MachineType& r : log::kMachineTypes) names.push_back(r.name);
    throw DataError("no machine type " + quoted(rig) + "; expected one of " + core::listed(names) +
                    core::did_you_mean(rig, names));
  }
  ChannelPermutation a;
  if (rig == "hopper") {
    a = hopper(nodes, joints);
  } else {
    a.rig = rig;
    if (rig == "rotary_joint" && joints.size() > 1)
      throw DataError("--joint: a rotary_joint has one drive; expected one, or --machine tree");
    if (!joints.empty() || ((rig == "tree" || rig == "rotary_joint") && extra.empty()))
      add_joints(a, nodes, joints);
    if (a.columns.empty() && extra.empty())
      throw DataError("the columns of a " + a.rig +
                      " are not known; add them with --column NAME=NODE.MESSAGE.SIGNAL");
  }
  for (const Column& c : extra) {
    std::erase_if(a.columns, [&](const Column& old) { return old.name == c.name; });
    std::erase_if(a.calibrations, [&](const Calibration& old) { return old.column == c.name; });
    a.columns.push_back(c);
    if (rig != "hopper" && c.join == Join::hold) a.columns.back().join = Join::acting;
    // The tick's own message gives its values to their row.
    if (c.node == a.tick_node && c.message == a.tick_message) a.columns.back().join = Join::tick;
  }
  for (const log::ColumnInfo& required : info->columns) {
    if (!required.required || required.kind == log::ColumnKind::time) continue;
    const auto found = std::find_if(a.columns.begin(), a.columns.end(),
                                    [&](const Column& c) { return c.name == required.name; });
    if (found == a.columns.end())
      throw DataError("a " + a.rig + " needs the column " + std::string(required.name) + "; add --column " +
                      std::string(required.name) + "=NODE.MESSAGE.SIGNAL");
    found->required = true;
  }
  if (a.tick_message.empty()) {
    const auto measured = std::find_if(a.columns.begin(), a.columns.end(),
                                       [](const Column& c) { return c.join == Join::between; });
    if (measured == a.columns.end())
      throw DataError("no column is of what a node measures; add one with --column NAME=NODE.MESSAGE.SIGNAL");
    a.tick_node = measured->node;
    a.tick_message = measured->message;
    for (Column& c : a.columns)
      if (c.node == a.tick_node && c.message == a.tick_message) c.join = Join::tick;
  }
  return a;
}

}  // namespace furcula::bus
