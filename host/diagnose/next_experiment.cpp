#include "host/diagnose/next_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/diagnose/wording.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::diagnose {
namespace {

using control::ProfileShape;
using dynamics::Effect;
using dynamics::Kind;
using identify::Recording;
using sim::Scenario;

/// Evidence that decides: odds of about 400 to 1, so that a little less than predicted still does.
constexpr double kDecides = 12.0;
constexpr double kSimulatedRowsPerSecond = 1000.0;

/// What the rig has done in its recordings.
struct Reach {
  double input = 0.0;  ///< largest, N or N m
  double lowest = 0.0, highest = 0.0;
  double speed = 0.0;
  double rows_per_second = kSimulatedRowsPerSecond;
};

Reach reach_of(const std::vector<Recording>& recordings) {
  Reach reach{0.0, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  double rows = 0.0, seconds = 0.0;
  for (const Recording& r : recordings) {
    for (double u : r.input) reach.input = std::max(reach.input, std::abs(u));
    for (double x : r.position) {
      reach.lowest = std::min(reach.lowest, x);
      reach.highest = std::max(reach.highest, x);
    }
    for (double v : r.velocity_smoothed) reach.speed = std::max(reach.speed, std::abs(v));
    rows += static_cast<double>(r.rows());
    seconds += r.time_s.back() - r.time_s.front();
  }
  if (seconds > 0.0) reach.rows_per_second = rows / seconds;
  return reach;
}

/// Collects scenarios.
class Shelf {
 public:
  explicit Shelf(const model::Model& model) : base_(sim::default_scenario(model)) {
    base_.profile = ProfileShape::zero;
    base_.amplitude = 0.0;
  }
  Scenario start(double position, double velocity, double duration_s) const {
    Scenario s = base_;
    s.start_position = position;
    s.start_velocity = velocity;
    s.duration_s = duration_s;
    return s;
  }
  Scenario driven(Scenario s, ProfileShape profile, double amplitude, double period_s) const {
    s.profile = profile;
    s.amplitude = amplitude;
    s.period_s = period_s;
    return s;
  }
  void add(std::string what, const Scenario& s) { all_.push_back({std::move(what), s}); }
  std::vector<Experiment> take() { return std::move(all_); }

 private:
  Scenario base_;
  std::vector<Experiment> all_;
};

void shelve_hopper(Shelf& shelf, const model::Model& model, const Reach& reach) {
  const double top = identify::touchdown_height_m(model);
  const double torque = reach.input > 0.0 ? reach.input : sim::default_scenario(model).amplitude;
  const double drop = std::clamp(reach.highest, top + 0.02, top + 0.15);
  const auto centimetres = [&](double height) { return number(1e2 * (height - top), 2) + " cm"; };
  for (double rise : {0.02, 0.05, 0.1})
    shelf.add("a drop from " + centimetres(top + rise) + " above touch-down, without torque",
              shelf.start(top + rise, 0.0, 3.0));
  for (double speed : {1.0, 1.5, 2.0})
    shelf.add("a flight pushed up from the touch-down height at " + number(speed) + " m/s, without torque",
              shelf.start(top + 1e-4, speed, 2.0));
  for (double share : {0.5, 1.0})
    for (double period_s : {0.22, 0.27, 0.33, 0.4})
      shelf.add("hopping with a harmonic torque of " + number(share * torque) + " N m and " +
                    number(period_s) + " s, dropped from " + centimetres(drop),
                shelf.driven(shelf.start(drop, 0.0, 4.0), ProfileShape::harmonic, share * torque, period_s));
  shelf.add(
      "hopping with a constant torque of " + number(0.4 * torque) + " N m, dropped from " + centimetres(drop),
      shelf.driven(shelf.start(drop, 0.0, 4.0), ProfileShape::constant, 0.4 * torque, 1.0));
  shelf.add(
      "a long run for drift: 60 s of hopping with a harmonic torque of " + number(torque) + " N m and 0.3 s",
      shelf.driven(shelf.start(drop, 0.0, 60.0), ProfileShape::harmonic, torque, 0.3));
  // On the ground: about where the spring bears the body, by less than what would lift it off.
  const double rest = model.parameter("rest_height_m") - model.parameter("mass_kg") *
                                                             model.parameter("gravity_mps2") /
                                                             model.parameter("stiffness_npm");
  const double room = top - rest;
  const double length = model.parameter("link_length_m");
  const double lever = std::sqrt(std::max(4.0 * length * length - rest * rest, 1e-6));
  for (double share : {0.4, 0.8})
    shelf.add("a slow compression: standing, a harmonic torque of 2 s that moves the body by " +
                  number(1e3 * share * room, 2) + " mm",
              shelf.driven(shelf.start(rest, 0.0, 8.0), ProfileShape::harmonic,
                           std::min(torque, share * room * model.parameter("stiffness_npm") * lever), 2.0));
  shelf.add(
      "a swing without torque: let go on the ground " + number(0.9e3 * room, 2) + " mm below where it stands",
      shelf.start(rest - 0.9 * room, 0.0, 3.0));
}

void shelve_axis(Shelf& shelf, const model::Model& model, Reach reach) {
  const bool rotary = model.kind == Kind::rotary_joint;
  // A rig that has only coasted or swung: as much as makes a second's motion as fast as that.
  if (reach.input == 0.0) reach.input = 2.0 * std::numbers::pi * model.parameters.front() * reach.speed;
  const char* unit = rotary ? " N m" : " N";
  const char* input = rotary ? "torque" : "force";
  for (double share : {0.25, 0.5, 1.0})
    for (double period_s : {0.25, 0.5, 1.0, 2.0, 4.0}) {
      const double amplitude = share * reach.input;
      // Begun at the speed about which a sine of force makes a sine of position.
      const double velocity =
          rotary ? 0.0 : -amplitude * period_s / (2.0 * std::numbers::pi * model.parameters.front());
      shelf.add("a harmonic " + std::string(input) + " of " + number(amplitude) + unit + " and " +
                    number(period_s) + " s",
                shelf.driven(shelf.start(0.0, velocity, std::max(4.0, 3.0 * period_s)),
                             ProfileShape::harmonic, amplitude, period_s));
    }
  if (rotary) {
    for (double share : {0.25, 0.5, 1.0}) {
      const double angle = share * std::max(std::abs(reach.lowest), std::abs(reach.highest));
      shelf.add("a swing without torque, let go at " + number(angle) + " rad", shelf.start(angle, 0.0, 6.0));
    }
  } else {
    for (double share : {0.3, 1.0})
      for (double sign : {1.0, -1.0})
        shelf.add("coasting to rest from " + number(share * sign * reach.speed) + " m/s without force",
                  shelf.start(0.0, share * sign * reach.speed, 2.0));
  }
  shelf.add(
      "a long run for drift: 60 s of a harmonic " + std::string(input) + " of " + number(reach.input) + unit +
          " and 1 s",
      shelf.driven(
          shelf.start(0.0, rotary ? 0.0 : -reach.input / (2.0 * std::numbers::pi * model.parameters.front()),
                      60.0),
          ProfileShape::harmonic, reach.input, 1.0));
}

void shelve_carriage(Shelf& shelf, const Reach& reach) {
  const double highest = std::max(reach.highest, 0.05);
  for (double share : {0.5, 1.0, 2.0})
    shelf.add("a fall from " + number(share * highest) + " m",
              shelf.start(share * highest, 0.0, 0.5 + std::sqrt(share * highest)));
  for (double share : {0.5, 1.0, 1.5}) {
    const double speed = std::sqrt(2.0 * 9.81 * share * highest);
    shelf.add("a flight pushed up from the stop at " + number(speed) + " m/s",
              shelf.start(0.0, speed, 0.5 + speed / 4.0));
  }
}

void shelve_bench(Shelf& shelf, const model::Model& model) {
  const double delay_s = model.parameter("release_delay_s");
  for (double fall_s : {0.02, 0.03, 0.045}) {
    Scenario s = shelf.start(0.0, 0.0, 0.0);
    s.clutch.clear();
    constexpr int kReleases = 5;
    for (int i = 0; i < kReleases; ++i) {
      const double at_s = 0.1 + 0.4 * i;
      s.clutch.push_back({at_s, true});
      s.clutch.push_back({at_s + delay_s + fall_s + 1e-3 * i, false});
    }
    s.duration_s = 0.1 + 0.4 * kReleases;
    shelf.add(
        "five releases one after the other, each with a fall of " + number(1e3 * fall_s) + " ms and more", s);
  }
}

/// Places, inputs and speeds stay near what the rig has done.
bool within_reach(const Recording& r, const Reach& reach, Kind kind) {
  if (is_hopper(kind) || kind == Kind::rail_carriage || kind == Kind::clutch_bench) return true;
  const auto [low, high] = std::minmax_element(r.position.begin(), r.position.end());
  if (kind == Kind::motor_axis && *high - *low > reach.highest - reach.lowest) return false;
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
    if (!within_reach(r, reach_, model_.kind)) return s;
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
      left -= pull.dot(Eigen::VectorXd(part.completeOrthogonalDecomposition().solve(pull)));
    }
    const double stays = total > 0.0 ? std::clamp(left / total, 0.0, 1.0) : 0.0;
    double evidence = 0.0;
    for (std::size_t c = 0; c < identify::kChannels; ++c) {
      if (rows[c] == 0.0 || noise.rows[c] == 0.0 || !(noise.squares[c] > 0.0)) continue;
      const double scatter = noise.squares[c] / noise.rows[c];
      const double rate = c == static_cast<std::size_t>(identify::Channel::contact)
                              ? 1.0
                              : std::min(1.0, reach_.rows_per_second / kSimulatedRowsPerSecond);
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
  Reach reach_;
  double window_s_;
  double report_spread_s_ = 0.0;
  std::vector<Noise> noise_;
  std::vector<Eigen::MatrixXd> information_;
};

}  // namespace

std::vector<Experiment> library(const model::Model& model, const std::vector<Recording>& recordings) {
  Shelf shelf(model);
  const Reach reach = reach_of(recordings);
  switch (model.kind) {
    case Kind::hopper_linear:
    case Kind::hopper_nonlinear:
      shelve_hopper(shelf, model, reach);
      break;
    case Kind::rail_carriage:
      shelve_carriage(shelf, reach);
      break;
    case Kind::clutch_bench:
      shelve_bench(shelf, model);
      break;
    case Kind::motor_axis:
    case Kind::rotary_joint:
      shelve_axis(shelf, model, reach);
      break;
  }
  return shelf.take();
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
