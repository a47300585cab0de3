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

/// A shorter recording has too few windows.
constexpr double kShortest_s = 2.0;
constexpr std::size_t kFewestRows = 50;
/// Random motions that the search begins with, as a share of all that it may look at.
constexpr double kRandom = 0.2;
constexpr std::size_t kPopulation = 20;
constexpr double kSigma = 0.5;
/// Of a random motion's numbers.
constexpr double kUsual = 0.8;
/// Windows that one evaluation looks at, others in each generation.
constexpr std::size_t kWindows = 8;
/// The best of all that are looked at in full.
constexpr std::size_t kFinal = 6;
/// Of numbers without any motion within the limits.
constexpr double kNone = 1e9;

double value_of(Criterion criterion, const Eigen::MatrixXd& information) {
  Eigen::MatrixXd all = information;
  all.diagonal().array() += 1.0;
  const auto count = static_cast<double>(all.rows());
  if (criterion == Criterion::d) return -linear::log_determinant_of_positive(all) / count;
  return linear::inverse_of_positive(all).trace() / count;
}
std::vector<Subject> chosen(std::vector<Subject> all, About about) {
  if (about != About::all)
    std::erase_if(all, [&](const Subject& s) { return s.free != (about == About::free); });
  Eigen::Index columns = 0;
  for (Subject& s : all) {
    s.first = columns;
    columns += s.columns();
  }
  return all;
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
  const Sines sines(easiest_posture(model, limits), o.duration_s, o.highest_hz);
  const auto numbers = static_cast<Eigen::Index>(sines.size());
  const auto windows = static_cast<std::size_t>(o.duration_s / o.window_s);
  const std::size_t every = std::max<std::size_t>(1, windows / kWindows);
  Design out;
  std::vector<Subject> sought;
  Eigen::MatrixXd known;
  std::size_t done = 0;
  const auto report = [&](std::string_view doing) {
    if (o.progress)
      o.progress(static_cast<double>(done) / static_cast<double>(o.recordings * o.evaluations), doing);
  };
  for (std::size_t r = 0; r < o.recordings; ++r) {
    const std::string doing = "recording " + std::to_string(r + 1) + " of " + std::to_string(o.recordings);
    const auto scenario_at = [&](const Eigen::VectorXd& x) {
      return sines.within(model, limits, {x.data(), static_cast<std::size_t>(x.size())}, o.rate_hz);
    };
    core::Random random(o.seed, r);
    const auto many = std::max<std::size_t>(
        kPopulation, static_cast<std::size_t>(kRandom * static_cast<double>(o.evaluations)));
    std::vector<Eigen::VectorXd> points;
    for (std::size_t k = 0; k < many; ++k) {
      Eigen::VectorXd x(numbers);
      for (Eigen::Index i = 0; i < numbers; ++i) x(i) = kUsual * random.gaussian();
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
      sought = chosen(out.subjects, o.about);
      if (sought.empty())
        throw core::DataError(
            model.file +
            ": no parameter in [free]; expected at least one, or motions for causes (--for causes)");
      const Eigen::Index columns = sought.back().first + sought.back().columns();
      known = Eigen::MatrixXd::Zero(columns, columns);
    }
    struct Tried {
      double value;
      Eigen::VectorXd x;
    };
    std::vector<Tried> best;
    std::size_t generation = 0;
    const auto evaluate = [&](const std::vector<Eigen::VectorXd>& all, std::size_t apart) {
      std::vector<double> values(all.size(), kNone);
      core::parallel_for(all.size(), o.threads, [&](std::size_t i) {
        if (const auto s = scenario_at(all[i]))
          values[i] = value_of(o.criterion, known + information(model, sought, *s, o.seed + r, o.window_s,
                                                                apart, generation % apart));
      });
      ++generation;
      return values;
    };
    const auto look_at = [&](const std::vector<Eigen::VectorXd>& all) {
      std::vector<double> values = evaluate(all, every);
      for (std::size_t i = 0; i < all.size(); ++i)
        if (values[i] < kNone) best.push_back({values[i], all[i]});
      std::stable_sort(best.begin(), best.end(),
                       [](const Tried& a, const Tried& b) { return a.value < b.value; });
      if (best.size() > kFinal) best.resize(kFinal);
      done += all.size();
      report(doing);
      return values;
    };
    std::vector<double> values;
    for (std::size_t k = 0; k < points.size(); k += kPopulation) {
      const std::vector<Eigen::VectorXd> some(
          points.begin() + static_cast<std::ptrdiff_t>(k),
          points.begin() + static_cast<std::ptrdiff_t>(std::min(k + kPopulation, points.size())));
      for (const double v : look_at(some)) values.push_back(v);
    }
    if (r == 0) {
      std::vector<double> found;
      for (const double v : values)
        if (v < kNone) found.push_back(v);
      std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2),
                       found.end());
      if (!found.empty()) out.of_random = as_sd(o.criterion, found[found.size() / 2]);
    }
    if (best.empty())
      throw core::DataError(
          "no motion was found within the limits of position, velocity and torque; expected wider ones");
    walk::CmaEs search(best.front().x, kSigma, kPopulation, o.seed * 1000 + r);
    for (std::size_t used = points.size(); used + kPopulation <= o.evaluations; used += kPopulation)
      search.tell(look_at(search.ask()));
    std::vector<Eigen::VectorXd> last{search.mean()};
    for (Tried& t : best) last.push_back(std::move(t.x));
    values = evaluate(last, 1);
    const auto least = std::min_element(values.begin(), values.end());
    out.scenarios.push_back(*scenario_at(last[static_cast<std::size_t>(least - values.begin())]));
    if (r == 0) out.of_design = as_sd(o.criterion, *least);
    known += information(model, sought, out.scenarios.back(), o.seed + r, o.window_s, 1);
  }
  return out;
}

}  // namespace furcula::excite
