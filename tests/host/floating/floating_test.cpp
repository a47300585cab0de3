// Recordings of a walking robot, made by the project's own simulation here (in MuJoCo: tests/robot): what windows are, what is refused, and that
// numbers that a robot differs in are found within a fit of all.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "host/biped/machine_toml.hpp"
#include "host/core/random.hpp"
#include "host/floating/identify.hpp"
#include "host/floating/random_effect.hpp"
#include "host/walk/exercise.hpp"
#include "host/walk/simulation.hpp"
#include "host/walk/walk_file.hpp"
#include "tests/folder.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::floating;
using Catch::Contains;

namespace {

/// A walk of 10 s, of which the rows before `until_s` are kept.
log::Log log_of(const dynamics::biped::Description& robot, const char* mode, std::uint64_t seed,
                double until_s) {
  const walk::Walk walk = test::found_walk(mode);
  walk::RolloutOptions options;
  options.mode = walk.mode;
  log::Log log = simulate_walk(robot, options, walk.parameters, 0.01, seed).log;
  log.path = "walk.csv";
  const auto rows = static_cast<std::size_t>(until_s / 0.01);
  for (auto& [name, column] : log.columns) column.resize(rows);
  return log;
}

Machine nominal() {
  Machine m;
  m.robot = dynamics::biped::design();
  return m;
}

double identified(const Identified& found, const std::string& kind, const std::string& location) {
  for (const Unknown& u : found.unknowns)
    if (u.kind == kind && u.location == location) return u.value(found.machine) - u.value(found.given);
  FAIL("no " << kind << " at " << location);
  return 0.0;
}

}  // namespace

TEST_CASE("windows have no landing in them, and a foot carries in each") {
  const Recording r = recording_of(log_of(dynamics::biped::design(), "active", 1, 10.0));
  Unused unused;
  const std::vector<Window> windows = windows_of(r, 0, 0.3, &unused);
  REQUIRE(windows.size() > 20);
  double in_windows_s = 0.0;
  for (const Window& w : windows)
    in_windows_s += r.rows[w.first + w.count - 1].time_s - r.rows[w.first].time_s;
  CHECK(in_windows_s + unused.landings_s + unused.no_stance_s + unused.short_s ==
        Approx(r.rows.back().time_s - r.rows[1].time_s));
  std::size_t landings = 0;
  for (std::size_t k = 1; k < r.rows.size(); ++k)
    for (std::size_t side = 0; side < 2; ++side)
      landings += r.rows[k].contact[side] && !r.rows[k - 1].contact[side];
  CHECK(landings >= 8);
  for (const Window& w : windows) {
    REQUIRE(w.first + w.count <= r.rows.size());
    CHECK(r.rows[w.first + w.count - 1].time_s - r.rows[w.first].time_s < 0.3 + 1e-9);
    bool carries[] = {true, true};
    for (std::size_t k = w.first; k < w.first + w.count; ++k)
      for (std::size_t side = 0; side < 2; ++side) {
        carries[side] = carries[side] && r.rows[k].contact[side];
        if (k > w.first) CHECK((!r.rows[k].contact[side] || r.rows[k - 1].contact[side]));
      }
    CHECK((carries[0] || carries[1]));
    for (std::size_t k = std::max<std::size_t>(w.first, 5) - 4; k <= w.first; ++k)  // no landing within 60 ms
      for (std::size_t side = 0; side < 2; ++side)
        CHECK((!r.rows[k].contact[side] || r.rows[k - 1].contact[side]));
    CHECK(carries[w.foot]);
  }
}

TEST_CASE("of a robot that falls the rows before the fall are used") {
  log::Log log = log_of(dynamics::biped::design(), "active", 1, 4.0);
  for (std::size_t k = 300; k < log.rows(); ++k) log.columns["pitch_rad"][k] = 0.8;
  const Recording r = recording_of(log);
  CHECK(r.rows.size() == 285);  // 0.15 s before row 300
  REQUIRE(r.notes.size() == 1);
  CHECK_THAT(r.notes[0], Contains("the robot falls 3 s after the first row"));
}

TEST_CASE("a log without targets is refused with what is expected") {
  log::Log log = log_of(dynamics::biped::design(), "active", 1, 1.0);
  log.columns.erase("angle_cmd_left_knee_rad");
  CHECK_THAT(test::error_message([&] { recording_of(log); }),
             Contains("walk.csv: no column 'angle_cmd_left_knee_rad'") && Contains("furcula walk sim"));
}

TEST_CASE("a recording tells whether the hips' pitch is on springs or on drives") {
  const Machine m = nominal();
  for (const char* mode : {"active", "semi_passive"}) {
    INFO(mode);
    const Recording r = recording_of(log_of(m.robot, mode, 2, 2.5));
    CHECK(passive_hips(m, r, {}) == (std::string(mode) == "semi_passive"));
  }
}

TEST_CASE(
    "a fit of all numbers sees more dry friction where it is, and predicts another part of the walk better",
    "[slow]") {
  auto robot = dynamics::biped::design();
  robot.drives[0][dynamics::biped::kKnee].friction_nm += 6.0;
  // The sensors' constant errors are drawn from the seed: encoders off by 5 mrad, so that both parts are of one robot.
  Recording all = recording_of(log_of(robot, "semi_passive", 3, 6.0));
  all.passive_hips = true;
  Recording first = all, then = all;
  first.rows.resize(350);
  then.rows.erase(then.rows.begin(), then.rows.begin() + 350);
  const IdentifyOptions options;
  const Identified found = identify(nominal(), {first}, options);
  CHECK(found.after.angle_rad < 0.2 * found.before.angle_rad);
  const double left = identified(found, "coulomb_friction", "left_knee"),
               right = identified(found, "coulomb_friction", "right_knee");
  CHECK(left > 4.0);
  CHECK(left < 7.0);
  CHECK(std::abs(right) < 1.0);
  const WindowErrors given = window_errors(nominal(), {then}, options),
                     identified_errors = window_errors(found.machine, {then}, options);
  CHECK(identified_errors.angle_rad < 0.6 * given.angle_rad);
  CHECK(identified_errors.attitude_rad < 1.05 * given.attitude_rad);  // that of the filter, mostly
}

TEST_CASE("a run that begins where it differs from the first one is the same as by itself, to the bit") {
  const Recording r = recording_of(log_of(dynamics::biped::design(), "active", 1, 4.0));
  const std::vector<Window> windows = windows_of(r, 0, 0.3);
  const Machine machine = nominal();
  const Plant plant = plant_of(machine);
  const Local here = Local::Constant(1e-4);
  for (const std::size_t w : {std::size_t{0}, windows.size() - 1}) {
    // The knots of eight channels, one knot after the other as a linearisation has them, and a start's number behind them.
    std::vector<Variant> variants{{&machine, &plant, here.data()}};
    for (std::size_t knot = 0; knot < kKnots; ++knot)
      for (std::size_t k = 0; k < 8; ++k)
        variants.push_back(
            {&machine, &plant, here.data(), static_cast<int>(kStart + k * kKnots + knot), 5.0});
    variants.push_back({&machine, &plant, here.data(), 9, 1e-3});
    const Eigen::MatrixXd together = residuals(r, windows[w], variants, 1e-3);
    for (std::size_t k = 0; k < variants.size(); ++k) {
      INFO("window " << w << ", run " << k);
      const Eigen::MatrixXd alone = residuals(r, windows[w], std::span(&variants[k], 1), 1e-3);
      CHECK((together.col(static_cast<Eigen::Index>(k)) == alone.col(0)));
      if (k > 0) CHECK((alone.col(0) != together.col(0)));
    }
  }
}

TEST_CASE(
    "a fit begins at the robot that fewer recordings gave where that is likelier, and else at the model") {
  auto robot = dynamics::biped::design();
  robot.drives[0][dynamics::biped::kKnee].friction_nm += 6.0;
  Recording all = recording_of(log_of(robot, "semi_passive", 3, 2.4));
  all.passive_hips = true;
  IdentifyOptions options;
  options.iterations = 0;
  const auto begun_at = [&](std::size_t side) {
    options.start = nominal();
    options.start->robot.drives[side][dynamics::biped::kKnee].friction_nm += 6.0;
    return identify(nominal(), {all}, options);
  };
  const Identified near = begun_at(0), far = begun_at(1);
  CHECK(identified(near, "coulomb_friction", "left_knee") == Approx(6.0).epsilon(1e-6));
  CHECK(identified(far, "coulomb_friction", "right_knee") == Approx(0.0).margin(1e-9));
}

TEST_CASE(
    "the evidence of a deviation is what an integration over it gives, and windows that disagree give none") {
  const Eigen::Vector3d information{40.0, 90.0, 10.0}, agreed{40.0 * 0.8, 90.0 * 0.8, 10.0 * 0.8};
  // The least scatter is none: densities of Student's t with 4 degrees of freedom of 0.8 three times, with theta of variance 1 and with theta 0.
  const auto likelihood = [&](double theta) {
    double log_sum = 0.0;
    for (int w = 0; w < 3; ++w)
      log_sum += -2.5 * std::log1p(information[w] * (0.8 - theta) * (0.8 - theta) / 4.0) +
                 0.5 * std::log(information[w]);
    return std::exp(log_sum);
  };
  double all = 0.0, positive = 0.0, mean = 0.0;
  constexpr double kStep = 1e-4;
  for (double theta = -6.0; theta < 6.0; theta += kStep) {
    const double density = likelihood(theta) * std::exp(-0.5 * theta * theta) / std::sqrt(2.0 * M_PI) * kStep;
    all += density, mean += theta * density;
    if (theta >= 0.0) positive += 2.0 * density;
  }
  const RandomEffect both = random_effect(information, agreed, {0, 1, 2}, 0.0, false),
                     up = random_effect(information, agreed, {0, 1, 2}, 0.0, true);
  // By Laplace's approximation: theta is the mode.
  CHECK(both.theta == Approx(mean / all).epsilon(0.01));
  CHECK(both.spread == 0.0);
  CHECK(up.log_bayes_factor - both.log_bayes_factor == Approx(std::log(positive / all)).margin(1e-3));
  // Without theta the scatter is what makes three of 0.8 likeliest; with none of it, more is lost.
  CHECK(both.log_bayes_factor > 0.0);
  CHECK(both.log_bayes_factor < std::log(all / likelihood(0.0)) + 0.2);
  // Twelve windows that say 0.8 are evidence; that say 0.8 and -0.8 in turn, though each is sure of it, are none.
  const std::vector<std::size_t> each{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
      two{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  const Eigen::VectorXd sure = Eigen::VectorXd::Constant(12, 400.0);
  Eigen::VectorXd same = 0.8 * sure, turns = same;
  for (int w = 0; w < 12; w += 2) turns[w] = -turns[w];
  CHECK(random_effect(sure, same, each, 0.0, false).log_bayes_factor > 10.0);
  const RandomEffect none = random_effect(sure, turns, each, 0.0, false);
  CHECK(none.log_bayes_factor < 0.0);
  // Windows that scatter say less where they are of few phases: what a phase does, all of its windows share.
  Eigen::VectorXd scattered = same;
  for (int w = 0; w < 12; ++w) scattered[w] += (w % 2 == 0 ? 0.3 : -0.3) * sure[w];
  CHECK(random_effect(sure, scattered, two, 0.0, false).log_bayes_factor <
        random_effect(sure, scattered, each, 0.0, false).log_bayes_factor - 2.0);
  // One window that is far off, and surer than the others, does not outweigh them.
  Eigen::VectorXd surer = sure, but_one = same;
  surer[5] *= 4.0, but_one[5] = -0.8 * surer[5];
  const RandomEffect outweighed = random_effect(surer, but_one, each, 0.0, false);
  CHECK(outweighed.log_bayes_factor > 5.0);
  CHECK(outweighed.theta == Approx(0.8).epsilon(0.05));
  // What cannot be below 0 is no cause where windows say that it is, however sure they are of it.
  CHECK(random_effect(1e4 * sure, -1e4 * same, each, 0.0, true).log_bayes_factor < 0.0);
  CHECK(random_effect(sure, -same, each, 0.0, true).log_bayes_factor < 0.0);
  // A deviation as large as a tick is no evidence.
  CHECK(random_effect(sure, 0.2 * sure, each, 0.2, false).log_bayes_factor < 0.5);
  CHECK(random_effect(sure, 0.2 * sure, each, 0.0, false).log_bayes_factor > 5.0);
}

TEST_CASE("variances are those that the windows' disturbances were drawn from") {
  // Windows of a linear model of their own: each group's columns are random, what they multiply has 3 times the first deviation.
  core::Random random(5, 1);
  Variances truth = first_variances();
  for (double& v : truth.local) v *= 9.0;
  for (double& v : truth.noise) v *= 0.25;
  // Every second window is disturbed four times as much.
  constexpr double kMore = 16.0;
  const auto more = [](std::size_t w, std::size_t g) {
    return w % 2 == 1 && g >= kTorque && g <= kMomentUp ? kMore : 1.0;
  };
  std::vector<LinearWindow> windows(40);
  for (std::size_t w = 0; w < windows.size(); ++w) {
    LinearWindow& l = windows[w];
    for (std::size_t k = 0; k < kLocals; k += 3) l.locals.push_back(k);
    const auto rows = static_cast<Eigen::Index>(20 * kRowSize),
               n = static_cast<Eigen::Index>(l.locals.size());
    l.c.resize(rows, n);
    l.y = Eigen::VectorXd::Zero(rows);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto g = static_cast<std::size_t>(group_of(l.locals[static_cast<std::size_t>(k)]));
      const double x = std::sqrt(more(w, g) * truth.local[g]) * random.gaussian();
      for (Eigen::Index i = 0; i < rows; ++i) {
        const auto noise = static_cast<std::size_t>(noise_of(static_cast<std::size_t>(i) % kRowSize));
        l.c(i, k) = 0.1 * random.gaussian() * std::sqrt(truth.noise[noise] / truth.local[g]);
        l.y[i] += l.c(i, k) * x;
      }
    }
    for (Eigen::Index i = 0; i < rows; ++i)
      l.y[i] +=
          std::sqrt(truth.noise[static_cast<std::size_t>(noise_of(static_cast<std::size_t>(i) % kRowSize))]) *
          random.gaussian();
  }
  const std::vector<Variances> all = estimated(windows, first_variances(), 1);
  Variances found;
  found.noise = all[0].noise;
  for (std::size_t w = 0; w < windows.size(); ++w)
    for (std::size_t g = 0; g < kLocalGroups; ++g)
      found.local[g] += all[w].local[g] / more(w, g) / static_cast<double>(windows.size());
  for (std::size_t g = 0; g < kNoiseGroups; ++g)
    CHECK(found.noise[g] == Approx(truth.noise[g]).epsilon(0.05));
  // Of a number the rows tell 360 / 100 times what its prior does. So a variance from 40 or more draws is known to 0.28 of itself.
  std::array<bool, kLocalGroups> there{};
  for (const std::size_t k : windows[0].locals) there[static_cast<std::size_t>(group_of(k))] = true;
  double ratios = 0.0, groups = 0.0;
  for (std::size_t g = 0; g < kLocalGroups; ++g) {
    INFO("group " << g);
    if (!there[g]) continue;
    CHECK(found.local[g] == Approx(truth.local[g]).epsilon(0.84));
    ratios += found.local[g] / truth.local[g], groups += 1.0;
  }
  // A window has from 5 draws of a disturbance on, and what they say is drawn to the typical window by four.
  CHECK(ratios / groups == Approx(1.0).epsilon(0.3));
}

TEST_CASE("on a stand with late drives the legs move as much later") {
  walk::Walk walk = test::found_walk("active");
  walk.exercise_s = 4.0;
  const auto knee_rad = [&](double command_delay_s) {
    return simulate_exercise(dynamics::biped::design(), walk, command_delay_s, 1e-3, std::nullopt)
        .at("angle_left_knee_rad");
  };
  const std::vector<double> prompt = knee_rad(0.0), late = knee_rad(5e-3);
  double shifted = 0.0, same_time = 0.0;
  for (std::size_t k = 1000; k + 5 < prompt.size(); ++k) {
    shifted = std::max(shifted, std::abs(late[k + 5] - prompt[k]));
    same_time = std::max(same_time, std::abs(late[k] - prompt[k]));
  }
  CHECK(shifted < 1e-5);
  CHECK(same_time > 1e-4);
}

TEST_CASE("a window of the stand hardly depends on the step") {
  walk::Walk walk = test::found_walk("active");
  walk.exercise_s = 8.0;
  log::Log log = walk::simulate_exercise(dynamics::biped::design(), walk, 0.0, 0.01, 3);
  log.path = "exercise.csv";
  const Recording recording = recording_of(log);
  const Machine machine = nominal();
  const Plant plant = plant_of(machine);
  const Local none = Local::Zero();
  const Variant here{&machine, &plant, none.data()};
  double worst = 0.0;
  for (const Window& w : windows_of(recording, 0, 0.3)) {
    const Eigen::MatrixXd fine = residuals(recording, w, std::span(&here, 1), 6.25e-5),
                          coarse = residuals(recording, w, std::span(&here, 1), Settings{}.step_s);
    worst = std::max(worst, (coarse - fine).cwiseAbs().maxCoeff());
  }
  CHECK(worst < 5e-5);  // noise of an encoder
}

TEST_CASE("on a stand one run has a derivative of each leg, the same as by itself, to the bit") {
  walk::Walk walk = test::found_walk("active");
  walk.exercise_s = 8.0;
  log::Log log = walk::simulate_exercise(dynamics::biped::design(), walk, 0.0, 0.01, 3);
  log.path = "exercise.csv";
  const std::vector<Recording> recordings{recording_of(log)};
  const std::vector<Window> windows{windows_of(recordings[0], 0, 0.3)[12]};
  const Machine machine = nominal();
  const Plant plant = plant_of(machine);
  const Local here = Local::Constant(1e-4);
  const LinearWindow own =
      linearised(recordings[0], windows[0], first_variances(), machine, plant, here, Settings{}.step_s);
  double moved = 0.0;
  for (std::size_t k = 0; k < own.locals.size(); ++k) {
    if (own.locals[k] >= kFilterAt) continue;
    INFO("a window's own unknown " << own.locals[k]);
    const double change = 1e-3 * kLocalSd[group_of(own.locals[k])];
    const std::array both{Variant{&machine, &plant, here.data()},
                          Variant{&machine, &plant, here.data(), static_cast<int>(own.locals[k]), change}};
    const Eigen::MatrixXd r = residuals(recordings[0], windows[0], both, Settings{}.step_s);
    const auto column = static_cast<Eigen::Index>(k);
    CHECK((own.c.col(column) == (r.col(0) - r.col(1)) / change));
    moved += own.c.col(column).cwiseAbs().maxCoeff() > 0.0;
  }
  CHECK(moved == 2 + 2 * 12 + 12 * kKnots);  // tilt, angles, rates, torques

  const std::vector<Unknown> unknowns = biped::unknowns(machine.robot, true, false);
  const Point point =
      at(machine, unknowns, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns.size())), {here});
  const auto derivatives = [&](const std::vector<Unknown>& of) {
    std::vector<LinearWindow> linear{own};
    linearise_machine(
        recordings, windows, of,
        {point.machine, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(of.size())), point.locals},
        Settings{}, linear);
    return linear[0].a;
  };
  const Eigen::MatrixXd all = derivatives(unknowns);
  int acting = 0;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    INFO(unknowns[i].name());
    CHECK((all.col(static_cast<Eigen::Index>(i)) == derivatives({unknowns[i]}).col(0)));
    acting += unknowns[i].location.starts_with("right_") &&
              all.col(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff() > 0.0;
  }
  CHECK(acting > 100);
}

TEST_CASE("more dry friction does not move a joint that sticks, and holds one that slides") {
  walk::Walk walk = test::found_walk("active");
  walk.exercise_s = 8.0;
  log::Log log = walk::simulate_exercise(dynamics::biped::design(), walk, 0.0, 0.01, std::nullopt);
  log.path = "exercise.csv";
  const Recording recording = recording_of(log);
  Machine less = nominal();
  less.robot.creep_radps = 3e-3;
  Machine more = less;
  for (auto& leg : more.robot.drives)
    for (auto& drive : leg) drive.friction_nm *= 2.0;
  const Plant with_less = plant_of(less), with_more = plant_of(more);
  const Local none = Local::Zero();
  const std::array both{Variant{&less, &with_less, none.data()}, Variant{&more, &with_more, none.data()}};
  double sticking = 0.0, sliding = 0.0;
  int rests = 0;
  for (const Window& w : windows_of(recording, 0, 0.3)) {
    double fastest = 0.0;
    for (std::size_t k = w.first; k < w.first + w.count; ++k)
      for (const double rate : recording.rows[k].rate_radps) fastest = std::max(fastest, std::abs(rate));
    const Eigen::MatrixXd r = residuals(recording, w, both, Settings{}.step_s);
    rests += fastest < 1e-3;
    double& most = fastest < 1e-3 ? sticking : sliding;
    most = std::max(most, (r.col(1) - r.col(0)).cwiseAbs().maxCoeff());
  }
  CHECK(rests > 2);
  CHECK(sticking < 1e-9);
  CHECK(sliding > 1e-3);
}

TEST_CASE(
    "on the stand a joint's dry friction is named, and nothing beside it but what its sensors are off by") {
  constexpr double kFriction_nm = 4.0;
  walk::Walk walk = test::found_walk("active");
  walk.exercise_s = 8.0;
  IdentifyOptions options;
  options.iterations = 0;
  options.settings.threads = 1;
  auto robot = dynamics::biped::design();
  robot.drives[1][dynamics::biped::kHipRoll].friction_nm += kFriction_nm;
  log::Log log = walk::simulate_exercise(robot, walk, 0.0, 0.01, 3);
  log.path = "exercise.csv";
  const Recording recording = recording_of(log);
  CHECK(recording.held);
  CHECK(windows_of(recording, 0, 0.3).size() == 28);  // 8.5 s, without the first row
  const Identified found = identify(nominal(), {recording}, options);
  CHECK(found.before.attitude_rad < 1e-4);
  double found_nm = 0.0;
  for (const Cause& c : found.causes) {
    const Unknown& u = found.unknowns[c.unknown];
    INFO(u.kind << "@" << u.location << ", confidence " << c.confidence);
    // These sensors have a gyro that is off and encoders that are.
    if (c.confidence < 0.5 || u.kind.starts_with("gyro_bias") || u.kind == "encoder_offset") continue;
    // Known to be wrong: the IMU's mounting, which a robot on its stand does not show, has 0.53.
    if (u.kind == "imu_mounting_y" && c.confidence < 0.6) continue;
    CHECK(u.kind == "coulomb_friction");
    CHECK(u.location == "right_hip_roll");
    found_nm = c.theta * u.prior_sd;
  }
  CHECK(found_nm == Approx(kFriction_nm).epsilon(0.2));
}

TEST_CASE("deviations of a model file are read as they were written, and wrong ones are refused") {
  const Machine given = nominal();
  Machine machine = given;
  std::size_t n = 0;
  for (const Unknown& u : biped::unknowns(given.robot, true, true))
    if (++n % 7 == 0) u.add(machine, 0.1 * u.prior_sd);
  const test::Folder folder;
  const auto model_of = [&](const std::string& deviations) {
    const std::string file = folder.file("model.toml");
    std::ofstream(file) << "[model]\nkind = \"biped\"\nschema = 1\nurdf = \""
                        << test::source("models/biped/furcula_biped.urdf") << "\"\n"
                        << deviations;
    return walk::read_model(file);
  };
  const walk::Model read = model_of(biped::format_deviations(given, machine));
  for (const Unknown& u : biped::unknowns(given.robot, true, true)) {
    INFO(u.kind << "@" << u.location);
    CHECK(u.value(read.machine) == Approx(u.value(machine)).epsilon(1e-9).margin(1e-12));
  }
  CHECK(read.robot.pelvis.mass_kg == read.machine.robot.pelvis.mass_kg);
  // A fit may end where a number cannot go further: 1.9 kg - 1.52 kg is less than a fifth of 1.9 kg by rounding.
  Machine bound = given;
  for (auto& leg : bound.robot.legs)
    for (auto& link : leg) link.mass_kg *= 0.2;
  CHECK(model_of(biped::format_deviations(given, bound)).robot.mass_kg() == Approx(bound.robot.mass_kg()));
  CHECK_THAT(test::error_message([&] { model_of("[deviations]\n\"mass@left_kne\" = 0.1\n"); }),
             Contains("mass@left_kne") && Contains("[deviations]"));
  CHECK_THAT(test::error_message([&] { model_of("[deviations]\n\"mass@left_knee\" = -3.3\n"); }),
             Contains("a robot that cannot be"));
  CHECK_THAT(test::error_message([&] { model_of("[deviations]\n\"mass@left_knee\" = \"much\"\n"); }),
             Contains("model.toml"));
}
