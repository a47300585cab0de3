// Whether a gait can be kept up: multipliers and basin with and without a feedback in stance, and the cheapest gait that
// is stable with it.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "host/gait/held_gait.hpp"
#include "host/gait/search.hpp"

namespace furcula::gait {

/// The law for any gait: the flight's stiffness in stance too, with twice its damping. Of the gains that were tried on
/// gaits in place and at 1 m/s (50 to 400 N m/rad) the softest with which nine of ten starts return.
inline constexpr StanceGains kStanceGains{{200.0, 200.0}, {10.0, 10.0}};

/// Starts that are drawn evenly from a box about the gait's apex, all six values at once.
struct BasinOptions {
  unsigned starts = 200, strides = 5;
  std::uint64_t seed = 1;
  Apex<double> spread{0.05, 0.3, {0.15, 0.15}, {2.0, 2.0}};  ///< half of the box, m, m/s, rad, rad/s
  double near = 0.1;               ///< returned: every value within this share of `spread`
  double joint_excess_rad = 0.02;  ///< a joint further beyond its range is a fall
};
struct Basin {
  unsigned starts = 0, returned = 0;
  double share() const { return starts > 0 ? static_cast<double>(returned) / starts : 0.0; }
};
/// How many starts return within so many strides; the same for the same seed.
Basin basin_of(const HeldGait& gait, const BasinOptions& options = {});

struct Stability {
  StanceGains gains;
  std::vector<std::complex<double>> multipliers;  ///< with the law, largest first
  Basin basin, open_loop;                         ///< with and without it

  bool stable() const { return !multipliers.empty() && std::abs(multipliers.front()) < 1.0; }
};
Stability stability_of(const Gait& gait, const StanceGains& gains = kStanceGains);

/// A gait that the law keeps, and the speed with which its toe comes down at least. Speed 0: the cheapest gait itself.
struct StableGait {
  double landing_speed_mps = 0.0;
  Gait gait;
  Evaluation evaluation;
  Stability stability;
};
/// The cheapest gait whose multipliers with the law are below 1: where the cheapest of all is not, its toe lands faster,
/// by steps of 0.25 m/s up to 3 m/s. Empty where none of these is stable.
std::optional<StableGait> cheapest_stable(const Query& query, const Search& found,
                                          const std::function<void(std::string_view)>& tell);

}  // namespace furcula::gait
