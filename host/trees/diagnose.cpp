// The diagnosis of a tree, see diagnose.hpp.
#include "host/trees/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/quantile.hpp"
#include "host/result/confidence.hpp"
#include "host/trees/base_parameters.hpp"
#include "host/trees/conventions.hpp"
#include "host/trees/disagreement.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/missing_torque.hpp"
#include "host/trees/next_experiment.hpp"
#include "host/trees/reported.hpp"
#include "host/trees/result.hpp"
#include "host/trees/search.hpp"

namespace furcula::trees {
namespace {

/// Where so much lasts that nothing predicts, of the drive's torque and of the torque that what is named accounts for, the names may stand
/// for something else. Of real machines a twentieth of the drive's is usual.
constexpr double kDoubted = 0.1, kOfNamed = 0.5;
/// A drive that gives less than this of what moves its joint gives nothing.
constexpr double kDriven = 0.02;
/// What is missing at times only: so much of the drive's torque, and so much of its squares in a tenth of the samples (of chance: 0.44).
constexpr double kOfDrive = 0.1, kNearlyAll = 0.9;
/// Held-out windows that are so many times as far off as those that were fitted show something else.
constexpr double kOnlyThere = 4.0;
constexpr std::size_t kMostSearchWindows = 160;
/// Below this confidence it is said why.
constexpr double kClear = 0.9;

std::string percent(double share) {
  const double p = 100.0 * share;
  return (std::abs(p) >= 10.0 ? std::to_string(static_cast<long>(std::lround(p))) : core::rounded(p, 2)) +
         " %";
}

std::string joined(const std::vector<std::string>& all) {
  std::string out;
  for (std::size_t i = 0; i < all.size(); ++i)
    out += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i];
  return out;
}

class Diagnoser {
 public:
  Diagnoser(const TreeModel& model, const std::vector<log::Log>& training,
            const std::vector<log::Log>& held_out, const Options& options)
      : model_(model), options_(options) {
    for (const log::Log& log : training) {
      training_.push_back(recording_of(model, log));
      d_.training_files.push_back(log.path);
      d_.samples += log.rows();
    }
    require_motion(model, training_);
    if (!options.trust_columns) require_conventions(model, training_, options.window_s);
    for (const log::Log& log : held_out) {
      held_out_.push_back(recording_of(model, log));
      d_.held_out_files.push_back(log.path);
      d_.samples += log.rows();
    }
    share_lateness(training_, held_out_);
    std::set<std::string> foreign;
    for (const auto* logs : {&training, &held_out})
      for (const log::Log& log : *logs)
        for (const std::string& joint : foreign_joints(model, log)) foreign.insert(joint);
    note_loop_rate();
    if (!foreign.empty())
      d_.notes.push_back("The logs have columns of joints that " + model.urdf.file + " does not have: " +
                         joined({foreign.begin(), foreign.end()}) + ". They are not used.");
    for (const auto* recordings : {&training_, &held_out_})
      for (const Recording& r : *recordings) add_data_quality(d_.data_quality, r);
    d_.model = model;
    d_.logs = training.size() + held_out.size();
    d_.held_out_logs = held_out.size();
    d_.window_s = options.window_s;
  }

  /// Whether a recording that disagrees with the others may be taken out.
  void may_disagree(bool may) { may_disagree_ = may; }
  /// The training recording that does, found by what run() chose.
  const std::optional<Disagreement>& disagreement() const { return disagreement_; }

  /// Ends early where a recording disagrees with the others.
  Diagnosis run() {
    std::vector<Window> windows = windows_of(model_, training_, options_.window_s, kMostSearchWindows);
    if (windows.empty())
      throw core::DataError("no training log has " + core::shortest(options_.window_s) +
                            " s without a gap; expected longer logs, or a smaller --window-s");
    if (windows_of(model_, held_out_, options_.window_s, 1).empty())
      throw core::DataError("no held-out log has " + core::shortest(options_.window_s) +
                            " s without a gap; expected longer logs, or a smaller --window-s");
    d_.windows = windows.size();
    Problem problem(model_, training_, std::move(windows), options_.threads);
    std::vector<Window> short_windows =
        windows_of(model_, training_, options_.window_s / 3.0, kMostSearchWindows);
    std::optional<Problem> coarse;
    if (!short_windows.empty()) coarse.emplace(model_, training_, std::move(short_windows), options_.threads);
    const Found found = search(problem, coarse ? &*coarse : nullptr, options_.progress, options_.most_work);
    if (may_disagree_)
      disagreement_ = disagreeing(model_, training_, found.fit.at, options_.window_s, kMostSearchWindows,
                                  options_.threads);
    if (disagreement_) return {};
    disputed_ = found.disputed;
    ended_early_ = found.ended_early;
    unjudged_ = found.unjudged;
    if (ended_early_)
      d_.notes.push_back(
          "The search was ended: after much more work than usual there was still something to add. More may be wrong than is named.");
    d_.refitted = found.refitted.at;
    d_.extended = found.fit.at;
    note_inputs(found.fit);
    for (const auto& t : found.table) {
      const std::string name = cause_name(model_, t.cause);
      const bool again = std::any_of(d_.candidates.begin(), d_.candidates.end(),
                                     [&](const auto& c) { return label(c.causes) == name; });
      if (again) continue;
      result::Candidate candidate;
      candidate.causes = {named(model_, t.cause)};
      candidate.score_test_gain = t.gain;
      candidate.chosen = std::any_of(d_.extended.causes.begin(), d_.extended.causes.end(),
                                     [&](const Cause& c) { return cause_name(model_, c) == name; });
      d_.candidates.push_back(std::move(candidate));
    }
    say(0.95, "predicting the held-out logs");
    errors();
    torques(problem);
    if (found.common) beside_common(*found.common);
    findings(problem, found);
    parameters(problem, found);
    known_inertias(problem);
    verdict(problem);
    motions();
    return std::move(d_);
  }

 private:
  /// What it is worth that nobody knows how often a position law is calculated.
  void note_loop_rate() {
    constexpr double kUsual_hz = 1000.0;
    for (std::size_t j = 0; j < model_.joints(); ++j) {
      const Drive& drive = model_.drives[j];
      if (drive.law != ControlMode::position || drive.loop_rate_hz > 0.0) continue;
      const double half_s = 0.5 / kUsual_hz;
      const bool slides = model_.prismatic(j);
      d_.notes.push_back(
          "Position laws count as calculated continuously; loop_rate_hz in [drive] says how often they are. " +
          std::string("A rate of 1 kHz acts like ") + core::rounded(drive.kp_nmprad * half_s, 3) +
          (slides ? " N s/m" : " N m s/rad") + " less damping and " +
          core::rounded(drive.kd_nmsprad * half_s, 3) + (slides ? " kg" : " kg m^2") +
          " less rotor inertia at " + model_.robot.joints[j].name + ".");
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
      const double time_ms = 1e3 * std::abs(rows) * training_.front().interval_s;
      d_.notes.push_back(
          "Inputs act " + core::rounded(std::abs(rows), 2) + " rows (" + core::rounded(time_ms, 2) + " ms) " +
          (rows < 0.0 ? "before their rows, as torques do that are measured at the rows' times"
                      : "after their rows, as commands do that wait for the drive's next tick") +
          ". That is allowed for, and no cause.");
    }
  }
  void say(double fraction, std::string_view doing) const {
    if (options_.progress) options_.progress(fraction, doing);
  }

  void errors() {
    const Hypothesis given{model_.drives, model_.causes};
    const auto of = [&](const Hypothesis& h, std::vector<double> Trace::*into) {
      return predict(model_, held_out_, options_.window_s, h, &d_.traces, into);
    };
    const Predictions as_given = of(given, &Trace::as_given);
    d_.as_given_error = as_given.errors;
    d_.noise_floor = as_given.floor;
    d_.refitted_error = of(d_.refitted, &Trace::refitted).errors;
    d_.extended_error = of(d_.extended, &Trace::extended).errors;
    training_error_ = predict(model_, training_, options_.window_s, d_.extended).errors;
  }

  /// What the common laws alone are worth, beside all that is named.
  void beside_common(const Hypothesis& common) {
    const std::vector<ChannelError> error = predict(model_, held_out_, options_.window_s, common).errors;
    std::vector<std::string> names, joints;
    for (std::size_t c = model_.causes.size(); c < common.causes.size(); ++c)
      names.push_back(cause_name(model_, common.causes[c]));
    for (std::size_t j = 0; j < model_.joints(); ++j)
      joints.push_back(model_.robot.joints[j].name + " " + core::rounded(error[j].rmse, 3) + " " +
                       std::string(channel_unit(model_, j)));
    if (!names.empty())
      d_.notes.push_back("Common laws alone, " + joined(names) + ": held-out error, RMS, " + joined(joints) +
                         ". What is named beyond them is worth the difference.");
  }

  void torques(const Problem& problem) {
    const std::vector<TorqueSamples> before =
        missing_torque(problem, training_, d_.refitted, options_.window_s);
    after_ = missing_torque(problem, training_, d_.extended, options_.window_s);
    const std::vector<TorqueSamples>& after = after_;
    for (std::size_t j = 0; j < model_.joints(); ++j) {
      MissingTorque m = side_by_side(before[j], after[j]);
      const Remainder was = remainder_of(before[j], training_.size()),
                      left = remainder_of(after[j], training_.size());
      m.rms_before_nm = was.rms_nm;
      m.rms_after_nm = left.rms_nm;
      m.persistent_after_nm = left.persistent_nm;
      m.rms_torque_nm = problem.scales().torque_nm[j];
      m.rms_drive_nm = problem.scales().drive_nm[j];
      m.predictable_before = was.predictable;
      m.predictable_after = left.predictable;
      if (structured(m)) m.correlated_with = correlated_with(after[j], j, training_.size(), model_);
      d_.missing.push_back(std::move(m));
    }
  }
  /// The samples that both have: which rows are too near to a reversal depends on the model's own motion.
  static MissingTorque side_by_side(const TorqueSamples& before, const TorqueSamples& after) {
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
  static Remainder remains(const MissingTorque& m) {
    return {m.rms_after_nm, m.predictable_after, m.persistent_after_nm};
  }
  /// Much torque is missing, and nearly all of it in a few places.
  static bool at_times(const MissingTorque& m) {
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
  static bool structured(const MissingTorque& m) { return remains(m).is_structured(m.rms_torque_nm); }
  static bool is_another(const MissingTorque& m) { return remains(m).is_another(m.rms_torque_nm); }
  static bool lasts(const MissingTorque& m) { return remains(m).lasts(m.rms_torque_nm); }

  /// Whether something else than what is named acts at this joint, or at one whose missing torque goes along with what this one does.
  bool beside_another(std::size_t joint) const {
    const std::string does = what_does(model_, joint);
    for (std::size_t j = 0; j < d_.missing.size(); ++j) {
      const MissingTorque& m = d_.missing[j];
      const double named_nm =
          std::sqrt(std::max(0.0, m.rms_before_nm * m.rms_before_nm - m.rms_after_nm * m.rms_after_nm));
      const bool lasting = m.persistent_after_nm > std::max(kDoubted * m.rms_torque_nm, kOfNamed * named_nm);
      if ((is_another(m) || lasting) && (j == joint || m.correlated_with == does)) return true;
    }
    return false;
  }

  /// Drives that are all late, and angles that are late in the log.
  bool one_law(const Cause& a, const Cause& b) const {
    const auto all_late = [&](const Cause& c) {
      return c.effect == Effect::actuator_delay && c.sites.size() == model_.joints();
    };
    return (all_late(a) && b.effect == Effect::time_skew && b.values[0] > 0.0) ||
           (all_late(b) && a.effect == Effect::time_skew);
  }
  static bool undecided(const Finding& f) {
    return std::any_of(f.indistinguishable_from.begin(), f.indistinguishable_from.end(),
                       [](const result::Rival& r) { return !r.same_law; });
  }

  std::vector<Estimate> estimates(const Fit& fit, std::size_t cause) const {
    std::vector<Estimate> out;
    const Cause& c = fit.at.causes[cause];
    const EffectInfo& e = info(c.effect);
    const bool linear = is_linear(model_, e.location_type, c.sites.front());
    for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
      const Unknown& u = fit.unknowns[k];
      if (!u.of_cause || u.cause != cause) continue;
      const Parameter& p = e.parameters()[u.parameter];
      out.push_back(interval(std::string(name_on(p, linear)), std::string(unit_on(p, linear)), fit, k));
    }
    return out;
  }
  /// Whether its parameters are within their scatter, taken together, of values with which the cause is not there.
  bool covers_none(const Fit& fit, std::size_t cause) const {
    const Away away = away_from_none(model_, fit, cause);
    return away.parameters > 0 &&
           away.squares < core::chi_square_above(0.05, static_cast<double>(away.parameters));
  }
  static Estimate interval(const std::string& name, const std::string& unit, const Fit& fit, std::size_t k) {
    const Interval within = interval_of(fit, k);
    return {name, unit, value_of(fit.at, fit.unknowns[k]), within.lower, within.upper};
  }

  void findings(Problem& problem, const Found& found) {
    const std::size_t given = model_.causes.size();
    double explainable = 0.0;
    for (const double g : found.gain) explainable += g;
    for (std::size_t c = given; c < found.fit.at.causes.size(); ++c) {
      const Cause& cause = found.fit.at.causes[c];
      const EffectInfo& e = info(cause.effect);
      Finding f;
      f.cause = cause;
      for (const std::size_t site : cause.sites) f.at.push_back(site_name(model_, e.location_type, site));
      f.parameters = estimates(found.fit, c);
      f.explainable_removed = explainable > 0.0 ? found.gain[c - given] / explainable : 0.0;
      const Fit off = problem.fit(without(found.fit.at, c), 4, &found.fit);
      f.without = predict(model_, held_out_, options_.window_s, off.at).errors;
      double others = 0.0;  // their odds
      for (const Rival& r : found.rivals[c - given]) {
        result::Rival text;
        text.causes = {named(model_, r.causes.front())};
        const EffectInfo& other = info(r.causes.front().effect);
        for (std::size_t k = 0; k < other.parameter_count; ++k) {
          const bool linear = is_linear(model_, other.location_type, r.causes.front().sites.front());
          text.causes.front().parameters.push_back({std::string(name_on(other.parameters()[k], linear)),
                                                    std::string(unit_on(other.parameters()[k], linear)),
                                                    r.causes.front().values[k], NAN, NAN});
        }
        if (one_law(cause, r.causes.front())) {
          text.same_law = true;
          text.reason = "the same law under another name: no recording tells them apart";
          f.indistinguishable_from.push_back(text);
          continue;
        }
        others += std::exp(-r.log_odds);
        text.reason =
            "in its place and fitted, the training recordings are less likely by a factor of " +
            (r.log_odds < std::log(1e6) ? core::rounded(std::exp(r.log_odds), 2) : "a million or more");
        if (r.stands()) undecided_.push_back(r.at);
        (r.stands() ? f.indistinguishable_from : f.alternatives).push_back(text);
      }
      f.confidence = std::min(0.99, 1.0 / (1.0 + others));
      if (f.confidence < kClear)
        f.lowered_by.push_back("another cause in its place fits the training recordings nearly as well");
      if (undecided(f)) limit(f, 0.5, "another cause explains the training recordings as well");
      // A value that a fit wanted beyond what there can be stands for something else.
      for (std::size_t k = 0; k < found.fit.unknowns.size(); ++k)
        if (found.fit.unknowns[k].of_cause && found.fit.unknowns[k].cause == c && found.fit.at_bound[k]) {
          limit(f, 0.3, "one of its values is at a bound");
          at_bound_ = true;
        }
      if (covers_none(found.fit, c))
        limit(f, 0.4, "the interval of its size holds the value at which there is nothing");
      if (total(f.without) < total(d_.extended_error))
        limit(f, 0.4, "the held-out recordings are predicted worse with it than without it");
      f.explanation = std::string(e.explanation);
      f.where_to_look = std::string(e.where_to_look);
      f.next_experiment = std::string(e.experiment);
      d_.findings.push_back(std::move(f));
    }
    std::stable_sort(d_.findings.begin(), d_.findings.end(),
                     [&](const Finding& a, const Finding& b) { return total(a.without) > total(b.without); });
  }
  /// Over joints, each by its own motion.
  static double total(const std::vector<ChannelError>& e) {
    double sum = 0.0;
    for (const ChannelError& c : e) sum += c.nmse;
    return sum;
  }

  void parameters(const Problem& problem, const Found& found) {
    for (std::size_t k = 0; k < found.fit.unknowns.size(); ++k) {
      const Unknown& u = found.fit.unknowns[k];
      if (u.of_cause || u.of_body || u.of_inputs) continue;
      const std::string name =
          std::string(kDriveParameters[u.parameter]) + "." + model_.robot.joints[u.joint].name;
      const std::string unit((model_.prismatic(u.joint) ? kLinearDriveUnits : kDriveUnits)[u.parameter]);
      result::Parameter row;
      row.name = name;
      row.unit = unit;
      row.baseline = value_of(Hypothesis{model_.drives, {}}, u);
      row.extended = interval(name, unit, found.fit, k);
      row.refitted = row.extended;
      for (std::size_t i = 0; i < found.refitted.unknowns.size(); ++i) {
        const Unknown& v = found.refitted.unknowns[i];
        if (!v.of_cause && !v.of_body && !v.of_inputs && v.joint == u.joint && v.parameter == u.parameter)
          row.refitted = interval(name, unit, found.refitted, i);
      }
      const double width = row.extended.upper - row.extended.lower;
      row.verdict = found.fit.at_bound[k]                                                  ? "at_bound"
                    : width > 0.5 * (u.upper - u.lower) || problem.scales().still[u.joint] ? "not_excited"
                                                                                           : "identified";
      d_.parameters.push_back(row);
    }
    bodies(problem, found);
  }
  /// Both fits have the same rows of bodies.
  void bodies(const Problem& problem, const Found& found) {
    if (model_.free_bodies.empty()) return;
    const Reported before = reported(model_, found.refitted), after = reported(model_, found.fit);
    for (std::size_t i = 0; i < after.rows.size(); ++i) {
      const Reported::Row& r = after.rows[i];
      if (!r.link) continue;
      const auto same = std::find_if(before.rows.begin(), before.rows.end(),
                                     [&](const Reported::Row& b) { return b.name == r.name; });
      const auto estimate = [](const Fit& fit, const Reported& all, std::size_t row) {
        const Interval within = interval_of(fit, all, row);
        return Estimate{all.rows[row].name, all.rows[row].unit, all.rows[row].value, within.lower,
                        within.upper};
      };
      result::Parameter row;
      row.name = r.name;
      row.unit = r.unit;
      row.baseline = r.given;
      row.extended = estimate(found.fit, after, i);
      row.refitted = estimate(found.refitted, before, static_cast<std::size_t>(same - before.rows.begin()));
      row.verdict = r.part == 0 && found.fit.at_bound[r.unknown]
                        ? "at_bound"
                        : parameter_verdict(model_, after, i, problem.scales().still).verdict;
      d_.parameters.push_back(std::move(row));
    }
  }

  /// What the recordings tell of masses and inertias.
  void known_inertias(const Problem& problem) {
    const Scales& scales = problem.scales();
    d_.base_parameters = base_parameters(model_, d_.extended, after_, scales.torque_nm);
    bool driven = false;
    for (std::size_t j = 0; j < model_.joints(); ++j)
      driven |= scales.drive_nm[j] > kDriven * scales.torque_nm[j];
    if (!driven)
      for (BaseParameter& b : d_.base_parameters) b.shown = false;
    const auto shown = std::count_if(d_.base_parameters.begin(), d_.base_parameters.end(),
                                     [](const BaseParameter& b) { return b.shown; });
    d_.notes.push_back("Of the bodies' " + std::to_string(kInertialParameters * model_.joints()) +
                       " inertial parameters the joints' torques depend on " +
                       std::to_string(d_.base_parameters.size()) + " combinations; these recordings show " +
                       std::to_string(shown) + " of them.");
    if (!driven)
      d_.notes.push_back(
          "No drive acts in them: twice all inertias, with twice all that is named, would move alike. Sizes are for the inertias given.");
  }

  static void limit(Finding& f, double most, std::string why) {
    if (!(f.confidence > most)) return;
    f.confidence = most;
    f.lowered_by.push_back(std::move(why));
  }

  /// Joints whose torque a cause changes: its own, of a link all down to the base, of the base and of the log all.
  std::vector<std::size_t> joints_of(const Cause& cause) const {
    const LocationType type = info(cause.effect).location_type;
    std::set<std::size_t> out;
    for (const std::size_t site : cause.sites) {
      if (is_of_joints(type)) out.insert(site);
      if (type != LocationType::link) continue;
      for (int j = model_.robot.links[site].joint; j >= 0;
           j = model_.robot.model.shape().parent(static_cast<std::size_t>(j)))
        out.insert(static_cast<std::size_t>(j));
    }
    for (std::size_t j = 0; out.empty() && j < model_.joints(); ++j) out.insert(j);
    return {out.begin(), out.end()};
  }

  /// Squares of torque over a joint's own: what goes with all that is named, and what a flexible law predicts of the rest, or lasts in it.
  struct Shares {
    double named = 0.0, left = 0.0;
  };
  static Shares shares_of(const MissingTorque& m) {
    const double unit = m.rms_torque_nm * m.rms_torque_nm;
    const auto squares = [](double rms, double share) { return std::max(0.0, share) * rms * rms; };
    const double before = squares(m.rms_before_nm, m.predictable_before),
                 after = squares(m.rms_after_nm, m.predictable_after);
    Shares out;
    // Where one recording alone has it, nothing predicts it from the others: then by what is less.
    out.named = std::max({0.0, before - after, squares(m.rms_before_nm, 1.0) - squares(m.rms_after_nm, 1.0)});
    if (structured(m)) out.left = after;
    if (lasts(m)) out.left = std::max(out.left, m.persistent_after_nm * m.persistent_after_nm);
    return {out.named / unit, out.left / unit};
  }
  /// Of the predictable torque at the joints where a cause acts, what no name accounts for.
  double unnamed_share(const Cause& cause) const {
    Shares all;
    for (const std::size_t j : joints_of(cause)) {
      const Shares at = shares_of(d_.missing[j]);
      all.named += at.named;
      all.left += at.left;
    }
    return all.left > 0.0 ? all.left / (all.left + all.named) : 0.0;
  }

  void verdict(const Problem& problem) {
    double before = 0.0, after = 0.0;
    std::vector<std::string> where;
    bool any_lost = false;
    for (std::size_t j = 0; j < model_.joints(); ++j) {
      const MissingTorque& m = d_.missing[j];
      const double unit = m.rms_torque_nm * m.rms_torque_nm;
      const Shares at = shares_of(m);
      after += m.predictable_after * m.rms_after_nm * m.rms_after_nm / unit;
      before += std::max(at.named + at.left, m.predictable_before * m.rms_before_nm * m.rms_before_nm / unit);
      // Runs that are further off than the joint moves, and far beyond its encoder's noise: whatever the torques say, it is not adequate.
      const bool lost = d_.extended_error[j].nmse > 1.0 && !problem.scales().still[j] &&
                        d_.extended_error[j].rmse > 50.0 * training_.front().angle_noise_rad[j];
      any_lost = any_lost || lost;
      // Held-out recordings may have what those that were fitted do not.
      const bool only_there = d_.findings.empty() &&
                              d_.extended_error[j].rmse > kOnlyThere * training_error_[j].rmse &&
                              d_.extended_error[j].rmse > 50.0 * training_.front().angle_noise_rad[j];
      if (structured(m) || lasts(m) || lost || only_there || at_times(m))
        where.push_back(model_.robot.joints[j].name);
    }
    const bool disputed = disputed_ > kDisputed;
    d_.unexplained_share = before > 0.0 && !d_.findings.empty() ? std::clamp(after / before, 0.0, 1.0)
                           : where.empty() && !disputed         ? 0.0
                                                                : 1.0;
    std::vector<std::string> of_another;
    for (std::size_t j = 0; j < model_.joints(); ++j)
      if (const MissingTorque& m = d_.missing[j]; is_another(m) || lasts(m) || at_times(m))
        of_another.push_back(model_.robot.joints[j].name);
    const bool another = !of_another.empty();
    const bool left =
        disputed || ended_early_ ||
        (!where.empty() && (d_.findings.empty() || d_.unexplained_share > kOfBefore || another));
    for (Finding& f : d_.findings) {
      if (const double none = result::share_of_none(unnamed_share(f.cause)); none > 0.0) {
        f.confidence *= 1.0 - none;
        if (none > 1.0 - kClear) f.lowered_by.push_back("the names leave a part of what there is to explain");
      }
      if (any_lost) limit(f, 0.5, "held-out runs are off by more than a joint moves");
      if (unjudged_) limit(f, 0.5, "the comparison with other causes was ended");
      const std::vector<std::size_t> joints = joints_of(f.cause);
      if (info(f.cause.effect).location_type != LocationType::base &&
          info(f.cause.effect).location_type != LocationType::log &&
          std::any_of(joints.begin(), joints.end(), [&](std::size_t j) { return beside_another(j); }))
        limit(f, 0.5, "predictable torque is still missing at its joint");
    }
    const bool undecided_ones = std::any_of(d_.findings.begin(), d_.findings.end(), undecided);
    // What the model lacks, and what it has wrong.
    std::vector<std::string> lacks, wrong;
    for (const Finding& f : d_.findings) {
      std::string_view label = info(f.cause.effect).label;
      std::vector<std::string>& list = label.starts_with("the ") ? wrong : lacks;
      constexpr std::string_view kOwn = "the model's ";
      if (label.starts_with(kOwn)) label = label.substr(kOwn.size());
      const bool of_log = info(f.cause.effect).location_type == LocationType::log;
      list.push_back(std::string(label) + (of_log ? " in the log" : " at " + joined(f.at)));
    }
    if (d_.findings.empty()) {
      d_.verdict = left ? Verdict::unexplained : Verdict::adequate;
      d_.summary =
          left && where.empty() && ended_early_
              ? "No cause of the catalogue was found before the search was ended."
          : left && where.empty()
              ? "The model is wrong by more than chance, and the recordings do not agree on a cause of the catalogue."
          : left
              ? "The model lacks torque at " + joined(where) +
                    ", and no cause of the catalogue accounts for it."
              : "The model is adequate: nothing is missing that the state, the torque or the time would predict.";
    } else {
      d_.verdict = undecided_ones      ? Verdict::not_identifiable
                   : left || at_bound_ ? Verdict::partly_explained
                                       : Verdict::explained;
      d_.summary = "The model " + (lacks.empty() ? "" : "lacks " + joined(lacks)) +
                   (lacks.empty() || wrong.empty() ? "" : ", and ") +
                   (wrong.empty() ? "" : "has wrong values of " + joined(wrong)) + ".";
      if (undecided_ones) d_.summary += " The recordings cannot tell all of that from other causes.";
      if (left && !where.empty() && d_.unexplained_share > kOfBefore)
        d_.summary += " " + percent(d_.unexplained_share) +
                      " of the torque that could be predicted is still missing, at " + joined(where) + ".";
      else if (another)
        d_.summary +=
            " Torque is still missing at " + joined(of_another) + ", for longer than noise would be.";
      else if (ended_early_)
        d_.summary += " The search for more was ended.";
      else if (left)
        d_.summary += " What is left is more than chance, and the recordings do not agree on a cause of it.";
    }
    if (!undecided_.empty()) {
      d_.experiments = next_experiments(model_, training_, d_.extended, undecided_, options_.window_s);
      if (!d_.experiments.empty())
        d_.next_experiment =
            d_.experiments.front().what +
            ": the predictions of the causes that these recordings cannot tell apart then differ by " +
            core::rounded(1e3 * d_.experiments.front().apart_rad, 3) + " mrad at least, RMS over " +
            core::shortest(options_.window_s) + " s.";
      if (const std::string other = other_way_of_moving(model_, training_); !other.empty())
        d_.next_experiment += (d_.next_experiment.empty() ? "" : " ") + other;
    }
    if (d_.next_experiment.empty() && !d_.findings.empty())
      d_.next_experiment = d_.findings.front().next_experiment;
  }

  /// One held-out recording for the picture: measured, and simulated window by window.
  void motions() {
    for (const Recording& r : held_out_) {
      Motion m;
      m.log = r.path;
      const std::size_t step =
          std::max<std::size_t>(1, static_cast<std::size_t>(0.02 / std::max(r.interval_s, 1e-6)));
      m.measured.resize(model_.joints());
      m.simulated.resize(model_.joints());
      for (std::size_t j = 0; j < model_.joints(); ++j)
        for (const Trace& t : d_.traces) {
          if (t.log != r.path || t.channel != channel_name(model_, j)) continue;
          for (std::size_t k = 0; k < t.time_s.size(); k += step) {
            if (j == 0) m.time_s.push_back(t.time_s[k] - t.time_s.front());
            m.measured[j].push_back(t.measured[k]);
            m.simulated[j].push_back(t.extended[k]);
          }
        }
      d_.motions.push_back(std::move(m));
      if (d_.motions.size() == 3) break;
    }
  }

  const TreeModel& model_;
  const Options& options_;
  bool may_disagree_ = false;
  std::optional<Disagreement> disagreement_;
  std::vector<Recording> training_, held_out_;
  bool at_bound_ = false;                        ///< of a finding
  std::vector<ChannelError> training_error_;     ///< of the extended model
  std::vector<TorqueSamples> after_;             ///< of the extended model, a joint each
  double disputed_ = 0.0;                        ///< see Found
  bool ended_early_ = false, unjudged_ = false;  ///< see Found
  std::vector<Hypothesis> undecided_;            ///< rivals that cannot be told from a finding
  Diagnosis d_;
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
