// Walks simulated in lanes: in each a robot with parameters of its own. One that has ended gives its lane to the next at once, and what a
// robot does hangs on no other and on no lane.
//
// A robot is a member of an ensemble (member.hpp); without one all are the same, without errors of sensors and pushes.
//
// Forces, steps and the controller are the core's (dynamics/biped/, control/walk/). The controller gets what sensors give: joints, gyro, the
// attitude that the filter makes of gyro and accelerometer, and the feet's switches.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "furcula/control/walk/walk.hpp"
#include "furcula/dynamics/biped/clutching.hpp"
#include "furcula/dynamics/biped/design.hpp"
#include "furcula/dynamics/biped/energy.hpp"
#include "furcula/dynamics/biped/step.hpp"
#include "host/biped/put_robot.hpp"
#include "host/walk/member_batch.hpp"
#include "host/walk/posture.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// One tick of a robot, for those who watch or disturb it.
template <class T>
struct WalkMoment {
  const dynamics::biped::State<T>& state;
  const dynamics::biped::StepReport<T>& report;  ///< of the last step
  const control::WalkState<T>& walk;
  const control::WalkOutputs<T>& out;
  const control::WalkSample<T>& sample;
  /// Number of each lane's job; none where the lane has no robot any more.
  const std::array<std::optional<std::size_t>, control::WalkState<T>::kRobots>& job;
  dynamics::tree::Vec3<T> position_m;  ///< of the pelvis frame when the sample was taken
  T time_s;
};

class PeriodicRollout;  // return_map.cpp

/// T is a number in lanes, or double.
template <class T>
class BatchedRollout {
  friend class PeriodicRollout;
  using V = dynamics::ValueOf<T>;
  using L = dynamics::biped::LegScalar<T>;
  static constexpr std::size_t kRobots = control::WalkState<T>::kRobots;

 public:
  using Take = std::function<const Job*(std::size_t&)>;
  using Done = std::function<void(std::size_t, const Rollout&)>;

  /// `known` is the robot as the controller has it in its feedback, unless the options have another.
  BatchedRollout(const dynamics::biped::Description& robot, const dynamics::biped::Description& known,
                 const RolloutOptions& options)
      : BatchedRollout({{robot, options.sensors, 0.0, {}}}, known, options, options.sensors.any()) {}
  /// Of an ensemble, at least one.
  BatchedRollout(std::span<const Member> members, const dynamics::biped::Description& known,
                 const RolloutOptions& options)
      : BatchedRollout({members.begin(), members.end()}, known, options, true) {}

  /// What a robot's sensors make of a tick, before the filter and the controller see it.
  std::function<void(control::WalkSample<T>&, control::Imu<T>&)> senses;
  /// After each tick.
  std::function<void(const WalkMoment<T>&)> watch;

  /// One robot to its end.
  Rollout run_one(const Parameters& walk) {
    Rollout out;
    bool taken = false;
    const Job job{walk, 0};
    run([&](std::size_t&) { return std::exchange(taken, true) ? nullptr : &job; },
        [&](std::size_t, const Rollout& r) { out = r; });
    return out;
  }

  /// Of run_one's robot, joints left then right. In double alone.
  std::array<JointEnergy, dynamics::biped::kJoints> joint_energy() const requires std::is_same_v<T, double> {
    auto out = ended_joints_;
    for (JointEnergy& e : out) e.copper_j *= robot(0).m.robot.copper_w_pnm2();
    return out;
  }

  /// take(i) gives a robot's job and its number i, or none; done(i, rollout) gets what it did.
  void run(const Take& take, const Done& done) {
    std::size_t running = 0;
    const auto next = [&](std::size_t lane) {
      std::size_t number = 0;
      const Job* job = take(number);
      job_[lane] = job != nullptr ? std::optional(number) : std::nullopt;
      if (job != nullptr) ++running;
      begin(lane, job != nullptr ? *job : Job{standing(), 0});
    };
    for (std::size_t lane = 0; lane < kRobots; ++lane) next(lane);
    while (running > 0) {
      tick();
      if (!dynamics::any(ended_ > V(0.5))) continue;
      for (std::size_t lane = 0; lane < kRobots; ++lane) {
        if (!(lane_of(ended_, lane) > V(0.5))) continue;
        if (job_[lane]) {
          --running;
          done(*job_[lane], result(lane));
          next(lane);
        } else {
          begin(lane, {standing(), 0});
        }
      }
    }
  }

 private:
  BatchedRollout(const std::vector<Member>& members, const dynamics::biped::Description& known,
                 const RolloutOptions& options, bool differ)
      : robots_(std::make_shared<const std::vector<Robot>>(members.begin(), members.end())),
        differ_(differ),
        o_(options),
        plant_(members.front().robot),
        laws_(dynamics::biped::active_laws(plant_)),
        config_({}, dynamics::biped::Parameters<T>(options.known ? *options.known : known)) {
    using namespace dynamics::biped;
    config_.walk_until_s = static_cast<V>(o_.walk_until_s);
    on_the_way_.resize(static_cast<std::size_t>(std::lround(o_.command_delay_s / o_.tick_s())));
    if (o_.mode == WalkMode::semi_passive)
      for (const std::size_t side : {kLeft, kRight})
        set_mode(plant_, side, kHipClutch, Mode::passive, laws_, s_);
  }

  /// A member with what is computed of it once.
  struct Robot {
    explicit Robot(const Member& member) : m(member), plain(member.robot), mass_kg(member.robot.mass_kg()) {}
    Member m;
    dynamics::biped::Parameters<double> plain;
    double mass_kg;
  };
  const Robot& robot(std::size_t lane) const { return (*robots_)[member_[lane]]; }

  static V lane_of(const T& x, std::size_t lane) { return dynamics::lane_of(x, lane); }
  static double plain(const T& x, std::size_t lane) { return static_cast<double>(lane_of(x, lane)); }
  static void put(T& x, std::size_t lane, double v) { dynamics::set_lane(x, lane, static_cast<V>(v)); }
  static void put(dynamics::tree::Vec3<T>& x, std::size_t lane, const dynamics::tree::Vec3<double>& v) {
    put(x.x, lane, v.x), put(x.y, lane, v.y), put(x.z, lane, v.z);
  }
  static void put(control::Quaternion<T>& x, std::size_t lane, const control::Quaternion<double>& v) {
    put(x.w, lane, v.w), put(x.x, lane, v.x), put(x.y, lane, v.y), put(x.z, lane, v.z);
  }
  /// Of one leg.
  static void put_leg(L& x, std::size_t side, std::size_t lane, double v) {
    T all = dynamics::biped::Legs<T>::read(x, side);
    put(all, lane, v);
    dynamics::biped::Legs<T>::write(x, side, all);
  }
  template <class X>
  static X size(const X& x) {
    return dynamics::larger(x, X(-x));
  }
  static T most_of(const dynamics::biped::PerLeg<T, L>& x) {
    using namespace dynamics::biped;
    return dynamics::larger(T(Legs<T>::read(x[Legs<T>::pass(kLeft)], kLeft)),
                            T(Legs<T>::read(x[Legs<T>::pass(kRight)], kRight)));
  }

  /// For a lane that has no robot any more.
  static Parameters standing() {
    Parameters w{};
    w.knee_rad = 0.5;
    w.start_s = 1e6;
    w.up_blend_s = w.down_blend_s = w.stop_blend_s = 1.0;
    return w;
  }

  /// Lane `lane` becomes that member.
  void become(std::size_t lane, std::size_t member) {
    using namespace dynamics::biped;
    member_[lane] = member;
    if (!differ_) return;
    const Robot& r = robot(lane);
    furcula::biped::put_robot<T>(plant_, lane, r.plain);
    T here = T(V(0));
    put(here, lane, 1.0);
    const auto is_here = here > V(0.5);
    const auto is_of_leg = LegScalar<T>(here) > V(0.5);
    const JointLaws<T> laws = active_laws(plant_);
    for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass)
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        JointLaw<L>& l = laws_[pass][j];
        const JointLaw<L>& to = laws[pass][j];
        for (const auto number :
             {&JointLaw<L>::armature_kgm2, &JointLaw<L>::damping_nmspr, &JointLaw<L>::friction_nm,
              &JointLaw<L>::kp_nmprad, &JointLaw<L>::kd_nmsprad, &JointLaw<L>::limit_nm})
          l.*number = dynamics::select(is_of_leg, to.*number, l.*number);
      }
    if (o_.mode == WalkMode::semi_passive)
      for (const std::size_t side : {kLeft, kRight})
        set_mode(plant_, side, kHipClutch, Mode::passive, laws_, s_, is_here);
    members_.begin(lane, r.m, r.plain.gravity_mps2);
  }

  void begin(std::size_t lane, const Job& job) {
    using namespace dynamics::biped;
    become(lane, job.member);
    const Parameters& w = job.walk;
    auto values = config_.walk.values();
    const auto given = w.values();
    for (std::size_t i = 0; i < values.size(); ++i) put(values[i], lane, given[i]);
    config_.walk = control::WalkParameters<T>::of(values);
    control::begin_walk(config_, lane, walk_);

    const Robot& r = robot(lane);
    State<double> still = posture(r.m.robot, r.plain, o_.mode, w);
    for (Joints<T>& targets : on_the_way_)
      for (std::size_t i = 0; i < kJoints; ++i) {
        T all = joint<T>(targets, i);
        put(all, lane, joint<double>(still.q_rad, i));
        set_joint<T>(targets, i, all);
      }
    Kinematics<double> k;
    kinematics<DesignTopology>(r.plain, still, k);
    if (differ_) {
      // The encoders read the posture, and the lowest corner of the soles is on the ground.
      for (std::size_t i = 0; i < kJoints; ++i)
        if (o_.mode != WalkMode::semi_passive || i % kLegJoints != kHipPitch)
          set_joint<double>(still.q_rad, i, joint<double>(still.q_rad, i) - r.m.sensors.encoder_rad[i]);
      kinematics<DesignTopology>(r.plain, still, k);
      still.position_m.z -= lowest_m(r.m.robot, k);
      kinematics<DesignTopology>(r.plain, still, k);
    }
    begins_m_[lane] = totals(r.plain, still).centre_m().x;
    put(s_.position_m, lane, still.position_m);
    put(s_.attitude, lane, still.attitude);
    // At rest an accelerometer measures gravity's opposite, and the filter takes the vertical from it.
    const auto acc = -transposed_times(rotation(still.attitude), r.plain.gravity_mps2);
    put(acc_mps2_, lane, acc);
    put(filter_.attitude, lane, control::attitude_at_rest(differ_ ? imu_axes(r.m) * acc : acc).attitude);
    for (auto* v : {&s_.w_radps, &s_.v_mps, &filter_.bias_radps}) put(*v, lane, {0.0, 0.0, 0.0});
    for (const std::size_t side : {kLeft, kRight}) {
      const std::size_t pass = Legs<T>::pass(side);
      if (knees_switch()) {
        T here = T(V(0));
        put(here, lane, 1.0);
        set_mode(plant_, side, kKneeClutch, Mode::active, laws_, s_, here > V(0.5));
        put(knee_off_[side], lane, 0.0);
      }
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        put_leg(s_.q_rad[pass][j], side, lane, joint<double>(still.q_rad, side * kLegJoints + j));
        put_leg(s_.qd_radps[pass][j], side, lane, 0.0);
        put_leg(motor_nm_[pass][j], side, lane, 0.0);
      }
      for (std::size_t c = 0; c < kClutches; ++c) {
        put_leg(s_.rotors_rad[pass][c], side, lane,
                joint<double>(still.q_rad, side * kLegJoints + kClutchJoints[c]));
        put_leg(s_.rotors_radps[pass][c], side, lane, 0.0);
      }
      for (auto* m : {&moment_x_, &moment_y_}) put_leg((*m)[pass], side, lane, 0.0);
      for (std::size_t i = 0; i < kVertices; ++i) {
        const auto& at = r.m.robot.vertices_m[side][i];
        put_leg(s_.anchors_m[pass][i][0], side, lane, k.legs[0].foot_position_m.x[side] + at.x);
        put_leg(s_.anchors_m[pass][i][1], side, lane, k.legs[0].foot_position_m.y[side] + at.y);
      }
      put(switch_[side].carries, lane, 1.0), put(switch_[side].below_s, lane, 0.0);
      put(normal_n_[side], lane, 0.5 * r.mass_kg * r.m.robot.gravity_mps2);
    }
    for (T* x : {&work_, &positive_, &squares_, &torque_, &speed_, &moment_, &time_s_, &ended_, &off_})
      put(*x, lane, 0.0);
    if constexpr (std::is_same_v<T, double>) ended_joints_ = std::exchange(joints_, {});
  }

  /// Height of the lowest corner of the soles.
  static double lowest_m(const dynamics::biped::Description& robot,
                         const dynamics::biped::Kinematics<double>& k) {
    using namespace dynamics::biped;
    double lowest = 1e9;
    const auto& leg = k.legs[0];
    for (const std::size_t side : {kLeft, kRight})
      for (const auto& v : robot.vertices_m[side]) {
        const auto& down = leg.foot_rotation.z;
        lowest = std::fmin(lowest, leg.foot_position_m.z[side] + down.x[side] * v.x + down.y[side] * v.y +
                                       down.z[side] * v.z);
      }
    return lowest;
  }

  void tick() {
    using namespace dynamics::biped;
    using dynamics::larger;
    using dynamics::select;
    const V dt = static_cast<V>(o_.tick_s());
    const Vec3<T> position = s_.position_m;
    const T zero = T(V(0)), one = T(V(1));
    for (const std::size_t side : {kLeft, kRight})
      switch_[side].step(differ_ ? members_.measured_n(normal_n_[side]) : normal_n_[side],
                         static_cast<V>(o_.foot_threshold_n), dt);
    control::WalkSample<T> sample{
        s_.q_rad, s_.qd_radps, s_.w_radps, {}, switch_[kLeft].carries, switch_[kRight].carries};
    control::Imu<T> imu{s_.w_radps, acc_mps2_};
    if (differ_) {
      members_.push(time_s_, o_.tick_s(), plant_.gravity_mps2);
      members_.sense(sample, imu);
    }
    if constexpr (std::is_same_v<T, double>)
      if (senses) senses(sample, imu);
    // What the filter has made of all samples before is the attitude of now; this one is for the next tick.
    sample.attitude = filter_.attitude;
    control::step_attitude(control::AttitudeGains<T>{}, imu, T(dt), filter_);
    control::step_walk(config_, sample, dt, walk_, out_);
    if (knees_switch()) switch_knees();
    Commands<T> command;
    command.target_rad = out_.target_rad;
    if (!on_the_way_.empty()) {
      std::swap(command.target_rad, on_the_way_[next_on_the_way_]);
      next_on_the_way_ = (next_on_the_way_ + 1) % on_the_way_.size();
    }
    if (differ_) members_.command(command);

    T farthest = zero;
    for (int k = 0; k < o_.steps_a_tick; ++k) {
      const Joints<T> speeds = s_.qd_radps;
      if (o_.mode == WalkMode::active)
        step<false>(plant_, laws_, command, T(static_cast<V>(o_.step_s)), s_, report_);
      else
        step<true>(plant_, laws_, command, T(static_cast<V>(o_.step_s)), s_, report_);
      farthest = larger(farthest, account(speeds));
    }
    // A sample is of the end of the last step, its accelerations of that step.
    acc_mps2_ =
        report_.acceleration.vd_mps2 + cross(s_.w_radps, s_.v_mps) -
        transposed_times(rotation(s_.attitude), differ_ ? members_.gravity_mps2() : plant_.gravity_mps2);
    for (const std::size_t side : {kLeft, kRight})
      normal_n_[side] = Legs<T>::read(report_.contact.normal_n[Legs<T>::pass(side)], side);
    time_s_ += T(dt);

    const WalkLimits& m = o_.limits;
    const auto is = [&](const auto& condition) { return select(condition, one, zero); };
    // A number that is none compares as false: such a robot has fallen.
    const T fallen = one - is(s_.position_m.z > static_cast<V>(m.height_m));
    const T away = is(farthest > static_cast<V>(m.range_rad));
    Vec3<T> apart = out_.apart_m;
    if constexpr (std::is_same_v<T, double>)
      if (senses) {
        // Feet hit each other where they are, not where erring encoders have them.
        PerLeg<T, control::LegPose<L>> legs;
        control::leg_poses(plant_, s_.q_rad, s_.qd_radps, legs);
        apart = control::ankles_apart<T>(legs);
      }
    const T near = is(apart.y < static_cast<V>(m.apart_m)) * is(size(apart.x) < static_cast<V>(m.along_m));
    const T hits = larger(near, is(apart.y < V(0)));
    off_ = select(fallen > V(0.5), T(V(1)), select(away > V(0.5), T(V(2)), T(V(3) * hits)));
    ended_ = larger(is(off_ > V(0.5)), is(time_s_ > static_cast<V>(o_.time_s - 0.5 * o_.tick_s())));
    if (watch) watch({s_, report_, walk_, out_, sample, job_, position, time_s_});
  }

  /// Energy, and the most of what has a limit, of a step that began with these joint speeds. The joint that is farthest from zero, rad.
  FURCULA_INLINE T account(const dynamics::biped::Joints<T>& speeds) {
    using namespace dynamics::biped;
    using dynamics::larger;
    const T h = T(static_cast<V>(o_.step_s));
    const L zero = L(V(0)), smoothing = L(static_cast<V>(o_.step_s / 0.01));
    PerLeg<T, L> power, positive, squares, torque, rate, moment, angle;
    for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
      power[pass] = positive[pass] = squares[pass] = torque[pass] = rate[pass] = angle[pass] = zero;
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        L nm = report_.torque.motor_nm[pass][j], qd = speeds[pass][j];
        // A spring's, a brake's, and no motor's.
        if (o_.mode != WalkMode::active && (j == kHipPitch || j == kKnee)) {
          const auto joined = laws_[pass][j].joined;
          nm = dynamics::select(joined, nm, zero), qd = dynamics::select(joined, qd, zero);
        }
        const L p = nm * qd;
        power[pass] += p;
        positive[pass] += larger(p, zero);
        squares[pass] += nm * nm;
        account_joint(j, nm, p);
        L& smooth = motor_nm_[pass][j];
        smooth += smoothing * (nm - smooth);
        torque[pass] = larger(torque[pass], size(smooth));
        rate[pass] = larger(rate[pass], size(qd));
        angle[pass] = larger(angle[pass], size(s_.q_rad[pass][j]));
      }
      moment_x_[pass] += smoothing * (report_.foot[pass].n.x - moment_x_[pass]);
      moment_y_[pass] += smoothing * (report_.foot[pass].n.y - moment_y_[pass]);
      moment[pass] = larger(size(moment_x_[pass]), size(moment_y_[pass]));
    }
    work_ += Legs<T>::sum(power) * h;
    positive_ += Legs<T>::sum(positive) * h;
    squares_ += Legs<T>::sum(squares) * h;
    if (o_.mode == WalkMode::semi_passive && o_.hips_follow) account_motors(kHipClutch, h);
    if (knees_switch()) account_motors(kKneeClutch, h);
    torque_ = larger(torque_, most_of(torque));
    speed_ = larger(speed_, most_of(rate));
    moment_ = larger(moment_, most_of(moment));
    return most_of(angle);
  }
  /// A motor that is not joined follows its link by the drive's law: what that takes.
  FURCULA_INLINE void account_motors(dynamics::biped::LegClutch c, const T& h) {
    using namespace dynamics::biped;
    using dynamics::clamped;
    using dynamics::larger;
    using dynamics::select;
    const L zero = L(V(0));
    const std::size_t j = kClutchJoints[c];
    PerLeg<T, L> power, positive, squares;
    for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
      const Drive<L>& d = plant_.drives[pass][j];
      const L &q = s_.rotors_rad[pass][c], &qd = s_.rotors_radps[pass][c];
      const L follows = clamped(L(d.kp_nmprad * (s_.q_rad[pass][j] - q) - d.kd_nmsprad * qd), d.limit_nm);
      const L nm = select(laws_[pass][j].joined, zero, follows);
      power[pass] = nm * qd;
      positive[pass] = larger(power[pass], zero);
      squares[pass] = nm * nm;
      account_joint(j, nm, power[pass]);
    }
    work_ += Legs<T>::sum(power) * h;
    positive_ += Legs<T>::sum(positive) * h;
    squares_ += Legs<T>::sum(squares) * h;
  }

  bool knees_switch() const { return o_.mode == WalkMode::knee_passive || o_.mode == WalkMode::knee_braked; }
  /// Opens and closes the knees' clutches as the walk's phase asks. A pin that goes in is told so early that it is in when it is asked for.
  void switch_knees() {
    using namespace dynamics::biped;
    using dynamics::any;
    using dynamics::select;
    const T zero = T(V(0)), one = T(V(1));
    const V pin_s = static_cast<V>(o_.pin_s);
    const T out = select(walk_.since_s > pin_s, one, zero);
    for (const std::size_t side : {kLeft, kRight}) {
      const T stands = side == kLeft ? walk_.left : T(one - walk_.left);
      T off = walk_.walks * (one - walk_.lands) * (one - stands) * out;
      if (o_.mode == WalkMode::knee_braked) {
        // A stance's brake, once closed, holds until the leg swings; then, and in `stop`, its pin takes its time.
        const T kept = knee_off_[side] * (one - out);
        const T still = select(walk_.since_s * walk_.inverse_blend_1ps > T(V(1)), out, zero);
        off = walk_.walks * select(stands > V(0.5), dynamics::larger(out, knee_off_[side]), kept) +
              walk_.stops * dynamics::larger(still, kept);
      }
      const auto opens = T(off - knee_off_[side]) > V(0.5), closes = T(knee_off_[side] - off) > V(0.5);
      if (any(opens))
        set_mode(plant_, side, kKneeClutch, o_.mode == WalkMode::knee_passive ? Mode::released : Mode::braked,
                 laws_, s_, opens);
      if (any(closes)) engage(plant_, side, kKneeClutch, laws_, s_, closes);
      knee_off_[side] = off;
    }
  }

  /// One step's, of joint `j` of both legs.
  FURCULA_INLINE void account_joint([[maybe_unused]] std::size_t j, [[maybe_unused]] const L& nm,
                                    [[maybe_unused]] const L& watts) {
    using namespace dynamics::biped;
    if constexpr (std::is_same_v<T, double>)
      for (const std::size_t side : {kLeft, kRight}) {
        JointEnergy& e = joints_[side * kLegJoints + j];
        const double w = watts[side], torque = nm[side];
        e.work_j += w * o_.step_s;
        e.positive_work_j += std::fmax(w, 0.0) * o_.step_s;
        e.copper_j += torque * torque * o_.step_s;  // by copper_w_pnm2 when it is asked for
      }
  }
  /// Of the capture point, seen along the world's axes from the middle of the ankles, as if the feet stood side by side.
  static double outside_of_soles(const Robot& r, const dynamics::biped::State<double>& s,
                                 const dynamics::biped::Totals<double>& sums) {
    using namespace dynamics::biped;
    Kinematics<double> k;
    kinematics<DesignTopology>(r.plain, s, k);
    const auto& foot = k.legs[0].foot_position_m;
    const Vec3<double> centre = sums.centre_m();
    const double time = std::sqrt(std::fmax(centre.z, 0.0) / r.m.robot.gravity_mps2) / r.mass_kg;
    const double x = centre.x + sums.linear_ns.x * time - 0.5 * (foot.x[kLeft] + foot.x[kRight]);
    const double y = centre.y + sums.linear_ns.y * time - 0.5 * (foot.y[kLeft] + foot.y[kRight]);
    const double side = 0.5 * std::abs(foot.y[kLeft] - foot.y[kRight]);
    double front = 0.0, rear = 0.0, wide = 0.0;
    for (const auto& v : r.m.robot.vertices_m[kLeft]) {
      front = std::fmax(front, v.x);
      rear = std::fmin(rear, v.x);
      wide = std::fmax(wide, std::abs(v.y));
    }
    return std::fmax(std::fmax(x - front, rear - x), std::abs(y) - side - wide) + kSoleMargin_m;
  }

  Rollout result(std::size_t lane) const {
    using namespace dynamics::biped;
    Rollout r;
    const Robot& who = robot(lane);
    const Description& is = who.m.robot;
    r.ending = static_cast<Ending>(static_cast<int>(plain(off_, lane)));
    r.time_s = plain(time_s_, lane);
    r.torque_nm = plain(torque_, lane), r.speed_radps = plain(speed_, lane),
    r.moment_nm = plain(moment_, lane);
    r.work_j = plain(work_, lane), r.positive_work_j = plain(positive_, lane);
    r.copper_j = plain(squares_, lane) * is.copper_w_pnm2();
    r.constant_j = is.constant_power_w * r.time_s;
    r.landings = walk_.steps[lane];
    r.steps = static_cast<std::uint64_t>(std::llround(r.time_s / o_.step_s));
    State<double> end;
    end.position_m.x = plain(s_.position_m.x, lane);
    end.w_radps = {plain(s_.w_radps.x, lane), plain(s_.w_radps.y, lane), plain(s_.w_radps.z, lane)};
    end.v_mps = {plain(s_.v_mps.x, lane), plain(s_.v_mps.y, lane), plain(s_.v_mps.z, lane)};
    end.attitude = {plain(s_.attitude.w, lane), plain(s_.attitude.x, lane), plain(s_.attitude.y, lane),
                    plain(s_.attitude.z, lane)};
    for (std::size_t i = 0; i < kJoints; ++i) {
      set_joint<double>(end.q_rad, i, plain(joint<T>(s_.q_rad, i), lane));
      set_joint<double>(end.qd_radps, i, plain(joint<T>(s_.qd_radps, i), lane));
    }
    const auto sums = totals(who.plain, end);
    r.distance_m = sums.centre_m().x - begins_m_[lane];
    r.outside_m = outside_of_soles(who, end, sums);
    const WalkLimits& m = o_.limits;
    for (const double share :
         {r.torque_nm / m.torque_nm, r.speed_radps / m.speed_radps, r.moment_nm / m.moment_nm})
      if (!(share <= 1.0)) r.over += share - 1.0;
    if (!(r.outside_m <= 0.0)) r.over += r.outside_m / 0.1;
    if (r.distance_m > 0.0) r.cot = r.energy_j() / (who.mass_kg * kCotGravity_mps2 * r.distance_m);
    return r;
  }

  std::shared_ptr<const std::vector<Robot>> robots_;
  bool differ_ = false;                                    ///< robots do, or their sensors err
  std::array<std::size_t, kRobots> member_{};              ///< of each lane
  std::array<std::optional<std::size_t>, kRobots> job_{};  ///< of each lane
  RolloutOptions o_;
  dynamics::biped::Parameters<T> plant_;
  dynamics::biped::State<T> s_;
  dynamics::biped::JointLaws<T> laws_;
  control::WalkConfig<T> config_;
  control::WalkState<T> walk_{};
  control::WalkOutputs<T> out_{};
  control::AttitudeFilter<T> filter_{};
  dynamics::biped::StepReport<T> report_{};
  std::array<control::FootSwitch<T>, 2> switch_{};
  std::array<T, 2> normal_n_{};
  std::array<T, 2> knee_off_{};  ///< 1 where the knee's motor is not joined
  dynamics::tree::Vec3<T> acc_mps2_{};
  dynamics::biped::Joints<T> motor_nm_{};                              ///< low-pass
  dynamics::biped::PerLeg<T, L> moment_x_{}, moment_y_{};              ///< the same
  T work_{}, positive_{}, squares_{}, torque_{}, speed_{}, moment_{};  ///< J; (N m)^2 s; the most so far
  T time_s_{}, ended_{}, off_{};
  std::array<JointEnergy, dynamics::biped::kJoints> joints_{}, ended_joints_{};  ///< copper_j in (N m)^2 s
  std::array<double, kRobots> begins_m_{};
  MemberBatch<T> members_;  ///< where they differ alone
  std::vector<dynamics::biped::Joints<T>>
      on_the_way_;  ///< targets that late drives do not act on yet, a ring
  std::size_t next_on_the_way_ = 0;
};

}  // namespace furcula::walk
