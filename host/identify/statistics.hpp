// What a fit's windows say of its values: how many independent numbers their residuals are worth, and how the
// values would scatter if it were all recorded again.
#pragma once

#include <Eigen/Dense>
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
  double squares = 0.0;         ///< of all channels
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

/// Covariance of the unknowns from the scatter of the windows' gradients about zero (a sandwich), so that
/// neighbouring samples need not be independent; entries of unknowns at a bound are zero. Windows in layers
/// stand in the order of their begin.
///
/// Windows that overlap share noise: `layers` of them in a row are summed up, and of what neighbouring sums
/// have in common half is counted (Newey and West's weight at the first lag, which keeps the covariance
/// positive). It is enlarged by n / (n - unknowns), n the number of independent windows.
Eigen::MatrixXd sandwich_covariance(const std::vector<WindowShare>& shares, const std::vector<bool>& at_bound,
                                    std::size_t layers = 1);

}  // namespace furcula::identify
