// The mocked robot, see rig.hpp.
#include "host/rig/rig.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "boards/sim_host/board.hpp"
#include "furcula/bus/parameters.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/rig/child.hpp"
#include "host/rig/devices.hpp"
#include "host/rig/gpio_sim.hpp"
#include "host/rig/peers.hpp"
#include "host/sim/expectation.hpp"
#include "host/sim/recorder.hpp"
#include "host/sim/simulate.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::rig {
namespace {

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::uint32_t kStartTicks = 10'000;  ///< in which the board must be idle, and then the drive on
constexpr std::uint32_t kSilentTicks = 1'000;  ///< without a frame for the drive; then the board is gone
constexpr std::uint32_t kCommandTicks = 10;    ///< between two commands of the host

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

/// A fault of the clock befalls the board's program; all others the rig has.
bool befalls_program(const sim_host::PlannedFault& fault) { return sim_host::delays_tick(fault.kind); }

class Rig {
 public:
  Rig(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed, const RigOptions& options)
      : options_(options),
        scenario_(scenario),
        clutch_(model.clutch.has_value()),
        config_(sim::controller_config(model, scenario)),
        board_(own_part(sim::rig_config(model, scenario, seed))),
        recorder_(scenario.duration_s),
        can_(options.can_interface, {}),
        devices_(
            [this](const bus::Frame& frame) {
              static_cast<void>(can_.send({&frame, 1}));
            },
            [this](std::uint32_t classes) { send_error_frame(classes); }, clutch_),
        gpio_(options.gpio_folder) {
    if (!options.moment) {
      onset_s_ = sim::first_fault_s(scenario).value_or(kNever);
      std::copy_if(scenario.faults.begin(), scenario.faults.end(), std::back_inserter(program_faults_),
                   befalls_program);
    }
    static_cast<void>(board_.wait_for_tick());  // the first sample: the body is held where it starts
    const control::Sample& home = board_.sample();
    core::write_file_atomically(
        options.configuration_path,
        board_configuration(options, config_, clutch_, home.home_count, home.home_height_m));
  }

  RigResult run() {
    std::vector<std::string> command = options_.command;
    command.push_back(options_.configuration_path);
    Child program(command);
    sched_param priority{};
    priority.sched_priority = 50;
    static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &priority));  // where it may not, the counts tell
    // A page that is read from the disk in the middle of a run makes the rig late.
    static_cast<void>(::mlockall(MCL_CURRENT | MCL_FUTURE));
    due_ns_ = now_ns();
    start(program);
    bool ended = false;
    while (!ended) {
      stop_program(program);
      pass_tick(program);
      settle();
      recorder_.add(board_);
      note();
      if (options_.moment && onset_s_ == kNever && board_.time_s() > kFirstMomentS && options_.moment(board_))
        plant();
      ended = !board_.wait_for_tick() || board_.time_s() > onset_s_ + options_.watched_s ||
              (options_.moment && board_.time_s() > result_.told_off_s + kWatchedS);
    }
    if (options_.moment && onset_s_ == kNever) throw RigError("the moment for its fault never came");
    recorder_.finish(result_.log, clutch_);
    result_.onset_s = onset_s_;
    result_.fault = words_.fault;
    result_.complaint = devices_.drive().complaint();
    RigResult result = std::move(result_);  // what the board says at its end is no part of it
    finish(program);
    return result;
  }

 private:
  /// What the simulated rig has itself: where a moment is waited for, nothing yet.
  sim_host::RigConfig own_part(sim_host::RigConfig config) const {
    std::erase_if(config.faults,
                  [&](const auto& fault) { return options_.moment != nullptr || befalls_program(fault); });
    return config;
  }

  /// The scenario's faults, from the next tick on.
  void plant() {
    onset_s_ = board_.time_s() + 0.001;
    for (sim_host::PlannedFault fault : scenario_.faults) {
      fault.time_s += onset_s_;
      if (befalls_program(fault))
        program_faults_.push_back(fault);
      else
        board_.plant(fault);
    }
  }

  /// Holds the body and speaks for the host until the drive is switched on.
  void start(Child& program) {
    for (std::uint32_t tick = 0; !devices_.drive().on(); ++tick) {
      if (tick > kStartTicks)
        throw RigError(!words_.heard ? "the board says nothing on " + options_.can_interface + " for 10 s"
                                     : "the board does not start within 10 s: its state is " +
                                           std::to_string(words_.state) + ", its fault " + fault_name());
      // A hop counts where the request changes to it, so first it is told to stop.
      const bool idle = words_.heard && words_.state == 1;
      idle_ticks_ = idle ? idle_ticks_ + 1 : 0;
      pass_tick(program, idle_ticks_ > 50 ? Host::Request::hop : Host::Request::stop);
    }
    running_ = true;
    commanded_ = false;
  }

  std::string fault_name() const {
    return words_.fault < control::kFaultCount ? std::string(control::kFaults[words_.fault].name)
                                               : std::to_string(words_.fault);
  }

  /// Sends what the devices measure, then answers the board until the next tick is due.
  void pass_tick(Child& program, Host::Request request = Host::Request::hop) {
    gpio_.set_contact(board_.sample().contact != 0);
    devices_.begin_tick(board_, running_);
    if (tick_ % kCommandTicks == 0) {
      const bus::Frame frame = host_.command(request, config_.torque.amplitude_nm, config_.torque.period_s,
                                             config_.clutch.release_in_flight != 0);
      static_cast<void>(can_.send({&frame, 1}));
    }
    due_ns_ += kTickNs;
    for (;;) {
      const std::int64_t left_ns = due_ns_ - now_ns();
      if (left_ns <= 0) {
        if (left_ns <= -kTickNs && running_) ++result_.late_ticks;
        break;
      }
      pollfd waited{can_.fd(), POLLIN, 0};
      const timespec wait{0, static_cast<long>(left_ns)};
      if (::ppoll(&waited, 1, &wait, nullptr) > 0) listen();
    }
    listen();
    if (tick_++ % 50 == 0 && !killed_)
      if (const std::string ending = program.ending(); !ending.empty())
        throw RigError("the board's program " + ending);
  }

  void listen() {
    for (const socketcan::Received& r : can_.receive()) {
      words_.receive(r.frame);
      if (devices_.hear(r.frame)) commanded_ = true;
      if (is_switch_off(r.frame) && board_.time_s() >= onset_s_ && result_.told_off_s == kNever)
        result_.told_off_s = board_.time_s();
    }
  }

  /// As the board's CAN controller would have the kernel say.
  void send_error_frame(std::uint32_t classes) const {
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | classes;
    frame.can_dlc = CAN_ERR_DLC;
    if (::write(can_.fd(), &frame, sizeof frame) != static_cast<ssize_t>(sizeof frame))
      throw RigError("the CAN interface does not take an error frame");
  }

  /// What befalls the board's program itself. One that shall hang to the end of the run is killed.
  void stop_program(Child& program) {
    for (const sim_host::PlannedFault& fault : program_faults_) {
      const bool for_ever = fault.time_s + fault.duration_s >= scenario_.duration_s;
      const auto is_now = [&](double time_s) {
        return board_.time_s() >= time_s - 1e-9 && board_.time_s() < time_s + 0.001 - 1e-9;
      };
      if (is_now(fault.time_s)) {
        program.send(for_ever ? SIGKILL : SIGSTOP);
        killed_ = killed_ || for_ever;
        stopped_until_s_ = fault.time_s + fault.duration_s;
      }
      if (!for_ever && is_now(fault.time_s + fault.duration_s)) program.send(SIGCONT);
    }
  }

  /// Hands what drive and solenoid do to the plant. That of a board whose program is gone is what the
  /// kernel leaves of its line.
  void settle() {
    control::Command command;
    command.torque_nm = devices_.torque_nm();
    command.coil_duty = gpio_.solenoid() ? 1.0f : 0.0f;
    static_cast<void>(board_.actuate(command));
    board_.kick_watchdog();  // the simulated board's; the drive has its own
    quiet_ticks_ = commanded_ ? 0 : quiet_ticks_ + 1;
    if (!commanded_) ++result_.silent_ticks;
    if (quiet_ticks_ > kSilentTicks && !killed_ && board_.time_s() > stopped_until_s_)
      throw RigError("the board said nothing to the drive for 1 s, from " +
                     core::rounded(board_.time_s() - 1.0) + " s on");
    commanded_ = false;
    firmware::Telemetry telemetry;
    telemetry.outputs.fault = static_cast<control::Fault>(words_.fault);
    telemetry.outputs.height =
        control::estimate_height(config_.height, height_state_,
                                 count_difference(board_.sample().height_count, board_.sample().home_count),
                                 board_.sample().home_height_m, 0.001f);
    board_.report(telemetry);
    devices_.show_torque(command.torque_nm);
  }

  void note() {
    if (std::abs(board_.command().torque_nm) > static_cast<float>(sim::kNoTorqueNm))
      result_.last_torque_s = board_.time_s();
    if (board_.time_s() < onset_s_) result_.fault_before = result_.fault_before || words_.fault != 0;
    const bool stands = board_.plant().in_stance();
    if (stands && !stood_ && board_.time_s() >= onset_s_) ++result_.landings;
    stood_ = stands;
  }

  void finish(Child& program) {
    if (killed_) return;
    program.send(SIGCONT);
    program.send(SIGTERM);
    // It still speaks with its drive, which shall hear that it is to be off.
    for (int i = 0; i < 2000 && program.ending().empty(); ++i) pass_tick_at_end();
    if (program.ending().empty()) throw RigError("the board's program did not end within 2 s of SIGTERM");
    if (!program.ended_well()) throw RigError("the board's program " + program.ending() + " on SIGTERM");
    if (devices_.drive().on() || gpio_.solenoid())
      throw RigError("the board's program ended and left the drive on, or the solenoid");
  }
  void pass_tick_at_end() {
    due_ns_ += kTickNs;
    const timespec pause{0, kTickNs};
    ::nanosleep(&pause, nullptr);
    listen();
  }

  static constexpr double kNever = RigResult::kNever;
  static constexpr double kFirstMomentS = 0.6;  ///< by then it hops
  static constexpr double kWatchedS = 0.15;     ///< after the drive was told off; telemetry tells why

  const RigOptions& options_;
  const sim::Scenario& scenario_;
  bool clutch_;
  control::Config config_;
  sim_host::SimBoard board_;
  sim::HopperRecorder recorder_;
  socketcan::CanSocket can_;
  Devices devices_;
  GpioSim gpio_;
  Host host_;
  BoardWords words_;
  control::HeightState height_state_;
  RigResult result_;
  std::vector<sim_host::PlannedFault> program_faults_;
  std::int64_t due_ns_ = 0;
  std::uint32_t tick_ = 0, idle_ticks_ = 0, quiet_ticks_ = 0;
  double onset_s_ = kNever, stopped_until_s_ = 0.0;
  bool commanded_ = false, running_ = false, killed_ = false, stood_ = false;
};

}  // namespace

std::string board_configuration(const RigOptions& options, const control::Config& config, bool clutch,
                                std::uint32_t home_count, float home_height_m) {
  const auto number = [](double value) { return core::toml_float(value); };
  std::string text = "[can]\ninterface = \"" + options.can_interface + "\"\nmotor = \"" +
                     std::string(bus::info(kMotor).name) + "\"\ndrive_node = " + std::to_string(kDriveNode) +
                     "\nheight_encoder_node = " + std::to_string(kHeightNode) +
                     "\ncable_encoder_node = " + std::to_string(clutch ? kCableNode : 0) +
                     "\nsupply_node = " + std::to_string(kSupplyNode) +
                     "\nown_node = " + std::to_string(kBoardNode) +
                     "\n\n[height]\nhome_count = " + std::to_string(home_count) +
                     "\nhome_m = " + number(static_cast<double>(home_height_m)) + "\n";
  if (clutch) text += "\n[cable]\nhome_count = " + std::to_string(home_count) + "\n";
  text += "\n[contact]\nchip = \"" + options.gpio_chip + "\"\nline = \"contact\"\n\n[solenoid]\nchip = \"" +
          options.gpio_chip + "\"\nline = \"solenoid\"\n\n[parameters]\n";
  for (const bus::Parameter& p : bus::kParameters) {
    // A board on a bus allows its sensors more (firmware/app/can_link.hpp).
    if (p.name == "sample_age_max_us") continue;
    // Bounded, as a person's values are: what the model leaves open may be out of the table's bounds.
    const float value = std::clamp(p.get(config), p.least, p.most);
    text += std::string(p.name) + " = " +
            (p.whole ? std::to_string(static_cast<long>(value)) : number(static_cast<double>(value))) + "\n";
  }
  return text;
}

RigResult run(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed,
              const RigOptions& options) {
  return Rig(model, scenario, seed, options).run();
}

}  // namespace furcula::rig
