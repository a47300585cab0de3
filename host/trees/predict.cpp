// Predictions of held-out windows, see diagnose.hpp.
#include <algorithm>
#include <cmath>

#include "host/linear/linear.hpp"
#include "host/trees/diagnose.hpp"

namespace furcula::trees {
namespace {

constexpr double kStart_s = 0.05;

struct Start {
  std::vector<double> angle_rad, velocity_radps;
};

/// Polynomial through (t, y): value and slope at 0, and the root mean square of what it leaves.
struct Line {
  double value, slope, left;
};
Line through(const std::vector<double>& t, const std::vector<double>& y, int order) {
  const auto n = static_cast<Eigen::Index>(t.size());
  Eigen::MatrixXd a(n, order + 1);
  for (Eigen::Index i = 0; i < n; ++i)
    for (int k = 0; k <= order; ++k) a(i, k) = std::pow(t[static_cast<std::size_t>(i)] / kStart_s, k);
  const Eigen::Map<const Eigen::VectorXd> b(y.data(), n);
  const Eigen::VectorXd c = linear::least_squares(a, Eigen::VectorXd(b));
  const double freedom = std::max(1.0, static_cast<double>(n - order - 1));
  return {c(0), c(1) / kStart_s, std::sqrt((b - a * c).squaredNorm() / freedom)};
}

Start start_of(const Recording& r, const Window& w, const Setup& setup) {
  const std::size_t n = setup.joints.size();
  std::size_t end = w.first;
  while (end < w.last && (r.time_s[end + 1] - r.time_s[w.first] <= kStart_s || end - w.first < 5)) ++end;
  std::vector<double> t;
  for (std::size_t k = w.first; k <= end; ++k) t.push_back(r.time_s[k] - r.time_s[w.first]);
  Start s{std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t j = 0; j < n; ++j) {
    const std::vector<double> y(r.angle_rad[j].begin() + static_cast<std::ptrdiff_t>(w.first),
                                r.angle_rad[j].begin() + static_cast<std::ptrdiff_t>(end + 1));
    const Line l = through(t, y, 2);
    s.angle_rad[j] = l.value;
    s.velocity_radps[j] = l.slope;
  }
  std::vector<double> out(t.size() * n);
  for (int round = 0; round < 2; ++round) {
    run(setup, r, w.first, end, s.angle_rad, s.velocity_radps, out);
    for (std::size_t j = 0; j < n; ++j) {
      std::vector<double> left;
      for (std::size_t k = 0; k < t.size(); ++k) left.push_back(r.angle_rad[j][w.first + k] - out[k * n + j]);
      Line l = through(t, left, 1);
      // A model that is wrong bends away within 50 ms already.
      if (l.left > 1.5 * r.angle_noise_rad[j] && t.size() > 6) l = through(t, left, 2);
      if (!std::isfinite(l.value + l.slope)) continue;
      s.angle_rad[j] += l.value;
      s.velocity_radps[j] += l.slope;
    }
  }
  return s;
}

}  // namespace

Predictions predict(const TreeModel& model, const std::vector<Recording>& recordings, double window_s,
                    const Hypothesis& h, std::vector<Trace>* traces, std::vector<double> Trace::*into) {
  const std::size_t n = model.joints();
  const SetupMaker maker(model);
  const Setup setup = maker.make(h);
  const std::vector<Window> windows = windows_of(model, recordings, window_s);
  Predictions out{std::vector<ChannelError>(n), std::vector<double>(n)};
  std::vector<double> squares(n), absolute(n), about_mean(n), noise(n);
  double rows = 0.0;
  for (const Window& w : windows) {
    const Recording& r = recordings[w.recording];
    const Start s = start_of(r, w, setup);
    const std::size_t count = w.last - w.first + 1;
    std::vector<double> predicted(count * n);
    run(setup, r, w.first, w.last, s.angle_rad, s.velocity_radps, predicted);
    rows += static_cast<double>(count);
    for (std::size_t j = 0; j < n; ++j) {
      double mean = 0.0;
      for (std::size_t k = 0; k < count; ++k)
        mean += r.angle_rad[j][w.first + k] / static_cast<double>(count);
      for (std::size_t k = 0; k < count; ++k) {
        const double error = std::min(1e3, std::abs(predicted[k * n + j] - r.angle_rad[j][w.first + k]));
        squares[j] += std::isfinite(error) ? error * error : 1e6;
        absolute[j] += std::isfinite(error) ? error : 1e3;
        about_mean[j] += std::pow(r.angle_rad[j][w.first + k] - mean, 2);
      }
      noise[j] += std::pow(r.angle_noise_rad[j], 2) * static_cast<double>(count);
    }
    if (traces == nullptr) continue;
    for (std::size_t j = 0; j < n; ++j) {
      const auto found = std::find_if(traces->begin(), traces->end(), [&](const Trace& t) {
        return t.log == r.path && t.channel == channel_name(model, j);
      });
      Trace& t =
          found != traces->end()
              ? *found
              : traces->emplace_back(Trace{
                    r.path, channel_name(model, j), std::string(channel_unit(model, j)), {}, {}, {}, {}, {}});
      for (std::size_t k = 0; k < count; ++k) {
        if (into == &Trace::as_given) {
          t.time_s.push_back(r.time_s[w.first + k]);
          t.measured.push_back(r.angle_rad[j][w.first + k]);
        }
        (t.*into).push_back(predicted[k * n + j]);
      }
    }
  }
  for (std::size_t j = 0; j < n && rows > 0.0; ++j) {
    out.errors[j] = {squares[j] / std::max(about_mean[j], 1e-300), absolute[j] / rows,
                     std::sqrt(squares[j] / rows)};
    out.floor[j] = noise[j] / std::max(about_mean[j], 1e-300);
  }
  return out;
}

}  // namespace furcula::trees
