// What a remaining force goes along with: each signal planted in turn in samples where all are independent.
#include "host/diagnose/associations.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

namespace furcula::diagnose {
namespace {

struct Sample {
  double time_s, velocity, position, acceleration, input, interval_s, since_touchdown_s, since_liftoff_s;
};

/// Four recordings of 4 s, every 4 ms; in turns 100 ms of stance and of flight. The force is `of` plus noise
/// of a standard deviation of 1.
ResidualForce made(const std::function<double(const Sample&)>& of) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  ResidualForce r;
  for (std::size_t recording = 0; recording < 4; ++recording)
    for (int i = 0; i < 1000; ++i) {
      const double time_s = 4e-3 * i, phase_s = std::fmod(time_s, 0.2);
      const bool stance = phase_s < 0.1;
      const Sample s{time_s,
                     normal(random),
                     (stance ? 0.25 : 0.30) + 0.03 * uniform(random),
                     normal(random),
                     normal(random),
                     1e-3 * (1.0 + uniform(random)),
                     stance ? phase_s : std::nan(""),
                     stance ? std::nan("") : phase_s - 0.1};
      r.recording.push_back(recording);
      r.time_s.push_back(s.time_s);
      r.velocity.push_back(s.velocity);
      r.position.push_back(s.position);
      r.acceleration.push_back(s.acceleration);
      r.input.push_back(s.input);
      r.interval_s.push_back(s.interval_s);
      r.since_touchdown_s.push_back(s.since_touchdown_s);
      r.since_liftoff_s.push_back(s.since_liftoff_s);
      r.force.push_back(of(s) + normal(random));
    }
  return r;
}

std::vector<Association> found_in(const std::function<double(const Sample&)>& of,
                                  dynamics::Kind kind = dynamics::Kind::hopper_linear) {
  model::Model model;
  model.kind = kind;
  if (kind == dynamics::Kind::hopper_linear)
    model.parameters = {1.5, 605.0, 0.29, 6.0, 1.2, 0.97, 1.0, 0.15, 0.349, 9.81};
  else
    model.parameters = {1.5, 1.0, 0.0};
  return associations(made(of), model);
}

}  // namespace

TEST_CASE("A remaining force that is noise goes along with nothing") {
  CHECK(found_in([](const Sample&) { return 0.0; }).empty());
}

TEST_CASE("The signal that a remaining force goes along with comes first, with its share of the variance") {
  const auto sign = [](double v) { return v > 0.0 ? 1.0 : -1.0; };
  struct Case {
    const char* signal;
    std::function<double(const Sample&)> force;
    double share;
  };
  // +-1 beside noise of 1: half of the variance; in one of two phases: 0.5 / 1.5.
  const std::vector<Case> cases = {
      {"velocity", [&](const Sample& s) { return sign(s.velocity); }, 0.5},
      {"acceleration", [&](const Sample& s) { return sign(s.acceleration); }, 0.5},
      {"time_s", [&](const Sample& s) { return sign(s.time_s - 2.0); }, 0.5},
      {"torque_cmd_nm", [&](const Sample& s) { return sign(s.input); }, 0.5},
      {"sample_interval_s", [&](const Sample& s) { return sign(s.interval_s - 1.5e-3); }, 0.5},
      {"time_since_touchdown_s",
       [&](const Sample& s) { return s.since_touchdown_s >= 0.0 ? sign(s.since_touchdown_s - 0.05) : 0.0; },
       1.0 / 3.0},
      {"time_since_liftoff_s",
       [&](const Sample& s) { return s.since_liftoff_s >= 0.0 ? sign(s.since_liftoff_s - 0.05) : 0.0; },
       1.0 / 3.0},
      {"frequency_hz", [&](const Sample& s) { return std::sqrt(2.0) * std::sin(44.0 * s.time_s + 1.0); },
       0.5},
  };
  for (const Case& c : cases) {
    INFO(c.signal);
    const auto found = found_in(c.force);
    REQUIRE(!found.empty());
    CHECK(found.front().signal == c.signal);
    CHECK(found.front().strength == Approx(c.share).margin(0.05));
  }
}

TEST_CASE("A remaining force that swings tells its frequency") {
  const auto found = found_in([](const Sample& s) { return 2.0 * std::cos(44.0 * s.time_s); });
  REQUIRE(!found.empty());
  CHECK(found.front().description == "the remaining force swings with 7 Hz");  // 44 / (2 pi) = 7.003
}

TEST_CASE("A place that acts on one way only is told from one that acts on both") {
  const auto near = [](const Sample& s) { return s.position > 0.31 ? 3.0 : 0.0; };
  const auto both = found_in(near, dynamics::Kind::motor_axis);
  REQUIRE(!both.empty());
  CHECK(both.front().signal == "position_m");
  CHECK(both.front().description == "the remaining force changes with the position");
  const auto one =
      found_in([&](const Sample& s) { return s.velocity > 0.0 ? near(s) : 0.0; }, dynamics::Kind::motor_axis);
  REQUIRE(!one.empty());
  CHECK(one.front().signal == "position_m");
  CHECK(one.front().description.find("two ways") != std::string::npos);
}

TEST_CASE("Too few samples go along with nothing") { CHECK(associations({}, {}).empty()); }

}  // namespace furcula::diagnose
