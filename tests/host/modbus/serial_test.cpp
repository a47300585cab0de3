// libmodbus as RTU master, on one end of a pty, against our server on the other.
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "furcula/bus/modbus_rtu.hpp"
#include "host/modbus/client.hpp"
#include "tests/common/bus/node_board.hpp"

using namespace furcula;

namespace {

/// A standing robot on a pty, served on a thread of its own.
class SerialRobot {
 public:
  SerialRobot() {
    fd_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(fd_ >= 0);
    REQUIRE(::grantpt(fd_) == 0);
    REQUIRE(::unlockpt(fd_) == 0);
    path_ = ::ptsname(fd_);  // NOLINT(concurrency-mt-unsafe): one thread so far
    termios raw{};
    ::tcgetattr(fd_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(fd_, TCSANOW, &raw);
    line_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY);  // kept open, so that the other end never hangs up
    bench_.settle();
    thread_ = std::thread([this] { serve(); });
  }
  ~SerialRobot() {
    ended_ = true;
    thread_.join();
    ::close(line_);
    ::close(fd_);
  }
  SerialRobot(const SerialRobot&) = delete;
  SerialRobot& operator=(const SerialRobot&) = delete;

  std::string port() const { return "modbus:" + path_ + "@115200"; }
  /// Puts bytes on the line, as a master would.
  void disturb(const std::string& bytes) const {
    REQUIRE(::write(line_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

 private:
  static std::uint32_t now_us() {
    return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                          std::chrono::steady_clock::now().time_since_epoch())
                                          .count());
  }
  void serve() {
    bus::RtuServer server(1, 1750);
    while (!ended_) {
      bench_.tick();
      pollfd waited{fd_, POLLIN, 0};
      std::uint8_t bytes[300];
      if (::poll(&waited, 1, 1) > 0) {
        const ssize_t n = ::read(fd_, bytes, sizeof bytes);
        for (ssize_t i = 0; i < n; ++i) server.receive(bytes[i], now_us());
        continue;
      }
      server.poll(bench_.registers, bench_.node.bus_counts(), now_us());
      std::string out;
      for (; server.answering(); server.advance()) out.push_back(static_cast<char>(server.next()));
      if (!out.empty() && ::write(fd_, out.data(), out.size()) < 0) return;
    }
  }

  test::Bench bench_;
  std::string path_;
  int fd_ = -1, line_ = -1;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace

TEST_CASE("libmodbus reads and writes our server over a serial line, 100 times of 100") {
  SerialRobot robot;
  modbus::Client client(modbus::parse_port(robot.port()));
  const bus::Parameter& period = *bus::parameter_named("torque_period_s");
  for (int i = 0; i < 100; ++i) {
    const float wanted = 0.2f + 0.001f * static_cast<float>(i);
    client.write(period, wanted);
    REQUIRE(client.parameters()[period.number - 1u] == wanted);
  }
  const bus::Snapshot s = client.snapshot();
  CHECK(s.height_m == Approx(0.22f));
  CHECK(s.bus_bad_frames == 0);
  CHECK(s.bus_exceptions == 0);
  CHECK(s.bus_requests == 201);  // the version's, and these; not yet this one
}

TEST_CASE("the names, the arming sequence and refusals go over a serial line") {
  SerialRobot robot;
  modbus::Client client(modbus::parse_port(robot.port()));
  CHECK(client.names().board == "test_board");
  client.request(bus::Request::arm);
  client.request(bus::Request::hop);
  CHECK(client.snapshot().state == static_cast<int>(bus::NodeState::running));
  CHECK_THROWS_AS(client.write(*bus::parameter_named("torque_period_s"), 0.2f), modbus::Refused);
  client.request(bus::Request::stop);
  CHECK(client.snapshot().state == static_cast<int>(bus::NodeState::idle));
}

TEST_CASE("noise on the line is dropped and counted, and the next request is answered") {
  SerialRobot robot;
  modbus::Client client(modbus::parse_port(robot.port()));
  robot.disturb("\x01\x06\x01\x02");
  robot.disturb(std::string(700, '\x55'));
  robot.disturb(std::string("\x01\x06\x00\x02\x00\x01\x00\x00", 8));  // a request with a wrong checksum
  const bus::Snapshot s = client.snapshot();
  CHECK(s.bus_bad_frames >= 3);
  CHECK(s.requests_taken == 0);
}
