// libmodbus as the master of the emulated Cortex-M4F: a node whose USART is a pty of QEMU's.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "furcula/bus/modbus_rtu.hpp"
#include "host/core/error.hpp"
#include "host/modbus/client.hpp"
#include "tests/paths.hpp"
#include "tests/pil/emulator.hpp"

namespace {

using namespace furcula;
using Bytes = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

bool cannot_run_here() { return test::cannot_emulate({test::image("qemu_modbus")}); }

/// QEMU with the image, in real time: where time runs by instructions it hands over a byte too seldom.
class Machine {
 public:
  Machine() {
    emulator_.start(test::image("qemu_modbus"),
                    {"-semihosting-config", "enable=on,target=native", "-serial", "pty"});
    const auto deadline = Clock::now() + 20s;
    while (pty_.empty() && Clock::now() < deadline) {
      ::poll(nullptr, 0, 20);
      std::ostringstream said;
      said << std::ifstream(emulator_.said_path()).rdbuf();
      const std::string text = said.str();
      const std::size_t at = text.find("/dev/pts/");
      if (at != std::string::npos && text.find(' ', at) != std::string::npos)
        pty_ = text.substr(at, text.find(' ', at) - at);
    }
    REQUIRE_FALSE(pty_.empty());
    // Held open: QEMU looks for somebody at the other end but once a second.
    line_ = ::open(pty_.c_str(), O_RDWR | O_NOCTTY);
    REQUIRE(line_ >= 0);
  }
  ~Machine() { ::close(line_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  const std::string& pty() const { return pty_; }

  /// A master, once QEMU has noticed that somebody is at the other end of its pty.
  modbus::Client connect() const {
    const modbus::Port port = modbus::parse_port("modbus:" + pty_ + "@1200");
    for (int attempt = 0;; ++attempt) try {
        return modbus::Client(port);
      } catch (const core::DataError&) {
        if (attempt == 20) throw;
      }
  }

 private:
  test::Emulator emulator_;
  std::string pty_;
  int line_ = -1;
};

void settle(modbus::Client& client) {
  const auto deadline = Clock::now() + 20s;
  while (client.snapshot().state == static_cast<int>(bus::NodeState::starting))
    REQUIRE(Clock::now() < deadline);
}

Bytes framed(Bytes frame) {
  const std::uint16_t crc = bus::crc16(frame);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xff));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

/// Bytes as they are on the line, and what comes back until it is quiet.
Bytes raw(const Machine& machine, const Bytes& bytes) {
  const int fd = ::open(machine.pty().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  REQUIRE(fd >= 0);
  REQUIRE(::write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  Bytes answer;
  pollfd waited{fd, POLLIN, 0};
  while (::poll(&waited, 1, answer.empty() ? 1000 : 200) > 0) {
    std::uint8_t byte = 0;
    if (::read(fd, &byte, 1) != 1) break;
    answer.push_back(byte);
  }
  ::close(fd);
  return answer;
}

Bytes request_frame(std::uint16_t session, bus::Request request) {
  return framed({1, 16, 0, 0, 0, 3, 6, 0x46, 0x55, static_cast<std::uint8_t>(session >> 8),
                 static_cast<std::uint8_t>(session & 0xff), 0, static_cast<std::uint8_t>(request)});
}

}  // namespace

TEST_CASE("libmodbus reads and writes parameters of the emulated board, 200 round trips") {
  if (cannot_run_here()) return;
  const Machine machine;
  modbus::Client client = machine.connect();
  CHECK(client.names().board == "qemu_modbus");
  CHECK(client.snapshot().height_m == 0.22f);
  const bus::Parameter& period = *bus::parameter_named("torque_period_s");
  int repeats = 0;
  // A pause of the emulator within a frame makes two of it, and the master asks again.
  const auto again = [&](auto ask) {
    for (;;) try {
        return ask();
      } catch (const core::DataError&) {
        if (++repeats > 10) throw;
      }
  };
  for (int i = 0; i < 100; ++i) {
    const float wanted = 0.2f + 0.001f * static_cast<float>(i);
    again([&] { client.write(period, wanted); });
    REQUIRE(again([&] { return client.parameters(); })[period.number - 1u] == wanted);
  }
  const bus::Snapshot s = again([&] { return client.snapshot(); });
  CHECK(s.bus_requests >= 200);
  CHECK(s.bus_exceptions == 0);
  CHECK(s.parameter_origin == static_cast<int>(bus::ParameterOrigin::changed));
  WARN("repeated " << repeats << " of 200; frames dropped by the board: " << s.bus_bad_frames);
}

TEST_CASE("the emulated board runs when it is armed and told to, refuses parameters then, and stops") {
  if (cannot_run_here()) return;
  const Machine machine;
  modbus::Client client = machine.connect();
  settle(client);
  const bus::Snapshot idle = client.snapshot();
  CHECK(idle.state == static_cast<int>(bus::NodeState::idle));
  CHECK(idle.torque_nm == 0.0f);
  CHECK_THROWS_AS(client.request(bus::Request::hop), modbus::Refused);
  client.request(bus::Request::arm);
  client.request(bus::Request::hop);
  float most_nm = 0.0f;
  for (int i = 0; i < 20; ++i) most_nm = std::max(most_nm, std::abs(client.snapshot().torque_nm));
  CHECK(most_nm > 0.5f);  // of a sine of 2 N m, looked at now and then
  CHECK(most_nm <= 2.0f);
  CHECK_THROWS_AS(client.write(*bus::parameter_named("torque_period_s"), 0.2f), modbus::Refused);
  CHECK_THROWS_AS(client.request(bus::Request::save), modbus::Refused);
  client.request(bus::Request::stop);
  const bus::Snapshot stopped = client.snapshot();
  CHECK(stopped.state == static_cast<int>(bus::NodeState::idle));
  CHECK(stopped.reason == static_cast<int>(bus::Reason::stopped));
  CHECK(stopped.torque_nm == 0.0f);
  CHECK(stopped.fault == 0);
}

TEST_CASE("the emulated board stops by itself when the host that made it run falls silent") {
  if (cannot_run_here()) return;
  const Machine machine;
  modbus::Client client = machine.connect();
  settle(client);
  client.write(*bus::parameter_named("host_timeout_s"), 0.05f);
  client.request(bus::Request::arm);
  client.request(bus::Request::hop);
  std::this_thread::sleep_for(std::chrono::seconds(1));  // far more, also where the emulator is slow
  const bus::Snapshot stopped = client.snapshot();
  CHECK(stopped.state == static_cast<int>(bus::NodeState::idle));
  CHECK(stopped.reason == static_cast<int>(bus::Reason::host_silent));
  CHECK(stopped.torque_nm == 0.0f);
  CHECK(stopped.stale_stops == 1);
}

TEST_CASE(
    "a frame with a wrong checksum is not answered, and a repeated one is refused by the emulated board") {
  if (cannot_run_here()) return;
  const Machine machine;
  modbus::Client client = machine.connect();
  settle(client);
  const bus::Snapshot before = client.snapshot();
  Bytes arm = request_frame(before.session, bus::Request::arm);
  Bytes wrong = arm;
  wrong.back() ^= 1;
  CHECK(raw(machine, wrong).empty());
  CHECK(client.snapshot().state == static_cast<int>(bus::NodeState::idle));
  CHECK(client.snapshot().bus_bad_frames > before.bus_bad_frames);
  CHECK(raw(machine, arm) == framed({1, 16, 0, 0, 0, 3}));
  client.request(bus::Request::stop);
  CHECK(raw(machine, arm) == framed({1, 0x90, 4}));
  const bus::Snapshot after = client.snapshot();
  CHECK(after.state == static_cast<int>(bus::NodeState::idle));
  CHECK(after.last_refusal == static_cast<int>(bus::Refusal::wrong_session));
}
