// The diagnosis of a tree, see diagnose.hpp.
#include "host/trees/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/trees/conventions.hpp"
#include "host/trees/diagnosis_state.hpp"
#include "host/trees/disagreement.hpp"
#include "host/trees/findings.hpp"
#include "host/trees/left_over.hpp"
#include "host/trees/parameter_rows.hpp"
#include "host/trees/result.hpp"
#include "host/trees/search.hpp"
#include "host/trees/verdict.hpp"

namespace furcula::trees {
namespace {

constexpr std::size_t kMostSearchWindows = 160;

class Diagnoser {
 public:
  Diagnoser(const TreeModel& model, const std::vector<log::Log>& training,
            const std::vector<log::Log>& held_out, const Options& options)
      : s_{model, options} {
    for (const log::Log& log : training) {
      s_.training.push_back(recording_of(model, log));
      s_.d.training_files.push_back(log.path);
      s_.d.samples += log.rows();
    }
    require_motion(model, s_.training);
    if (!options.trust_columns) require_conventions(model, s_.training, options.window_s);
    for (const log::Log& log : held_out) {
      s_.held_out.push_back(recording_of(model, log));
      s_.d.held_out_files.push_back(log.path);
      s_.d.samples += log.rows();
    }
    share_lateness(s_.training, s_.held_out);
    std::set<std::string> foreign;
    for (const auto* logs : {&training, &held_out})
      for (const log::Log& log : *logs)
        for (const std::string& joint : foreign_joints(model, log)) foreign.insert(joint);
    note_loop_rate();
    if (!foreign.empty())
      s_.d.notes.push_back("The logs have columns of joints that " + model.urdf.file + " does not have: " +
                           joined({foreign.begin(), foreign.end()}) + ". They are not used.");
    for (const auto* recordings : {&s_.training, &s_.held_out})
      for (const Recording& r : *recordings) add_data_quality(s_.d.data_quality, r);
    s_.d.model = model;
    s_.d.logs = training.size() + held_out.size();
    s_.d.held_out_logs = held_out.size();
    s_.d.window_s = options.window_s;
  }

  /// Whether a recording that disagrees with the others may be taken out.
  void may_disagree(bool may) { may_disagree_ = may; }
  /// The training recording that does, found by what run() chose.
  const std::optional<Disagreement>& disagreement() const { return disagreement_; }

  /// Ends early where a recording disagrees with the others.
  Diagnosis run() {
    std::vector<Window> windows = windows_of(s_.model, s_.training, s_.options.window_s, kMostSearchWindows);
    if (windows.empty())
      throw core::DataError("no training log has " + core::shortest(s_.options.window_s) +
                            " s without a gap; expected longer logs, or a smaller --window-s");
    if (windows_of(s_.model, s_.held_out, s_.options.window_s, 1).empty())
      throw core::DataError("no held-out log has " + core::shortest(s_.options.window_s) +
                            " s without a gap; expected longer logs, or a smaller --window-s");
    s_.d.windows = windows.size();
    Problem problem(s_.model, s_.training, std::move(windows), s_.options.threads);
    std::vector<Window> short_windows =
        windows_of(s_.model, s_.training, s_.options.window_s / 3.0, kMostSearchWindows);
    std::optional<Problem> coarse;
    if (!short_windows.empty())
      coarse.emplace(s_.model, s_.training, std::move(short_windows), s_.options.threads);
    const Found found =
        search(problem, coarse ? &*coarse : nullptr, s_.options.progress, s_.options.most_work);
    if (may_disagree_)
      disagreement_ = disagreeing(s_.model, s_.training, found.fit.at, s_.options.window_s,
                                  kMostSearchWindows, s_.options.threads);
    if (disagreement_) return {};
    s_.disputed = found.disputed;
    s_.ended_early = found.ended_early;
    s_.unjudged = found.unjudged;
    if (s_.ended_early)
      s_.d.notes.push_back(
          "The search was ended: after much more work than usual there was still something to add. More may be wrong than is named.");
    s_.d.refitted = found.refitted.at;
    s_.d.extended = found.fit.at;
    note_inputs(found.fit);
    for (const auto& t : found.table) {
      const std::string name = cause_name(s_.model, t.cause);
      const bool again = std::any_of(s_.d.candidates.begin(), s_.d.candidates.end(),
                                     [&](const auto& c) { return label(c.causes) == name; });
      if (again) continue;
      result::Candidate candidate;
      candidate.causes = {named(s_.model, t.cause)};
      candidate.score_test_gain = t.gain;
      candidate.chosen = std::any_of(s_.d.extended.causes.begin(), s_.d.extended.causes.end(),
                                     [&](const Cause& c) { return cause_name(s_.model, c) == name; });
      s_.d.candidates.push_back(std::move(candidate));
    }
    say(0.95, "predicting the held-out logs");
    errors();
    set_missing_torques(s_, problem);
    if (found.common) beside_common(*found.common);
    add_findings(s_, problem, found);
    set_parameters(s_, problem, found);
    set_base_parameters(s_, problem);
    set_verdict(s_, problem);
    motions();
    return std::move(s_.d);
  }

 private:
  /// What it is worth that nobody knows how often a position law is calculated.
  void note_loop_rate() {
    constexpr double kUsual_hz = 1000.0;
    for (std::size_t j = 0; j < s_.model.joints(); ++j) {
      const Drive& drive = s_.model.drives[j];
      if (drive.law != ControlMode::position || drive.loop_rate_hz > 0.0) continue;
      const double half_s = 0.5 / kUsual_hz;
      const bool slides = s_.model.prismatic(j);
      s_.d.notes.push_back(
          "Position laws count as calculated continuously; loop_rate_hz in [drive] says how often they are. " +
          std::string("A rate of 1 kHz acts like ") + core::rounded(drive.kp_nmprad * half_s, 3) +
          (slides ? " N s/m" : " N m s/rad") + " less damping and " +
          core::rounded(drive.kd_nmsprad * half_s, 3) + (slides ? " kg" : " kg m^2") +
          " less rotor inertia at " + s_.model.robot.joints[j].name + ".");
      return;
    }
  }
  /// When inputs act, where that is not with their rows.
  void note_inputs(const Fit& fit) {
    constexpr double kSurely = 1.96;
    for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
      if (!fit.unknowns[k].of_inputs) continue;
      const double rows = fit.at.inputs_late_rows;
      if (!fit.at_bound[k] && std::abs(rows) < kSurely * std::sqrt(variance_of(fit, k))) continue;
      const double time_ms = 1e3 * std::abs(rows) * s_.training.front().interval_s;
      s_.d.notes.push_back(
          "Inputs act " + core::rounded(std::abs(rows), 2) + " rows (" + core::rounded(time_ms, 2) + " ms) " +
          (rows < 0.0 ? "before their rows, as torques do that are measured at the rows' times"
                      : "after their rows, as commands do that wait for the drive's next tick") +
          ". That is allowed for, and no cause.");
    }
  }
  void say(double fraction, std::string_view doing) const {
    if (s_.options.progress) s_.options.progress(fraction, doing);
  }

  void errors() {
    const Hypothesis given{s_.model.drives, s_.model.causes};
    const auto of = [&](const Hypothesis& h, std::vector<double> Trace::*into) {
      return predict(s_.model, s_.held_out, s_.options.window_s, h, &s_.d.traces, into);
    };
    const Predictions as_given = of(given, &Trace::as_given);
    s_.d.as_given_error = as_given.errors;
    s_.d.noise_floor = as_given.floor;
    s_.d.refitted_error = of(s_.d.refitted, &Trace::refitted).errors;
    s_.d.extended_error = of(s_.d.extended, &Trace::extended).errors;
    s_.training_error = predict(s_.model, s_.training, s_.options.window_s, s_.d.extended).errors;
  }

  /// What the common laws alone are worth, beside all that is named.
  void beside_common(const Hypothesis& common) {
    const std::vector<ChannelError> error =
        predict(s_.model, s_.held_out, s_.options.window_s, common).errors;
    std::vector<std::string> names, joints;
    for (std::size_t c = s_.model.causes.size(); c < common.causes.size(); ++c)
      names.push_back(cause_name(s_.model, common.causes[c]));
    for (std::size_t j = 0; j < s_.model.joints(); ++j)
      joints.push_back(s_.model.robot.joints[j].name + " " + core::rounded(error[j].rmse, 3) + " " +
                       std::string(channel_unit(s_.model, j)));
    if (!names.empty())
      s_.d.notes.push_back("Common laws alone, " + joined(names) + ": held-out error, RMS, " +
                           joined(joints) + ". What is named beyond them is worth the difference.");
  }

  /// One held-out recording for the picture: measured, and simulated window by window.
  void motions() {
    for (const Recording& r : s_.held_out) {
      Motion m;
      m.log = r.path;
      const std::size_t step =
          std::max<std::size_t>(1, static_cast<std::size_t>(0.02 / std::max(r.interval_s, 1e-6)));
      m.measured.resize(s_.model.joints());
      m.simulated.resize(s_.model.joints());
      for (std::size_t j = 0; j < s_.model.joints(); ++j)
        for (const Trace& t : s_.d.traces) {
          if (t.log != r.path || t.channel != channel_name(s_.model, j)) continue;
          for (std::size_t k = 0; k < t.time_s.size(); k += step) {
            if (j == 0) m.time_s.push_back(t.time_s[k] - t.time_s.front());
            m.measured[j].push_back(t.measured[k]);
            m.simulated[j].push_back(t.extended[k]);
          }
        }
      s_.d.motions.push_back(std::move(m));
      if (s_.d.motions.size() == 3) break;
    }
  }

  bool may_disagree_ = false;
  std::optional<Disagreement> disagreement_;
  DiagnosisState s_;
};

}  // namespace

std::string channel_name(const TreeModel& model, std::size_t joint) {
  return (model.prismatic(joint) ? "position_" : "angle_") + model.robot.joints[joint].name;
}
std::string_view channel_unit(const TreeModel& model, std::size_t joint) {
  return model.prismatic(joint) ? "m" : "rad";
}

Diagnosis diagnose(const TreeModel& model, const std::vector<log::Log>& training,
                   const std::vector<log::Log>& held_out, const Options& options) {
  // One recording that disagrees is taken out, and the rest diagnosed; of a quarter and more nobody can say which are right.
  constexpr double kMinority = 0.25;
  std::vector<log::Log> agreeing = training;
  std::vector<log::DataQuality::Excluded> excluded;
  for (;;) {
    Diagnoser diagnoser(model, agreeing, held_out, options);
    diagnoser.may_disagree(static_cast<double>(excluded.size() + 1) <
                           kMinority * static_cast<double>(training.size()));
    Diagnosis d = diagnoser.run();
    if (const auto& odd = diagnoser.disagreement()) {
      excluded.push_back({agreeing[odd->recording].path, odd->why});
      agreeing.erase(agreeing.begin() + static_cast<std::ptrdiff_t>(odd->recording));
      continue;
    }
    d.data_quality.excluded = std::move(excluded);
    return d;
  }
}

}  // namespace furcula::trees
