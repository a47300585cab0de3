// The biped in MuJoCo, for the controller that a board has: MuJoCo's own contacts and integrator, simulated drives, encoders, IMU, feet and pins.
// It shares no dynamics with the product; Description is used as a table of numbers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "furcula/control/walk/walker.hpp"
#include "host/core/random.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/robot/truth.hpp"

namespace furcula::robot {

struct Disturbances {
  bool sensors = true;  ///< noise and quantisation of encoders, gyro, accelerometer, feet
  double push_n =
      15.0;  ///< standard deviation, of each horizontal direction, on the pelvis for 0.1 s, once a second
};

class MujocoBiped {
 public:
  static constexpr double kTick_s = 1e-3;

  /// On its stand it holds `posture_rad`; passive hips are at their springs' rest. `exercises`: it never leaves the stand.
  /// @throws std::runtime_error where MuJoCo does not take the robot.
  MujocoBiped(const Truth& truth, bool passive_hips, bool exercises,
              const std::array<double, control::kWalkerJoints>& posture_rad, const Disturbances& disturbances,
              std::uint64_t seed);

  /// What the devices give in this tick. The robot holds its posture on its stand until the board walks or exercises.
  control::WalkerInputs sense();
  /// A tick under these commands.
  void advance(const control::WalkerOutputs& told);

  double time_s() const { return time_s_; }
  bool holds() const { return holds_; }
  /// Of the pelvis' origin, in the ground's frame; not of a robot that exercises.
  std::array<double, 3> position_m() const { return {data_->qpos[0], data_->qpos[1], data_->qpos[2]}; }
  /// Of the centre of mass, forward.
  double forward_m() const { return data_->subtree_com[3]; }
  const mjModel& model() const { return *model_; }
  mjData& data() { return *data_; }

 private:
  struct Gear {  ///< between a drive's motor and its joint, where it is not stiff
    double angle_rad = 0.0, rate_radps = 0.0;  ///< of the motor
  };
  /// Places of a joint's coordinate and rate: a free joint comes first, where there is one.
  std::size_t coordinate(std::size_t i) const { return (exercises_ ? 0 : 7) + i; }
  std::size_t rate(std::size_t i) const { return (exercises_ ? 0 : 6) + i; }
  bool passive(std::size_t i) const;
  bool stiff(std::size_t i) const {
    return truth_.elasticity_nmprad[i] == 0.0 && truth_.backlash_rad[i] == 0.0;
  }
  double motor_angle_rad(std::size_t i) const;
  double motor_rate_radps(std::size_t i) const;
  double gear_torque_nm(std::size_t i) const;
  void place_on_ground();
  void step(const std::array<control::JointCommand, control::kWalkerJoints>& commands);
  void measure_feet();

  Truth truth_;
  bool passive_hips_, exercises_;
  Disturbances disturbances_;
  core::Random noise_, pushes_;
  test::MujocoModel model_;
  test::MujocoData data_;
  std::array<Gear, control::kWalkerJoints> gears_{};
  std::vector<std::array<control::JointCommand, control::kWalkerJoints>> on_the_way_;
  std::array<double, control::kWalkerJoints> torque_nm_{};
  std::array<double, 2> foot_n_{};
  std::array<double, control::kWalkerPins> pins_{};
  double time_s_ = 0.0, push_until_s_ = 0.0, next_push_s_ = 0.0;
  bool holds_ = true;
};

}  // namespace furcula::robot
