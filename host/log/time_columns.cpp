// Columns of seconds and fractions, see time_columns.hpp.
#include "host/log/time_columns.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "host/core/message.hpp"

namespace furcula::log {
namespace {

struct Word {
  std::string_view word;
  const char* scale;
};
/// ROS 1 (secs, nsecs), ROS 2 (sec, nanosec), timespec (tv_sec, tv_nsec), timeval (tv_sec, tv_usec), and what people write.
constexpr Word kFractions[]{
    {"nsec", "1e-9"},        {"nsecs", "1e-9"},     {"nanosec", "1e-9"},      {"nanosecs", "1e-9"},
    {"nanoseconds", "1e-9"}, {"ns", "1e-9"},        {"usec", "1e-6"},         {"usecs", "1e-6"},
    {"microsec", "1e-6"},    {"microsecs", "1e-6"}, {"microseconds", "1e-6"}, {"us", "1e-6"},
    {"msec", "1e-3"},        {"msecs", "1e-3"},     {"millisec", "1e-3"},     {"milliseconds", "1e-3"},
    {"ms", "1e-3"}};
constexpr std::string_view kSeconds[]{"sec", "secs", "second", "seconds", "s"};

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// The name's last word in small letters, and what stands before it.
std::pair<std::string, std::string> parts(const std::string& name) {
  const std::string small = lower(name);
  const std::size_t at = small.find_last_of("._/ :");
  if (at == std::string::npos) return {small, {}};
  return {small.substr(at + 1), small.substr(0, at)};
}

const Word* fraction(const std::string& name) {
  const std::string last = parts(name).first;
  for (const Word& w : kFractions)
    if (w.word == last) return &w;
  return nullptr;
}

bool is_seconds(const std::string& name) {
  const std::string last = parts(name).first;
  return std::find(std::begin(kSeconds), std::end(kSeconds), last) != std::end(kSeconds);
}

}  // namespace

std::string line_that_adds(std::span<const std::string> columns, const std::string& seconds) {
  const auto line = [](const std::string& one, const std::string& other, const char* scale) {
    return "time_s = { columns = [\"" + core::printable(one) + "\", \"" + core::printable(other) +
           "\"], scales = [1, " + scale + "] }";
  };
  // Of the same stem first: header.stamp.secs and header.stamp.nsecs.
  for (const bool same_stem : {true, false})
    for (const std::string& one : columns) {
      if (seconds.empty() ? !is_seconds(one) : one != seconds) continue;
      for (const std::string& other : columns) {
        const Word* word = fraction(other);
        if (other == one || word == nullptr) continue;
        // `ms` at the end of any other name is that quantity's unit.
        if (same_stem ? parts(one).second == parts(other).second : !seconds.empty() && word->word.size() > 2)
          return line(one, other, word->scale);
      }
    }
  return {};
}

}  // namespace furcula::log
