// What recordings tell, see check.hpp.
#include "host/excite/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/message.hpp"
#include "host/core/random.hpp"
#include "host/trees/base_parameters.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/reported.hpp"

namespace furcula::excite {
namespace {

using Columns = std::vector<Eigen::Index>;

/// A cause is seen where its size is so many standard deviations: the score test's threshold, 16 as a square.
constexpr double kSeen = 4.0;
/// Causes are called confused from this correlation on, if less than kSeen of the first is left beside the others.
constexpr double kCorrelated = 0.9;
/// So many others at most explain one.
constexpr std::size_t kMostOthers = 3;
/// A share of squares that is none: angles of a URDF are often written with five digits.
constexpr double kNone = 1e-8;
constexpr double k95 = 1.96;

Columns columns_of(const Subject& s) {
  Columns out;
  for (Eigen::Index k = 0; k < s.columns(); ++k) out.push_back(s.first + k);
  return out;
}
void append(Columns& to, const Columns& more) { to.insert(to.end(), more.begin(), more.end()); }

/// What of a column's square the others leave.
double left(const Eigen::MatrixXd& m, Eigen::Index column, const Columns& others) {
  if (others.empty()) return m(column, column);
  const Eigen::VectorXd right = m(others, column);
  return std::max(
      0.0, m(column, column) -
               right.dot(Eigen::VectorXd(trees::ScaledNormal(m(others, others), 1e-10, 1e-12).solve(right))));
}

/// Torques of random motions, in which gravity, rates and accelerations make about as much each: what a subject's bodies, rotors and viscous
/// damping change of them. Columns of what acts otherwise are zero.
Eigen::MatrixXd of_any_motion(const trees::TreeModel& m, const std::vector<Subject>& subjects,
                              Eigen::Index count) {
  constexpr std::size_t kStates = 120;
  const std::size_t n = m.joints();
  const trees::SetupMaker maker(m);
  const auto given = maker.make({m.drives, m.causes});
  core::Random random(1, 1);
  std::vector<model::RobotModel::Joints> q(kStates), v(kStates), a(kStates);
  for (std::size_t k = 0; k < kStates; ++k)
    for (std::size_t j = 0; j < n; ++j) {
      q[k][j] = random.uniform(-3.1, 3.1) * (m.prismatic(j) ? 0.2 : 1.0);
      v[k][j] = random.uniform(-6.0, 6.0) * (m.prismatic(j) ? 0.2 : 1.0);
      a[k][j] = random.uniform(-40.0, 40.0) * (m.prismatic(j) ? 0.2 : 1.0);
    }
  Eigen::MatrixXd torque = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(kStates * n), count);
  for (const Subject& s : subjects)
    for (std::size_t i = 0; i < s.numbers.size(); ++i) {
      const auto& h = s.numbers[i].changed;
      const auto changed = maker.make(h);
      for (std::size_t k = 0; k < kStates; ++k) {
        const auto with = dynamics::tree::inverse_dynamics(changed.model, q[k], v[k], a[k]),
                   without = dynamics::tree::inverse_dynamics(given.model, q[k], v[k], a[k]);
        for (std::size_t j = 0; j < n; ++j)
          torque(static_cast<Eigen::Index>(k * n + j), s.first + static_cast<Eigen::Index>(i)) =
              (with[j] - without[j]) * s.numbers[i].size / s.numbers[i].change;
      }
    }
  return torque.transpose() * torque;
}

/// Whether the engine's columns of a subject are torques of bodies, rotors and damping, and nothing else.
bool by_inverse_dynamics(const Subject& s) {
  if (!s.cause) return !s.name.starts_with("kp_") && !s.name.starts_with("kd_");
  switch (s.cause->effect) {
    case trees::Effect::mass_error:
    case trees::Effect::com_error:
    case trees::Effect::inertia_error:
    case trees::Effect::payload:
    case trees::Effect::base_tilt:
    case trees::Effect::damping_error:
    case trees::Effect::rotor_inertia_error:
      return true;
    default:
      return false;
  }
}

class Checker {
 public:
  Checker(const trees::TreeModel& model, const std::vector<Subject>& subjects, const trees::Problem& problem)
      : subjects_(subjects) {
    const auto [changed, scale] = probes_of(subjects);
    const trees::Products p = problem.products({model.drives, model.causes}, {}, changed);
    const Eigen::Index count = scale.size();
    told_ = scale.asDiagonal() * p.all.bottomRightCorner(count, count) * scale.asDiagonal();
    scatter_ = Eigen::MatrixXd::Zero(count, count);
    for (const Eigen::MatrixXf& w : p.window) {
      const Eigen::VectorXd g =
          scale.cwiseProduct(Eigen::VectorXd(w.row(0).tail(count).transpose().cast<double>()));
      scatter_ += g * g.transpose();
    }
    windows_ = static_cast<double>(p.window.size());
    any_ = of_any_motion(model, subjects, count);
    for (const Subject& s : subjects) {
      if (!s.free) continue;
      append(free_, columns_of(s));
      // What is known of bodies beforehand.
      if (s.columns() > 1)
        for (const Eigen::Index k : columns_of(s)) told_(k, k) += 1.0;
    }
    for (const Subject& s : subjects) {
      std::vector<double>& sd = sd_.emplace_back();
      for (const Eigen::Index k : columns_of(s)) sd.push_back(deviation(s, k));
    }
  }

  /// In sizes, beside the free parameters.
  const std::vector<double>& deviations(std::size_t subject) const { return sd_[subject]; }
  bool seen(std::size_t subject) const {
    return std::any_of(sd_[subject].begin(), sd_[subject].end(), [](double sd) { return kSeen * sd <= 1.0; });
  }
  bool ever(const Subject& s) const {
    if (!by_inverse_dynamics(s)) return true;
    const Columns all = columns_of(s);
    return std::any_of(all.begin(), all.end(), [&](Eigen::Index k) { return any_(k, k) > 1e-20; });
  }

  std::vector<Check::Confused> confused() const {
    std::vector<Check::Confused> out;
    const std::vector<std::size_t> alike = alike_in_any_motion();
    for (std::size_t a = 0; a < alike.size(); ++a) {
      Check::Confused c{{}, 1.0, false};
      for (std::size_t b = a; b < alike.size(); ++b)
        if (alike[b] == a) c.names.push_back(subjects_[b].name);
      if (c.names.size() > 1) out.push_back(std::move(c));
    }
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t a = 0; a < subjects_.size(); ++a) {
      if (!can_be_explained(a)) continue;
      bool found = false;
      for (std::size_t b = 0; b < subjects_.size(); ++b) {
        if (a == b || subjects_[b].columns() > 3 || !seen(b) || alike[a] == alike[b]) continue;
        const auto c = by(a, {b});
        if (!c) continue;
        found = true;
        if (std::find(pairs.begin(), pairs.end(), std::pair(b, a)) != pairs.end()) continue;
        pairs.emplace_back(a, b);
        out.push_back(*c);
      }
      if (!found)
        if (const auto c = by_several(a)) out.push_back(*c);
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const auto& a, const auto& b) { return a.names.size() < b.names.size(); });
    return out;
  }

 private:
  /// Of each subject the first one whose torques are the same in all motions, but for a factor.
  std::vector<std::size_t> alike_in_any_motion() const {
    std::vector<std::size_t> out;
    const double least = 1e-12 * any_.diagonal().maxCoeff();
    for (std::size_t a = 0; a < subjects_.size(); ++a) {
      out.push_back(a);
      for (std::size_t b = 0; b < a && out[a] == a; ++b) {
        if (!by_inverse_dynamics(subjects_[a]) || !by_inverse_dynamics(subjects_[b])) continue;
        const auto explained = [&](std::size_t x, std::size_t y) {
          bool all = subjects_[x].columns() <= 3, any = false;
          for (const Eigen::Index k : columns_of(subjects_[x])) {
            if (any_(k, k) <= least) continue;
            any = true;
            all = all && left(any_, k, columns_of(subjects_[y])) < kNone * any_(k, k);
          }
          return all && any;
        };
        if (explained(a, b) && explained(b, a)) out[a] = out[b];
      }
    }
    return out;
  }

  /// Bodies' ten numbers stand in combinations from the start.
  bool can_be_explained(std::size_t a) const { return subjects_[a].columns() <= 3 && seen(a); }

  double deviation(const Subject& s, Eigen::Index column) const {
    Columns all = free_;
    if (!s.free) append(all, columns_of(s));
    const auto at = std::find(all.begin(), all.end(), column) - all.begin();
    Columns others = all;
    others.erase(others.begin() + at);
    if (!(left(told_, column, others) > 1e-3)) return std::numeric_limits<double>::infinity();
    const Eigen::MatrixXd inverse = trees::ScaledNormal(told_(all, all), 1e-12).inverse(),
                          covariance = inverse * scatter_(all, all) * inverse;
    const double few = windows_ / std::max(1.0, windows_ - static_cast<double>(all.size()));
    return std::sqrt(std::max(covariance(at, at) * few, 0.0));
  }

  /// Free parameters that are none of these.
  Columns beside(std::size_t a, const std::vector<std::size_t>& others) const {
    Columns out;
    for (std::size_t s = 0; s < subjects_.size(); ++s)
      if (subjects_[s].free && s != a && std::find(others.begin(), others.end(), s) == others.end())
        append(out, columns_of(subjects_[s]));
    return out;
  }

  /// The share of a subject's column with the least explained part that the others leave.
  double share_left(const Eigen::MatrixXd& m, std::size_t a, const std::vector<std::size_t>& others) const {
    const Columns base = beside(a, others);
    Columns all = base;
    for (const std::size_t o : others) append(all, columns_of(subjects_[o]));
    double most = 0.0;
    for (const Eigen::Index k : columns_of(subjects_[a])) {
      const double alone = left(m, k, base);
      if (alone > 0.0) most = std::max(most, left(m, k, all) / alone);
    }
    return most;
  }

  std::optional<Check::Confused> by(std::size_t a, const std::vector<std::size_t>& others) const {
    const double share = share_left(told_, a, others), correlation = std::sqrt(std::max(0.0, 1.0 - share));
    const double least = *std::min_element(sd_[a].begin(), sd_[a].end());
    if (correlation < kCorrelated || std::sqrt(share) / least >= kSeen) return std::nullopt;
    Check::Confused out{{subjects_[a].name}, correlation, true};
    bool motion = by_inverse_dynamics(subjects_[a]);
    for (const std::size_t o : others) {
      out.names.push_back(subjects_[o].name);
      motion = motion && by_inverse_dynamics(subjects_[o]);
    }
    out.ever = !(motion && share_left(any_, a, others) < kNone);
    return out;
  }

  std::optional<Check::Confused> by_several(std::size_t a) const {
    std::vector<std::size_t> others;
    while (others.size() < kMostOthers) {
      std::size_t best = a;
      double least = 2.0;
      for (std::size_t b = 0; b < subjects_.size(); ++b) {
        if (b == a || subjects_[b].columns() > 3 || !seen(b) ||
            std::find(others.begin(), others.end(), b) != others.end())
          continue;
        std::vector<std::size_t> with = others;
        with.push_back(b);
        if (const double share = share_left(told_, a, with); share < least) least = share, best = b;
      }
      if (best == a) return std::nullopt;
      others.push_back(best);
      if (others.size() < 2) continue;
      if (auto c = by(a, others)) return c;
    }
    return std::nullopt;
  }

  const std::vector<Subject>& subjects_;
  Eigen::MatrixXd told_, scatter_, any_;
  double windows_ = 0.0;
  Columns free_;
  std::vector<std::vector<double>> sd_;
};

/// Given values at a bound have no interval there: they are moved off it by a little.
trees::Hypothesis off_bounds(const trees::Problem& problem, trees::Hypothesis at) {
  for (const trees::Unknown& u : trees::unknowns_of(problem.model(), problem.scales(), at)) {
    if (u.of_body || u.of_inputs) continue;
    const double apart = std::min(2e-3 * u.scale, 0.25 * (u.upper - u.lower));
    trees::set_value(at, u, std::clamp(trees::value_of(at, u), u.lower + apart, u.upper - apart));
  }
  return at;
}

}  // namespace

Check check(const trees::TreeModel& m, const std::vector<Subject>& subjects,
            const std::vector<trees::Recording>& recordings, double window_s, unsigned threads) {
  trees::Problem problem(m, recordings, trees::windows_of(m, recordings, window_s), threads);
  const trees::Hypothesis given{m.drives, m.causes};
  problem.weigh(given);
  Check out;
  out.windows = problem.windows().size();
  if (!m.free.empty() || !m.free_bodies.empty()) {
    const trees::Fit fit = problem.fit(off_bounds(problem, given), 0);
    const trees::Reported all = trees::reported(m, fit);
    for (std::size_t k = 0; k < all.rows.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const trees::ParameterVerdict told = trees::parameter_verdict(m, all, k, problem.scales().still);
      out.parameters.push_back({all.rows[k].name, all.rows[k].unit, all.rows[k].given,
                                k95 * std::sqrt(all.covariance(i, i)), told.verdict, told.with});
    }
  }
  const Checker checker(m, subjects, problem);
  for (std::size_t s = 0; s < subjects.size(); ++s) {
    if (!subjects[s].cause) continue;
    Check::OfCause c{*subjects[s].cause, subjects[s].name, {}, checker.seen(s), checker.ever(subjects[s])};
    for (std::size_t k = 0; k < subjects[s].numbers.size(); ++k) {
      const Subject::Number& n = subjects[s].numbers[k];
      c.numbers.push_back({n.name, n.unit, n.size, k95 * checker.deviations(s)[k] * n.size});
    }
    out.causes.push_back(std::move(c));
  }
  out.confused = checker.confused();
  // What it takes of samples is not asked for here.
  for (const trees::BaseParameter& b : trees::base_parameters(
           m, given, std::vector<trees::TorqueSamples>(m.joints()), std::vector<double>(m.joints(), 1.0)))
    out.combinations.push_back(b.combination);
  return out;
}

Check check_of(const trees::TreeModel& m, const Design& design, const Options& o) {
  std::vector<trees::Recording> recordings;
  for (std::size_t k = 0; k < design.scenarios.size(); ++k)
    recordings.push_back(trees::recording_of(m, trees::simulate(m, design.scenarios[k], o.seed + k)));
  return check(m, design.subjects, recordings, o.window_s, o.threads);
}

std::string sentence(const Check::Confused& c) {
  std::string others;
  for (std::size_t k = 1; k < c.names.size(); ++k)
    others += (k == 1 ? "" : k + 1 == c.names.size() ? " and " : ", ") + c.names[k];
  if (!c.ever) return "No motion of this robot tells " + c.names[0] + " from " + others + ".";
  const std::string correlation = " (correlation " + core::rounded(c.correlation, 3) + ").";
  return "With these recordings " + c.names[0] +
         (c.names.size() == 2 ? " and " + others + " cannot be told apart"
                              : " cannot be told from " + others + " together") +
         correlation;
}

}  // namespace furcula::excite
