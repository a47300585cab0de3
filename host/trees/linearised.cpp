// Windows made linear, see linearised.hpp.
#include "host/trees/linearised.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/trees/batch_runner.hpp"
#include "host/trees/rotor.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;
using Law = dynamics::tree::JointLaw<double>;

/// The run is linear from one time to the next, so far apart.
constexpr double kInterval_s = 5e-3;
/// Changes of the state by whose consequences it is made linear.
constexpr double kAngle_rad = 1e-5, kVelocity_radps = 1e-4;

bool same(const dynamics::tree::Inertia<double>& a, const dynamics::tree::Inertia<double>& b) {
  const auto &s = a.inertia_kgm2, &t = b.inertia_kgm2;
  return a.mass_kg == b.mass_kg && a.moment_kgm.x == b.moment_kgm.x && a.moment_kgm.y == b.moment_kgm.y &&
         a.moment_kgm.z == b.moment_kgm.z && s.xx == t.xx && s.xy == t.xy && s.xz == t.xz && s.yy == t.yy &&
         s.yz == t.yz && s.zz == t.zz;
}

bool same_bodies(const model::RobotModel& a, const model::RobotModel& b) {
  const auto &g = a.gravity_mps2, &h = b.gravity_mps2;
  if (g.x != h.x || g.y != h.y || g.z != h.z) return false;
  for (std::size_t i = 0; i < a.count(); ++i)
    if (!same(a.aligned_inertia(i), b.aligned_inertia(i))) return false;
  return true;
}

/// Dry friction against motion in this direction, 1 or -1, at a place.
double friction(const Law& law, double q, double v, double drive_nm, int direction) {
  const bool within =
      law.binding_friction_nm > 0.0 && std::abs(q - law.binding_centre_rad) <= 0.5 * law.binding_width_rad;
  return direction * friction_in_motion(law, v, drive_nm, direction,
                                        within ? dynamics::tree::Spot::within : dynamics::tree::Spot::none);
}

/// Means over time of what a recording's drives were given. Where the log's clocks are apart, that of after the window counts too.
class Inputs {
 public:
  Inputs(const Recording& r, std::size_t joint, std::size_t last)
      : time_s_(r.time_s), input_(r.input[joint]), interval_s_(r.interval_s) {
    constexpr double kAfter_s = 0.1;
    const double end = r.time_s[last] + kAfter_s;
    while (last + 1 < r.rows() && r.time_s[last] < end) ++last;
    sum_.resize(last + 1);
    for (std::size_t k = 0; k < last; ++k) sum_[k + 1] = sum_[k] + input_[k] * (time_s_[k + 1] - time_s_[k]);
  }
  /// Of what the drive has, over `span_s` from this time on.
  double mean(const Setup::Joint& drive, double from_s, double span_s) const {
    const double now = mean(from_s - drive.delay_s, span_s), share = std::abs(drive.late_rows);
    if (share == 0.0) return now;
    const double row_s = std::copysign(interval_s_, drive.late_rows);
    return (1.0 - share) * now + share * mean(from_s - drive.delay_s - row_s, span_s);
  }

 private:
  double mean(double from_s, double span_s) const {
    return (until(from_s + span_s) - until(from_s)) / span_s;
  }
  double until(double t) const {
    const auto end = time_s_.begin() + static_cast<std::ptrdiff_t>(sum_.size());
    const auto after = std::upper_bound(time_s_.begin(), end, t);
    const auto k = after == time_s_.begin() ? 0U : static_cast<std::size_t>(after - time_s_.begin()) - 1;
    return sum_[k] + input_[k] * (t - time_s_[k]);
  }
  const std::vector<double>&time_s_, &input_;
  double interval_s_;
  std::vector<double> sum_;
};

/// What a joint has more of an elastic drive's torque than of the stiff one that was run, along a window; by the rotor's own equation
/// and the measured angle, in which the spring's consequences are.
class DriveSpring {
 public:
  DriveSpring(const Setup& stiff, const Setup& setup, const Recording& r, const Window& w, std::size_t joint)
      : time_s_(r.time_s), first_(w.first) {
    const Law& law = stiff.model.laws[joint];
    const Setup::Joint& drive = stiff.joints[joint];
    const double damping =
        law.damping_nmspr - (Runner::is_spring(drive) ? drive.gain * drive.kd_nmsprad : 0.0);
    Rotor rotor = Rotor::at(setup, r, joint, w.first);
    impulse_nms_.push_back(rotor.impulse_nms(law.armature_kgm2, damping));
    for (std::size_t k = w.first; k < w.last; ++k) {
      rotor.advance();
      impulse_nms_.push_back(rotor.impulse_nms(law.armature_kgm2, damping));
    }
  }
  double mean_nm(double from_s, double to_s) { return (until(to_s) - until(from_s)) / (to_s - from_s); }

 private:
  /// Called with times that grow, or fall by no more than an interval.
  double until(double t) {
    while (at_ + 2 < impulse_nms_.size() && time_s_[first_ + at_ + 1] < t) ++at_;
    while (at_ > 0 && time_s_[first_ + at_] > t) --at_;
    const double from = time_s_[first_ + at_], to = time_s_[first_ + at_ + 1];
    return impulse_nms_[at_] + (impulse_nms_[at_ + 1] - impulse_nms_[at_]) * (t - from) / (to - from);
  }
  const std::vector<double>& time_s_;
  std::size_t first_, at_ = 0;
  std::vector<double> impulse_nms_;
};

}  // namespace

/// The torque of each joint that is too much for the motion there is.
class Linearised::Torques {
 public:
  Torques(const Setup& setup, const Recording& r, std::size_t first, std::span<const std::size_t> joints)
      : setup_(setup), joints_(joints.begin(), joints.end()) {
    for (const std::size_t i : joints)
      lagged_.push_back(setup.joints[i].lag_s > 0.0 ? lagged_before(setup.joints[i], r, i, first) : 0.0);
  }

  /// Of the k-th of the joints over an interval from `from_s`.
  double left(std::size_t k, const Interval& at, const Inputs& inputs, double from_s, double step_s) {
    const std::size_t i = joints_[k];
    const Setup::Joint& drive = setup_.joints[i];
    const Law& law = setup_.model.laws[i];
    const double q = at.position_rad[i], v = at.velocity_radps[i], measured = q + drive.encoder_offset_rad;
    const double input = inputs.mean(drive, from_s, step_s);
    double asked = asked_torque(drive, input, measured, v);
    if (drive.lag_s > 0.0) asked = passed(drive.lag_s, step_s, asked, lagged_[k]);
    const double torque = drive.offset_nm + made_torque(drive, asked, measured);
    double added = torque, rest = law.rest_rad;
    if (Runner::is_spring(drive)) {
      rest = input - drive.encoder_offset_rad;
      added -= drive.gain * asked;  // the joint's own spring and damper are that
    }
    // A rotor behind a spring goes with its joint, but for what the run made linear has of its own.
    const double rotor_damping_nmspr = law.elastic ? law.rotor_damping_nmspr : 0.0;
    double out = added - passive_torque(law, q - rest + law.rest_rad, v) +
                 one_way_torque(law, q - rest + law.rest_rad) - one_way_torque(law, q) -
                 rotor_damping_nmspr * v - law.armature_kgm2 * at.acceleration_radps2[i];
    if (is_dry(law))
      out -= 0.5 * (1.0 + at.forth[i]) * friction(law, q, v, torque, 1) +
             0.5 * (1.0 - at.forth[i]) * friction(law, q, v, torque, -1);
    return out;
  }
  std::span<const std::size_t> joints() const { return joints_; }

 private:
  const Setup& setup_;
  std::vector<std::size_t> joints_;
  std::vector<double> lagged_;
};

Linearised::Linearised(const Setup& of_all, const Recording& r, const Window& w,
                       std::span<const double> torque_nm)
    : setup_(in_phase(of_all, r, w.first)), recording_(r), window_(w) {
  const Setup& setup = setup_;
  const std::size_t n = setup.joints.size();
  const double begin = r.time_s[w.first], span = r.time_s[w.last] - begin;
  const auto count = static_cast<std::size_t>(std::ceil(span / kInterval_s));
  step_s_ = span / static_cast<double>(count);

  std::vector<Inputs> inputs;
  std::vector<std::size_t> with_state;  // joints whose drive's lag depends on the motion
  std::vector<std::size_t> elastic;
  Runner runner(setup);
  runner.reset(r, w.first, w.angle_rad, w.velocity_radps);
  for (std::size_t i = 0; i < n; ++i) {
    inputs.emplace_back(r, i, w.last);
    const Setup::Joint& j = setup.joints[i];
    if (setup.model.laws[i].elastic) elastic.push_back(i);
    if (j.lag_s > 0.0 && j.law == ControlMode::position) with_state.push_back(i);
  }
  const std::size_t rotors = 2 * n + with_state.size();
  const auto size = static_cast<Index>(rotors + 2 * elastic.size());
  const auto state = [&](const Runner::Place& p) {
    Eigen::VectorXd x(size);
    for (std::size_t i = 0; i < n; ++i) {
      x(static_cast<Index>(i)) = p.plant.position_rad[i];
      x(static_cast<Index>(n + i)) = p.plant.velocity_radps[i];
    }
    for (std::size_t k = 0; k < with_state.size(); ++k)
      x(static_cast<Index>(2 * n + k)) = p.lagged_nm[with_state[k]];
    for (std::size_t k = 0; k < elastic.size(); ++k) {
      x(static_cast<Index>(rotors + 2 * k)) = p.plant.rotor_rad[elastic[k]];
      x(static_cast<Index>(rotors + 2 * k + 1)) = p.plant.rotor_radps[elastic[k]];
    }
    return x;
  };
  std::vector<double> input(n);
  Runner::Place here = runner.place();
  // The run, and those beside it that begin an interval elsewhere, or have a torque more: of what, and which column of it by what change.
  struct Beside {
    Runner::Place place;
    std::size_t torque_at = 0;
    Eigen::MatrixXd* of = nullptr;
    Index column = 0;
    double change = 0.0;
  };
  std::vector<Beside> all;
  const std::vector<const Setup*> of_lanes(BatchRunner::kLanes, &setup);
  std::vector<Runner::Place> places(BatchRunner::kLanes, here);
  std::optional<BatchRunner> batch;
  if (n <= BatchRunner::kMostJoints) batch.emplace(of_lanes, places);
  const auto move_all = [&](std::span<const double> given) {
    if (!batch) {
      for (Beside& b : all) {
        runner.go_to(b.place);
        if (b.of == &intervals_.back().driven) runner.disturb(b.torque_at, b.change);
        runner.advance(given, step_s_);
        runner.disturb(b.torque_at, 0.0);
        b.place = runner.place();
      }
      return;
    }
    const Runner::Place from = all.front().place;
    for (std::size_t first = 1; first < all.size(); first += BatchRunner::kLanes - 1) {
      const auto part = std::span(all).subspan(first, std::min(all.size() - first, BatchRunner::kLanes - 1));
      places.assign(BatchRunner::kLanes, from);
      for (std::size_t k = 0; k < part.size(); ++k) places[k + 1] = part[k].place;
      batch->go_to(places);
      const auto disturb = [&](double share) {
        for (std::size_t k = 0; k < part.size(); ++k)
          if (part[k].of == &intervals_.back().driven)
            batch->disturb(k + 1, part[k].torque_at, share * part[k].change);
      };
      disturb(1.0);
      batch->advance(given, step_s_);
      disturb(0.0);
      for (std::size_t k = 0; k < part.size(); ++k) part[k].place = batch->place(k + 1);
      all.front().place = batch->place(0);
    }
  };
  for (std::size_t g = 0; g < count; ++g) {
    const double from = begin + static_cast<double>(g) * step_s_;
    for (std::size_t i = 0; i < n; ++i) input[i] = inputs[i].mean(setup.joints[i], from, step_s_);
    Interval& at = intervals_.emplace_back();
    at.carried = Eigen::MatrixXd::Zero(size, size);
    at.driven = Eigen::MatrixXd::Zero(size, static_cast<Index>(n));
    all.assign(1, {here});
    const auto change = [&](Index column, double by, auto&& number) {
      Beside& b = all.emplace_back(Beside{here, 0, &at.carried, column, by});
      number(b.place) += by;
    };
    for (std::size_t i = 0; i < n; ++i) {
      const auto a = static_cast<Index>(i);
      change(a, kAngle_rad, [i](Runner::Place& p) -> double& { return p.plant.position_rad[i]; });
      if (!here.plant.mode.held[i])
        change(a + static_cast<Index>(n), kVelocity_radps,
               [i](Runner::Place& p) -> double& { return p.plant.velocity_radps[i]; });
      all.push_back({here, i, &at.driven, a, torque_nm[i]});
    }
    for (std::size_t k = 0; k < with_state.size(); ++k) {
      const std::size_t i = with_state[k];
      change(static_cast<Index>(2 * n + k), torque_nm[i],
             [i](Runner::Place& p) -> double& { return p.lagged_nm[i]; });
    }
    for (std::size_t k = 0; k < elastic.size(); ++k) {
      const std::size_t i = elastic[k];
      change(static_cast<Index>(rotors + 2 * k), kAngle_rad,
             [i](Runner::Place& p) -> double& { return p.plant.rotor_rad[i]; });
      change(static_cast<Index>(rotors + 2 * k + 1), kVelocity_radps,
             [i](Runner::Place& p) -> double& { return p.plant.rotor_radps[i]; });
    }
    move_all(input);
    const Runner::Place next = all.front().place;
    const Eigen::VectorXd end = state(next);
    for (const Beside& b : std::span(all).subspan(1)) b.of->col(b.column) = (state(b.place) - end) / b.change;
    for (std::size_t i = 0; i < n; ++i) {
      const double v0 = here.plant.velocity_radps[i], v1 = next.plant.velocity_radps[i];
      at.position_rad[i] = 0.5 * (here.plant.position_rad[i] + next.plant.position_rad[i]);
      at.velocity_radps[i] = 0.5 * (v0 + v1);
      at.acceleration_radps2[i] = (v1 - v0) / step_s_;
      const double both = std::abs(v0) + std::abs(v1);
      at.forth[i] = both > 0.0 ? (v0 + v1) / both : 0.0;
    }
    at.body_nm = body_torques(setup.model, at.position_rad, at.velocity_radps, at.acceleration_radps2);
    here = next;
  }

  steps_ = runner.steps() + (batch ? batch->steps() : 0);

  const std::size_t bins = static_cast<std::size_t>(w.measured.size()) / n;
  share_.assign(bins, std::vector<double>(count + 1));
  std::vector<double> rows(bins);
  for (const std::size_t b : w.bin) rows[b] += 1.0;
  for (std::size_t k = w.first; k <= w.last; ++k) {
    const std::size_t b = w.bin[k - w.first];
    const double t = (r.time_s[k] - begin) / step_s_;
    const std::size_t g = std::min(count - 1, static_cast<std::size_t>(t));
    const double after = std::clamp(t - static_cast<double>(g), 0.0, 1.0);
    share_[b][g] += (1.0 - after) / rows[b];
    share_[b][g + 1] += after / rows[b];
  }
}

Eigen::MatrixXd Linearised::changes(std::span<const Setup* const> of_all) const {
  std::vector<Setup> here;
  std::vector<const Setup*> setups(of_all.begin(), of_all.end());
  if (setup_.by_phase) {
    here.reserve(setups.size());
    for (const Setup*& s : setups) s = &here.emplace_back(in_phase(*s, recording_, window_.first));
  }
  const std::size_t n = setup_.joints.size();
  const auto columns = static_cast<Index>(setups.size()), joints = static_cast<Index>(n);
  std::vector<std::size_t> all;
  std::vector<Inputs> inputs;
  for (std::size_t i = 0; i < n; ++i) {
    all.push_back(i);
    inputs.emplace_back(recording_, i, window_.last);
  }
  Torques as_run(setup_, recording_, window_.first, all);
  std::vector<Torques> others;
  std::vector<std::vector<std::pair<std::size_t, DriveSpring>>> springs(setups.size());
  std::vector<bool> other_bodies;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(intervals_.front().carried.rows(), columns);
  Eigen::MatrixXd read = Eigen::MatrixXd::Zero(joints, columns);  // angles, the encoder's change in them
  for (std::size_t k = 0; k < setups.size(); ++k) {
    const Setup& s = *setups[k];
    std::vector<std::size_t> differ;
    for (std::size_t i = 0; i < n; ++i) {
      if (s.joints[i] == setup_.joints[i] && s.model.laws[i] == setup_.model.laws[i]) continue;
      if (s.model.laws[i].elastic && !setup_.model.laws[i].elastic) {
        springs[k].emplace_back(i, DriveSpring(setup_, s, recording_, window_, i));
        continue;
      }
      differ.push_back(i);
      const double offset = s.joints[i].encoder_offset_rad - setup_.joints[i].encoder_offset_rad;
      x(static_cast<Index>(i), static_cast<Index>(k)) = -offset;
      read(static_cast<Index>(i), static_cast<Index>(k)) = offset;
    }
    others.emplace_back(s, recording_, window_.first, differ);
    other_bodies.push_back(!same_bodies(s.model, setup_.model));
  }
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(window_.measured.size(), columns);
  const auto seen_at = [&](std::size_t g) {
    for (std::size_t b = 0; b < share_.size(); ++b)
      if (share_[b][g] != 0.0)
        out.middleRows(static_cast<Index>(b) * joints, joints) += share_[b][g] * (x.topRows(joints) + read);
  };
  seen_at(0);
  Eigen::MatrixXd torque(joints, columns);
  std::vector<double> left(n);
  for (std::size_t g = 0; g < intervals_.size(); ++g) {
    const Interval& at = intervals_[g];
    const double from = recording_.time_s[window_.first] + static_cast<double>(g) * step_s_;
    for (std::size_t i = 0; i < n; ++i) left[i] = as_run.left(i, at, inputs[i], from, step_s_);
    torque.setZero();
    for (std::size_t k = 0; k < setups.size(); ++k) {
      const auto c = static_cast<Index>(k);
      const auto differ = others[k].joints();
      for (std::size_t d = 0; d < differ.size(); ++d)
        torque(static_cast<Index>(differ[d]), c) =
            others[k].left(d, at, inputs[differ[d]], from, step_s_) - left[differ[d]];
      for (auto& [i, spring] : springs[k])
        torque(static_cast<Index>(i), c) = spring.mean_nm(from, from + step_s_);
      if (!other_bodies[k]) continue;
      const Joints body =
          body_torques(setups[k]->model, at.position_rad, at.velocity_radps, at.acceleration_radps2);
      for (std::size_t i = 0; i < n; ++i) torque(static_cast<Index>(i), c) -= body[i] - at.body_nm[i];
    }
    x = (at.carried * x + at.driven * torque).eval();
    seen_at(g + 1);
  }
  // A run that flies apart says no more than that it does.
  return out.unaryExpr(
      [](double change) { return std::isfinite(change) ? std::clamp(change, -1e6, 1e6) : 0.0; });
}

Eigen::MatrixXd Linearised::of_torques(std::size_t slices) const {
  const auto joints = static_cast<Index>(setup_.joints.size()), parts = static_cast<Index>(slices);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(intervals_.front().carried.rows(), joints * parts);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(window_.measured.size(), joints * parts);
  for (std::size_t g = 0; g < intervals_.size(); ++g) {
    x = (intervals_[g].carried * x).eval();
    const auto part = static_cast<Index>(g * slices / intervals_.size());
    for (Index j = 0; j < joints; ++j) x.col(j * parts + part) += intervals_[g].driven.col(j);
    for (std::size_t b = 0; b < share_.size(); ++b)
      if (share_[b][g + 1] != 0.0)
        out.middleRows(static_cast<Index>(b) * joints, joints) += share_[b][g + 1] * x.topRows(joints);
  }
  return out.unaryExpr(
      [](double change) { return std::isfinite(change) ? std::clamp(change, -1e6, 1e6) : 0.0; });
}

Eigen::MatrixXd Linearised::rotor_starts(std::span<const Setup* const> setups) const {
  const std::size_t n = setup_.joints.size();
  const auto joints = static_cast<Index>(n), columns = static_cast<Index>(2 * setups.size());
  struct Swing {
    std::size_t joint;
    const Law* law;
    Index column;
    double angle_rad, rate_radps;
    double impulse_nms() const {
      return -law->armature_kgm2 * rate_radps - law->rotor_damping_nmspr * angle_rad;
    }
  };
  std::vector<Swing> all;
  for (std::size_t k = 0; k < setups.size(); ++k)
    for (std::size_t i = 0; i < n; ++i) {
      const Law& law = setups[k]->model.laws[i];
      if (!law.elastic || setup_.model.laws[i].elastic) continue;
      all.push_back({i, &law, static_cast<Index>(2 * k), 1.0, 0.0});
      all.push_back({i, &law, static_cast<Index>(2 * k + 1), 0.0, 1.0});
    }
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(intervals_.front().carried.rows(), columns);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(window_.measured.size(), columns);
  for (std::size_t g = 0; g < intervals_.size(); ++g) {
    x = (intervals_[g].carried * x).eval();
    for (Swing& s : all) {
      const double before = s.impulse_nms();
      swing(*s.law, step_s_, s.angle_rad, s.rate_radps);
      x.col(s.column) +=
          intervals_[g].driven.col(static_cast<Index>(s.joint)) * ((s.impulse_nms() - before) / step_s_);
    }
    for (std::size_t b = 0; b < share_.size(); ++b)
      if (share_[b][g + 1] != 0.0)
        out.middleRows(static_cast<Index>(b) * joints, joints) += share_[b][g + 1] * x.topRows(joints);
  }
  return out.unaryExpr(
      [](double change) { return std::isfinite(change) ? std::clamp(change, -1e6, 1e6) : 0.0; });
}

}  // namespace furcula::trees
