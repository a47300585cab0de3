// The search: one seed, one result; a walk from a robot that falls.
#include "host/walk/search.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;

TEST_CASE("one seed gives one result on any number of threads, and the best only gets better") {
  SearchOptions options;
  options.steps = 2'000'000;
  options.seed = 5;
  const auto robot = dynamics::biped::design();
  std::vector<double> shares;
  options.progress = [&](double share, const std::string& doing) {
    shares.push_back(share);
    CHECK_FALSE(doing.empty());
  };
  const SearchResult one = search_walk(robot, options);
  options.threads = 3;
  const SearchResult three = search_walk(robot, options);
  CHECK(one.walk.values() == three.walk.values());
  CHECK(one.state.steps == three.state.steps);
  CHECK(one.state.steps >= 2'000'000);
  CHECK(one.state.steps < 2'000'000 + 32 * 20000);
  REQUIRE(one.state.history.size() == three.state.history.size());
  for (std::size_t i = 1; i < one.state.history.size(); ++i)
    CHECK(one.state.history[i].objective < one.state.history[i - 1].objective);
  CHECK(one.state.history.back().objective < one.state.history.front().objective);
  REQUIRE_FALSE(shares.empty());
  CHECK(shares.front() == 0.0);
  options.seed = 6;
  CHECK(search_walk(robot, options).walk.values() != one.walk.values());
}

TEST_CASE("a passive hip's pitch is not sought") {
  SearchOptions options;
  options.rollout.mode = WalkMode::semi_passive;
  options.steps = 500'000;
  const auto found = search_walk(dynamics::biped::design(), options).walk.values();
  std::size_t kept = 0, changed = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& p = control::kWalkParameters[i];
    if (p.of_hip_pitch) CHECK(found[i] == p.start);
    ++(found[i] == p.start ? kept : changed);
  }
  CHECK(kept == 9);
  CHECK(changed == 37);
}

TEST_CASE("a search from a walk begins with it, and looks near it") {
  SearchOptions options;
  options.start = test::found_walk().parameters;
  options.steps = 20'000;  // the walk itself, and one generation
  const auto robot = dynamics::biped::design();
  const SearchResult one = search_walk(robot, options);
  REQUIRE(one.found);
  REQUIRE_FALSE(one.state.bests.empty());
  CHECK(one.state.bests.front().values() == options.start->values());
  options.steps = 3'000'000;
  const SearchResult more = search_walk(robot, options);
  CHECK(more.state.history.back().objective <= one.state.history.front().objective);
  // A joint's targets are still about those of the walk.
  CHECK(std::abs(more.walk.up_s - options.start->up_s) < 0.2);
}

TEST_CASE("from steps on the spot a search soon gets ahead within all limits, whatever its seed and mode") {
  const auto robot = dynamics::biped::design();
  for (const WalkMode mode : {WalkMode::active, WalkMode::semi_passive})
    for (const std::uint64_t seed : {11u, 12u, 13u}) {
      SearchOptions options;
      options.rollout.mode = mode;
      options.seed = seed;
      options.steps = 20'000'000;  // some 4 s of a processor
      options.threads = 2;
      // The first walk ends it.
      bool found = false;
      options.interrupted = [&] { return found; };
      options.keep_every_s = 0.0;
      options.keep = [&](const SearchState& state) { found = state.first_walk.has_value(); };
      const SearchResult r = search_walk(robot, options);
      INFO(kModeNames[static_cast<std::size_t>(mode)] << ", seed " << seed);
      REQUIRE(r.state.first_walk);
    }
}
