// Fits of a tree by simulation: short windows of the recordings, each from a start of its own.
//
// What is compared is the mean of a window's angles over bins of time. A window's start (positions and velocities)
// is an unknown too; it has a prior from the angles around it, and is eliminated: every product of residuals and
// columns below is one of what no start can explain. That is linear in the start; where the simulation is not, weigh()
// moves the start to where it fits best, and is linear there. What is known of the start beforehand stays where it was.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/trees/hypothesis.hpp"
#include "host/trees/run.hpp"
#include "host/trees/windows.hpp"

namespace furcula::trees {

struct Fit {
  Hypothesis at;
  std::vector<Unknown> unknowns;
  double loss = 0.0;
  /// Of the unknowns, from the scatter of the windows' gradients and what is known beforehand; 0 at a bound.
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd of_prior;  ///< the part of it that comes from what is known beforehand
  /// Of the unknowns, those at a bound too, from the curvature of the loss alone: very large where nothing is told.
  Eigen::MatrixXd by_curvature;
  std::vector<bool> at_bound;
  /// Of a time of one drive: what is not known of it because each drive may take its commands at a tick of its own. Intervals alone have it:
  /// that the drive is late is told by the windows.
  std::vector<double> tick_sd;
  std::vector<double> window_loss;  ///< of each window
  /// Loss of each fold at what the others alone would have made of the unknowns (by the linear problem), summed.
  double held_out_loss = 0.0;
  /// Of each unknown, fitted on each fold alone (by the linear problem): its value, and its information there.
  std::vector<std::vector<double>> fold_value, fold_information;
  /// Of the residuals' simulation by the unknowns, each window's, weighted; of each unknown, where; by which weights.
  std::vector<Eigen::MatrixXd> derivatives;
  std::vector<double> derived_at;
  unsigned weighing = 0;
};

/// Products of columns over all windows, folds and one by one. Column 0 is the residual (measured less simulated),
/// then one for each unknown (its derivative of the simulation), then one for each probe (what it changes to first order in its
/// torques) and one for each run (simulation with it less that without).
struct Products {
  Eigen::MatrixXd all;
  std::vector<Eigen::MatrixXd> fold;
  std::vector<Eigen::MatrixXf> window;
  /// Of a probe that brings a spring, what the unknown start of its rotor accounts for of the residuals, less what it would of noise: a row
  /// each window. The probe's own column is without what another start would make of it.
  Eigen::MatrixXd of_rotors;
};

/// Of a fitted value: what the windows say, or the scatter between the recordings where that is more.
double variance_of(const Fit& fit, std::size_t unknown);

struct Interval {
  double lower, upper;
};
/// 95 % of an unknown, within its bounds. One at a bound has what lies inside of it; one about which the windows say nothing all that its
/// bounds leave; and one that another unknown can stand for as much as the bounds of both leave.
Interval interval_of(const Fit& fit, std::size_t unknown);

/// How far a cause's parameters, taken together, are from having no effect: the square over their variance. Of those without such a value
/// (a stiffness, a limit) and of those at a bound it knows nothing.
struct Away {
  double squares = 0.0;     ///< by variance_of
  double by_windows = 0.0;  ///< by the windows' variance alone
  std::size_t parameters = 0;
};
Away away_from_none(const TreeModel& model, const Fit& fit, std::size_t cause);

class Problem {
 public:
  Problem(const TreeModel& model, const std::vector<Recording>& recordings, std::vector<Window> windows,
          unsigned threads);

  const TreeModel& model() const { return model_; }
  const Scales& scales() const { return scales_; }
  const std::vector<Window>& windows() const { return windows_; }
  double interval_s() const { return recordings_.front().interval_s; }  ///< of the rows
  const std::vector<Recording>& recordings() const { return recordings_; }
  std::size_t folds() const { return folds_; }
  std::size_t fold_of(std::size_t window) const;
  std::size_t joints() const { return model_.joints(); }

  /// Steps of integration that the fits of this problem, and of what was made of it, have taken.
  std::size_t steps() const { return work_->steps; }
  /// From so many on, fits end where they are: for a search that may be given up.
  void stop_after(std::size_t steps) const { work_->most = steps; }
  bool spent() const { return work_->steps > work_->most; }

  /// The same on every so-manieth window, not weighed yet.
  Problem thinned(std::size_t every) const;

  /// How the starts move the residuals, and what each bin's residual weighs, at this hypothesis: the loss of one that is
  /// right is then about the number of residuals. Fits are comparable between two calls.
  /// `starts`: a hypothesis whose windows' starts are eliminated in place of those of `h`: with a spring that may be, its rotor's too.
  void weigh(const Hypothesis& h, const Hypothesis* starts = nullptr);
  /// From weigh() on: residuals are weighed by the likelihood of `h` under a random torque at each joint and noise, which are estimated from
  /// what `h` leaves (disturbance.hpp). A unit of the loss is then twice one of the logarithm of likelihood.
  void whiten(const Hypothesis& h);
  /// Least squares by the unknowns of `from`. `beside`: a fit that has most of them, whose derivatives serve as long as they lead down.
  Fit fit(Hypothesis from, int iterations, const Fit* beside = nullptr) const;
  /// Squares of what the windows' runs are off over those of the motion about its mean, of the joint where they are most.
  double misfit(const Hypothesis& h) const;
  Products products(const Hypothesis& h, const std::vector<Unknown>& unknowns,
                    const std::vector<Hypothesis>& probes, const std::vector<Hypothesis>& runs = {}) const;

 private:
  struct Start {
    Eigen::MatrixXd columns;    ///< weighted derivatives by the start
    Eigen::VectorXd precision;  ///< of its prior
    Eigen::MatrixXd inverse;    ///< of the start's normal matrix, its prior in it
    Eigen::VectorXd
        of_more;  ///< what the window's start_more takes off the residuals, to first order, weighted; empty: nothing
  };
  /// What is known of an elastic drive's rotor at a window's start, beside where its own equation says that it is: angle, rate.
  Eigen::Vector2d rotor_precision(const Setup& setup, std::size_t joint) const;
  static Run run_of(const Setup& setup, const Window& w);
  /// Means over the window's bins, a column for each run. Runs that are nearly the first go beside it.
  Eigen::MatrixXd simulated(std::span<const Run> runs, const Window& w) const;
  Eigen::VectorXd simulated(const Setup& setup, const Window& w) const;
  /// How the start moves what is simulated.
  Start start_of(const Setup& setup, const Window& w) const;
  /// The start with which `left` (not weighted) is least, less the measured one; by the linear problem.
  Eigen::VectorXd best_start(std::size_t window, const Eigen::VectorXd& left) const;
  /// What each bin's residual is worth: from what is left once the starts are fitted.
  void weigh_bins(const std::vector<Eigen::VectorXd>& left);
  double noise_rad(std::size_t joint) const;     ///< of its encoder, the most of all recordings
  std::vector<double> small_torques_nm() const;  ///< of each joint, one that changes nothing else
  /// Residuals or columns of a window over their standard deviations; after whiten() they are independent, too.
  Eigen::MatrixXd weighted(std::size_t window, const Eigen::MatrixXd& x) const;
  /// Takes the starts off all products, and weighs the windows. `left`: not weighted.
  void eliminate_starts(const std::vector<Eigen::VectorXd>& left);
  /// Moves the window's start to the best one, unless the linear problem is right about it. @return whether it did.
  bool move_start(const Setup& setup, std::size_t window, const Eigen::VectorXd& left);
  Eigen::VectorXd residual(const Setup& setup, std::size_t window) const;
  std::vector<Eigen::VectorXd> residuals(const Hypothesis& h) const;  ///< of each window
  /// Of each window: columns as in Products, but for the residual.
  std::vector<Eigen::MatrixXd> columns(const Hypothesis& h, const std::vector<Eigen::VectorXd>& residuals,
                                       const std::vector<Unknown>& unknowns,
                                       const std::vector<Hypothesis>& probes,
                                       const std::vector<Hypothesis>& runs,
                                       Eigen::MatrixXd* of_rotors = nullptr) const;
  /// What a time is not known by because part of a row is not, or of a latch's delay or offset the touch-downs' common lateness.
  double timing_doubt(const Cause& cause) const;
  /// Derivatives of those unknowns that `beside` does not have; the others are taken from there.
  void derive_beside(const Fit& beside, const std::vector<Eigen::VectorXd>& residuals, Fit& out) const;
  /// How well the unknowns are known, from the products at them: all of Fit but where it is, its loss and its derivatives.
  void set_intervals(const Products& p, double ridge, Fit& out) const;
  Products products_of(const std::vector<Eigen::VectorXd>& residuals,
                       const std::vector<Eigen::MatrixXd>& columns) const;
  Setup make(const Hypothesis& h) const { return maker_.make(h); }
  /// a' b over what no start explains.
  Eigen::MatrixXd product(std::size_t window, const Eigen::MatrixXd& columns) const;

  struct Work {
    std::atomic<std::size_t> steps = 0;
    std::size_t most = std::numeric_limits<std::size_t>::max();
  };
  const TreeModel& model_;
  const std::vector<Recording>& recordings_;
  std::vector<Window> windows_;
  unsigned threads_;
  SetupMaker maker_;
  Scales scales_;
  std::size_t bins_, folds_;
  Eigen::VectorXd weight_;             ///< of each bin and joint: one over a standard deviation
  std::vector<Eigen::MatrixXd> root_;  ///< of each window's covariance, lower triangular; empty: by weight_
  std::vector<double> window_weight_;  ///< less than 1 of a window that nothing explains
  std::vector<Start> starts_;
  unsigned weighing_ = 0;  ///< how often it was weighed
  std::shared_ptr<Work> work_ = std::make_shared<Work>();
};

}  // namespace furcula::trees
