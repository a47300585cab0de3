// See velocities.hpp.
#include "host/mapping/velocities.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace furcula::mapping {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2.0 * std::numbers::pi;

struct Known {
  double factor;
  const char* what;
};
constexpr Known kKnown[]{{1.0, "the other sign"},
                         {kDegree, "degrees beside rad/s"},
                         {1.0 / kDegree, "rad beside degrees/s"},
                         {kTurn, "turns beside rad/s"},
                         {60.0 / kTurn, "rad beside turns a minute"},
                         {1e3, "m beside mm/s"},
                         {1e-3, "mm beside m/s"}};

}  // namespace

std::optional<VelocityFactor> velocity_factor(const std::vector<double>& time_s,
                                              const std::vector<double>& position,
                                              const std::vector<double>& velocity) {
  // A velocity's integral has little of the noise that a position's slope has.
  constexpr std::size_t kRows = 20;
  constexpr double kAlike = 0.9, kLeast = 0.7, kMost = 1.4, kNear = 0.1;
  double of_velocity = 0.0, of_position = 0.0, product = 0.0;
  for (std::size_t from = 0; from + kRows < time_s.size(); from += kRows) {
    double way = 0.0;
    for (std::size_t i = from; i < from + kRows; ++i)
      way += 0.5 * (velocity[i] + velocity[i + 1]) * (time_s[i + 1] - time_s[i]);
    const double moved = position[from + kRows] - position[from];
    if (!std::isfinite(way + moved)) continue;
    of_velocity += way * way, of_position += moved * moved, product += way * moved;
  }
  if (!(std::abs(product) > kAlike * std::sqrt(of_velocity * of_position)) || !(of_position > 0.0))
    return std::nullopt;
  const double factor = product / of_position;
  if (factor > kLeast && factor < kMost) return std::nullopt;
  const double sign = factor < 0.0 ? -1.0 : 1.0;
  for (const Known& k : kKnown)
    if (std::abs(std::abs(factor) / k.factor - 1.0) < kNear)
      return VelocityFactor{
          sign * k.factor,
          std::string(k.what) + (sign < 0.0 && k.factor != 1.0 ? ", of the other sign" : "")};
  return VelocityFactor{factor, ""};
}

}  // namespace furcula::mapping
