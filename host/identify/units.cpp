// Velocities that are not their position's slope, see units.hpp.
#include "host/identify/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host/core/message.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

/// A usual confusion of units, by its factor.
struct Confusion {
  double factor;
  const char* what;
};
constexpr Confusion kConfusions[]{{1.0 / kRadPerDegree, ", as with degrees for radians"},
                                  {kRadPerDegree, ", as with radians for degrees"},
                                  {30.0 / std::numbers::pi, ", as with turns a minute for rad/s"},
                                  {1e3, ", as with millimetres for metres"},
                                  {1e-3, ", as with metres for millimetres"},
                                  {1e2, ", as with centimetres for metres"},
                                  {-1.0, ", with the other sign"}};

/// That which a factor is near to; else the factor itself.
Confusion confusion_of(double factor) {
  for (const Confusion& c : kConfusions)
    if (std::abs(factor / c.factor - 1.0) < 0.1) return c;
  return {factor, ""};
}

}  // namespace

void mend_velocities(std::vector<Recording>& recordings) {
  constexpr double kAlike = 0.9, kLeast = 0.7, kMost = 1.4;
  for (Recording& r : recordings) {
    if (!r.velocity_recorded) continue;
    double of_column = 0.0, of_slope = 0.0, product = 0.0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      of_column += r.velocity[i] * r.velocity[i];
      of_slope += r.velocity_smoothed[i] * r.velocity_smoothed[i];
      product += r.velocity[i] * r.velocity_smoothed[i];
    }
    if (!(std::abs(product) > kAlike * std::sqrt(of_column * of_slope))) continue;
    const double factor = std::copysign(std::sqrt(of_column / of_slope), product);
    if (factor > kLeast && factor < kMost) continue;
    const machines::Columns& columns = machines::rules(r.kind).columns;
    const Confusion confusion = confusion_of(factor);
    r.notes.push_back(r.name + ": " + std::string(columns.velocity) + " is " + core::rounded(factor, 3) +
                      " times the slope of " + std::string(columns.position) + confusion.what +
                      ": it is not used (a --map file with scale = " +
                      core::rounded(1.0 / confusion.factor, 6) + " mends it, if the position is right).");
    r.velocity = r.velocity_smoothed;
    r.velocity_recorded = false;
  }
}

}  // namespace furcula::identify
