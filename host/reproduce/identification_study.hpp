// The identification of document 002, section 4.2, at its full scale: stance, flight, whole strides and the
// non-linear model, cross-validated, by both estimators.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/reproduce/virtual_rig.hpp"

namespace furcula::reproduce {

/// Of one recording, predicted by an estimate that has not seen it. NMSE as in eq. 4.4.
struct TrajectoryErrors {
  double nmse_height = 0.0, nmse_velocity = 0.0;
  double mae_height_m = 0.0, mae_velocity_mps = 0.0;
  double worst_height_m = 0.0;
};

/// The same predictions, started or judged as the document does.
struct OtherJudging {
  std::string what;
  std::vector<TrajectoryErrors> errors;  ///< one a recording
};

/// What one estimator found on one phase.
struct Estimates {
  std::string phase;                       ///< "stance", "flight", "stride", "stance, non-linear"
  std::string method;                      ///< "simulation", "equation"
  std::vector<std::string> names, units;   ///< of the parameters
  std::vector<double> values;              ///< on all recordings
  std::vector<std::vector<double>> folds;  ///< one a fold left out
  std::vector<TrajectoryErrors> errors;    ///< one a recording
  std::vector<OtherJudging> otherwise;     ///< of "stance", "flight" and "stride"

  double value(std::string_view name) const { return values[index(name)]; }
  /// Largest less smallest estimate over the folds, over their mean.
  double spread(std::string_view name) const;
  /// Smallest and largest estimate over the folds.
  std::pair<double, double> range(std::string_view name) const;
  std::size_t index(std::string_view name) const;  ///< @throws std::out_of_range for no such parameter
};

/// The same fits the plain way (plain_fit.hpp), cross-validated too.
struct PlainStudy {
  Estimates estimates;
  std::size_t fits = 0, evaluations = 0, converged = 0;
  double plain_s = 0.0, ours_s = 0.0;  ///< wall time of all fits of this phase on one thread
  /// NMSE(z) + NMSE(z') of both estimates on all recordings, mean, from one set of estimated starts.
  double plain_nmse = 0.0, ours_nmse = 0.0;
  /// The same over the windows with the start of each run fitted to it, which is what our way makes least, and
  /// with the measured state as its start, which is what the plain way makes least.
  double plain_nmse_fitted = 0.0, ours_nmse_fitted = 0.0, plain_nmse_measured = 0.0, ours_nmse_measured = 0.0;
};

/// Predicted and measured heights of one recording.
struct Example {
  std::string recording;
  std::vector<double> time_s, measured_m, predicted_m;
};

struct IdentificationStudy {
  VirtualRig rig;  ///< without its logs
  Estimates stance, stance_by_equation, flight, flight_by_equation, strides, nonlinear;
  /// The same from differences of counts as the rig derives them, instead of the slope of a smoothing fit.
  Estimates stance_by_equation_raw;
  /// By how much the velocity that the rig records lags, s.
  double recorded_delay_s = 0.0;
  /// Equation error where the smooth velocity, without noise of its own, is made late.
  struct Delayed {
    double delay_s, damping_nspm, damped_frequency_radps;
    double nmse;  ///< NMSE(z) + NMSE(z'), mean of the recordings that are predicted
  };
  std::vector<Delayed> equation_by_delay;
  /// Stance by simulation error with other parameters held: mass, spring rate, damping (section 6.1.1).
  struct Variant {
    std::string freed;
    double mass_kg, stiffness_npm, damping_nspm, damped_frequency_radps;
    double nmse;  ///< NMSE(z) + NMSE(z') on all recordings, mean
  };
  std::vector<Variant> variants;
  /// How much the cost of the non-linear fit changes, relatively, when 0.1 kg is added at the toe, which
  /// stands still (m, e, b, a by 1, 2 L, L, 2 L^2 a kilogram).
  double toe_mass_cost_change = 0.0;
  /// By how much NMSE(z) + NMSE(z') grows in the mean where a and b are held at zero, the rest fitted again.
  double nmse_of_a_and_b = 0.0;
  bool b_at_bound = false;
  /// The mass that height feels in stance, M of theta over the lever's square, mean over the stances, in
  /// closed form: of the rig's true links, kg; of the document's over 1.62 kg, with a as in table 3.1 and
  /// with a from the masses it prints.
  double effective_stance_mass_kg = 0.0, table_mass_ratio = 0.0, printed_links_mass_ratio = 0.0;
  /// What the noise of the positions does to each flight's prediction, through its start, to first order.
  std::vector<TrajectoryErrors> flight_floor;  ///< the two NMSE alone
  /// The viscous damping that takes the same power from the flights as the rig's damping and friction.
  double equivalent_flight_damping_nspm = 0.0;
  std::vector<PlainStudy> plain;
  std::vector<double>
      stride_torque_late_s;            ///< first torque after the measured touch-down, s; below 0: before
  std::vector<Example> good_and_poor;  ///< whole strides: the best and the worst predicted one
  double seconds = 0.0;                ///< the fits and predictions, without the peer's
};

struct StudyOptions {
  std::uint64_t seed = 1;
  std::size_t stances = 60, flights = 20, stance_folds = 10, flight_folds = 5;
  bool plain = true;      ///< with the peer's fits
  bool equation = true;   ///< with the fits by equation error
  bool nonlinear = true;  ///< with the non-linear model's
  RigChange change;       ///< of the rig
  unsigned threads = 1;
  std::function<void(double fraction, std::string_view doing)> progress;
};

/// The same for any number of threads, but for the times.
IdentificationStudy run_identification_study(const StudyOptions& options);

/// sqrt(k/m) sqrt(1 - xi^2), section 4.2.1.1.
double damped_frequency_radps(double mass_kg, double stiffness_npm, double damping_nspm);

/// Section 4.2: differences of the heights through a third-order Butterworth filter of 15 Hz, forwards and
/// back. Rows at one rate, three at least.
std::vector<double> filtered_velocity(const std::vector<double>& time_s, const std::vector<double>& height_m);

}  // namespace furcula::reproduce
