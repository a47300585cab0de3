#include "host/floating/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "host/core/parallel.hpp"

namespace furcula::floating {

Marginal scaled(const LinearWindow& w, const Variances& v) {
  Marginal s;
  s.row_sd.resize(w.y.size());
  for (Eigen::Index k = 0; k < w.y.size(); ++k)
    s.row_sd[k] = std::sqrt(v.noise[noise_of(static_cast<std::size_t>(k) % kRowSize)]);
  s.local_sd.resize(w.c.cols());
  for (Eigen::Index k = 0; k < w.c.cols(); ++k)
    s.local_sd[k] = std::sqrt(v.local[group_of(w.locals[static_cast<std::size_t>(k)])]);
  s.c = s.row_sd.cwiseInverse().asDiagonal() * w.c * s.local_sd.asDiagonal();
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(w.c.cols(), w.c.cols());
  m.selfadjointView<Eigen::Lower>().rankUpdate(s.c.transpose());
  s.m.compute(m);
  return s;
}

namespace {

/// One window's own unknowns, by Levenberg and Marquardt's method. Derivatives cost some fifty times what a step along them does, so they are kept as
/// long as steps gain.
class WindowFit {
 public:
  WindowFit(const Recording& recording, const Window& window, const Variances& variances,
            const Machine& machine, const Plant& plant, double step_s, std::span<const Local> starts)
      : recording_(recording),
        window_(window),
        variances_(variances),
        machine_(machine),
        plant_(plant),
        step_s_(step_s) {
    for (std::size_t k = 0; k < kRowSize; ++k) row_sd_[k] = std::sqrt(variances.noise[noise_of(k)]);
    const Eigen::MatrixXd r = residuals_at(starts);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const Eigen::VectorXd residual = r.col(static_cast<Eigen::Index>(i));
      if (const double now = cost_of(starts[i], residual); i == 0 || now < cost_)
        cost_ = now, x_ = starts[i], residual_ = residual;
    }
  }

  const Local& locals() const { return x_; }
  double cost() const { return cost_; }
  const Eigen::VectorXd& residual() const { return residual_; }

  /// Linearises anew until a first step gains little, at most so many times in all.
  void improve(int derivatives) {
    damping_ = kFirstDamping;
    settled_ = false;
    for (int k = 0; k < derivatives && !settled_; ++k) {
      linearise();
      settled_ = !along(linear_, own_, true);
    }
  }

  /// About where it is. Derivatives of a last step that gained little hold after it too.
  std::pair<LinearWindow, Marginal> linear() && {
    if (!settled_) linearise();
    linear_.y = residual_;
    for (Eigen::Index k = 0; k < linear_.c.cols(); ++k) linear_.y += linear_.c.col(k) * x_[of(linear_, k)];
    return {std::move(linear_), std::move(own_)};
  }

  /// Steps along the same derivatives, as long as they gain much. @returns whether the first one did. `here`: they were taken here.
  bool along(const LinearWindow& linear, const Marginal& s, bool here = false) {
    constexpr int kMost = 8;
    const Eigen::MatrixXd normal = s.m.reconstructedMatrix();
    for (int k = 0; k < kMost; ++k) {
      double gain = step(linear, s, normal);
      // Where derivatives were taken the cost falls along the steepest descent, if the step is short enough.
      for (; here && k == 0 && gain == 0.0 && damping_ < kMostDamping; gain = step(linear, s, normal)) {
      }
      if (!(gain > kLittle * cost_)) return k > 0;
    }
    return true;
  }

 private:
  void linearise() {
    linear_ = linearised(recording_, window_, variances_, machine_, plant_, x_, step_s_);
    own_ = scaled(linear_, variances_);
  }

  /// Times the damping of the step before: tried at once, in lanes.
  static constexpr std::array<double, 4> kDampings{0.1, 1.0, 10.0, 100.0};
  static constexpr double kLittle = 1e-3, kFirstDamping = 1e-2, kLeastDamping = 1e-6, kMostDamping = 1e4;

  /// @returns what it gained.
  double step(const LinearWindow& linear, const Marginal& s, const Eigen::MatrixXd& normal) {
    const auto n = s.c.cols();
    Eigen::VectorXd z(n);
    for (Eigen::Index k = 0; k < n; ++k) z[k] = x_[of(linear, k)] / s.local_sd[k];
    const Eigen::VectorXd gradient = s.c.transpose() * residual_.cwiseQuotient(s.row_sd) - z;
    std::array<Local, kDampings.size()> tried;
    tried.fill(x_);
    for (std::size_t i = 0; i < tried.size(); ++i) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + std::max(kLeastDamping, kDampings[i] * damping_);
      const Eigen::VectorXd to = s.local_sd.cwiseProduct(damped.llt().solve(gradient));
      for (Eigen::Index k = 0; k < n; ++k) tried[i][of(linear, k)] += to[k];
    }
    const Eigen::MatrixXd r = residuals_at(tried);
    double least = cost_;
    std::size_t best = kDampings.size() - 1;
    for (std::size_t i = 0; i < tried.size(); ++i) {
      const Eigen::VectorXd residual = r.col(static_cast<Eigen::Index>(i));
      if (const double now = cost_of(tried[i], residual); now < least)
        least = now, x_ = tried[i], residual_ = residual, best = i;
    }
    damping_ = std::max(kLeastDamping, kDampings[best] * damping_);
    const double gain = cost_ - least;
    cost_ = least;
    return gain;
  }

  static Eigen::Index of(const LinearWindow& linear, Eigen::Index k) {
    return static_cast<Eigen::Index>(linear.locals[static_cast<std::size_t>(k)]);
  }

  Eigen::MatrixXd residuals_at(std::span<const Local> locals) const {
    std::vector<Variant> variants;
    for (const Local& x : locals) variants.push_back({&machine_, &plant_, x.data()});
    return residuals(recording_, window_, variants, step_s_);
  }

  double cost_of(const Local& x, const Eigen::VectorXd& residual) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < kLocals; ++k) {
      const double at = x[static_cast<Eigen::Index>(k)], variance = variances_.local[group_of(k)];
      if (variance > 0.0) sum += at * at / variance;
    }
    for (Eigen::Index k = 0; k < residual.size(); ++k) {
      const double at = residual[k] / row_sd_[static_cast<std::size_t>(k) % kRowSize];
      sum += at * at;
    }
    return std::isfinite(sum) ? sum : 1e300;
  }

  const Recording& recording_;
  const Window& window_;
  const Variances& variances_;
  const Machine& machine_;
  const Plant& plant_;
  double step_s_;
  std::array<double, kRowSize> row_sd_{};
  Local x_;
  Eigen::VectorXd residual_;
  double cost_ = 0.0, damping_ = kFirstDamping;
  LinearWindow linear_;
  Marginal own_;
  bool settled_ = false;
};

}  // namespace

std::vector<Variances> estimated(const std::vector<LinearWindow>& windows, const Variances& from,
                                 unsigned threads) {
  constexpr int kIterations = 20;
  struct Known {  // what no variance changes
    std::array<Eigen::MatrixXd, kNoiseGroups> cc;
    std::array<Eigen::VectorXd, kNoiseGroups> cy;
    std::array<double, kNoiseGroups> yy{}, rows{};
  };
  std::vector<Known> known(windows.size());
  core::parallel_for(windows.size(), threads, [&](std::size_t w) {
    const LinearWindow& l = windows[w];
    for (std::size_t g = 0; g < kNoiseGroups; ++g) {
      std::vector<Eigen::Index> of;
      for (Eigen::Index k = 0; k < l.y.size(); ++k)
        if (static_cast<std::size_t>(noise_of(static_cast<std::size_t>(k) % kRowSize)) == g) of.push_back(k);
      const Eigen::MatrixXd c = l.c(of, Eigen::all);
      const Eigen::VectorXd y = l.y(of);
      known[w].cc[g] = c.transpose() * c;
      known[w].cy[g] = c.transpose() * y;
      known[w].yy[g] = y.squaredNorm();
      known[w].rows[g] = static_cast<double>(of.size());
    }
  });
  struct Sums {
    std::array<double, kLocalGroups> local{}, locals{};
    std::array<double, kNoiseGroups> noise{}, rows{};
  };
  std::vector<Variances> each(windows.size(), from);
  std::vector<Sums> sums(windows.size());
  for (int k = 0; k < kIterations; ++k) {
    core::parallel_for(windows.size(), threads, [&](std::size_t w) {
      const LinearWindow& l = windows[w];
      const Known& of = known[w];
      const Variances& v = each[w];
      const auto n = l.c.cols();
      Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(n, n);
      Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
      for (std::size_t g = 0; g < kNoiseGroups; ++g) {
        precision += of.cc[g] / v.noise[g];
        score += of.cy[g] / v.noise[g];
      }
      for (Eigen::Index i = 0; i < n; ++i)
        precision(i, i) += 1.0 / v.local[group_of(l.locals[static_cast<std::size_t>(i)])];
      const Eigen::LLT<Eigen::MatrixXd> solver(precision);
      const Eigen::MatrixXd covariance = solver.solve(Eigen::MatrixXd::Identity(n, n));
      const Eigen::VectorXd x = solver.solve(score);
      Sums& s = sums[w] = {};
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto g = static_cast<std::size_t>(group_of(l.locals[static_cast<std::size_t>(i)]));
        s.local[g] += x[i] * x[i] + covariance(i, i);
        s.locals[g] += 1.0;
      }
      for (std::size_t g = 0; g < kNoiseGroups; ++g) {
        s.noise[g] = of.yy[g] - 2.0 * x.dot(of.cy[g]) + x.dot(of.cc[g] * x) +
                     (covariance.array() * of.cc[g].array()).sum();
        s.rows[g] = of.rows[g];
      }
    });
    Sums all;
    for (const Sums& s : sums) {
      for (std::size_t g = 0; g < kLocalGroups; ++g) all.local[g] += s.local[g], all.locals[g] += s.locals[g];
      for (std::size_t g = 0; g < kNoiseGroups; ++g) all.noise[g] += s.noise[g], all.rows[g] += s.rows[g];
    }
    for (std::size_t g = 0; g < kNoiseGroups; ++g)
      for (Variances& v : each) v.noise[g] = all.noise[g] / all.rows[g];
    for (std::size_t g = 0; g < kLocalGroups; ++g) {
      if (!(all.locals[g] > 0.0)) continue;
      const bool disturbs = g >= kTorque && g <= kMomentUp;
      double inverse = 0.0, having = 0.0;
      for (std::size_t w = 0; w < each.size(); ++w)
        if (sums[w].locals[g] > 0.0) inverse += 1.0 / each[w].local[g], having += 1.0;
      for (std::size_t w = 0; w < each.size(); ++w)
        each[w].local[g] =
            disturbs ? (sums[w].local[g] + kFreedom * having / inverse) / (sums[w].locals[g] + kFreedom)
                     : all.local[g] / all.locals[g];
    }
  }
  return each;
}

std::vector<double> fit_locals(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                               const Variances& v, Point& point, const Settings& settings, int derivatives) {
  constexpr int kEach = 3;  // from each start
  const Plant plant = plant_of(point.machine);
  std::vector<double> out(windows.size());
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    const Recording& recording = recordings[windows[w].recording];
    const std::array<double, 2> flat = flat_foot(recording, windows[w], point.machine, plant);
    std::vector<WindowFit> fits;
    for (const double share : {0.0, 1.0}) {
      Local start = Local::Zero();
      start[1] = share * flat[0], start[2] = share * flat[1];
      fits.emplace_back(recording, windows[w], v, point.machine, plant, settings.step_s,
                        std::span(&start, 1));
      fits.back().improve(std::min(kEach, derivatives));
      if (fits.back().cost() < static_cast<double>(fits.back().residual().size()))
        break;  // noise leaves more
    }
    WindowFit& best = fits.back().cost() < fits.front().cost() ? fits.back() : fits.front();
    best.improve(derivatives - kEach);
    point.locals[w] = best.locals();
    out[w] = best.cost();
  });
  return out;
}

namespace {

/// `move` fits each window from where its own unknowns are, which end where it leaves them. `also`: or from there, where that is likelier.
template <class Move>
void each_window(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                 const Variances& v, Point& point, const Settings& settings, const Move& move,
                 const std::vector<Local>* also = nullptr) {
  const Plant plant = plant_of(point.machine);
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    std::vector<Local> starts{point.locals[w]};
    if (also != nullptr) starts.push_back((*also)[w]);
    WindowFit fit(recordings[windows[w].recording], windows[w], v, point.machine, plant, settings.step_s,
                  starts);
    move(w, fit);
    point.locals[w] = fit.locals();
  });
}

constexpr int kRefitDerivatives = 6;

}  // namespace

std::vector<double> refit_locals(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                                 const Variances& v, Point& point, const Settings& settings) {
  std::vector<double> out(windows.size());
  each_window(recordings, windows, v, point, settings, [&](std::size_t w, WindowFit& fit) {
    fit.improve(kRefitDerivatives);
    out[w] = fit.cost();
  });
  return out;
}

Refitted refit_linear(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                      const Variances& v, const std::vector<Local>& also, Point& point,
                      const Settings& settings) {
  Refitted out{std::vector<LinearWindow>(windows.size()), std::vector<Marginal>(windows.size())};
  each_window(
      recordings, windows, v, point, settings,
      [&](std::size_t w, WindowFit& fit) {
        fit.improve(kRefitDerivatives);
        std::tie(out.linear[w], out.own[w]) = std::move(fit).linear();
      },
      &also);
  return out;
}

std::vector<Moved> fit_locals_along(const std::vector<Recording>& recordings,
                                    const std::vector<Window>& windows,
                                    const std::vector<LinearWindow>& nearby,
                                    const std::vector<Marginal>& marginals, const std::vector<double>& before,
                                    const Variances& v, Point& point, const Settings& settings) {
  constexpr int kDerivatives = 1;
  std::vector<Moved> out(windows.size());
  each_window(recordings, windows, v, point, settings, [&](std::size_t w, WindowFit& fit) {
    fit.along(nearby[w], marginals[w]);
    if (!(fit.cost() < before[w])) fit.improve(kDerivatives);
    out[w] = {fit.residual(), fit.cost()};
  });
  return out;
}

std::vector<Marginal> marginals(const std::vector<LinearWindow>& windows, const Variances& variances,
                                unsigned threads) {
  std::vector<Marginal> out(windows.size());
  core::parallel_for(windows.size(), threads, [&](std::size_t w) {
    Marginal& s = out[w] = scaled(windows[w], variances);
    const Eigen::MatrixXd a = s.row_sd.cwiseInverse().asDiagonal() * windows[w].a;
    // L^-1 C' A, so that what is subtracted is a square.
    s.ca = s.m.matrixL().solve(s.c.transpose() * a);
    s.information = Eigen::MatrixXd::Zero(a.cols(), a.cols());
    s.information.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
    s.information.selfadjointView<Eigen::Lower>().rankUpdate(s.ca.transpose(), -1.0);
  });
  return out;
}

std::vector<Local> locals_at(const std::vector<LinearWindow>& windows, const std::vector<Marginal>& marginals,
                             const Eigen::VectorXd& theta, const std::vector<Local>& from) {
  std::vector<Local> out = from;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const LinearWindow& l = windows[w];
    const Marginal& s = marginals[w];
    const Eigen::VectorXd x =
        s.local_sd.cwiseProduct(s.m.solve(s.c.transpose() * (l.y - l.a * theta).cwiseQuotient(s.row_sd)));
    for (Eigen::Index k = 0; k < x.size(); ++k)
      out[w][static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])] = x[k];
  }
  return out;
}

Evidence evidence(const std::vector<LinearWindow>& windows, const std::vector<Marginal>& marginals,
                  const std::vector<double>& weights) {
  const auto n = windows.front().a.cols();
  Evidence out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const Marginal& s = marginals[w];
    const Eigen::VectorXd y = windows[w].y.cwiseQuotient(s.row_sd),
                          cy = s.m.matrixL().solve(s.c.transpose() * y);
    out.information += weights[w] * s.information;
    out.score += weights[w] * (windows[w].a.transpose() * y.cwiseQuotient(s.row_sd) - s.ca.transpose() * cy);
  }
  out.information = Eigen::MatrixXd(out.information.selfadjointView<Eigen::Lower>());
  return out;
}

}  // namespace furcula::floating
