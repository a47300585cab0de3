// Elements and default classes of MJCF, see mjcf_document.hpp.
#include "host/model/mjcf_document.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/model/xml_check.hpp"
#include "host/model/xml_text.hpp"

namespace furcula::model {
namespace {

using dynamics::tree::Frame;
using dynamics::tree::Mat3;
using dynamics::tree::Vec3;
namespace fs = std::filesystem;

constexpr std::size_t kFilesMax = 64, kIncludeDepthMax = 8;
constexpr std::string_view kActuators[] = {"general",     "motor",   "position", "velocity",
                                           "intvelocity", "damper",  "cylinder", "muscle",
                                           "adhesion",    "dcmotor", "plugin"};
/// MuJoCo keeps a value of each form, its class's or its own, and the later one here counts.
constexpr std::string_view kOrientations[] = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};
/// MuJoCo's own bound of positions and speeds, mjMAXVAL.
constexpr double kMost = 1e10;

using Attributes = std::map<std::string, std::string, std::less<>>;

/// Writes an element's attributes over those of its class.
void take(Attributes& to, const MjcfElement& e) {
  bool own = false;
  for (const std::string_view form : kOrientations) {
    if (own && to.contains(form))
      e.fail("has an orientation beside the " + std::string(form) +
             " of its default class, which MuJoCo prefers; expected one form in both: " + std::string(form));
    own |= e.attributes.contains(form);
  }
  if (own)
    for (const std::string_view form : kOrientations) to.erase(std::string(form));
  for (const auto& [key, value] : e.attributes) {
    std::string& all = to[key];
    std::string merged = value;
    // Sizes that it does not have are its class's.
    if (e.tag == "geom" && key == "size")
      for (std::size_t k = words(value).size(); k < words(all).size(); ++k)
        merged += " " + std::string(words(all)[k]);
    all = std::move(merged);
  }
}

class ElementReader {
 public:
  ElementReader(std::string folder, const MjcfFiles& files) : folder_(std::move(folder)), files_(files) {}

  MjcfElement read(std::string_view text, const std::string& name,
                   std::size_t depth) {  // NOLINT(misc-no-recursion)
    const std::vector<XmlElement> flat = check_xml(text, name, kMjcfDepthMax);
    std::size_t at = 0;
    return element(flat, at, name, depth);
  }

 private:
  // At most kMjcfDepthMax elements within each other, in at most kIncludeDepthMax files.
  MjcfElement element(const std::vector<XmlElement>& flat, std::size_t& at,
                      const std::string& file,  // NOLINT(misc-no-recursion)
                      std::size_t depth) {
    const XmlElement& from = flat[at++];
    MjcfElement out{std::string(from.tag), file, from.line};
    for (const auto& [name, value] : from.attributes)
      if (!out.attributes.emplace(name, resolved(value)).second)
        out.fail("has the attribute '" + core::printable(name) + "' twice; expected it once");
    while (at < flat.size() && flat[at].depth > from.depth) {
      MjcfElement child = element(flat, at, file, depth);
      if (child.tag != "include") {
        out.children.push_back(std::move(child));
        continue;
      }
      if (!child.children.empty()) child.fail("has elements within it; expected none");
      for (MjcfElement& included : include(child, depth).children)
        out.children.push_back(std::move(included));
    }
    return out;
  }
  MjcfElement include(const MjcfElement& from, std::size_t depth) {  // NOLINT(misc-no-recursion)
    const std::string path(from.attribute("file"));
    if (path.empty() || core::printable(path) != path)
      from.fail("names no file; expected file=\"...\", seen from the folder of the main file");
    if (depth >= kIncludeDepthMax)
      from.fail("is " + std::to_string(depth) + " files deep; expected at most " +
                std::to_string(kIncludeDepthMax));
    std::error_code error;
    std::string found = (fs::path(folder_) / path).lexically_normal().string();
    if (!fs::exists(found, error)) {
      const fs::path beside = (fs::path(from.file).parent_path() / path).lexically_normal();
      if (fs::exists(beside, error)) found = beside.string();
    }
    if (included_.size() >= kFilesMax || !included_.insert(found).second)
      from.fail("names " + core::quoted(path) + ", which is included already" +
                (included_.size() >= kFilesMax ? " or is one file too many" : "") +
                "; expected each file once, as MuJoCo does, and at most " + std::to_string(kFilesMax));
    std::string text;
    try {
      text = files_(found);
    } catch (const core::DataError& e) {
      from.fail("names a file that cannot be read: " + std::string(e.what()));
    }
    return read(text, found, depth + 1);
  }

  const std::string folder_;
  const MjcfFiles& files_;
  std::set<std::string> included_;
};

Mat3<double> about(const Vec3<double>& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return turn_of(std::cos(0.5 * angle), axis.x * s, axis.y * s, axis.z * s);
}
double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

}  // namespace

std::string MjcfElement::title() const {
  const std::string_view name = attribute("name");
  return "<" + core::printable(tag) +
         (name.empty() ? "" : " name=\"" + core::printable(std::string(name)) + "\"") + ">";
}

void MjcfElement::fail(const std::string& what) const {
  throw core::DataError(file + ":" + std::to_string(line) + ": " + title() + " " + what);
}

MjcfElement read_mjcf_elements(std::string_view text, const std::string& name, const MjcfFiles& files) {
  MjcfElement out = ElementReader(fs::path(name).parent_path().string(), files).read(text, name, 1);
  if (out.tag != "mujoco") out.fail("is the root; expected <mujoco> (MJCF)");
  return out;
}

Mat3<double> turn_of(double w, double x, double y, double z) {
  const double n = 1.0 / std::sqrt(w * w + x * x + y * y + z * z);
  w *= n, x *= n, y *= n, z *= n;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
          {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
          {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
}

Mat3<double> turn_of_z_to(const Vec3<double>& to) {
  constexpr double kParallel = 1e-10;
  const Vec3<double> unit = to * (1.0 / length(to));
  const Vec3<double> axis{-unit.y, unit.x, 0.0};
  const double s = length(axis);
  if (s < kParallel) return about({1.0, 0.0, 0.0}, std::atan2(s, unit.z));
  return about(axis * (1.0 / s), std::atan2(s, unit.z));
}

std::string_view MjcfFields::text(std::string_view name) const {
  const auto found = attributes_.find(name);
  return found == attributes_.end() ? std::string_view{} : trimmed(found->second);
}

void MjcfFields::fail(std::string_view attribute, const std::string& expected) const {
  element_->fail("has " + std::string(attribute) + " = " + core::quoted(text(attribute)) + "; expected " +
                 expected);
}

std::string MjcfFields::choice(std::string_view name, std::initializer_list<std::string_view> of) const {
  if (!has(name)) return std::string(*of.begin());
  const auto* const found = std::find(of.begin(), of.end(), text(name));
  if (found == of.end()) fail(name, "one of " + core::listed(std::vector<std::string_view>(of)));
  return std::string(*found);
}

bool MjcfFields::flag(std::string_view name, bool otherwise) const {
  const std::string which = choice(name, {"auto", "true", "false"});
  return which == "auto" ? otherwise : which == "true";
}

std::vector<double> MjcfFields::numbers(std::string_view name, std::size_t least, std::size_t most) const {
  std::vector<double> out;
  if (!has(name)) return out;
  for (const std::string_view word : words(text(name))) {
    const auto value = model::number(word);
    if (!value) element_->fail("has " + std::string(name) + ": " + no_number(word));
    if (std::abs(*value) > kMost && !name.ends_with("range")) fail(name, "numbers up to 1e10 (mjMAXVAL)");
    out.push_back(*value);
  }
  if (out.size() < least || out.size() > most)
    fail(name,
         (least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most)) +
             (most == 1 ? " number" : " numbers"));
  return out;
}

double MjcfFields::number(std::string_view name, double otherwise) const {
  const std::vector<double> one = numbers(name, 1, 1);
  return one.empty() ? otherwise : one[0];
}
double MjcfFields::not_negative(std::string_view name) const {
  const double out = number(name, 0.0);
  if (out < 0.0) fail(name, "at least 0");
  return out;
}
Vec3<double> MjcfFields::vec3(std::string_view name, const Vec3& otherwise) const {
  const std::vector<double> v = numbers(name, 3, 3);
  return v.empty() ? otherwise : Vec3{v[0], v[1], v[2]};
}

bool MjcfFields::has_orientation() const {
  return std::any_of(std::begin(kOrientations), std::end(kOrientations),
                     [&](std::string_view name) { return has(name); });
}

Frame<double> MjcfFields::frame(const MjcfCompiler& compiler) const {
  Frame<double> out{dynamics::tree::identity<double>(), vec3("pos", {0.0, 0.0, 0.0})};
  if (std::count_if(std::begin(kOrientations), std::end(kOrientations),
                    [&](std::string_view name) { return has(name); }) > 1)
    element_->fail("has more than one orientation; expected one of quat, axisangle, euler, xyaxes, zaxis");
  const double unit = compiler.degrees ? std::numbers::pi / 180.0 : 1.0;
  if (const auto q = numbers("quat", 4, 4); !q.empty()) {
    if (!(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 1e-20))
      fail("quat", "one that is not zero");
    out.turn = turn_of(q[0], q[1], q[2], q[3]);
  }
  if (const auto a = numbers("axisangle", 4, 4); !a.empty()) {
    const Vec3 axis{a[0], a[1], a[2]};
    if (!(length(axis) > 1e-10)) fail("axisangle", "an axis that is not zero, and an angle");
    out.turn = about(axis * (1.0 / length(axis)), a[3] * unit);
  }
  if (const auto e = numbers("euler", 3, 3); !e.empty())
    for (std::size_t k = 0; k < 3; ++k) {
      const char axis = compiler.euler_sequence[k];
      const bool moves = axis >= 'x';
      const double which = axis - (moves ? 'x' : 'X');
      const Mat3<double> turn =
          about({which == 0 ? 1.0 : 0.0, which == 1 ? 1.0 : 0.0, which == 2 ? 1.0 : 0.0}, e[k] * unit);
      // Turns take the parent's coordinates to the frame's: the later of two about axes that move stands left.
      out.turn = moves ? turn * out.turn : out.turn * turn;
    }
  if (const auto a = numbers("xyaxes", 6, 6); !a.empty()) {
    Vec3 x{a[0], a[1], a[2]}, y{a[3], a[4], a[5]};
    if (length(x) > 1e-10) {
      x = x * (1.0 / length(x));
      y = y - x * dot(x, y);
    }
    if (!(length(x) > 1e-10) || !(length(y) > 1e-10))
      fail("xyaxes", "two axes that are not zero and not parallel");
    y = y * (1.0 / length(y));
    out.turn = {x, y, cross(x, y)};
  }
  if (has("zaxis")) {
    const Vec3 z = vec3("zaxis", {0.0, 0.0, 1.0});
    if (!(length(z) > 1e-10)) fail("zaxis", "an axis that is not zero");
    out.turn = turn_of_z_to(z);
  }
  return out;
}

bool is_mjcf_actuator(std::string_view tag) {
  return std::find(std::begin(kActuators), std::end(kActuators), tag) != std::end(kActuators);
}

void MjcfDefaults::add(const MjcfElement& section) { add(section, nullptr); }

void MjcfDefaults::add(const MjcfElement& section, const std::string* parent) {  // NOLINT(misc-no-recursion)
  std::string name(section.attribute("class"));
  if (parent == nullptr && name.empty()) name = "main";
  if (name.empty()) section.fail("has no class; expected class=\"...\" on a <default> within another");
  if (parent != nullptr && !classes_.emplace(name, classes_.at(*parent)).second)
    section.fail("has the class " + core::quoted(name) +
                 ", which is there already; expected each class once");
  // The top one is the same class in each section, however it is called.
  Class& of = parent == nullptr ? classes_["main"] : classes_.at(name);
  for (const MjcfElement& e : section.children) {
    if (e.tag == "default") continue;
    if (is_mjcf_actuator(e.tag)) {
      of.actuators.push_back(&e);
      continue;
    }
    Attributes& attributes = of.by_tag[e.tag];
    take(attributes, e);
  }
  if (parent == nullptr && name != "main") classes_[name] = of;
  for (const MjcfElement& e : section.children)
    if (e.tag == "default") add(e, &name);
}

const MjcfDefaults::Class* MjcfDefaults::class_of(const MjcfElement& element,
                                                  const std::string& inherited) const {
  const std::string own(element.attribute("class"));
  const std::string& name = own.empty() ? inherited : own;
  require(element, name);
  return &classes_.at(name.empty() ? "main" : name);
}

void MjcfDefaults::require(const MjcfElement& element, const std::string& name) const {
  if (name.empty() || classes_.contains(name)) return;
  std::vector<std::string_view> known;
  for (const auto& [known_name, of] : classes_) known.emplace_back(known_name);
  element.fail("is of the class " + core::quoted(name) + ", which no <default> has; expected one of " +
               core::listed(known) + core::did_you_mean(name, known));
}

MjcfFields MjcfDefaults::of(const MjcfElement& element, const std::string& inherited,
                            std::string_view tag) const {
  const Class* from = class_of(element, inherited);
  const auto found = from->by_tag.find(tag);
  Attributes attributes = found == from->by_tag.end() ? Attributes{} : found->second;
  take(attributes, element);
  return {element, std::move(attributes)};
}

const std::vector<const MjcfElement*>& MjcfDefaults::actuators_of(const MjcfElement& element) const {
  return class_of(element, "")->actuators;
}

}  // namespace furcula::model
