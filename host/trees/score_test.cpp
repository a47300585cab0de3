// The linear test, see score_test.hpp.
#include "host/trees/score_test.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/trees/linear.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;
using Columns = ScoreTest::Columns;

/// A candidate must be so many times its own scatter from window to window, squared: by its number of columns. Some
/// hundred are tried, and the windows of a log are not quite independent.
constexpr double kSure[] = {0.0, 16.0, 21.0, 25.0, 28.0};
/// Of the residuals, so much is not chance.
constexpr double kMuch = 0.2;
/// Of the gain on all recordings, so much must be there on those that the fit has not seen; no more than this share of them may lose.
constexpr double kKept = 0.4, kMostWorse = 0.4;
/// What a candidate that every recording gains by must gain, of the residuals, and keep.
constexpr double kNotable = 0.05, kKeptWhole = 0.8;

/// What every recording gains by and keeps is no chance, if it is so much of the residuals and the first cause: the recordings may then
/// agree less on its size. Beside other causes, what is left of those may do as much.
constexpr double kNoChance = 0.15, kAgreeLittle = 0.2;

/// Of what is told of a candidate's size: where one recording has more, the others cannot contradict it (steadiness).
constexpr double kAlone = 0.75;

/// How far off its one size a candidate's coefficient may be.
constexpr double kOffSize = 0.5;

Eigen::MatrixXd part(const Eigen::MatrixXd& m, const Columns& rows, const Columns& columns) {
  Eigen::MatrixXd out(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t b = 0; b < columns.size(); ++b)
      out(static_cast<Index>(a), static_cast<Index>(b)) = m(rows[a], columns[b]);
  return out;
}

/// Coefficients of `columns` for the target column `of`.
Eigen::VectorXd solve(const Eigen::MatrixXd& m, const Columns& columns, Index of = 0) {
  return ScaledNormal(part(m, columns, columns), kRidge).solve(part(m, columns, {of}));
}

/// Everything less what `base` explains.
Eigen::MatrixXd not_explained_by(const Eigen::MatrixXd& m, const Columns& base) {
  if (base.empty()) return m;
  Columns all;
  for (Index k = 0; k < m.cols(); ++k) all.push_back(k);
  const Eigen::MatrixXd cross = part(m, base, all);
  return m - cross.transpose() * ScaledNormal(part(m, base, base), kRidge).solve(cross);
}

double loss_with(const Eigen::MatrixXd& m, const Columns& columns, const Eigen::VectorXd& x) {
  if (columns.empty()) return m(0, 0);
  const Eigen::VectorXd right = part(m, columns, {0});
  return m(0, 0) - 2.0 * x.dot(right) + x.dot(Eigen::VectorXd(part(m, columns, columns) * x));
}

}  // namespace

/// How well the recordings must agree on a cause (steadiness) by the number of its parameters: each is another way to suit a few of them.
/// Quarters of a single recording say less than recordings do.
double agreement(std::size_t parameters, const Problem& problem) {
  return (problem.recordings().size() > 1 ? 1.0 : 2.0) *
         (1.0 + 0.5 * (static_cast<double>(parameters) - 1.0));
}

ScoreTest::ScoreTest(const Problem& problem, const Hypothesis& h, const std::vector<Unknown>& unknowns,
                     std::vector<Candidate> candidates, const std::vector<Hypothesis>& added)
    : problem_(problem),
      candidates_(std::move(candidates)),
      first_(h.causes.size() == problem.model().causes.size()) {
  std::vector<Hypothesis> probes;
  for (const Candidate& c : candidates_) {
    column_.push_back(static_cast<Index>(1 + unknowns.size() + probes.size()));
    for (std::size_t k = 0; k < c.columns.size(); ++k) probes.push_back(with_column(h, c, k));
  }
  added_ = static_cast<Index>(1 + unknowns.size() + probes.size());
  products_ = problem.products(h, unknowns, probes, added);
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const auto column = static_cast<Index>(1 + k);
    // When inputs act is no longer free at the end of its range.
    const Unknown& u = unknowns[k];
    const double value = value_of(h, u), push = products_.all(0, column);
    if (u.of_inputs && ((value <= u.lower && push < 0.0) || (value >= u.upper && push > 0.0))) continue;
    fitted_.push_back(column);
  }
}

ScoreTest ScoreTest::seen_from(std::size_t added) const {
  ScoreTest out = *this;
  const Index k = added_ + static_cast<Index>(added);
  const auto turn = [k](auto& m) {
    // The residual there is that here less the simulation's change.
    m.row(0) -= m.row(k).eval();
    m.col(0) -= m.col(k).eval();
  };
  turn(out.products_.all);
  for (auto& m : out.products_.fold) turn(m);
  for (auto& m : out.products_.window) turn(m);
  return out;
}

ScoreTest::Columns ScoreTest::columns_of(std::size_t candidate) const {
  Columns out;
  for (std::size_t k = 0; k < candidates_[candidate].columns.size(); ++k)
    out.push_back(column_[candidate] + static_cast<Index>(k));
  return out;
}
double ScoreTest::loss_of(const Columns& base) const {
  return loss_with(products_.all, base, base.empty() ? Eigen::VectorXd() : solve(products_.all, base));
}

std::vector<ScoreTest::Score> ScoreTest::gains(const Columns& base) const {
  const Eigen::MatrixXd& m = products_.all;
  const double before = loss_of(base);
  const Eigen::MatrixXd left = not_explained_by(m, base);
  std::vector<Score> out;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (candidates_[c].fitted_gain > 0.0) {
      const double gain = candidates_[c].fitted_gain * before;
      out.push_back({c, gain, gain, Eigen::VectorXd::Ones(1)});
      continue;
    }
    // A column that hardly sticks out of what is fitted already says nothing.
    Columns columns;
    std::vector<Index> kept;
    const Columns own = columns_of(c);
    for (std::size_t k = 0; k < own.size(); ++k) {
      if (!(left(own[k], own[k]) > 1e-4 * m(own[k], own[k]) && m(own[k], own[k]) > 1e-6 * before)) continue;
      columns.push_back(own[k]);
      kept.push_back(static_cast<Index>(k));
    }
    if (columns.empty() || (kept.front() != 0 && candidates_[c].only_forward)) continue;
    Eigen::VectorXd of_kept = solve(left, columns);
    if (candidates_[c].of_one_size) {
      if (std::abs(of_kept(0) - 1.0) > kOffSize) continue;
      of_kept.setOnes();
      const double gain = 2.0 * left(0, columns[0]) - left(columns[0], columns[0]) +
                          products_.of_rotors.col(columns[0]).sum();
      if (gain > kNotable * before) out.push_back({c, gain, gain, of_kept});
      continue;
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Index>(own.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) x(kept[k]) = of_kept(static_cast<Index>(k));
    if (candidates_[c].only_forward && x.minCoeff() < 0.0 && (x.size() == 1 || x(0) < 0.0)) continue;
    const double gain = of_kept.dot(Eigen::VectorXd(part(left, columns, {0})));
    if (gain > kWorth * before) out.push_back({c, gain, gain, x});
  }
  std::sort(out.begin(), out.end(), [](const Score& a, const Score& b) {
    return a.gain != b.gain ? a.gain > b.gain : a.candidate < b.candidate;
  });
  return out;
}

std::vector<ScoreTest::Score> ScoreTest::scores(const Columns& base, std::size_t most, double* alike) const {
  const Eigen::MatrixXd& m = products_.all;
  const double before = loss_of(base);
  std::vector<Score> kept;
  for (Score& s : gains(base)) {
    if (kept.size() == most) break;
    if (candidates_[s.candidate].of_one_size) {
      // A ringing is in few windows, and there it is much; that its size comes out as it must says more.
      if (candidates_[s.candidate].fitted_gain == 0.0 &&
          worse_of_one_size(columns_of(s.candidate).front()) > kMostWorse)
        continue;
      s.worth = s.gain;
      kept.push_back(std::move(s));
      continue;
    }
    const double sure = sureness(base, s);
    const OnFolds f = on_folds(base, s);
    // What is there in a few windows only is much there: the scatter then says little. What each recording predicts of the others is
    // worth some scatter, too; the fit decides.
    const std::size_t of_many = candidates_[s.candidate].of_many;
    const bool everywhere = s.gain > kNotable * before && f.kept > kKeptWhole && f.worse == 0.0;
    const bool much = s.gain > kMuch * m(0, 0);
    const double limit = kSure[std::min<std::size_t>(static_cast<std::size_t>(s.coefficients.size()), 4)] +
                         2.0 * std::log(static_cast<double>(of_many));
    // Of many, one is there by chance.
    const double share = everywhere && much && of_many == 1     ? 0.15
                         : everywhere && much                   ? 0.5
                         : (everywhere || much) && of_many == 1 ? 0.3
                                                                : 1.0;
    const bool no_chance = first_ && everywhere && s.gain > kNoChance * before && of_many == 1;
    if (sure < share * limit) continue;
    if (sure > limit && alike != nullptr) *alike = std::max(*alike, s.gain / before);
    if (!(f.kept > kKept && f.worse <= kMostWorse)) continue;
    // Where windows and recordings both are sure of it, its size may be known badly: what else is free beside it may go with it.
    if (!(f.steady >
          (no_chance                    ? kAgreeLittle
           : everywhere && sure > limit ? 0.35
           : everywhere                 ? 0.7
                                        : 1.0) *
              agreement(static_cast<std::size_t>((s.coefficients.array() != 0.0).count()), problem_)))
      continue;
    s.worth = s.gain - s.gain / std::max(sure, 1.0) * static_cast<double>(s.coefficients.size()) * 4.0;
    kept.push_back(std::move(s));
  }
  std::stable_sort(kept.begin(), kept.end(),
                   [](const Score& a, const Score& b) { return a.worth > b.worth; });
  return kept;
}

std::vector<ScoreTest::Score> ScoreTest::in_place_of(std::size_t added, const Columns& base,
                                                     double least) const {
  const Index without = added_ + static_cast<Index>(added);
  const Eigen::MatrixXd left = not_explained_by(products_.all, base);
  std::vector<Score> out;
  if (!(left(without, without) > 0.0)) return out;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const Columns columns = columns_of(c);
    // What it is without the cause goes the other way.
    const Eigen::VectorXd x = -solve(left, columns, without);
    if (candidates_[c].only_forward && !(x(0) > 0.0)) continue;
    const double share = -x.dot(Eigen::VectorXd(part(left, columns, {without}))) / left(without, without);
    if (share > least) out.push_back({c, share, share, x});
  }
  std::stable_sort(out.begin(), out.end(), [](const Score& a, const Score& b) { return a.gain > b.gain; });
  return out;
}

/// The candidate's score over its scatter from window to window, squared.
double ScoreTest::sureness(const Columns& base, const Score& s) const {
  const Columns columns = columns_of(s.candidate);
  const Eigen::MatrixXd& m = products_.all;
  Columns both = columns;
  both.insert(both.end(), base.begin(), base.end());
  const Eigen::VectorXd b0 = base.empty() ? Eigen::VectorXd() : solve(m, base);
  Eigen::MatrixXd b(static_cast<Index>(base.size()), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size() && !base.empty(); ++k)
    b.col(static_cast<Index>(k)) = solve(m, base, columns[k]);
  const auto p = static_cast<Index>(columns.size());
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(p);
  for (const Eigen::MatrixXf& w : products_.window) {
    Eigen::VectorXd g(p);
    for (Index k = 0; k < p; ++k) g(k) = static_cast<double>(w(columns[static_cast<std::size_t>(k)], 0));
    if (!base.empty()) {
      Eigen::VectorXd right(static_cast<Index>(base.size()));
      for (std::size_t a = 0; a < base.size(); ++a)
        right(static_cast<Index>(a)) = static_cast<double>(w(base[a], 0));
      Eigen::MatrixXd cross(p, right.size()), inner(right.size(), right.size());
      for (std::size_t a = 0; a < base.size(); ++a) {
        for (Index k = 0; k < p; ++k)
          cross(k, static_cast<Index>(a)) =
              static_cast<double>(w(columns[static_cast<std::size_t>(k)], base[a]));
        for (std::size_t c = 0; c < base.size(); ++c)
          inner(static_cast<Index>(a), static_cast<Index>(c)) = static_cast<double>(w(base[a], base[c]));
      }
      g += -cross * b0 - b.transpose() * right + b.transpose() * (inner * b0);
    }
    scatter += g * g.transpose();
    sum += g;
  }
  const double statistic = sum.dot(Eigen::VectorXd(ScaledNormal(scatter, 1e-6).solve(sum)));
  return statistic;
}

/// What it gains in each fold, fitted without it. Of what one recording alone tells, the others can predict nothing: then quarters of its
/// windows are the folds.
ScoreTest::OnFolds ScoreTest::on_folds(const Columns& base, const Score& s) const {
  std::vector<double> size, information;
  for (const Eigen::MatrixXd& fold : products_.fold) {
    size.push_back(0.0);
    information.push_back(0.0);
    std::vector<double> of_size, of_information;
    if (fold(0, 0) > 0.0) one_size(fold, base, s, of_size, of_information);
    if (!of_size.empty()) size.back() = of_size.front(), information.back() = of_information.front();
  }
  const double all = std::accumulate(information.begin(), information.end(), 0.0);
  const auto most = std::max_element(information.begin(), information.end());
  if (problem_.recordings().size() >= 3 && *most > kAlone * all)
    return on_folds(quarters_of(static_cast<std::size_t>(most - information.begin())), base, s);
  return on_folds(products_.fold, base, s);
}

std::vector<Eigen::MatrixXd> ScoreTest::quarters_of(std::size_t recording) const {
  constexpr std::size_t kQuarters = 4;
  std::vector<std::size_t> windows;
  for (std::size_t w = 0; w < products_.window.size(); ++w)
    if (problem_.fold_of(w) == recording) windows.push_back(w);
  std::vector<Eigen::MatrixXd> out(kQuarters,
                                   Eigen::MatrixXd::Zero(products_.all.rows(), products_.all.cols()));
  for (std::size_t k = 0; k < windows.size(); ++k)
    out[k * kQuarters / windows.size()] += products_.window[windows[k]].cast<double>();
  return out;
}

ScoreTest::OnFolds ScoreTest::on_folds(const std::vector<Eigen::MatrixXd>& parts, const Columns& base,
                                       const Score& s) const {
  Columns with = base;
  for (const Index k : columns_of(s.candidate)) with.push_back(k);
  double gain = 0.0;
  int worse = 0, folds = 0;
  std::vector<double> size, information;
  for (const Eigen::MatrixXd& fold : parts) {
    if (fold(0, 0) <= 0.0) continue;
    one_size(fold, base, s, size, information);
    const Eigen::MatrixXd rest = products_.all - fold;
    const double without_it = loss_with(fold, base, base.empty() ? Eigen::VectorXd() : solve(rest, base));
    const double with_it = loss_with(fold, with, solve(rest, with));
    gain += without_it - with_it;
    // A recording that does not move what the candidate is about neither speaks for it nor against it.
    worse += with_it > 1.01 * without_it ? 1 : 0;
    ++folds;
  }
  return {gain / s.gain, static_cast<double>(worse) / std::max(folds, 1), steadiness(size, information)};
}

/// Share of the folds that lose by a candidate whose size is not free.
double ScoreTest::worse_of_one_size(Index column) const {
  std::vector<double> gain(products_.fold.size());
  for (std::size_t f = 0; f < gain.size(); ++f)
    gain[f] = 2.0 * products_.fold[f](0, column) - products_.fold[f](column, column);
  for (std::size_t i = 0; i < products_.window.size(); ++i)
    gain[problem_.fold_of(i)] += products_.of_rotors(static_cast<Index>(i), column);
  std::size_t worse = 0, folds = 0;
  for (std::size_t f = 0; f < gain.size(); ++f) {
    folds += products_.fold[f](0, 0) > 0.0 ? 1 : 0;
    worse += gain[f] < 0.0 ? 1 : 0;
  }
  return static_cast<double>(worse) / static_cast<double>(std::max<std::size_t>(folds, 1));
}

/// The candidate at its coefficients' proportions as one column: its size in a fold, 1 where it is as in all.
void ScoreTest::one_size(const Eigen::MatrixXd& fold, const Columns& base, const Score& s,
                         std::vector<double>& size, std::vector<double>& information) const {
  const Columns columns = columns_of(s.candidate);
  const auto n = static_cast<Index>(base.size());
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n + 2, n + 2);  // residual, base, the candidate
  Columns rows{0};
  rows.insert(rows.end(), base.begin(), base.end());
  m.topLeftCorner(n + 1, n + 1) = part(fold, rows, rows);
  m.col(n + 1).head(n + 1) = part(fold, rows, columns) * s.coefficients;
  m.row(n + 1) = m.col(n + 1).transpose();
  m(n + 1, n + 1) = s.coefficients.dot(Eigen::VectorXd(part(fold, columns, columns) * s.coefficients));
  Columns all;
  for (Index k = 1; k < n + 2; ++k) all.push_back(k);
  const Eigen::MatrixXd normal = part(m, all, all);
  if (!(normal(n, n) > 0.0)) return;
  const Eigen::MatrixXd inverse = ScaledNormal(normal, kRidge, 1e-12).inverse();
  size.push_back((inverse * part(m, all, {0}))(n, 0));
  information.push_back(1.0 / inverse(n, n));
}

}  // namespace furcula::trees
