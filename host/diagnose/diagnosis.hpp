// What a diagnosis says: the figures, the findings and the traces that the JSON and the report are made from.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "host/diagnose/bootstrap.hpp"
#include "host/diagnose/remainder.hpp"
#include "host/diagnose/rule.hpp"
#include "host/identify/contact_switch.hpp"
#include "host/identify/manoeuvres.hpp"
#include "host/identify/prediction.hpp"
#include "host/model/model.hpp"
#include "host/result/diagnosis.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::diagnose {

using furcula::Verdict;
using result::Association;
using result::ResidualForce;
using result::Trace;

using identify::ChannelErrors;
using identify::Errors;

struct Estimate {
  double value = 0.0;
  double lower = 0.0;  ///< 95 % interval
  double upper = 0.0;
};

/// A set of effects or free parameters that competes with a finding.
struct Rival {
  std::vector<std::string> names;
  std::string why;                             ///< why not, or why it cannot be told apart
  std::map<std::string, Estimate> parameters;  ///< "effect.parameter" -> fitted value
  bool same_law = false;                       ///< under another name, whatever the recordings
};

struct Finding {
  dynamics::Effect effect;
  std::map<std::string, Estimate> parameters;  ///< names as on this kind of axis
  /// That it is judged on, where it does not move the body: "contact", "torque", "leg_angle"; else empty.
  std::string channel;
  double explainable_nmse_removed = 0.0;  ///< 1 = all that is above the noise floor
  double squares_removed = 0.0;           ///< of all that the held-out recordings leave without it
  double held_out_mae_before = 0.0;       ///< of the main channel, without the effect, all else re-fitted
  double held_out_mae_after = 0.0;
  // 95 % intervals over the held-out recordings (bootstrap.hpp), of the share and of the MAE's fall.
  std::optional<Interval> removed_interval, mae_gain_interval;
  bool helps = false;         ///< the held-out recordings are predicted better with it than without it
  bool contradicted = false;  ///< ... worse
  double confidence = 0.0;
  std::vector<std::string> lowered_by;  ///< what limits the confidence, in words
  /// encoder_slip: each jump of the training recordings; those that the held-out ones are seen to have, which
  /// nothing predicts.
  std::vector<result::Event> events, observed_events;
  bool undecided = false;  ///< another law explains the training recordings as well
  std::vector<Rival> alternatives;
  std::vector<Rival> indistinguishable_from;
  std::string explanation;
  std::string next_experiment;
};

/// One hypothesis that was tried: a row of the report's table.
struct Candidate {
  std::vector<std::string> effects;
  std::map<std::string, Estimate> parameters;  ///< "effect.parameter"
  double training_gain = 0.0;  ///< share of the cross-validated error removed on the training logs
  double held_out_gain = 0.0;  ///< share of the held-out error above the floor removed
  bool chosen = false;
  double weight = 0.0;  ///< share among the laws that were fitted (posterior.hpp)
  std::string outcome;  ///< "named", or in plain words why it lost
};

/// An experiment of the rig's library (next_experiment.hpp), and how well it separates the causes that the
/// recordings cannot tell apart.
struct Experiment {
  std::string what;        ///< in plain words
  sim::Scenario scenario;  ///< with ideal sensors
  /// Of one recording, for a truth against another cause re-fitted, in units of twice the log-likelihood
  /// ratio; of the two causes that it separates least.
  double evidence = 0.0;
  double apart = 0.0;  ///< those two's predictions then differ by so much, RMS, m or rad
  int recordings = 0;  ///< how many it takes at this noise to decide
};

struct Diagnosis : result::Summary {
  dynamics::Kind kind{};
  std::size_t hops = 0;
  std::size_t windows = 0,
              fitted_windows = 0;  ///< of the training recordings; those that the search was made on
  std::vector<identify::Excluded> excluded;  ///< of all recordings
  std::string main_channel;                  ///< "height", "position" or "angle"
  std::string main_unit;
  Errors baseline, refitted, extended, noise_floor;  ///< held-out; the floor has nmse alone
  std::vector<Finding> findings;
  std::vector<Candidate> candidates;
  /// Parameters of the model as given, re-fitted, extended; and which were free.
  std::vector<result::Parameter> parameters;
  /// Free parameters whose bounds keep the model from the recordings, with what they would be beyond them.
  struct BeyondBounds {
    std::string name, unit;
    double lower, upper;  ///< the bounds
    double value;
  };
  std::vector<BeyondBounds> beyond_bounds;
  double unexplained_fraction = 0.0;
  /// Of what could be explained on the held-out recordings, what no named cause explains; 0 without a
  /// finding, or where those do not help there.
  double unnamed_share = 0.0;
  double none_of_catalogue = 0.0;  ///< the share that no finding has, by the training recordings
  bool nothing_left = true;        ///< of the held-out error, but what comes at random or from the sensors
  identify::SwitchAgreement contact_switch;  ///< of all recordings, a hopper's
  /// What is new from row to row hangs on nothing before (whiteness.hpp); where that cannot be tested, as above.
  bool residual_white = true;
  /// Held-out windows that no figure is of, since they hold or follow a slip that nothing predicts.
  std::size_t windows_excluded = 0;
  std::optional<Remainder> remainder;  ///< of the extended model
  std::vector<Association> correlated_with;
  /// Where causes cannot be told apart: the experiments that would, the most telling first.
  std::vector<Experiment> experiments;
  model::Model refitted_model, extended_model;
  std::vector<Trace> traces;
  ResidualForce residual;
  Rules rules_that_acted;  ///< of the search: what would be named might be another without them
};

}  // namespace furcula::diagnose
