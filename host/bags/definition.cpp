// Forms of ROS 2 messages, see definition.hpp. Source: "Interface definition", docs.ros.org; the schema's text: mcap.dev/spec/registry.
#include "host/bags/definition.hpp"

#include <array>
#include <charconv>
#include <map>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

constexpr std::size_t kMostMessages = 1000;
constexpr std::size_t kMostFields = 10000;
constexpr int kDeepest = 32;

constexpr std::array<std::pair<std::string_view, FieldType>, 15> kTypes{{
    {"bool", FieldType::boolean},
    {"byte", FieldType::u8},
    {"char", FieldType::u8},
    {"int8", FieldType::i8},
    {"uint8", FieldType::u8},
    {"int16", FieldType::i16},
    {"uint16", FieldType::u16},
    {"int32", FieldType::i32},
    {"uint32", FieldType::u32},
    {"int64", FieldType::i64},
    {"uint64", FieldType::u64},
    {"float32", FieldType::f32},
    {"float64", FieldType::f64},
    {"string", FieldType::text},
    {"wstring", FieldType::wide_text},
}};

// From the packages builtin_interfaces, std_msgs, geometry_msgs and sensor_msgs of ROS 2, without comments.
constexpr std::string_view kHeader =
    "\n===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
constexpr std::string_view kJointState =
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort";
constexpr std::string_view kImu =
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
    "===\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"
    "===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z";
constexpr std::string_view kMultiArray =
    "std_msgs/MultiArrayLayout layout\nfloat64[] data\n"
    "===\nMSG: std_msgs/MultiArrayLayout\nstd_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"
    "===\nMSG: std_msgs/MultiArrayDimension\nstring label\nuint32 size\nuint32 stride\n";

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t\r");
  if (begin == rest.npos) {
    rest = {};
    return {};
  }
  rest.remove_prefix(begin);
  const std::size_t end = rest.find_first_of(" \t\r");
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(word.size());
  return word;
}

/// "[]", "[<=8]" or "[8]" behind a type, taken off it.
bool take_count(std::string_view& type, Field& field) {
  if (!type.ends_with(']')) return true;
  const std::size_t open = type.rfind('[');
  if (open == type.npos) return false;
  const std::string_view inside = type.substr(open + 1, type.size() - open - 2);
  type = type.substr(0, open);
  field.count = Field::Count::sequence;
  if (inside.empty() || inside.starts_with("<=")) return true;
  field.count = Field::Count::fixed;
  const auto read = std::from_chars(inside.data(), inside.data() + inside.size(), field.fixed);
  return read.ec == std::errc() && read.ptr == inside.data() + inside.size();
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& type) : type_(type) { split(text); }

  Definition parse() {
    add(short_type(type_), 0);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw core::DataError("the definition of " + core::quoted(type_) + " " + what +
                          "; expected the text of a .msg file (ros2 interface show)");
  }

  void split(std::string_view text) {
    std::string name = short_type(type_);
    std::string_view body = text;
    std::size_t line = 0;
    const auto close = [&](std::size_t end) { texts_.emplace(name, body.substr(0, end)); };
    while (line < body.size()) {
      const std::size_t end = std::min(body.find('\n', line), body.size());
      if (body.substr(line, 3) != "===") {
        line = end + 1;
        continue;
      }
      close(line);
      body.remove_prefix(std::min(end + 1, body.size()));
      const std::size_t next = std::min(body.find('\n'), body.size());
      std::string_view head = body.substr(0, next);
      if (next_word(head) != "MSG:") fail("has no line \"MSG: package/Type\" below a line of '='");
      name = short_type(next_word(head));
      body.remove_prefix(std::min(next + 1, body.size()));
      line = 0;
    }
    close(body.size());
  }

  std::size_t add(const std::string& type, int depth) {
    if (depth > kDeepest) fail("goes deeper than 32 messages");
    if (const auto known = known_.find(type); known != known_.end()) {
      if (known->second.second) fail("has " + core::quoted(type) + ", which contains itself");
      return known->second.first;
    }
    auto text = texts_.find(type);
    std::string_view body;
    if (text != texts_.end())
      body = text->second;
    else if (const std::string_view built_in = built_in_definition(type); !built_in.empty())
      body = built_in.substr(0, built_in.find("==="));
    else
      fail("lacks the type " + core::quoted(type));
    const std::size_t index = out_.messages.size();
    if (index >= kMostMessages) fail("has more than 1000 types");
    out_.messages.push_back({type, {}});
    known_[type] = {index, true};
    std::vector<Field> fields;
    while (!body.empty()) {
      const std::size_t end = std::min(body.find('\n'), body.size());
      take_line(body.substr(0, end), type, depth, fields);
      body.remove_prefix(std::min(end + 1, body.size()));
    }
    // What a message without fields has on the wire.
    if (fields.empty()) fields.push_back({"structure_needs_at_least_one_member", FieldType::u8, {}, 0, 0});
    out_.messages[index].fields = std::move(fields);
    known_[type].second = false;
    return index;
  }

  void take_line(std::string_view line, const std::string& of, int depth, std::vector<Field>& fields) {
    std::string_view rest = line;
    std::string_view type = next_word(rest);
    if (type.empty() || type.starts_with('#')) return;
    std::string_view name = next_word(rest);
    if (const std::size_t comment = name.find('#'); comment != name.npos) name = name.substr(0, comment);
    if (name.empty()) fail("has the line " + core::quoted(line));
    // A constant: NAME=value, NAME =value.
    if (name.find('=') != name.npos) return;
    if (std::string_view more = rest; next_word(more).starts_with('=')) return;
    if (++fields_ > kMostFields) fail("has more than 10000 fields");
    Field field;
    field.name = name;
    if (!take_count(type, field)) fail("has the line " + core::quoted(line));
    if (const std::size_t bound = type.find("<="); bound != type.npos) type = type.substr(0, bound);
    for (const auto& [word, is] : kTypes)
      if (type == word) {
        field.type = is;
        fields.push_back(std::move(field));
        return;
      }
    std::string nested = type == "Header" ? "std_msgs/Header" : short_type(type);
    if (nested.find('/') == nested.npos) nested = of.substr(0, of.find('/') + 1) + nested;
    field.type = FieldType::message;
    field.message = add(nested, depth + 1);
    fields.push_back(std::move(field));
  }

  const std::string& type_;
  std::map<std::string, std::string_view> texts_;
  std::map<std::string, std::pair<std::size_t, bool>> known_;  ///< index, and whether it is not complete yet
  Definition out_;
  std::size_t fields_ = 0;
};

}  // namespace

std::string short_type(std::string_view type) {
  std::string out(type);
  if (const std::size_t at = out.find("/msg/"); at != out.npos) out.erase(at, 4);
  return out;
}

std::string_view built_in_definition(std::string_view type) {
  static const auto kAll = [] {
    const auto joined = [](std::string_view a) { return std::string(a) + std::string(kHeader); };
    std::map<std::string, std::string, std::less<>> all{
        {"sensor_msgs/JointState", joined(kJointState)},
        {"sensor_msgs/Imu", joined(kImu)},
        {"std_msgs/Float64MultiArray", std::string(kMultiArray)}};
    // Those that they consist of.
    const std::map<std::string, std::string, std::less<>> whole = all;
    for (const auto& [name, text] : whole)
      for (std::size_t at = 0; (at = text.find("MSG: ", at)) != text.npos;) {
        const std::size_t end = text.find('\n', at);
        const std::string part = text.substr(at + 5, end - at - 5);
        at = std::min(text.find("===", end), text.size());
        all.emplace(part, text.substr(end + 1, at - end - 1));
      }
    return all;
  }();
  const auto found = kAll.find(short_type(type));
  return found == kAll.end() ? std::string_view{} : std::string_view(found->second);
}

Definition parse_definition(std::string_view text, const std::string& type) {
  return Parser(text, type).parse();
}

}  // namespace furcula::bags
