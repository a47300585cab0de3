// furculad's loop for a biped, from CAN frames to CAN frames: three pairs of sockets are its buses, the simulated robot's devices are at
// the other ends, and beside it a controller gets what stands in the frames.
#include <linux/can.h>
#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>
#include <vector>

#include "boards/linux_sbc/loop.hpp"
#include "boards/linux_sbc/walker_board.hpp"
#include "furcula/dynamics/biped/design.hpp"
#include "host/log/reader.hpp"
#include "host/walk/walker_config.hpp"
#include "host/walk/walker_devices.hpp"
#include "host/walk/walker_faults.hpp"
#include "tests/boards/linux_sbc/doubles.hpp"
#include "tests/folder.hpp"
#include "tests/host/walk/walks.hpp"

#ifdef FURCULA_COUNTS_ALLOCATIONS
extern "C" unsigned long furcula_allocations();
#endif

using namespace furcula;
using control::Fault;
using control::WalkerStage;

namespace {

constexpr std::size_t kBuses = linux_sbc::kMostBuses;
using Board = linux_sbc::LinuxWalkerBoard<socketcan::CanSocket, test::QuietTicks>;

walk::WalkerRigConfig robot_of(const char* mode = "active", std::uint64_t seed = 1) {
  const walk::Walk found = test::found_walk(mode);
  return {.robot = dynamics::biped::design(), .mode = found.mode, .walk = found.parameters, .seed = seed};
}

/// Who tells the robot what to do.
struct Host {
  enum class Request : std::uint8_t { stop = 1, hop = 2, reset = 3 };
  bus::Frame command(Request request) {
    bus::Frame frame = bus::empty_frame(bus::message::kCommand, 1);
    frame.data = {static_cast<std::uint8_t>(bus::kProtocolVersion | static_cast<int>(request) << 4),
                  sequence++};
    return frame;
  }
  std::uint8_t sequence = 0;
};

/// A wire of local sockets: kernel frames go over it as they do over CAN.
struct Wire {
  Wire() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) std::abort();
    here = std::make_unique<socketcan::CanSocket>(ends[0]);
    there = std::make_unique<socketcan::CanSocket>(ends[1]);
  }
  /// What a driver says of its controller.
  void say(std::uint32_t error) const {
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | error;
    frame.can_dlc = 8;
    REQUIRE(::write(there->fd(), &frame, sizeof frame) == sizeof frame);
  }
  std::unique_ptr<socketcan::CanSocket> here, there;
};

struct Robot {
  explicit Robot(const walk::WalkerRigConfig& c)
      : config(c),
        devices(c),
        controller(
            walk::walker_config(c.robot, {"", c.mode, 5.0, c.walk}, 30.0, walk::DriveTurns::over_buses)),
        board({}, {wires[0].here.get(), wires[1].here.get(), wires[2].here.get()}, stop, figures),
        node(board, controller, faults) {
    faults.begin();
  }

  void send(std::size_t bus, const bus::Frame& frame) {
    if (cut[bus]) return;
    if (bus == walk::kWalkerBodyBus && frame.id == body_lost) return;
    in[bus].push_back(frame);
    REQUIRE(wires[bus].there->send(std::span(&frame, 1)));
  }

  /// What a host says from now on, every 10 ms.
  void say(Host::Request request) { request_ = request; }
  void fall_silent() { host_speaks_ = false; }

  /// A tick: what comes for it, furculad's loop, what comes of it.
  void tick() {
    before();
    loop();
    after();
  }
  void before() {
    if (host_speaks_ && ticks % 10 == 0) send(walk::kWalkerBodyBus, host_.command(request_));
    for (const bus::Frame& frame : devices.speak()) send(walk::kWalkerBodyBus, frame);
    heard = in;
    for (auto& frames : in) frames.clear();
    was = node.state();
  }
  void loop() {
    static_cast<void>(board.wait_for_tick());
    linux_sbc::run_walker_tick(board, node, recorder);
  }
  void after() {
    for (std::size_t bus = 0; bus < kBuses; ++bus) {
      out[bus].clear();
      for (const socketcan::Received& r : wires[bus].there->receive()) {
        out[bus].push_back(r.frame);
        if (cut[bus]) continue;
        if (const auto reply = devices.hear(bus, r.frame)) send(bus, *reply);
      }
    }
    devices.advance();
    ++ticks;
  }
  void tick(int times) {
    for (int i = 0; i < times; ++i) tick();
  }
  /// From its start until it walks.
  void walk() {
    tick(200);
    REQUIRE(node.state() == bus::NodeState::idle);
    say(Host::Request::hop);
    while (node.outputs().stage != WalkerStage::walking && ticks < 2000) tick();
    INFO(control::info(node.outputs().fault).name << ", joint " << node.outputs().suspect);
    REQUIRE(node.outputs().stage == WalkerStage::walking);
  }

  walk::WalkerRigConfig config;
  std::array<Wire, kBuses> wires;
  std::array<bool, kBuses> cut{};
  std::uint32_t body_lost = 0;  ///< frames with this id are lost on the body's bus
  walk::WalkerDevices devices;
  control::WalkerConfig controller;
  std::atomic<bool> stop{false};
  linux_sbc::LoopFigures figures;
  firmware::FaultLog faults{};
  Board board;
  firmware::WalkerNode<Board> node;
  std::array<std::vector<bus::Frame>, kBuses> in, heard, out;  ///< for the next tick; in this tick
  bus::NodeState was = bus::NodeState::starting;               ///< before the tick
  int ticks = 0;
  linux_sbc::WalkRecorder* recorder = nullptr;

 private:
  Host host_;
  Host::Request request_ = Host::Request::stop;
  bool host_speaks_ = true;
};

// What stands in a frame, from docs/bus.md.

float between(std::uint32_t raw, std::uint32_t steps, float most) {
  return static_cast<float>(raw) * (2.0f * most) / static_cast<float>(steps) + -most;
}
control::JointReading reading(const bus::Frame& f) {
  const auto b = [&](std::size_t i) { return static_cast<std::uint32_t>(f.data[i]); };
  const std::uint32_t rate = b(3) << 4 | b(4) >> 4;
  return {between(b(1) << 8 | b(2), 65535, 3.2f),
          rate == 0x7ff || rate == 0x800 ? 0.0f : between(rate, 4095, 20.0f),
          between((b(4) & 15u) << 8 | b(5), 4095, 220.0f)};
}
std::uint64_t bits(const bus::Frame& f) {
  std::uint64_t all = 0;
  std::memcpy(&all, f.data.data(), sizeof all);
  return all;
}
float number(const bus::Frame& f, int start, int width, float counts) {
  const auto raw = static_cast<std::int64_t>(bits(f) << (64 - start - width)) >> (64 - width);
  return static_cast<float>(raw) / counts;
}

/// The sample that a tick's frames make of the last one.
void take(control::WalkerSample& sample, const std::array<std::vector<bus::Frame>, kBuses>& frames) {
  sample.answered = 0;
  for (std::size_t bus = 0; bus < 2; ++bus)
    for (const bus::Frame& f : frames[bus]) {
      const std::size_t joint = f.data[0] - 1u;  // ids 1 to 12
      sample.joints[joint] = reading(f);
      sample.answered |= 1u << joint;
    }
  for (const bus::Frame& f : frames[2]) {
    if (f.id == 0x541)
      sample.gyro_radps = {number(f, 16, 16, 2000.0f), number(f, 32, 16, 2000.0f),
                           number(f, 48, 16, 2000.0f)};
    if (f.id == 0x561) {
      sample.acc_mps2 = {number(f, 24, 13, 25.0f), number(f, 37, 13, 25.0f), number(f, 50, 13, 25.0f)};
      sample.answered |= 1u << control::kImuDevice;
    }
    if (f.id == 0x581) {
      const auto force = [&](int start) { return static_cast<float>(bits(f) >> start & 0xffffu) / 10.0f; };
      sample.foot_n = {force(24), force(40)};
      sample.answered |= 1u << control::kFeetDevice;
    }
    if (f.id == 0x5a1) {
      for (int pin = 0; pin < 4; ++pin)
        sample.pins[static_cast<std::size_t>(pin)] = number(f, 24 + 8 * pin, 8, 100.0f);
      sample.answered |= 1u << control::kPinsDevice;
    }
  }
}

bool is_exit(const bus::Frame& f) { return f.data[7] == 0xfd && f.data[0] == 0xff && f.data[6] == 0xff; }
bool is_enter(const bus::Frame& f) { return f.data[7] == 0xfc && f.data[0] == 0xff && f.data[6] == 0xff; }

}  // namespace

TEST_CASE(
    "10 s of a biped's walk over three buses: it stands, and each command is that of a controller that got "
    "the frames' numbers") {
  for (const char* mode : {"active", "semi_passive"}) {
    Robot robot(robot_of(mode));
    control::WalkerState beside = control::begin_walker(robot.controller);
    control::WalkerSample sample;
    std::size_t compared = 0, differing = 0, entered = 0, odd = 0;
    int running = 0;
    INFO(mode);
    for (int i = 0; i < 10500; ++i) {
      if (i == 200) robot.say(Host::Request::hop);
      robot.tick();
      take(sample, robot.heard);
      control::WalkerInputs in;
      in.sample = sample;
      in.tick_interval_us = 1000;
      running = robot.node.state() == bus::NodeState::running ? running + 1 : 0;
      in.run = running > 6;  // each drive is told three times to switch on, in every second tick
      in.reset = robot.was == bus::NodeState::starting;
      const control::WalkerOutputs told = control::step_walker(robot.controller, beside, in, 1e-3f);
      REQUIRE(told.fault == robot.node.outputs().fault);
      REQUIRE(told.stage == robot.node.outputs().stage);
      for (std::size_t bus = 0; bus < 2; ++bus) {
        if (robot.out[bus].size() != 3) ++odd;
        for (const bus::Frame& f : robot.out[bus]) {
          const std::size_t joint = f.id - 1u;
          if (bus != joint / 6 || joint % 2 != static_cast<std::size_t>(i) % 2) ++odd;
          if (is_enter(f)) {
            ++entered;
            continue;
          }
          ++compared;
          if (running == 0) {
            if (!is_exit(f)) ++differing;
            continue;
          }
          const control::JointCommand& c = told.joints[joint];
          const auto wanted =
              bus::pack(bus::MotorCommand{c.target_rad, 0.0f, c.stiffness_nmprad, c.damping_nmsprad, 0.0f},
                        bus::Motor::biped_joint, static_cast<std::uint8_t>(f.id));
          if (!(wanted.value() == f)) ++differing;
        }
      }
    }
    CHECK(odd == 0);
    CHECK(differing == 0);
    CHECK(entered == 36);  // each drive three times
    CHECK(compared == 63000 - 36);
    CHECK(robot.node.outputs().fault == Fault::none);
    CHECK(robot.node.outputs().stage == WalkerStage::walking);
    CHECK(robot.node.outputs().phase == control::WalkPhase::stop);
    CHECK(robot.devices.rig().state().position_m.z > 0.9);
    CHECK(robot.devices.rig().state().position_m.x > 0.5);
    CHECK(robot.figures.can_refused.load() == 0);
    CHECK(robot.board.link().statistics().foreign == 0);
  }
}

namespace {

/// Walks of 10 s with sensors that err by each of the seeds. Who falls is found to fall. @returns how many do.
int walk_without_an_alarm(std::uint64_t first, std::uint64_t last) {
  int falls = 0;
  for (const char* mode : {"active", "semi_passive"})
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      Robot robot(robot_of(mode, seed));
      INFO(mode << ", seed " << seed);
      robot.walk();
      while (robot.ticks < 10500 && robot.node.outputs().fault == Fault::none) robot.tick();
      INFO("at " << robot.devices.rig().time_s() << " s, joint " << robot.node.outputs().suspect);
      const bool fell = robot.node.outputs().fault == Fault::falling;
      falls += fell ? 1 : 0;
      CHECK((fell || robot.node.outputs().fault == Fault::none));
      CHECK((fell || robot.devices.rig().state().position_m.z > 0.9));
    }
  return falls;
}

}  // namespace

TEST_CASE("no fault is found over three buses where nothing is broken") {
  CHECK(walk_without_an_alarm(2, 2) == 0);
}

// For docs/linux_board.md: test_linux_sbc_walker "[long]".
TEST_CASE("128 walks over three buses: no false alarm, and two fall at most", "[.][long]") {
  CHECK(walk_without_an_alarm(1, 64) <= 2);
}

namespace {

struct Trial {
  Fault found = Fault::none;
  std::uint32_t suspect = control::kNoJoint;
  std::uint32_t after_ticks = 0;  ///< that had the fault, before the one on which it was found
  double work_after_j = 0.0;      ///< positive, from when each drive has had its turn
  double torque_after_nm = 0.0;
};

/// Until half a second after a fault is found, or for 5 s.
Trial until_found(Robot& robot) {
  Trial t;
  double work_j = 0.0;
  int faulty = 0;
  for (int i = 0; i < 5000 && faulty < 500; ++i) {
    if (robot.devices.rig().broken() && faulty == 0) ++t.after_ticks;
    robot.tick();
    if (robot.node.outputs().fault == Fault::none) continue;
    if (faulty++ == 0) {
      t.found = robot.node.outputs().fault;
      t.suspect = robot.node.outputs().suspect;
      --t.after_ticks;
    }
    if (faulty == 3) work_j = robot.devices.rig().positive_work_j();
    if (faulty > 3) t.torque_after_nm = std::max(t.torque_after_nm, robot.devices.rig().largest_torque_nm());
  }
  t.work_after_j = robot.devices.rig().positive_work_j() - work_j;
  return t;
}

}  // namespace

TEST_CASE(
    "what breaks in a walking robot is found over its buses a few ticks later at most, and its drives only brake") {
  // Drives answer in every second tick, a tick after they are asked, and one lost answer is bridged.
  constexpr std::uint32_t kLater = 4;
  using walk::WalkerFault;
  for (const walk::WalkerFaultRow& row : walk::walker_fault_rows()) {
    // No frame has a number that is none, and no bus makes a tick late.
    if (row.breaks == WalkerFault::encoder_lost || row.breaks == WalkerFault::late_tick) continue;
    // The instants of a stride in turn, one a joint.
    const std::vector<walk::WalkerRigConfig> trials = walk::trials_of(row, robot_of());
    for (std::size_t k = 0; k < row.joints.size(); ++k) {
      walk::WalkerRigConfig config = trials[k % 4 * row.joints.size() + k];
      if (!row.from_start) config.fault_s += 0.2;
      Robot robot(config);
      robot.tick(200);
      robot.say(Host::Request::hop);
      const Trial t = until_found(robot);
      INFO(row.name << " at " << config.fault_s << " s, joint " << config.joint << ": found "
                    << control::info(t.found).name << " after " << t.after_ticks << ", joint " << t.suspect);
      // An IMU whose number is none says that it has no signal.
      const bool fits = row.breaks == WalkerFault::imu_no_number
                            ? t.found == Fault::peer_lost
                            : std::find(row.finds.begin(), row.finds.end(), t.found) != row.finds.end();
      CHECK(fits);
      const std::uint32_t switched_on = row.from_start ? 6 : 0;
      CHECK(t.after_ticks <= row.within_ticks + kLater + switched_on);
      if (row.joints.size() > 1) CHECK(t.suspect == config.joint);
      CHECK(robot.node.state() == bus::NodeState::fault);
      CHECK(t.work_after_j == 0.0);
      CHECK(t.torque_after_nm < 1.1 * 80.0);
    }
  }
}

TEST_CASE("a drive that is lost is switched off, and the others are told to brake in their next turn") {
  walk::WalkerRigConfig config = robot_of();
  config.fault = walk::WalkerFault::drive_silent;
  config.joint = dynamics::biped::kKnee;
  config.fault_s = 2.0;
  Robot robot(config);
  robot.walk();
  while (robot.node.outputs().fault == Fault::none && robot.ticks < 4000) robot.tick();
  REQUIRE(robot.node.outputs().fault == Fault::drive_silent);
  CHECK(robot.devices.rig().time_s() - 2.0 <= 0.0055);
  std::array<int, control::kWalkerJoints> braked{};
  for (int i = 0; i < 2; ++i) {
    for (std::size_t bus = 0; bus < 2; ++bus)
      for (const bus::Frame& f : robot.out[bus]) {
        const std::size_t joint = f.id - 1u;
        if (joint == config.joint) {
          CHECK(is_exit(f));
          continue;
        }
        // Stiffness and torque are zero: 0 of 4095, and 7FF, in the packing of docs/bus.md.
        CHECK((f.data[3] & 15u) == 0);
        CHECK(f.data[4] == 0);
        CHECK(((f.data[6] & 15u) << 8 | f.data[7]) == 0x7ff);
        CHECK((f.data[5] << 4 | f.data[6] >> 4) > 0);  // damping
        ++braked[joint];
      }
    robot.tick();
  }
  for (std::size_t joint = 0; joint < braked.size(); ++joint)
    CHECK(braked[joint] == (joint == config.joint ? 0 : 1));
  CHECK_FALSE(robot.devices.on(config.joint));
  CHECK(robot.devices.on(0));
}

TEST_CASE("a bus that goes off, one that is cut, and one with a stranger on it are each found") {
  SECTION("off the bus: its controller says so, and the fault stays until a reset when it is back") {
    const std::size_t bus = GENERATE(0u, 1u, 2u);
    Robot robot(robot_of());
    robot.walk();
    robot.wires[bus].say(CAN_ERR_BUSOFF);
    robot.tick();
    CHECK(robot.node.outputs().fault == Fault::bus_off);
    CHECK(robot.node.state() == bus::NodeState::fault);
    CHECK(robot.figures.can_states[bus].load() == socketcan::CanState::off);
    robot.wires[bus].say(CAN_ERR_RESTARTED);
    robot.tick(20);
    CHECK(robot.figures.can_states[bus].load() == socketcan::CanState::on);
    CHECK(robot.node.outputs().fault == Fault::bus_off);
  }
  SECTION("a leg's bus that is cut: a drive of that leg is silent") {
    const std::size_t bus = GENERATE(0u, 1u);
    Robot robot(robot_of());
    robot.walk();
    robot.tick(500);
    robot.cut[bus] = true;
    int after = 0;
    while (robot.node.outputs().fault == Fault::none && after < 100) robot.tick(), ++after;
    CHECK(robot.node.outputs().fault == Fault::drive_silent);
    CHECK(robot.node.outputs().suspect / 6 == bus);
    CHECK(after <= 4);
  }
  SECTION("the body's bus that is cut: peers are lost") {
    Robot robot(robot_of());
    robot.walk();
    robot.cut[2] = true;
    robot.tick(4);
    CHECK(robot.node.outputs().fault == Fault::peer_lost);
  }
  SECTION("another controller that commands a drive") {
    Robot robot(robot_of());
    robot.walk();
    robot.tick(7);
    const auto frame = bus::pack(bus::MotorCommand{}, bus::Motor::biped_joint, 4);
    robot.send(0, frame.value());
    robot.tick();
    CHECK(robot.node.outputs().fault == Fault::node_id_taken);
  }
}

TEST_CASE("samples of the body that are lost, too old or without their other half did not answer") {
  Robot robot(robot_of());
  robot.walk();
  SECTION("older than 5 ms when they are sent") { robot.devices.set_age(0.006f); }
  SECTION("no feet") { robot.body_lost = 0x581; }
  SECTION("no pins") { robot.body_lost = 0x5a1; }
  SECTION("no angular rates") { robot.body_lost = 0x541; }
  SECTION("no accelerations") { robot.body_lost = 0x561; }
  robot.tick(3);  // one sample that is lost is bridged, as of a drive in two buses
  CHECK(robot.node.outputs().fault == Fault::none);
  robot.tick();
  CHECK(robot.node.outputs().fault == Fault::peer_lost);
  CHECK(robot.node.outputs().stage == WalkerStage::damped);
}

TEST_CASE("who stops has the drives off at once, and a host that falls silent has them brake") {
  Robot robot(robot_of());
  robot.walk();
  robot.tick(100);
  SECTION("stop") {
    robot.say(Host::Request::stop);
    robot.tick(12);
    CHECK(robot.node.outputs().fault == Fault::none);
    CHECK(robot.node.state() == bus::NodeState::idle);
    for (std::size_t i = 0; i < control::kWalkerJoints; ++i) CHECK_FALSE(robot.devices.on(i));
  }
  SECTION("silence") {
    robot.fall_silent();
    robot.tick(99 - 10);
    CHECK(robot.node.outputs().fault == Fault::none);
    robot.tick(13);
    CHECK(robot.node.outputs().fault == Fault::peer_lost);
    CHECK(robot.node.outputs().stage == WalkerStage::damped);
    for (std::size_t i = 0; i < control::kWalkerJoints; ++i) CHECK(robot.devices.on(i));
  }
}

TEST_CASE("a robot whose devices do not all answer is in its fault after a second, with its drives off") {
  Robot robot(robot_of());
  robot.body_lost = 0x581;
  robot.tick(900);
  CHECK(robot.node.state() == bus::NodeState::starting);
  robot.say(Host::Request::hop);
  robot.tick(300);
  CHECK(robot.node.state() == bus::NodeState::fault);
  CHECK(robot.node.outputs().fault == Fault::peer_lost);
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i) CHECK_FALSE(robot.devices.on(i));
  // Well again: nothing before a reset and a hop that is said anew.
  robot.body_lost = 0;
  robot.tick(300);
  CHECK(robot.node.state() == bus::NodeState::fault);
}

TEST_CASE("furculad logs each walk from its first tick to its end, as a file that is whole") {
  const test::Folder folder;
  std::string said;
  linux_sbc::WalkRecorder recorder(folder.file("") + "walks", 100,
                                   [&](const std::string& line) { said += line + "\n"; });
  Robot robot(robot_of());
  robot.recorder = &recorder;
  robot.walk();
  // Of the first tick of a row, as the node had it.
  const auto first = robot.node.walker().last;
  const auto told = robot.node.outputs();
  robot.tick(1999);
  const auto last = robot.node.walker().last;
  robot.tick(1);
  CHECK(robot.node.walker().last.joints[3].angle_rad != last.joints[3].angle_rad);
  robot.say(Host::Request::stop);
  robot.tick(50);
  REQUIRE(robot.node.outputs().stage == WalkerStage::idle);
  // The file is whole as soon as the walk has ended, while furculad goes on.
  std::thread writer([&] { recorder.serve(); });
  for (int k = 0; k < 1000 && !std::filesystem::exists(folder.file("") + "walks/walk_1.csv"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(std::filesystem::exists(folder.file("") + "walks/walk_1.csv"));
  // It hangs in its posture again, and walks for a moment.
  Robot again(robot_of());
  again.recorder = &recorder;
  again.walk();
  again.tick(100);
  recorder.stop();
  writer.join();
  CHECK(said == folder.file("") + "walks/walk_1.csv has the walk\n" + folder.file("") +
                    "walks/walk_2.csv has the walk\n");
  CHECK_FALSE(std::filesystem::exists(folder.file("") + "walks/walk_1.csv.part"));
  const log::Log log = log::read_log(folder.file("") + "walks/walk_1.csv", "tree");
  const auto& time = log.columns.at("time_s");
  // `stop` is heard at the next of the host's frames, 10 ms apart.
  REQUIRE(time.size() >= 200);
  CHECK(time.size() <= 203);
  for (std::size_t k = 0; k < time.size(); ++k)
    CHECK(time[k] == Approx(0.01 * static_cast<double>(k)).margin(1e-9));
  for (std::size_t i = 0; i < control::kWalkerJoints; ++i) {
    const std::string name = walk::joint_name(i);
    CHECK(log.columns.at("angle_" + name + "_rad")[0] == Approx(first.joints[i].angle_rad));
    CHECK(log.columns.at("angle_cmd_" + name + "_rad")[0] == Approx(told.joints[i].target_rad));
    CHECK(log.columns.at("torque_" + name + "_nm")[0] == Approx(first.joints[i].torque_nm));
  }
  CHECK(log.columns.at("acc_z_mps2")[0] == Approx(first.acc_mps2.z));
  CHECK(log.columns.at("contact_left_foot")[0] == 1.0);
  CHECK(log.columns.size() == walk::kBoardColumns);
  CHECK(log::read_log(folder.file("") + "walks/walk_2.csv", "tree").columns.at("time_s").size() == 11);
  // The next furculad goes on with the next number.
  linux_sbc::WalkRecorder next(folder.file("") + "walks", 1000,
                               [&](const std::string& line) { said = line; });
  Robot third(robot_of());
  third.recorder = &next;
  third.walk();
  third.tick(2000);  // nobody has written: there is place for 1024 rows
  next.stop();
  next.serve();
  CHECK_THAT(said, Catch::Contains("walk_3.csv has the walk"));
  CHECK(log::read_log(folder.file("") + "walks/walk_3.csv", "tree").columns.at("time_s").size() == 1024);
}

TEST_CASE("a walk that cannot be written is said, and the robot goes on") {
  const test::Folder folder;
  std::string said;
  linux_sbc::WalkRecorder recorder(folder.file("") + "walks", 100,
                                   [&](const std::string& line) { said += line + "\n"; });
  std::filesystem::remove_all(folder.file("") + "walks");
  Robot robot(robot_of());
  robot.recorder = &recorder;
  robot.walk();
  robot.tick(200);
  recorder.stop();
  recorder.serve();
  CHECK_THAT(said,
             Catch::Contains(
                 "walk_1.csv.part cannot be written: No such file or directory; this walk is not logged"));
  CHECK(robot.node.outputs().stage == WalkerStage::walking);
  std::ofstream(folder.file("") + "file") << "no folder";
  CHECK_THROWS_WITH(linux_sbc::WalkRecorder(folder.file("") + "file", 100, [](const std::string&) {}),
                    Catch::Contains("[log] folder " + folder.file("") + "file: ") &&
                        Catch::Contains("expected a folder to write walks to"));
}

TEST_CASE("a thousand ticks of a walk take nothing from the heap, its log included") {
#ifndef FURCULA_COUNTS_ALLOCATIONS
  WARN("not counted under a sanitizer");
#else
  const test::Folder folder;
  linux_sbc::WalkRecorder recorder(folder.file(""), 1000, [](const std::string&) {});
  Robot robot(robot_of());
  robot.recorder = &recorder;
  robot.walk();
  unsigned long taken = 0;
  for (int i = 0; i < 1000; ++i) {
    robot.before();
    const unsigned long before = furcula_allocations();
    robot.loop();
    taken += furcula_allocations() - before;
    robot.after();
  }
  CHECK(robot.node.outputs().stage == WalkerStage::walking);
  CHECK(taken == 0);
  CHECK(furcula_allocations() > 0);  // the counter counts
#endif
}
