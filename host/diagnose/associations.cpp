#include "host/diagnose/associations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "host/core/quantile.hpp"
#include "host/diagnose/wording.hpp"
#include "host/identify/windows.hpp"
#include "host/linear/linear.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::has;
using dynamics::LocationType;

constexpr std::size_t kBins = 12;
constexpr double kWeakest = 0.1;

double squares_about_mean(const std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double squares = 0.0;
  for (double v : values) squares += (v - mean) * (v - mean);
  return squares;
}

/// Squares of `force` about its means over bins of the signal: `bins` of equal count (fewer where many
/// samples share a value).
double squares_within(const std::vector<double>& signal, const std::vector<double>& force, std::size_t bins) {
  const std::size_t n = force.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return signal[a] < signal[b]; });
  double within = 0.0;
  for (std::size_t b = 0, from = 0; b < bins; ++b) {
    std::size_t to = std::max(from, (b + 1) * n / bins);
    while (to > from && to < n && signal[order[to]] == signal[order[to - 1]]) ++to;
    std::vector<double> inside;
    for (std::size_t i = from; i < to; ++i) inside.push_back(force[order[i]]);
    if (!inside.empty()) within += squares_about_mean(inside);
    from = to;
  }
  return within;
}

/// The share of the variance that `groups` means explain, less what they explain by chance.
double explained(double total, double within, std::size_t samples, std::size_t groups) {
  if (samples < 10 * groups || !(total > 0.0)) return 0.0;
  return 1.0 - within / total * static_cast<double>(samples - 1) / static_cast<double>(samples - groups);
}

class Associations {
 public:
  Associations(const ResidualForce& r, const model::Model& model)
      : r_(r), model_(model), columns_(machines::rules(model.kind).columns), rest_(r.force) {
    for (std::size_t i = 0; i < r.law.size(); ++i) rest_[i] -= r.law[i];
    total_ = rest_.empty() ? 0.0 : squares_about_mean(rest_);
  }

  std::vector<Association> run() {
    look(r_.velocity, "velocity", "the remaining force changes with the velocity");
    look(r_.acceleration, "acceleration", "the remaining force changes with the acceleration");
    look_at_position();
    look(r_.time_s, "time_s", "the remaining force changes with the time since the recording began");
    if (has(model_.kind, LocationType::drive))
      look(r_.input, columns_.input, "the remaining force changes with the input");
    look(r_.interval_s, "sample_interval_s", "the remaining force changes with the interval between rows");
    if (has(model_.kind, LocationType::leg)) {
      look(r_.since_touchdown_s, "time_since_touchdown_s",
           "in stance the remaining force changes with the time since touch-down");
      look(r_.since_liftoff_s, "time_since_liftoff_s",
           "in flight the remaining force changes with the time since lift-off");
      std::vector<double> compression(r_.position);
      const double touchdown_m = machines::touchdown_height_m(model_);
      for (std::size_t i = 0; i < compression.size(); ++i)
        compression[i] = std::isfinite(r_.since_touchdown_s[i]) ? touchdown_m - compression[i] : std::nan("");
      look(compression, "spring_compression_m",
           "in stance the remaining force changes with the compression of the spring");
    }
    look_for_frequency();
    std::stable_sort(found_.begin(), found_.end(),
                     [](const auto& a, const auto& b) { return a.strength > b.strength; });
    return std::move(found_);
  }

 private:
  void add(std::string_view signal, double share, const std::string& how) {
    if (share > kWeakest) found_.push_back({{}, std::string(signal), std::min(share, 1.0), how});
  }

  /// Where the signal is finite; the share is of the variance of all samples.
  void look(const std::vector<double>& signal, std::string_view name, const std::string& how) {
    std::vector<double> values, force;
    for (std::size_t i = 0; i < signal.size(); ++i)
      if (std::isfinite(signal[i])) {
        values.push_back(signal[i]);
        force.push_back(rest_[i]);
      }
    if (force.size() < 10 * kBins) return;
    const double total = squares_about_mean(force);
    add(name,
        explained(total, squares_within(values, force, kBins), force.size(), kBins) *
            std::min(total / total_, 1.0),
        how);
  }

  /// A place may act on one way only.
  void look_at_position() {
    std::vector<double> position[2], force[2];
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      const int up = r_.velocity[i] > 0.0 ? 1 : 0;
      position[up].push_back(r_.position[i]);
      force[up].push_back(rest_[i]);
    }
    const double both = squares_within(r_.position, rest_, kBins);
    const double each =
        squares_within(position[0], force[0], kBins) + squares_within(position[1], force[1], kBins);
    const double of_both = explained(total_, both, rest_.size(), kBins);
    const double ways = squares_about_mean(force[0]) + squares_about_mean(force[1]);
    const double of_each = explained(total_, each, rest_.size(), 2 * kBins) -
                           explained(total_, ways, rest_.size(), 2);  // what the way alone does not explain
    const bool differ = of_each > of_both + 0.5 * kWeakest && of_each > 1.25 * of_both;
    add(columns_.position, differ ? of_each : of_both,
        differ ? "the remaining force changes with the position, and not in the same way on the two ways"
               : "the remaining force changes with the position");
  }

  /// The share of `values` that a sinusoid explains, in each recording with amplitude and phase of its own.
  double sinusoid(const std::vector<double>& values, double frequency_hz) const {
    double total = 0.0, left = 0.0;
    for (std::size_t from = 0; from < values.size();) {
      std::size_t to = from;
      while (to < values.size() && r_.recording[to] == r_.recording[from]) ++to;
      const auto n = static_cast<Eigen::Index>(to - from);
      // Least squares of 1, cos, sin by their normal equations.
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      double squares = 0.0, sum = 0.0;
      for (std::size_t i = from; i < to; ++i) {
        const double angle = 2.0 * std::numbers::pi * frequency_hz * r_.time_s[i];
        const Eigen::Vector3d basis(1.0, std::cos(angle), std::sin(angle));
        normal += basis * basis.transpose();
        right += values[i] * basis;
        squares += values[i] * values[i];
        sum += values[i];
      }
      total += squares - sum * sum / static_cast<double>(n);
      left += squares - right.dot(linear::solve_symmetric(normal, right));
      from = to;
    }
    return total > 0.0 ? 1.0 - left / total : 0.0;
  }

  /// From three periods in the longest recording to a tenth of the samples' rate; not where the motion itself
  /// has that frequency.
  void look_for_frequency() {
    constexpr double kOfTheMotion = 0.02;
    constexpr int kFiner = 20;
    constexpr std::size_t kMostFrequencies = 1500;
    double longest_s = 0.0;
    for (double t : r_.time_s) longest_s = std::max(longest_s, t);
    if (rest_.size() < 10 * kBins || !(longest_s > 0.0)) return;
    std::vector<double> spacings;
    for (std::size_t i = 1; i < r_.time_s.size(); ++i)
      if (r_.recording[i] == r_.recording[i - 1]) spacings.push_back(r_.time_s[i] - r_.time_s[i - 1]);
    if (spacings.empty()) return;
    const double highest_hz = 0.1 / core::median(spacings);
    const double step_hz = 0.25 / longest_s;
    double best = 0.0, best_hz = 0.0;
    for (std::size_t i = 0; i < kMostFrequencies; ++i) {
      const double hz = 3.0 / longest_s + step_hz * static_cast<double>(i);
      if (hz > highest_hz) break;
      const double share = sinusoid(rest_, hz);
      if (share > best && sinusoid(r_.position, hz) < kOfTheMotion) {
        best = share;
        best_hz = hz;
      }
    }
    const double from_hz = best_hz - step_hz;
    for (int i = 1; best > kWeakest && i < 2 * kFiner; ++i) {
      const double hz = from_hz + step_hz * i / kFiner;
      if (const double share = sinusoid(rest_, hz); share > best) {
        best = share;
        best_hz = hz;
      }
    }
    add("frequency_hz", best, "the remaining force swings with " + number(best_hz) + " Hz");
  }

  const ResidualForce& r_;
  const model::Model& model_;
  const machines::Columns& columns_;
  std::vector<double> rest_;
  double total_ = 0.0;
  std::vector<Association> found_;
};

}  // namespace

std::vector<Association> associations(const ResidualForce& r, const model::Model& model) {
  if (r.force.size() < 10 * kBins) return {};
  return Associations(r, model).run();
}

}  // namespace furcula::diagnose
