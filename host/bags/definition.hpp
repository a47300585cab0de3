// The form of a ROS 2 message, from the text that a bag stores (schema encoding "ros2msg") or from the types that are built in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::bags {

enum class FieldType : std::uint8_t {
  i8,
  u8,
  i16,
  u16,
  i32,
  u32,
  i64,
  u64,
  f32,
  f64,
  boolean,
  text,
  wide_text,
  message
};

struct Field {
  enum class Count : std::uint8_t { one, fixed, sequence };

  std::string name;
  FieldType type = FieldType::f64;
  Count count = Count::one;
  std::uint32_t fixed = 0;  ///< how many, of Count::fixed
  std::size_t message = 0;  ///< which of Definition::messages, of FieldType::message
};

struct MessageForm {
  std::string type;  ///< "sensor_msgs/JointState"
  std::vector<Field> fields;
};

/// The first message is that of the topic; the others are those that it consists of.
struct Definition {
  std::vector<MessageForm> messages;
};

/// From the text of a .msg file, behind which those of the types in it follow, each below a line of '=' and a line "MSG: package/Type".
/// @throws core::DataError saying which line or type is wrong.
Definition parse_definition(std::string_view text, const std::string& type);

/// The text of a type that bags need not store (sensor_msgs/JointState, sensor_msgs/Imu, std_msgs/Float64MultiArray and what they consist
/// of); empty: it is none of them.
std::string_view built_in_definition(std::string_view type);

/// "sensor_msgs/msg/JointState" and "sensor_msgs/JointState" as the latter.
std::string short_type(std::string_view type);

}  // namespace furcula::bags
