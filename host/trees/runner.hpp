// A plant with its drives between two rows of a log: what each drive makes of its input, and how the tree then moves.
//
// For plain numbers and for batches of nearly equal robots (led_batch.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "furcula/dynamics/tree/plant.hpp"
#include "host/model/urdf.hpp"
#include "host/trees/model.hpp"

namespace furcula::trees {

/// A tree with all its causes applied: numbers, cheap to make.
template <class T, dynamics::tree::Topology P>
struct SetupOf {
  struct Joint {
    ControlMode law = ControlMode::torque;
    T kp_nmprad{0.0}, kd_nmsprad{0.0};
    T gain{1.0}, lag_s{0.0};
    double delay_s = 0.0;  ///< below zero where the log's clocks are apart
    /// Between -1 and 1: of the row before (of the one after, below 0) the input has this share.
    double late_rows = 0.0;
    T limit_nm{0.0};  ///< 0: none
    T ripple_nm{0.0}, ripple_cycles{0.0}, ripple_phase_rad{0.0};
    T offset_nm{0.0};  ///< on the joint
    /// Of a spring beside the drive, as Spring has it: its rest less that of the touch-down, and the touch-down's delay.
    double spring_nmprad = 0.0, spring_rest_rad = 0.0, latch_delay_s = 0.0;
    bool switched = false, both_ways = false;
    double flight_nm = 0.0;     ///< while the foot is in the air
    T encoder_offset_rad{0.0};  ///< measured less true
    /// A position law that is not the joint's own spring and damper: its torque is computed step by step.
    bool held_torque = false;
    /// The torque depends on the state in a way that the joint's law has no words for: it changes from step to step.
    bool stepwise = false;

    friend bool operator==(const Joint&, const Joint&) = default;
  };
  dynamics::tree::Model<T, P> model;
  std::vector<Joint> joints;
  double longest_step_s = 4e-3;
  bool by_phase = false;                  ///< feet or springs depend on the phase of the recording (in_phase)
  dynamics::tree::Foothold<double> foot;  ///< where it stands in a stance
  std::vector<double> extension_m;  ///< of each joint's link, where links are longer than the model says

  /// Whether a torque along the motion stands for what the other setup has more: not where its foot would have to move.
  bool differs_by_torque(const SetupOf& other) const;
};

using Setup = SetupOf<double, model::RobotShape>;

/// The torque that a drive's law asks for where the encoder reads `measured_rad`.
template <class J, class I, class T>
T asked_torque(const J& joint, const I& input, const T& measured_rad, const T& velocity_radps) {
  if (joint.law == ControlMode::torque) return T(input);
  return joint.kp_nmprad * (input - measured_rad) - joint.kd_nmsprad * velocity_radps;
}

/// What the drive makes of a torque that has come through its lag.
template <class J, class T>
T made_torque(const J& joint, const T& asked_nm, const T& measured_rad) {
  using dynamics::value_of;
  using std::sin;
  T torque = joint.gain * asked_nm;
  if (const double limit = value_of(joint.limit_nm); limit > 0.0) {
    if (value_of(torque) > limit) torque = joint.limit_nm;
    if (value_of(torque) < -limit) torque = -joint.limit_nm;
  }
  if (value_of(joint.ripple_nm) != 0.0)
    torque += joint.ripple_nm * sin(joint.ripple_cycles * measured_rad + joint.ripple_phase_rad);
  return torque;
}

/// A first-order lag over `dt_s` of a steady input: its mean output; `state` moves on.
template <class T>
T passed(const T& lag_s, double dt_s, const T& in, T& state) {
  using std::exp;
  const T before = state, left = exp(-dt_s / lag_s);
  state = in + (before - in) * left;
  return in + (before - in) * ((1.0 - left) * lag_s / dt_s);
}

/// What a plant with the drives of `setup` does between two rows, for simulations that make their inputs as they go.
template <class T, dynamics::tree::Topology P>
class RunnerOf {
 public:
  using Setup = SetupOf<T, P>;
  using Joint = typename Setup::Joint;
  using Plant = dynamics::tree::Plant<T, P>;

  explicit RunnerOf(const Setup& setup)
      : setup_(setup),
        plant_(setup.model, setup.longest_step_s),
        lagged_(setup.joints.size()),
        disturbance_(setup.joints.size(), T(0.0)),
        torque_(setup.joints.size()),
        acceleration_(setup.joints.size()) {
    for (const Joint& j : setup.joints) stepwise_ |= j.stepwise;
  }
  /// Starts at these positions and velocities, rad and rad/s.
  void start(const typename Plant::Joints& q, const typename Plant::Joints& v) {
    plant_.reset(q, v);
    std::fill(acceleration_.begin(), acceleration_.end(), T(0.0));
  }
  /// Where a run is: it goes on from there as it did before.
  struct Place {
    typename Plant::Place plant;
    std::vector<T> lagged_nm;            ///< of each drive's lag: what comes out of it
    std::vector<T> acceleration_radps2;  ///< in the last step
  };
  Place place() const { return {plant_.place(), lagged_, acceleration_}; }
  void go_to(const Place& place) {
    plant_.go_to(place.plant);
    lagged_ = place.lagged_nm;
    acceleration_ = place.acceleration_radps2;
  }
  /// The drive's lag as it is after its law has asked for this torque for ever.
  void settle_input(std::size_t joint, const T& input) { lagged_[joint] = input; }
  /// After reset(): the rotor of an elastic drive.
  void place_rotor(std::size_t joint, const T& angle_rad, const T& rate_radps) {
    plant_.place_rotor(joint, angle_rad, rate_radps);
  }
  /// Moves on with the inputs of this interval, one for each joint.
  template <class Inputs>
  void advance(const Inputs& input, double dt_s) {
    constexpr double kStepwise = 1e-3;
    const int parts = stepwise_ ? std::max(1, static_cast<int>(std::ceil(dt_s / kStepwise - 1e-9))) : 1;
    const double dt = dt_s / parts;
    std::fill(torque_.begin(), torque_.end(), T(0.0));
    for (int part = 0; part < parts; ++part) {
      typename Plant::Joints tau{};
      for (std::size_t i = 0; i < setup_.joints.size(); ++i) {
        const Joint& j = setup_.joints[i];
        T drive(0.0);
        if (is_spring(j)) {
          plant_.set_rest(i, input[i] - j.encoder_offset_rad);
          drive = j.gain * asked_torque(j, input[i], measured(i), velocity(i));
          if (j.stepwise) tau[i] = spring_torque(i, T(input[i]), dt);
        } else {
          const T ahead = measured(i) + velocity(i) * 0.5 * dt;
          // A velocity of half a step ago would count as inertia.
          const bool lags = value_of(j.lag_s) > 0.0;
          const T gained = lags ? T(0.5 * dt * acceleration_[i]) : T(0.0);
          T asked = asked_torque(j, input[i], ahead, T(velocity(i) + gained));
          if (lags) asked = passed(j.lag_s, dt, asked, lagged_[i]);
          drive = made_torque(j, asked, ahead);
          tau[i] = drive;
        }
        tau[i] += j.offset_nm + disturbance_[i];
        torque_[i] += drive / static_cast<double>(parts);
      }
      const typename Plant::Joints before = plant_.velocities();
      plant_.advance(tau, dt);
      for (std::size_t i = 0; i < setup_.joints.size(); ++i)
        acceleration_[i] = (velocity(i) - before[i]) / dt;
    }
  }
  /// Whether the joint's own spring and damper are the drive.
  static bool is_spring(const Joint& j) { return j.law == ControlMode::position && !j.held_torque; }
  T measured(std::size_t joint) const {
    return plant_.positions()[joint] + setup_.joints[joint].encoder_offset_rad;
  }
  T velocity(std::size_t joint) const { return plant_.velocities()[joint]; }
  std::size_t steps() const { return plant_.steps(); }
  /// Of the last interval, mean: as a sensor between drive and joint has it.
  T torque(std::size_t joint) const { return torque_[joint]; }
  /// An additional torque on the joint, from outside.
  void disturb(std::size_t joint, const T& torque_nm) { disturbance_[joint] = torque_nm; }

 protected:
  const Setup& setup_;
  Plant plant_;

 private:
  static double value_of(const T& x) { return dynamics::value_of(x); }
  /// What the drive adds to the joint's spring and damper over the next step; what these and the dry friction are in it.
  T spring_torque(std::size_t i, const T& input, double dt_s) {
    const Joint& j = setup_.joints[i];
    const T ahead = measured(i) + velocity(i) * 0.5 * dt_s;
    const T asked = asked_torque(j, input, ahead, velocity(i)), made = made_torque(j, asked, ahead);
    const bool limited =
        value_of(j.limit_nm) > 0.0 && std::abs(value_of(j.gain * asked)) > value_of(j.limit_nm);
    dynamics::tree::JointLaw<T> law = setup_.model.laws[i];
    law.rest_rad = input - j.encoder_offset_rad;
    if (limited) {
      law.stiffness_nmprad -= j.gain * j.kp_nmprad;
      law.damping_nmspr -= j.gain * j.kd_nmsprad;
    }
    // The friction of the load is of the whole drive's torque.
    const T whole = made + j.offset_nm + disturbance_[i];
    const T load = law.load_friction_ratio * (value_of(whole) < 0.0 ? T(-whole) : whole);
    law.load_friction_ratio = T(0.0);
    law.friction_nm += load;
    law.friction_back_nm += load;
    if (value_of(law.static_friction_nm) > 0.0) law.static_friction_nm += load;
    plant_.set_law(i, law);
    return limited ? made : T(made - j.gain * asked);
  }

  bool stepwise_ = false;
  std::vector<T> lagged_, disturbance_, torque_, acceleration_;
};

// Compiled once, in run.cpp: of copies in several objects the linker would take any.
extern template class RunnerOf<double, model::RobotShape>;

}  // namespace furcula::trees

extern template class furcula::dynamics::tree::Plant<double, furcula::model::RobotShape>;
extern template void furcula::dynamics::tree::forward_dynamics(
    const furcula::model::RobotModel&, const furcula::model::RobotModel::Joints&,
    const furcula::model::RobotModel::Joints&, const furcula::model::RobotModel::Joints&,
    const furcula::model::RobotModel::Flags&,
    furcula::dynamics::tree::Accelerations<furcula::model::RobotModel>&);
