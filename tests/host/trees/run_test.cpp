// Trees in motion against closed forms: drives, encoders, gravity, bodies with causes in them.
#include "host/trees/run.hpp"

#include <cmath>

#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Cause;
using trees::Effect;

namespace {

constexpr double kWheel_kgm2 = 0.5;
constexpr double kGravity_mps2 = 9.81;

/// What the first joint's encoder reads over the recording, from that reading and velocity.
std::vector<double> readings(const trees::TreeModel& m, const trees::Recording& r,
                             const std::vector<Cause>& causes, std::vector<double> angle_rad,
                             std::vector<double> velocity_radps) {
  const trees::Setup setup = trees::SetupMaker(m).make({m.drives, causes});
  std::vector<double> out(r.rows() * m.joints());
  trees::run(setup, r, 0, r.rows() - 1, angle_rad, velocity_radps, out);
  return out;
}
Cause cause(Effect effect, double a, double b = 0.0, double c = 0.0, double d = 0.0) {
  return {effect, {0}, {a, b, c, d}};
}
/// Largest difference from a motion in closed form.
double apart(const trees::Recording& r, const std::vector<double>& angle_rad,
             const std::function<double(double)>& closed) {
  double worst = 0.0;
  for (std::size_t k = 0; k < r.rows(); ++k)
    worst = std::max(worst, std::abs(angle_rad[k] - closed(r.time_s[k])));
  return worst;
}

const char* const kPosition = "[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 20.0\nkd_nmsprad = 1.5\n";

/// J q'' = kp (c - q) - kd q', from q0 at v0.
double oscillator(double t, double kp, double kd, double c, double q0, double v0) {
  const double decay = 0.5 * kd / kWheel_kgm2, w = std::sqrt(kp / kWheel_kgm2 - decay * decay), x0 = q0 - c;
  return c + std::exp(-decay * t) * (x0 * std::cos(w * t) + (v0 + decay * x0) / w * std::sin(w * t));
}

}  // namespace

TEST_CASE("A position law that is calculated at a rate acts as one that is half a period late") {
  constexpr double kPeriod_s = 0.002, kTarget_rad = 0.3;
  // A torque is held for a period: exact from tick to tick.
  std::vector<double> exact{0.0};
  double q = 0.0, v = 0.5;
  for (int tick = 0; tick < 500; ++tick) {
    const double a = (20.0 * (kTarget_rad - q) - 1.5 * v) / kWheel_kgm2;
    q += v * kPeriod_s + 0.5 * a * kPeriod_s * kPeriod_s;
    v += a * kPeriod_s;
    exact.push_back(q);
  }
  const auto off = [&](const std::string& rate) {
    const trees::TreeModel m = test::wheel(kPosition + rate);
    const trees::Recording r =
        test::inputs(m, 1.0, kPeriod_s, [](std::size_t, double) { return kTarget_rad; });
    const std::vector<double> read = readings(m, r, {}, {0.0}, {0.5});
    double worst = 0.0;
    for (std::size_t k = 0; k < std::min(exact.size(), read.size()); ++k)
      worst = std::max(worst, std::abs(read[k] - exact[k]));
    return worst;
  };
  CHECK(off("") > 1e-3);
  CHECK(off("loop_rate_hz = 500.0\n") < 0.02 * off(""));
  CHECK_THROWS_WITH(test::wheel(kPosition + std::string("loop_rate_hz = 0.0\n")),
                    Catch::Contains("loop_rate_hz") && Catch::Contains("50"));
}

TEST_CASE("Under the torque law a wheel speeds up evenly") {
  const trees::TreeModel m = test::wheel();
  const trees::Recording r = test::inputs(m, 1.0, 0.003, [](std::size_t, double) { return 1.5; });
  CHECK(apart(r, readings(m, r, {}, {0.2}, {-0.4}), [](double t) { return 0.2 - 0.4 * t + 1.5 * t * t; }) <
        1e-12);
  // The rotor's inertia is added, the gain multiplied, an offset and dry friction added.
  const trees::TreeModel geared = test::wheel("[drive]\nrotor_inertia_kgm2 = 0.25\n");
  CHECK(apart(r, readings(geared, r, {}, {0.0}, {0.0}), [](double t) { return t * t; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::rotor_inertia_error, 0.25)}, {0.0}, {0.0}),
              [](double t) { return t * t; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::torque_gain_error, 0.8)}, {0.0}, {0.0}),
              [](double t) { return 1.2 * t * t; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::force_offset, -0.5)}, {0.0}, {0.0}),
              [](double t) { return t * t; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::coulomb_friction, 0.5)}, {0.0}, {0.0}),
              [](double t) { return t * t; }) < 1e-9);
  CHECK(apart(r, readings(m, r, {cause(Effect::load_friction, 1.0 / 3.0)}, {0.0}, {0.0}),
              [](double t) { return t * t; }) < 1e-9);
  CHECK(apart(r, readings(m, r, {cause(Effect::torque_saturation, 1.0)}, {0.0}, {0.0}),
              [](double t) { return t * t; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::torque_saturation, 2.0)}, {0.0}, {0.0}),
              [](double t) { return 1.5 * t * t; }) < 1e-12);
  // Friction of 2 N m holds the wheel where it is.
  CHECK(apart(r, readings(m, r, {cause(Effect::coulomb_friction, 2.0)}, {0.1}, {0.0}),
              [](double) { return 0.1; }) == 0.0);
}

TEST_CASE("Damping and drag slow a wheel down as their laws say") {
  const trees::TreeModel m = test::wheel();
  const trees::Recording r = test::inputs(m, 1.0, 0.003, [](std::size_t, double) { return 0.0; });
  const double rate = 0.6 / kWheel_kgm2;
  CHECK(apart(r, readings(m, r, {cause(Effect::damping_error, 0.6)}, {0.0}, {2.0}),
              [&](double t) { return 2.0 * -std::expm1(-rate * t) / rate; }) < 1e-9);
  const double c = 0.3 / kWheel_kgm2;
  CHECK(apart(r, readings(m, r, {cause(Effect::quadratic_drag, 0.3)}, {0.0}, {2.0}),
              [&](double t) { return std::log1p(2.0 * c * t) / c; }) < 1e-8);
  CHECK(apart(r, readings(m, r, {cause(Effect::asymmetric_friction, 0.2, 0.4)}, {0.0}, {2.0}),
              [](double t) { return 2.0 * t - 0.5 * 0.4 * t * t; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::asymmetric_friction, 0.2, 0.4)}, {0.0}, {-2.0}),
              [](double t) { return -2.0 * t + 0.5 * 0.8 * t * t; }) < 1e-12);
}

TEST_CASE("A delay puts the input off by itself, also where it falls between two rows") {
  const trees::TreeModel m = test::wheel();
  const trees::Recording r =
      test::inputs(m, 1.0, 0.004, [](std::size_t, double t) { return t >= 0.1 - 1e-9 ? 1.5 : 0.0; });
  for (const double delay_s : {0.0, 0.004, 0.0137, 0.05, 0.15}) {
    INFO(delay_s);
    const auto late = [&](double t) {
      const double on = std::max(0.0, t - 0.1 - delay_s);
      return 0.3 * t + 1.5 * on * on;
    };
    CHECK(apart(r, readings(m, r, {cause(Effect::actuator_delay, delay_s)}, {0.0}, {0.3}), late) < 1e-10);
  }
}

TEST_CASE("Where the clocks are apart an input acts before its row, or after it") {
  const trees::TreeModel m = test::wheel();
  const trees::Recording r =
      test::inputs(m, 1.0, 0.004, [](std::size_t, double t) { return t >= 0.1 - 1e-9 ? 1.5 : 0.0; });
  for (const double skew_s : {-0.0963, -0.03, -0.002, 0.0, 0.0137}) {
    INFO(skew_s);
    const auto read = [&](double t) {
      const double on = std::max(0.0, t - 0.1 - skew_s);
      return 0.3 * t + 1.5 * on * on;
    };
    CHECK(apart(r, readings(m, r, {cause(Effect::time_skew, skew_s)}, {0.0}, {0.3}), read) < 1e-10);
  }
}

TEST_CASE("A run that starts in the middle has what was given before in its delay and lag") {
  const trees::TreeModel m = test::wheel();
  const trees::Recording r = test::inputs(
      m, 1.0, 0.004, [](std::size_t, double t) { return std::sin(9.0 * t) + (t > 0.45 ? 1.0 : 0.0); });
  const std::vector<Cause> late{cause(Effect::actuator_delay, 0.0217), cause(Effect::actuator_lag, 0.03)};
  const std::vector<double> all = readings(m, r, late, {0.0}, {0.0});
  // State at row 125 (0.5 s): the velocity by central differences of the run itself at a step of 1 ms.
  const trees::Setup setup = trees::SetupMaker(m).make({m.drives, late});
  const double before = all[125], next = all[126];
  std::vector<double> part(r.rows() - 125);
  double low = -5.0, high = 5.0;  // the velocity that makes the next row
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    trees::run(setup, r, 125, 126, std::vector{before}, std::vector{middle}, part);
    (part[1] < next ? low : high) = middle;
  }
  trees::run(setup, r, 125, r.rows() - 1, std::vector{before}, std::vector{low}, part);
  // The history of six time constants is 0.25 % short: of 1 N m for some hundredths of a second, 1e-4 rad.
  for (std::size_t k = 0; k < part.size(); ++k) CHECK(std::abs(part[k] - all[125 + k]) < 2e-4);
}

TEST_CASE("A lag lets a step through as a filter of first order does") {
  const trees::TreeModel m = test::wheel();
  const trees::Recording r =
      test::inputs(m, 0.5, 0.001, [](std::size_t, double t) { return t >= 0.1 - 1e-9 ? 1.5 : 0.0; });
  constexpr double kLag_s = 0.03;
  const auto closed = [](double t) {
    const double on = std::max(0.0, t - 0.1);
    return 3.0 * (0.5 * on * on - kLag_s * on + kLag_s * kLag_s * -std::expm1(-on / kLag_s));
  };
  // Within a row the torque is held at its mean: position is of second order in rows.
  CHECK(apart(r, readings(m, r, {cause(Effect::actuator_lag, kLag_s)}, {0.0}, {0.0}), closed) < 1e-6);
}

TEST_CASE("Under the position law a wheel swings to the set point as a damped oscillator") {
  const trees::TreeModel m = test::wheel(kPosition);
  const trees::Recording r = test::inputs(m, 1.5, 0.005, [](std::size_t, double) { return 0.7; });
  CHECK(apart(r, readings(m, r, {}, {0.2}, {1.0}),
              [](double t) { return oscillator(t, 20.0, 1.5, 0.7, 0.2, 1.0); }) < 1e-7);
  CHECK(apart(r, readings(m, r, {cause(Effect::position_gain_error, 30.0, 0.5)}, {0.2}, {1.0}),
              [](double t) { return oscillator(t, 30.0, 0.5, 0.7, 0.2, 1.0); }) < 1e-7);
  CHECK(apart(r, readings(m, r, {cause(Effect::torque_gain_error, 0.5)}, {0.2}, {1.0}),
              [](double t) { return oscillator(t, 10.0, 0.75, 0.7, 0.2, 1.0); }) < 1e-7);
  CHECK(apart(r, readings(m, r, {cause(Effect::force_offset, 2.0)}, {0.2}, {1.0}),
              [](double t) { return oscillator(t, 20.0, 1.5, 0.8, 0.2, 1.0); }) < 1e-7);
  // A delay holds the first set point; a later one arrives late.
  const trees::Recording step =
      test::inputs(m, 1.5, 0.005, [](std::size_t, double t) { return t >= 0.2 - 1e-9 ? 0.7 : 0.1; });
  CHECK(apart(step, readings(m, step, {cause(Effect::actuator_delay, 0.0123)}, {0.1}, {0.0}), [](double t) {
          return t < 0.2123 ? 0.1 : oscillator(t - 0.2123, 20.0, 1.5, 0.7, 0.1, 0.0);
        }) < 1e-7);
}

TEST_CASE("A position drive gives no more than its limit") {
  const trees::TreeModel m = test::wheel(kPosition);
  const trees::Recording r = test::inputs(m, 0.4, 0.005, [](std::size_t, double) { return 5.0; });
  // 20 (5 - q) - 1.5 v stays above 2 N m: 2 / 0.5 rad/s^2.
  CHECK(apart(r, readings(m, r, {cause(Effect::torque_saturation, 2.0)}, {0.0}, {0.0}),
              [](double t) { return 2.0 * t * t; }) < 1e-12);
  // A limit that is never reached changes nothing but the steps (1 ms, the middle's torque): second order.
  CHECK(apart(r, readings(m, r, {cause(Effect::torque_saturation, 1e3)}, {0.0}, {0.0}),
              [](double t) { return oscillator(t, 20.0, 1.5, 5.0, 0.0, 0.0); }) < 2e-2);
}

TEST_CASE("An encoder's offset is in what is read, and in what a position drive does") {
  const trees::TreeModel free = test::pendulum();
  const trees::Recording still = test::inputs(free, 1.0, 0.004, [](std::size_t, double) { return 0.0; });
  // It hangs down where 0.1 is read.
  CHECK(apart(still, readings(free, still, {cause(Effect::encoder_offset, 0.1)}, {0.1}, {0.0}),
              [](double) { return 0.1; }) < 1e-12);
  const trees::TreeModel m = test::wheel(kPosition);
  const trees::Recording r = test::inputs(m, 1.0, 0.004, [](std::size_t, double) { return 0.7; });
  CHECK(apart(r, readings(m, r, {cause(Effect::encoder_offset, 0.1)}, {0.2}, {1.0}),
              [](double t) { return oscillator(t, 20.0, 1.5, 0.7, 0.2, 1.0); }) < 1e-7);
}

TEST_CASE("On a base that is tilted a pendulum hangs down still") {
  const trees::TreeModel m = test::pendulum();
  const trees::Recording r = test::inputs(m, 1.0, 0.004, [](std::size_t, double) { return 0.0; });
  // The axis is y: a base that is pitched by p leaves the rod -p from the base's own down.
  CHECK(apart(r, readings(m, r, {cause(Effect::base_tilt, 0.0, 0.2)}, {-0.2}, {0.0}),
              [](double) { return -0.2; }) < 1e-12);
  CHECK(apart(r, readings(m, r, {cause(Effect::base_tilt, 0.3, 0.2)}, {-0.2}, {0.0}),
              [](double) { return -0.2; }) > 1e-3);
  CHECK(apart(r, readings(m, r, {cause(Effect::base_tilt, 0.3, 0.0)}, {0.0}, {0.0}),
              [](double) { return 0.0; }) < 1e-12);
  // R = Ry(pitch) Rx(roll): the third row of R is the vertical in the base's axes.
  const trees::Setup s = trees::SetupMaker(m).make({m.drives, {cause(Effect::base_tilt, 0.3, 0.2)}});
  CHECK(s.model.gravity_mps2.x == Approx(kGravity_mps2 * std::sin(0.2)));
  CHECK(s.model.gravity_mps2.y == Approx(-kGravity_mps2 * std::cos(0.2) * std::sin(0.3)));
  CHECK(s.model.gravity_mps2.z == Approx(-kGravity_mps2 * std::cos(0.2) * std::cos(0.3)));
}

TEST_CASE("Masses, centres, inertias and payloads add up as composite bodies do") {
  const trees::TreeModel m = test::pendulum();
  const auto body = [&](std::vector<Cause> causes) {
    for (Cause& c : causes) c.sites = {test::link(m, "rod")};
    return trees::SetupMaker(m).make({m.drives, causes}).model.body(0);
  };
  // 0.8 kg at 0.3 m, 0.025 kg m^2 about its centre.
  const auto given = body({});
  CHECK(given.inertia_kgm2.yy == Approx(0.025 + 0.8 * 0.09));
  const auto heavy = body({cause(Effect::mass_error, 1.2)});
  CHECK(heavy.mass_kg == Approx(1.2));
  CHECK(heavy.moment_kgm.z == Approx(-0.36));
  CHECK(heavy.inertia_kgm2.yy == Approx(1.5 * (0.025 + 0.8 * 0.09)));
  const auto moved = body({cause(Effect::com_error, 0.02, 0.0, -0.1)});
  CHECK(moved.mass_kg == Approx(0.8));
  CHECK(moved.moment_kgm.x == Approx(0.016));
  CHECK(moved.moment_kgm.z == Approx(-0.32));
  CHECK(moved.inertia_kgm2.yy == Approx(0.025 + 0.8 * (0.16 + 0.0004)));
  CHECK(moved.inertia_kgm2.xz == Approx(0.8 * 0.02 * 0.4));
  const auto wide = body({cause(Effect::inertia_error, 2.0)});
  CHECK(wide.inertia_kgm2.yy == Approx(0.05 + 0.8 * 0.09));
  CHECK(wide.inertia_kgm2.zz == Approx(0.0008));
  const auto loaded = body({cause(Effect::payload, 0.5, 0.1, 0.2, -0.4)});
  CHECK(loaded.mass_kg == Approx(1.3));
  CHECK(loaded.moment_kgm.y == Approx(0.1));
  CHECK(loaded.moment_kgm.z == Approx(-0.24 - 0.2));
  CHECK(loaded.inertia_kgm2.yy == Approx(0.025 + 0.8 * 0.09 + 0.5 * (0.01 + 0.16)));
  CHECK(loaded.inertia_kgm2.xy == Approx(-0.5 * 0.1 * 0.2));
}

TEST_CASE("A fixed link's causes are in its own axes") {
  const trees::TreeModel m = test::double_pendulum();
  const std::size_t elbow = test::joint(m, "elbow"), weight = test::link(m, "weight");
  // Rz(0.1) Ry(0.4) on the lower rod, 0.38 m below the elbow.
  const auto out = [](double x, double y, double z) {
    const double u = std::cos(0.4) * x + std::sin(0.4) * z, w = -std::sin(0.4) * x + std::cos(0.4) * z;
    return std::array{std::cos(0.1) * u - std::sin(0.1) * y, std::sin(0.1) * u + std::cos(0.1) * y, w - 0.38};
  };
  const trees::SetupMaker maker(m);
  const auto given = maker.make({m.drives, {}}).model.body(elbow);
  const auto loaded =
      maker.make({m.drives, {Cause{Effect::payload, {weight}, {0.3, 0.05, -0.04, 0.02}}}}).model.body(elbow);
  const auto at = out(0.05, -0.04, 0.02);
  CHECK(loaded.mass_kg - given.mass_kg == Approx(0.3));
  CHECK(loaded.moment_kgm.x - given.moment_kgm.x == Approx(0.3 * at[0]));
  CHECK(loaded.moment_kgm.y - given.moment_kgm.y == Approx(0.3 * at[1]));
  CHECK(loaded.moment_kgm.z - given.moment_kgm.z == Approx(0.3 * at[2]));
  CHECK(loaded.inertia_kgm2.yy - given.inertia_kgm2.yy == Approx(0.3 * (at[0] * at[0] + at[2] * at[2])));
  const auto shifted = maker.make({m.drives, {Cause{Effect::com_error, {weight}, {0.05, -0.04, 0.02, 0.0}}}})
                           .model.body(elbow);
  CHECK(shifted.mass_kg == Approx(given.mass_kg));
  CHECK(shifted.moment_kgm.x - given.moment_kgm.x == Approx(0.25 * at[0]));
  CHECK(shifted.moment_kgm.z - given.moment_kgm.z == Approx(0.25 * (at[2] + 0.38)));
}

TEST_CASE("A cause at its neutral value changes nothing") {
  for (
      const char* settings :
      {"[drive]\nrotor_inertia_kgm2 = 0.02\n",
       "[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 15.0\nkd_nmsprad = 0.8\nrotor_inertia_kgm2 = 0.02\n"}) {
    const trees::TreeModel m = test::double_pendulum(settings);
    const trees::Recording r = test::inputs(m, 1.0, 0.004, [](std::size_t j, double t) {
      return 0.8 * std::sin((4.0 + static_cast<double>(j)) * t);
    });
    const std::vector<double> plain = readings(m, r, {}, {0.3, -0.4}, {0.5, 0.2});
    std::size_t tried = 0;
    for (const trees::EffectInfo& e : trees::catalogue()) {
      if (e.effect == Effect::position_gain_error && m.drives[0].law == trees::ControlMode::torque) continue;
      for (const std::size_t site : trees::sites(m, e.location_type)) {
        Cause c{e.effect, {site}, {}};
        for (std::size_t k = 0; k < e.parameter_count; ++k) {
          c.values[k] = trees::neutral_value(m, e.effect, k, site);
          if (std::isnan(c.values[k]) && k > 0) c.values[k] = 0.3;
        }
        if (std::isnan(c.values[0])) continue;  // neutral without end: the next test
        if (e.effect == Effect::stribeck_friction) c.values[2] = 0.2;
        INFO(trees::cause_name(m, c));
        const std::vector<double> with = readings(m, r, {c}, {0.3, -0.4}, {0.5, 0.2});
        double worst = 0.0;
        for (std::size_t k = 0; k < with.size(); ++k) worst = std::max(worst, std::abs(with[k] - plain[k]));
        CHECK(worst < 1e-9);
        ++tried;
      }
    }
    CHECK(tried > 30);
  }
}

TEST_CASE("A limit far above the torque and a spring that is very stiff change next to nothing") {
  const trees::TreeModel m = test::wheel("[drive]\nrotor_inertia_kgm2 = 0.1\n");
  const trees::Recording r =
      test::inputs(m, 0.6, 0.004, [](std::size_t, double t) { return std::sin(5.0 * t); });
  const std::vector<double> plain = readings(m, r, {}, {0.0}, {0.0});
  for (const Cause& c : {cause(Effect::torque_saturation, 50.0), cause(Effect::joint_elasticity, 1e5)}) {
    const std::vector<double> with = readings(m, r, {c}, {0.0}, {0.0});
    for (std::size_t k = 0; k < plain.size(); ++k) CHECK(std::abs(with[k] - plain[k]) < 2e-5);
  }
}

TEST_CASE("The torque ripple goes with the joint's angle as it is read") {
  // On a wheel that is turned evenly at 2 rad/s a ripple of a few mN m: q'' = A sin(n w t + p) / J.
  const trees::TreeModel m = test::wheel();
  const trees::Recording r = test::inputs(m, 1.0, 0.004, [](std::size_t, double) { return 0.0; });
  constexpr double kAmplitude_nm = 1e-3, kCycles = 6.0, kPhase_rad = 0.4, kSpeed_radps = 2.0,
                   kRate = kCycles * kSpeed_radps;
  CHECK(apart(r,
              readings(m, r, {cause(Effect::torque_ripple, kAmplitude_nm, kCycles, kPhase_rad)}, {0.0},
                       {kSpeed_radps}),
              [&](double t) {
                const double s = std::sin(kPhase_rad), c = std::cos(kPhase_rad),
                             a = kAmplitude_nm / kWheel_kgm2 / kRate;
                return kSpeed_radps * t + a * (c * t - (std::sin(kRate * t + kPhase_rad) - s) / kRate);
              }) < 1e-6);
}
