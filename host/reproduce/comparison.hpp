// What a document prints beside what is computed here, with the reason where the two differ.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace furcula::reproduce {

/// Met: inside of what the printed figure allows. Smaller: an error below half of a printed one, of a rig
/// that is cleaner than the real one. Explained: outside, for a reason that was computed and holds. Differs:
/// outside. Computed: nothing is printed that a number of ours can be held against. By construction: inside,
/// but it was put in, was chosen to come out so, or follows by arithmetic from what was: no result.
enum class Outcome { met, smaller, explained, differs, computed, by_construction };

const char* name(Outcome outcome);

/// What a printed figure allows for, both ends included.
struct Range {
  double low, high;
  bool has(double value) const { return value >= low && value <= high; }
};

/// What a row's number is where one cause is another.
struct Counterfactual {
  std::string what;  ///< "with weightless links"
  double value;      ///< in the row's unit, unless `unit` says another
  std::string unit = {};
  bool guessed = false;  ///< how much of the cause there is was not measured
};

struct Row {
  std::string where;      ///< "3.2.1, Fig. 3.4"
  std::string what;       ///< "apex, steady"
  std::string unit;       ///< of `ours` and `accepted`; "" of a plain number
  std::string published;  ///< as printed
  double ours = 0.0;
  std::optional<Range> accepted = {};
  Outcome outcome = Outcome::computed;
  std::string remark = {};                           ///< the reason, or what the number means
  std::vector<Counterfactual> counterfactuals = {};  ///< what shows the reason
};

/// Why a number may lie outside of its range: `holds` is what was computed to show it, `shown_by` its
/// figures, which the text has too.
struct Reason {
  bool holds;
  std::string text;
  std::vector<Counterfactual> shown_by = {};
};

std::size_t count(const std::vector<Row>& rows, Outcome outcome);

/// A number against the range that the printed one allows for.
Row compare(Row row, Range accepted, const std::optional<Reason>& reason = std::nullopt);

/// An error against a printed one of the same kind: met within a factor of two. `causes`: what the error is
/// where one of them is switched on; a smaller error is put down to the first with which it is met, or else is larger than that.
Row compare_error(Row row, double printed, const std::optional<Reason>& reason = std::nullopt,
                  const std::vector<Counterfactual>& causes = {});

/// A number that was put in, against the range that the printed one allows for.
Row put_in(Row row, Range accepted, std::string how);

}  // namespace furcula::reproduce
