// furcula_mujoco_robot: tries walks on the biped in MuJoCo. One trial with its log, or a table of trials on drawn robots.
#include <CLI/CLI.hpp>
#include <iostream>

#include "host/core/message.hpp"
#include "host/core/parallel.hpp"
#include "host/log/writer.hpp"
#include "host/walk/walk_file.hpp"
#include "host/walk/walk_toml.hpp"
#include "tests/robot/trial.hpp"

using namespace furcula;

namespace {

struct Options {
  std::string model, walk, cause = "none", out;
  double tables = 0.0, time_s = 10.0;
  std::uint64_t seed = 1, repetition = 0;
  unsigned robots = 0, threads = 2;
  bool undisturbed = false;
};

robot::Truth truth_of(const Options& o, const dynamics::biped::Description& nominal, std::uint64_t seed,
                      std::string& what) {
  robot::Truth truth = robot::drawn(nominal, o.tables, seed);
  for (std::size_t i = 0; i < robot::kCauseNames.size(); ++i)
    if (robot::kCauseNames[i] == o.cause) {
      const robot::Planted planted = robot::drawn_cause(static_cast<robot::Cause>(i), seed);
      robot::plant(planted, truth);
      what = robot::in_words(planted);
    }
  if (what.empty()) throw std::runtime_error("no cause '" + o.cause + "'");
  return truth;
}

void print(const robot::Trial& t) {
  std::cout << t.ending << ", " << core::rounded(t.distance_m, 3) << " m in " << core::rounded(t.time_s, 3)
            << " s, CoT " << core::rounded(t.cot, 3) << "\n";
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Tries a walk on the biped in MuJoCo"};
  Options o;
  app.add_option("--model", o.model, "Model file of kind biped: the robot as the board knows it")->required();
  app.add_option("--walk", o.walk, "walk.toml")->required();
  app.add_option("--tables", o.tables,
                 "How far the robot is from the model: times the ranges of document 000, Tables I and II");
  app.add_option("--cause", o.cause, "A cause beyond the tables");
  app.add_option("--seed", o.seed, "Of the robot and of its disturbances");
  app.add_option("--repetition", o.repetition, "Other disturbances of the same robot");
  app.add_option("--time", o.time_s, "s");
  app.add_option("--out", o.out, "The log to write");
  app.add_option("--robots", o.robots, "A table instead: so many robots, seeds from --seed on");
  app.add_option("--threads", o.threads);
  app.add_flag("--undisturbed", o.undisturbed, "No noise of the sensors, no pushes");
  CLI11_PARSE(app, argc, argv);
  const walk::Model model = walk::read_model(o.model);
  const walk::Walk walk = walk::read_walk(o.walk);
  robot::TrialOptions options;
  options.time_s = o.time_s;
  if (o.undisturbed) options.disturbances = {false, 0.0};
  if (o.robots == 0) {
    std::string what;
    const robot::Truth truth = truth_of(o, model.robot, o.seed, what);
    options.seed = o.seed + 1000 * o.repetition;
    const robot::Trial trial = robot::try_walk(truth, model.robot, walk, options);
    print(trial);
    if (!o.out.empty()) log::write_log(trial.log, o.out);
    return trial.stands ? 0 : 1;
  }
  std::vector<robot::Trial> trials(o.robots);
  std::vector<std::string> what(o.robots);
  core::parallel_for(o.robots, o.threads, [&](std::size_t i) {
    robot::TrialOptions mine = options;
    mine.seed = o.seed + i + 1000 * o.repetition;
    trials[i] = robot::try_walk(truth_of(o, model.robot, o.seed + i, what[i]), model.robot, walk, mine);
    trials[i].log = {};
  });
  unsigned stand = 0;
  double distance_m = 0.0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    std::cout << o.seed + i << "  " << what[i] << ": ";
    print(trials[i]);
    stand += trials[i].stands;
    distance_m += trials[i].stands ? trials[i].distance_m : 0.0;
  }
  std::cout << stand << " of " << trials.size() << " stand; mean distance of these "
            << core::rounded(stand > 0 ? distance_m / stand : 0.0, 3) << " m\n";
  return 0;
} catch (const std::exception& e) {
  std::cerr << "furcula_mujoco_robot: " << e.what() << "\n";
  return 2;
}
