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
#include <string>
#include <vector>

#include "firmware/startup/image_header.hpp"
#include "furcula/bus/parameters.hpp"
#include "furcula/bus/registers.hpp"
#include "furcula/control/fault.hpp"
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

std::string image(const BoardCase& board) { return FURCULA_IMAGES "/" + std::string(board.name) + ".elf"; }

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
    emulator_.start(image(board), more);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(socket_path.size() < sizeof(address.sun_path));
    std::memcpy(address.sun_path, socket_path.c_str(), socket_path.size());
    socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto deadline = Clock::now() + std::chrono::seconds(20);
    while (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
      REQUIRE(Clock::now() < deadline);
      ::poll(nullptr, 0, 10);
    }
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
        pollfd waited{socket_, POLLIN, 0};
        ::poll(&waited, 1, 50);
        std::uint8_t byte = 0;
        while (::recv(socket_, &byte, 1, MSG_DONTWAIT) == 1) answer.push_back(byte);
        if (answer.size() >= 5 && crc_of(answer) == 0 && answer[0] == 1)
          return {answer.begin() + 1, answer.end() - 2};
      }
    }
    return {};
  }

 private:
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

TEST_CASE("a running robot's whole tick, with its buses, takes no more instructions than its budget") {
  if (cannot_run_here()) return;
  const std::string elf = FURCULA_IMAGES "/qemu_robot_tick.elf";
  if (!std::filesystem::exists(elf)) return test::skip("no image qemu_robot_tick");
  const std::string command = "timeout 60 qemu-system-arm -M netduinoplus2 -kernel '" + elf +
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
  CHECK(said["worst_tick"] <= 8000);
  // For the table of scripts/size-budget.
  std::ofstream(elf + ".measured") << "worst_tick " << said["worst_tick"] << "\n";
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
