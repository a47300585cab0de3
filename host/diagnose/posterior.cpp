#include "host/diagnose/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/quantile.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/wording.hpp"
#include "host/machines/hopper.hpp"

namespace furcula::diagnose {

using dynamics::Effect;
using identify::Recording;
using identify::Window;

Posterior::Posterior(const model::Model& model, const std::vector<Weighed>& sets, double misfit)
    : model_(model) {
  double largest = 0.0;
  for (const Weighed& s : sets) {
    const double odds = s.evidence / misfit + s.prior;  // twice their logarithm
    largest = std::max(largest, odds);
    const auto laws = laws_of(model, s.effects);
    const auto known =
        std::find_if(laws_.begin(), laws_.end(), [&](const Law& other) { return other.laws == laws; });
    if (known == laws_.end())
      laws_.push_back({laws, odds});
    else
      known->weight = std::max(known->weight, odds);
  }
  for (Law& law : laws_) law.weight = std::exp(0.5 * (law.weight - largest));
}

double Posterior::share_with(Effect e) const {
  const auto of = laws_of(model_, {e});
  double all = 0.0, with = 0.0;
  for (const Law& law : laws_) {
    all += law.weight;
    if (std::includes(law.laws.begin(), law.laws.end(), of.begin(), of.end())) with += law.weight;
  }
  return all > 0.0 ? with / all : 0.0;
}

double Posterior::weight_of(const EffectSet& effects) const {
  const auto of = laws_of(model_, effects);
  double all = 0.0, own = 0.0;
  for (const Law& law : laws_) {
    all += law.weight;
    if (law.laws == of) own = law.weight;
  }
  return all > 0.0 ? own / all : 0.0;
}

double misfit_of(const std::optional<Remainder>& left) {
  if (!left || !left->is_structured_in_training()) return 1.0;
  return std::min(1.0 / std::max(1.0 - left->crossed.share, 1e-3), kConfidence.largest_misfit);
}

double unnamed_share(double before, double after, double floor, const Predictable* predictable,
                     bool nothing_left) {
  if (nothing_left || !(after < before) || !(before > floor)) return 0.0;
  // What a flexible law predicts is there to be explained; of what comes at random, all that is not noise.
  const double above = predictable ? predictable->share * (after - floor) : after - floor;
  return std::clamp(above / (above + before - after), 0.0, 1.0);
}

namespace {

/// From where to where the windows go, but for their outermost hundredths.
struct Range {
  double low, high;
};
Range range_of(const std::vector<double>& values) {
  return {core::quantile(values, 0.01), core::quantile(values, 0.99)};
}

template <class Visit>
void each_row(const std::vector<Window>& windows, const std::vector<Recording>& recordings,
              const Visit& visit) {
  for (const Window& w : windows)
    for (std::size_t row = w.first; row <= w.last; ++row) visit(recordings[w.recording], row, w);
}

/// How far what turns the motor, or the encoder's wheel, goes: rad or m.
double travel_of_motor(const model::Model& m, const std::vector<Recording>& recordings,
                       const std::vector<Window>& windows) {
  const bool leg = dynamics::has(m.kind, dynamics::LocationType::leg);
  std::vector<double> angles;
  each_row(windows, recordings, [&](const Recording& r, std::size_t row, const Window&) {
    const double position = r.position[row];
    if (!leg)
      angles.push_back(position);
    else if (position <= machines::touchdown_height_m(m))
      angles.push_back(std::acos(std::clamp(position / (2.0 * m.parameter("link_length_m")), -1.0, 1.0)));
  });
  if (angles.empty()) return 0.0;
  const auto [low, high] = range_of(angles);
  return high - low;
}

double travel_of(const std::vector<Recording>& recordings, const std::vector<Window>& windows) {
  std::vector<double> positions;
  each_row(windows, recordings,
           [&](const Recording& r, std::size_t row, const Window&) { positions.push_back(r.position[row]); });
  const auto [low, high] = range_of(positions);
  return high - low;
}

std::optional<std::string> swings(double seen, std::string_view of) {
  if (seen >= kConfidence.fewest_swings) return std::nullopt;
  return "the recordings go through " + number(seen, 2) + " of its swings over " + std::string(of) +
         "; a bend looks alike below " + number(kConfidence.fewest_swings, 2);
}

}  // namespace

std::optional<std::string> too_little_seen(Effect e, const model::Model& fitted,
                                           const std::vector<Recording>& recordings,
                                           const std::vector<Window>& windows) {
  if (!fitted.effects.contains(e)) return std::nullopt;
  const auto& p = fitted.effects.at(e);
  switch (e) {
    case Effect::torque_ripple:
      return swings(travel_of_motor(fitted, recordings, windows) * p[1] / (2.0 * std::numbers::pi),
                    "the motor's angle");
    case Effect::height_eccentricity:
      return swings(travel_of(recordings, windows) / p[1], "the height");
    case Effect::binding_spot: {
      bool up = false, down = false, below = false, above = false;
      const double low = p[1] - 0.5 * p[2], high = p[1] + 0.5 * p[2];
      each_row(windows, recordings, [&](const Recording& r, std::size_t row, const Window& w) {
        if (row == w.first) return;
        const double from = r.position[row - 1], to = r.position[row];
        up = up || (from < p[1] && to >= p[1]);
        down = down || (from > p[1] && to <= p[1]);
        below = below || to < low;
        above = above || to > high;
      });
      if (!up || !down) return "the recordings go through that spot in one direction only";
      if (!below || !above) return "the recordings do not go beyond that spot on both sides";
      return std::nullopt;
    }
    case Effect::thermal_derating: {
      std::vector<double> driven_s;
      each_row(windows, recordings, [&](const Recording& r, std::size_t row, const Window&) {
        if (!r.driven_s.empty()) driven_s.push_back(r.driven_s[row]);
      });
      if (driven_s.empty()) return std::nullopt;
      const auto [low, high] = range_of(driven_s);
      if (high - low >= kConfidence.least_warming * p[1]) return std::nullopt;
      return "the motor works for " + number(high - low, 2) + " s, and warms up within " + number(p[1], 2) +
             " s: a constant gain looks alike";
    }
    case Effect::stribeck_friction: {
      double rows = 0.0, in_windows = 0.0;
      const Window* last = nullptr;
      each_row(windows, recordings, [&](const Recording& r, std::size_t row, const Window& w) {
        if (std::abs(r.velocity_smoothed[row]) > p[2]) return;
        ++rows;
        if (&w != last) ++in_windows;
        last = &w;
      });
      if (rows >= kConfidence.fewest_slow_rows && in_windows >= kConfidence.fewest_slow_windows)
        return std::nullopt;
      return "the recordings hold " + number(rows) +
             " rows below its velocity: plain dry friction looks alike";
    }
    default:
      return std::nullopt;
  }
}

}  // namespace furcula::diagnose
