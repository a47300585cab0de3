// Designed recordings: their limits, what they tell beside random ones, what no recording tells.
#include <algorithm>
#include <cstdio>
#include <numbers>
#include <set>

#include "host/core/random.hpp"
#include "host/excite/result.hpp"
#include "host/trees/identify.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

constexpr const char* kFree =
    "[drive]\ncontrol_mode = \"torque\"\nrotor_inertia_kgm2 = 0.02\n[free]\n"
    "\"damping_nmspr.yaw\" = [0.0, 1.0]\n\"damping_nmspr.shoulder\" = [0.0, 1.0]\n"
    "\"damping_nmspr.elbow\" = [0.0, 1.0]\n\"rotor_inertia_kgm2.yaw\" = [0.0, 0.1]\n"
    "\"rotor_inertia_kgm2.shoulder\" = [0.0, 0.1]\n\"rotor_inertia_kgm2.elbow\" = [0.0, 0.1]\n";

std::vector<excite::JointLimits> limits(const trees::TreeModel& m,
                                        const std::vector<std::string>& texts = {}) {
  std::vector<excite::Override> overrides;
  for (const std::string& t : texts) overrides.push_back(excite::parse_override(t));
  return excite::limits_of(m, overrides);
}

excite::Options quick(std::size_t recordings = 1, std::size_t evaluations = 40) {
  excite::Options o;
  o.recordings = recordings;
  o.evaluations = evaluations;
  o.duration_s = 6.0;
  o.threads = 2;
  return o;
}

/// One sine a joint, its period anywhere between the shortest of the design and the recording, on a logarithmic scale; its amplitude made
/// smaller until the motion is within what a designed one may use.
trees::Scenario random_sines(const trees::TreeModel& m, const std::vector<excite::JointLimits>& limits,
                             const trees::Scenario& like, double highest_hz, core::Random& random) {
  trees::Scenario out = like;
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const excite::JointLimits& l = limits[j];
    const double half = 0.5 * excite::kOfRange * (l.upper_rad - l.lower_rad),
                 middle = 0.5 * (l.lower_rad + l.upper_rad);
    trees::Path& p = out.paths[j];
    p = {};
    p.period_s = std::exp(random.uniform(std::log(1.0 / highest_hz), std::log(like.duration_s)));
    p.amplitude_rad = random.uniform(0.0, half);
    p.centre_rad = middle + random.uniform(-1.0, 1.0) * (half - p.amplitude_rad);
    p.phase_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  }
  for (int attempt = 0; attempt < 200; ++attempt) {
    const std::vector<excite::Extremes> e = excite::extremes(m, out, 0.01);
    std::size_t worst = 0;
    double most = 0.0;
    for (std::size_t j = 0; j < e.size(); ++j) {
      excite::JointLimits l = limits[j];
      l.velocity_radps *= excite::kOfVelocity;
      l.torque_nm *= excite::kOfTorque;
      if (const double used = excite::used(e[j], l); used > most) most = used, worst = j;
    }
    if (most <= 1.0) return out;
    out.paths[worst].amplitude_rad *= 0.9;
  }
  return random_sines(m, limits, like, highest_hz, random);
}

/// Widths of the 95 % intervals that `furcula identify` gives.
std::vector<double> widths(const trees::TreeModel& m, const std::vector<trees::Scenario>& scenarios,
                           std::uint64_t seed, std::vector<std::string>* names = nullptr) {
  std::vector<log::Log> logs;
  for (const trees::Scenario& s : scenarios) {
    logs.push_back(trees::simulate(m, s, seed++));
    logs.back().path = "log_" + std::to_string(seed) + ".csv";
  }
  trees::Options o;
  o.threads = 2;
  // Random sines of a seed may hardly move a joint.
  o.trust_columns = true;
  const trees::Identification found = trees::identify(m, logs, {logs.back()}, o);
  std::vector<double> out;
  for (const auto& p : found.parameters) {
    out.push_back(p.upper - p.lower);
    if (names != nullptr) names->push_back(p.name);
  }
  return out;
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return 0.5 * (x[x.size() / 2] + x[(x.size() - 1) / 2]);
}

/// Of each parameter the median over seeds of the designed recordings' interval over that of random sines.
std::vector<double> ratios(const trees::TreeModel& m, const excite::Options& o, std::size_t seeds,
                           std::vector<std::string>& names) {
  const auto l = limits(m);
  const excite::Design d = excite::design(m, l, o);
  std::vector<std::vector<double>> ratio;
  for (std::size_t seed = 0; seed < seeds; ++seed) {
    core::Random random(seed, 7);
    std::vector<trees::Scenario> sines;
    for (std::size_t r = 0; r < o.recordings; ++r)
      sines.push_back(random_sines(m, l, d.scenarios[r], o.highest_hz, random));
    names.clear();
    const std::vector<double> a = widths(m, d.scenarios, 1000 + 10 * seed, &names),
                              b = widths(m, sines, 1000 + 10 * seed);
    ratio.resize(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) ratio[k].push_back(a[k] / b[k]);
  }
  std::vector<double> out;
  for (const auto& r : ratio) out.push_back(median(r));
  return out;
}

}  // namespace

TEST_CASE(
    "Simulated recordings of designed motions stay within the limits of position, velocity and torque") {
  const trees::TreeModel m = test::arm3(kFree);
  const auto l = limits(m, {"shoulder.lower=-1.2", "shoulder.upper=0.4", "all.velocity=4", "elbow.effort=5"});
  const excite::Design d = excite::design(m, l, quick(2));
  REQUIRE(d.scenarios.size() == 2);
  for (const trees::Scenario& s : d.scenarios) {
    const log::Log log = trees::simulate(m, s, 5);
    for (std::size_t j = 0; j < m.joints(); ++j) {
      const auto& q = log.at(trees::column_of(m, j, "angle"));
      const auto& torque = log.at(trees::column_of(m, j, "torque_cmd"));
      INFO(m.robot.joints[j].name);
      for (std::size_t k = 1; k + 1 < q.size(); ++k) {
        REQUIRE(q[k] > l[j].lower_rad);
        REQUIRE(q[k] < l[j].upper_rad);
        REQUIRE(std::abs(torque[k]) < l[j].torque_nm);
      }
      // Over 40 ms the encoders' noise makes less than 0.01 rad/s of a velocity.
      for (std::size_t k = 5; k + 5 < q.size(); ++k)
        REQUIRE(std::abs(q[k + 5] - q[k - 5]) / (log.time_s()[k + 5] - log.time_s()[k - 5]) <
                l[j].velocity_radps);
    }
  }
}

TEST_CASE("Under the position law the simulated motion, not the set points alone, stays within the limits") {
  const trees::TreeModel m =
      test::arm3("[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 60.0\nkd_nmsprad = 2.0\n");
  const auto l = limits(m, {"all.velocity=3", "shoulder.upper=0.5", "all.effort=15"});
  const excite::Design d = excite::design(m, l, quick(1, 20));
  const auto e = excite::extremes(m, d.scenarios.front(), 0.004);
  for (std::size_t j = 0; j < m.joints(); ++j) CHECK(excite::used(e[j], l[j]) <= 1.0);
}

TEST_CASE("Designed motions begin and end at rest") {
  const trees::TreeModel m = test::arm3(kFree);
  const excite::Design d = excite::design(m, limits(m), quick(1, 20));
  for (const trees::Path& p : d.scenarios.front().paths)
    for (const double t : {0.0, 6.0}) {
      CHECK(std::abs(p.at(t).v) < 1e-9);
      CHECK(std::abs(p.at(t).a) < 1e-9);
    }
}

TEST_CASE("The same seed designs the same set points on one thread and on two, another seed others") {
  const trees::TreeModel m = test::double_pendulum("[drive]\ncontrol_mode = \"torque\"\n");
  const auto l = limits(m, {"all.effort=5", "all.velocity=5", "all.lower=-2", "all.upper=2"});
  excite::Options o = quick(1, 20);
  o.duration_s = 3.0;
  const auto text = [&] { return excite::setpoints_csv(m, excite::design(m, l, o).scenarios.front()); };
  const std::string two = text();
  o.threads = 1;
  CHECK(text() == two);
  o.seed = 2;
  CHECK(text() != two);
}

TEST_CASE(
    "In the geometric mean intervals from designed recordings are at most half as wide as those from random sines") {
  const trees::TreeModel m = test::arm3(kFree);
  excite::Options o = quick(1, 200);
  o.about = excite::About::free;
  std::vector<std::string> names;
  const std::vector<double> all = ratios(m, o, 3, names);
  double log_mean = 0.0;
  for (const double r : all) log_mean += std::log(r) / static_cast<double>(all.size());
  CHECK(std::exp(log_mean) < 0.5);
}

TEST_CASE("Table: each parameter's interval beside random sines, 20 seeds", "[.table]") {
  const trees::TreeModel m = test::arm3(std::string(kFree) + "\"inertial.fore\" = [0.5, 2.0]\n");
  excite::Options o;
  o.threads = 2;
  o.recordings = 1;
  const auto table = [&] {
    std::vector<std::string> names;
    const std::vector<double> all = ratios(m, o, 20, names);
    std::printf("for %s, %zu motions tried\n", o.about == excite::About::free ? "free" : "all",
                o.evaluations);
    for (std::size_t k = 0; k < all.size(); ++k) std::printf("| `%s` | %.2f |\n", names[k].c_str(), all[k]);
    std::fflush(stdout);
  };
  table();
  o.about = excite::About::free;
  table();
  o.evaluations = 2000;
  table();
  // The largest part of it: how much narrower one parameter's interval can be when the motion is for it alone.
  const trees::TreeModel alone = test::arm3(
      "[drive]\ncontrol_mode = \"torque\"\nrotor_inertia_kgm2 = 0.02\n[free]\n\"damping_nmspr.elbow\" = [0.0, 1.0]\n");
  std::vector<std::string> names;
  o.evaluations = 1000;
  std::printf("damping_nmspr.elbow alone: %.2f\n", ratios(alone, o, 20, names).front());
}

TEST_CASE(
    "Mass, centre and inertia of the link on a vertical axis, and its rotor, are one number in any motion") {
  const trees::TreeModel m = test::arm3(kFree);
  const excite::Options o = quick(1, 20);
  const excite::Check c = excite::check_of(m, excite::design(m, limits(m), o), o);
  const auto together =
      std::find_if(c.confused.begin(), c.confused.end(), [](const auto& x) { return !x.ever; });
  REQUIRE(together != c.confused.end());
  const std::set<std::string> names(together->names.begin(), together->names.end());
  CHECK(names == std::set<std::string>{"rotor_inertia_kgm2.yaw", "mass_error@column", "com_error@column",
                                       "inertia_error@column", "payload@column"});
  CHECK_THAT(excite::sentence(*together),
             Contains("No motion of this robot tells rotor_inertia_kgm2.yaw from"));
  // The two bodies beyond have more.
  CHECK(std::none_of(c.confused.begin(), c.confused.end(), [](const auto& x) {
    return !x.ever && std::find(x.names.begin(), x.names.end(), "mass_error@fore") != x.names.end();
  }));
  CHECK_FALSE(c.combinations.empty());
}

TEST_CASE(
    "Viscous and Coulomb friction of a joint that moves with one speed to and fro cannot be told apart") {
  const trees::TreeModel m = test::wheel("[drive]\ncontrol_mode = \"torque\"\n");
  // The velocity is a square wave but for its edges: third, fifth, ... harmonics.
  trees::Scenario s = trees::default_scenario(m);
  s.duration_s = 8.0;
  trees::Path& p = s.paths[0];
  p = {trees::Path::Profile::fourier, 0.0, 0.0, 2.0, 0.0};
  for (const double k : {1.0, 3.0, 5.0, 7.0, 9.0, 11.0})
    p.harmonics.push_back({k, 0.8 / (k * k) * (std::fmod(k, 4.0) == 1.0 ? 1.0 : -1.0), 0.0});
  s.torque_noise_nm = {0.05};
  const std::vector<trees::Recording> square{trees::recording_of(m, trees::simulate(m, s, 1))};
  p = {};
  p.amplitude_rad = 0.8;
  const std::vector<trees::Recording> sine{trees::recording_of(m, trees::simulate(m, s, 1))};
  const auto correlation = [&](const std::vector<trees::Recording>& r) {
    const trees::Problem problem(m, r, trees::windows_of(m, r, 0.3), 1);
    for (const auto& c : excite::check(m, excite::subjects(problem), r, 0.3, 1).confused)
      if (std::set<std::string>(c.names.begin(), c.names.end()) ==
          std::set<std::string>{"damping_error@wheel", "coulomb_friction@wheel"})
        return c.correlation;
    return 0.0;
  };
  CHECK(correlation(square) > 0.99);
  CHECK(correlation(sine) == 0.0);
}

TEST_CASE("Wrong limits, a weak joint and a short recording are refused with one message each") {
  using test::error_message;
  const trees::TreeModel m = test::arm3(kFree);
  CHECK_THAT(error_message([] { excite::parse_override("elbow.speed=2"); }),
             Contains("'speed'") && Contains("expected JOINT.KEY=NUMBER"));
  CHECK_THAT(error_message([] { excite::parse_override("elbow.velocity=fast"); }), Contains("has no number"));
  CHECK_THAT(error_message([] { excite::parse_override("elbow.velocity=-1"); }), Contains("is not above 0"));
  CHECK_THAT(error_message([&] { limits(m, {"elbo.velocity=1"}); }),
             Contains("'elbo'") && Contains("did you mean 'elbow'?"));
  CHECK_THAT(error_message([&] { limits(m, {"elbow.lower=4"}); }), Contains("expected lower below upper"));
  const trees::TreeModel none = test::robot("trees/published/thin_rod_chain_without_limits.urdf",
                                            "[drive]\ncontrol_mode = \"torque\"\n");
  CHECK_THAT(error_message([&] { limits(none); }), Contains("has no limit of") && Contains("--limit"));
  CHECK_THAT(
      error_message([&] {
        excite::easiest_posture(m, limits(m, {"shoulder.effort=2", "shoulder.lower=-0.3",
                                              "shoulder.upper=0.3", "elbow.lower=-0.3", "elbow.upper=0.3"}));
      }),
      Contains("joint 'shoulder' cannot move against gravity") && Contains("expected a higher effort limit"));
  excite::Options o = quick();
  o.duration_s = 1.0;
  CHECK_THAT(error_message([&] { excite::design(m, limits(m), o); }),
             Contains("1 s is too short") && Contains("expected 2 s or more"));
}

TEST_CASE("An arm too weak to hold itself outstretched is moved where it can hold itself") {
  const trees::TreeModel m = test::arm3(kFree);
  const auto l = limits(m, {"shoulder.effort=3"});
  const excite::Design d = excite::design(m, l, quick(1, 20));
  const auto e = excite::extremes(m, d.scenarios.front(), 0.01);
  for (std::size_t j = 0; j < m.joints(); ++j) CHECK(excite::used(e[j], l[j]) <= 1.0);
  // Outstretched it takes 5.9 N m.
  CHECK(e[1].torque_nm < 3.0);
  CHECK(e[1].highest_rad - e[1].lowest_rad > 0.05);
}

TEST_CASE(
    "Set points are a table of positions and velocities that a scenario plays, and the result is JSON") {
  excite::Result r{test::arm3(kFree), {}, quick(1, 20), {}, {}, {}};
  r.limits = limits(r.model);
  r.design = excite::design(r.model, r.limits, r.options);
  r.check = excite::check_of(r.model, r.design, r.options);
  const auto files = excite::files(r, "out");
  REQUIRE(files.size() == 3);
  CHECK(files[0].path == "out/setpoints_1.csv");
  CHECK_THAT(files[0].content,
             Catch::StartsWith("time_s,angle_cmd_yaw_rad,velocity_cmd_yaw_radps,angle_cmd_shoulder_rad,"));
  CHECK(std::count(files[0].content.begin(), files[0].content.end(), '\n') == 1 + 1501);
  const trees::Scenario again = trees::parse_scenario(files[1].content, "scenario_1.toml", r.model);
  CHECK(again.paths[2].at(3.3).q == r.design.scenarios[0].paths[2].at(3.3).q);
  CHECK(again.torque_noise_nm == r.design.scenarios[0].torque_noise_nm);
  CHECK_THAT(files[2].content, Contains("\"schema\": \"furcula-excitation/1\"") &&
                                   Contains("\"damping_nmspr.elbow\"") && Contains("\"indistinguishable\""));
}
