// The filter in front of urdfdom, see urdf_filter.hpp.
#include "host/model/urdf_filter.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/model/xml_text.hpp"

namespace furcula::model {
namespace {

using core::quoted;
using core::shortest;
using Kind = UrdfJoint::Kind;

/// Half a unit of the last digit of each of the six moments as they are printed.
///
/// A program prints all of a body either to as many decimals ("%.6f") or to as many significant digits ("%.4g", which drops zeros at the end), and
/// a number does not tell which. So a number is off by up to half a unit of the last decimal that any of the six has, or of its own last digit
/// were it printed to as many digits as the longest of the six: the larger of the two. Zero without decimals is exact. Six numbers of one digit
/// and without zeros at the end were typed: they are exact, too.
std::array<double, 6> rounding_of(const std::array<std::string_view, 6>& printed,
                                  const std::array<double, 6>& values) {
  int finest = std::numeric_limits<int>::max(), longest = 0;  // exponent of the last decimal; digits
  bool typed = true;
  std::array<bool, 6> exact{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string_view text = trimmed(printed[i]);
    const std::size_t e = std::min(text.find_first_of("eE"), text.size());
    int exponent = 0;
    if (e < text.size()) {
      std::string_view power = text.substr(e + 1);
      if (power.starts_with('+')) power.remove_prefix(1);
      std::from_chars(power.data(), power.data() + power.size(), exponent);
    }
    const std::string_view mantissa = text.substr(0, e);
    const std::size_t point = mantissa.find('.');
    const int decimals = point == mantissa.npos ? 0 : static_cast<int>(mantissa.size() - point - 1);
    int digits = 0;
    bool begun = false;
    for (const char c : mantissa) {
      begun |= c >= '1' && c <= '9';
      digits += begun && c >= '0' && c <= '9' ? 1 : 0;
    }
    exact[i] = values[i] == 0.0 && decimals == 0;
    // "0.0" and "1.0" are how a language writes a whole number.
    typed &= digits <= 1 && !(decimals >= 2 && mantissa.ends_with("00"));
    longest = std::max(longest, digits);
    if (!exact[i] && point != mantissa.npos) finest = std::min(finest, exponent - decimals);
  }
  std::array<double, 6> out{};
  if (typed) return out;
  for (std::size_t i = 0; i < 6; ++i) {
    if (exact[i]) continue;
    if (finest != std::numeric_limits<int>::max()) out[i] = 0.5 * std::pow(10.0, finest);
    if (values[i] != 0.0)
      out[i] =
          std::max(out[i], 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(values[i]))) - longest + 1));
  }
  return out;
}

/// Depth-1 elements of which the dynamics use nothing.
constexpr std::string_view kWithoutMechanics[] = {"material",
                                                  "sensor",
                                                  "mujoco",
                                                  "plugin",
                                                  "collision_filter_group",
                                                  "drake:collision_filter_group",
                                                  "disable_collisions",
                                                  "self_collision_checking",
                                                  "group",
                                                  "group_state",
                                                  "end_effector",
                                                  "passive_joint",
                                                  "virtual_joint",
                                                  "static",
                                                  "author",
                                                  "license",
                                                  "description",
                                                  "version"};
/// Those that join two links beside the tree of joints: Drake's, and what others call it. A spring between links joins none: it is an element that is
/// not used. A bushing is one, but stands for a joint that closes a loop.
constexpr std::string_view kClosures[] = {"loop_joint",
                                          "drake:loop_joint",
                                          "loop",
                                          "closed_loop",
                                          "constraint",
                                          "cut_joint",
                                          "cable_length_constraint",
                                          "linear_bushing_rpy",
                                          "drake:linear_bushing_rpy",
                                          "drake:ball_constraint",
                                          "drake:distance_constraint",
                                          "drake:weld_constraint",
                                          "drake:coupler_constraint",
                                          "drake:tendon_constraint"};
constexpr std::string_view kOfJoints[] = {"origin",
                                          "parent",
                                          "child",
                                          "axis",
                                          "limit",
                                          "dynamics",
                                          "mimic",
                                          "calibration",
                                          "safety_controller",
                                          "sensor",
                                          "visual",
                                          "collision",
                                          "gazebo",
                                          "hardware_interface",
                                          "hardwareInterface",
                                          "disable_collision",
                                          "drake:controller_gains"};

template <std::size_t N>
bool among(std::string_view tag, const std::string_view (&list)[N]) {
  return std::find(std::begin(list), std::end(list), tag) != std::end(list);
}

class Filter {
 public:
  Filter(const std::vector<XmlElement>& elements, const std::string& file)
      : elements_(elements), file_(file) {}

  FilteredUrdf run() {
    const XmlElement& root = elements_.front();
    if (root.tag != "robot") {
      constexpr std::pair<std::string_view, std::string_view> kOthers[] = {
          {"sdf", "SDF; a converter makes a URDF of it"},
          {"mujoco", "MJCF; a converter makes a URDF of it"},
          {"mujocoinclude", "a part of an MJCF file; a converter makes a URDF of the whole"},
          {"COLLADA", "a mesh (COLLADA); the URDF is the file that names it"},
          {"package",
           "a package's description; the URDF is another file of the package, often in its folder urdf"},
          {"launch", "a launch file; the URDF is the file that it loads"}};
      std::string what = "; see that urdf in [model] names the robot's file";
      for (const auto& [other, is] : kOthers)
        if (root.tag == other) what = " (this is " + std::string(is) + ")";
      fail(root,
           "not a robot (URDF): the root element is " + tag(root) + ", expected <robot>" + std::string(what));
    }
    refuse_xacro();
    // Links first: joints name them, wherever they stand.
    for (std::size_t i = 1; i < elements_.size(); ++i)
      if (elements_[i].depth == 1 && elements_[i].tag == "link") link(i);
    for (std::size_t i = 1; i < elements_.size(); ++i)
      if (elements_[i].depth == 1 && (elements_[i].tag == "joint" || elements_[i].tag == "drake:joint"))
        joint(i);
    if (out_.links.empty()) {
      const bool groups = std::any_of(elements_.begin(), elements_.end(), [](const XmlElement& e) {
        return e.depth == 1 &&
               (e.tag == "group" || e.tag == "virtual_joint" || e.tag == "disable_collisions");
      });
      fail(root, std::string("not a robot (URDF): no <link>, expected links and joints") +
                     (groups ? " (this is SRDF, MoveIt's groups of joints; name the URDF that it goes with)"
                             : "; see that urdf in [model] names the robot's file"));
    }
    check_tree();
    for (std::size_t i = 1; i < elements_.size(); ++i)
      if (elements_[i].depth == 1) other(i);
    unread_notes();
    std::string name(root.attribute("name"));
    if (trimmed(name).empty()) name = "robot";
    out_.text = "<robot name=" + in_quotes(name) + ">\n" + links_text_ + joints_text_ + "</robot>\n";
    return std::move(out_);
  }

 private:
  struct Edge {
    std::size_t line;
    std::string name, parent, child;
  };
  struct Unread {
    std::string what;
    std::string whose;  ///< "joint"; empty: names are lines
    std::vector<std::string> names;
  };

  static std::string tag(const XmlElement& e) { return "<" + core::printable(e.tag) + ">"; }
  std::string place(const XmlElement& e) const { return file_ + ":" + std::to_string(e.line) + ": "; }
  [[noreturn]] void fail(const XmlElement& e, const std::string& message) const {
    throw core::DataError(place(e) + message);
  }
  static std::string in_quotes(std::string_view raw) {
    const char quote = raw.find('"') == raw.npos ? '"' : '\'';
    return quote + std::string(raw) + quote;
  }
  static bool has(const XmlElement& e, std::string_view attribute) {
    return std::any_of(e.attributes.begin(), e.attributes.end(),
                       [&](const auto& a) { return a.first == attribute; });
  }
  /// One after the last element within element i.
  std::size_t end_of(std::size_t i) const {
    std::size_t end = i + 1;
    while (end < elements_.size() && elements_[end].depth > elements_[i].depth) ++end;
    return end;
  }
  /// The first child of that tag, or null.
  const XmlElement* child(std::size_t of, std::string_view its_tag) const {
    for (std::size_t i = of + 1, end = end_of(of); i < end; ++i)
      if (elements_[i].depth == elements_[of].depth + 1 && elements_[i].tag == its_tag) return &elements_[i];
    return nullptr;
  }
  std::size_t index(const XmlElement& e) const { return static_cast<std::size_t>(&e - elements_.data()); }

  void refuse_xacro() const {
    std::set<std::string> prefixes{"xacro"};
    for (const auto& [name, value] : elements_.front().attributes)
      if (name.starts_with("xmlns:") && value.find("xacro") != value.npos)
        prefixes.insert(std::string(name.substr(6)));
    const auto is_of_xacro = [&](std::string_view name) {
      const std::size_t colon = name.find(':');
      return colon != name.npos && prefixes.contains(std::string(name.substr(0, colon)));
    };
    const auto refuse = [&](const XmlElement& e, const std::string& what) {
      fail(e, what + ": this is a xacro file, expected a URDF; expand it: xacro " + core::printable(file_) +
                  " > robot.urdf, and name robot.urdf in the model file");
    };
    for (const XmlElement& e : elements_) {
      // The names of long ago, without a namespace.
      if (is_of_xacro(e.tag) || (e.depth == 1 && (e.tag == "macro" || e.tag == "include"))) refuse(e, tag(e));
      for (const auto& [name, value] : e.attributes) {
        if (is_of_xacro(name)) refuse(e, "the attribute " + quoted(name) + " of " + tag(e));
        // Where a mesh lies does not matter here.
        if (value.find("${") != value.npos ||
            (value.find("$(") != value.npos && e.tag != "mesh" && e.tag != "texture"))
          refuse(e, "in " + tag(e) + ": " + std::string(core::printable(name)) + " = " + quoted(value));
      }
    }
  }

  std::string named(const XmlElement& e, const char* what) const {
    if (trimmed(e.attribute("name")).empty())
      fail(e, "a " + std::string(what) + " has no name, expected name=\"...\"");
    return resolved(e.attribute("name"));
  }

  /// Three numbers of an attribute, or its default where it is not there; `why` is set where they are none.
  std::array<double, 3> three(const XmlElement* e, std::string_view attribute, std::array<double, 3> none,
                              std::string& why) const {
    if (e == nullptr || !has(*e, attribute)) return none;
    const std::string_view raw = e->attribute(attribute);
    const auto parts = words(raw);
    const std::string where = tag(*e) + " " + std::string(attribute) + " is ";
    if (parts.size() != 3) {
      why = place(*e) + "@" + where + quoted(raw) + ", expected three numbers with blanks between them";
      return none;
    }
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto value = number(parts[i]);
      if (!value) {
        why = place(*e) + "@" + where + quoted(raw) + ": " + no_number(parts[i]);
        return none;
      }
      out[i] = *value;
    }
    return out;
  }
  /// What three() says, with whose it is.
  static std::string of(const std::string& who, std::string why) {
    const std::size_t at = why.find(": @");
    return at == why.npos ? why : why.replace(at, 3, ": " + who + ": ");
  }
  static std::string text_of(const std::array<double, 3>& v) {
    return "\"" + shortest(v[0]) + " " + shortest(v[1]) + " " + shortest(v[2]) + "\"";
  }
  std::string origin(const XmlElement* e, std::string& why) const {
    const auto xyz = three(e, "xyz", {}, why), rpy = three(e, "rpy", {}, why);
    return "<origin xyz=" + text_of(xyz) + " rpy=" + text_of(rpy) + "/>";
  }

  void link(std::size_t at) {
    const XmlElement& e = elements_[at];
    const std::string name = named(e, "<link>");
    const auto [known, is_new] = out_.links.emplace(name, FilteredLink{e.line, {}, {}});
    if (!is_new)
      fail(e, "link " + quoted(name) + " is there twice, first in line " +
                  std::to_string(known->second.line) + "; expected names that differ");
    links_text_ += "<link name=" + in_quotes(e.attribute("name"));
    std::size_t inertials = 0;
    for (std::size_t i = at + 1, end = end_of(at); i < end; ++i) {
      if (elements_[i].depth != e.depth + 1) continue;
      if (elements_[i].tag == "mass" || elements_[i].tag == "inertia")
        unread(tag(elements_[i]) + " outside of <inertial>", "link", quoted(name));
      inertials += elements_[i].tag == "inertial" ? 1 : 0;
    }
    if (inertials > 1) unread("all but the first <inertial>", "link", quoted(name));
    const XmlElement* inertial = child(at, "inertial");
    const std::string text = inertial == nullptr ? "" : inertial_text(*inertial, name, known->second);
    links_text_ += text.empty() ? "/>\n" : ">" + text + "</link>\n";
  }
  std::string inertial_text(const XmlElement& e, const std::string& name, FilteredLink& out) {
    const std::string who = "link " + quoted(name);
    const std::size_t at = index(e);
    const std::string frame = origin(child(at, "origin"), out.flaw);
    if (!out.flaw.empty()) {
      out.flaw = of(who + ": its <inertial>", out.flaw);
      return {};
    }
    const XmlElement *mass = child(at, "mass"), *inertia = child(at, "inertia");
    if (mass == nullptr || !has(*mass, "value")) {
      out.flaw =
          place(mass == nullptr ? e : *mass) + who +
          ": its <inertial> has no mass, expected <mass value=\"...\"/> in kg (0 for a frame without mass)";
      return {};
    }
    const auto mass_kg = number(mass->attribute("value"));
    if (!mass_kg) {
      out.flaw = place(*mass) + who + ": its <mass> " + no_number(mass->attribute("value"));
      return {};
    }
    constexpr std::string_view kMoments[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
    std::array<std::string_view, 6> printed{};
    std::array<double, 6> values{};
    bool lacks_products = false;
    for (std::size_t k = 0; k < 6 && inertia != nullptr; ++k) {
      const bool product = kMoments[k][1] != kMoments[k][2];
      if (!has(*inertia, kMoments[k])) {
        lacks_products |= product;
        if (product) continue;
        out.flaw = place(*inertia) + who + ": its <inertia> has no " + std::string(kMoments[k]) +
                   ", expected ixx, iyy and izz in kg m^2";
        return {};
      }
      printed[k] = inertia->attribute(kMoments[k]);
      const auto value = number(printed[k]);
      if (!value) {
        out.flaw = place(*inertia) + who + ": its <inertia> " + std::string(kMoments[k]) + " " +
                   no_number(printed[k]);
        return {};
      }
      values[k] = *value;
    }
    if (inertia == nullptr && *mass_kg != 0.0) without_inertia_.push_back(quoted(name));
    if (lacks_products) without_products_.push_back(quoted(name));
    out.rounding_kgm2 = rounding_of(printed, values);
    std::string text = "<inertial>" + frame + "<mass value=\"" + shortest(*mass_kg) + "\"/><inertia";
    for (std::size_t k = 0; k < 6; ++k)
      text += " " + std::string(kMoments[k]) + "=\"" + shortest(values[k]) + "\"";
    return text + "/></inertial>";
  }

  std::string link_of(const XmlElement& joint, const std::string& who, std::string_view end) {
    const XmlElement* e = child(index(joint), end);
    const std::string what = tag(joint) + " " + who + ": its <" + std::string(end) + ">";
    if (e == nullptr || trimmed(e->attribute("link")).empty())
      fail(e == nullptr ? joint : *e,
           "joint " + who + " has no <" + std::string(end) + " link=\"...\"/>, expected the name of a link");
    const std::string name = resolved(e->attribute("link"));
    if (out_.links.contains(name)) return std::string(e->attribute("link"));
    // Drake's robots stand on a link that need not be there.
    if (name == "world" && end == "parent") {
      out_.links.emplace(name, FilteredLink{e->line, {}, {}});
      links_text_ += "<link name=\"world\"/>\n";
      return name;
    }
    std::vector<std::string_view> names;
    for (const auto& [link, what_is] : out_.links) names.emplace_back(link);
    fail(*e, "joint " + who + ": its <" + std::string(end) + "> is link " + quoted(name) +
                 ", which is no link of the robot" + core::printable(core::did_you_mean(name, names)) +
                 "; expected one of its links");
  }
  static std::optional<Kind> kind_of(std::string_view type) {
    if (type == "fixed") return Kind::fixed;
    if (type == "revolute") return Kind::revolute;
    if (type == "continuous") return Kind::continuous;
    if (type == "prismatic") return Kind::prismatic;
    constexpr std::string_view kOthers[] = {"floating",    "planar", "spherical", "ball",
                                            "universal",   "screw",  "free",      "quaternion_floating",
                                            "rpy_floating"};
    if (among(type, kOthers)) return Kind::other;
    return std::nullopt;
  }
  void joint(std::size_t at) {
    const XmlElement& e = elements_[at];
    const std::string name = named(e, "<joint>"), who = quoted(name);
    const auto [known, is_new] = out_.joints.emplace(name, FilteredJoint{});
    FilteredJoint& j = known->second;
    if (!is_new)
      fail(e, "joint " + who + " is there twice, first in line " + std::to_string(j.line) +
                  "; expected names that differ");
    j.line = e.line;
    const std::string_view type = trimmed(e.attribute("type"));
    const auto kind = kind_of(type);
    if (!kind) {
      constexpr std::string_view kTypes[] = {"revolute", "continuous", "prismatic",
                                             "fixed",    "floating",   "planar"};
      fail(e, "joint " + who + (type.empty() ? " has no type" : " has the type " + quoted(type)) +
                  ", expected one of " + core::listed(kTypes) + core::did_you_mean(type, kTypes));
    }
    j.kind = *kind;
    j.type = type;
    const std::string parent = link_of(e, who, "parent"), child_link = link_of(e, who, "child");
    j.child = resolved(child_link);
    edges_.push_back({e.line, name, resolved(parent), j.child});
    std::string why;
    const std::string frame = origin(child(at, "origin"), why);
    if (!why.empty()) throw core::DataError(of("joint " + who, why));
    const bool moves = j.kind != Kind::fixed && j.kind != Kind::other;
    joints_text_ += "<joint name=" + in_quotes(e.attribute("name")) + " type=\"" +
                    (moves ? std::string(type) : "fixed") + "\">" + frame +
                    "<parent link=" + in_quotes(parent) + "/><child link=" + in_quotes(child_link) + "/>";
    if (moves) {
      joints_text_ += axis_text(at, who, j);
      // It asks for some; the joint's are read here.
      if (j.kind != Kind::continuous)
        joints_text_ += "<limit lower=\"0\" upper=\"0\" effort=\"0\" velocity=\"0\"/>";
      if (const XmlElement* limit = child(at, "limit")) read_limit(*limit, j);
      if (child(at, "limit") == nullptr && j.kind != Kind::continuous) j.limit_flaw = "there is none";
      if (const XmlElement* dynamics = child(at, "dynamics")) read_dynamics(*dynamics, who, j);
    }
    joints_text_ += "</joint>\n";
    if (const XmlElement* mimic = child(at, "mimic")) j.mimics = resolved(mimic->attribute("joint"));
    for (std::size_t i = at + 1, end = end_of(at); i < end; ++i)
      if (elements_[i].depth == e.depth + 1 && !among(elements_[i].tag, kOfJoints))
        unread(tag(elements_[i]), "joint", who);
  }
  std::string axis_text(std::size_t at, const std::string& who, FilteredJoint& j) const {
    const XmlElement* e = child(at, "axis");
    std::string why;
    std::array<double, 3> axis{1.0, 0.0, 0.0};  // the format's own default
    if (e != nullptr) axis = three(e, "xyz", {}, why);
    if (why.empty()) {
      const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
      if (!(length > 1e-9) || !std::isfinite(length))
        why = place(*e) + "@its <axis> is " + shortest(axis[0]) + " " + shortest(axis[1]) + " " +
              shortest(axis[2]) + ", expected a direction";
    }
    if (!why.empty()) {
      j.flaw = of("joint " + who, why);
      axis = {1.0, 0.0, 0.0};
    }
    return "<axis xyz=" + text_of(axis) + "/>";
  }
  static void read_limit(const XmlElement& e, FilteredJoint& j) {
    UrdfLimits l;
    const auto read = [&](std::string_view attribute, double& into) {
      if (!has(e, attribute)) return false;
      const auto value = any_number(e.attribute(attribute));
      const std::string is = std::string(attribute) + " is " + quoted(e.attribute(attribute));
      if (value && std::isfinite(*value)) {
        into = *value;
        return true;
      }
      if (j.limit_flaw.empty()) j.limit_flaw = is;
      return false;
    };
    const bool lower = read("lower", l.lower), upper = read("upper", l.upper);
    read("effort", l.effort);
    read("velocity", l.velocity);
    if (l.effort < 0.0 || l.velocity < 0.0) {
      if (j.limit_flaw.empty())
        j.limit_flaw =
            (l.effort < 0.0 ? "effort is " + shortest(l.effort) : "velocity is " + shortest(l.velocity));
      l.effort = std::max(0.0, l.effort);
      l.velocity = std::max(0.0, l.velocity);
    }
    if (j.limit_flaw.empty()) {
      // One that is missing is 0, the format says.
      if (l.lower > l.upper)
        j.limit_flaw = "lower " + shortest(l.lower) + " is above upper " + shortest(l.upper);
      else if (!lower && !upper && j.kind != Kind::continuous)
        j.limit_flaw = "it has no lower and no upper";
    }
    // As of a continuous joint: no range.
    if (!(l.lower <= l.upper) || (has(e, "lower") && !lower) || (has(e, "upper") && !upper))
      l.lower = l.upper = 0.0;
    j.limits = l;
  }
  void read_dynamics(const XmlElement& e, const std::string& who, FilteredJoint& j) {
    for (const auto& [name, raw] : e.attributes) {
      const auto value = number(raw);
      if (name == "damping" || name == "friction") {
        double& into = name == "damping" ? j.damping : j.friction;
        const std::string its = "joint " + who + ": its <dynamics> " + std::string(name) + " ";
        if (!value)
          j.flaw = place(e) + its + no_number(raw);
        else if (*value < 0.0)
          j.flaw = place(e) + its + "is " + shortest(*value) + ", expected at least 0";
        else
          into = *value;
      } else if (!value || *value == 0.0) {
        continue;  // nothing is lost
      } else if (name == "armature" || name == "rotor_inertia" || name == "rotor_inertia_kgm2") {
        j.rotor_inertia_kgm2 = *value;
      } else if (name == "spring_stiffness" || name == "stiffness") {
        j.spring_nmprad = *value;
      } else if (name == "spring_reference") {
        j.spring_rest_rad = *value;
      } else {
        unread(core::printable(name) + " of <dynamics>", "joint", who);
      }
    }
  }

  void check_tree() {
    std::map<std::string_view, const Edge*> above;  // of links
    for (const Edge& j : edges_) {
      const auto [other, is_first] = above.emplace(j.child, &j);
      if (!is_first)
        throw core::DataError(file_ + ":" + std::to_string(j.line) + ": link " + quoted(j.child) +
                              " is the child of joint " + quoted(other->second->name) + " and of joint " +
                              quoted(j.name) +
                              ", expected one parent (a tree; a closed loop is not supported)");
    }
    std::set<std::string_view> rooted;
    for (const Edge& j : edges_) {
      std::set<std::string_view> way;
      for (auto up = above.find(j.child); up != above.end() && !rooted.contains(up->first);
           up = above.find(up->second->parent))
        if (!way.insert(up->first).second)
          throw core::DataError(file_ + ":" + std::to_string(up->second->line) + ": link " +
                                quoted(up->first) + " is in a loop of joints, expected a tree");
      rooted.merge(way);
    }
    std::vector<std::string> roots;
    for (const auto& [name, link] : out_.links)
      if (!above.contains(name)) roots.push_back(quoted(name));
    if (roots.size() > 1)
      throw core::DataError(
          file_ + ": the links " + first_names(roots) +
          " all have no joint above them, expected one root link (remove a link that is not in use, or put it on another by a fixed joint)");
  }

  void other(std::size_t at) {
    const XmlElement& e = elements_[at];
    if (e.tag == "link" || e.tag == "joint" || e.tag == "drake:joint") return;
    if (e.tag == "transmission") return transmission(at, end_of(at), true);
    if (e.tag == "ros2_control") return ros2_control(at);
    if (e.tag == "gazebo") return gazebo(at);
    if (e.tag == "frame" || e.tag == "drake:frame") return;  // read where it is used
    if (among(e.tag, kClosures)) return closure(at);
    if (!among(e.tag, kWithoutMechanics)) unread(tag(e), e);
  }

  /// The link that a name stands for: its own, or that of a <frame>.
  std::string link_named(std::string_view raw) const {
    const std::string name = resolved(trimmed(raw));
    if (out_.links.contains(name)) return name;
    for (std::size_t i = 1; i < elements_.size(); ++i)
      if (elements_[i].depth == 1 && elements_[i].tag.ends_with("frame") &&
          resolved(elements_[i].attribute("name")) == name) {
        const std::string link = resolved(elements_[i].attribute("link"));
        if (out_.links.contains(link)) return link;
      }
    return {};
  }
  void closure(std::size_t at) {
    UrdfClosure c{elements_[at].line, core::printable(elements_[at].tag), {}};
    std::set<std::string> seen;
    const auto add = [&](std::string_view raw) {
      const std::string link = link_named(raw);
      if (!link.empty() && seen.insert(link).second) c.links.push_back(link);
    };
    for (std::size_t i = at, end = end_of(at); i < end; ++i) {
      add(elements_[i].text);
      for (const auto& [name, value] : elements_[i].attributes)
        if (i != at || name != "name") add(value);
    }
    out_.closures.push_back(std::move(c));
  }

  FilteredJoint* joint_named(std::string_view raw) {
    const auto found = out_.joints.find(resolved(trimmed(raw)));
    return found == out_.joints.end() ? nullptr : &found->second;
  }
  /// The value of an element: its text, or its attribute.
  static std::string_view value_of(const XmlElement& e) {
    return e.text.empty() ? e.attribute("value") : e.text;
  }
  static bool is_reduction(std::string_view name) {
    return name == "mechanicalReduction" || name == "mechanical_reduction" || name == "reduction";
  }
  /// Its reductions, with those of the joints beside its transmissions.
  void ros2_control(std::size_t at) {
    const std::size_t end_of_all = end_of(at);
    for (std::size_t i = at + 1; i < end_of_all;) {
      const XmlElement& e = elements_[i];
      const std::size_t end = end_of(i);
      if (e.tag == "transmission") {
        transmission(i, end, true);
        i = end;
      } else if (e.tag == "joint") {
        transmission(i - 1, end, false);
        i = end;
      } else {
        if (is_reduction(e.tag) || (e.tag == "param" && is_reduction(e.attribute("name"))))
          unread("a reduction of no joint", e);
        ++i;
      }
    }
  }
  /// The elements after `at`: of a <transmission>, or a joint that may have a reduction.
  void transmission(std::size_t at, std::size_t end, bool is_transmission) {
    std::vector<FilteredJoint*> joints;
    std::vector<std::string> unknown;
    double shared = 0.0, rotor = 0.0, gear = 1.0, rotor_of_actuator = 0.0;
    std::string_view type = is_transmission ? elements_[at].attribute("type") : std::string_view{};
    std::size_t shared_reductions = 0;
    bool any = false, coupled = false;
    FilteredJoint* inside = nullptr;  // of the <joint> that is open
    std::string inside_name;
    std::size_t inside_end = 0;
    const auto reduction = [&](std::string_view raw, const std::string& what, const XmlElement& e) {
      const auto value = number(raw);
      if (!value || *value == 0.0) {
        const std::string no_ratio = what + " " + quoted(raw) + " (no ratio)";
        if (inside_name.empty())
          unread(no_ratio, e);
        else
          unread(no_ratio, "joint", inside_name);
        return;
      }
      any = true;
      if (inside != nullptr) {
        inside->reduction = *value;
      } else if (inside_name.empty()) {
        shared = *value;
        ++shared_reductions;
      }
    };
    for (std::size_t i = at + 1; i < end; ++i) {
      const XmlElement& e = elements_[i];
      if (i >= inside_end) {
        inside = nullptr;
        inside_name.clear();
      }
      if (e.tag == "joint") {
        inside_name = quoted(resolved(trimmed(e.attribute("name"))));
        inside_end = end_of(i);
        inside = joint_named(e.attribute("name"));
        if (trimmed(e.attribute("name")).empty())
          inside_name.clear();
        else if (inside == nullptr)
          unknown.push_back(inside_name);
        else if (std::find(joints.begin(), joints.end(), inside) == joints.end())
          joints.push_back(inside);
      }
      for (const auto& [name, raw] : e.attributes) {
        if (!is_reduction(name)) continue;
        // <flexJoint>, <gap_joint>: of wrists and grippers, where several motors and joints hang together.
        if (e.tag != "joint" && e.tag.ends_with("oint"))
          coupled = true;
        else
          reduction(raw, "the " + core::printable(name) + " of " + tag(e), e);
      }
      if (is_reduction(e.tag) || (e.tag == "param" && is_reduction(e.attribute("name"))))
        reduction(value_of(e), tag(e), e);
      if (is_transmission && type.empty() && (e.tag == "type" || e.tag == "plugin")) type = trimmed(e.text);
      if (is_transmission && e.tag == "compensator") unread(tag(e) + " (a belt)", e);
      const auto value = number(value_of(e));
      if (!value) continue;
      if (e.tag == "drake:rotor_inertia" || e.tag == "rotor_inertia") rotor = *value;
      if (e.tag == "rotorInertia" || (e.tag == "param" && e.attribute("name") == "rotor_inertia"))
        rotor_of_actuator = *value;
      if (e.tag == "drake:gear_ratio" || e.tag == "gear_ratio") {
        if (*value == 0.0)
          unread(tag(e) + " " + quoted(value_of(e)) + " (no ratio)", e);
        else
          gear = *value;
      }
    }
    any |= rotor != 0.0 || gear != 1.0 || rotor_of_actuator != 0.0;
    // "pr2_mechanism_model/SimpleTransmission", "transmission_interface/FourBarLinkageTransmission"
    const std::string_view law = type.substr(type.find_last_of("/:") + 1);
    if (!law.empty() && law.find("imple") == law.npos)
      unread("a <transmission> of the type " + quoted(law) + " (it does more than reduce)", elements_[at]);
    if (is_transmission || any)
      for (const std::string& name : unknown)
        unread(is_transmission ? "a <transmission>" : "a reduction", "unknown joint", name);
    if (joints.size() == 1 && !coupled) {
      FilteredJoint& joint = *joints.front();
      if (shared_reductions == 1) joint.reduction = shared;
      if (shared_reductions > 1)
        unread("a <transmission> with " + std::to_string(shared_reductions) + " reductions", elements_[at]);
      if (gear != 1.0 && joint.reduction == 0.0) joint.reduction = gear;
      joint.rotor_inertia_kgm2 += rotor * gear * gear;
      // An actuator's is on the motor's side of the reduction.
      const double ratio = joint.reduction == 0.0 ? 1.0 : joint.reduction;
      joint.rotor_inertia_kgm2 += rotor_of_actuator * ratio * ratio;
    } else if (coupled ||
               (joints.size() > 1 && (shared_reductions > 0 || rotor != 0.0 || rotor_of_actuator != 0.0))) {
      unread("a <transmission> that couples joints", elements_[at]);
    } else if (joints.empty() && unknown.empty() && any) {
      unread("a <transmission> of no joint", elements_[at]);
    }
  }

  void gazebo(std::size_t at) {
    const XmlElement& e = elements_[at];
    const std::string_view reference = e.attribute("reference");
    const bool is_link = out_.links.contains(resolved(trimmed(reference)));
    const std::size_t end = end_of(at);
    std::string_view joint = reference;
    for (std::size_t i = at + 1; i < end; ++i) {
      const XmlElement& inner = elements_[i];
      if (inner.depth == e.depth + 1) joint = reference;
      if (inner.tag == "joint" && inner.depth == e.depth + 1) {
        if (closes_loop(i))
          i = end_of(i) - 1;
        else  // what it adds to a joint of the robot
          joint = inner.attribute("name");
      } else if (inner.tag == "plugin" || inner.tag == "sensor") {
        mimic_plugin(i);
        i = end_of(i) - 1;
      } else if (inner.tag == "springStiffness" || inner.tag == "spring_stiffness" ||
                 inner.tag == "springReference" || inner.tag == "spring_reference" ||
                 inner.tag == "friction" || inner.tag == "damping") {
        of_joint_in_gazebo(inner, joint, is_link);
      } else if ((inner.tag == "turnGravityOff" && (inner.text == "true" || inner.text == "1")) ||
                 (inner.tag == "gravity" && (inner.text == "false" || inner.text == "0"))) {
        unread(tag(inner) + " (no gravity)", inner);
      }
    }
  }
  /// A <joint> in <gazebo> between two links of the robot.
  bool closes_loop(std::size_t at) {
    const XmlElement *parent = child(at, "parent"), *child_link = child(at, "child");
    if (parent == nullptr || child_link == nullptr) return false;
    UrdfClosure c{elements_[at].line, "joint> in <gazebo", {}};
    for (const XmlElement* end : {parent, child_link}) {
      const std::string_view name = end->text.empty() ? end->attribute("link") : end->text;
      if (const std::string link = link_named(name); !link.empty())
        c.links.push_back(link);
      else if (trimmed(name) == "world")
        c.links.emplace_back();  // the base
    }
    out_.closures.push_back(std::move(c));
    return true;
  }
  /// A spring, friction or damping; of a link they are its surface's.
  void of_joint_in_gazebo(const XmlElement& e, std::string_view name, bool is_link) {
    const auto value = number(value_of(e));
    if (!value || *value == 0.0) return;
    FilteredJoint* joint = joint_named(name);
    if (joint == nullptr) {
      if (!is_link) unread(tag(e) + " in <gazebo>", e);
    } else if (e.tag == "springReference" || e.tag == "spring_reference") {
      joint->spring_rest_rad = *value;
    } else if (e.tag.starts_with("spring")) {
      joint->spring_nmprad = *value;
    } else if (joint->kind != Kind::fixed) {
      unread(tag(e) + " in <gazebo>", "joint", quoted(resolved(trimmed(name))));
    }
  }
  /// A plugin that makes one joint follow another.
  void mimic_plugin(std::size_t at) {
    const XmlElement* mimic = child(at, "mimicJoint");
    const XmlElement* leader = child(at, "joint");
    if (mimic == nullptr || leader == nullptr) return;
    FilteredJoint* joint = joint_named(mimic->text);
    if (joint != nullptr && joint->mimics.empty()) joint->mimics = resolved(leader->text);
  }

  /// An element or attribute that nothing reads, of a joint or link, or in a line.
  void unread(const std::string& what, const std::string& whose, const std::string& name) {
    const auto [known, is_new] = unread_at_.emplace(std::pair(what, whose), unread_.size());
    if (is_new) unread_.push_back({what, whose, {}});
    unread_[known->second].names.push_back(name);
  }
  void unread(const std::string& what, const XmlElement& e) { unread(what, "", std::to_string(e.line)); }
  static std::string text_of(const Unread& u) {
    const std::string count = std::to_string(u.names.size());
    if (u.names.size() == 1)
      return u.what + (u.whose.empty() ? " in line " : " of " + u.whose + " ") + u.names.front();
    if (u.whose.empty()) return u.what + " (" + count + " times, first in line " + u.names.front() + ")";
    return u.what + " (" + count + " times: " + u.whose + " " + first_names(u.names) + ")";
  }

  void unread_notes() {
    if (!unread_.empty()) {
      std::vector<std::string> texts;
      for (const Unread& u : unread_) texts.push_back(text_of(u));
      out_.notes.push_back("The dynamics do not use " + first_names(texts) + " of the URDF.");
    }
    if (!without_inertia_.empty())
      out_.notes.push_back("No <inertia> beside the mass of link " + first_names(without_inertia_) +
                           ": taken as a point mass.");
    if (!without_products_.empty())
      out_.notes.push_back("No products of inertia (ixy, ixz, iyz) of link " +
                           first_names(without_products_) + ": taken as 0.");
  }

  const std::vector<XmlElement>& elements_;
  const std::string& file_;
  FilteredUrdf out_;
  std::string links_text_, joints_text_;
  std::vector<Edge> edges_;
  std::vector<Unread> unread_;  ///< in the order of the file
  std::map<std::pair<std::string, std::string>, std::size_t> unread_at_;
  std::vector<std::string> without_inertia_, without_products_;
};

}  // namespace

std::string first_names(const std::vector<std::string>& names) {
  constexpr std::size_t kFirst = 4;
  std::string out;
  const std::size_t shown = names.size() <= kFirst + 1 ? names.size() : kFirst;
  for (std::size_t i = 0; i < shown; ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out + (shown < names.size() ? " and " + std::to_string(names.size() - shown) + " more" : "");
}

FilteredUrdf filter_urdf(const std::vector<XmlElement>& elements, const std::string& file) {
  return Filter(elements, file).run();
}

}  // namespace furcula::model
