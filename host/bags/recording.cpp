// Bags in memory, see recording.hpp.
#include "host/bags/recording.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "host/bags/compression.hpp"
#include "host/bags/json_message.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

constexpr std::uint64_t kMostNumbers = 500'000'000;  // 4 GB
constexpr std::size_t kMostStreams = 64;             // of a topic

}  // namespace

bool is_joint_state(const Channel& channel) { return short_type(channel.type) == "sensor_msgs/JointState"; }

void Recording::set_up(Topic& topic, Source& source) {
  const Channel& c = topic.channel;
  source.json = c.message_encoding == "json";
  if (source.json) return;
  if (c.message_encoding != "cdr") {
    topic.trouble =
        "its messages have the encoding " + core::quoted(c.message_encoding) + "; expected cdr or json";
    return;
  }
  const bool text = c.schema_encoding == "ros2msg" && !c.definition.empty();
  try {
    if (text || !built_in_definition(c.type).empty())
      source.cdr.emplace(
          parse_definition(text ? std::string_view(c.definition) : built_in_definition(c.type), c.type));
    else if (!c.schema_encoding.empty())
      topic.trouble = "its type is described as " + core::quoted(c.schema_encoding) + "; expected ros2msg";
    else
      topic.trouble = "the bag does not store what " + core::quoted(c.type) +
                      " consists of: write it anew as MCAP, with ros2 bag convert";
  } catch (const core::DataError& e) {
    topic.trouble = e.what();
  }
}

std::size_t Recording::channel(const Channel& channel) {
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const Channel& c = topics[i].channel;
    if (c.topic == channel.topic && c.type == channel.type && c.message_encoding == channel.message_encoding)
      return i;
  }
  topics.push_back({});
  sources_.push_back({});
  topics.back().channel = channel;
  topics.back().joint_states = is_joint_state(channel);
  set_up(topics.back(), sources_.back());
  sources_.back().kept = topics.back().trouble.empty() && keeps_(channel);
  return topics.size() - 1;
}

std::string Recording::decode(const Source& source, std::string_view data, std::vector<std::string>* names) {
  if (source.json) return decode_json(data, decoded_, names);
  std::string why = source.cdr->decode(data, decoded_);
  if (why.empty() && names != nullptr) *names = source.cdr->names(data);
  return why;
}

void Recording::message(std::size_t channel, std::int64_t log_ns, std::string_view data) {
  Topic& topic = topics[channel];
  Source& source = sources_[channel];
  ++topic.messages;
  if (!topic.trouble.empty() || (!source.kept && source.named)) return;
  std::string why;
  // Of compression message by message.
  if (is_zstd(data)) {
    if (unzstd(data, kLargestPart, unpacked_) != Decompressed::whole) why = "it does not decompress (zstd)";
    data = unpacked_;
  }
  if (!source.kept) {
    std::vector<std::string> names;
    if (why.empty() && decode(source, data, &names).empty()) {
      topic.first_names = std::move(names);
      source.named = true;
    }
    return;
  }
  if (why.empty()) why = decode(source, data, nullptr);
  Place* place = why.empty() ? place_of(topic, source, data, why) : nullptr;
  if (place == nullptr) {
    if (topic.unread++ == 0)
      topic.first_unread = "its message " + std::to_string(topic.messages) + ": " + why;
    return;
  }
  Stream& stream = topic.streams[place->stream];
  numbers_ += stream.names.size() + 2;
  if (numbers_ > kMostNumbers)
    throw core::DataError(
        name_ + ": it has more than " + std::to_string(kMostNumbers) +
        " numbers in the topics that are read; expected fewer: split it, or name the columns that are "
        "needed in a map (--map)");
  stream.log_ns.push_back(std::clamp<std::int64_t>(log_ns, 0, kLatest_ns));
  stream.stamp_ns.push_back(decoded_.stamp_ns);
  if (place->from.empty())
    stream.values.insert(stream.values.end(), decoded_.values.begin(), decoded_.values.end());
  else
    for (const std::size_t i : place->from)
      stream.values.push_back(i == kNone ? std::numeric_limits<double>::quiet_NaN() : decoded_.values[i]);
}

Recording::Place* Recording::place_of(Topic& topic, Source& source, std::string_view data, std::string& why) {
  const auto fits = [&](const Place& p) { return p.form == decoded_.form && p.texts == decoded_.texts; };
  // Texts beside names of joints are no part of it.
  if (!topic.joint_states) decoded_.texts.clear();
  if (source.last < source.places.size() && fits(source.places[source.last]))
    return &source.places[source.last];
  for (std::size_t i = 0; i < source.places.size(); ++i)
    if (fits(source.places[i])) {
      source.last = i;
      return &source.places[i];
    }
  if (source.places.size() >= kMostStreams) {
    why = "it has other lengths or names than the " + std::to_string(kMostStreams) + " forms before it";
    return nullptr;
  }
  Place place;
  place.form = decoded_.form;
  place.texts = decoded_.texts;
  std::vector<std::string> names;
  why = decode(source, data, &names);
  if (!topic.joint_states) decoded_.texts.clear();
  if (topic.joint_states) {
    why = joint_place(topic, names, place);
    if (!why.empty()) return nullptr;
  } else {
    place.stream = topic.streams.size();
    topic.streams.push_back({std::move(names), {}, {}, {}, {}});
  }
  source.last = source.places.size();
  source.places.push_back(std::move(place));
  return &source.places.back();
}

std::string Recording::joint_place(Topic& topic, const std::vector<std::string>& names, Place& place) const {
  std::vector<std::string> joints;
  for (std::size_t at = 0; at < decoded_.texts.size();) {
    const std::size_t end = decoded_.texts.find('\0', at);
    joints.push_back(decoded_.texts.substr(at, end - at));
    at = end + 1;
  }
  if (joints.empty()) return "it has no names of joints";
  std::vector<std::string> sorted = joints;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    return "it has the joint " + core::quoted(*twice) + " twice";
  static constexpr const char* kFields[kOfJoint] = {"position", "velocity", "effort"};
  std::array<std::size_t, kOfJoint> first{}, count{};
  for (std::size_t k = 0; k < kOfJoint; ++k) {
    const std::string begin = std::string(kFields[k]) + "[";
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i].starts_with(begin) && count[k]++ == 0) first[k] = i;
    if (count[k] != 0 && count[k] != joints.size())
      return "it has " + std::to_string(joints.size()) + " names and " + std::to_string(count[k]) +
             " numbers in " + kFields[k] + "; expected as many, or none";
  }
  const auto known = std::find_if(topic.streams.begin(), topic.streams.end(),
                                  [&](const Stream& s) { return s.joints == sorted; });
  place.stream = static_cast<std::size_t>(known - topic.streams.begin());
  for (const std::string& joint : sorted) {
    const auto i = static_cast<std::size_t>(std::find(joints.begin(), joints.end(), joint) - joints.begin());
    for (std::size_t k = 0; k < kOfJoint; ++k) place.from.push_back(count[k] == 0 ? kNone : first[k] + i);
  }
  if (known != topic.streams.end()) return {};
  Stream stream;
  for (const std::string& joint : sorted)
    for (const char* field : kFields) stream.names.push_back(joint + "/" + field);
  stream.joints = std::move(sorted);
  topic.streams.push_back(std::move(stream));
  return {};
}

}  // namespace furcula::bags
