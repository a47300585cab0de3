#include "host/reproduce/rows.hpp"

#include <cmath>

#include "host/report/html.hpp"
#include "host/report/page.hpp"

namespace furcula::reproduce {
namespace {

report::Tone tone(Outcome o) {
  switch (o) {
    case Outcome::met:
    case Outcome::smaller:
      return report::Tone::good;
    case Outcome::explained:
      return report::Tone::notice;
    case Outcome::differs:
      return report::Tone::bad;
    case Outcome::computed:
    case Outcome::by_construction:
      break;
  }
  return report::Tone::neutral;
}

}  // namespace

nlohmann::ordered_json json_of(const Row& row) {
  using Json = nlohmann::ordered_json;
  return {{"where", row.where},
          {"what", row.what},
          {"unit", row.unit},
          {"published", row.published},
          {"ours", row.ours},
          {"accepted", row.accepted ? Json{row.accepted->low, row.accepted->high} : Json(nullptr)},
          {"outcome", name(row.outcome)},
          {"remark", row.remark}};
}

std::string rows_html(const std::vector<Row>& rows) {
  using report::number;
  if (rows.empty()) return {};
  report::Table t({{"Where"}, {"What"}, {"Printed"}, {"Accepted"}, {"Here", true}, {""}, {"Remark"}});
  for (const Row& row : rows)
    t.add({report::escape(row.where), report::escape(row.what), report::escape(row.published),
           row.accepted ? number(row.accepted->low, 3) + " to " + number(row.accepted->high, 3) : "",
           std::isfinite(row.ours)
               ? number(row.ours, 4) +
                     (row.unit.empty() ? "" : "&#8239;<small>" + report::escape(row.unit) + "</small>")
               : "none",
           report::badge(name(row.outcome), tone(row.outcome)), report::escape(row.remark)},
          row.outcome == Outcome::differs);
  return t.html();
}

}  // namespace furcula::reproduce
