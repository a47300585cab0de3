// A simulated walk from start to stop: what is asked of it, and what it gave.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "furcula/control/walk/walk_parameters.hpp"
#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::walk {

using Parameters = control::WalkParameters<double>;

enum class WalkMode : std::uint8_t {
  active,        ///< all joints
  semi_passive,  ///< both hips' pitch on their springs, the other joints active
  knee_passive,  ///< the swing leg's knee swings free while the foot goes up
  knee_braked    ///< the stance leg's knee is held by its brake, both while the robot stands
};
inline constexpr std::array<std::string_view, 4> kModeNames{"active", "semi_passive", "knee_passive",
                                                            "knee_braked"};

/// What a walk must keep (000 section III); a collision of feet is chosen here.
struct WalkLimits {
  double torque_nm = 80.0;   ///< of a motor, at its joint; 10 ms low-pass
  double speed_radps = 1.5;  ///< of a joint whose motor is joined
  double moment_nm =
      50.0;  ///< of a foot's contact about its ankle, the larger of roll and pitch; 10 ms low-pass
  double height_m = 0.8;    ///< of the pelvis frame; below it a robot has fallen
  double range_rad = 1.57;  ///< of a joint
  double apart_m = 0.13,
         along_m = 0.25;  ///< ankles nearer than this sideways while nearer than that along; or crossed
};

/// Constant errors of a robot's sensors.
struct SensorOffsets {
  std::array<double, dynamics::biped::kJoints> encoder_rad{};  ///< measured less true; left then right
  dynamics::tree::Vec3<double> imu_turn_rad{};                 ///< of the IMU against the pelvis
  dynamics::tree::Vec3<double> gyro_bias_radps{};

  bool any() const {
    double most = 0.0;
    for (const double x : encoder_rad) most = std::max(most, std::abs(x));
    for (const auto& v : {imu_turn_rad, gyro_bias_radps})
      most = std::max({most, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return most > 0.0;
  }
};

/// Of drives that walks can be searched for: what a board's supervisor allows for beyond its buses' two ticks.
inline constexpr double kMostCommandDelay_s = 18e-3;
inline constexpr double kSoleMargin_m = 0.03;
inline constexpr double kCotGravity_mps2 = 9.8;  ///< of 000 eq. 1

struct RolloutOptions {
  WalkMode mode = WalkMode::active;
  double time_s = 10.0;
  double step_s = 5e-4;
  int steps_a_tick = 2;  ///< the controller's tick
  double walk_until_s = 5.0;
  double command_delay_s = 0.0;    ///< drives act on targets so much later; rounded to ticks
  double foot_threshold_n = 30.0;  ///< of the feet's switches
  double pin_s = 0.06;             ///< a clutch's pin takes to go out, and to go in
  /// semi_passive: whether the hips' motors follow their links all the while. Else they are off, as they are not joined before the end.
  bool hips_follow = false;
  WalkLimits limits;
  SensorOffsets sensors;  ///< of the robot; members of an ensemble have their own
  /// The robot as the controller has it in its feedback, as on a board; without it as it is simulated.
  std::optional<dynamics::biped::Description> known;

  double tick_s() const { return step_s * steps_a_tick; }
};

/// Of one joint's motor over a walk.
struct JointEnergy {
  double work_j = 0.0, positive_work_j = 0.0, copper_j = 0.0;
};

enum class Ending : std::uint8_t { stands, fell, range, collision };
inline constexpr std::array<std::string_view, 4> kEndingNames{"stands", "fell", "range", "collision"};

struct Rollout {
  Ending ending = Ending::fell;
  double time_s = 0.0;                                         ///< until it ended
  double torque_nm = 0.0, speed_radps = 0.0, moment_nm = 0.0;  ///< the most of what the limits are of
  /// How far the capture point (Pratt et al. 2006: the centre of mass, and its speed times sqrt(height / g)) lies outside of the soles at
  /// the end, less kSoleMargin_m: who is above 0 has not stopped, or falls.
  double outside_m = 0.0;
  double work_j = 0.0;           ///< of the motors, signed: braking gives back
  double positive_work_j = 0.0;  ///< its positive parts
  double copper_j = 0.0, constant_j = 0.0;
  double distance_m = 0.0;                               ///< of the centre of mass, forward
  double cot = std::numeric_limits<double>::infinity();  ///< 000 eq. 1
  double over = 0.0;  ///< what is beyond the limits, in shares of them, summed
  std::uint32_t landings = 0;
  std::uint64_t steps = 0;  ///< of the simulation

  double energy_j() const { return work_j + copper_j + constant_j; }
  bool keeps_limits() const { return ending == Ending::stands && over == 0.0; }
  /// 000 eq. 2, with grades where that has none: from 2 on a fall, 1 to 2 beyond a limit, below 1 a walk; 1 stands on the spot. Not a
  /// number where one of the figures is none.
  double objective(double time_asked_s) const {
    if (ending != Ending::stands) return 1.0 + time_asked_s / std::max(time_s, 1e-3);
    if (over != 0.0) return 1.0 + price();
    return ahead();
  }
  /// The same for a search to descend: what is beyond a limit is a price, and not a wall behind which the cost of transport counts for
  /// nothing.
  double value(double time_asked_s) const {
    return ending == Ending::stands ? ahead() + price() : objective(time_asked_s);
  }

 private:
  double ahead() const { return std::isinf(cot) ? 1.0 : 1.0 / (1.0 + 1.0 / cot); }
  double price() const { return std::min(0.3 * over, 1.0); }  // in this order: what is no number stays none
};

}  // namespace furcula::walk
