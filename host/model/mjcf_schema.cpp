// The names of MJCF, see mjcf_schema.hpp. From MuJoCo's documentation ("XML Reference"), versions 2.2 to 3.3 together.
#include "host/model/mjcf_schema.hpp"

#include <algorithm>
#include <vector>

#include "host/core/message.hpp"
#include "host/model/xml_text.hpp"

namespace furcula::model {
namespace {

struct Row {
  std::string_view parent, tag;
  std::string_view
      attributes;  ///< "*": any, and any elements within it, as no force depends on them or it is refused elsewhere
  std::string_view more = {};
};

constexpr std::string_view kPlace = "pos quat axisangle xyaxes zaxis euler";
constexpr std::string_view kConstraint = "name class active solref solimp";
constexpr std::string_view kActuator =
    "name class group nsample interp delay ctrllimited forcelimited ctrlrange forcerange lengthrange gear damping armature cranklength user joint "
    "jointinparent tendon slidersite cranksite site refsite";
constexpr std::string_view kTendon =
    "name class group limited actuatorfrclimited range actuatorfrcrange solreflimit solimplimit solreffriction solimpfriction frictionloss "
    "springlength width material margin stiffness damping armature rgba user";

constexpr Row kRows[] = {
    {"", "mujoco", "model"},
    {"mujoco", "compiler",
     "autolimits boundmass boundinertia settotalmass balanceinertia strippath coordinate angle fitaabb eulerseq meshdir texturedir discardvisual "
     "convexhull usethread fusestatic inertiafromgeom inertiagrouprange exactmeshinertia saveinertial assetdir alignfree conflict"},
    {"mujoco", "option",
     "timestep apirate impratio tolerance ls_tolerance noslip_tolerance mpr_tolerance ccd_tolerance sleep_tolerance gravity wind magnetic density "
     "viscosity o_margin o_solref o_solimp o_friction integrator collision cone jacobian solver iterations ls_iterations noslip_iterations "
     "mpr_iterations ccd_iterations sdf_iterations sdf_initpoints actuatorgroupdisable"},
    {"mujoco", "size", "*"},
    {"mujoco", "visual", "*"},
    {"mujoco", "statistic", "*"},
    {"mujoco", "default", "class"},
    {"mujoco", "custom", "*"},
    {"mujoco", "asset", "*"},
    {"mujoco", "worldbody", kPlace, "name childclass user"},
    {"mujoco", "contact", "*"},
    {"mujoco", "equality", ""},
    {"mujoco", "tendon", ""},
    {"mujoco", "actuator", ""},
    {"mujoco", "sensor", "*"},
    {"mujoco", "keyframe", "*"},
    {"mujoco", "deformable", "*"},
    {"mujoco", "extension", "*"},
    {"compiler", "lengthrange", "*"},
    {"option", "flag",
     "constraint equality frictionloss limit contact passive spring damper gravity clampctrl warmstart filterparent actuation refsafe sensor "
     "midphase eulerdamp autoreset nativeccd island multiccd override energy fwdinv invdiscrete sensornoise sleep diagexact ipc"},
    {"body", "body", kPlace, "name childclass mocap gravcomp sleep simple fuse user"},
    {"body", "frame", kPlace, "name childclass"},
    {"body", "inertial", kPlace, "mass diaginertia fullinertia"},
    {"body", "joint",
     "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit solreffriction solimpfriction stiffness "
     "range actuatorfrcrange actuatorgravcomp margin ref springref armature damping frictionloss user"},
    {"body", "freejoint", "name group align"},
    {"body", "geom", kPlace,
     "name class type contype conaffinity condim group priority size material friction mass density shellinertia solmix solref solimp margin gap "
     "surfacevel adhesion fromto hfield mesh fitscale rgba fluidshape fluidcoef user"},
    {"body", "site", "*"},
    {"body", "camera", "*"},
    {"body", "light", "*"},
    {"body", "composite", "*"},
    {"body", "flexcomp", "*"},
    {"body", "replicate", "*"},
    {"body", "attach", "*"},
    {"body", "plugin", "*"},
    {"geom", "plugin", "*"},
    {"default", "default", "class"},
    {"default", "mesh", "*"},
    {"default", "material", "*"},
    {"default", "pair", "*"},
    {"default", "equality", kConstraint},
    {"default", "tendon", kTendon},
    {"equality", "connect", kConstraint, "body1 body2 site1 site2 anchor"},
    {"equality", "weld", kConstraint, "body1 body2 site1 site2 anchor relpose torquescale"},
    {"equality", "joint", kConstraint, "joint1 joint2 polycoef"},
    {"equality", "tendon", kConstraint, "tendon1 tendon2 polycoef"},
    {"equality", "distance", "*"},
    {"equality", "flex", "*"},
    {"equality", "flexvert", "*"},
    {"equality", "flexstrain", "*"},
    {"tendon", "spatial", kTendon},
    {"tendon", "fixed", kTendon},
    {"spatial", "site", "site"},
    {"spatial", "geom", "geom sidesite"},
    {"spatial", "pulley", "divisor"},
    {"fixed", "joint", "joint coef"},
    {"actuator", "general", kActuator,
     "actlimited actrange body dyntype gaintype biastype dynprm gainprm biasprm actdim actearly input velrange ffrange"},
    {"actuator", "motor", kActuator},
    {"actuator", "position", kActuator, "kp kv dampratio timeconst inheritrange"},
    {"actuator", "velocity", kActuator, "kv"},
    {"actuator", "intvelocity", kActuator, "kp kv dampratio actlimited actrange inheritrange"},
    {"actuator", "damper", kActuator, "kv"},
    {"actuator", "cylinder", kActuator, "timeconst area diameter bias"},
    {"actuator", "muscle", kActuator, "timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax"},
    {"actuator", "adhesion", kActuator, "body gain"},
    {"actuator", "orientation", "*"},
    {"actuator", "pid", "*"},
    {"actuator", "dcmotor", "*"},
    {"actuator", "plugin", "*"},
};

constexpr std::string_view kOfDefaults = "joint geom site camera light";

bool among(std::string_view list, std::string_view name) {
  const std::vector<std::string_view> all = words(list);
  return std::find(all.begin(), all.end(), name) != all.end();
}

/// Rows of the elements that may stand within one. Bodies and frames hold the same; a default class holds what bodies and <actuator> do.
std::vector<const Row*> rows_within(std::string_view tag) {
  const std::string_view parent = tag == "worldbody" || tag == "frame" ? "body" : tag;
  std::vector<const Row*> out;
  for (const Row& r : kRows)
    if (r.parent == parent || (parent == "default" &&
                               (r.parent == "actuator" || (r.parent == "body" && among(kOfDefaults, r.tag)))))
      out.push_back(&r);
  return out;
}

std::string nearest(std::string_view name, const std::vector<std::string_view>& known) {
  std::string out = core::did_you_mean(name, known);
  if (out.empty()) out = known.empty() ? "; expected none" : "; expected one of " + core::listed(known);
  return out;
}

void check(const MjcfElement& e, const std::vector<const Row*>& among) {  // NOLINT(misc-no-recursion)
  const auto found =
      std::find_if(among.begin(), among.end(), [&](const Row* row) { return row->tag == e.tag; });
  if (found == among.end()) {
    std::vector<std::string_view> tags;
    for (const Row* row : among) tags.push_back(row->tag);
    e.fail("is no element that MJCF has here" + nearest(e.tag, tags));
  }
  const Row& row = **found;
  if (row.attributes == "*") return;
  std::vector<std::string_view> known = words(row.attributes);
  for (const std::string_view more : words(row.more)) known.push_back(more);
  for (const auto& [name, value] : e.attributes)
    if (std::find(known.begin(), known.end(), name) == known.end() && !name.starts_with("xmlns"))
      e.fail("has the attribute " + core::quoted(name) + ", which MJCF does not have there" +
             nearest(name, known));
  const std::vector<const Row*> inner = rows_within(e.tag);
  for (const MjcfElement& child : e.children) check(child, inner);
}

}  // namespace

void check_mjcf_names(const MjcfElement& root) { check(root, rows_within("")); }

}  // namespace furcula::model
