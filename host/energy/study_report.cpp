// What stands on the page of an energy study, from top to bottom.
#include "host/energy/study_report.hpp"

#include <algorithm>
#include <cmath>

#include "host/report/html.hpp"
#include "host/report/page.hpp"

namespace furcula::energy {
namespace {

using report::number;
using report::Table;

std::string centimetres(const std::optional<double>& length_m) {
  return length_m ? number(100.0 * *length_m, 3) + "&#8239;<small>cm</small>" : "nowhere";
}

/// With copper losses.
std::string joules(const std::optional<Settled>& robot) {
  return robot ? number(cost_j(robot->energy, Measure::electrical), 3) + " J" : "nothing";
}

/// A line over the contraction for each robot.
std::string plot(const Study& s, const std::string& title, double (*value)(const HopEnergy&)) {
  constexpr double kWidth = 640, kHeight = 260, kLeft = 56, kBottom = 34, kTop = 12, kRight = 20;
  double most = 0.0;
  for (const Point& p : s.points)
    for (const auto* robot : {&p.caught, &p.clutched, &p.springless})
      if (*robot) most = std::max(most, value((*robot)->energy));
  if (!(most > 0.0) || s.points.size() < 2) return "";
  const double widest = s.points.back().contraction_m;
  const auto x = [&](double m) { return kLeft + (kWidth - kLeft - kRight) * m / widest; };
  const auto y = [&](double v) { return kHeight - kBottom - (kHeight - kBottom - kTop) * v / most; };
  std::string out = "<figure><svg viewBox=\"0 0 640 260\" width=\"640\" role=\"img\" aria-label=\"" +
                    report::escape(title) + "\" style=\"max-width:100%\">\n";
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const std::string at = number(y(share * most), 5);
    out += "<line x1=\"56\" x2=\"620\" y1=\"" + at + "\" y2=\"" + at +
           "\" stroke=\"currentColor\" opacity=\"0.15\"/><text x=\"50\" y=\"" + at +
           "\" text-anchor=\"end\" dominant-baseline=\"middle\" font-size=\"12\" fill=\"currentColor\">" +
           number(share * most, 3) + "</text>\n";
    out += "<text x=\"" + number(x(share * widest), 5) +
           "\" y=\"246\" text-anchor=\"middle\" font-size=\"12\" fill=\"currentColor\">" +
           number(100.0 * share * widest, 3) + "</text>\n";
  }
  const auto line = [&](std::optional<Settled> Point::*robot, const char* colour) {
    std::string points;
    for (const Point& p : s.points)
      if (p.*robot)
        points += number(x(p.contraction_m), 5) + "," + number(y(value((p.*robot)->energy)), 5) + " ";
    out += "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + std::string(colour) + "\" points=\"" +
           points + "\"/>\n";
  };
  line(&Point::caught, "#b45309");
  line(&Point::clutched, "#047857");
  line(&Point::springless, "#4f46e5");
  return out + "</svg><figcaption>" + report::escape(title) +
         ", over the contraction in cm. <span style=\"color:#b45309\">Spring caught</span>, <span "
         "style=\"color:#047857\">spring released by the clutch</span>, <span style=\"color:#4f46e5\">no "
         "spring</span>.</figcaption></figure>\n";
}

std::string where_it_goes(const Study& s) {
  struct Column {
    const char* name;
    const std::optional<Settled>& robot;
  };
  const Point &first = s.points.front(), &last = s.points.back();
  const Column all[] = {{"caught", first.caught},
                        {"no spring", first.springless},
                        {"caught, folded", last.caught},
                        {"released, folded", last.clutched},
                        {"no spring, folded", last.springless}};
  if (std::none_of(std::begin(all), std::end(all), [](const Column& c) { return c.robot.has_value(); }))
    return "";
  std::vector<Table::Column> head{{"J a hop"}};
  for (const Column& c : all) head.push_back({c.name, true});
  Table table(head);
  const auto row = [&](const char* what, double HopEnergy::*member) {
    std::vector<std::string> cells{what};
    for (const Column& c : all) cells.push_back(c.robot ? number(c.robot->energy.*member, 3) : "&ndash;");
    table.add(cells);
  };
  row("Motor, mechanical, given", &HopEnergy::motor_pushed);
  row("Motor, mechanical, net", &HopEnergy::motor_work);
  row("Motor, copper", &HopEnergy::motor_copper);
  row("Coil, from the supply", &HopEnergy::coil);
  row("Lost in the guide", &HopEnergy::guide_damping);
  row("Lost in the leg's damping", &HopEnergy::leg_damping);
  row("Lost at touch-down", &HopEnergy::touchdown);
  row("Lost on the leg's stop", &HopEnergy::stop);
  row("Lost at lift-off", &HopEnergy::liftoff);
  row("Clutch, friction", &HopEnergy::clutch_friction);
  row("Clutch, impacts", &HopEnergy::clutch_impacts);
  row("Clutch, coil's heat", &HopEnergy::coil_heat);
  row("Peak torque in flight, N m", &HopEnergy::peak_torque_flight_nm);
  row("Peak torque in stance, N m", &HopEnergy::peak_torque_stance_nm);
  return table.html();
}

std::string break_even(const Study& s) {
  Table table({{"Changed"}, {"Mechanical", true}, {"With copper losses", true}});
  table.add({"nothing", centimetres(s.mechanical_m), centimetres(s.electrical_m)}, true);
  for (const Variant& v : s.variants)
    table.add({report::escape(v.what), centimetres(v.mechanical_m), centimetres(v.electrical_m)});
  return table.html();
}

}  // namespace

std::string render_energy_report(const Study& s, const std::string& command) {
  report::Page page;
  page.title = "Energy a hop";
  page.command = command;
  page.body_html =
      "<header>\n<p class=\"eyebrow\">Energy a hop, at an apex of " + number(100.0 * s.options.apex_m) +
      " cm</p>\n<h1>" +
      (s.mechanical_m ? "The clutch costs less than a caught spring from a contraction of " +
                            number(100.0 * *s.mechanical_m, 3) + " cm on."
                      : std::string("The clutch costs more than a caught spring at every contraction.")) +
      "</h1>\n</header>\n" +
      report::key_figures(
          {{"Break-even, mechanical", centimetres(s.mechanical_m), "motor's positive work and coil"},
           {"Break-even, electrical", centimetres(s.electrical_m), "copper losses of the motor too"},
           {"Break-even, as published", centimetres(s.published.break_even_m),
            "k A² / 2 against " + number(s.published.coil_j) +
                " J of a coil at full power for the whole flight"},
           {"The clutch's mass", number(s.published.mass_j, 3) + "&#8239;<small>J</small>",
            number(s.options.clutch_mass_kg) + " kg more, a hop"},
           {"Without a spring", joules(s.points.front().springless),
            "electrical, not folded; with it " + joules(s.points.front().caught)}}) +
      report::section("mechanical", "Motor's work and coil",
                      plot(s, "J a hop", [](const HopEnergy& e) { return cost_j(e, Measure::mechanical); })) +
      report::section("electrical", "With the motor's copper losses",
                      plot(s, "J a hop", [](const HopEnergy& e) { return cost_j(e, Measure::electrical); })) +
      report::section("torque", "Peak torque in flight",
                      plot(s, "N m", [](const HopEnergy& e) { return e.peak_torque_flight_nm; })) +
      report::section("stance", "Peak torque in stance",
                      plot(s, "N m", [](const HopEnergy& e) { return e.peak_torque_stance_nm; })) +
      report::section("where", "Where it goes, without a contraction and at the largest", where_it_goes(s)) +
      report::section("variants", "What moves the break-even", break_even(s));
  return report::render(page);
}

}  // namespace furcula::energy
