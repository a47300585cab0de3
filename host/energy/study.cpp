// When the clutch pays, see study.hpp.
#include "host/energy/study.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::energy {
namespace {

/// What a variant changes on the robot with the clutch.
struct Change {
  double hold_duty = -1.0;                                                    ///< below 0: as it is
  double coil_resistance = 1.0, cable_mass = 1.0, auxiliary_stiffness = 1.0;  ///< factors
  double clutch_mass_kg = 0.0;                                                ///< more
};

sim::Scenario hopping(const Options& o, double contraction_m, bool release) {
  sim::Scenario s;
  s.start_position = o.apex_m;
  s.period_s = o.period_s;
  s.amplitude = 2.0;
  s.contraction_m = contraction_m;
  s.release_in_flight = release;
  return s;
}

Robot caught_robot(const model::Model& model, const Options& o, double contraction_m) {
  model::Model without = model;
  without.clutch.reset();
  const sim::Scenario s = hopping(o, contraction_m, false);
  return {sim::rig_config(without, s, 1), sim::controller_config(without, s)};
}

Robot clutched_robot(const model::Model& model, const Options& o, double contraction_m,
                     const Change& change) {
  model::Model with = model;
  with.parameters[*dynamics::parameter_index(with.kind, "mass_kg")] +=
      o.clutch_mass_kg + change.clutch_mass_kg;
  with.clutch->auxiliary_stiffness_npm *= change.auxiliary_stiffness;
  const sim::Scenario s = hopping(o, contraction_m, contraction_m > 0.0);
  Robot r{sim::rig_config(with, s, 1), sim::controller_config(with, s)};
  auto clutch = sim::clutch_of(with);
  clutch.solenoid.resistance_ohm *= change.coil_resistance;
  clutch.cable_mass_kg *= change.cable_mass;
  r.rig.plant = sim_host::Plant(dynamics::from_table<dynamics::HopperNonlinearParameters<double>>(
                                    std::span<const double>(with.parameters)),
                                clutch);
  r.rig.coil_supply_v *= change.coil_resistance;  // the same current
  if (change.hold_duty >= 0.0) {
    r.config.coil.hold_duty = static_cast<float>(change.hold_duty);
    r.config.coil.heat_max = 10.0f;  // whatever the coil would say to it
  }
  return r;
}

/// All three robots at `options.points` contractions, evenly from none to the largest.
std::vector<Point> sweep(const model::Model& model, const Options& o) {
  std::vector<Point> points(o.points);
  for (std::size_t i = 0; i < o.points; ++i)
    points[i].contraction_m =
        o.most_contraction_m *
        (o.points > 1 ? static_cast<double>(i) / static_cast<double>(o.points - 1) : 1.0);
  constexpr std::size_t kRobots = 3;
  core::parallel_for(kRobots * o.points, o.threads, [&](std::size_t i) {
    Point& p = points[i / kRobots];
    const double contraction_m = p.contraction_m;
    const auto settled = [&](const Robot& robot) { return energy_at_apex(robot, o.motor, o.apex_m); };
    if (i % kRobots == 0)
      p.caught = settled(caught_robot(model, o, contraction_m));
    else if (i % kRobots == 1)
      p.clutched = settled(clutched_robot(model, o, contraction_m, {}));
    else
      p.springless = settled(springless_robot(model, hopping(o, contraction_m, false)));
  });
  return points;
}

/// The same with a robot with the clutch that is changed; the others stay what they are.
std::vector<Point> changed(std::vector<Point> points, const model::Model& model, const Options& o,
                           const Change& change) {
  core::parallel_for(points.size(), o.threads, [&](std::size_t i) {
    points[i].clutched =
        energy_at_apex(clutched_robot(model, o, points[i].contraction_m, change), o.motor, o.apex_m);
  });
  return points;
}

}  // namespace

Robot springless_robot(const model::Model& model, const sim::Scenario& scenario) {
  Robot r{sim::rig_config(model, scenario, 1), sim::controller_config(model, scenario)};
  auto p = dynamics::from_table<dynamics::HopperNonlinearParameters<double>>(
      std::span<const double>(model.parameters));
  // Paid out by more than any leg can fold: the controller pushes with all that the spring would.
  r.rig.cable_loose_m = p.rest_height_m;
  r.config.supervisor.cable_travel_max_m = static_cast<float>(p.rest_height_m) + 0.01f;
  p.stiffness_npm = 0.0;
  r.rig.plant = sim_host::Plant(p);
  return r;
}

double cost_j(const HopEnergy& e, Measure measure) {
  return e.motor_pushed + e.coil + (measure == Measure::electrical ? e.motor_copper : 0.0);
}

std::optional<double> break_even_m(const std::vector<Point>& points, Measure measure,
                                   std::optional<Settled> Point::*one, std::optional<Settled> Point::*other) {
  std::optional<double> after_at, after_gain;
  for (auto p = points.rbegin(); p != points.rend(); ++p) {
    const auto &cheaper = (*p).*one, &dearer = (*p).*other;
    if (!cheaper || !dearer) continue;
    const double gain = cost_j(dearer->energy, measure) - cost_j(cheaper->energy, measure);
    if (gain < 0.0) {
      if (!after_at) return std::nullopt;
      return p->contraction_m + (*after_at - p->contraction_m) * gain / (gain - *after_gain);
    }
    after_at = p->contraction_m;
    after_gain = gain;
  }
  return after_at;
}

Study run_study(const model::Model& model, const Options& options) {
  if (!dynamics::has(model.kind, dynamics::LocationType::heavy_links) || !model.clutch)
    throw core::DataError(
        "the model has no clutch; expected a hopper_nonlinear with a tooth_pitch_m above 0");
  if (!model.effects.empty())
    throw core::DataError("the model: [effect." +
                          std::string(dynamics::info(model.effects.begin()->first).name) +
                          "]; expected none: what a drive or a friction costs beside is not told apart");
  if (!dynamics::NonlinearHopper<double>::resolves(
          dynamics::from_table<dynamics::HopperNonlinearParameters<double>>(
              std::span<const double>(model.parameters))))
    throw core::DataError(
        "the model: inertia_a_kgm2, inertia_b_kgm and inertia_e_kgm are too small, or no links'; expected those of links");
  const auto tell = [&](double fraction, std::string_view doing) {
    if (options.progress) options.progress(fraction, doing);
  };
  Study out;
  out.options = options;
  tell(0.0, "contractions");
  out.points = sweep(model, options);
  out.mechanical_m = break_even_m(out.points, Measure::mechanical);
  out.electrical_m = break_even_m(out.points, Measure::electrical);
  const auto springless = [&](Measure measure) {
    return break_even_m(out.points, measure, &Point::springless, &Point::caught);
  };
  out.springless_mechanical_m = springless(Measure::mechanical);
  out.springless_electrical_m = springless(Measure::electrical);

  // As published: without the robot's own motion but for its flight time and the price of its mass.
  const Point& still = out.points.front();
  if (still.caught && still.clutched) {
    const auto clutch = sim::clutch_of(model);
    const double supply_v = caught_robot(model, options, 0.0).rig.coil_supply_v;
    const double power_w = supply_v * supply_v / clutch.solenoid.resistance_ohm;
    const double stiffness = model.parameter("stiffness_npm");
    out.published.coil_j = power_w * still.caught->energy.flight_s;
    out.published.mass_j = still.clutched->energy.motor_work - still.caught->energy.motor_work;
    out.published.break_even_m = std::sqrt(2.0 * out.published.coil_j / stiffness);
    out.published.break_even_with_mass_m =
        std::sqrt(2.0 * (out.published.coil_j + std::max(0.0, out.published.mass_j)) / stiffness);
  }

  struct Named {
    const char* what;
    Change change;
  };
  const Named all[] = {{"coil at full supply all the time", {.hold_duty = 1.0}},
                       {"hold current a quarter less",
                        {.hold_duty = 0.75 * static_cast<double>(control::CoilConfig{}.hold_duty)}},
                       {"coil of half the resistance, same current", {.coil_resistance = 0.5}},
                       {"moving cable twice as heavy", {.cable_mass = 2.0}},
                       {"auxiliary spring twice as stiff", {.auxiliary_stiffness = 2.0}},
                       {"clutch half a kilogram lighter", {.clutch_mass_kg = -0.5}},
                       {"clutch half a kilogram heavier", {.clutch_mass_kg = 0.5}}};
  // Every other contraction will do, where the last one is one of them.
  std::vector<Point> coarse;
  const std::size_t stride = options.points > 10 && options.points % 2 == 1 ? 2 : 1;
  for (std::size_t i = 0; i < out.points.size(); i += stride) coarse.push_back(out.points[i]);
  for (std::size_t i = 0; i < std::size(all); ++i) {
    tell(0.4 + 0.6 * static_cast<double>(i) / static_cast<double>(std::size(all)), all[i].what);
    const std::vector<Point> points = changed(coarse, model, options, all[i].change);
    out.variants.push_back(
        {all[i].what, break_even_m(points, Measure::mechanical), break_even_m(points, Measure::electrical)});
  }
  tell(1.0, "done");
  return out;
}

}  // namespace furcula::energy
