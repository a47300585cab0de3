// Simulated logs of robots of several joints, and the scenarios that say what they do.
#include "host/trees/simulate.hpp"

#include <cmath>
#include <numbers>

#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;
using trees::Path;

namespace {

trees::Scenario scenario(const std::string& text) {
  return trees::parse_scenario(text, "s.toml", test::arm3());
}
std::string refused(const std::string& text) {
  return test::error_message([&] { scenario(text); });
}

}  // namespace

TEST_CASE("A scenario says duration, paths, disturbance and noise, joints without a path stand still") {
  const trees::Scenario s = scenario(
      "[run]\nduration_s = 3.0\nsample_rate_hz = 500.0\n[path.elbow]\nprofile = \"steps\"\ncentre_rad = 0.2\namplitude_rad = 0.1\n"
      "period_s = 1.5\nphase_rad = 0.3\n[disturbance]\nshare = 0.05\ntime_s = 0.1\n[sensors]\nangle_noise_rad = 1e-3\ntorque_noise_share = 0.02\n");
  CHECK(s.duration_s == 3.0);
  CHECK(s.sample_rate_hz == 500.0);
  REQUIRE(s.paths.size() == 3);
  CHECK(s.paths[0].profile == Path::Profile::hold);
  CHECK(s.paths[2].profile == Path::Profile::steps);
  CHECK(s.paths[2].centre_rad == 0.2);
  CHECK(s.paths[2].period_s == 1.5);
  CHECK(s.disturbance_share == 0.05);
  CHECK(s.angle_noise_rad == 1e-3);
  CHECK(s.torque_noise_share == 0.02);
  CHECK(scenario("[run]\n").paths[0].profile == Path::Profile::sine);
}

TEST_CASE("A wrong scenario of a tree is refused") {
  CHECK_THAT(refused("[runs]\n"),
             Contains("s.toml:1: unknown key 'runs'") && Contains("did you mean 'run'?"));
  CHECK_THAT(refused("[path.elbo]\n"), Contains("unknown key 'elbo'") && Contains("did you mean 'elbow'?"));
  CHECK_THAT(refused("[path.elbow]\nprofile = \"triangle\"\n"),
             Contains("s.toml:2") && Contains("expected sine, steps, fourier or hold"));
  CHECK_THAT(refused("[path.elbow]\namplitude_m = 0.1\n"), Contains("unknown key 'amplitude_m'"));
  CHECK_THAT(refused("[run]\nduration_s = -1\n"), Contains("[run] duration_s"));
  CHECK_THAT(refused("[run]\nsample_rate_hz = nan\n"), Contains("[run] sample_rate_hz"));
}

TEST_CASE("A Fourier series has the derivatives of its sines and cosines, and reads back as it was written") {
  const trees::Scenario s = scenario(
      "[run]\nduration_s = 8.0\n[path.elbow]\nprofile = \"fourier\"\ncentre_rad = 0.2\nperiod_s = 8.0\n"
      "harmonics = [1, 4]\nsine_rad = [0.3, 0]\ncosine_rad = [0, -0.1]\n");
  const double w = 2.0 * std::numbers::pi / 8.0;
  for (const double t : {0.0, 0.7, 3.1}) {
    const Path::Point p = s.paths[2].at(t);
    CHECK(p.q == Approx(0.2 + 0.3 * std::sin(w * t) - 0.1 * std::cos(4.0 * w * t)));
    CHECK(p.v == Approx(0.3 * w * std::cos(w * t) + 0.4 * w * std::sin(4.0 * w * t)));
    CHECK(p.a == Approx(-0.3 * w * w * std::sin(w * t) + 1.6 * w * w * std::cos(4.0 * w * t)));
  }
  const trees::Scenario again = scenario(trees::format_scenario(test::arm3(), s));
  CHECK(again.duration_s == 8.0);
  CHECK(again.paths[0].profile == Path::Profile::hold);
  CHECK(again.paths[2].at(2.3).q == s.paths[2].at(2.3).q);
}

TEST_CASE("A ramp takes a Fourier series from rest to rest, and its derivatives are those of the path") {
  const trees::Scenario s = scenario(
      "[run]\nduration_s = 4.0\n[path.elbow]\nprofile = \"fourier\"\ncentre_rad = 0.2\nperiod_s = 1.0\n"
      "harmonics = [1.3, 0.4]\nsine_rad = [0.3, 0.2]\ncosine_rad = [0.1, -0.1]\nramp_s = 0.5\n");
  const Path& p = s.paths[2];
  for (const double t : {0.0, 4.0}) {
    CHECK(p.at(t).q == Approx(0.2));
    CHECK(std::abs(p.at(t).v) < 1e-12);
    CHECK(std::abs(p.at(t).a) < 1e-12);
  }
  const double h = 1e-4;
  for (const double t : {0.2, 1.7, 3.8}) {
    CHECK(p.at(t).v == Approx((p.at(t + h).q - p.at(t - h).q) / (2.0 * h)).epsilon(1e-5));
    CHECK(p.at(t).a == Approx((p.at(t + h).v - p.at(t - h).v) / (2.0 * h)).epsilon(1e-5));
  }
  CHECK(scenario(trees::format_scenario(test::arm3(), s)).paths[2].at(3.9).q == p.at(3.9).q);
}

TEST_CASE("A Fourier series with lists of different lengths is refused") {
  const std::string start = "[path.elbow]\nprofile = \"fourier\"\n";
  CHECK_THAT(refused(start), Contains("s.toml") && Contains("no key 'harmonics'"));
  CHECK_THAT(refused(start + "harmonics = [1, 2]\nsine_rad = [0.1]\ncosine_rad = [0, 0]\n"),
             Contains("2 harmonics, 1 numbers in sine_rad and 2 in cosine_rad"));
  CHECK_THAT(refused(start + "harmonics = 3\nsine_rad = [0.1]\ncosine_rad = [0]\n"), Contains("s.toml:3"));
  CHECK_THAT(refused(start + "amplitude_rad = 3\n"), Contains("unknown key 'amplitude_rad'"));
}

TEST_CASE("A model's sensor noise is the scenario's, and is kept when the model is written") {
  const trees::TreeModel m = test::arm3("[sensors]\nangle_noise_rad = 1e-3\n");
  CHECK(trees::default_scenario(m).angle_noise_rad == 1e-3);
  CHECK_THAT(trees::format_tree_model(m, "arm3.urdf"), Contains("[sensors]\nangle_noise_rad = 0.001\n"));
  CHECK_THAT(test::error_message([] { test::arm3("[sensors]\nangle_noise_rad = -1\n"); }),
             Contains("[sensors] angle_noise_rad"));
}

TEST_CASE("The same seed gives the same log, another one another") {
  const trees::TreeModel m = test::arm3();
  trees::Scenario s = trees::default_scenario(m);
  s.duration_s = 1.0;
  CHECK(trees::simulate(m, s, 3).columns == trees::simulate(m, s, 3).columns);
  CHECK(trees::simulate(m, s, 3).columns != trees::simulate(m, s, 4).columns);
}

TEST_CASE("Without disturbance and noise the joints follow their paths, and the torque is the pendulum's") {
  const trees::TreeModel m = test::pendulum();
  trees::Scenario s = trees::default_scenario(m);
  s.duration_s = 6.0;
  s.disturbance_share = s.angle_noise_rad = s.torque_noise_share = 0.0;
  s.paths[0] = {Path::Profile::sine, 0.3, 0.4, 2.0, 0.0};
  const log::Log log = trees::simulate(m, s, 1);
  REQUIRE(log.rows() == 1501);
  const double w = 2.0 * std::numbers::pi / 2.0, inertia = 0.025 + 0.8 * 0.09;
  for (std::size_t k = 300; k < log.rows(); ++k) {
    const double t = log.time_s()[k], q = 0.3 + 0.4 * std::sin(w * t);
    CHECK(std::abs(log.at("angle_hinge_rad")[k] - q) < 0.01);
    const double torque = -inertia * 0.4 * w * w * std::sin(w * t) + 0.02 * 0.4 * w * std::cos(w * t) +
                          0.8 * 9.81 * 0.3 * std::sin(q);
    CHECK(std::abs(log.at("torque_hinge_nm")[k] - torque) < 0.05);
  }
}
