// Model files of trees, see model.hpp.
#include "host/trees/model.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <tuple>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/mjcf_reader.hpp"
#include "host/model/robot_file.hpp"
#include "host/model/urdf_filter.hpp"
#include "host/trees/inertial.hpp"
#include "host/trees/joint_choice.hpp"
#include "host/trees/recording.hpp"

namespace furcula::trees {
namespace {

using core::fail;
using core::shortest;

constexpr double kMost = 1e9;
/// Slower ones are no position law of a joint: half a period would be 10 ms.
constexpr double kLeastLoop_hz = 50.0;
constexpr std::string_view kInertial = "inertial";
constexpr std::array<std::string_view, 3> kLaws{"torque", "position", "none"};  // as ControlMode

/// Of a robot itself, which stands for a model file that names it and says no more.
bool is_robot(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != text.npos && text[first] == '<';
}
std::string text_of(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "\"";
}
std::string as_model_file(std::string_view text, const std::string& path) {
  if (!is_robot(text)) return std::string(text);
  const std::string file = std::filesystem::path(path).filename().string();
  // Of an MJCF the actuators say what the drives are told.
  return "[model]\nkind = \"tree\"\nschema = 1\nurdf = " + text_of(core::printable(file)) + "\n" +
         (model::is_mjcf(text) ? "" : "[drive]\ncontrol_mode = \"torque\"\n");
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& path, const TreeContext& context)
      : name_(path), file_(core::parse_toml(as_model_file(text, path), path)), columns_(context.columns) {
    core::rename_key(file_, "hold", "locked_joints");
    if (toml::table* drives = file_["drive"].as_table()) {
      if (!drives->contains("law") || !drives->get("law")->is_table())
        core::rename_key(*drives, "law", "control_mode");
      for (auto&& [joint, drive] : *drives)
        if (toml::table* of_joint = drive.as_table()) core::rename_key(*of_joint, "law", "control_mode");
    }
    model_.file = path;
    model_.urdf_text = context.urdf;
    model_.accept_inertias = context.accept_inertias;
  }

  TreeModel read() {
    static constexpr std::array<std::string_view, 8> kSections{"model", "locked_joints", "drive", "spring",
                                                               "foot",  "sensors",       "free",  "effect"};
    core::refuse_unknown_keys(file_, name_, "the model file of a tree", kSections);
    read_robot();
    read_drives();
    require_inertia();
    read_springs();
    if (const toml::node* feet = file_.get("foot")) read_foot(core::table(*feet, name_, "[foot]"));
    if (const toml::node* sensors = file_.get("sensors")) {
      static constexpr std::array<std::string_view, 2> kKeys{"angle_noise_rad", "torque_noise_nm"};
      const toml::table& table = core::table(*sensors, name_, "[sensors]");
      core::refuse_unknown_keys(table, name_, "[sensors]", kKeys);
      if (const toml::node* noise = table.get(kKeys.front()))
        model_.angle_noise_rad = core::number(*noise, name_, "[sensors] angle_noise_rad", 1e-9, 1.0,
                                              "rad (m of a prismatic joint)");
      if (const toml::node* noise = table.get(kKeys.back()))
        model_.torque_noise_nm = core::number(*noise, name_, "[sensors] torque_noise_nm", 1e-9, 1e6,
                                              "N m (N of a prismatic joint)");
    }
    if (const toml::node* free = file_.get("free")) read_free(core::table(*free, name_, "[free]"));
    if (const toml::node* effects = file_.get("effect"))
      read_effects(core::table(*effects, name_, "[effect]"));
    for (const auto& [joint, keys] : of_held_)
      model_.notes.push_back("Not used: " + model::first_names(keys) + ". Joint " + core::quoted(joint) +
                             " is held at 0: " + held_.at(joint) + ".");
    return std::move(model_);
  }

 private:
  void read_robot() {
    static constexpr std::array<std::string_view, 8> kKeys{
        "kind", "schema", "urdf", "mjcf", "base", "joints", "gravity_mps2", "accept_inertias"};
    const toml::node* section = file_.get("model");
    if (section == nullptr) fail(name_, file_.source(), "no section [model]; expected one");
    const toml::table& table = core::table(*section, name_, "[model]");
    core::refuse_unknown_keys(table, name_, "[model] of a tree", kKeys);
    const toml::node* schema = table.get("schema");
    if (schema == nullptr) fail(name_, table.source(), "no key 'schema' in [model]; expected schema = 1");
    if (!schema->is_integer() || schema->value<std::int64_t>() != 1)
      fail(name_, schema->source(), "schema = " + core::value_text(*schema) + "; expected 1");
    if (const toml::node* base = table.get("base"))
      if (const std::string which = core::text(*base, name_, "base"); which != "fixed")
        fail(name_, base->source(),
             "base = " + core::quoted(which) + "; expected \"fixed\" (this version has no floating base)");
    const toml::node *urdf = table.get("urdf"), *mjcf = table.get("mjcf");
    if (urdf != nullptr && mjcf != nullptr)
      fail(name_, mjcf->source(), "[model] has both urdf and mjcf; expected one of them, the robot's file");
    const std::string key = urdf == nullptr ? "mjcf" : "urdf";
    if (urdf == nullptr) urdf = mjcf;
    if (urdf == nullptr)
      fail(name_, table.source(),
           "no key 'urdf' in [model]; expected the URDF's file name, or mjcf and an MJCF's");
    model_.urdf_path = core::text(*urdf, name_, key);
    // It begins messages about the file.
    if (core::printable(model_.urdf_path) != model_.urdf_path)
      fail(name_, urdf->source(),
           key + " = " + core::quoted(model_.urdf_path) + "; expected a file name of printable characters");
    if (const toml::node* joints = table.get("joints")) {
      const toml::array* list = joints->as_array();
      if (list == nullptr || list->empty())
        fail(name_, joints->source(),
             "joints = " + core::value_text(*joints) + "; expected names of joints that move");
      for (const toml::node& joint : *list) model_.moving.push_back(core::text(joint, name_, "joints"));
    }
    if (const toml::node* accept = table.get("accept_inertias")) {
      if (!accept->is_boolean())
        fail(name_, accept->source(),
             "accept_inertias = " + core::value_text(*accept) + "; expected true or false");
      model_.accept_inertias |= accept->value<bool>().value_or(false);
    }
    if (const toml::node* gravity = table.get("gravity_mps2")) {
      const toml::array* list = gravity->as_array();
      if (list == nullptr || list->size() != 3)
        fail(name_, gravity->source(),
             "gravity_mps2 = " + core::value_text(*gravity) + "; expected three numbers, x y z");
      const auto part = [&](std::size_t i) {
        return core::number((*list)[i], name_, "gravity_mps2", -100.0, 100.0, "m/s^2");
      };
      model_.gravity_mps2 = {part(0), part(1), part(2)};
    }
    if (const toml::node* hold = file_.get("locked_joints"))
      for (const auto& [joint, node] : core::table(*hold, name_, "[locked_joints]"))
        model_.hold[std::string(joint.str())] =
            core::number(node, name_, "[locked_joints] " + std::string(joint.str()), -1e3, 1e3, "rad or m");

    const auto beside = std::filesystem::path(name_).parent_path() / model_.urdf_path;
    model_.urdf = model_.urdf_text.empty() ? model::read_robot(beside.string())
                                           : model::parse_robot(model_.urdf_text, model_.urdf_path);
    if (model_.urdf.is_mjcf && !table.contains("gravity_mps2"))
      model_.gravity_mps2 = model_.urdf.gravity_mps2;
    JointChoice choice = choose_joints(model_.urdf, model_.moving, model_.hold, columns_);
    if (model_.moving.empty()) model_.moving = std::move(choice.moving);
    model_.logged_names = std::move(choice.logged);
    model_.map_lines = std::move(choice.map_lines);
    model_.notes = std::move(choice.notes);
    held_ = std::move(choice.held);
    model::TreeOptions options;
    options.accept_inertias = model_.accept_inertias;
    options.judge_motion = false;  // the rotors are not read yet
    model_.robot = model::tree_of(model_.urdf, model_.moving, model_.hold, options);
    model_.robot.model.gravity_mps2 = model_.gravity_mps2;
    refuse_shared_columns();
  }
  /// "torque_cmd_x_nm" is the command of a joint x, and the torque of a joint cmd_x.
  void refuse_shared_columns() const {
    static constexpr std::array<const char*, 5> kQuantities{"torque", "torque_cmd", "angle", "angle_cmd",
                                                            "velocity"};
    std::map<std::string, std::size_t> whose;
    for (std::size_t j = 0; j < model_.joints(); ++j)
      for (const char* quantity : kQuantities) {
        const auto [other, is_new] = whose.emplace(column_of(model_, j, quantity), j);
        if (is_new || other->second == j) continue;
        const std::string a = model_.robot.joints[other->second].name, b = model_.robot.joints[j].name;
        std::string rest;
        for (const auto& joint : model_.robot.joints)
          if (joint.name != b) rest += (rest.empty() ? "\"" : ", \"") + core::printable(joint.name) + "\"";
        throw core::DataError(
            model_.urdf.file + ": the joints " + core::quoted(a) + " and " + core::quoted(b) +
            " would have a column of a log in common, " + core::quoted(other->first) +
            "; expected names that do not begin with \"cmd_\": rename one in the URDF, or hold one (joints = [" +
            rest + "] in [model])");
      }
  }

  void require_inertia() {
    std::vector<double> rotors_kgm2;
    for (const Drive& drive : model_.drives) rotors_kgm2.push_back(drive.rotor_inertia_kgm2);
    model::require_joint_inertia(model_.robot, model_.urdf.file, rotors_kgm2);
    for (const auto* notes : {&model_.urdf.notes, &model_.robot.notes})
      model_.notes.insert(model_.notes.end(), notes->begin(), notes->end());
    if (!model_.urdf.is_mjcf) note_drives();
  }
  /// What extensions of the format say of drives is the model file's to say.
  void note_drives() {
    std::vector<std::string> rotors, springs;
    for (std::size_t i = 0; i < model_.joints(); ++i)
      for (const model::UrdfJoint& j : model_.urdf.joints) {
        if (j.name != model_.robot.joints[i].name) continue;
        if (j.rotor_inertia_kgm2 != 0.0 && model_.drives[i].rotor_inertia_kgm2 == 0.0)
          rotors.push_back("[drive." + toml_key(j.name) +
                           "] rotor_inertia_kgm2 = " + core::rounded(j.rotor_inertia_kgm2, 6));
        if (j.spring_nmprad != 0.0 &&
            (!file_["spring"].is_table() || !file_["spring"].as_table()->contains(j.name)))
          springs.push_back("[spring." + toml_key(j.name) +
                            "] stiffness_nmprad = " + core::toml_float(j.spring_nmprad) +
                            ", rest_rad = " + core::toml_float(j.spring_rest_rad));
      }
    if (!rotors.empty())
      model_.notes.push_back(
          "The URDF gives rotors an inertia, which is not used; the model file would say, at the joint: " +
          model::first_names(rotors) + ".");
    if (!springs.empty())
      model_.notes.push_back(
          "The URDF gives joints a spring, which is not used: missing torque may be this spring's. The model file would say: " +
          model::first_names(springs) +
          ". That spring pushes back above rest_rad alone, and the URDF's both ways: it is the same where the joint stays above rest_rad, "
          "and a model file has no other.");
  }

  /// The joint; none where it is held though the model file does not say so: then `who` is not used, and a note says why.
  std::optional<std::size_t> joint_named(const std::string& joint, const toml::source_region& where,
                                         const std::string& who) {
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < model_.joints(); ++i) {
      if (model_.robot.joints[i].name == joint) return i;
      names.emplace_back(model_.robot.joints[i].name);
    }
    if (held_.contains(joint)) {
      of_held_[joint].push_back(who);
      return std::nullopt;
    }
    std::vector<std::string_view> near = names;
    for (const auto& [held, why] : held_) near.emplace_back(held);
    fail(name_, where,
         who + ": no joint " + core::quoted(joint) + " that moves; expected one of " + core::listed(names) +
             (why_held(joint).empty() ? core::did_you_mean(joint, near) : why_held(joint)));
  }
  /// " (why)", of a joint of the robot that does not move because the model file or the URDF says so; else nothing.
  std::string why_held(const std::string& joint) const {
    for (const model::UrdfJoint& j : model_.urdf.joints) {
      if (j.name != joint) continue;
      if (model_.hold.contains(joint)) return " (it is in [locked_joints])";
      if (j.kind == model::UrdfJoint::Kind::fixed || j.kind == model::UrdfJoint::Kind::other)
        return " (it is " + core::printable(j.type) + ")";
      return " (it is held: joints in [model] does not name it)";
    }
    return {};
  }
  /// Whether a link stands still because of a joint that is held though the model file does not say so: then `who` is not used.
  bool is_of_held(const std::string& link, const std::string& who) {
    const auto& links = model_.urdf.links;
    std::size_t at = 0;
    while (at < links.size() && links[at].name != link) ++at;
    if (at == links.size() || model_.robot.links[at].joint >= 0) return false;
    for (bool up = true; up;) {
      up = false;
      for (const model::UrdfJoint& j : model_.urdf.joints) {
        if (j.child != at) continue;
        if (held_.contains(j.name)) {
          of_held_[j.name].push_back(who);
          return true;
        }
        at = j.parent;
        up = true;
        break;
      }
    }
    return false;
  }

  void read_drives() {
    model_.drives.resize(model_.joints());
    for (std::size_t i = 0; i < model_.joints(); ++i)
      model_.drives[i].damping_nmspr = model_.robot.model.laws[i].damping_nmspr;
    if (model_.urdf.is_mjcf) take_actuators();
    const toml::node* section = file_.get("drive");
    if (section == nullptr) return;
    const toml::table& table = core::table(*section, name_, "[drive]");
    for (Drive& drive : model_.drives) read_drive(table, "[drive]", drive);
    for (const auto& [key, node] : table) {
      const std::string joint(key.str());
      if (!node.is_table()) continue;
      const std::string where = "[drive." + joint + "]";
      const auto at = joint_named(joint, key.source(), where);
      Drive unused;
      read_drive(core::table(node, name_, where), where, at ? model_.drives[*at] : unused);
    }
    for (std::size_t i = 0; i < model_.joints(); ++i)
      if (model_.drives[i].law == ControlMode::position && model_.drives[i].kp_nmprad == 0.0)
        fail(name_, table.source(),
             "the drive of joint " + core::quoted(model_.robot.joints[i].name) +
                 " has control_mode \"position\" and no kp_nmprad; expected one above 0");
  }
  /// What the robot's own file says of drives, where [drive] does not.
  void take_actuators() {
    using Actuator = model::UrdfJoint::Actuator;
    for (std::size_t i = 0; i < model_.joints(); ++i) {
      Drive& drive = model_.drives[i];
      drive.rotor_inertia_kgm2 = model_.robot.model.laws[i].armature_kgm2;
      const model::UrdfJoint& joint = joint_in_file(i);
      if (joint.actuator == Actuator::none) drive.law = ControlMode::none;
      if (joint.actuator != Actuator::position) continue;
      drive.law = ControlMode::position;
      drive.kp_nmprad = joint.kp_nmprad;
      drive.kd_nmsprad = joint.kd_nmsprad;
    }
  }
  const model::UrdfJoint& joint_in_file(std::size_t i) const {
    return *std::find_if(model_.urdf.joints.begin(), model_.urdf.joints.end(),
                         [&](const model::UrdfJoint& j) { return j.name == model_.robot.joints[i].name; });
  }
  void read_drive(const toml::table& table, const std::string& where, Drive& drive) {
    std::vector<std::string_view> known{"control_mode", "loop_rate_hz"};
    known.insert(known.end(), kDriveParameters.begin(), kDriveParameters.end());
    for (const auto& [key, node] : table) {
      if (node.is_table() && where == "[drive]") continue;
      if (std::find(known.begin(), known.end(), key.str()) == known.end())
        fail(name_, key.source(),
             "unknown key " + core::quoted(key.str()) + " in " + where + "; expected one of " +
                 core::listed(known) + ", or a joint's table" + core::did_you_mean(key.str(), known));
      if (key.str() == "control_mode") {
        const std::string law = core::text(node, name_, "control_mode");
        const auto which = std::find(kLaws.begin(), kLaws.end(), law);
        if (which == kLaws.end())
          fail(name_, node.source(),
               "control_mode = " + core::quoted(law) + "; expected one of " + core::listed(kLaws));
        const auto next = static_cast<ControlMode>(which - kLaws.begin());
        // Gains of the robot's own file belong to its position actuator.
        if (next != ControlMode::position && drive.law == ControlMode::position)
          drive.kp_nmprad = drive.kd_nmsprad = 0.0;
        drive.law = next;
        continue;
      }
      if (key.str() == "loop_rate_hz") {
        drive.loop_rate_hz = core::number(node, name_, where + " loop_rate_hz", kLeastLoop_hz, kMost);
        continue;
      }
      const auto which = static_cast<std::size_t>(
          std::find(kDriveParameters.begin(), kDriveParameters.end(), key.str()) - kDriveParameters.begin());
      drive.*kDriveMembers[which] =
          core::number(node, name_, where + " " + std::string(key.str()), 0.0, kMost);
    }
  }

  void read_springs() {
    model_.springs.resize(model_.joints());
    if (model_.urdf.is_mjcf)
      for (std::size_t i = 0; i < model_.joints(); ++i) {
        auto& law = model_.robot.model.laws[i];
        if (law.stiffness_nmprad != 0.0)
          model_.springs[i] = {law.stiffness_nmprad, false, law.rest_rad, true};
        law.stiffness_nmprad = law.rest_rad = 0.0;  // it is a Spring from here on
      }
    const toml::node* section = file_.get("spring");
    if (section == nullptr) return;
    for (const auto& [key, node] : core::table(*section, name_, "[spring]")) {
      static constexpr std::array<std::string_view, 4> kKeys{"stiffness_nmprad", "rest", "rest_rad",
                                                             "both_ways"};
      const std::string where = "[spring." + std::string(key.str()) + "]";
      const toml::table& table = core::table(node, name_, where);
      core::refuse_unknown_keys(table, name_, where, kKeys);
      const auto at = joint_named(std::string(key.str()), key.source(), where);
      Spring unused;
      Spring& spring = at ? model_.springs[*at] : unused;
      spring = {};
      const toml::node* rate = table.get("stiffness_nmprad");
      if (rate == nullptr)
        fail(name_, table.source(), "no key 'stiffness_nmprad' in " + where + "; expected one");
      spring.stiffness_nmprad =
          core::number(*rate, name_, where + " stiffness_nmprad", 1e-9, kMost, "N m/rad");
      const toml::node *rest = table.get("rest"), *angle = table.get("rest_rad");
      if ((rest == nullptr) == (angle == nullptr))
        fail(name_, table.source(), where + "; expected either rest = \"touch_down\" or rest_rad");
      if (const toml::node* both = table.get("both_ways")) {
        if (!both->is_boolean() || rest != nullptr)
          fail(name_, both->source(),
               where + " both_ways = " + core::value_text(*both) +
                   "; expected true or false, and rest_rad, as a switched spring is one-way");
        spring.both_ways = both->value<bool>().value_or(false);
      }
      if (angle != nullptr) {
        spring.rest_rad = core::number(*angle, name_, where + " rest_rad", -1e3, 1e3, "rad");
        continue;
      }
      if (const std::string when = core::text(*rest, name_, "rest"); when != "touch_down")
        fail(name_, rest->source(), "rest = " + core::quoted(when) + "; expected \"touch_down\"");
      if (!file_.contains("foot"))
        fail(name_, rest->source(), where + " rests at the touch-down; expected a [foot.NAME] that has one");
      spring.switched = true;
    }
  }

  void read_foot(const toml::table& feet) {
    if (feet.size() != 1)
      fail(name_, feet.source(),
           "[foot] has " + std::to_string(feet.size()) + " feet; expected one (this version has no more)");
    const std::string foot_name(feet.begin()->first.str());
    const toml::node& node = feet.begin()->second;
    static constexpr std::array<std::string_view, 2> kKeys{"link", "point_m"};
    const std::string where = "[foot." + foot_name + "]";
    const toml::table& table = core::table(node, name_, where);
    core::refuse_unknown_keys(table, name_, where, kKeys);
    const toml::node *link = table.get("link"), *point = table.get("point_m");
    if (link == nullptr || point == nullptr)
      fail(name_, table.source(), where + " has no key 'link' or no key 'point_m'; expected both");
    Foot foot;
    foot.name = foot_name;
    std::vector<std::string_view> names;
    for (const auto& l : model_.robot.links)
      if (l.joint >= 0) names.emplace_back(l.name);
    const std::string which = core::text(*link, name_, "link");
    while (foot.link < model_.robot.links.size() && model_.robot.links[foot.link].name != which) ++foot.link;
    if (foot.link == model_.robot.links.size() || model_.robot.links[foot.link].joint < 0)
      fail(name_, link->source(),
           where + ": no link " + core::quoted(which) + " that moves; expected one of " +
               core::listed(names) + core::did_you_mean(which, names));
    const toml::array* list = point->as_array();
    if (list == nullptr || list->size() != 3)
      fail(name_, point->source(),
           where + " point_m = " + core::value_text(*point) + "; expected three numbers, x y z");
    const auto part = [&](std::size_t i) {
      return core::number((*list)[i], name_, where + " point_m", -10.0, 10.0, "m");
    };
    foot.point_m = {part(0), part(1), part(2)};
    model_.foot = foot;
  }

  void read_free(const toml::table& table) {
    for (const auto& [key, node] : table) {
      const std::string whole(key.str());
      const auto dot = whole.find('.');
      const std::string who = "[free] " + whole;
      if (whole.substr(0, dot) == kInertial && dot != std::string::npos) {
        read_free_body(whole.substr(dot + 1), who, key.source(), node);
        continue;
      }
      const auto which = std::find(kDriveParameters.begin(), kDriveParameters.end(), whole.substr(0, dot));
      if (dot == std::string::npos || which == kDriveParameters.end())
        fail(name_, key.source(),
             "unknown key " + core::quoted(whole) + " in [free]; expected \"NAME.JOINT\" with NAME one of " +
                 core::listed(kDriveParameters) + ", or \"inertial.LINK\"");
      const auto at = joint_named(whole.substr(dot + 1), key.source(), who);
      FreeParameter f{static_cast<std::size_t>(which - kDriveParameters.begin()), at.value_or(0), 0.0, 0.0};
      std::tie(f.lower, f.upper) = bounds(who, node);
      if (!at) continue;
      const double value = model_.drives[f.joint].*kDriveMembers[f.parameter];
      if (!(f.lower < f.upper) || value < f.lower || value > f.upper)
        fail(name_, node.source(),
             who + " = [" + shortest(f.lower) + ", " + shortest(f.upper) +
                 "]; expected lower < upper around the model's value " + shortest(value));
      model_.free.push_back(f);
    }
    require_inertia_within_bounds();
  }
  /// A fit may go to the bounds.
  void require_inertia_within_bounds() const {
    constexpr std::size_t kRotor = 2;  // of kDriveParameters
    for (const FreeParameter& f : model_.free) {
      if (f.parameter != kRotor || f.lower > 0.0) continue;
      std::vector<double> rotors_kgm2;
      for (const Drive& drive : model_.drives) rotors_kgm2.push_back(drive.rotor_inertia_kgm2);
      rotors_kgm2[f.joint] = f.lower;
      model::RobotTree tree = model_.robot;
      try {
        model::require_joint_inertia(tree, model_.urdf.file, rotors_kgm2);
      } catch (const core::DataError&) {
        const std::string joint = model_.robot.joints[f.joint].name;
        throw core::DataError(name_ + ": [free] rotor_inertia_kgm2." + joint + " has the lower bound " +
                              shortest(f.lower) + ", and nothing else gives joint " + core::quoted(joint) +
                              " an inertia; expected a lower bound above 0");
      }
    }
  }

  std::pair<double, double> bounds(const std::string& who, const toml::node& node) const {
    const toml::array* pair = node.as_array();
    if (pair == nullptr || pair->size() != 2)
      fail(name_, node.source(),
           who + " is " + core::value_text(node) + "; expected two numbers, [lower, upper]");
    return {core::number((*pair)[0], name_, who + " lower bound", 0.0, kMost),
            core::number((*pair)[1], name_, who + " upper bound", 0.0, kMost)};
  }
  void read_free_body(const std::string& link, const std::string& who, const toml::source_region& where,
                      const toml::node& node) {
    std::vector<std::string_view> names;
    for (const std::size_t i : sites(model_, LocationType::link))
      names.emplace_back(model_.robot.links[i].name);
    const std::string one_of = "; expected one of " + core::listed(names);
    std::size_t i = 0;
    while (i < model_.robot.links.size() && model_.robot.links[i].name != link) ++i;
    if (i == model_.robot.links.size())
      fail(name_, where, who + ": no link " + core::quoted(link) + one_of + core::did_you_mean(link, names));
    if (is_of_held(link, who)) {
      bounds(who, node);
      return;
    }
    if (model_.robot.links[i].joint < 0)
      fail(name_, where, who + ": link " + core::quoted(link) + " does not move" + one_of);
    if (std::find(names.begin(), names.end(), link) == names.end())
      fail(name_, where, who + ": link " + core::quoted(link) + " has no mass" + one_of);
    const model::UrdfInertia& body = *model_.urdf.links[i].inertia;
    if (!has_coordinates(body))
      fail(
          name_, where,
          who + ": the <inertia> of link " + core::quoted(link) +
              " is that of a sheet, a rod or a point; expected a body that fills space, of whose principal moments each is "
              "less than the sum of the other two");
    const auto [lower, upper] = bounds(who, node);
    if (!(lower > 0.0 && lower < upper && lower <= 1.0 && upper >= 1.0))
      fail(name_, node.source(),
           who + " = [" + shortest(lower) + ", " + shortest(upper) +
               "]; expected 0 < lower < upper around 1: its mass stays between so many times the given " +
               shortest(body.mass_kg) + " kg");
    model_.free_bodies.push_back({i, lower, upper});
  }

  void read_effects(const toml::table& table) {
    std::vector<std::string_view> all;
    for (const EffectInfo& e : catalogue()) all.push_back(e.name);
    for (const auto& [key, node] : table) {
      const auto effect = effect_named(key.str());
      if (!effect)
        fail(name_, key.source(),
             "unknown effect " + core::quoted(key.str()) + " of a tree; expected one of " +
                 core::listed(all) + core::did_you_mean(key.str(), all));
      const std::string where = "[effect." + std::string(key.str()) + "]";
      for (const auto& [site, values] : core::table(node, name_, where))
        read_effect(*effect, std::string(site.str()), values, site.source());
    }
  }
  void read_effect(Effect effect, const std::string& site, const toml::node& node,
                   const toml::source_region& source) {
    const EffectInfo& e = info(effect);
    const std::string where = "[effect." + std::string(e.name) + "." + site + "]";
    std::vector<std::string> names;
    std::optional<std::size_t> at;
    for (const std::size_t i : sites(model_, e.location_type)) {
      names.push_back(site_name(model_, e.location_type, i));
      if (names.back() == site) at = i;
    }
    const std::vector<std::string_view> views(names.begin(), names.end());
    if (!at && e.location_type == LocationType::link && is_of_held(site, where)) return;
    if (!at && is_of_joints(e.location_type) && held_.contains(site)) {
      of_held_[site].push_back(where);
      return;
    }
    if (!at)
      fail(name_, source,
           where + ": no " + std::string(name(e.location_type)) + " " + core::quoted(site) +
               "; expected one of " + core::listed(views) + core::did_you_mean(site, views) +
               (is_of_joints(e.location_type) ? why_held(site) : ""));
    const bool linear = is_linear(model_, e.location_type, *at);
    const toml::table& table = core::table(node, name_, where);
    std::vector<std::string_view> known;
    for (const Parameter& p : e.parameters()) known.push_back(name_on(p, linear));
    // On a prismatic joint the names of revolute ones will do, too: the keys of [drive] are the same on both.
    if (linear)
      for (const Parameter& p : e.parameters())
        if (p.name != p.linear_name) known.push_back(p.name);
    core::refuse_unknown_keys(table, name_, where, known);
    Cause cause{effect, {*at}, {}};
    for (std::size_t k = 0; k < e.parameter_count; ++k) {
      const Parameter& p = e.parameters()[k];
      const toml::node* value = table.get(known[k]);
      if (value == nullptr) value = table.get(p.name);
      if (value == nullptr)
        fail(name_, table.source(),
             "no key '" + std::string(known[k]) + "' in " + where + "; expected a number from " +
                 shortest(p.lower) + " to " + shortest(p.upper) + " " + std::string(unit_on(p, linear)));
      cause.values[k] = core::number(*value, name_, where + " " + std::string(known[k]), p.lower, p.upper,
                                     unit_on(p, linear));
    }
    if (e.location_type == LocationType::spring && effect != Effect::spring_rate_error &&
        !model_.springs[*at].switched)
      fail(name_, source, where + ": its spring has a fixed rest_rad; expected one of rest = \"touch_down\"");
    if (effect == Effect::position_gain_error && model_.drives[*at].law != ControlMode::position)
      fail(name_, source, where + ": its drive has control_mode \"torque\"; expected \"position\"");
    if ((effect == Effect::mass_error || effect == Effect::com_error || effect == Effect::inertia_error) &&
        model_.is_free_body(*at))
      fail(name_, source,
           where + ": [free] has \"inertial." + site + "\", which fits the same; expected one of the two");
    model_.causes.push_back(cause);
  }

  const std::string name_;
  toml::table file_;
  const std::vector<std::string>& columns_;
  std::map<std::string, std::string>
      held_;  ///< joints that are held though the file does not say so, and why
  std::map<std::string, std::vector<std::string>> of_held_;  ///< what the file says of these
  TreeModel model_;
};

std::string table_of(const std::string& heading, const Drive& drive) {
  std::string out =
      heading + "\ncontrol_mode = \"" + std::string(kLaws[static_cast<std::size_t>(drive.law)]) + "\"\n";
  for (std::size_t k = 0; k < kDriveParameters.size(); ++k)
    if (k >= 2 || drive.law == ControlMode::position)
      out += std::string(kDriveParameters[k]) + " = " + core::toml_float(drive.*kDriveMembers[k]) + "\n";
  if (drive.loop_rate_hz > 0.0) out += "loop_rate_hz = " + core::toml_float(drive.loop_rate_hz) + "\n";
  return out;
}

}  // namespace

std::string toml_key(const std::string& name) {
  constexpr std::string_view kBare = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !name.empty() && name.find_first_not_of(kBare) == std::string::npos ? name : text_of(name);
}

bool is_tree(std::string_view text) {
  if (is_robot(text)) return true;
  try {
    const toml::table file = core::parse_toml(text, "");
    return file["model"]["kind"].value<std::string_view>() == "tree";
  } catch (const core::DataError&) {
    return false;
  }
}

TreeModel parse_tree_model(std::string_view text, const std::string& path, const TreeContext& context) {
  return Reader(text, path, context).read();
}

TreeModel parse_tree_model(std::string_view text, const std::string& path, const std::string& urdf) {
  return Reader(text, path, TreeContext{urdf, {}, false}).read();
}

TreeModel read_tree_model(const std::string& path) {
  return parse_tree_model(core::read_small_file(path, "a model file (TOML)"), path);
}

std::string format_tree_model(const TreeModel& m, const std::string& urdf) {
  std::string out = "[model]\nkind = \"tree\"\nschema = 1\n" +
                    std::string(m.urdf.is_mjcf && !urdf.ends_with(".urdf") ? "mjcf" : "urdf") + " = " +
                    text_of(urdf) + "\nbase = \"fixed\"\n";
  if (!m.moving.empty()) {
    out += "joints = [";
    for (std::size_t i = 0; i < m.moving.size(); ++i) out += (i > 0 ? ", " : "") + text_of(m.moving[i]);
    out += "]\n";
  }
  out += "gravity_mps2 = [" + core::toml_float(m.gravity_mps2.x) + ", " + core::toml_float(m.gravity_mps2.y) +
         ", " + core::toml_float(m.gravity_mps2.z) + "]\n";
  if (m.accept_inertias) out += "accept_inertias = true\n";
  if (!m.hold.empty()) out += "\n[locked_joints]\n";
  for (const auto& [joint, position] : m.hold)
    out += toml_key(joint) + " = " + core::toml_float(position) + "\n";
  for (std::size_t i = 0; i < m.joints(); ++i)
    out += "\n" + table_of("[drive." + toml_key(m.robot.joints[i].name) + "]", m.drives[i]);
  for (std::size_t i = 0; i < m.springs.size(); ++i) {
    const Spring& s = m.springs[i];
    if (s.stiffness_nmprad == 0.0) continue;
    out +=
        "\n[spring." + toml_key(m.robot.joints[i].name) +
        "]\nstiffness_nmprad = " + core::toml_float(s.stiffness_nmprad) + "\n" +
        (s.switched ? std::string("rest = \"touch_down\"") : "rest_rad = " + core::toml_float(s.rest_rad)) +
        (s.both_ways ? "\nboth_ways = true\n" : "\n");
  }
  if (m.foot)
    out += "\n[foot." + toml_key(m.foot->name) + "]\nlink = " + text_of(m.robot.links[m.foot->link].name) +
           "\npoint_m = [" + core::toml_float(m.foot->point_m.x) + ", " +
           core::toml_float(m.foot->point_m.y) + ", " + core::toml_float(m.foot->point_m.z) + "]\n";
  const bool angle = m.angle_noise_rad != TreeModel{}.angle_noise_rad;
  if (angle || m.torque_noise_nm > 0.0) out += "\n[sensors]\n";
  if (angle) out += "angle_noise_rad = " + core::toml_float(m.angle_noise_rad) + "\n";
  if (m.torque_noise_nm > 0.0) out += "torque_noise_nm = " + core::toml_float(m.torque_noise_nm) + "\n";
  if (!m.free.empty() || !m.free_bodies.empty()) out += "\n[free]\n";
  for (const FreeParameter& f : m.free)
    out += text_of(std::string(kDriveParameters[f.parameter]) + "." + m.robot.joints[f.joint].name) + " = [" +
           core::toml_float(f.lower) + ", " + core::toml_float(f.upper) + "]\n";
  for (const FreeBody& f : m.free_bodies)
    out += text_of(std::string(kInertial) + "." + m.robot.links[f.link].name) + " = [" +
           core::toml_float(f.lower) + ", " + core::toml_float(f.upper) + "]\n";
  for (const Cause& c : m.causes)
    for (const std::size_t site : c.sites) {
      const EffectInfo& e = info(c.effect);
      out += "\n[effect." + std::string(e.name) + "." + toml_key(site_name(m, e.location_type, site)) + "]\n";
      for (std::size_t k = 0; k < e.parameter_count; ++k)
        out += std::string(name_on(e.parameters()[k], is_linear(m, e.location_type, site))) + " = " +
               core::toml_float(c.values[k]) + "\n";
    }
  return out;
}

std::string urdf_seen_from(const TreeModel& model, const std::string& folder) {
  namespace fs = std::filesystem;
  if (!model.urdf_text.empty()) return model.urdf_path;
  std::error_code error;
  const fs::path urdf = fs::weakly_canonical(fs::path(model.file).parent_path() / model.urdf_path, error);
  const fs::path from = fs::weakly_canonical(folder, error);
  const fs::path relative = urdf.lexically_relative(from);
  return relative.empty() ? urdf.string() : relative.string();
}

std::vector<std::size_t> sites(const TreeModel& model, LocationType location_type) {
  std::vector<std::size_t> out;
  if (location_type == LocationType::base || location_type == LocationType::log) return {0};
  if (location_type == LocationType::link) {
    for (std::size_t i = 0; i < model.robot.links.size(); ++i)
      if (model.robot.links[i].joint >= 0 && model.urdf.links[i].inertia &&
          model.urdf.links[i].inertia->mass_kg > 0.0)
        out.push_back(i);
    return out;
  }
  for (std::size_t i = 0; i < model.joints(); ++i) {
    if (location_type == LocationType::spring && model.springs[i].stiffness_nmprad == 0.0) continue;
    out.push_back(i);
  }
  return out;
}

std::string site_name(const TreeModel& model, LocationType location_type, std::size_t site) {
  if (location_type == LocationType::base || location_type == LocationType::log)
    return std::string(name(location_type));
  return location_type == LocationType::link ? model.robot.links[site].name : model.robot.joints[site].name;
}

std::string cause_name(const TreeModel& model, const Cause& cause) {
  std::string out(info(cause.effect).name);
  for (std::size_t i = 0; i < cause.sites.size(); ++i)
    out += (i == 0 ? "@" : ",") + site_name(model, info(cause.effect).location_type, cause.sites[i]);
  return out;
}

bool is_linear(const TreeModel& model, LocationType location_type, std::size_t site) {
  return is_of_joints(location_type) && model.prismatic(site);
}

}  // namespace furcula::trees
