// What furculad says to the service manager, and about boards that are not there.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>
#include <string>

#include "boards/linux_sbc/gpio.hpp"
#include "boards/linux_sbc/notify.hpp"
#include "host/core/timer.hpp"
#include "host/rig/gpio_sim.hpp"
#include "host/rig/rig.hpp"
#include "host/socketcan/can_socket.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("the service manager gets datagrams on the socket that it named, an abstract one too") {
  const std::string name = "furculad-test-" + std::to_string(::getpid());
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  REQUIRE(fd >= 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, name.data(), name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  REQUIRE(::bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0);
  ::setenv("NOTIFY_SOCKET", ("@" + name).c_str(), 1);
  ::setenv("WATCHDOG_USEC", "500000", 1);
  {
    const linux_sbc::ServiceManager manager;
    CHECK(manager.watchdog_period().count() == 250000);
    CHECK(manager.tell("READY=1"));
    char said[32] = {};
    CHECK(::recv(fd, said, sizeof(said), 0) == 7);
    CHECK(std::string(said) == "READY=1");
  }
  ::setenv("WATCHDOG_PID", "1", 1);  // somebody else's
  CHECK(linux_sbc::ServiceManager().watchdog_period().count() == 0);
  ::unsetenv("NOTIFY_SOCKET");
  ::unsetenv("WATCHDOG_USEC");
  ::unsetenv("WATCHDOG_PID");
  ::close(fd);
  const linux_sbc::ServiceManager nobody;
  CHECK_FALSE(nobody.tell("READY=1"));
}

TEST_CASE("a CAN interface or a GPIO chip that is not there is one error that names it") {
  const auto open_can = [] { socketcan::CanSocket("nocan7", {}); };
  CHECK_THROWS_AS(open_can(), socketcan::CanError);
  CHECK_THROWS_WITH(open_can(), Contains("nocan7") || Contains("SocketCAN"));
  CHECK_THROWS_WITH(socketcan::CanSocket("a name that is too long", {}),
                    Contains("no name of a CAN interface"));
  const linux_sbc::GpioLine line{"no-such-chip", "contact", false};
  CHECK_THROWS_AS(linux_sbc::Gpio(line, nullptr), linux_sbc::GpioError);
  CHECK_THROWS_WITH(linux_sbc::Gpio(line, nullptr), Contains("'no-such-chip'"));
  CHECK_THROWS_WITH(rig::GpioSim("/no/such/bank"), Contains("/no/such/bank/sim_gpio0/pull"));
}

TEST_CASE("the timer keeps to its grid, and counts the ticks that it missed") {
  core::Timer timer(1'000'000);
  timer.start();
  const std::int64_t begin_ns = core::monotonic_ns();
  for (int i = 0; i < 5; ++i) CHECK(timer.wait() >= 0);
  CHECK(timer.woke_ns() - begin_ns >= 5'000'000 - 50'000);
  const std::uint64_t before = timer.overruns();
  const timespec pause{0, 5'200'000};
  ::nanosleep(&pause, nullptr);
  CHECK(timer.wait() >= 4'000'000);
  CHECK(timer.overruns() >= before + 4);
}
