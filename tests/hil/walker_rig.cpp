// A simulated biped on three CAN interfaces, against the program furculad: hil_walker_rig FURCULAD WALK FOLDER CASE. CASE is `walk`,
// `drive_silent` or `bus_down`. Ends with status 0 where what is expected came, 4 with a reason where it did not. Called by
// tests/hil/run.
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <array>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/control/fault.hpp"
#include "furcula/dynamics/biped/design.hpp"
#include "host/core/timer.hpp"
#include "host/rig/child.hpp"
#include "host/rig/peers.hpp"
#include "host/rig/rig.hpp"
#include "host/socketcan/can_socket.hpp"
#include "host/walk/walk_toml.hpp"
#include "host/walk/walker_devices.hpp"

namespace {

using namespace furcula;
using control::Fault;
using control::WalkerStage;

constexpr std::array<const char*, 3> kInterfaces{"vcan0", "vcan1", "vcan2"};
constexpr std::int64_t kTickNs = 1'000'000;
constexpr int kWatchedTicks = 100;

walk::WalkerRigConfig robot(const std::string& file, bool drive_dies) {
  const walk::Walk found = walk::read_walk(file);
  walk::WalkerRigConfig c{
      .robot = dynamics::biped::design(), .mode = found.mode, .walk = found.parameters, .seed = 1};
  if (drive_dies) c.fault = walk::WalkerFault::drive_silent;
  c.fault_s = 3.0;
  return c;
}

class Rig {
 public:
  explicit Rig(const walk::WalkerRigConfig& config) : devices_(config) {
    for (std::size_t bus = 0; bus < can_.size(); ++bus)
      can_[bus] = std::make_unique<socketcan::CanSocket>(kInterfaces[bus], std::span<const std::uint32_t>{});
    timer_.start();
  }

  void tick() {
    const std::int64_t late_ns = timer_.wait();
    if (late_ns > most_late_ns_) most_late_ns_ = late_ns;
    if (ticks_++ % 10 == 0) send(walk::kWalkerBodyBus, host_.command(request, 0.0f, 0.3f, false));
    for (const bus::Frame& frame : devices_.speak()) send(walk::kWalkerBodyBus, frame);
    // Drives answer at once, until shortly before the tick ends.
    const std::int64_t end_ns = timer_.woke_ns() - late_ns + kTickNs - 100'000;
    do {
      for (std::size_t bus = 0; bus < can_.size(); ++bus)
        for (const socketcan::Received& r : can_[bus]->receive()) {
          if (bus == walk::kWalkerBodyBus) words.receive(r.frame);
          if (const auto reply = devices_.hear(bus, r.frame)) send(bus, *reply);
        }
    } while (wait_for_a_frame(end_ns));
    devices_.advance();
    if (devices_.rig().broken()) ++broken_ticks;
  }
  /// At once: a program that does it would hold up the drives' answers.
  bool take_down(std::size_t bus) const {
    ifreq flags{};
    std::memcpy(flags.ifr_name, kInterfaces[bus], std::strlen(kInterfaces[bus]));
    if (::ioctl(can_[bus]->fd(), SIOCGIFFLAGS, &flags) != 0) return false;
    flags.ifr_flags = static_cast<short>(flags.ifr_flags & ~IFF_UP);
    return ::ioctl(can_[bus]->fd(), SIOCSIFFLAGS, &flags) == 0;
  }
  /// @returns whether it came within so many ticks.
  template <class Condition>
  bool come(int ticks, const Condition& condition) {
    for (int i = 0; i < ticks && !condition(); ++i) tick();
    return condition();
  }

  const walk::WalkerDevices& devices() const { return devices_; }
  std::int64_t most_late_ns() const { return most_late_ns_; }
  void forget_lateness() { most_late_ns_ = 0; }
  WalkerStage stage() const { return devices_.told().stage; }
  Fault fault() const { return static_cast<Fault>(words.fault); }

  rig::Host::Request request = rig::Host::Request::stop;
  rig::BoardWords words;
  int broken_ticks = 0;

 private:
  void send(std::size_t bus, const bus::Frame& frame) {
    static_cast<void>(can_[bus]->send(std::span(&frame, 1)));
  }
  bool wait_for_a_frame(std::int64_t end_ns) {
    const std::int64_t left_ns = end_ns - core::monotonic_ns();
    if (left_ns <= 0) return false;
    std::array<pollfd, 3> fds{};
    for (std::size_t bus = 0; bus < can_.size(); ++bus) fds[bus] = {can_[bus]->fd(), POLLIN, 0};
    const timespec most{0, static_cast<long>(left_ns)};
    return ::ppoll(fds.data(), fds.size(), &most, nullptr) > 0;
  }

  walk::WalkerDevices devices_;
  std::array<std::unique_ptr<socketcan::CanSocket>, 3> can_;
  core::Timer timer_{kTickNs};
  rig::Host host_;
  int ticks_ = 0;
  std::int64_t most_late_ns_ = 0;
};

/// Empty, or what is not as expected.
std::string play(Rig& rig, const std::string& which) {
  const auto told = [&] { return std::string(control::info(rig.fault()).name); };
  if (!rig.come(10'000, [&] { return rig.words.heard && rig.words.state == 1; }))
    return "it is not idle after 10 s: state " + std::to_string(rig.words.state) + ", fault " + told();
  rig.forget_lateness();  // programs were being loaded
  rig.request = rig::Host::Request::hop;
  if (!rig.come(2'000, [&] { return rig.stage() == WalkerStage::walking; }))
    return "it does not walk 2 s after it was told to: fault " + told();
  const double begin_s = rig.devices().rig().time_s();
  const auto& state = rig.devices().rig().state();
  if (which == "walk") {
    if (rig.come(10'000, [&] { return rig.stage() == WalkerStage::damped; }))
      return "a fault after " + std::to_string(rig.devices().rig().time_s() - begin_s) +
             " s of walking: " + told();
    if (!(state.position_m.z > 0.9)) return "it does not stand";
    if (!(state.position_m.x > 0.5)) return "it did not get 0.5 m ahead";
    const double walked_m = state.position_m.x;
    rig.request = rig::Host::Request::stop;
    if (!rig.come(20, [&] { return rig.stage() == WalkerStage::idle; }))
      return "it does not stop: stage " + std::to_string(static_cast<int>(rig.stage())) + ", fault " + told();
    // Not before: to print on a busy machine's console takes some ticks, in which drives would be silent.
    std::cout << "walked " << walked_m << " m in 10 s, and stands\n";
    return "";
  }
  if (which == "bus_down") {
    rig.come(1'000, [] { return false; });
    if (!rig.take_down(0)) return "vcan0 cannot be taken down";
  }
  if (!rig.come(5'000, [&] { return rig.stage() == WalkerStage::damped; })) return "no fault is found";
  rig.come(kWatchedTicks, [] { return false; });  // for its heartbeat
  const Fault expected = which == "bus_down" ? Fault::bus_off : Fault::drive_silent;
  if (rig.fault() != expected) return "it found " + told();
  if (which == "drive_silent") {
    const int after = rig.broken_ticks - kWatchedTicks;
    std::cout << "the dead drive was found after " << after << " ms\n";
    // Frames cross the two programs' ticks: two more than in one program's time.
    if (after > 8) return "the dead drive was found too late";
  }
  // The right leg's drives brake.
  for (std::size_t i = 6; i < 12; ++i) {
    if (!rig.devices().on(i)) return "a drive that could brake is off";
    if (rig.devices().told().joints[i].stiffness_nmprad != 0.0f) return "a drive pulls after the fault";
  }
  return "";
}

int run(char** argv) {
  const std::string program = argv[1], walk_file = argv[2], folder = argv[3], which = argv[4];
  const std::string configuration = folder + "/furculad.toml";
  std::ofstream(configuration) << "robot = \"biped_walker\"\n[can]\nleft = \"" << kInterfaces[0]
                               << "\"\nright = \"" << kInterfaces[1] << "\"\nbody = \"" << kInterfaces[2]
                               << "\"\n[walk]\nfile = \"" << std::filesystem::absolute(walk_file).string()
                               << "\"\n";
  Rig rig(robot(walk_file, which == "drive_silent"));
  rig::Child child({program, configuration});
  sched_param priority{};
  priority.sched_priority = 50;
  static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &priority));
  static_cast<void>(::mlockall(MCL_CURRENT | MCL_FUTURE));
  std::string wrong = play(rig, which);
  if (const std::string ending = child.ending(); wrong.empty() && !ending.empty())
    wrong = "furculad " + ending;
  child.send(SIGTERM);
  rig.come(200, [] { return false; });
  if (wrong.empty() && which != "bus_down")
    for (std::size_t i = 0; i < control::kWalkerJoints; ++i)
      if (rig.devices().on(i)) wrong = "a drive is on after SIGTERM";
  if (!child.wait(std::chrono::milliseconds(2000)) || !child.ended_well())
    if (wrong.empty()) wrong = "furculad did not end well on SIGTERM";
  std::cout << which << ": " << (wrong.empty() ? "held" : "FAILED: " + wrong) << "; the rig's ticks began "
            << rig.most_late_ns() / 1000 << " us late at most\n";
  return wrong.empty() ? 0 : 4;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: hil_walker_rig FURCULAD WALK FOLDER walk|drive_silent|bus_down\n";
    return 2;
  }
  try {
    return run(argv);
  } catch (const std::exception& e) {
    std::cerr << "hil_walker_rig: " << e.what() << "\n";
    return 3;
  }
}
