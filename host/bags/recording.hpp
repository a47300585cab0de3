// The messages of a bag in memory, as numbers: 8 bytes a number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/bags/cdr.hpp"
#include "host/bags/decoded.hpp"
#include "host/bags/sink.hpp"

namespace furcula::bags {

/// Messages of a topic that have the same numbers; of joint states those of the same joints, in whatever order.
struct Stream {
  std::vector<std::string> names;   ///< paths of the numbers: "data[0]"; of joint states "elbow/position"
  std::vector<std::string> joints;  ///< of joint states, sorted; three names each
  std::vector<std::int64_t> log_ns;
  std::vector<std::int64_t> stamp_ns;  ///< 0: none
  std::vector<double> values;          ///< message by message; NaN: the message does not say

  std::size_t messages() const { return log_ns.size(); }
  double at(std::size_t message, std::size_t name) const { return values[message * names.size() + name]; }
};

/// What of a joint a joint state has, in the order of Stream::names.
inline constexpr std::size_t kOfJoint = 3;  // position, velocity, effort

struct Topic {
  Channel channel;
  bool joint_states = false;
  std::uint64_t messages = 0;
  std::vector<Stream> streams;
  std::string trouble;                   ///< why none of its messages can be read; empty: they can
  std::uint64_t unread = 0;              ///< messages that could not be read
  std::string first_unread;              ///< the first of them, and why
  std::vector<std::string> first_names;  ///< of its first message, whether it is kept or not
};

class Recording final : public Sink {
 public:
  /// `name` stands for the bag in messages. `keeps`: whether messages of the topic are kept, or only counted.
  Recording(std::string name, std::function<bool(const Channel&)> keeps)
      : name_(std::move(name)), keeps_(std::move(keeps)) {}

  std::size_t channel(const Channel& channel) override;
  void message(std::size_t channel, std::int64_t log_ns, std::string_view data) override;
  void note(std::string sentence) override { notes.push_back(std::move(sentence)); }

  std::vector<Topic> topics;
  std::vector<std::string> notes;

 private:
  /// How the last message's numbers go to their stream.
  struct Place {
    std::size_t stream = 0;
    std::vector<std::uint32_t> form;
    std::string texts;
    std::vector<std::size_t>
        from;  ///< of joint states: for each name the number among the message's, or kNone
  };
  struct Source {
    std::optional<CdrDecoder> cdr;
    bool json = false, kept = false, named = false;
    std::vector<Place> places;
    std::size_t last = 0;
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  static void set_up(Topic& topic, Source& source);
  std::string decode(const Source& source, std::string_view data, std::vector<std::string>* names);
  Place* place_of(Topic& topic, Source& source, std::string_view data, std::string& why);
  std::string joint_place(Topic& topic, const std::vector<std::string>& names, Place& place) const;

  std::string name_;
  std::function<bool(const Channel&)> keeps_;
  std::vector<Source> sources_;
  std::string unpacked_;
  Decoded decoded_;
  std::uint64_t numbers_ = 0;
};

/// Whether it is sensor_msgs/msg/JointState.
bool is_joint_state(const Channel& channel);

}  // namespace furcula::bags
