// The torque that a model lacks, see missing_torque.hpp.
#include "host/trees/missing_torque.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "furcula/dynamics/tree/foothold.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/quantile.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/candidates.hpp"

namespace furcula::trees {
namespace {

/// A run asks for so many times the torque that acts there: it has flown apart.
constexpr double kFlownApart = 1e6;
constexpr double kHalf_s = 0.02;
constexpr double kFewestOfWindow = 8.0;  ///< samples

/// The drive's input about a row, weighed as a cubic's second derivative weighs accelerations.
double smoothed_input(const Recording& r, std::size_t joint, double t0, double half_s, std::size_t near) {
  double sum = 0.0, weights = 0.0;
  const auto take = [&](std::size_t k) {
    const double end = k + 1 < r.rows() ? r.time_s[k + 1] : r.time_s[k] + r.interval_s;
    const double s = (0.5 * (r.time_s[k] + end) - t0) / half_s;
    if (std::abs(s) >= 1.0) return false;
    const double w = (1.0 - s * s) * (1.0 - s * s) * (end - r.time_s[k]);
    sum += w * r.input[joint][k];
    weights += w;
    return true;
  };
  for (std::size_t k = near; k < r.rows(); ++k)
    if (!take(k) && r.time_s[k] > t0) break;
  for (std::size_t k = near; k-- > 0;)
    if (!take(k) && r.time_s[k] < t0 - half_s - r.interval_s) break;
  return weights > 0.0 ? sum / weights : r.input[joint][near];
}

double friction_torque(const dynamics::tree::JointLaw<double>& law, double q, double v, double drive) {
  const int direction = v > 0.0 ? 1 : -1;
  return direction *
         dynamics::tree::friction_in_motion(law, v, drive, direction, dynamics::tree::spot_at(law, q));
}

/// All joints at one row.
struct Row {
  std::vector<double> angle, velocity, acceleration, drive, drive_rate, missing;
};

/// Of torques that are missing, less what a force on the standing foot makes up for: as much as no other rows than those without a drive
/// decide, where there are any.
void without_ground(const model::RobotModel& tree, const model::RobotModel::Joints& q,
                    const model::RobotModel::Joints& v, const std::vector<bool>& driven,
                    std::vector<double>& missing) {
  constexpr double kDriven = 1e-3;
  const auto point = point_motion(tree, tree.foothold, q, v);
  const auto n = static_cast<Eigen::Index>(missing.size());
  Eigen::MatrixXd by_force(n, 3);
  Eigen::VectorXd weight(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& c = point.by_joint[static_cast<std::size_t>(i)];
    by_force.row(i) << c.x, c.y, c.z;
    weight(i) = driven[static_cast<std::size_t>(i)] ? kDriven : 1.0;
  }
  Eigen::Map<Eigen::VectorXd> all(missing.data(), n);
  const Eigen::Vector3d force =
      linear::least_norm_of_three(weight.asDiagonal() * by_force, weight.cwiseProduct(all));
  all -= by_force * force;
}

Row at_row(const Setup& setup, const Recording& r, std::size_t k, double half_s) {
  const std::size_t n = setup.joints.size();
  Row out{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n),
          std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  model::RobotModel::Joints q{}, v{}, a{};
  auto tree = setup.model;
  for (std::size_t j = 0; j < n; ++j) {
    const LocalState s = local_state(r, j, k, half_s);
    const Setup::Joint& d = setup.joints[j];
    q[j] = s.angle_rad - d.encoder_offset_rad;
    v[j] = s.velocity_radps;
    a[j] = s.acceleration_radps2;
    const double late = d.delay_s + d.lag_s + d.late_rows * r.interval_s;
    std::size_t near = k;
    while (near > 0 && r.time_s[near] > r.time_s[k] - late) --near;
    while (near + 1 < r.rows() && r.time_s[near + 1] <= r.time_s[k] - late) ++near;
    double input = smoothed_input(r, j, r.time_s[k] - late, half_s, near);
    const double dt = 0.5 * half_s,
                 rate = (smoothed_input(r, j, r.time_s[k] - late + dt, half_s, near) - input) / dt;
    out.drive_rate[j] = d.gain * rate;
    if (d.law == ControlMode::position) {
      input = d.kp_nmprad * (input - s.angle_rad) - d.kd_nmsprad * v[j];
      out.drive_rate[j] = d.gain * d.kp_nmprad * (rate - v[j]);
      if (Runner::is_spring(d)) {  // the joint's law has it as a spring and a damper
        tree.laws[j].stiffness_nmprad -= d.gain * d.kp_nmprad;
        tree.laws[j].damping_nmspr -= d.gain * d.kd_nmsprad;
      }
    }
    input *= d.gain;
    if (d.limit_nm > 0.0) input = std::clamp(input, -d.limit_nm, d.limit_nm);
    if (d.ripple_nm != 0.0)
      input += d.ripple_nm * std::sin(d.ripple_cycles * s.angle_rad + d.ripple_phase_rad);
    out.drive[j] = input;
    out.angle[j] = q[j];
    out.velocity[j] = v[j];
    out.acceleration[j] = a[j];
  }
  const auto needed = dynamics::tree::inverse_dynamics(tree, q, v, a);
  for (std::size_t j = 0; j < n; ++j)
    out.missing[j] = needed[j] - out.drive[j] - setup.joints[j].offset_nm +
                     friction_torque(tree.laws[j], q[j], v[j], out.drive[j]);
  if (tree.foothold.joint >= 0) {
    std::vector<bool> driven;
    for (const Setup::Joint& d : setup.joints) driven.push_back(d.law != ControlMode::none);
    without_ground(tree, q, v, driven, out.missing);
  }
  return out;
}

}  // namespace

std::vector<TorqueSamples> missing_torque(const Problem& problem, const std::vector<Recording>& recordings,
                                          const Hypothesis& h, double window_s, std::size_t most) {
  const std::size_t n = problem.joints();
  const Setup of_all = SetupMaker(problem.model()).make(h);
  std::vector<TorqueSamples> out(n);
  for (TorqueSamples& s : out) s.others.resize(n);
  std::size_t rows = 0;
  for (const Recording& r : recordings) rows += r.rows();
  // Of long recordings some windows with as many samples each as tell its motion, in place of all with one or none.
  const double in_window = window_s / std::max(recordings.front().interval_s, 1e-6);
  const auto widest = static_cast<std::size_t>(std::max(1.0, in_window / kFewestOfWindow));
  const std::size_t step = std::clamp<std::size_t>(rows / most, 1, widest);
  const std::size_t most_windows =
      rows / most > widest ? most / static_cast<std::size_t>(kFewestOfWindow) : 0;
  for (const Window& w : windows_of(problem.model(), recordings, window_s, most_windows)) {
    const Recording& r = recordings[w.recording];
    const double half = std::max(kHalf_s, 3.5 * r.interval_s);
    // The same window as the model makes it: what smoothing does to it, it does to the measured one.
    const Setup setup = in_phase(of_all, r, w.first);
    Recording simulated = part_of(r, w.first, w.last);
    std::vector<double> run_of((w.last - w.first + 1) * n);
    run(of_all, r, w.first, w.last, w.angle_rad, w.velocity_radps, run_of);
    const Recording measured = simulated;
    for (std::size_t k = 0; k < simulated.rows(); ++k)
      for (std::size_t j = 0; j < n; ++j) simulated.angle_rad[j][k] = run_of[k * n + j];
    const std::vector<std::size_t> before_window = [&] {
      std::vector<std::size_t> counts;
      for (const TorqueSamples& s : out) counts.push_back(s.missing_nm.size());
      return counts;
    }();
    for (std::size_t k = step / 2; k < measured.rows(); k += step) {
      if (measured.time_s[k] - measured.time_s.front() < half ||
          measured.time_s.back() - measured.time_s[k] < half)
        continue;
      const Row m = at_row(setup, measured, k, half), s = at_row(setup, simulated, k, half);
      for (std::size_t j = 0; j < n; ++j) {
        // What a foot that stands makes up for is not known there.
        if (setup.model.foothold.joint >= 0 && setup.joints[j].law == ControlMode::none) continue;
        // Dry friction has any value about a reversal.
        const double slow =
            std::max(0.05 * problem.scales().velocity_radps[j], std::abs(m.acceleration[j]) * half);
        if (std::abs(m.velocity[j]) < slow || m.velocity[j] * s.velocity[j] <= 0.0 ||
            !(std::abs(s.missing[j]) < kFlownApart * problem.scales().torque_nm[j]))
          continue;
        TorqueSamples& to = out[j];
        to.half_s = std::max(to.half_s, half);
        to.recording.push_back(w.recording);
        to.time_s.push_back(measured.time_s[k] - r.time_s.front());
        to.missing_nm.push_back(m.missing[j] - s.missing[j]);
        // Of the model's motion: the measured one has the very noise in it that is in the missing torque.
        to.drive_rate_nmps.push_back(s.drive_rate[j]);
        to.asked_nm.push_back(m.drive[j]);
        to.needed_nm.push_back(m.drive[j] + m.missing[j]);
        for (std::size_t o = 0; o < n; ++o) {
          to.others[o].angle_rad.push_back(s.angle[o]);
          to.others[o].velocity_radps.push_back(s.velocity[o]);
          to.others[o].acceleration_radps2.push_back(s.acceleration[o]);
          to.others[o].drive_nm.push_back(s.drive[o]);
        }
      }
    }
    // A spring that caught at a touch-down that is known to a row is off by a torque that lasts as long as the stance.
    const Phase& phase = r.phase_at(w.first);
    for (std::size_t j = 0; j < n && phase.stance; ++j) {
      if (!setup.joints[j].switched) continue;
      const auto begin = out[j].missing_nm.begin() + static_cast<std::ptrdiff_t>(before_window[j]),
                 end = out[j].missing_nm.end();
      if (begin == end) continue;
      const double mean = std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin),
                   furthest = 2.0 * setup.joints[j].spring_nmprad * phase.touchdown_sd_rad[j];
      for (auto x = begin; x != end; ++x) *x -= std::clamp(mean, -furthest, furthest);
    }
  }
  for (std::size_t j = 0; j < n; ++j) out[j].joint = j;
  return out;
}

namespace {

using Regressors = std::vector<Eigen::VectorXd>;

double rms(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return x.empty() ? 1.0 : std::max(1e-12, std::sqrt(sum / static_cast<double>(x.size())));
}

class Basis {
 public:
  Basis(const TorqueSamples& s, std::size_t joint) : s_(s), joint_(joint) {}

  template <class F>
  void add(Regressors& to, const F& f) const {
    Eigen::VectorXd c(static_cast<Eigen::Index>(s_.missing_nm.size()));
    for (Eigen::Index i = 0; i < c.size(); ++i) c(i) = f(static_cast<std::size_t>(i));
    to.push_back(std::move(c));
  }
  const TorqueSamples::Joint& own() const { return s_.others[joint_]; }
  static double sign(double x) { return x > 0.0 ? 1.0 : -1.0; }

  Regressors friction() const {
    Regressors out;
    const double v0 = rms(own().velocity_radps);
    const auto& v = own().velocity_radps;
    add(out, [&](std::size_t i) { return sign(v[i]); });
    add(out, [&](std::size_t i) { return v[i] / v0; });
    add(out, [&](std::size_t i) { return v[i] * std::abs(v[i]) / (v0 * v0); });
    for (const double width : {0.2, 0.6})
      add(out, [&](std::size_t i) { return sign(v[i]) * std::exp(-std::pow(v[i] / (width * v0), 2)); });
    return out;
  }
  Regressors position() const {
    Regressors out;
    add(out, [](std::size_t) { return 1.0; });
    const auto [low, high] = std::minmax_element(own().angle_rad.begin(), own().angle_rad.end());
    constexpr int kHats = 8;
    const double width = (*high - *low) / kHats + 1e-9;
    for (int k = 0; k < kHats; ++k) {
      const double centre = *low + (k + 0.5) * width;
      add(out, [&](std::size_t i) { return std::exp(-std::pow((own().angle_rad[i] - centre) / width, 2)); });
    }
    return out;
  }
  Regressors friction_by_position() const {
    Regressors out;
    for (const Eigen::VectorXd& c : position()) {
      Eigen::VectorXd x = c;
      for (Eigen::Index i = 0; i < x.size(); ++i)
        x(i) *= sign(own().velocity_radps[static_cast<std::size_t>(i)]);
      out.push_back(x);
    }
    return out;
  }
  Regressors drive() const {
    Regressors out;
    const double u = rms(own().drive_nm), du = rms(s_.drive_rate_nmps);
    add(out, [&](std::size_t i) { return own().drive_nm[i] / u; });
    add(out, [&](std::size_t i) { return std::abs(own().drive_nm[i]) * sign(own().velocity_radps[i]) / u; });
    add(out, [&](std::size_t i) { return s_.drive_rate_nmps[i] / du; });
    return out;
  }
  Regressors acceleration() const {
    Regressors out;
    const double a0 = rms(own().acceleration_radps2);
    add(out, [&](std::size_t i) { return own().acceleration_radps2[i] / a0; });
    return out;
  }
  Regressors time() const {
    Regressors out;
    const double end =
        s_.time_s.empty() ? 1.0 : std::max(1e-9, *std::max_element(s_.time_s.begin(), s_.time_s.end()));
    add(out, [&](std::size_t i) { return s_.time_s[i] / end; });
    add(out, [&](std::size_t i) { return sign(own().velocity_radps[i]) * s_.time_s[i] / end; });
    return out;
  }
  Regressors other(std::size_t o) const {
    Regressors out;
    if (o == joint_) return out;
    const double v0 = rms(s_.others[o].velocity_radps), a0 = rms(s_.others[o].acceleration_radps2),
                 u0 = rms(s_.others[o].drive_nm);
    add(out, [&](std::size_t i) { return s_.others[o].velocity_radps[i] / v0; });
    add(out, [&](std::size_t i) { return s_.others[o].acceleration_radps2[i] / a0; });
    add(out, [&](std::size_t i) { return s_.others[o].drive_nm[i] / u0; });
    add(out, [&](std::size_t i) { return std::sin(s_.others[o].angle_rad[i]); });
    add(out, [&](std::size_t i) { return std::cos(s_.others[o].angle_rad[i]); });
    add(out,
        [&](std::size_t i) { return sign(own().velocity_radps[i]) * std::sin(s_.others[o].angle_rad[i]); });
    add(out,
        [&](std::size_t i) { return sign(own().velocity_radps[i]) * std::cos(s_.others[o].angle_rad[i]); });
    return out;
  }

 private:
  const TorqueSamples& s_;
  std::size_t joint_;
};

/// Share predictable; 0 where it does harm on more than three of ten folds.
double cross_validated(const TorqueSamples& s, const Regressors& columns, std::size_t recordings) {
  const auto rows = static_cast<Eigen::Index>(s.missing_nm.size());
  const auto p = static_cast<Eigen::Index>(columns.size());
  if (rows < 20 * p || p == 0) return 0.0;
  const std::size_t folds = recordings >= 3 ? recordings : 4;
  std::vector<Eigen::MatrixXd> normal(folds, Eigen::MatrixXd::Zero(p, p));
  std::vector<Eigen::VectorXd> right(folds, Eigen::VectorXd::Zero(p));
  std::vector<double> squares(folds, 0.0);
  Eigen::MatrixXd x(rows, p);
  for (Eigen::Index k = 0; k < p; ++k) x.col(k) = columns[static_cast<std::size_t>(k)];
  const Eigen::Map<const Eigen::VectorXd> y(s.missing_nm.data(), rows);
  for (std::size_t f = 0; f < folds; ++f) {
    std::vector<Eigen::Index> mine;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const std::size_t fold = recordings >= 3
                                   ? s.recording[static_cast<std::size_t>(i)]
                                   : static_cast<std::size_t>(i) * folds / static_cast<std::size_t>(rows);
      if (fold == f) mine.push_back(i);
    }
    const Eigen::MatrixXd xf = x(mine, Eigen::all);
    const Eigen::VectorXd yf = y(mine);
    normal[f] = xf.transpose() * xf;
    right[f] = xf.transpose() * yf;
    squares[f] = yf.squaredNorm();
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd all_right = Eigen::VectorXd::Zero(p);
  double total = 0.0;
  for (std::size_t f = 0; f < folds; ++f) {
    all += normal[f];
    all_right += right[f];
    total += squares[f];
  }
  double best = 0.0;
  for (const double ridge : {1e-4, 1e-2, 1e-1, 1.0}) {
    double left = 0.0;
    std::size_t worse = 0;
    for (std::size_t f = 0; f < folds; ++f) {
      Eigen::MatrixXd m = all - normal[f];
      m.diagonal().array() += ridge * static_cast<double>(rows) * 0.1;
      const Eigen::VectorXd c = linear::solve_symmetric(m, Eigen::VectorXd(all_right - right[f]));
      const double of_fold = squares[f] - 2.0 * c.dot(right[f]) + c.dot(Eigen::VectorXd(normal[f] * c));
      left += of_fold;
      worse += of_fold > 1.01 * squares[f] ? 1 : 0;
    }
    if (10 * worse <= 3 * folds) best = std::max(best, 1.0 - left / std::max(total, 1e-300));
  }
  return best;
}

void append(Regressors& to, Regressors from) {
  for (Eigen::VectorXd& c : from) to.push_back(std::move(c));
}

}  // namespace

double predictable_share(const TorqueSamples& s, std::size_t joint, std::size_t recordings) {
  if (s.missing_nm.size() < 50) return 0.0;
  const Basis b(s, joint);
  Regressors own;
  append(own, b.friction());
  append(own, b.position());
  append(own, b.friction_by_position());
  append(own, b.drive());
  append(own, b.acceleration());
  append(own, b.time());
  const double alone = cross_validated(s, own, recordings);
  for (std::size_t o = 0; o < s.others.size(); ++o) append(own, b.other(o));
  return std::max(alone, cross_validated(s, own, recordings));
}

double persistent_nm(const TorqueSamples& s) {
  // Blocks of the recordings scatter. The nearest bin of time apart is asked for two standard errors, the best of all for so much
  // more that all together err as seldom by chance.
  constexpr double kBlock_s = 0.5, kOfOne = 2.0, kOfAny = 3.15;
  constexpr std::size_t kBins = 14;  // each of one half_s: 0.04 to 0.32 s apart at the usual one
  struct Bin {
    double sum = 0.0, pairs = 0.0;
  };
  std::map<std::pair<std::size_t, long>, std::array<Bin, kBins>> blocks;
  for (std::size_t i = 0; i < s.time_s.size(); ++i) {
    auto& block = blocks[{s.recording[i], std::lround(s.time_s[i] / kBlock_s)}];
    for (std::size_t k = i + 1; k < s.time_s.size() && s.recording[k] == s.recording[i]; ++k) {
      const double apart = (s.time_s[k] - s.time_s[i]) / s.half_s - 2.0;
      if (apart >= static_cast<double>(kBins)) break;
      if (apart < 0.0) continue;
      Bin& bin = block[static_cast<std::size_t>(apart)];
      bin.sum += s.missing_nm[i] * s.missing_nm[k];
      bin.pairs += 1.0;
    }
  }
  double most = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    double sum = 0.0, pairs = 0.0, squares = 0.0;
    for (const auto& [where, b] : blocks) sum += b[bin].sum, pairs += b[bin].pairs;
    if (!(pairs > 0.0)) continue;
    const double mean = sum / pairs;
    for (const auto& [where, b] : blocks) squares += std::pow(b[bin].sum - mean * b[bin].pairs, 2);
    const double of_mean = std::sqrt(squares) / pairs;
    // What swings has the other sign half a period on. Of what keeps its sign the nearest bin says most.
    if (bin == 0) most = mean - kOfOne * of_mean;
    most = std::max(most, std::abs(mean) - kOfAny * of_mean);
  }
  return std::sqrt(std::max(0.0, most));
}

Remainder remainder_of(const TorqueSamples& s, std::size_t recordings) {
  double squares = 0.0;
  for (const double x : s.missing_nm) squares += x * x;
  const double samples = static_cast<double>(std::max<std::size_t>(s.missing_nm.size(), 1));
  return {std::sqrt(squares / samples), std::clamp(predictable_share(s, s.joint, recordings), 0.0, 1.0),
          persistent_nm(s)};
}

std::string what_does(const TreeModel& model, std::size_t joint) {
  return "what " + model.robot.joints[joint].name + " does";
}

std::string correlated_with(const TorqueSamples& s, std::size_t joint, std::size_t recordings,
                            const TreeModel& model) {
  if (s.missing_nm.size() < 50) return {};
  const Basis b(s, joint);
  std::vector<std::pair<double, std::string>> all;
  const auto test = [&](const Regressors& c, const std::string& what) {
    all.emplace_back(cross_validated(s, c, recordings), what);
  };
  const std::string own = model.robot.joints[joint].name;
  test(b.friction(), "the velocity of " + own);
  test(b.position(), "the position of " + own);
  test(b.friction_by_position(), "the position and the direction of motion of " + own);
  test(b.drive(), "the drive's torque at " + own + " and its rate");
  test(b.acceleration(), "the acceleration of " + own);
  test(b.time(), "the time");
  for (std::size_t o = 0; o < s.others.size(); ++o)
    if (o != joint) test(b.other(o), what_does(model, o));
  const auto best = std::max_element(all.begin(), all.end());
  return best->first > 0.1 ? best->second : std::string();
}

std::vector<std::vector<double>> ripple_cycles(const Problem& problem,
                                               const std::vector<TorqueSamples>& samples) {
  constexpr double kSwings = 0.05;  // of the missing torque's square
  std::vector<std::vector<double>> out;
  for (const TorqueSamples& s : samples) {
    const auto& q = s.own().angle_rad;
    const auto& y = s.missing_nm;
    std::vector<std::pair<double, double>> best;
    const double range = problem.scales().highest_rad[s.joint] - problem.scales().lowest_rad[s.joint];
    for (int cycles = kFewestCycles; cycles <= kMostCycles && y.size() > 100; ++cycles) {
      if (cycles * range < kTravel_rad) continue;
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      double squares = 0.0;
      for (std::size_t i = 0; i < y.size(); ++i) {
        const Eigen::Vector3d row(1.0, std::sin(cycles * q[i]), std::cos(cycles * q[i]));
        normal += row * row.transpose();
        right += row * y[i];
        squares += y[i] * y[i];
      }
      const double constant = right(0) * right(0) / normal(0, 0);
      best.emplace_back(
          (right.dot(linear::solve_symmetric(normal, right)) - constant) / std::max(squares, 1e-300), cycles);
    }
    std::sort(best.rbegin(), best.rend());
    out.emplace_back();
    for (std::size_t k = 0; k < best.size() && k < 2 && best[k].first > kSwings; ++k)
      out.back().push_back(best[k].second);
  }
  return out;
}

std::vector<std::vector<double>> limits_nm(const std::vector<TorqueSamples>& samples) {
  constexpr double kLess = 0.85;
  std::vector<std::vector<double>> out;
  for (const TorqueSamples& s : samples) {
    std::vector<double>& limits = out.emplace_back();
    std::vector<double> asked;
    for (const double x : s.asked_nm) asked.push_back(std::abs(x));
    if (asked.size() < 50) continue;
    for (const double share : {0.7, 0.92}) {
      const double most = core::quantile(asked, share);
      std::vector<double> given, of;
      for (std::size_t i = 0; i < asked.size(); ++i) {
        if (asked[i] < most) continue;
        given.push_back(std::copysign(1.0, s.asked_nm[i]) * s.needed_nm[i]);
        of.push_back(asked[i]);
      }
      const double limit = core::median(given);
      if (limit > 0.0 && limit < kLess * core::median(of)) limits.push_back(limit);
    }
  }
  return out;
}

}  // namespace furcula::trees
