#include "host/walk/return_map.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <optional>

#include "host/core/message.hpp"
#include "host/walk/batched_rollout.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::walk {

using namespace dynamics::biped;

/// A walker between two strides, and its state as a vector.
class PeriodicRollout {
 public:
  using Robot = BatchedRollout<double>;
  using Vector = Eigen::VectorXd;
  static constexpr Eigen::Index kBias = 3 + 6 + 2 * kJoints + 4 * kVertices + 2;
  static constexpr Eigen::Index kSize = kBias + 3 + kJoints + 3 + 6;

  PeriodicRollout(const Description& robot, const RolloutOptions& options, const Parameters& walk,
                  int strides)
      : r_(robot, robot, options), step_s_(options.step_s), steps_(2 * strides) {
    r_.begin(0, {walk, 0});
  }

  /// The direction in which nothing is felt: a bias of the gyro about the vertical, which no accelerometer sees.
  Vector unfelt() const {
    Vector t = Vector::Zero(kSize);
    const auto up = control::up_of(r_.filter_.attitude);
    t.segment<3>(kBias) << up.x, up.y, up.z;
    return t;
  }

  /// Two steps, or as many strides as were asked for. False: it fell.
  bool stride() {
    for (int k = 0; k < steps_; ++k)
      if (!step()) return false;
    return true;
  }
  /// Through a landing, to where the other leg begins to come down.
  bool step() {
    const std::uint32_t before = r_.walk_.steps[0];
    std::vector<Robot> past(3, r_);  // before the last three ticks, in turn
    bool landed = false;
    const double begun_s = r_.time_s_;
    for (std::size_t n = 0; r_.time_s_ - begun_s < kLongest_s; ++n) {
      if (!landed) past[n % 3] = r_;
      r_.tick();
      if (!landed && r_.walk_.steps[0] > before) {
        landed = true;
        // Where a foot made the landing it carried a tick before the one that acted upon it.
        if (const Robot whole = r_; n >= 2) {
          r_ = past[n % 3];
          locate(past[(n + 1) % 3], past[(n + 2) % 3]);
          r_.tick();
          // A landing that is not yet allowed, a part of a tick earlier.
          if (r_.walk_.steps[0] == before) r_ = whole;
        }
      }
      if (r_.off_ > 0.5) return false;
      if (landed && r_.walk_.phase[0] == control::WalkPhase::down) return true;
    }
    return false;
  }

  bool stands_on_left() const { return r_.walk_.on_left[0]; }
  double time_s() const { return r_.time_s_; }
  double energy_j() const {
    return r_.work_ + r_.squares_ * r_.robot(0).m.robot.copper_w_pnm2() +
           r_.robot(0).m.robot.constant_power_w * r_.time_s_;
  }
  double weight_n() const { return r_.robot(0).mass_kg * kCotGravity_mps2; }
  dynamics::tree::Vec3<double> position_m() const { return r_.s_.position_m; }

  Vector state() const {
    Vector x(kSize);
    Eigen::Index n = 0;
    each([&](double v) {
      x(n++) = v;
      return v;
    });
    return x;
  }
  /// Where it is, with that state.
  void set(const Vector& to) {
    Eigen::Index n = 0;
    const Vector from = state();
    each([&](double v) {
      const double out = v + to(n) - from(n);
      ++n;
      return out;
    });
  }

 private:
  static constexpr double kLongest_s = 5.0;  ///< of a step

  /// A tick tells the force of where it began. So the one before the last is cut, that from `first` to `second`: where it ends the foot's force
  /// crosses its threshold. A step that ends by a time ends where it ended.
  void locate(const Robot& first, const Robot& second) {
    const std::size_t foot = r_.walk_.on_left[0] ? kRight : kLeft;
    // A foot carries above its threshold, not at it.
    const double threshold_n = r_.o_.foot_threshold_n * (1.0 + 1e-12);
    if (second.normal_n_[foot] >= threshold_n || r_.normal_n_[foot] <= threshold_n) return;
    const auto cut = [&](double h_s) {
      Robot one = first;
      one.o_.step_s = h_s;
      one.tick();
      one.o_.step_s = step_s_;
      one.tick();
      return one;
    };
    const auto over_n = [&](double h_s) { return cut(h_s).normal_n_[foot] - threshold_n; };
    std::uintmax_t most = 60;
    const double high =
        boost::math::tools::toms748_solve(over_n, 0.0, step_s_, second.normal_n_[foot] - threshold_n,
                                          r_.normal_n_[foot] - threshold_n,
                                          boost::math::tools::eps_tolerance<double>(), most)
            .second;
    r_ = cut(high);
  }

  /// Each number of the state goes through f and becomes what that gives.
  template <class F>
  void each(const F& f) const {
    const_cast<PeriodicRollout*>(this)->each_of(f);
  }
  template <class F>
  void each_of(const F& f) {
    const auto one = [&](double& v) { v = f(v); };
    auto& s = r_.s_;
    one(s.position_m.z);
    RollPitchYaw pelvis = roll_pitch_yaw(s.attitude);
    const double yaw = pelvis.yaw_rad;
    one(pelvis.roll_rad), one(pelvis.pitch_rad);
    s.attitude = attitude_of(pelvis);
    for (auto* v : {&s.w_radps, &s.v_mps})
      for (double* c : {&v->x, &v->y, &v->z}) one(*c);
    for (auto* of : {&s.q_rad, &s.qd_radps})
      for (std::size_t i = 0; i < kJoints; ++i) {
        double v = joint<double>(*of, i);
        one(v);
        set_joint<double>(*of, i, v);
      }
    // Anchors from the pelvis, along its heading.
    const double c = std::cos(yaw), si = std::sin(yaw);
    for (const std::size_t side : {kLeft, kRight})
      for (auto& anchor : s.anchors_m[0]) {
        const double dx = anchor[0][side] - s.position_m.x, dy = anchor[1][side] - s.position_m.y;
        double ahead = c * dx + si * dy, left = c * dy - si * dx;
        one(ahead), one(left);
        anchor[0].set(side, s.position_m.x + c * ahead - si * left);
        anchor[1].set(side, s.position_m.y + si * ahead + c * left);
      }
    RollPitchYaw filter = roll_pitch_yaw(r_.filter_.attitude);
    one(filter.roll_rad), one(filter.pitch_rad);
    r_.filter_.attitude = attitude_of(filter);
    auto& bias = r_.filter_.bias_radps;
    for (double* b : {&bias.x, &bias.y, &bias.z}) one(*b);
    // Targets without feedback, where they are.
    const double share = std::min(r_.walk_.since_s * r_.walk_.inverse_blend_1ps, 1.0);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double rest = joint<double>(r_.walk_.change_rad, i) * share;
      double here = joint<double>(r_.walk_.from_rad, i) + rest;
      one(here);
      set_joint<double>(r_.walk_.from_rad, i, here - rest);
    }
    // Where a knee is braked, and the motor that is not joined to it; else they are not used, and count as 0.
    for (const std::size_t side : {kLeft, kRight}) {
      const bool open = r_.knees_switch() && r_.knee_off_[side] > 0.5;
      for (auto* x :
           {&r_.laws_[0][kKnee].rest_rad, &s.rotors_rad[0][kKneeClutch], &s.rotors_radps[0][kKneeClutch]}) {
        double v = open ? (*x)[side] : 0.0;
        one(v);
        if (open) x->set(side, v);
      }
    }
    // What the accelerometer has felt and the filter has not been told yet.
    for (double* a : {&r_.acc_mps2_.x, &r_.acc_mps2_.y, &r_.acc_mps2_.z}) one(*a);
  }

  Robot r_;
  double step_s_;
  int steps_;
};

namespace {

using Vector = PeriodicRollout::Vector;
using Matrix = Eigen::MatrixXd;

constexpr int kStridesBefore = 12;
constexpr int kMostNewton = 30;
constexpr double kClosed = 5e-8;
constexpr double kDifference = 1e-7;  // of a state, SI units

/// Columns by one stride each, from where `s` is.
std::optional<Matrix> derivatives(const PeriodicRollout& s) {
  const Vector x = s.state();
  Matrix out(x.size(), x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    std::array<Vector, 2> ends;
    for (const std::size_t up : {0u, 1u}) {
      PeriodicRollout one = s;
      Vector there = x;
      there(k) += up == 1 ? kDifference : -kDifference;
      one.set(there);
      if (!one.stride()) return std::nullopt;
      ends[up] = one.state();
    }
    out.col(k) = (ends[1] - ends[0]) / (2.0 * kDifference);
  }
  return out;
}

/// Sizes of the eigenvalues but for the one of direction t, largest first.
std::vector<double> sizes_of_eigenvalues(const Matrix& j, const Vector& t) {
  Eigen::Index k = 0;
  t.cwiseAbs().maxCoeff(&k);
  // States that differ along t are one: that of them whose number k is zero.
  const Matrix left = j - t / t(k) * j.row(k);
  Matrix rest(j.rows() - 1, j.cols() - 1);
  for (Eigen::Index r = 0; r < rest.rows(); ++r)
    for (Eigen::Index c = 0; c < rest.cols(); ++c) rest(r, c) = left(r + (r >= k), c + (c >= k));
  std::vector<double> out;
  for (const auto& value : rest.eigenvalues()) out.push_back(std::abs(value));
  std::sort(out.rbegin(), out.rend());
  return out;
}

}  // namespace

ReturnMap return_map_of(const Description& robot, const RolloutOptions& options, const Parameters& walk,
                        int strides) {
  ReturnMap out;
  if (options.command_delay_s > 0.0) {
    out.none =
        "it is not computed for drives that are late";  // targets on the way to them are no part of the state
    return out;
  }
  RolloutOptions endless = options;
  endless.walk_until_s = 1e9;
  endless.time_s = 1e9;
  endless.steps_a_tick = 1;
  PeriodicRollout s(robot, endless, walk, strides);
  const auto fell = [&] {
    out.none = "it falls after " + core::rounded(s.time_s(), 3) + " s";
    return out;
  };
  do {
    if (!s.step()) return fell();
  } while (!s.stands_on_left());
  for (int k = 0; k < kStridesBefore; ++k)
    if (!s.stride()) return fell();

  // Newton's steps, shortened until they come nearer; where none does, the walk itself goes on by a stride.
  const auto after = [](const PeriodicRollout& from, double& closure) {
    std::optional<PeriodicRollout> end(from);
    if (!end->stride()) return std::optional<PeriodicRollout>{};
    closure = (end->state() - from.state()).cwiseAbs().maxCoeff();
    return end;
  };
  std::optional<PeriodicRollout> end = after(s, out.closure);
  if (!end) return fell();
  std::optional<Matrix> j;
  for (int k = 0; out.closure >= kClosed; ++k) {
    if (k == kMostNewton) {
      out.none =
          "no periodic stride: after a stride the state still differs by " + core::rounded(out.closure, 2);
      return out;
    }
    if (!j) j = derivatives(s);
    if (!j) return fell();
    const Vector x = s.state();
    const Vector step =
        (Matrix::Identity(x.size(), x.size()) - *j).colPivHouseholderQr().solve(end->state() - x);
    bool nearer = false;
    for (double share = 1.0; share > 0.05 && !nearer; share *= 0.5) {
      // From the stride's end, so that what is no part of the state settles too.
      PeriodicRollout next = *end;
      next.set(x + share * step);
      double closure = 0.0;
      std::optional<PeriodicRollout> there = after(next, closure);
      nearer = there && closure < out.closure;
      if (!nearer) continue;
      if (share < 1.0 || closure > 0.3 * out.closure) j.reset();
      s = next;
      end = std::move(there);
      out.closure = closure;
    }
    if (nearer) continue;
    j.reset();
    s = *end;
    end = after(s, out.closure);
    if (!end) return fell();
  }
  const std::clock_t begin = std::clock();
  j = derivatives(s);
  if (!j) return fell();
  out.multipliers = sizes_of_eigenvalues(*j, s.unfelt());
  out.cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const double time_s = s.time_s(), energy_j = s.energy_j();
  const auto from = s.position_m();
  if (!s.stride()) return fell();
  const auto way = s.position_m() - from;
  out.stride_s = s.time_s() - time_s;
  out.stride_m = std::hypot(way.x, way.y);
  out.cot = (s.energy_j() - energy_j) / (s.weight_n() * out.stride_m);
  out.found = true;
  return out;
}

}  // namespace furcula::walk
