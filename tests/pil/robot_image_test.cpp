// The images of the STM32F4 boards, as they are flashed, in QEMU: start, tick, and Modbus over the serial
// port. QEMU has no clock control, pins, CAN or encoders: the image starts from its internal oscillator and
// says that it has no peer.
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "firmware/startup/image_header.hpp"
#include "furcula/bus/parameters.hpp"
#include "furcula/bus/registers.hpp"
#include "furcula/control/fault.hpp"
#include "tests/paths.hpp"
#include "tests/pil/emulator.hpp"

namespace {

using namespace furcula;
using Bytes = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

struct BoardCase {
  const char* name;
  int serial_ports_before;  ///< of QEMU's, USART1 being the first
};
constexpr BoardCase kBoards[] = {{"stm32f4discovery", 1}, {"feather_stm32f405", 2}};

std::string image(const BoardCase& board) { return test::image(std::string(board.name)); }

bool cannot_run_here() {
  std::vector<std::string> images;
  for (const BoardCase& board : kBoards) images.push_back(image(board));
  return test::cannot_emulate(images);
}

/// QEMU with an image, its serial port at our end of a socket.
class Machine {
 public:
  explicit Machine(const BoardCase& board) {
    const std::string socket_path = emulator_.folder() + "/serial";
    std::vector<std::string> more{"-icount", "shift=0"};
    for (int i = 0; i < board.serial_ports_before; ++i) more.insert(more.end(), {"-serial", "null"});
    more.insert(more.end(), {"-serial", "unix:" + socket_path + ",server=on,wait=off"});
    more.insert(more.end(), {"-chardev", "socket,id=debugger,path=" + debugger_path() + ",server=on,wait=off",
                             "-gdb", "chardev:debugger"});
    emulator_.start(image(board), more);
    socket_ = connected(socket_path);
  }
  ~Machine() { ::close(socket_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// An answer to a request (PDU), or an empty one. The request is said again where the emulated line, whose
  /// time runs by instructions, had a gap in it; so requests must bear it.
  Bytes ask(const Bytes& pdu) {
    Bytes frame{1};
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    const std::uint16_t crc = crc_of(frame);
    frame.push_back(static_cast<std::uint8_t>(crc));
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
    for (int attempt = 0; attempt < 20; ++attempt) {
      REQUIRE(::write(socket_, frame.data(), frame.size()) == static_cast<ssize_t>(frame.size()));
      Bytes answer;
      const auto deadline = Clock::now() + std::chrono::seconds(2);
      while (Clock::now() < deadline) {
        // A frame ends with a silence: one whose check sum ends with a 0 is whole by its sum a byte too
        // early.
        pollfd waited{socket_, POLLIN, 0};
        if (::poll(&waited, 1, 50) == 0 && answer.size() >= 5 && crc_of(answer) == 0 && answer[0] == 1)
          return {answer.begin() + 1, answer.end() - 2};
        std::uint8_t byte = 0;
        while (::recv(socket_, &byte, 1, MSG_DONTWAIT) == 1) answer.push_back(byte);
      }
    }
    return {};
  }

  /// The next thing to be pushed finds this stack pointer. By the debugger's protocol ("GDB Remote Serial
  /// Protocol"): the program stops when one connects, `g` and `G` are the registers, `D` lets it go on.
  void set_stack_pointer(std::uint32_t address) const {
    const int debugger = connected(debugger_path());
    std::string registers = say(debugger, "g").substr(0, std::size_t{16} * 8);
    REQUIRE(registers.size() == std::size_t{16} * 8);
    for (std::size_t i = 0; i < 4; ++i) {
      char digits[3];
      std::snprintf(digits, sizeof digits, "%02x", address >> 8 * i & 0xffu);
      registers.replace(std::size_t{13} * 8 + 2 * i, 2, digits);
    }
    REQUIRE(say(debugger, "G" + registers) == "OK");
    REQUIRE(say(debugger, "D") == "OK");
    ::close(debugger);
  }

 private:
  std::string debugger_path() const { return emulator_.folder() + "/debugger"; }

  static int connected(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof(address.sun_path));
    std::memcpy(address.sun_path, path.c_str(), path.size());
    const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto deadline = Clock::now() + std::chrono::seconds(20);
    while (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
      REQUIRE(Clock::now() < deadline);
      ::poll(nullptr, 0, 10);
    }
    return socket;
  }

  /// A packet of the debugger's, and the one that answers it.
  static std::string say(int debugger, const std::string& packet) {
    unsigned sum = 0;
    for (const char c : packet) sum += static_cast<unsigned char>(c);
    char tail[4];
    std::snprintf(tail, sizeof tail, "#%02x", sum & 0xffu);
    const std::string framed = "$" + packet + tail;
    REQUIRE(::write(debugger, framed.data(), framed.size()) == static_cast<ssize_t>(framed.size()));
    std::string answer;
    const auto deadline = Clock::now() + std::chrono::seconds(10);
    for (;;) {
      REQUIRE(Clock::now() < deadline);
      pollfd waited{debugger, POLLIN, 0};
      ::poll(&waited, 1, 50);
      char c = 0;
      while (::recv(debugger, &c, 1, MSG_DONTWAIT) == 1) answer.push_back(c);
      const std::size_t begin = answer.find('$'), end = answer.find('#');
      if (begin == std::string::npos || end == std::string::npos || answer.size() < end + 3) continue;
      REQUIRE(::write(debugger, "+", 1) == 1);
      const std::string body = answer.substr(begin + 1, end - begin - 1);
      answer.erase(0, end + 3);
      if (body.substr(0, 1) != "T") return body;  // that says that it stopped
    }
  }

  /// CRC-16 of the serial line, MODBUS over Serial Line V1.02, 6.2.2: of a frame with its own CRC it is 0.
  static std::uint16_t crc_of(const Bytes& bytes) {
    std::uint16_t crc = 0xffff;
    for (const std::uint8_t byte : bytes) {
      crc = static_cast<std::uint16_t>(crc ^ byte);
      for (int i = 0; i < 8; ++i)
        crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0xa001 : crc >> 1);
    }
    return crc;
  }

  test::Emulator emulator_;
  int socket_ = -1;
};

bus::Snapshot snapshot_of(Machine& machine) {
  const Bytes answer = machine.ask({4, 0, 0, 0, static_cast<std::uint8_t>(bus::kInputWords)});
  REQUIRE(answer.size() == 2u + 2u * bus::kInputWords);
  std::array<std::uint16_t, bus::kInputWords> words{};
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = static_cast<std::uint16_t>(answer[2 + 2 * i] << 8 | answer[3 + 2 * i]);
  return bus::from_words(words);
}

/// The newest first.
std::vector<bus::LoggedFault> log_of(Machine& machine, std::size_t entries) {
  const auto count = static_cast<std::uint8_t>(entries * bus::kLogEntryWords);
  std::vector<bus::LoggedFault> log;
  if (count == 0) return log;
  const Bytes answer = machine.ask({4, bus::kLogBase >> 8, bus::kLogBase & 0xff, 0, count});
  REQUIRE(answer.size() == 2u + 2u * count);
  std::vector<std::uint16_t> words;
  for (std::size_t i = 2; i < answer.size(); i += 2)
    words.push_back(static_cast<std::uint16_t>(answer[i] << 8 | answer[i + 1]));
  for (std::size_t i = 0; i < entries; ++i)
    log.push_back(bus::logged_fault(std::span(words).subspan(i * bus::kLogEntryWords)));
  return log;
}

firmware::ImageHeader header_of(const BoardCase& board) {
  std::string path = image(board);
  path.replace(path.size() - 3, 3, "bin");
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  firmware::ImageHeader header;
  REQUIRE(bytes.size() >= firmware::kImageHeaderOffset + sizeof(header));
  std::memcpy(&header, bytes.data() + firmware::kImageHeaderOffset, sizeof(header));
  return header;
}

}  // namespace

TEST_CASE("each STM32F4 image starts, ticks every millisecond and tells who it is over Modbus") {
  if (cannot_run_here()) return;
  for (const BoardCase& board : kBoards) {
    INFO(board.name);
    Machine machine(board);
    const bus::Snapshot first = snapshot_of(machine);
    const firmware::ImageHeader header = header_of(board);
    CHECK(header.names.board.data() == std::string(board.name));
    CHECK(first.build_id == firmware::build_id(header));
    CHECK(first.firmware_version == header.names.firmware_version);
    // The clock of microseconds is a timer, the tick the processor's: QEMU's have clocks of their own, and
    // the image measures one by the other to a whole MHz of about 95.
    CHECK(first.last_interval_us == Approx(1000).epsilon(0.01));
    CHECK(first.longest_interval_us < 1500);
    bus::Snapshot later;
    for (int i = 0; i < 10 && later.uptime_ms < first.uptime_ms + 1100; ++i) later = snapshot_of(machine);
    CHECK(later.uptime_ms > first.uptime_ms);
    // No CAN: nobody answers, and the robot is told so. It commands nothing.
    CHECK(later.fault == static_cast<std::uint16_t>(control::Fault::peer_lost));
    CHECK(later.torque_nm == 0.0f);
    CHECK(later.coil_duty == 0.0f);
  }
}

TEST_CASE(
    "a running robot's whole tick takes no more instructions than its budget, and each stop on the bus is obeyed") {
  if (cannot_run_here()) return;
  const std::string elf = test::image("qemu_robot_tick");
  if (!std::filesystem::exists(elf)) return test::skip("no image qemu_robot_tick");
  const std::string command = "timeout 200 qemu-system-arm -M netduinoplus2 -kernel '" + elf +
                              "' -icount shift=0 -semihosting-config enable=on,target=native -display none "
                              "-monitor none -serial none 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::map<std::string, long> said;
  char name[32];
  for (long number = 0; std::fscanf(pipe, "%31s %ld", name, &number) == 2;) said[name] = number;
  REQUIRE(::pclose(pipe) == 0);
  // It ran, and one Modbus request followed the other: all input registers, all parameters, writing them all.
  CHECK(said["ticks_running"] > 4500);
  CHECK(said["modbus_answers"] > 400);
  CHECK(said["running_modbus"] > 1000);
  CHECK(said["idle_modbus"] > 2000);
  CHECK(said["worst_tick"] > 3000);
  CHECK(said["worst_tick"] <= 11000);
  // The same binary under the attack of tests/sil/stop_test.cpp: 3 times 256 stops, and seven hosts of 500 each.
  CHECK(said["stops_at_offsets"] == 256);
  CHECK(said["stops_of_versions"] == 256);
  CHECK(said["stops_by_registers"] == 256);
  CHECK(said["stops_beside"] == 7);
  CHECK(said["attacks_on_hopping"] == 3 * 256 + 2 * 7);
  // For the table of scripts/size-budget.
  std::ofstream(elf + ".measured") << "worst_tick " << said["worst_tick"] << "\n";
}

TEST_CASE("a stack that overflows ends in the exception's handler and a new start, with all else as it was") {
  if (cannot_run_here()) return;
  // The stack lies at the bottom of the RAM (firmware/chip/stm32f4/stm32f4x5xg.ld): what does not fit between
  // its pointer and there is written below it. Of the least depths the first to overflow is the frame that
  // the processor pushes for the tick's exception, of the others a function's.
  constexpr std::uint32_t kStackBottom = 0x20000000;
  for (const std::uint32_t left : {0u, 64u, 400u}) {
    INFO("bytes left: " << left);
    Machine machine(kBoards[0]);
    bus::Snapshot before;
    for (int i = 0; i < 30 && before.uptime_ms < 1100; ++i) before = snapshot_of(machine);
    REQUIRE(before.starts == 1);
    const std::vector<bus::LoggedFault> log_before = log_of(machine, before.logged_faults);

    machine.set_stack_pointer(kStackBottom + left);
    const bus::Snapshot after = snapshot_of(machine);
    CHECK(after.starts == 2);
    CHECK(after.uptime_ms < before.uptime_ms);
    CHECK(after.torque_nm == 0.0f);
    CHECK(after.coil_duty == 0.0f);
    // The log, in the RAM that a start leaves alone, is whole: what it had, and the handler's line.
    const std::vector<bus::LoggedFault> log_after = log_of(machine, after.logged_faults);
    REQUIRE(log_after.size() > log_before.size());
    const std::size_t newer = log_after.size() - log_before.size() - 1;
    CHECK(log_after[newer].fault == static_cast<std::uint16_t>(control::Fault::processor_fault));
    CHECK(log_after[newer].starts == 1);
    CHECK(log_after[newer].tick == bus::kNoTick);
    for (std::size_t i = 0; i < log_before.size(); ++i) {
      CHECK(log_after[newer + 1 + i].fault == log_before[i].fault);
      CHECK(log_after[newer + 1 + i].tick == log_before[i].tick);
    }
  }
}

TEST_CASE("a parameter of the image is read and written over Modbus") {
  if (cannot_run_here()) return;
  Machine machine(kBoards[0]);
  const bus::Parameter& parameter = bus::kParameters[0];
  const std::uint16_t address = bus::address_of(parameter);
  const auto high = static_cast<std::uint8_t>(address >> 8), low = static_cast<std::uint8_t>(address);
  const Bytes before = machine.ask({3, high, low, 0, 2});
  REQUIRE(before.size() == 6);
  const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(before[2]) << 24 |
                                          static_cast<std::uint32_t>(before[3]) << 16 |
                                          static_cast<std::uint32_t>(before[4]) << 8 | before[5]);
  CHECK(value == parameter.get(control::Config{}));
  const float wanted = 0.5f * (value + parameter.most);
  const auto bits = std::bit_cast<std::uint32_t>(wanted);
  const Bytes written = machine.ask({16, high, low, 0, 2, 4, static_cast<std::uint8_t>(bits >> 24),
                                     static_cast<std::uint8_t>(bits >> 16),
                                     static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits)});
  CHECK(written == Bytes{16, high, low, 0, 2});
  const Bytes after = machine.ask({3, high, low, 0, 2});
  REQUIRE(after.size() == 6);
  CHECK(std::equal(after.begin() + 2, after.end(),
                   Bytes{static_cast<std::uint8_t>(bits >> 24), static_cast<std::uint8_t>(bits >> 16),
                         static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits)}
                       .begin()));
}
