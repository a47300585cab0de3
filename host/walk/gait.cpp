#include "host/walk/gait.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <utility>

#include "host/optimise/graph.hpp"
#include "host/optimise/nlp.hpp"

namespace furcula::walk {

using namespace biped;
using optimise::Graph;
using optimise::GraphElement;
using optimise::Nlp;
using optimise::Recorded;
using optimise::Spline;
using optimise::Sum;

namespace {

constexpr std::size_t kSwingIntervals = 6, kBothIntervals = 1;
constexpr double kRoom = 0.98;         // of limits, kept at the moments, so that they hold between them
constexpr double kApartRoom_m = 0.02;  // what follows the gait is never quite on it
constexpr double kForce_n = 100.0;     // a wrench's coefficients in the programme are shares of this
constexpr std::array<std::size_t, kJoints> kMirror{6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5};

bool passive(WalkMode mode, std::size_t joint) {
  return mode == WalkMode::semi_passive && joint % kLegJoints == kHipPitch;
}
/// Of an angle in a mirror: yaw and roll change sign.
double mirror_sign(std::size_t joint) {
  return DesignTopology::kAxes[joint % kLegJoints] == Axis::y ? 1.0 : -1.0;
}

/// Gear friction, rounded where the joint turns back.
template <class T>
T gear_nm(const Description& d, std::size_t joint, const T& qd) {
  using std::sqrt;
  const Drive<double>& drive = d.drives[joint / kLegJoints][joint % kLegJoints];
  const T x = qd * (1.0 / d.creep_radps);
  return qd * drive.damping_nmspr + x / sqrt(x * x + 1.0) * drive.friction_nm;
}

template <class T>
JointNumbers<T> motors(const Description& d, WalkMode mode, const JointNumbers<T>& qd,
                       const JointNumbers<T>& qdd, const Stance<T>& s) {
  JointNumbers<T> out;
  for (std::size_t i = 0; i < kJoints; ++i)
    out[i] = (passive(mode, i) ? T(qdd[i] * d.drives[i / kLegJoints][i % kLegJoints].armature_kgm2)
                               : s.torque_nm[i]) +
             gear_nm(d, i, qd[i]);
  return out;
}

/// What a passive hip needs beside its spring and its damping.
template <class T>
T spring_off_nm(const Description& d, std::size_t joint, const T& q, const T& qd, const Stance<T>& s) {
  const Clutch<double>& c = d.clutches[joint / kLegJoints][kHipClutch];
  return s.body_nm[joint] + (q - c.spring_rest_rad) * c.spring_nmprad + qd * c.damping_nmspr;
}

/// What stands in the way under a foot that stands, each at least 0; N or N m. `f` is about its ankle.
template <class T>
struct Contact {
  T front, rear, left, right, cone, turn_left, turn_right;
};
template <class T>
Contact<T> contact(const Description& d, const GaitTask& task, std::size_t side, const Force<T>& f) {
  double front = -1.0, rear = 1.0, left = -1.0, right = 1.0;
  const double down = d.vertices_m[side][0].z;
  for (const auto& v : d.vertices_m[side]) {
    front = std::max(front, v.x), rear = std::min(rear, v.x);
    left = std::max(left, v.y), right = std::min(right, v.y);
  }
  const double m = task.sole_margin_m;
  // About the point of the sole under the ankle; the centre of pressure is at (-ny, nx) / load.
  const Vec3<T> n = f.n - cross(Vec3<double>{0.0, 0.0, down}, f.f);
  const T load = f.f.z;
  const double mu = d.ground.friction;
  const T turn = load * (mu * task.yaw_arm_m);
  return {load * (front - m) + n.y,
          load * -(rear + m) - n.y,
          load * (left - m) - n.x,
          load * -(right + m) + n.x,
          (load * load * (mu * mu) - f.f.x * f.f.x - f.f.y * f.f.y) * (1.0 / 500.0),
          turn - n.z,
          turn + n.z};
}

template <class T>
Vec3<T> apart(const Stance<T>& s) {
  // The left ankle is the world's origin.
  return transposed_times(s.pelvis.rotation, -s.swing_foot.at_m);
}
template <class T>
std::array<T, kVertices> corners_m(const Description& d, const Stance<T>& s) {
  std::array<T, kVertices> out;
  for (std::size_t i = 0; i < kVertices; ++i)
    out[i] = s.swing_foot.at_m.z + dot(s.swing_foot.rotation.z, d.vertices_m[kRight][i]) -
             d.vertices_m[kLeft][0].z;
  return out;
}

}  // namespace

JointNumbers<double> motor_torques(const Description& robot, WalkMode mode, const GaitPhase::At& at,
                                   const Stance<double>& stance) {
  return motors(robot, mode, at.qd, at.qdd, stance);
}

GaitPhase::At GaitPhase::at(double time_s) const {
  At out;
  const Spline spline(joints[0].size() - Spline::kDegree);
  const Spline::Basis b = spline.basis(time_s / duration_s);
  std::array<double, 6> w{};
  for (std::size_t i = 0; i < kJoints; ++i) out.q[i] = out.qd[i] = out.qdd[i] = 0.0;
  for (std::size_t k = 0; k < Spline::kOrder; ++k) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double c = joints[i][b.first + k];
      out.q[i] += b.share[0][k] * c;
      out.qd[i] += b.share[1][k] * c / duration_s;
      out.qdd[i] += b.share[2][k] * c / (duration_s * duration_s);
    }
    if (both)
      for (std::size_t i = 0; i < 6; ++i) w[i] += b.share[0][k] * wrench[i][b.first + k];
  }
  out.other = {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}};
  return out;
}

double Gait::duration_s() const {
  double sum = 0.0;
  for (const GaitPhase& p : phases) sum += p.duration_s;
  return sum;
}

std::pair<const GaitPhase*, double> Gait::phase_at(double time_s) const {
  for (const GaitPhase& p : phases) {
    if (time_s <= p.duration_s || &p == &phases.back()) return {&p, std::min(time_s, p.duration_s)};
    time_s -= p.duration_s;
  }
  return {nullptr, 0.0};
}

namespace {

/// Angles, their first and second derivatives by the phase's own time from 0 to 1, the phase's duration, and the other foot's wrench.
struct PhaseInputs {
  static constexpr std::size_t kDuration = 3 * kJoints, kWrench = kDuration + 1;
  static constexpr std::size_t count(bool both) { return both ? kWrench + 6 : kWrench; }

  JointNumbers<Recorded> q, qd, qdd;
  Force<Recorded> other;

  PhaseInputs(const std::vector<Recorded>& x, bool both) {
    const Recorded rate = Recorded(1.0) / x[kDuration];
    for (std::size_t i = 0; i < kJoints; ++i) {
      q[i] = x[3 * i];
      qd[i] = x[3 * i + 1] * rate;
      qdd[i] = x[3 * i + 2] * rate * rate;
    }
    if (!both) return;
    const auto w = [&](std::size_t i) { return x[kWrench + i] * kForce_n; };
    other = {{w(0), w(1), w(2)}, {w(3), w(4), w(5)}};
  }
};

/// An output of the graph at a moment of a phase, as a row of the programme.
struct Kind {
  const char* what;
  double lower, upper;
};
constexpr double kNone = optimise::kNoBound;

class StepNlp {
 public:
  StepNlp(const Description& robot, const GaitTask& task) : d_(robot), task_(task), dynamics_(robot) {
    cot_ = p_.variable(0.0, 1e3, 3.0);
    step_ = p_.variable(0.02, 1.0, 0.15);
    wide_ = p_.variable(task.limits.apart_m, std::max(0.6, task.limits.apart_m), 0.18);
    p_.linear(0, {{cot_, 1.0}});
    energy_ = p_.row(optimise::kCostRow, 0.0, 0.0);
    // Energy in units of m g times a metre, which is what the cost of transport is times the step.
    p_.element(std::array<Sum, 2>{Sum{{cot_, 1.0}}, Sum{{step_, 1.0}}}, std::array<int, 1>{energy_},
               [](const auto& z) {
                 using T = std::decay_t<decltype(z[0])>;
                 return std::array<T, 1>{z[0] * z[1] * -1.0};
               });
    add_phase(false, kSwingIntervals, 0.5, 0.2, 3.0);
    if (task.double_support_s > 0.0)
      add_phase(true, kBothIntervals, std::max(0.15, task.double_support_s), task.double_support_s,
                std::max(1.0, task.double_support_s));
    for (std::size_t k = 0; k < phases_.size(); ++k) add_points(k);
    join();
    add_landing();
    if (task.speed_mps) {
      const int row = p_.row("the speed that is asked", 0.0, 0.0);
      p_.linear(row, {{step_, 1.0}});
      for (const Phase& phase : phases_) p_.linear(row, {{phase.duration, -*task.speed_mps}});
    }
  }

  Nlp& nlp() { return p_; }

  Gait gait(const std::vector<double>& x) const {
    Gait out;
    out.step_m = x[static_cast<std::size_t>(step_)], out.step_width_m = x[static_cast<std::size_t>(wide_)];
    for (const Phase& phase : phases_) {
      GaitPhase g;
      g.both = phase.both;
      g.duration_s = x[static_cast<std::size_t>(phase.duration)];
      for (std::size_t i = 0; i < kJoints; ++i)
        for (const int v : phase.joints[i]) g.joints[i].push_back(x[static_cast<std::size_t>(v)]);
      for (std::size_t i = 0; i < 6; ++i)
        for (const int v : phase.wrench[i]) g.wrench[i].push_back(kForce_n * x[static_cast<std::size_t>(v)]);
      out.phases.push_back(std::move(g));
    }
    return out;
  }

 private:
  struct Phase {
    bool both;
    std::size_t intervals;
    int duration;
    std::array<std::vector<int>, kJoints> joints;
    std::array<std::vector<int>, 6> wrench;
  };

  void add_phase(bool both, std::size_t intervals, double start_s, double least_s, double most_s) {
    constexpr double kKnee = 0.5;
    Phase phase{both, intervals, p_.variable(least_s, most_s, start_s), {}, {}};
    const std::size_t n = Spline(intervals).coefficients();
    const double range = task_.limits.range_rad;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t j = i % kLegJoints;
      double start = 0.0;
      if (j == kHipPitch || j == kAnklePitch) start = -0.5 * kKnee;
      if (j == kKnee_) start = kKnee;
      if (passive(task_.mode, i)) start = 0.0;
      for (std::size_t k = 0; k < n; ++k)
        if (j == kHipYaw && task_.yaw_held)
          phase.joints[i].push_back(p_.variable(0.0, 0.0, 0.0));
        else
          phase.joints[i].push_back(p_.variable(j == kKnee_ ? task_.least_knee_rad : -range, range, start));
    }
    if (both)
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < n; ++k)
          phase.wrench[i].push_back(p_.variable(-10.0, 10.0, i == 5 ? 2.5 : 0.0));
    phases_.push_back(std::move(phase));
  }

  Sum at(const std::vector<int>& coefficients, const Spline::Basis& b, std::size_t derivative) const {
    Sum sum;
    for (std::size_t k = 0; k < Spline::kOrder; ++k)
      if (const double share = b.share[derivative][k]; share != 0.0)
        sum.emplace_back(coefficients[b.first + k], share);
    return sum;
  }

  /// The graph of one moment, and what its outputs are.
  std::pair<std::shared_ptr<const Graph>, std::vector<Kind>> moment(bool both) const {
    std::vector<Kind> kinds;
    const WalkLimits& limits = task_.limits;
    const double heat = d_.copper_w_pnm2(), weight = d_.mass_kg() * kCotGravity_mps2;
    auto graph = std::make_shared<const Graph>(PhaseInputs::count(both), [&](const std::vector<Recorded>& x) {
      std::vector<Recorded> out;
      const auto put = [&](const Recorded& value, double scale, const char* what, double lower,
                           double upper) {
        out.push_back(value * (1.0 / scale));
        kinds.push_back(
            {what, lower == -kNone ? lower : lower / scale, upper == kNone ? upper : upper / scale});
      };
      const PhaseInputs in(x, both);
      const Stance<Recorded> s = dynamics_(in.q, in.qd, in.qdd, in.other);
      const auto motor = motors(d_, task_.mode, in.qd, in.qdd, s);
      Recorded watts(d_.constant_power_w);
      for (std::size_t i = 0; i < kJoints; ++i) watts += motor[i] * in.qd[i] + motor[i] * motor[i] * heat;
      put(watts * x[PhaseInputs::kDuration], weight, optimise::kCostRow, -kNone, kNone);  // first: the energy
      for (std::size_t i = 0; i < kJoints; ++i)
        if (passive(task_.mode, i)) {
          put(spring_off_nm(d_, i, in.q[i], in.qd[i], s), 50.0, "a passive hip has no more than its spring",
              0.0, 0.0);
        } else {
          // With the gear's friction against either direction: where the joint turns back it jumps, and would jump over the limit between
          // two moments.
          const Drive<double>& drive = d_.drives[i / kLegJoints][i % kLegJoints];
          const double most = std::max(kRoom * limits.torque_nm - drive.friction_nm, 0.01);
          put(s.torque_nm[i] + in.qd[i] * drive.damping_nmspr, 50.0, "the motors' torque", -most, most);
        }
      const auto stands = [&](std::size_t side, const Force<Recorded>& f) {
        const auto c = contact(d_, task_, side, f);
        for (const Recorded& edge : {c.front, c.rear, c.left, c.right})
          put(edge, 20.0, "a foot's centre of pressure stays inside its sole", 0.0, kNone);
        put(c.cone, 100.0, "friction under a foot", 0.0, kNone);
        for (const Recorded& turn : {c.turn_left, c.turn_right})
          put(turn, 20.0, "friction under a foot that turns", 0.0, kNone);
        for (const Recorded& n : {f.n.x, f.n.y})
          put(n, 50.0, "a foot's contact moment", -kRoom * limits.moment_nm, kRoom * limits.moment_nm);
      };
      stands(kLeft, s.foot);
      if (both) stands(kRight, in.other);
      put(s.pelvis.at_m.z - d_.vertices_m[kLeft][0].z, 1.0, "the pelvis' height", limits.height_m, kNone);
      put(apart(s).y, 0.2, "the feet's distance", limits.apart_m + kApartRoom_m, kNone);
      if (!both)
        for (const Recorded& z : corners_m(d_, s)) put(z, 0.05, "the swing foot's clearance", 0.0, kNone);
      return out;
    });
    return {graph, kinds};
  }

  void add_points(std::size_t which) {
    const Phase& phase = phases_[which];
    const auto recorded = moment(phase.both);
    const auto& graph = recorded.first;  // clang 14 lets no lambda have a structured binding
    const auto& kinds = recorded.second;
    const Spline spline(phase.intervals);
    const auto n = static_cast<double>(phase.intervals);
    const auto point = [&](double s, std::size_t interval, double weight) {
      const Spline::Basis b = spline.basis(s, interval);
      std::vector<Sum> inputs;
      for (std::size_t i = 0; i < kJoints; ++i)
        for (std::size_t d = 0; d < 3; ++d) inputs.push_back(at(phase.joints[i], b, d));
      inputs.push_back({{phase.duration, 1.0}});
      if (phase.both)
        for (std::size_t i = 0; i < 6; ++i) inputs.push_back(at(phase.wrench[i], b, 0));
      std::vector<int> rows;
      std::vector<double> factors(kinds.size(), 1.0);
      std::size_t corner = 0;
      for (std::size_t m = 0; m < kinds.size(); ++m) {
        Kind k = kinds[m];
        if (m == 0) {
          rows.push_back(weight > 0.0 ? energy_ : -1);
          factors[m] = weight;
          continue;
        }
        if (std::string_view(k.what) == "the swing foot's clearance") {
          ++corner;
          k.lower = 16.0 * s * s * (1.0 - s) * (1.0 - s) * task_.clearance_m / 0.05;
          if (weight == 0.0) {  // at its ends the swing foot stands
            rows.push_back(-1);
            continue;
          }
        }
        rows.push_back(p_.row(k.what, k.lower, k.upper));
      }
      p_.add(std::make_unique<GraphElement>(graph, std::move(inputs), std::move(rows), std::move(factors)));
      for (std::size_t i = 0; i < kJoints; ++i) {
        if (passive(task_.mode, i) || held(i)) continue;
        const Sum rate = at(phase.joints[i], b, 1);
        for (const double sign : {1.0, -1.0}) {
          const int row = p_.row("the joints' speed", -kNone, 0.0);
          for (const auto& [v, f] : rate) p_.linear(row, {{v, sign * f}});
          p_.linear(row, {{phase.duration, -kRoom * task_.limits.speed_radps}});
        }
      }
    };
    for (std::size_t k = 0; k < phase.intervals; ++k)
      for (const optimise::GaussPoint& g : optimise::kGauss)
        point((static_cast<double>(k) + g.at) / n, k, g.weight / n);
    point(0.0, 0, 0.0);
    point(1.0, phase.intervals - 1, 0.0);
  }

  /// Angles and rates go on from phase to phase, and from the end to the mirrored beginning.
  void join() {
    for (std::size_t k = 0; k < phases_.size(); ++k) {
      const Phase& here = phases_[k];
      const bool last = k + 1 == phases_.size();
      const Phase& next = phases_[last ? 0 : k + 1];
      const Spline::Basis end = Spline(here.intervals).basis(1.0, here.intervals - 1),
                          begin = Spline(next.intervals).basis(0.0, 0);
      for (std::size_t i = 0; i < kJoints; ++i) {
        if (held(i)) continue;
        const std::size_t to = last ? kMirror[i] : i;
        const double sign = last ? mirror_sign(i) : 1.0;
        const char* what = last ? "the end is the beginning's mirror image" : "the phases are joined";
        const Sum value = at(here.joints[i], end, 0), next_value = at(next.joints[to], begin, 0);
        const int row = p_.row(what, 0.0, 0.0);
        p_.linear(row, value);
        for (const auto& [v, f] : next_value) p_.linear(row, {{v, -sign * f}});
        const Sum rate = at(here.joints[i], end, 1), next_rate = at(next.joints[to], begin, 1);
        const int rates = p_.row(what, 0.0, 0.0);
        if (here.duration == next.duration) {
          p_.linear(rates, rate);
          for (const auto& [v, f] : next_rate) p_.linear(rates, {{v, -sign * f}});
        } else {
          // rate / duration = next rate / its duration
          p_.element(
              std::array<Sum, 4>{rate, Sum{{here.duration, 1.0}}, next_rate, Sum{{next.duration, 1.0}}},
              std::array<int, 1>{rates}, [sign](const auto& z) {
                using T = std::decay_t<decltype(z[0])>;
                return std::array<T, 1>{z[0] * z[3] - z[2] * z[1] * sign};
              });
        }
      }
    }
  }

  /// The right foot is flat on the ground, one step ahead, and stays there: where it is, how it moves, how that changes.
  void add_landing() {
    const auto graph =
        std::make_shared<const Graph>(PhaseInputs::count(false) + 2, [&](const std::vector<Recorded>& x) {
          const PhaseInputs in(x, false);
          const Stance<Recorded> s = dynamics_(in.q, in.qd, in.qdd, {});
          const Moving<Recorded>& f = s.swing_foot;
          const Recorded &step = x[PhaseInputs::count(false)], &wide = x[PhaseInputs::count(false) + 1];
          const Vec3<Recorded> still =
              f.a_mps2 - transposed_times(f.rotation, Vec3<double>{0.0, 0.0, d_.gravity_mps2});
          return std::vector<Recorded>{
              f.at_m.x - step, f.at_m.y + wide, f.at_m.z,  f.rotation.z.x, f.rotation.z.y, f.rotation.y.x,
              f.v_mps.x,       f.v_mps.y,       f.v_mps.z, f.w_radps.x,    f.w_radps.y,    f.w_radps.z,
              still.x,         still.y,         still.z,   f.wd_radps2.x,  f.wd_radps2.y,  f.wd_radps2.z};
        });
    const auto place = [&](const Phase& phase, double s, bool stays, bool placed) {
      const Spline::Basis b = Spline(phase.intervals).basis(s, s > 0.5 ? phase.intervals - 1 : 0);
      std::vector<Sum> inputs;
      for (std::size_t i = 0; i < kJoints; ++i)
        for (std::size_t d = 0; d < 3; ++d) inputs.push_back(at(phase.joints[i], b, d));
      inputs.push_back({{phase.duration, 1.0}});
      inputs.push_back({{step_, 1.0}});
      inputs.push_back({{wide_, 1.0}});
      std::vector<int> rows;
      std::vector<double> factors;
      for (std::size_t m = 0; m < 18; ++m) {
        const bool used = m < 12 ? placed : stays;
        rows.push_back(!used ? -1
                             : p_.row(m < 6    ? "the swing foot lands flat, one step ahead"
                                      : m < 12 ? "the swing foot lands without an impact"
                                               : "both feet stay where they are",
                                      0.0, 0.0));
        factors.push_back(m < 12 ? 1.0 : 0.1);
      }
      p_.add(std::make_unique<GraphElement>(graph, std::move(inputs), std::move(rows), std::move(factors)));
    };
    for (std::size_t k = 0; k < phases_.size(); ++k) {
      if (phases_[k].both) place(phases_[k], 0.0, true, false);
      place(phases_[k], 1.0, phases_[k].both, true);
    }
  }

  bool held(std::size_t i) const { return task_.yaw_held && i % kLegJoints == kHipYaw; }

  static constexpr std::size_t kKnee_ = biped::kKnee;
  const Description& d_;
  const GaitTask& task_;
  StanceDynamics<Recorded> dynamics_;
  Nlp p_;
  std::vector<Phase> phases_;
  int cot_ = 0, step_ = 0, wide_ = 0, energy_ = 0;
};

}  // namespace

GaitResult find_gait(const Description& robot, const GaitTask& task) {
  const std::clock_t begin = std::clock();
  GaitResult out;
  StepNlp step(robot, task);
  optimise::SolveOptions options;
  options.iterations = 300;
  options.tolerance = 1e-5;
  options.cpu_s = task.cpu_s;
  options.progress = [&](int iteration, double cost, double violation) {
    if (task.progress) task.progress(iteration, cost, violation);
    return true;
  };
  optimise::Solution s = optimise::solve(step.nlp(), options);
  const double left_s = task.cpu_s - static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  if (!s.found && left_s > 0.0) {
    // With Ipopt 3.14 of Debian 13 the adaptive barrier gets stuck at some speeds.
    options.cpu_s = left_s;
    options.monotone = true;
    optimise::Solution again = optimise::solve(step.nlp(), options);
    if (again.found) s = std::move(again);
  }
  out.found = s.found;
  out.status = s.status;
  out.iterations = s.iterations;
  out.against = s.worst;
  out.broken_by = s.violation;
  if (!s.x.empty()) {
    out.gait = step.gait(s.x);
    out.figures = figures_of(robot, task, out.gait);
  }
  out.cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return out;
}

GaitFigures figures_of(const Description& robot, const GaitTask& task, const Gait& gait) {
  GaitFigures out;
  out.height_m = out.apart_m = out.load_n = out.pressure_m = out.least_knee_rad = out.sole_m =
      std::numeric_limits<double>::infinity();
  const StanceDynamics<double> dynamics(robot);
  const double heat = robot.copper_w_pnm2();
  GaitTask bare = task;
  bare.sole_margin_m = 0.0;
  constexpr int kFine = 400;
  for (const GaitPhase& phase : gait.phases)
    for (int k = 0; k <= kFine; ++k) {
      // Trapezoids: ends count half.
      const double dt = phase.duration_s / kFine * (k == 0 || k == kFine ? 0.5 : 1.0);
      const GaitPhase::At at = phase.at(phase.duration_s * k / kFine);
      const Stance<double> s = dynamics(at.q, at.qd, at.qdd, at.other);
      const auto motor = motor_torques(robot, task.mode, at, s);
      for (std::size_t i = 0; i < kJoints; ++i) {
        const double work = motor[i] * at.qd[i] * dt;
        out.work_j += work;
        out.positive_work_j += std::max(work, 0.0);
        out.copper_j += motor[i] * motor[i] * heat * dt;
        out.range_rad = std::max(out.range_rad, std::abs(at.q[i]));
        if (i % kLegJoints == kKnee) out.least_knee_rad = std::min(out.least_knee_rad, at.q[i]);
        if (passive(task.mode, i)) {
          out.spring_off_nm =
              std::max(out.spring_off_nm, std::abs(spring_off_nm(robot, i, at.q[i], at.qd[i], s)));
          continue;
        }
        out.torque_nm = std::max(out.torque_nm, std::abs(motor[i]));
        out.speed_radps = std::max(out.speed_radps, std::abs(at.qd[i]));
      }
      out.constant_j += robot.constant_power_w * dt;
      const auto foot = [&](std::size_t side, const Force<double>& f) {
        out.moment_nm = std::max({out.moment_nm, std::abs(f.n.x), std::abs(f.n.y)});
        out.load_n = std::min(out.load_n, f.f.z);
        out.friction = std::max(out.friction, std::hypot(f.f.x, f.f.y) / f.f.z);
        const auto c = contact(robot, bare, side, f);
        out.pressure_m = std::min(out.pressure_m, std::min({c.front, c.rear, c.left, c.right}) / f.f.z);
      };
      foot(kLeft, s.foot);
      if (phase.both) foot(kRight, at.other);
      out.height_m = std::min(out.height_m, s.pelvis.at_m.z - robot.vertices_m[kLeft][0].z);
      out.apart_m = std::min(out.apart_m, apart(s).y);
      for (const double z : corners_m(robot, s)) out.sole_m = std::min(out.sole_m, z);
    }
  out.energy_j = out.work_j + out.copper_j + out.constant_j;
  out.cot = out.energy_j / (robot.mass_kg() * kCotGravity_mps2 * gait.step_m);
  return out;
}

}  // namespace furcula::walk
