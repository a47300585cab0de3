// A link's inertial parameters as fits move them and as a URDF has them.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "host/model/urdf.hpp"

namespace furcula::trees {

/// Ten numbers without unit, all 0 at the given body. Its pseudo-inertia has the Cholesky factor U = U0 V, U0 that of the given one:
/// 0 is the logarithm of the root of the mass, at a steady shape; 1 to 3 the logarithms of the stretches and 4 to 6 the shears of V; 7 to 9
/// the way of the centre of mass, over the radius of the given body. Every point is a body that fills space
/// (furcula/dynamics/tree/inertia_coordinates.hpp).
using BodyCoordinates = std::array<double, 10>;

/// What is known of each coordinate beforehand: 0, with this standard deviation. That is a factor of 2.7 on the mass, of 1.6 on lengths, half
/// a radius of the centre of mass.
inline constexpr double kBodyPrior = 0.5;

/// A link as a fit has it.
struct FittedBody {
  std::size_t link;
  BodyCoordinates at{};
};

/// Whether the body has coordinates: it fills space. A sheet, a rod and a point do not.
bool has_coordinates(const model::UrdfInertia& body);

/// The body at these coordinates about the given one, which has some. The axes of its inertia stay; at 0 it is the given one, bit by bit.
model::UrdfInertia body_at(const model::UrdfInertia& given, const BodyCoordinates& at);

/// As a URDF has them: mass, centre of mass in the link, inertia about it in the axes of <inertial><origin>.
inline constexpr std::array<std::string_view, 10> kInertialNames{
    "mass_kg",  "com_x_m",  "com_y_m",  "com_z_m",  "ixx_kgm2",
    "ixy_kgm2", "ixz_kgm2", "iyy_kgm2", "iyz_kgm2", "izz_kgm2"};
inline constexpr std::array<std::string_view, 10> kInertialUnits{
    "kg", "m", "m", "m", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2"};
std::array<double, 10> inertial_values(const model::UrdfInertia& body);

}  // namespace furcula::trees
