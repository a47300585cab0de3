// The log of faults in memory that survives a reset.
#include "firmware/store/fault_log.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <random>

namespace {

using furcula::firmware::FaultLog;

/// A log in memory with what happened to be in it.
struct Memory {
  alignas(FaultLog) std::uint8_t bytes[sizeof(FaultLog)];
  explicit Memory(std::uint32_t seed) {
    std::mt19937 random(seed);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  }
  FaultLog& log() { return *reinterpret_cast<FaultLog*>(bytes); }
};

}  // namespace

TEST_CASE("noise after a power-up is an empty log") {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    Memory memory(seed);
    CHECK_FALSE(memory.log().begin());
    CHECK(memory.log().count() == 0);
    CHECK(memory.log().starts() == 1);
  }
}

TEST_CASE("faults are noted when they come, newest first, and kept over a reset") {
  Memory memory(1);
  FaultLog& log = memory.log();
  log.begin();
  for (std::uint32_t tick = 0; tick < 100; ++tick) log.note(tick, tick < 10 ? 0 : tick < 50 ? 3 : 0);
  log.note(100, 8);
  REQUIRE(log.count() == 2);
  CHECK(log.entry(0).fault == 8);
  CHECK(log.entry(0).tick == 100);
  CHECK(log.entry(1).fault == 3);
  CHECK(log.entry(1).tick == 10);

  CHECK(log.begin());  // a reset: the memory is as it was
  REQUIRE(log.count() == 2);
  log.note(5, 8);
  REQUIRE(log.count() == 3);
  CHECK(log.entry(0).tick == 5);
  CHECK(log.entry(0).starts == 2);
  CHECK(log.entry(1).starts == 1);
}

TEST_CASE("a run that an exception ended is known as such in the next one, and in no later one") {
  Memory memory(1);
  FaultLog& log = memory.log();
  log.begin();
  log.note(7, 3);
  log.note(furcula::bus::kNoTick, 19);
  CHECK_FALSE(log.last_run_ended_by(19));  // it is this run
  log.begin();
  CHECK(log.last_run_ended_by(19));
  CHECK_FALSE(log.last_run_ended_by(18));
  log.begin();
  CHECK_FALSE(log.last_run_ended_by(19));
  log.note(9, 19);  // noted by a tick
  log.begin();
  CHECK_FALSE(log.last_run_ended_by(19));
}

TEST_CASE("the last eight faults are kept") {
  Memory memory(1);
  memory.log().begin();
  for (std::uint8_t fault = 1; fault <= 20; ++fault) memory.log().note(fault * 10u, fault);
  REQUIRE(memory.log().count() == FaultLog::kEntries);
  for (std::uint32_t age = 0; age < FaultLog::kEntries; ++age)
    CHECK(memory.log().entry(age).fault == 20 - age);
}

TEST_CASE("a log with a byte changed is not believed") {
  Memory memory(1);
  memory.log().begin();
  memory.log().note(1, 3);
  memory.bytes[0] ^= 0x10;
  CHECK_FALSE(memory.log().begin());
  CHECK(memory.log().count() == 0);
}
