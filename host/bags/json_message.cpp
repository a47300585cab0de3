// JSON messages, see json_message.hpp.
#include "host/bags/json_message.hpp"

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

using Json = nlohmann::json;

/// Called by the parser, event by event: nothing is kept but numbers, and memory is bounded by the depth.
class Leaves final : public nlohmann::json_sax<Json> {
 public:
  Leaves(Decoded& to, std::vector<std::string>* names) : to_(to), names_(names) {}

  bool null() override { return leaf(std::numeric_limits<double>::quiet_NaN()); }
  bool boolean(bool value) override { return leaf(value ? 1.0 : 0.0); }
  bool number_integer(number_integer_t value) override { return integer(value); }
  bool number_unsigned(number_unsigned_t value) override {
    return value <= INT64_MAX ? integer(static_cast<std::int64_t>(value)) : leaf(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return leaf(value); }
  bool string(string_t& value) override {
    // Names of joints.
    if (levels_.size() == 2 && levels_.back().array && path_.starts_with("name[")) {
      next();
      to_.texts += value.substr(0, value.find('\0'));
      to_.texts += '\0';
      return true;
    }
    next();
    return true;
  }
  bool binary(binary_t& /*value*/) override { return true; }
  bool start_object(std::size_t /*size*/) override { return begin(false); }
  bool end_object() override { return end(); }
  bool start_array(std::size_t /*size*/) override { return begin(true); }
  bool end_array() override { return end(); }
  bool key(string_t& value) override {
    path_.resize(levels_.back().length);
    if (!path_.empty()) path_ += '/';
    path_ += value;
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& /*e*/) override {
    why = "it is no JSON from its byte " + std::to_string(position) + " on";
    return false;
  }

  std::string why;
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a, of the paths

 private:
  struct Level {
    bool array;
    std::size_t length;  ///< of the path to it
    std::size_t index;
  };

  /// The path of the value that comes.
  void next() {
    if (levels_.empty() || !levels_.back().array) return;
    path_.resize(levels_.back().length);
    path_ += "[" + std::to_string(levels_.back().index++) + "]";
  }
  bool begin(bool array) {
    if (levels_.empty() && array) {
      why = "it is a JSON array; expected an object, {\"...\": ...}";
      return false;
    }
    if (levels_.size() >= 64) {
      why = "its JSON is nested deeper than 64 levels";
      return false;
    }
    next();
    levels_.push_back({array, path_.size(), 0});
    if (array) path_ += "[";
    return true;
  }
  bool end() {
    path_.resize(levels_.back().length);
    levels_.pop_back();
    return true;
  }
  bool integer(std::int64_t value) {
    if (path_ == "header/stamp/sec" || path_ == "stamp/sec") to_.stamp_ns += seconds_of(value);
    if (path_ == "header/stamp/nanosec" || path_ == "header/stamp/nsec" || path_ == "stamp/nanosec" ||
        path_ == "stamp/nsec")
      to_.stamp_ns += value >= 0 && value < 1000000000 ? value : 0;
    return leaf(static_cast<double>(value));
  }
  static std::int64_t seconds_of(std::int64_t value) {
    return value >= 0 && value < kLatest_ns / 1000000000 ? value * 1000000000 : 0;
  }
  bool leaf(double value) {
    if (levels_.empty()) {
      why = "it is a JSON value; expected an object, {\"...\": ...}";
      return false;
    }
    next();
    if (levels_.back().array && levels_.back().index > kMostElements) return true;
    if (to_.values.size() >= kMostValues) return true;
    for (const char c : path_) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    hash = (hash ^ 0xFFu) * 1099511628211u;
    to_.values.push_back(value);
    if (names_ != nullptr) names_->push_back(path_);
    return true;
  }

  Decoded& to_;
  std::vector<std::string>* names_;
  std::string path_;
  std::vector<Level> levels_;
};

}  // namespace

std::string decode_json(std::string_view data, Decoded& to, std::vector<std::string>* names) {
  to.clear();
  if (names != nullptr) names->clear();
  Leaves leaves(to, names);
  if (!Json::sax_parse(data, &leaves)) return leaves.why.empty() ? "it is no JSON" : leaves.why;
  to.form = {static_cast<std::uint32_t>(leaves.hash), static_cast<std::uint32_t>(leaves.hash >> 32)};
  return {};
}

}  // namespace furcula::bags
