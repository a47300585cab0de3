#include "host/trees/confidences.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "host/result/confidence.hpp"
#include "host/trees/findings.hpp"
#include "host/trees/left_over.hpp"

namespace furcula::trees {
namespace {

/// Where so much lasts that nothing predicts, of the drive's torque and of the torque that what is named accounts for, the names may stand
/// for something else. Of real machines a twentieth of the drive's is usual.
constexpr double kDoubted = 0.1, kOfNamed = 0.5;

/// Whether something else than what is named acts at this joint, or at one whose missing torque goes along with what this one does.
bool beside_another(const DiagnosisState& s, std::size_t joint) {
  const std::string does = what_does(s.model, joint);
  for (std::size_t j = 0; j < s.d.missing.size(); ++j) {
    const MissingTorque& m = s.d.missing[j];
    const double named_nm =
        std::sqrt(std::max(0.0, m.rms_before_nm * m.rms_before_nm - m.rms_after_nm * m.rms_after_nm));
    const bool lasting = m.persistent_after_nm > std::max(kDoubted * m.rms_torque_nm, kOfNamed * named_nm);
    if ((remains(m).is_another(m.rms_torque_nm) || lasting) && (j == joint || m.correlated_with == does))
      return true;
  }
  return false;
}

/// Joints whose torque a cause changes: its own, of a link all down to the base, of the base and of the log all.
std::vector<std::size_t> joints_of(const TreeModel& model, const Cause& cause) {
  const LocationType type = info(cause.effect).location_type;
  std::set<std::size_t> out;
  for (const std::size_t site : cause.sites) {
    if (is_of_joints(type)) out.insert(site);
    if (type != LocationType::link) continue;
    for (int j = model.robot.links[site].joint; j >= 0;
         j = model.robot.model.shape().parent(static_cast<std::size_t>(j)))
      out.insert(static_cast<std::size_t>(j));
  }
  for (std::size_t j = 0; out.empty() && j < model.joints(); ++j) out.insert(j);
  return {out.begin(), out.end()};
}

/// Of the predictable torque at the joints where a cause acts, what no name accounts for.
double unnamed_share(const DiagnosisState& s, const Cause& cause) {
  Shares all;
  for (const std::size_t j : joints_of(s.model, cause)) {
    const Shares at = shares_of(s.d.missing[j]);
    all.named += at.named;
    all.left += at.left;
  }
  return all.left > 0.0 ? all.left / (all.left + all.named) : 0.0;
}

}  // namespace

void lower_confidences(DiagnosisState& s, bool any_lost) {
  for (Finding& f : s.d.findings) {
    if (const double none = result::share_of_none(unnamed_share(s, f.cause)); none > 0.0) {
      f.confidence *= 1.0 - none;
      if (none > 1.0 - kClear) f.lowered_by.push_back("the names leave a part of what there is to explain");
    }
    if (any_lost) limit(f, 0.5, "held-out runs are off by more than a joint moves");
    if (s.unjudged) limit(f, 0.5, "the comparison with other causes was ended");
    const std::vector<std::size_t> joints = joints_of(s.model, f.cause);
    if (info(f.cause.effect).location_type != LocationType::base &&
        info(f.cause.effect).location_type != LocationType::log &&
        std::any_of(joints.begin(), joints.end(), [&](std::size_t j) { return beside_another(s, j); }))
      limit(f, 0.5, "predictable torque is still missing at its joint");
  }
}

}  // namespace furcula::trees
