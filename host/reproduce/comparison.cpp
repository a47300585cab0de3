#include "host/reproduce/comparison.hpp"

#include <cmath>

namespace furcula::reproduce {

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
    case Outcome::computed:
      break;
  }
  return "computed";
}

Row compare(Row row, Range accepted, const std::optional<Reason>& reason) {
  row.accepted = accepted;
  const bool explained = reason && reason->holds && std::isfinite(row.ours);
  row.outcome = accepted.has(row.ours) ? Outcome::met : explained ? Outcome::explained : Outcome::differs;
  if (row.outcome == Outcome::explained) row.remark = reason->text;
  return row;
}

Row compare_error(Row row, double printed, const std::optional<Reason>& reason) {
  row = compare(std::move(row), {0.5 * printed, 2.0 * printed}, reason);
  if (row.ours >= 0.0 && row.ours < 0.5 * printed) {
    row.outcome = Outcome::smaller;
    row.remark.clear();
  }
  return row;
}

}  // namespace furcula::reproduce
