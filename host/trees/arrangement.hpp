// Columns that may not be what they are named: joints that are swapped, that count the other way, or in another unit.
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

/// The one exchange of columns, of two joints, or change of sign or unit (degrees, millimetres, N mm), of one joint or of all, that makes
/// the model fit where it does not fit at all; nothing where it fits, or where no exchange helps by much.
std::optional<Arrangement> other_arrangement(const TreeModel& model, const std::vector<Recording>& recordings,
                                             unsigned threads);

}  // namespace furcula::trees
