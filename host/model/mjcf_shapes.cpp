// Masses of bodies by MuJoCo's rules, see mjcf_shapes.hpp.
#include "host/model/mjcf_shapes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/message.hpp"
#include "host/linear/linear.hpp"

namespace furcula::model {
namespace {

using dynamics::tree::identity;
using dynamics::tree::Inertia;

constexpr double kWater_kgpm3 = 1000.0;  // MuJoCo's density where there is none

struct Shape {
  double volume_m3 = 0.0;
  Vec3<double> per_kg_m2{0.0, 0.0, 0.0};  ///< moments about the centre, of 1 kg
};

/// The volume and the moments of a solid; sizes as MuJoCo has them: radii and half lengths.
Shape solid(const std::string& type, double a, double b, double c) {
  constexpr double kPi = std::numbers::pi;
  if (type == "sphere") return {4.0 / 3.0 * kPi * a * a * a, {0.4 * a * a, 0.4 * a * a, 0.4 * a * a}};
  if (type == "ellipsoid")
    return {4.0 / 3.0 * kPi * a * b * c,
            {(b * b + c * c) / 5.0, (a * a + c * c) / 5.0, (a * a + b * b) / 5.0}};
  if (type == "box")
    return {8.0 * a * b * c, {(b * b + c * c) / 3.0, (a * a + c * c) / 3.0, (a * a + b * b) / 3.0}};
  const double h = 2.0 * b, tube = kPi * a * a * h;
  if (type == "cylinder")
    return {tube, {(3.0 * a * a + h * h) / 12.0, (3.0 * a * a + h * h) / 12.0, 0.5 * a * a}};
  // A capsule: a cylinder, and half a ball on each end, whose centre of mass is 3/8 of the radius beyond it.
  const double balls = 4.0 / 3.0 * kPi * a * a * a, ball = balls / (balls + tube), rest = 1.0 - ball;
  const double across =
      rest * (3.0 * a * a + h * h) / 12.0 + ball * (0.4 * a * a + h * (3.0 * a + 2.0 * h) / 8.0);
  return {balls + tube, {across, across, rest * 0.5 * a * a + ball * 0.4 * a * a}};
}

/// Of one shape; nothing where it has no mass.
std::optional<UrdfInertia> inertia_of_geom(const MjcfFields& f, const Frame<double>& in_body,
                                           const MjcfCompiler& compiler) {
  const std::string type = f.has("mesh") && f.text("type") != "mesh" && f.text("type") != "sdf"
                               ? "mesh"
                               : f.choice("type", {"sphere", "plane", "hfield", "capsule", "ellipsoid",
                                                   "cylinder", "box", "mesh", "sdf"});
  if (type == "plane" || type == "hfield") return std::nullopt;
  const double mass = f.not_negative("mass"),
               density = f.has("density") ? f.not_negative("density") : kWater_kgpm3;
  if (f.has("mass") ? mass == 0.0 : density == 0.0) return std::nullopt;
  if (type == "mesh" || type == "sdf")
    f.fail(
        "is a mesh, and its body has no mass but that of its shapes; mesh files are not read. Expected an <inertial> in the "
        "body (MuJoCo shows the compiled body_mass, body_ipos, body_iquat and body_inertia), or mass=\"0\" on the mesh");
  if (f.flag("shellinertia", false) || f.text("inertia") == "shell")
    f.fail("is a shell; expected a solid shape, or an <inertial> in the body");
  std::vector<double> size = f.numbers("size", 1, 3);
  Frame<double> frame = f.frame(compiler);
  const bool long_one = type == "capsule" || type == "cylinder";
  if (f.has("fromto")) {
    if (type == "sphere") f.fail("fromto", "it on a capsule, cylinder, box or ellipsoid");
    const std::vector<double> ends = f.numbers("fromto", 6, 6);
    const Vec3<double> from{ends[0], ends[1], ends[2]}, to{ends[3], ends[4], ends[5]}, way = from - to;
    const double half = 0.5 * std::sqrt(dot(way, way));
    if (!(half > 1e-14)) f.fail("fromto", "two points that are apart");
    if (size.empty()) f.fail("has fromto and no size; expected its radius");
    size = long_one ? std::vector<double>{size[0], half} : std::vector<double>{size[0], size[0], half};
    frame = {turn_of_z_to(way), (from + to) * 0.5};
  }
  const std::size_t needed = type == "sphere" ? 1 : long_one ? 2 : 3;
  if (size.size() < needed)
    f.fail("has " + std::to_string(size.size()) + " numbers in size; a " + type + " needs " +
           std::to_string(needed));
  for (std::size_t k = 0; k < needed; ++k)
    if (!(size[k] > 0.0)) f.fail("size", "numbers above 0");
  size.resize(3, 0.0);
  const Shape shape = solid(type, size[0], size[1], size[2]);
  const double kg = f.has("mass") ? mass : density * shape.volume_m3;
  const Vec3<double> m = shape.per_kg_m2 * kg;
  return UrdfInertia{kg, within(in_body, frame), {m.x, 0.0, 0.0, m.y, 0.0, m.z}};
}

/// As one, in the body's axes.
UrdfInertia sum(const std::vector<UrdfInertia>& parts) {
  if (parts.size() == 1) return parts[0];
  Inertia<double> all{};
  for (const UrdfInertia& p : parts)
    all = all + inertia_back(p.frame, dynamics::tree::inertia_of(p.mass_kg, Vec3<double>{0.0, 0.0, 0.0},
                                                                 p.about_centre_kgm2));
  const Vec3<double> centre = all.moment_kgm * (1.0 / all.mass_kg);
  const Sym3<double> s = dynamics::tree::minus_squared_cross(centre), &o = all.inertia_kgm2;
  const double m = all.mass_kg;
  return {
      m,
      {identity<double>(), centre},
      {o.xx - m * s.xx, o.xy - m * s.xy, o.xz - m * s.xz, o.yy - m * s.yy, o.yz - m * s.yz, o.zz - m * s.zz}};
}

UrdfInertia given(const MjcfElement& element, const MjcfCompiler& compiler) {
  const MjcfFields f(element, element.attributes);
  if (!f.has("mass")) f.fail("has no mass; expected mass=\"...\" in kg");
  if (!f.has("pos")) f.fail("has no pos; expected the centre of mass, x y z");
  UrdfInertia out{f.not_negative("mass"), f.frame(compiler), {}};
  if (const auto m = f.numbers("fullinertia", 6, 6); !m.empty()) {
    if (f.has("diaginertia") || f.has_orientation())
      f.fail(
          "has fullinertia, and diaginertia or an orientation; expected fullinertia alone, in the body's axes");
    out.about_centre_kgm2 = {m[0], m[3], m[4], m[1], m[5], m[2]};
  } else if (const auto d = f.numbers("diaginertia", 3, 3); !d.empty()) {
    out.about_centre_kgm2 = {d[0], 0.0, 0.0, d[1], 0.0, d[2]};
  }
  return out;
}

/// boundmass, boundinertia, balanceinertia; and refuses what is no body's.
void judge(UrdfInertia& body, const MjcfElement& element, const MjcfCompiler& compiler) {
  constexpr double kRounding = 1e-6;
  body.mass_kg = std::max(body.mass_kg, compiler.bound_mass_kg);
  Sym3<double>& s = body.about_centre_kgm2;
  Eigen::Matrix3d m;
  m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const linear::Axes3 axes = linear::axes_of_three(m);
  Eigen::Vector3d moments = axes.values.cwiseMax(compiler.bound_inertia_kgm2);
  const double most = moments(2);
  const bool negative = axes.values(0) < -kRounding * std::max(most, 0.0);
  if (!negative && moments(0) + moments(1) < moments(2) && compiler.balance_inertia)
    moments.setConstant(moments.mean());
  else if (negative || moments(2) - moments(1) - moments(0) > kRounding * most)
    element.fail(
        "has the principal moments of inertia " + core::rounded(axes.values(0)) + ", " +
        core::rounded(axes.values(1)) + ", " + core::rounded(axes.values(2)) +
        " kg m^2, which no body has; expected none below 0 and none more than the sum of the other two "
        "(<compiler balanceinertia=\"true\"/> makes them equal, as in MuJoCo)");
  if (moments == axes.values) return;
  const Eigen::Matrix3d r = axes.vectors * moments.asDiagonal() * axes.vectors.transpose();
  s = {r(0, 0), r(0, 1), r(0, 2), r(1, 1), r(1, 2), r(2, 2)};
}

}  // namespace

std::optional<UrdfInertia> inertia_of_body(const MjcfBody& body, const MjcfCompiler& compiler) {
  using FromGeoms = MjcfCompiler::FromGeoms;
  std::vector<UrdfInertia> parts;
  bool any = false;
  const bool by_geoms = compiler.inertia_from_geoms == FromGeoms::always ||
                        (compiler.inertia_from_geoms == FromGeoms::where_missing && body.inertial == nullptr);
  if (by_geoms)
    for (const auto& [fields, in_body] : body.geoms) {
      const double group = fields.number("group", 0.0);
      if (group < compiler.least_group || group > compiler.last_group) continue;
      any = true;
      if (const auto part = inertia_of_geom(fields, in_body, compiler)) parts.push_back(*part);
    }
  std::optional<UrdfInertia> out;
  const MjcfElement* from = body.element;
  if (!parts.empty()) {
    out = sum(parts);
  } else if (body.inertial != nullptr) {
    from = body.inertial;
    out = given(*body.inertial, compiler);
    out->frame = within(body.to_body, out->frame);
  } else if (compiler.bound_mass_kg > 0.0 || compiler.bound_inertia_kgm2 > 0.0) {
    // MuJoCo's rule, odd as it is: without any shape that counts, the mass is as far from the body as the body from its parent.
    out = UrdfInertia{
        0.0,
        any || compiler.global ? Frame<double>{identity<double>(), {0.0, 0.0, 0.0}} : body.in_parent,
        {}};
  }
  if (out) judge(*out, *from, compiler);
  return out;
}

}  // namespace furcula::model
