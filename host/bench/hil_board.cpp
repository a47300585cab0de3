// furculad on the simulated bench, see hil_board.hpp. Two threads: one plays the stand, each millisecond; the
// host's is the caller's.
#include "host/bench/hil_board.hpp"

#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "host/bench/bus_board.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/timer.hpp"
#include "host/rig/child.hpp"
#include "host/rig/gpio_sim.hpp"
#include "host/socketcan/can_socket.hpp"

namespace furcula::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::size_t kSeenTicks = 10;                    ///< by then the board has seen what hangs there
constexpr const char* kModbus = "modbus:127.0.0.1:1502";  ///< furculad's own, unless it is told otherwise

class KernelWires final : public Wires {
 public:
  explicit KernelWires(const rig::RigOptions& options)
      : can_(options.can_interface, {}), gpio_(options.gpio_folder) {}

  bool coil() override { return gpio_.solenoid(); }
  void send(const bus::Frame& frame) override { static_cast<void>(can_.send({&frame, 1})); }
  std::vector<bus::Frame> receive() override {
    std::vector<bus::Frame> frames;
    for (const socketcan::Received& r : can_.receive()) frames.push_back(r.frame);
    return frames;
  }

 private:
  socketcan::CanSocket can_;
  rig::GpioSim gpio_;
};

rig::RigOptions options_here(const std::string& program) {
  namespace fs = std::filesystem;
  const rig::GpioBank bank = rig::find_gpio_bank();
  rig::RigOptions options;
  options.gpio_folder = bank.folder;
  options.gpio_chip = bank.chip;
  options.command = {
      program.empty() ? fs::read_symlink("/proc/self/exe").replace_filename("furculad").string() : program};
  options.configuration_path =
      (fs::temp_directory_path() / ("furcula-bench-" + std::to_string(::getpid()) + ".toml")).string();
  return options;
}

rig::RigOptions options_or_why(const std::string& program) {
  try {
    return options_here(program);
  } catch (const rig::RigError& e) {
    throw core::DataError(std::string("hil: ") + e.what());
  }
}

/// furculad's, as long as this lives.
struct ConfigurationFile {
  ConfigurationFile(const rig::RigOptions& options, const SimStand& stand)
      : path(options.configuration_path) {
    core::write_file_atomically(path,
                                rig::board_configuration(options, stand_config(stand, {}), true, 0, 0.0f));
  }
  ~ConfigurationFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  ConfigurationFile(const ConfigurationFile&) = delete;
  ConfigurationFile& operator=(const ConfigurationFile&) = delete;

  std::string path;
};

std::vector<std::string> with_argument(std::vector<std::string> command, const std::string& argument) {
  command.push_back(argument);
  return command;
}

}  // namespace

struct HilBoard::Parts {
  Parts(const rig::RigOptions& options, std::unique_ptr<Wires> ends, SimStand& stand)
      : configuration(options, stand),
        wires(std::move(ends)),
        program(with_argument(options.command, configuration.path)),
        player(stand, *wires) {
    thread = std::thread([this] { play(); });
  }

  ~Parts() {
    // It ends in the safe state, with its encoder still there.
    program.send(SIGTERM);
    program.wait(2s);
    {
      const std::lock_guard lock(mutex);
      over = true;
    }
    thread.join();
  }

  void play() {
    sched_param priority{};
    priority.sched_priority = 50;
    static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &priority));  // where it may not, the count tells
    // A page that is read from the disk in the middle of a trial makes the stand late.
    static_cast<void>(::mlockall(MCL_CURRENT | MCL_FUTURE));
    core::Timer timer(kTickNs);
    timer.start();
    for (;;) {
      const bool late = timer.wait() >= kTickNs;
      const std::lock_guard lock(mutex);
      if (over) return;
      try {
        if (wanted) {
          player.hang(*wanted);
          wanted.reset();
          ticks = late_ticks = 0;
          rows.clear();
        } else if (late) {
          ++late_ticks;
        }
        player.tick();
      } catch (const std::runtime_error& e) {
        complaint = e.what();
        return;
      }
      ++ticks;
      if (rows.size() < kept) rows.push_back(player.reading());
    }
  }

  /// The load hangs, and so many ticks have passed since.
  void hang(const Conditions& conditions, std::size_t wait_ticks, std::size_t keep) {
    {
      const std::lock_guard lock(mutex);
      wanted = conditions;
      kept = keep;
    }
    for (bool there = false; !there; std::this_thread::sleep_for(1ms)) {
      check();
      const std::lock_guard lock(mutex);
      there = !wanted && ticks >= wait_ticks;
    }
  }

  /// @throws core::DataError where stand or program have ended, which explains whatever else was seen.
  void check() {
    {
      const std::lock_guard lock(mutex);
      if (!complaint.empty()) throw core::DataError("hil: " + complaint);
    }
    if (const std::string ending = program.ending(); !ending.empty())
      throw core::DataError("hil: the board's program " + ending);
  }

  void wait_until_idle() {
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    for (;;) {
      check();
      rig::BoardWords words;
      {
        const std::lock_guard lock(mutex);
        words = player.words();
      }
      if (words.heard && words.state == static_cast<std::uint32_t>(bus::NodeState::idle)) return;
      if (std::chrono::steady_clock::now() > deadline)
        throw core::DataError(words.heard ? "hil: the board is not idle within 10 s: its state is " +
                                                std::to_string(words.state) + ", its fault " +
                                                std::to_string(words.fault)
                                          : "hil: the board says nothing for 10 s");
      std::this_thread::sleep_for(5ms);
    }
  }

  ConfigurationFile configuration;
  std::unique_ptr<Wires> wires;
  rig::Child program;
  std::optional<BusBoard> host;
  std::thread thread;

  std::mutex mutex;  ///< of all below
  StandPlayer player;
  std::optional<Conditions> wanted;
  std::size_t ticks = 0, late_ticks = 0;  ///< since the load was hung up
  std::size_t kept = 0;                   ///< so many rows at most
  std::vector<Reading> rows;
  std::string complaint;
  bool over = false;
};

HilBoard::HilBoard(const std::string& program) : HilBoard(options_or_why(program), nullptr) {}

HilBoard::HilBoard(const rig::RigOptions& options, std::unique_ptr<Wires> wires) {
  try {
    if (!wires) wires = std::make_unique<KernelWires>(options);
    parts_ = std::make_unique<Parts>(options, std::move(wires), stand_);
  } catch (const std::runtime_error& e) {
    throw core::DataError(std::string("hil: ") + e.what());
  }
  parts_->wait_until_idle();
  parts_->host.emplace(modbus::parse_port(kModbus), 1,
                       [this](const Conditions& conditions) { parts_->hang(conditions, kSeenTicks, 0); });
}

HilBoard::~HilBoard() = default;

std::vector<Reading> HilBoard::run(const Conditions& conditions, const Timing& timing) {
  std::vector<Reading> rows;
  if (timing.window == 0) {
    parts_->hang(conditions, timing.rows(), timing.rows());
    const std::lock_guard lock(parts_->mutex);
    rows = parts_->rows;
  } else {
    try {
      rows = parts_->host->run(conditions, timing);
    } catch (const core::DataError&) {
      parts_->check();
      throw;
    }
  }
  const std::lock_guard lock(parts_->mutex);
  if (parts_->late_ticks != 0)
    throw core::DataError("hil: the stand was late on " + std::to_string(parts_->late_ticks) +
                          " ticks, and what the board saw does not count");
  return rows;
}

}  // namespace furcula::bench
