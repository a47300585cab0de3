// Bodies and joints of MJCF, see mjcf_reader.hpp.
#include "host/model/mjcf_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/model/mjcf_names.hpp"
#include "host/model/mjcf_schema.hpp"
#include "host/model/mjcf_shapes.hpp"
#include "host/model/urdf_filter.hpp"

namespace furcula::model {
namespace {

using dynamics::tree::identity;
using dynamics::tree::Mat3;
using Kind = UrdfJoint::Kind;

constexpr double kDegree = std::numbers::pi / 180.0;

Frame<double> at_point(const Vec3<double>& p) { return {identity<double>(), p}; }
Frame<double> inverse(const Frame<double>& f) { return {transposed(f.turn), -(f.turn * f.at)}; }
Mat3<double> about(const Vec3<double>& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return turn_of(std::cos(0.5 * angle), axis.x * s, axis.y * s, axis.z * s);
}

/// Where an element is: the class that it inherits, and the frames between it and its body.
struct Place {
  std::string inherited;
  Frame<double> in_body = at_point({0.0, 0.0, 0.0});
};

class Reader {
 public:
  Reader(const MjcfElement& root, const std::string& name) : root_(root) {
    out_.file = name;
    out_.is_mjcf = true;
  }

  Urdf read() {
    check_mjcf_names(root_);
    out_.name =
        word(root_, root_.attributes.contains("model") ? std::string(root_.attribute("model")) : "robot");
    for (const MjcfElement* e : sections("compiler")) read_compiler(MjcfFields(*e, e->attributes));
    for (const MjcfElement* e : sections("option")) read_option(*e);
    for (const MjcfElement* e : sections("default")) defaults_.add(*e);
    const std::vector<const MjcfElement*> worlds = sections("worldbody");
    if (worlds.empty()) root_.fail("has no <worldbody>; expected one with the robot's bodies");
    if (!free_root(worlds)) {
      out_.links.push_back({"world", std::nullopt, worlds[0]->line, "", false, included(*worlds[0])});
      names_.bodies["world"] = 0;
      for (const MjcfElement* e : worlds) world(*e);
    }
    set_total_mass();
    for (const MjcfElement* e : sections("deformable"))
      for (const MjcfElement& d : e->children)
        if (d.tag != "skin") d.fail("is not rigid; expected rigid bodies alone: take it out of the file");
    read_mjcf_constraints(sections("equality"), sections("tendon"), defaults_, names_, out_);
    std::vector<std::string> assumed;
    read_mjcf_actuators(sections("actuator"), defaults_, names_, out_, assumed);
    note(assumed);
    return std::move(out_);
  }

 private:
  std::vector<const MjcfElement*> sections(std::string_view tag) const {
    std::vector<const MjcfElement*> out;
    for (const MjcfElement& e : root_.children)
      if (e.tag == tag) out.push_back(&e);
    return out;
  }
  std::string included(const MjcfElement& e) const { return e.file == out_.file ? "" : e.file; }
  /// A name goes into logs, a line or a column of them.
  static std::string word(const MjcfElement& e, const std::string& name) {
    if (core::printable(name) != name)
      e.fail("has the name " + core::quoted(name) + "; expected printable characters");
    return name;
  }

  void read_compiler(const MjcfFields& f) {
    using FromGeoms = MjcfCompiler::FromGeoms;
    MjcfCompiler& c = compiler_;
    if (f.has("angle")) c.degrees = f.choice("angle", {"degree", "radian"}) == "degree";
    if (f.has("coordinate")) c.global = f.choice("coordinate", {"local", "global"}) == "global";
    c.autolimits = f.flag("autolimits", c.autolimits);
    c.balance_inertia = f.flag("balanceinertia", c.balance_inertia);
    if (f.has("inertiafromgeom")) {
      const std::string from = f.choice("inertiafromgeom", {"auto", "true", "false"});
      c.inertia_from_geoms = from == "auto"   ? FromGeoms::where_missing
                             : from == "true" ? FromGeoms::always
                                              : FromGeoms::never;
    }
    if (f.has("boundmass")) c.bound_mass_kg = f.not_negative("boundmass");
    if (f.has("boundinertia")) c.bound_inertia_kgm2 = f.not_negative("boundinertia");
    c.total_mass_kg = f.number("settotalmass", c.total_mass_kg);
    if (const auto range = f.numbers("inertiagrouprange", 2, 2); !range.empty()) {
      c.least_group = static_cast<int>(std::clamp(range[0], -1e6, 1e6));
      c.last_group = static_cast<int>(std::clamp(range[1], -1e6, 1e6));
    }
    if (f.has("eulerseq")) {
      c.euler_sequence = f.text("eulerseq");
      if (c.euler_sequence.size() != 3 || c.euler_sequence.find_first_not_of("xyzXYZ") != std::string::npos)
        f.fail("eulerseq", "three letters of xyzXYZ");
    }
  }
  void read_option(const MjcfElement& e) {
    const MjcfFields f(e, e.attributes);
    out_.gravity_mps2 = f.vec3("gravity", out_.gravity_mps2);
    if (!(f.number("timestep", 1.0) > 0.0)) f.fail("timestep", "a number of seconds above 0");
    fluid_ |= f.number("density", 0.0) != 0.0 || f.number("viscosity", 0.0) != 0.0;
    if (f.has("actuatorgroupdisable")) not_used_.emplace_back("actuatorgroupdisable of <option>");
    for (const MjcfElement& flags : e.children) {
      if (flags.tag != "flag") continue;
      const MjcfFields g(flags, flags.attributes);
      const auto off = [&](std::string_view name) {
        return g.choice(name, {"enable", "disable"}) == "disable";
      };
      gravity_off_ |= off("gravity");
      passive_off_ |= off("passive");
      spring_off_ |= passive_off_ || off("spring");
      damper_off_ |= passive_off_ || off("damper");
      friction_off_ |= off("frictionloss") || off("constraint");
      if (off("actuation")) not_used_.emplace_back("actuation=\"disable\" of <flag>");
    }
    if (gravity_off_) out_.gravity_mps2 = {0.0, 0.0, 0.0};
  }

  static const MjcfElement* free_joint(const MjcfElement& body) {
    for (const MjcfElement& e : body.children)
      if (e.tag == "freejoint" || (e.tag == "joint" && e.attribute("type") == "free")) return &e;
    return nullptr;
  }
  /// One body that is free, and not turned: it stands where the model begins. Its links are those of a URDF whose root floats.
  bool free_root(const std::vector<const MjcfElement*>& worlds) {
    const MjcfElement* only = nullptr;
    std::string inherited;
    for (const MjcfElement* w : worlds)
      for (const MjcfElement& e : w->children) {
        if (e.tag == "frame") return false;
        if (e.tag != "body") continue;
        if (only != nullptr) return false;
        only = &e;
        inherited = w->attribute("childclass");
      }
    if (only == nullptr || free_joint(*only) == nullptr ||
        MjcfFields(*only, only->attributes).has_orientation())
      return false;
    std::size_t joints = 0;
    for (const MjcfElement& e : only->children) joints += e.tag == "joint" || e.tag == "freejoint" ? 1 : 0;
    if (joints != 1) return false;
    for (const MjcfElement* w : worlds)
      for (const MjcfElement& e : w->children)
        if (e.tag != "body") world_element(e, {}, false);
    const Frame<double> world =
        compiler_.global ? MjcfFields(*only, only->attributes).frame(compiler_) : at_point({0.0, 0.0, 0.0});
    if (only->attributes.contains("childclass")) inherited = only->attribute("childclass");
    defaults_.require(*only, inherited);
    const std::size_t link = add_link(*only, body_name(*only));
    fill(*only, link, {inherited, at_point({0.0, 0.0, 0.0})}, world,
         MjcfFields(*only, only->attributes).frame(compiler_));
    out_.notes.push_back("The root " + core::quoted(out_.links[0].name) +
                         " is free in the file and held here, where the model begins.");
    return true;
  }

  void world(const MjcfElement& e) {
    const Place place{std::string(e.attribute("childclass")), at_point({0.0, 0.0, 0.0})};
    for (const MjcfElement& child : e.children) world_element(child, place, true);
  }
  void world_element(const MjcfElement& e, const Place& place, bool bodies) {  // NOLINT(misc-no-recursion)
    refuse_makers(e);
    if (e.tag == "body" && bodies) body(e, 0, place, at_point({0.0, 0.0, 0.0}));
    if (e.tag == "geom" || e.tag == "site") {
      static_cast<void>(defaults_.of(e, place.inherited, e.tag));
      name_of(e.tag == "geom" ? names_.geoms : names_.sites, e, 0);
    }
    if (e.tag == "frame") {
      const Place inner = within_frame(e, place);
      for (const MjcfElement& child : e.children) world_element(child, inner, bodies);
    }
  }
  Place within_frame(const MjcfElement& e, const Place& place) const {
    const std::string own(e.attribute("childclass"));
    defaults_.require(e, own);
    return {own.empty() ? place.inherited : own,
            within(place.in_body, MjcfFields(e, e.attributes).frame(compiler_))};
  }
  static void name_of(MjcfNames::Index& index, const MjcfElement& e, std::size_t link) {
    const std::string name(e.attribute("name"));
    if (!name.empty() && !index.emplace(name, link).second)
      e.fail("has a name that another <" + e.tag + "> has; expected names of their own");
  }
  static void refuse_makers(const MjcfElement& e) {
    for (const std::string_view tag : {"composite", "flexcomp", "replicate", "attach"})
      if (e.tag == tag)
        e.fail(
            "makes bodies that are not in this file; expected the bodies themselves: MuJoCo writes them (mj_saveLastXML, in "
            "Python mujoco.mj_saveLastXML)");
    if (e.tag == "plugin")
      e.fail(
          "exerts forces that this program does not know; expected a robot without it: take it out of the file");
  }

  std::string body_name(const MjcfElement& e) {
    ++bodies_;
    std::string name = word(e, std::string(e.attribute("name")));
    if (name.empty()) name = free_name("body" + std::to_string(bodies_), taken_links_);
    if (!names_.bodies.emplace(name, 0).second)
      e.fail("has a name that another body has; expected names of their own");
    return name;
  }
  /// The name, with a number where another has it.
  static std::string free_name(const std::string& name, std::set<std::string>& taken) {
    std::string out = name;
    for (int k = 2; !taken.insert(out).second; ++k) out = name + "_" + std::to_string(k);
    return out;
  }
  std::size_t add_link(const MjcfElement& e, const std::string& name) {
    names_.bodies[name] = out_.links.size();
    taken_links_.insert(name);
    out_.links.push_back({name, std::nullopt, e.line, "", false, included(e)});
    return out_.links.size() - 1;
  }
  UrdfJoint& add_joint(const MjcfElement& e, const std::string& name, std::size_t parent,
                       const Frame<double>& placement) {
    if (!taken_joints_.insert(name).second)
      e.fail("would be a joint " + core::quoted(name) +
             ", which there is already; expected names of their own");
    UrdfJoint j;
    j.name = name;
    j.parent = parent;
    j.child = out_.links.size();
    j.placement = placement;
    j.axis = {0.0, 0.0, 1.0};
    j.line = e.line;
    j.file = included(e);
    j.type = "fixed";
    out_.joints.push_back(std::move(j));
    return out_.joints.back();
  }

  /// `outer` is the parent's frame in the world, where coordinates are global. At most kMjcfDepthMax deep.
  void body(const MjcfElement& e, std::size_t parent, const Place& place,  // NOLINT(misc-no-recursion)
            const Frame<double>& outer) {
    const MjcfFields f(e, e.attributes);
    const std::string name = body_name(e), own(e.attribute("childclass"));
    defaults_.require(e, own);
    if (f.number("gravcomp", 0.0) != 0.0)
      f.fail("gravcomp", "none: gravity is not compensated here; put its torque into the recordings' torque");
    if (compiler_.global && !f.has("pos")) f.fail("has no pos; expected one, as coordinates are global");
    const Frame<double> given = f.frame(compiler_);
    const Frame<double> world = compiler_.global ? given : at_point({0.0, 0.0, 0.0});
    Frame<double> next = compiler_.global ? within(inverse(outer), given) : within(place.in_body, given);
    const Frame<double> in_parent = next;
    const Place inside{own.empty() ? place.inherited : own, at_point({0.0, 0.0, 0.0})};
    std::vector<const MjcfElement*> joints;
    find_joints(e, joints);
    std::size_t from = parent;
    bool has_link = false;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const MjcfElement& at = *joints[k];
      const std::string joint_name =
          word(at, at.attributes.contains("name") && !at.attribute("name").empty()
                       ? std::string(at.attribute("name"))
                       : name + (k == 0 ? "_joint" : "_joint" + std::to_string(k + 1)));
      if (at.tag == "freejoint" || at.attribute("type") == "free") {
        if (joints.size() != 1 || parent != 0 || !names_.bodies.contains("world"))
          at.fail(
              "is free within a moving body or beside other joints; expected it alone, in a body of the world");
        UrdfJoint& j = add_joint(at, joint_name, from, next);
        j.kind = Kind::other;
        j.type = "free";
        from = add_link(e, name);
        has_link = true;
        break;
      }
      const MjcfFields jf = defaults_.of(at, inside.inherited, "joint");
      const Vec3<double> anchor = joint(jf, joint_name, from, next, world);
      names_.joints[joint_name] = out_.joints.size() - 1;
      const bool here = dot(anchor, anchor) == 0.0;
      const bool last = k + 1 == joints.size();
      from =
          last && here ? add_link(e, name) : add_link(at, free_name(name + "/" + joint_name, taken_links_));
      out_.links[from].between_joints = !last;
      has_link = last && here;
      next = at_point(-anchor);
    }
    if (!has_link) {
      add_joint(e, free_name(joints.empty() ? name : name + "/body", taken_fixed_), from, next);
      from = add_link(e, name);
    }
    fill(e, from, inside, world, in_parent);
  }
  /// Also those in <frame>, which may not move them.
  static void find_joints(const MjcfElement& e, std::vector<const MjcfElement*>& out) {
    for (const MjcfElement& child : e.children) {
      if (child.tag == "joint" || child.tag == "freejoint") out.push_back(&child);
      if (child.tag == "frame")
        for (const MjcfElement& inner : child.children)
          if (inner.tag == "joint" || inner.tag == "freejoint")
            inner.fail("is within a <frame>; expected it in the body itself");
    }
  }

  /// Adds the joint; its link comes next. @return where its axis is in the body.
  Vec3<double> joint(const MjcfFields& f, const std::string& name, std::size_t parent,
                     const Frame<double>& body, const Frame<double>& world) {
    const std::string type = f.choice("type", {"hinge", "slide", "ball", "free"});
    if (type != "hinge" && type != "slide")
      f.fail("is a " + type +
             " joint; expected hinge or slide: three hinges in the body, one axis each, are a ball, and "
             "a body without a joint stands still");
    const bool hinge = type == "hinge";
    const double unit = hinge && compiler_.degrees ? kDegree : 1.0;
    Vec3<double> at = f.vec3("pos", {0.0, 0.0, 0.0}), axis = f.vec3("axis", {0.0, 0.0, 1.0});
    if (compiler_.global) {
      at = world.turn * (at - world.at);
      axis = world.turn * axis;
    }
    const double length = std::sqrt(dot(axis, axis));
    if (!(length > 1e-10)) f.fail("axis", "one that is not zero");
    axis = axis * (1.0 / length);
    // A place along the axis is as good as another, and where a slide is does not matter.
    const Vec3<double> off = at - axis * dot(at, axis);
    if (!hinge || dot(off, off) < 1e-24) at = {0.0, 0.0, 0.0};
    const double ref = f.number("ref", 0.0) * unit;
    const Frame<double> back =
        hinge ? Frame<double>{about(axis, -ref), {0.0, 0.0, 0.0}} : at_point(axis * -ref);
    UrdfJoint& j = add_joint(f.element(), name, parent, within(within(body, at_point(at)), back));
    j.axis = axis;
    j.type = type;
    j.kind = hinge ? Kind::continuous : Kind::prismatic;
    const std::vector<double> range = f.numbers("range", 2, 2);
    if (!range.empty() && f.flag("limited", compiler_.autolimits) && range[0] < range[1]) {
      if (hinge) j.kind = Kind::revolute;
      j.limits = UrdfLimits{range[0] * unit, range[1] * unit, 0.0, 0.0};
    }
    j.rotor_inertia_kgm2 = f.not_negative("armature");
    j.damping = damper_off_ ? 0.0 : f.not_negative("damping");
    j.friction = friction_off_ ? 0.0 : f.not_negative("frictionloss");
    j.spring_nmprad = spring_off_ ? 0.0 : f.not_negative("stiffness");
    j.spring_rest_rad = f.number("springref", 0.0) * unit;
    if (const auto pair = f.numbers("springdamper", 2, 2); !pair.empty() && pair[0] > 0.0 && pair[1] > 0.0)
      f.fail(
          "springdamper",
          "stiffness and damping instead (MuJoCo shows those that it computes: jnt_stiffness, dof_damping)");
    return at;
  }

  /// What a body has beside its joints; its bodies last.
  void fill(const MjcfElement& e, std::size_t link, const Place& place,  // NOLINT(misc-no-recursion)
            const Frame<double>& world, const Frame<double>& in_parent) {
    MjcfBody b;
    b.element = &e;
    b.in_parent = in_parent;
    b.to_body = compiler_.global ? inverse(world) : at_point({0.0, 0.0, 0.0});
    std::vector<std::pair<const MjcfElement*, Place>> bodies;
    gather(e, link, {place.inherited, b.to_body}, b, bodies);
    out_.links[link].inertia = inertia_of_body(b, compiler_);
    for (const auto& [child, at] : bodies)
      body(*child, link, compiler_.global ? Place{at.inherited, at_point({0.0, 0.0, 0.0})} : at, world);
  }
  void gather(const MjcfElement& e, std::size_t link, const Place& place,
              MjcfBody& b,  // NOLINT(misc-no-recursion)
              std::vector<std::pair<const MjcfElement*, Place>>& bodies) {
    for (const MjcfElement& child : e.children) {
      refuse_makers(child);
      if (child.tag == "body") {
        bodies.emplace_back(&child, place);
      } else if (child.tag == "geom") {
        b.geoms.emplace_back(defaults_.of(child, place.inherited, "geom"), place.in_body);
        name_of(names_.geoms, child, link);
        ++shapes_;
      } else if (child.tag == "site") {
        name_of(names_.sites, child, link);
      } else if (child.tag == "inertial") {
        if (b.inertial != nullptr) child.fail("is the second of its body; expected one");
        b.inertial = &child;
      } else if (child.tag == "frame") {
        gather(child, link, within_frame(child, place), b, bodies);
      }
    }
  }

  void set_total_mass() {
    double sum = 0.0;
    for (const UrdfLink& l : out_.links) sum += l.inertia ? l.inertia->mass_kg : 0.0;
    if (!(compiler_.total_mass_kg > 0.0) || !(sum > 0.0)) return;
    const double by = compiler_.total_mass_kg / sum;
    for (UrdfLink& l : out_.links) {
      if (!l.inertia) continue;
      l.inertia->mass_kg *= by;
      Sym3<double>& s = l.inertia->about_centre_kgm2;
      s = {s.xx * by, s.xy * by, s.xz * by, s.yy * by, s.yz * by, s.zz * by};
    }
  }

  /// What was assumed, together.
  void note(const std::vector<std::string>& assumed) {
    for (const char* tag : {"contact", "sensor", "keyframe", "deformable"}) {
      const std::vector<const MjcfElement*> found = sections(tag);
      if (std::any_of(found.begin(), found.end(), [](const auto* e) { return !e->children.empty(); }))
        not_used_.push_back("<" + std::string(tag) + ">");
    }
    std::string out = "Read as MJCF: contacts and joint ranges exert no force";
    if (fluid_) out += ", nor does the fluid of <option>";
    for (const std::string& what : assumed) out += "; " + what;
    if (!not_used_.empty()) {
      out += "; not used: ";
      for (const std::string& what : not_used_) out += (&what == not_used_.data() ? "" : ", ") + what;
    }
    out_.notes.insert(out_.notes.begin(), out + ".");
  }

  const MjcfElement& root_;
  Urdf out_;
  MjcfCompiler compiler_;
  MjcfDefaults defaults_;
  MjcfNames names_;
  std::set<std::string> taken_links_{"world"}, taken_joints_, taken_fixed_;
  std::vector<std::string> not_used_;
  std::size_t bodies_ = 0, shapes_ = 0;
  bool gravity_off_ = false, passive_off_ = false, spring_off_ = false, damper_off_ = false,
       friction_off_ = false, fluid_ = false;
};

}  // namespace

Urdf parse_mjcf(std::string_view text, const std::string& name, const MjcfFiles& files) {
  const MjcfElement root = read_mjcf_elements(text, name, files);
  return Reader(root, name).read();
}

bool is_mjcf(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
    const std::string_view end = text.starts_with("<!--") ? "-->" : text.starts_with("<?") ? "?>" : "";
    if (end.empty()) break;
    const std::size_t at = text.find(end);
    if (at == text.npos) return false;
    text.remove_prefix(at + end.size());
  }
  return text.starts_with("<mujoco") &&
         (text.size() == 7 || kBlank.find(text[7]) != kBlank.npos || text[7] == '>' || text[7] == '/' ||
          text.starts_with("<mujocoinclude"));
}

}  // namespace furcula::model
