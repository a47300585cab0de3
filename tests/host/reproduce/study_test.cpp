// The identification study: the rig is drawn, the fits do not see its truth, the plain way agrees.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/identify/windows.hpp"
#include "host/reproduce/identification_rows.hpp"
#include "host/reproduce/plain_fit.hpp"
#include "host/sim/simulate.hpp"

using namespace furcula;
using namespace furcula::reproduce;

namespace {

StudyOptions small(std::uint64_t seed) {
  StudyOptions o;
  o.seed = seed;
  o.stances = 12;
  o.flights = 6;
  o.stance_folds = 4;
  o.flight_folds = 3;
  o.plain = false;
  return o;
}

void set(model::Model& m, std::string_view name, double value) {
  m.parameters[*dynamics::parameter_index(m.kind, name)] = value;
}

}  // namespace

TEST_CASE("Rigs differ by their seed, and recordings among themselves") {
  const VirtualRig a = draw_rig(1, 3, 2), b = draw_rig(2, 3, 2), again = draw_rig(1, 3, 2);
  CHECK(a.truth.parameters != b.truth.parameters);
  CHECK(a.truth.parameters == again.truth.parameters);
  CHECK(a.stance_logs[0].at("height_m") == again.stance_logs[0].at("height_m"));
  CHECK(a.stance_logs[0].at("height_m") != a.stance_logs[1].at("height_m"));
  CHECK(a.weighed_kg != a.truth.parameter("mass_kg"));
}

TEST_CASE(
    "A drawn machine_type is identified: what the links do to the mass, what friction does to the damping") {
  for (const std::uint64_t seed : {11u, 12u}) {
    const IdentificationStudy s = run_identification_study(small(seed));
    INFO("seed " << seed);
    // The mass that height feels in stance, from the true links in closed form; the fit knows no links.
    CHECK(s.stance.value("mass_kg") == Approx(s.effective_stance_mass_kg).epsilon(0.03));
    CHECK(s.stance.value("mass_kg") < 0.97 * s.rig.weighed_kg);
    // Friction is no viscous damping: a fit of heights weighs it otherwise than its power does.
    CHECK(s.flight.value("damping_flight_nspm") == Approx(s.equivalent_flight_damping_nspm).epsilon(0.3));
    CHECK(s.flight.value("damping_flight_nspm") > s.rig.truth.parameter("damping_flight_nspm"));
    // sqrt(k/m) sqrt(1 - xi^2) stays put whichever of mass and spring rate is held (section 6.1.1).
    REQUIRE(s.variants.size() == 3);
    for (const auto& v : s.variants)
      CHECK(v.damped_frequency_radps == Approx(s.variants[0].damped_frequency_radps).epsilon(0.01));
    CHECK(std::abs(s.variants[1].mass_kg / s.variants[0].mass_kg - 1.0) > 0.03);
    // Plastic impacts of links that are not in the linear model.
    CHECK(s.strides.value("restitution_touchdown") > 0.8);
    CHECK(s.strides.value("restitution_touchdown") < 1.0);
    CHECK(s.toe_mass_cost_change < 1e-3);
    REQUIRE(s.stance.errors.size() == 12);
    REQUIRE(s.flight.errors.size() == 6);
    double linear = 0.0, nonlinear = 0.0;
    for (const auto& e : s.stance.errors) linear += e.nmse_height;
    for (const auto& e : s.nonlinear.errors) nonlinear += e.nmse_height;
    CHECK(nonlinear < linear);
  }
}

TEST_CASE("The document's filter, forwards and back, halves 15 Hz, keeps 2 Hz, and delays neither") {
  for (const auto& [hz, gain] : {std::pair{15.0, 0.5}, std::pair{2.0, 1.0}, std::pair{60.0, 0.0}}) {
    std::vector<double> time_s, height_m;
    for (int i = 0; i <= 2000; ++i) {
      time_s.push_back(1e-3 * i);
      height_m.push_back(0.01 * std::sin(2.0 * M_PI * hz * 1e-3 * i));
    }
    const auto v = filtered_velocity(time_s, height_m);
    // The differences' own gain: sin(w dt) / (w dt).
    const double peak_mps = 0.01 * std::sin(2.0 * M_PI * hz * 1e-3) / 1e-3;
    for (int i = 800; i < 1200; ++i)
      REQUIRE(v[i] ==
              Approx(gain * peak_mps * std::cos(2.0 * M_PI * hz * 1e-3 * i)).margin(0.005 * peak_mps));
  }
}

TEST_CASE("What is switched on a machine_type is switched, and nothing else is drawn otherwise") {
  const VirtualRig a = draw_rig(1, 3, 2);
  const VirtualRig b =
      draw_rig(1, 3, 2, {.weightless_links = true, .exact_positions = true, .friction_n = 2.5});
  CHECK(b.weighed_kg == a.weighed_kg);
  CHECK(b.stiffness_npm == a.stiffness_npm);
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(b.stance_experiments[i].amplitude_nm == a.stance_experiments[i].amplitude_nm);
  CHECK(b.truth.parameter("inertia_a_kgm2") == 0.0);
  CHECK(b.truth.parameter("damping_stance_nspm") == a.truth.parameter("damping_stance_nspm"));
  CHECK(b.truth.effects.at(dynamics::Effect::coulomb_friction)[0] == 2.5);
}

TEST_CASE("The reasons beside the identification are figures of the rig with the cause switched") {
  StudyOptions o = small(11);
  const auto rows_of = [&](double friction_n) {
    o.change.friction_n = friction_n;
    StudyOptions base = o;
    const IdentificationStudy study = run_identification_study(base);
    return std::pair{study, identification_rows(study, run_switched_studies(o))};
  };
  const auto row = [](const std::vector<Row>& rows, const char* what) {
    for (const Row& r : rows)
      if (r.what == what) return r;
    FAIL("no row " << what);
    return Row{};
  };
  const auto [study, rows] = rows_of(0.4);
  const auto [rough, rough_rows] = rows_of(1.2);

  // A point mass moves as the linear model does: its mass is the one that was weighed.
  const Row mass = row(rows, "mass identified in stance over mass weighed");
  CHECK(mass.ours < 0.95);
  REQUIRE(mass.counterfactuals.size() == 5);
  CHECK(mass.counterfactuals[0].value == Approx(1.0).margin(0.02));
  // Differences of counts over 5 ms are those of 2.5 ms ago (docs of the log).
  CHECK(study.recorded_delay_s == Approx(2.5e-3).margin(0.5e-3));

  // Another rig, other figures; without friction what is left is the rig's own damping, whatever the friction was.
  const char* damping = "damping in stance by simulation error";
  CHECK(row(rows, damping).remark.find("0.40 N of dry friction") != std::string::npos);
  CHECK(row(rough_rows, damping).remark.find("1.2 N of dry friction") != std::string::npos);
  CHECK(row(rough_rows, damping).ours > row(rows, damping).ours);
  CHECK(row(rows, damping).counterfactuals[0].value == row(rough_rows, damping).counterfactuals[0].value);
  const char* flight = "damping in flight";
  CHECK(row(rows, flight).counterfactuals[0].value ==
        Approx(study.rig.truth.parameter("damping_flight_nspm")).margin(0.15));

  // Judged by a velocity that is 2.5 ms late a perfect prediction is off by that times the acceleration.
  for (const Row& r : rows)
    if (r.what == "stance: velocity, MAE, a good one; median" && r.outcome == Outcome::smaller) {
      REQUIRE(!r.counterfactuals.empty());
      CHECK(r.counterfactuals[0].what.find("velocity that the rig records") != std::string::npos);
      CHECK(r.counterfactuals[0].value > 1.5 * r.ours);
    }
  for (const Row& r : rows)
    if (r.outcome == Outcome::smaller) {
      INFO(r.what << ": " << r.remark);
      CHECK(r.counterfactuals.size() == 6);
    }
}

TEST_CASE("A study is the same on any number of threads") {
  StudyOptions o = small(5);
  const IdentificationStudy one = run_identification_study(o);
  o.threads = 3;
  const IdentificationStudy three = run_identification_study(o);
  CHECK(one.stance.folds == three.stance.folds);
  CHECK(one.strides.folds == three.strides.folds);
  CHECK(one.nonlinear.values == three.nonlinear.values);
}

TEST_CASE("The plain way finds the parameters of ideal recordings, of both models") {
  for (const auto kind : {dynamics::Kind::hopper_linear, dynamics::Kind::hopper_nonlinear}) {
    VirtualRig rig = draw_rig(7, 1, 1);
    model::Model truth = rig.truth;
    truth.effects.clear();
    truth.kind = kind;
    truth.parameters.resize(dynamics::info(kind).parameters.size());
    std::vector<log::Log> logs;
    for (const double period_s : {0.27, 0.30, 0.33}) {
      sim::Scenario s = sim::default_scenario(truth);
      s.start_position = 0.35;
      s.duration_s = 0.75;
      s.amplitude = 2.0;
      s.period_s = period_s;
      logs.push_back(sim::simulate(truth, s, 1));
    }
    model::Model m = truth;
    m.free[*dynamics::parameter_index(kind, "mass_kg")] = {0.5, 3.0};
    m.free[*dynamics::parameter_index(kind, "damping_stance_nspm")] = {0.0, 50.0};
    set(m, "mass_kg", 1.4);
    set(m, "damping_stance_nspm", 3.0);
    const auto recordings = identify::make_recordings(logs, kind);
    std::vector<identify::Window> windows;
    for (std::size_t i = 0; i < recordings.size(); ++i)
      windows.push_back(identify::stances(recordings[i], i, m).at(0));
    const auto unknowns = identify::free_unknowns(m);
    const PlainFit fit = fit_plainly(m, unknowns, identify::values_in(m, unknowns), recordings, windows);
    // The recorded torque is held from row to row, the plain way draws it straight: half a row apart.
    CHECK(fit.values[0] == Approx(truth.parameter("mass_kg")).epsilon(0.01));
    CHECK(fit.values[1] == Approx(truth.parameter("damping_stance_nspm")).epsilon(0.03));
    CHECK(fit.evaluations > 5);
  }
}

TEST_CASE(
    "The engine and the plain way each fit best by their own cost: starts fitted, and starts as measured") {
  StudyOptions o = small(1);
  o.plain = true;
  const IdentificationStudy s = run_identification_study(o);
  REQUIRE(s.plain.size() == 3);
  const PlainStudy& stance = s.plain.front();
  CHECK(stance.ours_nmse_fitted < stance.plain_nmse_fitted);
  CHECK(stance.plain_nmse_measured < stance.ours_nmse_measured);
  // A start that may move never leaves more.
  for (const PlainStudy& p : s.plain) {
    CAPTURE(p.estimates.phase);
    CHECK(p.ours_nmse_fitted < p.ours_nmse_measured);
    CHECK(p.plain_nmse_fitted < p.plain_nmse_measured);
    CHECK(p.ours_nmse_fitted <= p.plain_nmse_fitted * (1.0 + 1e-4));
  }
}
