// Proposes a map file for a log with other column names: columns by name, units by name and range, signs, zeros and further units by the
// trial of conventions (host/conventions/trial.hpp).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/model/model.hpp"
#include "host/trees/model.hpp"

namespace furcula::mapping {

enum class Sureness { sure, likely, guess };

/// A line of the map.
struct Line {
  std::string ours;
  log::MappedColumn column;
  Sureness sureness = Sureness::sure;
  std::vector<std::string> why;  ///< what says so
};

struct Proposal {
  std::string log, rig;
  std::vector<Line> lines;
  char separator = ',', decimal = '.';
  std::vector<std::string> expected;  ///< of ours that no column was found for
  std::vector<std::string> left;      ///< columns of the log that are not used
  std::vector<std::string> confirm;   ///< what a person must look at, in sentences
};

/// A tree as its model file says, with the columns that a log has.
using TreeReader = std::function<trees::TreeModel(const std::vector<std::string>& columns)>;

/// @throws core::DataError where the log cannot be read, or no column of it is time or the position of any joint: with the log's columns, and
/// what was expected.
Proposal propose(const std::string& log, const TreeReader& model);
Proposal propose(const std::string& log, const model::Model& model);

/// A map file, with a comment for each line: how sure it is, and why.
std::string map_text(const Proposal& proposal);

}  // namespace furcula::mapping
