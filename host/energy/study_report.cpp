// What stands on the page of an energy study, from top to bottom.
#include "host/energy/study_report.hpp"

#include <utility>

#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
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
  report::LinePlot out{title, "contraction, cm", {}, true};
  const std::pair<const char*, std::optional<Settled> Point::*> robots[] = {
      {"spring caught", &Point::caught},
      {"spring released by the clutch", &Point::clutched},
      {"no spring", &Point::springless}};
  for (const auto& [label, robot] : robots) {
    report::Line line{label, {}, {}};
    for (const Point& p : s.points)
      if (p.*robot) {
        line.x.push_back(100.0 * p.contraction_m);
        line.y.push_back(value((p.*robot)->energy));
      }
    out.lines.push_back(std::move(line));
  }
  return report::line_plot_html(out);
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
