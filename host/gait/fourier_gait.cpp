#include "host/gait/fourier_gait.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/gait/gait_nlp.hpp"
#include "host/identify/dual.hpp"

namespace furcula::gait {
namespace {

constexpr std::size_t kLaw = FourierParameters<double>::kCount, kState = 6, kAll = kLaw + kState;
using Number = identify::Dual<kAll + kAll % 2>;

/// Least squares with a little weight on the size of what is sought.
Eigen::VectorXd fitted(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double small) {
  const Eigen::Index n = a.cols();
  return (a.transpose() * a + small * Eigen::MatrixXd::Identity(n, n)).ldlt().solve(a.transpose() * b);
}

double bernstein(std::size_t n, std::size_t k, double s) {
  double out = 1.0;
  for (std::size_t i = 0; i < k; ++i) out *= s * static_cast<double>(n - i) / static_cast<double>(i + 1);
  for (std::size_t i = k; i < n; ++i) out *= 1.0 - s;
  return out;
}

/// The splines' gait, with torques that a law gives: at as many points as the splines have freedoms the torque that
/// the motion needs is the law's.
class LawNlp : public GaitNlp {
 public:
  /// `rising` phases of the flight lie before the apex.
  LawNlp(const Machine& machine, const Task& task, const std::vector<JointPath>& start,
         const std::vector<Turn>& turns, std::size_t rising, const FourierParameters<double>& law,
         double rounding)
      : GaitNlp(machine, task, start, turns, rounding), rising_(rising) {
    const auto add = [&](double low, double high, double value) {
      return p_.variable(low, high, std::clamp(value, low, high));
    };
    omega_ = add(3.0, 40.0, law.omega_radps);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const auto& series = joint == 0 ? law.hip : law.knee;
      series_[joint].push_back(add(-300.0, 300.0, series.mean));
      for (const double v : series.sine) series_[joint].push_back(add(-300.0, 300.0, v));
      for (const double v : series.cosine) series_[joint].push_back(add(-300.0, 300.0, v));
    }
    const std::array<const FourierParameters<double>::Curve*, 4> curves{&law.rise_hip, &law.rise_knee,
                                                                        &law.fall_hip, &law.fall_knee};
    for (std::size_t c = 0; c < 4; ++c)
      for (const double v : *curves[c]) curve_[c].push_back(add(-6.0, 6.0, v));
    for (std::size_t k = 0; k < phases_; ++k) {
      const std::size_t n = spline_[k].intervals();
      for (std::size_t i = 0; i < n + 3; ++i) {
        // Greville's points of the second derivative, a spline of degree 3.
        double s = 0.0;
        for (std::size_t j = 1; j <= 3; ++j)
          s += std::clamp((static_cast<double>(i + j) - 3.0) / static_cast<double>(n), 0.0, 1.0) / 3.0;
        add_law(k, s, spline_[k].interval_at(s));
      }
    }
  }

  FourierParameters<double> law(const std::vector<double>& x) const {
    const auto at = [&](int v) { return x[static_cast<std::size_t>(v)]; };
    std::array<double, kLaw> values{};
    std::size_t n = 0;
    values[n++] = at(omega_);
    for (const auto& s : series_)
      for (const int v : s) values[n++] = at(v);
    for (const auto& c : curve_)
      for (const int v : c) values[n++] = at(v);
    double rise = 0.0, fall = 0.0;
    for (std::size_t k = 1; k < phases_; ++k) (k <= rising_ ? rise : fall) += at(duration_[k]);
    values[n++] = rise;
    values[n++] = fall;
    return FourierParameters<double>::of(values);
  }

 private:
  void add_law(std::size_t k, double s, std::size_t interval) {
    std::array<int, 2> torque{}, motion{}, rule{};
    for (std::size_t joint = 0; joint < 2; ++joint) {
      torque[joint] = p_.variable(-400.0, 400.0, 0.0);
      motion[joint] = p_.row("the law's torques", 0.0, 0.0);
      rule[joint] = p_.row("the law's torques", 0.0, 0.0);
      p_.linear(motion[joint], {{torque[joint], -0.1}});
      p_.linear(rule[joint], {{torque[joint], -0.1}});
    }
    const bool in_stance = k == 0;
    p_.element(
        std::array<Sum, 8>{path(k, 0, 0, s, interval), path(k, 1, 0, s, interval), path(k, 0, 1, s, interval),
                           path(k, 1, 1, s, interval), path(k, 0, 2, s, interval), path(k, 1, 2, s, interval),
                           of(duration_[k]), caught_knee()},
        motion, [this, in_stance](const auto& z) {
          using T = std::decay_t<decltype(z[0])>;
          const Joints2<T> u = motors<T>(needed(z, in_stance).torque, z[1], z[7], in_stance);
          return std::array<T, 2>{0.1 * u.hip, 0.1 * u.knee};
        });
    for (std::size_t joint = 0; joint < 2; ++joint)
      if (in_stance)
        add_series(joint, s, rule[joint]);
      else
        add_curve(k, joint, s, interval, rule[joint]);
  }

  void add_series(std::size_t joint, double s, int row) {
    std::array<Sum, 13> inputs;
    for (std::size_t i = 0; i < 11; ++i) inputs[i] = of(series_[joint][i]);
    inputs[11] = of(omega_);
    inputs[12] = of(duration_[0]);
    p_.element(inputs, std::array<int, 1>{row}, [s](const auto& z) {
      using std::cos;
      using std::sin;
      using T = std::decay_t<decltype(z[0])>;
      T sum = z[0];
      for (std::size_t n = 0; n < 5; ++n) {
        const T angle = (s * static_cast<double>(n + 1)) * (z[11] * z[12]);
        sum = sum + z[1 + n] * sin(angle) + z[6 + n] * cos(angle);
      }
      return std::array<T, 1>{0.1 * sum};
    });
  }

  void add_curve(std::size_t k, std::size_t joint, double s, std::size_t interval, int row) {
    const bool rises = k <= rising_;
    Sum since_turn, whole;
    for (std::size_t i = rises ? 1 : rising_ + 1; i < (rises ? rising_ + 1 : phases_); ++i) {
      whole.emplace_back(duration_[i], 1.0);
      if (i < k) since_turn.emplace_back(duration_[i], 1.0);
      if (i == k) since_turn.emplace_back(duration_[i], s);
    }
    std::array<Sum, 11> inputs;
    for (std::size_t i = 0; i < 6; ++i) inputs[i] = of(curve_[(rises ? 0 : 2) + joint][i]);
    inputs[6] = path(k, joint, 0, s, interval);
    inputs[7] = path(k, joint, 1, s, interval);
    inputs[8] = of(duration_[k]);
    inputs[9] = since_turn;
    inputs[10] = whole;
    p_.element(inputs, std::array<int, 1>{row}, [](const auto& z) {
      using T = std::decay_t<decltype(z[0])>;
      const FlightGains gains;
      const T r = 1.0 / z[10], at = z[9] * r, rest = 1.0 - at;
      std::array<T, 6> c;
      for (std::size_t i = 0; i < 6; ++i) c[i] = z[i];
      for (std::size_t level = 5; level > 1; --level)
        for (std::size_t i = 0; i < level; ++i) c[i] = rest * c[i] + at * c[i + 1];
      const T wanted = rest * c[0] + at * c[1], rate = 5.0 * (c[1] - c[0]) * r;
      return std::array<T, 1>{
          0.1 * (gains.kp_nmprad * (wanted - z[6]) + gains.kd_nmsprad * (rate - z[7] * (1.0 / z[8])))};
    });
  }

  std::size_t rising_;
  int omega_ = 0;
  std::array<std::vector<int>, 2> series_;
  std::array<std::vector<int>, 4> curve_;
};

/// A part of a path, from one time of it to another, over so many intervals.
JointPath part_of(const std::function<JointPath::At(double)>& path, double from, double to,
                  std::size_t intervals) {
  std::vector<double> hip, knee;
  const std::size_t values = 6 * intervals + 1;
  for (std::size_t i = 0; i < values; ++i) {
    const auto at = path(from + (to - from) * static_cast<double>(i) / static_cast<double>(values - 1));
    hip.push_back(at.angle.hip);
    knee.push_back(at.angle.knee);
  }
  const Spline s(intervals);
  return {to - from, s.fitted(hip), s.fitted(knee)};
}

}  // namespace

FourierGait fourier_near(const Machine& machine, const FreeGait& gait) {
  const FreeLaw law(machine, gait);
  StrideOptions options;
  options.longest_step_s = 2e-3;
  std::array<std::vector<Moment>, 3> moments;
  double fall = 0.0, stance = 0.0;
  options.moment = [&](const Moment& m) { moments[static_cast<std::size_t>(m.phase)].push_back(m); };
  const StrideEnd<double> end = run_stride<double>(machine, law, law, law.apex(), options);
  fall = end.fall;
  stance = end.stance;
  FourierGait out;
  out.apex = law.apex();
  FourierParameters<double>& p = out.law;
  p.omega_radps = std::clamp(2.0 * std::numbers::pi / (1.3 * stance), 3.0, 40.0);
  p.rise_s = end.rise;
  p.fall_s = end.fall;

  const auto series = [&](double Joints2<double>::*joint) {
    const auto& all = moments[static_cast<std::size_t>(LegPhase::stance)];
    const auto rows = static_cast<Eigen::Index>(all.size());
    Eigen::MatrixXd a(rows, 11);
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Moment& m = all[static_cast<std::size_t>(i)];
      const double angle = p.omega_radps * (m.time_s - fall);
      a(i, 0) = 1.0;
      for (int n = 1; n <= 5; ++n) {
        a(i, n) = std::sin(n * angle);
        a(i, 5 + n) = std::cos(n * angle);
      }
      b(i) = m.torque.*joint;
    }
    const Eigen::VectorXd c = fitted(a, b, 1e-3 * static_cast<double>(rows));
    FourierParameters<double>::Series s;
    s.mean = c(0);
    for (int n = 0; n < 5; ++n) {
      s.sine[static_cast<std::size_t>(n)] = c(1 + n);
      s.cosine[static_cast<std::size_t>(n)] = c(6 + n);
    }
    return s;
  };
  p.hip = series(&Joints2<double>::hip);
  p.knee = series(&Joints2<double>::knee);

  // The PD law alone has to give the torque: d + (Kd / Kp) d' = angle + (Kd / Kp) rate + torque / Kp.
  const FlightGains gains;
  const double lag = gains.kd_nmsprad / gains.kp_nmprad;
  const auto curve = [&](LegPhase phase, double begin, double duration, double Joints2<double>::*joint) {
    const auto& all = moments[static_cast<std::size_t>(phase)];
    const auto rows = static_cast<Eigen::Index>(all.size());
    Eigen::MatrixXd a(rows, 6);
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Moment& m = all[static_cast<std::size_t>(i)];
      const double s = (m.time_s - begin) / duration;
      for (std::size_t k = 0; k <= 5; ++k) {
        double slope = 0.0;
        if (k > 0) slope += 5.0 * bernstein(4, k - 1, s);
        if (k < 5) slope -= 5.0 * bernstein(4, k, s);
        a(i, static_cast<Eigen::Index>(k)) = bernstein(5, k, s) + lag * slope / duration;
      }
      b(i) = m.angle.*joint + lag * m.rate.*joint + m.torque.*joint / gains.kp_nmprad;
    }
    const Eigen::VectorXd c = fitted(a, b, 1e-6 * static_cast<double>(rows));
    FourierParameters<double>::Curve out_curve{};
    for (std::size_t k = 0; k <= 5; ++k) out_curve[k] = c(static_cast<Eigen::Index>(k));
    return out_curve;
  };
  p.rise_hip = curve(LegPhase::rise, fall + stance, p.rise_s, &Joints2<double>::hip);
  p.rise_knee = curve(LegPhase::rise, fall + stance, p.rise_s, &Joints2<double>::knee);
  p.fall_hip = curve(LegPhase::fall, 0.0, p.fall_s, &Joints2<double>::hip);
  p.fall_knee = curve(LegPhase::fall, 0.0, p.fall_s, &Joints2<double>::knee);
  return out;
}

namespace {

/// What a gait has to meet, as far as it is not the optimiser's business any more: the same state after a stride, the
/// durations, the way, the clearance. With derivatives by the law's parameters and the state.
bool closing(const Machine& machine, const Task& task, const StrideOptions& options, const Eigen::VectorXd& x,
             Eigen::VectorXd& rows, Eigen::MatrixXd* jacobian) {
  const auto evaluate = [&](auto scalar) {
    using T = decltype(scalar);
    std::array<T, kLaw> law;
    std::array<T, kState> apex;
    std::array<double, kLaw> plain;
    for (std::size_t i = 0; i < kAll; ++i) {
      const double value = x(static_cast<Eigen::Index>(i));
      T v(value);
      if constexpr (!std::is_same_v<T, double>) v = T(value, static_cast<int>(i));
      if (i < kLaw) {
        law[i] = v;
        plain[i] = value;
      } else {
        apex[i - kLaw] = v;
      }
    }
    const FourierLaw<T> full(FourierParameters<T>::of(law));
    const FourierLaw<double> values(FourierParameters<double>::of(plain));
    const StrideEnd<T> e = run_stride<T>(machine, full, values, Apex<T>::of(apex), options);
    std::vector<T> out;
    if (!e.whole) return out;
    const auto after = e.apex.values();
    for (std::size_t i = 0; i < kState; ++i) out.push_back(after[i] - apex[i]);
    out.push_back(e.rise - law[kLaw - 2]);
    out.push_back(e.fall - law[kLaw - 1]);
    out.push_back(e.distance - task.speed_mps.value_or(0.0) * (e.fall + e.stance + e.rise));
    if (task.clearance_m) out.push_back(e.highest_toe - *task.clearance_m);
    if (task.touchdown_knee_rad) out.push_back(e.touchdown_knee - *task.touchdown_knee_rad);
    return out;
  };
  if (jacobian == nullptr) {
    const auto out = evaluate(0.0);
    rows = Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
    return !out.empty();
  }
  const auto out = evaluate(Number());
  rows.resize(static_cast<Eigen::Index>(out.size()));
  jacobian->resize(rows.size(), static_cast<Eigen::Index>(kAll));
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    rows(i) = out[static_cast<std::size_t>(i)].a;
    for (std::size_t j = 0; j < kAll; ++j)
      (*jacobian)(i, static_cast<Eigen::Index>(j)) = out[static_cast<std::size_t>(i)].derivative(j);
  }
  return !out.empty();
}

/// The nearest gait that closes, by Newton's method with the least change. Its residual.
double close(const Machine& machine, const Task& task, FourierGait& gait) {
  StrideOptions options;
  options.lift_off = task.lift_off;
  options.longest_step_s = 3e-3;
  options.energies = false;
  Eigen::VectorXd x(static_cast<Eigen::Index>(kAll));
  const auto law = gait.law.values();
  const auto state = gait.apex.values();
  std::copy(law.begin(), law.end(), x.data());
  std::copy(state.begin(), state.end(), x.data() + kLaw);
  Eigen::VectorXd rows;
  Eigen::MatrixXd jacobian;
  double residual = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 12; ++round) {
    if (!closing(machine, task, options, x, rows, &jacobian)) return std::numeric_limits<double>::infinity();
    residual = rows.lpNorm<Eigen::Infinity>();
    if (residual < 1e-12) break;
    const Eigen::VectorXd step = jacobian.completeOrthogonalDecomposition().solve(rows);
    double share = 1.0;
    Eigen::VectorXd tried;
    for (; share > 1e-3; share *= 0.5)
      if (closing(machine, task, options, x - share * step, tried, nullptr) &&
          tried.lpNorm<Eigen::Infinity>() < residual)
        break;
    if (share <= 1e-3) break;
    x -= share * step;
  }
  std::array<double, kLaw> law_values;
  std::array<double, kState> apex_values;
  std::copy_n(x.data(), kLaw, law_values.begin());
  std::copy_n(x.data() + kLaw, kState, apex_values.begin());
  gait.law = FourierParameters<double>::of(law_values);
  gait.apex = Apex<double>::of(apex_values);
  return residual;
}

}  // namespace

FourierResult find_fourier_gait(const Machine& machine, const Task& task, const FreeGait& start,
                                const FourierOptions& options) {
  // The flight is parted at the apex and, in place, at the toe's highest point too.
  const FreeLaw free(machine, start);
  const double rise = free.rise_s(), first = start.phases[1].duration_s,
               whole = first + start.phases[2].duration_s;
  const auto flight = [&](double t) {
    return t < first ? start.phases[1].at(t) : start.phases[2].at(t - first);
  };
  const std::size_t n = options.flight_intervals;
  std::vector<JointPath> paths{part_of([&](double t) { return start.stance().at(t); }, 0.0,
                                       start.stance().duration_s, options.stance_intervals)};
  std::vector<Turn> turns;
  std::vector<double> ends{0.0};
  std::size_t rising = 1;
  if (task.clearance_m) {
    const bool top_first = first < rise;
    turns = top_first ? std::vector{Turn::top, Turn::apex} : std::vector{Turn::apex, Turn::top};
    ends.push_back(std::min(first, rise));
    ends.push_back(std::max(first, rise));
    if (top_first) rising = 2;
  } else {
    turns = {Turn::apex};
    ends.push_back(rise);
  }
  ends.push_back(whole);
  for (std::size_t k = 1; k < ends.size(); ++k) {
    // A short part needs few intervals.
    const auto intervals = static_cast<std::size_t>(
        std::clamp(std::round(2.0 * static_cast<double>(n) * (ends[k] - ends[k - 1]) / whole), 2.0,
                   2.0 * static_cast<double>(n)));
    paths.push_back(part_of(flight, ends[k - 1], ends[k], intervals));
  }

  FourierResult result;
  result.gait = fourier_near(machine, start);
  result.gait.law.omega_radps *= options.omega_factor;
  const bool kinks = has_kinks(machine, task);
  for (const double rounding : kinks ? std::vector<double>{2e-2, 2e-3, 3e-4} : std::vector<double>{1e-5}) {
    LawNlp nlp(machine, task, paths, turns, rising, result.gait.law, rounding);
    SolveOptions solving;
    solving.iterations = options.iterations;
    solving.progress = options.progress;
    if (rounding < 1e-2 && kinks) solving.barrier = 1e-4;
    const Solution solution = solve(nlp.nlp(), solving);
    result.found = solution.found;
    result.status = solution.status;
    result.violation = solution.violation;
    result.worst = solution.worst;
    result.iterations += solution.iterations;
    if (!solution.found) return result;
    paths = nlp.paths(solution.x);
    result.gait.law = nlp.law(solution.x);
    result.gait.cost = solution.cost;
  }
  // The apex of these paths.
  FreeGait found;
  found.phases[0] = paths[0];
  const auto flown = [&](double t) {
    std::size_t k = 1;
    for (; k + 1 < paths.size() && t > paths[k].duration_s; ++k) t -= paths[k].duration_s;
    return paths[k].at(t);
  };
  found.phases[1] = part_of(flown, 0.0, result.gait.law.rise_s, 2 * n);
  found.phases[2] =
      part_of(flown, result.gait.law.rise_s, result.gait.law.rise_s + result.gait.law.fall_s, 2 * n);
  result.gait.apex = FreeLaw(machine, found).apex();
  result.closure = close(machine, task, result.gait);
  if (!(result.closure < 1e-9)) {
    result.found = false;
    result.status = "does not close";
    result.worst = "the same state after a stride";
    result.violation = result.closure;
  }
  return result;
}

}  // namespace furcula::gait
