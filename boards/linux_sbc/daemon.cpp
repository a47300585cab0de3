// furculad, see daemon.hpp. Threads: the loop, which alone touches robot and node; of a hopper the server of
// Modbus and the writer of parameters, of a biped the writer of walks' logs; and the first one, which waits for signals and speaks with the
// service manager.
#include "boards/linux_sbc/daemon.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <span>
#include <sstream>
#include <string>

#include "boards/linux_sbc/board.hpp"
#include "boards/linux_sbc/loop.hpp"
#include "boards/linux_sbc/mailbox.hpp"
#include "boards/linux_sbc/notify.hpp"
#include "boards/linux_sbc/parameter_writer.hpp"
#include "boards/linux_sbc/realtime.hpp"
#include "boards/linux_sbc/say.hpp"
#include "boards/linux_sbc/signals.hpp"
#include "boards/linux_sbc/walker_board.hpp"
#include "firmware/app/node.hpp"
#include "firmware/app/node_registers.hpp"
#include "firmware/app/walker_node.hpp"
#include "host/core/message.hpp"
#include "host/core/own_build.hpp"
#include "host/core/parameter_file.hpp"
#include "host/modbus/tcp_server.hpp"

/// Of this process so far, where a program that counts them is linked (tests/hil/allocations.cpp).
extern "C" __attribute__((weak)) unsigned long furcula_allocations();

namespace furcula::linux_sbc {
namespace {

using Store = ParameterWriter<core::ParameterFile>;
using Node = firmware::Node<Board, Store>;
static_assert(firmware::SavesAside<Store>);

constexpr std::uint64_t kSettledTicks =
    100;  ///< until READY=1: the loop runs, and all that it needs is in memory

/// What furculad has of any robot. A robot has besides `board`, tick() after the board's wait_for_tick(), and switch_off(), which
/// tells its drives so.
struct Common {
  explicit Common(int its_priority) : identity(own_identity(text)), priority(its_priority) { faults.begin(); }

  std::atomic<bool> stop{false};
  LoopFigures figures;
  std::string text;
  bus::Identity identity;
  firmware::FaultLog faults{};
  int priority;
  std::string warning;  ///< of the loop's thread; written before its first tick
};

struct Hopper : Common {
  static constexpr int kSwitchOffTicks = 5;
  Hopper(const Configuration& configuration, socketcan::CanSocket& can, Gpio& gpio)
      : Common(configuration.priority),
        board(configuration, can, gpio, stop, figures),
        store(configuration.store_file),
        node(board, store, configuration.controller, identity,
             static_cast<std::uint16_t>(core::monotonic_ns() / 1000), faults),
        registers(node) {
    board.introduce(identity, faults);
    if (node.snapshot().parameter_origin == static_cast<std::uint16_t>(bus::ParameterOrigin::store_unusable))
      board.report_start_fault(control::Fault::parameters_lost);
  }
  void tick() { run_tick(board, node, registers, mailbox); }
  void switch_off() {
    board.set_state(bus::NodeState::idle);
    static_cast<void>(board.actuate(control::Command{}));
  }

  Board board;
  Store store;
  Node node;
  firmware::NodeRegisters<Node> registers;
  Mailbox mailbox;
  std::unique_ptr<modbus::TcpServer> server;
};

struct Walker : Common {
  static constexpr int kSwitchOffTicks = 10;  // each drive has its turn in every second one
  Walker(const Configuration& configuration, const std::array<socketcan::CanSocket*, kMostBuses>& buses)
      : Common(configuration.priority),
        board(configuration.walker->link, buses, stop, figures),
        node(board, configuration.walker->controller, faults) {
    board.introduce(identity, faults);
    if (const std::string& folder = configuration.walker->log_folder; !folder.empty())
      recorder = std::make_unique<WalkRecorder>(
          folder, configuration.walker->log_rate_hz, [](const std::string& line) {
            static_cast<void>(say(STDOUT_FILENO, "furculad: " + core::printable_lines(line) + "\n"));
          });
  }
  void tick() { run_walker_tick(board, node, recorder.get()); }
  void switch_off() {
    board.set_state(bus::NodeState::idle);
    board.actuate(control::WalkerOutputs{});
  }

  WalkerBoard board;
  firmware::WalkerNode<WalkerBoard> node;
  std::unique_ptr<WalkRecorder> recorder;  ///< where walks are logged
};

template <class Robot>
void* run_loop(void* argument) {
  Robot& robot = *static_cast<Robot*>(argument);
  touch_stack();
  if (robot.priority > 0) robot.warning = run_first_in_first_out(robot.priority);
  while (robot.board.wait_for_tick()) robot.tick();
  // Said several times: one frame may be lost.
  for (int i = 0; i < Robot::kSwitchOffTicks; ++i) {
    robot.switch_off();
    static_cast<void>(robot.board.wait_for_tick());
  }
  return nullptr;
}

void* run_server(void* argument) {
  Hopper& d = *static_cast<Hopper*>(argument);
  touch_stack();
  d.server->serve();
  return nullptr;
}

void* run_writer(void* argument) {
  Hopper& d = *static_cast<Hopper*>(argument);
  touch_stack();
  d.store.serve();
  return nullptr;
}

void* run_recorder(void* argument) {
  touch_stack();
  static_cast<WalkRecorder*>(argument)->serve();
  return nullptr;
}

struct Baseline {
  rusage usage{};
  unsigned long allocations = 0;
};

Baseline now() {
  Baseline b;
  ::getrusage(RUSAGE_SELF, &b.usage);
  if (furcula_allocations != nullptr) b.allocations = furcula_allocations();
  return b;
}

void print_figures(const LoopFigures& figures, const Baseline& begin) {
  const Baseline end = now();
  std::ostringstream out;
  out << "furculad: " << figures.ticks.load() << " ticks, " << figures.overruns.load()
      << " missed; CAN: " << figures.can_refused.load() << " sends refused, " << figures.can_errors.load()
      << " error frames; switch: " << figures.edges.load() << " edges\n"
      << figures.lateness.text("a tick begins late by") << figures.work.text("a tick's own work")
      << "since the start: " << end.usage.ru_minflt - begin.usage.ru_minflt << " page faults, "
      << end.usage.ru_majflt - begin.usage.ru_majflt << " from disk";
  if (furcula_allocations != nullptr) out << "; " << end.allocations - begin.allocations << " allocations";
  out << "\n";
  static_cast<void>(say(STDOUT_FILENO, out.str()));
}

void warn(const std::string& message) {
  if (!message.empty())
    static_cast<void>(say(STDERR_FILENO, "furculad: warning: " + core::printable_lines(message) + "\n"));
}

/// What a person has to know of the bus, once.
std::string told_of_bus(socketcan::CanState state, const std::string& interface) {
  const std::string begin = "furculad: " + interface;
  switch (state) {
    case socketcan::CanState::on:
      return begin + " is back on the bus; the fault stays until a reset\n";
    case socketcan::CanState::off:
      return begin + " went off the bus after too many errors: ip link set " + interface +
             " type can restart, or down and up; then reset\n";
    case socketcan::CanState::down:
      return begin + " is down: ip link set " + interface + " up type can bitrate 1000000; then reset\n";
    default:
      return begin + " is gone: it is looked for until it is there again; then reset\n";
  }
}

/// Waits for signals; the watchdog of the service manager hears of a loop that ticks, and of no other.
void watch(const Common& d, std::span<const std::string> interfaces, const ServiceManager& manager,
           const Signals& signals, const Baseline& begin) {
  std::chrono::nanoseconds pause = std::chrono::milliseconds(100);
  if (manager.watchdog_period().count() > 0)
    pause = std::min<std::chrono::nanoseconds>(pause, manager.watchdog_period());
  const timespec wait{0, static_cast<long>(pause.count())};
  std::uint64_t seen = 0;
  std::array<socketcan::CanState, kMostBuses> told{};
  for (;;) {
    const Signals::Asks asks = signals.wait(wait);
    if (asks == Signals::Asks::end) return;
    if (asks == Signals::Asks::figures) print_figures(d.figures, begin);
    for (std::size_t bus = 0; bus < interfaces.size(); ++bus)
      if (const socketcan::CanState state = d.figures.can_states[bus].load(std::memory_order_relaxed);
          state != told[bus]) {
        static_cast<void>(say(STDERR_FILENO, told_of_bus(state, core::printable(interfaces[bus]))));
        told[bus] = state;
      }
    const std::uint64_t ticks = d.figures.ticks.load(std::memory_order_relaxed);
    if (ticks != seen) manager.tell("WATCHDOG=1");
    seen = ticks;
  }
}

/// The loop's thread, from its start to its end on a signal.
template <class Robot>
void run_robot(Robot& robot, std::span<const std::string> interfaces, const Signals& signals) {
  const ServiceManager manager;
  warn(lock_memory());
  const unsigned long loop = start_thread(run_loop<Robot>, &robot);
  touch_stack();
  while (robot.figures.ticks.load() < kSettledTicks) {
    const timespec pause{0, 1'000'000};
    ::nanosleep(&pause, nullptr);
  }
  warn(robot.warning);
  std::string all;
  for (const std::string& interface : interfaces)
    all += (all.empty() ? "" : ", ") + core::printable(interface);
  static_cast<void>(say(STDOUT_FILENO, "furculad: running on " + all + "\n"));
  manager.tell("READY=1");
  const Baseline begin = now();
  watch(robot, interfaces, manager, signals, begin);
  manager.tell("STOPPING=1");
  robot.stop = true;
  ::pthread_join(loop, nullptr);
  print_figures(robot.figures, begin);
}

void run_hopper(const Configuration& configuration, const Signals& signals) {
  const firmware::HeardIds ids(configuration.link);
  socketcan::CanSocket can(configuration.can_interface, ids);
  Gpio gpio(configuration.contact, configuration.has_solenoid ? &configuration.solenoid : nullptr);
  const auto hopper = std::make_unique<Hopper>(configuration, can, gpio);
  if (configuration.modbus)
    hopper->server = std::make_unique<modbus::TcpServer>(
        configuration.modbus_address, configuration.modbus_port,
        [&mailbox = hopper->mailbox](std::span<const std::uint8_t> request) { return mailbox.ask(request); });
  warn(network_warning(configuration));
  const unsigned long writer = start_thread(run_writer, hopper.get());
  unsigned long server = 0;
  if (hopper->server) server = start_thread(run_server, hopper.get());
  run_robot(*hopper, std::span(&configuration.can_interface, 1), signals);
  if (hopper->server) {
    hopper->server->stop();
    ::pthread_join(server, nullptr);
  }
  hopper->store.stop();
  ::pthread_join(writer, nullptr);
}

void run_walker(const Configuration& configuration, const Signals& signals) {
  const WalkerConfiguration& walker = *configuration.walker;
  const auto opened = [&](std::size_t bus) {
    const firmware::WalkerHeardIds ids(walker.link, bus);
    return std::make_unique<socketcan::CanSocket>(walker.can_interfaces[bus], ids);
  };
  const auto left = opened(0), right = opened(1), body = opened(firmware::kBodyBus);
  const auto robot = std::make_unique<Walker>(configuration, std::array{left.get(), right.get(), body.get()});
  unsigned long recorder = 0;
  if (robot->recorder) recorder = start_thread(run_recorder, robot->recorder.get());
  run_robot(*robot, walker.can_interfaces, signals);
  if (!robot->recorder) return;
  robot->recorder->stop();
  ::pthread_join(recorder, nullptr);
}

}  // namespace

bus::Identity own_identity(std::string& text) {
  const std::uint32_t build_id = core::own_build_id();
  text = "furculad " FURCULA_VERSION " build " + core::hexadecimal(build_id);
  return {.board = "linux_sbc",
          .text = text,
          .firmware_version =
              bus::version_number(FURCULA_VERSION_MAJOR, FURCULA_VERSION_MINOR, FURCULA_VERSION_PATCH),
          .build_id = build_id};
}

void run_daemon(const Configuration& configuration) {
  const Signals signals;  // the other threads inherit that
  if (configuration.walker)
    run_walker(configuration, signals);
  else
    run_hopper(configuration, signals);
}

}  // namespace furcula::linux_sbc
