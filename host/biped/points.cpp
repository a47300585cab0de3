// Positions of a biped's joints and corners of its feet.
#include "host/biped/points.hpp"

#include "furcula/dynamics/biped/kinematics.hpp"

namespace furcula::biped {

using namespace dynamics::biped;

Points points_of(const Description& robot, const Vec3<double>& at, const Mat3<double>& pelvis,
                 const std::array<double, kJoints>& angle_rad) {
  Points out;
  out.all = {at, at + pelvis * Vec3<double>{0.0, 0.0, 0.35}};
  for (const std::size_t side : {kLeft, kRight}) {
    Mat3<double> r = pelvis;
    Vec3<double> joint = at;
    outwards([&](auto index) {
      constexpr std::size_t J = index;
      joint += r * robot.legs[side][J].offset_m;
      const auto angle = dynamics::sine_cosine(angle_rad[side * kLegJoints + J]);
      const Turn<DesignTopology::kAxes[J], double> turn{angle.cosine, angle.sine};
      r = {turn.in(r.x), turn.in(r.y), turn.in(r.z)};
      if (J == kHipPitch || J == kKnee || J == kAnklePitch) out.all.push_back(joint);
    });
    for (const Vec3<double>& corner : robot.vertices_m[side]) out.all.push_back(joint + r * corner);
    out.feet[side] = r;
  }
  return out;
}

}  // namespace furcula::biped
