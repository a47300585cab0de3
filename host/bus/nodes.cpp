// Nodes of a bus, see nodes.hpp.
#include "host/bus/nodes.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "furcula/bus/codec.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

constexpr std::array<std::string_view, 5> kProtocols{"mini_cheetah", "odrive", "encoder", "controller",
                                                     "walker"};
// "<node>_Get_Bus_Voltage_Current" is then within the 32 characters of a name in a DBC file.
constexpr std::size_t kLongestName = 8;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view take(std::string_view& rest, char end) {
  const std::size_t at = std::min(rest.find(end), rest.size());
  const std::string_view part = rest.substr(0, at);
  rest.remove_prefix(std::min(at + 1, rest.size()));
  return part;
}

}  // namespace

std::string_view name_of(Protocol protocol) { return kProtocols[static_cast<std::size_t>(protocol)]; }

std::vector<Node> usual_nodes() {
  return {{"Board", Protocol::controller, 1},
          {"Knee", Protocol::mini_cheetah, 1, Motor::ak80_9},
          {"Axis", Protocol::odrive, 2},
          {"Rail", Protocol::encoder, 1}};
}

Node parse_node(std::string_view text) {
  const std::string where = "node " + core::quoted(text) + ": ";
  std::string_view rest = text;
  const std::string_view name = take(rest, '=');
  if (name.empty() || name.size() > kLongestName || !is_letter(name.front()) ||
      !std::all_of(name.begin(), name.end(), [](char c) { return is_letter(c) || is_digit(c) || c == '_'; }))
    throw core::DataError(
        where + "name " + core::quoted(name) +
        "; expected NAME=PROTOCOL:ID with a name of a letter and up to 7 more letters, digits, _");
  if (name == "Host")
    throw core::DataError(where +
                          "`Host` is the name of the host, which sends commands; expected another name");
  const std::string_view protocol = take(rest, ':');
  const auto* const known = std::find(kProtocols.begin(), kProtocols.end(), protocol);
  if (known == kProtocols.end())
    throw core::DataError(where + "no protocol " + core::quoted(protocol) + "; expected one of " +
                          core::listed(kProtocols) + core::did_you_mean(protocol, kProtocols));
  Node node{std::string(name), static_cast<Protocol>(known - kProtocols.begin()), 0};
  const std::string_view id = take(rest, ':');
  const char* const end = id.data() + id.size();
  if (const auto read = std::from_chars(id.data(), end, node.id);
      id.empty() || read.ec != std::errc() || read.ptr != end || node.id < kFirstNode || node.id > kLastNode)
    throw core::DataError(where + "id " + core::quoted(id) + "; expected a whole number from 1 to 31");
  if (node.protocol != Protocol::mini_cheetah) {
    if (!rest.empty()) throw core::DataError(where + core::quoted(rest) + " after the id; expected nothing");
    return node;
  }
  std::vector<std::string_view> names;
  for (const MotorInfo& m : kMotors) {
    names.push_back(m.name);
    if (m.name == rest) {
      node.motor = m.motor;
      return node;
    }
  }
  throw core::DataError(where + "no motor " + core::quoted(rest) + "; expected one of " +
                        core::listed(names) + core::did_you_mean(rest, names));
}

void check_nodes(const std::vector<Node>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Node &a = nodes[k], &b = nodes[i];
      if (a.name == b.name)
        throw core::DataError("node " + core::quoted(b.name) + " is there twice; expected names that differ");
      if (a.protocol == b.protocol && a.id == b.id)
        throw core::DataError("nodes " + core::quoted(a.name) + " and " + core::quoted(b.name) +
                              " are both " + std::string(name_of(b.protocol)) + " " + std::to_string(b.id) +
                              "; expected ids that differ");
    }
}

std::vector<NodeMessage> messages_of(const std::vector<Node>& nodes) {
  std::vector<NodeMessage> all;
  for (const Node& node : nodes)
    for (const Message* m : kMessages) {
      if (m->protocol != node.protocol) continue;
      NodeMessage& out = all.emplace_back();
      out.name = node.name + "_" + std::string(m->name);
      out.message = m;
      out.node = &node;
      out.id = id_of(*m, node.id);
      out.size = m == &message::kMotorReply ? info(node.motor).reply_bytes : m->size;
      for (const Signal& s : m->signals)
        if (bytes_to_end(s) <= out.size) out.signals.push_back(with_range(s, info(node.motor)));
    }
  return all;
}

}  // namespace furcula::bus
