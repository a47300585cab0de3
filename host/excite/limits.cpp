// Limits of the joints, see limits.hpp.
#include "host/excite/limits.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/random.hpp"
#include "host/trees/run.hpp"

namespace furcula::excite {
namespace {

constexpr std::array<std::string_view, 4> kKeys{"lower", "upper", "velocity", "effort"};
/// Postures that are looked at for one that the drives can hold.
constexpr std::size_t kPostures = 2000;

std::string unit_of(const trees::TreeModel& m, std::size_t joint, std::size_t key) {
  const bool slides = m.prismatic(joint);
  return key < 2 ? (slides ? "m" : "rad") : key == 2 ? (slides ? "m/s" : "rad/s") : slides ? "N" : "N m";
}

/// The robot without its drives.
class Holding {
 public:
  explicit Holding(const trees::TreeModel& m) : tree_(trees::SetupMaker(m).make({m.drives, m.causes}).model) {
    for (std::size_t j = 0; j < m.joints(); ++j)
      if (m.drives[j].law == trees::ControlMode::position) {
        tree_.laws[j].stiffness_nmprad -= m.drives[j].kp_nmprad;
        tree_.laws[j].damping_nmspr -= m.drives[j].kd_nmsprad;
      }
  }
  std::vector<double> nm(std::span<const double> posture) const {
    model::RobotModel::Joints q{};
    std::copy(posture.begin(), posture.end(), q.begin());
    const auto held = dynamics::tree::inverse_dynamics(tree_, q, {}, {});
    std::vector<double> out;
    for (std::size_t j = 0; j < posture.size(); ++j)
      out.push_back(std::abs(held[j]) +
                    std::max(tree_.laws[j].friction_nm, tree_.laws[j].static_friction_nm));
    return out;
  }

 private:
  model::RobotModel tree_;
};

}  // namespace

Override parse_override(std::string_view text) {
  const auto bad = [&](const std::string& why) -> core::DataError {
    return core::DataError(
        "--limit " + core::quoted(text) + why +
        "; expected JOINT.KEY=NUMBER, as elbow.velocity=2, or all.effort=5; keys: " + core::listed(kKeys));
  };
  const std::size_t equals = text.rfind('=');
  const std::size_t dot = equals == text.npos ? text.npos : text.substr(0, equals).rfind('.');
  if (dot == text.npos || dot == 0) throw bad(" is no limit of a joint");
  Override out{std::string(text.substr(0, dot)), std::string(text.substr(dot + 1, equals - dot - 1)), 0.0};
  if (std::find(kKeys.begin(), kKeys.end(), out.key) == kKeys.end())
    throw bad(" names " + core::quoted(out.key) + core::did_you_mean(out.key, kKeys));
  const std::string_view number = text.substr(equals + 1);
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), out.value);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(out.value))
    throw bad(" has no number");
  if (out.key != "lower" && out.key != "upper" && !(out.value > 0.0)) throw bad(" is not above 0");
  return out;
}

std::vector<JointLimits> limits_of(const trees::TreeModel& m, std::span<const Override> overrides) {
  if (m.foot)
    throw core::DataError(m.file + ": foot " + core::quoted(m.foot->name) +
                          "; expected a robot without a foot: motions are designed for a fixed base");
  std::vector<std::string_view> names{"all"};
  for (const auto& joint : m.robot.joints) names.emplace_back(joint.name);
  for (const Override& o : overrides)
    if (std::find(names.begin(), names.end(), o.joint) == names.end())
      throw core::DataError("--limit names joint " + core::quoted(o.joint) +
                            core::did_you_mean(o.joint, names) + "; expected one that moves, or all");
  std::vector<JointLimits> out;
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const auto& joint = m.robot.joints[j];
    if (!m.driven(j))
      throw core::DataError(
          m.file + ": joint " + core::quoted(joint.name) +
          " has no drive (control_mode = \"none\"); expected a drive at every joint that moves, or the joint in [locked_joints]");
    std::array<std::optional<double>, 4> value;
    if (const auto& l = joint.limits) {
      if (l->lower < l->upper) value[0] = l->lower, value[1] = l->upper;
      if (l->velocity > 0.0) value[2] = l->velocity;
      if (l->effort > 0.0) value[3] = l->effort;
    }
    if (joint.kind == model::UrdfJoint::Kind::continuous && !value[0])
      value[0] = -std::numbers::pi, value[1] = std::numbers::pi;
    for (const Override& o : overrides)
      if (o.joint == "all" || o.joint == joint.name)
        value[static_cast<std::size_t>(std::find(kKeys.begin(), kKeys.end(), o.key) - kKeys.begin())] =
            o.value;
    std::string missing;
    for (std::size_t k = 0; k < kKeys.size(); ++k)
      if (!value[k]) missing += (missing.empty() ? "" : ", ") + std::string(kKeys[k]);
    if (!missing.empty())
      throw core::DataError(m.urdf.file + ": joint " + core::quoted(joint.name) + " has no limit of " +
                            missing + "; expected <limit lower upper velocity effort>, or --limit " +
                            joint.name + "." + missing.substr(0, missing.find(',')) + "=NUMBER (" +
                            unit_of(m, j,
                                    static_cast<std::size_t>(std::find(kKeys.begin(), kKeys.end(),
                                                                       missing.substr(0, missing.find(','))) -
                                                             kKeys.begin())) +
                            ")");
    if (!(*value[0] < *value[1]))
      throw core::DataError("joint " + core::quoted(joint.name) + " may move from " +
                            core::shortest(*value[0]) + " to " + core::shortest(*value[1]) + " " +
                            unit_of(m, j, 0) + "; expected lower below upper");
    out.push_back({*value[0], *value[1], *value[2], *value[3]});
  }
  return out;
}

std::vector<double> holding_nm(const trees::TreeModel& m, std::span<const double> posture) {
  return Holding(m).nm(posture);
}

std::vector<double> easiest_posture(const trees::TreeModel& m, std::span<const JointLimits> limits) {
  const std::size_t n = m.joints();
  const Holding holding(m);
  core::Random random(1, 0);
  double least = std::numeric_limits<double>::infinity(),
         least_nm = 0.0;  // of the best posture's worst joint
  std::size_t worst = 0;
  std::vector<double> best(n);
  for (std::size_t k = 0; k < kPostures; ++k) {
    std::vector<double> q(n);
    for (std::size_t j = 0; j < n; ++j) q[j] = random.uniform(limits[j].lower_rad, limits[j].upper_rad);
    // The middle of all ranges is one of them.
    if (k == 0)
      for (std::size_t j = 0; j < n; ++j) q[j] = 0.5 * (limits[j].lower_rad + limits[j].upper_rad);
    const std::vector<double> held = holding.nm(q);
    double most = 0.0, most_nm = 0.0;
    std::size_t joint = 0;
    for (std::size_t j = 0; j < n; ++j) {
      if (held[j] / limits[j].torque_nm <= most) continue;
      most = held[j] / limits[j].torque_nm;
      most_nm = held[j];
      joint = j;
    }
    if (most >= least) continue;
    least = most, least_nm = most_nm, worst = joint;
    best = q;
  }
  if (least < kOfTorque) return best;
  throw core::DataError(
      "joint " + core::quoted(m.robot.joints[worst].name) +
      " cannot move against gravity and friction: in the best posture within the limits it needs " +
      core::rounded(least_nm) + " " + unit_of(m, worst, 3) + ", and of its limit of " +
      core::rounded(limits[worst].torque_nm) + " motions use " +
      core::rounded(kOfTorque * limits[worst].torque_nm) +
      "; expected a higher effort limit, or ranges of the joints in which it is enough");
}

}  // namespace furcula::excite
