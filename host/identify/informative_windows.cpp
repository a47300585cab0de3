#include "host/identify/informative_windows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/quantile.hpp"
#include "host/identify/simulation_fit.hpp"

namespace furcula::identify {
namespace {

std::size_t rows_of(const std::vector<Window>& windows) {
  std::size_t rows = 0;
  for (const Window& w : windows) rows += w.rows();
  return rows;
}

/// Which of `count`, so many and evenly.
std::vector<std::size_t> even_places(std::size_t count, std::size_t most) {
  std::vector<std::size_t> places;
  most = std::min(most, count);
  // The middle of each of `most` equal stretches: neither end of a recording is preferred.
  for (std::size_t i = 0; i < most; ++i) places.push_back((2 * i + 1) * count / (2 * most));
  return places;
}

/// Takes windows until the room is used up.
class Choice {
 public:
  Choice(const std::vector<Window>& all, std::size_t most_rows)
      : all_(all), taken_(all.size(), 0), most_rows_(most_rows) {}

  /// False where there is no room for it.
  bool take(std::size_t i, std::size_t most_rows) {
    if (taken_[i]) return true;
    if (count_ >= kFewestChosen && rows_ + all_[i].rows() > std::min(most_rows, most_rows_)) return false;
    taken_[i] = 1;
    rows_ += all_[i].rows();
    ++count_;
    return true;
  }
  bool has(std::size_t i) const { return taken_[i] != 0; }
  std::vector<Window> windows() const {
    std::vector<Window> chosen;
    for (std::size_t i = 0; i < all_.size(); ++i)
      if (taken_[i]) chosen.push_back(all_[i]);
    return chosen;
  }

 private:
  const std::vector<Window>& all_;
  std::vector<char> taken_;
  std::size_t most_rows_, rows_ = 0, count_ = 0;
};

/// What a force may hang on, in some rows of each window, each in units of its root mean square over all of them: what is seldom large
/// then counts where it is.
class Regressors {
 public:
  static constexpr Eigen::Index kPlaces = 12, kWays = 8, kCount = 14 + kPlaces + kWays;

  Regressors(const std::vector<Recording>& recordings, const std::vector<Window>& windows) {
    constexpr std::size_t kMostRows = 12, kFewestRows = 2, kMostInAll = 60'000;
    per_window_ = std::clamp(kMostInAll / windows.size(), kFewestRows, kMostRows);
    Scales s = scales_of(recordings, windows);
    rows_.resize(static_cast<Eigen::Index>(windows.size() * per_window_), kCount);
    for (std::size_t i = 0; i < windows.size(); ++i)
      for (std::size_t k = 0; k < per_window_; ++k)
        rows_.row(static_cast<Eigen::Index>(i * per_window_ + k)) =
            at(recordings[windows[i].recording], row_of(windows[i], k), s);
    for (Eigen::Index c = 0; c < kCount; ++c) {
      const double rms = std::sqrt(rows_.col(c).squaredNorm() / static_cast<double>(rows_.rows()));
      if (rms > 0.0) rows_.col(c) /= rms;
    }
  }

  auto of(std::size_t window) const {
    return rows_.middleRows(static_cast<Eigen::Index>(window * per_window_),
                            static_cast<Eigen::Index>(per_window_));
  }

 private:
  struct Scales {
    double speed = 1.0, acceleration = 1.0, input = 1.0, top_input = 1.0, low = 0.0, high = 1.0,
           longest_s = 1.0;
  };

  std::size_t row_of(const Window& w, std::size_t k) const {
    return w.first + (2 * k + 1) * (w.rows() - 1) / (2 * per_window_);
  }

  static double acceleration(const Recording& r, std::size_t row) {
    const std::size_t before = row > 0 ? row - 1 : row, after = std::min(row + 1, r.rows() - 1);
    return (r.velocity_smoothed[after] - r.velocity_smoothed[before]) / (r.time_s[after] - r.time_s[before]);
  }

  Scales scales_of(const std::vector<Recording>& recordings, const std::vector<Window>& windows) const {
    Scales s;
    std::vector<double> positions, inputs;
    double speed = 0.0, acceleration_squares = 0.0, input = 0.0;
    for (const Window& w : windows)
      for (std::size_t k = 0; k < per_window_; ++k) {
        const Recording& r = recordings[w.recording];
        const std::size_t row = row_of(w, k);
        positions.push_back(r.position[row]);
        inputs.push_back(std::abs(r.input[row]));
        speed += r.velocity_smoothed[row] * r.velocity_smoothed[row];
        acceleration_squares += std::pow(acceleration(r, row), 2);
        input += r.input[row] * r.input[row];
        s.longest_s = std::max(s.longest_s, r.time_s[row] - r.time_s.front());
      }
    const auto rms = [&](double squares) {
      return squares > 0.0 ? std::sqrt(squares / static_cast<double>(positions.size())) : 1.0;
    };
    s.speed = rms(speed), s.acceleration = rms(acceleration_squares), s.input = rms(input);
    s.top_input = std::max(core::quantile(std::move(inputs), 0.9), 1e-9 * s.input);
    const auto [low, high] = std::minmax_element(positions.begin(), positions.end());
    s.low = *low, s.high = *high;
    return s;
  }

  static Eigen::Matrix<double, 1, kCount> at(const Recording& r, std::size_t row, const Scales& s) {
    Eigen::Matrix<double, 1, kCount> out = Eigen::Matrix<double, 1, kCount>::Zero();
    Eigen::Index i = 0;
    const double v = r.velocity_smoothed[row] / s.speed, way = v > 0.0 ? 1.0 : -1.0;
    const double u = r.input[row] / s.input, t = (r.time_s[row] - r.time_s.front()) / s.longest_s;
    const double place = std::clamp((r.position[row] - s.low) / std::max(s.high - s.low, 1e-12), 0.0, 1.0);
    out(i++) = 1.0;
    out(i++) = way;
    out(i++) = v;
    out(i++) = v * std::abs(v);
    out(i++) = way * std::exp(-std::pow(v / 0.2, 2));
    out(i++) = acceleration(r, row) / s.acceleration;
    out(i++) = u;
    out(i++) = std::abs(u) * way;
    out(i++) = std::copysign(std::max(std::abs(r.input[row]) / s.top_input - 1.0, 0.0),
                             u);  // what a limit would cut off
    out(i++) = t;
    out(i++) = t * t;
    out(i++) = way * t;
    out(i++) = u * t;
    out(i++) = r.solenoid.empty() ? 0.0 : r.solenoid[row];
    const auto hats = [&](Eigen::Index count, double sign) {
      for (Eigen::Index h = 0; h < count; ++h)
        out(i++) = sign * std::exp(-std::pow(
                              place * static_cast<double>(count) - (static_cast<double>(h) + 0.5), 2));
    };
    hats(kPlaces, 1.0);
    hats(kWays, way);
    return out;
  }

  std::size_t per_window_ = 1;
  Eigen::MatrixXd rows_;
};

/// Adds windows one by one, each the one that adds most to the logarithm of the information's determinant. That gain only falls as others
/// are added, so a window whose gain of before is below the best one's of now need not be looked at again.
void add_telling(Choice& choice, const std::vector<Recording>& recordings, const std::vector<Window>& all,
                 std::size_t most_rows) {
  constexpr Eigen::Index n = Regressors::kCount;
  const Regressors regressors(recordings, all);
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(n, n);
  const auto add = [&](std::size_t i) {
    const auto rows = regressors.of(i);
    information.noalias() += rows.transpose() * rows;
  };
  for (std::size_t i = 0; i < all.size(); ++i)
    if (choice.has(i)) add(i);
  Eigen::LLT<Eigen::MatrixXd> factor(information);
  const auto gain = [&](std::size_t i) {
    const Eigen::MatrixXd half = factor.matrixL().solve(regressors.of(i).transpose());
    Eigen::MatrixXd inner = half.transpose() * half;
    inner.diagonal().array() += 1.0;
    return 2.0 * Eigen::LLT<Eigen::MatrixXd>(inner).matrixLLT().diagonal().array().log().sum();
  };
  struct Candidate {
    double gain;
    std::size_t index, of_round;
    bool operator<(const Candidate& o) const { return gain != o.gain ? gain < o.gain : index > o.index; }
  };
  std::priority_queue<Candidate> queue;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!choice.has(i)) queue.push({gain(i), i, 0});
  for (std::size_t round = 0; !queue.empty();) {
    const Candidate best = queue.top();
    queue.pop();
    if (best.of_round != round) {
      queue.push({gain(best.index), best.index, round});
      continue;
    }
    if (!choice.take(best.index, most_rows)) return;
    add(best.index);
    factor.compute(information);
    ++round;
  }
}

/// Squares a row that the model leaves of each window, re-fitted on `pilot`.
std::vector<double> misfits(const model::Model& model, const std::vector<Recording>& recordings,
                            const std::vector<Window>& pilot, const std::vector<Window>& all) {
  model::Model refitted = model;
  try {
    const std::vector<Unknown> unknowns = free_unknowns(model);
    const Fit fit = fit_by_simulation(model, unknowns, values_in(model, unknowns), recordings, pilot);
    refitted = with_values(model, unknowns, fit.values);
  } catch (const core::DataError&) {  // the model as given then
  }
  const Fit look = look_by_simulation(refitted, {}, {}, recordings, all, Starting::linear);
  std::vector<double> each;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double squares = look.shares[i].squares / static_cast<double>(all[i].rows());
    each.push_back(std::isfinite(squares) ? squares : 0.0);  // it runs away from there: not for a fit
  }
  return each;
}

}  // namespace

std::vector<Window> evenly(const std::vector<Window>& windows, std::size_t most_rows, std::size_t fewest) {
  const std::size_t rows = rows_of(windows);
  if (rows <= most_rows) return windows;
  const std::size_t most = std::max(fewest, windows.size() * most_rows / rows);
  std::vector<Window> some;
  for (const std::size_t i : even_places(windows.size(), most)) some.push_back(windows[i]);
  return some;
}

TrainingWindows informative_windows(const std::vector<Recording>& recordings, const model::Model& model,
                                    TrainingWindows all, std::size_t most_rows) {
  const std::vector<Window>& windows = all.windows;
  const std::size_t rows = rows_of(windows);
  if (rows <= most_rows || all.layers > 1 || windows.size() <= kFewestChosen) return all;
  Choice choice(windows, most_rows);
  const std::size_t even_rows = most_rows / 2;
  const std::size_t of_half = std::max(kFewestChosen / 2, windows.size() * even_rows / rows);
  for (const std::size_t i : even_places(windows.size(), of_half)) choice.take(i, even_rows);
  std::vector<char> seen(recordings.size(), 0);
  for (const Window& w : choice.windows()) seen[w.recording] = 1;
  for (std::size_t i = 0; i < windows.size(); ++i)
    if (!seen[windows[i].recording]) seen[windows[i].recording] = choice.take(i, most_rows);
  const std::vector<double> misfit = misfits(model, recordings, choice.windows(), windows);
  std::vector<std::size_t> worst(windows.size());
  std::iota(worst.begin(), worst.end(), std::size_t{0});
  std::stable_sort(worst.begin(), worst.end(),
                   [&](std::size_t a, std::size_t b) { return misfit[a] > misfit[b]; });
  for (const std::size_t i : worst)
    if (!choice.take(i, even_rows + most_rows / 6)) break;
  add_telling(choice, recordings, windows, most_rows);
  return {choice.windows(), 1};
}

}  // namespace furcula::identify
