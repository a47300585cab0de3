#include "host/trees/left_over.hpp"

#include <algorithm>
#include <utility>

namespace furcula::trees {
namespace {

/// What is missing at times only: so much of the drive's torque, and so much of its squares in a tenth of the samples (of chance: 0.44).
constexpr double kOfDrive = 0.1, kNearlyAll = 0.9;

/// The samples that both have: which rows are too near to a reversal depends on the model's own motion.
MissingTorque side_by_side(const TorqueSamples& before, const TorqueSamples& after) {
  MissingTorque m;
  const auto place = [](const TorqueSamples& s, std::size_t i) {
    return std::pair(s.recording[i], s.time_s[i]);
  };
  for (std::size_t b = 0, a = 0; b < before.time_s.size() && a < after.time_s.size();) {
    if (place(before, b) < place(after, a)) {
      ++b;
    } else if (place(after, a) < place(before, b)) {
      ++a;
    } else {
      m.recording.push_back(after.recording[a]);
      m.time_s.push_back(after.time_s[a]);
      m.angle_rad.push_back(after.own().angle_rad[a]);
      m.velocity_radps.push_back(after.own().velocity_radps[a]);
      m.before_nm.push_back(before.missing_nm[b++]);
      m.after_nm.push_back(after.missing_nm[a++]);
    }
  }
  return m;
}

}  // namespace

Remainder remains(const MissingTorque& m) {
  return {m.rms_after_nm, m.predictable_after, m.persistent_after_nm};
}

void set_missing_torques(DiagnosisState& s, const Problem& problem) {
  const std::vector<TorqueSamples> before =
      missing_torque(problem, s.training, s.d.refitted, s.options.window_s);
  s.after = missing_torque(problem, s.training, s.d.extended, s.options.window_s);
  const std::vector<TorqueSamples>& after = s.after;
  for (std::size_t j = 0; j < s.model.joints(); ++j) {
    MissingTorque m = side_by_side(before[j], after[j]);
    const Remainder was = remainder_of(before[j], s.training.size()),
                    left = remainder_of(after[j], s.training.size());
    m.rms_before_nm = was.rms_nm;
    m.rms_after_nm = left.rms_nm;
    m.persistent_after_nm = left.persistent_nm;
    m.rms_torque_nm = problem.scales().torque_nm[j];
    m.rms_drive_nm = problem.scales().drive_nm[j];
    m.predictable_before = was.predictable;
    m.predictable_after = left.predictable;
    if (remains(m).is_structured(m.rms_torque_nm))
      m.correlated_with = correlated_with(after[j], j, s.training.size(), s.model);
    s.d.missing.push_back(std::move(m));
  }
}

bool at_times(const MissingTorque& m) {
  if (!(m.rms_after_nm > kOfDrive * m.rms_torque_nm)) return false;
  std::vector<double> squares;
  for (const double x : m.after_nm) squares.push_back(x * x);
  std::sort(squares.rbegin(), squares.rend());
  double all = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < squares.size(); ++k) {
    all += squares[k];
    if (k < squares.size() / 10) largest += squares[k];
  }
  return largest > kNearlyAll * all;
}

Shares shares_of(const MissingTorque& m) {
  const double unit = m.rms_torque_nm * m.rms_torque_nm;
  const auto squares = [](double rms, double share) { return std::max(0.0, share) * rms * rms; };
  const double before = squares(m.rms_before_nm, m.predictable_before),
               after = squares(m.rms_after_nm, m.predictable_after);
  Shares out;
  // Where one recording alone has it, nothing predicts it from the others: then by what is less.
  out.named = std::max({0.0, before - after, squares(m.rms_before_nm, 1.0) - squares(m.rms_after_nm, 1.0)});
  if (remains(m).is_structured(m.rms_torque_nm)) out.left = after;
  if (remains(m).lasts(m.rms_torque_nm))
    out.left = std::max(out.left, m.persistent_after_nm * m.persistent_after_nm);
  return {out.named / unit, out.left / unit};
}

}  // namespace furcula::trees
