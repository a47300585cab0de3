// The table of units, see units.hpp.
#include "host/conventions/units.hpp"

#include <array>
#include <numbers>

namespace furcula::conventions {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2.0 * std::numbers::pi;
constexpr double kKilopond = 9.80665, kPound = 4.4482216152605, kInch = 0.0254;

constexpr std::array<Unit, 8> kAngles{{{"degrees", kDegree},
                                       {"turns", kTurn},
                                       {"half turns", kTurn / 2.0, true},
                                       {"tenths of a degree", kDegree / 10.0, true},
                                       {"hundredths of a degree", kDegree / 100.0},
                                       {"millidegrees", kDegree / 1000.0},
                                       {"milliradians", 1e-3, true},
                                       {"gradians", kTurn / 400.0, true}}};
constexpr std::array<Unit, 5> kLengths{{{"millimetres", 1e-3},
                                        {"centimetres", 1e-2},
                                        {"micrometres", 1e-6, true},
                                        {"inches", kInch, true},
                                        {"feet", 12.0 * kInch, true}}};
constexpr std::array<Unit, 9> kTorques{{{"N mm", 1e-3},
                                        {"N cm", 1e-2},
                                        {"uN m", 1e-6, true},
                                        {"kN m", 1e3, true},
                                        {"kgf cm", kKilopond / 100.0, true},
                                        {"kgf m", kKilopond, true},
                                        {"ozf in", kPound / 16.0 * kInch, true},
                                        {"lbf in", kPound* kInch, true},
                                        {"lbf ft", kPound * 12.0 * kInch, true}}};
constexpr std::array<Unit, 5> kForces{{{"mN", 1e-3, true},
                                       {"kN", 1e3},
                                       {"kgf", kKilopond},
                                       {"gf", kKilopond / 1000.0, true},
                                       {"lbf", kPound, true}}};
constexpr std::array<Unit, 4> kTimes{
    {{"milliseconds", 1e-3}, {"microseconds", 1e-6}, {"nanoseconds", 1e-9}, {"minutes", 60.0, true}}};

constexpr std::array<Unit, 4> kInertias{
    {{"kg cm^2", 1e-4}, {"g m^2", 1e-3}, {"kg mm^2", 1e-6}, {"g cm^2", 1e-7}}};
constexpr std::array<Unit, 1> kMasses{{{"g", 1e-3}}};

}  // namespace

std::span<const Unit> units_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::angle:
      return kAngles;
    case Quantity::length:
      return kLengths;
    case Quantity::torque:
      return kTorques;
    default:
      return kForces;
  }
}

std::span<const Unit> units_of_time() { return kTimes; }

std::span<const Unit> units_of_inertia(Quantity position) {
  if (position == Quantity::length) return kMasses;
  return kInertias;
}

std::string_view si_unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::angle:
      return "rad";
    case Quantity::length:
      return "m";
    case Quantity::torque:
      return "N m";
    default:
      return "N";
  }
}

}  // namespace furcula::conventions
