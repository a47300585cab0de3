// What the joints may do while recordings are made: the URDF's limits, and what was said of them beside it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/trees/model.hpp"

namespace furcula::excite {

/// Of one joint. Units of a revolute joint; of a prismatic one m, m/s and N.
struct JointLimits {
  double lower_rad = 0.0, upper_rad = 0.0, velocity_radps = 0.0, torque_nm = 0.0;
};

/// "elbow.velocity=2": one of the URDF's attributes lower, upper, velocity, effort, of a joint or of `all`.
struct Override {
  std::string joint, key;
  double value = 0.0;
};

/// @throws core::DataError: the text is not of that form, or the number is none that such a limit can be.
Override parse_override(std::string_view text);

/// Of each joint; a later override counts more. A continuous joint without a range may make half a turn to both sides.
/// @throws core::DataError: a joint without a drive, a joint without a limit, a range of no width, an override of a joint that does not move, a
/// foot.
std::vector<JointLimits> limits_of(const trees::TreeModel& model, std::span<const Override> overrides);

/// Shares of the limits that designed motions use; the rest is for the controller that follows them.
inline constexpr double kOfRange = 0.96, kOfVelocity = 0.95, kOfTorque = 0.9;

/// What each drive gives in a posture against gravity, and at most against friction at rest.
std::vector<double> holding_nm(const trees::TreeModel& model, std::span<const double> posture);

/// Of the postures within the limits the one in which the drives have most torque left; each joint's position.
/// @throws core::DataError: a joint that even there cannot be held, and its friction overcome, with the torque that designed motions use.
std::vector<double> easiest_posture(const trees::TreeModel& model, std::span<const JointLimits> limits);

}  // namespace furcula::excite
