// What axes are said to have, in the right words: machines of one joint, integrated here.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/result.hpp"
#include "host/diagnose/trainer.hpp"
#include "host/result/diagnosis_json.hpp"

using namespace furcula;
using diagnose::Verdict;
using dynamics::Effect;
using dynamics::Kind;

namespace {

/// J x'' = u - d x' - M sin x - k x - Fc sgn x' + more(x).
struct Joint {
  double inertia = 0.05, damping = 0.03, gravity = 0.0, spring = 0.0, friction = 0.0;
  double encoder_offset = 0.0;
  double lag_s = 0.0;  ///< of the drive, first order
  double row_s = 2e-3;
  bool rows_after = false;  ///< they hold the state after their command has acted
  double command_s =
      2e-3;  ///< so often commands change; 0: all the time, a torque that is measured at the rows' times
  std::function<double(double)> more = [](double) { return 0.0; };
};

/// 6 s from rest at an angle, steps of 20 µs.
log::Log recorded(const Joint& j, double angle, const std::function<double(double)>& command, unsigned seed) {
  const int rows = static_cast<int>(6.0 / j.row_s), steps = static_cast<int>(j.row_s / 20e-6);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 5e-5);
  log::Log log;
  log.path = "joint-" + std::to_string(seed) + ".csv";
  log.rig = "rotary_joint";
  double x = angle, v = 0.0, torque = 0.0;
  for (int row = 0; row < rows; ++row) {
    const auto told_at = [&](double t) {
      constexpr double kRounding = 1e-6;  // of a step
      return command(j.command_s > 0.0 ? j.command_s * std::floor(t / j.command_s + kRounding) : t);
    };
    double told = told_at(j.row_s * row);
    const double h = j.row_s / steps, before = x, logged = told;
    if (row == 0) torque = told;
    for (int i = 0; i < steps; ++i) {
      told = told_at(j.row_s * row + h * i);
      torque = j.lag_s > 0.0 ? torque + (told - torque) * h / j.lag_s : told;
      const double push = torque - j.damping * v - j.gravity * std::sin(x) - j.spring * x + j.more(x);
      const double next = v + h * push / j.inertia, brake = h * j.friction / j.inertia;
      v = std::abs(next) <= brake ? 0.0 : next - std::copysign(brake, next);
      x += h * v;
    }
    log.columns["time_s"].push_back(j.row_s * row);
    log.columns["angle_rad"].push_back((j.rows_after ? x : before) + j.encoder_offset + noise(random));
    log.columns["torque_nm"].push_back(logged);
  }
  return log;
}

/// Sines of several frequencies, other ones in each recording.
std::function<double(double)> sines(double amplitude, double most_hz, unsigned seed) {
  std::mt19937_64 random(100 + seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::array<std::array<double, 3>, 4> parts{};
  for (auto& p : parts)
    p = {amplitude * (0.3 + 0.3 * uniform(random)), 0.3 + (most_hz - 0.3) * uniform(random),
         6.28 * uniform(random)};
  return [parts](double t) {
    double sum = 0.0;
    for (const auto& [size, hz, phase] : parts)
      sum += size * std::sin(2.0 * std::numbers::pi * hz * t + phase);
    return sum;
  };
}

struct Data {
  std::vector<log::Log> training, held_out;
};
Data driven(const Joint& j, double amplitude, double most_hz) {
  Data d;
  for (unsigned i = 0; i < 6; ++i)
    (i < 4 ? d.training : d.held_out).push_back(recorded(j, 0.0, sines(amplitude, most_hz, i), i));
  return d;
}
Data swings(const Joint& j) {
  Data d;
  for (unsigned i = 0; i < 6; ++i)
    (i < 4 ? d.training : d.held_out)
        .push_back(recorded(
            j, (i % 2 == 0 ? 1.0 : -1.0) * (0.9 + 0.25 * i), [](double) { return 0.0; }, i));
  return d;
}

/// With inertia and damping free, and off.
model::Model model_of(Kind kind, const Joint& j) {
  model::Model m;
  m.kind = kind;
  m.parameters = {1.05 * j.inertia, kind == Kind::rotary_joint ? j.gravity : j.spring, 0.9 * j.damping};
  m.free = {{0, {0.3 * j.inertia, 3.0 * j.inertia}}, {2, {0.0, 10.0 * j.damping}}};
  return m;
}

std::vector<std::string> candidates(const diagnose::Diagnosis& d) {
  std::vector<std::string> all;
  for (const auto& c : d.candidates) all.insert(all.end(), c.effects.begin(), c.effects.end());
  return all;
}

/// By how much inputs act before their rows, as a note tells; 0 where none does.
double early_rows(const diagnose::Diagnosis& d) {
  for (const std::string& note : d.notes)
    if (note.find("before their rows") != std::string::npos)
      return std::stod(note.substr(note.find("act ") + 4));
  return 0.0;
}

bool among(const std::vector<std::string>& all, const char* name) {
  return std::find(all.begin(), all.end(), name) != all.end();
}

}  // namespace

TEST_CASE(
    "Where a torsion spring's angle is measured from is a constant torque in other words, and both are said",
    "[long]") {
  Joint j{.spring = 1.5, .encoder_offset = 0.06};
  const Data data = driven(j, 0.8, 1.5);
  const auto d = diagnose::diagnose(model_of(Kind::torsion_pendulum, j), data.training, data.held_out);
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::force_offset);
  CHECK(d.findings[0].parameters.at("torque_nm").value == Approx(1.5 * 0.06).epsilon(0.02));
  const auto& others = d.findings[0].indistinguishable_from;
  REQUIRE(others.size() == 1);
  CHECK(others[0].names == std::vector<std::string>{"encoder_offset"});
  CHECK(others[0].same_law);
  CHECK(others[0].parameters.at("encoder_offset.offset_rad").value == Approx(0.06).epsilon(0.02));
}

TEST_CASE("Where a joint's angle is measured from is named where gravity shows its zero", "[long]") {
  Joint j{.gravity = 2.0, .encoder_offset = -0.05};
  const Data data = driven(j, 2.0, 1.5);
  const auto d = diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out);
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::encoder_offset);
  CHECK(d.findings[0].parameters.at("offset_rad").value == Approx(-0.05).epsilon(0.02));
  CHECK(d.findings[0].confidence > 0.9);
}

TEST_CASE("Without a torque nothing is said of the drive, and dry friction is found", "[long]") {
  Joint j{.gravity = 2.0, .friction = 0.05};
  const Data data = swings(j);
  const auto d = diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out);
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict == Verdict::explained);
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == Effect::coulomb_friction);
  CHECK(d.findings[0].parameters.at("torque_nm").value == Approx(0.05).epsilon(0.03));
  for (const char* of_input :
       {"actuator_delay", "actuator_lag", "torque_saturation", "thermal_derating", "time_skew"})
    CHECK_FALSE(among(candidates(d), of_input));
}

TEST_CASE("A torque that does not swing again within the travel is no ripple", "[long]") {
  // A weight beside the line from the axis, that the model has not: 0.15 N m sin(x + 0.8).
  Joint j{.gravity = 2.0, .more = [](double x) { return -0.15 * std::sin(x + 0.8); }};
  const Data data = driven(j, 0.7, 1.5);
  const auto d = diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out);
  INFO(result::to_json_text(diagnose::result_of(d)));
  for (const auto& f : d.findings) CHECK(f.effect != Effect::torque_ripple);
}

TEST_CASE("A lag in a log whose rows hold the state after their step is not called a skew with confidence",
          "[long]") {
  // Early by the row of 10 ms, late by the lag of 4 ms: nearly as a torque that is measured at the rows' times is early by half a row.
  Joint j{.gravity = 2.0, .lag_s = 4e-3, .row_s = 10e-3, .rows_after = true, .command_s = 10e-3};
  const Data data = driven(j, 2.0, 3.0);
  const auto d = diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out);
  INFO(result::to_json_text(diagnose::result_of(d)));
  CHECK(d.verdict != Verdict::explained);
  for (const auto& f : d.findings) CHECK(f.confidence <= 0.5);
  CHECK(early_rows(d) == Approx(0.5).margin(0.1));
}

TEST_CASE("A torque that is measured at the rows' times is not held until the next row", "[long]") {
  for (const double friction : {0.0, 0.05}) {
    INFO(friction);
    Joint j{.gravity = 2.0, .friction = friction, .row_s = 10e-3, .command_s = 0.0};
    const Data data = driven(j, 2.0, 3.0);
    const auto d = diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out);
    INFO(result::to_json_text(diagnose::result_of(d)));
    CHECK(early_rows(d) == Approx(0.5).margin(0.05));
    CHECK(d.verdict == (friction > 0.0 ? Verdict::explained : Verdict::adequate));
    CHECK(d.findings.size() == (friction > 0.0 ? 1 : 0));
    for (const auto& f : d.findings) {
      CHECK(f.effect == Effect::coulomb_friction);
      CHECK(f.parameters.at("torque_nm").value == Approx(friction).epsilon(0.05));
    }
  }
  Joint j{.gravity = 2.0, .friction = 0.05, .row_s = 10e-3, .command_s = 10e-3};
  const Data data = driven(j, 2.0, 3.0);
  CHECK(early_rows(diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out)) == 0.0);
}

TEST_CASE("Commands that change more often than there are rows act a part of a row early, which is no cause",
          "[long]") {
  // Of n commands a row the log has the first: what acts is (n - 1) / (2 n) of a row earlier than a held one.
  for (const int n : {2, 5}) {
    CAPTURE(n);
    Joint j{.gravity = 2.0, .row_s = 10e-3, .command_s = 10e-3 / n};
    const Data data = driven(j, 2.0, 3.0);
    const auto d = diagnose::diagnose(model_of(Kind::rotary_joint, j), data.training, data.held_out);
    INFO(result::to_json_text(diagnose::result_of(d)));
    CHECK(early_rows(d) == Approx((n - 1) / (2.0 * n)).margin(0.05));
    CHECK(d.verdict == Verdict::adequate);
  }
}

TEST_CASE("What acts on a command is tried where there is one, and what shifts or cuts it where it changes") {
  Joint j{.gravity = 2.0};
  const auto candidates_under = [&](const std::function<double(double)>& command) {
    const auto model = model_of(Kind::rotary_joint, j);
    const auto recordings = identify::make_recordings({recorded(j, 0.8, command, 1)}, Kind::rotary_joint);
    const auto training = identify::training_windows(recordings, model, 0.5);
    return diagnose::Trainer{model, recordings, training}.candidates();
  };
  const auto none = candidates_under([](double) { return 0.0; }),
             constant = candidates_under([](double) { return 0.4; }),
             sine = candidates_under(sines(0.7, 1.5, 1));
  for (const Effect e :
       {Effect::actuator_delay, Effect::actuator_lag, Effect::torque_saturation, Effect::time_skew}) {
    CAPTURE(std::string(dynamics::info(e).name));
    CHECK_FALSE(diagnose::holds(none, e));
    CHECK_FALSE(diagnose::holds(constant, e));
    CHECK(diagnose::holds(sine, e));
  }
  CHECK_FALSE(diagnose::holds(none, Effect::thermal_derating));
  CHECK(diagnose::holds(constant, Effect::thermal_derating));
  // Cogging is there without a current.
  for (const Effect e : {Effect::coulomb_friction, Effect::encoder_offset, Effect::torque_ripple})
    CHECK(diagnose::holds(none, e));
}
