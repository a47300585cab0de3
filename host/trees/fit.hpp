// Fits of a tree by simulation: short windows of the recordings, each from a start of its own.
//
// What is compared is the mean of a window's angles over bins of time. A window's start (positions and velocities)
// is an unknown too; it has a prior from the angles around it, and is eliminated: every product of residuals and
// columns below is one of what no start can explain.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/trees/recording.hpp"
#include "host/trees/run.hpp"

namespace furcula::trees {

/// What may differ from the model as given.
struct Hypothesis {
  std::vector<Drive> drives;
  std::vector<Cause> causes;
};

/// One number that a fit moves.
struct Unknown {
  bool of_cause = false;
  std::size_t cause = 0;      ///< in Hypothesis::causes
  std::size_t joint = 0;      ///< where it is a drive's
  std::size_t parameter = 0;  ///< of the cause, or in kDriveParameters
  double lower = 0.0, upper = 0.0;
  double scale = 1.0;  ///< a change that matters
};

double value_of(const Hypothesis& h, const Unknown& u);
void set_value(Hypothesis& h, const Unknown& u, double value);

/// How large things are on this machine: root mean squares over the recordings.
struct Scales {
  std::vector<double> torque_nm, velocity_radps, acceleration_radps2;  ///< of each joint
  std::vector<double> lowest_rad, highest_rad;
  std::vector<bool> still;  ///< what it moves is lost in the encoder's noise: its parameters cannot show
};
Scales scales_of(const TreeModel& model, std::span<const Recording> recordings);

struct Window {
  std::size_t recording, first, last;
  double span_s;                                  ///< asked for
  std::vector<double> angle_rad, velocity_radps;  ///< start, as measured around it
  Eigen::VectorXd start_precision;                ///< of angles, then velocities: one over the variance
  Eigen::VectorXd measured;                       ///< bin by bin, joint by joint
  std::vector<std::size_t> bin;                   ///< of each row from `first`
};

/// Windows of `window_s` side by side, none over a gap in the rows; at most `most` of them, evenly chosen (0: all).
std::vector<Window> windows_of(const TreeModel& model, std::span<const Recording> recordings, double window_s,
                               std::size_t most = 0);

struct FitOptions {
  unsigned threads = 2;
  int iterations = 6;
};

struct Fit {
  Hypothesis at;
  std::vector<Unknown> unknowns;
  double loss = 0.0;
  Eigen::MatrixXd covariance;  ///< of the unknowns, from the scatter of the windows' gradients; 0 at a bound
  std::vector<bool> at_bound;
  std::vector<double> window_loss;  ///< of each window
  /// Of each unknown, fitted on each fold alone (by the linear problem): its value, and its information there.
  std::vector<std::vector<double>> fold_value, fold_information;
};

/// The stiffest spring between drive and joint that a fit looks at: the rotor rings on it with 130 Hz.
double stiffest_nmprad(const Drive& drive);

/// Estimates of one number from several recordings, weighed by their information: their mean over what their scatter says of
/// its error, over what chance alone may reach. Above 1 the recordings agree that it is not zero.
double steadiness(std::span<const double> value, std::span<const double> information);

/// Products of columns over all windows, folds and one by one. Column 0 is the residual (measured less simulated),
/// then one for each unknown (its derivative of the simulation), then one for each probe (simulation with it less that without).
struct Products {
  Eigen::MatrixXd all;
  std::vector<Eigen::MatrixXd> fold;
  std::vector<Eigen::MatrixXf> window;
};

class Problem {
 public:
  Problem(const TreeModel& model, const std::vector<Recording>& recordings, std::vector<Window> windows,
          unsigned threads);

  const TreeModel& model() const { return model_; }
  const Scales& scales() const { return scales_; }
  const std::vector<Window>& windows() const { return windows_; }
  double interval_s() const { return recordings_.front().interval_s; }  ///< of the rows
  std::size_t recordings() const { return recordings_.size(); }
  std::size_t folds() const { return folds_; }
  std::size_t joints() const { return model_.joints(); }

  /// The model's free parameters, then the parameters of the causes that the model does not have of its own.
  std::vector<Unknown> unknowns(const Hypothesis& h) const;

  /// How the starts move the residuals, and what each bin's residual weighs, at this hypothesis: the loss of one that is
  /// right is then about the number of residuals. Fits are comparable between two calls.
  void weigh(const Hypothesis& h);
  Fit fit(Hypothesis from, const FitOptions& options) const;
  /// Loss of each window.
  std::vector<double> losses(const Hypothesis& h) const;
  /// Squares of what the windows' runs are off over those of the motion about its mean, of the joint where they are most.
  double misfit(const Hypothesis& h) const;
  /// Of each joint, the cycles a turn with which the missing torque swings most: at most two, none where nothing swings.
  std::vector<std::vector<double>> ripple_cycles(const Hypothesis& h) const;
  Products products(const Hypothesis& h, const std::vector<Unknown>& unknowns,
                    const std::vector<Hypothesis>& probes) const;

 private:
  Eigen::VectorXd simulated(const Setup& setup, const Window& w) const;
  Eigen::VectorXd residual(const Setup& setup, std::size_t window) const;
  Setup make(const Hypothesis& h) const { return maker_.make(h.drives, h.causes); }
  std::size_t fold_of(std::size_t window) const;
  /// a' b over what no start explains.
  Eigen::MatrixXd product(std::size_t window, const Eigen::MatrixXd& columns) const;

  struct Start {
    Eigen::MatrixXd columns;  ///< weighted derivatives by the start
    Eigen::MatrixXd inverse;  ///< of the start's normal matrix, its prior in it
  };
  const TreeModel& model_;
  const std::vector<Recording>& recordings_;
  std::vector<Window> windows_;
  unsigned threads_;
  SetupMaker maker_;
  Scales scales_;
  std::size_t bins_, folds_;
  Eigen::VectorXd weight_;             ///< of each bin and joint: one over a standard deviation
  std::vector<double> window_weight_;  ///< less than 1 of a window that nothing explains
  std::vector<Start> starts_;
};

}  // namespace furcula::trees
