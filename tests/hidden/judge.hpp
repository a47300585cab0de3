// Compares what the diagnosis said with what was planted.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/rule.hpp"
#include "tests/hidden/cases.hpp"

namespace furcula::hidden {

enum class Outcome {
  /// The planted effect, or the same law under its other name, and nothing else; of a pair: both.
  named,
  not_separated,  ///< another stands first, with the planted effect among those that it cannot be told from
  /// The planted law's simpler case stands alone, and what it leaves is below the sensor's resolution (judge.cpp).
  simpler_law,
  half_named,     ///< of a pair: one is named, and nothing else
  nothing_named,  ///< no finding
  honest,  ///< a cause outside of the catalogue: said to be unexplained or partly explained, or a name of 0.5 at most
  wrong_name,  ///< a law that is not planted, first or beside
};

struct ParameterError {
  std::string name;
  double expected = 0.0, found = 0.0, lower = 0.0, upper = 0.0;
  double neutral = 0.0;  ///< value at which there would be no effect
  bool main = true;      ///< the law's size; else what shapes it (a width, a phase, an instant)
  double relative() const;
  /// Of the planted difference from the neutral value: what a wrong rate is wrong by.
  double relative_of_difference() const;
  bool within_interval() const { return lower <= expected && expected <= upper; }
  /// Within 10 % of the planted value, or the value within the estimate's 95 % interval.
  bool acceptable() const { return relative() <= 0.10 || within_interval(); }
};

struct Judgement {
  Outcome outcome = Outcome::nothing_named;
  diagnose::Verdict verdict = diagnose::Verdict::adequate;
  std::string first;                       ///< effect that stands first; empty: none
  double confidence = 0.0;                 ///< of it
  bool first_right = false;                ///< it is a planted law, also in other words
  bool other_name = false;                 ///< named as the same law under its other name
  bool alike = false;                      ///< not_separated: and truly so, on these recordings
  std::vector<std::string> extra;          ///< findings beyond the planted laws
  std::vector<ParameterError> parameters;  ///< of the planted laws that were named
  /// Share of the held-out error above the noise floor that the extended model removes from the re-fitted
  /// one, on the main channel, from the diagnosis' own figures.
  double removed = 0.0;
  /// True if the re-fitted model's held-out error stands so far above the noise floor that `removed` means
  /// something: nearer to it, what the start states' noise does in these few windows decides the share.
  bool removed_is_told = false;
  /// The same share found independently: both models run in this folder's machine over what really happened
  /// in the held-out experiments, from true states, without a sensor's error. NaN if a law of the sensors is
  /// planted or found: there the body moves the same.
  double removed_truly = 0.0;
  double remaining_rms = 0.0;  ///< of the extended model in that calculation, m or rad
  diagnose::Rules acted;       ///< rules of the search that changed the chosen set
  std::string said;            ///< one line: verdict, findings with values, rivals, errors

  /// The right cause first, or in a group that truly is one; of a pair, both.
  bool right() const {
    return outcome == Outcome::named || outcome == Outcome::simpler_law ||
           (outcome == Outcome::not_separated && alike);
  }
};

/// The diagnosis of a case: it gets the model and the recordings, and nothing else.
diagnose::Diagnosis diagnosed(const Case& c, unsigned threads, const diagnose::WithoutRules& without = {});

Judgement judge(const Case& c, const diagnose::Diagnosis& d);

/// Whether each planted cause is there to be seen: what it does to the motion, in free runs over the held-out experiments, is at least twice
/// what the disturbance does (a small one's half of it), and two counts of the encoder. True where no run tells: laws of the sensors,
/// machines with a clutch.
bool shows(const Case& c);

/// At least 90 % of what can be explained is gone: in truth, and by the diagnosis' own figures where they
/// tell.
bool removes_enough(const Judgement& j);

std::string_view name(Outcome outcome);

}  // namespace furcula::hidden
