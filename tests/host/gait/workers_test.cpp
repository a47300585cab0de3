// Jobs in processes of their own.
#include "host/gait/workers.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <map>
#include <stdexcept>

using furcula::gait::in_processes;
using furcula::gait::Tell;

TEST_CASE("results come in the jobs' order, whoever ran them, with what they told") {
  const auto job = [](std::size_t i, const Tell& tell) {
    tell("at " + std::to_string(i));
    return std::string(100000 * (i % 3), 'x') + std::to_string(i);
  };
  for (const unsigned processes : {1u, 2u, 7u}) {
    std::map<std::size_t, std::string> told;
    const auto out =
        in_processes(5, processes, job, [&](std::size_t i, std::string_view line) { told[i] = line; });
    REQUIRE(out.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
      CHECK(out[i] == std::string(100000 * (i % 3), 'x') + std::to_string(i));
      CHECK(told[i] == "at " + std::to_string(i));
    }
  }
}

TEST_CASE("what a job throws is thrown here, and a process that dies is said") {
  const auto fails = [](std::size_t i, const Tell&) -> std::string {
    if (i == 1) throw std::runtime_error("no result of 1");
    return "";
  };
  CHECK_THROWS_WITH(in_processes(4, 2, fails, {}), "no result of 1");
  const auto dies = [](std::size_t i, const Tell&) -> std::string {
    if (i == 2) ::_exit(3);
    return "";
  };
  CHECK_THROWS_AS(in_processes(4, 2, dies, {}), std::runtime_error);
}
