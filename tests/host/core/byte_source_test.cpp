// Files and pipes as sources of bytes: a pipe that nobody writes to is refused, all others are read.
#include "host/core/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <thread>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string read_all(const std::string& path) {
  core::FileSource source(path, "a log");
  std::string all;
  char part[7];
  while (const std::size_t n = source.read(part, sizeof part)) all.append(part, n);
  return all;
}

double seconds_of(const std::function<void()>& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

struct Fifo {
  Fifo() { REQUIRE(::mkfifo(path.c_str(), 0600) == 0); }
  test::TemporaryFolder folder;
  std::string path = folder.path() + "/fifo";
};

}  // namespace

TEST_CASE("a FIFO that no program writes to is refused after two seconds") {
  const Fifo fifo;
  std::string message;
  const double took_s = seconds_of([&] { message = test::error_message([&] { read_all(fifo.path); }); });
  CHECK(message == fifo.path + ": is a pipe that no program writes to (waited 2 s); expected a log");
  CHECK(took_s >= 2.0);
  CHECK(took_s < 10.0);
}

TEST_CASE("a FIFO whose writer comes late and writes slowly is read to its end") {
  const Fifo fifo;
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const int fd = ::open(fifo.path.c_str(), O_WRONLY | O_CLOEXEC);
    // Longer than a FIFO without a writer is waited for.
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    for (int i = 0; i < 3; ++i) {
      static_cast<void>(::write(fd, "0123456789", 10));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ::close(fd);
  });
  std::string all;
  CHECK_NOTHROW(all = read_all(fifo.path));
  writer.join();
  CHECK(all == "012345678901234567890123456789");
}

TEST_CASE("a writer that came and wrote nothing is the end, at once") {
  const Fifo fifo;
  std::thread writer([&] { ::close(::open(fifo.path.c_str(), O_WRONLY | O_CLOEXEC)); });
  std::string all = "x";
  CHECK(seconds_of([&] { all = read_all(fifo.path); }) < 1.9);
  writer.join();
  CHECK(all.empty());
}

TEST_CASE("a pipe without a name, as a shell's <(...), is read, though its writer is gone") {
  int ends[2];
  REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
  REQUIRE(::write(ends[1], "a,b\n", 4) == 4);
  ::close(ends[1]);
  CHECK(read_all("/dev/fd/" + std::to_string(ends[0])) == "a,b\n");
  CHECK(read_all("/dev/fd/" + std::to_string(ends[0])).empty());
  ::close(ends[0]);
}

TEST_CASE("the program refuses a FIFO as a log and as a model, with status 3") {
  const Fifo fifo;
  const test::Ran log = test::run_furcula({"check", "--machine", "hopper", fifo.path}, 20);
  CHECK(log.status == 3);
  CHECK_THAT(log.err, Contains("is a pipe that no program writes to (waited 2 s); expected a log (CSV)"));
  const test::Ran model = test::run_furcula({"sim", "--model", fifo.path, "--out", "/dev/null"}, 20);
  CHECK(model.status == 3);
}

TEST_CASE("what stands in a log reaches the terminal without its escape sequences") {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("a\x1b[31m.csv", "time_s,he\x1b[2Jight_m\n0,1\n");
  const test::Ran ran = test::run_furcula({"check", "--machine", "hopper", path});
  CHECK(ran.status == 3);
  CHECK(ran.err.find('\x1b') == std::string::npos);
  CHECK_THAT(ran.err, Contains("a\\x1b[31m.csv") && Contains("he\\x1b[2Jight_m"));
}
