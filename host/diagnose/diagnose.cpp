#include "host/diagnose/diagnose.hpp"

#include <algorithm>
#include <utility>

#include "host/diagnose/associations.hpp"
#include "host/diagnose/candidates.hpp"
#include "host/diagnose/choice.hpp"
#include "host/diagnose/confidences.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/estimates.hpp"
#include "host/diagnose/findings.hpp"
#include "host/diagnose/likelihood_search.hpp"
#include "host/diagnose/next_experiment.hpp"
#include "host/diagnose/notes.hpp"
#include "host/diagnose/residual_force.hpp"
#include "host/diagnose/slips.hpp"
#include "host/diagnose/support.hpp"
#include "host/diagnose/verdict.hpp"
#include "host/diagnose/wording.hpp"
#include "host/identify/conventions.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using identify::Recording;
using identify::Window;

std::vector<Recording> joined(std::vector<Recording> all, const std::vector<Recording>& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void describe_data(Diagnosis& d, const model::Model& model, const DataSet& data, const HeldOut& held_out,
                   double window_s) {
  d.kind = model.kind;
  d.windows = data.all_training_windows();
  d.fitted_windows = data.training_windows().windows.size();
  d.windows_excluded = data.held_out_windows().size() - held_out.windows().size();
  d.logs = data.training().size() + data.held_out().size();
  d.held_out_logs = data.held_out().size();
  for (const auto& r : data.training()) d.training_files.push_back(r.name), d.samples += r.rows();
  for (const auto& r : data.held_out()) d.held_out_files.push_back(r.name), d.samples += r.rows();
  if (dynamics::has(model.kind, dynamics::LocationType::leg)) d.hops = d.windows + held_out.windows().size();
  const std::vector<Recording> all = joined(data.training(), held_out.recordings());
  for (const Recording& r : all) {
    d.data_quality.refused.insert(d.data_quality.refused.end(), r.refused.begin(), r.refused.end());
    d.data_quality.notes.insert(d.data_quality.notes.end(), r.notes.begin(), r.notes.end());
  }
  d.excluded = identify::excluded(all, model, window_s);
  if (machines::rules(model.kind).cut == machines::Cut::strides)
    d.contact_switch = identify::switch_agreement(all, machines::touchdown_height_m(d.extended_model));
  const auto names = identify::channel_names(model.kind);
  d.main_channel = names.position;
  d.main_unit = names.position_unit;
}

/// Errors on the held-out recordings, and what is left there.
void fill_figures(Diagnosis& d, const model::Model& model, const DataSet& data, const Crossed& crossed,
                  const Selection& selection, const HeldOut& held_out) {
  d.baseline = held_out.errors(model);
  d.refitted = held_out.errors(d.refitted_model);
  d.extended = held_out.errors(d.extended_model);
  d.noise_floor = held_out.noise_floor(selection.chosen.fitted);
  d.remainder = remainder_of(d.extended_model, data.training(), crossed.windows(), held_out.recordings(),
                             evenly(held_out.windows()));
  for (std::string& note : identify::disagreeing_held_out(
           d.extended_model, data.training(), held_out.recordings(), crossed.windows(), held_out.windows()))
    d.data_quality.notes.push_back(std::move(note));
}

/// Which experiment would tell the rivals apart.
void plan_experiments(Diagnosis& d, const model::Model& model, const DataSet& data,
                      const Selection& selection, const Options& options) {
  const std::vector<const Hypothesis*> candidates = to_be_told_apart(model, selection);
  if (candidates.size() < 2) return;
  if (options.progress) options.progress(0.98, "which experiment would tell");
  d.experiments = experiments_that_tell(model, candidates, data.training(), data.training_windows(),
                                        options.window_s, options.threads);
  std::vector<std::string> sets;
  for (const Hypothesis* h : candidates) sets.push_back(names(h->effects));
  const std::string text = experiment_that_tells(d, sets);
  for (Finding& f : d.findings)
    if (f.undecided) f.next_experiment = text;
}

void add_notes(Diagnosis& d, const model::Model& model, const DataSet& data, const Selection& selection,
               const Support& support, const HeldOut& held_out) {
  const auto add = [&](std::optional<std::string> note) {
    if (note) d.notes.push_back(std::move(*note));
  };
  if (data.early_rows() > 0.0)
    add("Inputs act " + number(data.early_rows()) + " rows (" +
        number(1e3 * data.early_rows() * identify::row_s(data.training().front())) +
        " ms) before their rows: by half a row as torques do that are measured at the rows' times, by less as commands do that change more often than there are rows. That is allowed for, and no cause.");
  add(note_one_scale(model, d.findings));
  if (support.undecided) add(note_held_out_that_tells(model, selection, held_out, d.main_unit));
}

/// Of long recordings some windows that lie evenly.
std::vector<Trace> traces_of(const Diagnosis& d, const model::Model& model, const HeldOut& held_out) {
  constexpr std::size_t kMostTraces = 96;
  const std::vector<Window>& windows = held_out.windows();
  const std::size_t step = std::max<std::size_t>(1, (windows.size() + kMostTraces - 1) / kMostTraces);
  std::vector<Trace> all;
  for (std::size_t i = 0; i < windows.size(); i += step) {
    const Window& w = windows[i];
    const Recording& r = held_out.recordings()[w.recording];
    const identify::StartState& start = held_out.starts()[i];
    Trace t;
    t.log = r.name;
    t.channel = d.main_channel;
    t.unit = d.main_unit;
    const auto slice = [&](const std::vector<double>& v) {
      return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(w.first),
                                 v.begin() + static_cast<std::ptrdiff_t>(w.last) + 1);
    };
    t.time_s = slice(r.time_s);
    t.measured = slice(r.position);
    t.as_given = identify::predict(model, r, w, start).position;
    t.refitted = identify::predict(d.refitted_model, r, w, start).position;
    t.extended = identify::predict(d.extended_model, r, w, start).position;
    all.push_back(std::move(t));
  }
  return all;
}

/// All that is said of what the training recordings chose. The held-out recordings are seen here first. They name nothing and withdraw nothing.
Diagnosis described(const model::Model& model, const DataSet& data, const Selection& selection,
                    const Options& options) {
  const Crossed crossed(data.training(), data.training_windows(),
                        evenly(identify::prediction_windows(data.training(), model, options.window_s)));
  const Support support = support_of(model, data, crossed, selection, options.without, options.threads);
  const Hypothesis& extended = extension(selection, support);

  const bool slips = holds(extended.effects, dynamics::Effect::encoder_slip);
  const ExpectedSlips expected =
      slips ? expected_slips(data.training(), data.held_out(), data.held_out_windows())
            : ExpectedSlips{data.held_out(), data.held_out_windows()};
  const bool slip_alone =
      !expected.predictable && extended.effects == EffectSet{dynamics::Effect::encoder_slip};
  const HeldOut held_out(expected.recordings, expected.windows, selection.refitted.fitted);

  Diagnosis d;
  d.refitted_model = selection.refitted.fitted;
  d.extended_model = extended.fitted;
  describe_data(d, model, data, held_out, options.window_s);
  fill_figures(d, model, data, crossed, selection, held_out);
  const bool random = random_alone(d, held_out);
  if (!support.withdrawn) {
    // What the machine does not repeat is nobody's to explain.
    const double floor = held_out.nmse(d.noise_floor);
    d.findings = findings_of(model, data, selection, held_out, d.extended,
                             random ? std::max(held_out.nmse(d.extended), floor) : floor);
  }
  d.beyond_bounds = beyond_bounds(model, selection);
  d.candidates = candidates_of(model, selection, support.withdrawn, held_out);
  d.parameters = parameter_rows(model, selection.refitted, extended);
  judge(d, held_out, {random, support.undecided, slip_alone, data.has_few_windows()});
  if (d.contact_switch.contradicted > 0 && d.verdict != Verdict::unexplained)
    d.data_quality.notes.push_back(identify::in_words(d.contact_switch) + ".");
  fill_confidences(d, model, data, crossed, selection, support, held_out, expected.predictable, slip_alone);
  judge_names(d);
  if (support.undecided) plan_experiments(d, model, data, selection, options);
  add_notes(d, model, data, selection, support, held_out);
  d.traces = traces_of(d, model, held_out);
  d.residual = residual_force(d.extended_model, extended.effects, joined(data.training(), data.held_out()));
  if (!d.nothing_left) d.correlated_with = associations(d.residual, model);
  d.next_experiment = next_experiment(d);
  d.rules_that_acted = selection.acted;
  if (support.by_rule) d.rules_that_acted.insert(Rule::withdrawal);
  d.summary = summary(d);
  return d;
}

}  // namespace

Diagnosis diagnose(const model::Model& model, const std::vector<log::Log>& training,
                   const std::vector<log::Log>& held_out, const Options& options) {
  // One recording that disagrees is taken out, and the rest diagnosed; of a quarter and more nobody can say which are right.
  constexpr double kMinority = 0.25;
  std::vector<log::Log> agreeing = training;
  std::vector<log::DataQuality::Excluded> excluded;
  for (;;) {
    if (!options.trust_columns)
      identify::require_conventions(model, identify::make_recordings(agreeing, model.kind));
    DataSet data = with_likelier_inputs(
        model, DataSet(model, agreeing, held_out, options.window_s, options.threads), options.threads);
    Selection selection = choose_causes(model, data, options);
    const bool may_disagree =
        static_cast<double>(excluded.size() + 1) < kMinority * static_cast<double>(training.size()) &&
        !options.without.contains(Rule::odd_recording);
    const auto odd = may_disagree ? odd_recording(model, data, selection, options.threads) : std::nullopt;
    if (odd) {
      excluded.push_back({agreeing[odd->recording].path, odd->why});
      agreeing.erase(agreeing.begin() + static_cast<std::ptrdiff_t>(odd->recording));
      continue;
    }
    if (!options.without.contains(Rule::likelihood))
      if (auto likeliest = select_by_likelihood(model, data.training(), data.training_windows(),
                                                options.threads, options.progress, selection))
        selection = std::move(*likeliest);
    Diagnosis d = described(model, data, selection, options);
    if (!excluded.empty()) d.rules_that_acted.insert(Rule::odd_recording);
    d.data_quality.excluded = std::move(excluded);
    return d;
  }
}

}  // namespace furcula::diagnose
