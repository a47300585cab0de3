// Which recording disagrees, see disagreement.hpp.
#include "host/identify/disagreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/core/message.hpp"
#include "host/core/outlier.hpp"
#include "host/core/quantile.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

constexpr double kSuspect = 4.0;       // times the others' median NMSE
constexpr std::size_t kMostLooks = 6;  // fits, where anything stands out
constexpr double kOverNoise = 9.0;     // of the squares
constexpr std::size_t kFewest = 5;

/// Whether the others span how it was driven, how fast it moved and where.
bool within_others(const std::vector<Recording>& recordings, std::size_t index) {
  constexpr double kShare = 0.25;
  std::vector<double> inputs, speeds;
  double low = std::numeric_limits<double>::infinity(), high = -low, own_low = 0.0, own_high = 0.0;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const Recording& r = recordings[k];
    double input = 0.0, speed = 0.0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      input += r.input[i] * r.input[i] / static_cast<double>(r.rows());
      speed += r.velocity_smoothed[i] * r.velocity_smoothed[i] / static_cast<double>(r.rows());
    }
    inputs.push_back(std::sqrt(input));
    speeds.push_back(std::sqrt(speed));
    const double lowest = core::quantile(r.position, 0.01), highest = core::quantile(r.position, 0.99);
    if (k == index) {
      own_low = lowest;
      own_high = highest;
    } else {
      low = std::min(low, lowest);
      high = std::max(high, highest);
    }
  }
  const double room = kShare * (high - low);
  return core::within_others(inputs, index, core::kHarder) &&
         core::within_others(speeds, index, core::kFaster) && own_low >= low - room &&
         own_high <= high + room;
}

/// Of the recordings, what a fit's windows leave: over the motion about its mean, and over noise.
struct Left {
  std::vector<double> nmse, over_noise;
};

Left left_by(const std::vector<WindowShare>& shares, const std::vector<double>& squares,
             const std::vector<Recording>& recordings, const std::vector<Window>& windows) {
  std::vector<double> sums(recordings.size(), 0.0), rows = sums, motion = sums;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const Window& w = windows[k];
    const Recording& r = recordings[w.recording];
    sums[w.recording] += squares[k];
    rows[w.recording] += shares[k][Channel::motion].rows;
    double mean = 0.0, spread = 0.0;
    for (std::size_t i = w.first; i <= w.last; ++i) mean += r.position[i] / static_cast<double>(w.rows());
    for (std::size_t i = w.first; i <= w.last; ++i) spread += std::pow(r.position[i] - mean, 2);
    motion[w.recording] += spread / std::pow(r.position_noise, 2);
  }
  Left left;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    left.nmse.push_back(motion[i] > 0.0 ? sums[i] / motion[i] : 0.0);
    left.over_noise.push_back(rows[i] > 0.0 ? sums[i] / rows[i] : 0.0);
  }
  return left;
}

std::vector<double> squares_of_motion(const std::vector<WindowShare>& shares) {
  std::vector<double> all;
  for (const WindowShare& s : shares) all.push_back(s[Channel::motion].squares);
  return all;
}

/// By the linear problem: what each window leaves of the motion where the recordings but one would have put the unknowns. Not less than
/// noise.
std::vector<double> squares_without(const Fit& fit, const std::vector<Window>& windows, std::size_t one,
                                    std::size_t unknowns) {
  if (unknowns == 0) return squares_of_motion(fit.shares);  // nothing to refit
  const auto count = static_cast<Eigen::Index>(unknowns);
  Eigen::MatrixXd others = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd of_others = Eigen::VectorXd::Zero(count);
  for (std::size_t k = 0; k < windows.size(); ++k)
    if (windows[k].recording != one) {
      others += fit.shares[k].information;
      of_others += fit.shares[k].gradient;
    }
  const Eigen::VectorXd step = LeavingOut(fit.shares, fit.at_bound).step(others, of_others);
  std::vector<double> squares = squares_of_motion(fit.shares);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const WindowShare& s = fit.shares[k];
    const double moved = 2.0 * s.gradient.dot(step) + step.dot(s.information * step);
    squares[k] = std::max(squares[k] + moved, std::min(squares[k], s[Channel::motion].rows));
  }
  return squares;
}

core::Outlier apart(const Left& left, std::size_t i) {
  core::Outlier found = core::outlier(left.nmse, i);
  found.far = found.far && left.over_noise[i] > kOverNoise;
  return found;
}

}  // namespace

namespace {

/// Where a belt falls back teeth catch it: a force that no machine repeats decides on which, and with it where the whole recording ends.
bool runs_are_steady(dynamics::Kind kind) { return machines::rules(kind).cut != machines::Cut::releases; }

}  // namespace

std::optional<Disagreement> disagreeing(const std::vector<FittedSet>& sets,
                                        const std::vector<Recording>& recordings,
                                        const std::vector<Window>& windows,
                                        const LikelierOfAnother& another) {
  if (recordings.size() < kFewest || sets.empty() || !runs_are_steady(sets.front().model.kind))
    return std::nullopt;
  struct Suspect {
    std::size_t set, recording;
    double others;  ///< squares, by the linear problem
  };
  // Of each set the one that stands out most; what was chosen first, then by what is left of the others.
  std::vector<Suspect> suspects;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (sets[s].fit.shares.size() != windows.size()) continue;
    std::optional<Suspect> worst;
    double most = kSuspect;
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      const std::vector<double> squares = squares_without(sets[s].fit, windows, i, sets[s].unknowns.size());
      const double times = apart(left_by(sets[s].fit.shares, squares, recordings, windows), i).times;
      if (times <= most) continue;
      most = times;
      worst = Suspect{s, i, 0.0};
      for (std::size_t k = 0; k < windows.size(); ++k)
        if (windows[k].recording != i) worst->others += squares[k];
    }
    if (worst && within_others(recordings, worst->recording)) suspects.push_back(*worst);
  }
  std::sort(suspects.begin(), suspects.end(), [](const Suspect& x, const Suspect& y) {
    return std::pair(x.set != 0, x.others) < std::pair(y.set != 0, y.others);
  });
  if (suspects.size() > kMostLooks) suspects.resize(kMostLooks);
  for (const Suspect& suspect : suspects) {
    // In earnest.
    const FittedSet& set = sets[suspect.set];
    std::vector<Window> others;
    for (const Window& w : windows)
      if (w.recording != suspect.recording) others.push_back(w);
    const Fit without = fit_by_simulation(set.model, set.unknowns, set.fit.values, recordings, others,
                                          Weighting::noise, set.fit.layers);
    const Fit look = look_by_simulation(set.model, set.unknowns, without.values, recordings, windows);
    const Left left = left_by(look.shares, squares_of_motion(look.shares), recordings, windows);
    const core::Outlier found = apart(left, suspect.recording);
    if (!found.far || !another(suspect.set, suspect.recording, without)) continue;
    return Disagreement{suspect.recording,
                        "disagrees with the other " + std::to_string(recordings.size() - 1) +
                            ": fitted on those, the model leaves " + core::rounded(found.times, 2) +
                            " times as much of its motion as of theirs"};
  }
  return std::nullopt;
}

std::vector<std::string> disagreeing_held_out(const model::Model& fitted,
                                              const std::vector<Recording>& training,
                                              const std::vector<Recording>& held_out,
                                              const std::vector<Window>& of_training,
                                              const std::vector<Window>& of_held_out) {
  std::vector<std::string> all;
  if (!runs_are_steady(fitted.kind)) return all;
  const Fit fitted_to = look_by_simulation(fitted, {}, {}, training, of_training, Starting::linear);
  const Left training_left =
      left_by(fitted_to.shares, squares_of_motion(fitted_to.shares), training, of_training);
  const Fit look = look_by_simulation(fitted, {}, {}, held_out, of_held_out, Starting::linear);
  const Left left = left_by(look.shares, squares_of_motion(look.shares), held_out, of_held_out);
  for (std::size_t i = 0; i < held_out.size(); ++i) {
    Left beside = training_left;
    beside.nmse.push_back(left.nmse[i]);
    beside.over_noise.push_back(left.over_noise[i]);
    const core::Outlier found = apart(beside, training.size());
    if (!found.far) continue;
    std::vector<Recording> recordings = training;
    recordings.push_back(held_out[i]);
    if (within_others(recordings, training.size()))
      all.push_back(held_out[i].name + ", which is held out, disagrees with the " +
                    std::to_string(training.size()) + " that were fitted: the model leaves " +
                    core::rounded(found.times, 2) +
                    " times as much of its motion as of theirs. It stands in all held-out figures.");
  }
  return all;
}

}  // namespace furcula::identify
