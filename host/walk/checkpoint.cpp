#include "host/walk/checkpoint.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "furcula/core/crc32.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/own_build.hpp"
#include "host/walk/state_json.hpp"

namespace furcula::walk {
namespace {

using Json = nlohmann::json;
using core::DataError;

constexpr std::string_view kFormat = "furcula-walk-checkpoint/1";

std::uint32_t crc_of(std::string_view bytes) {
  Crc32 crc;
  for (const char c : bytes) crc.add(static_cast<std::uint8_t>(c));
  return crc.value();
}

/// Of all numbers that a robot, or its sensors' errors, are.
template <class Numbers>
std::string hash_of(const Numbers& numbers) {
  static_assert(std::is_trivially_copyable_v<Numbers> && sizeof(Numbers) % sizeof(double) == 0 &&
                alignof(Numbers) == alignof(double));  // doubles alone: no padding
  std::array<char, sizeof(Numbers)> bytes;
  std::memcpy(bytes.data(), &numbers, bytes.size());
  return core::hexadecimal(crc_of({bytes.data(), bytes.size()}));
}

std::string hash_of(const Parameters& walk) {
  const auto values = walk.values();
  return "a walk, " +
         core::hexadecimal(crc_of({reinterpret_cast<const char*>(values.data()), sizeof values}));
}

std::string hash_of(const std::vector<Member>& ensemble) {
  static_assert(std::is_trivially_copyable_v<Member> && sizeof(Member) % sizeof(double) == 0 &&
                alignof(Member) == alignof(double));
  if (ensemble.empty()) return "none";
  const auto* bytes = reinterpret_cast<const char*>(ensemble.data());
  return std::to_string(ensemble.size()) + ", " +
         core::hexadecimal(crc_of({bytes, ensemble.size() * sizeof(Member)}));
}

Json point_json(const SearchPoint& p) {
  return {p.cpu_s, p.steps, p.rollouts, state_json(p.objective), state_json(p.cot)};
}
SearchPoint point_of(const Json& j) {
  return {j.at(0), j.at(1), j.at(2), state_double(j.at(3)), state_double(j.at(4))};
}

SearchState state_of(const Json& j, std::string_view method) {
  SearchState s;
  s.steps = j.at("steps");
  s.rollouts = j.at("rollouts");
  s.not_finite = j.at("not_finite");
  s.cpu_s = j.at("cpu_s");
  s.seconds = j.at("seconds");
  if (!j.at("first_walk").is_null()) s.first_walk = point_of(j.at("first_walk"));
  for (const Json& p : j.at("history")) s.history.push_back(point_of(p));
  for (const Json& b : j.at("bests"))
    s.bests.push_back(Parameters::of(b.get<std::array<double, Parameters::kCount>>()));
  if (const Json& begun = j.at("robust_start"); !begun.is_null())
    s.robust_start = Parameters::of(begun.get<std::array<double, Parameters::kCount>>());
  if (s.history.empty() != s.bests.empty()) throw std::invalid_argument("bests without history");
  s.method = method;
  return s;
}

/// A number in the header, or none.
template <class N>
std::optional<N> number_in(std::string_view text, int base) {
  N value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string_view taken_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

Checkpoint read_one(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw DataError(path + ": a folder; expected a checkpoint, as DIR/search.checkpoint");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(path + ": cannot be read; expected a checkpoint of furcula walk search");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  return parse_checkpoint(text, path);
}

}  // namespace

Settings settings_of(const Model& model, const SearchOptions& options, const std::string& program) {
  const RolloutOptions& r = options.rollout;
  Settings out{{"program", program},
               {"robot", model.name},
               {"the robot's numbers, as a hash", hash_of(model.robot)},
               {"mode", std::string(kModeNames[static_cast<std::size_t>(r.mode)])},
               {"method", std::string(kMethodNames[static_cast<std::size_t>(options.method)])},
               {"seed", std::to_string(options.seed)},
               {"start", options.start ? hash_of(*options.start) : "steps on the spot"},
               {"other robots of a robust search", hash_of(options.ensemble)},
               {"time_s", core::shortest(r.time_s)},
               {"step_s", core::shortest(r.step_s)},
               {"steps a tick", std::to_string(r.steps_a_tick)},
               {"walk_until_s", core::shortest(r.walk_until_s)},
               {"foot_threshold_n", core::shortest(r.foot_threshold_n)},
               {"motors of passive hips", r.hips_follow ? "follow" : "off"},
               {"first walk, m", core::shortest(options.first_walk_m)}};
  if (r.sensors.any()) out.emplace_back("errors of the sensors, as a hash", hash_of(r.sensors));
  if (r.known && hash_of(*r.known) != hash_of(model.robot))
    out.emplace_back("the robot that the controller knows, as a hash", hash_of(*r.known));
  if (r.command_delay_s > 0.0) out.emplace_back("command_delay_s", core::shortest(r.command_delay_s));
  for (const LimitKey& k : kLimitKeys)
    out.emplace_back("[limits] " + std::string(k.name), core::shortest(r.limits.*k.of));
  return out;
}

std::string format_checkpoint(const Checkpoint& c) {
  const SearchState& s = c.state;
  Json history = Json::array(), bests = Json::array(), settings = Json::array();
  for (const SearchPoint& p : s.history) history.push_back(point_json(p));
  for (const Parameters& b : s.bests) bests.push_back(b.values());
  for (const auto& [what, value] : c.settings) settings.push_back({what, value});
  const Json j{{"settings", settings},
               {"build", c.build},
               {"steps", s.steps},
               {"rollouts", s.rollouts},
               {"not_finite", s.not_finite},
               {"cpu_s", s.cpu_s},
               {"seconds", s.seconds},
               {"first_walk", s.first_walk ? point_json(*s.first_walk) : Json(nullptr)},
               {"history", history},
               {"bests", bests},
               {"robust_start", s.robust_start ? Json(s.robust_start->values()) : Json(nullptr)}};
  const std::string body = j.dump() + "\n" + s.method + "\n";
  return std::string(kFormat) + " " + std::to_string(body.size()) + " " + core::hexadecimal(crc_of(body)) +
         "\n" + body;
}

Checkpoint parse_checkpoint(std::string_view text, const std::string& name) {
  std::string_view rest = text, head = taken_line(rest);
  const std::string_view format = head.substr(0, head.find(' '));
  if (format != kFormat)
    throw DataError(name + ":1: begins with " + core::quoted(format.substr(0, 40)) + "; expected " +
                    core::quoted(kFormat));
  head.remove_prefix(format.size());
  const std::size_t gap = std::min(head.find(' ', 1), head.size());
  const auto bytes = number_in<std::size_t>(
      head.substr(std::min<std::size_t>(1, head.size()), gap - std::min<std::size_t>(1, gap)), 10);
  const auto crc = number_in<std::uint32_t>(head.substr(std::min(gap + 1, head.size())), 16);
  if (!bytes || !crc) throw DataError(name + ":1: no size and CRC-32; expected both after the format's name");
  if (rest.size() < *bytes)
    throw DataError(name + ": cut short: " + std::to_string(rest.size()) + " of " + std::to_string(*bytes) +
                    " bytes after the first line");
  if (rest.size() > *bytes || crc_of(rest) != *crc)
    throw DataError(name + ": damaged: its bytes do not fit the CRC-32 of its first line");
  try {
    const Json j = Json::parse(taken_line(rest));
    Checkpoint out;
    for (const Json& s : j.at("settings")) out.settings.emplace_back(s.at(0), s.at(1));
    out.build = j.at("build");
    out.state = state_of(j, taken_line(rest));
    return out;
  } catch (const std::exception& e) {
    throw DataError(name + ":2: not a state of a search: " + e.what());
  }
}

void write_checkpoint(const Checkpoint& checkpoint, const std::string& path) {
  std::error_code none_yet;
  std::filesystem::rename(path, path + ".previous", none_yet);
  core::write_file_atomically(path, format_checkpoint(checkpoint));
}

FoundCheckpoint read_checkpoint(const std::string& path) {
  try {
    return {read_one(path), path, {}};
  } catch (const DataError& e) {
    const std::string previous = path + ".previous";
    if (!std::filesystem::is_regular_file(previous)) throw;
    try {
      return {read_one(previous), previous, std::string(e.what()) + "; the one before it is used"};
    } catch (const DataError& also) {
      throw DataError(std::string(e.what()) + "; and " + also.what());
    }
  }
}

std::string difference(const Settings& written, const Settings& asked) {
  const auto value_in = [](const Settings& all, const std::string& what) -> std::string {
    for (const auto& [name, value] : all)
      if (name == what) return value;
    return "none";
  };
  std::string out;
  const auto compare = [&](const std::string& what) {
    const std::string was = value_in(written, what), is = value_in(asked, what);
    if (was == is) return;
    out += (out.empty() ? "" : "; ") + what + " " + core::quoted(was) + ", expected " + core::quoted(is);
  };
  for (const auto& [what, value] : asked) compare(what);
  for (const auto& [what, value] : written)
    if (value_in(asked, what) == "none") compare(what);
  return out;
}

}  // namespace furcula::walk
