// A tree in motion as fits and simulations run it: drives, bodies and joints, encoders.
//
// The stages are those of the machines of one joint: the drive makes a torque of its input, the tree moves, the
// encoder reads. A cause changes one of them.
#pragma once

#include <span>
#include <vector>

#include "furcula/dynamics/tree/plant.hpp"
#include "host/trees/inertial.hpp"
#include "host/trees/model.hpp"
#include "host/trees/recording.hpp"

namespace furcula::trees {

/// A tree with all its causes applied: plain numbers, cheap to make.
struct Setup {
  struct Joint {
    ControlMode law = ControlMode::torque;
    double kp_nmprad = 0.0, kd_nmsprad = 0.0;
    double gain = 1.0, lag_s = 0.0;
    double delay_s = 0.0;   ///< below zero where the log's clocks are apart
    double limit_nm = 0.0;  ///< 0: none
    double ripple_nm = 0.0, ripple_cycles = 0.0, ripple_phase_rad = 0.0;
    double offset_nm = 0.0;  ///< on the joint
    /// Of a spring beside the drive, as Spring has it: its rest less that of the touch-down, and the touch-down's delay.
    double spring_nmprad = 0.0, spring_rest_rad = 0.0, latch_delay_s = 0.0;
    bool switched = false, both_ways = false;
    double flight_nm = 0.0;           ///< while the foot is in the air
    double encoder_offset_rad = 0.0;  ///< measured less true
    /// A position law that is not the joint's own spring and damper: its torque is computed step by step.
    bool held_torque = false;
    /// The torque depends on the state in a way that the joint's law has no words for: it changes from step to step.
    bool stepwise = false;

    friend bool operator==(const Joint&, const Joint&) = default;
  };
  model::RobotModel model;
  std::vector<Joint> joints;
  double longest_step_s = 4e-3;
  bool by_phase = false;                  ///< feet or springs depend on the phase of the recording (in_phase)
  dynamics::tree::Foothold<double> foot;  ///< where it stands in a stance
  std::vector<double> extension_m;  ///< of each joint's link, where links are longer than the model says

  /// Whether a torque along the motion stands for what the other setup has more: not where its foot would have to move.
  bool differs_by_torque(const Setup& other) const;
};

/// The setup as it is in the phase of a recording's row: the foot on the ground or not, springs at rest where they caught.
Setup in_phase(const Setup& setup, const Recording& recording, std::size_t row);

/// What does not change from one set of causes to the next is computed once.
class SetupMaker {
 public:
  explicit SetupMaker(const TreeModel& model);
  /// The tree with these drives and causes, and with these bodies in place of the given ones.
  Setup make(std::span<const Drive> drives, std::span<const Cause> causes,
             std::span<const FittedBody> fitted = {}) const;

 private:
  struct Body {  ///< of a link, in the link frame of the joint that moves it
    std::size_t link;
    double mass_kg;
    dynamics::tree::Vec3<double> centre_m;
    dynamics::tree::Sym3<double> about_centre_kgm2;
  };
  Body body(std::size_t link, const model::UrdfInertia& inertia) const;

  const TreeModel& tree_;
  std::vector<Body> bodies_;
};

/// The value with which an effect is not there: the model's own, 0, 1, or without end (NaN: any).
double neutral_value(const TreeModel& model, Effect effect, std::size_t parameter, std::size_t site);

/// Runs the tree from the states at `first`, positions as the encoders read them and velocities, on the recording's inputs to `last`,
/// in the phase of `first`;
/// `measured[row - first][joint]` is what the encoders read. Inputs from before `first` are in the drives' delays and lags,
/// and in the rotors of elastic drives (rotor.hpp), to which `rotor_more` is added (angles, then rates; empty: nothing), as
/// `rest_more_rad` is to the rests of switched springs.
/// @return the steps of integration that it took.
std::size_t run(const Setup& setup, const Recording& recording, std::size_t first, std::size_t last,
                std::span<const double> angle_rad, std::span<const double> velocity_radps,
                std::span<double> measured, std::span<const double> rotor_more = {},
                std::span<const double> rest_more_rad = {});

/// The torque that a drive's law asks for where the encoder reads `measured_rad`.
double asked_torque(const Setup::Joint& joint, double input, double measured_rad, double velocity_radps);
/// What the drive makes of a torque that has come through its lag.
double made_torque(const Setup::Joint& joint, double asked_nm, double measured_rad);
/// A first-order lag over `dt_s` of a steady input: its mean output; `state` moves on.
double passed(double lag_s, double dt_s, double in, double& state);
/// The row whose input a drive has at row `first`.
std::size_t row_in_force(const Setup::Joint& joint, const Recording& recording, std::size_t first);
/// A lag's output at row `first`, from the inputs before; a position law's at the measured angles.
double lagged_before(const Setup::Joint& law, const Recording& recording, std::size_t joint,
                     std::size_t first);

/// What a plant with the drives of `setup` does between two rows, for simulations that make their inputs as they go.
class Runner {
 public:
  using Plant = dynamics::tree::Plant<double, model::RobotShape>;

  explicit Runner(const Setup& setup);
  /// `angle_rad` as the encoders read them. On a foot that stands, joints without a drive move as the others and the foot
  /// make them.
  void reset(std::span<const double> angle_rad, std::span<const double> velocity_radps);
  /// Where a run is: it goes on from there as it did before.
  struct Place {
    Plant::Place plant;
    std::vector<double> lagged_nm;            ///< of each drive's lag: what comes out of it
    std::vector<double> acceleration_radps2;  ///< in the last step
  };
  Place place() const { return {plant_.place(), lagged_, acceleration_}; }
  void go_to(const Place& place);
  /// The drive's lag as it is after its law has asked for this torque for ever.
  void settle_input(std::size_t joint, double input) { lagged_[joint] = input; }
  /// After reset(): the rotor of an elastic drive.
  void place_rotor(std::size_t joint, double angle_rad, double rate_radps) {
    plant_.place_rotor(joint, angle_rad, rate_radps);
  }
  /// Moves on with the inputs of this interval.
  void advance(std::span<const double> input, double dt_s);
  /// Whether the joint's own spring and damper are the drive.
  static bool is_spring(const Setup::Joint& j) { return j.law == ControlMode::position && !j.held_torque; }
  double measured(std::size_t joint) const {
    return plant_.positions()[joint] + setup_.joints[joint].encoder_offset_rad;
  }
  double velocity(std::size_t joint) const { return plant_.velocities()[joint]; }
  std::size_t steps() const { return plant_.steps(); }
  /// Of the last interval, mean: as a sensor between drive and joint has it.
  double torque(std::size_t joint) const { return torque_[joint]; }
  /// An additional torque on the joint, from outside.
  void disturb(std::size_t joint, double torque_nm) { disturbance_[joint] = torque_nm; }

 private:
  double spring_torque(std::size_t joint, double input, double dt_s);
  void follow(const Plant::Joints& q, Plant::Joints& v) const;

  const Setup& setup_;
  Plant plant_;
  bool stepwise_ = false;
  std::vector<double> lagged_, disturbance_, torque_, acceleration_;
};

}  // namespace furcula::trees
