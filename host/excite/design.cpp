// Designed recordings, see design.hpp.
#include "host/excite/design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/parallel.hpp"
#include "host/core/random.hpp"
#include "host/linear/linear.hpp"
#include "host/walk/cma_es.hpp"

namespace furcula::excite {
namespace {

/// A shorter recording has too few windows, and too few harmonics.
constexpr double kShortest_s = 2.0;
constexpr std::size_t kFewestRows = 50;
/// Random series that the search begins with, as a share of all that it may look at.
constexpr double kRandom = 0.2;
constexpr std::size_t kPopulation = 10;
constexpr double kSigma = 0.4;
/// Windows that one evaluation looks at.
constexpr std::size_t kWindows = 12;
/// Of numbers without any motion within the limits.
constexpr double kNone = 1e9;

double value_of(Criterion criterion, const Eigen::MatrixXd& information) {
  Eigen::MatrixXd all = information;
  all.diagonal().array() += 1.0;
  const auto count = static_cast<double>(all.rows());
  if (criterion == Criterion::d) return -linear::log_determinant_of_positive(all) / count;
  return linear::inverse_of_positive(all).trace() / count;
}
void chosen(std::vector<Subject>& all, About about) {
  if (about != About::all)
    std::erase_if(all, [&](const Subject& s) { return s.free != (about == About::free); });
  Eigen::Index columns = 0;
  for (Subject& s : all) {
    s.first = columns;
    columns += s.columns();
  }
}

/// As a standard deviation.
double as_sd(Criterion criterion, double value) {
  return criterion == Criterion::d ? std::exp(0.5 * value) : std::sqrt(value);
}

}  // namespace

Design design(const trees::TreeModel& model, const std::vector<JointLimits>& limits, const Options& o) {
  if (o.duration_s < kShortest_s || o.duration_s * o.rate_hz < static_cast<double>(kFewestRows) ||
      o.duration_s < 4.0 * o.window_s)
    throw core::DataError(
        "a recording of " + core::shortest(o.duration_s) + " s is too short to tell anything; expected " +
        core::shortest(
            std::max({kShortest_s, 4.0 * o.window_s, static_cast<double>(kFewestRows) / o.rate_hz})) +
        " s or more");
  const Series series(easiest_posture(model, limits), o.duration_s, o.highest_hz);
  const auto numbers = static_cast<Eigen::Index>(series.size());
  const auto windows = static_cast<std::size_t>(o.duration_s / o.window_s);
  const std::size_t every = std::max<std::size_t>(1, windows / kWindows);
  Design out;
  Eigen::MatrixXd known;
  std::size_t done = 0;
  const auto report = [&](std::string_view doing) {
    if (o.progress)
      o.progress(static_cast<double>(done) / static_cast<double>(o.recordings * o.evaluations), doing);
  };
  for (std::size_t r = 0; r < o.recordings; ++r) {
    const std::string doing = "recording " + std::to_string(r + 1) + " of " + std::to_string(o.recordings);
    const auto scenario_at = [&](const Eigen::VectorXd& x) {
      return series.within(model, limits, {x.data(), static_cast<std::size_t>(x.size())}, o.rate_hz);
    };
    core::Random random(o.seed, r);
    const auto many = std::max<std::size_t>(
        kPopulation, static_cast<std::size_t>(kRandom * static_cast<double>(o.evaluations)));
    std::vector<Eigen::VectorXd> points;
    for (std::size_t k = 0; k < many; ++k) {
      Eigen::VectorXd x(numbers);
      for (Eigen::Index i = 0; i < numbers; ++i) x(i) = 0.6 * random.gaussian();
      points.push_back(std::move(x));
    }
    if (r == 0) {
      // Sizes are those on the first random motion.
      std::optional<trees::Scenario> first;
      for (std::size_t k = 0; k < points.size() && !first; ++k) first = scenario_at(points[k]);
      if (!first)
        throw core::DataError(
            "no motion was found within the limits of position, velocity and torque; expected wider ones");
      const std::vector<trees::Recording> reference{
          trees::recording_of(model, trees::simulate(model, *first, o.seed))};
      const trees::Problem problem(model, reference, trees::windows_of(model, reference, o.window_s), 1);
      out.subjects = subjects(problem);
      chosen(out.subjects, o.about);
      const Eigen::Index columns = out.subjects.back().first + out.subjects.back().columns();
      known = Eigen::MatrixXd::Zero(columns, columns);
    }
    Eigen::VectorXd best;
    double least = std::numeric_limits<double>::infinity();
    const auto evaluate = [&](const std::vector<Eigen::VectorXd>& all) {
      std::vector<double> values(all.size(), kNone);
      core::parallel_for(all.size(), o.threads, [&](std::size_t i) {
        if (const auto s = scenario_at(all[i]))
          values[i] = value_of(
              o.criterion, known + static_cast<double>(every) *
                                       information(model, out.subjects, *s, o.seed + r, o.window_s, every));
      });
      for (std::size_t i = 0; i < all.size(); ++i)
        if (values[i] < least) least = values[i], best = all[i];
      done += all.size();
      report(doing);
      return values;
    };
    std::vector<double> values;
    for (std::size_t k = 0; k < points.size(); k += kPopulation) {
      const std::vector<Eigen::VectorXd> some(
          points.begin() + static_cast<std::ptrdiff_t>(k),
          points.begin() + static_cast<std::ptrdiff_t>(std::min(k + kPopulation, points.size())));
      for (const double v : evaluate(some)) values.push_back(v);
    }
    if (r == 0) {
      std::vector<double> found;
      for (const double v : values)
        if (v < kNone) found.push_back(v);
      std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2),
                       found.end());
      if (!found.empty()) out.of_random = as_sd(o.criterion, found[found.size() / 2]);
    }
    if (best.size() == 0)
      throw core::DataError(
          "no motion was found within the limits of position, velocity and torque; expected wider ones");
    walk::CmaEs search(best, kSigma, kPopulation, o.seed * 1000 + r);
    for (std::size_t used = points.size(); used + kPopulation <= o.evaluations; used += kPopulation)
      search.tell(evaluate(search.ask()));
    out.scenarios.push_back(*scenario_at(best));
    if (r == 0) out.of_design = as_sd(o.criterion, least);
    known += information(model, out.subjects, out.scenarios.back(), o.seed + r, o.window_s, 1);
  }
  return out;
}

}  // namespace furcula::excite
