// Document 000, section IV: rows of loops that were run, and a semi-passive walk predicted by the model of an active loop.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "host/reproduce/loops_000.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/loop/sample_loop.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const std::string kModel = test::source("models/biped/biped.toml");

std::string model_with(const std::string& deviations) {
  return "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
         test::source("models/biped/furcula_biped.urdf") + "\"\n[deviations]\n" + deviations;
}

/// A loop's folder without logs.
std::string loop_folder(const test::TemporaryFolder& at, const std::string& mode,
                        const loop::LoopResult& result, const std::string& identified) {
  const std::string folder = at.path() + "/" + mode;
  for (std::size_t r = 1; r <= result.rounds.size(); ++r) {
    const std::string round = folder + "/round_" + std::to_string(r);
    fs::create_directories(round);
    fs::copy_file(test::source("tests/host/walk/" + mode + "_walk.toml"), round + "/walk.toml");
    if (r < result.rounds.size() || !identified.empty())
      std::ofstream(round + "/identified_model.toml") << model_with(identified);
  }
  std::ofstream(folder + "/loop.json") << loop::to_json_text({}, {}, result);
  return folder;
}

const reproduce::Row& row_of(const std::vector<reproduce::Row>& rows, const std::string& what) {
  for (const reproduce::Row& r : rows)
    if (r.what == what) return r;
  FAIL(what);
  return rows.front();
}

/// One trial, in which a robot with that model walks for two seconds.
loop::LoopResult one_round() {
  loop::LoopResult out;
  loop::Round& r = out.rounds.emplace_back();
  r.walk = "round_1/walk.toml";
  r.trials.emplace_back().log = "round_1/log_1.csv";
  return out;
}
void walk_in(const std::string& folder, const std::string& model) {
  const test::Ran ran = test::run_furcula({"walk", "sim", "--model", model, "--walk",
                                           folder + "/round_1/walk.toml", "--out", folder + "/whole.csv"});
  INFO(ran.out << ran.err);
  std::ifstream whole(folder + "/whole.csv");
  std::ofstream log(folder + "/round_1/log_1.csv");
  std::string line;
  for (int k = 0; k < 201 && std::getline(whole, line); ++k) log << line << "\n";
  REQUIRE(whole);
}

}  // namespace

TEST_CASE("a loop's triangle stands beside Fig. 7: as given, training, the walk after it, the last one") {
  test::TemporaryFolder at;
  const loop::LoopResult sample = test::sample_loop();
  const std::string folder = loop_folder(at, "active", sample, "");
  const reproduce::LoopStudy study = reproduce::study_loops({kModel, {folder}, 1, {}});
  CHECK_FALSE(study.cross);
  const std::vector<reproduce::Row> rows = reproduce::rows_of(study);
  CHECK(row_of(rows, "Active: identifications until a walk on the robot").ours == 3.0);
  // A cell's error over whole walks is ten times its sample error, and a round's the mean of its two trials.
  const auto mrad = [](int model, unsigned round) {
    return 1e4 * 0.5 * (test::sample_error_rad(model, round, 1) + test::sample_error_rad(model, round, 2));
  };
  const auto& given = row_of(rows, "Active: Eq. 3 of the first walk, model as given");
  CHECK(given.ours == Approx(mrad(loop::kGiven, 1)));
  CHECK(given.published == "84e-3 rad");
  CHECK(given.where == "IV, Fig. 7");
  CHECK(row_of(rows, "Active: the same, identified from it").ours == Approx(mrad(1, 1)));
  CHECK(row_of(rows, "Active: Eq. 3 of the second walk, identified from the first").ours ==
        Approx(mrad(1, 2)));
  CHECK(row_of(rows, "Active: Eq. 3 of the last walk, not in the fit").ours == Approx(mrad(2, 3)));
  for (const reproduce::Row& r : rows) CHECK(r.outcome == reproduce::Outcome::computed);
  // Of the print's last model: the walk that it has not seen.
  CHECK_THAT(reproduce::loops_html(study), Contains("Identified after walk 5") && Contains(">14<"));
}

TEST_CASE(
    "a loop that walks in its first trial has one identification, from its exercise, which predicts that walk") {
  test::TemporaryFolder at;
  loop::LoopResult sample = test::sample_loop();
  sample.rounds.resize(1);
  sample.rounds[0].identification.reset();
  sample.rounds[0].walks = true;
  const std::string folder = loop_folder(at, "active", sample, "");
  std::filesystem::remove(folder + "/round_1/identified_model.toml");
  const std::vector<reproduce::Row> rows =
      reproduce::rows_of(reproduce::study_loops({kModel, {folder}, 1, {}}));
  REQUIRE(rows.size() == 3);
  CHECK(row_of(rows, "Active: identifications until a walk on the robot").ours == 1.0);
  CHECK(row_of(rows, "Active: Eq. 3 of the last walk, not in the fit").ours ==
        Approx(1e4 * 0.5 * (test::sample_error_rad(0, 1, 1) + test::sample_error_rad(0, 1, 2))));
}

TEST_CASE("a loop that has not walked yet has no number of identifications, and no model of its own") {
  test::TemporaryFolder at;
  const reproduce::LoopStudy study =
      reproduce::study_loops({kModel, {loop_folder(at, "semi_passive", one_round(), "")}, 1, {}});
  const std::vector<reproduce::Row> rows = reproduce::rows_of(study);
  CHECK(rows.size() == 2);
  CHECK(std::isnan(row_of(rows, "Semi-passive: identifications until a walk on the robot").ours));
}

TEST_CASE(
    "the model of an active loop predicts the last semi-passive walk, beside one that is identified from all other recordings") {
  test::TemporaryFolder at;
  // The robot is the model as given: it predicts its own walk; 3 kg more at the pelvis do not.
  const std::string active = loop_folder(at, "active", one_round(), "\"mass@pelvis\" = 3.0\n"),
                    semi = loop_folder(at, "semi_passive", one_round(), "");
  walk_in(active, kModel), walk_in(semi, kModel);
  reproduce::LoopStudyOptions options{kModel, {semi, active}, 2, {}};
  options.identify.iterations = 1;
  const reproduce::LoopStudy study = reproduce::study_loops(options);
  REQUIRE(study.cross);
  const reproduce::CrossPrediction& c = *study.cross;
  CHECK(c.log == semi + "/round_1/log_1.csv");
  CHECK(c.given.whole_run_rad < 1e-3);
  CHECK(c.active.whole_run_rad > 5.0 * c.given.whole_run_rad);
  // "All other recordings" are the active one alone: the walk that is predicted is not in the fit.
  loop::Request request;
  request.log = active + "/round_1/log_1.csv";
  floating::IdentifyOptions alone = options.identify;
  alone.settings.threads = 2;
  const walk::Model given = walk::read_model(kModel);
  const floating::Machine other =
      floating::identify(given.machine, {loop::read_recording(request.log, request)}, alone).machine;
  request.log = c.log;
  floating::Recording predicted = loop::read_recording(request.log, request);
  const double expected_rad =
      loop::whole_run_errors_rad(given, other, {{&predicted, walk::read_walk(semi + "/round_1/walk.toml")}},
                                 1)
          .front();
  CHECK(c.together.whole_run_rad == expected_rad);
  CHECK(c.together.whole_run_rad < c.active.whole_run_rad);
  CHECK(loop::model_error_rad(c.given.windows) < loop::model_error_rad(c.active.windows));
  const std::vector<reproduce::Row> rows = reproduce::rows_of(study);
  const auto& row = row_of(rows, "Eq. 3 of the last semi-passive walk, identified from active walks");
  CHECK(row.ours == Approx(1e3 * c.active.whole_run_rad));
  CHECK(row.published == "259e-3 rad");
}

TEST_CASE("a folder without a loop, and a loop of another robot, are refused with what was expected") {
  test::TemporaryFolder at;
  const auto refused = [](const std::string& folder) {
    return test::error_message([&] { reproduce::study_loops({kModel, {folder}, 1, {}}); });
  };
  CHECK_THAT(refused(at.path()), Contains("loop.json: cannot be read") && Contains("furcula walk loop"));
  const std::string folder = loop_folder(at, "active", one_round(), "");
  std::string walk = test::text_of(folder + "/round_1/walk.toml");
  walk.replace(walk.find("furcula_biped"), 13, "another_robot");
  std::ofstream(folder + "/round_1/walk.toml") << walk;
  CHECK_THAT(refused(folder), Contains("another_robot") && Contains("expected one of 'furcula_biped'"));
  loop::LoopResult none = one_round();
  none.rounds[0].trials.clear();
  std::ofstream(folder + "/loop.json") << loop::to_json_text({}, {}, none);
  CHECK_THAT(refused(folder), Contains("no trial yet"));
}
