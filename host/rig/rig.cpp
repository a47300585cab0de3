// The mocked robot, see rig.hpp.
#include "host/rig/rig.hpp"

#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "boards/linux_sbc/can_socket.hpp"
#include "boards/sim_host/board.hpp"
#include "furcula/bus/parameters.hpp"
#include "host/log/atomic_file.hpp"
#include "host/log/message.hpp"
#include "host/log/strict_toml.hpp"
#include "host/rig/child.hpp"
#include "host/rig/gpio_sim.hpp"
#include "host/rig/peers.hpp"
#include "host/sim/recorder.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::rig {
namespace {

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::uint32_t kStartTicks = 10'000;  ///< in which the board must be idle, and then the drive on
constexpr std::uint32_t kSilentTicks = 1'000;  ///< without a frame for the drive; then the board is gone
constexpr std::uint32_t kCommandTicks = 10;    ///< between two commands of the desk

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

/// How a fault is planted: by the simulated rig's own means, or here.
enum class Means { rig, peers_silent, drive_silent, drive_lies, stop_program, impossible };

const std::map<std::string_view, Means>& means() {
  static const std::map<std::string_view, Means> all{
      {"late_tick", Means::stop_program},     {"task_stuck", Means::stop_program},
      {"peer_lost", Means::peers_silent},     {"drive_silent", Means::drive_silent},
      {"drive_error", Means::drive_lies},     {"drive_off", Means::impossible},
      {"frame_lost", Means::impossible},      {"frame_late", Means::impossible},
      {"frame_repeated", Means::impossible},  {"frame_reordered", Means::impossible},
      {"frame_corrupted", Means::impossible}, {"bus_off", Means::impossible}};
  return all;
}

Means means_of(const sim_host::PlannedFault& fault) {
  for (const auto& row : sim_host::kRigFaults)
    if (row.fault == fault.kind) {
      const auto found = means().find(row.name);
      return found == means().end() ? Means::rig : found->second;
    }
  return Means::rig;
}

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
        gpio_(options.gpio_folder) {
    static_cast<void>(board_.wait_for_tick());  // the first sample: the body is held where it starts
    const control::Sample& home = board_.sample();
    log::write_file_atomically(
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
    due_ns_ = now_ns();
    start(program);
    bool ended = false;
    while (!ended) {
      pass_tick(program);
      plant(program);
      settle();
      recorder_.add(board_);
      ended = !board_.wait_for_tick();
    }
    finish(program);
    RigResult result;
    recorder_.finish(result.log, clutch_);
    result.silent_ticks = silent_ticks_;
    result.late_ticks = late_ticks_;
    result.complaint = drive_.complaint();
    return result;
  }

 private:
  /// What the simulated rig plants itself.
  static sim_host::RigConfig own_part(sim_host::RigConfig config) {
    std::erase_if(config.faults, [](const auto& fault) { return means_of(fault) != Means::rig; });
    return config;
  }

  bool active(Means wanted) const {
    return std::any_of(scenario_.faults.begin(), scenario_.faults.end(), [&](const auto& fault) {
      return means_of(fault) == wanted && running_ && board_.time_s() >= fault.time_s - 1e-9 &&
             board_.time_s() < fault.time_s + fault.duration_s - 1e-9;
    });
  }

  /// Holds the body and speaks for the desk until the drive is switched on.
  void start(Child& program) {
    for (std::uint32_t tick = 0; !drive_.on(); ++tick) {
      if (tick > kStartTicks)
        throw RigError(!words_.heard ? "the board says nothing on " + options_.can_interface + " for 10 s"
                                     : "the board does not start within 10 s: its state is " +
                                           std::to_string(words_.state) + ", its fault " + fault_name());
      // A hop counts where the wish changes to it, so first it is told to stop.
      const bool idle = words_.heard && words_.state == 1;
      idle_ticks_ = idle ? idle_ticks_ + 1 : 0;
      pass_tick(program, idle_ticks_ > 50 ? Desk::Wish::hop : Desk::Wish::stop);
    }
    running_ = true;
    commanded_ = false;
  }

  std::string fault_name() const {
    return words_.fault < control::kFaultCount ? std::string(control::kFaults[words_.fault].name)
                                               : std::to_string(words_.fault);
  }

  /// Sends what the devices measure, then answers the board until the next tick is due.
  void pass_tick(Child& program, Desk::Wish wish = Desk::Wish::hop) {
    gpio_.set_contact(board_.sample().contact != 0);
    speak(wish);
    due_ns_ += kTickNs;
    for (;;) {
      const std::int64_t left_ns = due_ns_ - now_ns();
      if (left_ns <= 0) {
        if (left_ns <= -kTickNs) ++late_ticks_;
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

  void speak(Desk::Wish wish) {
    if (!active(Means::peers_silent)) {
      const control::Sample& s = board_.sample();
      send(height_.sample(s.height_count, s.age_us, std::isfinite(s.home_height_m)));
      if (clutch_) send(cable_.sample(s.cable_count, s.age_us, true));
    }
    if (tick_ % kCommandTicks == 0)
      send(desk_.command(wish, config_.torque.amplitude_nm, config_.torque.period_s,
                         config_.clutch.release_in_flight != 0));
  }

  void listen() {
    for (const linux_sbc::Received& r : can_.receive()) {
      words_.receive(r.frame);
      const bool silent = active(Means::peers_silent) || active(Means::drive_silent);
      const auto reply = drive_.receive(r.frame, board_.sample().leg_angle_rad, shown_torque_nm_);
      if (!reply) continue;
      commanded_ = true;
      bus::Frame answer = *reply;
      if (active(Means::drive_lies)) answer.data[7] = 1;
      if (!silent) send(answer);
    }
  }

  void send(const bus::Frame& frame) { static_cast<void>(can_.send({&frame, 1})); }

  /// What befalls the board's program itself. One that shall hang to the end of the run is killed.
  void plant(Child& program) {
    for (const sim_host::PlannedFault& fault : scenario_.faults) {
      if (means_of(fault) != Means::stop_program) continue;
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

  /// Hands what the board commanded to the plant. A drive that hears nothing switches off by its own
  /// watchdog, the simulated board's.
  void settle() {
    control::Command command;
    command.torque_nm = active(Means::drive_silent) ? 0.0f : drive_.torque_nm();  // a drive that is dead
    command.coil_duty = gpio_.solenoid() ? 1.0f : 0.0f;
    if (commanded_ || quiet_ticks_ < kQuietTicks) static_cast<void>(board_.actuate(command));
    quiet_ticks_ = commanded_ ? 0 : quiet_ticks_ + 1;
    if (commanded_) board_.kick_watchdog();
    if (!commanded_) ++silent_ticks_;
    if (quiet_ticks_ > kSilentTicks && !killed_ && board_.time_s() > stopped_until_s_)
      throw RigError("the board said nothing to the drive for 1 s, from " +
                     log::rounded(board_.time_s() - 1.0) + " s on");
    commanded_ = false;
    firmware::Telemetry telemetry;
    telemetry.outputs.fault = static_cast<control::Fault>(words_.fault);
    telemetry.outputs.height =
        control::estimate_height(config_.height, height_state_,
                                 count_difference(board_.sample().height_count, board_.sample().home_count),
                                 board_.sample().home_height_m, 0.001f);
    board_.report(telemetry);
    shown_torque_nm_ = static_cast<float>(board_.command().torque_nm);
  }

  void finish(Child& program) {
    if (killed_) return;
    program.send(SIGCONT);
    program.send(SIGTERM);
    // It still speaks with its drive, which shall hear that it is to be off.
    for (int i = 0; i < 2000 && program.ending().empty(); ++i) pass_tick_at_end();
    if (program.ending().empty()) throw RigError("the board's program did not end within 2 s of SIGTERM");
    if (!program.ended_well()) throw RigError("the board's program " + program.ending() + " on SIGTERM");
    if (drive_.on() || gpio_.solenoid())
      throw RigError("the board's program ended and left the drive on, or the solenoid");
  }
  void pass_tick_at_end() {
    due_ns_ += kTickNs;
    const timespec pause{0, kTickNs};
    ::nanosleep(&pause, nullptr);
    listen();
  }

  static constexpr std::uint32_t kQuietTicks = 4;  ///< then the drive's watchdog rules

  const RigOptions& options_;
  const sim::Scenario& scenario_;
  bool clutch_;
  control::Config config_;
  sim_host::SimBoard board_;
  sim::HopperRecorder recorder_;
  linux_sbc::CanSocket can_;
  GpioSim gpio_;
  Drive drive_;
  EncoderNode height_{kHeightNode}, cable_{kCableNode};
  Desk desk_;
  BoardWords words_;
  control::HeightState height_state_;
  std::int64_t due_ns_ = 0;
  std::uint32_t tick_ = 0, idle_ticks_ = 0, quiet_ticks_ = 0, silent_ticks_ = 0, late_ticks_ = 0;
  float shown_torque_nm_ = 0.0f;
  double stopped_until_s_ = 0.0;
  bool commanded_ = false, running_ = false, killed_ = false;
};

}  // namespace

std::string what_cannot_be_planted(const sim::Scenario& scenario) {
  for (const sim_host::PlannedFault& fault : scenario.faults)
    if (means_of(fault) == Means::impossible)
      for (const auto& row : sim_host::kRigFaults)
        if (row.fault == fault.kind) return std::string(row.name);
  return {};
}

std::string board_configuration(const RigOptions& options, const control::Config& config, bool clutch,
                                std::uint32_t home_count, float home_height_m) {
  const auto number = [](double value) { return log::toml_float(value); };
  std::string text = "[can]\ninterface = \"" + options.can_interface + "\"\nmotor = \"" +
                     std::string(bus::info(kMotor).name) + "\"\ndrive_node = " + std::to_string(kDriveNode) +
                     "\nheight_encoder_node = " + std::to_string(kHeightNode) +
                     "\ncable_encoder_node = " + std::to_string(clutch ? kCableNode : 0) +
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
