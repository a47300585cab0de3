#include "host/identify/simulation_fit.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "host/core/error.hpp"
#include "host/core/quantile.hpp"
#include "host/identify/window_cost.hpp"
#include "host/linear/linear.hpp"

namespace furcula::identify {
namespace {

Weights weights_of(const Recording& r, const Window& w, Weighting weighting) {
  if (weighting == Weighting::noise) {
    Weights weights{1.0 / std::max(r.position_noise, 1e-12)};
    if (std::isfinite(w.report_lag_s)) weights.contact = 1.0 / w.report_spread_s;
    if (!r.drive.empty()) weights.drive = 1.0 / r.drive_noise;
    if (!r.leg_angle.empty()) weights.leg = 1.0 / r.leg_angle_noise;
    return weights;
  }
  const auto spread = [&](const std::vector<double>& values) {
    double mean = 0.0, squares = 0.0;
    for (std::size_t i = w.first; i <= w.last; ++i) mean += values[i] / static_cast<double>(w.rows());
    for (std::size_t i = w.first; i <= w.last; ++i) squares += (values[i] - mean) * (values[i] - mean);
    return std::max(std::sqrt(squares), 1e-12);
  };
  return {1.0 / spread(r.position), 1.0 / spread(r.velocity_smoothed)};
}

/// Tukey's loss of a window's squares and its derivative.
struct Bounded {
  double loss, slope;
};
Bounded bounded(double squares, double most) {
  if (!std::isfinite(most) || !std::isfinite(squares)) return {squares, 1.0};
  double rho[3];
  ceres::TukeyLoss(std::sqrt(most)).Evaluate(squares, rho);
  return {rho[0], rho[1]};
}

/// The share as it counts under that loss.
WindowShare bounded(WindowShare share, double most) {
  if (!std::isfinite(most)) return share;
  const auto [loss, slope] = bounded(share.squares, most);
  const double part = share.squares > 0.0 ? loss / share.squares : 1.0;
  share.squares = loss;
  for (ChannelShare& c : share.channels) c.squares *= part;
  share.gradient *= slope;
  share.information *= slope;
  for (Eigen::MatrixXd& of : share.information_of) of *= slope;
  return share;
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Moves the window's start state towards its own optimum at these values, by at most so many Gauss-Newton rounds.
void settle(const WindowCost& cost, const std::vector<double>& values, double* start, int rounds) {
  const auto rows = static_cast<Eigen::Index>(cost.num_residuals());
  Eigen::VectorXd residual(rows);
  RowMajor by_start(rows, kStartSize);
  const auto evaluate = [&](const double* at) {
    const double* blocks[2] = {values.data(), at};
    double* jacobians[2] = {nullptr, by_start.data()};
    const bool some = !values.empty();
    return cost.Evaluate(blocks + (some ? 0 : 1), residual.data(), jacobians + (some ? 0 : 1));
  };
  double best = std::numeric_limits<double>::infinity();
  if (rounds > 0 && evaluate(start)) best = residual.squaredNorm();
  for (int round = 0; round < rounds; ++round) {
    const Eigen::Vector2d step = by_start.colPivHouseholderQr().solve(residual);
    const double trial[kStartSize] = {start[0] - step(0), start[1] - step(1)};
    const bool usable = evaluate(trial);
    const double squares = usable ? residual.squaredNorm() : best;
    if (!(squares < best * (1.0 - 1e-9))) break;
    best = squares;
    std::copy(trial, trial + kStartSize, start);
  }
}

/// The window's share at these values, its start state settled by so many rounds, and from there by a linear step.
WindowShare share_of(const WindowCost& cost, const std::vector<double>& values, double* start, int rounds) {
  settle(cost, values, start, rounds);
  const auto rows = static_cast<Eigen::Index>(cost.num_residuals());
  const auto count = static_cast<Eigen::Index>(values.size());
  Eigen::VectorXd residual(rows);
  RowMajor by_unknowns(rows, count);
  RowMajor by_start(rows, kStartSize);
  const double* blocks[2] = {values.data(), start};
  double* jacobians[2] = {by_unknowns.data(), by_start.data()};
  const bool some = count > 0;
  cost.Evaluate(blocks + (some ? 0 : 1), residual.data(), jacobians + (some ? 0 : 1));
  WindowShare share;
  const Eigen::ColPivHouseholderQR<RowMajor> qr(by_start);
  const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(rows, qr.rank());
  const std::size_t sizes[kChannels] = {cost.run().motion_rows(), cost.run().contact_rows(),
                                        cost.run().drive_rows(), cost.run().leg_rows()};
  if (count > 0) {
    const Eigen::MatrixXd projected = by_unknowns - basis * (basis.transpose() * by_unknowns);
    share.gradient = projected.transpose() * residual;
    share.information = projected.transpose() * projected;
    for (std::size_t c = 0, from = 0; c < kChannels && sizes[0] != static_cast<std::size_t>(rows);
         from += sizes[c++]) {
      const auto part =
          projected.middleRows(static_cast<Eigen::Index>(from), static_cast<Eigen::Index>(sizes[c]));
      share.information_of[c] = part.transpose() * part;
    }
  } else {
    share.gradient.resize(0);
    share.information.resize(0, 0);
  }
  share.squares = share.all_squares = residual.squaredNorm() - (basis.transpose() * residual).squaredNorm();
  Eigen::Index from = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto part = residual.segment(from, static_cast<Eigen::Index>(sizes[c]));
    share.channels[c] = {part.squaredNorm(), static_cast<double>(sizes[c]), effective_count(part)};
    from += static_cast<Eigen::Index>(sizes[c]);
  }
  return share;
}

}  // namespace

void take_off_column_means(double* values, std::size_t rows, std::size_t columns) {
  Eigen::Map<RowMajor> part(values, static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  part.rowwise() -= part.colwise().mean().eval();
}

void require_finite(bool finite, const std::vector<Recording>& recordings,
                    const std::vector<Window>& windows) {
  if (!finite)
    throw core::DataError(
        recordings[windows.front().recording].name +
        ": the model's run does not stay finite on these recordings; expected inputs and units that fit the model");
}

std::vector<bool> at_bounds(const std::vector<double>& values, const std::vector<Unknown>& unknowns) {
  std::vector<bool> all;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const double margin = 1e-9 * (unknowns[i].upper - unknowns[i].lower);
    all.push_back(values[i] <= unknowns[i].lower + margin || values[i] >= unknowns[i].upper - margin);
  }
  return all;
}

Fit in_law_parameters(Fit fit, const std::vector<Unknown>& unknowns, const model::Model& model) {
  const auto first = std::find_if(unknowns.begin(), unknowns.end(), [](const Unknown& u) {
    return u.of_effect && u.effect == dynamics::Effect::leg_inertia && u.parameter == 0;
  });
  if (first == unknowns.end()) return fit;
  const Eigen::Index at = first - unknowns.begin();
  const auto count = static_cast<Eigen::Index>(unknowns.size());
  Eigen::MatrixXd to_law = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index k = 0; k < 3; ++k) {
    std::array<double, 3> unit{};
    unit[static_cast<std::size_t>(k)] = 1.0;
    links_to_law(unit, model.parameter("link_length_m"));
    to_law.block<3, 1>(at, at + k) = Eigen::Vector3d(unit[0], unit[1], unit[2]);
  }
  for (std::size_t k = 0; k < 3; ++k) fit.at_bound[static_cast<std::size_t>(at) + k] = false;
  fit.covariance = jackknife_covariance(fit.shares, fit.at_bound, fit.layers);
  Eigen::Map<Eigen::VectorXd> values(fit.values.data(), count);
  values = (to_law * values).eval();
  fit.covariance = to_law * fit.covariance * to_law.transpose();
  const Eigen::MatrixXd back = linear::inverse(to_law);
  for (WindowShare& s : fit.shares) {
    s.gradient = back.transpose() * s.gradient;
    s.information = back.transpose() * s.information * back;
  }
  return fit;
}

namespace {

/// The windows' costs and start states.
struct Costs {
  std::deque<WindowCost> costs;
  std::vector<double> starts;

  Costs(const model::Model& model, const std::vector<Unknown>& unknowns,
        const std::vector<Recording>& recordings, const std::vector<Window>& windows, Weighting weighting,
        const std::vector<Whitening>* whitening = nullptr)
      : starts(windows.size() * kStartSize) {
    require_room(unknowns);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const Recording& r = recordings[windows[i].recording];
      costs.emplace_back(model, unknowns, r, windows[i], weights_of(r, windows[i], weighting),
                         whitening ? &(*whitening)[i] : nullptr);
      const StartState s = start_state(r, windows[i]);
      starts[kStartSize * i] = s.position;
      starts[kStartSize * i + 1] = s.velocity;
    }
  }
  void shares(Fit& fit, int rounds, double most_squares) {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      fit.shares.push_back(
          bounded(share_of(costs[i], fit.values, &starts[kStartSize * i], rounds), most_squares));
      fit.squares += fit.shares.back().squares;
    }
  }
};

}  // namespace

double most_squares_of(const std::vector<WindowShare>& shares) {
  // Of a normal number's square: its upper quartile, and Tukey's bound for 95 % efficiency (4.685 standard deviations).
  constexpr double kQuartile = 1.3233, kBound = 4.685 * 4.685;
  std::vector<double> squares;
  for (const WindowShare& s : shares) squares.push_back(s.all_squares);
  if (squares.empty()) return std::numeric_limits<double>::infinity();
  const double quartile = core::quantile(squares, 0.75);
  // Runs that meet the recordings in every digit give no scale.
  return quartile > 0.0 ? kBound / kQuartile * quartile : std::numeric_limits<double>::infinity();
}

Fit look_by_simulation(const model::Model& model, const std::vector<Unknown>& unknowns,
                       const std::vector<double>& values, const std::vector<Recording>& recordings,
                       const std::vector<Window>& windows, Starting starting, double most_squares,
                       const std::vector<Whitening>* whitening) {
  Fit fit;
  fit.values = values;
  fit.at_bound = at_bounds(values, unknowns);
  Costs(model, unknowns, recordings, windows, Weighting::noise, whitening)
      .shares(fit, starting == Starting::linear ? 0 : 2, most_squares);
  return fit;
}

namespace {

bool is_of_swing(const Unknown& u) { return u.of_effect && dynamics::info(u.effect).search.swings; }

/// A phase is the same a turn further: into [-pi, pi], as it is expected to be reported.
void wrap_phases(std::vector<double>& values, const std::vector<Unknown>& unknowns) {
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (is_of_swing(unknowns[i]) && unknowns[i].parameter == 2)
      values[i] = std::remainder(values[i], 2.0 * std::numbers::pi);
}

/// Moves the values and start states to where the squares are least. False where the runs do not stay finite.
bool solve(Costs& problems, const std::vector<Unknown>& unknowns, std::vector<double>& values,
           const Effort& effort) {
  auto& [costs, starts] = problems;
  if (unknowns.empty() || costs.empty()) return true;
  // By what goes up and down with the position, right values look wrong beside a start that is off.
  if (std::any_of(unknowns.begin(), unknowns.end(), is_of_swing))
    for (std::size_t i = 0; i < costs.size(); ++i) settle(costs[i], values, &starts[kStartSize * i], 1);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  std::optional<ceres::TukeyLoss> loss;
  if (std::isfinite(effort.most_squares)) loss.emplace(std::sqrt(effort.most_squares));
  ceres::Problem problem(problem_options);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  options.max_num_iterations = effort.most_iterations;
  // Of the squares, which judge a cause by their logarithm times the number of rows: less is no evidence, and
  // a law with more parameters than the recordings can tell creeps on for as long as it may.
  options.function_tolerance = 1e-6;
  options.parameter_tolerance = 1e-10;
  if (!effort.along_steps) options.max_num_line_search_step_size_iterations = 0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    problem.AddResidualBlock(&costs[i], loss ? &*loss : nullptr, values.data(), &starts[kStartSize * i]);
    options.linear_solver_ordering->AddElementToGroup(&starts[kStartSize * i], 0);
  }
  options.linear_solver_ordering->AddElementToGroup(values.data(), 1);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    values[i] = std::clamp(values[i], unknowns[i].lower, unknowns[i].upper);
    problem.SetParameterLowerBound(values.data(), static_cast<int>(i), unknowns[i].lower);
    problem.SetParameterUpperBound(values.data(), static_cast<int>(i), unknowns[i].upper);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  wrap_phases(values, unknowns);
  return summary.IsSolutionUsable();
}

double mean_square(const WindowShare& share) {
  double rows = 0.0;
  for (const ChannelShare& c : share.channels) rows += c.rows;
  return share.squares / std::max(rows, 1.0);
}

/// The unknowns that the runs jump with, looked through value by value.
class Jumping {
 public:
  Jumping(Costs& problems, const std::vector<Unknown>& unknowns, dynamics::Kind kind, double most_squares)
      : problems_(problems), most_squares_(most_squares), ranges_(unknowns.size(), {0.0, 0.0}) {
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      if (const auto range = jumps(unknowns[i], kind)) all_.push_back({i, *range});
  }
  bool any() const { return !all_.empty(); }
  const std::vector<std::pair<double, double>>& ranges() const { return ranges_; }

  /// Of all windows, their start states as they are; where they are more than `most`, of the windows up to there.
  double squares(const std::vector<double>& values,
                 double most = std::numeric_limits<double>::infinity()) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < problems_.costs.size() && sum <= most; ++i)
      sum += bounded(squares_of(i, values), most_squares_).loss;
    return sum;
  }

  /// The ranges out to where the likelihood ratio of that value is at its 95 % point: a window or two may end on another tooth by what
  /// disturbs the machine. Of how many independent residuals, the scatter of the windows' mean squares tells (2 by their relative variance).
  void widen(const Fit& fit, std::size_t layers) {
    constexpr double kLevel = 0.05;
    const auto windows = static_cast<double>(fit.shares.size());
    double rows = 0.0, mean = 0.0, variance = 0.0;
    for (const WindowShare& share : fit.shares) {
      for (const ChannelShare& c : share.channels) rows += c.effective_rows;
      mean += mean_square(share) / windows;
    }
    for (const WindowShare& share : fit.shares)
      variance += std::pow(mean_square(share) - mean, 2) / (windows - 1.0);
    const double independent = std::min(rows, windows * 2.0 * mean * mean / std::max(variance, 1e-300)) /
                               static_cast<double>(layers);
    if (fit.shares.size() < 3 || !(independent > 0.0)) return;
    const double most = squares(fit.values) * std::exp(core::chi_square_above(kLevel, 1.0) / independent);
    for (const Sought& u : all_)
      if (auto& range = ranges_[u.index]; range.first < range.second)
        range = range_about(u, fit.values, fit.values[u.index], most);
  }

  /// The share of the windows that lie beyond the bound of the loss there.
  double beyond(const std::vector<double>& values) const {
    double count = 0.0;
    for (std::size_t i = 0; i < problems_.costs.size(); ++i) count += squares_of(i, values) > most_squares_;
    return count / static_cast<double>(problems_.costs.size());
  }

  /// Pairs of two of them on a coarse grid, all else as it is.
  void look_coarsely(std::vector<double>& values) const {
    constexpr int kPoints = 24;
    if (all_.size() < 2) return;
    const auto at = [&](const Sought& u, int k) {
      const double share = (k + 0.5) / kPoints;
      return u.where.by_ratio ? u.where.lower * std::pow(u.where.upper / u.where.lower, share)
                              : u.where.lower + share * (u.where.upper - u.where.lower);
    };
    std::vector<double> best = values;
    double least = squares(values);
    for (int i = 0; i < kPoints; ++i)
      for (int k = 0; k < kPoints; ++k) {
        values[all_[0].index] = at(all_[0], i);
        values[all_[1].index] = at(all_[1], k);
        if (const double s = squares(values, least); s < least) {
          least = s;
          best = values;
        }
      }
    values = best;
  }

  /// Each to the middle of the range that leaves least. True if that leaves less than before.
  bool look(std::vector<double>& values) {
    bool better = false;
    for (const Sought& u : all_) better = look_through(u, values) || better;
    return better;
  }

 private:
  struct Sought {
    std::size_t index;
    Jumps where;
  };

  /// Of one window; infinite where it does not run.
  double squares_of(std::size_t i, const std::vector<double>& values) const {
    residual_.resize(static_cast<std::size_t>(problems_.costs[i].num_residuals()));
    const double* blocks[2] = {values.data(), &problems_.starts[kStartSize * i]};
    // Without unknowns the start is the only block.
    if (!problems_.costs[i].Evaluate(values.empty() ? blocks + 1 : blocks, residual_.data(), nullptr))
      return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (double r : residual_) sum += r * r;
    return sum;
  }

  /// A step up, or down with `way` -1.
  static double further(const Jumps& where, double v, int way) {
    constexpr double kStep_s = 5e-4, kRatio = 1.04;
    return where.by_ratio ? v * std::pow(kRatio, way) : v + kStep_s * way;
  }

  /// From where to where about `from` no more squares than `most` are left.
  std::pair<double, double> range_about(const Sought& u, std::vector<double> values, double from,
                                        double most) const {
    constexpr int kHalvings = 8;
    const auto as_good = [&](double v) {
      values[u.index] = v;
      return squares(values, most) <= most;
    };
    const auto end = [&](int way) {
      double inside = from;
      for (;;) {
        const double outside = std::clamp(further(u.where, inside, way), u.where.lower, u.where.upper);
        if (as_good(outside)) {
          if (outside == inside) return inside;
          inside = outside;
          continue;
        }
        double beyond = outside;
        for (int i = 0; i < kHalvings; ++i) {
          const double middle = 0.5 * (inside + beyond);
          (as_good(middle) ? inside : beyond) = middle;
        }
        return inside;
      }
    };
    return {end(-1), end(1)};
  }

  bool look_through(const Sought& u, std::vector<double>& values) {
    constexpr double kSame = 1e-6;
    const Jumps& where = u.where;
    double best = values[u.index], least = squares(values);
    const double before = least;
    const auto next = [&](double v) { return further(where, v, 1); };
    for (double v = where.lower; v <= where.upper; v = next(v)) {
      values[u.index] = v;
      if (const double s = squares(values, least); s < least * (1.0 - kSame)) {
        least = s;
        best = v;
      }
    }
    const auto [low, high] = range_about(u, values, best, least * (1.0 + kSame));
    // What changes the runs between the jumps too has a best value, which the fit's steps find.
    const bool flat = high - low > 0.01 * (next(best) - best);
    ranges_[u.index] = flat ? std::pair(low, high) : std::pair(0.0, 0.0);
    values[u.index] = flat ? 0.5 * (low + high) : best;
    return least < before * (1.0 - 1e-3);
  }

  Costs& problems_;
  double most_squares_;
  std::vector<Sought> all_;
  std::vector<std::pair<double, double>> ranges_;
  mutable std::vector<double> residual_;
};

/// Some of the windows, half of them evenly and half those that add most to what is known of the unknowns at these values.
std::vector<Window> telling(const std::vector<WindowShare>& shares, const std::vector<Window>& windows,
                            std::size_t count) {
  const auto n = shares.front().information.rows();
  std::vector<char> taken(windows.size(), 0);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  const auto take = [&](std::size_t i) {
    taken[i] = 1;
    if (shares[i].information.allFinite()) information += shares[i].information;
  };
  for (std::size_t i = 0; i < count / 2; ++i) take((2 * i + 1) * windows.size() / (2 * (count / 2)));
  for (std::size_t more = count / 2; more < count; ++more) {
    // What a window adds to the determinant's logarithm, to first order.
    Eigen::MatrixXd known = information;
    for (Eigen::Index i = 0; i < n; ++i) known(i, i) = std::max(known(i, i) * (1.0 + 1e-9), 1e-300);
    const Eigen::VectorXd scale = known.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse = scale.asDiagonal() *
                                    linear::pseudo_inverse(scale.asDiagonal() * known * scale.asDiagonal()) *
                                    scale.asDiagonal();
    std::size_t best = windows.size();
    double most = -1.0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      if (taken[i] || !shares[i].information.allFinite()) continue;
      const double adds = inverse.cwiseProduct(shares[i].information).sum();
      if (adds > most) most = adds, best = i;
    }
    if (best == windows.size()) break;
    take(best);
  }
  std::vector<Window> some;
  for (std::size_t i = 0; i < windows.size(); ++i)
    if (taken[i]) some.push_back(windows[i]);
  return some;
}

/// An input acts from half a row before to half a row after its row, each as likely: no window tells by how much. By as much a drive may be late.
void add_timing_doubt(Fit& fit, const std::vector<Unknown>& unknowns,
                      const std::vector<Recording>& recordings) {
  using dynamics::Effect;
  const double sd_s = 0.5 / std::sqrt(3.0) * row_s(recordings.front());
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const Effect e = unknowns[i].effect;
    if (unknowns[i].of_effect && !fit.at_bound[i] &&
        (e == Effect::actuator_delay || e == Effect::actuator_lag || e == Effect::time_skew))
      fit.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += sd_s * sd_s;
  }
}

}  // namespace

std::optional<std::vector<double>> begin_on_some(const model::Model& model,
                                                 const std::vector<Unknown>& unknowns,
                                                 const std::vector<double>& start,
                                                 const std::vector<Recording>& recordings,
                                                 const std::vector<Window>& windows) {
  constexpr std::size_t kMany = 24'000, kSome = 12'000, kFewestWindows = 24;  // rows
  std::size_t rows = 0;
  for (const Window& w : windows) rows += w.rows();
  if (unknowns.empty() || rows <= kMany || windows.size() < 2 * kFewestWindows ||
      dynamics::has(model.kind, dynamics::LocationType::belt))
    return std::nullopt;
  const std::size_t count = std::max(kFewestWindows, windows.size() * kSome / rows);
  const Fit look = look_by_simulation(model, unknowns, start, recordings, windows, Starting::linear);
  const std::vector<Window> some = telling(look.shares, windows, count);
  Costs problems(model, unknowns, recordings, some, Weighting::noise);
  std::vector<double> values = start;
  if (!solve(problems, unknowns, values, kOnSome)) return std::nullopt;
  return values;
}

Fit fit_by_simulation(const model::Model& model, const std::vector<Unknown>& unknowns,
                      const std::vector<double>& start, const std::vector<Recording>& recordings,
                      const std::vector<Window>& windows, Weighting weighting, std::size_t layers,
                      const Effort& effort) {
  Fit fit;
  // What the solver tells of rejected steps is no news to a user.
  [[maybe_unused]] static const bool quiet = (FLAGS_minloglevel = google::GLOG_FATAL, true);
  fit.values = start;
  Costs problems(model, unknowns, recordings, windows, weighting, effort.whitening);
  Jumping jumping(problems, unknowns, model.kind, effort.most_squares);
  bool usable = true;
  if (dynamics::has(model.kind, dynamics::LocationType::belt) && !unknowns.empty()) {
    // As long as the coil is on no tooth matters: first how the belt falls, then where it is held.
    std::vector<Window> falls = windows;
    for (Window& w : falls) w.last = w.liftoff;
    Costs falling(model, unknowns, recordings, falls, weighting);
    const double before = jumping.squares(fit.values);
    const std::vector<double> given = fit.values;
    usable = solve(falling, unknowns, fit.values, {effort.most_iterations, effort.along_steps});
    if (!usable || (!jumping.any() && !(jumping.squares(fit.values) < before))) fit.values = given;
    jumping.look_coarsely(fit.values);
    jumping.look(fit.values);
  }
  // Windows beyond the bound do not pull: where half of them are, first without it.
  if (std::isfinite(effort.most_squares) && jumping.beyond(fit.values) > 0.5)
    usable = solve(problems, unknowns, fit.values, {effort.most_iterations, effort.along_steps});
  constexpr int kRounds = 3;
  bool again = true;
  for (int round = 0; round < kRounds && again; ++round) {
    usable = solve(problems, unknowns, fit.values, effort);
    again = usable && jumping.look(fit.values);
  }
  fit.at_bound = at_bounds(fit.values, unknowns);
  problems.shares(fit, 6, effort.most_squares);
  jumping.widen(fit, layers);
  fit.ranges = jumping.ranges();
  require_finite(usable && std::isfinite(fit.squares), recordings, windows);
  fit.layers = layers;
  fit.covariance = jackknife_covariance(fit.shares, fit.at_bound, layers);
  add_timing_doubt(fit, unknowns, recordings);
  return fit;
}

}  // namespace furcula::identify
