#include "host/loop/whole_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/core/message.hpp"
#include "host/walk/ensemble.hpp"
#include "host/walk/roll_pitch_yaw.hpp"

namespace furcula::loop {
namespace {

using biped::kJoints;
using floating::Machine;

constexpr double kRow_s = 0.01;  // 100 Hz, as document 000 records
constexpr std::size_t kNumbers = BesideSimulation::kNumbers;
constexpr double kMoved_rad = 1e-3;  // a target that has left its place
constexpr double kLongestStart_s = 0.5;

using Numbers = std::array<double, kNumbers>;

Numbers numbers_of(const floating::Row& row) {
  Numbers out{};
  for (std::size_t i = 0; i < kJoints; ++i) out[i] = row.angle_rad[i], out[kJoints + i] = row.target_rad[i];
  const walk::RollPitchYaw turn = walk::roll_pitch_yaw(row.attitude);
  out[2 * kJoints] = turn.roll_rad, out[2 * kJoints + 1] = turn.pitch_rad,
          out[2 * kJoints + 2] = turn.yaw_rad;
  return out;
}
Numbers numbers_of(const walk::TraceRow& row) {
  Numbers out{};
  for (std::size_t i = 0; i < kJoints; ++i) out[i] = row.angle_rad[i], out[kJoints + i] = row.target_rad[i];
  std::copy(row.turn_rad.begin(), row.turn_rad.end(), out.begin() + 2 * kJoints);
  return out;
}

/// The last row before the first in which a target has left its place; the first one where none does.
template <class Row>
std::size_t beginning(const std::vector<Row>& rows) {
  const auto moves = [&](const Row& row) {
    for (std::size_t i = 0; i < kJoints; ++i)
      if (std::abs(row.target_rad[i] - rows.front().target_rad[i]) > kMoved_rad) return true;
    return false;
  };
  const auto first = std::find_if(rows.begin(), rows.end(), moves);
  return first == rows.begin() || first == rows.end() ? 0
                                                      : static_cast<std::size_t>(first - rows.begin()) - 1;
}

/// Difference of angles, within a half turn.
double apart(double a, double b) { return std::remainder(a - b, 2.0 * std::numbers::pi); }

/// Calls `see` with the time of each row, what was measured, and what was simulated then.
template <class See>
void each_row(const floating::Recording& recording, const walk::Trace& trace, const See& see) {
  const std::size_t from = beginning(recording.rows), begin = beginning(trace.rows);
  const double measured_yaw = numbers_of(recording.rows[from]).back(),
               yaw = numbers_of(trace.rows[begin]).back();
  for (std::size_t k = from; k < recording.rows.size(); ++k) {
    const double time_s = recording.rows[k].time_s - recording.rows[from].time_s, at = time_s / kRow_s;
    const std::size_t before = std::min(begin + static_cast<std::size_t>(at), trace.rows.size() - 1);
    const std::size_t after = std::min(before + 1, trace.rows.size() - 1);
    const double share = at - std::floor(at);
    Numbers measured = numbers_of(recording.rows[k]);
    const Numbers a = numbers_of(trace.rows[before]), b = numbers_of(trace.rows[after]);
    measured.back() -= measured_yaw - yaw;
    Numbers simulated{};
    for (std::size_t i = 0; i < kNumbers; ++i) simulated[i] = a[i] + share * apart(b[i], a[i]);
    see(time_s, measured, simulated);
  }
}

/// Sum of squares over the rows of a recording, and their number.
struct Squares {
  double sum = 0.0;
  std::size_t rows = 0;
};
Squares squares_of(const floating::Recording& recording, const walk::Trace& trace) {
  Squares out;
  each_row(recording, trace, [&](double, const Numbers& measured, const Numbers& simulated) {
    ++out.rows;
    for (std::size_t i = 0; i < kNumbers; ++i) {
      const double off = apart(measured[i], simulated[i]);
      out.sum += off * off;
    }
  });
  return out;
}

/// Of each machine on a run.
std::vector<walk::Trace> traces_of(const walk::Model& model, const std::vector<Machine>& machines,
                                   const WholeRun& run, unsigned threads) {
  walk::RolloutOptions options = walk::rollout_of(model, run.walk.mode, run.walk.walk_until_s);
  const auto& rows = run.recording->rows;
  // A simulated walk, too, has a while before its first target moves.
  options.time_s =
      std::min(options.time_s, rows.back().time_s - rows[beginning(rows)].time_s + kLongestStart_s);
  std::vector<walk::Member> members;
  std::vector<walk::Job> jobs;
  for (const Machine& m : machines) {
    jobs.push_back({run.walk.parameters, members.size()});
    members.push_back(walk::member_of(m));
  }
  options.command_delay_s = std::max(machines.front().delay_s, 0.0);  // which no search changes
  return walk::traces(model.robot, members, options, jobs, kRow_s, threads);
}

/// Of each machine on a run. Counts the steps.
std::vector<Squares> squares_of(const walk::Model& model, const std::vector<Machine>& machines,
                                const WholeRun& run, unsigned threads, std::uint64_t& steps) {
  std::vector<Squares> out;
  for (const walk::Trace& trace : traces_of(model, machines, run, threads)) {
    out.push_back(squares_of(*run.recording, trace));
    steps += trace.rollout.steps;
  }
  return out;
}

/// What a search changes: shares of ranges from the machine as given.
class Space {
 public:
  explicit Space(const Machine& given, const std::vector<WholeRun>& runs) : given_(given) {
    const auto sprung = [](const WholeRun& r) { return r.walk.mode == walk::WalkMode::semi_passive; };
    unknowns_ = biped::unknowns(given.robot, !std::all_of(runs.begin(), runs.end(), sprung),
                                std::any_of(runs.begin(), runs.end(), sprung));
    std::erase_if(unknowns_, [](const biped::Unknown& u) { return !u.of_tables; });
  }
  const std::vector<biped::Unknown>& unknowns() const { return unknowns_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(unknowns_.size()); }
  Eigen::VectorXd at(const Machine& m) const {
    Eigen::VectorXd x(size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      const biped::Unknown& u = unknowns_[static_cast<std::size_t>(i)];
      x[i] = std::clamp((u.value(m) - u.value(given_)) / width(u), -0.5, 0.5);
    }
    return x;
  }
  Machine machine(const Eigen::VectorXd& x) const {
    Machine m = given_;
    for (Eigen::Index i = 0; i < size(); ++i) {
      const biped::Unknown& u = unknowns_[static_cast<std::size_t>(i)];
      u.add(m, std::clamp(x[i], -0.5, 0.5) * width(u));
    }
    biped::make_possible(given_, m);
    return m;
  }
  /// What lies outside of the ranges, squared.
  double outside(const Eigen::VectorXd& x) const {
    return (x.array().abs() - 0.5).max(0.0).matrix().squaredNorm();
  }

 private:
  /// Of a range: a uniform distribution's, twice the root of three of its standard deviations.
  static double width(const biped::Unknown& u) { return 2.0 * std::sqrt(3.0) * u.prior_sd; }

  const Machine& given_;
  std::vector<biped::Unknown> unknowns_;
};

double root_mean(const Squares& s) {
  return std::sqrt(s.sum / static_cast<double>(std::max<std::size_t>(s.rows, 1) * kNumbers));
}

}  // namespace

std::vector<double> whole_run_errors_rad(const walk::Model& model, const Machine& machine,
                                         const std::vector<WholeRun>& runs, unsigned threads) {
  std::uint64_t steps = 0;
  std::vector<double> out;
  for (const WholeRun& run : runs)
    out.push_back(root_mean(squares_of(model, {machine}, run, threads, steps).front()));
  return out;
}

BesideSimulation beside_simulation(const walk::Model& model, const Machine& machine, const WholeRun& run) {
  BesideSimulation out;
  each_row(*run.recording, traces_of(model, {machine}, run, 1).front(),
           [&](double time_s, const Numbers& measured, const Numbers& simulated) {
             out.time_s.push_back(time_s);
             for (std::size_t i = 0; i < kNumbers; ++i) {
               out.measured_rad[i].push_back(measured[i]);
               out.simulated_rad[i].push_back(simulated[i]);
             }
           });
  return out;
}

WholeRunFit fit_whole_runs(const walk::Model& model, const std::vector<WholeRun>& runs,
                           const WholeRunOptions& options) {
  const Space space(model.machine, runs);
  WholeRunFit out;
  out.unknowns = space.unknowns();
  std::uint64_t steps = 0;
  const auto errors = [&](const std::vector<Machine>& machines) {
    std::vector<Squares> sums(machines.size());
    for (const WholeRun& run : runs) {
      const std::vector<Squares> of = squares_of(model, machines, run, options.threads, steps);
      for (std::size_t k = 0; k < of.size(); ++k) sums[k].sum += of[k].sum, sums[k].rows += of[k].rows;
      out.simulations += of.size();
    }
    std::vector<double> all;
    for (const Squares& s : sums) all.push_back(root_mean(s));
    for (double& e : all)
      if (!std::isfinite(e)) e = std::numeric_limits<double>::infinity();
    return all;
  };
  // Points are from the start on.
  const Eigen::VectorXd start = space.at(options.start);
  const Eigen::VectorXd half = Eigen::VectorXd::Constant(space.size(), 0.5);
  const auto method = walk::make_method(options.method, -half - start, half - start, options.seed);
  Eigen::VectorXd best = Eigen::VectorXd::Zero(space.size());
  out.start_rad = out.error_rad = errors({space.machine(start)}).front();
  const double scale_rad = std::isfinite(out.start_rad) && out.start_rad > 0.0 ? out.start_rad : 1.0;
  while (steps < options.steps) {
    if (options.progress)
      options.progress(static_cast<double>(steps) / static_cast<double>(options.steps),
                       "model error " + core::rounded(1e3 * out.error_rad, 3) + " mrad");
    const std::vector<Eigen::VectorXd>& points = method->ask();
    std::vector<Machine> machines;
    for (const Eigen::VectorXd& x : points) machines.push_back(space.machine(start + x));
    std::vector<double> values = errors(machines);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] < out.error_rad) {
        out.error_rad = values[k];
        best = (start + points[k]).cwiseMax(-half).cwiseMin(half) - start;
      }
      // The methods have thresholds for values about 1.
      values[k] = values[k] / scale_rad + space.outside(start + points[k]);
    }
    method->tell(values, best);
  }
  out.machine = space.machine(start + best);
  return out;
}

}  // namespace furcula::loop
