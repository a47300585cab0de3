// What a reader of bags hands on: channels, then their messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace furcula::bags {

/// A topic as one writer recorded it.
struct Channel {
  std::string topic;
  std::string type;  ///< "sensor_msgs/msg/JointState"; a name without a fixed form where messages are JSON
  std::string message_encoding;  ///< "cdr", "json", ...
  std::string schema_encoding;   ///< "ros2msg", "jsonschema", ...; empty: there is no schema
  std::string definition;        ///< the schema; empty: none is stored
};

class Sink {
 public:
  virtual ~Sink() = default;
  /// The number of a channel; of one that is known the number that it has.
  virtual std::size_t channel(const Channel& channel) = 0;
  /// A message as it was recorded, in the order of the file. `log_ns`: when it was recorded, since the epoch. The bytes live during the call.
  virtual void message(std::size_t channel, std::int64_t log_ns, std::string_view data) = 0;
  /// What is odd about the file and does not keep it from being read, a sentence.
  virtual void note(std::string sentence) = 0;
};

}  // namespace furcula::bags
