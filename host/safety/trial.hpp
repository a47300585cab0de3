// One run of the simulated robot with planted faults, and what of it was unsafe, in physical terms.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "furcula/bus/parameters.hpp"
#include "furcula/control/fault.hpp"
#include "host/model/model.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::safety {

enum class Unsafe : std::uint8_t {
  torque_after_fault,
  coil_after_fault,
  coil_in_stance,
  torque_beyond_limit,
  off_the_rail,
  hard_impact,
  not_finite,
  fall_unnoticed,
  spring_unknown,
};

/// Limits of the judgement.
inline constexpr std::uint32_t kTorqueOffTicks = 2;  ///< after detection
/// A drive that hears no command any more stops by itself (its own time-out is 5 ms, and the tick in which
/// the last command acts).
inline constexpr std::uint32_t kDeafDriveTicks = 7;
inline constexpr double kDriveStepNm = 0.01;  ///< a zero in the drive's packing is less than this
inline constexpr double kHighestM = 0.75;     ///< half of the rail; hops reach 0.4 m
inline constexpr double kHardestMps =
    3.0;  ///< of the body: a fall from that height, with the guide's damping
/// Of the toe, whose links weigh a tenth of the body, when a leg that is still stretching meets the ground.
inline constexpr double kFastestToeMps = 4.0;
inline constexpr double kFallenM =
    0.10;  ///< of the hip above the ground; the spring alone holds a landing above it
inline constexpr double kSpringCaughtS = 0.3;       ///< after detection: the key falls in within 50 ms
inline constexpr std::uint32_t kUnknownTicks = 50;  ///< running: so long a loose spring may be unseen
/// The switch reports touch-down up to 10 ms late and two readings count; an open one in a stance is found
/// once the leg is 3 cm short, for 50 ms.
inline constexpr std::uint32_t kCoilInStanceTicks = 100;
inline constexpr double kStillMps = 0.05;  ///< of the body: slower, it stands

struct UnsafeInfo {
  Unsafe outcome;
  std::string_view name;
  std::string_view meaning;
};
inline constexpr std::array<UnsafeInfo, 9> kUnsafe{{
    {Unsafe::torque_after_fault, "torque_after_fault",
     "the motor gives torque more than two ticks after a fault was found (a drive that hears nothing: more than seven)"},
    {Unsafe::coil_after_fault, "coil_after_fault",
     "the coil is commanded on from the tick on which a fault was found"},
    {Unsafe::coil_in_stance, "coil_in_stance",
     "the coil is commanded on for more than 100 ms of a stance, and no fault is found"},
    {Unsafe::torque_beyond_limit, "torque_beyond_limit", "the torque commanded is beyond its limit"},
    {Unsafe::off_the_rail, "off_the_rail", "the body rises above half of the rail, 0.75 m"},
    {Unsafe::hard_impact, "hard_impact",
     "the body comes down at more than 3 m/s, or the toe alone at more than 4 m/s"},
    {Unsafe::not_finite, "not_finite", "a command or the body's height is not a number"},
    {Unsafe::fall_unnoticed, "fall_unnoticed",
     "the hip comes closer to the ground than 10 cm before a fault is found"},
    {Unsafe::spring_unknown, "spring_unknown",
     "0.3 s after a fault the robot stands on a bent leg whose spring is neither caught nor seen to be loose by the "
     "cable's encoder"},
}};

/// What a run came to. Ticks are counted from the first fault's instant on.
struct Trial {
  control::Fault fault = control::Fault::none;  ///< the first that the controller found
  std::uint32_t found_tick = 0;                 ///< where one was found
  std::uint32_t torque_off_ticks = 0;           ///< from then until the motor's torque was zero, for good
  bool early = false;                           ///< found before anything was broken
  bool false_alarm = false;                     ///< found early, with the robot's own parameters
  bool refused = false;                         ///< the configuration was, and nothing ran
  std::uint32_t hops = 0;                       ///< touch-downs, of the plant
  double lowest_m = 1e9, highest_m = 0.0, hardest_mps = 0.0, fastest_toe_mps = 0.0;
  std::uint32_t longest_coil_in_stance_ticks = 0;
  bool caught_at_end = true;
  // From when it lands without its switch, or, where it does not, from the fault on.
  bool lands = false;
  std::uint32_t landing_tick = 0;  ///< since the first fault's instant, where it lands
  double lowest_after_m = 1e9, hardest_after_mps = 0.0;
  std::uint32_t moving_ticks = 0;  ///< since the first fault's instant, until it stands still
  std::uint32_t unsafe = 0;        ///< bit n: the outcome of number n

  bool is(Unsafe outcome) const { return (unsafe >> static_cast<unsigned>(outcome) & 1u) != 0; }
  void set(Unsafe outcome) { unsafe |= 1u << static_cast<unsigned>(outcome); }
};

enum class Rig : std::uint8_t { local, on_bus };

/// A parameter of the table and the value that it is given instead of the robot's own.
struct DrawnParameter {
  const bus::Parameter* parameter;
  float value;
};

/// `hopping`: told to run from the first tick on. `resting`: never told, the robot comes to rest.
enum class Use : std::uint8_t { hopping, resting };

/// Runs the scenario with its faults, and with these parameters in the controller, if the node would take them.
/// `on_bus`: drive and encoders behind the simulated CAN bus. `blind`: its contact observer sees nothing, and it
/// knows of the ground by the switch alone. The same arguments give the same result.
Trial run_trial(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed, Rig rig,
                std::span<const DrawnParameter> parameters = {}, Use use = Use::hopping, bool blind = false);

/// The robot of document 002, chapter 5, whose spring has a clutch.
model::Model robot();

/// It hops by 7 cm, lets its spring go in each flight and folds its leg by 5 cm; all sensors as they are.
sim::Scenario hopping(double duration_s);

/// By then a robot that was never told to run stands still: its swing falls to a tenth in 1.4 s.
inline constexpr double kRestsS = 4.0;

/// Where in its stride the robot is when something breaks.
enum class Moment : std::uint8_t { flight, stance, released, catching };
inline constexpr std::array<std::string_view, 4> kMoments{"flight", "stance", "released flight", "catch"};

/// Seconds from the start at which the robot that hops on is first in the middle of it, after the first
/// second.
double instant_of(Moment moment, std::uint64_t seed, Rig rig);

}  // namespace furcula::safety
