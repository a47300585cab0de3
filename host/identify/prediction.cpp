#include "host/identify/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/identify/dual.hpp"
#include "host/identify/simulate.hpp"
#include "host/machines/hopper.hpp"

namespace furcula::identify {
namespace {

/// `errors` and `measured` over the rows [first, last] of a window.
ErrorSums sums_of(const std::vector<double>& measured, std::size_t offset, const std::vector<double>& errors,
                  std::size_t first, std::size_t last) {
  ErrorSums s;
  if (last < first) return s;
  double mean = 0.0;
  const auto rows = static_cast<double>(last - first + 1);
  for (std::size_t i = first; i <= last; ++i) mean += measured[offset + i] / rows;
  for (std::size_t i = first; i <= last; ++i) {
    s.squares += errors[i] * errors[i];
    s.absolute += std::abs(errors[i]);
    s.spread += (measured[offset + i] - mean) * (measured[offset + i] - mean);
  }
  s.count = rows;
  return s;
}

std::optional<ChannelErrors> pooled(const std::vector<ErrorSums>& windows) {
  ErrorSums all;
  for (const ErrorSums& s : windows) all += s;
  if (all.count == 0.0) return std::nullopt;
  return all.errors();
}

/// Pools the errors of all windows; `position_error(window, row errors)` and the like fill a vector of one
/// entry a row.
template <class Fill>
Errors pool(const std::vector<Recording>& recordings, const std::vector<Window>& windows, const Fill& fill) {
  std::map<std::string, ErrorSums> sums;
  std::vector<double> position, velocity;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    const Recording& r = recordings[w.recording];
    position.assign(w.rows(), 0.0);
    velocity.assign(w.rows(), 0.0);
    fill(k, position, velocity);
    const std::string channel = channel_names(r.kind).position;
    sums[channel] += sums_of(r.position, w.first, position, 0, w.rows() - 1);
    if (dynamics::has(r.kind, dynamics::LocationType::leg) || r.velocity_recorded)
      sums["velocity"] += sums_of(r.velocity, w.first, velocity, 0, w.rows() - 1);
    if (w.kind == WindowKind::stride) {
      sums["height_stance"] +=
          sums_of(r.position, w.first, position, w.touchdown - w.first, w.liftoff - w.first - 1);
      sums["height_flight"] += sums_of(r.position, w.first, position, 0, w.touchdown - w.first - 1);
      sums["height_flight"] += sums_of(r.position, w.first, position, w.liftoff - w.first, w.rows() - 1);
    }
  }
  Errors errors;
  for (const auto& [channel, s] : sums) errors[channel] = s.errors();
  return errors;
}

}  // namespace

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) {
  squares += other.squares;
  absolute += other.absolute;
  spread += other.spread;
  count += other.count;
  return *this;
}

ChannelErrors ErrorSums::errors() const {
  if (count == 0.0) return {};
  return {spread > 0.0 ? squares / spread : 0.0, absolute / count, std::sqrt(squares / count)};
}

Run predict(const model::Model& model, const Recording& r, const Window& w, const StartState& start) {
  const PlantSetup<double> setup(model, {}, nullptr);
  Run run;
  run.position.reserve(w.rows());
  run.velocity.reserve(w.rows());
  simulate(setup, r, w, start.position, start.velocity,
           [&](std::size_t, double x, double v, double, const auto&) {
             run.position.push_back(x);
             run.velocity.push_back(v);
           });
  return run;
}

std::vector<StartState> start_states(const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows, const model::Model& reference) {
  std::vector<StartState> all;
  for (const Window& w : windows) all.push_back(start_state(recordings[w.recording], w, reference));
  return all;
}

Errors prediction_errors(const model::Model& model, const std::vector<Recording>& recordings,
                         const std::vector<Window>& windows, const std::vector<StartState>& starts) {
  return pool(recordings, windows,
              [&](std::size_t k, std::vector<double>& position, std::vector<double>& velocity) {
                const Window& w = windows[k];
                const Recording& r = recordings[w.recording];
                const Run run = predict(model, r, w, starts[k]);
                for (std::size_t i = 0; i < w.rows(); ++i) {
                  position[i] = run.position[i] - r.position[w.first + i];
                  velocity[i] = run.velocity[i] - r.velocity[w.first + i];
                }
              });
}

std::vector<ErrorSums> position_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                     const std::vector<Window>& windows,
                                     const std::vector<StartState>& starts) {
  std::vector<ErrorSums> all;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    const Recording& r = recordings[w.recording];
    std::vector<double> errors = predict(model, r, w, starts[k]).position;
    for (std::size_t i = 0; i < w.rows(); ++i) errors[i] -= r.position[w.first + i];
    all.push_back(sums_of(r.position, w.first, errors, 0, w.rows() - 1));
  }
  return all;
}

std::vector<ErrorSums> contact_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                    const std::vector<Window>& windows) {
  const PlantSetup<double> setup(model, {}, nullptr);
  std::vector<ErrorSums> all(windows.size());
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    if (!std::isfinite(w.report_lag_s)) continue;
    const double error =
        report_lag(setup, recordings[w.recording], w, machines::touchdown_height_m(model)) - w.report_lag_s;
    all[k] = {error * error, std::abs(error), 0.0, 1.0};
  }
  return all;
}

std::optional<ChannelErrors> contact_errors(const model::Model& model,
                                            const std::vector<Recording>& recordings,
                                            const std::vector<Window>& windows) {
  auto errors = pooled(contact_sums(model, recordings, windows));
  if (errors) errors->nmse = std::numeric_limits<double>::quiet_NaN();
  return errors;
}

std::vector<ErrorSums> drive_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                  const std::vector<Window>& windows) {
  const PlantSetup<double> setup(model, {}, nullptr);
  std::vector<ErrorSums> all(windows.size());
  std::vector<double> errors;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    const Recording& r = recordings[w.recording];
    if (r.drive.empty()) continue;
    errors.assign(w.rows(), 0.0);
    simulate(setup, r, w, r.position[w.first], r.velocity_smoothed[w.first],
             [&](std::size_t row, double, double, double drive, const auto&) {
               if (row < w.last) errors[row - w.first] = drive - r.drive[row];
             });
    all[k] = sums_of(r.drive, w.first, errors, 0, w.rows() - 2);
  }
  return all;
}

std::optional<ChannelErrors> drive_errors(const model::Model& model, const std::vector<Recording>& recordings,
                                          const std::vector<Window>& windows) {
  return pooled(drive_sums(model, recordings, windows));
}

std::vector<ErrorSums> leg_angle_sums(const model::Model& model, const std::vector<Recording>& recordings,
                                      const std::vector<Window>& windows,
                                      const std::vector<StartState>& starts) {
  const PlantSetup<double> setup(model, {}, nullptr);
  std::vector<ErrorSums> all(windows.size());
  std::vector<double> errors;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    const Recording& r = recordings[w.recording];
    if (r.leg_angle.empty()) continue;
    errors.clear();
    double mean = 0.0;
    simulate(setup, r, w, starts[k].position, starts[k].velocity,
             [&](std::size_t row, double, double, double, const auto& leg_angle) {
               errors.push_back(leg_angle() - r.leg_angle[row]);
               mean += errors.back() / static_cast<double>(w.rows());
             });
    for (double& e : errors) e -= mean;
    all[k] = sums_of(r.leg_angle, w.first, errors, 0, w.rows() - 1);
  }
  return all;
}

std::optional<ChannelErrors> leg_angle_errors(const model::Model& model,
                                              const std::vector<Recording>& recordings,
                                              const std::vector<Window>& windows,
                                              const std::vector<StartState>& starts) {
  return pooled(leg_angle_sums(model, recordings, windows, starts));
}

Errors noise_floor(const model::Model& model, const std::vector<Recording>& recordings,
                   const std::vector<Window>& windows, const std::vector<StartState>& starts) {
  const PlantSetup<Dual<2>> setup(model, {}, nullptr);
  Errors floor = pool(
      recordings, windows, [&](std::size_t k, std::vector<double>& position, std::vector<double>& velocity) {
        const Window& w = windows[k];
        const Recording& r = recordings[w.recording];
        const StartState& s = starts[k];
        const double noise = r.position_noise * r.position_noise;
        const auto spread = [&](const Dual<2>& x) {
          const double by_position = x.derivative(0), by_velocity = x.derivative(1);
          return noise * (by_position * by_position * s.position_variance +
                          2.0 * by_position * by_velocity * s.covariance +
                          by_velocity * by_velocity * s.velocity_variance);
        };
        simulate(setup, r, w, Dual<2>(s.position, 0), Dual<2>(s.velocity, 1),
                 [&](std::size_t row, const Dual<2>& x, const Dual<2>& v, const Dual<2>&, const auto&) {
                   position[row - w.first] = std::sqrt(noise + spread(x));
                   velocity[row - w.first] = std::sqrt(r.velocity_noise * r.velocity_noise + spread(v));
                 });
      });
  for (auto& [channel, e] : floor) e.mae = 0.0;
  return floor;
}

}  // namespace furcula::identify
