#include "host/loop/way.hpp"

#include <array>
#include <cmath>

#include "furcula/dynamics/biped/kinematics.hpp"
#include "host/floating/simulate.hpp"

namespace furcula::loop {
namespace {

using namespace dynamics::biped;

/// Both feet's sole vertices against the pelvis, in the level's axes.
using Soles = std::array<std::array<Vec3<double>, kVertices>, 2>;

Soles soles_of(const floating::Row& row, const floating::Machine& machine, const floating::Plant& plant) {
  State<double> s;
  s.attitude = row.attitude;
  for (std::size_t i = 0; i < kJoints; ++i)
    set_joint<double>(s.q_rad, i, row.angle_rad[i] - machine.encoder_offset_rad[i]);
  Kinematics<double> k;
  kinematics<AnywhereTopology>(plant, s, k);
  const auto& turn = k.legs[0].foot_rotation;
  const auto& at = k.legs[0].foot_position_m;
  Soles out;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t i = 0; i < kVertices; ++i) {
      const Vec3<double>& v = machine.robot.vertices_m[side][i];
      const auto of = [&](const auto& axis) {
        return axis.x[side] * v.x + axis.y[side] * v.y + axis.z[side] * v.z;
      };
      out[side][i] = {at.x[side] + of(turn.x), at.y[side] + of(turn.y), at.z[side] + of(turn.z)};
    }
  return out;
}

/// Of a foot, that which is lowest over two rows: by how much it moves against the pelvis, and its height.
struct Lowest {
  Vec3<double> moved_m;
  double height_m;
};
Lowest lowest(const std::array<Vec3<double>, kVertices>& from,
              const std::array<Vec3<double>, kVertices>& to) {
  std::size_t best = 0;
  const auto height = [&](std::size_t i) { return 0.5 * (from[i].z + to[i].z); };
  for (std::size_t i = 1; i < kVertices; ++i)
    if (height(i) < height(best)) best = i;
  return {to[best] - from[best], height(best)};
}

}  // namespace

std::vector<Place> way_of(const floating::Recording& recording, const floating::Machine& machine) {
  const auto& rows = recording.rows;
  std::vector<Place> out(rows.size());
  if (rows.empty()) return out;
  const floating::Plant plant = floating::plant_of(machine);
  const Mat3<double> first = rotation(rows[0].attitude);
  const double heading_rad = std::atan2(first.y.x, first.x.x);
  const double c = std::cos(heading_rad), s = std::sin(heading_rad);
  Soles before = soles_of(rows[0], machine, plant);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const Soles now = soles_of(rows[k], machine, plant);
    const std::array<Lowest, 2> feet{lowest(before[0], now[0]), lowest(before[1], now[1])};
    const auto carries = [&](std::size_t side) { return rows[k - 1].contact[side] && rows[k].contact[side]; };
    const std::size_t lower = feet[1].height_m < feet[0].height_m ? 1 : 0;
    const std::size_t stance = carries(0) == carries(1) ? lower : carries(1) ? 1 : 0;
    const Vec3<double>& by = feet[stance].moved_m;
    out[k] = {out[k - 1].x_m - (c * by.x + s * by.y), out[k - 1].y_m - (c * by.y - s * by.x)};
    before = now;
  }
  return out;
}

}  // namespace furcula::loop
