// See names.hpp.
#include "host/mapping/names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <numbers>
#include <set>
#include <string_view>
#include <vector>

#include "host/trees/joint_names.hpp"

namespace furcula::mapping {
namespace {

using Words = std::set<std::string>;

const Words kTime{"time", "t",     "timestamp", "stamp", "sec", "secs",
                  "nsec", "nsecs", "nanosec",   "clock", "tick"};
const Words kPosition{"pos",     "position", "positions", "angle",  "ang", "q",   "theta",
                      "encoder", "enc",      "height",    "travel", "phi", "qpos"};
const Words kVelocity{"vel", "velocity", "velocities", "qd", "dq", "qdot", "speed", "omega", "rpm", "qvel"};
const Words kEffort{"tau", "torque", "torques", "effort", "efforts", "trq", "tq", "force", "moment"};
const Words kCurrent{"current", "iq", "curr", "amps"};
const Words kContact{"contact", "touch"};
const Words kCoil{"solenoid", "coil"};
const Words kCommand{"cmd",       "command", "commands", "commanded", "des",  "desired", "ref",
                     "reference", "target",  "setpoint", "set",       "goal", "input",   "sp"};
/// Of a drive, but nothing that a map has.
const Words kNothing{"temp", "temperature", "voltage",      "bus", "fault", "mode",  "error", "status",
                     "acc",  "accel",       "acceleration", "kp",  "kd",    "power", "abs",   "circular"};
/// They say neither what it is nor of which joint.
const Words kFiller{"states",   "state",     "js",       "measured", "meas",       "actual",  "act",
                    "estimate", "estimated", "est",      "servo",    "stats",      "motor",   "data",
                    "value",    "filtered",  "feedback", "fb",       "controller", "control", "mapper",
                    "robot",    "joints",    "msg",      "sensor",   "m",          "of",      "field"};

struct Unit {
  std::string_view name;
  Role role;
  bool linear;
  double si;  ///< 0: not known
};
constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2.0 * std::numbers::pi;
constexpr std::array<Unit, 43> kUnits{{
    {"s", Role::time, false, 1.0},
    {"sec", Role::time, false, 1.0},
    {"secs", Role::time, false, 1.0},
    {"seconds", Role::time, false, 1.0},
    {"ms", Role::time, false, 1e-3},
    {"msec", Role::time, false, 1e-3},
    {"us", Role::time, false, 1e-6},
    {"usec", Role::time, false, 1e-6},
    {"ns", Role::time, false, 1e-9},
    {"nsec", Role::time, false, 1e-9},
    {"nsecs", Role::time, false, 1e-9},
    {"nanosec", Role::time, false, 1e-9},
    {"rad", Role::position, false, 1.0},
    {"deg", Role::position, false, kDegree},
    {"degree", Role::position, false, kDegree},
    {"degrees", Role::position, false, kDegree},
    {"mrad", Role::position, false, 1e-3},
    {"mdeg", Role::position, false, 1e-3 * kDegree},
    {"rev", Role::position, false, kTurn},
    {"revs", Role::position, false, kTurn},
    {"revolutions", Role::position, false, kTurn},
    {"turn", Role::position, false, kTurn},
    {"turns", Role::position, false, kTurn},
    {"counts", Role::position, false, 0.0},
    {"count", Role::position, false, 0.0},
    {"ticks", Role::position, false, 0.0},
    {"m", Role::position, true, 1.0},
    {"mm", Role::position, true, 1e-3},
    {"cm", Role::position, true, 1e-2},
    {"radps", Role::velocity, false, 1.0},
    {"degps", Role::velocity, false, kDegree},
    {"rps", Role::velocity, false, kTurn},
    {"rpm", Role::velocity, false, kTurn / 60.0},
    {"mps", Role::velocity, true, 1.0},
    {"mmps", Role::velocity, true, 1e-3},
    {"nm", Role::effort, false, 1.0},
    {"mnm", Role::effort, false, 1e-3},
    {"nmm", Role::effort, false, 1e-3},
    {"ncm", Role::effort, false, 1e-2},
    {"n", Role::effort, true, 1.0},
    {"kn", Role::effort, true, 1e3},
    {"a", Role::current, false, 0.0},
    {"ma", Role::current, false, 0.0},
}};

bool is_unit(const std::string& word) {
  return std::any_of(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == word; });
}

/// "rad/s" is "radps", "N m" and "N*m" are "nm".
std::string plain(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (std::isalnum(c) != 0) out += static_cast<char>(std::tolower(c));
    if (c == '/' && i + 1 < text.size()) out += 'p';
  }
  return out;
}

/// Takes "[deg]" or "(N m)" off the end of a name, or "_deg", and gives the unit.
std::string take_unit(std::string& name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const auto from = name.rfind(open), to = name.rfind(close);
    if (from == name.npos || to == name.npos || to < from) continue;
    const std::string unit = plain(name.substr(from + 1, to - from - 1));
    if (!is_unit(unit)) continue;
    name.erase(from, to - from + 1);
    return unit;
  }
  const auto at = name.find_last_of("_ .");
  if (at == name.npos || at == 0) return {};
  const std::string unit = plain(name.substr(at + 1));
  if (!is_unit(unit)) return {};
  name.erase(at);
  return unit;
}

std::vector<std::string> words_in(const std::string& name) {
  // Whole words that a capital or a digit would divide: "qDot", "Iq".
  std::vector<std::string> out;
  for (std::string& word : trees::words_of(name)) {
    if (word == "dot" && !out.empty() && out.back() == "q") {
      out.back() = "qdot";
      continue;
    }
    out.push_back(std::move(word));
  }
  return out;
}

bool any_in(const std::vector<std::string>& words, const Words& of) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& w) { return of.contains(w); });
}

Role role_of(const std::vector<std::string>& words, const std::string& unit) {
  if (any_in(words, kNothing)) return Role::other;
  // A current along the d axis makes no torque.
  const bool d_axis = std::find(words.begin(), words.end(), "d") != words.end();
  if (any_in(words, kCurrent)) return d_axis ? Role::other : Role::current;
  if (any_in(words, kEffort)) return Role::effort;
  if (any_in(words, kVelocity)) return Role::velocity;
  if (any_in(words, kPosition)) return Role::position;
  if (any_in(words, kContact)) return Role::contact;
  if (any_in(words, kCoil)) return Role::coil;
  if (any_in(words, kTime)) return Role::time;
  for (const Unit& u : kUnits)
    if (u.name == unit) return u.role;
  return Role::other;
}

}  // namespace

Meaning meaning_of(const std::string& column) {
  Meaning out;
  std::string name = column;
  out.unit = take_unit(name);
  std::vector<std::string> words = words_in(name);
  // "nsecs" is what it is, and its unit.
  if (words.empty() && !out.unit.empty()) words.push_back(out.unit);
  out.role = role_of(words, out.unit);
  if (out.role == Role::time && out.unit.empty())
    for (const std::string& w : words)
      if (is_unit(w)) out.unit = w;
  out.command = any_in(words, kCommand);
  const Words* roles[]{&kPosition, &kVelocity, &kEffort, &kCurrent, &kCommand, &kFiller, &kContact, &kCoil};
  for (const std::string& w : words)
    if (std::none_of(std::begin(roles), std::end(roles), [&](const Words* r) { return r->contains(w); }))
      out.joint += (out.joint.empty() ? "" : "_") + w;
  // moteus' telemetry and ODrive's properties count turns.
  const bool moteus = column.find("servo_stats") != column.npos || column.find("moteus") != column.npos;
  const bool odrive = column.find("pos_estimate") != column.npos ||
                      column.find("pos_setpoint") != column.npos || column.find("input_pos") != column.npos ||
                      column.find("pos_rel") != column.npos;
  if (out.unit.empty() && out.role == Role::position && (moteus || odrive)) {
    out.unit = "turns";
    out.unit_usual = true;
  }
  return out;
}

double si_of(Role role, const std::string& unit, bool linear) {
  for (const Unit& u : kUnits)
    if (u.name == unit && u.role == role && (u.linear == linear || role == Role::time)) return u.si;
  return 0.0;
}

}  // namespace furcula::mapping
