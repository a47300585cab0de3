// `furcula walk` as a user runs it.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/report/html.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

const std::string kModel = test::source("models/biped/biped.toml");

}  // namespace

TEST_CASE(
    "furcula walk search --robust says on how many other robots its walk stands, and goes on with them") {
  test::TemporaryFolder folder;
  const auto search = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.begin(), {"walk", "search", "--model", kModel, "--robust", "--seed", "2", "--out",
                               folder.path() + "/" + out});
    return test::run_furcula(more, 120);
  };
  const test::Ran whole = search("whole", {"--steps", "12000000"});
  INFO(whole.err);
  const auto j = test::json_of(folder.path() + "/whole/walk.json");
  CHECK(j["ensemble"] == 7);
  if (j["found"] == true) CHECK(j["robustness"]["other_robots"]["robots"] == 64);
  // Other robots are another search.
  const test::Ran other = search("other", {"--steps", "12000000", "--deviations", "0.5", "--resume",
                                           folder.path() + "/whole/search.checkpoint"});
  CHECK(other.status == 2);
  CHECK_THAT(other.err, Contains("of another search: other robots of a robust search '7, "));
  const test::Ran plain =
      test::run_furcula({"walk", "search", "--model", kModel, "--seed", "2", "--steps", "12000000", "--out",
                         folder.path() + "/plain", "--resume", folder.path() + "/whole/search.checkpoint"});
  CHECK(plain.status == 2);
  CHECK_THAT(plain.err, Contains("expected 'none'"));
  const test::Ran far = search("far", {"--steps", "1", "--deviations", "3"});
  CHECK(far.status == 2);
  CHECK_THAT(far.err, Contains("--deviations 3: expected from 0 to 2"));
}

TEST_CASE(
    "furcula walk search finds a walk without a first guess and writes it, sim plays it, show draws it") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  const test::Ran few =
      test::run_furcula({"walk", "search", "--model", kModel, "--steps", "400000", "--out", out});
  CHECK(few.status == 4);
  CHECK_THAT(few.err, Contains("no walk within all limits that gets ahead"));
  const auto none = test::json_of(out + "/walk.json");
  CHECK(none["found"] == false);
  CHECK(none["first_walk"].is_null());
  CHECK_FALSE(none["limits"].empty());
  CHECK(none["steps"].get<double>() >= 400000);

  const test::Ran ran = test::run_furcula(
      {"walk", "search", "--model", kModel, "--steps", "20000000", "--seed", "2", "--out", out}, 120);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  CHECK_THAT(ran.out, Contains("first walk of 10 s within all limits") && Contains("cost of transport") &&
                          Contains("of 64 stand"));
  const auto j = test::json_of(out + "/walk.json");
  CHECK(j["schema"] == "furcula-walk/1");
  CHECK(j["mode"] == "active");
  CHECK(j["method"] == "cmaes");
  CHECK(j["found"] == true);
  CHECK(j["limits"].empty());
  CHECK(j["robustness"]["steps"].size() == 4);
  const double total = j["energy_j"]["total"], copper = j["energy_j"]["copper"], work = j["energy_j"]["work"];
  CHECK(total == Approx(copper + work + 1000.0));
  CHECK(j["cot"].get<double>() == Approx(total / (49.8 * 9.8 * j["distance_m"].get<double>())));
  CHECK(j["objective"].get<double>() == Approx(1.0 / (1.0 + 1.0 / j["cot"].get<double>())));
  CHECK(j["history"].back()[1].get<double>() == Approx(j["objective"].get<double>()).epsilon(0.05));

  const auto page_of = [](const std::string& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  CHECK_THAT(page_of(out + "/report.html"),
             Contains("walk-data") && Contains("The search") && Contains("furcula walk search --model"));

  const std::string shown = folder.path() + "/shown";
  const test::Ran show =
      test::run_furcula({"walk", "show", "--model", kModel, "--walk", out + "/walk.toml", "--out", shown});
  CHECK(show.status == 0);
  CHECK_THAT(page_of(shown + "/report.html"), Contains("walk-data") && Contains("furcula walk show --model"));

  const std::string log = folder.path() + "/log.csv";
  const test::Ran sim =
      test::run_furcula({"walk", "sim", "--model", kModel, "--walk", out + "/walk.toml", "--out", log});
  INFO(sim.err);
  CHECK(sim.status == 0);
  std::ifstream file(log);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  CHECK_THAT(text, Contains("# machine_type: tree") && Contains("angle_cmd_left_hip_pitch_rad") &&
                       Contains("contact_right_foot"));
  CHECK(std::count(text.begin(), text.end(), '\n') > 1000);
}

TEST_CASE(
    "a search that is interrupted leaves its best so far, and goes on to the walk that it finds without") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out", whole = folder.path() + "/whole";
  // No walk keeps so low a limit, however long the search took until it was interrupted.
  const std::string slow = folder.file("slow.toml", "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
                                                        test::source("models/biped/furcula_biped.urdf") +
                                                        "\"\n[limits]\nspeed_radps = 0.3\n");
  const std::vector<std::string> one{"walk", "search", "--model", slow,     "--seed",
                                     "3",    "--mode", "active",  "--steps"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), one.begin(), one.end());
    return more;
  };
  std::vector<std::string> command = with({"1000000000000", "--threads", "1", "--out", out});
  command.insert(command.begin(),
                 {"-c",
                  "(until [ -d '" + out +
                      "' ] || ! kill -0 $$; do sleep 0.1; done; sleep 0.5; kill -INT $$) & exec \"$@\"",
                  "search", test::program("furcula")});
  const test::Ran ended = test::run_program("/bin/bash", command);
  INFO(ended.err);
  CHECK(ended.status == 4);
  CHECK_THAT(ended.out,
             Contains("interrupted; the same command with --resume " + out + "/search.checkpoint"));
  CHECK_THAT(ended.err, Contains("before the interruption"));
  CHECK(test::text_of(out + "/walk.toml").size() > 1000);
  CHECK(test::text_of(out + "/report.html").size() > 10000);
  const auto interrupted = test::json_of(out + "/walk.json");
  CHECK(interrupted["ended"] == "interrupted");

  const auto steps = std::to_string(interrupted["steps"].get<std::uint64_t>() + 600'000);
  const std::string checkpoint = out + "/search.checkpoint";
  const test::Ran on =
      test::run_furcula(with({steps, "--threads", "2", "--resume", checkpoint, "--out", out}));
  CHECK_THAT(on.err, Contains("goes on after"));
  test::run_furcula(with({steps, "--threads", "1", "--out", whole}));
  CHECK(test::text_of(out + "/walk.toml") == test::text_of(whole + "/walk.toml"));
  auto a = test::json_of(out + "/walk.json"), b = test::json_of(whole + "/walk.json");
  CHECK(a["ended"] == "budget");
  for (auto* j : {&a, &b}) {
    // Times differ.
    j->erase("cpu_s");
    for (auto& point : (*j)["history"]) point[0] = 0.0;
  }
  CHECK(a == b);

  const auto said = [&](const std::vector<std::string>& more, int status) {
    std::vector<std::string> arguments{"walk",    "search", "--model", slow,
                                       "--steps", steps,    "--out",   folder.path() + "/none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Ran ran = test::run_furcula(arguments);
    CHECK(ran.status == status);
    CHECK_FALSE(std::filesystem::exists(folder.path() + "/none"));
    return ran.err;
  };
  CHECK_THAT(said({"--seed", "4", "--resume", checkpoint}, 2),
             Contains("search.checkpoint: of another search: seed '3', expected '4'"));
  CHECK_THAT(said({"--seed", "3", "--mode", "semi_passive", "--resume", checkpoint}, 2),
             Contains("mode 'active', expected 'semi_passive'"));
  CHECK_THAT(said({"--resume", out}, 3), Contains("a folder; expected a checkpoint"));
  CHECK_THAT(said({"--resume", out + "/walk.toml"}, 3),
             Contains("walk.toml:1: begins with '[walk]'; expected 'furcula-walk-checkpoint/1'"));
  CHECK_THAT(said({"--resume", out + "/nothing"}, 3), Contains("nothing: cannot be read"));
}

TEST_CASE("limits that no posture keeps end a search before it begins") {
  test::TemporaryFolder folder;
  const std::string tall = folder.file("tall.toml", "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
                                                        test::source("models/biped/furcula_biped.urdf") +
                                                        "\"\n[limits]\nheight_m = 1.1\n");
  const test::Ran ran = test::run_furcula(
      {"walk", "search", "--model", tall, "--steps", "1000000000000", "--out", folder.path() + "/out"});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("tall.toml: [limits] height_m = 1.1") && Contains("at most 0.983 m"));
  CHECK_FALSE(std::filesystem::exists(folder.path() + "/out"));
}

TEST_CASE("a longer simulation walks longer") {
  test::TemporaryFolder folder;
  const std::string walk = test::source("tests/host/walk/active_walk.toml");
  const auto distance = [&](const char* seconds) {
    const test::Ran ran = test::run_furcula({"walk", "sim", "--model", kModel, "--walk", walk, "--seconds",
                                             seconds, "--out", folder.path() + "/log.csv"});
    INFO(ran.err);
    REQUIRE(ran.status == 0);
    const auto at = ran.out.find(" landings, ");
    return std::stod(ran.out.substr(at + 11));
  };
  CHECK(distance("20") > 1.8 * distance("10"));
}

TEST_CASE("what furcula walk cannot use is said") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out", walk = test::source("tests/host/walk/active_walk.toml");
  const auto said = [&](const std::vector<std::string>& arguments, int status) {
    const test::Ran ran = test::run_furcula(arguments);
    CHECK(ran.status == status);
    return ran.err;
  };
  CHECK_THAT(said({"walk", "search", "--model", kModel, "--out", out}, 2), Contains("--seconds and --steps"));
  CHECK_THAT(said({"walk", "search", "--model", kModel, "--seconds", "0", "--out", out}, 2),
             Contains("--seconds 0"));
  CHECK_THAT(said({"walk", "search", "--model", kModel, "--steps", "-5", "--out", out}, 2),
             Contains("--steps -5"));
  CHECK_THAT(said({"walk", "sim", "--model", kModel, "--walk", walk, "--rate-hz", "700", "--out", out}, 2),
             Contains("--rate-hz 700"));
  CHECK_THAT(said({"walk", "search", "--model", walk, "--steps", "1000", "--out", out}, 3),
             Contains("no section [model]"));
  CHECK_THAT(said({"walk", "sim", "--model", kModel, "--walk", kModel, "--out", out}, 3),
             Contains("no section [walk]"));
  CHECK_THAT(said({"walk", "sim", "--model", kModel, "--walk", walk, "--rate-hz", "5000", "--out", out}, 2),
             Contains("--rate-hz 5000"));
  std::ifstream file(walk);
  std::string text(std::istreambuf_iterator<char>(file), {});
  const auto at = text.find("furcula_biped");
  REQUIRE(at != std::string::npos);
  const std::string other = folder.file("other.toml", text.replace(at, 13, "another_robot"));
  CHECK_THAT(said({"walk", "sim", "--model", kModel, "--walk", other, "--out", out}, 2),
             Contains("another_robot") && Contains("furcula_biped"));
  CHECK_THAT(said({"walk", "search", "--model", kModel, "--steps", "1000", "--from", other, "--out", out}, 2),
             Contains("--from") && Contains("another_robot"));
  const std::string copy = folder.file("copy.toml", [&] {
    std::ifstream again(walk);
    return std::string(std::istreambuf_iterator<char>(again), {});
  }());
  CHECK_THAT(said({"walk", "sim", "--model", kModel, "--walk", copy, "--out", copy}, 2),
             Contains("is the walk"));

  // A limit that the walk does not keep is said.
  const std::string weak = folder.file("weak.toml", "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
                                                        test::source("models/biped/furcula_biped.urdf") +
                                                        "\"\n[limits]\ntorque_nm = 10\n");
  const test::Ran over = test::run_furcula({"walk", "sim", "--model", weak, "--walk", walk, "--seconds", "3",
                                            "--out", folder.path() + "/log.csv"});
  CHECK(over.status == 0);
  CHECK_THAT(over.out, Contains("limit: a motor gives"));
}

TEST_CASE("rollouts of any x86-64, of those with AVX2 and of those with AVX-512 have the same bits") {
  const std::string linker = "/lib64/ld-linux-x86-64.so.2";
  if (!std::filesystem::exists(linker)) return test::skip("no x86-64: there is one library");
  test::TemporaryFolder folder;
  const auto found = [&](std::vector<std::string> how, const std::string& name) {
    const std::string out = folder.path() + "/" + name;
    for (const char* word :
         {"walk", "search", "--model", kModel.c_str(), "--steps", "600000", "--out", out.c_str()})
      how.push_back(word);
    const test::Ran ran = test::run_program(linker, how);
    INFO(ran.err);
    REQUIRE(ran.status == 4);  // too few steps for a walk
    std::ifstream file(out + "/walk.toml");
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string program = test::program("furcula");
  const std::string any = found({"--glibc-hwcaps-mask", "", program}, "any");
  CHECK(any.size() > 1000);
  // A library that the processor cannot run is not chosen.
  for (const char* kind : {"x86-64-v3", "x86-64-v4"})
    CHECK(found({"--glibc-hwcaps-mask", kind, program}, kind) == any);
  CHECK(found({program}, "own") == any);
}

TEST_CASE("furcula walk identify writes a model that walks are simulated on, wherever its folder is") {
  test::TemporaryFolder folder;
  const std::string walk = folder.path() + "/walk.csv", brief = folder.path() + "/brief<b>&.csv",
                    out = folder.path() + "/some/deep/folder/of/results";
  REQUIRE(test::run_furcula({"walk", "sim", "--model", kModel, "--walk",
                             test::source("tests/host/walk/active_walk.toml"), "--seed", "1", "--out", walk})
              .status == 0);
  std::ifstream in(walk);
  std::ofstream to(brief);
  std::size_t rows = 0;
  for (std::string line; rows < 100 && std::getline(in, line); ++rows) to << line << "\n";
  to.close();
  const test::Ran ran =
      test::run_furcula({"walk", "identify", brief, "--model", kModel, "--threads", "2", "--out", out}, 600);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  const std::string alone = folder.path() + "/alone";
  REQUIRE(
      test::run_furcula({"walk", "identify", brief, "--model", kModel, "--threads", "1", "--out", alone}, 600)
          .status == 0);
  CHECK(test::json_of(alone + "/identification.json") == test::json_of(out + "/identification.json"));
  const std::string linker = "/lib64/ld-linux-x86-64.so.2";
  if (std::filesystem::exists(linker)) {
    const std::string narrow = folder.path() + "/narrow";
    REQUIRE(
        test::run_program(linker, {"--glibc-hwcaps-mask", "", test::program("furcula"), "walk", "identify",
                                   brief, "--model", kModel, "--threads", "2", "--out", narrow})
            .status == 0);
    CHECK(test::json_of(narrow + "/identification.json") == test::json_of(out + "/identification.json"));
  }
  CHECK_THAT(ran.out,
             Contains("hips' pitch on their drives") && Contains("training") && Contains("held out"));
  const auto j = test::json_of(out + "/identification.json");
  CHECK(j["schema"] == "furcula-walk-identification/1");
  CHECK(j["parameters"].size() > 300);
  const std::string page = test::text_of(out + "/identification.html");
  CHECK(page == test::text_of(alone + "/identification.html"));
  CHECK(page.find("brief<b>") == std::string::npos);
  CHECK_THAT(page, Contains("/brief&lt;b&gt;&amp;.csv"));
  std::size_t at = 0;
  for (const char* section : {"answer", "walk", "channels", "parameters", "recordings"}) {
    INFO(section);
    at = page.find("<section id=\"" + std::string(section) + "\">", at);
    REQUIRE(at != std::string::npos);
  }
  const std::string answer = page.substr(page.find("<section id=\"answer\">"));
  at = 0;
  for (const char* key : {"rms_angle_rad", "rms_attitude_rad", "rms_gyro_radps"})
    for (const char* set : {"held_out", "training"})
      for (const char* which : {"given", "identified"}) {
        INFO(key << " " << set << " " << which);
        at = answer.find(">" + report::number(1e3 * j[set][which][key].get<double>()) + "</td>", at);
        REQUIRE(at != std::string::npos);
      }
  std::size_t narrowed = 0;
  for (const auto& p : j["parameters"]) {
    narrowed += p["posterior_sd"].get<double>() < 0.5 * p["prior_sd"].get<double>();
    CHECK(page.find("<code>" + p["name"].get<std::string>() + "</code>") != std::string::npos);
  }
  CHECK_THAT(page, Contains(">" + std::to_string(narrowed) + " <small>of " +
                            std::to_string(j["parameters"].size()) + "</small>"));
  // A robot that is a little different may fall, which is status 4; it is read.
  const test::Ran again = test::run_furcula({"walk", "sim", "--model", out + "/identified_model.toml",
                                             "--walk", test::source("tests/host/walk/active_walk.toml"),
                                             "--out", folder.path() + "/again.csv"});
  INFO(again.err);
  CHECK((again.status == 0 || again.status == 4));
  const test::Ran other =
      test::run_furcula({"walk", "identify", test::source("README.md"), "--model", kModel, "--out", out});
  CHECK(other.status == 3);
}
