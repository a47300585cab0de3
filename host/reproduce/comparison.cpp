#include "host/reproduce/comparison.hpp"

#include <cmath>
#include <utility>

namespace furcula::reproduce {

const char* name(Outcome outcome) {
  switch (outcome) {
    case Outcome::met:
      return "met";
    case Outcome::explained:
      return "explained";
    case Outcome::differs:
      return "differs";
    case Outcome::computed:
      break;
  }
  return "computed";
}

Row compare(std::string where, std::string what, std::string unit, std::string published, double ours,
            Range range, const std::optional<Reason>& reason) {
  Row row{std::move(where), std::move(what), std::move(unit), std::move(published), ours, {}, ""};
  const bool explained = reason && reason->holds && std::isfinite(ours);
  row.outcome = range.has(ours) ? Outcome::met : explained ? Outcome::explained : Outcome::differs;
  if (row.outcome == Outcome::explained) row.remark = reason->text;
  return row;
}

Row computed(std::string where, std::string what, std::string unit, std::string published, double ours,
             std::string remark) {
  return {std::move(where),  std::move(what),  std::move(unit), std::move(published), ours,
          Outcome::computed, std::move(remark)};
}

}  // namespace furcula::reproduce
