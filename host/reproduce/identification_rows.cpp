#include "host/reproduce/identification_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "host/core/quantile.hpp"
#include "host/report/html.hpp"

namespace furcula::reproduce {
namespace {

using core::median;
using report::number;

using Errors = std::vector<TrajectoryErrors>;
using Member = double TrajectoryErrors::*;
using E = TrajectoryErrors;
using Phase = Estimates IdentificationStudy::*;
using Statistic = double (*)(const Errors&, Member);

std::vector<double> values_of(const Errors& errors, Member member) {
  std::vector<double> all;
  for (const E& e : errors) all.push_back(e.*member);
  return all;
}
double mean_of(const Errors& errors, Member member) {
  double sum = 0.0;
  for (const E& e : errors) sum += e.*member;
  return sum / static_cast<double>(errors.size());
}
double worst_of(const Errors& errors, Member member) {
  return core::quantile(values_of(errors, member), 1.0);
}
double median_of(const Errors& errors, Member member) { return median(values_of(errors, member)); }
/// Mean of NMSE(z) + NMSE(z'), what eq. 4.5 sums.
double cost_of(const Errors& errors) {
  return mean_of(errors, &E::nmse_height) + mean_of(errors, &E::nmse_velocity);
}

std::size_t poorest_of(const Errors& errors) {
  const auto poorer = [](const E& a, const E& b) { return a.nmse_height < b.nmse_height; };
  return static_cast<std::size_t>(std::max_element(errors.begin(), errors.end(), poorer) - errors.begin());
}

/// How many lie more than 1.5 interquartile ranges above the upper quartile, as a box plot draws them.
double outliers(const std::vector<double>& values) {
  const double low = core::quantile(values, 0.25), high = core::quantile(values, 0.75);
  return static_cast<double>(
      std::count_if(values.begin(), values.end(), [&](double v) { return v > high + 1.5 * (high - low); }));
}

std::string with_unit(double value, const char* unit, int digits = 3) {
  return number(value, digits) + (*unit != '\0' ? " " + std::string(unit) : "");
}

std::string as_printed(double value, const char* unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%g %s", value, unit);
  return text;
}

double friction_n(const IdentificationStudy& s) {
  return s.rig.truth.effects.at(dynamics::Effect::coulomb_friction)[0];
}

/// The two studies that all rows are made of.
struct Studies {
  const IdentificationStudy& s;
  const SwitchedStudies& switched;

  /// What an error of a phase is with each cause that may enlarge it.
  std::vector<Counterfactual> causes(Phase phase, Member member, double scale, Statistic statistic) const {
    std::vector<Counterfactual> all;
    for (const OtherJudging& other : (s.*phase).otherwise)
      all.push_back({other.what, scale * statistic(other.errors, member)});
    const auto switched_on = [&](std::string what, const Errors& errors) {
      all.push_back({std::move(what), scale * statistic(errors, member), {}, true});
    };
    switched_on("with " + number(kStickyGuideN, 2) + " N of dry friction in the guide in place of " +
                    number(friction_n(s), 2) + " N",
                (switched.sticky_guide.*phase).errors);
    switched_on("with impacts that ring in the height by " + number(1e3 * kRinging.amplitude_m, 2) +
                    " mm at " + number(kRinging.frequency_hz, 2) + " Hz",
                (switched.ringing.*phase).errors);
    switched_on("with all of these at once", (switched.both.*phase).otherwise.back().errors);
    return all;
  }

  /// The document shows two trajectories of each phase, a good and a poor one: our median stands beside the
  /// first, our poorest beside the second.
  struct Examples {
    const char* where;
    const char* name;
    Phase phase;
    Member member;
    const char* what;
    const char* unit;
    double scale;       ///< to the unit
    double good, poor;  ///< printed
  };
  void add(std::vector<Row>& rows, const Examples& e,
           const std::optional<Reason>& poor_reason = std::nullopt) const {
    const std::string what = std::string(e.name) + ": " + e.what;
    const Errors& errors = (s.*e.phase).errors;
    rows.push_back(compare_error({e.where, what + ", a good one; median", e.unit, as_printed(e.good, e.unit),
                                  e.scale * median_of(errors, e.member)},
                                 e.good, {}, causes(e.phase, e.member, e.scale, median_of)));
    rows.push_back(compare_error({e.where, what + ", a poor one; poorest", e.unit, as_printed(e.poor, e.unit),
                                  e.scale * worst_of(errors, e.member)},
                                 e.poor, poor_reason, causes(e.phase, e.member, e.scale, worst_of)));
  }
};

/// A reason whose figures are the same error of another study.
Reason other_study(bool holds, const std::string& text, const std::string& what, double value,
                   const char* unit) {
  return {holds, text + " " + what + " it is " + with_unit(value, unit) + ".", {{what, value}}};
}

void stance_errors(const Studies& all, std::vector<Row>& rows) {
  const Errors& errors = all.s.stance.errors;
  constexpr Phase kStance = &IdentificationStudy::stance;
  rows.push_back(compare_error({"6.1.1, Fig. 4.11", "stance: height, mean absolute error, mean of 60", "mm",
                                "2 mm", 1e3 * mean_of(errors, &E::mae_height_m)},
                               2.0, {}, all.causes(kStance, &E::mae_height_m, 1e3, mean_of)));
  rows.push_back(compare({"6.1.1", "stance: largest deviation of any", "mm", "not above 7 mm",
                          1e3 * worst_of(errors, &E::worst_height_m)},
                         {0.0, 7.0}));
  rows.push_back({"6.1.1", "stance: outliers of 60, by 1.5 interquartile ranges", "", "5",
                  outliers(values_of(errors, &E::mae_height_m))});
  all.add(rows, {"Fig. 4.12", "stance", kStance, &E::nmse_height, "NMSE of height", "%", 100.0, 0.6, 6.8});
  all.add(rows, {"Fig. 4.12", "stance", kStance, &E::mae_height_m, "height, MAE", "mm", 1e3, 1.5, 4.8});
  all.add(rows,
          {"Fig. 4.12", "stance", kStance, &E::nmse_velocity, "NMSE of velocity", "%", 100.0, 1.9, 2.6});
  all.add(rows,
          {"Fig. 4.12", "stance", kStance, &E::mae_velocity_mps, "velocity, MAE", "mm/s", 1e3, 53.6, 54.6});
}

/// The two estimators, with a velocity without delay and with the rig's own.
void estimators(const Studies& all, std::vector<Row>& rows) {
  const IdentificationStudy& s = all.s;
  const double damping = s.stance.value("damping_stance_nspm"), cost = cost_of(s.stance.errors);
  const auto frequency = [&](const Estimates& e) {
    return damped_frequency_radps(e.value("mass_kg"), s.rig.stiffness_npm, e.value("damping_stance_nspm"));
  };
  const auto off = [&](double damping_nspm) { return 100.0 * std::abs(damping_nspm / damping - 1.0); };
  const Estimates &smooth = s.stance_by_equation, &raw = s.stance_by_equation_raw;
  const double gain = cost / cost_of(smooth.errors), raw_gain = cost / cost_of(raw.errors);
  const double smooth_off = off(smooth.value("damping_stance_nspm")),
               raw_off = off(raw.value("damping_stance_nspm"));

  // The smooth velocity made late: what the delay alone does.
  std::vector<Counterfactual> late_gain, late_off;
  std::string at_once;
  for (const auto& d : s.equation_by_delay) {
    const double late_cost = cost / d.nmse, deviation = off(d.damping_nspm);
    const std::string late = number(1e3 * d.delay_s, 2) + " ms late";
    late_gain.push_back({"with a smooth velocity made " + late, late_cost});
    late_off.push_back({"with a smooth velocity made " + late, deviation, "%"});
    if (at_once.empty() && deviation >= 5.0 && late_cost >= 0.5 && late_cost <= 1.0)
      at_once = "With a smooth velocity made " + late + " the damping deviates by " + number(deviation, 2) +
                " % at a cost ratio of " + number(late_cost, 2) + ", which are both claims at once.";
  }
  const bool any_late_one = !at_once.empty();
  if (at_once.empty() && !late_off.empty())
    at_once = "A smooth velocity does not show both claims at once however late; " + late_off.back().what +
              " the damping deviates by " + number(late_off.back().value, 2) + " % at a cost ratio of " +
              number(late_gain.back().value, 2) + ".";
  rows.push_back(compare(
      {"6.1.1", "cost, simulation over equation error, velocity without delay", "", "slightly better", gain},
      {0.5, 1.0},
      Reason{any_late_one && gain < 1.25,
             "By a velocity without any delay the two are level. " + at_once +
                 " How late the document's is, is not printed.",
             late_gain}));
  rows.push_back(
      compare({"6.1.1", "the same, the rig's own velocity", "", "slightly better", raw_gain}, {0.5, 1.0},
              Reason{!late_gain.empty() && late_gain.back().value < gain && raw_gain < gain,
                     "The rig's velocity, differences of counts, is " + number(1e3 * s.recorded_delay_s, 2) +
                         " ms late; one-step prediction takes the delay for damping. " + at_once,
                     late_gain}));
  rows.push_back(compare(
      {"6.1.1, Fig. 4.9", "damping, equation against simulation error, velocity without delay", "%",
       "significant deviation", smooth_off},
      {5.0, 100.0},
      Reason{
          raw_off > 5.0 * smooth_off && !late_off.empty() && late_off.back().value > 5.0 * smooth_off,
          "With a velocity that is neither late nor noisy the two agree; with the rig's own they differ by " +
              number(raw_off, 2) + " %. " + at_once,
          late_off}));
  rows.push_back(
      compare({"6.1.1, Fig. 4.9", "the same, the rig's own velocity", "%", "significant deviation", raw_off},
              {5.0, 100.0}));
  for (const auto& [e, which] :
       {std::pair{&smooth, "velocity without delay"}, std::pair{&raw, "the rig's own velocity"}})
    rows.push_back(compare(
        {"6.1.1, Fig. 4.10", std::string("damped frequency, equation against simulation error, ") + which,
         "%", "closely match", 100.0 * std::abs(frequency(*e) / frequency(s.stance) - 1.0)},
        {0.0, 2.0}));
}

void stance_parameters(const Studies& all, std::vector<Row>& rows) {
  const IdentificationStudy& s = all.s;
  using Variant = IdentificationStudy::Variant;
  const auto spread = [&](double Variant::*member) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& v : s.variants) {
      low = std::min(low, v.*member);
      high = std::max(high, v.*member);
    }
    return 100.0 * (high / low - 1.0);
  };
  rows.push_back(compare({"6.1.1", "mass, spring rate or both identified: spread of the mass", "%",
                          "different", spread(&Variant::mass_kg)},
                         {2.0, 100.0}));
  rows.push_back(compare({"6.1.1", "the same of the damped natural frequency", "%", "consistent",
                          spread(&Variant::damped_frequency_radps)},
                         {0.0, 1.0}));

  const double mass_kg = s.stance.value("mass_kg");
  const IdentificationStudy& weightless = all.switched.weightless_links;
  const double ratio = mass_kg / s.rig.weighed_kg;
  const double weightless_ratio = weightless.stance.value("mass_kg") / weightless.rig.weighed_kg;
  const double closed_form = s.effective_stance_mass_kg / s.rig.weighed_kg;
  const double freed_ratio = s.variants.back().mass_kg / s.rig.weighed_kg;
  rows.push_back(compare(
      {"4.2.1", "mass identified in stance over mass weighed", "", "1.554 / 1.62 = 0.959", ratio},
      {0.949, 0.969},
      Reason{
          std::abs(s.effective_stance_mass_kg / mass_kg - 1.0) < 0.03 && s.printed_links_mass_ratio < 0.959 &&
              weightless_ratio - ratio > 0.75 * (1.0 - ratio),
          "With the toe on the ground the links turn instead of moving with the body. With weightless links it is " +
              number(weightless_ratio, 3) + "; by this rig's links it is " + number(closed_form, 3) +
              " in closed form, by the document's " + number(s.printed_links_mass_ratio, 3) + ", and " +
              number(s.table_mass_ratio, 3) +
              " with a as in table 3.1: its drop of mass is its links', and would be more. With the spring "
              "rate identified too it is " +
              number(freed_ratio, 3) + ".",
          {{"with weightless links", weightless_ratio},
           {"this rig's links in closed form", closed_form},
           {"the document's links in closed form", s.printed_links_mass_ratio},
           {"the same with a as in table 3.1", s.table_mass_ratio},
           {"with the spring rate identified too", freed_ratio}}}));
  const IdentificationStudy& frictionless = all.switched.frictionless;
  const double without = frictionless.stance.value("damping_stance_nspm");
  rows.push_back({"4.2.1.1, Fig. 4.9",
                  "damping in stance by simulation error",
                  "N s/m",
                  "6.42 (of its rig)",
                  s.stance.value("damping_stance_nspm"),
                  {},
                  Outcome::computed,
                  "This rig has " + number(s.rig.truth.parameter("damping_stance_nspm"), 3) + " N s/m and " +
                      number(friction_n(s), 2) +
                      " N of dry friction, which no model of the document has. Without friction " +
                      number(without, 3) + " N s/m are identified.",
                  {{"without friction", without}}});
}

void flight(const Studies& all, std::vector<Row>& rows) {
  const IdentificationStudy& s = all.s;
  constexpr Phase kFlight = &IdentificationStudy::flight;
  const Errors& errors = s.flight.errors;
  rows.push_back(compare({"6.1.1, Fig. 4.14", "flight: height, mean absolute error, mean of 20", "mm",
                          "below 2 mm", 1e3 * mean_of(errors, &E::mae_height_m)},
                         {0.0, 2.0}));
  // A flight of 0.2 s starts from a state estimated from a tenth of it.
  const std::size_t noisiest = poorest_of(errors);
  const double floor = s.flight_floor[noisiest].nmse_height;
  const std::string start_text =
      "Predicted from a start that the first tenth of its positions gives. What their noise makes of this low flight is " +
      number(100.0 * floor, 2) + " % of NMSE in the mean, to first order.";
  const auto start = [&](Member member, double scale, double printed, const char* unit) {
    const double exact = scale * worst_of(all.switched.exact_positions.flight.errors, member);
    return other_study(errors[noisiest].nmse_height < 9.0 * floor && exact < 2.0 * printed, start_text,
                       "With positions without counts and noise", exact, unit);
  };
  all.add(rows, {"Fig. 4.15", "flight", kFlight, &E::nmse_height, "NMSE of height", "%", 100.0, 4.9, 6.8},
          start(&E::nmse_height, 100.0, 6.8, "%"));
  all.add(rows, {"Fig. 4.15", "flight", kFlight, &E::mae_height_m, "height, MAE", "mm", 1e3, 1.4, 4.8},
          start(&E::mae_height_m, 1e3, 4.8, "mm"));
  all.add(rows, {"Fig. 4.15", "flight", kFlight, &E::nmse_velocity, "NMSE of velocity", "%", 100.0, 1.9, 3.7},
          start(&E::nmse_velocity, 100.0, 3.7, "%"));
  all.add(rows,
          {"Fig. 4.15", "flight", kFlight, &E::mae_velocity_mps, "velocity, MAE", "mm/s", 1e3, 53.6, 20.8},
          start(&E::mae_velocity_mps, 1e3, 20.8, "mm/s"));
  for (Row& row : rows)
    if (row.where == "Fig. 4.15" && (row.published == "6.8 %" || row.published == "4.8 mm" ||
                                     row.published == "1.9 %" || row.published == "53.6 mm/s"))
      row.remark +=
          std::string(row.remark.empty() ? "" : " ") +
          "The caption of Fig. 4.12 prints the same figure; that one of the two is a slip is a conjecture.";
  const double without = all.switched.frictionless.flight.value("damping_flight_nspm");
  rows.push_back({"4.2.1.1, Fig. 4.13",
                  "damping in flight",
                  "N s/m",
                  "1.18 (of its rig)",
                  s.flight.value("damping_flight_nspm"),
                  {},
                  Outcome::computed,
                  "This rig has " + number(s.rig.truth.parameter("damping_flight_nspm"), 3) +
                      " N s/m; a damping that takes as much power as that and its friction is " +
                      number(s.equivalent_flight_damping_nspm, 3) + ". Without friction " +
                      number(without, 3) + " N s/m are identified.",
                  {{"without friction", without}}});
}

void strides(const Studies& all, std::vector<Row>& rows) {
  const IdentificationStudy& s = all.s;
  constexpr Phase kStride = &IdentificationStudy::strides;
  rows.push_back(
      {"Fig. 4.16", "touch-down: velocity kept", "", "a picture", s.strides.value("restitution_touchdown")});
  rows.push_back(
      {"Fig. 4.16", "lift-off: velocity kept", "", "a picture", s.strides.value("restitution_liftoff")});
  // The poorest stride's torque was restarted when the switch reported, not when the model touches down.
  const std::size_t poorest = poorest_of(s.strides.errors);
  std::vector<double> off_s;
  for (const double late_s : s.stride_torque_late_s) off_s.push_back(std::abs(late_s));
  const std::string late_text = "In the poorest stride the switch restarted the torque " +
                                number(1e3 * off_s[poorest], 2) + " ms off the touch-down (median " +
                                number(1e3 * median(off_s), 2) + " ms).";
  const auto late = [&](Member member, double scale, double printed, const char* unit) {
    const double punctual = scale * worst_of(all.switched.punctual_switch.strides.errors, member);
    return other_study(off_s[poorest] >= core::quantile(off_s, 0.9) && punctual < 2.0 * printed, late_text,
                       "With a switch that reports in time", punctual, unit);
  };
  all.add(rows, {"Fig. 4.18", "stride", kStride, &E::nmse_height, "NMSE of height", "%", 100.0, 0.75, 2.1},
          late(&E::nmse_height, 100.0, 2.1, "%"));
  all.add(rows, {"Fig. 4.18", "stride", kStride, &E::mae_height_m, "height, MAE", "mm", 1e3, 2.7, 4.7},
          late(&E::mae_height_m, 1e3, 4.7, "mm"));
  all.add(rows,
          {"Fig. 4.18", "stride", kStride, &E::nmse_velocity, "NMSE of velocity", "%", 100.0, 1.23, 2.9},
          late(&E::nmse_velocity, 100.0, 2.9, "%"));
  all.add(rows,
          {"Fig. 4.18", "stride", kStride, &E::mae_velocity_mps, "velocity, MAE", "mm/s", 1e3, 49.6, 89.1},
          late(&E::mae_velocity_mps, 1e3, 89.1, "mm/s"));
}

void nonlinear_model(const Studies& all, std::vector<Row>& rows) {
  const IdentificationStudy& s = all.s;
  const double linear = cost_of(s.stance.errors), nonlinear = cost_of(s.nonlinear.errors);
  // NMSE(z) + NMSE(z') of the better one of Fig. 4.12.
  constexpr double kPrinted = 0.006 + 0.019;
  const IdentificationStudy& weightless = all.switched.weightless_links;
  const double weightless_ratio = cost_of(weightless.nonlinear.errors) / cost_of(weightless.stance.errors);
  const double beside_printed = (nonlinear + kPrinted) / (linear + kPrinted);
  rows.push_back(compare(
      {"4.2.1.2, Fig. 4.20", "cost of the non-linear model over the linear one's, stance", "",
       "at the same level", nonlinear / linear},
      {0.8, 1.25},
      Reason{
          beside_printed > 0.8 && weightless_ratio > 0.8,
          "The rig is simulated with these very equations and little else, so that the linear model's cost, " +
              number(100.0 * linear, 2) + " %, is mostly the links': with weightless links it is " +
              number(weightless_ratio, 3) +
              ". With the 2.5 % of the document's good example on top of both costs it is " +
              number(beside_printed, 3) + ": there it would not show.",
          {{"with weightless links", weightless_ratio},
           {"with 2.5 % on top of both costs", beside_printed}}}));
  rows.push_back(compare({"6.1.1, Fig. 4.19", "spread of a over the folds, over that of the mass", "",
                          "a and b deviate relatively largely",
                          s.nonlinear.spread("inertia_a_kgm2") / s.nonlinear.spread("mass_kg")},
                         {3.0, 1000.0}));
  const auto [b_low, b_high] = s.nonlinear.range("inertia_b_kgm");
  rows.push_back({"6.1.1, Fig. 4.19",
                  "spread of b over the folds, of table 3.1's b",
                  "%",
                  "a and b deviate relatively largely",
                  100.0 * (b_high - b_low) / 75e-4,
                  {},
                  Outcome::computed,
                  s.b_at_bound
                      ? "b lies at its bound of zero; the rig's is " +
                            number(s.rig.truth.parameter("inertia_b_kgm"), 2) + " kg m, its a is " +
                            number(s.rig.truth.parameter("inertia_a_kgm2"), 2) + " kg m^2 where " +
                            number(s.nonlinear.value("inertia_a_kgm2"), 2) + " is found: see the toe."
                      : ""});
  rows.push_back(compare({"6.1.1", "NMSE(z) + NMSE(z') that a and b take away, the rest fitted without them",
                          "%", "a minor contribution to the motion", 100.0 * s.nmse_of_a_and_b},
                         {0.0, 0.5}));
  rows.push_back(
      {"6.1.1",
       "cost with 0.1 kg put on the toe: changed by",
       "%",
       "",
       100.0 * s.toe_mass_cost_change,
       {},
       Outcome::computed,
       "The toe stands still in stance: m, e, b and a may rise together by 1, 2 L, L and 2 L^2 a "
       "kilogram and nothing moves otherwise. One combination of the four is free, so none of them can be "
       "told from stances alone, whatever the data. (That what is left is the integrator's step is a "
       "conjecture.)"});
}

}  // namespace

SwitchedStudies run_switched_studies(StudyOptions o) {
  o.plain = o.equation = o.nonlinear = false;
  const auto progress = std::move(o.progress);
  o.progress = {};
  double done = 0.0;
  const auto with = [&](const RigChange& change, std::string_view doing, bool nonlinear = false) {
    if (progress) progress(done, doing);
    done += 1.0 / 7.0;
    o.change = change;
    o.nonlinear = nonlinear;
    return run_identification_study(o);
  };
  SwitchedStudies out;
  out.weightless_links = with({.weightless_links = true}, "the same with weightless links", true);
  out.exact_positions = with({.exact_positions = true}, "the same with exact positions");
  out.punctual_switch = with({.punctual_switch = true}, "the same with a punctual switch");
  out.frictionless = with({.friction_n = 0.0}, "the same without friction");
  out.sticky_guide = with({.friction_n = kStickyGuideN}, "the same with a guide that sticks");
  out.ringing = with({.ringing = kRinging}, "the same with impacts that ring");
  out.both = with({.friction_n = kStickyGuideN, .ringing = kRinging}, "the same with both");
  return out;
}

std::vector<Row> identification_rows(const IdentificationStudy& study, const SwitchedStudies& switched) {
  const Studies all{study, switched};
  std::vector<Row> rows;
  stance_errors(all, rows);
  estimators(all, rows);
  stance_parameters(all, rows);
  flight(all, rows);
  strides(all, rows);
  nonlinear_model(all, rows);
  return rows;
}

}  // namespace furcula::reproduce
