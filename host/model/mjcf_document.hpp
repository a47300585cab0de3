// An MJCF file as a tree of elements: its includes in their places, each element with the file and line it stands in, and the
// attributes that its default classes give it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/dynamics/tree/spatial.hpp"

namespace furcula::model {

struct MjcfElement {
  std::string tag;
  std::string file;      ///< as messages name it
  std::size_t line = 0;  ///< of that file
  std::map<std::string, std::string, std::less<>> attributes{};
  std::vector<MjcfElement> children{};

  /// Empty if it has none of that name.
  std::string_view attribute(std::string_view name) const {
    const auto found = attributes.find(name);
    return found == attributes.end() ? std::string_view{} : std::string_view(found->second);
  }
  /// `<joint name="elbow">`
  std::string title() const;
  /// @throws core::DataError: file, line, element, and this.
  [[noreturn]] void fail(const std::string& what) const;
};

/// The text of an included file, by its path. @throws core::DataError where it cannot be read.
using MjcfFiles = std::function<std::string(const std::string& path)>;

/// The root element <mujoco>, with what <include> names in its place. Included paths are seen from the folder of `name`, or from that of the
/// file that includes.
/// @throws core::DataError: what check_xml throws; another root; a file that is included twice, too deep or is not there; a second attribute of a name.
MjcfElement read_mjcf_elements(std::string_view text, const std::string& name, const MjcfFiles& files);

/// What MuJoCo's <compiler> says of the meaning of the other elements.
struct MjcfCompiler {
  enum class FromGeoms { never, always, where_missing };
  bool degrees = true, global = false, autolimits = true, balance_inertia = false;
  std::string euler_sequence = "xyz";
  FromGeoms inertia_from_geoms = FromGeoms::where_missing;
  double bound_mass_kg = 0.0, bound_inertia_kgm2 = 0.0, total_mass_kg = -1.0;
  int least_group = 0, last_group = 5;
};

/// An element's attributes with those of its default class where it has none of its own, and what they mean.
class MjcfFields {
 public:
  using Vec3 = dynamics::tree::Vec3<double>;

  MjcfFields(const MjcfElement& element, std::map<std::string, std::string, std::less<>> attributes)
      : element_(&element), attributes_(std::move(attributes)) {}

  const MjcfElement& element() const { return *element_; }
  bool has(std::string_view name) const { return attributes_.contains(name); }
  std::string_view text(std::string_view name) const;
  /// One of `of`; the first where there is none.
  std::string choice(std::string_view name, std::initializer_list<std::string_view> of) const;
  /// "true"; "auto" and none are `otherwise`.
  bool flag(std::string_view name, bool otherwise) const;
  double number(std::string_view name, double otherwise) const;
  double not_negative(std::string_view name) const;  ///< 0 where there is none
  /// `least` to `most` numbers; nothing where there is none.
  std::vector<double> numbers(std::string_view name, std::size_t least, std::size_t most) const;
  Vec3 vec3(std::string_view name, const Vec3& otherwise) const;
  /// Where it is in its parent: `pos` and one of quat, axisangle, euler, xyaxes, zaxis.
  dynamics::tree::Frame<double> frame(const MjcfCompiler& compiler) const;
  bool has_orientation() const;
  [[noreturn]] void fail(const std::string& what) const { element_->fail(what); }
  [[noreturn]] void fail(std::string_view attribute, const std::string& expected) const;

 private:
  const MjcfElement* element_;
  std::map<std::string, std::string, std::less<>> attributes_;
};

/// Rotation that takes a vector of the frame to the parent, from MuJoCo's quaternion w x y z of any length above 0; as Frame::turn.
dynamics::tree::Mat3<double> turn_of(double w, double x, double y, double z);
/// The shortest turn of z to a vector.
dynamics::tree::Mat3<double> turn_of_z_to(const dynamics::tree::Vec3<double>& to);

/// The default classes.
class MjcfDefaults {
 public:
  /// Adds a section <default>. @throws core::DataError: a class without a name, or that is there already.
  void add(const MjcfElement& section);
  /// The element's own attributes over those of its class, `inherited` where it names none; `tag` is that of the defaults.
  MjcfFields of(const MjcfElement& element, const std::string& inherited, std::string_view tag) const;
  /// The attributes of actuators come from several elements (motor, position, general ...), the later ones over the earlier; in their order.
  const std::vector<const MjcfElement*>& actuators_of(const MjcfElement& element) const;
  /// @throws core::DataError where there is no such class
  void require(const MjcfElement& element, const std::string& name) const;

 private:
  struct Class {
    std::map<std::string, std::map<std::string, std::string, std::less<>>, std::less<>> by_tag;
    std::vector<const MjcfElement*> actuators;
  };
  void add(const MjcfElement& section, const std::string* parent);  // NOLINT(misc-no-recursion)
  const Class* class_of(const MjcfElement& element, const std::string& inherited) const;

  std::map<std::string, Class> classes_{{"main", {}}};
};

/// Whether it is an element of <actuator>, or of <default> for one.
bool is_mjcf_actuator(std::string_view tag);

}  // namespace furcula::model
