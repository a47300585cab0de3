#include "host/trees/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/core/message.hpp"
#include "host/trees/confidences.hpp"
#include "host/trees/findings.hpp"
#include "host/trees/left_over.hpp"
#include "host/trees/next_experiment.hpp"

namespace furcula::trees {
namespace {

/// Held-out windows that are so many times as far off as those that were fitted show something else.
constexpr double kOnlyThere = 4.0;

/// What the extended model leaves.
struct JointsLeft {
  std::vector<std::string> where;       ///< joints at which something is left
  std::vector<std::string> of_another;  ///< those at which that is more than a remainder of something named
  bool any_lost = false;                ///< runs are further off than a joint moves
};
/// Sets d.unexplained_share.
JointsLeft left_of(DiagnosisState& s, const Problem& problem) {
  JointsLeft out;
  double before = 0.0, after = 0.0;
  for (std::size_t j = 0; j < s.model.joints(); ++j) {
    const MissingTorque& m = s.d.missing[j];
    const double unit = m.rms_torque_nm * m.rms_torque_nm;
    const Remainder remainder = remains(m);
    const Shares at = shares_of(m);
    after += m.predictable_after * m.rms_after_nm * m.rms_after_nm / unit;
    before += std::max(at.named + at.left, m.predictable_before * m.rms_before_nm * m.rms_before_nm / unit);
    // Runs that are further off than the joint moves, and far beyond its encoder's noise: whatever the torques say, it is not adequate.
    const bool lost = s.d.extended_error[j].nmse > 1.0 && !problem.scales().still[j] &&
                      s.d.extended_error[j].rmse > 50.0 * s.training.front().angle_noise_rad[j];
    out.any_lost = out.any_lost || lost;
    // Held-out recordings may have what those that were fitted do not.
    const bool only_there = s.d.findings.empty() &&
                            s.d.extended_error[j].rmse > kOnlyThere * s.training_error[j].rmse &&
                            s.d.extended_error[j].rmse > 50.0 * s.training.front().angle_noise_rad[j];
    if (remainder.is_structured(m.rms_torque_nm) || remainder.lasts(m.rms_torque_nm) || lost || only_there ||
        at_times(m))
      out.where.push_back(s.model.robot.joints[j].name);
    if (remainder.is_another(m.rms_torque_nm) || remainder.lasts(m.rms_torque_nm) || at_times(m))
      out.of_another.push_back(s.model.robot.joints[j].name);
  }
  s.d.unexplained_share = before > 0.0 && !s.d.findings.empty() ? std::clamp(after / before, 0.0, 1.0)
                          : out.where.empty() && s.disputed <= kDisputed ? 0.0
                                                                         : 1.0;
  return out;
}

std::string percent(double share) {
  const double p = 100.0 * share;
  return (std::abs(p) >= 10.0 ? std::to_string(static_cast<long>(std::lround(p))) : core::rounded(p, 2)) +
         " %";
}

/// "The model lacks A at B, and has wrong values of C at D."
std::string named_in_words(const std::vector<Finding>& findings) {
  // What the model lacks, and what it has wrong.
  std::vector<std::string> lacks, wrong;
  for (const Finding& f : findings) {
    std::string_view label = info(f.cause.effect).label;
    std::vector<std::string>& list = label.starts_with("the ") ? wrong : lacks;
    constexpr std::string_view kOwn = "the model's ";
    if (label.starts_with(kOwn)) label = label.substr(kOwn.size());
    const bool of_log = info(f.cause.effect).location_type == LocationType::log;
    list.push_back(std::string(label) + (of_log ? " in the log" : " at " + joined(f.at)));
  }
  return "The model " + (lacks.empty() ? "" : "lacks " + joined(lacks)) +
         (lacks.empty() || wrong.empty() ? "" : ", and ") +
         (wrong.empty() ? "" : "has wrong values of " + joined(wrong)) + ".";
}

/// Sets d.verdict and d.summary.
void say_verdict(DiagnosisState& s, const JointsLeft& left) {
  const bool is_left = s.disputed > kDisputed || s.ended_early ||
                       (!left.where.empty() && (s.d.findings.empty() || s.d.unexplained_share > kOfBefore ||
                                                !left.of_another.empty()));
  const bool undecided_ones = std::any_of(s.d.findings.begin(), s.d.findings.end(), undecided);
  if (s.d.findings.empty()) {
    s.d.verdict = is_left ? Verdict::unexplained : Verdict::adequate;
    s.d.summary =
        is_left && left.where.empty() && s.ended_early
            ? "No cause of the catalogue was found before the search was ended."
        : is_left && left.where.empty()
            ? "The model is wrong by more than chance, and the recordings do not agree on a cause of the catalogue."
        : is_left
            ? "The model lacks torque at " + joined(left.where) +
                  ", and no cause of the catalogue accounts for it."
            : "The model is adequate: nothing is missing that the state, the torque or the time would predict.";
  } else {
    s.d.verdict = undecided_ones          ? Verdict::not_identifiable
                  : is_left || s.at_bound ? Verdict::partly_explained
                                          : Verdict::explained;
    s.d.summary = named_in_words(s.d.findings);
    if (undecided_ones) s.d.summary += " The recordings cannot tell all of that from other causes.";
    if (is_left && !left.where.empty() && s.d.unexplained_share > kOfBefore)
      s.d.summary += " " + percent(s.d.unexplained_share) +
                     " of the torque that could be predicted is still missing, at " + joined(left.where) +
                     ".";
    else if (!left.of_another.empty())
      s.d.summary +=
          " Torque is still missing at " + joined(left.of_another) + ", for longer than noise would be.";
    else if (s.ended_early)
      s.d.summary += " The search for more was ended.";
    else if (is_left)
      s.d.summary += " What is left is more than chance, and the recordings do not agree on a cause of it.";
  }
}

/// Sets d.experiments and d.next_experiment.
void propose_experiments(DiagnosisState& s) {
  if (!s.undecided.empty()) {
    s.d.experiments = next_experiments(s.model, s.training, s.d.extended, s.undecided, s.options.window_s);
    if (!s.d.experiments.empty())
      s.d.next_experiment =
          s.d.experiments.front().what +
          ": the predictions of the causes that these recordings cannot tell apart then differ by " +
          core::rounded(1e3 * s.d.experiments.front().apart_rad, 3) + " mrad at least, RMS over " +
          core::shortest(s.options.window_s) + " s.";
    if (const std::string other = other_way_of_moving(s.model, s.training); !other.empty())
      s.d.next_experiment += (s.d.next_experiment.empty() ? "" : " ") + other;
  }
  if (s.d.next_experiment.empty() && !s.d.findings.empty())
    s.d.next_experiment = s.d.findings.front().next_experiment;
}

}  // namespace

void set_verdict(DiagnosisState& s, const Problem& problem) {
  const JointsLeft left = left_of(s, problem);
  lower_confidences(s, left.any_lost);
  say_verdict(s, left);
  propose_experiments(s);
}

}  // namespace furcula::trees
