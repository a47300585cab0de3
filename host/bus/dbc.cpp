// DBC files, see dbc.hpp. Vector, "DBC File Format Documentation" 1.0.5: messages, signals, SIG_VALTYPE_ (1:
// IEEE float), BO_TX_BU_ (further transmitters), CM_.
#include "host/bus/dbc.hpp"

#include <algorithm>
#include <cstdio>

#include "host/bus/numbers.hpp"

namespace furcula::bus {
namespace {

constexpr std::string_view kNobody = "Vector__XXX";

std::string controller_of(const std::vector<Node>& nodes) {
  for (const Node& n : nodes)
    if (n.protocol == Protocol::controller) return n.name;
  return std::string(kNobody);
}

std::string sender_of(const NodeMessage& m, const std::string& controller) {
  switch (m.message->sender) {
    case Sender::host:
      return "Host";
    case Sender::controller:
      return controller;
    case Sender::node:
      return m.node->name;
  }
  return std::string(kNobody);
}

std::string receiver_of(const NodeMessage& m, const std::string& controller) {
  if (m.message->sender != Sender::node) return m.node->name;
  return m.message->protocol == Protocol::controller ? "Host" : controller;
}

std::string signal_line(const Signal& s, const std::string& name, const std::string& receiver) {
  const bool is_real = s.encoding == Encoding::real;
  return " SG_ " + name + " : " + std::to_string(s.start_bit) + "|" + std::to_string(s.width) + "@" +
         (s.order == ByteOrder::little ? "1" : "0") + (s.encoding == Encoding::unsigned_integer ? "+" : "-") +
         " (" + decimal(factor(s)) + "," + decimal(static_cast<double>(s.offset)) + ") [" +
         (is_real ? "0|0" : decimal(lowest(s)) + "|" + decimal(highest(s))) + "] \"" + std::string(s.unit) +
         "\" " + receiver + "\n";
}

struct Text {
  std::string messages, transmitters, comments, value_types;

  void head(std::uint32_t id, const std::string& name, std::uint8_t size, const std::string& sender,
            const std::string& comment) {
    messages += "BO_ " + std::to_string(id) + " " + name + ": " + std::to_string(size) + " " + sender + "\n";
    comments += "CM_ BO_ " + std::to_string(id) + " \"" + comment + "\";\n";
  }
  // `selector`: " M" or " m1" of a multiplexed message.
  void signal(std::uint32_t id, const Signal& s, const std::string& name, const std::string& selector,
              const std::string& receiver) {
    messages += signal_line(s, name + selector, receiver);
    comments += "CM_ SG_ " + std::to_string(id) + " " + name + " \"" + std::string(s.meaning) + "\";\n";
    if (s.encoding == Encoding::real)
      value_types += "SIG_VALTYPE_ " + std::to_string(id) + " " + name + " : 1;\n";
  }
};

void add_replies(Text& text, const std::vector<const NodeMessage*>& replies, const std::string& controller) {
  if (replies.empty()) return;
  const std::uint32_t id = replies.front()->id;
  std::uint8_t size = 0;
  std::string senders;
  for (const NodeMessage* m : replies) {
    size = std::max(size, m->size);
    senders += (senders.empty() ? "" : ",") + m->node->name;
  }
  text.head(id, "Motor_Reply", size, replies.front()->node->name,
            std::string(replies.front()->message->meaning));
  if (replies.size() > 1) text.transmitters += "BO_TX_BU_ " + std::to_string(id) + " : " + senders + ";\n";
  text.signal(id, replies.front()->signals.front(), "Motor_Id", " M", controller);
  for (const NodeMessage* m : replies)
    for (std::size_t i = 1; i < m->signals.size(); ++i)
      text.signal(id, m->signals[i], m->node->name + "_" + std::string(m->signals[i].name),
                  " m" + std::to_string(m->node->id), controller);
  text.messages += "\n";
}

}  // namespace

std::string to_dbc(const std::vector<Node>& nodes) {
  const std::string controller = controller_of(nodes);
  std::string names = "Host";
  for (const Node& n : nodes) names += " " + n.name;

  Text text;
  const std::vector<NodeMessage> all = messages_of(nodes);
  std::vector<const NodeMessage*> replies;
  std::string markers;
  for (const NodeMessage& m : all) {
    if (m.message->marker != 0) {
      char byte[4];
      std::snprintf(byte, sizeof byte, "%02X", static_cast<unsigned>(m.message->marker));
      markers += " Seven bytes FF and then " + std::string(byte) + ": " + std::string(m.message->name) + ".";
      continue;
    }
    if (m.message->rule == IdRule::fixed) {
      replies.push_back(&m);
      continue;
    }
    text.head(m.id, m.name, m.size, sender_of(m, controller), std::string(m.message->meaning) + markers);
    markers.clear();
    for (const Signal& s : m.signals)
      text.signal(m.id, s, std::string(s.name), "", receiver_of(m, controller));
    text.messages += "\n";
  }
  add_replies(text, replies, controller);
  return "VERSION \"furcula " + std::to_string(kProtocolVersion) +
         "\"\n\nNS_ :\n\tCM_\n\tSIG_VALTYPE_\n\tBO_TX_BU_\n\nBS_:\n\nBU_: " + names + "\n\n" + text.messages +
         text.transmitters + text.comments + text.value_types;
}

}  // namespace furcula::bus
