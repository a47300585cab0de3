// Windows of a walking robot, simulated in lanes from a start, driven by the logged targets, with disturbances. Derivatives are differences
// between lanes. A shared library, built for several kinds of x86-64 (furcula_lanes in host/CMakeLists.txt): no Eigen here, whose types
// depend on the processor.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "host/biped/machine.hpp"
#include "host/floating/recording.hpp"

namespace furcula::floating {

/// What a start may differ by from what its first row says: height of the pelvis, roll and pitch about the level's axes, angular velocity,
/// velocity, joints' angles and rates, and for each foot how its anchors are off in x, y and yaw.
inline constexpr std::size_t kStart = 1 + 2 + 3 + 3 + 12 + 12 + 6;
/// A torque at each joint; a force (3) and a moment (3) at each foot, world axes, about the foot's origin.
inline constexpr std::size_t kChannels = kJoints + 12;
/// Numbers of a disturbance over a window: at knots from its begin to its end, straight in between. They are correlated over kCorrelation_s; a
/// window's unknowns are independent numbers of which they are made.
inline constexpr std::size_t kKnots = 7;
inline constexpr std::size_t kDisturbances = kChannels * kKnots;
inline constexpr double kCorrelation_s = 0.1;
/// What the attitude filter is off by, about the pelvis' axes: at the window's begin, its rate, half of its rate's change.
inline constexpr std::size_t kFilterAt = kStart + kDisturbances;
inline constexpr std::size_t kFilterShapes = 3;
inline constexpr std::size_t kLocals = kFilterAt + 3 * kFilterShapes;
/// Of a row: joints' angles, attitude (3, small turns about the pelvis' axes), gyro.
inline constexpr std::size_t kRowSize = kJoints + 6;

/// What the equations of a machine run on.
using Plant = dynamics::biped::TurnedParameters<double>;
Plant plant_of(const Machine& machine);

/// A run: which machine, from which of the window's own unknowns, and in which of these it differs.
struct Variant {
  const Machine* machine;
  const Plant* plant;
  const double* locals;  ///< kLocals of them
  int local = -1;        ///< which is changed; -1: none
  double change = 0.0;
  int other_leg = -1;  ///< on a stand, which parts the legs: which is changed by as much, too; -1: none
};

/// Residuals, measured less predicted, of every run in `out`: kRowSize (count - 1) numbers each, the start's row left out. Runs that differ from
/// the first in a later knot alone begin where they differ; those of one knot should stand side by side.
void residuals(const Recording& recording, const Window& window, std::span<const Variant> variants,
               double step_s, std::span<double> out);

/// Roll and pitch, as in `local`, with which the sole of the foot that has carried longest is flat on the ground.
std::array<double, 2> flat_foot(const Recording& recording, const Window& window, const Machine& machine,
                                const Plant& plant);

}  // namespace furcula::floating
