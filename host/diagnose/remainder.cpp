// See remainder.hpp.
#include "host/diagnose/remainder.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "host/core/quantile.hpp"
#include "host/diagnose/bootstrap.hpp"
#include "host/identify/dual.hpp"
#include "host/identify/simulate.hpp"
#include "host/identify/unknowns.hpp"
#include "host/linear/linear.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using identify::Dual;
using identify::Recording;
using identify::Window;

/// What the flexible law may hang on, in one row of a free run.
struct Sample {
  double position = 0, velocity = 0, acceleration = 0, input = 0, input_rate = 0, input_before = 0,
         time_s = 0;
  double since_touchdown_s = -1, since_liftoff_s = -1;  ///< below 0: not since then
  std::array<double, 3> remembered{};                   ///< see remembered()
};

/// What a machine remembers of its positions, of a hopper of its leg's compression: means over the past, which is forgotten with these time
/// constants. A spring that creeps hangs on that.
constexpr std::array<double, 3> kMemory_s{0.05, 0.2, 0.8};
std::vector<std::array<double, 3>> remembered(const model::Model& model, const Recording& r) {
  const bool leg = dynamics::has(model.kind, dynamics::LocationType::leg);
  const double straight_m = leg ? machines::touchdown_height_m(model) : 0.0;
  std::vector<std::array<double, 3>> out(r.rows());
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double seen =
        leg ? std::max(0.0, r.touchdown_height_m(i, straight_m) - r.position[i]) : r.position[i];
    for (std::size_t k = 0; k < kMemory_s.size(); ++k) {
      const double kept = i > 0 ? std::exp(-(r.time_s[i] - r.time_s[i - 1]) / kMemory_s[k]) : 0.0;
      out[i][k] = i > 0 ? kept * out[i - 1][k] + (1.0 - kept) * seen : leg ? 0.0 : seen;
    }
  }
  return out;
}

/// A free run over a window, and what small changes do to it: state i + 1 is by[i] times state i and force[i] times a force in between.
struct Linear {
  std::size_t recording = 0;
  double interval_s = 0, noise = 0;
  std::vector<double> left;  ///< measured less run
  std::vector<Eigen::Matrix2d> by;
  std::vector<Eigen::Vector2d> force;
  std::vector<double> impact_speed;  ///< between row i and the next; 0: none
  std::vector<Sample> samples;
};

struct Cumulative {
  Eigen::Matrix2d start;
  Eigen::Vector2d force;
  double position, velocity;
};

std::vector<Cumulative> run(const model::Model& model, const Recording& r, const Window& w, double position,
                            double velocity) {
  const auto unknowns = identify::effect_unknowns(Effect::force_offset, model.kind);
  const auto on = model.effects.find(Effect::force_offset);
  const Dual<4> constant(on == model.effects.end() ? 0.0 : on->second[0], 0);
  const identify::PlantSetup<Dual<4>> setup(model, unknowns, &constant);
  std::vector<Cumulative> all;
  all.reserve(w.rows());
  identify::simulate(setup, r, w, Dual<4>(position, 1), Dual<4>(velocity, 2),
                     [&](std::size_t, const Dual<4>& x, const Dual<4>& v, const Dual<4>&, const auto&) {
                       Cumulative c;
                       c.start << x.derivative(1), x.derivative(2), v.derivative(1), v.derivative(2);
                       c.force << x.derivative(0), v.derivative(0);
                       c.position = x.a;
                       c.velocity = v.a;
                       all.push_back(c);
                     });
  return all;
}

/// Up to where it is stuck: from there on its start does not matter any more.
std::size_t free_rows(const std::vector<Cumulative>& run) {
  constexpr double kStuck = 1e-4;
  std::size_t rows = 0;
  while (rows < run.size() && std::isfinite(run[rows].position) &&
         std::abs(run[rows].start.determinant()) > kStuck)
    ++rows;
  return rows;
}

std::optional<Linear> linearised(const model::Model& model, const Recording& r, const Window& w,
                                 const std::vector<std::array<double, 3>>* memory = nullptr) {
  constexpr std::size_t kFewestFreeRows = 20;
  constexpr double kBefore_s = 0.01;
  auto start = identify::start_state(r, w, model);
  std::vector<Cumulative> c;
  std::size_t rows = 0;
  for (int round = 0;; ++round) {
    c = run(model, r, w, start.position, start.velocity);
    rows = free_rows(c);
    if (rows < kFewestFreeRows) return std::nullopt;
    if (round == 2) break;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < rows; ++i) {
      const Eigen::Vector2d row = c[i].start.row(0).transpose();
      normal += row * row.transpose();
      right += row * (r.position[w.first + i] - c[i].position);
    }
    const Eigen::Vector2d step = normal.completeOrthogonalDecomposition().solve(right);
    start.position += step(0);
    start.velocity += step(1);
  }
  Linear out;
  out.recording = w.recording;
  out.noise = r.position_noise;
  out.interval_s = (r.time_s[w.first + rows - 1] - r.time_s[w.first]) / static_cast<double>(rows - 1);
  std::size_t before = w.first;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row = w.first + i;
    out.left.push_back(r.position[row] - c[i].position);
    if (i + 1 == rows) break;
    const double dt = r.time_s[row + 1] - r.time_s[row];
    const Eigen::Matrix2d by = c[i + 1].start * c[i].start.inverse();
    out.by.push_back(by);
    out.force.push_back(c[i + 1].force - by * c[i].force);
    const bool stride = w.kind == identify::WindowKind::stride;
    const bool impact = stride && (row + 1 == w.touchdown || row + 1 == w.liftoff);
    out.impact_speed.push_back(impact ? std::abs(c[i].velocity) : 0.0);
    Sample s;
    s.position = c[i].position;
    s.velocity = c[i].velocity;
    s.acceleration = (c[i + 1].velocity - c[i].velocity) / dt;
    s.input = r.input[row];
    s.input_rate = (r.input[row + 1] - r.input[row]) / dt;
    while (before < row && r.time_s[before + 1] <= r.time_s[row] - kBefore_s) ++before;
    s.input_before = r.input[before] - r.input[row];
    s.time_s = r.time_s[row] - r.time_s.front();
    if (memory != nullptr) s.remembered = (*memory)[row];
    if (stride && row >= w.touchdown && row < w.liftoff)
      s.since_touchdown_s = r.time_s[row] - r.time_s[w.touchdown];
    if (stride && row >= w.liftoff) s.since_liftoff_s = r.time_s[row] - r.time_s[w.liftoff];
    out.samples.push_back(s);
  }
  return out;
}

std::vector<Linear> linearised(const model::Model& model, const std::vector<Recording>& recordings,
                               const std::vector<Window>& windows) {
  std::vector<Linear> all;
  std::map<std::size_t, std::vector<std::array<double, 3>>> memory;
  for (const Window& w : windows) {
    const Recording& r = recordings[w.recording];
    const auto own = memory.try_emplace(w.recording);
    if (own.second) own.first->second = remembered(model, r);
    if (auto one = linearised(model, r, w, &own.first->second)) all.push_back(std::move(*one));
  }
  return all;
}

/// The functions that the flexible law is a sum of; each about one where it is largest.
class Basis {
 public:
  Basis(const std::vector<Linear>& all, bool driven, bool leg) : driven_(driven), leg_(leg) {
    std::vector<double> positions;
    double v2 = 0, a2 = 0, u2 = 0, du2 = 0, n = 0;
    for (const Linear& w : all)
      for (const Sample& s : w.samples) {
        positions.push_back(s.position);
        v2 += s.velocity * s.velocity, a2 += s.acceleration * s.acceleration;
        u2 += s.input * s.input, du2 += s.input_rate * s.input_rate;
        longest_s_ = std::max(longest_s_, s.time_s);
        ++n;
      }
    const auto rms = [&](double squares) { return std::max(std::sqrt(squares / std::max(n, 1.0)), 1e-9); };
    v_ = rms(v2), a_ = rms(a2), u_ = rms(u2), du_ = rms(du2);
    low_ = core::quantile(positions, 0.002), high_ = core::quantile(positions, 0.998);
    Sample any;
    size_ = 0;
    fill(any, nullptr);
  }
  Eigen::Index size() const { return size_; }
  void at(const Sample& s, Eigen::VectorXd& out) const { fill(s, &out); }

 private:
  void fill(const Sample& s, Eigen::VectorXd* out) const {
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

struct Sizes {
  double force = 0, correlation_s = 0.02, impact = 0, noise = 1;  ///< noise: of the recording's
};

/// Kalman filter of (position, velocity, random force). Calls visit(row, gain, deviation of what is new) before each step.
struct Filter {
  Eigen::Matrix3d step = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gain;
  double deviation = 0;

  Filter(const Linear& w, const Sizes& sizes) {
    spread(0, 0) = std::pow(1e3 * w.noise, 2);
    spread(1, 1) = std::pow(1e3 * w.noise / (10 * w.interval_s), 2);
    spread(2, 2) = sizes.force * sizes.force;
  }
  void measure(const Linear& w, const Sizes& sizes) {
    const double variance = spread(0, 0) + std::pow(sizes.noise * w.noise, 2);
    deviation = std::sqrt(variance);
    gain = spread.col(0) / variance;
    spread -= gain * spread.row(0).eval();
  }
  void predict(const Linear& w, const Sizes& sizes, std::size_t i) {
    const double kept = std::exp(-w.interval_s / sizes.correlation_s);
    step.topLeftCorner<2, 2>() = w.by[i];
    step.topRightCorner<2, 1>() = w.force[i];
    step(2, 2) = kept;
    spread = (step * spread * step.transpose()).eval();
    spread(2, 2) += sizes.force * sizes.force * (1 - kept * kept);
    spread(1, 1) += std::pow(sizes.impact * w.impact_speed[i], 2);
  }
};

constexpr std::size_t kFewestWindows = 4;
constexpr std::size_t kSettles = 4;  // rows in which the filter learns its start

/// Minus twice the logarithm of the likelihood of a window's first rows, but for a constant.
double surprise(const Linear& w, const Sizes& sizes, std::size_t rows) {
  double sum = 0;
  Filter f(w, sizes);
  Eigen::Vector3d state = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rows; ++i) {
    f.measure(w, sizes);
    const double is_new = w.left[i] - state(0);
    if (i >= kSettles) sum += 2 * std::log(f.deviation) + is_new * is_new / (f.deviation * f.deviation);
    if (i + 1 == rows) break;
    state += f.gain * is_new;
    f.predict(w, sizes, i);
    state = (f.step * state).eval();
  }
  return sum;
}

double surprise(const std::vector<Linear>& all, const Sizes& sizes) {
  double sum = 0;
  for (const Linear& w : all) sum += surprise(w, sizes, w.left.size());
  return sum;
}

/// Under which the windows are likeliest; of many, some that lie evenly.
Sizes likeliest(const std::vector<Linear>& of, double typical_force) {
  constexpr std::size_t kMostWindows = 60;
  std::vector<Linear> all;
  const std::size_t every = (of.size() + kMostWindows - 1) / kMostWindows;
  for (std::size_t i = 0; i < of.size(); i += every) all.push_back(of[i]);
  Sizes best;
  double least = surprise(all, best);
  const auto try_it = [&](const Sizes& s) {
    const double value = surprise(all, s);
    if (value < least) least = value, best = s;
  };
  const bool impacts = std::any_of(all.begin(), all.end(), [](const Linear& w) {
    return std::any_of(w.impact_speed.begin(), w.impact_speed.end(), [](double v) { return v > 0; });
  });
  for (int round = 0; round < 2; ++round) {
    const Sizes from = best;
    for (const double correlation_s : {0.003, 0.01, 0.03, 0.1, 0.3})
      for (double share = 1e-4; share < 0.5; share *= round == 0 ? 2.5 : 1.6) {
        Sizes s = from;
        s.correlation_s = correlation_s;
        s.force = share * typical_force;
        try_it(s);
      }
    if (impacts)
      for (const double impact : {0.0, 0.002, 0.004, 0.008, 0.015, 0.03, 0.06}) {
        Sizes s = best;
        s.impact = impact;
        try_it(s);
      }
    for (const double noise : {0.5, 0.7, 1.0, 1.4, 2.0}) {
      Sizes s = best;
      s.noise = noise;
      try_it(s);
    }
  }
  return best;
}

/// Normal equations of the flexible law to what is new in one window.
struct Normal {
  std::size_t recording = 0;
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double squares = 0;
  LagSums lags;  ///< of what is new
};

Normal normal_of(const Linear& w, const Sizes& sizes, const Basis& basis) {
  const Eigen::Index p = basis.size();
  Normal n{w.recording, Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 0, {}};
  Filter f(w, sizes);
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
    f.measure(w, sizes);
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
    f.predict(w, sizes, i);
    state = (f.step * state).eval();
    basis.at(w.samples[i], at);
    response = (w.by[i] * response + w.force[i] * at.transpose()).eval();
  }
  flush();
  n.lags.add(all_new);
  return n;
}

std::vector<Normal> normals_of(const std::vector<Linear>& all, const Sizes& sizes, const Basis& basis) {
  std::vector<Normal> out;
  for (const Linear& w : all) out.push_back(normal_of(w, sizes, basis));
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
std::array<double, 3> squares_of_free_run(const Linear& w, const Basis& basis, const Eigen::VectorXd& c) {
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

/// The weight, or the input's root mean square; of what is thrown, what gives it its acceleration.
std::pair<double, const char*> typical_force(const model::Model& model, const std::vector<Linear>& windows) {
  if (const auto weight = machines::rules(model.kind).weight) return {weight(model), "the weight"};
  double inputs = 0, forces = 0, rows = 0;
  for (const Linear& w : windows)
    for (const Sample& s : w.samples) {
      inputs += s.input * s.input;
      forces += std::pow(machines::rules(model.kind).inertia(model) * s.acceleration, 2);
      ++rows;
    }
  if (inputs > 0) return {std::sqrt(inputs / rows), "the input's root mean square"};
  return {std::sqrt(forces / std::max(rows, 1.0)), "the usual inertia force"};
}

}  // namespace

bool Predictable::counts(double typical_force) const {
  constexpr double kSure = 3.0, kCounts = 0.01, kShare = 0.02, kNoises = 0.5;
  return noises > kNoises && deviations > kSure && force > kCounts * typical_force && share > kShare;
}

namespace {

constexpr double kMostRandom = 0.04;  // of the typical force

/// What flexible laws do on windows that they have not seen; `law(i)` is that for window i.
template <class Law>
Predictable predictable_of(const std::vector<Linear>& windows, const std::vector<Normal>& normals,
                           const Basis& basis, const Law& law) {
  std::vector<double> gains, gains_of_free_runs;
  double before = 0, after = 0, force = 0, rows = 0, parts = 0, positions = 0;
  Eigen::VectorXd at(basis.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Linear& w = windows[i];
    const Eigen::VectorXd& c = law(i);
    gains.push_back(normals[i].squares - left_by(normals[i], c));
    const auto [without, with, part] = squares_of_free_run(w, basis, c);
    before += without, after += with;
    parts += part / (w.noise * w.noise), positions += static_cast<double>(w.left.size());
    gains_of_free_runs.push_back(without - with);
    for (const Sample& s : w.samples) {
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

bool Remainder::repeats() const { return largest_random_force() <= kMostRandom * typical_force; }

bool Remainder::repeats_in_training() const { return random_force <= kMostRandom * typical_force; }

std::optional<Remainder> remainder_of(const model::Model& fitted, const std::vector<Recording>& training,
                                      const std::vector<Window>& training_windows,
                                      const std::vector<Recording>& held_out,
                                      const std::vector<Window>& held_out_windows) {
  if (!dynamics::applies(Effect::force_offset, fitted.kind)) return std::nullopt;
  const std::vector<Linear> fit = linearised(fitted, training, training_windows),
                            judge = linearised(fitted, held_out, held_out_windows);
  const bool judged = !held_out_windows.empty();
  if (fit.size() < 4 || (judged && judge.size() < 2)) return std::nullopt;
  Remainder out;
  out.unit = dynamics::info(fitted.kind).rotary ? "N m" : "N";
  std::tie(out.typical_force, out.typical_is) = typical_force(fitted, fit);
  const bool driven = std::any_of(training.begin(), training.end(), [](const Recording& r) {
    return std::any_of(r.input.begin(), r.input.end(), [](double u) { return u != 0; });
  });
  const Basis basis(fit, driven, dynamics::has(fitted.kind, dynamics::LocationType::leg));
  const Sizes sizes = likeliest(fit, out.typical_force);
  out.random_force = sizes.force;
  out.correlation_s = sizes.correlation_s;
  out.impact_scatter = sizes.impact;
  const std::vector<Normal> from = normals_of(fit, sizes, basis);
  const std::vector<std::size_t> fold = folds_of(from);
  const std::vector<Normal> folds = added_up(from, fold);
  std::vector<Eigen::VectorXd> without;
  for (std::size_t i = 0; i < folds.size(); ++i) without.push_back(learned(folds, out.typical_force, i));
  out.crossed = predictable_of(
      fit, from, basis, [&](std::size_t i) -> const auto& { return without[fold[i]]; });
  if (!judged) return out;
  out.random_force_held_out = likeliest(judge, out.typical_force).force;
  const std::vector<Normal> of = normals_of(judge, sizes, basis);
  const Eigen::VectorXd law = learned(folds, out.typical_force);
  out.predictable = predictable_of(
      judge, of, basis, [&](std::size_t) -> const auto& { return law; });
  LagSums lags;
  for (const Normal& n : of) lags += n.lags;
  out.new_finds = ljung_box(lags);
  return out;
}

std::optional<std::vector<identify::Whitening>> whitening_about(const model::Model& likely,
                                                                const std::vector<Recording>& recordings,
                                                                const std::vector<Window>& windows) {
  if (!dynamics::applies(Effect::force_offset, likely.kind)) return std::nullopt;
  std::vector<identify::Whitening> out(windows.size());
  std::vector<std::optional<Linear>> of;
  std::vector<Linear> all;
  for (const Window& w : windows) {
    of.push_back(linearised(likely, recordings[w.recording], w));
    if (of.back()) all.push_back(*of.back());
  }
  if (all.size() < kFewestWindows) return std::nullopt;
  const Sizes sizes = likeliest(all, typical_force(likely, all).first);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (!of[k]) continue;
    const Linear& w = *of[k];
    Filter f(w, sizes);
    f.spread.topLeftCorner<2, 2>().setZero();  // the start is sought
    for (std::size_t i = 0; i < w.left.size(); ++i) {
      f.measure(w, sizes);
      const double scale = w.noise / f.deviation;
      if (i + 1 < w.left.size()) {
        const Eigen::Vector3d gain = f.gain;
        f.predict(w, sizes, i);
        out[k].rows.push_back({gain, scale, f.step});
      } else
        out[k].rows.push_back({f.gain, scale, Eigen::Matrix3d::Zero()});
    }
  }
  return out;
}

EvidenceFor evidence_under_disturbances(const model::Model& likely, const std::vector<Recording>& recordings,
                                        const std::vector<Window>& windows) {
  if (!dynamics::applies(Effect::force_offset, likely.kind)) return {};
  std::vector<Linear> all;
  std::vector<Window> of;
  for (const Window& w : windows)
    if (auto one = linearised(likely, recordings[w.recording], w)) {
      all.push_back(std::move(*one));
      of.push_back(w);
    }
  if (all.size() < kFewestWindows) return {};
  const Sizes sizes = likeliest(all, typical_force(likely, all).first);
  return [&recordings, all = std::move(all), of = std::move(of),
          sizes](const model::Model& other) -> std::optional<double> {
    constexpr double kHardly = 0.01;  // of the rows
    double evidence = 0.0, one_alone = 0.0, rows_of_both = 0.0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const std::optional<Linear> its = linearised(other, recordings[of[i].recording], of[i]);
      const std::size_t own_rows = all[i].left.size(), its_rows = its ? its->left.size() : 0,
                        rows = std::min(own_rows, its_rows);
      one_alone += static_cast<double>(std::max(own_rows, its_rows) - rows);
      rows_of_both += static_cast<double>(rows);
      if (rows > 0) evidence += surprise(all[i], sizes, rows) - surprise(*its, sizes, rows);
    }
    if (one_alone > kHardly * rows_of_both) return std::nullopt;
    return evidence;
  };
}

}  // namespace furcula::diagnose
