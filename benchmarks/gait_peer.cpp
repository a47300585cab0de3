// gait_peer [SECONDS]: the hop in place of document 001 by the way of its authors, beside ours, in one run. Theirs: 49 parameters and the
// state at the apex, one stride by an integrator, forward differences, sequential quadratic programming (there MATLAB's fmincon; here
// NLopt's SLSQP, compiled). Both begin with the same rough gait. Its integrator is ours, which is
// quicker than theirs. Times are the processor's. After SECONDS (60 unless given) the peer is ended, and what it has is told.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <nlopt.hpp>
#include <vector>

#include "host/gait/fourier_gait.hpp"
#include "host/gait/search.hpp"

namespace {

using namespace furcula::gait;
/// Of the processor, s.
double now_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A stride as a function of what is sought.
class Shooting {
 public:
  static constexpr std::size_t kLaw = FourierParameters<double>::kCount, kAll = kLaw + 6, kEqual = 10,
                               kAtLeast = 3;
  static constexpr std::size_t kValues = 1 + kEqual + kAtLeast;
  using Values = std::array<double, kValues>;  ///< cost, what must be zero, what must not be positive

  Shooting(const Machine& machine, const Task& task) : machine_(machine), task_(task) {
    options_.longest_step_s = 3e-3;
    options_.lift_off = task.lift_off;
    scale_.fill(1.0);
    scale_[0] = 10.0;                           // the series' base frequency, rad/s
    std::fill_n(scale_.begin() + 1, 22, 30.0);  // torques, N m
    scale_[kLaw - 2] = scale_[kLaw - 1] = 0.1;  // durations, s
    scale_[kLaw] = 0.1;                         // the hip's height, m
    scale_[kLaw + 4] = scale_[kLaw + 5] = 5.0;  // rates, rad/s
  }

  std::vector<double> point(const FourierGait& gait) const {
    std::vector<double> z;
    for (const double v : gait.law.values()) z.push_back(v / scale_[z.size()]);
    for (const double v : gait.apex.values()) z.push_back(v / scale_[z.size()]);
    return z;
  }

  const Values& at(const std::vector<double>& z) {
    if (z != here_) {
      if (now_s() > end_s_) throw nlopt::forced_stop();
      here_ = z;
      values_ = run(z);
      derived_ = false;
      if (const double off = off_by(values_); off < nearest_off_) {
        nearest_off_ = off;
        nearest_ = z;
      }
    }
    return values_;
  }
  /// Of value `row`, by forward differences.
  void gradient(const std::vector<double>& z, std::size_t row, double* out) {
    at(z);
    if (!derived_) {
      constexpr double kStep = 1.5e-8;  // the square root of the rounding, as fmincon has it
      std::vector<double> moved = z;
      for (std::size_t i = 0; i < kAll; ++i) {
        const double step = kStep * std::max(1.0, std::abs(z[i]));
        moved[i] = z[i] + step;
        const Values there = run(moved);
        for (std::size_t k = 0; k < kValues; ++k) jacobian_[k][i] = (there[k] - values_[k]) / step;
        moved[i] = z[i];
      }
      derived_ = true;
    }
    std::copy(jacobian_[row].begin(), jacobian_[row].end(), out);
  }
  long strides() const { return strides_; }
  /// By how much the constraint is missed that is missed most.
  static double off_by(const Values& v) {
    double most = 0.0;
    for (std::size_t i = 1; i < v.size(); ++i) most = std::max(most, i <= kEqual ? std::abs(v[i]) : v[i]);
    return most;
  }
  /// Of the points that were seen, the one that misses least; empty before the first.
  const std::vector<double>& nearest() const { return nearest_; }
  double nearest_off() const { return nearest_off_; }
  void end_at(double cpu_s) { end_s_ = cpu_s; }

 private:
  Values run(const std::vector<double>& z) {
    ++strides_;
    std::array<double, kLaw> law;
    std::array<double, 6> apex;
    for (std::size_t i = 0; i < kAll; ++i) (i < kLaw ? law[i] : apex[i - kLaw]) = z[i] * scale_[i];
    const FourierLaw<double> f(FourierParameters<double>::of(law));
    const StrideEnd<double> e = run_stride<double>(machine_, f, f, Apex<double>::of(apex), options_);
    Values out;
    out.fill(10.0);  // what falls is far from everything
    if (!e.whole) return out;
    const auto after = e.apex.values();
    out[0] = e.electric;
    for (std::size_t i = 0; i < 6; ++i) out[1 + i] = after[i] - apex[i];
    out[7] = e.rise - law[kLaw - 2];
    out[8] = e.fall - law[kLaw - 1];
    out[9] = e.distance - task_.speed_mps.value_or(0.0) * (e.fall + e.stance + e.rise);
    out[10] = task_.clearance_m ? e.highest_toe - *task_.clearance_m : 0.0;
    out[11] = -e.lowest_toe;
    out[12] = -0.01 * e.least_force_n;
    out[13] = e.joint_excess_rad;
    return out;
  }

  Machine machine_;
  Task task_;
  StrideOptions options_;
  std::array<double, kAll> scale_{};
  std::vector<double> here_;
  Values values_{};
  std::array<std::array<double, kAll>, kValues> jacobian_{};
  bool derived_ = false;
  long strides_ = 0;
  double end_s_ = 1e300, nearest_off_ = 1e300;
  std::vector<double> nearest_;
};

double cost(const std::vector<double>& z, std::vector<double>& gradient, void* data) {
  Shooting& s = *static_cast<Shooting*>(data);
  if (!gradient.empty()) s.gradient(z, 0, gradient.data());
  return s.at(z)[0];
}
void rows(Shooting& s, std::size_t first, unsigned count, double* out, const double* z, double* gradient) {
  const std::vector<double> at(z, z + Shooting::kAll);
  for (unsigned k = 0; k < count; ++k) {
    out[k] = s.at(at)[first + k];
    if (gradient != nullptr) s.gradient(at, first + k, gradient + k * Shooting::kAll);
  }
}
void equal(unsigned count, double* out, unsigned, const double* z, double* gradient, void* data) {
  rows(*static_cast<Shooting*>(data), 1, count, out, z, gradient);
}
void at_least(unsigned count, double* out, unsigned, const double* z, double* gradient, void* data) {
  rows(*static_cast<Shooting*>(data), 1 + Shooting::kEqual, count, out, z, gradient);
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60.0;
  if (!(seconds > 0.0)) {
    std::fprintf(stderr, "gait_peer: '%s' is no number of seconds above 0\n", argv[1]);
    return 2;
  }
  Query query;
  query.machine = spear(LegSpring::switched);
  query.task.clearance_m = 0.075;
  query.fourier = true;
  query.starts = 1;
  const double begin_s = now_s();
  const auto found = find_gait(query);
  const double ours_s = now_s() - begin_s;
  if (!found.gait) {
    std::fprintf(stderr, "gait_peer: no gait was found\n");
    return 1;
  }
  const Evaluation ours = evaluate(*found.gait, false);
  std::printf("collocation, exact derivatives, Ipopt:  %7.2f s  %.4f J  off by at most %.1e\n", ours_s,
              ours.cost_j, ours.closure);
  std::fflush(stdout);

  Shooting shooting(query.machine, query.task);
  const FourierGait start = fourier_near(query.machine, rough_gait(query.machine, query.task, 0));
  std::vector<double> z = shooting.point(start), low(Shooting::kAll, -30.0), high(Shooting::kAll, 30.0);
  low[0] = 0.3, high[0] = 4.0;
  for (const std::size_t duration : {Shooting::kLaw - 2, Shooting::kLaw - 1})
    low[duration] = 0.1, high[duration] = 10.0;
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = std::clamp(z[i], low[i], high[i]);
  nlopt::opt sqp(nlopt::LD_SLSQP, Shooting::kAll);
  sqp.set_lower_bounds(low);
  sqp.set_upper_bounds(high);
  sqp.set_min_objective(cost, &shooting);
  sqp.add_equality_mconstraint(equal, &shooting, std::vector<double>(Shooting::kEqual, 1e-7));
  sqp.add_inequality_mconstraint(at_least, &shooting, std::vector<double>(Shooting::kAtLeast, 1e-7));
  sqp.set_ftol_rel(1e-7);
  double best = 0.0;
  const char* ended = "ended";
  const double peer_s = now_s();
  shooting.end_at(peer_s + seconds);
  // A step into a leg that falls ends a run: then once more from the nearest point, as long as that helps.
  for (double before = 1e300;;) {
    try {
      sqp.optimize(z, best);
      ended = "converged";
    } catch (const nlopt::forced_stop&) {
      ended = "out of time";
      break;
    } catch (const std::exception&) {
      ended = "gave up";
    }
    if (shooting.nearest_off() < 1e-6 || shooting.nearest_off() > 0.9 * before) break;
    before = shooting.nearest_off();
    z = shooting.nearest();
  }
  const double took_s = now_s() - peer_s;
  shooting.end_at(1e300);
  if (Shooting::off_by(shooting.at(z)) > shooting.nearest_off()) z = shooting.nearest();
  const Shooting::Values& last = shooting.at(z);
  std::printf(
      "shooting, forward differences, SLSQP:   %7.2f s  %.4f J  off by at most %.1e  (%s, %ld strides)\n",
      took_s, last[0], Shooting::off_by(last), ended, shooting.strides());
  return 0;
}
