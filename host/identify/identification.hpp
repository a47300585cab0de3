// Identification: parameters of a model from recordings, by both estimators of 002 section 4.2,
// cross-validated.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/identify/manoeuvres.hpp"
#include "host/identify/prediction.hpp"
#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::identify {

enum class Method { equation, simulation };

std::string_view name(Method m);

/// One free parameter.
struct Identified {
  std::string name, unit;
  double given = 0.0;  ///< in the model file
  double value = 0.0;
  double lower = 0.0, upper = 0.0;  ///< 95 % interval
  std::vector<double> folds;        ///< estimates with one fold left out
  std::string verdict;              ///< "identified", "correlated", "at_bound", "not_excited"
  std::string with;                 ///< correlated: the other parameter; at_bound: "lower" or "upper"
};

/// A quantity computed from the parameters.
struct Derived {
  std::string name, unit;
  double value = 0.0;
  std::vector<double> folds;
};

/// What one estimator found.
struct Estimation {
  Method method = Method::simulation;
  std::vector<Identified> parameters;
  std::vector<Derived> derived;
  std::vector<Errors> folds;       ///< errors on each fold's windows, of the estimate that has not seen it
  std::optional<Errors> held_out;  ///< on the held-out recordings, over prediction windows
  model::Model model;              ///< the model at the estimate
};

/// A window of the held-out (or else the training) recordings: measured, and predicted before and after.
struct FittedTrace {
  std::string log, channel, unit;
  std::vector<double> time_s, measured, as_given, identified;
};

struct Identification {
  dynamics::Kind kind{};
  std::vector<Estimation> estimations;  ///< the one that was asked for; of both, simulation first
  std::size_t logs = 0, windows = 0, samples = 0, held_out_logs = 0;
  std::size_t folds = 0;
  std::vector<std::string> training_files, held_out_files;
  std::vector<Excluded> excluded;  ///< of all recordings
  std::optional<Errors> as_given;  ///< held-out errors of the model as given
  std::string main_channel, main_unit;
  std::vector<FittedTrace> traces;
  log::DataQuality data_quality;
};

struct IdentifyOptions {
  bool by_equation = false;
  bool by_simulation = true;
  std::size_t folds = 0;  ///< 0: ten, or as many as there are recordings if fewer; of a single one five
  double window_s = 0.5;
  unsigned threads = 2;
  std::function<void(double, std::string_view)> progress;
  bool trust_columns = false;  ///< units, signs and zeros are not tried (host/conventions/trial.hpp)
};

/// Identifies the model's free parameters. On the hopper the windows are stances and flights, each alone (002
/// section 4.2), and, where a restitution is free, whole strides too; on the rail carriage flights; elsewhere
/// restart windows of `window_s`.
/// @throws core::DataError: no free parameter, no usable window, fewer recordings (of a single one: windows)
/// than folds.
Identification identify(const model::Model& model, const std::vector<log::Log>& training,
                        const std::vector<log::Log>& held_out, const IdentifyOptions& options = {});

}  // namespace furcula::identify
