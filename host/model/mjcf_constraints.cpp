// Equality constraints and tendons of MJCF, see mjcf_names.hpp.
#include <set>

#include "host/core/message.hpp"
#include "host/model/mjcf_names.hpp"

namespace furcula::model {
namespace {

class Reader {
 public:
  Reader(const MjcfDefaults& defaults, const MjcfNames& names, Urdf& robot)
      : defaults_(defaults), names_(names), robot_(robot) {}

  void equality(const MjcfElement& e) {
    const MjcfFields f = defaults_.of(e, "", "equality");
    if (!f.flag("active", true)) return;
    if (e.tag == "tendon") return;  // the tendon itself is judged
    if (e.tag == "joint") return joint(e);
    if (e.tag != "connect" && e.tag != "weld")
      e.fail(
          "is an equality constraint that this program does not know; expected a tree of joints: take it out of the file");
    UrdfClosure c = closure(e);
    for (const char* which : {"1", "2"}) {
      if (!e.attribute(std::string("site") + which).empty())
        add(c, names_.sites, e, std::string("site") + which);
      else if (const std::string body = std::string("body") + which; !e.attribute(body).empty())
        add(c, names_.bodies, e, body);
      else
        c.links.emplace_back();
    }
    robot_.closures.push_back(std::move(c));
  }
  void tendon(const MjcfElement& e) {
    UrdfClosure c = closure(e);
    for (const MjcfElement& part : e.children) {
      if (part.tag == "joint") {
        const UrdfJoint& j = joint_of(part, "joint");
        c.links.push_back(robot_.links[j.parent].name);
        c.links.push_back(robot_.links[j.child].name);
      } else if (part.tag == "site") {
        add(c, names_.sites, part, "site");
      } else if (part.tag == "geom") {
        add(c, names_.geoms, part, "geom");
      }
    }
    std::set<std::string> seen;
    std::erase_if(c.links, [&](const std::string& link) { return !seen.insert(link).second; });
    if (c.links.size() == 1) c.links.push_back(c.links[0]);
    robot_.closures.push_back(std::move(c));
  }

 private:
  /// It is named by its tag in messages.
  UrdfClosure closure(const MjcfElement& e) const {
    const std::string title = e.title();
    return {e.line,
            title.substr(1, title.size() - 2),
            {},

            e.file == robot_.file ? "" : e.file};
  }
  void add(UrdfClosure& c, const MjcfNames::Index& index, const MjcfElement& e,
           const std::string& attribute) {
    const auto found = index.find(e.attribute(attribute));
    if (found == index.end())
      e.fail("has " + attribute + " = " + core::quoted(e.attribute(attribute)) +
             ", which the file does not have; expected the name of one");
    c.links.push_back(robot_.links[found->second].name);
  }
  UrdfJoint& joint_of(const MjcfElement& e, const std::string& attribute) {
    const auto found = names_.joints.find(e.attribute(attribute));
    if (found == names_.joints.end())
      e.fail("has " + attribute + " = " + core::quoted(e.attribute(attribute)) +
             ", which is no hinge or slide of the file; expected the name of one");
    return robot_.joints[found->second];
  }
  /// One joint follows another, or stays where it is.
  void joint(const MjcfElement& e) {
    UrdfJoint& first = joint_of(e, "joint1");
    if (!e.attribute("joint2").empty()) {
      first.mimics = joint_of(e, "joint2").name;
      return;
    }
    UrdfClosure c = closure(e);
    c.links = {robot_.links[first.parent].name, robot_.links[first.child].name};
    robot_.closures.push_back(std::move(c));
  }

  const MjcfDefaults& defaults_;
  const MjcfNames& names_;
  Urdf& robot_;
};

}  // namespace

void read_mjcf_constraints(const std::vector<const MjcfElement*>& equalities,
                           const std::vector<const MjcfElement*>& tendons, const MjcfDefaults& defaults,
                           const MjcfNames& names, Urdf& robot) {
  Reader reader(defaults, names, robot);
  for (const MjcfElement* s : equalities)
    for (const MjcfElement& e : s->children) reader.equality(e);
  for (const MjcfElement* s : tendons)
    for (const MjcfElement& e : s->children) reader.tendon(e);
}

}  // namespace furcula::model
