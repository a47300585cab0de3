// Joints by the names of a log, see joint_choice.hpp.
#include "host/trees/joint_choice.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/log/machine_types.hpp"
#include "host/model/urdf_filter.hpp"
#include "host/trees/joint_names.hpp"
#include "host/trees/model.hpp"

namespace furcula::trees {
namespace {

using model::Urdf;
using model::UrdfJoint;

bool slides(const UrdfJoint& j) { return j.kind == UrdfJoint::Kind::prismatic; }
bool can_move(const UrdfJoint& j) {
  return j.kind != UrdfJoint::Kind::fixed && j.kind != UrdfJoint::Kind::other;
}
std::string angle_column(const std::string& name, bool prismatic) {
  return prismatic ? "position_" + name + "_m" : "angle_" + name + "_rad";
}
/// The others that a recording needs of a joint, or may have in their place.
std::array<std::string, 3> input_columns(const std::string& name, bool prismatic) {
  if (prismatic) return {"force_" + name + "_n", "force_cmd_" + name + "_n", "position_cmd_" + name + "_m"};
  return {"torque_" + name + "_nm", "torque_cmd_" + name + "_nm", "angle_cmd_" + name + "_rad"};
}
/// The joints that follow this one.
std::vector<std::string> followers(const Urdf& robot, const std::string& name) {
  std::vector<std::string> out;
  for (const UrdfJoint& j : robot.joints)
    if (j.mimics == name && can_move(j)) out.push_back(core::quoted(j.name));
  return out;
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
      // Which of several columns a joint's is must be said: it is not held because of that.
      std::erase_if(recorded,
                    [&](const std::string& name) { return !is_recorded(name) && !could_be_.contains(name); });
      if (count_from_another(all))
        recorded = all;
      else
        propose(all);
      for (const std::string& name : all)
        if (is_called_angle(name))
          out_.map_lines = sliding_lines(name) + (out_.map_lines.empty() ? "" : ", ") + out_.map_lines;
    }
    if (wanted.empty()) take(recorded.empty() ? all : recorded, hold);
    if (!out_.logged.empty()) {
      std::vector<std::string> pairs;
      for (const auto& [joint, name] : out_.logged)
        pairs.push_back(core::quoted(joint) + " is " + core::quoted(name));
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
  /// A joint that slides and whose position bears the name of an angle: ROS 2 gives both in one field.
  bool is_called_angle(const std::string& name) const {
    const UrdfJoint* j = joint(name);
    return j != nullptr && slides(*j) && !is_recorded(name) && columns_.contains(angle_column(name, false));
  }
  /// What a map file says of it.
  std::string sliding_lines(const std::string& name) const {
    const auto line = [](const std::string& ours, const std::string& theirs) {
      return ours + " = { column = \"" + theirs + "\" }";
    };
    std::string out = line(angle_column(name, true), angle_column(name, false));
    const auto ours = input_columns(name, true), theirs = input_columns(name, false);
    for (std::size_t i = 0; i < ours.size(); ++i)
      if (columns_.contains(theirs[i]) && !columns_.contains(ours[i])) out += ", " + line(ours[i], theirs[i]);
    return out;
  }
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
  /// Names of one kind of joint: the URDF's that have no column, and the log's that no joint has.
  struct Names {
    std::vector<JointName> ours, theirs;
    std::vector<bool> ours_left, theirs_left;
  };
  Names names(const std::vector<std::string>& all, bool prismatic) const {
    Names out;
    for (const std::string& name : foreign(prismatic)) out.theirs.emplace_back(name);
    for (const std::string& name : all)
      if (const UrdfJoint* j = joint(name); j != nullptr && slides(*j) == prismatic && !has_column(*j))
        out.ours.emplace_back(name);
    for (const JointName& n : out.ours) out.ours_left.push_back(!out_.logged.contains(n.name()));
    for (const JointName& n : out.theirs)
      out.theirs_left.push_back(std::none_of(out_.logged.begin(), out_.logged.end(),
                                             [&](const auto& pair) { return pair.second == n.name(); }));
    return out;
  }
  /// The one name of the log that is alike, where it is that of no other joint either.
  static std::optional<std::size_t> only_one(const Names& n, std::size_t way, std::size_t our) {
    const bool among_all = way >= Likeness::kLessSaid;
    std::optional<std::size_t> found;
    for (std::size_t k = 0; k < n.theirs.size(); ++k) {
      if (!(among_all || n.theirs_left[k]) || !Likeness::alike(way, n.ours[our], n.theirs[k])) continue;
      if (found) return std::nullopt;
      found = k;
    }
    if (!found || !n.theirs_left[*found]) return std::nullopt;
    for (std::size_t i = 0; i < n.ours.size(); ++i)
      if (i != our && (among_all || n.ours_left[i]) && Likeness::alike(way, n.ours[i], n.theirs[*found]))
        return std::nullopt;
    return found;
  }
  void match(const std::vector<std::string>& all) {
    for (const bool prismatic : {false, true}) {
      Names n = names(all, prismatic);
      if (n.ours.empty() || n.theirs.empty()) continue;
      for (std::size_t way = 0; way < Likeness::kAsked; ++way) {
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        std::set<std::vector<std::string>> sides;
        for (std::size_t i = 0; i < n.ours.size(); ++i)
          if (n.ours_left[i])
            if (const auto k = only_one(n, way, i)) {
              pairs.emplace_back(i, *k);
              sides.insert(Likeness::further_sides(n.ours[i], n.theirs[*k]));
            }
        // A side that names of one robot leave out is one: "hip" and "knee" are not "left_hip" and "right_knee".
        if (way + 1 == Likeness::kAsked && sides.size() > 1) continue;
        for (const auto& [i, k] : pairs) {
          out_.logged.emplace(n.ours[i].name(), n.theirs[k].name());
          n.ours_left[i] = n.theirs_left[k] = false;
        }
      }
      for (std::size_t i = 0; i < n.ours.size(); ++i) {
        if (!n.ours_left[i]) continue;
        for (std::size_t k = 0; k < n.theirs.size(); ++k)
          for (std::size_t way = 0; way < Likeness::kWays && n.theirs_left[k]; ++way)
            if (Likeness::alike(way, n.ours[i], n.theirs[k])) {
              could_be_[n.ours[i].name()].push_back(n.theirs[k].name());
              break;
            }
      }
    }
  }
  /// Lines of a map file for a joint's columns: its angle, and what else the log has of it.
  std::string lines_for(const std::string& name, const std::string& other, bool prismatic) const {
    const auto line = [](const std::string& ours, const std::string& theirs) {
      return ours + " = { column = \"" + theirs + "\" }";
    };
    std::string out = line(angle_column(name, prismatic), angle_column(other, prismatic));
    const auto ours = input_columns(name, prismatic), theirs = input_columns(other, prismatic);
    for (std::size_t i = 0; i < ours.size(); ++i)
      if (columns_.contains(theirs[i])) out += ", " + line(ours[i], theirs[i]);
    return out;
  }
  /// For those that are left: the pairs that are most alike together. Those with nothing in common go in their order, if there are as many on both sides.
  void propose(const std::vector<std::string>& all) {
    std::vector<std::string> lines;
    for (const bool prismatic : {false, true}) {
      const Names n = names(all, prismatic);
      std::vector<std::size_t> ours, theirs;
      for (std::size_t i = 0; i < n.ours.size() && ours.size() < model::kMostJoints; ++i)
        if (n.ours_left[i]) ours.push_back(i);
      for (std::size_t k = 0; k < n.theirs.size(); ++k)
        if (n.theirs_left[k]) theirs.push_back(k);
      std::vector<std::vector<double>> weights;
      for (const std::size_t i : ours) {
        weights.emplace_back();
        for (const std::size_t k : theirs) weights.back().push_back(similarity(n.ours[i], n.theirs[k]));
      }
      auto pairs = best_assignment(weights);
      std::vector<std::size_t> rest_of_ours, rest_of_theirs;
      for (std::size_t i = 0; i < ours.size(); ++i)
        if (!pairs[i] && !could_be_.contains(n.ours[ours[i]].name())) rest_of_ours.push_back(i);
      for (std::size_t k = 0; k < theirs.size(); ++k)
        if (std::find(pairs.begin(), pairs.end(), std::optional(k)) == pairs.end())
          rest_of_theirs.push_back(k);
      if (rest_of_ours.size() == rest_of_theirs.size())
        for (std::size_t i = 0; i < rest_of_ours.size(); ++i) pairs[rest_of_ours[i]] = rest_of_theirs[i];
      for (std::size_t i = 0; i < ours.size(); ++i) {
        if (!pairs[i]) continue;
        const std::string &name = n.ours[ours[i]].name(), &other = n.theirs[theirs[*pairs[i]]].name();
        std::string line = lines_for(name, other, prismatic);
        if (const auto could = could_be_.find(name); could != could_be_.end())
          for (const std::string& one : could->second)
            if (one != other) {
              line += " (or those of " + core::quoted(one) + ")";
              break;
            }
        lines.push_back(std::move(line));
      }
    }
    if (!lines.empty()) set_lines(lines);
    if (lines.empty() && out_.logged.empty()) show_form(all);
  }
  /// What a line looks like, where nothing tells which column is whose.
  void show_form(const std::vector<std::string>& all) {
    for (const bool prismatic : {false, true}) {
      const Names n = names(all, prismatic);
      if (n.ours.empty() || n.theirs.empty()) continue;
      std::vector<std::string> theirs;
      for (const JointName& name : n.theirs) theirs.push_back(core::quoted(name.name()));
      out_.map_lines =
          lines_for(n.ours.front().name(), "NAME", prismatic) + " with NAME one of " + listed(theirs);
      return;
    }
  }
  /// A log that counts from 0 joints that the URDF counts from 1 has columns of nearly all of them, and each is another's. Where it has a number
  /// before the first and lacks the last, all are wanted, and lines for a map file are given.
  bool count_from_another(const std::vector<std::string>& all) {
    std::map<std::string, std::map<long, std::string>> ours;
    const auto parts = [](const std::string& name) -> std::pair<std::string, long> {
      std::size_t at = name.size();
      while (at > 0 && std::isdigit(static_cast<unsigned char>(name[at - 1])) != 0 && name.size() - at < 4)
        --at;
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
          lines.push_back(lines_for(name, stem + std::to_string(n - 1), prismatic));
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
      out_.map_lines += " and the like of " + std::to_string(lines.size() - shown) + " more joints";
  }
  static std::string needs(const UrdfJoint& j) {
    const auto [measured, told, set_point] = input_columns(j.name, slides(j));
    return "the recordings have no column of it; expected " + angle_column(j.name, slides(j)) + ", and " +
           measured + " or " + told + " (with control_mode \"position\" " + set_point +
           "), under these names or by a --map file";
  }
  /// Says which joints move, and which do not that could.
  void take(const std::vector<std::string>& chosen, const std::map<std::string, double>& hold) {
    const std::set<std::string> moving(chosen.begin(), chosen.end());
    std::vector<std::string> taken, held, tied;
    std::string line;
    for (const UrdfJoint& j : robot_.joints) {
      if (!can_move(j) || hold.contains(j.name)) continue;
      if (moving.contains(j.name)) {
        taken.push_back(core::quoted(j.name));
        line += (line.empty() ? "\"" : ", \"") + j.name + "\"";
        out_.moving.push_back(j.name);
        continue;
      }
      const std::vector<std::string> its = followers(robot_, j.name);
      const bool is_tied = !j.mimics.empty() || !its.empty();
      (is_tied ? tied : held).push_back(core::quoted(j.name));
      out_.held[j.name] = !j.mimics.empty() ? "it mimics " + core::quoted(j.mimics)
                          : is_tied         ? "it is mimicked by " + model::first_names(its)
                                            : needs(j);
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
  std::map<std::string, std::vector<std::string>>
      could_be_;  ///< of joints without a column: names of the log that are alike
  JointChoice out_;
};

}  // namespace

JointChoice choose_joints(const Urdf& robot, const std::vector<std::string>& wanted,
                          const std::map<std::string, double>& hold,
                          const std::vector<std::string>& columns) {
  return Chooser(robot, columns).choose(wanted, hold);
}

std::vector<std::string> notes_on_held(const TreeModel& m, const std::vector<const log::Log*>& logs) {
  std::vector<std::string> out;
  for (const UrdfJoint& j : m.urdf.joints) {
    const auto is_it = [&](const model::RobotTree::Joint& moving) { return moving.name == j.name; };
    if (!can_move(j) || std::any_of(m.robot.joints.begin(), m.robot.joints.end(), is_it)) continue;
    const std::string column = angle_column(j.name, slides(j)), unit = slides(j) ? " m" : " rad";
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const log::Log* log : logs)
      if (const auto found = log->columns.find(column); found != log->columns.end())
        for (const double x : found->second)
          if (std::isfinite(x)) {
            least = std::min(least, x);
            most = std::max(most, x);
          }
    if (!(least <= most)) continue;
    const auto hold = m.hold.find(j.name);
    const std::vector<std::string> its = followers(m.urdf, j.name);
    std::string note =
        "Joint " + core::quoted(j.name) + " is held at " +
        core::rounded(hold == m.hold.end() ? 0.0 : hold->second) + unit +
        ", and the recordings have it from " + core::rounded(least) + " to " + core::rounded(most) + unit +
        ": " + core::quoted(column) +
        " is not used, and what its motion does to the others is missing. Where it stands still, ";
    note += hold == m.hold.end()
                ? "write " + toml_key(j.name) + " = " + core::rounded(0.5 * (least + most)) +
                      " in [locked_joints]. To let it move, "
                : "correct it in [locked_joints]. To let it move, take it out of [locked_joints], and ";
    if (!j.mimics.empty())
      note += "take its <mimic> of " + core::quoted(j.mimics) + " out of the URDF.";
    else if (!its.empty())
      note += "take the <mimic> of " + model::first_names(its) + " out of the URDF; " +
              (its.size() == 1 ? "that is" : "those are") + " then held.";
    else
      note += "name it in joints = [...] in [model].";
    out.push_back(std::move(note));
  }
  return out;
}

}  // namespace furcula::trees
