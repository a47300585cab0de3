// Actuators of MJCF as drives of joints, see mjcf_names.hpp.
#include <algorithm>
#include <cmath>

#include "host/core/message.hpp"
#include "host/model/mjcf_names.hpp"
#include "host/model/urdf_filter.hpp"

namespace furcula::model {
namespace {

/// force = gain u + bias + bias_q (gear q) + bias_v (gear v); u: the control.
struct Actuator {
  std::string gain_type = "fixed", bias_type = "none", dynamics = "none";
  double gain = 1.0, bias = 0.0, bias_q = 0.0, bias_v = 0.0, gear = 1.0;
  double most = 0.0;  ///< force, 0: no limit
  bool odd = false;   ///< its force is no such sum
};

/// The first numbers of an attribute over what was there.
void read(const MjcfFields& f, std::string_view name, std::initializer_list<double*> to,
          std::size_t most = 10) {
  const std::vector<double> values = f.numbers(name, 1, most);
  auto* const* at = to.begin();
  for (const double v : values)
    if (at != to.end()) **at++ = v;
}

/// What an element says, over what its class says: as MuJoCo, which keeps one actuator a class.
void apply(const MjcfElement& e, Actuator& a) {
  const MjcfFields f(e, e.attributes);
  read(f, "gear", {&a.gear}, 6);
  for (const char* of_joint : {"armature", "damping"})
    if (f.number(of_joint, 0.0) != 0.0) f.fail(of_joint, "it at the joint, times the square of the gear");
  if (const auto range = f.numbers("forcerange", 2, 2); !range.empty() && f.flag("forcelimited", true))
    a.most = std::min(std::abs(range[0]), std::abs(range[1]));
  if (e.tag == "general") {
    if (f.has("gaintype")) a.gain_type = f.text("gaintype");
    if (f.has("biastype")) a.bias_type = f.text("biastype");
    if (f.has("dyntype")) a.dynamics = f.text("dyntype");
    read(f, "gainprm", {&a.gain});
    read(f, "biasprm", {&a.bias, &a.bias_q, &a.bias_v});
  } else if (e.tag == "motor") {
    a = {"fixed", "none", "none", 1.0, 0.0, 0.0, 0.0, a.gear, a.most, false};
  } else if (e.tag == "position") {
    read(f, "kp", {&a.gain});
    if (f.has("kv")) a.bias_v = -f.not_negative("kv");
    if (f.number("dampratio", 0.0) != 0.0)
      f.fail("dampratio", "kv instead (MuJoCo shows what it computes: -actuator_biasprm[2])");
    a.gain_type = "fixed", a.bias_type = "affine", a.bias = 0.0, a.bias_q = -a.gain;
    a.dynamics = f.number("timeconst", 0.0) > 0.0 ? "filterexact" : "none";
  } else if (e.tag == "velocity") {
    read(f, "kv", {&a.gain});
    a.gain_type = "fixed", a.bias_type = "affine", a.dynamics = "none";
    a.bias = 0.0, a.bias_q = 0.0, a.bias_v = -a.gain;
  } else {
    a.odd = true;
  }
}

class Reader {
 public:
  Reader(const MjcfDefaults& defaults, const MjcfNames& names, Urdf& robot)
      : defaults_(defaults), names_(names), robot_(robot) {}

  void add(const MjcfElement& e) {
    const std::string own(e.attribute("name"));
    const std::string who = own.empty() ? "<" + e.tag + "> in line " + std::to_string(e.line) : own;
    for (const char* other : {"tendon", "site", "body", "cranksite", "slidersite"}) {
      if (e.attribute(other).empty()) continue;
      if (std::string_view(other) != "tendon")
        e.fail("acts on a " + std::string(other) +
               "; expected a joint: forces on other places are in no recording. Take it out of the file");
      excluded_.push_back(who);
      return;
    }
    const std::string_view name =
        e.attribute(e.attributes.contains("jointinparent") ? "jointinparent" : "joint");
    const auto found = names_.joints.find(name);
    if (found == names_.joints.end()) {
      std::vector<std::string_view> known;
      for (const auto& [joint, at] : names_.joints) known.emplace_back(joint);
      e.fail("acts on the joint " + core::quoted(name) + "; expected one of " + core::listed(known) +
             core::did_you_mean(name, known));
    }
    Actuator a;
    for (const MjcfElement* of : defaults_.actuators_of(e)) apply(*of, a);
    a.odd = false;
    apply(e, a);
    any_ = true;
    UrdfJoint& j = robot_.joints[found->second];
    const std::string joint = core::quoted(j.name);
    if (a.most > 0.0 && j.limits) j.limits->effort += a.most * std::abs(a.gear);
    const bool affine = a.bias_type == "affine";
    if (a.odd || a.gain_type != "fixed" || (a.bias_type != "none" && !affine) || a.dynamics != "none") {
      take_as_torque(j);
      odd_.push_back(who);
      return;
    }
    const double square = a.gear * a.gear;
    if (affine && a.bias_q < 0.0) {
      if (j.kp_nmprad > 0.0) {
        take_as_torque(j);
        odd_.push_back(who);
        return;
      }
      j.kp_nmprad = -a.bias_q * square;
      j.kd_nmsprad += std::max(0.0, -a.bias_v) * square;
      if (!torques_.contains(j.name)) j.actuator = UrdfJoint::Actuator::position;
      if (a.gear != 1.0 || a.gain != -a.bias_q || a.bias != 0.0)
        scaled_.push_back(joint + " (" + core::rounded(a.gain / -a.bias_q / a.gear, 6) + " ctrl" +
                          (a.bias == 0.0 ? "" : " + " + core::rounded(a.bias / -a.bias_q / a.gear, 6)) + ")");
      return;
    }
    if (affine && a.bias_v < 0.0 && a.bias_q == 0.0) {
      // The damping of a position law, where a joint has both; alone its torque is to be in the recording.
      velocity_[j.name] += -a.bias_v * square;
      return;
    }
    if (affine && (a.bias_q != 0.0 || a.bias_v != 0.0 || a.bias != 0.0)) odd_.push_back(who);
    take_as_torque(j);
    if (a.gear * a.gain != 1.0)
      geared_.push_back(joint + " (" + core::rounded(a.gear * a.gain, 6) + " ctrl)");
  }

  void finish(std::vector<std::string>& assumed) {
    std::vector<std::string> none, velocities;
    for (UrdfJoint& j : robot_.joints) {
      if (!any_ || (j.kind != UrdfJoint::Kind::revolute && j.kind != UrdfJoint::Kind::continuous &&
                    j.kind != UrdfJoint::Kind::prismatic))
        continue;
      if (const auto v = velocity_.find(j.name); v != velocity_.end()) {
        if (j.actuator == UrdfJoint::Actuator::position) {
          j.kd_nmsprad += v->second;
          pairs_.push_back(core::quoted(j.name));
        } else {
          take_as_torque(j);
          velocities.push_back(core::quoted(j.name));
        }
      }
      if (j.actuator != UrdfJoint::Actuator::position) j.kp_nmprad = j.kd_nmsprad = 0.0;
      if (j.actuator == UrdfJoint::Actuator::unknown) {
        j.actuator = UrdfJoint::Actuator::none;
        none.push_back(core::quoted(j.name));
      }
    }
    const auto say = [&](const std::string& what, const std::vector<std::string>& names) {
      if (!names.empty()) assumed.push_back(what + " " + first_names(names));
    };
    if (!any_) assumed.emplace_back("no joint has an actuator, and a torque is expected on each");
    say("torques in recordings are at the joint:", geared_);
    say("set points in recordings are at the joint:", scaled_);
    say("position and velocity actuators are one drive, its target velocity zero: joint", pairs_);
    say("a velocity actuator counts as a torque, which recordings have at the joint: joint", velocities);
    say("an actuator with a law of its own counts as a torque, which recordings have at the joint:", odd_);
    say("no actuator moves joint", none);
    say("an actuator on a tendon is left out:", excluded_);
  }

 private:
  void take_as_torque(UrdfJoint& j) {
    torques_.insert(j.name);
    j.actuator = UrdfJoint::Actuator::torque;
  }

  const MjcfDefaults& defaults_;
  const MjcfNames& names_;
  Urdf& robot_;
  bool any_ = false;
  std::set<std::string> torques_;
  std::map<std::string, double> velocity_;  ///< gains of velocity actuators
  std::vector<std::string> geared_, scaled_, odd_, pairs_, excluded_;
};

}  // namespace

void read_mjcf_actuators(const std::vector<const MjcfElement*>& sections, const MjcfDefaults& defaults,
                         const MjcfNames& names, Urdf& robot, std::vector<std::string>& assumed) {
  Reader reader(defaults, names, robot);
  for (const MjcfElement* s : sections)
    for (const MjcfElement& e : s->children) reader.add(e);
  reader.finish(assumed);
}

}  // namespace furcula::model
