// What a document prints beside what is computed here, with the reason where the two differ.
#pragma once

#include <optional>
#include <string>

namespace furcula::reproduce {

/// Met: inside of what the printed figure allows. Smaller: an error below half of a printed one, of a rig
/// that is cleaner than the real one. Explained: outside, for a reason that was computed and holds. Differs:
/// outside. Computed: nothing is printed that a number of ours can be held against.
enum class Outcome { met, smaller, explained, differs, computed };

const char* name(Outcome outcome);

/// What a printed figure allows for, both ends included.
struct Range {
  double low, high;
  bool has(double value) const { return value >= low && value <= high; }
};

struct Row {
  std::string where;      ///< "3.2.1, Fig. 3.4"
  std::string what;       ///< "apex, steady"
  std::string unit;       ///< of `ours` and `accepted`; "" of a plain number
  std::string published;  ///< as printed
  double ours = 0.0;
  std::optional<Range> accepted = {};
  Outcome outcome = Outcome::computed;
  std::string remark = {};  ///< the reason, or what the number means
};

/// Why a number may lie outside of its range: `holds` is what was computed to show it.
struct Reason {
  bool holds;
  std::string text;
};

/// A number against the range that the printed one allows for.
Row compare(Row row, Range accepted, const std::optional<Reason>& reason = std::nullopt);

/// An error against a printed one of the same kind: met within a factor of two.
Row compare_error(Row row, double printed, const std::optional<Reason>& reason = std::nullopt);

}  // namespace furcula::reproduce
