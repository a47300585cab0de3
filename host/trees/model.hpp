// A robot of several joints as a model file has it: `kind = "tree"` (docs/trees.md, the model file).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/model/urdf.hpp"
#include "host/trees/effects.hpp"

namespace furcula::trees {

enum class ControlMode { torque, position, none };

/// Beside the drive of a joint: it gives -rate max(q - rest, 0); both ways, -rate (q - rest).
struct Spring {
  double stiffness_nmprad = 0.0;  ///< 0: there is none
  bool switched = false;          ///< in stance only, its rest the joint's angle at touch-down
  double rest_rad = 0.0;          ///< else
  bool both_ways = false;
};

/// A point of a link that stands on the ground while the log's column `contact_NAME` says so.
struct Foot {
  std::string name;
  std::size_t link = 0;
  dynamics::tree::Vec3<double> point_m{0.0, 0.0, 0.0};  ///< in the link's frame
};

/// Of one joint. Units of a revolute joint; of a prismatic one N for N m and m for rad.
struct Drive {
  ControlMode law = ControlMode::torque;
  double kp_nmprad = 0.0, kd_nmsprad = 0.0;  ///< of the position law: kp (set point - q) - kd v
  double rotor_inertia_kgm2 = 0.0;           ///< reflected to the joint
  double damping_nmspr = 0.0;                ///< viscous, in the joint
  double loop_rate_hz = 0.0;                 ///< at which the position law is calculated; 0: continuously
};

/// The parameters of a drive that [free] may name, as "name.joint".
inline constexpr std::array<std::string_view, 4> kDriveParameters{"kp_nmprad", "kd_nmsprad",
                                                                  "rotor_inertia_kgm2", "damping_nmspr"};
inline constexpr std::array<double Drive::*, 4> kDriveMembers{
    &Drive::kp_nmprad, &Drive::kd_nmsprad, &Drive::rotor_inertia_kgm2, &Drive::damping_nmspr};

/// Of a revolute joint's and of a prismatic one's.
inline constexpr std::array<std::string_view, 4> kDriveUnits{"N m/rad", "N m s/rad", "kg m^2", "N m s/rad"};
inline constexpr std::array<std::string_view, 4> kLinearDriveUnits{"N/m", "N s/m", "kg", "N s/m"};

/// An effect at one site, or at several with one value.
struct Cause {
  Effect effect;
  std::vector<std::size_t> sites;  ///< joints or links (of RobotTree); {0} for the base and the log
  std::array<double, kMostParameters> values{};

  friend bool operator==(const Cause&, const Cause&) = default;
};

struct FreeParameter {
  std::size_t parameter;  ///< in kDriveParameters
  std::size_t joint;
  double lower, upper;
};

/// "inertial.LINK" in [free]: all ten inertial parameters of a link.
struct FreeBody {
  std::size_t link;
  double lower, upper;  ///< of its mass, times the given one
};

struct TreeModel {
  std::string file;       ///< for messages
  std::string urdf_path;  ///< as in the model file, of any format that model::read_robot reads
  std::string urdf_text;  ///< where it is no file
  model::Urdf urdf;
  model::RobotTree robot;
  std::vector<std::string>
      moving;  ///< as in the model file, or by the recordings; empty: all that can by themselves
  std::map<std::string, double> hold;  ///< of joints that do not move, rad or m
  dynamics::tree::Vec3<double> gravity_mps2{0.0, 0.0, -9.81};
  bool accept_inertias = false;    ///< masses and moments that no body has are taken as they are
  std::vector<std::string> notes;  ///< what of the URDF was taken, left out and repaired, in sentences
  std::map<std::string, std::string> logged_names;  ///< of joints that the recordings call otherwise
  std::string map_lines;        ///< what a map file could say of joints that no recording has columns of
  std::vector<Drive> drives;    ///< of each joint of the tree
  std::vector<Spring> springs;  ///< of each joint
  std::optional<Foot> foot;
  double angle_noise_rad = 2e-4;  ///< of the encoders, one sample, standard deviation; of a prismatic joint m
  double torque_noise_nm = 0.0;   ///< of the drives' torques and what disturbs the joints; 0: not said
  std::vector<FreeParameter> free;
  std::vector<FreeBody> free_bodies;
  std::vector<Cause> causes;  ///< that are switched on, each at one site

  std::size_t joints() const { return robot.joints.size(); }
  bool prismatic(std::size_t joint) const {
    return robot.joints[joint].kind == model::UrdfJoint::Kind::prismatic;
  }
  /// Whether a drive moves the joint.
  bool driven(std::size_t joint) const { return drives[joint].law != ControlMode::none; }
  /// Whether one of a joint's drive parameters (of kDriveParameters) is fitted.
  bool is_free(std::size_t joint, std::size_t parameter) const {
    for (const FreeParameter& f : free)
      if (f.joint == joint && f.parameter == parameter) return true;
    return false;
  }
  /// Whether a link's inertial parameters are fitted.
  bool is_free_body(std::size_t link) const {
    for (const FreeBody& f : free_bodies)
      if (f.link == link) return true;
    return false;
  }
};

/// Whether the text says kind = "tree" in [model], or is a robot's own file (URDF, MJCF), which stands for a model file that names it and
/// says no more.
bool is_tree(std::string_view text);

/// What is known beside the model file.
struct TreeContext {
  std::string urdf{};  ///< its text, where it is no file
  std::vector<std::string>
      columns{};  ///< of the recordings: they say which joints move where the file does not, and what they are called
  bool accept_inertias = false;  ///< as the key of that name
};

/// @throws core::DataError naming file, line and what was expected; and what read_robot and tree_of throw. The robot's
/// file lies beside the model file.
TreeModel read_tree_model(const std::string& path);
TreeModel parse_tree_model(std::string_view text, const std::string& path, const TreeContext& context = {});
/// The same with the URDF as text.
TreeModel parse_tree_model(std::string_view text, const std::string& path, const std::string& urdf);

/// As a file that reads back the same; `urdf` stands for the URDF's name in it. A cause at several sites becomes one a site.
std::string format_tree_model(const TreeModel& model, const std::string& urdf);

/// The URDF as a model file in `folder` has to name it: its path from there.
std::string urdf_seen_from(const TreeModel& model, const std::string& folder);

/// A name as a TOML key: bare where it can be.
std::string toml_key(const std::string& name);

/// The names of all sites of a location type, and of one; links are those that move and have mass.
std::vector<std::size_t> sites(const TreeModel& model, LocationType location_type);
std::string site_name(const TreeModel& model, LocationType location_type, std::size_t site);
/// "coulomb_friction@elbow", "coulomb_friction@shoulder,elbow"
std::string cause_name(const TreeModel& model, const Cause& cause);
/// Whether the site's parameters have the names and units of a prismatic joint.
bool is_linear(const TreeModel& model, LocationType location_type, std::size_t site);

}  // namespace furcula::trees
