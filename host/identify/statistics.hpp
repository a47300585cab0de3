// What a fit's windows say of its values: how many independent numbers their residuals are worth, and how the
// values would scatter if it were all recorded again.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace furcula::identify {

/// What residuals are of: the body's motion, when the contact switch reports, what the drive reports, the
/// angle of the leg about its mean over the window (where its encoder's zero is, no model says). With
/// Weighting::nmse of the motion alone.
enum class Channel { motion, contact, drive, leg };
inline constexpr std::size_t kChannels = 4;

/// Residuals of one channel.
struct ChannelShare {
  double squares = 0.0;         ///< of the weighted residuals
  double rows = 0.0;            ///< residuals
  double effective_rows = 0.0;  ///< independent residuals that say as much: rows over the correlation time
};

/// A window's part in a fit, its start state eliminated.
struct WindowShare {
  std::array<ChannelShare, kChannels> channels;
  double squares = 0.0;         ///< of all channels, as they count (simulation_fit.hpp, Effort)
  double all_squares = 0.0;     ///< of all channels, as they are
  Eigen::VectorXd gradient;     ///< half the derivative of `squares` by the unknowns
  Eigen::MatrixXd information;  ///< Gauss-Newton half Hessian
  std::array<Eigen::MatrixXd, kChannels> information_of;  ///< of each channel; empty where there is one alone

  const ChannelShare& operator[](Channel c) const { return channels[static_cast<std::size_t>(c)]; }
};

/// How many independent numbers these residuals are worth: their count over the integrated autocorrelation,
/// summed up to where it first falls below 0.05.
double effective_count(const Eigen::Ref<const Eigen::VectorXd>& residual);

/// How many independent windows so many are worth of which each row lies in `layers`: as many as lie side by
/// side.
double independent_windows(std::size_t windows, std::size_t layers);

/// How an estimate moves, by one linear step, where some of its windows are left out. Of a direction of which the others tell less than a
/// twentieth of what all do a step is no longer than if they told so much: they do not know better.
class LeavingOut {
 public:
  LeavingOut(const std::vector<WindowShare>& shares, const std::vector<bool>& at_bound);

  const std::vector<Eigen::Index>& moving() const { return moving_; }  ///< unknowns that are not at a bound
  /// From coordinates in which all windows' information is one to the moving unknowns, and of a gradient by these the other way.
  const Eigen::MatrixXd& to_unit() const { return to_unit_; }
  /// In those coordinates. `own`: the information of the moving unknowns that goes, `pull`: the gradient that is then missing. To `alone`
  /// the directions are added of which the others hardly tell.
  Eigen::VectorXd unit_step(const Eigen::MatrixXd& own, const Eigen::VectorXd& pull,
                            std::vector<Eigen::VectorXd>* alone = nullptr) const;
  /// Of all unknowns; those at a bound stay there. `others`: what stays.
  Eigen::VectorXd step(const Eigen::MatrixXd& others, const Eigen::VectorXd& gradient_of_others) const;

 private:
  Eigen::Index count_;
  std::vector<Eigen::Index> moving_;
  Eigen::MatrixXd information_, to_unit_;
};

/// Covariance of the unknowns from how the estimate moves without each window (the jackknife, by one linear step each), so that neighbouring
/// samples need not be independent, and what few windows alone tell is as uncertain as it is; entries of unknowns at a bound are zero.
/// Windows in layers stand in the order of their begin.
///
/// Windows that overlap share noise: `layers` of them in a row are left out together, and of what neighbouring steps
/// have in common half is counted (Newey and West's weight at the first lag, which keeps the covariance
/// positive). Of a direction that hardly any other window tells no window says how it scatters: at least as the other directions do, for
/// their information.
Eigen::MatrixXd jackknife_covariance(const std::vector<WindowShare>& shares,
                                     const std::vector<bool>& at_bound, std::size_t layers = 1);

}  // namespace furcula::identify
