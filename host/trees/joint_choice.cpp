// Joints by the names of a log, see joint_choice.hpp.
#include "host/trees/joint_choice.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <optional>
#include <set>

#include "host/core/message.hpp"
#include "host/log/rigs.hpp"
#include "host/model/urdf_filter.hpp"

namespace furcula::trees {
namespace {

using core::quoted;
using model::Urdf;
using model::UrdfJoint;
using Words = std::vector<std::string>;

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Where in a name a word begins: after a separator, at a capital ("leftHip", "LHip"), at digits and after them.
bool begins_word(const std::string& name, std::size_t i) {
  const char before = name[i - 1], c = name[i];
  if (is_digit(before) != is_digit(c)) return true;
  if (is_lower(before) && is_upper(c)) return true;
  return is_upper(before) && is_upper(c) && i + 1 < name.size() && is_lower(name[i + 1]);
}
Words words_of(const std::string& name) {
  // What robots' names abbreviate; of legs the second letter is the side.
  static const std::map<std::string, Words> kMeans{
      {"l", {"left"}},           {"lft", {"left"}},          {"r", {"right"}},
      {"rgt", {"right"}},        {"fl", {"front", "left"}},  {"fr", {"front", "right"}},
      {"lf", {"front", "left"}}, {"rf", {"front", "right"}}, {"rl", {"rear", "left"}},
      {"rr", {"rear", "right"}}, {"hl", {"rear", "left"}},   {"hr", {"rear", "right"}},
      {"lh", {"rear", "left"}},  {"rh", {"rear", "right"}},  {"lr", {"rear", "left"}},
      {"bl", {"rear", "left"}},  {"br", {"rear", "right"}},  {"hind", {"rear"}},
      {"back", {"rear"}},        {"fore", {"front"}}};
  Words out;
  std::string word;
  const auto end = [&] {
    if (word.empty()) return;
    const auto means = kMeans.find(word);
    if (means == kMeans.end())
      out.push_back(word);
    else
      out.insert(out.end(), means->second.begin(), means->second.end());
    word.clear();
  };
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0;
    if (!letter || (i > 0 && begins_word(name, i))) end();
    if (!letter) continue;
    // "007" is 7.
    if (word == "0" && is_digit(c)) word.clear();
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  end();
  return out;
}
/// Without the words that only say that it is a joint, if any other is left.
Words telling(const Words& words) {
  static const std::set<std::string> kSaysJoint{"joint", "jnt", "j", "q", "axis"};
  Words out;
  for (const std::string& w : words)
    if (!kSaysJoint.contains(w)) out.push_back(w);
  return out.empty() ? words : out;
}
Words sorted(Words words) {
  std::sort(words.begin(), words.end());
  return words;
}
bool is_end_of(const Words& part, const Words& whole) {
  return part.size() < whole.size() && std::equal(part.rbegin(), part.rend(), whole.rbegin());
}

/// How two names are taken for one, the surest first.
const std::vector<std::function<bool(const std::string&, const std::string&)>>& likenesses() {
  static const std::vector<std::function<bool(const std::string&, const std::string&)>> kAll{
      [](const std::string& a, const std::string& b) { return words_of(a) == words_of(b); },
      [](const std::string& a, const std::string& b) { return telling(words_of(a)) == telling(words_of(b)); },
      [](const std::string& a, const std::string& b) {
        return sorted(telling(words_of(a))) == sorted(telling(words_of(b)));
      },
      [](const std::string& a, const std::string& b) {
        const Words x = telling(words_of(a)), y = telling(words_of(b));
        return is_end_of(x, y) || is_end_of(y, x);
      }};
  return kAll;
}

bool slides(const UrdfJoint& j) { return j.kind == UrdfJoint::Kind::prismatic; }
std::string angle_column(const std::string& name, bool prismatic) {
  return prismatic ? "position_" + name + "_m" : "angle_" + name + "_rad";
}

class Chooser {
 public:
  Chooser(const Urdf& robot, const std::vector<std::string>& columns)
      : robot_(robot), columns_(columns.begin(), columns.end()) {}

  JointChoice choose(const std::vector<std::string>& wanted, const std::map<std::string, double>& hold) {
    const std::vector<std::string> all = wanted.empty() ? model::default_joints(robot_, hold) : wanted;
    std::vector<std::string> recorded = all;
    if (!columns_.empty()) {
      match(all);
      std::erase_if(recorded, [&](const std::string& name) { return !is_recorded(name); });
      if (count_from_another(all))
        recorded = all;
      else
        propose(all);
    }
    if (wanted.empty()) take(recorded.empty() ? all : recorded, hold);
    if (!out_.logged.empty()) {
      std::vector<std::string> pairs;
      for (const auto& [joint, name] : out_.logged) pairs.push_back(quoted(joint) + " is " + quoted(name));
      out_.notes.push_back("Joints that the recordings call otherwise: " + listed(pairs) +
                           ". Check that they are the same; a --map file says it otherwise.");
    }
    return std::move(out_);
  }

 private:
  const UrdfJoint* joint(const std::string& name) const {
    for (const UrdfJoint& j : robot_.joints)
      if (j.name == name) return &j;
    return nullptr;
  }
  bool has_column(const UrdfJoint& j) const { return columns_.contains(angle_column(j.name, slides(j))); }
  bool is_recorded(const std::string& name) const {
    const UrdfJoint* j = joint(name);
    return j != nullptr && (out_.logged.contains(name) || has_column(*j));
  }
  static std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 12;
    std::string out;
    for (std::size_t i = 0; i < std::min(kMost, names.size()); ++i) out += (i == 0 ? "" : ", ") + names[i];
    return out + (names.size() > kMost ? " and " + std::to_string(names.size() - kMost) + " more" : "");
  }

  /// The log's names of joints that no joint of the robot has.
  std::vector<std::string> foreign(bool prismatic) const {
    std::vector<std::string> out;
    const std::string_view prefix = prismatic ? "position_" : "angle_", unit = prismatic ? "m" : "rad";
    for (const std::string& column : columns_) {
      for (const log::ColumnPattern& p : log::kTreeColumns) {
        if (p.prefix != prefix || p.unit != unit) continue;
        const std::string name(p.joint_in(column));
        // angle_cmd_y_rad is a set point of y.
        if (!name.empty() && !name.starts_with("cmd_") && joint(name) == nullptr) out.push_back(name);
      }
    }
    return out;
  }
  void match(const std::vector<std::string>& all) {
    for (const bool prismatic : {false, true}) {
      std::vector<std::string> theirs = foreign(prismatic), ours;
      for (const std::string& name : all)
        if (const UrdfJoint* j = joint(name); j != nullptr && slides(*j) == prismatic && !has_column(*j))
          ours.push_back(name);
      for (const auto& alike : likenesses()) {
        std::map<std::string, std::string> pairs;
        for (const std::string& name : ours) {
          const auto count = [](const std::vector<std::string>& of, const auto& is) {
            return std::count_if(of.begin(), of.end(), is);
          };
          const auto to = [&](const std::string& other) { return alike(name, other); };
          if (count(theirs, to) != 1) continue;
          const std::string other = *std::find_if(theirs.begin(), theirs.end(), to);
          if (count(ours, [&](const std::string& one) { return alike(one, other); }) == 1)
            pairs.emplace(name, other);
        }
        for (const auto& [name, other] : pairs) {
          out_.logged.emplace(name, other);
          std::erase(ours, name);
          std::erase(theirs, other);
        }
      }
    }
  }
  /// Names with most words in common, for those that are left; the first that nobody has where none has any.
  void propose(const std::vector<std::string>& all) {
    std::vector<std::string> lines;
    std::set<std::string> proposed;
    for (const std::string& name : all) {
      const UrdfJoint* j = joint(name);
      if (j == nullptr || is_recorded(name)) continue;
      const Words own = sorted(telling(words_of(name)));
      std::string best, first;
      std::size_t most = 0;
      for (const std::string& other : foreign(slides(*j))) {
        const bool taken = std::any_of(out_.logged.begin(), out_.logged.end(),
                                       [&](const auto& pair) { return pair.second == other; });
        if (taken) continue;
        if (first.empty() && !proposed.contains(other)) first = other;
        const Words its = sorted(telling(words_of(other)));
        Words common;
        std::set_intersection(own.begin(), own.end(), its.begin(), its.end(), std::back_inserter(common));
        if (common.size() > most) {
          most = common.size();
          best = other;
        }
      }
      if (best.empty()) best = first;
      proposed.insert(best);
      if (!best.empty())
        lines.push_back(angle_column(name, slides(*j)) + " = { column = \"" + angle_column(best, slides(*j)) +
                        "\" }");
    }
    if (!lines.empty()) set_lines(lines);
  }
  /// A log that counts from 0 joints that the URDF counts from 1 has columns of nearly all of them, and each is another's. Where it has a number
  /// before the first and lacks the last, all are wanted, and lines for a map file are given.
  bool count_from_another(const std::vector<std::string>& all) {
    std::map<std::string, std::map<long, std::string>> ours;
    const auto parts = [](const std::string& name) -> std::pair<std::string, long> {
      std::size_t at = name.size();
      while (at > 0 && is_digit(name[at - 1]) && name.size() - at < 4) --at;
      return {name.substr(0, at), at == name.size() ? -1 : std::stol(name.substr(at))};
    };
    for (const std::string& name : all)
      if (const auto [stem, number] = parts(name); number >= 0) ours[stem].emplace(number, name);
    std::vector<std::string> lines;
    for (const bool prismatic : {false, true})
      for (const std::string& other : foreign(prismatic)) {
        const auto [stem, number] = parts(other);
        const auto found = ours.find(stem);
        if (found == ours.end() || found->second.size() < 2) continue;
        const auto& joints = found->second;
        if (number != joints.begin()->first - 1 || is_recorded(joints.rbegin()->second)) continue;
        for (const auto& [n, name] : joints)
          lines.push_back(angle_column(name, prismatic) + " = { column = \"" +
                          angle_column(stem + std::to_string(n - 1), prismatic) + "\" }");
      }
    if (lines.empty()) return false;
    set_lines(lines);
    return true;
  }
  void set_lines(const std::vector<std::string>& lines) {
    constexpr std::size_t kMost = 4;
    const std::size_t shown = std::min(kMost, lines.size());
    for (std::size_t i = 0; i < shown; ++i) out_.map_lines += (i == 0 ? "" : ", ") + lines[i];
    if (shown < lines.size())
      out_.map_lines += " and " + std::to_string(lines.size() - shown) + " more such lines";
  }
  /// Says which joints move, and which do not that could.
  void take(const std::vector<std::string>& chosen, const std::map<std::string, double>& hold) {
    const std::set<std::string> moving(chosen.begin(), chosen.end());
    std::vector<std::string> taken, held, tied;
    std::string line;
    for (const UrdfJoint& j : robot_.joints) {
      if (j.kind == UrdfJoint::Kind::fixed || j.kind == UrdfJoint::Kind::other || hold.contains(j.name))
        continue;
      if (moving.contains(j.name)) {
        taken.push_back(quoted(j.name));
        line += (line.empty() ? "\"" : ", \"") + j.name + "\"";
        out_.moving.push_back(j.name);
        continue;
      }
      const bool is_tied =
          !j.mimics.empty() || std::any_of(robot_.joints.begin(), robot_.joints.end(),
                                           [&](const UrdfJoint& other) { return other.mimics == j.name; });
      (is_tied ? tied : held).push_back(quoted(j.name));
    }
    if (held.empty() && tied.empty()) {
      out_.moving.clear();
      return;
    }
    std::string note = "The model file names no joints: ";
    note += columns_.empty() || held.empty() ? "those move that can by themselves, "
                                             : "those move that the recordings have columns of, ";
    note += listed(taken) + ".";
    if (!held.empty()) note += " Held at 0: " + listed(held) + ".";
    if (!tied.empty()) note += " Held at 0, since one mimics another: " + listed(tied) + ".";
    if (!out_.map_lines.empty()) note += " A --map file may name columns of theirs: " + out_.map_lines + ".";
    // A short one is printed to be copied.
    constexpr std::size_t kLine = 12;
    note += " To choose, write joints = [" + (taken.size() <= kLine ? line : std::string("...")) +
            "] in [model].";
    out_.notes.push_back(note);
  }

  const Urdf& robot_;
  std::set<std::string> columns_;
  JointChoice out_;
};

}  // namespace

JointChoice choose_joints(const Urdf& robot, const std::vector<std::string>& wanted,
                          const std::map<std::string, double>& hold,
                          const std::vector<std::string>& columns) {
  return Chooser(robot, columns).choose(wanted, hold);
}

}  // namespace furcula::trees
