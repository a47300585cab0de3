// Checkpoints: an interrupted search gives what it gives without; what cannot be gone on with is said.
#include "host/walk/checkpoint.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "host/core/error.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;
using Catch::Contains;

namespace {

/// In place of simulation: the cost of transport is a bowl in shares of the ranges, with a flat bottom, and some of space falls.
std::vector<Rollout> bowl(const std::vector<Job>& walks) {
  std::vector<Rollout> out;
  for (const Job& job : walks) {
    Rollout r;
    const auto values = job.walk.values();
    double away = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& p = control::kWalkParameters[i];
      away += std::pow((values[i] - p.least) / (p.most - p.least) - 0.4, 2);
    }
    r.cot = 2.0 + 10.0 * std::max(away, 0.2);
    r.ending = values[3] > 0.9 ? Ending::fell : Ending::stands;
    r.time_s = r.ending == Ending::fell ? 3.0 : 10.0;
    r.distance_m = 1.0;
    r.steps = r.ending == Ending::fell ? 6000 : 20000;
    out.push_back(r);
  }
  return out;
}

SearchOptions bowl_options(std::uint64_t steps) {
  SearchOptions o;
  o.run = bowl;
  o.steps = steps;
  return o;
}

/// Times are not compared: they differ.
void check_same(const SearchState& a, const SearchState& b) {
  CHECK(a.steps == b.steps);
  CHECK(a.rollouts == b.rollouts);
  CHECK(a.method == b.method);
  REQUIRE(a.history.size() == b.history.size());
  for (std::size_t i = 0; i < a.history.size(); ++i) {
    CHECK(a.history[i].objective == b.history[i].objective);
    CHECK(a.history[i].steps == b.history[i].steps);
  }
  REQUIRE(a.bests.size() == b.bests.size());
  for (std::size_t i = 0; i < a.bests.size(); ++i) CHECK(a.bests[i].values() == b.bests[i].values());
}

SearchState through_a_file(const SearchState& state) {
  return parse_checkpoint(format_checkpoint({{}, 0, state}), "checkpoint").state;
}

/// In pieces of some generations each, and a file between them.
SearchResult in_pieces(SearchOptions options, int generations) {
  const auto robot = dynamics::biped::design();
  for (;;) {
    int left = generations;
    options.interrupted = [&] { return left-- == 0; };
    SearchResult part = search_walk(robot, options);
    if (!part.interrupted) return part;
    options.from = through_a_file(part.state);
  }
}

Checkpoint small_checkpoint() {
  SearchOptions options = bowl_options(2'000'000);
  return {settings_of(read_model(test::source("models/biped/biped.toml")), options, "furcula 0"), 7,
          search_walk(dynamics::biped::design(), options).state};
}

}  // namespace

TEST_CASE("a search that is interrupted and goes on is the one that was not, restarts included") {
  for (std::size_t method = 0; method < kMethodNames.size(); ++method) {
    SearchOptions options = bowl_options(150'000'000);
    options.method = static_cast<MethodKind>(method);
    INFO(kMethodNames[method]);
    const SearchResult whole = search_walk(dynamics::biped::design(), options);
    CHECK_FALSE(whole.interrupted);
    CHECK(whole.state.history.size() > 8);
    if (options.method != MethodKind::esch) CHECK(whole.restarts > 0);
    const SearchResult pieces = in_pieces(options, 37);
    check_same(pieces.state, whole.state);
    CHECK(pieces.walk.values() == whole.walk.values());
    CHECK(pieces.restarts == whole.restarts);
  }
}

TEST_CASE("walks in lanes are gone on with to the bit") {
  SearchOptions options;
  options.steps = 1'500'000;
  options.seed = 3;
  const SearchResult whole = search_walk(dynamics::biped::design(), options);
  options.threads = 2;
  check_same(in_pieces(options, 3).state, whole.state);
}

TEST_CASE(
    "a search gives its state as often as asked and at the end, and a larger budget goes on from there") {
  SearchOptions options = bowl_options(3'000'000);
  std::vector<SearchState> kept;
  options.keep = [&](const SearchState& s) { kept.push_back(s); };
  options.keep_every_s = 0.0;
  const SearchResult first = search_walk(dynamics::biped::design(), options);
  REQUIRE(kept.size() > 3);
  CHECK(kept[0].steps < kept[1].steps);
  check_same(kept.back(), first.state);
  options.keep = {};
  options.from = through_a_file(kept.back());
  options.steps = 6'000'000;
  check_same(search_walk(dynamics::biped::design(), options).state,
             search_walk(dynamics::biped::design(), bowl_options(6'000'000)).state);
}

TEST_CASE("an objective that is not a number is never the best, and a search of nothing else ends in order") {
  SearchOptions options = bowl_options(4'000'000);
  const auto spoil = [](Rollout& r, std::size_t i) {
    // No number in what is beyond a limit, in the cost, in the time of a fall.
    r.ending = Ending::stands;
    if (i % 3 == 0) r.over = std::nan("");
    if (i % 3 == 1) r.cot = std::nan("");
    if (i % 3 == 2) r.ending = Ending::fell, r.time_s = std::nan("");
  };
  options.run = [&](const std::vector<Job>& walks) {
    auto out = bowl(walks);
    for (std::size_t i = 0; i < out.size(); i += 2) spoil(out[i], i / 2);
    return out;
  };
  const SearchResult half = search_walk(dynamics::biped::design(), options);
  CHECK(half.state.not_finite > 50);
  CHECK(half.state.not_finite < half.state.rollouts);
  for (const SearchPoint& p : half.state.history) CHECK(std::isfinite(p.objective));
  CHECK(half.state.history.back().objective < half.state.history.front().objective);

  for (std::size_t method = 0; method < kMethodNames.size(); ++method) {
    options.method = static_cast<MethodKind>(method);
    options.steps = 100'000'000;
    options.run = [&](const std::vector<Job>& walks) {
      auto out = bowl(walks);
      for (std::size_t i = 0; i < out.size(); ++i) spoil(out[i], i);
      return out;
    };
    const SearchResult none = search_walk(dynamics::biped::design(), options);
    CHECK_FALSE(none.found);
    CHECK(none.state.history.empty());
    CHECK(none.state.not_finite == none.state.rollouts);
    CHECK(none.walk.values() == test::start_walk().values());
    check_same(through_a_file(none.state), none.state);
  }
}

TEST_CASE("a checkpoint that is cut short, damaged or something else is said to be so") {
  const std::string text = format_checkpoint(small_checkpoint());
  CHECK(parse_checkpoint(text, "c").build == 7);
  const auto said = [](const std::string& bad) {
    return test::error_message([&] { parse_checkpoint(bad, "c"); });
  };
  for (std::size_t length = 0; length < text.size(); length += 1 + text.size() / 300)
    CHECK_THAT(said(text.substr(0, length)), Contains("c:") && Contains(length < 60 ? "c:" : "cut short"));
  std::string other = text;
  other[text.size() / 2] = static_cast<char>(other[text.size() / 2] ^ 1);
  CHECK_THAT(said(other), Contains("damaged"));
  CHECK_THAT(said(text + "x"), Contains("damaged"));
  CHECK_THAT(said("furcula-walk-checkpoint/2" + text.substr(25)),
             Contains("furcula-walk-checkpoint/2") && Contains("expected 'furcula-walk-checkpoint/1'"));
  CHECK_THAT(said("[walk]\nschema = 1\n"), Contains("[walk]") && Contains("expected"));
}

TEST_CASE("where a checkpoint is cut short the one before it is used, and this is said") {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/search.checkpoint";
  Checkpoint c = small_checkpoint();
  write_checkpoint(c, path);
  const std::uint64_t before = c.state.steps++;
  write_checkpoint(c, path);
  CHECK(folder.names() == std::vector<std::string>{"search.checkpoint", "search.checkpoint.previous"});
  const FoundCheckpoint last = read_checkpoint(path);
  CHECK(last.checkpoint.state.steps == before + 1);
  CHECK(last.note.empty());

  std::filesystem::resize_file(path, 1000);
  const FoundCheckpoint previous = read_checkpoint(path);
  CHECK(previous.checkpoint.state.steps == before);
  CHECK(previous.file == path + ".previous");
  CHECK_THAT(previous.note, Contains("cut short") && Contains("the one before it is used"));
  std::filesystem::remove(path);
  CHECK(read_checkpoint(path).checkpoint.state.steps == before);

  std::filesystem::resize_file(path + ".previous", 500);
  CHECK_THAT(test::error_message([&] { read_checkpoint(path); }),
             Contains("search.checkpoint: cannot be read") && Contains(".previous: cut short"));
}

TEST_CASE("a checkpoint of another search says in what it is another") {
  Model model = read_model(test::source("models/biped/biped.toml"));
  SearchOptions options;
  options.rollout.limits = model.limits;
  const Settings one = settings_of(model, options, "furcula 1");
  CHECK(difference(one, settings_of(model, options, "furcula 1")).empty());
  const auto told = [&](const Model& m, const SearchOptions& o, const char* program = "furcula 1") {
    return difference(one, settings_of(m, o, program));
  };
  CHECK(told(model, options, "furcula 2") == "program 'furcula 1', expected 'furcula 2'");
  SearchOptions other = options;
  other.seed = 9;
  other.rollout.mode = WalkMode::semi_passive;
  other.rollout.limits.torque_nm = 60.0;
  CHECK(
      told(model, other) ==
      "mode 'active', expected 'semi_passive'; seed '1', expected '9'; [limits] torque_nm '80', expected '60'");
  Model named = model;
  named.name = "another";
  CHECK(told(named, options) == "robot 'furcula_biped', expected 'another'");
  Model heavier = model;
  heavier.robot.pelvis.mass_kg *= 1.0 + 1e-15;
  CHECK_THAT(told(heavier, options), Contains("the robot's numbers"));
  CHECK(difference({{"seed", "1"}, {"new", "x"}}, {{"seed", "1"}}) == "new 'x', expected 'none'");
}
