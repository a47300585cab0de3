// The four stages joined: against closed forms, and each effect in the stage that the catalogue says and in
// no other.
#include "furcula/dynamics/stages.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/simple_clutch_bench.hpp"
#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;

namespace {

constexpr double kStep_s = 1e-3;

/// Commands at even instants.
struct Recorded {
  std::vector<double> time_s, command, impulse, driven_s;
  void add(double value) {
    const bool first = command.empty();
    impulse.push_back(first ? 0.0 : impulse.back() + command.back() * kStep_s);
    driven_s.push_back(first ? 0.0 : driven_s.back() + (command.back() != 0.0 ? kStep_s : 0.0));
    time_s.push_back(kStep_s * static_cast<double>(command.size()));
    command.push_back(value);
  }
  Commands<double> view() const { return {time_s, command, impulse, driven_s}; }
};

/// A step of the command from zero, in the row `at`.
Recorded step_of(double value, int at, int rows) {
  Recorded out;
  for (int n = 0; n <= rows; ++n) out.add(n < at ? 0.0 : value);
  return out;
}

Recorded swings(int rows) {
  Recorded out;
  for (int n = 0; n <= rows; ++n) out.add(0.4 + 2.0 * std::sin(0.05 * n));
  return out;
}

}  // namespace

TEST_CASE("A late drive on a free joint with an encoder off its zero moves as the closed form says") {
  // No gravity, no friction: angle = torque (t - delay)^2 / (2 I) after the delay, and it is measured with
  // the offset.
  const double inertia = 0.2, torque = 1.5, delay = 7.3e-3, offset = 0.11, start = 0.4;
  Effects<double> effects;
  effects.set(Effect::actuator_delay, 0, delay);
  effects.set(Effect::encoder_offset, 0, offset);
  Stages stages(RotaryJoint<double>({inertia, 0.0, 0.0}, effects), effects);
  stages.reset(start, 0.0);
  CHECK(stages.plant().position() == Approx(start - offset));
  const Recorded r = step_of(torque, 20, 100);
  stages.actuation().drive.start(r.view(), 0);
  for (std::size_t row = 0; row < 100; ++row) {
    stages.step(r.view(), row, kStep_s);
    const double since = std::max(0.0, r.time_s[row + 1] - 0.020 - delay);
    // In the row in which the torque comes its mean acts: as much speed, and the way off by torque dt^2 / 8 I
    // at most.
    CHECK(stages.velocity() == Approx(torque / inertia * since).margin(1e-12));
    CHECK(stages.position() == Approx(start + 0.5 * torque / inertia * since * since).margin(1e-6));
  }
}

TEST_CASE("A skewed encoder shows the state of a skew before, by whichever clock the stages run") {
  const double inertia = 0.2, skew = 4e-3;
  Effects<double> effects;
  effects.set(Effect::time_skew, 0, skew);
  const RotaryJoint<double> joint({inertia, 0.0, 0.0}, effects);
  Stages by_commands(joint, effects);
  Stages by_encoder(joint, effects, Clock::encoder);
  const Recorded r = swings(200);
  std::vector<double> as_commanded, as_measured;
  by_commands.reset(0.0, 0.0);
  by_encoder.reset(0.0, 0.0);
  by_commands.actuation().drive.start(r.view(), 0);
  by_encoder.actuation().drive.start(r.view(), 0);
  for (std::size_t row = 0; row < 200; ++row) {
    by_commands.step(r.view(), row, kStep_s);
    by_encoder.step(r.view(), row, kStep_s);
    as_commanded.push_back(by_commands.velocity());
    as_measured.push_back(by_encoder.velocity());
  }
  CHECK(*by_commands.sensing().skew_s() == skew);
  // Four rows later, but for what the first command, held before the first row, gave in those four.
  const double before = r.command[0] * skew / inertia;
  for (std::size_t row = 4; row < 200; ++row)
    CHECK(as_measured[row] == Approx(as_commanded[row - 4] + before).epsilon(1e-12));
}

TEST_CASE("The derivative by a skew is that of finite differences") {
  using Jet = ceres::Jet<double, 1>;
  const Recorded r = swings(150);
  const auto angle = [&](auto skew) {
    using T = decltype(skew);
    Effects<T> effects;
    effects.set(Effect::time_skew, 0, skew);
    Stages stages(RotaryJoint<T>({T(0.2), T(2.0), T(0.01)}, effects), effects, Clock::encoder);
    stages.reset(T(0.3), T(0.0));
    stages.actuation().drive.start(r.view(), 0);
    for (std::size_t row = 0; row < 150; ++row) stages.step(r.view(), row, kStep_s);
    return stages.position();
  };
  const double at = -2.61e-3, h = 1e-6;
  const Jet out = angle(Jet(at, 0));
  CHECK(out.a == Approx(angle(at)).epsilon(1e-14));
  CHECK(out.v[0] == Approx((angle(at + h) - angle(at - h)) / (2 * h)).epsilon(1e-6));
}

TEST_CASE("Where the input is what the drive reports, the motor alone acts on it") {
  Effects<double> effects;
  effects.set(Effect::actuator_delay, 0, 0.01);
  effects.set(Effect::actuator_lag, 0, 0.02);
  effects.set(Effect::torque_saturation, 0, 0.5);
  effects.set(Effect::torque_gain_error, 0, 0.8);
  effects.set(Effect::torque_offset, 0, -0.1);
  Stages stages(RotaryJoint<double>({0.2, 2.0, 0.0}, effects), effects, Clock::encoder, Input::drive_torque);
  const Recorded r = swings(50);
  CHECK(stages.actuation().drive.ideal());
  for (std::size_t row = 0; row < 50; ++row)
    CHECK(stages.actuation().torque(r.view(), row, kStep_s) == Approx(0.8 * r.command[row] - 0.1));
}

TEST_CASE("A state that is measured is found again behind the encoder") {
  Effects<double> effects;
  effects.set(Effect::height_scale_error, 0, 1.04);
  effects.set(Effect::encoder_offset, 0, 0.006);
  const HopperLinearParameters<double> p{1.5, 600.0, 0.282, 5.0, 1.0, 1.0, 1.0, 0.15, 0.349, 9.81};
  Stages stages(Hopper<double>(p, effects), effects);
  const double touchdown = 2 * 0.15 * std::cos(0.349);
  stages.reset(0.37, -0.8);
  CHECK(stages.plant().height_m() == Approx(touchdown + (0.37 - 0.006 - touchdown) / 1.04));
  CHECK(stages.plant().velocity_mps() == Approx(-0.8 / 1.04));
  CHECK(stages.position() == Approx(0.37));
  CHECK(stages.velocity() == Approx(-0.8));
}

// Each effect in exactly one stage: by the compiler.

namespace {

template <std::size_t>
struct Compiles {};
/// Whether the code of a stage can name an effect.
template <Stage kStage, Effect kEffect>
concept Named = requires {
  typename Compiles<EffectIn<kStage>(kEffect).slot()>;
};

template <Effect kEffect>
constexpr bool in_its_stage_alone() {
  constexpr Stage s = info(kEffect).stage;
  return Named<Stage::actuation, kEffect> == (s == Stage::actuation) &&
         Named<Stage::mechanism, kEffect> == (s == Stage::mechanism) &&
         Named<Stage::contact, kEffect> == (s == Stage::contact) &&
         Named<Stage::sensing, kEffect> == (s == Stage::sensing);
}
static_assert([]<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
  return (in_its_stage_alone<static_cast<Effect>(kIndex)>() && ...);
}(std::make_index_sequence<kEffectCount>{}));

// And by what each stage does.

struct Case {
  Effect effect;
  std::vector<double> at;
  bool joint = false;  ///< on a rotary joint, else on a hopper with a clutch
  bool bench = false;  ///< on a clutch bench
};
const std::vector<Case> kCases{
    {Effect::coulomb_friction, {1.2}},
    {Effect::stribeck_friction, {0.8, 1.5, 0.1}},
    {Effect::asymmetric_friction, {1.0, 0.6}},
    {Effect::quadratic_drag, {0.5}},
    {Effect::binding_spot, {2.0, 0.3, 0.02}},
    {Effect::damping_error, {1.4}},
    {Effect::force_offset, {0.7}},
    {Effect::guide_tilt, {0.2}},
    {Effect::mass_error, {1.7}},
    {Effect::stiffness_error, {640.0}},
    {Effect::rest_height_error, {0.287}},
    {Effect::spring_preload, {2.0}},
    {Effect::spring_hardening, {4e4}},
    {Effect::spring_hysteresis, {0.06}},
    {Effect::leg_inertia, {42e-4, 75e-4, 38e-3}},
    {Effect::torque_gain_error, {0.9}},
    {Effect::torque_offset, {0.15}},
    {Effect::actuator_delay, {0.0123}},
    {Effect::actuator_lag, {0.011}},
    {Effect::torque_saturation, {1.1}},
    {Effect::torque_ripple, {0.3, 14.0, 0.6}, true},
    {Effect::thermal_derating, {0.7, 0.5}},
    {Effect::backlash, {0.04}, true},
    {Effect::touchdown_loss, {0.9}},
    {Effect::liftoff_loss, {0.92}},
    {Effect::ground_compliance, {6000.0, 30.0}},
    {Effect::toe_sticking, {8.0}},
    {Effect::encoder_offset, {0.006}},
    {Effect::height_scale_error, {1.05}},
    {Effect::height_eccentricity, {0.0015, 0.05, 0.7}},
    {Effect::encoder_slip, {0.013, 0.3}},
    {Effect::contact_delay, {0.012}},
    {Effect::time_skew, {0.0117}},
    {Effect::clutch_slip, {12.0}, false, true},
    {Effect::late_catch, {0.035}, false, true},
    {Effect::incomplete_release, {0.25}},
    {Effect::auxiliary_spring, {60.0}},
    {Effect::bump_stop, {0.01, 2500.0}},
};

using Trace = std::vector<double>;

Effects<double> effects_of(const Case* c) {
  Effects<double> effects;
  if (c != nullptr)
    for (std::size_t k = 0; k < c->at.size(); ++k) effects.set(c->effect, k, c->at[k]);
  return effects;
}

/// What drive and motor make of commands, and the motor's rotor of the motor's torque.
Trace actuation_of(const Effects<double>& effects) {
  Actuation<double> actuation{Drive<double>(effects), Motor<double>(effects)};
  const Recorded r = swings(400);
  actuation.drive.start(r.view(), 0);
  Rotor<double> rotor(effects);
  Trace out;
  for (std::size_t row = 0; row < 400; ++row) {
    out.push_back(actuation.torque(r.view(), row, kStep_s));
    out.push_back(rotor.torque(1.0, 0.01 * static_cast<double>(row)));
  }
  rotor.let_go(-1.0, 0.0);
  out.push_back(rotor.angle());
  out.push_back(rotor.crosses());
  return out;
}

/// Where given torques at the leg take the body.
template <class Plant>
Trace motion(Plant plant) {
  Trace out;
  for (int n = 0; n < 800; ++n) {
    double input = 0.5 + 1.5 * std::sin(0.02 * n);
    if constexpr (requires { plant.energise(true); }) plant.energise(n / 100 % 2 == 1);
    if constexpr (std::is_same_v<Plant, SimpleClutchBench<double>>) input = n / 100 % 2;
    plant.advance(input, kStep_s);
    out.push_back(position_of(plant));
  }
  return out;
}
Trace motion_of(const Case& c, const Effects<double>& effects) {
  if (c.bench) {
    SimpleClutchBench<double> bench({1.0, 0.02, 2e-5, 1e-4, 10.0, 5e-3, 2e-3, 0.01, 0.012}, effects);
    bench.reset(0.0);
    return motion(bench);
  }
  if (c.joint) {
    RotaryJoint<double> joint({0.15, 2.6, 0.02}, effects);
    joint.reset(0.3, 0.0);
    return motion(joint);
  }
  Hopper<double> hopper(
      HopperLinearParameters<double>{1.554, 605.0, 0.282, 5.0, 1.0, 0.95, 0.98, 0.15, 0.349, 9.81}, effects);
  hopper.fit_clutch({0.02, 0.02, 20.0, 4.2857e-3});
  hopper.reset(0.36, 0.0);
  return motion(hopper);
}

/// What encoder and switch make of positions.
Trace sensing_of(const Effects<double>& effects) {
  const Sensing<double> sensing(effects, 0.28);
  Trace out{sensing.skew_s().value_or(0.0), sensing.contact_delay_s(), sensing.report_lag_s(-1.0, 0.0)};
  for (int n = 0; n < 100; ++n) {
    const double position = 0.2 + 0.002 * n;
    out.push_back(sensing.measured(position));
    out.push_back(sensing.gain(position));
    out.push_back(sensing.position(position));
    out.push_back(sensing.slip(0.01 * n));
  }
  return out;
}

}  // namespace

TEST_CASE("Each effect changes what its own stage does, and what no other does") {
  REQUIRE(kCases.size() == kEffectCount);
  const Effects<double> none;
  for (const Case& c : kCases) {
    CAPTURE(std::string(info(c.effect).name));
    const Effects<double> effects = effects_of(&c);
    const Stage stage = info(c.effect).stage;
    CHECK((actuation_of(effects) != actuation_of(none)) == (stage == Stage::actuation));
    CHECK((sensing_of(effects) != sensing_of(none)) == (stage == Stage::sensing));
    // The rotor, of the actuation, is stepped with the leg: it moves the body as what is in the mechanism
    // does.
    const bool of_rotor = !Rotor<double>(effects).ideal();
    CHECK(of_rotor == (c.effect == Effect::torque_ripple || c.effect == Effect::backlash));
    CHECK((motion_of(c, effects) != motion_of(c, none)) ==
          (stage == Stage::mechanism || stage == Stage::contact || of_rotor));
    const bool contact = EffectsOf<double, Stage::contact>(effects).any();
    const bool mechanism = EffectsOf<double, Stage::mechanism>(effects).any();
    CHECK(contact == (stage == Stage::contact));
    CHECK(mechanism == (stage == Stage::mechanism));
  }
}
