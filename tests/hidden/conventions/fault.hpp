// A wrong convention in a log: a column in another unit, of another sign, with another zero or exchanged with another column, or a model in
// which gravity points elsewhere. And what a user should be told to write, from which an answer is judged.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/log/log.hpp"

namespace furcula::hidden::conventions {

/// What is done to one column: logged = scale x true + offset, perhaps whole numbers, perhaps of another column.
struct Change {
  double scale = 1.0, offset = 0.0;
  bool whole = false;
  std::string from{};  ///< the column whose values stand here
};

struct Fault {
  std::string name;                       ///< "degrees, all joints"
  std::string group;                      ///< "scale", "zero", "gravity", "sign", "exchange", "none"
  std::map<std::string, Change> changes;  ///< by column
  std::string model_from{}, model_to{};   ///< text of the model file that is replaced
  /// What must be written to undo it: the columns, of those that a map can name, and how far off a scale may be.
  std::map<std::string, Change> undone{};
  std::vector<std::string> words{};  ///< of which one stands in a message that lists it
};

/// The faults that this log can have. `gravities`: those of the model file, as text, and others to put in their place.
std::vector<Fault> faults_of(const log::Log& log, const std::string& model);

/// The log with the fault.
log::Log faulty(const log::Log& log, const Fault& fault);

}  // namespace furcula::hidden::conventions
