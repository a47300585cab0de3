// Edits of a URDF's text in place, and MJCF, see exports.hpp.
#include "host/trees/exports.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/mjcf.hpp"
#include "host/model/urdf_writer.hpp"
#include "host/model/xml_check.hpp"
#include "host/trees/edits.hpp"
#include "host/trees/mjcf_edits.hpp"
#include "host/trees/run.hpp"

namespace furcula::trees {
namespace {

using core::shortest;
using dynamics::tree::Sym3;
using dynamics::tree::Vec3;
using model::XmlElement;

/// For the inside of a comment, which holds no two hyphens.
std::string commented(const std::string& text) {
  std::string out;
  for (const char c : core::printable(text)) {
    if (c == '-' && !out.empty() && out.back() == '-') out += ' ';
    out += c;
  }
  return out;
}
std::string comment(const std::vector<std::string>& lines) {
  std::string out = "<!--\n";
  for (const std::string& line : lines) out += "  " + commented(line) + "\n";
  return out + "-->\n";
}

bool acts_on(const Cause& cause, std::size_t site) {
  return std::find(cause.sites.begin(), cause.sites.end(), site) != cause.sites.end();
}
bool is_of_body(Effect e) {
  return e == Effect::mass_error || e == Effect::com_error || e == Effect::inertia_error ||
         e == Effect::payload;
}

/// "coulomb_friction@elbow: a finding, confidence 0.98"
std::string reason(const Diagnosis& d, const Cause& cause) {
  const std::string name = cause_name(d.model, cause);
  for (const Finding& f : d.findings)
    if (f.cause.effect == cause.effect && f.cause.sites == cause.sites)
      return name + ", a finding of confidence " + core::rounded(f.confidence, 2);
  return name + ", an effect of the model file";
}

/// "torque_nm 0.31 N m, static_torque_nm 0.4 N m"
std::string values(const TreeModel& model, const Cause& cause) {
  const EffectInfo& e = info(cause.effect);
  const bool linear = is_linear(model, e.location_type, cause.sites.at(0));
  std::string out;
  for (std::size_t k = 0; k < e.parameter_count; ++k) {
    const std::string unit(unit_on(e.parameters()[k], linear));
    out += (k > 0 ? ", " : "") + std::string(name_on(e.parameters()[k], linear)) + " " +
           core::rounded(cause.values[k], 6) + (unit.empty() ? "" : " " + unit);
  }
  return out;
}

/// Viscous, in the joint: without the damping of a position law.
double joint_damping(const Hypothesis& h, std::size_t joint) {
  double out = h.drives[joint].damping_nmspr;
  for (const Cause& c : h.causes)
    if (c.effect == Effect::damping_error && acts_on(c, joint)) out = c.values[0];
  return out;
}
/// Coulomb friction in motion; of one that differs forth and back the mean, which takes the same energy.
double joint_friction(const dynamics::tree::JointLaw<double>& law) {
  return law.asymmetric ? 0.5 * (law.friction_nm + law.friction_back_nm) : law.friction_nm;
}

/// What of a cause a file does not hold; empty: nothing. `mjcf` holds more than URDF.
std::string excluded(const Cause& cause, bool mjcf, bool position_control) {
  switch (cause.effect) {
    case Effect::coulomb_friction:
    case Effect::damping_error:
    case Effect::mass_error:
    case Effect::com_error:
    case Effect::inertia_error:
    case Effect::payload:
      return "";
    case Effect::stribeck_friction:
      return "the friction in motion is in the file, its rise towards rest is not";
    case Effect::asymmetric_friction:
      return "the mean of both directions is in the file";
    case Effect::base_tilt:
      return mjcf ? "" : "gravity is not in the file";
    case Effect::rotor_inertia_error:
      return mjcf ? "" : "the rotor's inertia is not in the file";
    case Effect::position_gain_error:
      return mjcf ? "" : "the drive's gains are not in the file";
    case Effect::torque_gain_error:
      if (mjcf && position_control) return "";
      return "not in the file: the torque is this many times the commanded one";
    case Effect::joint_elasticity:
      return mjcf ? "the spring is not in the file; the rotor's inertia counts as the joint's"
                  : "not in the file";
    default:
      return "not in the file";
  }
}

std::vector<std::string> what_is_excluded(const Diagnosis& d, bool mjcf) {
  std::vector<std::string> out;
  for (const Cause& c : d.extended.causes) {
    const LocationType location_type = info(c.effect).location_type;
    const bool position_control =
        location_type == LocationType::drive && d.extended.drives[c.sites.at(0)].law == ControlMode::position;
    if (c.effect == Effect::rotor_inertia_error && d.model.urdf.is_mjcf) continue;
    if (const std::string what = excluded(c, mjcf, position_control); !what.empty())
      out.push_back(cause_name(d.model, c) + " (" + values(d.model, c) + "): " + what);
  }
  return out;
}

std::string text_of(const Vec3<double>& v) {
  return shortest(v.x) + " " + shortest(v.y) + " " + shortest(v.z);
}

/// A link's <inertial>: the centre of mass in the link's axes, the inertia in those of <inertial><origin>.
struct Body {
  double mass_kg;
  Vec3<double> centre_m;
  Sym3<double> about_centre_kgm2;
};
Sym3<double> scaled(const Sym3<double>& s, double by) {
  return {s.xx * by, s.xy * by, s.xz * by, s.yy * by, s.yz * by, s.zz * by};
}

/// The URDF's own text; of a robot of another format, and of one that xacro has to expand, one that is written here.
std::string text_of_robot(const TreeModel& model, const std::string& file) {
  if (model.urdf.is_mjcf || model.urdf.is_expanded) return model::format_urdf(model.urdf);
  return model.urdf_text.empty() ? core::read_small_file(file, "a robot (URDF)") : model.urdf_text;
}

const FittedBody* fitted_body(const Diagnosis& d, std::size_t i) {
  for (const FittedBody& f : d.extended.bodies)
    if (f.link == i) return &f;
  return nullptr;
}
/// The link's inertial with its causes, a payload last, as SetupMaker applies them.
Body extended_body(const Diagnosis& d, std::size_t i, const model::UrdfInertia& given,
                   std::vector<std::string>& excluded) {
  const FittedBody* fitted = fitted_body(d, i);
  const model::UrdfInertia from = fitted != nullptr ? body_at(given, fitted->at) : given;
  Body b{from.mass_kg, from.frame.at, from.about_centre_kgm2};
  for (const Cause& c : d.extended.causes) {
    if (!is_of_body(c.effect) || !acts_on(c, i)) continue;
    const auto& v = c.values;
    if ((c.effect == Effect::mass_error || c.effect == Effect::inertia_error) && !(v[0] > 0.0)) {
      excluded.push_back(cause_name(d.model, c) + " (" + values(d.model, c) +
                         "): a link that moves has both above 0");
      continue;
    }
    if (c.effect == Effect::mass_error) {
      b.about_centre_kgm2 = scaled(b.about_centre_kgm2, v[0] / b.mass_kg);
      b.mass_kg = v[0];
    }
    if (c.effect == Effect::com_error) b.centre_m += Vec3<double>{v[0], v[1], v[2]};
    if (c.effect == Effect::inertia_error) b.about_centre_kgm2 = scaled(b.about_centre_kgm2, v[0]);
  }
  for (const Cause& c : d.extended.causes) {
    if (c.effect != Effect::payload || !acts_on(c, i) || !(c.values[0] > 0.0)) continue;
    const double load_kg = c.values[0], sum_kg = b.mass_kg + load_kg;
    const Vec3<double> at{c.values[1], c.values[2], c.values[3]};
    const Vec3<double> centre = (b.centre_m * b.mass_kg + at * load_kg) * (1.0 / sum_kg);
    const auto about = [&](const Vec3<double>& point, double mass) {
      return scaled(dynamics::tree::minus_squared_cross(given.frame.turn * (point - centre)), mass);
    };
    b = {sum_kg, centre, b.about_centre_kgm2 + about(b.centre_m, b.mass_kg) + about(at, load_kg)};
  }
  return b;
}

class UrdfWriter {
 public:
  explicit UrdfWriter(const Diagnosis& d)
      : d_(d),
        file_((std::filesystem::path(d.model.file).parent_path() / d.model.urdf_path).string()),
        text_(text_of_robot(d.model, file_)),
        elements_(model::check_xml(text_, file_)),
        edits_(text_),
        setup_(SetupMaker(d.model).make(d.extended)) {}

  std::string write() {
    for (std::size_t i = 0; i < d_.model.joints(); ++i) joint(i);
    for (const std::size_t i : sites(d_.model, LocationType::link)) link(i);
    for (const std::string& line : what_is_excluded(d_, false)) excluded_.push_back(line);
    if (d_.model.urdf.is_mjcf)
      excluded_.emplace_back("armature of <dynamics> is read by furcula; other programs ignore it");
    leave_out_drives();
    describe("The robot with what a diagnosis found.");
    return edits_.text();
  }
  std::string write_bodies() {
    for (const std::size_t i : sites(d_.model, LocationType::link)) link(i);
    describe("The robot with inertial parameters that were fitted.");
    return edits_.text();
  }

 private:
  /// The element of the robot with this tag and name.
  std::size_t named(std::string_view tag, const std::string& name) const {
    for (std::size_t i = 0; i < elements_.size(); ++i)
      if (elements_[i].depth == 1 && elements_[i].tag == tag &&
          model::resolved(elements_[i].attribute("name")) == name)
        return i;
    throw core::DataError(file_ + ": no " + std::string(tag) + " " + core::quoted(name) +
                          ", expected the file that was diagnosed");
  }
  /// The first child of that tag; none where there is none.
  const XmlElement* child(std::size_t of, std::string_view tag) const {
    for (std::size_t i = of + 1; i < elements_.size() && elements_[i].depth > elements_[of].depth; ++i)
      if (elements_[i].depth == elements_[of].depth + 1 && elements_[i].tag == tag) return &elements_[i];
    return nullptr;
  }
  const XmlElement& needed(std::size_t of, std::string_view tag) const {
    if (const XmlElement* e = child(of, tag)) return *e;
    throw core::DataError(file_ + ":" + std::to_string(elements_[of].line) + ": no <" + std::string(tag) +
                          ">, expected the file that was diagnosed");
  }
  double rotor_of_file(const std::string& joint) const {
    for (const model::UrdfJoint& j : d_.model.urdf.joints)
      if (j.name == joint) return j.rotor_inertia_kgm2;
    return 0.0;
  }
  std::string reasons(std::span<const Effect> effects, std::size_t site) const {
    std::string out;
    for (const Cause& c : d_.extended.causes)
      if (std::find(effects.begin(), effects.end(), c.effect) != effects.end() && acts_on(c, site))
        out += (out.empty() ? "" : "; ") + reason(d_, c);
    return out;
  }

  void joint(std::size_t i) {
    const std::string& name = d_.model.robot.joints[i].name;
    const auto& given = d_.model.robot.model.laws[i];  // as the file has it
    const double damping = joint_damping(d_.extended, i), friction = joint_friction(setup_.model.laws[i]);
    const bool damps = damping != given.damping_nmspr, rubs = friction != given.friction_nm;
    // A URDF that is written here has rotors' inertias; one of the user's stays without.
    const double rotor = setup_.model.laws[i].armature_kgm2, rotor_given = rotor_of_file(name);
    const bool spins = d_.model.urdf.is_mjcf && rotor != rotor_given;
    if (!damps && !rubs && !spins) return;
    const bool linear = d_.model.prismatic(i);
    const std::size_t at = named("joint", name);
    if (const XmlElement* dynamics = child(at, "dynamics")) {
      if (damps) edits_.set(*dynamics, "damping", shortest(damping));
      if (rubs) edits_.set(*dynamics, "friction", shortest(friction));
      if (spins) edits_.set(*dynamics, "armature", shortest(rotor));
    } else {
      edits_.add_before(needed(at, "child"),
                        "<dynamics damping=\"" + shortest(damping) + "\" friction=\"" + shortest(friction) +
                            "\"" + (spins ? " armature=\"" + shortest(rotor) + "\"" : "") + "/>");
    }
    if (spins)
      changed("joint " + name + ", armature: " + shortest(rotor_given) + " -> " + shortest(rotor) +
              (linear ? " kg" : " kg m^2"));
    if (damps) {
      constexpr Effect kDamping[] = {Effect::damping_error};
      std::string why = reasons(kDamping, i);
      if (why.empty())
        why = damping == d_.model.drives[i].damping_nmspr ? "[drive] of the model file"
                                                          : "a free parameter, fitted";
      changed("joint " + name + ", damping: " + shortest(given.damping_nmspr) + " -> " + shortest(damping) +
              (linear ? " N s/m: " : " N m s/rad: ") + why);
    }
    constexpr Effect kFriction[] = {Effect::coulomb_friction, Effect::stribeck_friction,
                                    Effect::asymmetric_friction};
    if (rubs)
      changed("joint " + name + ", friction: " + shortest(given.friction_nm) + " -> " + shortest(friction) +
              (linear ? " N: " : " N m: ") + reasons(kFriction, i));
  }

  void link(std::size_t i) {
    const model::UrdfInertia& given = *d_.model.urdf.links[i].inertia;
    std::string why;
    bool moved = false, heavier = false, fuller = false;
    if (fitted_body(d_, i) != nullptr) {
      why = "free inertial parameters, fitted";
      moved = heavier = fuller = true;
    }
    for (const Cause& c : d_.extended.causes) {
      if (!is_of_body(c.effect) || !acts_on(c, i)) continue;
      why += (why.empty() ? "" : "; ") + reason(d_, c);
      const bool load = c.effect == Effect::payload;
      moved |= load || c.effect == Effect::com_error;
      heavier |= load || c.effect == Effect::mass_error;
      fuller |= load || c.effect != Effect::com_error;
    }
    if (why.empty()) return;
    const Body b = extended_body(d_, i, given, excluded_);
    const std::string& name = d_.model.urdf.links[i].name;
    const std::size_t inertial =
        static_cast<std::size_t>(&needed(named("link", name), "inertial") - elements_.data());
    const auto say = [&](const char* what, const std::string& before, const std::string& after,
                         const char* unit) {
      if (before != after)
        changed("link " + name + ", " + what + ": " + before + " -> " + after + " " + unit + ": " + why);
    };
    if (moved) {
      if (const XmlElement* origin = child(inertial, "origin"))
        edits_.set(*origin, "xyz", text_of(b.centre_m));
      else
        edits_.add_before(needed(inertial, "mass"), "<origin xyz=\"" + text_of(b.centre_m) + "\"/>");
      say("centre of mass", text_of(given.frame.at), text_of(b.centre_m), "m");
    }
    if (heavier) {
      edits_.set(needed(inertial, "mass"), "value", shortest(b.mass_kg));
      say("mass", shortest(given.mass_kg), shortest(b.mass_kg), "kg");
    }
    if (!fuller) return;
    const XmlElement* inertia = child(inertial, "inertia");
    std::string before, after, whole = "<inertia";
    constexpr std::pair<const char*, double Sym3<double>::*> kMoments[] = {
        {"ixx", &Sym3<double>::xx}, {"ixy", &Sym3<double>::xy}, {"ixz", &Sym3<double>::xz},
        {"iyy", &Sym3<double>::yy}, {"iyz", &Sym3<double>::yz}, {"izz", &Sym3<double>::zz}};
    for (const auto& [moment, member] : kMoments) {
      const std::string value = shortest(b.about_centre_kgm2.*member);
      if (inertia != nullptr) edits_.set(*inertia, moment, value);
      whole += " " + std::string(moment) + "=\"" + value + "\"";
      before += (before.empty() ? "" : " ") + shortest(given.about_centre_kgm2.*member);
      after += (after.empty() ? "" : " ") + value;
    }
    // A mass without it is a point.
    if (inertia == nullptr) edits_.add_before(needed(inertial, "mass"), whole + "/>");
    say("inertia xx xy xz yy yz zz", before, after, "kg m^2");
  }

  void changed(const std::string& line) { changed_.push_back(line); }

  void describe(const std::string& what) {
    std::vector<std::string> lines{what};
    lines.emplace_back(changed_.empty() ? "Nothing is changed." : "Changed, before -> after:");
    for (const std::string& line : changed_) lines.push_back("  " + line);
    if (!excluded_.empty()) lines.emplace_back("What a URDF cannot hold:");
    for (const std::string& line : excluded_) lines.push_back("  " + line);
    edits_.insert_on_top(comment(lines));
  }
  void leave_out_drives() {
    for (std::size_t i = 0; i < d_.model.joints(); ++i) {
      const Drive& drive = d_.extended.drives[i];
      const std::string of = "[drive] of " + d_.model.robot.joints[i].name + ": ";
      const bool linear = d_.model.prismatic(i);
      if (drive.rotor_inertia_kgm2 != 0.0 && !d_.model.urdf.is_mjcf)
        excluded_.push_back(of + "rotor inertia " + shortest(drive.rotor_inertia_kgm2) +
                            (linear ? " kg" : " kg m^2"));
      if (drive.law == ControlMode::position)
        excluded_.push_back(of + "kp " + shortest(drive.kp_nmprad) +
                            (linear ? " N/m, kd " : " N m/rad, kd ") + shortest(drive.kd_nmsprad) +
                            (linear ? " N s/m" : " N m s/rad"));
    }
  }

  const Diagnosis& d_;
  const std::string file_, text_;
  const std::vector<XmlElement> elements_;
  Edits edits_;
  const Setup setup_;
  std::vector<std::string> changed_, excluded_;
};

}  // namespace

std::string extended_urdf(const Diagnosis& d) { return UrdfWriter(d).write(); }

std::string urdf_with_bodies(const TreeModel& model, const std::vector<FittedBody>& bodies) {
  Diagnosis d;
  d.model = model;
  d.extended = {model.drives, {}, bodies};
  return UrdfWriter(d).write_bodies();
}

std::string extended_mjcf(const Diagnosis& d) {
  const Setup setup = SetupMaker(d.model).make(d.extended);
  model::RobotTree robot = d.model.robot;
  robot.model = setup.model;
  std::vector<model::PositionGains> gains;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    auto& law = robot.model.laws[i];
    const Setup::Joint& drive = setup.joints[i];
    // The drive's position law is the actuator's, and what is left out is named here.
    law.damping_nmspr = joint_damping(d.extended, i);
    law.stiffness_nmprad = drive.both_ways ? drive.spring_nmprad : 0.0;
    law.rest_rad = drive.both_ways ? drive.spring_rest_rad : 0.0;
    law.friction_nm = joint_friction(law);
    law.static_friction_nm = 0.0;
    law.elastic = false;
    if (drive.law == ControlMode::position)
      gains.push_back({robot.joints[i].name, drive.gain * drive.kp_nmprad, drive.gain * drive.kd_nmsprad});
  }
  std::vector<std::string> lines{"The robot with what a diagnosis found."};
  for (const Cause& c : d.extended.causes) lines.push_back("  " + reason(d, c) + ": " + values(d.model, c));
  for (const FittedBody& b : d.extended.bodies)
    lines.push_back("  link " + d.model.robot.links[b.link].name + ": free inertial parameters, fitted");
  const std::vector<std::string> missing = what_is_excluded(d, true);
  if (!missing.empty()) lines.emplace_back("What this file does not hold:");
  for (const std::string& line : missing) lines.push_back("  " + line);
  // The robot's own file with what is changed, where that file says it all; else one that is written here.
  const std::string file = (std::filesystem::path(d.model.file).parent_path() / d.model.urdf_path).string();
  if (d.model.urdf.is_mjcf && !d.model.urdf.is_expanded) {
    MjcfChanges changes{{}, {}, robot.model.gravity_mps2};
    for (const std::size_t i : sites(d.model, LocationType::link)) {
      const bool of_cause =
          std::any_of(d.extended.causes.begin(), d.extended.causes.end(),
                      [&](const Cause& c) { return is_of_body(c.effect) && acts_on(c, i); });
      if (!of_cause && fitted_body(d, i) == nullptr) continue;
      const model::UrdfInertia& given = *d.model.urdf.links[i].inertia;
      std::vector<std::string> impossible;
      const Body b = extended_body(d, i, given, impossible);
      changes.bodies[d.model.urdf.links[i].name] = {
          b.mass_kg, {given.frame.turn, b.centre_m}, b.about_centre_kgm2};
    }
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const auto& law = robot.model.laws[i];
      const bool sets = setup.joints[i].law == ControlMode::position;
      const double gain = setup.joints[i].gain;
      changes.joints[robot.joints[i].name] = {law.armature_kgm2,
                                              law.damping_nmspr,
                                              law.friction_nm,
                                              law.stiffness_nmprad,
                                              law.rest_rad,
                                              sets ? gain * setup.joints[i].kp_nmprad : 0.0,
                                              sets ? gain * setup.joints[i].kd_nmsprad : 0.0};
    }
    const std::string text =
        d.model.urdf_text.empty() ? core::read_small_file(file, "a robot (MJCF)") : d.model.urdf_text;
    std::vector<std::string> head = lines;
    head.push_back("Files of meshes and textures are named as in " + d.model.urdf_path +
                   ": put this file beside it.");
    if (const auto edited = edited_mjcf(text, d.model.urdf, changes, comment(head))) return *edited;
  }
  return comment(lines) + model::format_mjcf(robot, gains);
}

}  // namespace furcula::trees
