#include "host/gait/study_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
#include "host/report/page.hpp"

namespace furcula::gait {
namespace {

using report::Line;
using report::number;
using report::Table;

constexpr const char* kNone = "&ndash;";

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }
std::string where(const StudyRow& row) {
  return row.speed_mps ? number(*row.speed_mps, 3) + " m/s" : "in place";
}
std::string spring_words(LegSpring spring) {
  return spring == LegSpring::switched   ? "switched spring"
         : spring == LegSpring::parallel ? "parallel spring"
                                         : "no spring";
}
std::string cost_of(const StudyRow& row) {
  if (!row.cost) return kNone;
  return number(*row.cost, 4) + (row.speed_mps ? "" : "&#8239;<small>J</small>");
}

/// A line for each place where the rows' gaits run; points without a figure are left out.
template <class X, class Y>
std::vector<Line> lines_by_place(const std::vector<StudyRow>& rows, const X& x, const Y& y) {
  std::vector<Line> out;
  for (const StudyRow& r : rows) {
    const std::string name = where(r);
    auto line = std::find_if(out.begin(), out.end(), [&](const Line& l) { return l.label == name; });
    if (line == out.end()) line = out.insert(out.end(), {name, {}, {}});
    line->x.push_back(x(r));
    line->y.push_back(y(r));
  }
  return out;
}

double left(const StudyRow& r) { return r.share ? 100.0 * *r.share : std::nan(""); }

std::string clutch_html(const std::vector<StudyRow>& rows) {
  std::vector<StudyRow> late, teeth;
  Table table({{"Where"},
               {"Spring"},
               {"Catch delay, ms", true},
               {"Tooth, mm", true},
               {"Lost at the knee, degrees", true},
               {"Cost, J or of transport", true},
               {"Advantage left", true}});
  for (const StudyRow& r : rows) {
    table.add({where(r), spring_words(r.spring), number(1e3 * r.catch_delay_s, 3), number(1e3 * r.tooth_m, 3),
               number(degrees(r.lost_rad), 3), cost_of(r),
               r.share ? number(left(r), 3) + " %" : std::string(kNone)});
    if (r.spring != LegSpring::switched) continue;
    if (r.tooth_m == 0.0 && r.lost_rad == 0.0) late.push_back(r);
    if (r.catch_delay_s == 0.0) teeth.push_back(r);
  }
  const auto over = [](const char* title, const char* axis, std::vector<Line> lines) {
    return report::line_plot_html({title, axis, std::move(lines)});
  };
  return report::section(
             "left", "What is left of the switch's advantage",
             report::paragraph(
                 "100 % is what the ideal switch saves against the parallel spring; at 0 % the two cost the same.") +
                 over("Advantage left, %", "catch delay, ms",
                      lines_by_place(
                          late, [](const StudyRow& r) { return 1e3 * r.catch_delay_s; }, left)) +
                 over("Advantage left, %", "lost at the knee until the tooth holds, degrees",
                      lines_by_place(
                          teeth, [](const StudyRow& r) { return degrees(r.lost_rad); }, left))) +
         report::section("table", "Each gait", table.html());
}

std::string ground_html(const std::vector<StudyRow>& rows) {
  // Least friction last; without a limit first.
  const auto friction_of = [](const StudyRow& r) { return r.friction.value_or(1e9); };
  std::set<double, std::greater<>> frictions;
  std::set<double> speeds;
  for (const StudyRow& r : rows) {
    frictions.insert(friction_of(r));
    speeds.insert(r.speed_mps.value_or(0.0));
  }
  const auto name = [](double friction) {
    return friction >= 1e9 ? std::string("any") : number(friction, 3);
  };
  std::string out;
  std::vector<Line> least;
  for (const LegSpring spring : {LegSpring::switched, LegSpring::parallel, LegSpring::none}) {
    std::vector<Table::Column> columns{{"Speed, m/s", true}};
    for (const double f : frictions)
      columns.push_back({f >= 1e9 ? "any friction" : "friction " + name(f), true});
    Table table(columns);
    std::vector<Line> lines;
    for (const double f : frictions) lines.push_back({"friction " + name(f), {}, {}});
    Line edge{spring_words(spring), {}, {}};
    bool any = false;
    for (const double speed : speeds) {
      std::vector<std::string> cells{number(speed, 3)};
      double lowest = std::nan("");
      std::size_t column = 0;
      for (const double f : frictions) {
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const StudyRow& r) {
          return r.spring == spring && r.speed_mps.value_or(0.0) == speed && friction_of(r) == f;
        });
        const bool found = row != rows.end() && row->cost;
        any = any || row != rows.end();
        cells.push_back(found ? number(*row->cost, 3) : kNone);
        lines[column].x.push_back(speed);
        lines[column++].y.push_back(found ? *row->cost : std::nan(""));
        if (found && f < 1e9) lowest = f;
      }
      table.add(cells);
      edge.x.push_back(speed);
      edge.y.push_back(lowest);
    }
    if (!any) continue;
    least.push_back(edge);
    const std::string id = dynamics::kLegSpringNames[static_cast<std::size_t>(spring)].data();
    std::string heading = spring_words(spring);
    heading[0] = static_cast<char>(heading[0] - 'a' + 'A');
    out += report::section(id, heading,
                           table.html() + report::line_plot_html({"Cost of transport", "speed, m/s", lines}));
  }
  return report::section("map", "Where each leg can run",
                         report::paragraph(
                             "The least friction of those tried on which a gait was found, over the speed.") +
                             report::line_plot_html({"Least friction", "speed, m/s", least, true})) +
         out +
         report::paragraph(
             "Figures are costs of transport. A dash: no gait was found on that ground at that speed; study.json names the limiting constraint.");
}

std::string rest_html(const std::vector<StudyRow>& rows, double print_rad) {
  std::map<double, const StudyRow*> best, of_print;
  for (const StudyRow& r : rows) {
    if (!r.cost) continue;
    const double speed = r.speed_mps.value_or(0.0);
    const StudyRow*& b = best[speed];
    if (b == nullptr || *r.cost < *b->cost) b = &r;
    if (std::abs(r.rest_rad - print_rad) < 1e-9) of_print[speed] = &r;
  }
  Table table({{"Where"},
               {"Best rest angle, degrees", true},
               {"Cost, J or of transport", true},
               {"With the model's own angle", true},
               {"Saved", true}});
  for (const auto& [speed, b] : best) {
    const StudyRow* p = of_print[speed];
    table.add({where(*b), number(degrees(b->rest_rad), 3), cost_of(*b), p ? cost_of(*p) : kNone,
               p ? number(100.0 * (1.0 - *b->cost / *p->cost), 3) + " %" : kNone});
  }
  std::vector<StudyRow> sorted = rows;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const StudyRow& a, const StudyRow& b) { return a.rest_rad < b.rest_rad; });
  // Over the best one of its place: places differ by more than angles do.
  std::vector<Line> lines = lines_by_place(
      sorted, [](const StudyRow& r) { return degrees(r.rest_rad); },
      [&](const StudyRow& r) {
        return r.cost ? *r.cost / *best[r.speed_mps.value_or(0.0)]->cost : std::nan("");
      });
  std::vector<Table::Column> columns{{"Rest angle, degrees", true}};
  for (const auto& [speed, b] : best) columns.push_back({where(*b), true});
  Table each(columns);
  for (auto row = sorted.begin(); row != sorted.end();) {
    const double angle = row->rest_rad;
    std::map<double, std::string> costs;
    for (; row != sorted.end() && std::abs(row->rest_rad - angle) < 1e-9; ++row)
      costs[row->speed_mps.value_or(0.0)] = cost_of(*row);
    std::vector<std::string> cells{number(degrees(angle), 3)};
    for (const auto& [speed, b] : best) cells.push_back(costs.contains(speed) ? costs[speed] : kNone);
    each.add(cells);
  }
  return report::section(
             "best", "The best rest angle",
             table.html() + report::line_plot_html({"Cost over that of the best angle",
                                                    "rest angle of the parallel spring, degrees", lines})) +
         report::section(
             "table", "Each gait",
             each.html() +
                 report::paragraph(
                     "Joules a stride in place, else costs of transport. A dash: no gait was found."));
}

}  // namespace

std::string render_study_report(const std::vector<StudyRow>& rows, const StudyOptions& options,
                                const std::string& command) {
  const auto found =
      std::count_if(rows.begin(), rows.end(), [](const StudyRow& r) { return r.cost.has_value(); });
  const char* title = options.kind == StudyKind::clutch   ? "A real clutch in place of the ideal switch"
                      : options.kind == StudyKind::ground ? "Speed and friction of the ground"
                                                          : "The rest angle of a parallel spring";
  report::Page page;
  page.title = "Study of gaits";
  page.command = command;
  page.body_html =
      "<header>\n<p class=\"eyebrow\">Study of a planar leg's gaits</p>\n<h1>" + std::string(title) +
      "</h1>\n<p class=\"lead\">" + std::to_string(found) + " of " + std::to_string(rows.size()) +
      " gaits were found, each the cheapest of free torques from two starts or from its neighbour.</p>\n</header>\n" +
      (options.kind == StudyKind::clutch   ? clutch_html(rows)
       : options.kind == StudyKind::ground ? ground_html(rows)
                                           : rest_html(rows, options.rest_rad));
  return report::render(page);
}

}  // namespace furcula::gait
