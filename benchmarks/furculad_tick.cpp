// What a tick of furculad takes on this computer, in real time: its loop, node, CAN socket and mailbox, with a
// pair of local sockets in the place of the bus and a pipe in that of the switch's line. As many system calls
// a tick as on a robot; what is not in it are the kernel's CAN and GPIO layers and their drivers.
//   furculad_tick [SECONDS]
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "boards/linux_sbc/board.hpp"
#include "boards/linux_sbc/loop.hpp"
#include "boards/linux_sbc/mailbox.hpp"
#include "boards/linux_sbc/realtime.hpp"
#include "firmware/app/node.hpp"
#include "firmware/app/node_registers.hpp"
#include "host/core/parameter_file.hpp"
#include "host/rig/peers.hpp"

using namespace furcula;

namespace {

/// The switch's and the solenoid's lines with the system calls of gpio_v1.cpp: one a tick, one more where an
/// edge came, one where the solenoid switches.
class PipeLines {
 public:
  explicit PipeLines(int fd) : fd_(fd) {}
  linux_sbc::SwitchReading read_switch() {
    std::array<char, 16 * 48> events;
    const ssize_t n = ::read(fd_, events.data(), events.size());
    reading_.edges = n > 0 ? static_cast<std::uint32_t>(n) / 48 : 0;
    int left = 0;
    if (n > 0) static_cast<void>(::ioctl(fd_, FIONREAD, &left));
    edges += reading_.edges;
    return reading_;
  }
  bool set_solenoid(bool on) {
    int left = 0;
    if (on != on_) static_cast<void>(::ioctl(fd_, FIONREAD, &left));
    on_ = on;
    return true;
  }
  std::uint64_t edges = 0;

 private:
  int fd_;
  bool on_ = false;
  linux_sbc::SwitchReading reading_{.closed = true};
};

using Board = linux_sbc::LinuxBoard<socketcan::CanSocket, PipeLines>;
using Node = firmware::Node<Board, core::ParameterFile>;

struct Stand {
  Stand() {
    if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, bus) != 0 ||
        ::pipe2(line, O_NONBLOCK | O_CLOEXEC) != 0)
      std::exit(4);
    const int on = 1;
    ::setsockopt(bus[0], SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
    configuration.home_count = 1000;
    configuration.home_height_m = 0.28f;
    configuration.controller.torque = {control::ProfileShape::harmonic, 2.0f, 0.3f};
    // This computer may do other things besides: a late tick or a drive without its turn is not what is
    // measured here.
    configuration.controller.supervisor.tick_interval_max_us = 100'000;
    configuration.controller.supervisor.sample_age_max_us = 100'000;
    configuration.link.silent_us = 100'000;
  }

  int bus[2] = {-1, -1}, line[2] = {-1, -1};
  linux_sbc::Configuration configuration;
  std::atomic<bool> stop{false}, quiet{false};
  linux_sbc::LoopFigures figures;
  linux_sbc::Mailbox mailbox;
};

/// Drive and encoder of a robot that stands: they answer each tick. Every 50 ms the switch bounces.
void play_devices(Stand& stand, int priority) {
  static_cast<void>(linux_sbc::run_first_in_first_out(priority));
  socketcan::CanSocket can(stand.bus[1]);
  rig::Drive drive;
  rig::EncoderNode encoder(rig::kHeightNode);
  core::Timer timer(1'000'000);
  timer.start();
  const std::array<char, 2 * 48> bounce{};
  for (int tick = 0; !stand.quiet; ++tick) {
    static_cast<void>(timer.wait());
    std::array<bus::Frame, 2> out{encoder.sample(1000, 0, true)};
    std::size_t size = 1;
    for (const socketcan::Received& r : can.receive())
      if (const auto reply = drive.receive(r.frame, 0.35f, drive.torque_nm()); reply && size < out.size())
        out[size++] = *reply;
    static_cast<void>(can.send(std::span<const bus::Frame>(out).first(size)));
    if (tick % 50 == 0) static_cast<void>(::write(stand.line[1], bounce.data(), bounce.size()));
  }
}

/// Reads all of its registers, as `furcula monitor` does, but fifty times a second; and makes it run.
void play_host(Stand& stand) {
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto session = [&] { return stand.mailbox.ask(std::array<std::uint8_t, 5>{4, 0, 5, 0, 1}); };
  for (const bus::Request request : {bus::Request::arm, bus::Request::hop}) {
    const bus::Response s = session();
    const std::array<std::uint8_t, 12> write{16,
                                             0,
                                             0,
                                             0,
                                             3,
                                             6,
                                             bus::kRequestKey >> 8,
                                             bus::kRequestKey & 0xff,
                                             s.bytes[2],
                                             s.bytes[3],
                                             0,
                                             static_cast<std::uint8_t>(request)};
    static_cast<void>(stand.mailbox.ask(write));
  }
  while (!stand.quiet) {
    static_cast<void>(stand.mailbox.ask(
        std::array<std::uint8_t, 5>{4, 0, 0, 0, static_cast<std::uint8_t>(bus::kInputWords)}));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10.0;
  if (!(seconds >= 1.0 && seconds <= 3600.0)) {
    std::fputs("expected a number of seconds from 1 to 3600\n", stderr);
    return 2;
  }
  Stand stand;
  socketcan::CanSocket can(stand.bus[0]);
  PipeLines lines(stand.line[0]);
  Board board(stand.configuration, can, lines, stand.stop, stand.figures);
  core::ParameterFile store("");
  firmware::FaultLog faults{};
  faults.begin();
  Node node(board, store, stand.configuration.controller, {.board = "linux_sbc", .text = ""}, 1, faults);
  firmware::NodeRegisters registers(node);

  const auto ticks = static_cast<std::size_t>(1000.0 * seconds);
  std::vector<std::uint32_t> took_us(ticks);
  std::fputs((linux_sbc::lock_memory() + "\n").c_str(), stderr);
  std::thread devices(play_devices, std::ref(stand), 79), host(play_host, std::ref(stand));
  const std::string warning = linux_sbc::run_first_in_first_out(80);
  linux_sbc::touch_stack();
  std::size_t ran = 0;
  constexpr std::size_t kSettled = 500;
  for (std::size_t tick = 0; tick < ticks + kSettled; ++tick) {
    static_cast<void>(board.wait_for_tick());
    linux_sbc::run_tick(board, node, registers, stand.mailbox);
    // From when it woke, a microsecond at most too much: that is rounded down.
    const auto now_us = static_cast<std::uint32_t>((core::monotonic_ns() + 999) / 1000);
    if (tick < kSettled) continue;
    took_us[tick - kSettled] = now_us - board.now_us();
    ran += node.state() == bus::NodeState::running ? 1 : 0;
  }
  stand.quiet = true;
  devices.join();
  host.join();

  std::sort(took_us.begin(), took_us.end());
  const auto share = [&](double s) {
    return took_us[static_cast<std::size_t>(s * static_cast<double>(ticks - 1))];
  };
  if (!warning.empty()) std::fprintf(stderr, "%s\n", warning.c_str());
  const socketcan::CanCounters& c = can.counters();
  std::printf("%zu ticks, %zu of them running; %.2f frames in and %.2f out a tick, %.3f edges; requests %u\n",
              ticks, ran, static_cast<double>(c.received) / static_cast<double>(ticks + kSettled),
              static_cast<double>(c.sent) / static_cast<double>(ticks + kSettled),
              static_cast<double>(lines.edges) / static_cast<double>(ticks + kSettled),
              node.bus_counts().requests);
  std::printf("a tick's own work: median %u us, 99 %% within %u us, 99.9 %% within %u us, longest %u us\n",
              share(0.5), share(0.99), share(0.999), took_us.back());
  if (10 * ran > 9 * ticks) return 0;
  std::fprintf(stderr, "the robot did not run all the while: its fault is %s\n",
               std::string(control::info(static_cast<control::Fault>(node.snapshot().fault)).name).c_str());
  return 4;
}
