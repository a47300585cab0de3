#include "host/identify/identification.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/identify/conventions.hpp"
#include "host/identify/equation_fit.hpp"
#include "host/identify/manoeuvres.hpp"
#include "host/identify/plausible.hpp"
#include "host/identify/refute.hpp"
#include "host/identify/units.hpp"
#include "host/identify/verdicts.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

constexpr std::size_t kMostTraces = 96;

bool restitution_is_free(const model::Model& model) {
  for (const char* name : {"restitution_touchdown", "restitution_liftoff"})
    if (model.free.contains(*dynamics::parameter_index(model.kind, name))) return true;
  return false;
}

/// The windows that parameters are fitted on.
TrainingWindows fit_windows(const std::vector<Recording>& recordings, const model::Model& model,
                            double window_s) {
  if (!dynamics::has(model.kind, dynamics::LocationType::leg))
    return training_windows(recordings, model, window_s);
  TrainingWindows t;
  const bool whole = restitution_is_free(model);
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (const auto& some : {stances(recordings[i], i, model), flights(recordings[i], i, model),
                             whole ? strides(recordings[i], i, model) : std::vector<Window>{}})
      t.windows.insert(t.windows.end(), some.begin(), some.end());
  }
  return t;
}

/// Damped natural frequency of the stance, sqrt(k/m) sqrt(1 - xi^2) (002 section 4.2.1.1), rad/s.
double damped_frequency(const model::Model& m) {
  const double mass = m.parameter("mass_kg"), sigma = m.parameter("damping_stance_nspm") / (2.0 * mass);
  return std::sqrt(std::max(0.0, m.parameter("stiffness_npm") / mass - sigma * sigma));
}

class Work {
 public:
  Work(const model::Model& model, const std::vector<log::Log>& training,
       const std::vector<log::Log>& held_out, const IdentifyOptions& options)
      : model_(model), options_(options), unknowns_(free_unknowns(model)) {
    if (unknowns_.empty())
      throw core::DataError(
          "the model has no [free] table: nothing to identify; expected at least one parameter with bounds in it");
    if (!options.trust_columns) require_conventions(model, make_recordings(training, model.kind));
    take(training, held_out, {}, {});
    refuse_by_residuals(training, held_out);
    const machines::Rules& rules = machines::rules(model.kind);
    if (rules.held && options.by_equation)
      throw core::DataError("equation error says nothing on " + std::string(dynamics::info(model.kind).name) +
                            ", whose belt stands or falls for whole windows; expected --method simulation");
    fit_windows_ = fit_windows(training_, model, options.window_s);
    const std::string left = nothing_left(training_, model, options.window_s);
    if (fit_windows_.windows.empty() && !left.empty())
      throw core::DataError(training_.front().name + ": no window to fit on is left: " + left);
    if (fit_windows_.windows.empty())
      throw core::DataError(training_.front().name + ": no window to fit on; expected " +
                            (rules.fit_expects.empty()
                                 ? "at least " + std::to_string(options.window_s) + " s of recording"
                                 : std::string(rules.fit_expects)));
    held_out_windows_ = prediction_windows(held_out_, model, options.window_s);
    for (const Window& w : fit_windows_.windows) units_.try_emplace(w.recording, units_.size());
    folds_ = fold_count();
  }

  Identification run() {
    Identification out;
    for (const auto* list : {&training_, &held_out_})
      for (const Recording& r : *list) {
        out.data_quality.refused.insert(out.data_quality.refused.end(), r.refused.begin(), r.refused.end());
        out.data_quality.notes.insert(out.data_quality.notes.end(), r.notes.begin(), r.notes.end());
      }
    out.kind = model_.kind;
    out.logs = training_.size() + held_out_.size();
    out.held_out_logs = held_out_.size();
    out.windows = fit_windows_.windows.size();
    out.folds = folds_;
    const ChannelNames names = channel_names(model_.kind);
    out.main_channel = names.position;
    out.main_unit = names.position_unit;
    for (const auto& r : training_) out.training_files.push_back(r.name), out.samples += r.rows();
    for (const auto& r : held_out_) out.held_out_files.push_back(r.name), out.samples += r.rows();
    std::vector<Recording> all = training_;
    all.insert(all.end(), held_out_.begin(), held_out_.end());
    out.excluded = excluded(all, model_, options_.window_s);
    if (options_.by_simulation) out.estimations.push_back(estimate(Method::simulation));
    if (options_.by_equation) out.estimations.push_back(estimate(Method::equation));
    if (!held_out_windows_.empty())
      out.as_given = prediction_errors(model_, held_out_, held_out_windows_, held_out_starts_);
    traces(out);
    return out;
  }

 private:
  using Refuted = std::vector<std::vector<log::Refuted>>;  // rows of each log

  void take(const std::vector<log::Log>& training, const std::vector<log::Log>& held_out,
            const Refuted& of_training, const Refuted& of_held_out) {
    training_ = make_recordings(training, model_.kind, of_training);
    held_out_ = make_recordings(held_out, model_.kind, of_held_out);
    keep_warm(held_out_, training_);
    require_plausible(training_, held_out_);
    for (auto* list : {&training_, &held_out_}) {
      follow_manoeuvres(*list, model_);
      mend_velocities(*list);
    }
  }

  /// Leaves out rows that runs of the fitted model refute.
  void refuse_by_residuals(const std::vector<log::Log>& training, const std::vector<log::Log>& held_out) {
    const TrainingWindows windows = training_windows(training_, model_, options_.window_s);
    if (windows.windows.empty() || machines::rules(model_.kind).held) return;
    const Fit fitted = fit_by_simulation(model_, unknowns_, values_in(model_, unknowns_), training_,
                                         windows.windows, Weighting::noise, windows.layers);
    const model::Model refitted = with_values(model_, unknowns_, fitted.values);
    const auto refuted = [&](const std::vector<Recording>& recordings) {
      return refuted_rows(refitted, recordings, prediction_windows(recordings, model_, options_.window_s));
    };
    const Refuted of_training = refuted(training_), of_held_out = refuted(held_out_);
    const auto any = [](const Refuted& all) {
      return std::any_of(all.begin(), all.end(), [](const auto& rows) { return !rows.empty(); });
    };
    if (any(of_training) || any(of_held_out)) take(training, held_out, of_training, of_held_out);
  }

  std::size_t fold_count() const {
    const bool by_recording = units_.size() > 1;
    const std::size_t units = by_recording ? units_.size() : fit_windows_.windows.size();
    const char* what = by_recording ? " recordings" : " windows";
    std::size_t folds = options_.folds;
    if (folds == 0) folds = std::min<std::size_t>(by_recording ? 10 : 5, units);
    if (units < folds || folds < 2)
      throw core::DataError(training_.front().name + ": " + std::to_string(units) + what +
                            " cannot be put into " + std::to_string(std::max<std::size_t>(folds, 2)) +
                            " folds; expected at least as many" + what + " as folds");
    return folds;
  }

  std::size_t fold_of(std::size_t window) const {
    return units_.size() > 1 ? units_.at(fit_windows_.windows[window].recording) % folds_
                             : window * folds_ / fit_windows_.windows.size();
  }

  Fit fit(Method method, const std::vector<double>& start, const std::vector<Window>& windows) const {
    const bool leg = dynamics::has(model_.kind, dynamics::LocationType::leg);
    if (method == Method::simulation)
      return fit_by_simulation(model_, unknowns_, start, training_, windows,
                               leg ? Weighting::nmse : Weighting::noise, fit_windows_.layers);
    // One step knows nothing of an impact: strides say nothing here.
    std::vector<Window> inside;
    for (const Window& w : windows)
      if (w.kind != WindowKind::stride) inside.push_back(w);
    return fit_by_equation(model_, unknowns_, start, training_, inside, fit_windows_.layers);
  }

  Estimation estimate(Method method) {
    const auto tell = [&](double fraction, const std::string& what) {
      if (options_.progress) options_.progress(fraction, what);
    };
    tell(0.0, "all recordings, " + std::string(name(method)) + " error");
    Estimation e;
    e.method = method;
    const std::vector<double> given = values_in(model_, unknowns_);
    const Fit whole = fit(method, given, fit_windows_.windows);
    e.model = with_values(model_, unknowns_, whole.values);
    std::vector<std::vector<double>> estimates(folds_);
    e.folds.resize(folds_);
    core::parallel_for(folds_, options_.threads, [&](std::size_t fold) {
      tell(static_cast<double>(fold + 1) / static_cast<double>(folds_ + 1),
           "fold " + std::to_string(fold + 1));
      std::vector<Window> seen, unseen;
      for (std::size_t i = 0; i < fit_windows_.windows.size(); ++i)
        (fold_of(i) == fold ? unseen : seen).push_back(fit_windows_.windows[i]);
      estimates[fold] = fit(method, whole.values, seen).values;
      const model::Model without_fold = with_values(model_, unknowns_, estimates[fold]);
      e.folds[fold] =
          prediction_errors(without_fold, training_, unseen, start_states(training_, unseen, without_fold));
    });
    const auto verdicts = parameter_verdicts(whole, unknowns_);
    for (std::size_t i = 0; i < unknowns_.size(); ++i) {
      Identified p;
      p.name = unknowns_[i].name;
      p.unit = unknowns_[i].unit;
      p.given = given[i];
      p.value = verdicts[i].value;
      p.lower = verdicts[i].lower;
      p.upper = verdicts[i].upper;
      for (const auto& values : estimates) p.folds.push_back(values[i]);
      p.verdict = verdicts[i].verdict;
      p.with = verdicts[i].with;
      e.parameters.push_back(std::move(p));
    }
    if (dynamics::has(model_.kind, dynamics::LocationType::leg)) {
      Derived d{"damped_frequency_radps", "rad/s", damped_frequency(e.model), {}};
      for (const auto& values : estimates)
        d.folds.push_back(damped_frequency(with_values(model_, unknowns_, values)));
      e.derived.push_back(std::move(d));
    }
    // The first estimate's start states serve all that are compared.
    if (held_out_starts_.empty()) held_out_starts_ = start_states(held_out_, held_out_windows_, e.model);
    if (!held_out_windows_.empty())
      e.held_out = prediction_errors(e.model, held_out_, held_out_windows_, held_out_starts_);
    return e;
  }

  void traces(Identification& out) const {
    const bool held = !held_out_windows_.empty();
    const auto& recordings = held ? held_out_ : training_;
    const auto& windows = held ? held_out_windows_ : fit_windows_.windows;
    const std::size_t step = std::max<std::size_t>(1, (windows.size() + kMostTraces - 1) / kMostTraces);
    for (std::size_t i = 0; i < windows.size(); i += step) {
      const Window& w = windows[i];
      const Recording& r = recordings[w.recording];
      const StartState start = start_state(r, w, out.estimations.front().model);
      const auto begin = static_cast<std::ptrdiff_t>(w.first), end = static_cast<std::ptrdiff_t>(w.last) + 1;
      out.traces.push_back({r.name,
                            out.main_channel,
                            out.main_unit,
                            {r.time_s.begin() + begin, r.time_s.begin() + end},
                            {r.position.begin() + begin, r.position.begin() + end},
                            predict(model_, r, w, start).position,
                            predict(out.estimations.front().model, r, w, start).position});
    }
  }

  const model::Model& model_;
  const IdentifyOptions& options_;
  std::vector<Unknown> unknowns_;
  std::vector<Recording> training_, held_out_;
  TrainingWindows fit_windows_;
  std::vector<Window> held_out_windows_;
  std::vector<StartState> held_out_starts_;
  std::map<std::size_t, std::size_t> units_;  // the recordings that have windows, numbered
  std::size_t folds_ = 0;
};

}  // namespace

std::string_view name(Method m) { return m == Method::equation ? "equation" : "simulation"; }

Identification identify(const model::Model& model, const std::vector<log::Log>& training,
                        const std::vector<log::Log>& held_out, const IdentifyOptions& options) {
  return Work(model, training, held_out, options).run();
}

}  // namespace furcula::identify
