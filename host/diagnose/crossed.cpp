#include "host/diagnose/crossed.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/core/error.hpp"
#include "host/diagnose/trainer.hpp"

namespace furcula::diagnose {
namespace {

using identify::Window;

/// The model at the estimate that has not seen each fold.
std::vector<model::Model> models_of(const Hypothesis& h, const Crossing& crossing) {
  std::vector<model::Model> all;
  for (const Eigen::VectorXd& step : crossing.step) {
    std::vector<double> values = h.fit.values;
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::clamp(values[i] + step(static_cast<Eigen::Index>(i)), h.unknowns[i].lower,
                             h.unknowns[i].upper);
    all.push_back(identify::with_values(h.fitted, h.unknowns, values));
  }
  return all;
}

}  // namespace

Crossed::Crossed(const std::vector<identify::Recording>& recordings,
                 const identify::TrainingWindows& training, const std::vector<Window>& predicted)
    : recordings_(recordings), training_(training), units_(units_of(training.windows)) {
  // A window's fold is that of the one that begins nearest to it among those that fits are made on.
  for (const Window& w : predicted) {
    const auto distance = [&](std::size_t i) {
      const std::size_t first = training_.windows[i].first;
      return first > w.first ? first - w.first : w.first - first;
    };
    std::optional<std::size_t> nearest;
    for (std::size_t i = 0; i < training_.windows.size(); ++i)
      if (training_.windows[i].recording == w.recording && (!nearest || distance(i) < distance(*nearest)))
        nearest = i;
    if (!nearest) continue;
    predicted_.push_back(w);
    place_.push_back(*nearest);
  }
  predicted_units_ = units_of(predicted_);  // those of the fits may overlap
}

double Crossed::nmse(const Hypothesis& h, const Hypothesis& reference) const {
  const Crossing crossing = crossing_of(h.fit, training_.windows, recordings_.size()),
                 crossing_of_reference = crossing_of(reference.fit, training_.windows, recordings_.size());
  const auto models = models_of(h, crossing), references = models_of(reference, crossing_of_reference);
  identify::ErrorSums sums;
  for (std::size_t fold = 0; fold < models.size(); ++fold) {
    std::vector<Window> windows;
    for (std::size_t i = 0; i < predicted_.size(); ++i)
      if (crossing.fold[place_[i]] == fold) windows.push_back(predicted_[i]);
    const auto starts = identify::start_states(recordings_, windows, references[fold]);
    for (const auto& s : identify::position_sums(models[fold], recordings_, windows, starts)) sums += s;
  }
  return sums.errors().nmse;
}

double Crossed::noise_floor(const Hypothesis& h) const {
  const auto starts = identify::start_states(recordings_, predicted_, h.fitted);
  const auto floor = identify::noise_floor(h.fitted, recordings_, predicted_, starts);
  return floor.at(identify::channel_names(h.fitted.kind).position).nmse;
}

double Crossed::gain_in_standard_errors(const Hypothesis& smaller, const Hypothesis& larger) const {
  const std::vector<double> all =
      gains_unseen(smaller.fit, larger.fit, training_.windows, recordings_.size());
  std::vector<double> gains;
  for (const std::size_t i : place_) gains.push_back(all[i]);
  return in_standard_errors(gains, predicted_units_);
}

Crossed::Predictable Crossed::fitted_again(const model::Model& model, const Hypothesis& smaller,
                                           const Hypothesis& larger, unsigned threads) const {
  constexpr double kMost = 0.5;
  // Where the model runs away without a recording, what all have told is the best there is.
  const auto fitted = [](const Trainer& trainer, const Hypothesis& h) {
    try {
      return trainer.fit(h.effects, &h).fitted;
    } catch (const core::DataError&) {
      return h.fitted;
    }
  };
  identify::ErrorSums of_smaller, of_larger;
  std::vector<double> gain(predicted_.size());
  for (std::size_t unseen = 0; unseen < recordings_.size(); ++unseen) {
    std::vector<std::size_t> places;
    std::vector<Window> windows;
    for (std::size_t i = 0; i < predicted_.size(); ++i)
      if (predicted_[i].recording == unseen) places.push_back(i), windows.push_back(predicted_[i]);
    identify::TrainingWindows others;
    others.layers = training_.layers;
    others.most_squares = training_.most_squares;
    for (const Window& w : training_.windows)
      if (w.recording != unseen) others.windows.push_back(w);
    if (windows.empty() || others.windows.empty()) continue;
    const Trainer trainer{model, recordings_, others, threads};
    const model::Model one = fitted(trainer, smaller), other = fitted(trainer, larger);
    const auto starts = identify::start_states(recordings_, windows, one);
    const auto sums = identify::position_sums(one, recordings_, windows, starts),
               other_sums = identify::position_sums(other, recordings_, windows, starts);
    for (std::size_t k = 0; k < places.size(); ++k) {
      of_smaller += sums[k];
      of_larger += other_sums[k];
      // Of how many times as much, as far as half an e-fold: a fall that ends on another tooth is off by so much that it would hide all others.
      // What is as near as the encoder's noise is equal.
      const double noise = recordings_[unseen].position_noise, least = sums[k].count * noise * noise + 1e-300;
      gain[places[k]] =
          std::clamp(std::log((sums[k].squares + least) / (other_sums[k].squares + least)), -kMost, kMost);
    }
  }
  return {of_smaller.errors().nmse, of_larger.errors().nmse, in_standard_errors(gain, predicted_units_)};
}

}  // namespace furcula::diagnose
