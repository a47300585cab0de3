#include "host/diagnose/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/error.hpp"
#include "host/diagnose/associations.hpp"
#include "host/diagnose/crossed.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/exclusion.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/likelihood_search.hpp"
#include "host/diagnose/next_experiment.hpp"
#include "host/diagnose/posterior.hpp"
#include "host/diagnose/residual_force.hpp"
#include "host/diagnose/selection.hpp"
#include "host/diagnose/wording.hpp"
#include "host/identify/conventions.hpp"
#include "host/identify/disagreement.hpp"
#include "host/identify/informative_windows.hpp"
#include "host/identify/manoeuvres.hpp"
#include "host/identify/plausible.hpp"
#include "host/identify/refute.hpp"
#include "host/identify/units.hpp"
#include "host/identify/verdicts.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"
#include "host/result/confidence.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using dynamics::Kind;
using identify::Recording;
using identify::Window;

constexpr std::size_t kFewestWindows = 3;
constexpr std::size_t kMostTraces = 96;
constexpr std::size_t kMostRowsOfSample = 24'000, kFewestOfSample = 24;
constexpr double kWithinNoise = 2.0;
constexpr double kSmallRemainder = 0.1;
/// Standard errors by which causes must help on training recordings that their fit has not seen. They are beyond
/// chance by all recordings together already; two would withdraw the friction of a real pendulum of which there is
/// one recording. Help in one recording alone is 1.0, whatever its size.
constexpr double kSureHelp = 1.2;
/// Of a belt, of which fits without each of few recordings predict falls that end on one tooth or another: beyond nine of ten draws of chance
/// in five recordings (Student's t).
constexpr double kSureHelpOfFalls = 1.6;
/// Standard errors of help from which causes stand though others would do as well: that one of them is there is plain.
constexpr double kPlainHelp = 3.0;
/// NMSE that the simulator's own discretisation and an input held from row to row are worth: two thousandths
/// of the motion. What is smaller is not called a cause, however fine the sensor.
constexpr double kNumerics = 4e-6;
/// With one slip more, the held-out recordings' NMSE is not so many times as large.
constexpr double kFarOff = 2.0;
constexpr const char* kContact = "contact";
constexpr const char* kDrive = "torque";
constexpr const char* kLeg = "leg_angle";

std::vector<std::string> strings(const std::vector<Effect>& effects) {
  std::vector<std::string> all;
  for (Effect e : effects) all.emplace_back(dynamics::info(e).name);
  return all;
}

std::map<std::string, Estimate> effect_parameters(const Hypothesis& h, Kind kind, bool qualified,
                                                  const Effect* only) {
  std::map<std::string, Estimate> all;
  const auto verdicts =
      identify::parameter_verdicts(identify::in_law_parameters(h.fit, h.unknowns, h.fitted), h.unknowns);
  for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
    const auto& u = h.unknowns[i];
    if (!u.of_effect || (only != nullptr && u.effect != *only)) continue;
    const std::string name =
        qualified ? u.name
                  : std::string(name_on(dynamics::info(u.effect).parameter_table[u.parameter], kind));
    all[name] = {verdicts[i].value, verdicts[i].lower, verdicts[i].upper};
  }
  return all;
}

/// Share of what stands above the floor in `before` that is gone in `after`.
double explained_share(double before, double after, double floor) {
  constexpr double kNothing = 1e-3;  // of what there was: the floor is not known better
  const double explainable = before - floor;
  return explainable > kNothing * before ? std::clamp((before - after) / explainable, -9.99, 1.0) : 0.0;
}

/// Why a hypothesis of the table was not named.
std::string why_not(const Tried& t, const Selection& s) {
  const auto& h = t.hypothesis;
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect && h.fit.at_bound[i])
      return "its best value is none at all, or a physical limit";
  if (!h.meaningful) return "its size scatters from window to window as much as it is away from none";
  if (!t.against_smaller.significant)
    return t.against_smaller.evidence > t.against_smaller.threshold
               ? "removes less than differences of numerics could"
               : "removes no more than chance would";
  const double ratio = std::sqrt(h.fit.squares / std::max(s.chosen.fit.squares, 1e-300));
  if (t.round == 0 && ratio > 1.05 && !s.chosen.effects.empty())
    return "leaves " + number(ratio) + " times the error of " + names(s.chosen.effects) +
           " on the training recordings";
  if (h.effects.size() >= s.chosen.effects.size() && ratio <= 1.05)
    return "explains the training recordings no better than " + names(s.chosen.effects);
  return "needless beside " + names(s.chosen.effects);
}

class Assembly {
 public:
  Assembly(const model::Model& model, const std::vector<log::Log>& training,
           const std::vector<log::Log>& held_out, const Options& options)
      : model_(model), options_(options), training_logs_(training), held_out_logs_(held_out) {
    if (!options.trust_columns)
      identify::require_conventions(model, identify::make_recordings(training, model.kind));
    take();
    refuse_by_residuals();
    if (other_inputs_fit_better({}, nullptr)) change_inputs();
    cross();
  }

  /// The training recording that disagrees with the others, found by what run() chose.
  const std::optional<identify::Disagreement>& disagreement() const { return disagreement_; }

  /// Whether one that does may be taken out.
  void may_disagree(bool may) { may_disagree_ = may; }

  /// Ends early where a recording disagrees with the others.
  Diagnosis run() {
    select_causes();
    select_again_with_other_inputs();
    // Slips are each recording's own: one that has a larger one is no other machine.
    if (may_disagree_ && !options_.without.contains(Rule::odd_recording) &&
        !holds(selection_.chosen.effects, Effect::encoder_slip))
      disagreement_ = find_disagreement();
    if (disagreement_) return {};
    if (!options_.without.contains(Rule::likelihood))
      if (auto likeliest = select_by_likelihood(model_, training_, training_windows_, options_.threads,
                                                options_.progress, selection_))
        selection_ = std::move(*likeliest);
    choose();
    // From here on the held-out recordings are seen. They name nothing and withdraw nothing.
    foretell_slips();
    starts_ = identify::start_states(held_out_, held_out_windows_, selection_.refitted.fitted);
    some_held_out_ = identify::evenly(held_out_windows_, kMostRowsOfSample, kFewestOfSample);
    some_starts_ = identify::start_states(held_out_, some_held_out_, selection_.refitted.fitted);
    describe_data();
    figures();
    findings();
    table();
    parameter_rows();
    verdict();
    confidences();
    no_finding();
    plan();
    note_inputs();
    note_one_scale();
    note_held_out_that_tells();
    pictures();
    d_.next_experiment = next_experiment(d_);
    d_.rules_that_acted = selection_.acted;
    d_.summary = summary(d_);
    return std::move(d_);
  }

 private:
  /// Of long recordings as many windows as a fit is made on.
  static std::vector<Window> evenly(const std::vector<Window>& all) {
    return identify::evenly(all, identify::kMostRowsOfFit, identify::kFewestChosen);
  }

  /// Whether the machine is a belt, whose falls end on one tooth or another: runs jump with what is fitted.
  bool ends_on_teeth() const { return machines::rules(model_.kind).cut == machines::Cut::releases; }

  void cross() {
    crossed_.emplace(training_, training_windows_,
                     evenly(identify::prediction_windows(training_, model_, options_.window_s)));
  }

  /// Whether inputs are a drive's, of which a log may have what is measured at each row's time, or what acts until the next.
  bool has_drive() const {
    const machines::Columns& columns = machines::rules(model_.kind).columns;
    return !columns.input.empty() && columns.touchdown.empty() && !ends_on_teeth();
  }
  /// Reads the inputs the other way.
  void change_inputs() {
    measured_inputs_ = !measured_inputs_;
    take();
  }
  /// Whether the other way of reading inputs leaves less with these causes, by more than chance makes of the windows.
  bool other_inputs_fit_better(const EffectSet& effects, const Hypothesis* from) {
    constexpr double kSurely = 2.0;  // standard errors
    if (!has_drive()) return false;
    const auto left = [&] {
      const Trainer trainer{model_, training_, training_windows_, options_.threads};
      const Hypothesis h = trainer.fit(effects, from);
      const auto wider = effects.empty() ? trainer.widened(h) : std::nullopt;
      return (wider ? *wider : h).fit.shares;
    };
    const auto now = left();
    change_inputs();
    const auto other = left();
    change_inputs();
    if (now.size() != other.size()) return false;
    double gain = 0.0, scatter = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double more =
          now[i][identify::Channel::motion].squares - other[i][identify::Channel::motion].squares;
      gain += more;
      scatter += more * more;
    }
    return gain > kSurely * std::sqrt(scatter * static_cast<double>(training_windows_.layers));
  }
  /// The causes may be why one way of reading seemed better than the other: the better end of two searches counts. A drive that is late is late
  /// after a command, and that is held.
  void select_again_with_other_inputs() {
    const Hypothesis first = selection_.chosen;
    const auto is_late = [](const Hypothesis& h) {
      return holds(h.effects, Effect::actuator_delay) || holds(h.effects, Effect::actuator_lag) ||
             holds(h.effects, Effect::time_skew);
    };
    const bool late = is_late(first);
    if (first.effects.empty() || (late ? !measured_inputs_ : !other_inputs_fit_better(first.effects, &first)))
      return;
    Selection before = std::move(selection_);
    change_inputs();
    cross();
    select_causes();
    if (late ? is_late(selection_.chosen) : selection_.chosen.fit.squares < first.fit.squares) return;
    selection_ = std::move(before);
    change_inputs();
    cross();
  }

  /// Of a belt, a fall that ends on another tooth must not outweigh the others: each counts by a loss that is bounded, by the size of most
  /// of them as the re-fitted model leaves them, and then as what is chosen does.
  void select_causes() {
    const bool jumps = ends_on_teeth();
    const auto select_now = [&](double from) {
      const Progress half = [&](double fraction, std::string_view what) {
        options_.progress(from + 0.5 * fraction, what);
      };
      selection_ = select(model_, training_, training_windows_, options_.threads,
                          jumps && options_.progress ? half : options_.progress, options_.without);
    };
    constexpr int kRounds = 4;
    for (int round = 0; jumps && round < kRounds; ++round)
      if (!bound_by(Trainer{model_, training_, training_windows_, options_.threads}.fit({}, nullptr))) break;
    select_now(0.0);
    if (jumps && bound_by(selection_.chosen)) select_now(0.5);
  }

  /// Lowers the bound to what `h` leaves of most windows; whether that is clearly less.
  bool bound_by(const Hypothesis& h) {
    constexpr double kClearly = 0.7;
    const double most = identify::most_squares_of(h.fit.shares);
    if (!(most < kClearly * training_windows_.most_squares)) return false;
    training_windows_.most_squares = most;
    return true;
  }

  /// By what was chosen, first, and what else was tried on top of the re-fitted model alone, and it.
  std::optional<identify::Disagreement> find_disagreement() const {
    std::vector<const Hypothesis*> sets;
    std::vector<identify::FittedSet> fitted;
    const auto add = [&](const Hypothesis& h) {
      if (h.failed) return;
      sets.push_back(&h);
      fitted.push_back({with_slips(model_, training_, h.effects), h.unknowns, h.fit});
    };
    add(selection_.chosen);
    add(selection_.refitted);
    for (const Hypothesis& h : selection_.without) add(h);
    for (const Tried& t : selection_.tried)
      if (t.round == 0) add(t.hypothesis);
    const Trainer trainer{model_, training_, training_windows_, options_.threads};
    return identify::disagreeing(fitted, training_, training_windows_.windows,
                                 [&](std::size_t set, std::size_t recording, const identify::Fit& without) {
                                   return log_odds_of_another(trainer, selection_, *sets[set], recording,
                                                              without) > 0.0;
                                 });
  }

  using Refuted = std::vector<std::vector<log::Refuted>>;  // rows of each log

  /// Makes recordings and windows of the logs, without the rows that are refuted.
  void take() {
    training_ = recordings_of(training_logs_, refuted_in_training_);
    held_out_ = recordings_of(held_out_logs_, refuted_in_held_out_);
    identify::keep_warm(held_out_, training_);
    training_windows_ = identify::training_windows(training_, model_, options_.window_s);
    d_.windows = training_windows_.windows.size();
    if (d_.windows > 0)
      training_windows_ = identify::informative_windows(training_, model_, std::move(training_windows_));
    d_.fitted_windows = training_windows_.windows.size();
    held_out_windows_ = identify::prediction_windows(held_out_, model_, options_.window_s);
    identify::require_plausible(training_, held_out_);
    require(training_windows_.windows, training_, "training");
    require(held_out_windows_, held_out_, "held-out");
  }

  std::vector<Recording> recordings_of(const std::vector<log::Log>& logs, const Refuted& refuted) const {
    std::vector<Recording> all = identify::make_recordings(logs, model_.kind, refuted);
    if (measured_inputs_) identify::take_as_measured(all);
    identify::follow_manoeuvres(all, model_);
    identify::keep_plausible_leg_angles(all, model_);
    identify::mend_velocities(all);
    return all;
  }

  /// What the neighbours of a row cannot tell, runs of the re-fitted model can: as long as they refute rows, these are left out.
  void refuse_by_residuals() {
    constexpr int kRounds = 2;
    if (machines::rules(model_.kind).held) return;
    for (int round = 0; round < kRounds; ++round) {
      const model::Model refitted =
          Trainer{model_, training_, training_windows_, options_.threads}.fit({}, nullptr).fitted;
      const auto refuted = [&](const std::vector<Recording>& recordings) {
        return identify::refuted_rows(refitted, recordings,
                                      identify::prediction_windows(recordings, model_, options_.window_s));
      };
      const bool in_training = identify::add_refuted(refuted_in_training_, refuted(training_));
      const bool in_held_out = identify::add_refuted(refuted_in_held_out_, refuted(held_out_));
      if (!in_training && !in_held_out) return;
      take();
    }
  }

  void require(const std::vector<Window>& windows, const std::vector<Recording>& recordings,
               const char* what) const {
    if (!windows.empty()) return;
    const std::string file = recordings.empty() ? std::string("no log") : recordings.front().name;
    if (const std::string left = identify::nothing_left(recordings, model_, options_.window_s); !left.empty())
      throw core::DataError(file + ": of the " + what + " recordings no stride is left: " + left);
    if (const auto expected = machines::rules(model_.kind).window_expected)
      throw core::DataError(file + ": the " + what + " recordings hold no " + expected(model_));
    throw core::DataError(file + ": the " + what + " recordings are shorter than a prediction window of " +
                          number(options_.window_s) + " s; expected longer ones or a smaller --window-s");
  }

  void describe_data() {
    d_.kind = model_.kind;
    d_.logs = training_.size() + held_out_.size();
    d_.held_out_logs = held_out_.size();
    for (const auto& r : training_) d_.training_files.push_back(r.name), d_.samples += r.rows();
    for (const auto& r : held_out_) d_.held_out_files.push_back(r.name), d_.samples += r.rows();
    if (dynamics::has(model_.kind, dynamics::LocationType::leg))
      d_.hops = d_.windows + held_out_windows_.size();
    for (const auto* list : {&training_, &held_out_})
      for (const Recording& r : *list) {
        d_.data_quality.refused.insert(d_.data_quality.refused.end(), r.refused.begin(), r.refused.end());
        d_.data_quality.notes.insert(d_.data_quality.notes.end(), r.notes.begin(), r.notes.end());
      }
    std::vector<Recording> all = training_;
    all.insert(all.end(), held_out_.begin(), held_out_.end());
    d_.excluded = identify::excluded(all, model_, options_.window_s);
    const auto names = identify::channel_names(model_.kind);
    d_.main_channel = names.position;
    d_.main_unit = names.position_unit;
  }

  /// What the diagnosis ends with: the chosen set, unless the training recordings do not bear it out.
  const Hypothesis& extension() const { return withdrawn_ ? selection_.refitted : selection_.chosen; }

  /// Whether the chosen causes stand on training recordings that their fit has not seen. Nothing is named where
  /// the re-fitted model leaves noise alone, and the causes are undecided or of no sure help. No simulator's
  /// numerics jump from one row to the next, and a slip in one recording says nothing of another.
  void choose() {
    const Hypothesis &chosen = selection_.chosen, &refitted = selection_.refitted;
    if (selection_.beyond_bounds) {
      withdrawn_ = true;
      const Hypothesis& h = *selection_.beyond_bounds;
      for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
        const auto& u = h.unknowns[i];
        const auto& bounds = model_.free.at(u.parameter);
        if (h.fit.values[i] < bounds.lower || h.fit.values[i] > bounds.upper)
          d_.beyond_bounds.push_back({u.name, u.unit, bounds.lower, bounds.upper, h.fit.values[i]});
      }
      return;
    }
    if (chosen.effects.empty()) return;
    for (const auto& rival : selection_.equals)
      undecided_ = undecided_ || !always_same(model_, rival.hypothesis.effects, chosen.effects);
    double gain = 0.0;
    const bool jumps = ends_on_teeth() && training_.size() > 1;
    if (jumps) {
      const Crossed::Predictable again = crossed_->fitted_again(model_, refitted, chosen, options_.threads);
      crossed_before_ = again.smaller, crossed_after_ = again.larger, gain = again.gain;
    } else {
      crossed_before_ = crossed_->nmse(refitted, refitted);
      crossed_after_ = crossed_->nmse(chosen, refitted);
      gain = crossed_->gain_in_standard_errors(refitted, chosen);
    }
    crossed_floor_ = crossed_->noise_floor(refitted);
    const bool other_channels = std::all_of(chosen.effects.begin(), chosen.effects.end(), [&](Effect e) {
      return judged_on(e, training_) != identify::Channel::motion;
    });
    if (other_channels) return;
    const bool slipped = holds(chosen.effects, Effect::encoder_slip);
    const bool numerics = crossed_before_ <= kNumerics && !slipped;
    const bool helps =
        slipped || (jumps ? gain > kSureHelpOfFalls : crossed_after_ < crossed_before_ && gain > kSureHelp);
    const bool doubtful = (undecided_ && gain < kPlainHelp) || !helps ||
                          std::any_of(chosen.effects.begin(), chosen.effects.end(), [&](Effect e) {
                            return may_be_none(chosen, model_, e) || not_held(e);
                          });
    withdrawn_ = numerics ||
                 (doubtful && !options_.without.contains(Rule::withdrawal) && refitted_stands_in_training());
    if (withdrawn_ && !numerics) selection_.acted.insert(Rule::withdrawal);
    if (withdrawn_) undecided_ = false;
  }

  bool refitted_stands_in_training() const {
    const Hypothesis& h = selection_.refitted;
    const auto left = remainder_of(h.fitted, training_, crossed_->windows());
    const identify::ChannelShare motion = channel(h.fit, identify::Channel::motion);
    // The floor of predictions is mostly the start states' noise: where more is known, it does not decide.
    return motion.squares <= kWithinNoise * motion.rows ||
           (!left && crossed_before_ <= kWithinNoise * (crossed_floor_ + kNumerics)) ||
           random_alone_in_training(h.fitted, left);
  }

  bool random_alone_in_training(const model::Model& m, const std::optional<Remainder>& left) const {
    if (left) return !left->is_structured_in_training() && left->repeats_in_training();
    return falls_repeat(m, training_, crossed_->windows(),
                        identify::start_states(training_, crossed_->windows(), m));
  }

  /// Slips that the training recordings have at the same times are to be expected in the held-out ones, and
  /// are put there. Of others no figure is made: windows that hold or follow one are left out.
  void foretell_slips() {
    if (!holds(extension().effects, Effect::encoder_slip)) return;
    recorded_ = held_out_;
    slips_predictable_ = slips_agree();
    const auto slipped_before = [&](const Window& w, bool only_within) {
      const auto& slips = recorded_[w.recording].slips;
      return std::any_of(slips.begin(), slips.end(), [&](const identify::Slip& slip) {
        return slip.row <= w.last && (!only_within || slip.row > w.first);
      });
    };
    for (Recording& r : held_out_) {
      r.slips.clear();
      r.slip_offset.clear();
      if (const Recording* before = identify::goes_on_from(r, training_);
          before && !before->slip_offset.empty())
        r.slip_offset.assign(r.rows(), before->slip_offset.back());
      if (!slips_predictable_) continue;
      const Recording& like = training_.front();
      if (r.slip_offset.empty()) r.slip_offset.assign(r.rows(), 0.0);
      for (const identify::Slip& slip : like.slips) {
        const double time_s = like.time_s[slip.row] - like.time_s.front();
        std::size_t row = 0;
        while (row < r.rows() && r.time_s[row] - r.time_s.front() < time_s) ++row;
        if (row == 0 || row == r.rows()) continue;
        r.slips.push_back({row, slip.step, slip.deviation});
        for (std::size_t i = row; i < r.rows(); ++i) r.slip_offset[i] += slip.step;
      }
    }
    if (slips_predictable_) return;
    // Where all follow one, those that hold none; where all hold one, none is left out.
    for (const bool only_within : {false, true}) {
      std::vector<Window> kept;
      for (const Window& w : held_out_windows_)
        if (!slipped_before(w, only_within)) kept.push_back(w);
      if (kept.empty()) continue;
      d_.windows_excluded = held_out_windows_.size() - kept.size();
      held_out_windows_ = std::move(kept);
      return;
    }
  }

  /// Whether each training recording has the same slips at the same times as the first.
  bool slips_agree() const {
    constexpr double kSameStep = 0.1, kSameTime_s = 0.01;
    const Recording& first = training_.front();
    return training_.size() > 1 && !first.slips.empty() &&
           std::all_of(training_.begin(), training_.end(), [&](const Recording& r) {
             if (r.slips.size() != first.slips.size()) return false;
             for (std::size_t i = 0; i < r.slips.size(); ++i) {
               const auto &a = first.slips[i], &b = r.slips[i];
               const double apart_s =
                   (first.time_s[a.row] - first.time_s.front()) - (r.time_s[b.row] - r.time_s.front());
               if (std::abs(apart_s) > kSameTime_s ||
                   std::abs(a.step - b.step) > kSameStep * std::abs(a.step) + 3.0 * a.deviation)
                 return false;
             }
             return true;
           });
  }

  Errors on_held_out(const model::Model& m) const {
    Errors errors = identify::prediction_errors(m, held_out_, held_out_windows_, starts_);
    if (const auto contact = identify::contact_errors(m, held_out_, held_out_windows_))
      errors[kContact] = *contact;
    if (const auto drive = identify::drive_errors(m, held_out_, held_out_windows_)) errors[kDrive] = *drive;
    if (const auto leg = identify::leg_angle_errors(m, held_out_, held_out_windows_, starts_))
      errors[kLeg] = *leg;
    return errors;
  }
  double nmse_on_some(const model::Model& m) const {
    return nmse(identify::prediction_errors(m, held_out_, some_held_out_, some_starts_));
  }
  double nmse(const Errors& e) const { return e.at(d_.main_channel).nmse; }

  void figures() {
    d_.baseline = on_held_out(model_);
    d_.refitted = on_held_out(selection_.refitted.fitted);
    d_.extended = on_held_out(extension().fitted);
    d_.noise_floor = identify::noise_floor(selection_.chosen.fitted, held_out_, held_out_windows_, starts_);
    d_.refitted_model = selection_.refitted.fitted;
    d_.extended_model = extension().fitted;
    d_.remainder =
        remainder_of(d_.extended_model, training_, crossed_->windows(), held_out_, evenly(held_out_windows_));
    for (std::string& note : identify::disagreeing_held_out(d_.extended_model, training_, held_out_,
                                                            crossed_->windows(), held_out_windows_))
      d_.data_quality.notes.push_back(std::move(note));
  }

  /// Nothing is missing in this model but what the machine does not repeat. What the simulator's numerics leave of an ideal
  /// sensor is correlated from row to row, too.
  bool random_alone_with(const model::Model& m, const std::optional<Remainder>& left) const {
    const bool numerics = nmse(d_.extended) <= kNumerics;
    return left ? !left->is_structured() && left->repeats() && (numerics || !left->is_coloured())
                : falls_repeat(m, held_out_, held_out_windows_, starts_);
  }

  void findings() {
    if (withdrawn_) return;
    const Hypothesis& chosen = selection_.chosen;
    const double after = nmse(d_.extended);
    // What the machine does not repeat is nobody's to explain.
    const double floor = random_alone_with(d_.extended_model, d_.remainder)
                             ? std::max(after, nmse(d_.noise_floor))
                             : nmse(d_.noise_floor);
    std::vector<std::pair<double, Finding>> all;
    for (std::size_t i = 0; i < chosen.effects.size(); ++i) {
      const Effect e = chosen.effects[i];
      Finding f;
      f.effect = e;
      f.parameters = effect_parameters(chosen, model_.kind, false, &e);
      const Errors without = on_held_out(selection_.without[i].fitted);
      const identify::Channel judge = judged_on(e, training_);
      if (judge == identify::Channel::contact) f.channel = kContact;
      if (judge == identify::Channel::drive) f.channel = kDrive;
      if (judge == identify::Channel::leg) f.channel = kLeg;
      const std::string& channel = f.channel.empty() ? d_.main_channel : f.channel;
      if (!without.contains(channel) || !d_.extended.contains(channel)) f.channel.clear();
      if (f.channel.empty()) {
        f.explainable_nmse_removed = explained_share(nmse(without), after, floor);
        f.squares_removed = 1.0 - after / std::max(nmse(without), 1e-300);
        f.held_out_mae_before = without.at(d_.main_channel).mae;
        f.held_out_mae_after = d_.extended.at(d_.main_channel).mae;
        f.contradicted = nmse(without) < after;
        intervals(f, selection_.without[i].fitted, identify::Channel::motion,
                  [&](const auto& before, const auto& now) {
                    return explained_share(before.nmse, now.nmse, floor);
                  });
      } else {
        // The floor: how far the reports scatter about the lag that the training recordings have; what the
        // current sensor, or the leg's encoder, resolves.
        const double scatter = judge == identify::Channel::contact ? contact_scatter()
                               : judge == identify::Channel::leg   ? leg_angle_noise()
                                                                   : held_out_.front().drive_noise;
        const auto& b = without.at(channel);
        const auto& a = d_.extended.at(channel);
        f.explainable_nmse_removed = explained_share(b.rmse * b.rmse, a.rmse * a.rmse, scatter * scatter);
        f.squares_removed = 1.0 - a.rmse * a.rmse / std::max(b.rmse * b.rmse, 1e-300);
        f.held_out_mae_before = b.mae;
        f.held_out_mae_after = a.mae;
        other_channel_helps_ = other_channel_helps_ || a.rmse < b.rmse;
        f.contradicted = b.rmse < a.rmse;
        intervals(f, selection_.without[i].fitted, judge, [&](const auto& before, const auto& now) {
          return explained_share(before.rmse * before.rmse, now.rmse * now.rmse, scatter * scatter);
        });
      }
      f.explanation = std::string(dynamics::info(e).explanation);
      f.next_experiment = std::string(dynamics::info(e).best_experiment);
      if (e == Effect::encoder_slip) slips(f);
      for (const auto& rival : selection_.equals)
        if (rival.of == e) {
          const bool same = always_same(model_, rival.hypothesis.effects, chosen.effects);
          Rival r{strings(without_common(rival.hypothesis.effects, chosen.effects)),
                  same ? "the same law under another name: no recording in motion can tell them apart"
                       : "explains the training recordings equally well",
                  effect_parameters(rival.hypothesis, model_.kind, true, nullptr)};
          r.same_law = same;
          f.undecided = f.undecided || !same;
          f.indistinguishable_from.push_back(std::move(r));
        }
      for (const Tried& t : selection_.tried) {
        if (t.round != 0 || t.hypothesis.effects.front() == e || !t.against_smaller.significant) continue;
        const std::string name(dynamics::info(t.hypothesis.effects.front()).name);
        const bool equal = std::any_of(f.indistinguishable_from.begin(), f.indistinguishable_from.end(),
                                       [&](const Rival& r) { return r.names == std::vector{name}; });
        const bool named = std::find(chosen.effects.begin(), chosen.effects.end(),
                                     t.hypothesis.effects.front()) != chosen.effects.end();
        if (!equal && !named) f.alternatives.push_back({{name}, why_not(t, selection_), {}});
      }
      all.emplace_back(nmse(without) - after, std::move(f));
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (auto& [cost, f] : all) d_.findings.push_back(std::move(f));
  }

  /// Intervals of what a finding gains, over the held-out recordings.
  template <class Share>
  void intervals(Finding& f, const model::Model& without, identify::Channel channel,
                 const Share& share) const {
    const auto of = [&](const model::Model& m) {
      using identify::Channel;
      return channel == Channel::contact ? identify::contact_sums(m, held_out_, held_out_windows_)
             : channel == Channel::drive ? identify::drive_sums(m, held_out_, held_out_windows_)
             : channel == Channel::leg   ? identify::leg_angle_sums(m, held_out_, held_out_windows_, starts_)
                                         : identify::position_sums(m, held_out_, held_out_windows_, starts_);
    };
    const auto before = of(without), after = of(d_.extended_model);
    const Units units = units_of(held_out_windows_);
    std::vector<identify::ErrorSums> before_of(units.size()), after_of(units.size());
    for (std::size_t u = 0; u < units.size(); ++u)
      for (const std::size_t i : units[u]) before_of[u] += before[i], after_of[u] += after[i];
    const auto drawn = [](const std::vector<identify::ErrorSums>& sums, const std::vector<double>& times) {
      identify::ErrorSums all;
      for (std::size_t u = 0; u < sums.size(); ++u)
        all += {times[u] * sums[u].squares, times[u] * sums[u].absolute, times[u] * sums[u].spread,
                times[u] * sums[u].count};
      return all.errors();
    };
    f.removed_interval = bootstrap(units.size(), [&](const std::vector<double>& times) {
      return share(drawn(before_of, times), drawn(after_of, times));
    });
    f.mae_gain_interval = bootstrap(units.size(), [&](const std::vector<double>& times) {
      return drawn(before_of, times).mae - drawn(after_of, times).mae;
    });
  }

  /// Whether one of its values lies on a bound, or may be anything.
  bool not_held(Effect e) const {
    const Hypothesis& h = selection_.chosen;
    if (e == Effect::leg_inertia) return false;  // one or two of three inertias may be none: they act alike
    const auto parameters = effect_parameters(h, model_.kind, false, &e);
    for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
      const auto& u = h.unknowns[i];
      if (!u.of_effect || u.effect != e) continue;
      const auto& p =
          parameters.at(std::string(name_on(dynamics::info(e).parameter_table[u.parameter], model_.kind)));
      if (h.fit.at_bound[i] || (p.lower <= u.lower && p.upper >= u.upper)) return true;
    }
    return false;
  }

  /// How sure each name is: what the training recordings say, lowered by what the held-out ones do.
  void confidences() {
    if (d_.findings.empty()) return;
    const Hypothesis& chosen = selection_.chosen;
    const std::optional<Remainder> left =
        d_.remainder ? d_.remainder : remainder_of(chosen.fitted, training_, crossed_->windows());
    const double misfit = misfit_of(left);
    const Posterior posterior(model_, selection_.pool, misfit);
    double unnamed = 0.0;
    if (!other_channels_alone()) {
      const bool structured = left && left->is_structured_in_training();
      unnamed =
          unnamed_share(crossed_before_, crossed_after_, crossed_floor_,
                        structured ? &left->crossed : nullptr, random_alone_in_training(chosen.fitted, left));
    }
    const double none = result::share_of_none(std::max(unnamed, d_.unnamed_share));
    d_.none_of_catalogue = none;
    const double beside = most_beside(nmse(d_.extended), nmse(d_.noise_floor));
    const bool all_contradicted = !other_channels_alone() && !helps_held_out();
    for (Finding& f : d_.findings) {
      const double share = posterior.share_with(f.effect);
      f.confidence = std::min(kConfidence.most, share * (1.0 - none));
      if (share < kConfidence.clear)
        f.lowered_by.push_back("sets of causes without it explain the training recordings nearly as well");
      if (none > 1.0 - kConfidence.clear)
        f.lowered_by.push_back("the names leave a part of what there is to explain");
      const auto limit = [&](bool applies, double most, std::string why) {
        if (!applies) return;
        f.confidence = std::min(f.confidence, most);
        f.lowered_by.push_back(std::move(why));
      };
      const bool told = f.effect != Effect::encoder_slip || slips_predictable_;
      limit(f.undecided, kConfidence.undecided, "another cause explains the training recordings as well");
      limit(may_be_none(chosen, model_, f.effect), kConfidence.may_be_none,
            "the interval of its size holds the value at which there is nothing");
      limit(independent_windows() < kFewestWindows, kConfidence.few_windows,
            "the training recordings hold no more than " +
                number(static_cast<double>(independent_windows())) + " stretches to predict");
      limit(not_held(f.effect), kConfidence.not_held, "one of its values may be anything within its bounds");
      const bool contradicted = told && f.contradicted;
      limit(contradicted, kConfidence.contradicted,
            "the held-out recordings are predicted worse with it than without it");
      limit(all_contradicted && f.channel.empty() && (told || slip_alone()) && !contradicted,
            kConfidence.contradicted,
            "the held-out recordings are predicted worse with all that is named than without");
      limit(told && !contradicted &&
                (f.explainable_nmse_removed < kConfidence.least_confirmation ||
                 f.squares_removed < kConfidence.least_gain),
            kConfidence.not_confirmed, "the held-out recordings hardly show it");
      if (f.channel.empty() && told)
        limit(beside < kConfidence.clear, beside,
              "held-out runs are off by " + number(100.0 * std::sqrt(nmse(d_.extended))) +
                  " % of the motion with all that is named");
      limit(clips_nearly_all(f), kConfidence.clips_nearly_all,
            "the limit clips nearly every sample: it stands for another scale of the input");
      if (const auto little = too_little_seen(f.effect, chosen.fitted, training_, crossed_->windows()))
        limit(true, kConfidence.little_seen, *little);
    }
    for (Candidate& c : d_.candidates) c.weight = posterior.weight_of(effects_named(c.effects));
  }

  /// Whether a drive's limit clips more of the samples in which it is driven than a limit does.
  bool clips_nearly_all(const Finding& f) const {
    if (f.effect != Effect::torque_saturation || f.parameters.empty()) return false;
    const double limit = f.parameters.begin()->second.value;
    std::size_t driven = 0, clipped = 0;
    for (const Recording& r : training_)
      for (const double u : r.drive_commands().command) {
        driven += u != 0.0;
        clipped += std::abs(u) > limit;
      }
    return static_cast<double>(clipped) > kConfidence.most_clipped * static_cast<double>(driven);
  }

  static EffectSet effects_named(const std::vector<std::string>& names) {
    EffectSet all;
    for (const std::string& n : names) all.push_back(*dynamics::effect_named(n));
    return all;
  }

  /// A slip that nothing predicts, alone, changes no figure; but what was fitted beside one that is none is far off.
  bool helps_held_out() const {
    return nmse(d_.extended) < (slip_alone() ? kFarOff : 1.0) * nmse(d_.refitted);
  }
  bool slip_alone() const {
    return !slips_predictable_ && extension().effects == EffectSet{Effect::encoder_slip};
  }

  /// The largest step with its interval, and all of them.
  void slips(Finding& f) const {
    const auto& table = dynamics::info(Effect::encoder_slip).parameter_table;
    double largest = 0.0;
    for (const auto* recordings : {&training_, &recorded_})
      for (const Recording& r : *recordings)
        for (const identify::Slip& slip : r.slips) {
          const double time_s = r.time_s[slip.row] - r.time_s.front();
          const double half_s = 0.5 * (r.time_s[slip.row] - r.time_s[slip.row - 1]);
          const bool observed = recordings != &training_;
          (observed ? f.observed_events : f.events)
              .push_back({r.name, time_s, slip.step, dynamics::info(model_.kind).rotary ? "rad" : "m"});
          if (observed || std::abs(slip.step) <= largest) continue;
          largest = std::abs(slip.step);
          f.parameters[std::string(name_on(table[0], model_.kind))] = {
              slip.step, slip.step - 1.96 * slip.deviation, slip.step + 1.96 * slip.deviation};
          f.parameters["time_s"] = {time_s - half_s, time_s - 2.0 * half_s, time_s};
        }
  }

  double contact_scatter() const {
    for (const Window& w : held_out_windows_)
      if (std::isfinite(w.report_lag_s)) return w.report_spread_s;
    return 0.0;
  }

  double leg_angle_noise() const {
    for (const Recording& r : held_out_)
      if (!r.leg_angle.empty()) return r.leg_angle_noise;
    return 0.0;
  }

  static std::vector<Effect> without_common(const std::vector<Effect>& a, const std::vector<Effect>& b) {
    std::vector<Effect> rest;
    for (Effect e : a)
      if (std::find(b.begin(), b.end(), e) == b.end()) rest.push_back(e);
    return rest;
  }

  void table() {
    // Of long recordings on some windows alone: there are dozens of rows.
    const double before = nmse_on_some(selection_.refitted.fitted),
                 floor = nmse(identify::noise_floor(selection_.chosen.fitted, held_out_, some_held_out_,
                                                    some_starts_));
    const auto row = [&](const Hypothesis& h, bool chosen, std::string outcome) {
      Candidate c;
      c.effects = strings(h.effects);
      c.parameters = effect_parameters(h, model_.kind, true, nullptr);
      c.training_gain =
          1.0 - h.cross_validated_squares / std::max(selection_.refitted.cross_validated_squares, 1e-300);
      c.held_out_gain = explained_share(before, nmse_on_some(h.fitted), floor);
      c.chosen = chosen;
      c.outcome = std::move(outcome);
      d_.candidates.push_back(std::move(c));
    };
    if (!selection_.chosen.effects.empty())
      row(selection_.chosen, !withdrawn_, withdrawn_ ? "fits what is within the measuring noise" : "named");
    for (const auto& rival : selection_.equals)
      if (std::none_of(d_.candidates.begin(), d_.candidates.end(),
                       [&](const Candidate& c) { return c.effects == strings(rival.hypothesis.effects); }))
        row(rival.hypothesis, false,
            always_same(model_, rival.hypothesis.effects, selection_.chosen.effects)
                ? "the same law under another name"
                : "explains the recordings equally well");
    for (const Tried& t : selection_.tried)
      if (std::none_of(d_.candidates.begin(), d_.candidates.end(),
                       [&](const Candidate& c) { return c.effects == strings(t.hypothesis.effects); }))
        row(t.hypothesis, false, why_not(t, selection_));
  }

  void parameter_rows() {
    const auto table = dynamics::info(model_.kind).parameters;
    const auto before = identify::parameter_verdicts(selection_.refitted.fit, selection_.refitted.unknowns);
    const Hypothesis& chosen = extension();
    const auto after = identify::parameter_verdicts(
        identify::in_law_parameters(chosen.fit, chosen.unknowns, chosen.fitted), chosen.unknowns);
    for (std::size_t i = 0; i < table.size(); ++i) {
      result::Parameter row;
      row.name = table[i].name;
      row.unit = table[i].unit;
      row.meaning = table[i].meaning;
      row.free = false;
      row.baseline = model_.parameters[i];
      row.refitted = row.extended = {row.name, row.unit, row.baseline, row.baseline, row.baseline};
      for (std::size_t k = 0; k < selection_.refitted.unknowns.size(); ++k) {
        if (selection_.refitted.unknowns[k].parameter != i) continue;
        row.free = true;
        row.refitted = {row.name, row.unit, before[k].value, before[k].lower, before[k].upper};
        row.extended = {row.name, row.unit, after[k].value, after[k].lower, after[k].upper};
        row.verdict = after[k].verdict;
        if (after[k].verdict == "correlated") row.verdict += " with " + after[k].with;
        if (after[k].verdict == "at_bound") row.verdict += " (" + after[k].with + ")";
      }
      d_.parameters.push_back(std::move(row));
    }
  }

  void verdict() {
    const double floor = nmse(d_.noise_floor), before = nmse(d_.refitted);
    // Two looks at the held-out recordings: predictions from the first 50 ms, and free runs with the best
    // start state, which the start's own noise does not blur.
    const auto noise_alone_with = [&](const model::Model& m, double error) {
      const identify::Fit look = identify::fit_by_simulation(m, {}, {}, held_out_, held_out_windows_);
      double rows = 0.0;
      double squares = 0.0;
      for (const auto& share : look.shares) {
        rows += share[identify::Channel::motion].rows;
        squares += share[identify::Channel::motion].squares;
      }
      return error <= kWithinNoise * (floor + kNumerics) || squares <= kWithinNoise * rows;
    };
    const double after = nmse(d_.extended);
    const bool missing = d_.remainder && d_.remainder->is_structured();
    // The noise floor is mostly that of the start states: where more is known, it does not decide.
    d_.nothing_left = random_alone_with(d_.extended_model, d_.remainder) ||
                      (!d_.remainder && noise_alone_with(d_.extended_model, after));
    d_.residual_white = d_.remainder ? d_.remainder->new_finds.white() : d_.nothing_left;
    // Where all that is left comes at random, that is nothing to explain but for what a flexible law predicts of it.
    const double to_explain =
        d_.nothing_left && d_.remainder ? std::max(0.0, d_.remainder->predictable.share) : 1.0;
    d_.unexplained_fraction =
        before > 0.0 ? std::clamp(to_explain * (after - floor) / before, 0.0, 1.0) : 0.0;
    d_.unnamed_share =
        unnamed_share(before, after, floor, missing ? &d_.remainder->predictable : nullptr, d_.nothing_left);
    compare_contact_switch();
    const bool helps = helps_held_out();
    d_.verdict = decide(d_.nothing_left, helps, d_.unnamed_share < kSmallRemainder);
    if (d_.contact_switch.contradicted > 0 && d_.verdict != Verdict::unexplained)
      d_.data_quality.notes.push_back(identify::in_words(d_.contact_switch) + ".");
    if (d_.findings.empty() || other_channels_alone()) d_.unnamed_share = 0.0;
  }

  /// Of a belt that teeth catch: whether so small a force as no machine repeats (at most that of
  /// Remainder::repeats()) makes each fall end as it did.
  static bool falls_repeat(const model::Model& m, const std::vector<Recording>& recordings,
                           const std::vector<Window>& windows,
                           const std::vector<identify::StartState>& starts) {
    constexpr double kForces[] = {-0.04, -0.02, -0.01, 0.0, 0.01, 0.02, 0.04}, kOfFall = 0.01, kWindows = 0.9;
    const auto at = dynamics::parameter_index(m.kind, "pulley_inertia_kgm2");
    if (!at) return false;
    const double inertia = machines::rules(m.kind).inertia(m);
    double well = 0.0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const Window& w = windows[i];
      const Recording& r = recordings[w.recording];
      double least = std::numeric_limits<double>::infinity(), spread = 0.0;
      for (double force : kForces) {  // so much less weight is as much more inertia
        model::Model other = m;
        other.parameters[*at] -= force * inertia;
        const identify::Run run = identify::predict(other, r, w, starts[i]);
        double squares = 0.0;
        for (std::size_t k = 0; k < w.rows(); ++k) {
          squares += std::pow(run.position[k] - r.position[w.first + k], 2) / static_cast<double>(w.rows());
          spread = std::max(spread, std::abs(r.position[w.first + k] - r.position[w.first]));
        }
        least = std::min(least, squares);
      }
      well += least <= kWithinNoise * r.position_noise * r.position_noise + std::pow(kOfFall * spread, 2);
    }
    return well >= kWindows * static_cast<double>(windows.size());
  }

  void compare_contact_switch() {
    if (machines::rules(model_.kind).cut != machines::Cut::strides) return;
    std::vector<Recording> all = training_;
    all.insert(all.end(), held_out_.begin(), held_out_.end());
    d_.contact_switch = identify::switch_agreement(all, machines::touchdown_height_m(d_.extended_model));
  }

  /// Where no name is more likely right than wrong, nothing is explained: the names leave too much, or others do as well.
  void no_finding() {
    if (d_.verdict != Verdict::explained || d_.findings.empty()) return;
    for (const Finding& f : d_.findings)
      if (f.confidence >= 0.5) return;
    d_.verdict = d_.none_of_catalogue > 0.5 ? Verdict::partly_explained : Verdict::not_identifiable;
  }

  Verdict decide(bool noise_alone, bool better_held_out, bool little_remains) const {
    if (!d_.beyond_bounds.empty()) return Verdict::not_identifiable;
    if (d_.findings.empty()) {
      if (noise_alone) return d_.contact_switch.is_refuted() ? Verdict::unexplained : Verdict::adequate;
      return independent_windows() < kFewestWindows ? Verdict::not_identifiable : Verdict::unexplained;
    }
    if (other_channels_alone()) {
      if (!other_channel_helps_) return Verdict::not_identifiable;
      return noise_alone ? Verdict::explained : Verdict::partly_explained;
    }
    // What helps on the training recordings, the held-out ones may refute.
    if (undecided_ || !better_held_out) return Verdict::not_identifiable;
    const bool far_off = most_beside(nmse(d_.extended), nmse(d_.noise_floor)) < 0.5;
    if (far_off && !noise_alone) return Verdict::partly_explained;
    return noise_alone || little_remains ? Verdict::explained : Verdict::partly_explained;
  }

  std::size_t independent_windows() const {
    return training_windows_.windows.size() / training_windows_.layers;
  }

  /// Which experiment would tell the rivals apart.
  void plan() {
    if (!undecided_) return;
    constexpr std::size_t kMostRivals = 4;
    std::vector<const Hypothesis*> candidates{&selection_.chosen};
    for (const auto& rival : selection_.equals)
      if (candidates.size() <= kMostRivals &&
          std::none_of(candidates.begin(), candidates.end(), [&](const Hypothesis* h) {
            return h->effects == rival.hypothesis.effects ||
                   always_same(model_, h->effects, rival.hypothesis.effects);
          }))
        candidates.push_back(&rival.hypothesis);
    if (candidates.size() < 2) return;
    if (options_.progress) options_.progress(0.98, "which experiment would tell");
    d_.experiments = experiments_that_tell(model_, candidates, training_, training_windows_,
                                           options_.window_s, options_.threads);
    std::vector<std::string> sets;
    for (const Hypothesis* h : candidates) sets.push_back(names(h->effects));
    const std::string text = experiment_that_tells(d_, sets);
    for (Finding& f : d_.findings)
      if (f.undecided) f.next_experiment = text;
  }

  void note_inputs() {
    if (measured_inputs_)
      d_.notes.push_back(
          "Inputs count as measured at the rows' times: between two rows the mean of both acts. The recordings are likelier so than with inputs that are held until the next row.");
  }

  /// Mass and damping of an axis that are wrong by one factor are a wrong scale of its force, or of its position.
  void note_one_scale() {
    if (model_.kind != dynamics::Kind::motor_axis) return;
    const auto ratio = [&](Effect e, const char* key) -> std::optional<Estimate> {
      const auto found = std::find_if(d_.findings.begin(), d_.findings.end(),
                                      [&](const Finding& f) { return f.effect == e; });
      const double given = model_.parameter(key);
      if (found == d_.findings.end() || !(given > 0.0)) return std::nullopt;
      const Estimate& of = found->parameters.begin()->second;
      return Estimate{of.value / given, of.lower / given, of.upper / given};
    };
    const auto mass = ratio(Effect::mass_error, "mass_kg"),
               damping = ratio(Effect::damping_error, "damping_nspm");
    if (!mass || !damping || mass->lower > damping->upper || damping->lower > mass->upper) return;
    d_.notes.push_back(
        "Mass and damping are both " + number(mass->value) + " times the model's: a force of " +
        number(1.0 / mass->value, 3) + " times what the logs say, or a position of " +
        number(mass->value, 3) +
        " times what they say, is the same law. Check the force's constant and the encoder's scale.");
  }

  /// Of causes that the training recordings cannot tell apart: a held-out recording that does. It names nothing here.
  void note_held_out_that_tells() {
    constexpr double kTells = 2.0;  // times the error
    if (!undecided_) return;
    const auto errors = [&](const model::Model& m) {
      const std::vector<identify::ErrorSums> sums =
          identify::position_sums(m, held_out_, held_out_windows_, starts_);
      std::vector<identify::ErrorSums> of(held_out_.size());
      for (std::size_t i = 0; i < sums.size(); ++i) of[held_out_windows_[i].recording] += sums[i];
      std::vector<double> rmse;
      for (const identify::ErrorSums& s : of) rmse.push_back(s.count > 0.0 ? s.errors().rmse : 0.0);
      return rmse;
    };
    const std::vector<double> own = errors(selection_.chosen.fitted);
    for (const auto& rival : selection_.equals) {
      if (always_same(model_, rival.hypothesis.effects, selection_.chosen.effects)) continue;
      const std::vector<double> its = errors(rival.hypothesis.fitted);
      for (std::size_t i = 0; i < own.size(); ++i) {
        const double least = std::min(own[i], its[i]);
        if (!(least > 0.0) || std::max(own[i], its[i]) < kTells * least) continue;
        d_.notes.push_back(held_out_[i].name + ", which is held out, tells them apart: its error (RMSE) is " +
                           readable(own[i], d_.main_unit) + " with " + names(selection_.chosen.effects) +
                           " and " + readable(its[i], d_.main_unit) + " with " +
                           names(rival.hypothesis.effects) +
                           ". Diagnose with it among the recordings that are fitted, and hold out others.");
        return;
      }
    }
  }

  bool other_channels_alone() const {
    return std::all_of(d_.findings.begin(), d_.findings.end(),
                       [](const Finding& f) { return !f.channel.empty(); });
  }

  void pictures() {
    const std::size_t step =
        std::max<std::size_t>(1, (held_out_windows_.size() + kMostTraces - 1) / kMostTraces);
    for (std::size_t i = 0; i < held_out_windows_.size(); i += step) {
      const Window& w = held_out_windows_[i];
      const Recording& r = held_out_[w.recording];
      Trace t;
      t.log = r.name;
      t.channel = d_.main_channel;
      t.unit = d_.main_unit;
      const auto slice = [&](const std::vector<double>& v) {
        return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(w.first),
                                   v.begin() + static_cast<std::ptrdiff_t>(w.last) + 1);
      };
      t.time_s = slice(r.time_s);
      t.measured = slice(r.position);
      t.as_given = identify::predict(model_, r, w, starts_[i]).position;
      t.refitted = identify::predict(selection_.refitted.fitted, r, w, starts_[i]).position;
      t.extended = identify::predict(extension().fitted, r, w, starts_[i]).position;
      d_.traces.push_back(std::move(t));
    }
    std::vector<Recording> all = training_;
    const auto& judged = recorded_.empty() ? held_out_ : recorded_;
    all.insert(all.end(), judged.begin(), judged.end());
    d_.residual = residual_force(extension().fitted, extension().effects, all);
    if (!d_.nothing_left) d_.correlated_with = associations(d_.residual, model_);
  }

  const model::Model& model_;
  const Options& options_;
  const std::vector<log::Log>&training_logs_, &held_out_logs_;
  bool may_disagree_ = false;
  std::optional<identify::Disagreement> disagreement_;
  Refuted refuted_in_training_, refuted_in_held_out_;
  bool measured_inputs_ = false;  ///< see identify::take_as_measured()
  std::vector<Recording> training_, held_out_;
  std::vector<Recording>
      recorded_;  // held out, with their slips as they are; where those are not in held_out_
  identify::TrainingWindows training_windows_;
  std::optional<Crossed> crossed_;  // of training_, once its rows are settled
  std::vector<Window> held_out_windows_;
  std::vector<Window> some_held_out_;                       // of long recordings; else all
  std::vector<identify::StartState> starts_, some_starts_;  // of these windows, the same for every model
  Selection selection_;
  Diagnosis d_;
  bool withdrawn_ = false;  // the chosen causes, by the training recordings
  bool undecided_ = false;
  bool slips_predictable_ = false;
  double crossed_before_ = 0.0, crossed_after_ = 0.0, crossed_floor_ = 0.0;  // NMSE, of training recordings
  bool other_channel_helps_ = false;
};

}  // namespace

Diagnosis diagnose(const model::Model& model, const std::vector<log::Log>& training,
                   const std::vector<log::Log>& held_out, const Options& options) {
  // One recording that disagrees is taken out, and the rest diagnosed; of a quarter and more nobody can say which are right.
  constexpr double kMinority = 0.25;
  std::vector<log::Log> agreeing = training;
  std::vector<log::DataQuality::Excluded> excluded;
  for (;;) {
    Assembly assembly(model, agreeing, held_out, options);
    assembly.may_disagree(static_cast<double>(excluded.size() + 1) <
                          kMinority * static_cast<double>(training.size()));
    Diagnosis d = assembly.run();
    if (const auto& odd = assembly.disagreement()) {
      excluded.push_back({agreeing[odd->recording].path, odd->why});
      agreeing.erase(agreeing.begin() + static_cast<std::ptrdiff_t>(odd->recording));
      continue;
    }
    if (!excluded.empty()) d.rules_that_acted.insert(Rule::odd_recording);
    d.data_quality.excluded = std::move(excluded);
    return d;
  }
}

}  // namespace furcula::diagnose
