#include "host/diagnose/data_set.hpp"

#include <string>

#include "host/core/error.hpp"
#include "host/diagnose/trainer.hpp"
#include "host/diagnose/wording.hpp"
#include "host/identify/informative_windows.hpp"
#include "host/identify/manoeuvres.hpp"
#include "host/identify/plausible.hpp"
#include "host/identify/refute.hpp"
#include "host/identify/units.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {

using identify::Recording;
using identify::Window;

DataSet::DataSet(const model::Model& model, const std::vector<log::Log>& training,
                 const std::vector<log::Log>& held_out, double window_s, unsigned threads)
    : model_(&model), training_logs_(&training), held_out_logs_(&held_out), window_s_(window_s) {
  read();
  refuse_by_residuals(threads);
}

DataSet DataSet::with_inputs(double early_rows) const {
  DataSet other(*this);
  other.early_rows_ = early_rows;
  other.read();
  return other;
}

bool DataSet::has_few_windows() const {
  constexpr std::size_t kFewest = 3;
  return independent_windows() < kFewest;
}

void DataSet::read() {
  training_ = recordings_of(*training_logs_, refuted_in_training_);
  held_out_ = recordings_of(*held_out_logs_, refuted_in_held_out_);
  identify::keep_warm(held_out_, training_);
  training_windows_ = identify::training_windows(training_, *model_, window_s_);
  all_training_windows_ = training_windows_.windows.size();
  if (all_training_windows_ > 0)
    training_windows_ = identify::informative_windows(training_, *model_, std::move(training_windows_));
  held_out_windows_ = identify::prediction_windows(held_out_, *model_, window_s_);
  identify::require_plausible(training_, held_out_);
  require(training_windows_.windows, training_, "training");
  require(held_out_windows_, held_out_, "held-out");
}

std::vector<Recording> DataSet::recordings_of(const std::vector<log::Log>& logs,
                                              const Refuted& refuted) const {
  std::vector<Recording> all = identify::make_recordings(logs, model_->kind, refuted);
  if (early_rows_ > 0.0) identify::take_earlier(all, early_rows_);
  identify::follow_manoeuvres(all, *model_);
  identify::keep_plausible_leg_angles(all, *model_);
  identify::mend_velocities(all);
  return all;
}

/// What the neighbours of a row cannot tell, runs of the re-fitted model can: as long as they refute rows, these are left out.
void DataSet::refuse_by_residuals(unsigned threads) {
  constexpr int kRounds = 2;
  if (machines::rules(model_->kind).held) return;
  for (int round = 0; round < kRounds; ++round) {
    const model::Model refitted =
        Trainer{*model_, training_, training_windows_, threads}.fit({}, nullptr).fitted;
    const auto refuted = [&](const std::vector<Recording>& recordings) {
      return identify::refuted_rows(refitted, recordings,
                                    identify::prediction_windows(recordings, *model_, window_s_));
    };
    const bool in_training = identify::add_refuted(refuted_in_training_, refuted(training_));
    const bool in_held_out = identify::add_refuted(refuted_in_held_out_, refuted(held_out_));
    if (!in_training && !in_held_out) return;
    read();
  }
}

void DataSet::require(const std::vector<Window>& windows, const std::vector<Recording>& recordings,
                      const char* what) const {
  if (!windows.empty()) return;
  const std::string file = recordings.empty() ? std::string("no log") : recordings.front().name;
  if (const std::string left = identify::nothing_left(recordings, *model_, window_s_); !left.empty())
    throw core::DataError(file + ": of the " + what + " recordings no stride is left: " + left);
  if (const auto expected = machines::rules(model_->kind).window_expected)
    throw core::DataError(file + ": the " + what + " recordings hold no " + expected(*model_));
  throw core::DataError(file + ": the " + what + " recordings are shorter than a prediction window of " +
                        number(window_s_) + " s; expected longer ones or a smaller --window-s");
}

std::vector<Window> evenly(const std::vector<Window>& all) {
  return identify::evenly(all, identify::kMostRowsOfFit, identify::kFewestChosen);
}

bool ends_on_teeth(dynamics::Kind kind) { return machines::rules(kind).cut == machines::Cut::releases; }

}  // namespace furcula::diagnose
