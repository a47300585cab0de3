#include "host/diagnose/flexible_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/core/quantile.hpp"
#include "host/diagnose/bootstrap.hpp"
#include "host/linear/linear.hpp"

namespace furcula::diagnose {
namespace {

/// The functions that the flexible law is a sum of; each about one where it is largest.
class Basis {
 public:
  Basis(const std::vector<LinearRun>& all, bool driven, bool leg) : driven_(driven), leg_(leg) {
    std::vector<double> positions;
    double v2 = 0, a2 = 0, u2 = 0, du2 = 0, n = 0;
    for (const LinearRun& w : all)
      for (const RunSample& s : w.samples) {
        positions.push_back(s.position);
        v2 += s.velocity * s.velocity, a2 += s.acceleration * s.acceleration;
        u2 += s.input * s.input, du2 += s.input_rate * s.input_rate;
        longest_s_ = std::max(longest_s_, s.time_s);
        ++n;
      }
    const auto rms = [&](double squares) { return std::max(std::sqrt(squares / std::max(n, 1.0)), 1e-9); };
    v_ = rms(v2), a_ = rms(a2), u_ = rms(u2), du_ = rms(du2);
    low_ = core::quantile(positions, 0.002), high_ = core::quantile(positions, 0.998);
    RunSample any;
    size_ = 0;
    fill(any, nullptr);
  }
  Eigen::Index size() const { return size_; }
  void at(const RunSample& s, Eigen::VectorXd& out) const { fill(s, &out); }

 private:
  void fill(const RunSample& s, Eigen::VectorXd* out) const {
    Eigen::Index k = 0;
    const auto put = [&](double value) {
      if (out) (*out)(k) = value;
      ++k;
    };
    const double v = s.velocity / v_, way = v > 0 ? 1.0 : -1.0;
    put(way);
    put(v);
    put(v * std::abs(v));
    put(way * std::exp(-std::pow(v / 0.2, 2)));
    put(way * std::exp(-std::pow(v / 0.6, 2)));
    put(1.0);
    const double place = (s.position - low_) / std::max(high_ - low_, 1e-9);
    const auto hats = [&](int count, double sign) {
      for (int h = 0; h < count; ++h) put(sign * std::exp(-std::pow(place * count - (h + 0.5), 2)));
    };
    hats(16, 1.0);
    hats(10, way);
    put(s.acceleration / a_);
    put(s.time_s / std::max(longest_s_, 1e-9));
    put(way * s.time_s / std::max(longest_s_, 1e-9));
    if (driven_) {
      put(s.input / u_);
      put(std::abs(s.input) * way / u_);
      put(s.input_rate / du_);
      put(s.input_before / u_);
      put(s.input / u_ * (2 * place - 1));
    }
    if (!leg_)
      for (const double mean : s.remembered) put((s.position - mean) / std::max(high_ - low_, 1e-9));
    if (leg_) {
      const double stance = s.since_touchdown_s >= 0 ? 1.0 : 0.0;
      for (const double mean : s.remembered) put(stance * mean / std::max(high_ - low_, 1e-9));
      put(stance);
      put(stance * v);
      put(stance * way);
      for (const double since_s : {s.since_touchdown_s, s.since_liftoff_s})
        for (const double centre_s : {0.0, 0.005, 0.015, 0.035, 0.075, 0.15})
          put(since_s < 0 ? 0.0 : std::exp(-std::pow((since_s - centre_s) / (0.005 + 0.4 * centre_s), 2)));
    }
    if (!out) size_ = k;
  }

  bool driven_, leg_;
  double v_ = 1, a_ = 1, u_ = 1, du_ = 1, low_ = 0, high_ = 1, longest_s_ = 0;
  mutable Eigen::Index size_ = 0;
};

/// Normal equations of the flexible law to what is new in one window.
struct Normal {
  std::size_t recording = 0;
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double squares = 0;
  LagSums lags;  ///< of what is new
};

Normal normal_of(const LinearRun& w, const Disturbance& disturbance, const Basis& basis) {
  const Eigen::Index p = basis.size();
  Normal n{w.recording, Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 0, {}};
  DisturbanceFilter f(w, disturbance);
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(3, p + 1), response = Eigen::MatrixXd::Zero(2, p);
  Eigen::VectorXd at(p);
  Eigen::RowVectorXd seen(p + 1);
  constexpr Eigen::Index kBlock = 64;
  Eigen::MatrixXd block(kBlock, p);
  Eigen::VectorXd found(kBlock);
  Eigen::Index filled = 0;
  const auto flush = [&] {
    if (filled == 0) return;
    n.information.noalias() += block.topRows(filled).transpose() * block.topRows(filled);
    n.gradient.noalias() += block.topRows(filled).transpose() * found.head(filled);
    filled = 0;
  };
  std::vector<double> all_new;
  for (std::size_t i = 0; i < w.left.size(); ++i) {
    f.measure(w, disturbance);
    seen.head(p) = response.row(0) - state.row(0).head(p);
    seen(p) = w.left[i] - state(0, p);
    if (i >= kSettles) {
      block.row(filled) = seen.head(p) / f.deviation;
      found(filled) = seen(p) / f.deviation;
      n.squares += found(filled) * found(filled);
      all_new.push_back(found(filled));
      if (++filled == kBlock) flush();
    }
    if (i + 1 == w.left.size()) break;
    state.noalias() += f.gain * seen;
    f.predict(w, disturbance, i);
    state = (f.step * state).eval();
    basis.at(w.samples[i], at);
    response = (w.by[i] * response + w.force[i] * at.transpose()).eval();
  }
  flush();
  n.lags.add(all_new);
  return n;
}

std::vector<Normal> normals_of(const std::vector<LinearRun>& all, const Disturbance& disturbance,
                               const Basis& basis) {
  std::vector<Normal> out;
  for (const LinearRun& w : all) out.push_back(normal_of(w, disturbance, basis));
  return out;
}

double left_by(const Normal& n, const Eigen::VectorXd& c) {
  return n.squares - 2 * c.dot(n.gradient) + c.dot(Eigen::VectorXd(n.information * c));
}

/// Which part of the training windows each one lies in: recordings, or stretches of few.
std::vector<std::size_t> folds_of(const std::vector<Normal>& windows) {
  constexpr std::size_t kFewestRecordings = 3, kMostFolds = 6, kStretches = 4;
  std::size_t recordings = 0;
  for (const Normal& n : windows) recordings = std::max(recordings, n.recording + 1);
  std::vector<std::size_t> folds;
  for (std::size_t i = 0; i < windows.size(); ++i)
    folds.push_back(recordings >= kFewestRecordings ? windows[i].recording % std::min(recordings, kMostFolds)
                                                    : i * kStretches / windows.size());
  return folds;
}

/// The windows of each fold, added up.
std::vector<Normal> added_up(const std::vector<Normal>& windows, const std::vector<std::size_t>& folds) {
  const Eigen::Index p = windows.front().gradient.size();
  std::vector<Normal> sums(*std::max_element(folds.begin(), folds.end()) + 1,
                           {0, Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 0, {}});
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Normal& sum = sums[folds[i]];
    sum.information += windows[i].information;
    sum.gradient += windows[i].gradient;
    sum.squares += windows[i].squares;
  }
  return sums;
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

Eigen::VectorXd learned(const std::vector<Normal>& folds, double size, std::size_t without,
                        std::size_t and_without) {
  const Eigen::Index p = folds.front().gradient.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(p, p) / (size * size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(p);
  for (std::size_t i = 0; i < folds.size(); ++i)
    if (i != without && i != and_without) information += folds[i].information, gradient += folds[i].gradient;
  return linear::solve_symmetric(information, gradient);
}

/// How large its parts may be: what serves best on folds that are left out, of those that it may see.
Eigen::VectorXd learned(const std::vector<Normal>& folds, double typical_force, std::size_t without = kNone) {
  double best = std::numeric_limits<double>::infinity(), best_size = 0;
  for (const double share : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001}) {
    double left = 0;
    for (std::size_t fold = 0; fold < folds.size(); ++fold)
      if (fold != without) left += left_by(folds[fold], learned(folds, share * typical_force, fold, without));
    if (left < best) best = left, best_size = share;
  }
  return learned(folds, best_size * typical_force, without, kNone);
}

/// Squares of a free run with its best start: that it leaves without and with the flexible law, and of the law's part.
std::array<double, 3> squares_of_free_run(const LinearRun& w, const Basis& basis, const Eigen::VectorXd& c) {
  const auto rows = static_cast<Eigen::Index>(w.left.size());
  Eigen::MatrixXd start(rows, 2), sides(rows, 3);
  Eigen::Matrix2d by = Eigen::Matrix2d::Identity();
  Eigen::Vector2d response = Eigen::Vector2d::Zero();
  Eigen::VectorXd at(basis.size());
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto row = static_cast<std::size_t>(i);
    start.row(i) = by.row(0);
    sides.row(i) << w.left[row], w.left[row] - response(0), response(0);
    if (i + 1 == rows) break;
    basis.at(w.samples[row], at);
    by = (w.by[row] * by).eval();
    response = (w.by[row] * response + w.force[row] * c.dot(at)).eval();
  }
  const Eigen::MatrixXd rest = sides - start * linear::least_squares(start, sides);
  return {rest.col(0).squaredNorm(), rest.col(1).squaredNorm(), rest.col(2).squaredNorm()};
}

/// What flexible laws do on windows that they have not seen; `law(i)` is that for window i.
template <class Law>
Predictable predictable_of(const std::vector<LinearRun>& windows, const std::vector<Normal>& normals,
                           const Basis& basis, const Law& law) {
  std::vector<double> gains, gains_of_free_runs;
  double before = 0, after = 0, force = 0, rows = 0, parts = 0, positions = 0;
  Eigen::VectorXd at(basis.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const LinearRun& w = windows[i];
    const Eigen::VectorXd& c = law(i);
    gains.push_back(normals[i].squares - left_by(normals[i], c));
    const auto [without, with, part] = squares_of_free_run(w, basis, c);
    before += without, after += with;
    parts += part / (w.noise * w.noise), positions += static_cast<double>(w.left.size());
    gains_of_free_runs.push_back(without - with);
    for (const RunSample& s : w.samples) {
      basis.at(s, at);
      force += std::pow(c.dot(at), 2), ++rows;
    }
  }
  Predictable f;
  // The filter weighs best what is small; of free runs a window that it takes for another motion spoils less.
  f.deviations = std::max(in_standard_errors(gains), in_standard_errors(gains_of_free_runs));
  f.share = 1.0 - after / std::max(before, 1e-300);
  f.noises = std::sqrt(parts / std::max(positions, 1.0));
  f.force = std::sqrt(force / std::max(rows, 1.0));
  return f;
}

}  // namespace

PredictedByLaw predict_by_flexible_law(const std::vector<LinearRun>& training,
                                       const std::vector<LinearRun>& held_out, const Disturbance& disturbance,
                                       bool driven, bool leg, double typical_force) {
  PredictedByLaw out;
  const Basis basis(training, driven, leg);
  const std::vector<Normal> from = normals_of(training, disturbance, basis);
  const std::vector<std::size_t> fold = folds_of(from);
  const std::vector<Normal> folds = added_up(from, fold);
  std::vector<Eigen::VectorXd> without;
  for (std::size_t i = 0; i < folds.size(); ++i) without.push_back(learned(folds, typical_force, i));
  out.crossed = predictable_of(
      training, from, basis, [&](std::size_t i) -> const auto& { return without[fold[i]]; });
  if (held_out.empty()) return out;
  const std::vector<Normal> of = normals_of(held_out, disturbance, basis);
  const Eigen::VectorXd law = learned(folds, typical_force);
  out.predictable = predictable_of(
      held_out, of, basis, [&](std::size_t) -> const auto& { return law; });
  LagSums lags;
  for (const Normal& n : of) lags += n.lags;
  out.new_finds = ljung_box(lags);
  return out;
}

}  // namespace furcula::diagnose
