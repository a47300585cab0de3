// A tree in motion as fits and simulations run it: drives, bodies and joints, encoders.
//
// The stages are those of the machines of one joint: the drive makes a torque of its input, the tree moves, the
// encoder reads. A cause changes one of them.
#pragma once

#include <span>
#include <vector>

#include "host/trees/inertial.hpp"
#include "host/trees/model.hpp"
#include "host/trees/recording.hpp"
#include "host/trees/runner.hpp"

namespace furcula::trees {

class Runner : public RunnerOf<double, model::RobotShape> {
 public:
  using RunnerOf::RunnerOf;
  /// `angle_rad` as the encoders read them. On a foot that stands, joints without a drive move as the others and the foot
  /// make them.
  void reset(std::span<const double> angle_rad, std::span<const double> velocity_radps);
  /// The same at a row: inputs from before are in the drives' delays and lags, and in the rotors of elastic drives (rotor.hpp), to which
  /// `rotor_more` is added (angles, then rates; empty: nothing).
  void reset(const Recording& recording, std::size_t first, std::span<const double> angle_rad,
             std::span<const double> velocity_radps, std::span<const double> rotor_more = {});

 private:
  void follow(const Plant::Joints& q, Plant::Joints& v) const;
};

/// The setup as it is in the phase of a recording's row: the foot on the ground or not, springs at rest where they caught.
Setup in_phase(const Setup& setup, const Recording& recording, std::size_t row);

/// What may differ from the model as given.
struct Hypothesis {
  std::vector<Drive> drives;
  std::vector<Cause> causes;
  std::vector<FittedBody> bodies{};  ///< a link that is not here has its body as given
  double inputs_late_rows = 0.0;     ///< all inputs act so many rows after their own: Setup::Joint::late_rows
};

/// What does not change from one set of causes to the next is computed once.
class SetupMaker {
 public:
  explicit SetupMaker(const TreeModel& model);
  Setup make(const Hypothesis& hypothesis) const;

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

/// A run of the tree from a row of a recording.
struct Run {
  const Setup* setup = nullptr;
  std::span<const double> angle_rad,
      velocity_radps;  ///< at its start: as the encoders read them, and the joints' velocities
  std::span<const double> rotor_more{};     ///< as Runner::reset has it
  std::span<const double> rest_more_rad{};  ///< added to the rests of switched springs; empty: nothing
};

/// Runs the trees on the recording's inputs from row `first` to `last`, in the phase of `first`; what the encoders read is
/// `measured[run][row - first][joint]`. Runs that are nearly the first go beside it, in lanes.
/// @return the steps of integration that it took; of lanes as BatchRunner counts them.
std::size_t run(std::span<const Run> runs, const Recording& recording, std::size_t first, std::size_t last,
                std::span<double> measured);

/// One of them.
std::size_t run(const Setup& setup, const Recording& recording, std::size_t first, std::size_t last,
                std::span<const double> angle_rad, std::span<const double> velocity_radps,
                std::span<double> measured);

/// The input that a drive has while that of `row` is in force.
double input_in_force(const Setup::Joint& drive, const Recording& recording, std::size_t joint,
                      std::size_t row);
/// The row whose input a drive has at row `first`.
std::size_t row_in_force(const Setup::Joint& joint, const Recording& recording, std::size_t first);
/// A lag's output at row `first`, from the inputs before; a position law's at the measured angles.
double lagged_before(const Setup::Joint& law, const Recording& recording, std::size_t joint,
                     std::size_t first);

}  // namespace furcula::trees
