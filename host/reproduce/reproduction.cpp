#include "host/reproduce/reproduction.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "furcula/dynamics/links.hpp"
#include "host/bench/sim_board.hpp"
#include "host/identify/quantile.hpp"
#include "host/report/html.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::reproduce {
namespace {

using identify::median;
using report::number;

constexpr double kGravity = 9.81;
constexpr double kLegLength = 0.15;  // of a link
constexpr double kStop = 20.0 * std::numbers::pi / 180.0;

double deepest(const Trajectory& t) { return *std::min_element(t.height_m.begin(), t.height_m.end()); }

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

double mean_of(const std::vector<TrajectoryErrors>& errors, double TrajectoryErrors::*member) {
  double sum = 0.0;
  for (const TrajectoryErrors& e : errors) sum += e.*member;
  return sum / static_cast<double>(errors.size());
}
double quantile_of(const std::vector<TrajectoryErrors>& errors, double TrajectoryErrors::*member,
                   double share) {
  std::vector<double> all;
  for (const TrajectoryErrors& e : errors) all.push_back(e.*member);
  return identify::quantile(std::move(all), share);
}

/// Highest less lowest of the last ten apexes of a minute, m; infinite where it stopped hopping.
double apex_spread(const model::Model& robot, control::ProfileShape shape, double amplitude_nm,
                   double* apex_m) {
  sim::Scenario s = sim::default_scenario(robot);
  s.duration_s = 60.0;
  s.profile = shape;
  s.amplitude = amplitude_nm;
  s.period_s = 0.3;
  const log::Log log = sim::simulate(robot, s, 1);
  const double touchdown_m = 2.0 * kLegLength * std::cos(kStop);
  std::vector<double> apexes;
  double top = 0.0;
  for (const double z : log.at("height_m")) {
    if (z > touchdown_m + 2e-3) {
      top = std::max(top, z);
    } else if (top > 0.0) {
      apexes.push_back(top);
      top = 0.0;
    }
  }
  if (apexes.size() < 100) return std::numeric_limits<double>::infinity();
  const auto [low, high] = std::minmax_element(apexes.end() - 10, apexes.end());
  *apex_m = apexes.back();
  return *high - *low;
}

/// Chapter 5: links of table 3.1, what chapter 4 identified, a belt of 3 mm that runs 0.7 of the leg's way.
model::Model robot_with_clutch() {
  auto p = table_parameters();
  p.stiffness_npm = 605.0;
  p.rest_height_m = 0.289;
  model::Model m;
  m.kind = dynamics::Kind::hopper_nonlinear;
  for (const auto member : dynamics::HopperNonlinearParameters<double>::kMembers)
    m.parameters.push_back(p.*member);
  m.clutch = model::Clutch{0.020, 0.020, 20.0, 3e-3 / 0.7};
  return m;
}

/// 4.2.1: what was identified there.
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

void chapter_3(Reproduction& out) {
  auto& rows = out.rows;
  const auto example = example_parameters();
  rows.push_back(compare("5.2", "leg height at 20 deg", "m", "0.282", 2.0 * kLegLength * std::cos(kStop),
                         {0.2815, 0.2825}));
  rows.push_back(compare("5.2", "leg shortens from 20 to 60 deg by", "m", "almost 0.13",
                         2.0 * kLegLength * (std::cos(kStop) - 0.5), {0.125, 0.135}));
  out.example = hop(example, {}, 0.35, 20.0);
  rows.push_back(compare("3.2.1, Fig. 3.4", "hops on uninterrupted: last apex of 20 s above touch-down", "m",
                         "above 0", out.example.apexes_m.back() - example.rest_height_m, {0.01, 0.2}));
  rows.push_back(computed("3.2.1, Fig. 3.4", "apex that the hops settle to", "m", "a picture",
                          out.example.apexes_m.back()));
  const Trajectory reversed = hop(example, {-2.0, 0.3}, 0.35, 20.0);
  rows.push_back(computed(
      "eq. 3.3", "with the sign as printed: lowest apex of 20 s", "m", "",
      *std::min_element(reversed.apexes_m.begin(), reversed.apexes_m.end()),
      "eq. 3.3 drops the minus of the cosine's derivative; with it as printed, and + F_in as in eq. "
      "3.5, the torque takes energy out. The input vector below eq. 3.7 has - F_in, which mends it."));
  rows.push_back(computed("3.2.1, Fig. 3.4c", "largest force of the motor along the leg", "N", "a picture",
                          *std::max_element(out.example.force_n.begin(), out.example.force_n.end())));
  auto losses = example;
  losses.restitution_touchdown = 0.8;
  losses.restitution_liftoff = 0.9;
  out.example_with_losses = hop(losses, {}, 0.35, 20.0);
  rows.push_back(compare("3.2.1, Fig. 3.5", "velocity after over before touch-down, measured in the run", "",
                         "0.8", median(out.example_with_losses.touchdown_ratios), {0.799, 0.801}));
  rows.push_back(compare("3.2.1, Fig. 3.5", "velocity after over before lift-off, measured in the run", "",
                         "0.9", median(out.example_with_losses.liftoff_ratios), {0.899, 0.901}));
  rows.push_back(computed("3.2.1, Fig. 3.5", "apex with these losses", "m", "a picture",
                          out.example_with_losses.apexes_m.back()));

  // b = sum m_L r_L gives the lower links' centre, e then the upper ones'.
  const double lower_m = 0.5 * kLegLength;
  const double upper_m = (38e-3 - links_of_section_3_2_2(lower_m, 0.0).e) /
                         (links_of_section_3_2_2(0.0, 1.0).e - links_of_section_3_2_2(0.0, 0.0).e);
  const auto links = links_of_section_3_2_2(lower_m, upper_m);
  const double least_a = links_of_section_3_2_2(lower_m, 0.0).a;
  rows.push_back(compare("Table 3.1", "b from the lower links' masses, centres half-way", "kg m", "75e-4",
                         links.b, {74.5e-4, 75.5e-4}));
  rows.push_back(
      computed("Table 3.1", "distance of the upper links' centres that gives e = 38e-3", "m", "", upper_m));
  rows.push_back(compare(
      "Table 3.1", "a from the same links", "kg m^2", "42e-4", links.a, {41.5e-4, 42.5e-4},
      Reason{least_a > 42.5e-4, "The printed masses and inertias sum to " + number(1e4 * least_a, 3) +
                                    "e-4 even with the upper links' centres on their joint: the table's a is "
                                    "below its own figures' sum."}));

  const auto table = table_parameters();
  dynamics::HopperLinearParameters<double> linear = table;
  linear.restitution_touchdown = 0.9;
  out.linear_stride = hop(linear, {}, 0.35, 0.55);
  out.nonlinear_stride = hop(table, {}, 0.35, 0.55);
  const dynamics::Links<double> leg{table.inertia_a_kgm2, table.inertia_b_kgm, table.inertia_e_kgm,
                                    table.link_length_m, table.mass_kg};
  const auto pose = leg.pose(table.touchdown_angle_rad);
  rows.push_back(compare("Table 3.1", "velocity kept by the non-linear model's plastic touch-down", "", "0.9",
                         out.nonlinear_stride.touchdown_ratios.front(), {0.85, 0.95}));
  // Off the ground the body shares its momentum with links that the stop brings to rest.
  const double kept = leg.velocity_after_stop(pose, -1.0 / pose.lever, 1.0);
  const double at_liftoff = out.nonlinear_stride.liftoff_ratios.front();
  rows.push_back(compare(
      "Table 3.1", "velocity kept by the non-linear model's lift-off", "", "1", at_liftoff, {0.99, 1.01},
      Reason{std::abs(at_liftoff - kept) < 1e-3,
             "Here the leg meets its mechanical stop at 20 deg and the links' momentum goes to the "
             "body's: e sin(theta) / (2 L sin(theta) m) less, in closed form " +
                 number(kept, 4) + ". The document's leg swings on freely in its equations."}));
  rows.push_back(computed("Fig. 3.7a", "largest difference of the two models' heights in a stride", "m",
                          "a picture",
                          largest_difference(out.linear_stride.height_m, out.nonlinear_stride.height_m)));
  rows.push_back(
      computed("Fig. 3.7b", "largest difference of their velocities", "m/s", "a picture",
               largest_difference(out.linear_stride.velocity_mps, out.nonlinear_stride.velocity_mps),
               "It is largest where the two meet the ground and leave it at different instants."));
  rows.push_back(computed("Fig. 3.7a", "difference of their deepest points", "m", "a picture",
                          deepest(out.nonlinear_stride) - deepest(out.linear_stride)));
}

void chapter_4(Reproduction& out) {
  auto& rows = out.rows;
  const model::Model robot = published_robot();
  double apex_m = 0.0;
  const double constant_spread = apex_spread(robot, control::ProfileShape::constant, 1.4, &apex_m);
  rows.push_back(compare("4.1, Fig. 4.3a", "constant torque hops stably: spread of ten apexes", "m", "stable",
                         constant_spread, {0.0, 0.002}));
  rows.push_back(computed("4.1, Fig. 4.3a", "its apex at 1.4 N m", "m", "a picture", apex_m));
  const double harmonic_spread = apex_spread(robot, control::ProfileShape::harmonic, 2.4, &apex_m);
  rows.push_back(compare("4.1, Fig. 4.3b", "harmonic torque hops stably: spread of ten apexes", "m", "stable",
                         harmonic_spread, {0.0, 0.002}));
  rows.push_back(computed("4.1, Fig. 4.3b", "its apex at 2.4 N m", "m", "a picture", apex_m));
  rows.push_back(compare("4.2, Fig. 4.7", "pretension: 2.7 N less the weight of 0.2 kg of lower links", "N",
                         "below 1", 2.7 - 0.2 * kGravity, {0.0, 1.0}));
  rows.push_back(computed("4.2.1.1", "damped natural frequency of the printed k, m and ds", "rad/s",
                          "a picture", damped_frequency_radps(1.554, 605.0, 6.42)));

  const IdentificationStudy& s = out.study;
  using E = TrajectoryErrors;
  rows.push_back(compare("6.1.1, Fig. 4.11", "stance: height, mean absolute error of 60, mean", "m", "0.002",
                         mean_of(s.stance.errors, &E::mae_height_m), {0.0, 0.002}));
  rows.push_back(compare("6.1.1", "stance: largest deviation of any", "m", "not above 0.007",
                         quantile_of(s.stance.errors, &E::worst_height_m, 1.0), {0.0, 0.007}));
  rows.push_back(compare("Fig. 4.12", "stance: NMSE of height, worst of 60", "", "0.006 and 0.068 (two)",
                         quantile_of(s.stance.errors, &E::nmse_height, 1.0), {0.0, 0.068}));
  rows.push_back(compare("Fig. 4.12", "stance: NMSE of velocity, worst of 60", "", "0.019 and 0.026 (two)",
                         quantile_of(s.stance.errors, &E::nmse_velocity, 1.0), {0.0, 0.026}));
  rows.push_back(
      compare("6.1.1", "simulation error over equation error: mean NMSE(z) + NMSE(z')", "", "slightly better",
              (mean_of(s.stance.errors, &E::nmse_height) + mean_of(s.stance.errors, &E::nmse_velocity)) /
                  (mean_of(s.stance_by_equation.errors, &E::nmse_height) +
                   mean_of(s.stance_by_equation.errors, &E::nmse_velocity)),
              {0.5, 1.0}));
  const double mass_kg = s.stance.value("mass_kg"), weighed_kg = s.rig.weighed_kg;
  rows.push_back(compare(
      "4.2.1", "mass identified in stance over mass weighed", "", "1.554 / 1.62 = 0.959",
      mass_kg / weighed_kg, {0.95, 0.97},
      Reason{
          std::abs(s.effective_stance_mass_kg / mass_kg - 1.0) < 0.02,
          "Both are below 1 for the same cause: with the toe on the ground the links turn instead of moving "
          "with the body. The mean inertia along the stance of this rig's true links is " +
              number(s.effective_stance_mass_kg, 4) + " kg in closed form, " + number(mass_kg, 4) +
              " kg were identified. The document's links take less off."}));
  const auto frequency = [&](const Estimates& e) {
    return damped_frequency_radps(e.value("mass_kg"), s.rig.stiffness_npm, e.value("damping_stance_nspm"));
  };
  const double by_simulation = frequency(s.stance);
  rows.push_back(
      computed("Fig. 4.9", "damping in stance by simulation error", "N s/m", "6.42 (its rig's)",
               s.stance.value("damping_stance_nspm"),
               "The rig here has " + number(s.rig.truth.parameter("damping_stance_nspm"), 3) + " N s/m and " +
                   number(s.rig.truth.effects.at(dynamics::Effect::coulomb_friction)[0], 2) +
                   " N of friction, which no model of the document has: the damping takes it up."));
  rows.push_back(compare(
      "6.1.1", "damping in stance, by equation error less by simulation error, of the latter; rig's velocity",
      "", "significant deviation",
      std::abs(s.stance_by_equation_raw.value("damping_stance_nspm") / s.stance.value("damping_stance_nspm") -
               1.0),
      {0.1, 10.0}));
  rows.push_back(compare("6.1.1, Fig. 4.10", "damped natural frequency, one over the other", "",
                         "closely match", frequency(s.stance_by_equation_raw) / by_simulation, {0.97, 1.03}));
  rows.push_back(computed(
      "6.1.1", "the first with a velocity that is not late", "", "",
      std::abs(s.stance_by_equation.value("damping_stance_nspm") / s.stance.value("damping_stance_nspm") -
               1.0),
      "From the slope of a parabola through neighbouring samples. Differences of counts are "
      "2.5 ms late and noisy; one-step prediction takes that for damping."));
  const auto [slowest, fastest] = std::minmax_element(
      s.variants.begin(), s.variants.end(),
      [](const auto& a, const auto& b) { return a.damped_frequency_radps < b.damped_frequency_radps; });
  const auto [lightest, heaviest] =
      std::minmax_element(s.variants.begin(), s.variants.end(),
                          [](const auto& a, const auto& b) { return a.mass_kg < b.mass_kg; });
  rows.push_back(compare("6.1.1", "mass, spring rate or both identified: spread of the mass", "", "different",
                         heaviest->mass_kg / lightest->mass_kg - 1.0, {0.01, 1.0}));
  rows.push_back(compare("6.1.1", "the same of the damped natural frequency", "", "consistent",
                         fastest->damped_frequency_radps / slowest->damped_frequency_radps - 1.0,
                         {0.0, 0.01}));

  rows.push_back(compare("6.1.1, Fig. 4.14", "flight: height, mean absolute error of 20, mean", "m",
                         "below 0.002", mean_of(s.flight.errors, &E::mae_height_m), {0.0, 0.002}));
  rows.push_back(computed("Fig. 4.15", "flight: NMSE of height, median", "", "0.049 and 0.068 (two)",
                          quantile_of(s.flight.errors, &E::nmse_height, 0.5),
                          "The caption of Fig. 4.15 repeats figures of Fig. 4.12: 53.6 mm/s, 4.8 mm."));
  const double damping = s.flight.value("damping_flight_nspm");
  rows.push_back(computed("4.2.1.1, Fig. 4.13", "damping in flight", "N s/m", "1.18 (its rig's)", damping,
                          "The rig here has " + number(s.rig.truth.parameter("damping_flight_nspm"), 3) +
                              " N s/m; with its friction as a damping that takes the same power " +
                              number(s.equivalent_flight_damping_nspm, 3) + "."));
  rows.push_back(computed("Fig. 4.16", "touch-down: velocity kept", "", "a picture",
                          s.strides.value("restitution_touchdown")));
  rows.push_back(computed("Fig. 4.16", "lift-off: velocity kept", "", "a picture",
                          s.strides.value("restitution_liftoff")));
  rows.push_back(compare("Fig. 4.18", "whole strides: NMSE of height, median of 60", "",
                         "0.0075 (a good one)", quantile_of(s.strides.errors, &E::nmse_height, 0.5),
                         {0.0, 0.0075}));
  rows.push_back(compare("Fig. 4.18", "whole strides: NMSE of velocity, median", "", "0.0123 (a good one)",
                         quantile_of(s.strides.errors, &E::nmse_velocity, 0.5), {0.0, 0.0123}));
  rows.push_back(compare("Fig. 4.18", "NMSE of height that 90 % stay below", "", "0.021 (a poor one)",
                         quantile_of(s.strides.errors, &E::nmse_height, 0.9), {0.0, 0.021}));
  rows.push_back(compare("Fig. 4.18", "NMSE of velocity that 90 % stay below", "", "0.029 (a poor one)",
                         quantile_of(s.strides.errors, &E::nmse_velocity, 0.9), {0.0, 0.029}));
  rows.push_back(compare("Fig. 4.18", "height, mean absolute error, median", "m", "0.0027 (a good one)",
                         quantile_of(s.strides.errors, &E::mae_height_m, 0.5), {0.0, 0.0027}));
  rows.push_back(compare("Fig. 4.18", "velocity, mean absolute error, median", "m/s", "0.0496 (a good one)",
                         quantile_of(s.strides.errors, &E::mae_velocity_mps, 0.5), {0.0, 0.0496}));
  rows.push_back(computed("Fig. 4.17", "NMSE of height of the poorest", "", "a picture",
                          quantile_of(s.strides.errors, &E::nmse_height, 1.0),
                          "Where the switch is furthest off, the torque starts furthest from the predicted "
                          "touch-down."));
  const double linear_error =
      mean_of(s.stance.errors, &E::nmse_height) + mean_of(s.stance.errors, &E::nmse_velocity);
  const double nonlinear_error =
      mean_of(s.nonlinear.errors, &E::nmse_height) + mean_of(s.nonlinear.errors, &E::nmse_velocity);
  rows.push_back(compare(
      "6.1.1, Fig. 4.20", "error of the non-linear model over the linear one's, stance", "", "the same level",
      nonlinear_error / linear_error, {0.8, 1.2},
      Reason{
          mean_of(s.stance.errors, &E::mae_height_m) < 0.002,
          "The links are most of what the linear model misses here, " +
              number(1e3 * mean_of(s.stance.errors, &E::mae_height_m), 2) +
              " mm; beside the 2 mm that the document's rig misses for other causes they would not show."}));
  rows.push_back(compare("6.1.1, Fig. 4.19", "spread of b over the folds, of its mean", "",
                         "relatively large", s.nonlinear.spread("inertia_b_kgm"), {0.05, 100.0}));
  rows.push_back(compare("6.1.1", "change of the fit's cost when 0.1 kg is put on the toe", "",
                         "a minor contribution", s.toe_mass_cost_change, {0.0, 0.001}));
  rows.back().remark =
      "The toe stands still in stance: m, e, b and a may rise together by 1, 2 L, L and 2 L^2 a kilogram and "
      "nothing moves otherwise. From stances alone four of them cannot be told, whatever the data; this "
      "is more than the smallness that the document gives as the reason.";
}

/// Of the best straight line through the loads over the pressing forces.
double line_r2(const std::vector<bench::Holding>& points) {
  const auto n = static_cast<double>(points.size());
  double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const auto& p : points) {
    mx += p.pressing_n / n;
    my += p.load_kg / n;
  }
  for (const auto& p : points) {
    xx += (p.pressing_n - mx) * (p.pressing_n - mx);
    xy += (p.pressing_n - mx) * (p.load_kg - my);
    yy += (p.load_kg - my) * (p.load_kg - my);
  }
  return xy * xy / (xx * yy);
}

void chapter_5(Reproduction& out) {
  auto& rows = out.rows;
  const auto& bench = out.release_catch;
  rows.push_back(compare("5.1, Fig. 5.6", "1 kg, 40 ms: held after the command to catch", "s",
                         "0.020 to 0.050", bench.standard.caught_after_s, {0.020, 0.050}));
  rows.push_back(compare("5.1, Fig. 5.6", "the slowest of varied trials", "s", "0.020 to 0.050",
                         bench.summary.caught_after_worst_s, {0.020, 0.050}));
  rows.push_back(compare("5.1", "holding load over pressing force: R^2 of a straight line", "",
                         "rises with it", line_r2(bench.holding), {0.95, 1.0}));

  // W = integral of k dz d(dz) while the leg folds; dz = A sin(2 pi t / P) rises for P / 4.
  constexpr double kPeriodS = 0.4, kStiffness = 605.0;
  constexpr int kSteps = 1000;
  for (int i = 0; i <= 20; ++i) {
    const double a = 0.005 * i;
    double work = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double phase = 0.5 * std::numbers::pi * (k + 0.5) / kSteps;
      const double rate = a * 2.0 * std::numbers::pi / kPeriodS * std::cos(phase);
      work += kStiffness * a * std::sin(phase) * rate * 0.25 * kPeriodS / kSteps;
    }
    out.contraction_m.push_back(a);
    out.spring_work_j.push_back(work);
  }
  rows.push_back(compare("5.2, Fig. 5.10a", "work against the spring for 10 cm", "J", "as much as 3 of coil",
                         out.spring_work_j.back(), {2.8, 3.2}));
  const auto& e = out.energy;
  rows.push_back(compare("5.2", "flight at an apex of 0.34 m", "s", "about 0.2",
                         e.points.front().caught ? e.points.front().caught->energy.flight_s : std::nan(""),
                         {0.18, 0.22}));
  rows.push_back(
      compare("5.2", "coil at 10 V and 1.5 A for a flight", "J", "about 3", e.published.coil_j, {2.7, 3.3}));
  rows.push_back(compare("5.2, Fig. 5.10b", "1 kg of clutch more, a hop at the same apex", "J", "about 0.35",
                         e.published.mass_j, {0.30, 0.40}));
  rows.push_back(compare("5.2", "break-even by the document's accounting", "m", "near 0.10",
                         e.published.break_even_m, {0.09, 0.11}));
  rows.push_back(computed("5.2", "break-even of the simulated robots, mechanical", "m", "",
                          e.mechanical_m.value_or(std::nan("")),
                          "The coil is held at less than the current that pulls it in, and the energy of the "
                          "folded spring comes back only in part."));
  rows.push_back(computed("5.2", "the same with the motor's copper losses", "m", "",
                          e.electrical_m.value_or(std::nan("")),
                          "Holding a spring folded costs current, which the document leaves out."));
  // Quasi-static: the spring's pull, relaxed at 0.289 m, at the lever of the folded leg.
  const double touchdown_m = 2.0 * kLegLength * std::cos(kStop);
  const auto static_torque = [&](double a) {
    const double length = touchdown_m - a, cosine = length / (2.0 * kLegLength);
    return kStiffness * (0.289 - length) * 2.0 * kLegLength * std::sqrt(1.0 - cosine * cosine);
  };
  const auto& folded = e.points.back().caught;
  const double peak = folded ? folded->energy.peak_torque_flight_nm : std::nan("");
  double at_ten = 0.0;
  while (static_torque(at_ten) < 10.0) at_ten += 1e-4;
  rows.push_back(compare(
      "5.2, Fig. 5.11", "torque to fold by 10 cm against the spring", "N m", "up to 10", peak, {9.0, 11.0},
      Reason{std::abs(static_torque(0.1) / peak - 1.0) < 0.1,
             "Pull times lever of a leg folded by 10 cm is " + number(static_torque(0.1), 3) +
                 " N m in closed form; 10 N m belong to " + number(1e2 * at_ten, 2) + " cm."}));
  rows.push_back(computed(
      "5.2", "the same with the spring let go", "N m", "",
      e.points.back().clutched ? e.points.back().clutched->energy.peak_torque_flight_nm : std::nan("")));
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
  chapter_3(out);

  StudyOptions study;
  study.seed = options.seed;
  study.threads = options.threads;
  study.progress = part(0.02, 0.4);
  out.study = run_identification_study(study);
  chapter_4(out);

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
  chapter_5(out);
  return out;
}

}  // namespace furcula::reproduce
