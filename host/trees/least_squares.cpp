// Least squares of a tree's unknowns, see fit.hpp.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/parallel.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/fit.hpp"

namespace furcula::trees {
namespace {

/// Derivatives are those of a point no further than so much of what matters, in each unknown.
constexpr double kNear = 0.5;
/// No fit goes on for less than so much of the loss.
constexpr double kDone = 1e-4;

/// What is known beforehand is one residual more of its unknown: how far that is from 0, in standard deviations.
double of_priors(const Hypothesis& h, const std::vector<Unknown>& unknowns) {
  double out = 0.0;
  for (const Unknown& u : unknowns)
    if (u.prior_sd > 0.0) out += std::pow(value_of(h, u) / u.prior_sd, 2);
  return out;
}
/// Each fold has its share of it.
void add_priors(const Hypothesis& h, const std::vector<Unknown>& unknowns, Products& p) {
  const auto add = [](Eigen::MatrixXd& to, Eigen::Index column, double value, double weight) {
    to(0, 0) += weight * value * value;
    to(0, column) -= weight * value;
    to(column, 0) -= weight * value;
    to(column, column) += weight;
  };
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const Unknown& u = unknowns[k];
    if (!(u.prior_sd > 0.0)) continue;
    const auto column = static_cast<Eigen::Index>(k + 1);
    const double value = value_of(h, u), weight = 1.0 / (u.prior_sd * u.prior_sd);
    add(p.all, column, value, weight);
    for (Eigen::MatrixXd& fold : p.fold)
      add(fold, column, value, weight / static_cast<double>(p.fold.size()));
  }
}

/// How damped steps are, and what stands beside a normal matrix. Of bodies, of which something is known beforehand, no direction is without
/// information, and a direction that has little must not be lost beside one that has much.
struct Stepping {
  double damping, least, more, ridge, of_largest;
};
constexpr Stepping kUsual{1e-3, 1e-6, 20.0, 1e-10, 1e-9}, kOfBodies{1e-8, 1e-14, 1e3, 1e-13, 1e-13};

/// A step of the unknowns that move, over their scales, and what it gains by the linear problem.
struct Step {
  std::vector<std::size_t> moving;
  Eigen::VectorXd scaled;
  double gain = 0.0;
};
/// Unknowns at a bound that the gradient pushes against stay there.
Step damped_step(const Fit& fit, const Products& p, double damping, double of_largest) {
  Step out;
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    const double value = value_of(fit.at, u), push = p.all(0, static_cast<Eigen::Index>(k + 1));
    if (!((value <= u.lower && push < 0.0) || (value >= u.upper && push > 0.0))) out.moving.push_back(k);
  }
  const auto m = static_cast<Eigen::Index>(out.moving.size());
  const auto scale = [&](Eigen::Index a) {
    return fit.unknowns[out.moving[static_cast<std::size_t>(a)]].scale;
  };
  const auto column = [&](Eigen::Index a) {
    return static_cast<Eigen::Index>(out.moving[static_cast<std::size_t>(a)] + 1);
  };
  Eigen::MatrixXd normal(m, m);
  Eigen::VectorXd right(m);
  for (Eigen::Index a = 0; a < m; ++a) {
    right(a) = scale(a) * p.all(0, column(a));
    for (Eigen::Index b = 0; b < m; ++b) normal(a, b) = scale(a) * scale(b) * p.all(column(a), column(b));
  }
  normal.diagonal() *= 1.0 + damping;
  normal.diagonal().array() += of_largest * std::max(1e-12, normal.diagonal().maxCoeff());
  out.scaled = linear::solve_symmetric(normal, right);
  out.gain = right.dot(out.scaled);
  return out;
}

}  // namespace

Products Problem::products_of(const std::vector<Eigen::VectorXd>& residuals,
                              const std::vector<Eigen::MatrixXd>& columns) const {
  Products out;
  out.window.resize(windows_.size());
  std::vector<Eigen::MatrixXd> of(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    Eigen::MatrixXd c(residuals[i].size(), 1 + columns[i].cols());
    c << residuals[i], columns[i];
    of[i] = product(i, c);
    out.window[i] = of[i].cast<float>();
  });
  const Eigen::Index size = of.front().rows();
  out.all = Eigen::MatrixXd::Zero(size, size);
  out.fold.assign(folds_, Eigen::MatrixXd::Zero(size, size));
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    out.all += of[i];
    out.fold[fold_of(i)] += of[i];
  }
  return out;
}

Products Problem::products(const Hypothesis& h, const std::vector<Unknown>& unknowns,
                           const std::vector<Hypothesis>& probes, const std::vector<Hypothesis>& runs) const {
  const std::vector<Eigen::VectorXd> r = residuals(h);
  Eigen::MatrixXd of_rotors;
  Products out = products_of(r, columns(h, r, unknowns, probes, runs, &of_rotors));
  add_priors(h, unknowns, out);
  out.of_rotors = Eigen::MatrixXd::Zero(of_rotors.rows(), out.all.cols());
  out.of_rotors.rightCols(of_rotors.cols()) = of_rotors;
  return out;
}

void Problem::derive_beside(const Fit& beside, const std::vector<Eigen::VectorXd>& residuals,
                            Fit& out) const {
  const auto same = [&](const Unknown& u, const Unknown& w) {
    if (u.of_cause != w.of_cause || u.of_body != w.of_body || u.of_inputs != w.of_inputs ||
        u.parameter != w.parameter)
      return false;
    if (u.of_inputs) return true;
    if (u.of_body) return u.link == w.link;
    if (!u.of_cause) return u.joint == w.joint;
    const Cause &a = out.at.causes[u.cause], &b = beside.at.causes[w.cause];
    return a.effect == b.effect && a.sites == b.sites;
  };
  std::vector<Unknown> others;
  std::vector<std::size_t> taken;  // of those of `beside`
  std::vector<bool> is_taken;
  for (const Unknown& u : out.unknowns) {
    const auto found = std::find_if(beside.unknowns.begin(), beside.unknowns.end(),
                                    [&](const Unknown& w) { return same(u, w); });
    is_taken.push_back(found != beside.unknowns.end());
    if (is_taken.back()) {
      taken.push_back(static_cast<std::size_t>(found - beside.unknowns.begin()));
      out.derived_at.push_back(beside.derived_at[taken.back()]);
    } else {
      others.push_back(u);
      out.derived_at.push_back(value_of(out.at, u));
    }
  }
  const std::vector<Eigen::MatrixXd> own = columns(out.at, residuals, others, {}, {});
  out.derivatives.resize(windows_.size());
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    Eigen::MatrixXd& d = out.derivatives[i];
    d.resize(residuals[i].size(), static_cast<Eigen::Index>(out.unknowns.size()));
    Eigen::Index next_own = 0;
    std::size_t next_taken = 0;
    for (std::size_t k = 0; k < out.unknowns.size(); ++k)
      d.col(static_cast<Eigen::Index>(k)) =
          is_taken[k] ? beside.derivatives[i].col(static_cast<Eigen::Index>(taken[next_taken++]))
                      : own[i].col(next_own++);
  }
}

Fit Problem::fit(Hypothesis from, int iterations, const Fit* beside) const {
  Fit out;
  out.at = std::move(from);
  if (!inputs_may_be_late(model_, out.at)) out.at.inputs_late_rows = 0.0;
  out.unknowns = unknowns_of(model_, scales_, out.at);
  const auto count = static_cast<Eigen::Index>(out.unknowns.size());
  for (const Unknown& u : out.unknowns)
    set_value(out.at, u, std::clamp(value_of(out.at, u), u.lower, u.upper));
  const bool bodies =
      std::any_of(out.unknowns.begin(), out.unknowns.end(), [](const Unknown& u) { return u.of_body; });
  const Stepping& stepping = bodies ? kOfBodies : kUsual;
  double damping = stepping.damping;
  std::vector<Eigen::VectorXd> left = residuals(out.at);
  const auto derive = [&] {
    out.derivatives = columns(out.at, left, out.unknowns, {}, {});
    out.derived_at.clear();
    for (const Unknown& u : out.unknowns) out.derived_at.push_back(value_of(out.at, u));
  };
  if (beside != nullptr && beside->weighing == weighing_)
    derive_beside(*beside, left, out);
  else
    derive();
  out.weighing = weighing_;
  // The derivatives of a point near by serve as well.
  const auto way = [&] {
    double most = 0.0;
    for (std::size_t k = 0; k < out.unknowns.size(); ++k)
      most = std::max(
          most, std::abs(value_of(out.at, out.unknowns[k]) - out.derived_at[k]) / out.unknowns[k].scale);
    return most;
  };
  const auto products_here = [&] {
    Products here = products_of(left, out.derivatives);
    add_priors(out.at, out.unknowns, here);
    return here;
  };
  Products p = products_here();
  out.loss = p.all(0, 0);
  for (int iteration = 0; iteration < iterations && count > 0 && !spent(); ++iteration) {
    bool better = false;
    double gained = 0.0;
    for (int attempt = 0; attempt < 4 && !better; ++attempt) {
      const Step step = damped_step(out, p, damping, stepping.of_largest);
      // The linear problem's own gain; with damping this is a little too much.
      if (!(step.gain > kDone * out.loss)) break;
      Hypothesis trial = out.at;
      for (std::size_t a = 0; a < step.moving.size(); ++a) {
        const Unknown& u = out.unknowns[step.moving[a]];
        // No step of more than ten times what matters: far out the columns say nothing.
        const double moved = value_of(out.at, u) +
                             u.scale * std::clamp(step.scaled(static_cast<Eigen::Index>(a)), -10.0, 10.0);
        set_value(trial, u, std::clamp(moved, u.lower, u.upper));
      }
      std::vector<Eigen::VectorXd> of_trial = residuals(trial);
      double loss = of_priors(trial, out.unknowns);
      for (std::size_t i = 0; i < windows_.size(); ++i) loss += product(i, of_trial[i])(0, 0);
      if (loss < out.loss) {
        better = true;
        gained = out.loss - loss;
        out.at = trial;
        out.loss = loss;
        left = std::move(of_trial);
        damping = std::max(stepping.least, damping * 0.2);
      } else if (way() > 0.0) {
        derive();
        p = products_here();
      } else {
        damping = std::min(1e6, damping * stepping.more);
      }
    }
    if (!better) break;
    if (way() > kNear) derive();
    p = products_here();
    if (gained < kDone * out.loss) break;
  }
  // A phase is the same a turn further: it is told within half a turn of zero.
  for (std::size_t k = 0; k < out.unknowns.size(); ++k) {
    const Unknown& u = out.unknowns[k];
    if (!u.of_cause || out.at.causes[u.cause].effect != Effect::torque_ripple || u.parameter != 2) continue;
    const double phase = value_of(out.at, u), within = std::remainder(phase, 2.0 * std::numbers::pi);
    set_value(out.at, u, within);
    out.derived_at[k] -= phase - within;
  }
  set_intervals(p, stepping.ridge, out);
  return out;
}

}  // namespace furcula::trees
