// Saving beside the loop: a disk that takes its time makes no tick late, and what came of it is told.
#include "boards/linux_sbc/parameter_writer.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <thread>

#include "boards/linux_sbc/loop.hpp"
#include "boards/linux_sbc/mailbox.hpp"
#include "boards/linux_sbc/say.hpp"
#include "boards/linux_sbc/signals.hpp"
#include "firmware/app/node.hpp"
#include "firmware/app/node_registers.hpp"
#include "host/modbus/client.hpp"
#include "host/modbus/tcp_server.hpp"
#include "host/rig/peers.hpp"
#include "tests/boards/linux_sbc/doubles.hpp"

#ifdef FURCULA_COUNTS_ALLOCATIONS
extern "C" unsigned long furcula_allocations();
#endif

using namespace furcula;
using namespace furcula::test;
using Catch::Contains;

namespace {

/// A disk whose write ends when the test says so.
struct Disk {
  std::atomic<int> begun{0}, allowed{0};
  std::atomic<bool> fails{false};
  std::array<std::uint8_t, bus::kImageBytesMax> written{};
  std::size_t size = 0;
};
Disk* the_disk = nullptr;

class SlowFile {
 public:
  explicit SlowFile(const std::string&) {}
  static Result<std::size_t> load(std::span<std::uint8_t>) { return std::size_t{0}; }
  static Status save(std::span<const std::uint8_t> image) {
    const int number = ++the_disk->begun;
    while (the_disk->allowed < number) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (the_disk->fails) return Status::disconnected;
    std::copy(image.begin(), image.end(), the_disk->written.begin());
    the_disk->size = image.size();
    return Status::ok;
  }
};

using Writer = linux_sbc::ParameterWriter<SlowFile>;
static_assert(firmware::SavesAside<Writer>);
static_assert(!firmware::SavesAside<core::ParameterFile>);
using Node = firmware::Node<QuietBoardInTime, Writer>;

/// furculad's loop on doubles, tick by tick.
struct Robot {
  /// A machine with other things to do makes ticks late: that is not looked at here.
  static control::Config patient() {
    control::Config config;
    config.supervisor.tick_interval_max_us = 100'000'000;
    config.supervisor.sample_age_max_us = 100'000'000;
    return config;
  }
  static linux_sbc::Configuration wiring() {
    linux_sbc::Configuration c;
    c.home_count = 1000;
    c.home_height_m = 0.28f;
    c.link.silent_us = 100'000'000;
    return c;
  }
  Robot() {
    the_disk = &disk;
    thread = std::thread([this] { writer.serve(); });
    faults.begin();
    lines.reading.closed = true;
    for (int i = 0; i < 3000 && node.state() != bus::NodeState::idle; ++i) tick();
  }
  ~Robot() {
    disk.allowed = 1000;
    writer.stop();
    thread.join();
  }
  void tick(int times = 1) {
    for (int i = 0; i < times; ++i) {
      if (const auto reply = drive.receive(bus::empty_frame(bus::message::kMotorExit, 1), 0.35f, 0.0f))
        can.arrive(*reply);
      can.arrive(encoder.sample(1000, 0, true));
      static_cast<void>(board.wait_for_tick());
      linux_sbc::run_tick(board, node, registers, mailbox);
    }
  }
  void finish_save(int number) {
    disk.allowed = number;
    while (writer.saved() == firmware::SaveProgress::under_way) std::this_thread::yield();
    tick();
  }
  bus::ParameterOrigin origin() const { return bus::ParameterOrigin(node.snapshot().parameter_origin); }

  Disk disk;
  linux_sbc::Configuration configuration = wiring();
  QuietBus can;
  QuietLines lines;
  std::atomic<bool> stop{false};
  linux_sbc::LoopFigures figures;
  rig::Drive drive;
  rig::EncoderNode encoder{1};
  QuietBoardInTime board{configuration, can, lines, stop, figures};
  Writer writer{""};
  std::thread thread;
  firmware::FaultLog faults{};
  Node node{board, writer, patient(), {}, 7, faults};
  firmware::NodeRegisters<Node> registers{node};
  linux_sbc::Mailbox mailbox;
};

/// A robot whose loop runs on a thread, and a host at its Modbus server.
struct ServedRobot : Robot {
  ServedRobot()
      : server("127.0.0.1", 0,
               [this](std::span<const std::uint8_t> request) { return mailbox.ask(request); }),
        client(modbus::parse_port("modbus:127.0.0.1:" + std::to_string(server.port()))) {}
  ~ServedRobot() {
    ended = true;
    loop.join();
  }
  std::atomic<bool> ended{false};
  std::thread loop{[this] {
    while (!ended) tick();
  }};
  modbus::TcpService server;
  modbus::Client client;
};

}  // namespace

TEST_CASE("a save takes none of the loop's time, however long the disk needs") {
  Robot robot;
  REQUIRE(robot.node.state() == bus::NodeState::idle);
#ifdef FURCULA_COUNTS_ALLOCATIONS
  const unsigned long before = furcula_allocations();
#endif
  const auto begin = std::chrono::steady_clock::now();
  CHECK(robot.node.request(bus::Request::save) == bus::Refusal::none);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  robot.tick(600);  // longer than the service's watchdog
#ifdef FURCULA_COUNTS_ALLOCATIONS
  CHECK(furcula_allocations() == before);
#endif
  CHECK(took_s < 0.1);
  CHECK(robot.node.is_saving());
  CHECK(robot.origin() == bus::ParameterOrigin::being_saved);
  CHECK(robot.node.state() == bus::NodeState::idle);
  CHECK(robot.disk.begun == 1);
  robot.finish_save(1);
  CHECK(robot.origin() == bus::ParameterOrigin::store);
  const bus::ParameterImage image = bus::to_image(robot.node.config());
  REQUIRE(robot.disk.size == image.size());
  CHECK(std::equal(image.begin(), image.end(), robot.disk.written.begin()));
}

TEST_CASE("a save that fails is told when it failed, and leaves what was said of the parameters") {
  Robot robot;
  robot.disk.fails = true;
  const std::uint32_t refused = robot.node.snapshot().requests_refused;
  REQUIRE(robot.node.request(bus::Request::save) == bus::Refusal::none);
  robot.tick(10);
  CHECK(robot.node.snapshot().requests_refused == refused);
  robot.finish_save(1);
  CHECK(robot.origin() == bus::ParameterOrigin::defaults);
  CHECK(robot.node.snapshot().requests_refused == refused + 1);
  CHECK(robot.node.snapshot().last_refusal == static_cast<int>(bus::Refusal::store_failed));
  // And the next one may succeed.
  robot.disk.fails = false;
  REQUIRE(robot.node.request(bus::Request::save) == bus::Refusal::none);
  robot.finish_save(2);
  CHECK(robot.origin() == bus::ParameterOrigin::store);
}

TEST_CASE("during a save a second one is refused, and what is changed is not said to be saved") {
  Robot robot;
  REQUIRE(robot.node.request(bus::Request::save) == bus::Refusal::none);
  CHECK(robot.node.request(bus::Request::save) == bus::Refusal::not_in_this_state);
  const bus::ParameterImage asked_for = bus::to_image(robot.node.config());
  control::Config changed = robot.node.config();
  changed.torque.amplitude_nm = 1.5f;
  REQUIRE(robot.node.configure(changed) == bus::Refusal::none);
  CHECK(robot.origin() == bus::ParameterOrigin::being_saved);
  robot.finish_save(1);
  CHECK(robot.origin() == bus::ParameterOrigin::changed);
  // Written was what was in use when it was asked for.
  REQUIRE(robot.disk.size == asked_for.size());
  CHECK(std::equal(asked_for.begin(), asked_for.end(), robot.disk.written.begin()));
  CHECK_FALSE(std::equal(asked_for.begin(), asked_for.end(), bus::to_image(changed).begin()));
}

TEST_CASE("a host that asks for a save is answered when it is done, and when it failed, others are served") {
  ServedRobot robot;
  std::atomic<bool> returned{false};
  std::thread host([&] {
    robot.client.request(bus::Request::save);
    returned = true;
  });
  while (robot.disk.begun < 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  // Longer than a Modbus master waits for one answer.
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(1200);
  modbus::Client other(modbus::parse_port("modbus:127.0.0.1:" + std::to_string(robot.server.port())));
  int served = 0;
  for (; std::chrono::steady_clock::now() < until; ++served) {
    CHECK(other.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::being_saved));
    other.request(bus::Request::stop);
  }
  CHECK(served > 10);
  CHECK_FALSE(returned);
  robot.disk.allowed = 1;
  host.join();
  CHECK(other.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store));

  // The parameters are as saved, and this save fails all the same.
  robot.disk.fails = true;
  robot.disk.allowed = 2;
  CHECK_THROWS_AS(robot.client.request(bus::Request::save), modbus::Refused);
  CHECK_THROWS_WITH((robot.disk.allowed = 3, robot.client.request(bus::Request::save)),
                    Contains("save: refused"));
}

TEST_CASE(
    "every signal that ends or stops a program ends furculad in order, and SIGUSR1 asks for its figures") {
  const linux_sbc::Signals signals;
  const timespec wait{0, 1'000'000};
  CHECK(signals.wait(wait) == linux_sbc::Signals::Asks::nothing);
  // signal(7): all whose action is to end or to stop, but for errors of the program itself, SIGKILL and SIGSTOP.
  for (const int signal :
       {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGQUIT, SIGTSTP, SIGTTIN, SIGTTOU, SIGUSR2, SIGALRM, SIGVTALRM,
        SIGPROF, SIGXCPU, SIGXFSZ, SIGPWR, SIGPOLL, SIGSTKFLT, SIGRTMIN, SIGRTMAX}) {
    INFO(signal);
    REQUIRE(::raise(signal) == 0);  // blocked: it waits to be fetched
    CHECK(signals.wait(wait) == linux_sbc::Signals::Asks::end);
  }
  REQUIRE(::raise(SIGUSR1) == 0);
  CHECK(signals.wait(wait) == linux_sbc::Signals::Asks::figures);
  // Written to a pipe that nobody reads.
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  ::close(ends[0]);
  CHECK(::write(ends[1], "x", 1) == -1);
  ::close(ends[1]);
  CHECK(signals.wait(wait) == linux_sbc::Signals::Asks::end);
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_UNBLOCK, &all, nullptr);
}

TEST_CASE("what nobody reads is lost, and nobody waits for it") {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const std::string text(4000, 'x');
  int said = 0;
  while (said < 100 && linux_sbc::say(ends[1], text)) ++said;
  CHECK(said >= 10);  // a pipe holds 64 KiB
  CHECK(said < 100);
  std::string read(4096, ' ');
  CHECK(::read(ends[0], read.data(), read.size()) == 4096);
  CHECK(linux_sbc::say(ends[1], "and once more"));
  ::close(ends[0]);
  ::close(ends[1]);
}
