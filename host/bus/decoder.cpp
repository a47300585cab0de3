// Decoding, see decoder.hpp.
#include "host/bus/decoder.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "host/bus/numbers.hpp"

namespace furcula::bus {
namespace {

std::string value_text(const Frame& frame, const Signal& s, std::uint32_t raw) {
  char text[40];
  if (s.encoding == Encoding::real)
    return {text, std::to_chars(text, text + sizeof text, get(frame, s).value()).ptr};
  // Whole numbers as they are: counters and flags need all of their digits.
  std::snprintf(text, sizeof text, s.span == s.counts ? "%.0f" : "%.9g", physical(s, raw));
  return text;
}

std::string id_text(const Frame& frame) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%0*X", frame.extended ? 8 : 3, static_cast<unsigned>(frame.id));
  return text;
}

template <typename Counts>
std::string listed(const Counts& counts, std::size_t most) {
  std::string out;
  std::size_t n = 0;
  for (const auto& [id, count] : counts) {
    if (n++ == most) return out + ", and " + std::to_string(counts.size() - most) + " more";
    out += (out.empty() ? "" : ", ") + id + " (" + std::to_string(count) + ")";
  }
  return out;
}

template <typename Counts>
std::uint64_t total(const Counts& counts) {
  std::uint64_t sum = 0;
  for (const auto& [id, count] : counts) sum += count;
  return sum;
}

}  // namespace

Decoder::Decoder(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
  check_nodes(nodes_);
  messages_ = messages_of(nodes_);
}

void Undecoded::count_id(Counts& counts, const LogFrame& frame) {
  const std::string id = id_text(frame.frame);
  const auto known = counts.find(id);
  if (known != counts.end())
    ++known->second;
  else
    ++counts[counts.size() < kMostIds ? id : "others"];
}

void Undecoded::count(const LogFrame& in, const std::vector<NodeMessage>& messages) {
  const Frame& frame = in.frame;
  if (in.error || frame.remote || in.longer) {
    ++(in.error ? error_ : in.longer ? longer_ : remote_);
    return;
  }
  const bool id_known = std::any_of(messages.begin(), messages.end(), [&](const NodeMessage& m) {
    // Who a message of a shared id is from stands in its first byte.
    const bool same_node = m.message->rule != IdRule::fixed || frame.size == 0 || frame.data[0] == m.node->id;
    return m.id == frame.id && !frame.extended && same_node;
  });
  count_id(id_known ? wrong_length_ : unknown_, in);
}

void Decoder::decode(const LogFrame& in, std::string& rows) {
  const Frame& frame = in.frame;
  const auto found = std::find_if(messages_.begin(), messages_.end(), [&](const NodeMessage& m) {
    return !in.error && !in.longer && is(frame, *m.message, m.node->id);
  });
  if (found == messages_.end()) {
    undecoded_.count(in, messages_);
    return;
  }
  ++decoded_;
  char time[40];
  // Nanoseconds where they are there.
  const auto whole_s = static_cast<long long>(in.time_ns / 1'000'000'000),
             part_ns = static_cast<long long>(in.time_ns % 1'000'000'000);
  if (part_ns % 1000 == 0)
    std::snprintf(time, sizeof time, "%lld.%06lld", whole_s, part_ns / 1000);
  else
    std::snprintf(time, sizeof time, "%lld.%09lld", whole_s, part_ns);
  // Quotes and commas in an interface's name: CSV's rules.
  std::string interface = in.interface;
  if (interface.find_first_of(",\"") != interface.npos) {
    for (std::size_t i = 0; (i = interface.find('"', i)) != interface.npos; i += 2)
      interface.insert(i, 1, '"');
    interface = '"' + interface + '"';
  }
  const std::string before = std::string(time) + "," + interface + "," + found->name + ",";
  if (found->signals.empty()) rows += before + ",,\n";
  for (const Signal& s : found->message->signals) {
    const Signal ranged = with_range(s, info(found->node->motor));
    const Result<std::uint32_t> raw = get_raw(frame, ranged);
    if (!raw.ok()) continue;  // beyond the end of a shorter form of the message
    rows += before + std::string(s.name) + "," + value_text(frame, ranged, raw.value()) + "," +
            std::string(s.unit) + "\n";
  }
}

std::string Undecoded::remarks() const {
  std::string out;
  const auto add = [&](std::uint64_t n, const std::string& what) {
    if (n != 0) out += std::to_string(n) + (n == 1 ? " frame " : " frames ") + what + "\n";
  };
  constexpr std::size_t kListed = 10;
  add(total(unknown_), "of ids that no message has: " + listed(unknown_, kListed));
  add(total(wrong_length_),
      "of a length that their message does not have: " + listed(wrong_length_, kListed));
  add(longer_, "of CAN FD, not decoded");
  add(remote_, "asking for data (remote)");
  add(error_, "reporting an error of the bus");
  return out;
}

}  // namespace furcula::bus
