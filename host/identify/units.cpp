// Wrong units, see units.hpp.
#include "host/identify/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/identify/prediction.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

Recording scaled(Recording r, double scale) {
  for (auto* values : {&r.position, &r.velocity, &r.velocity_smoothed})
    for (double& v : *values) v *= scale;
  r.position_noise *= scale;
  r.velocity_noise *= scale;
  return r;
}

/// How far the model foretells what the body does beyond going on as it started: how many times as much of it as the model says, and how
/// alike the two are (1: the same but for that factor).
struct Foretold {
  double times = 0.0, alike = 0.0;
};

Foretold foretold_by(const model::Model& model, const Recording& r, const std::vector<Window>& windows) {
  double both = 0.0, said = 0.0, seen = 0.0;
  for (const Window& w : windows) {
    const StartState start = start_state(r, w);
    const Run run = predict(model, r, w, start);
    for (std::size_t i = 0; i < w.rows(); ++i) {
      const double on = start.position + start.velocity * (r.time_s[w.first + i] - r.time_s[w.first]);
      const double says = run.position[i] - on, does = r.position[w.first + i] - on;
      both += says * does;
      said += says * says;
      seen += does * does;
    }
  }
  if (!(said > 0.0 && seen > 0.0) || !std::isfinite(both) || !std::isfinite(said)) return {};
  return {both / said, both / std::sqrt(said * seen)};
}

Recording other_way(Recording r) {
  for (double& u : r.input) u = -u;
  return r;
}

/// Of what the body does, what a model leaves that foretells it, but for a factor; all, where it foretells the opposite.
double left_by(const Foretold& f) { return f.alike > 0.0 ? 1.0 - f.alike * f.alike : 1.0; }

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

void require_named_unit(const model::Model& model, const std::vector<Recording>& recordings,
                        const std::vector<Window>& windows) {
  constexpr double kAlike = 0.8, kAbout = 4.0, kBetter = 0.15;
  constexpr std::size_t kWindows = 6;  // of each recording
  const machines::Rules& rules = machines::rules(model.kind);
  if (rules.cut == machines::Cut::strides) return;
  const bool rotary = dynamics::info(model.kind).rotary;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& r = recordings[i];
    std::vector<Window> own, some;
    for (const Window& w : windows)
      if (w.recording == i) own.push_back(w);
    for (std::size_t k = 0; k < own.size(); k += std::max<std::size_t>(1, own.size() / kWindows))
      some.push_back(own[k]);
    // What swings freely by less than a turn may be a pendulum or a spring.
    const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
    const bool driven = std::any_of(r.input.begin(), r.input.end(), [](double u) { return u != 0.0; });
    if (some.empty() || (rotary && !driven && *high - *low < 2.0 * std::numbers::pi)) continue;
    const Foretold named = foretold_by(model, r, some);
    const auto refuse_if_better = [&](const Recording& read_so, const std::string& what, const char* named_so,
                                      const char* expected) {
      const Foretold other = foretold_by(model, read_so, some);
      const bool fits = other.alike > kAlike && other.times < kAbout && other.times > 1.0 / kAbout;
      if (!fits || !(left_by(other) < kBetter * left_by(named))) return;
      throw core::DataError(r.name + ": " + what + ": so read, the model accounts for all but " +
                            core::rounded(100.0 * left_by(other), 2) + " % of what it does, as " + named_so +
                            " for all but " + core::rounded(100.0 * left_by(named), 2) + " %; expected " +
                            expected);
    };
    const std::string position(rules.columns.position);
    if (rotary)
      refuse_if_better(scaled(r, kRadPerDegree), position + " moves as degrees would", "radians",
                       "radians (a --map file with scale = 0.0174533 makes them)");
    else
      refuse_if_better(scaled(r, 1e-3), position + " moves as millimetres would", "metres",
                       "metres (a --map file with scale = 0.001 makes them)");
    if (driven && rules.cut != machines::Cut::releases)  // there the input is a coil
      refuse_if_better(other_way(r), std::string(rules.columns.input) + " has the other sign", "named",
                       "a positive one to push the position up (a --map file with scale = -1.0 turns it)");
  }
}

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
