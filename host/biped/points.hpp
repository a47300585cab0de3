// The points of a biped that pictures join by lines.
#pragma once

#include <array>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::biped {

struct Points {
  /// The pelvis and its top; of each leg hip, knee, ankle and the foot's four corners. In the axes of `at` and `pelvis`.
  std::vector<dynamics::tree::Vec3<double>> all;
  std::array<dynamics::tree::Mat3<double>, 2> feet;  ///< their attitudes
};

/// `angle_rad` left then right; attitudes of joints' frames other than the design's are neglected.
Points points_of(const dynamics::biped::Description& robot, const dynamics::tree::Vec3<double>& at,
                 const dynamics::tree::Mat3<double>& pelvis,
                 const std::array<double, dynamics::biped::kJoints>& angle_rad);

/// Of `Points::all`.
inline constexpr std::size_t kPointsALeg = 7, kFirstCorner = 3;
constexpr std::size_t first_point(std::size_t side) { return 2 + kPointsALeg * side; }
/// The joint's place.
constexpr std::size_t point_of_joint(std::size_t joint) {
  const std::size_t j = joint % dynamics::biped::kLegJoints;
  return first_point(joint / dynamics::biped::kLegJoints) + (j < dynamics::biped::kKnee    ? 0
                                                             : j == dynamics::biped::kKnee ? 1
                                                                                           : 2);
}

}  // namespace furcula::biped
