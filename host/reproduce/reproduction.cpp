#include "host/reproduce/reproduction.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "host/bench/sim_board.hpp"
#include "host/core/quantile.hpp"
#include "host/report/html.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::reproduce {
namespace {

using core::median;
using report::number;

constexpr double kGravity = 9.81;

double touchdown_m() { return example_parameters().rest_height_m; }
double link_m() { return example_parameters().link_length_m; }

/// The last entry; not a number where a run never came so far.
double last_of(const std::vector<double>& v) { return v.empty() ? std::nan("") : v.back(); }
double least_of(const std::vector<double>& v) {
  return v.empty() ? std::nan("") : *std::min_element(v.begin(), v.end());
}
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

using Errors = std::vector<TrajectoryErrors>;
using Member = double TrajectoryErrors::*;
using E = TrajectoryErrors;

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

/// The document shows two trajectories of each phase, a good and a poor one: our median stands beside the
/// first, our poorest beside the second.
struct Examples {
  const char* where;
  const char* phase;
  const Errors& errors;
  Member member;
  const char* what;
  const char* unit;
  double scale;       ///< to the unit
  double good, poor;  ///< printed; NaN where only one is
};

std::string as_printed(double value, const char* unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%g %s", value, unit);
  return text;
}

void add(std::vector<Row>& rows, const Examples& e, const std::optional<Reason>& good_reason = std::nullopt,
         const std::optional<Reason>& poor_reason = std::nullopt) {
  const std::string what = std::string(e.phase) + ": " + e.what;
  if (std::isfinite(e.good))
    rows.push_back(compare_error({e.where, what + ", a good one; median", e.unit, as_printed(e.good, e.unit),
                                  e.scale * median_of(e.errors, e.member)},
                                 e.good, good_reason));
  if (std::isfinite(e.poor))
    rows.push_back(compare_error({e.where, what + ", a poor one; poorest", e.unit, as_printed(e.poor, e.unit),
                                  e.scale * worst_of(e.errors, e.member)},
                                 e.poor, poor_reason));
}

/// Highest less lowest of the last ten apexes of a minute, mm; infinite where it stopped hopping.
double apex_spread_mm(const model::Model& robot, control::ProfileShape shape, double amplitude_nm,
                      double& apex_m) {
  sim::Scenario s = sim::default_scenario(robot);
  s.duration_s = 60.0;
  s.profile = shape;
  s.amplitude = amplitude_nm;
  s.period_s = 0.3;
  const log::Log log = sim::simulate(robot, s, 1);
  std::vector<double> apexes;
  double top = 0.0;
  for (const double z : log.at("height_m")) {
    if (z > touchdown_m() + 2e-3) {
      top = std::max(top, z);
    } else if (top > 0.0) {
      apexes.push_back(top);
      top = 0.0;
    }
  }
  if (apexes.size() < 100) return std::numeric_limits<double>::infinity();
  const auto [low, high] = std::minmax_element(apexes.end() - 10, apexes.end());
  apex_m = apexes.back();
  return 1e3 * (*high - *low);
}

/// Chapter 5: table 3.1 with the spring of section 4.2.1, a belt of 3 mm that runs 0.7 of the leg's way (7 cm
/// of cable for 10 cm of leg).
model::Model robot_with_clutch() {
  auto p = table_parameters();
  p.stiffness_npm = 605.0;
  p.rest_height_m = 0.289;
  model::Model m;
  m.kind = dynamics::kKindOf<dynamics::machines::HopperNonlinear>;
  for (const auto member : dynamics::HopperNonlinearParameters<double>::kMembers)
    m.parameters.push_back(p.*member);
  m.clutch = model::Clutch{0.020, 0.020, 20.0, 3e-3 / 0.7};
  return m;
}

/// Section 4.2.1: what was measured and identified there; the touch-down's loss, of which only a picture is
/// printed, as in table 3.1.
model::Model published_robot() {
  auto p = example_parameters();
  p.mass_kg = 1.554;
  p.stiffness_npm = 605.0;
  p.rest_height_m = 0.289;
  p.damping_stance_nspm = 6.42;
  p.damping_flight_nspm = 1.18;
  p.restitution_touchdown = 0.9;
  model::Model m;
  for (const auto member : dynamics::HopperLinearParameters<double>::kMembers)
    m.parameters.push_back(p.*member);
  return m;
}

void examples(Reproduction& out) {
  auto& rows = out.rows;
  const auto example = example_parameters();
  rows.push_back(compare({"5.2", "leg at 20 deg", "m", "0.282 m", touchdown_m()}, {0.2815, 0.2825}));
  rows.push_back(compare({"5.2", "leg at 60 deg", "m", "0.15 m", link_m()}, {0.1495, 0.1505}));
  out.example = hop(example, {}, 0.35, 20.0);
  rows.push_back(compare({"3.2.1, Fig. 3.4",
                          "hops after 20 s: apex above touch-down",
                          "m",
                          "uninterrupted hopping",
                          last_of(out.example.apexes_m) - touchdown_m(),
                          {},
                          {},
                          ""},
                         {0.01, 0.2}));
  rows.push_back(
      {"3.2.1, Fig. 3.4", "apex that the hops settle to", "m", "a picture", last_of(out.example.apexes_m)});
  Drive literal;
  literal.restarted = false;
  const Trajectory without = hop(example, literal, 0.35, 20.0);
  rows.push_back(
      {"3.2.1",
       "lowest apex with T sin(2 pi t / P) as printed there",
       "m",
       "",
       least_of(without.apexes_m),
       {},
       Outcome::computed,
       "Not restarted at touch-down, the torque drifts against the motion. Section 4.1 restarts it; so do all other rows."});
  rows.push_back(
      {"eq. 3.3",
       "lowest apex with the sign as printed",
       "m",
       "",
       least_of(hop(example, {-2.0, 0.3}, 0.35, 20.0).apexes_m),
       {},
       Outcome::computed,
       "Eq. 3.3 drops the minus of the cosine's derivative: with it, and + F_in as in eq. 3.5, the "
       "torque takes energy out. The input vector below eq. 3.7 has - F_in, which mends it."});
  rows.push_back({"3.2.1, Fig. 3.4c", "largest force of the motor along the leg", "N", "a picture",
                  *std::max_element(out.example.force_n.begin(), out.example.force_n.end())});
  auto losses = example;
  losses.restitution_touchdown = 0.8;
  losses.restitution_liftoff = 0.9;
  out.example_with_losses = hop(losses, {}, 0.35, 20.0);
  rows.push_back({"3.2.1, Fig. 3.5", "apex with 0.8 at touch-down, 0.9 at lift-off", "m", "a picture",
                  last_of(out.example_with_losses.apexes_m)});
}

void table_3_1(Reproduction& out) {
  auto& rows = out.rows;
  // b = sum m_L r_L gives the lower links' centre, e then the upper ones'.
  const double lower_m = 0.5 * link_m();
  const double upper_m = (38e-3 - links_of_section_3_2_2(lower_m, 0.0).e) /
                         (links_of_section_3_2_2(0.0, 1.0).e - links_of_section_3_2_2(0.0, 0.0).e);
  const auto links = links_of_section_3_2_2(lower_m, upper_m);
  const double without_centres = links_of_section_3_2_2(0.0, 0.0).a;
  rows.push_back(compare({"Table 3.1", "b of the printed masses, centres half-way", "kg m", "75e-4", links.b},
                         {74.5e-4, 75.5e-4}));
  rows.push_back(
      {"Table 3.1", "distance of the upper links' centres that gives e = 38e-3", "m", "", upper_m});
  rows.push_back(
      compare({"Table 3.1", "a of the same links", "kg m^2", "42e-4", links.a}, {41.5e-4, 42.5e-4},
              Reason{without_centres > 42e-4 && without_centres < 43e-4,
                     "Sum I + m_L L^2 alone is " + number(1e4 * without_centres, 3) +
                         "e-4: the table leaves out the squares of the centres' distances, which its "
                         "own definition of a has (and counts I_U1 twice, I_L1 never)."}));

  const auto table = table_parameters();
  dynamics::HopperLinearParameters<double> linear = table;
  linear.restitution_touchdown = 0.9;
  out.linear_stride = hop(linear, {}, 0.35, 0.55);
  out.nonlinear_stride = hop(table, {}, 0.35, 0.55);
  const auto first = [](const std::vector<double>& v) { return v.empty() ? std::nan("") : v.front(); };
  rows.push_back(compare({"Table 3.1", "what the plastic touch-down of the links keeps of the velocity", "",
                          "0.9 (given to the linear model)", first(out.nonlinear_stride.touchdown_ratios)},
                         {0.85, 0.95}));
  const double kept = 1.0 - table.inertia_e_kgm / (2.0 * table.link_length_m * table.mass_kg);
  const double at_liftoff = first(out.nonlinear_stride.liftoff_ratios);
  rows.push_back(compare(
      {"Table 3.1", "what the non-linear model's lift-off keeps of it", "", "1", at_liftoff}, {0.99, 1.01},
      Reason{std::abs(at_liftoff - kept) < 1e-3,
             "The leg meets its mechanical stop at 20 deg there: the body takes the links "
             "along, which leaves 1 - e / (2 L m) = " +
                 number(kept, 4) + ". The document's equations have no stop."}));
  rows.push_back({"Fig. 3.7a", "largest difference of the two models' heights in a stride", "mm", "a picture",
                  1e3 * largest_difference(out.linear_stride.height_m, out.nonlinear_stride.height_m)});
  rows.push_back({"Fig. 3.7a", "difference of their deepest points", "mm", "a picture",
                  1e3 * (least_of(out.nonlinear_stride.height_m) - least_of(out.linear_stride.height_m))});
  rows.push_back({"Fig. 3.7b", "largest difference of their velocities", "m/s", "a picture",
                  largest_difference(out.linear_stride.velocity_mps, out.nonlinear_stride.velocity_mps)});
}

void hopping(Reproduction& out) {
  auto& rows = out.rows;
  const model::Model robot = published_robot();
  // The torque is not printed: one that brings the identified robot into the printed range of apexes.
  for (const auto& [where, what, shape, torque_nm] :
       {std::tuple{"4.1, Fig. 4.3a", "constant torque of 1.2 N m", control::ProfileShape::constant, 1.2},
        std::tuple{"4.1, Fig. 4.3b", "harmonic torque of 2.2 N m", control::ProfileShape::harmonic, 2.2}}) {
    double apex_m = std::nan("");
    const double spread_mm = apex_spread_mm(robot, shape, torque_nm, apex_m);
    rows.push_back(compare({where, std::string(what) + ": spread of ten apexes after a minute", "mm",
                            "dynamically stable", spread_mm},
                           {0.0, 2.0}));
    rows.push_back(
        compare({"5.2", std::string(what) + ": apex", "m", "0.30 to 0.35 m", apex_m}, {0.30, 0.35}));
  }
  rows.push_back({"4.2, Fig. 4.7",
                  "2.7 N less the weight of 0.2 kg of lower links: pretension",
                  "N",
                  "below 1 N",
                  2.7 - 0.2 * kGravity,
                  {},
                  Outcome::computed,
                  "The document's own figures agree."});
  rows.push_back({"4.2.1.1", "damped natural frequency of the printed k, m and ds", "rad/s", "a picture",
                  damped_frequency_radps(1.554, 605.0, 6.42)});
}

void stance(Reproduction& out) {
  auto& rows = out.rows;
  const IdentificationStudy& s = out.study;
  const Errors& errors = s.stance.errors;
  rows.push_back(compare_error({"6.1.1, Fig. 4.11", "stance: height, mean absolute error, mean of 60", "mm",
                                "2 mm", 1e3 * mean_of(errors, &E::mae_height_m)},
                               2.0));
  rows.push_back(compare({"6.1.1", "stance: largest deviation of any", "mm", "not above 7 mm",
                          1e3 * worst_of(errors, &E::worst_height_m)},
                         {0.0, 7.0}));
  rows.push_back({"6.1.1", "stance: outliers of 60, by 1.5 interquartile ranges", "", "5",
                  outliers(values_of(errors, &E::mae_height_m))});
  add(rows, {"Fig. 4.12", "stance", errors, &E::nmse_height, "NMSE of height", "%", 100.0, 0.6, 6.8});
  add(rows, {"Fig. 4.12", "stance", errors, &E::mae_height_m, "height, MAE", "mm", 1e3, 1.5, 4.8});
  add(rows, {"Fig. 4.12", "stance", errors, &E::nmse_velocity, "NMSE of velocity", "%", 100.0, 1.9, 2.6});
  add(rows, {"Fig. 4.12", "stance", errors, &E::mae_velocity_mps, "velocity, MAE", "mm/s", 1e3, 53.6, 54.6});

  // The two estimators, with a velocity without delay and with the rig's own.
  const double damping = s.stance.value("damping_stance_nspm"), cost = cost_of(errors);
  const auto frequency = [&](const Estimates& e) {
    return damped_frequency_radps(e.value("mass_kg"), s.rig.stiffness_npm, e.value("damping_stance_nspm"));
  };
  const auto deviation = [&](const Estimates& e) {
    return 100.0 * std::abs(e.value("damping_stance_nspm") / damping - 1.0);
  };
  const Estimates &smooth = s.stance_by_equation, &raw = s.stance_by_equation_raw;
  const double gain = cost / cost_of(smooth.errors), raw_gain = cost / cost_of(raw.errors);
  rows.push_back(compare(
      {"6.1.1", "cost, simulation over equation error, velocity without delay", "", "slightly better", gain},
      {0.5, 1.0}));
  rows.push_back(
      compare({"6.1.1", "the same, the rig's own velocity", "", "slightly better", raw_gain}, {0.5, 1.0},
              Reason{raw_gain < gain && gain < 1.0,
                     "The rig's velocity, differences of counts, is 2.5 ms late; one-step prediction "
                     "takes the delay for damping. How late the document's was is not printed."}));
  rows.push_back(compare(
      {"6.1.1, Fig. 4.9", "damping, equation against simulation error, velocity without delay", "%",
       "significant deviation", deviation(smooth)},
      {5.0, 100.0},
      Reason{
          deviation(raw) > 5.0 * deviation(smooth),
          "With a velocity that is neither late nor noisy the two agree; with the rig's own they differ by " +
              number(deviation(raw), 2) + " %. No one velocity shows both claims."}));
  rows.push_back(compare(
      {"6.1.1, Fig. 4.9", "the same, the rig's own velocity", "%", "significant deviation", deviation(raw)},
      {5.0, 100.0}));
  for (const auto& [e, which] :
       {std::pair{&smooth, "velocity without delay"}, std::pair{&raw, "the rig's own velocity"}})
    rows.push_back(compare(
        {"6.1.1, Fig. 4.10", std::string("damped frequency, equation against simulation error, ") + which,
         "%", "closely match", 100.0 * std::abs(frequency(*e) / frequency(s.stance) - 1.0)},
        {0.0, 2.0}));
  const auto spread = [&](double IdentificationStudy::Variant::*member) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& v : s.variants) {
      low = std::min(low, v.*member);
      high = std::max(high, v.*member);
    }
    return 100.0 * (high / low - 1.0);
  };
  using Variant = IdentificationStudy::Variant;
  rows.push_back(compare({"6.1.1", "mass, spring rate or both identified: spread of the mass", "%",
                          "different", spread(&Variant::mass_kg)},
                         {2.0, 100.0}));
  rows.push_back(compare({"6.1.1", "the same of the damped natural frequency", "%", "consistent",
                          spread(&Variant::damped_frequency_radps)},
                         {0.0, 1.0}));

  const double mass_kg = s.stance.value("mass_kg");
  rows.push_back(compare(
      {"4.2.1", "mass identified in stance over mass weighed", "", "1.554 / 1.62 = 0.959",
       mass_kg / s.rig.weighed_kg},
      {0.949, 0.969},
      Reason{
          std::abs(s.effective_stance_mass_kg / mass_kg - 1.0) < 0.03 && s.printed_links_mass_ratio < 0.959,
          "With the toe on the ground the links turn instead of moving with the body: along the stance that leaves " +
              number(s.effective_stance_mass_kg, 4) + " kg of this rig's " +
              number(s.rig.truth.parameter("mass_kg"), 4) + " in closed form; " + number(mass_kg, 4) +
              " are identified. Of the document's own links it leaves " +
              number(s.printed_links_mass_ratio, 3) + " of 1.62 kg, " + number(s.table_mass_ratio, 3) +
              " with a as in table 3.1: its drop of mass is its links', and would be more. The mass identified "
              "goes with the spring rate that is held (6.1.1), of which 3 % do."}));
  rows.push_back({"4.2.1.1, Fig. 4.9",
                  "damping in stance by simulation error",
                  "N s/m",
                  "6.42 (of its rig)",
                  damping,
                  {},
                  Outcome::computed,
                  "This rig has " + number(s.rig.truth.parameter("damping_stance_nspm"), 3) + " N s/m and " +
                      number(s.rig.truth.effects.at(dynamics::Effect::coulomb_friction)[0], 2) +
                      " N of dry friction, which no model of the document has: the damping takes it up."});
}

void flight_and_strides(Reproduction& out) {
  auto& rows = out.rows;
  const IdentificationStudy& s = out.study;
  rows.push_back(compare({"6.1.1, Fig. 4.14", "flight: height, mean absolute error, mean of 20", "mm",
                          "below 2 mm", 1e3 * mean_of(s.flight.errors, &E::mae_height_m)},
                         {0.0, 2.0}));
  // A flight of 0.2 s starts from a state estimated from a tenth of it.
  const std::size_t noisiest = poorest_of(s.flight.errors);
  const double floor = s.flight_floor[noisiest].nmse_height;
  const Reason start{
      s.flight.errors[noisiest].nmse_height < 9.0 * floor,
      "Predicted from a start that the first 20 ms of positions give. What their noise makes of this low flight is " +
          number(100.0 * floor, 2) +
          " % in the mean, to first order; the document took the start from a velocity that was "
          "filtered over the whole flight."};
  const double nan = std::nan("");
  const Errors& errors = s.flight.errors;
  add(rows, {"Fig. 4.15", "flight", errors, &E::nmse_height, "NMSE of height", "%", 100.0, 4.9, 6.8}, {},
      start);
  add(rows, {"Fig. 4.15", "flight", errors, &E::mae_height_m, "height, MAE", "mm", 1e3, 1.4, nan});
  add(rows, {"Fig. 4.15", "flight", errors, &E::nmse_velocity, "NMSE of velocity", "%", 100.0, 1.9, 3.7}, {},
      start);
  add(rows, {"Fig. 4.15", "flight", errors, &E::mae_velocity_mps, "velocity, MAE", "mm/s", 1e3, nan, 20.8},
      {}, start);
  rows.push_back({"4.2.1.1, Fig. 4.13",
                  "damping in flight",
                  "N s/m",
                  "1.18 (of its rig)",
                  s.flight.value("damping_flight_nspm"),
                  {},
                  Outcome::computed,
                  "This rig has " + number(s.rig.truth.parameter("damping_flight_nspm"), 3) +
                      " N s/m; a damping that takes as much power as that and its friction is " +
                      number(s.equivalent_flight_damping_nspm, 3) + "."});
  rows.push_back(
      {"Fig. 4.16", "touch-down: velocity kept", "", "a picture", s.strides.value("restitution_touchdown")});
  rows.push_back(
      {"Fig. 4.16", "lift-off: velocity kept", "", "a picture", s.strides.value("restitution_liftoff")});
  // The poorest stride's torque was restarted when the switch reported, not when the model touches down.
  const std::size_t poorest = poorest_of(s.strides.errors);
  std::vector<double> off_s;
  for (const double late_s : s.stride_torque_late_s) off_s.push_back(std::abs(late_s));
  const Reason late{off_s[poorest] >= core::quantile(off_s, 0.9),
                    "In the poorest stride the switch restarted the torque " +
                        number(1e3 * off_s[poorest], 2) +
                        " ms off the touch-down, one of the tenth that is furthest off (median " +
                        number(1e3 * median(off_s), 2) + " ms)."};
  add(rows,
      {"Fig. 4.18", "stride", s.strides.errors, &E::nmse_height, "NMSE of height", "%", 100.0, 0.75, 2.1}, {},
      late);
  add(rows, {"Fig. 4.18", "stride", s.strides.errors, &E::mae_height_m, "height, MAE", "mm", 1e3, 2.7, 4.7},
      {}, late);
  add(rows,
      {"Fig. 4.18", "stride", s.strides.errors, &E::nmse_velocity, "NMSE of velocity", "%", 100.0, 1.23, 2.9},
      {}, late);
  add(rows,
      {"Fig. 4.18", "stride", s.strides.errors, &E::mae_velocity_mps, "velocity, MAE", "mm/s", 1e3, 49.6,
       89.1},
      {}, late);
}

void nonlinear_model(Reproduction& out) {
  auto& rows = out.rows;
  const IdentificationStudy& s = out.study;
  const double linear = cost_of(s.stance.errors), nonlinear = cost_of(s.nonlinear.errors);
  // NMSE(z) + NMSE(z') of the better one of Fig. 4.12.
  constexpr double kPrinted = 0.006 + 0.019;
  rows.push_back(compare(
      {"4.2.1.2, Fig. 4.20", "cost of the non-linear model over the linear one's, stance", "",
       "at the same level", nonlinear / linear},
      {0.8, 1.25},
      Reason{(linear - nonlinear) / kPrinted < 0.2,
             "The rig is simulated with these very equations and little else, so the linear model's cost, " +
                 number(100.0 * linear, 2) + " %, is mostly the links' (" +
                 number(100.0 * s.variants.back().nmse, 2) +
                 " % with the spring rate freed too). What they add is " +
                 number(100.0 * (linear - nonlinear) / kPrinted, 2) +
                 " % of the 2.5 % of the document's good example: there it would not show."}));
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
       "kilogram and nothing moves otherwise; what is left is the integrator's step. One combination "
       "of the four is free, so none of them can be told from stances alone, whatever the data."});
}

void clutch(Reproduction& out) {
  auto& rows = out.rows;
  const auto& bench = out.release_catch;
  rows.push_back(compare({"5.1, Fig. 5.6", "1 kg, 40 ms: held after the command to catch", "ms",
                          "20 to 50 ms", 1e3 * bench.standard.caught_after_s},
                         {20.0, 50.0}));
  rows.push_back(compare({"5.1, Fig. 5.6", "the slowest of 100 varied trials", "ms", "20 to 50 ms",
                          1e3 * bench.summary.caught_after_worst_s},
                         {20.0, 50.0}));
  rows.push_back(compare(
      {"5.1", "smallest gain of holding load per gain of pressing force", "kg/N", "increases significantly",
       [&] {
         double least = std::numeric_limits<double>::infinity();
         for (std::size_t i = 1; i < bench.holding.size(); ++i)
           least = std::min(least, (bench.holding[i].load_kg - bench.holding[i - 1].load_kg) /
                                       (bench.holding[i].pressing_n - bench.holding[i - 1].pressing_n));
         return least;
       }()},
      {0.01, 10.0}));

  const double stiffness = robot_with_clutch().parameter("stiffness_npm");
  for (int i = 0; i <= 20; ++i) {
    const double a = 0.005 * i;
    out.contraction_m.push_back(a);
    out.spring_work_j.push_back(0.5 * stiffness * a * a);
  }
  const auto& e = out.energy;
  rows.push_back(compare(
      {"5.2, Fig. 5.10a", "k A^2 / 2 for 10 cm", "J", "level with the coil's 3 J", out.spring_work_j.back()},
      {2.7, 3.3}));
  rows.push_back(compare({"5.2", "flight at an apex of 0.34 m", "s", "0.2 s",
                          e.points.front().caught ? e.points.front().caught->energy.flight_s : std::nan("")},
                         {0.18, 0.22}));
  rows.push_back(compare(
      {"5.2", "coil at 10 V and 1.5 A for that flight", "J", "about 3 J", e.published.coil_j}, {2.7, 3.3}));
  rows.push_back(compare(
      {"5.2, Fig. 5.10b", "1 kg more, a hop at the same apex", "J", "about 0.35 J", e.published.mass_j},
      {0.30, 0.40}));
  rows.push_back(compare(
      {"5.2", "break-even by the document's accounting", "m", "up to 10 cm", e.published.break_even_m},
      {0.09, 0.11}));
  rows.push_back(
      {"5.2",
       "break-even of the simulated robots, mechanical",
       "m",
       "",
       e.mechanical_m.value_or(std::nan("")),
       {},
       Outcome::computed,
       "A coil that is held at less than it is pulled in with, a spring whose energy comes back in part."});
  rows.push_back({"5.2",
                  "the same with the motor's copper losses",
                  "m",
                  "",
                  e.electrical_m.value_or(std::nan("")),
                  {},
                  Outcome::computed,
                  "Which the document leaves to further study."});
  // At rest: the spring's pull at the lever of the folded leg.
  const double rest_m = robot_with_clutch().parameter("rest_height_m");
  const auto static_torque = [&](double a) {
    const double length = touchdown_m() - a, cosine = length / (2.0 * link_m());
    return stiffness * (rest_m - length) * 2.0 * link_m() * std::sqrt(1.0 - cosine * cosine);
  };
  const auto& last = e.points.back();
  const double peak = last.caught ? last.caught->energy.peak_torque_flight_nm : std::nan("");
  rows.push_back(
      compare({"5.2, Fig. 5.11", "torque to fold by 10 cm against the spring", "N m", "up to 10 N m", peak},
              {9.0, 11.0},
              Reason{std::abs(static_torque(0.1) / peak - 1.0) < 0.1 && static_torque(0.07) > 9.0 &&
                         static_torque(0.07) < 11.0,
                     "Pull times lever at rest is " + number(static_torque(0.1), 3) + " N m for 10 cm and " +
                         number(static_torque(0.07), 3) +
                         " N m for 7 cm: 10 N m belong to a leg that folds by the 7 cm that the "
                         "auxiliary spring stretches, for which the document has 10 cm of leg."}));
  rows.push_back({"5.2", "the same with the spring let go", "N m", "",
                  last.clutched ? last.clutched->energy.peak_torque_flight_nm : std::nan("")});
}

}  // namespace

std::size_t Reproduction::count(Outcome outcome) const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [&](const Row& r) { return r.outcome == outcome; }));
}

Reproduction reproduce_002(const Options& options) {
  const auto part = [&](double from, double to) {
    return [&options, from, to](double fraction, std::string_view doing) {
      if (options.progress) options.progress(from + (to - from) * fraction, doing);
    };
  };
  Reproduction out;
  out.options = options;
  part(0.0, 0.0)(0.0, "examples");
  examples(out);
  table_3_1(out);

  StudyOptions study;
  study.seed = options.seed;
  study.threads = options.threads;
  study.progress = part(0.02, 0.4);
  out.study = run_identification_study(study);
  hopping(out);
  stance(out);
  flight_and_strides(out);
  nonlinear_model(out);

  bench::SimBoard board;
  bench::Options trials;
  trials.progress = part(0.4, 0.45);
  out.release_catch = bench::run_release_catch(board, trials, {});
  energy::Options sweep;
  sweep.threads = options.threads;
  sweep.progress = part(0.45, 1.0);
  const auto from = std::chrono::steady_clock::now();
  out.energy = energy::run_study(robot_with_clutch(), sweep);
  out.energy_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
  clutch(out);
  return out;
}

}  // namespace furcula::reproduce
