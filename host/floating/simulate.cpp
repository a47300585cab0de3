#include "host/floating/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "furcula/dynamics/biped/contact.hpp"
#include "furcula/dynamics/biped/joint_laws.hpp"
#include "furcula/dynamics/biped/step.hpp"
#include "host/biped/put_robot.hpp"

namespace furcula::floating {
namespace {

using namespace dynamics::biped;
using dynamics::clamped;
using dynamics::SimdBatch;

#ifdef __AVX512F__
constexpr std::size_t kLanes = 8;
#else
constexpr std::size_t kLanes = 4;
#endif
using T = SimdBatch<double, kLanes>;
using L = LegScalar<T>;
static_assert(std::is_same_v<L, T>);
constexpr double kHold_s = 0.5e-3;  // a board gives targets each millisecond: in the mean half of it late
constexpr double kRampOf_nm = 5.0;  // dry friction with which a ramp is as wide as the machine says
constexpr double kLittle_nm = 1e-6;
constexpr double kTakeUp_nm = 2.0;  // over which a gear's backlash is taken up

Mat3<double> turned(const Vec3<double>& t) {
  const double cx = std::cos(t.x), sx = std::sin(t.x), cy = std::cos(t.y), sy = std::sin(t.y),
               cz = std::cos(t.z), sz = std::sin(t.z);
  // Rx Ry Rz: about x, then the turned y, then the turned z.
  return {{cy * cz, -cy * sz, sy},
          {cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy},
          {sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy}};
}

Quaternion<double> small_turn(const Vec3<double>& v) {
  const double angle = std::sqrt(dot(v, v)), k = angle > 1e-12 ? std::sin(0.5 * angle) / angle : 0.5;
  return {std::cos(0.5 * angle), k * v.x, k * v.y, k * v.z};
}
Quaternion<double> times(const Quaternion<double>& a, const Quaternion<double>& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
Quaternion<double> inverse(const Quaternion<double>& a) { return {a.w, -a.x, -a.y, -a.z}; }
/// Ry(slope_y) Rx(slope_x)
Quaternion<double> slope(const Description& d) {
  return times({std::cos(0.5 * d.slope_y_rad), 0.0, std::sin(0.5 * d.slope_y_rad), 0.0},
               {std::cos(0.5 * d.slope_x_rad), std::sin(0.5 * d.slope_x_rad), 0.0, 0.0});
}
/// The IMU's axes to the pelvis'.
Quaternion<double> mounting(const Vec3<double>& t) {
  return times(times(small_turn({t.x, 0, 0}), small_turn({0, t.y, 0})), small_turn({0, 0, t.z}));
}

bool passive(const Recording& r, std::size_t i) { return r.passive_hips && i % kLegJoints == kHipPitch; }

/// How far the motor's angle is ahead of the joint's.
double twist(const Machine& m, std::size_t i, double motor_nm) {
  return m.compliance_radpnm[i] * motor_nm +
         0.5 * m.backlash_rad[i] * std::clamp(motor_nm / kTakeUp_nm, -1.0, 1.0);
}

/// The level below which points at `height` sink in by `sink_m` in sum.
double carried(std::array<double, kVertices> height, double sink_m) {
  std::sort(height.begin(), height.end());
  double sum = 0.0, level = 0.0;
  for (std::size_t n = 1; n <= kVertices; ++n) {
    sum += height[n - 1];
    level = (sink_m + sum) / static_cast<double>(n);
    if (n == kVertices || level <= height[n]) break;
  }
  return level;
}

/// Where a window begins: what its first row says, and by how much `local` differs from it.
State<double> start(const Recording& recording, const Window& window, const Machine& m, const Plant& plant,
                    std::span<const double, kLocals> x) {
  const Row& row = recording.rows[window.first];
  State<double> s;
  const Quaternion<double> mount = mounting(m.imu_turn_rad);
  s.attitude = times(times(inverse(slope(m.robot)), row.attitude), inverse(mount));
  s.w_radps = rotation(mount) * (row.gyro_radps - m.gyro_bias_radps) + Vec3<double>{x[3], x[4], x[5]};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto& drive = m.robot.drives[i / kLegJoints][i % kLegJoints];
    const double motor = passive(recording, i) ? 0.0
                                               : drive.kp_nmprad * (row.target_rad[i] - row.angle_rad[i]) -
                                                     drive.kd_nmsprad * row.rate_radps[i];
    set_joint<double>(s.q_rad, i, row.angle_rad[i] - m.encoder_offset_rad[i] - twist(m, i, motor) + x[9 + i]);
    set_joint<double>(s.qd_radps, i, row.rate_radps[i] + x[21 + i]);
  }
  s.attitude = times(small_turn({x[1], x[2], 0.0}), s.attitude);
  const auto of_side = [](const auto& v, std::size_t side) {
    return Vec3<double>{v.x[side], v.y[side], v.z[side]};
  };
  Kinematics<double> k;
  kinematics<AnywhereTopology>(plant, s, k);
  const auto& leg = k.legs[0];
  const auto foot_rotation = [&](std::size_t side) {
    return Mat3<double>{of_side(leg.foot_rotation.x, side), of_side(leg.foot_rotation.y, side),
                        of_side(leg.foot_rotation.z, side)};
  };
  const std::size_t foot = window.foot;
  const auto& sole = m.robot.vertices_m[foot];
  const Vec3<double> foot_v = foot_rotation(foot) * of_side(leg.foot_v_mps, foot);
  s.v_mps = transposed_times(rotation(s.attitude), foot_v * -1.0) + Vec3<double>{x[6], x[7], x[8]};
  if (recording.held) {
    s.w_radps = s.v_mps = {0.0, 0.0, 0.0};
    s.position_m.z = 10.0;  // above the ground
    return s;
  }
  // As high as the ground's springs carry the foot's share of the weight.
  std::array<double, kVertices> height{};
  for (std::size_t v = 0; v < kVertices; ++v)
    height[v] = of_side(leg.foot_position_m, foot).z + dot(foot_rotation(foot).z, sole[v]);
  const double feet = (window.stance[0] ? 1.0 : 0.0) + (window.stance[1] ? 1.0 : 0.0);
  s.position_m.z =
      -carried(height, m.robot.mass_kg() * m.robot.gravity_mps2 / (feet * m.robot.ground.stiffness_npm)) +
      x[0];
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t v = 0; v < kVertices; ++v) {
      const Vec3<double> arm = foot_rotation(side) * m.robot.vertices_m[side][v],
                         at = of_side(leg.foot_position_m, side);
      const std::size_t a = 33 + 3 * side;
      s.anchors_m[0][v][0].set(side, at.x + arm.x + x[a] - x[a + 2] * arm.y);
      s.anchors_m[0][v][1].set(side, at.y + arm.y + x[a + 1] + x[a + 2] * arm.x);
    }
  return s;
}

void put(T& to, std::size_t lane, double x) { to.set(lane, x); }
void put(Vec3<T>& to, std::size_t lane, const Vec3<double>& x) {
  put(to.x, lane, x.x), put(to.y, lane, x.y), put(to.z, lane, x.z);
}

/// One lane's robot.
void put_plant(TurnedParameters<T>& to, std::size_t lane, const Plant& from) {
  biped::put_robot<T>(to, lane, from);
  for (std::size_t side = 0; side < 2; ++side) {
    const auto read3 = [side](const auto& v) {
      return Vec3<double>{Legs<double>::read(v.x, side), Legs<double>::read(v.y, side),
                          Legs<double>::read(v.z, side)};
    };
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      auto& f = to.frames[side][j];
      const auto& x = from.frames[0][j];
      put(f.x, lane, read3(x.x)), put(f.y, lane, read3(x.y)), put(f.z, lane, read3(x.z));
    }
  }
}

void put_state(State<T>& to, std::size_t lane, const State<double>& from) {
  put(to.position_m, lane, from.position_m), put(to.w_radps, lane, from.w_radps),
      put(to.v_mps, lane, from.v_mps);
  put(to.attitude.w, lane, from.attitude.w), put(to.attitude.x, lane, from.attitude.x);
  put(to.attitude.y, lane, from.attitude.y), put(to.attitude.z, lane, from.attitude.z);
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      put(to.q_rad[side][j], lane, from.q_rad[0][j][side]);
      put(to.qd_radps[side][j], lane, from.qd_radps[0][j][side]);
    }
    for (std::size_t v = 0; v < kVertices; ++v)
      for (std::size_t k = 0; k < 2; ++k) put(to.anchors_m[side][v][k], lane, from.anchors_m[0][v][k][side]);
  }
}

/// The first lane's in all.
FURCULA_INLINE State<T> in_all_lanes(State<T> s) {
  static_assert(std::is_trivially_copyable_v<State<T>> && sizeof(State<T>) % sizeof(T) == 0);
  std::array<T, sizeof(State<T>) / sizeof(T)> numbers;
  std::memcpy(&numbers, &s, sizeof s);
  for (T& x : numbers) x = T(x[0]);
  std::memcpy(static_cast<void*>(&s), &numbers, sizeof s);
  return s;
}

/// Logged targets between rows.
class Targets {
 public:
  Targets(const Recording& recording, const Window& window) : rows_(recording.rows), at_(window.first) {}
  void operator()(double time_s, std::array<double, kJoints>& out) {
    while (at_ > 0 && rows_[at_].time_s > time_s) --at_;
    while (at_ + 1 < rows_.size() && rows_[at_ + 1].time_s <= time_s) ++at_;
    if (rows_[at_].time_s > time_s || at_ + 1 == rows_.size()) {
      out = rows_[at_].target_rad;
      return;
    }
    const Row &a = rows_[at_], &b = rows_[at_ + 1];
    const double u = (time_s - a.time_s) / (b.time_s - a.time_s);
    for (std::size_t i = 0; i < kJoints; ++i)
      out[i] = a.target_rad[i] + u * (b.target_rad[i] - a.target_rad[i]);
  }

 private:
  const std::vector<Row>& rows_;
  std::size_t at_;
};

/// What the joints' drives, springs and gears do; `motor` is kept for the encoders.
struct Drives {
  Joints<T> compliance, backlash, offset, constant;
};

class Batch {
 public:
  /// From `from`, a reference's state at row `first_row` of the window, instead of from the window's start.
  Batch(const Recording& recording, const Window& window, std::span<const Variant> variants,
        std::size_t first_row, const State<T>* from)
      : recording_(recording),
        window_(window),
        variants_(variants),
        first_row_(first_row),
        targets_(recording, window) {
    if (first_row > 0) state_ = *from;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Variant& v = variants[std::min(lane, variants.size() - 1)];
      put_plant(plant_, lane, *v.plant);
      std::copy(v.locals, v.locals + kLocals, locals_[lane].begin());
      for (const int local : {v.local, v.other_leg})
        if (local >= 0) locals_[lane][static_cast<std::size_t>(local)] += v.change;
      if (first_row == 0)
        put_state(state_, lane, start(recording, window, *v.machine, *v.plant, locals_[lane]));
      machines_[lane] = v.machine;
      for (std::size_t i = 0; i < kJoints; ++i) {
        const std::size_t side = i / kLegJoints, j = i % kLegJoints;
        put(drives_.compliance[side][j], lane, v.machine->compliance_radpnm[i]);
        put(drives_.backlash[side][j], lane, 0.5 * v.machine->backlash_rad[i]);
        put(drives_.offset[side][j], lane, v.machine->encoder_offset_rad[i]);
        put(drives_.constant[side][j], lane, v.machine->torque_nm[i]);
      }
    }
  }

  /// Each lane's residuals after the first row, `stride` numbers apart; in `kept`, unless null, the first lane's state at each row, in all lanes.
  void run(double step_s, double* out, std::size_t stride, std::vector<State<T>>* kept) {
    const auto& rows = recording_.rows;
    const double begin = rows[window_.first].time_s,
                 length = rows[window_.first + window_.count - 1].time_s - begin;
    correlate(length);
    for (std::size_t k = first_row_ + 1; k < window_.count; ++k) {
      if (kept != nullptr) kept->push_back(in_all_lanes(state_));
      const double from = rows[window_.first + k - 1].time_s, dt = rows[window_.first + k].time_s - from;
      const int steps = std::max(1, static_cast<int>(std::lround(dt / step_s)));
      const double h = dt / steps;
      for (int n = 0; n < steps; ++n) {
        const double t = from + n * h;
        command(t);
        disturb((t + 0.5 * h - begin) / length);
        step(h);
      }
      write(k, out, stride);
    }
  }

 private:
  void command(double time_s) {
    std::array<double, kJoints> targets{};
    double known_s = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double delay = machines_[lane]->delay_s;
      if (!(delay == known_s)) targets_(time_s - delay - kHold_s, targets);
      known_s = delay;
      for (std::size_t i = 0; i < kJoints; ++i)
        put(target_[i / kLegJoints][i % kLegJoints], lane, targets[i]);
    }
  }

  /// Knots of the disturbances, each correlated with the one before (an Ornstein-Uhlenbeck process).
  void correlate(double length_s) {
    const double kept = std::exp(-length_s / ((kKnots - 1) * kCorrelation_s)),
                 fresh = std::sqrt(1.0 - kept * kept);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      for (std::size_t c = 0; c < kChannels; ++c)
        for (std::size_t k = 0; k < kKnots; ++k) {
          const double x = locals_[lane][kStart + c * kKnots + k];
          knots_[lane][c][k] = k == 0 ? x : kept * knots_[lane][c][k - 1] + fresh * x;
        }
  }

  /// `u`: of the window's length, from 0 to 1.
  void disturb(double u) {
    const double at = u * (kKnots - 1);
    const auto knot = std::min(static_cast<std::size_t>(at), kKnots - 2);
    const double to_next = at - static_cast<double>(knot);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto channel = [&](std::size_t c) {
        const auto& x = knots_[lane][c];
        return x[knot] + to_next * (x[knot + 1] - x[knot]);
      };
      for (std::size_t i = 0; i < kJoints; ++i)
        put(torque_[i / kLegJoints][i % kLegJoints], lane, channel(i));
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t c = kJoints + 6 * side;
        put(force_[side], lane, {channel(c), channel(c + 1), channel(c + 2)});
        put(moment_[side], lane, {channel(c + 3), channel(c + 4), channel(c + 5)});
      }
    }
  }

  void step(double h_s) {
    Kinematics<T> k;
    kinematics<AnywhereTopology>(plant_, state_, k);
    Actions<T> act;
    FootContact<T> feet;
    if (recording_.held)  // above the ground
      feet.anchors_m = state_.anchors_m, act.foot = {};
    else
      contact(plant_, state_, k, act.foot, feet);
    const T ramp_nmspr = T(kRampOf_nm / plant_.creep_radps), inverse_take_up = T(1.0 / kTakeUp_nm),
            one = T(1.0);
    for (std::size_t side = 0; side < 2; ++side) {
      const auto& turn = k.legs[side].foot_rotation;
      act.foot[side].n = act.foot[side].n + transposed_times(turn, moment_[side]);
      act.foot[side].f = act.foot[side].f + transposed_times(turn, force_[side]);
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        const Drive<T>& d = plant_.drives[side][j];
        const T q = state_.q_rad[side][j], qd = state_.qd_radps[side][j];
        T joint = drives_.constant[side][j] + torque_[side][j];
        if (recording_.passive_hips && j == kHipPitch) {
          const Clutch<T>& c = plant_.clutches[side][kHipClutch];
          joint += c.spring_nmprad * (c.spring_rest_rad - q) - c.damping_nmspr * qd;
          act.armature_kgm2[side][j] = T(0.0);
          twist_[side][j] = T(0.0);
        } else {
          const T& c = drives_.compliance[side][j];
          const T pull = d.kp_nmprad * (target_[side][j] - q - drives_.offset[side][j]) - d.kd_nmsprad * qd;
          const T share = one / (one + c * d.kp_nmprad);
          const T play = drives_.backlash[side][j] * clamped(T(pull * share * inverse_take_up), one);
          const T motor = clamped(T((pull - d.kp_nmprad * play) * share), d.limit_nm);
          // More dry friction does not change a joint that sticks: what is given is the ramp's slope. Through a steeper one it would jump in a step.
          const T slope = smaller(ramp_nmspr, T(2.0 / h_s) * d.armature_kgm2);
          const T dry = clamped(T(slope * qd), d.friction_nm);
          joint += motor - d.damping_nmspr * qd - dry;
          // A drive's damping acts at the mean of the rates before and after the kick, that of the ramp at the rate after it: less and less of it up to
          // twice the rate at which the ramp ends.
          const T beyond = larger(slope * qd, T(T(0.0) - slope * qd)) - d.friction_nm;
          const T stuck = one - clamped(T(larger(beyond, T(0.0)) / (d.friction_nm + T(kLittle_nm))), one);
          act.armature_kgm2[side][j] = d.armature_kgm2 +
                                       T(0.5 * h_s) * (d.kd_nmsprad * share + d.damping_nmspr) +
                                       T(h_s) * stuck * slope;
          twist_[side][j] = c * motor + play;
        }
        act.torque_nm[side][j] = joint;
      }
    }
    act.gravity_mps2 = plant_.gravity_mps2;
    Accelerations<T> by;
    if (recording_.held)
      forward_dynamics<AnywhereTopology, true>(plant_, state_, k, act, by);
    else
      forward_dynamics<AnywhereTopology>(plant_, state_, k, act, by);
    kick(state_, by, T(h_s));
    drift(k.pelvis_rotation, T(h_s), state_);
    state_.anchors_m = feet.anchors_m;
  }

  void write(std::size_t k, double* out, std::size_t stride) const {
    const Row& row = recording_.rows[window_.first + k];
    for (std::size_t lane = 0; lane < variants_.size(); ++lane) {
      const Machine& m = *machines_[lane];
      double* r = out + lane * stride + (k - 1) * kRowSize;
      for (std::size_t i = 0; i < kJoints; ++i) {
        const std::size_t side = i / kLegJoints, j = i % kLegJoints;
        r[i] = row.angle_rad[i] -
               (state_.q_rad[side][j][lane] + m.encoder_offset_rad[i] + twist_[side][j][lane]);
      }
      const Quaternion<double> attitude{state_.attitude.w[lane], state_.attitude.x[lane],
                                        state_.attitude.y[lane], state_.attitude.z[lane]};
      const Quaternion<double> mount = mounting(m.imu_turn_rad);
      const Quaternion<double> level = times(slope(m.robot), attitude);
      // In the pelvis' axes: what turns the predicted attitude into the measured one.
      const Quaternion<double> e = times(inverse(level), times(row.attitude, inverse(mount)));
      const double sign = e.w < 0.0 ? -2.0 : 2.0;
      const auto off = [&](std::size_t axis) {
        const double* x = locals_[lane].data() + kFilterAt + axis;
        const double t = row.time_s - recording_.rows[window_.first].time_s;
        return x[0] + t * (x[3] + t * x[6]);
      };
      r[kJoints] = sign * e.x - off(0), r[kJoints + 1] = sign * e.y - off(1),
      r[kJoints + 2] = sign * e.z - off(2);
      const Vec3<double> w{state_.w_radps.x[lane], state_.w_radps.y[lane], state_.w_radps.z[lane]};
      const Vec3<double> gyro = row.gyro_radps - (transposed_times(rotation(mount), w) + m.gyro_bias_radps);
      r[kJoints + 3] = gyro.x, r[kJoints + 4] = gyro.y, r[kJoints + 5] = gyro.z;
    }
  }

  const Recording& recording_;
  const Window& window_;
  std::span<const Variant> variants_;
  std::size_t first_row_;
  Targets targets_;
  TurnedParameters<T> plant_;
  State<T> state_;
  Drives drives_;
  std::array<std::array<double, kLocals>, kLanes> locals_;
  std::array<std::array<std::array<double, kKnots>, kChannels>, kLanes> knots_;
  std::array<const Machine*, kLanes> machines_{};
  Joints<T> target_, torque_, twist_;
  std::array<Vec3<T>, 2> force_, moment_;
};

}  // namespace

Plant plant_of(const Machine& machine) {
  JointFrames frames;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t j = 0; j < kLegJoints; ++j)
      frames[side][j] = transposed(turned(machine.turns_rad[side][j]));
  return {machine.robot, frames};
}

std::array<double, 2> flat_foot(const Recording& recording, const Window& window, const Machine& m,
                                const Plant& plant) {
  const std::array<double, kLocals> none{};
  const State<double> s = start(recording, window, m, plant, none);
  Kinematics<double> k;
  kinematics<AnywhereTopology>(plant, s, k);
  const auto& turn = k.legs[0].foot_rotation;
  const std::size_t f = window.foot;
  const auto& sole = m.robot.vertices_m[f];
  const Vec3<double> n = cross(sole[1] - sole[2], sole[0] - sole[3]);
  const auto of = [&](const auto& row) { return row.x[f] * n.x + row.y[f] * n.y + row.z[f] * n.z; };
  const Vec3<double> normal{of(turn.x), of(turn.y), of(turn.z)};
  // What brings the normal upright: about the level's axes, to first order.
  return {normal.y / normal.z, -normal.x / normal.z};
}

void residuals(const Recording& recording, const Window& window, std::span<const Variant> variants,
               double step_s, std::span<double> out) {
  const std::size_t rows = (window.count - 1) * kRowSize;
  const Variant& reference = variants.front();
  // The last row up to which a run is as the first: knot k acts from knot k - 1 on.
  const auto as_the_first = [&](const Variant& v) -> std::size_t {
    if (reference.local >= 0 || v.machine != reference.machine || v.plant != reference.plant ||
        v.locals != reference.locals || v.local < static_cast<int>(kStart) ||
        v.local >= static_cast<int>(kFilterAt))
      return 0;
    const std::size_t knot = (static_cast<std::size_t>(v.local) - kStart) % kKnots;
    if (knot < 2) return 0;
    const auto time = [&](std::size_t k) { return recording.rows[window.first + k].time_s; };
    const double until = time(0) + (time(window.count - 1) - time(0)) * static_cast<double>(knot - 1) /
                                       static_cast<double>(kKnots - 1);
    std::size_t k = 0;
    while (k + 2 < window.count && time(k + 1) <= until) ++k;
    return k;
  };
  std::vector<State<T>> kept;
  for (std::size_t i = 0; i < variants.size(); i += kLanes) {
    const auto some = variants.subspan(i, std::min(kLanes, variants.size() - i));
    std::size_t first_row = i == 0 ? 0 : window.count;
    for (const Variant& v : some) first_row = std::min(first_row, as_the_first(v));
    for (std::size_t lane = 0; lane < some.size(); ++lane)
      std::copy_n(out.data(), first_row * kRowSize, out.data() + (i + lane) * rows);
    Batch batch(recording, window, some, first_row, first_row > 0 ? &kept[first_row] : nullptr);
    batch.run(step_s, out.data() + i * rows, rows, i == 0 && variants.size() > kLanes ? &kept : nullptr);
  }
}

}  // namespace furcula::floating
