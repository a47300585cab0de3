// See cases.hpp.
#include "tests/hidden/cases.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "tests/hidden/belt.hpp"
#include "tests/hidden/random.hpp"
#include "tests/hidden/rig.hpp"
#include "tests/hidden/sizes.hpp"

namespace furcula::hidden {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

model::Bounds around(double nominal, double below, double above) {
  return {nominal * below, nominal * above};
}

bool asks(const Question& q, std::string_view law) {
  return std::find(q.laws.begin(), q.laws.end(), law) != q.laws.end();
}

// What a free parameter really is: this many times the model's.
double off(const Question& q, double scatter, Random& random) {
  switch (q.nominal) {
    case Nominal::scattered:
      return random.uniform(1 - scatter, 1 + scatter);
    case Nominal::exact:
      return 1.0;
    case Nominal::wrong:
      return 1.0 / (1 + 0.05 * random.sign());
  }
  return 1.0;
}

// The truth during one recording of the case. An encoder slips at another instant and by another step each
// time, and in some recordings not at all; Case::truth has the largest step.
Truth during(const Case& c, std::size_t recording, std::size_t slipping) {
  Truth truth = c.truth;
  truth.draw = c.question.seed * 1000 + recording;
  for (Planted& p : truth.planted)
    if (p.law == "encoder_slip" && recording != slipping) {
      Random random(truth.draw);
      p.values[0] *= random.chance(0.5) ? random.sign() * random.uniform(0.5, 0.9) : 0.0;
      p.values[1] *= random.uniform(0.5, 1.5);
    }
  return truth;
}

// Of a machine whose forces are about `typical`. Its own numbers: what else is drawn stays what it was.
Disturbance disturbance(const Question& q, double typical) {
  if (!q.disturbed) return {};
  Random random(q.seed * 0xA0761D6478BD642Fu + 5);
  Disturbance d;
  d.force = typical * random.log_uniform(0.005, 0.02);
  d.correlation_s = random.log_uniform(0.01, 0.1);
  if (q.kind == Kind::hopper_linear) {
    d.restitution = random.log_uniform(0.002, 0.012);
    d.ground_m = random.log_uniform(5e-5, 3e-4);
  }
  return d;
}

void draw_hopper(Case& c, Random& random) {
  const Question& q = c.question;
  // Around the published rig (002, section 4.2): m 1.554, k 605, z0 0.289, ds 6.42, df 1.18.
  const double mass = random.uniform(1.3, 1.9);
  const double stiffness = mass * random.uniform(370, 410);
  const double damping_stance = random.uniform(4.5, 7.5), damping_flight = random.uniform(0.8, 1.6);
  const double touchdown_angle = 20.0 * std::numbers::pi / 180.0, length = 0.15;
  // The leg's stop holds the spring a little stretched: 0.7 cm on the published rig.
  const double rest_height = 2 * length * std::cos(touchdown_angle) + random.uniform(0.006, 0.009);
  const double restitution = asks(q, "touchdown_loss") || random.chance(0.3) ? 1.0 : random.uniform(0.9, 1.0);
  // The sources of a known mass: a scale. It is what tells a torque's gain from a spring's rate.
  c.weighed = (asks(q, "torque_gain_error") || asks(q, "stiffness_error")) && random.chance(0.5);
  // A parameter whose error is planted is one that the user believes to know.
  const bool mass_held = c.weighed || asks(q, "mass_error"), guide_held = asks(q, "damping_error");
  c.model.parameters = {mass,        stiffness, rest_height, damping_stance,  damping_flight,
                        restitution, 1.0,       length,      touchdown_angle, 9.81};
  if (!mass_held) c.model.free[0] = around(mass, 0.7, 1.3);
  c.model.free[3] = around(damping_stance, 0.0, 5.0);
  if (!guide_held) c.model.free[4] = around(damping_flight, 0.0, 5.0);

  c.truth.parameters = c.model.parameters;
  if (!mass_held) c.truth.parameters[0] *= off(q, 0.03, random);
  c.truth.parameters[3] *= off(q, 0.1, random);
  if (!guide_held) c.truth.parameters[4] *= off(q, 0.1, random);
  for (const std::string& law : q.laws)
    if (law != "late_catch" && law != "incomplete_release" && law != "auxiliary_spring")
      c.truth.planted.push_back(hopper_law(law, c.size, c.model, random));
  if (q.clutched || asks(q, "late_catch") || asks(q, "incomplete_release") || asks(q, "auxiliary_spring")) {
    c.truth.clutch = {random.uniform(4e-3, 10e-3), random.uniform(6e-3, 15e-3), random.uniform(20, 60),
                      3e-3 / 0.7};
    const auto [release_s, catch_s, auxiliary_npm, pitch_m] = c.truth.clutch;
    c.model.clutch = model::Clutch{release_s, catch_s, auxiliary_npm, pitch_m};
    for (const std::string& law : q.laws)
      if (const auto p = clutch_law(law, c.size, c.model, random)) c.truth.planted.push_back(*p);
  }
  // The body's mass is what the side mass leaves of it: at rest nothing shows.
  if (const auto* side = find(c.truth.planted, "side_mass")) c.truth.parameters[0] -= (*side)[0];

  c.truth.disturbance = disturbance(q, mass * 9.81);

  HopperSensors sensors;
  sensors.noise_m = random.uniform(2e-5, 5e-5);
  sensors.report_error_s = random.chance(0.8) ? random.uniform(2e-3, 10e-3) : 0.0;
  sensors.bounce_s = random.uniform(0.0, 4e-3);
  sensors.vibration_m = random.chance(0.5) ? random.uniform(1e-4, 3e-4) : 0.0;
  sensors.velocity_column = random.chance(0.7);
  sensors.dropped_fraction = random.chance(0.3) ? random.uniform(1e-3, 1e-2) : 0.0;

  c.resolution = sensors.quantum_m;
  if (q.more_columns) {
    sensors.torque_column = random.chance(0.5);
    sensors.leg_angle_column = random.chance(0.5);
  }
  if (q.manoeuvre) sensors.leg_angle_column = true;

  constexpr int kTraining = 6, kHeldOut = 2;
  constexpr std::size_t kFirstHarmonic = 2;
  constexpr int kFewestHops = 6, kAttempts = 12;
  constexpr double kStrongest_nm = 3.0;
  for (int i = 0; i < kTraining + kHeldOut; ++i) {
    HopperExperiment e;
    e.profile = i == 0 ? Profile::none : i == 1 ? Profile::constant : Profile::harmonic;
    e.drop_height_m = random.uniform(0.30, 0.36);
    e.period_s = random.uniform(0.26, 0.36);
    e.amplitude_nm = e.profile == Profile::constant ? random.uniform(0.4, 0.7) : random.uniform(0.8, 2.2);
    // Deep while the spring is let go; then a short pull at the caught one, from which some flights come down folded.
    if (q.manoeuvre) e.folds = {{0.02, 0.03 + 0.005 * i, 0.10}, {0.138, 0.010, 0.05}};
    const Truth truth = during(c, static_cast<std::size_t>(i), kFirstHarmonic);
    HopperRecording recording = record_hopper(truth, e, sensors, random);
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
      recording = record_hopper(truth, e, sensors, random);
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

void draw_axis(Case& c, Random& random) {
  const Question& q = c.question;
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
  // A parameter whose error is planted is one that the user believes to know.
  const bool inertia_held = asks(q, "mass_error"), damping_held = asks(q, "damping_error");
  if (inertia_held) c.model.free.erase(0);
  if (damping_held) c.model.free.erase(c.model.parameters.size() - 1);
  if (!inertia_held) c.truth.parameters[0] *= off(q, 0.03, random);
  if (rotary) c.truth.parameters[1] *= off(q, 0.03, random);
  if (!damping_held) c.truth.parameters.back() *= off(q, 0.1, random);
  if (q.more_columns && rotary) sensors.drive_reports = random.chance(0.3);

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

  const auto record = [&] {
    std::vector<AxisRecording> recordings;
    for (const AxisExperiment& e : experiments)
      recordings.push_back(
          record_axis(during(c, recordings.size(), 0), c.model.parameters, e, sensors, random));
    return recordings;
  };

  // What the machine_type is used to: its inputs, speeds and places without the effect.
  double squares = 0.0;
  std::size_t rows = 0;
  std::vector<double> speeds, inputs, places;
  for (const AxisRecording& recording : record()) {
    const log::Log& log = recording.log;
    for (double u : log.at(rotary ? (sensors.drive_reports ? "torque_cmd_nm" : "torque_nm") : "force_n")) {
      squares += u * u;
      inputs.push_back(std::abs(u));
    }
    rows += log.rows();
    const auto& position = log.at(rotary ? "angle_rad" : "position_m");
    const auto& time = log.time_s();
    for (double x : position) places.push_back(std::abs(x));
    for (std::size_t i = 10; i < log.rows(); i += 10)
      speeds.push_back(std::abs(position[i] - position[i - 10]) / (time[i] - time[i - 10]));
  }
  const auto quantile = [](std::vector<double>& values, std::size_t percent) {
    std::sort(values.begin(), values.end());
    return values[values.size() * percent / 100];
  };
  c.typical_input = std::sqrt(squares / static_cast<double>(rows));
  c.top_speed = quantile(speeds, 95);
  const AxisHabits habits{c.typical_input, quantile(inputs, 99), c.top_speed, quantile(places, 90)};
  for (const std::string& law : q.laws)
    c.truth.planted.push_back(axis_law(law, c.size, c.model, habits, random));
  if (const auto* side = find(c.truth.planted, "side_mass")) c.truth.parameters[0] -= (*side)[0];
  c.truth.disturbance = disturbance(q, c.typical_input);

  int number = 0;
  for (AxisRecording& recording : record()) {
    const bool for_training = number++ < kTraining;
    (for_training ? c.training : c.held_out).push_back(std::move(recording.log));
    if (!for_training) c.held_out_truth.push_back(std::move(recording.truth));
  }
}

void draw_carriage(Case& c, Random& random) {
  const Question& q = c.question;
  const double mass = random.uniform(0.8, 2.0), damping = random.uniform(0.4, 1.2);
  c.model.parameters = {mass, damping, 9.81};
  // It is weighed: in free flight a mass is a damping and a friction in other measures.
  if (!asks(q, "damping_error") && !asks(q, "mass_error")) c.model.free[1] = around(damping, 0.0, 5.0);
  c.truth.parameters = c.model.parameters;
  if (c.model.free.contains(1)) c.truth.parameters[1] *= off(q, 0.1, random);
  for (const std::string& law : q.laws) c.truth.planted.push_back(hopper_law(law, c.size, c.model, random));
  for (Planted& p : c.truth.planted) {
    // The hopper's heights are not the rail's, and a rail's damping is what it is, not what comes on top.
    if (p.law == "binding_spot" || p.law == "cable_snag") p.values[1] = random.uniform(0.05, 0.15);
    if (p.law == "damping_error") p.values[0] += damping;
  }
  if (const auto* side = find(c.truth.planted, "side_mass")) c.truth.parameters[0] -= (*side)[0];

  c.truth.disturbance = disturbance(q, mass * 9.81);

  AxisSensors sensors;
  sensors.quantum = 9e-5;
  sensors.noise = random.uniform(2e-5, 5e-5);
  sensors.velocity_column = random.chance(0.5);
  sensors.dropped_fraction = random.chance(0.3) ? random.uniform(1e-3, 1e-2) : 0.0;
  c.resolution = sensors.quantum;
  constexpr int kTraining = 4, kHeldOut = 2, kThrows = 8;
  for (int i = 0; i < kTraining + kHeldOut; ++i) {
    CarriageExperiment e;
    for (int j = 0; j < kThrows; ++j) e.speeds_mps.push_back(random.uniform(1.2, 2.4));
    AxisRecording recording = record_carriage(during(c, static_cast<std::size_t>(i), 0), e, sensors, random);
    (i < kTraining ? c.training : c.held_out).push_back(std::move(recording.log));
    if (i >= kTraining) c.held_out_truth.push_back(std::move(recording.truth));
  }
}

void draw_bench(Case& c, Random& random) {
  const Question& q = c.question;
  // About 002, section 5.1: 1 kg, a belt of 3 mm pitch on a pulley of 20 teeth.
  const double mass = random.uniform(0.7, 1.4), radius = 60e-3 / kTwoPi * random.uniform(0.8, 1.25);
  const double damping = random.uniform(1e-5, 4e-5);
  const double release_s = random.uniform(5e-3, 14e-3), catch_s = random.uniform(6e-3, 16e-3);
  c.model.parameters = {mass,      radius, random.uniform(1e-6, 4e-6), damping, 0.0, 3e-3, 1.8e-3,
                        release_s, catch_s};
  if (!asks(q, "damping_error")) c.model.free[3] = {0.0, 2e-3};
  c.model.free[7] = {0.0, 0.04};
  // When the key comes is what the user believes to know, or has never measured.
  const bool catch_free = !asks(q, "late_catch") && random.chance(0.5);
  if (catch_free) c.model.free[8] = {0.0, 0.06};
  c.truth.parameters = c.model.parameters;
  if (!asks(q, "damping_error")) c.truth.parameters[3] *= off(q, 0.1, random);
  c.truth.parameters[7] *= off(q, 0.1, random);
  if (catch_free) c.truth.parameters[8] *= off(q, 0.1, random);
  for (const std::string& law : q.laws) c.truth.planted.push_back(bench_law(law, c.size, c.model, random));

  c.truth.disturbance = disturbance(q, mass * 9.81 * radius);

  BenchSensors sensors;
  sensors.noise_rad = sensors.quantum_rad * random.uniform(0.1, 0.5);
  sensors.dropped_fraction = random.chance(0.3) ? random.uniform(1e-3, 1e-2) : 0.0;
  c.resolution = sensors.quantum_rad;
  constexpr int kTraining = 5, kHeldOut = 2, kReleases = 4;
  for (int i = 0; i < kTraining + kHeldOut; ++i) {
    BenchExperiment e;
    for (int j = 0; j < kReleases; ++j) e.windows_s.push_back(release_s + random.uniform(0.015, 0.05));
    log::Log log = record_bench(during(c, static_cast<std::size_t>(i), 0), e, sensors, random);
    (i < kTraining ? c.training : c.held_out).push_back(std::move(log));
  }
}

// Families of laws that a pair takes one each of: within a family they are too much alike to be a fair pair.
constexpr std::pair<std::string_view, int> kFamilies[] = {
    {"coulomb_friction", 0},    {"stribeck_friction", 0},   {"asymmetric_friction", 0},
    {"spring_hysteresis", 0},   {"damping_error", 1},       {"quadratic_drag", 1},
    {"binding_spot", 2},        {"force_offset", 3},        {"guide_tilt", 3},
    {"mass_error", 3},          {"rest_height_error", 3},   {"spring_preload", 3},
    {"torque_offset", 3},       {"encoder_offset", 3},      {"stiffness_error", 4},
    {"spring_hardening", 4},    {"torque_gain_error", 4},   {"leg_inertia", 4},
    {"height_scale_error", 4},  {"thermal_derating", 4},    {"actuator_delay", 5},
    {"actuator_lag", 5},        {"time_skew", 5},           {"backlash", 5},
    {"torque_saturation", 5},   {"torque_ripple", 6},       {"touchdown_loss", 7},
    {"liftoff_loss", 7},        {"ground_compliance", 7},   {"toe_sticking", 7},
    {"height_eccentricity", 8}, {"encoder_slip", 8},        {"contact_delay", 9},
    {"bump_stop", 4},           {"clutch_slip", 10},        {"late_catch", 11},
    {"auxiliary_spring", 12},   {"incomplete_release", 12},
};

int family(std::string_view law) {
  for (const auto& [name, number] : kFamilies)
    if (name == law) return number;
  return -1;
}

// A constant force beside a friction of two sizes is that friction with two other sizes: one law, not two.
bool one_law(std::string_view a, std::string_view b) {
  const auto constant = [](std::string_view law) { return law == "force_offset" || law == "guide_tilt"; };
  return (a == "asymmetric_friction" && constant(b)) || (b == "asymmetric_friction" && constant(a));
}

// Laws whose first cases were drawn before there were names: their cases stay what they were.
constexpr std::string_view kFirstLaws[] = {
    "coulomb_friction", "stribeck_friction", "asymmetric_friction", "quadratic_drag", "force_offset",
    "stiffness_error",  "spring_preload",    "torque_gain_error",   "touchdown_loss",
};

std::uint64_t number_of(const std::vector<std::string>& laws) {
  if (laws.empty()) return 0;
  if (laws.size() == 1)
    for (std::size_t i = 0; i < std::size(kFirstLaws); ++i)
      if (kFirstLaws[i] == laws[0]) return i + 1;
  std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a
  for (const std::string& law : laws)
    for (char letter : law + " ") hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001B3u;
  return hash;
}

struct Choice {
  Kind kind;
  std::vector<std::string> laws;
};

void shuffle(std::vector<Choice>& choices, Random& random) {
  for (std::size_t i = choices.size(); i > 1; --i)
    std::swap(choices[i - 1],
              choices[std::min(i - 1, static_cast<std::size_t>(random.unit() * static_cast<double>(i)))]);
}

}  // namespace

std::string_view name(Size size) {
  return size == Size::small ? "small" : size == Size::medium ? "medium" : "large";
}

std::string_view name(Nominal nominal) {
  return nominal == Nominal::scattered ? "scattered" : nominal == Nominal::exact ? "exact" : "5 % wrong";
}

std::string_view name(Tier tier) {
  constexpr std::string_view kNames[] = {"large", "medium", "small", "pairs", "clean", "outside"};
  return kNames[static_cast<std::size_t>(tier)];
}

Case draw_case(const Question& question) {
  Case c;
  c.question = question;
  c.kind = question.kind;
  c.size = question.size;
  c.truth.kind = c.model.kind = question.kind;
  // Neighbouring seeds and the different questions asked of one seed must not share their draws.
  const std::uint64_t mixed = static_cast<std::uint64_t>(question.kind) * 1000 +
                              static_cast<std::uint64_t>(question.size) * 100 + number_of(question.laws) +
                              static_cast<std::uint64_t>(question.nominal) * 1000000;
  Random random(question.seed * 0x9E3779B97F4A7C15u + mixed * 0xBF58476D1CE4E5B9u);
  if (question.kind == Kind::hopper_linear)
    draw_hopper(c, random);
  else if (is_kind(question.kind, "rail_carriage"))
    draw_carriage(c, random);
  else if (is_kind(question.kind, "clutch_bench"))
    draw_bench(c, random);
  else
    draw_axis(c, random);
  int number = 0;
  for (auto* logs : {&c.training, &c.held_out})
    for (log::Log& log : *logs) {
      char label[40];
      std::snprintf(label, sizeof label, "%s-%02d", logs == &c.training ? "training" : "heldout", ++number);
      log.metadata = {{"format", "furcula-log/1"}, {"machine_type", log.rig}, {"experiment", label}};
      log.path = std::string(label) + ".csv";
    }
  return c;
}

Case draw_case(std::uint64_t seed, Kind kind, std::string_view law, Size size) {
  Question q;
  q.seed = seed;
  q.kind = kind;
  q.laws = {std::string(law)};
  q.size = size;
  return draw_case(q);
}

Case draw_clean_case(std::uint64_t seed, Kind kind) {
  Question q;
  q.seed = seed;
  q.kind = kind;
  return draw_case(q);
}

Question question_of(Tier tier, std::uint64_t seed, std::uint64_t index, std::string_view kind_name,
                     std::string_view law) {
  const auto wanted = [&](const LawInfo& l, Kind kind) {
    return (l.acts == Acts::outside_catalogue) == (tier == Tier::outside) && can_be_planted(l.name, kind) &&
           (kind_name.empty() || kind_name == dynamics::info(kind).name);
  };
  std::vector<Choice> choices;
  for (const auto& kind : dynamics::kMachines) {
    if (!machine_has(kind.kind)) continue;
    if (tier == Tier::clean) {
      if (kind_name.empty() || kind_name == kind.name) choices.push_back({kind.kind, {}});
      continue;
    }
    for (const LawInfo& l : laws()) {
      if (!wanted(l, kind.kind) || !(law.empty() || law == l.name)) continue;
      if (tier != Tier::pairs) {
        choices.push_back({kind.kind, {std::string(l.name)}});
        continue;
      }
      for (const LawInfo& other : laws())
        if (wanted(other, kind.kind) && family(other.name) != family(l.name) &&
            !one_law(l.name, other.name) && (law == l.name || &l < &other))
          choices.push_back({kind.kind, {std::string(l.name), std::string(other.name)}});
    }
  }
  Random order(seed * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(tier));
  shuffle(choices, order);
  Random random((seed + index) * 0xD1B54A32D192ED03u + static_cast<std::uint64_t>(tier));
  Question q;
  q.seed = seed + index;
  q.nominal = random.chance(0.5) ? Nominal::exact : Nominal::wrong;
  q.more_columns = q.disturbed = true;
  q.size = tier == Tier::small                                                  ? Size::small
           : tier == Tier::large || (tier == Tier::pairs && random.chance(0.5)) ? Size::large
                                                                                : Size::medium;
  if (!choices.empty()) {
    q.kind = choices[index % choices.size()].kind;
    q.laws = choices[index % choices.size()].laws;
  }
  return q;
}

bool Case::outside() const {
  return std::any_of(truth.planted.begin(), truth.planted.end(),
                     [](const Planted& p) { return law_named(p.law)->acts == Acts::outside_catalogue; });
}

std::string Case::description() const {
  std::string text =
      "seed " + std::to_string(question.seed) + " " + std::string(dynamics::info(kind).name) + " ";
  if (truth.planted.empty()) text += "clean";
  if (!truth.planted.empty() && !outside()) text += std::string(name(size)) + " ";
  for (const Planted& p : truth.planted) {
    if (&p != &truth.planted.front()) text += " + ";
    const LawInfo& law = *law_named(p.law);
    text += p.law;
    for (std::size_t i = 0; i < kMostValues && !law.parameters[i].empty(); ++i) {
      char number[40];
      std::snprintf(number, sizeof number, "=%.4g", p.values[i]);
      text += " " + parameter_name(law, i, kind) + number;
    }
  }
  text += " (nominal " + std::string(name(question.nominal));
  for (const char* column : {"torque_nm", "leg_angle_rad", "torque_cmd_nm"})
    if (question.more_columns && !training.empty() && training[0].has(column) &&
        (kind == Kind::hopper_linear) != (std::string_view(column) == "torque_cmd_nm"))
      text += ", " + std::string(column);
  return text + (weighed ? ", mass held)" : ")");
}

}  // namespace furcula::hidden
