// Recordings of a hopper's bus as logs with one row a tick: what comes back of the log that the bus carried.
#include "host/bus/bus_log.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <numbers>

#include "host/core/message.hpp"
#include "host/log/reader.hpp"
#include "host/model/writer.hpp"
#include "host/sim/hidden_case.hpp"
#include "tests/host/bus/hopper_bus.hpp"
#include "tests/host/bus/polled_drive.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Contains;

namespace {

/// A body that bounces: parabolas of 0.05 m over 0.28 m, half sines of 0.03 m below it. Ticks are up to 0.02 ms off.
log::Log bouncing(std::size_t rows) {
  log::Log log;
  log.rig = "hopper";
  constexpr double kFlightS = 0.202, kStanceS = 0.15;  // 2 sqrt(2 x 0.05 / 9.81)
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = 0.001 * static_cast<double>(i) + 1e-6 * static_cast<double>(i * 13 % 21);
    const double in = std::fmod(t, kFlightS + kStanceS);
    const bool flies = in < kFlightS;
    const double wave = std::numbers::pi * (in - kFlightS) / kStanceS;
    const double height = flies ? 0.28 + 9.81 * in * (kFlightS - in) / 2 : 0.28 - 0.03 * std::sin(wave);
    log.columns["time_s"].push_back(t);
    log.columns["height_m"].push_back(height);
    log.columns["velocity_mps"].push_back(flies ? 9.81 * (kFlightS / 2 - in)
                                                : -0.03 * std::numbers::pi / kStanceS * std::cos(wave));
    log.columns["leg_angle_rad"].push_back(flies ? 0.35 : std::acos(height / 0.3));
    log.columns["contact"].push_back(flies ? 0.0 : 1.0);
    log.columns["torque_cmd_nm"].push_back(flies ? 0.0 : 2.0 * std::sin(wave));
    log.columns["torque_nm"].push_back(flies ? 0.0 : 1.9 * std::sin(wave));
    log.columns["solenoid"].push_back(0.0);
  }
  return log;
}

struct Made {
  std::vector<log::Log> runs;
  std::vector<std::string> notes;
};

Made made_of(const std::vector<LogFrame>& frames, const MessageFinder& finder,
             const ChannelPermutation& wanted) {
  Made made;
  Survey survey(finder, wanted);
  for (const LogFrame& f : frames) survey.add(f);
  const ChannelPermutation found = survey.finish(made.notes);
  RowMaker rows(finder, found, [&](std::size_t run, const std::vector<double>& row) {
    made.runs.resize(run);
    log::Log& log = made.runs.back();
    log.columns["time_s"].push_back(row[0]);
    for (std::size_t i = 0; i < found.columns.size(); ++i)
      log.columns[found.columns[i].name].push_back(row[i + 1]);
  });
  for (const LogFrame& f : frames) rows.add(f);
  rows.finish();
  for (const std::string& note : rows.notes()) made.notes.push_back(note);
  return made;
}

Made log_of(const std::vector<LogFrame>& frames, const std::vector<JointDrive>& joints = {}) {
  const MessageFinder finder(usual_nodes());
  return made_of(frames, finder, arrange("hopper", usual_nodes(), joints, {}));
}

/// A rotary_joint of the ODrive, driven by its set points.
Made joint_of(const std::vector<LogFrame>& frames, const std::vector<std::string>& more = {}) {
  const MessageFinder finder(usual_nodes());
  std::vector<Column> columns{parse_column("torque_nm=Axis.Set_Input_Torque.Torque", finder.messages())};
  for (const std::string& text : more) columns.push_back(parse_column(text, finder.messages()));
  return made_of(frames, finder, arrange("rotary_joint", usual_nodes(), {{"angle", "Axis"}}, columns));
}

/// By how much a row's torque is off from what acted from the row's measurement to the next one's, at most.
double largest_error_nm(const test::PolledDrive::Truth& truth, const log::Log& log) {
  double largest = 0.0;
  for (std::size_t row = 0, k = 0; row + 1 < log.rows(); ++row) {
    // The row's own measurement: that angle, to the digits of a 32-bit number of turns.
    while (k + 1 < truth.angle_rad.size() && std::abs(truth.angle_rad[k] - log.at("angle_rad")[row]) > 2e-7)
      ++k;
    REQUIRE(k + 1 < truth.angle_rad.size());
    const double acted_nm = (truth.impulse_nms[k + 1] - truth.impulse_nms[k]) * 1e9 /
                            static_cast<double>(truth.measured_ns[k + 1] - truth.measured_ns[k]);
    largest = std::max(largest, std::abs(log.at("torque_nm")[row] - acted_nm));
    ++k;
  }
  return largest;
}

std::vector<LogFrame> frames_of(const test::HopperBus& bus, const log::Log& log) {
  std::vector<LogFrame> frames;
  bus.play(log, [&](const LogFrame& f) { frames.push_back(f); });
  return frames;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

std::string all(const std::vector<std::string>& notes) {
  std::string out;
  for (const std::string& n : notes) out += n + "\n";
  return out;
}

}  // namespace

TEST_CASE(
    "a recording of a hopper's bus gives the log that the bus carried, within the steps of its signals") {
  const log::Log truth = bouncing(3000);
  const Made made = log_of(frames_of({}, truth));
  REQUIRE(made.runs.size() == 1);
  const log::Log& log = made.runs[0];
  REQUIRE(log.rows() == 3000);
  // Ages have steps of 0.1 ms, and the first row's is one of them.
  CHECK(largest_difference(log.at("time_s"), truth.at("time_s")) < 0.000101);
  // Half a count, and what a scale that is off by 1e-3 at most makes of 0.05 m either way.
  CHECK(largest_difference(log.at("height_m"), truth.at("height_m")) < 0.000045 + 0.00005);
  CHECK(largest_difference(log.at("leg_angle_rad"), truth.at("leg_angle_rad")) < 25.0 / 65535 + 0.0001);
  CHECK(largest_difference(log.at("torque_cmd_nm"), truth.at("torque_cmd_nm")) < 36.0 / 4095);
  CHECK(largest_difference(log.at("torque_nm"), truth.at("torque_nm")) < 36.0 / 4095);
  CHECK_THAT(all(made.notes), Contains("height_m = ") && Contains("values of Board_Body_State.Height") &&
                                  Contains("40 rows with the drive off"));
}

TEST_CASE("a switch that is told every 10 ms changes in the middle, on the mean neither early nor late") {
  const log::Log truth = bouncing(6000);
  const Made made = log_of(frames_of({}, truth));
  double sum_ms = 0.0;
  int changes = 0;
  const auto &a = truth.at("contact"), &b = made.runs.at(0).at("contact");
  for (std::size_t i = 1; i < a.size() - 20; ++i) {
    if (a[i] == a[i - 1]) continue;
    for (int late = -10; late <= 10; ++late) {
      const std::size_t k = i + static_cast<std::size_t>(late);
      if (k == 0 || k >= b.size() || b[k] == b[k - 1] || b[k] != a[i]) continue;
      CHECK(std::abs(late) <= 6);
      sum_ms += late;
      ++changes;
    }
  }
  CHECK(changes >= 30);
  // Uniform within 10 ms: a mean of `changes` has a standard deviation of 10 / sqrt(12) / sqrt(changes).
  CHECK(std::abs(sum_ms / changes) < 3.0 * 10.0 / std::sqrt(12.0 * changes));
}

TEST_CASE("zero, sense and gear of the drive come from what the board tells, and torques follow") {
  const log::Log truth = bouncing(3000);
  test::HopperBus bus;
  bus.ratio = -6.0;
  bus.leg_zero_rad = 0.12;
  const Made made = log_of(frames_of(bus, truth));
  CHECK(largest_difference(made.runs.at(0).at("leg_angle_rad"), truth.at("leg_angle_rad")) < 0.0005);
  CHECK(largest_difference(made.runs.at(0).at("torque_cmd_nm"), truth.at("torque_cmd_nm")) <
        6 * 36.0 / 4095 + 0.002);
}

TEST_CASE("lost frames cost a row, a held command or an interpolated angle, and each is counted") {
  const log::Log truth = bouncing(2000);
  test::HopperBus bus;
  bus.comes = [](std::size_t tick, std::string_view message) {
    return !(tick % 100 == 50 && message == "Sample") && !(tick % 100 == 60 && message == "Command") &&
           !(tick % 100 == 70 && message == "Reply");
  };
  const Made made = log_of(frames_of(bus, truth));
  REQUIRE(made.runs.size() == 1);
  CHECK(made.runs[0].rows() == 2000 - 20);
  CHECK_THAT(all(made.notes),
             Contains("20 frames of Rail_Sample did not come") &&
                 Contains("20 rows without a frame of Knee_Command: torque_cmd_nm holds") &&
                 Contains("20 rows without a frame of Knee_Reply: leg_angle_rad is on the line"));
}

TEST_CASE("frames that came again or out of order give no row of their own") {
  const log::Log truth = bouncing(2000);
  std::vector<LogFrame> frames;
  std::size_t n = 0;
  for (const LogFrame& f : frames_of({}, truth)) {
    frames.push_back(f);
    if (f.frame.id == 0x461 && ++n % 100 == 0) frames.push_back(f);
  }
  const Made made = log_of(frames);
  CHECK(made.runs.at(0).rows() == 2000);
  CHECK_THAT(all(made.notes), Contains("frames of Rail_Sample came again"));
}

TEST_CASE("each time that the drive is switched on is a run, and a clock that is set back costs none") {
  const log::Log truth = bouncing(1000);
  std::vector<LogFrame> frames = frames_of({}, truth);
  test::HopperBus later;
  later.start_ns += 3'000'000'000;
  for (const LogFrame& f : frames_of(later, truth)) frames.push_back(f);
  const Made two = log_of(frames);
  REQUIRE(two.runs.size() == 2);
  CHECK(two.runs[1].rows() == 1000);
  // An hour back in the middle of a run.
  frames = frames_of({}, truth);
  for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) frames[i].time_ns -= 3'600'000'000'000;
  const Made back = log_of(frames);
  REQUIRE(back.runs.size() == 1);
  CHECK(back.runs[0].rows() >= 998);
  CHECK(back.runs[0].at("time_s").back() == Approx(0.999).margin(0.003));
  CHECK_THAT(all(back.notes), Contains("set back 1 time"));
}

TEST_CASE("what a log needs and the recording has not is said, with what to do") {
  const auto refusal = [](test::HopperBus bus, log::Log log) {
    return test::error_message([&] { log_of(frames_of(bus, log)); });
  };
  const auto without = [](const std::string& name) {
    test::HopperBus bus;
    bus.comes = [name](std::size_t, std::string_view message) { return message != name; };
    return bus;
  };
  CHECK_THAT(refusal(without("Leg_State"), bouncing(500)),
             Contains("no frame of Board_Leg_State (id 0x441)") && Contains("contact") &&
                 Contains("candump -L can0"));
  CHECK_THAT(refusal(without("Sample"), bouncing(500)), Contains("no frame of Rail_Sample (id 0x461)"));
  CHECK_THAT(refusal(without("Body_State"), bouncing(500)),
             Contains("what Rail_Sample.Count means is not told") &&
                 Contains("--column height_m=Rail.Sample.Count*"));
  log::Log still = bouncing(500);
  std::fill(still.columns["height_m"].begin(), still.columns["height_m"].end(), 0.3);
  CHECK_THAT(refusal({}, still), Contains("over too small a range"));
}

TEST_CASE("joints and columns are taken from options, and what is wrong with one is said") {
  const std::vector<Node> nodes = usual_nodes();
  const std::vector<NodeMessage> messages = messages_of(nodes);
  const Column c = parse_column("height_m=Rail.Sample.Count*-9e-05+0.28", messages);
  CHECK(c.name == "height_m");
  CHECK(c.scale == -9e-05);
  CHECK(c.offset == 0.28);
  CHECK(parse_column("contact=Board.Leg_State.Contact", messages).join == Join::step);
  CHECK(parse_column("torque_cmd_nm=Knee.Command.Torque", messages).join == Join::hold);
  const auto refusal = [&](const char* text) {
    return test::error_message([&] { parse_column(text, messages); });
  };
  CHECK_THAT(refusal("height_m"), Contains("expected NAME=NODE.MESSAGE.SIGNAL"));
  CHECK_THAT(refusal("height_m=Rail.Sample"), Contains("expected NODE.MESSAGE.SIGNAL"));
  CHECK_THAT(refusal("h=Rail.Sample.Cuont"), Contains("did you mean 'Rail.Sample.Count'"));
  CHECK_THAT(refusal("h=Rail.Sample.Count*x"), Contains("scale 'x'"));
  CHECK_THAT(refusal("h=Rail.Sample.Count+1m"), Contains("offset '+1m'"));
  CHECK_THAT(refusal("time_s=Rail.Sample.Count"), Contains("column 'time_s'"));
  CHECK(parse_joint("knee=Knee:-6").ratio == -6.0);
  CHECK_THAT(test::error_message([] { parse_joint("knee=Knee:0"); }), Contains("ratio '0'"));
  CHECK_THAT(test::error_message([] {
               arrange("tree", usual_nodes(), {{"k", "Kne"}}, {});
             }),
             Contains("did you mean 'Knee'"));
  CHECK_THAT(test::error_message([] {
               arrange("tree", usual_nodes(), {{"k", "Rail"}}, {});
             }),
             Contains("expected a drive"));
  CHECK_THAT(test::error_message([] { arrange("hoper", usual_nodes(), {}, {}); }),
             Contains("did you mean 'hopper'"));
  CHECK_THAT(test::error_message([] { arrange("motor_axis", usual_nodes(), {}, {}); }), Contains("--column"));
}

TEST_CASE("two drives of a tree share the instants of the first, and angles of an ODrive become radians") {
  // Both joints turn at a constant rate, so that the line between two replies is exact. A reply tells of when its command came.
  const test::TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.001 * i;
    const auto write = [&](double at_s, Frame frame) {
      text += format_candump({static_cast<std::int64_t>(std::llround(at_s * 1e9)), "can0", frame});
    };
    Frame command = empty_frame(message::kMotorCommand, 1);
    static_cast<void>(
        put(command, with_range(table::kMotorCommand[4], info(Motor::ak80_9)), i < 100 ? 1.0f : -2.0f));
    write(t, command);
    Frame reply = empty_frame(message::kMotorReply, 1);
    static_cast<void>(
        put(reply, with_range(table::kMotorReply[1], info(Motor::ak80_9)), static_cast<float>(2.0 * t)));
    write(t + 0.0002, reply);
    Frame axis = empty_frame(message::kOdriveEncoderEstimates, 2);
    static_cast<void>(put(axis, table::kOdriveEncoderEstimates[0], static_cast<float>(0.25 * (t + 0.0007))));
    static_cast<void>(put(axis, table::kOdriveEncoderEstimates[1], 0.25f));
    write(t + 0.0007, axis);
  }
  const std::string recording = folder.file("arm.log", text), out = folder.path() + "/arm.csv";
  const test::Ran ran = test::run_furcula({"bus", "log", recording, "--machine", "tree", "--joint",
                                           "upper=Knee", "--joint", "fore=Axis:2", "--out", out});
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  const log::Log log = log::read_log(out, "tree");
  REQUIRE(log.rows() >= 198);
  for (std::size_t i = 0; i < log.rows(); ++i) {
    // Both angles are those of the row's own instant.
    const double t = log.at("angle_upper_rad")[i] / 2.0;
    CHECK(log.at("angle_fore_rad")[i] == Approx(2.0 * std::numbers::pi * 0.25 / 2.0 * t).margin(0.0004));
    CHECK(log.at("velocity_fore_radps")[i] == Approx(std::numbers::pi / 4.0));
  }
  CHECK(log.at("torque_cmd_upper_nm").front() == Approx(1.0).margin(0.01));
  CHECK(log.at("torque_cmd_upper_nm").back() == Approx(-2.0).margin(0.01));
  CHECK_THAT(ran.err, Contains("torque_fore_nm is left out: no frame of Axis_Get_Torques (id 0x05C)"));
}

TEST_CASE("a row holds what acted from it to the next, whichever of command and measurement comes first") {
  // Stamps are whole steps of the truth, so that 32-bit torques of a few N m are all that is rounded.
  constexpr double kRoundedNm = 1e-6;
  test::PolledDrive answers;  // each set point is answered 0.3 ms later, with what was measured when it came
  answers.measured_ns = 300'000;
  test::PolledDrive asked = answers;  // by remote frames
  asked.measured_ns = 200'000;
  asked.asked_ns = 200'000;
  test::PolledDrive behind;  // the set point is made of the estimate, 0.3 ms later
  behind.command_ns = 300'000;
  behind.state_ns = 0;
  test::PolledDrive middle;  // both in periods of their own, which stay half a period apart
  middle.state_ns = 2'500'000;
  test::PolledDrive free = middle;  // clocks that are 0.8 % apart pass through each other
  free.state_period_ns = 5'040'000;
  test::PolledDrive often = middle;  // five set points an estimate, always 0.3 ms before it
  often.command_period_ns = 1'000'000;
  often.state_ns = 300'000;
  test::PolledDrive seldom = middle;  // a set point every ten estimates
  seldom.state_period_ns = 500'000;
  seldom.state_ns = 200'000;
  for (const test::PolledDrive& drive : {answers, asked, behind, middle, free, often, seldom}) {
    INFO(drive.command_ns << " " << drive.state_ns << " " << drive.asked_ns << " " << drive.state_period_ns);
    const test::PolledDrive::Truth truth = drive.run(4.0);
    const Made made = joint_of(truth.frames);
    REQUIRE(made.runs.size() == 1);
    CHECK(made.runs[0].rows() >= truth.angle_rad.size() - 2);
    CHECK(largest_error_nm(truth, made.runs[0]) < kRoundedNm);
    const bool answered = drive.measured_ns != 0;
    CHECK((all(made.notes).find("answers") != std::string::npos) == answered);
  }
  CHECK_THAT(all(joint_of(answers.run(1.0).frames).notes),
             Contains("Axis_Get_Encoder_Estimates answers Axis_Set_Input_Torque after 0.3 ms"));
  CHECK_THAT(all(joint_of(asked.run(1.0).frames).notes), Contains("answers remote frames after 0.2 ms"));
}

TEST_CASE("a diagnosis of a drive's recording names no delay that the drive does not have, in either order") {
  const test::TemporaryFolder folder;
  const std::string model = folder.file("model.toml",
                                        "[model]\nkind = \"rotary_joint\"\nschema = 1\n[parameters]\n"
                                        "inertia_kgm2 = 0.05\ngravity_torque_nm = 1.5\ndamping_nmspr = 0.1\n"
                                        "[free]\ninertia_kgm2 = [0.02, 0.1]\ndamping_nmspr = [0.0, 0.5]\n");
  test::PolledDrive answers, behind;
  answers.measured_ns = 300'000;
  behind.command_ns = 300'000;
  behind.state_ns = 0;
  for (test::PolledDrive drive : {answers, behind}) {
    drive.counts_per_turn = 8192.0;
    std::string text;
    for (const LogFrame& f : drive.run(8.0).frames) text += format_candump(f);
    const std::string out = folder.path() + "/axis.csv";
    REQUIRE(test::run_furcula({"bus", "log", folder.file("axis.log", text), "--machine", "rotary_joint",
                               "--joint", "angle=Axis", "--column", "torque_nm=Axis.Set_Input_Torque.Torque",
                               "--out", out})
                .status == 0);
    const test::Ran found =
        test::run_furcula({"diagnose", "--model", model, "--out", folder.path() + "/found", out});
    INFO(found.out << found.err);
    // The friction that it has, and no other cause.
    CHECK_THAT(found.out + found.err,
               Contains("The model lacks dry friction (coulomb_friction: 0.12 N m): with it"));
    CHECK_THAT(found.out + found.err, !Contains("actuator_delay"));
  }
}

TEST_CASE("a lost command leaves the rows where they were, and the one before it acts on") {
  test::PolledDrive drive;
  drive.measured_ns = 300'000;
  const Made whole = joint_of(drive.run(2.0).frames);
  drive.command_comes = [](std::size_t i) { return i % 50 != 20; };
  const Made lost = joint_of(drive.run(2.0).frames);
  REQUIRE(lost.runs.at(0).rows() == whole.runs.at(0).rows());
  CHECK(largest_difference(lost.runs[0].at("time_s"), whole.runs[0].at("time_s")) < 1e-9);
  const std::vector<double>& u = lost.runs[0].at("torque_nm");
  for (std::size_t row = 20; row < u.size(); row += 50) CHECK(u[row] == u[row - 1]);
  CHECK_THAT(all(lost.notes), Contains("8 rows without a frame of Axis_Set_Input_Torque: torque_nm holds"));
}

TEST_CASE("a command that is a whole number is what acted longest, not a mean") {
  test::PolledDrive drive;
  drive.state_ns = 2'000'000;
  std::vector<LogFrame> frames = drive.run(1.0).frames;
  for (const double change_s : {0.2, 0.6}) {
    Frame mode = empty_frame(message::kOdriveControllerMode, 2);
    static_cast<void>(put_raw(mode, table::kOdriveControllerMode[0], change_s < 0.5 ? 1 : 3));
    const LogFrame f{1'000'000'000 + std::llround(change_s * 1e9), "can0", mode};
    frames.insert(
        std::upper_bound(frames.begin(), frames.end(), f,
                         [](const LogFrame& a, const LogFrame& b) { return a.time_ns < b.time_ns; }),
        f);
  }
  const Made made = joint_of(frames, {"mode=Axis.Set_Controller_Mode.Control_Mode"});
  REQUIRE(made.runs.at(0).rows() > 100);
  for (const double mode : made.runs[0].at("mode")) CHECK((mode == 1.0 || mode == 3.0));
}

TEST_CASE("an answer that comes behind others' is joined at the instant of which it tells") {
  // Both are asked at once, the second one first, and answer in the other order.
  const std::vector<Node> nodes{{"A", Protocol::mini_cheetah, 1, Motor::ak80_9},
                                {"B", Protocol::mini_cheetah, 2, Motor::ak80_9}};
  std::vector<LogFrame> frames;
  for (int i = 0; i < 300; ++i) {
    const auto send = [&](int node, double at_s, bool reply, double told_s) {
      const auto id = static_cast<std::uint8_t>(node);
      Frame f = empty_frame(reply ? message::kMotorReply : message::kMotorCommand, id);
      const auto& position = reply ? table::kMotorReply[1] : table::kMotorCommand[0];
      static_cast<void>(put(f, with_range(position, info(Motor::ak80_9)), static_cast<float>(told_s)));
      frames.push_back({std::llround((1.0 + at_s) * 1e9), "can0", f});
    };
    const double t = 0.002 * i;
    send(1, t, false, 0.0);
    send(2, t + 0.0001, false, 0.0);
    send(2, t + 0.00025, true, t + 0.0001);
    send(1, t + 0.0004, true, t);
  }
  const MessageFinder finder(nodes);
  const Made made = made_of(frames, finder, arrange("tree", nodes, {{"a", "A"}, {"b", "B"}}, {}));
  const log::Log& log = made.runs.at(0);
  CHECK(log.rows() >= 298);
  // Steps of the position are 25 rad / 65535.
  CHECK(largest_difference(log.at("angle_a_rad"), log.at("angle_b_rad")) < 0.0004);
}

TEST_CASE("a drive that does not tell its torque is logged by the line that the message has") {
  const test::TemporaryFolder folder;
  std::string text;
  for (const LogFrame& f : test::PolledDrive{}.run(1.0).frames) text += format_candump(f);
  text += "(2.000000) can0 20000004#0004000000000000\n(2.000000) can0 04E##11122334455667788990011\n";
  const std::string recording = folder.file("axis.log", text), out = folder.path() + "/axis.csv";
  const std::vector<std::string> command{"bus",     "log",           recording, "--machine", "rotary_joint",
                                         "--joint", "angle=Axis:-8", "--out",   out};
  const test::Ran refused = test::run_furcula(command);
  CHECK(refused.status == 3);
  const std::string line = "torque_nm=Axis.Set_Input_Torque.Torque*-8";
  CHECK_THAT(refused.err,
             Contains("no frame of Axis_Get_Torques (id 0x05C)") && Contains("--column " + line + ";"));
  std::vector<std::string> again = command;
  again.insert(again.end(), {"--column", line});
  const test::Ran ran = test::run_furcula(again);
  INFO(ran.err);
  CHECK(ran.status == 0);
  // As decode counts them.
  CHECK_THAT(ran.err,
             Contains("1 frame of CAN FD, not decoded") && Contains("1 frame reporting an error of the bus"));
  CHECK_THAT(refused.err, Contains("1 frame of CAN FD, not decoded"));
}

TEST_CASE("furcula bus log writes logs that check reads, and ends with the contract's statuses") {
  const test::TemporaryFolder folder;
  const std::string recording = folder.file("can.log", test::HopperBus{}.candump(bouncing(1500)));
  const std::string out = folder.path() + "/run.csv";
  const test::Ran ran = test::run_furcula({"bus", "log", recording, "--out", out});
  INFO(ran.err);
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Contains("run.csv: 1500 rows, 1.499 s"));
  CHECK(test::run_furcula({"check", out}).status == 0);
  CHECK(folder.names() == std::vector<std::string>{"can.log", "run.csv"});

  // Two runs are two files.
  test::HopperBus later;
  later.start_ns += 10'000'000'000;
  const std::string both =
      folder.file("both.log", test::HopperBus{}.candump(bouncing(1500)) + later.candump(bouncing(600)));
  const test::Ran two = test::run_furcula({"bus", "log", both, "--out", out});
  CHECK_THAT(two.out, Contains("run.csv: 1500 rows") && Contains("run-2.csv: 600 rows"));

  // A link stays one, and what it names is replaced; /dev/stdout is such a link.
  const std::string link = folder.path() + "/link.csv";
  std::filesystem::create_symlink(out, link);
  CHECK(test::run_furcula({"bus", "log", recording, "--out", link}).status == 0);
  CHECK(std::filesystem::is_symlink(link));
  CHECK(log::read_log(out, "hopper").rows() == 1500);
  const test::Ran to_pipe = test::run_furcula({"bus", "log", recording, "--out", "/dev/stdout"});
  CHECK_THAT(to_pipe.out, Catch::StartsWith("# format: furcula-log/1\n"));
  CHECK(std::filesystem::is_symlink("/dev/stdout"));
  CHECK(test::run_furcula({"bus", "log", recording, "--out", folder.path()}).status == 2);

  CHECK(test::run_furcula({"bus", "log", recording, "--out", recording}).status == 2);
  CHECK(test::run_furcula({"bus", "log", recording}).status == 2);
  CHECK(test::run_furcula({"bus", "log", recording, "--out", out, "--machine", "tree"}).status == 2);
  CHECK(test::run_furcula({"bus", "log", recording, "--out", folder.path() + "/none/run.csv"}).status == 2);
  const test::Ran other =
      test::run_furcula({"bus", "log", recording, "--out", out, "--node", "B=controller:2", "--node",
                         "K=mini_cheetah:1:ak80_9", "--node", "R=encoder:1"});
  CHECK(other.status == 3);
  CHECK_THAT(other.err, Contains("no frame of B_Leg_State (id 0x442)"));
}

TEST_CASE("a hopper's hidden cause is named through recordings of its bus as through its own logs") {
  const test::TemporaryFolder folder;
  // Seed 4 draws a spring of another rate.
  const sim::HiddenCase hopper = sim::draw_hidden_case(4);
  REQUIRE(hopper.cause == dynamics::Effect::stiffness_error);
  std::vector<std::string> command{"diagnose", "--model",
                                   folder.file("model.toml", model::format_model(hopper.model)), "--out",
                                   folder.path() + "/found"};
  for (const log::Log& log : hopper.logs) {
    const std::string name = log.metadata.at("experiment");
    const std::string recording = folder.file(name + ".log", test::HopperBus{}.candump(log));
    const std::string out = folder.path() + "/" + name + ".csv";
    REQUIRE(test::run_furcula({"bus", "log", recording, "--out", out}).status == 0);
    command.push_back(out);
  }
  const test::Ran found = test::run_furcula(command);
  INFO(found.out);
  INFO(found.err);
  CHECK(found.status == 0);
  // The truth's own rate, to three digits.
  const double stiffness_npm = hopper.truth.effects.at(hopper.cause)[0];
  CHECK_THAT(
      found.out + found.err,
      Contains("explained: ") && Contains("(stiffness_error: " + core::rounded(stiffness_npm, 3) + " N/m"));
}
