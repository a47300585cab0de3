#include "host/reproduce/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/report/html.hpp"

namespace furcula::reproduce {
namespace {

/// Of an error below half of the printed one.
std::string why_smaller(const Row& row, const std::vector<Counterfactual>& causes, double printed) {
  const auto figure = [&](const Counterfactual& c) {
    return report::number(c.value, 3) + (row.unit.empty() ? "" : " " + row.unit);
  };
  const auto guessed = [](const Counterfactual& c) {
    return c.guessed ? " How much of it the document's rig has is a conjecture." : "";
  };
  for (const Counterfactual& c : causes)
    if (c.value >= 0.5 * printed && c.value <= 2.0 * printed)
      return "Smaller by this cause: " + c.what + " it is " + figure(c) + "." + guessed(c);
  for (const Counterfactual& c : causes)
    if (c.value > 2.0 * printed)
      return "This cause is more than enough: " + c.what + " it is " + figure(c) + "." + guessed(c);
  const auto most = std::max_element(
      causes.begin(), causes.end(),
      [](const Counterfactual& a, const Counterfactual& b) { return !(a.value >= b.value); });
  if (most == causes.end()) return "Why it is smaller was not computed.";
  return "None of the causes that were switched on brings it to the printed one; the most is " +
         figure(*most) + ", " + most->what +
         ". That the document's rig has more of them, or others, is a conjecture.";
}

}  // namespace

const char* name(Outcome outcome) {
  switch (outcome) {
    case Outcome::met:
      return "met";
    case Outcome::smaller:
      return "smaller";
    case Outcome::explained:
      return "explained";
    case Outcome::differs:
      return "differs";
    case Outcome::by_construction:
      return "by construction";
    case Outcome::computed:
      break;
  }
  return "computed";
}

std::size_t count(const std::vector<Row>& rows, Outcome outcome) {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [&](const Row& r) { return r.outcome == outcome; }));
}

Row compare(Row row, Range accepted, const std::optional<Reason>& reason) {
  row.accepted = accepted;
  const bool explained = reason && reason->holds && std::isfinite(row.ours);
  row.outcome = accepted.has(row.ours) ? Outcome::met : explained ? Outcome::explained : Outcome::differs;
  if (row.outcome == Outcome::explained) {
    row.remark = reason->text;
    row.counterfactuals = reason->shown_by;
  }
  return row;
}

Row compare_error(Row row, double printed, const std::optional<Reason>& reason,
                  const std::vector<Counterfactual>& causes) {
  row = compare(std::move(row), {0.5 * printed, 2.0 * printed}, reason);
  if (row.ours >= 0.0 && row.ours < 0.5 * printed) {
    row.outcome = Outcome::smaller;
    row.remark = why_smaller(row, causes, printed);
    row.counterfactuals = causes;
  }
  return row;
}

Row put_in(Row row, Range accepted, std::string how) {
  row = compare(std::move(row), accepted);
  if (row.outcome == Outcome::met) row.outcome = Outcome::by_construction;
  row.remark = std::move(how);
  return row;
}

}  // namespace furcula::reproduce
