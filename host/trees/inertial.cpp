// Links' inertial parameters, see inertial.hpp.
#include "host/trees/inertial.hpp"

#include <algorithm>
#include <cmath>

#include "furcula/dynamics/tree/inertia_coordinates.hpp"

namespace furcula::trees {
namespace {

using Coordinates = dynamics::tree::InertiaCoordinates<double>;
using dynamics::tree::Vec3;

/// In a frame at its centre of mass, in the axes of its inertia.
Result<Coordinates> about_centre(const model::UrdfInertia& body) {
  return dynamics::tree::coordinates_of(
      dynamics::tree::Inertia<double>{body.mass_kg, {0.0, 0.0, 0.0}, body.about_centre_kgm2});
}

}  // namespace

bool has_coordinates(const model::UrdfInertia& body) { return about_centre(body).ok(); }

model::UrdfInertia body_at(const model::UrdfInertia& given, const BodyCoordinates& at) {
  if (std::all_of(at.begin(), at.end(), [](double x) { return x == 0.0; })) return given;
  const Coordinates c = about_centre(given).value();
  // U0 V, both upper triangles.
  const double l11 = std::exp(c.log_stretch.x), l22 = std::exp(c.log_stretch.y);
  const double v22 = std::exp(at[2]), v33 = std::exp(at[3]);
  const auto& i = given.about_centre_kgm2;
  const double radius_m = std::sqrt(0.5 * (i.xx + i.yy + i.zz) / given.mass_kg);
  const Coordinates moved{c.log_scale + at[0],
                          {c.log_stretch.x + at[1], c.log_stretch.y + at[2], c.log_stretch.z + at[3]},
                          l11 * at[4] + c.shear12 * v22,
                          l22 * at[5] + c.shear23 * v33,
                          l11 * at[6] + c.shear12 * at[5] + c.shear13 * v33,
                          {0.0, 0.0, 0.0}};
  const auto body = dynamics::tree::inertia_of(moved);
  const auto& m = body.inertia_kgm2;
  model::UrdfInertia out = given;
  out.mass_kg = body.mass_kg;
  // No product is -0.
  out.about_centre_kgm2 = {m.xx, m.xy + 0.0, m.xz + 0.0, m.yy, m.yz + 0.0, m.zz};
  out.frame.at = given.frame.point_back(Vec3<double>{radius_m * at[7], radius_m * at[8], radius_m * at[9]});
  return out;
}

std::array<double, 10> inertial_values(const model::UrdfInertia& body) {
  const auto& c = body.frame.at;
  const auto& i = body.about_centre_kgm2;
  return {body.mass_kg, c.x, c.y, c.z, i.xx, i.xy, i.xz, i.yy, i.yz, i.zz};
}

}  // namespace furcula::trees
