// Columns that may stand for each other: joints that are swapped, or that count the other way.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/trees/recording.hpp"

namespace furcula::trees {

struct Arrangement {
  std::string what;  ///< "the torques of shoulder and elbow are swapped"
  /// What simulated windows are off at the joint where that is most, of its motion and squared: with the columns as they are, and so
  /// arranged; dry friction, damping and rotors of any size allowed for.
  double off_as_given = 0.0, off_arranged = 0.0;
};

/// The one exchange of columns, of two joints, or of one joint's sign, that makes the model fit where it does not fit at all; nothing
/// where it fits, or where no exchange helps by much.
std::optional<Arrangement> other_arrangement(const TreeModel& model, const std::vector<Recording>& recordings,
                                             unsigned threads);

}  // namespace furcula::trees
