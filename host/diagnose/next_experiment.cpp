#include "host/diagnose/next_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/wording.hpp"
#include "host/linear/linear.hpp"
#include "host/machines/rules.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using identify::Recording;
using sim::Scenario;

/// Evidence that decides: odds of about 400 to 1, so that a little less than predicted still does.
constexpr double kDecides = 12.0;
constexpr double kSimulatedRowsPerSecond = 1000.0;

machines::Reach reach_of(const std::vector<Recording>& recordings) {
  machines::Reach reach{0.0, std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
  for (const Recording& r : recordings) {
    for (double u : r.input) reach.input = std::max(reach.input, std::abs(u));
    for (double x : r.position) {
      reach.lowest = std::min(reach.lowest, x);
      reach.highest = std::max(reach.highest, x);
    }
    for (double v : r.velocity_smoothed) reach.speed = std::max(reach.speed, std::abs(v));
  }
  return reach;
}

double rows_per_second(const std::vector<Recording>& recordings) {
  double rows = 0.0, seconds = 0.0;
  for (const Recording& r : recordings) {
    rows += static_cast<double>(r.rows());
    seconds += r.time_s.back() - r.time_s.front();
  }
  return seconds > 0.0 ? rows / seconds : kSimulatedRowsPerSecond;
}

/// Places, inputs and speeds stay near what the rig has done.
bool within_reach(const Recording& r, const machines::Reach& reach, const machines::Rules& rules) {
  if (rules.cut != machines::Cut::intervals) return true;
  const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
  if (rules.keeps_travel && *high - *low > reach.highest - reach.lowest) return false;
  constexpr double kFaster = 1.5;
  return std::none_of(r.velocity_smoothed.begin(), r.velocity_smoothed.end(),
                      [&](double v) { return std::abs(v) > kFaster * reach.speed; });
}

/// What the rig would record of an experiment if a candidate were the truth, with the noise that its
/// recordings have; nothing where it cannot be done: the controller refuses it, it leaves the rig's reach, or
/// it holds no window.
struct Simulated {
  std::vector<Recording> recordings;  // one, or none
  identify::TrainingWindows windows;
};

class Planner {
 public:
  Planner(const model::Model& model, const std::vector<const Hypothesis*>& candidates,
          const std::vector<Recording>& recordings, const identify::TrainingWindows& training,
          double window_s)
      : model_(model),
        candidates_(candidates),
        recordings_(recordings),
        reach_(reach_of(recordings)),
        rows_per_second_(rows_per_second(recordings)),
        window_s_(window_s) {
    for (const auto& w : training.windows) report_spread_s_ = std::max(report_spread_s_, w.report_spread_s);
    for (const Hypothesis* h : candidates) {
      Noise noise;
      for (const auto& share : h->fit.shares)
        for (std::size_t c = 0; c < identify::kChannels; ++c) {
          noise.squares[c] += share.channels[c].squares;
          noise.rows[c] += share.channels[c].rows;
          noise.effective[c] += share.channels[c].effective_rows;
        }
      noise_.push_back(noise);
      const auto count = static_cast<Eigen::Index>(h->unknowns.size());
      Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
      for (const auto& share : h->fit.shares) information += share.information;
      information_.push_back(information / static_cast<double>(training.layers));
    }
  }

  void evaluate(Experiment& e) const {
    e.evidence = std::numeric_limits<double>::infinity();
    for (std::size_t truth = 0; truth < candidates_.size(); ++truth) {
      const Simulated s = record(e.scenario, candidates_[truth]->fitted);
      if (s.windows.windows.empty()) {
        e.evidence = 0.0;
        return;
      }
      for (std::size_t other = 0; other < candidates_.size(); ++other)
        if (other != truth) separate(e, s, truth, other);
    }
    e.recordings = e.evidence > 0.0 ? static_cast<int>(std::min(1e6, std::ceil(kDecides / e.evidence))) : 0;
  }

 private:
  struct Noise {
    double squares[identify::kChannels]{}, rows[identify::kChannels]{}, effective[identify::kChannels]{};
  };

  Simulated record(const Scenario& scenario, model::Model truth) const {
    Simulated s;
    truth.effects.erase(Effect::encoder_slip);  // an accident of the recordings that there are
    // In the library's experiments the spring stays caught, and with a clutch the simulated leg knows few effects.
    if (dynamics::has(model_.kind, dynamics::LocationType::heavy_links)) {
      truth.clutch.reset();
      for (const Effect e : {Effect::late_catch, Effect::incomplete_release, Effect::auxiliary_spring})
        truth.effects.erase(e);
    }
    const log::Log log = sim::simulate(truth, scenario, 1);
    if (log.has("fault"))
      for (double fault : log.at("fault"))
        if (fault != 0.0) return s;
    try {
      s.recordings.push_back(identify::make_recording(log, model_.kind));
    } catch (const core::DataError&) {
      return s;
    }
    Recording& r = s.recordings.front();
    if (!within_reach(r, reach_, machines::rules(model_.kind))) return s;
    double noise = 0.0, drive_noise = 0.0, leg_angle_noise = 0.0;
    bool drive = false, leg_angle = false;
    for (const Recording& old : recordings_) {
      noise = std::max(noise, old.position_noise);
      drive_noise = std::max(drive_noise, old.drive_noise);
      leg_angle_noise = std::max(leg_angle_noise, old.leg_angle_noise);
      drive = drive || !old.drive.empty();
      leg_angle = leg_angle || !old.leg_angle.empty();
    }
    r.position_noise = noise;
    r.drive_noise = drive_noise;
    r.leg_angle_noise = leg_angle_noise;
    if (!drive) r.drive.clear();
    if (!leg_angle) r.leg_angle.clear();
    r.slips.clear();
    r.slip_offset.clear();
    if (report_spread_s_ == 0.0) r.touchdown_reports_s.clear();
    s.windows = identify::training_windows(s.recordings, model_, window_s_);
    for (auto& w : s.windows.windows) w.report_spread_s = report_spread_s_;
    return s;
  }

  /// How much better the truth explains its recording than another candidate, whose unknowns move as far as
  /// all recordings together let them (one Gauss-Newton step).
  void separate(Experiment& e, const Simulated& s, std::size_t truth, std::size_t other) const {
    const Hypothesis& h = *candidates_[other];
    const identify::Fit look =
        identify::look_by_simulation(h.fitted, h.unknowns, h.fit.values, s.recordings, s.windows.windows);
    const double layers = static_cast<double>(s.windows.layers);
    const Noise& noise = noise_[truth];
    double squares[identify::kChannels]{}, rows[identify::kChannels]{}, total = 0.0;
    const auto count = static_cast<Eigen::Index>(h.unknowns.size());
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
    Eigen::MatrixXd information = information_[other];
    for (const auto& share : look.shares) {
      for (std::size_t c = 0; c < identify::kChannels; ++c) {
        squares[c] += share.channels[c].squares / layers;
        rows[c] += share.channels[c].rows / layers;
      }
      total += share.squares / layers;
      gradient += share.gradient / layers;
      information += share.information / layers;
    }
    if (!std::isfinite(total)) return;  // as far apart as can be
    std::vector<Eigen::Index> moving;
    for (Eigen::Index i = 0; i < count; ++i)
      if (!h.fit.at_bound[static_cast<std::size_t>(i)]) moving.push_back(i);
    double left = total;
    if (!moving.empty()) {
      const Eigen::MatrixXd part = information(moving, moving);
      const Eigen::VectorXd pull = gradient(moving);
      left -= pull.dot(linear::least_norm(part, pull));
    }
    const double stays = total > 0.0 ? std::clamp(left / total, 0.0, 1.0) : 0.0;
    double evidence = 0.0;
    for (std::size_t c = 0; c < identify::kChannels; ++c) {
      if (rows[c] == 0.0 || noise.rows[c] == 0.0 || !(noise.squares[c] > 0.0)) continue;
      const double scatter = noise.squares[c] / noise.rows[c];
      const double rate = c == static_cast<std::size_t>(identify::Channel::contact)
                              ? 1.0
                              : std::min(1.0, rows_per_second_ / kSimulatedRowsPerSecond);
      const double independent = rows[c] * rate * noise.effective[c] / noise.rows[c];
      evidence += independent * std::log1p(stays * squares[c] / (rows[c] * scatter));
    }
    if (evidence >= e.evidence) return;
    e.evidence = evidence;
    e.apart =
        rows[0] > 0.0 ? std::sqrt(stays * squares[0] / rows[0]) * s.recordings.front().position_noise : 0.0;
  }

  const model::Model& model_;
  const std::vector<const Hypothesis*>& candidates_;
  const std::vector<Recording>& recordings_;
  machines::Reach reach_;
  double rows_per_second_;
  double window_s_;
  double report_spread_s_ = 0.0;
  std::vector<Noise> noise_;
  std::vector<Eigen::MatrixXd> information_;
};

}  // namespace

std::vector<Experiment> library(const model::Model& model, const std::vector<Recording>& recordings) {
  const machines::Rules& rules = machines::rules(model.kind);
  machines::ExperimentLibrary experiment_library(rules.usual_run(model));
  rules.experiments(experiment_library, model, reach_of(recordings));
  std::vector<Experiment> all;
  for (auto& [what, run] : experiment_library.take())
    all.push_back({std::move(what), Scenario(std::move(run))});
  return all;
}

std::vector<const Hypothesis*> to_be_told_apart(const model::Model& model, const Selection& selection) {
  constexpr std::size_t kMostRivals = 4;
  std::vector<const Hypothesis*> all{&selection.chosen};
  for (const auto& rival : selection.equals)
    if (all.size() <= kMostRivals && std::none_of(all.begin(), all.end(), [&](const Hypothesis* h) {
          return h->effects == rival.hypothesis.effects ||
                 always_same(model, h->effects, rival.hypothesis.effects);
        }))
      all.push_back(&rival.hypothesis);
  return all;
}

std::vector<Experiment> experiments_that_tell(const model::Model& model,
                                              const std::vector<const Hypothesis*>& candidates,
                                              const std::vector<Recording>& recordings,
                                              const identify::TrainingWindows& training, double window_s,
                                              unsigned threads) {
  const Planner planner(model, candidates, recordings, training, window_s);
  std::vector<Experiment> all = library(model, recordings);
  core::parallel_for(all.size(), threads, [&](std::size_t i) { planner.evaluate(all[i]); });
  std::erase_if(all, [](const Experiment& e) { return !(e.evidence > 0.0); });
  // Of two that tell as well, the shorter: what counts is the evidence a second.
  std::stable_sort(all.begin(), all.end(), [](const Experiment& a, const Experiment& b) {
    const double x = a.recordings * a.scenario.duration_s, y = b.recordings * b.scenario.duration_s;
    return x != y ? x < y : a.evidence > b.evidence;
  });
  return all;
}

}  // namespace furcula::diagnose
