#include "host/gait/fourier_gait.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/gait/nlp.hpp"
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

/// Samples of the fall, the rise: heights of the toe and ranges of the joints are asked for there.
constexpr std::size_t kSamples = 10;

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

FourierResult find_fourier_gait(const Machine& machine, const Task& task, const FourierGait& start,
                                const FourierOptions& options) {
  Programme programme;
  const std::array<double, kLaw> law = start.law.values();
  const std::array<double, kState> state = start.apex.values();
  for (std::size_t i = 0; i < kLaw; ++i) {
    double low = -6.0, high = 6.0;
    if (i == 0) {
      low = 3.0;
      high = 40.0;
    } else if (i <= 22) {
      low = -300.0;
      high = 300.0;
    } else if (i >= kLaw - 2) {
      low = 0.01;
      high = 1.0;
    }
    programme.variable(low, high, std::clamp(law[i], low, high));
  }
  for (const double v : state) programme.variable(-60.0, 60.0, v);

  StrideOptions stride;
  stride.lift_off = task.lift_off;
  stride.longest_step_s = options.longest_step_s;
  std::size_t samples = 0;
  for (const auto& [phase, duration] : {std::pair{LegPhase::fall, start.law.fall_s},
                                        std::pair{LegPhase::rise, start.law.rise_s}})
    for (std::size_t i = 1; i <= kSamples; ++i) {
      stride.samples[static_cast<std::size_t>(phase)].push_back(0.9 * duration * static_cast<double>(i) /
                                                                (kSamples + 1));
      ++samples;
    }
  std::size_t rows = 1;
  const auto row = [&](const char* what, double low, double high) {
    programme.row(what, low, high);
    ++rows;
  };
  for (std::size_t i = 0; i < kState; ++i) row("the same state after a stride", 0.0, 0.0);
  row("the flight's duration", 0.0, 0.0);
  row("the flight's duration", 0.0, 0.0);
  row("the way of a stride", 0.0, 0.0);
  const double clearance = task.clearance_m.value_or(0.0);
  row("the toe's clearance", clearance, task.clearance_m ? clearance : kNoBound);
  row("the knee's angle at touch-down", task.touchdown_knee_rad.value_or(machine.least.knee),
      task.touchdown_knee_rad.value_or(machine.most.knee));
  for (std::size_t i = 0; i < samples; ++i) {
    row("the toe's height in flight", 0.0, kNoBound);
    row("the hip's range", machine.least.hip, machine.most.hip);
    row("the knee's range", machine.least.knee, machine.most.knee);
  }

  const auto evaluate = [&](const auto& law_values, const auto& apex_values, const FourierLaw<double>& plain,
                            auto& out) {
    using T = std::decay_t<decltype(law_values[0])>;
    const FourierLaw<T> full(FourierParameters<T>::of(law_values));
    const StrideEnd<T> e = run_stride<T>(machine, full, plain, Apex<T>::of(apex_values), stride);
    if (!e.whole) return false;
    std::size_t n = 0;
    const T time = e.fall + e.stance + e.rise;
    const double weight = machine.leg.mass_kg * machine.leg.gravity_mps2;
    out[n++] = task.speed_mps ? T(e.electric / (weight * std::abs(*task.speed_mps) * time)) : e.electric;
    const auto after = e.apex.values();
    for (std::size_t i = 0; i < kState; ++i) out[n++] = after[i] - apex_values[i];
    out[n++] = e.rise - full.parameters().rise_s;
    out[n++] = e.fall - full.parameters().fall_s;
    out[n++] = e.distance - task.speed_mps.value_or(0.0) * time;
    out[n++] = e.highest_toe;
    out[n++] = e.touchdown_knee;
    for (const LegPhase phase : {LegPhase::fall, LegPhase::rise}) {
      const auto& kept = e.samples[static_cast<std::size_t>(phase)];
      for (std::size_t i = 0; i < kSamples; ++i) {
        // Beyond the end of a phase that became shorter there is nothing to ask.
        const bool there = i < kept.size();
        out[n++] = there ? kept[i].toe_height : T(0.01);
        out[n++] = there ? kept[i].angle.hip : T(0.5 * (machine.least.hip + machine.most.hip));
        out[n++] = there ? kept[i].angle.knee : T(0.5 * (machine.least.knee + machine.most.knee));
      }
    }
    return true;
  };

  programme.whole(rows, [&](const double* x, double* out, double* jacobian) {
    std::array<double, kLaw> law_values;
    std::array<double, kState> apex_values;
    std::copy_n(x, kLaw, law_values.begin());
    std::copy_n(x + kLaw, kState, apex_values.begin());
    const FourierLaw<double> plain(FourierParameters<double>::of(law_values));
    if (jacobian == nullptr) {
      std::vector<double> values(rows);
      const bool whole = evaluate(law_values, apex_values, plain, values);
      for (std::size_t i = 0; i < rows; ++i)
        out[i] = whole ? values[i] : std::numeric_limits<double>::quiet_NaN();
      return;
    }
    std::array<Number, kLaw> law_numbers;
    std::array<Number, kState> apex_numbers;
    for (std::size_t i = 0; i < kLaw; ++i) law_numbers[i] = Number(law_values[i], static_cast<int>(i));
    for (std::size_t i = 0; i < kState; ++i)
      apex_numbers[i] = Number(apex_values[i], static_cast<int>(kLaw + i));
    std::vector<Number> values(rows);
    evaluate(law_numbers, apex_numbers, plain, values);
    for (std::size_t i = 0; i < rows; ++i) {
      out[i] = values[i].a;
      for (std::size_t j = 0; j < kAll; ++j) jacobian[i * kAll + j] = values[i].derivative(j);
    }
  });

  SolveOptions solving;
  solving.iterations = options.iterations;
  solving.tolerance = 1e-6;
  solving.barrier = 1e-4;
  solving.progress = options.progress;
  const Solution solution = solve(programme, solving);
  FourierResult result;
  result.found = solution.found;
  result.status = solution.status;
  result.violation = solution.violation;
  result.worst = solution.worst;
  result.iterations = solution.iterations;
  result.gait = start;
  if (solution.x.empty()) return result;
  std::array<double, kLaw> law_values;
  std::array<double, kState> apex_values;
  std::copy_n(solution.x.begin(), kLaw, law_values.begin());
  std::copy_n(solution.x.begin() + kLaw, kState, apex_values.begin());
  result.gait.law = FourierParameters<double>::of(law_values);
  result.gait.apex = Apex<double>::of(apex_values);
  result.gait.cost = solution.cost;
  return result;
}

}  // namespace furcula::gait
