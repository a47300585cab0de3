// Simulation-error least squares: the unknowns that make free runs of the model meet the measured positions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "host/identify/statistics.hpp"
#include "host/identify/unknowns.hpp"
#include "host/identify/whitening.hpp"
#include "host/identify/windows.hpp"

namespace furcula::identify {

/// How residuals are weighted.
enum class Weighting {
  noise,  ///< positions over their noise
  /// Positions and velocities over the window's spread: each window adds NMSE(z) + NMSE(z'), 002 eq. 4.4.
  nmse,
};

struct Fit {
  std::vector<double> values;  ///< of the unknowns
  double squares = 0.0;
  std::vector<WindowShare> shares;  ///< one a window, in their order
  /// Of the unknowns; from how they move without each window (statistics.hpp), so that neighbouring samples need
  /// not be independent.
  Eigen::MatrixXd covariance;
  std::vector<bool> at_bound;
  /// Of unknowns that the runs jump with (unknowns.hpp, jumps), and do not change with in between: from where
  /// to where they explain the windows as well, or worse by no more than chance. Equal ends: not such an unknown, or not within such a range.
  std::vector<std::pair<double, double>> ranges;
  std::size_t layers = 1;  ///< in how many of the windows each row lies
};

/// How a fit seeks.
struct Effort {
  int most_iterations = 60;
  /// Whether a search along each step looks for how far to go, by runs with derivatives: they are what a fit costs. Without it steps that
  /// do not lead down are taken back and shortened, which ends elsewhere in the last digits.
  bool along_steps = true;
  /// A window whose squares are far below this counts by them, one beyond it as a third of this, whatever its squares: Tukey's loss of
  /// whole windows. A belt that the teeth caught one tooth further would outweigh thousands of other falls.
  double most_squares = std::numeric_limits<double>::infinity();
  const std::vector<Whitening>* whitening = nullptr;  ///< of each window; none: residuals as they are
};
/// Of fits on many rows: on some of them, and then on all.
inline constexpr Effort kOnSome{60, false}, kFromNear{20, false};

/// `layers`: in how many of the windows each row lies; the covariance takes it into account.
/// @throws core::DataError where no run of the model stays finite.
/// Fits the unknowns from `start` (values, within bounds) on the windows, each with a start state of its own.
Fit fit_by_simulation(const model::Model& model, const std::vector<Unknown>& unknowns,
                      const std::vector<double>& start, const std::vector<Recording>& recordings,
                      const std::vector<Window>& windows, Weighting weighting = Weighting::noise,
                      std::size_t layers = 1, const Effort& effort = {});

/// Values from which a fit on many rows has a short way: fitted from `start` on some of the windows alone, those that tell most of these
/// unknowns there. Nothing where the rows are not many, or of a belt, whose runs jump.
std::optional<std::vector<double>> begin_on_some(const model::Model& model,
                                                 const std::vector<Unknown>& unknowns,
                                                 const std::vector<double>& start,
                                                 const std::vector<Recording>& recordings,
                                                 const std::vector<Window>& windows);

/// How the windows' start states, which are measured, come to their optimum: by running them again until they
/// are there, or by a linear step in the same run, at a third of the price.
enum class Starting : std::uint8_t { at_optimum, linear };

/// The bound of that loss at which nineteen of twenty windows that scatter as one normal number does keep nearly all their weight, whatever
/// the largest quarter of them is. Infinite without windows, or where most leave nothing.
double most_squares_of(const std::vector<WindowShare>& shares);

/// The windows' shares at values that are not fitted.
Fit look_by_simulation(const model::Model& model, const std::vector<Unknown>& unknowns,
                       const std::vector<double>& values, const std::vector<Recording>& recordings,
                       const std::vector<Window>& windows, Starting starting = Starting::at_optimum,
                       double most_squares = std::numeric_limits<double>::infinity(),
                       const std::vector<Whitening>* whitening = nullptr);

/// The fit by the parameters of the laws, where those are not what is fitted (unknowns.hpp); else the same.
/// A coordinate that lies on its bound is not thereby known: the covariance is that without the bound.
Fit in_law_parameters(Fit fit, const std::vector<Unknown>& unknowns, const model::Model& model);

/// @throws core::DataError, naming the first recording, where `finite` is false.
void require_finite(bool finite, const std::vector<Recording>& recordings,
                    const std::vector<Window>& windows);

/// Which values lie on a bound of their unknown.
std::vector<bool> at_bounds(const std::vector<double>& values, const std::vector<Unknown>& unknowns);

}  // namespace furcula::identify
