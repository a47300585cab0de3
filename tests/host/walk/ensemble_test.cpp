// Ensembles: each member is the robot that it says, with the errors of its sensors and its pushes; and a search that has to stand on all.
#include "host/walk/ensemble.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/biped/kinematics.hpp"
#include "host/walk/batched_rollout.hpp"
#include "host/walk/search.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;

namespace {

Member still(const dynamics::biped::Description& robot) { return {robot, {}, 0.0, {}}; }

bool same(const Rollout& a, const Rollout& b) {
  return a.ending == b.ending && a.time_s == b.time_s && a.work_j == b.work_j && a.copper_j == b.copper_j &&
         a.distance_m == b.distance_m && a.landings == b.landings;
}

RolloutOptions one_step_a_tick(WalkMode mode) {
  RolloutOptions o;
  o.mode = mode;
  o.step_s = 1e-3;
  o.steps_a_tick = 1;
  return o;
}

/// What the one member of an ensemble does, tick by tick.
template <class F>
Rollout watched(const Member& member, double time_s, const Parameters& walk, const F& watch) {
  const auto known = dynamics::biped::design();
  RolloutOptions o;
  o.time_s = time_s;
  BatchedRollout<double> rollouts(std::span(&member, 1), known, o);
  rollouts.watch = watch;
  return rollouts.run_one(walk);
}

}  // namespace

TEST_CASE("a member that deviates in nothing is the robot, whoever is in the lanes beside it") {
  const auto robot = dynamics::biped::design();
  biped::Machine machine;
  machine.robot = robot;
  for (const WalkMode mode :
       {WalkMode::active, WalkMode::semi_passive, WalkMode::knee_passive, WalkMode::knee_braked}) {
    std::vector<Member> members = drawn_robots(machine, mode, {.robots = 4, .deviations = 0.5, .seed = 3});
    members.push_back(still(robot));
    const Parameters walk =
        test::found_walk(mode == WalkMode::semi_passive ? "semi_passive" : "active").parameters;
    std::vector<Job> jobs;
    for (std::size_t n = 0; n < 20; ++n) jobs.push_back({walk, n % members.size()});
    RolloutOptions options;
    options.mode = mode;
    const auto together = run_jobs(robot, members, options, jobs, 2);
    for (std::size_t k = 0; k < members.size(); ++k) {
      CAPTURE(k, static_cast<int>(mode));
      CHECK(same(together[k], run_jobs(robot, {members[k]}, options, {{walk, 0}}, 1)[0]));
      CHECK(same(together[k], together[k + members.size()]));
    }
    CHECK_FALSE(same(together[0], together[1]));
    // The same but for the last digits of where it begins.
    const Rollout alone = run_walks(robot, one_step_a_tick(mode), {walk}, 1)[0], &as_member = together[4];
    CHECK(as_member.ending == alone.ending);
    CHECK(as_member.landings == alone.landings);
    CHECK(as_member.distance_m == Approx(alone.distance_m).epsilon(0.02));
  }
}

TEST_CASE("when a push begins hangs on no other lane, though its time is no number of the lanes' type") {
  using T = dynamics::SimdBatch<float, 8>;
  constexpr double kTick_s = 1e-3;
  const auto pushed_at = [](double begin_s) {
    Member m = still(dynamics::biped::design());
    m.pushes[0] = {begin_s, begin_s + 0.1, 1.0, 0.0};
    return m;
  };
  for (int k = 0; k < 20; ++k) {
    const float now_s = 1.0f + 0.001f * static_cast<float>(k);
    // In single precision the first one begins in the middle of the tick, in double before it. The second one has begun.
    const double middle_s = static_cast<double>(now_s) + 0.5 * kTick_s;
    const Member edge = pushed_at(middle_s - 1e-9), begun = pushed_at(middle_s - 0.01);
    const auto field = [&](const Member& beside) {
      MemberBatch<T> members;
      dynamics::tree::Vec3<T> out{T(0.0f), T(0.0f), T(0.0f)};
      for (std::size_t lane = 0; lane < 8; ++lane)
        members.begin(lane, lane == 0 ? edge : beside, {0.0, 0.0, -9.81});
      members.push(T(0.0f), kTick_s, out);
      members.push(T(now_s), kTick_s, out);
      return out.x[0];
    };
    INFO(k);
    CHECK(field(begun) == field(edge));
  }
}

TEST_CASE("a member's numbers are its own: what a lane does is what its robot does by itself, in double") {
  const auto robot = dynamics::biped::design();
  biped::Machine machine;
  machine.robot = robot;
  // Each on its feet for a second: in float and in double they have not come apart yet.
  RolloutOptions options = one_step_a_tick(WalkMode::active);
  options.time_s = 1.0;
  const auto members = drawn_robots(machine, WalkMode::active, {.robots = 8, .deviations = 1.0, .seed = 5});
  std::vector<Job> jobs;
  for (std::size_t k = 0; k < members.size(); ++k) jobs.push_back({test::standing_walk(), k});
  const auto lanes = run_jobs(robot, members, options, jobs, 1);
  for (std::size_t k = 0; k < members.size(); ++k) {
    const Rollout alone =
        BatchedRollout<double>(std::span(&members[k], 1), robot, options).run_one(test::standing_walk());
    CAPTURE(k);
    REQUIRE(alone.ending == Ending::stands);
    CHECK(lanes[k].distance_m == Approx(alone.distance_m).margin(2e-4));
    CHECK(lanes[k].copper_j == Approx(alone.copper_j).epsilon(0.02));
    CHECK(lanes[k].torque_nm == Approx(alone.torque_nm).epsilon(0.02));
  }
}

TEST_CASE("encoders that err read the posture at first, and the drives hold what is read") {
  const auto robot = dynamics::biped::design();
  Member m = still(robot);
  constexpr std::size_t kKnee = dynamics::biped::kKnee;
  m.sensors.encoder_rad[kKnee] = 0.02;
  const auto posture = [&](const Member& member, double& read_rad, double& is_rad, double& end_rad) {
    bool first = true;
    watched(member, 1.0, test::standing_walk(), [&](const WalkMoment<double>& at) {
      end_rad = dynamics::biped::joint<double>(at.state.q_rad, kKnee);
      if (first) read_rad = dynamics::biped::joint<double>(at.sample.q_rad, kKnee), is_rad = end_rad;
      first = false;
    });
  };
  double read = 0.0, is = 0.0, end = 0.0, right_read = 0.0, right_is = 0.0, right_end = 0.0;
  posture(m, read, is, end);
  posture(still(robot), right_read, right_is, right_end);
  CHECK(read == Approx(right_read).margin(1e-12));
  CHECK(is == Approx(right_is - 0.02).margin(1e-3));
  CHECK(end == Approx(right_end - 0.02).margin(3e-3));  // it carries a little more with the leg straighter
}

TEST_CASE("a turned and biased IMU gives what it measures in its own axes") {
  Member m = still(dynamics::biped::design());
  const double turn = 0.1;
  m.sensors.imu_turn_rad = {turn, 0.0, 0.0};
  m.sensors.gyro_bias_radps = {0.0, 0.0, 0.03};
  // It stands: gravity's opposite, and nothing but the bias of the gyro.
  bool seen = false;
  watched(m, 0.2, test::standing_walk(), [&](const WalkMoment<double>& at) {
    if (at.time_s > 0.0015) return;
    seen = true;
    // To the filter the vertical is turned about x, the other way: a turn of the IMU by +a about x reads as a robot turned by +a.
    const auto& q = at.sample.attitude;
    CHECK(2.0 * std::atan2(q.x, q.w) == Approx(turn).margin(2e-3));
    CHECK(at.sample.gyro_radps.z == Approx(0.03).margin(1e-3));
  });
  CHECK(seen);
}

TEST_CASE(
    "a robot without an ensemble has the sensors that its options say, and its controller knows the robot that they say") {
  const auto design = dynamics::biped::design();
  auto robot = design;
  robot.pelvis.mass_kg += 2.0;
  robot.pelvis.centre_m.x += 0.01;
  Member m{robot, {}, 0.0, {}};
  m.sensors.encoder_rad[dynamics::biped::kKnee] = 0.01;
  m.sensors.imu_turn_rad.y = 0.01;
  const Parameters walk = test::found_walk().parameters;
  RolloutOptions options = one_step_a_tick(WalkMode::active);
  options.time_s = 1.5;
  options.known = design;
  const Rollout member = BatchedRollout<double>(std::span(&m, 1), robot, options).run_one(walk);
  RolloutOptions own = options;
  own.sensors = m.sensors;
  CHECK(same(run_walk(robot, own, walk), member));
  CHECK_FALSE(same(run_walk(robot, options, walk), member));
  CHECK(same(run_walks(robot, own, {walk}, 1)[0], run_jobs(robot, {m}, options, {{walk, 0}}, 1)[0]));
  // A controller that knows of the mass does otherwise.
  own.known.reset();
  CHECK_FALSE(same(run_walk(robot, own, walk), member));
  CHECK(same(run_walk(robot, own, walk), BatchedRollout<double>(std::span(&m, 1), robot, own).run_one(walk)));
}

TEST_CASE("a foot whose sensor reads too little does not close its switch") {
  const auto carries = [](double change_n) {
    Member m = still(dynamics::biped::design());
    m.foot_change_n = change_n;
    double left = -1.0;
    watched(m, 0.3, test::standing_walk(),
            [&](const WalkMoment<double>& at) { left = at.sample.left_carries; });
    return left;
  };
  // Each foot carries 244 N, the switches close at 30 N.
  CHECK(carries(-200.0) == 1.0);
  CHECK(carries(-300.0) == 0.0);
}

TEST_CASE("a push gives the robot its momentum, and no accelerometer feels what pulls all of it alike") {
  const auto robot = dynamics::biped::design();
  Member m = still(robot);
  m.pushes[0] = {0.2, 0.3, 0.0, 1.5};
  const dynamics::biped::Parameters<double> plain(robot);
  double before = 0.0, after = 0.0, later = 0.0;
  watched(m, 0.5, test::standing_walk(), [&](const WalkMoment<double>& at) {
    const double y = dynamics::biped::totals(plain, at.state).linear_ns.y;
    if (at.time_s < 0.2005) before = y;
    if (at.time_s < 0.2035) after = y;
    if (at.time_s < 0.4) later = std::max(later, y);
  });
  // Three milliseconds of it, before the feet's springs give way.
  CHECK(after - before == Approx(3e-3 * 1.5 * robot.mass_kg()).epsilon(0.15));
  CHECK(later < 0.1 * 1.5 * robot.mass_kg());  // the ground holds against it
  CHECK(later > 2.0 * (after - before));
}

TEST_CASE(
    "drawn robots are within their share of the tables, one seed gives the same, and none but their pushes move what it stands on") {
  biped::Machine machine;
  machine.robot = dynamics::biped::design();
  const EnsembleOptions half{.robots = 40, .deviations = 0.5, .seed = 2};
  const auto members = drawn_robots(machine, WalkMode::active, half);
  REQUIRE(members.size() == 40);
  const double degree = std::numbers::pi / 180.0;
  double heaviest = 0.0, lightest = 1e9, farthest = 0.0;
  for (const Member& m : members) {
    // Document 000, Table I: masses within 1 kg, encoders 0.5 degrees; the thigh's mass and all encoders.
    heaviest = std::max(heaviest, m.robot.legs[0][2].mass_kg);
    lightest = std::min(lightest, m.robot.legs[0][2].mass_kg);
    for (const double o : m.sensors.encoder_rad) farthest = std::max(farthest, std::abs(o));
    CHECK(std::abs(m.robot.slope_x_rad) <= 0.25 * degree);
    CHECK(std::abs(m.foot_change_n) <= 7.5);
    CHECK(std::abs(m.robot.ground.friction - 0.8) <= 0.2);
    double end_s = 0.0;
    for (const Push& p : m.pushes) {
      CHECK(p.begin_s >= end_s);
      CHECK(p.end_s == Approx(p.begin_s + 0.1));
      end_s = p.end_s;
    }
    CHECK(m.pushes.back().end_s > 5.0);
  }
  CHECK(heaviest <= 5.9);
  CHECK(lightest >= 4.9);
  CHECK(heaviest - lightest > 0.8);
  CHECK(farthest <= 0.25 * degree);
  CHECK(farthest > 0.24 * degree);
  const auto again = drawn_robots(machine, WalkMode::active, half);
  CHECK(again[7].robot.pelvis.mass_kg == members[7].robot.pelvis.mass_kg);
  const auto other = drawn_robots(machine, WalkMode::active, {.robots = 40, .deviations = 0.5, .seed = 3});
  CHECK(other[7].robot.pelvis.mass_kg != members[7].robot.pelvis.mass_kg);
}

TEST_CASE("a robust search takes the walk that stands on all robots, a plain one the cheapest") {
  // In place of simulation: the lower the first number, the cheaper, and the fewer robots it stands on.
  const auto share = [](const Job& job) {
    const auto& p = control::kWalkParameters[0];
    return (job.walk.values()[0] - p.least) / (p.most - p.least);
  };
  SearchOptions options;
  options.steps = 10'000'000;
  std::size_t on_others = 0;
  options.run = [&](const std::vector<Job>& jobs) {
    std::vector<Rollout> out;
    for (const Job& job : jobs) {
      Rollout r;
      const double x = share(job);
      const bool stands = x >= 0.15 * static_cast<double>(job.member);
      r.ending = stands ? Ending::stands : Ending::fell;
      r.time_s = stands ? 10.0 : 10.0 * x / (0.15 * static_cast<double>(job.member));
      r.distance_m = 1.0;
      r.cot = 2.0 + x;
      r.steps = 200;
      out.push_back(r);
      if (job.member > 0) ++on_others;
    }
    return out;
  };
  const auto robot = dynamics::biped::design();
  const auto first = [&] {
    const SearchResult found = search_walk(robot, options);
    return share({found.state.bests.back(), 0});
  };
  CHECK(first() < 0.02);
  CHECK(on_others == 0);
  options.ensemble.assign(4, still(robot));
  const double robust = first();
  CHECK(on_others > 1000);
  CHECK(robust >= 0.6);  // the fourth of the other robots
  CHECK(robust < 0.65);
}

TEST_CASE(
    "a robust search that is interrupted goes on as if it had not been, before and after it asks the other robots") {
  SearchOptions options;
  options.steps = 2'000'000;
  options.run = [&](const std::vector<Job>& jobs) {
    std::vector<Rollout> out;
    for (const Job& job : jobs) {
      Rollout r;
      r.ending = Ending::stands;
      r.time_s = 10.0;
      r.distance_m = 1.0;
      double away = 0.0;
      const auto values = job.walk.values();
      for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& p = control::kWalkParameters[i];
        away +=
            std::pow((values[i] - p.least) / (p.most - p.least) - 0.1 * static_cast<double>(job.member), 2);
      }
      r.cot = 1.0 + away;
      r.steps = 200;
      out.push_back(r);
    }
    return out;
  };
  const auto robot = dynamics::biped::design();
  options.ensemble.assign(4, still(robot));
  const SearchResult whole = search_walk(robot, options);
  REQUIRE(whole.state.robust_start);
  for (const double share : {0.1, 0.7}) {
    SearchOptions first = options;
    double done = 0.0;
    first.progress = [&](double fraction, const std::string&) { done = fraction; };
    first.interrupted = [&] { return done > share; };
    const SearchResult part = search_walk(robot, first);
    REQUIRE(part.interrupted);
    CHECK(part.state.robust_start.has_value() == (share > 0.5));
    SearchOptions rest = options;
    rest.from = part.state;
    const SearchResult resumed = search_walk(robot, rest);
    CAPTURE(share);
    CHECK(resumed.walk.values() == whole.walk.values());
    CHECK(resumed.state.steps == whole.state.steps);
    CHECK(resumed.state.history.size() == whole.state.history.size());
    CHECK(resumed.state.method == whole.state.method);
  }
}

TEST_CASE(
    "a robust search gives one walk on any number of threads, and one that stands on more robots that it has not seen",
    "[long]") {
  biped::Machine machine;
  machine.robot = dynamics::biped::design();
  SearchOptions options;
  options.start = test::found_walk().parameters;
  options.steps = 20'000'000;
  options.ensemble = drawn_robots(machine, WalkMode::active, {.deviations = 1.0});
  const SearchResult one = search_walk(machine.robot, options);
  options.threads = 2;
  CHECK(search_walk(machine.robot, options).walk.values() == one.walk.values());
  const auto unseen = drawn_robots(machine, WalkMode::active, {.robots = 64, .deviations = 1.0, .seed = 99});
  const auto stand = [&](const Parameters& walk) {
    std::vector<Job> jobs;
    for (std::size_t k = 0; k < unseen.size(); ++k) jobs.push_back({walk, k});
    std::size_t count = 0;
    for (const Rollout& r : run_jobs(machine.robot, unseen, options.rollout, jobs, 2))
      count += r.ending == Ending::stands ? 1 : 0;
    return count;
  };
  const std::size_t before = stand(*options.start), after = stand(one.walk);
  CAPTURE(before, after);
  CHECK(after > before + 16);
}
