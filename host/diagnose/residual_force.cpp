#include "host/diagnose/residual_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/identify/simulate.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using identify::Recording;

constexpr double kHalfWidth_s = 0.015;  // of the local parabola that gives the acceleration
constexpr double kProbe_s = 1e-5;       // the model's acceleration is read off a step this short
constexpr std::size_t kFewestRows = 7;

/// What a model makes of a recording's measured states, its drive's and its sensors' effects included.
class Acceleration {
 public:
  explicit Acceleration(const model::Model& m) : setup_(m, {}, nullptr) {}

  /// What reaches the plant in each row.
  std::vector<double> inputs(const Recording& r) const {
    std::vector<double> all = identify::inputs(setup_, r);
    all.push_back(all.back());
    return all;
  }

  /// The acceleration that would be measured at a measured state of the row.
  double at(const Recording& r, std::size_t row, double position, double velocity, double input) const {
    return identify::acceleration(setup_, r, position, velocity, input, kProbe_s, row);
  }

 private:
  identify::PlantSetup<double> setup_;
};

/// Seconds since the last crossing of the touch-down height, NaN before the first; downwards in stance,
/// upwards in flight.
struct SinceEvents {
  std::vector<double> touchdown_s, liftoff_s;
};

SinceEvents since_events(const Recording& r, double touchdown_m) {
  constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
  SinceEvents since{std::vector<double>(r.rows(), kNever), std::vector<double>(r.rows(), kNever)};
  double last_s = kNever;
  for (std::size_t i = 1; i < r.rows(); ++i) {
    const bool below = r.position[i] < r.touchdown_height_m(i, touchdown_m);
    if (below != (r.position[i - 1] < r.touchdown_height_m(i - 1, touchdown_m))) last_s = r.time_s[i];
    (below ? since.touchdown_s : since.liftoff_s)[i] = r.time_s[i] - last_s;
  }
  return since;
}

/// Of a leg that folds in flight: the toe is within about 10 mm of the ground in the air, or the leg is on its
/// way, by which the body moves too; and rows that no model follows.
bool near_ground_or_folding(const Recording& r, std::size_t first, std::size_t last) {
  constexpr double kNear_m = 0.010, kMoves_m = 0.001;
  if (!r.not_followed.empty() && (r.not_followed[first] != 0 || r.not_followed[last] != 0)) return true;
  if (r.leg_length.empty()) return false;
  double low = 1e9, high = -1e9, least = 1e9, most = -1e9;
  for (std::size_t i = first; i <= last; ++i) {
    low = std::min(low, r.position[i] - r.leg_length[i]);
    high = std::max(high, r.position[i] - r.leg_length[i]);
    least = std::min(least, r.leg_length[i]);
    most = std::max(most, r.leg_length[i]);
  }
  return (low < kNear_m && high > -kNear_m) || (high > 0.0 && most - least > kMoves_m);
}

/// Whether the coil is on and the belt moves in all of the rows.
bool falls(const Recording& r, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i <= last; ++i)
    if (r.input[i] == 0.0 || !(std::abs(r.velocity_smoothed[i]) > 10.0 * r.position_noise / kHalfWidth_s))
      return false;
  return true;
}

}  // namespace

ResidualForce residual_force(const model::Model& model, const std::vector<dynamics::Effect>& named,
                             const std::vector<Recording>& recordings, std::size_t most) {
  ResidualForce out;
  const bool rotary = dynamics::info(model.kind).rotary;
  out.unit = rotary ? "N m" : "N";
  out.velocity_unit = rotary ? "rad/s" : "m/s";
  out.position_unit = rotary ? "rad" : "m";
  model::Model bare = model;
  for (dynamics::Effect e : named) bare.effects.erase(e);
  const Acceleration with(model), without(bare);
  const double mass = machines::rules(model.kind).inertia(model);
  const bool leg = dynamics::has(model.kind, dynamics::LocationType::leg);
  const double touchdown = leg ? machines::touchdown_height_m(model) : 0.0;

  std::size_t rows = 0;
  for (const Recording& r : recordings) rows += r.rows();
  const std::size_t stride = std::max<std::size_t>(1, rows / std::max<std::size_t>(most, 1));
  for (std::size_t of = 0; of < recordings.size(); ++of) {
    const Recording& r = recordings[of];
    const SinceEvents since = since_events(r, touchdown);
    const std::vector<double> driven = with.inputs(r), driven_without = without.inputs(r);
    for (std::size_t i = 0; i < r.rows(); i += stride) {
      std::size_t first = i, last = i;
      while (first > 0 && r.time_s[first - 1] >= r.time_s[i] - kHalfWidth_s) --first;
      while (last + 1 < r.rows() && r.time_s[last + 1] <= r.time_s[i] + kHalfWidth_s) ++last;
      while (last - first + 1 < kFewestRows && (first > 0 || last + 1 < r.rows())) {
        if (first > 0) --first;
        if (last + 1 < r.rows()) ++last;
      }
      if (i - first < 2 || last - i < 2) continue;
      // Of a belt the middle of its fall, clear of where it is let go and of where it is held.
      if (dynamics::has(model.kind, dynamics::LocationType::belt) && !falls(r, first, last)) continue;
      if (!r.contact.empty() && std::any_of(r.contact.begin() + static_cast<std::ptrdiff_t>(first),
                                            r.contact.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                                            [](double touches) { return touches != 0.0; }))
        continue;
      if (leg) {
        const auto [low, high] =
            std::minmax_element(r.position.begin() + static_cast<std::ptrdiff_t>(first),
                                r.position.begin() + static_cast<std::ptrdiff_t>(last) + 1);
        // Near a change of phase: within about 10 mm of the touch-down height.
        if (r.leg_length.empty() && *low < touchdown + 0.010 && *high > touchdown - 0.010) continue;
        if (near_ground_or_folding(r, first, last)) continue;
      }
      const auto p = identify::local_polynomial(r.time_s, r.position, first, last, r.time_s[i], 2);
      const auto seen = [&](const std::vector<double>& values) {  // by the parabola: averaged over its rows
        double sum = 0.0;
        for (std::size_t k = first; k <= last; ++k) sum += values[k] / static_cast<double>(last - first + 1);
        return sum;
      };
      const double lacking = without.at(r, i, p.value, p.slope, seen(driven_without));
      out.time_s.push_back(r.time_s[i] - r.time_s.front());
      out.velocity.push_back(p.slope);
      out.position.push_back(p.value);
      out.force.push_back(mass * (p.curvature - lacking));
      if (!named.empty()) out.law.push_back(mass * (with.at(r, i, p.value, p.slope, seen(driven)) - lacking));
      out.recording.push_back(of);
      out.acceleration.push_back(p.curvature);
      out.input.push_back(seen(r.input));
      out.interval_s.push_back(i > 0 ? r.time_s[i] - r.time_s[i - 1] : r.time_s[1] - r.time_s[0]);
      out.since_touchdown_s.push_back(since.touchdown_s[i]);
      out.since_liftoff_s.push_back(since.liftoff_s[i]);
    }
  }
  return out;
}

}  // namespace furcula::diagnose
