// See mjcf_edits.hpp.
#include "host/trees/mjcf_edits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/model/mjcf_reader.hpp"
#include "host/model/xml_check.hpp"
#include "host/trees/edits.hpp"

namespace furcula::trees {
namespace {

using core::shortest;
using dynamics::tree::Sym3;
using model::UrdfInertia;
using model::UrdfJoint;
using model::Vec3;
using model::XmlElement;

std::string three(const Vec3<double>& v) { return shortest(v.x) + " " + shortest(v.y) + " " + shortest(v.z); }
bool near(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max({1e-6, std::abs(a), std::abs(b)}); }

class MjcfEditor {
 public:
  MjcfEditor(const std::string& text, const model::Urdf& before, const MjcfChanges& changes)
      : text_(text),
        before_(before),
        changes_(changes),
        elements_(model::check_xml(text, before.file, model::kMjcfDepthMax)),
        edits_(text) {}

  std::optional<std::string> write(const std::string& head) {
    if (std::any_of(elements_.begin(), elements_.end(), [](const auto& e) { return e.tag == "include"; }))
      return std::nullopt;
    for (const UrdfJoint& j : before_.joints)
      if (const auto to = changes_.joints.find(j.name); to != changes_.joints.end() && !joint(j, to->second))
        return std::nullopt;
    for (const auto& [name, inertia] : changes_.bodies)
      if (!body(name, inertia)) return std::nullopt;
    gravity();
    edits_.insert_on_top(head);
    std::string out = edits_.text();
    return says(out) ? std::optional(std::move(out)) : std::nullopt;
  }

 private:
  /// The element of that tag and name below one of the root's children.
  const XmlElement* named(std::string_view section, std::string_view tag, std::string_view attribute,
                          const std::string& name) const {
    std::string_view within;
    for (const XmlElement& e : elements_) {
      if (e.depth == 1) within = e.tag;
      if (e.depth > 1 && within == section && e.tag == tag && model::resolved(e.attribute(attribute)) == name)
        return &e;
    }
    return nullptr;
  }

  bool joint(const UrdfJoint& j, const MjcfChanges::Joint& to) {
    const XmlElement* e = named("worldbody", "joint", "name", j.name);
    const auto set = [&](const char* attribute, double given, double value, double unit = 1.0) {
      if (near(given, value)) return true;
      if (e != nullptr) edits_.set(*e, attribute, shortest(value / unit));
      return e != nullptr;
    };
    const bool turns = j.kind != UrdfJoint::Kind::prismatic;
    bool done = set("armature", j.rotor_inertia_kgm2, to.armature_kgm2);
    done &= set("damping", j.damping, to.damping_nmspr);
    done &= set("frictionloss", j.friction, to.friction_nm);
    done &= set("stiffness", j.spring_nmprad, to.stiffness_nmprad);
    if (to.stiffness_nmprad != 0.0)
      done &= set("springref", j.spring_rest_rad, to.rest_rad,
                  turns && degrees() ? std::numbers::pi / 180.0 : 1.0);
    if (!near(j.kp_nmprad, to.kp_nmprad) || !near(j.kd_nmsprad, to.kd_nmsprad)) {
      const XmlElement* actuator = named("actuator", "position", "joint", j.name);
      if (actuator == nullptr) return false;
      edits_.set(*actuator, "kp", shortest(to.kp_nmprad));
      if (!near(j.kd_nmsprad, to.kd_nmsprad)) edits_.set(*actuator, "kv", shortest(to.kd_nmsprad));
    }
    return done;
  }
  bool degrees() const {
    bool out = true;
    for (const XmlElement& e : elements_)
      if (e.depth == 1 && e.tag == "compiler" && !e.attribute("angle").empty())
        out = e.attribute("angle") != "radian";
    return out;
  }

  bool body(const std::string& name, const UrdfInertia& to) {
    const XmlElement* e = named("worldbody", "body", "name", name);
    if (e == nullptr) return false;
    const Sym3<double> s = turned_back(to.frame.turn, to.about_centre_kgm2);
    std::string element = "<inertial pos=\"" + three(to.frame.at) + "\" mass=\"" + shortest(to.mass_kg) +
                          "\" fullinertia=\"" + three({s.xx, s.yy, s.zz}) + " " + three({s.xy, s.xz, s.yz}) +
                          "\"/>";
    const auto from = static_cast<std::size_t>(e - elements_.data());
    for (std::size_t i = from + 1; i < elements_.size() && elements_[i].depth > e->depth; ++i)
      if (elements_[i].depth == e->depth + 1 && elements_[i].tag == "inertial") {
        // The whole tag, whose end is not within an attribute.
        const std::size_t begin = edits_.place(elements_[i].tag) - 1;
        std::size_t end = begin;
        for (char quote = 0; end < text_.size() && (quote != 0 || text_[end] != '>'); ++end)
          if (quote != 0 ? text_[end] == quote : text_[end] == '"' || text_[end] == '\'')
            quote = quote != 0 ? '\0' : text_[end];
        if (text_[end - 1] != '/') return false;
        edits_.replace(std::string_view(text_).substr(begin, end + 1 - begin), element);
        return true;
      }
    if (from + 1 >= elements_.size() || elements_[from + 1].depth <= e->depth) return false;
    edits_.add_before(elements_[from + 1], element);
    return true;
  }

  void gravity() {
    const Vec3<double>&a = before_.gravity_mps2, &b = changes_.gravity_mps2;
    if (near(a.x, b.x) && near(a.y, b.y) && near(a.z, b.z)) return;
    const XmlElement* option = nullptr;
    for (const XmlElement& e : elements_)
      if (e.depth == 1 && e.tag == "option") option = &e;
    if (option != nullptr)
      edits_.set(*option, "gravity", three(b));
    else if (elements_.size() > 1)
      edits_.add_before(elements_[1], "<option gravity=\"" + three(b) + "\"/>");
  }

  /// Whether the text reads back as what it should be.
  bool says(const std::string& text) const {
    try {
      const model::Urdf now = model::parse_mjcf(
          text, before_.file, [](const std::string& path) -> std::string { throw core::DataError(path); });
      if (now.joints.size() != before_.joints.size() || now.links.size() != before_.links.size())
        return false;
      const Vec3<double> g = now.gravity_mps2 - changes_.gravity_mps2;
      if (!near(dot(g, g), 0.0)) return false;
      for (const UrdfJoint& j : now.joints) {
        const auto to = changes_.joints.find(j.name);
        if (to == changes_.joints.end()) continue;
        const MjcfChanges::Joint& t = to->second;
        if (!near(j.rotor_inertia_kgm2, t.armature_kgm2) || !near(j.damping, t.damping_nmspr) ||
            !near(j.friction, t.friction_nm) || !near(j.spring_nmprad, t.stiffness_nmprad) ||
            !near(j.kp_nmprad, t.kp_nmprad) || !near(j.kd_nmsprad, t.kd_nmsprad) ||
            (t.stiffness_nmprad != 0.0 && !near(j.spring_rest_rad, t.rest_rad)))
          return false;
      }
      for (std::size_t i = 0; i < now.links.size(); ++i) {
        const auto to = changes_.bodies.find(now.links[i].name);
        const auto& expected =
            to == changes_.bodies.end() ? before_.links[i].inertia : std::optional(to->second);
        if (expected.has_value() != now.links[i].inertia.has_value()) return false;
        if (expected && !same(*expected, *now.links[i].inertia)) return false;
      }
      return true;
    } catch (const core::DataError&) {
      return false;
    }
  }
  static bool same(const UrdfInertia& a, const UrdfInertia& b) {
    const Sym3<double> s = turned_back(a.frame.turn, a.about_centre_kgm2),
                       t = turned_back(b.frame.turn, b.about_centre_kgm2);
    const Vec3<double> c = a.frame.at - b.frame.at;
    return near(a.mass_kg, b.mass_kg) && near(dot(c, c), 0.0) && near(s.xx, t.xx) && near(s.xy, t.xy) &&
           near(s.xz, t.xz) && near(s.yy, t.yy) && near(s.yz, t.yz) && near(s.zz, t.zz);
  }

  const std::string& text_;
  const model::Urdf& before_;
  const MjcfChanges& changes_;
  const std::vector<XmlElement> elements_;
  Edits edits_;
};

}  // namespace

std::optional<std::string> edited_mjcf(const std::string& text, const model::Urdf& before,
                                       const MjcfChanges& changes, const std::string& head) {
  return MjcfEditor(text, before, changes).write(head);
}

}  // namespace furcula::trees
