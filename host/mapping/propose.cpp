// See propose.hpp.
#include "host/mapping/propose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/identify/conventions.hpp"
#include "host/identify/recording.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/machines/rules.hpp"
#include "host/mapping/names.hpp"
#include "host/mapping/raw_log.hpp"
#include "host/mapping/velocities.hpp"
#include "host/trees/conventions.hpp"
#include "host/trees/joint_names.hpp"
#include "host/trees/recording.hpp"

namespace furcula::mapping {
namespace {

/// Angles of robots beyond this are in degrees rather than in rad.
constexpr double kMostRad = 25.0;
/// Whole numbers that span more are counts of an encoder rather than degrees.
constexpr double kMostDegrees = 1000.0;
/// With less of the joints' force unexplained the columns are right (host/conventions/trial.cpp asks about other readings beyond).
constexpr double kFits = 0.2;
constexpr int kRounds = 3;

/// A joint and a column of ours that the model wants of it.
struct Slot {
  std::string joint;  ///< empty: the machine has one
  std::string ours;
  Role role;
  bool command = false, linear = false, required = false;
};

struct Candidate {
  std::string column;
  Meaning meaning;
};

struct Match {
  double weight = 0.0;
  Sureness sureness = Sureness::sure;
  std::string why;
};

/// The number that stands alone for a joint: "1" of "joint1_pos".
std::optional<int> number_in(const std::string& joint) {
  std::string digits;
  for (const std::string& w : trees::words_of(joint)) {
    if (w.empty() || std::isdigit(static_cast<unsigned char>(w.front())) == 0) {
      static const std::set<std::string> kSaysJoint{"joint", "jnt", "j", "axis", "id"};
      if (!kSaysJoint.contains(w)) return std::nullopt;
    } else if (!digits.empty()) {
      return std::nullopt;
    } else {
      digits = w;
    }
  }
  if (digits.empty() || digits.size() > 4) return std::nullopt;
  return std::stoi(digits);
}

class Names {
 public:
  Names(const RawLog& raw, std::vector<std::string> joints) : joints_(std::move(joints)) {
    for (const std::string& c : raw.columns) {
      candidates_.push_back({c, meaning_of(c)});
      if (const auto named = raw.joint_of.find(c); named != raw.joint_of.end())
        candidates_.back().meaning.joint = named->second;
    }
    for (const std::string& j : joints_) names_.emplace_back(j);
    // Joints that are numbered from 1, or from 0.
    for (const Candidate& c : candidates_)
      if (c.meaning.role == Role::position)
        if (const auto n = number_in(c.meaning.joint)) first_ = std::min(first_.value_or(*n), *n);
  }

  /// The columns of these slots of one kind, one each.
  std::vector<std::optional<std::pair<Candidate, Match>>> assign(const std::vector<Slot>& slots) const {
    std::vector<std::vector<double>> weights(slots.size(), std::vector<double>(candidates_.size()));
    std::vector<std::optional<std::pair<Candidate, Match>>> out(slots.size());
    if (candidates_.empty()) return out;
    for (std::size_t s = 0; s < slots.size(); ++s)
      for (std::size_t c = 0; c < candidates_.size(); ++c)
        weights[s][c] = match(slots[s], candidates_[c]).weight;
    const auto chosen = trees::best_assignment(weights);
    for (std::size_t s = 0; s < slots.size(); ++s)
      if (chosen[s]) out[s] = {candidates_[*chosen[s]], match(slots[s], candidates_[*chosen[s]])};
    return out;
  }

 private:
  Match match(const Slot& slot, const Candidate& c) const {
    if (c.column == slot.ours) return {10.0, Sureness::sure, "has this name"};
    const Meaning& m = c.meaning;
    const bool current = slot.role == Role::effort && m.role == Role::current;
    if ((m.role != slot.role && !current) || m.command != slot.command) return {};
    Match out = joint_match(slot.joint, m.joint);
    if (out.weight > 0.0 && current) {
      out.weight *= 0.3;
      out.sureness = Sureness::guess;
      out.why += "; a current stands for the torque";
    }
    return out;
  }

  Match joint_match(const std::string& joint, const std::string& words) const {
    if (joint.empty() || joints_.size() == 1) {
      if (words.empty() || number_in(words))
        return {1.0, Sureness::sure, "the only such column of the only joint"};
      if (joint.empty()) return {0.5, Sureness::likely, "of the only joint, called " + core::quoted(words)};
    }
    if (words.empty()) return {};
    const trees::JointName of_log(words);
    const auto at =
        static_cast<std::size_t>(std::find(joints_.begin(), joints_.end(), joint) - joints_.begin());
    for (std::size_t way = 0; way < trees::Likeness::kWays; ++way)
      if (trees::Likeness::alike(way, names_[at], of_log)) {
        const bool plain = way < trees::Likeness::kLessSaid;
        return {1.0 - 0.1 * static_cast<double>(way), plain ? Sureness::sure : Sureness::likely,
                "joint " + core::quoted(joint) + (plain ? " by name" : " by a name that is alike")};
      }
    if (const auto n = number_in(words); n && first_ && *n - *first_ == static_cast<int>(at) && !numbered())
      return {0.3, Sureness::guess,
              "joint " + core::quoted(joint) + " by number: number " + std::to_string(*n) +
                  " is taken for the model's joint " + std::to_string(at + 1)};
    const double like = trees::similarity(names_[at], of_log);
    if (like < 0.5) return {};
    return {0.2 * like, Sureness::guess,
            "joint " + core::quoted(joint) + " by a name that is somewhat alike"};
  }

  /// Whether the model's joints have numbers of their own.
  bool numbered() const {
    return std::all_of(joints_.begin(), joints_.end(),
                       [](const std::string& j) { return number_in(j).has_value(); });
  }

  std::vector<std::string> joints_;
  std::vector<trees::JointName> names_;
  std::vector<Candidate> candidates_;
  std::optional<int> first_;
};

bool whole(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return x == std::round(x); });
}

/// The unit by name, else by the range of the values.
void settle_unit(const Slot& slot, const Meaning& m, const std::vector<double>* values, Line& line) {
  double& scale = line.column.parts.front().scale;
  const double si = si_of(slot.role, m.unit, slot.linear);
  if (si > 0.0) {
    scale = si;
    line.why.push_back(m.unit_usual ? "drives of this kind count " + m.unit : "its name says " + m.unit);
    if (m.unit_usual) line.sureness = std::max(line.sureness, Sureness::likely);
    return;
  }
  if (values == nullptr || values->empty()) return;
  const auto [low, high] = std::minmax_element(values->begin(), values->end());
  const double most = std::max(std::abs(*low), std::abs(*high));
  const std::string range = core::rounded(*low, 3) + " to " + core::rounded(*high, 3);
  if (m.role == Role::current) {
    line.why.push_back("in A: the scale is the torque constant times the gear ratio, N m/A");
  } else if (slot.role == Role::position && !slot.linear &&
             (m.unit.starts_with("count") || m.unit == "ticks" ||
              (whole(*values) && *high - *low > kMostDegrees))) {
    line.sureness = Sureness::guess;
    line.why.push_back("whole numbers from " + range +
                       ": counts of an encoder; the scale is 2 pi / counts a turn");
  } else if (slot.role == Role::position && !slot.linear && most > kMostRad) {
    scale = std::numbers::pi / 180.0;
    line.sureness = Sureness::guess;
    line.why.push_back("values from " + range + " are taken for degrees");
  } else {
    line.why.push_back("values from " + range + " are taken as they are");
    if (m.unit.empty() && line.why.front() != "has this name")
      line.sureness = std::max(line.sureness, Sureness::likely);
  }
}

log::ColumnMap map_of(const Proposal& p) {
  log::ColumnMap map;
  map.path = "the proposed map";
  map.rig = p.rig;
  for (const Line& line : p.lines) map.columns[line.ours] = line.column;
  if (p.decimal == ',') map.separator = p.separator, map.decimal = p.decimal;
  map.all_topics = true;
  return map;
}

/// Fills in lines for slots of one kind after the other.
void add_lines(const Names& names, const std::vector<std::vector<Slot>>& kinds, const RawLog& raw,
               Proposal& out) {
  out.separator = raw.separator;
  out.decimal = raw.decimal;
  out.lines.push_back(
      {"time_s", raw.time, raw.time_sure ? Sureness::sure : Sureness::likely, {raw.time_why}});
  for (const std::vector<Slot>& slots : kinds) {
    const auto found = names.assign(slots);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (!found[i]) {
        if (slots[i].required) out.expected.push_back(slots[i].ours);
        continue;
      }
      const auto& [candidate, match] = *found[i];
      const auto values = raw.log.columns.find(candidate.column);
      Line line{slots[i].ours, {{{candidate.column, 1.0}}, 0.0, 0}, match.sureness, {match.why}};
      settle_unit(slots[i], candidate.meaning, values == raw.log.columns.end() ? nullptr : &values->second,
                  line);
      out.lines.push_back(std::move(line));
    }
  }
  std::set<std::string> used;
  for (const Line& line : out.lines)
    for (const log::MappedPart& p : line.column.parts) used.insert(p.column);
  for (const std::string& name : raw.columns)
    if (!used.contains(name)) out.left.push_back(name);
}

/// The map with what the trial has found of its columns.
void apply(const conventions::Finding& f, Proposal& p) {
  const log::ColumnMap before = map_of(p), found = log::parse_column_map(f.map, "the trial");
  for (const auto& [ours, column] : found.columns) {
    const auto theirs = before.columns.find(column.parts.front().column);
    const auto line = std::find_if(p.lines.begin(), p.lines.end(),
                                   [&name = ours](const Line& l) { return l.ours == name; });
    if (theirs == before.columns.end() || line == p.lines.end()) continue;
    const double scale = column.parts.front().scale;
    line->column = theirs->second;
    for (log::MappedPart& part : line->column.parts) part.scale *= scale;
    line->column.offset = theirs->second.offset * scale + column.offset;
    line->sureness = f.what.ends_with('?') ? Sureness::guess : Sureness::likely;
    line->why.push_back("the equation of motion says: " + f.what);
  }
}

/// Of the joints that the model moves, ours.
struct JointColumns {
  std::vector<std::string> position, velocity, input;
};

/// The line of a position or input of ours.
Line* line_of(Proposal& p, const std::string& ours) {
  const auto found =
      std::find_if(p.lines.begin(), p.lines.end(), [&](const Line& l) { return l.ours == ours; });
  return found == p.lines.end() ? nullptr : &*found;
}

/// The map with what all joints' equations say together. @return whether they say anything
bool apply(const JointColumns& of, const conventions::JointReadings& r, Proposal& p) {
  std::set<std::string> changed;
  const auto multiply = [&](const std::string& ours, const conventions::ColumnReading& by) {
    Line* line = line_of(p, ours);
    if (line == nullptr || by.scale == 1.0) return;
    for (log::MappedPart& part : line->column.parts) part.scale *= by.scale;
    line->column.offset *= by.scale;
    line->sureness = std::max(line->sureness, by.estimated || !r.sure ? Sureness::guess : Sureness::likely);
    line->why.push_back("the equation of motion of all joints says: " + by.what);
    changed.insert(ours);
  };
  for (std::size_t j = 0; j < r.position.size(); ++j) {
    multiply(of.position[j], r.position[j]);
    multiply(of.input[j], r.input[j]);
  }
  if (!changed.empty())
    p.confirm.push_back("Found by the equation of motion of all joints: other signs or units of " +
                        quoted_list({changed.begin(), changed.end()}) + "." +
                        (r.sure ? "" : " With large friction beside the model they may be as named."));
  for (const std::vector<std::string>& columns : r.same) {
    bool any = false;
    for (const std::string& ours : columns) any = any || changed.contains(ours);
    for (const std::string& ours : columns)
      if (Line* line = line_of(p, ours); line != nullptr && any) line->sureness = Sureness::guess;
    p.confirm.push_back("The motion does not show the signs of " + quoted_list(columns) +
                        ": with the other sign on all of these it would be the same.");
  }
  return !changed.empty();
}

/// Whether a name says the unit, or it is one of ours.
bool unit_is_named(const Line& line) {
  return line.why.size() > 1 && line.why[1].starts_with("its name says");
}

/// Positions and velocities in units in which one is the slope of the other. At first a position's unit may be what its velocity says; in the
/// end, when the equation of motion has been asked, velocities follow positions.
void settle_velocities(const RawLog& raw, const JointColumns& of, bool in_the_end, Proposal& p) {
  std::vector<double> time_s = raw.log.time_s();
  for (double& t : time_s) t *= raw.time.parts.front().scale;
  for (std::size_t j = 0; j < of.position.size(); ++j) {
    Line *position = line_of(p, of.position[j]), *velocity = line_of(p, of.velocity[j]);
    if (position == nullptr || velocity == nullptr) continue;
    const auto values = [&](const Line& line) {
      const log::MappedPart& part = line.column.parts.front();
      std::vector<double> out = raw.log.at(part.column);
      for (double& x : out) x *= part.scale;
      return out;
    };
    const auto found = velocity_factor(time_s, values(*position), values(*velocity));
    if (!found) continue;
    const bool of_position = !in_the_end && found->factor > 0.0 && !found->what.empty() &&
                             !unit_is_named(*position) &&
                             (unit_is_named(*velocity) || found->what.ends_with("rad/s"));
    if (!in_the_end && !of_position) continue;
    Line& line = of_position ? *position : *velocity;
    const double by = of_position ? found->factor : 1.0 / found->factor;
    for (log::MappedPart& part : line.column.parts) part.scale *= by;
    line.sureness = found->what.empty() ? Sureness::guess : std::max(line.sureness, Sureness::likely);
    line.why.push_back("the velocity is " + core::rounded(found->factor, 4) + " times the position's slope" +
                       (found->what.empty() ? "" : ": " + found->what));
  }
}

std::string percent(double share) { return core::rounded(100.0 * share, 2) + " %"; }

/// Asks the trial until it has nothing to say. `find` reads the log under the map.
template <class Find, class Judge, class Together>
void try_conventions(Proposal& p, const std::vector<std::string>& joints, const Find& find,
                     const Judge& judge, const Together& together) {
  together();
  for (int round = 0; round < kRounds; ++round) {
    const std::optional<conventions::Finding> f = find(map_of(p));
    if (!f) break;
    std::string also;
    for (const std::string& same : f->same) also += " The log would be the same with " + same + ".";
    for (const std::string& other : f->others) also += " Nearly as good: " + other + ".";
    p.confirm.push_back(
        (f->map.empty() ? "No map can mend this, the model can: " : "Found by the equation of motion: ") +
        f->what + (f->what.ends_with('?') ? "" : ".") + also);
    if (f->map.empty()) break;
    apply(*f, p);
  }
  conventions::AsNamed fits = judge(map_of(p));
  const auto poor = [](double off) { return off >= kFits; };
  // With a zero or an exchange mended all signs may be seen.
  if (fits.asked && std::any_of(fits.off.begin(), fits.off.end(), poor) && together())
    fits = judge(map_of(p));
  if (!fits.asked) {
    p.confirm.push_back(
        "Signs, zeros and units could not be tried: there is too little motion in the log, or a column is missing.");
    return;
  }
  for (std::size_t j = 0; j < fits.off.size(); ++j) {
    const std::string of = joints[j].empty() ? "the force" : "the force of " + core::quoted(joints[j]);
    p.confirm.push_back(
        "So read, " + percent(fits.off[j]) + " of " + of + " (RMS) stays unexplained" +
        (fits.off[j] < kFits ? "." : ": look at sign, zero and unit of its columns, and at the model."));
  }
}

[[noreturn]] void refuse(const RawLog& raw, const std::string& path, const std::string& expected) {
  throw core::DataError(path + ": no column is the position of a joint by its name; it has " +
                        quoted_list(raw.columns) + "; expected " + expected + ", or names of that kind");
}

bool has_position(const Proposal& p, const std::vector<Slot>& positions) {
  return std::any_of(positions.begin(), positions.end(), [&](const Slot& s) {
    return std::any_of(p.lines.begin(), p.lines.end(), [&](const Line& l) { return l.ours == s.ours; });
  });
}

}  // namespace

Proposal propose(const std::string& path, const TreeReader& read_model) {
  const RawLog raw = read_raw(path);
  const trees::TreeModel model = read_model({});
  std::vector<std::string> joints;
  std::vector<Slot> positions, inputs, commands, velocities;
  for (std::size_t j = 0; j < model.joints(); ++j) {
    const std::string& name = model.robot.joints[j].name;
    const bool linear = model.prismatic(j), sets = model.drives[j].law == trees::ControlMode::position;
    joints.push_back(name);
    positions.push_back({name, trees::column_of(model, j, "angle"), Role::position, false, linear, true});
    velocities.push_back(
        {name, trees::column_of(model, j, "velocity"), Role::velocity, false, linear, false});
    if (!model.driven(j)) continue;
    if (sets) {
      inputs.push_back({name, trees::column_of(model, j, "angle_cmd"), Role::position, true, linear, true});
      continue;
    }
    inputs.push_back({name, trees::column_of(model, j, "torque"), Role::effort, false, linear, false});
    commands.push_back({name, trees::column_of(model, j, "torque_cmd"), Role::effort, true, linear, false});
  }
  Proposal out;
  out.log = path;
  out.rig = "tree";
  add_lines(Names(raw, joints), {positions, inputs, commands, velocities}, raw, out);
  if (!has_position(out, positions)) {
    std::vector<std::string> names;
    for (const Slot& s : positions) names.push_back(s.ours);
    refuse(raw, path, quoted_list(names));
  }
  const auto has = [&](const std::string& ours) {
    return std::any_of(out.lines.begin(), out.lines.end(), [&](const Line& l) { return l.ours == ours; });
  };
  for (std::size_t i = 0; i < commands.size(); ++i)
    for (const Slot& s : inputs)
      if (s.joint == commands[i].joint && !has(s.ours) && !has(commands[i].ours))
        out.expected.push_back(s.ours + " or " + commands[i].ours);
  JointColumns moving_columns;
  try {
    std::vector<std::string> columns, moving;
    for (const Line& l : out.lines) columns.push_back(l.ours);
    const trees::TreeModel with = read_model(columns);
    for (std::size_t j = 0; j < with.joints(); ++j) {
      moving.push_back(with.robot.joints[j].name);
      moving_columns.position.push_back(trees::column_of(with, j, "angle"));
      moving_columns.velocity.push_back(trees::column_of(with, j, "velocity"));
      const bool sets = with.drives[j].law == trees::ControlMode::position;
      const std::string torque = trees::column_of(with, j, "torque");
      moving_columns.input.push_back(sets          ? trees::column_of(with, j, "angle_cmd")
                                     : has(torque) ? torque
                                                   : trees::column_of(with, j, "torque_cmd"));
    }
    settle_velocities(raw, moving_columns, false, out);
    const auto recordings = [&](const log::ColumnMap& map) {
      return std::vector<trees::Recording>{trees::recording_of(with, log::read_log(path, "tree", &map))};
    };
    try_conventions(
        out, moving, [&](const log::ColumnMap& map) { return trees::find_convention(with, recordings(map)); },
        [&](const log::ColumnMap& map) { return trees::as_named(with, recordings(map)); },
        [&] {
          const auto found = trees::find_joint_readings(with, recordings(map_of(out)));
          return found && apply(moving_columns, *found, out);
        });
  } catch (const core::DataError& e) {
    out.confirm.push_back(std::string("Signs, zeros and units could not be tried: ") + e.what());
  }
  settle_velocities(raw, moving_columns, true, out);
  return out;
}

Proposal propose(const std::string& path, const model::Model& model) {
  const RawLog raw = read_raw(path);
  const machines::Rules& rules = machines::rules(model.kind);
  Proposal out;
  out.log = path;
  out.rig = dynamics::info(model.kind).rig;
  const auto required = [&](std::string_view name) {
    const log::ColumnInfo* c = log::machine_type_named(out.rig)->column(name);
    return c != nullptr && c->required;
  };
  std::vector<std::vector<Slot>> kinds;
  const auto add = [&](std::string_view ours, Role role, bool linear) {
    if (!ours.empty())
      kinds.push_back(
          {{"", std::string(ours), role, ours.find("_cmd") != ours.npos, linear, required(ours)}});
  };
  const machines::Columns& c = rules.columns;
  const bool rotary = dynamics::info(model.kind).rotary;
  add(c.position, Role::position, !rotary);
  add(c.input, rules.cut == machines::Cut::releases ? Role::coil : Role::effort, c.input.ends_with("_n"));
  add(c.command, Role::effort, c.command.ends_with("_n"));
  add(c.report, Role::effort, c.report.ends_with("_n"));
  add(c.velocity, Role::velocity, !rotary);
  add(c.touchdown, Role::contact, false);
  add(c.stop, Role::contact, false);
  add(c.coil, Role::coil, false);
  const std::vector<Slot> position = kinds.front();
  add_lines(Names(raw, {""}), kinds, raw, out);
  if (!has_position(out, position)) refuse(raw, path, core::quoted(position.front().ours));
  if (!out.expected.empty()) return out;
  const auto recordings = [&](const log::ColumnMap& map) {
    return identify::make_recordings({log::read_log(path, out.rig, &map)}, model.kind);
  };
  try {
    try_conventions(
        out, {""},
        [&](const log::ColumnMap& map) { return identify::find_convention(model, recordings(map)); },
        [&](const log::ColumnMap& map) { return identify::as_named(model, recordings(map)); },
        [] { return false; });
  } catch (const core::DataError& e) {
    out.confirm.push_back(std::string("Signs, zeros and units could not be tried: ") + e.what());
  }
  return out;
}

}  // namespace furcula::mapping
