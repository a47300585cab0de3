// Runs in lanes, against the same runs one by one: the first has their bits, the others their differences from it.
#include <cmath>

#include "host/trees/batch_runner.hpp"
#include "host/trees/led_batch.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Cause;
using trees::Effect;

namespace {

using Batch = trees::LedBatch<double, 8>;

struct Case {
  const char* what;
  const char* law;
  double amplitude;
  std::vector<Cause> as_run;
  double step = 1e-6;    ///< of each cause's values, by their size
  double within = 1e-4;  ///< of the differences' largest
};

const char* const kTorque = "[drive]\ncontrol_mode = \"torque\"\n";
const char* const kPosition = "[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 20.0\nkd_nmsprad = 0.5\n";
const char* const kWithRotor = "[drive]\ncontrol_mode = \"torque\"\nrotor_inertia_kgm2 = 0.01\n";

/// Numbers of a run from a start: what the encoders read.
std::vector<double> readings(std::span<const trees::Run> runs, const trees::Recording& r,
                             std::size_t joints) {
  std::vector<double> out(runs.size() * r.rows() * joints);
  trees::run(runs, r, 0, r.rows() - 1, out);
  return out;
}

}  // namespace

TEST_CASE("Sines and cosines of a batch are those of its numbers, near the first and far from it") {
  for (const double first : {0.0, 0.3, -2.0, 1e3})
    for (const double apart : {1e-9, 1e-3, 0.099, 0.11, 3.0}) {
      Batch x(first);
      for (std::size_t i = 1; i < 8; ++i)
        x.lanes.set(i, first + apart * (static_cast<double>(i) - 4.5) / 3.5);
      const Batch s = sin(x), c = cos(x);
      CHECK(s.lanes[0] == std::sin(first));
      CHECK(c.lanes[0] == std::cos(first));
      for (std::size_t i = 1; i < 8; ++i) {
        CHECK(s.lanes[i] == Approx(std::sin(x.lanes[i])).margin(4e-16));
        CHECK(c.lanes[i] == Approx(std::cos(x.lanes[i])).margin(4e-16));
      }
    }
}

TEST_CASE("Lanes whose change would be far from the first one's keep to the step") {
  Batch time(1e-3), step(2e-3);
  time.lanes.set(1, 1.5e-3);
  time.lanes.set(2, 0.3);
  time.lanes.set(3, -0.3);
  const Batch kept = inside_step(time, step);
  CHECK(kept.lanes[0] == 1e-3);
  CHECK(kept.lanes[1] == 1.5e-3);
  CHECK(kept.lanes[2] == 2e-3);
  CHECK(kept.lanes[3] == 0.0);
}

TEST_CASE("Runs in lanes are those runs") {
  const std::vector<Case> cases{
      {"bodies alone", kTorque, 0.8, {{Effect::mass_error, {2}, {1.2, 0, 0, 0}}}},
      {"friction, joints that stop and set out",
       kTorque,
       0.8,
       {{Effect::coulomb_friction, {0}, {0.1, 0, 0, 0}},
        {Effect::coulomb_friction, {1}, {0.15, 0, 0, 0}},
        {Effect::asymmetric_friction, {2}, {0.05, 0.1, 0, 0}}},
       // A joint that rests loses what lanes differ by in velocity; when it stops is right to first order.
       1e-6,
       1e-3},
      {"a curve of friction, and a spot",
       kTorque,
       0.8,
       {{Effect::stribeck_friction, {0}, {0.1, 0.2, 1.0, 0}},
        {Effect::binding_spot, {1}, {0.1, 0.05, 0.2, 0}},
        {Effect::load_friction, {2}, {0.1, 0, 0, 0}}},
       1e-6,
       1e-3},
      {"position drives with lag, limit and ripple",
       kPosition,
       0.6,
       {{Effect::actuator_lag, {1}, {0.02, 0, 0, 0}},
        {Effect::torque_saturation, {0}, {3.0, 0, 0, 0}},
        {Effect::torque_ripple, {2}, {0.1, 7.0, 0.3, 0}},
        {Effect::position_gain_error, {2}, {21.0, 0.6, 0, 0}},
        {Effect::load_friction, {1}, {0.05, 0, 0, 0}}},
       1e-6,
       1e-3},
      {"offsets, drag, tilt, gain, and a delay that all have",
       kTorque,
       0.8,
       {{Effect::encoder_offset, {0}, {0.01, 0, 0, 0}},
        {Effect::force_offset, {1}, {0.1, 0, 0, 0}},
        {Effect::quadratic_drag, {2}, {0.01, 0, 0, 0}},
        {Effect::torque_gain_error, {0}, {1.1, 0, 0, 0}},
        {Effect::base_tilt, {0}, {0.02, -0.01, 0, 0}},
        {Effect::actuator_delay, {2}, {0.013, 0, 0, 0}}}},
      {"an elastic drive", kWithRotor, 0.8, {{Effect::joint_elasticity, {1}, {200.0, 0, 0, 0}}}, 1e-5, 1e-3}};
  for (const Case& c : cases) {
    INFO(c.what);
    const trees::TreeModel model = test::arm3(c.law);
    const std::size_t n = model.joints();
    const trees::Recording r = test::inputs(model, 0.5, 0.004, [&](std::size_t j, double t) {
      return c.amplitude * std::sin((5.0 + 2.0 * static_cast<double>(j)) * t);
    });
    const trees::SetupMaker maker(model);
    const trees::Setup base = maker.make({model.drives, c.as_run, {}, 0.2});
    const std::vector<double> q{0.2, -0.3, 0.4}, v{1.0, 2.0, -3.0};
    std::vector<trees::Setup> setups;
    std::vector<double> steps;
    for (std::size_t k = 0; k < c.as_run.size(); ++k)
      for (std::size_t p = 0; p < 4; ++p) {
        if (c.as_run[k].values[p] == 0.0 || c.as_run[k].effect == Effect::actuator_delay) continue;
        std::vector<Cause> moved = c.as_run;
        steps.push_back(c.step * std::abs(c.as_run[k].values[p]));
        moved[k].values[p] += steps.back();
        setups.push_back(maker.make({model.drives, moved, {}, 0.2}));
      }
    // Inputs that act a little later.
    steps.push_back(1e-6);
    setups.push_back(maker.make({model.drives, c.as_run, {}, 0.2 + steps.back()}));
    // Starts beside the first one, too; so many that there are two batches.
    std::vector<std::vector<double>> q_at(n, q), v_at(n, v);
    for (std::size_t j = 0; j < n; ++j) {
      q_at[j][j] += 1e-7;
      v_at[j][j] += 1e-6;
      steps.push_back(1e-7);
      steps.push_back(1e-6);
    }
    std::vector<trees::Run> runs{{&base, q, v}};
    for (const trees::Setup& s : setups) {
      CHECK(trees::BatchRunner::fits(base, s));
      runs.push_back({&s, q, v});
    }
    for (std::size_t j = 0; j < n; ++j) {
      runs.push_back({&base, q_at[j], v});
      runs.push_back({&base, q, v_at[j]});
    }
    const std::vector<double> together = readings(runs, r, n);
    const std::size_t size = together.size() / runs.size();
    std::vector<std::vector<double>> alone;
    for (const trees::Run& one : runs) alone.push_back(readings(std::span(&one, 1), r, n));
    bool same_bits = true;
    for (std::size_t x = 0; x < size; ++x) same_bits &= together[x] == alone[0][x];
    CHECK(same_bits);
    for (std::size_t k = 1; k < runs.size(); ++k) {
      double most = 0.0, off = 0.0;
      for (std::size_t x = 0; x < size; ++x) {
        const double by_itself = (alone[k][x] - alone[0][x]) / steps[k - 1],
                     in_lanes = (together[k * size + x] - together[x]) / steps[k - 1];
        most = std::max(most, std::abs(by_itself));
        off = std::max(off, std::abs(in_lanes - by_itself));
      }
      INFO("run " << k << ": " << off << " of " << most);
      CHECK(most > 0.0);
      CHECK(off < c.within * most);
    }
  }
}

TEST_CASE(
    "Runs of which one has a law that the first lacks, or another delay or geometry, are not beside it") {
  const trees::TreeModel model = test::arm3(kTorque);
  const trees::SetupMaker maker(model);
  const auto with = [&](const std::vector<Cause>& causes) { return maker.make({model.drives, causes}); };
  const trees::Setup base = with({});
  for (const Cause& c : {Cause{Effect::coulomb_friction, {0}, {0.1, 0, 0, 0}},
                         Cause{Effect::actuator_delay, {1}, {0.01, 0, 0, 0}},
                         Cause{Effect::actuator_lag, {1}, {0.01, 0, 0, 0}},
                         Cause{Effect::quadratic_drag, {2}, {0.01, 0, 0, 0}},
                         Cause{Effect::length_error, {1}, {0.01, 0, 0, 0}},
                         Cause{Effect::torque_ripple, {0}, {0.1, 7.0, 0.3, 0}}}) {
    INFO(static_cast<int>(c.effect));
    CHECK_FALSE(trees::BatchRunner::fits(base, with({c})));
  }
  CHECK(trees::BatchRunner::fits(base, with({{Effect::mass_error, {1}, {2.0, 0, 0, 0}}})));
  // They are run all the same.
  const trees::Recording r =
      test::inputs(model, 0.2, 0.004, [](std::size_t, double t) { return std::sin(9.0 * t); });
  const std::vector<double> q{0.2, -0.3, 0.4}, v{1.0, 2.0, -3.0};
  const trees::Setup rough = with({{Effect::coulomb_friction, {0}, {0.1, 0, 0, 0}}}),
                     heavy = with({{Effect::mass_error, {1}, {2.0, 0, 0, 0}}}),
                     light = with({{Effect::mass_error, {1}, {0.5, 0, 0, 0}}});
  const trees::Run runs[] = {{&base, q, v}, {&heavy, q, v}, {&rough, q, v}, {&light, q, v}};
  const std::vector<double> all = readings(runs, r, 3);
  const std::size_t size = all.size() / 4;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<double> alone = readings(std::span(&runs[k], 1), r, 3);
    double off = 0.0;
    for (std::size_t x = 0; x < size; ++x) off = std::max(off, std::abs(all[k * size + x] - alone[x]));
    CHECK(off < 1e-12);
  }
}
