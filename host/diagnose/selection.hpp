// Which effects the data ask for: nested extensions of the model, each fitted with the model's free
// parameters moving, compared on the training recordings alone.
#pragma once

#include <functional>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "host/diagnose/rule.hpp"
#include "host/diagnose/trainer.hpp"

namespace furcula::diagnose {

inline constexpr std::size_t kMostEffects = 4;
/// Two sets whose evidence differs by less than this explain the data equally well (odds of about 20 to 1).
inline constexpr double kEqualEvidence = 6.0;
/// Of squares: less is no reason for a parameter more.
inline constexpr double kSmallestLoss = 0.04;
/// Ten times as likely: twice the logarithm of the odds.
inline constexpr double kTenTimes = 2.0 * std::numbers::ln10;

/// One row of the diagnosis' table.
struct Tried {
  Hypothesis hypothesis;
  std::size_t round = 0;  ///< 0: alone on top of the re-fitted model
  Comparison against_smaller;
};

struct Selection {
  Hypothesis refitted;  ///< no effect added
  /// The same with wider bounds, where the bounds of free parameters hold it back and that explains the
  /// training recordings as well as `chosen`, or better.
  std::optional<Hypothesis> beyond_bounds;
  Hypothesis chosen;
  std::vector<Tried> tried;
  /// Sets that explain the training data as well as `chosen` with as many parameters, by the member that they
  /// replace.
  struct Rival {
    dynamics::Effect of;
    Hypothesis hypothesis;
  };
  std::vector<Rival> equals;
  /// For each chosen effect, the chosen set without it, re-fitted; in the order of chosen.effects.
  std::vector<Hypothesis> without;
  /// All sets that were fitted but those in which an effect lies on a limit or is not told from none; the chosen one first.
  std::vector<Weighed> pool;
  Rules acted;  ///< that put another set in the place of the chosen one
};

/// How far it is (0 to 1), and what is being tried.
using Progress = std::function<void(double, std::string_view)>;

/// Forward selection with backward elimination, then the search for equals.
Selection select(const model::Model& model, const std::vector<identify::Recording>& recordings,
                 const identify::TrainingWindows& training, unsigned threads, const Progress& progress,
                 const WithoutRules& without = {});

}  // namespace furcula::diagnose
