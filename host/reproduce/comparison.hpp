// What a document prints beside what is computed here, with the reason where the two differ.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace furcula::reproduce {

/// Met: inside what was printed. Explained: outside of it, for a reason that was computed and holds. Differs:
/// outside of it. Computed: the document prints a picture or nothing that a number can be held against.
enum class Outcome { met, explained, differs, computed };

const char* name(Outcome outcome);

struct Row {
  std::string where;      ///< "3.2.1, Fig. 3.4"
  std::string what;       ///< "apex, steady"
  std::string unit;       ///< "" of a plain number
  std::string published;  ///< as printed
  double ours = 0.0;
  Outcome outcome = Outcome::computed;
  std::string remark;  ///< the reason, or what the number means
};

struct Range {
  double low, high;
  bool has(double value) const { return value >= low && value <= high; }
};

/// Why a number may lie outside of its range: `holds` is what was computed to show it.
struct Reason {
  bool holds;
  std::string text;
};

/// A number against the range that the printed one allows for.
Row compare(std::string where, std::string what, std::string unit, std::string published, double ours,
            Range range, const std::optional<Reason>& reason = std::nullopt);

/// A number that nothing printed can be held against.
Row computed(std::string where, std::string what, std::string unit, std::string published, double ours,
             std::string remark = "");

}  // namespace furcula::reproduce
