// See cases.hpp.
//
// Sizes of the planted effects. Each is drawn within 10 % of the figure; signs are drawn.
//
//   on the hopper (1.3 to 1.9 kg)       small    medium   large
//   coulomb_friction     Fc             0.5      1.5      3      N
//   stribeck_friction    Fc             0.5      1        2      N, Fs / Fc 1.8 to 3, vs 0.1 to 0.3 m/s
//   asymmetric_friction  mean           0.5      1.5      3      N, one way 1.5 times, the other 0.5 times
//   quadratic_drag       at 1.2 m/s     0.5      1.5      3      N
//   force_offset                        0.5      1.5      3      N
//   stiffness_error                     3        6        12     %
//   spring_preload                      1        3        6      N, upwards only if large (below)
//   torque_gain_error                   6        12       25     %
//   touchdown_loss       alpha          0.95     0.9      0.8    the model's is held at 1
//
//   on the axes, of the RMS of the command without the effect
//   coulomb_friction     Fc             3        8        20     %
//   stribeck_friction    Fc             3        8        20     %, Fs / Fc 1.8 to 3, vs 5 to 25 % of top
//   speed asymmetric_friction  mean           3        8        20     %, as above quadratic_drag       at
//   top speed   3        8        20     % force_offset                        3        8        20     %
//
// A spring slack by 6 N at touch-down would have the ground pull on the toe: no such rig exists, so a large
// preload pushes upwards.
#include "tests/hidden/cases.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/hidden/random.hpp"
#include "tests/hidden/rig.hpp"

namespace furcula::hidden {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

double by_size(Size size, double small, double medium, double large) {
  return size == Size::small ? small : size == Size::medium ? medium : large;
}

model::Bounds around(double nominal, double below, double above) {
  return {nominal * below, nominal * above};
}

// Laws of friction and drag in terms of one force (or torque), on every kind.
Planted friction_of(Effect effect, double force, double drag_speed, double stribeck_velocity,
                    Random& random) {
  switch (effect) {
    case Effect::stribeck_friction:
      return {effect, {force, force * random.uniform(1.8, 3.0), stribeck_velocity}};
    case Effect::asymmetric_friction: {
      const double lean = 0.5 * random.sign();
      return {effect, {force * (1 + lean), force * (1 - lean)}};
    }
    case Effect::quadratic_drag:
      return {effect, {force / (drag_speed * drag_speed)}};
    case Effect::force_offset:
      return {effect, {force * random.sign()}};
    default:
      return {effect, {force}};
  }
}

Planted hopper_effect(Effect effect, Size size, const model::Model& model, Random& random) {
  const double scatter = random.uniform(0.9, 1.1);
  switch (effect) {
    case Effect::stiffness_error:
      return {effect,
              {model.parameter("stiffness_npm") *
               (1 + random.sign() * scatter * by_size(size, 0.03, 0.06, 0.12))}};
    case Effect::spring_preload: {
      const double direction = random.sign();
      return {effect, {(size == Size::large ? 1.0 : direction) * scatter * by_size(size, 1, 3, 6)}};
    }
    case Effect::torque_gain_error:
      return {effect, {1 + random.sign() * scatter * by_size(size, 0.06, 0.12, 0.25)}};
    case Effect::touchdown_loss:
      return {effect, {1 - scatter * by_size(size, 0.05, 0.1, 0.2)}};
    case Effect::stribeck_friction:
      return friction_of(effect, scatter * by_size(size, 0.5, 1, 2), 0, random.uniform(0.1, 0.3), random);
    default:
      return friction_of(effect, scatter * by_size(size, 0.5, 1.5, 3), 1.2, 0, random);
  }
}

void draw_hopper(Case& c, std::optional<Effect> effect, Random& random) {
  // Around the published rig (002, section 4.2): m 1.554, k 605, z0 0.289, ds 6.42, df 1.18.
  const double mass = random.uniform(1.3, 1.9);
  const double stiffness = mass * random.uniform(370, 410);
  const double damping_stance = random.uniform(4.5, 7.5), damping_flight = random.uniform(0.8, 1.6);
  const double touchdown_angle = 20.0 * std::numbers::pi / 180.0, length = 0.15;
  // The leg's stop holds the spring a little stretched: 0.7 cm on the published rig.
  const double rest_height = 2 * length * std::cos(touchdown_angle) + random.uniform(0.006, 0.009);
  const double restitution =
      effect == Effect::touchdown_loss || random.chance(0.3) ? 1.0 : random.uniform(0.9, 1.0);
  // The sources of a known mass: a scale. It is what tells a torque's gain from a spring's rate.
  c.weighed =
      (effect == Effect::torque_gain_error || effect == Effect::stiffness_error) && random.chance(0.5);
  c.model.parameters = {mass,        stiffness, rest_height, damping_stance,  damping_flight,
                        restitution, 1.0,       length,      touchdown_angle, 9.81};
  if (!c.weighed) c.model.free[0] = around(mass, 0.7, 1.3);
  c.model.free[3] = around(damping_stance, 0.0, 5.0);
  c.model.free[4] = around(damping_flight, 0.0, 5.0);

  c.truth.parameters = c.model.parameters;
  if (!c.weighed) c.truth.parameters[0] *= random.uniform(0.97, 1.03);
  c.truth.parameters[3] *= random.uniform(0.9, 1.1);
  c.truth.parameters[4] *= random.uniform(0.9, 1.1);
  if (effect) c.truth.planted = hopper_effect(*effect, c.size, c.model, random);

  HopperSensors sensors;
  sensors.noise_m = random.uniform(2e-5, 5e-5);
  sensors.report_error_s = random.chance(0.8) ? random.uniform(2e-3, 10e-3) : 0.0;
  sensors.bounce_s = random.uniform(0.0, 4e-3);
  sensors.vibration_m = random.chance(0.5) ? random.uniform(1e-4, 3e-4) : 0.0;
  sensors.velocity_column = random.chance(0.7);
  sensors.dropped_fraction = random.chance(0.3) ? random.uniform(1e-3, 1e-2) : 0.0;

  c.resolution = sensors.quantum_m;

  constexpr int kTraining = 6, kHeldOut = 2;
  constexpr int kFewestHops = 6, kAttempts = 12;
  constexpr double kStrongest_nm = 3.0;
  for (int i = 0; i < kTraining + kHeldOut; ++i) {
    HopperExperiment e;
    e.profile = i == 0 ? Profile::none : i == 1 ? Profile::constant : Profile::harmonic;
    e.drop_height_m = random.uniform(0.30, 0.36);
    e.period_s = random.uniform(0.26, 0.36);
    e.amplitude_nm = e.profile == Profile::constant ? random.uniform(0.4, 0.7) : random.uniform(0.8, 2.2);
    HopperRecording recording = record_hopper(c.truth, e, sensors, random);
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      if (recording.ground_pulled) {
        // So much torque so early would have lifted the toe while the body sinks: nobody hops like that.
        e.amplitude_nm *= 0.9;
        e.drop_height_m = std::min(0.36, e.drop_height_m + 0.01);
      } else if (e.profile == Profile::harmonic && recording.liftoffs < kFewestHops &&
                 e.amplitude_nm < kStrongest_nm) {
        // Whoever runs the rig turns the torque up until it keeps hopping, and drops it from higher.
        e.amplitude_nm = std::min(kStrongest_nm, 1.2 * e.amplitude_nm);
        e.drop_height_m = std::min(0.36, e.drop_height_m + 0.01);
      } else {
        break;
      }
      recording = record_hopper(c.truth, e, sensors, random);
    }
    c.ground_pulled = c.ground_pulled || recording.ground_pulled;
    (i < kTraining ? c.training : c.held_out).push_back(std::move(recording.log));
    if (i >= kTraining) c.held_out_truth.push_back(std::move(recording.truth));
  }
}

std::vector<Sine> sines(double amplitude, double lowest_hz, double highest_hz, Random& random) {
  std::vector<Sine> out;
  for (int i = 0; i < 4; ++i)
    out.push_back({amplitude * random.uniform(0.2, 0.35), random.log_uniform(lowest_hz, highest_hz),
                   random.uniform(0, kTwoPi)});
  return out;
}

Course moves(double reach, double shortest_s, double longest_s, double duration_s, Random& random) {
  Course course;
  double time = 0.1, position = 0.0;
  while (time < duration_s) {
    const double to = reach * random.uniform(0.4, 1.0) * (position > 0 ? -1 : 1);
    const double end = time + random.uniform(shortest_s, longest_s);
    course.moves.push_back({time, end, position, to});
    position = to;
    time = end + random.uniform(0.05, 0.3);
  }
  return course;
}

void draw_axis(Case& c, std::optional<Effect> effect, Random& random) {
  const bool rotary = c.kind == Kind::rotary_joint;
  AxisSensors sensors;
  if (rotary) {
    const double inertia = 0.05 * random.uniform(0.7, 1.4), gravity = 2.0 * random.uniform(0.7, 1.4);
    const double damping = random.uniform(0.03, 0.12) * std::sqrt(inertia * gravity);
    c.model.parameters = {inertia, gravity, damping};
    c.model.free = {
        {0, around(inertia, 0.7, 1.3)}, {1, around(gravity, 0.7, 1.3)}, {2, around(damping, 0.0, 5.0)}};
    sensors.quantum = random.log_uniform(1e-4, 1e-3);
    sensors.interval_spread_s = 5e-3;
  } else {
    const double mass = random.log_uniform(20, 120), damping = mass * random.uniform(0.5, 2.5);
    c.model.parameters = {mass, damping};
    c.model.free = {{0, around(mass, 0.7, 1.3)}, {1, around(damping, 0.0, 5.0)}};
    sensors.quantum = random.log_uniform(1e-6, 1e-5);
  }
  c.resolution = sensors.quantum;
  sensors.noise = sensors.quantum * random.uniform(0.2, 0.6);
  sensors.velocity_column = random.chance(0.5);
  sensors.dropped_fraction = random.chance(0.3) ? random.uniform(1e-3, 1e-2) : 0.0;

  c.truth.parameters = c.model.parameters;
  c.truth.parameters[0] *= random.uniform(0.97, 1.03);
  if (rotary) c.truth.parameters[1] *= random.uniform(0.97, 1.03);
  c.truth.parameters.back() *= random.uniform(0.9, 1.1);

  constexpr int kTraining = 4, kHeldOut = 2;
  std::vector<AxisExperiment> experiments;
  for (int i = 0; i < kTraining + kHeldOut; ++i) {
    AxisExperiment e;
    if (!rotary) {
      e.duration_s = 4.0;
      e.feedback_hz = random.uniform(1.5, 3.0);
      if (i % 2 == 0)
        e.course.sines = sines(random.uniform(0.1, 0.18), 0.3, 2.0, random);
      else
        e.course = moves(0.17, 0.25, 0.8, e.duration_s, random);
      e.limit = c.model.parameters[0] * 12.0;
    } else {
      e.duration_s = 6.0;
      e.limit = 2.5 * c.model.parameters[1];
      if (i == 1) {  // let go and left to swing
        e.start_position = random.sign() * random.uniform(1.2, 2.5);
      } else if (i % 2 == 0) {
        e.open_loop = sines(0.7 * c.model.parameters[1], 0.2, 1.5, random);
      } else {
        e.feedback_hz = random.uniform(0.8, 1.5);
        e.course.sines = sines(random.uniform(1.5, 2.5), 0.3, 1.2, random);
      }
    }
    experiments.push_back(e);
  }

  const auto record = [&](const Truth& truth) {
    std::vector<AxisRecording> recordings;
    for (const AxisExperiment& e : experiments)
      recordings.push_back(record_axis(truth, c.model.parameters, e, sensors, random));
    return recordings;
  };

  // What the machine is used to: its inputs and speeds without the effect.
  double squares = 0.0;
  std::size_t rows = 0;
  std::vector<double> speeds;
  for (const AxisRecording& recording : record(c.truth)) {
    const log::Log& log = recording.log;
    for (double u : log.at(rotary ? "torque_nm" : "force_n")) squares += u * u;
    rows += log.rows();
    const auto& position = log.at(rotary ? "angle_rad" : "position_m");
    const auto& time = log.time_s();
    for (std::size_t i = 10; i < log.rows(); i += 10)
      speeds.push_back(std::abs(position[i] - position[i - 10]) / (time[i] - time[i - 10]));
  }
  c.typical_input = std::sqrt(squares / static_cast<double>(rows));
  std::sort(speeds.begin(), speeds.end());
  c.top_speed = speeds[speeds.size() * 95 / 100];

  if (effect)
    c.truth.planted =
        friction_of(*effect, c.typical_input * random.uniform(0.9, 1.1) * by_size(c.size, 0.03, 0.08, 0.2),
                    c.top_speed, c.top_speed * random.uniform(0.05, 0.25), random);
  int number = 0;
  for (AxisRecording& recording : record(c.truth)) {
    const bool for_training = number++ < kTraining;
    (for_training ? c.training : c.held_out).push_back(std::move(recording.log));
    if (!for_training) c.held_out_truth.push_back(std::move(recording.truth));
  }
}

}  // namespace

std::string_view name(Size size) {
  return size == Size::small ? "small" : size == Size::medium ? "medium" : "large";
}

Case draw_case(std::uint64_t seed, Kind kind, std::optional<Effect> effect, Size size) {
  Case c;
  c.seed = seed;
  c.kind = kind;
  c.size = size;
  c.truth.kind = c.model.kind = kind;
  // Neighbouring seeds and the different questions asked of one seed must not share their draws.
  const std::uint64_t question = static_cast<std::uint64_t>(kind) * 1000 +
                                 static_cast<std::uint64_t>(size) * 100 +
                                 (effect ? static_cast<std::uint64_t>(*effect) + 1 : 0);
  Random random(seed * 0x9E3779B97F4A7C15u + question * 0xBF58476D1CE4E5B9u);
  if (kind == Kind::hopper_linear)
    draw_hopper(c, effect, random);
  else
    draw_axis(c, effect, random);
  int number = 0;
  for (auto* logs : {&c.training, &c.held_out})
    for (log::Log& log : *logs) {
      char label[40];
      std::snprintf(label, sizeof label, "%s-%02d", logs == &c.training ? "training" : "heldout", ++number);
      log.metadata = {{"format", "furcula-log/1"}, {"rig", log.rig}, {"experiment", label}};
      log.path = std::string(label) + ".csv";
    }
  return c;
}

std::string Case::description() const {
  std::string text = "seed " + std::to_string(seed) + " " + std::string(dynamics::info(kind).name) + " ";
  if (!truth.planted) return text + "clean";
  const dynamics::EffectInfo& e = dynamics::info(truth.planted->effect);
  text += std::string(name(size)) + " " + std::string(e.name);
  for (std::size_t i = 0; i < e.parameter_count; ++i) {
    char number[40];
    std::snprintf(number, sizeof number, "=%.4g", truth.planted->values[i]);
    text += " " + std::string(dynamics::name_on(e.parameter_table[i], kind)) + number;
  }
  return weighed ? text + " (mass held)" : text;
}

}  // namespace furcula::hidden
