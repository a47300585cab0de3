// The table of registers: there and back, and the numbers that others rely on.
#include "furcula/bus/registers.hpp"

#include <catch2/catch.hpp>
#include <set>
#include <vector>

#include "furcula/bus/node_words.hpp"
#include "furcula/control/clutch_sequencer.hpp"

using namespace furcula;

TEST_CASE("a snapshot goes through the registers and back to the bit, the more significant word first") {
  bus::Snapshot shown;
  std::uint32_t n = 0x3f810203u;
  for (const bus::InputRegister& r : bus::kInputRegisters) r.put(shown, n += 0x00010101u);
  const auto words = bus::to_words(shown);
  const bus::Snapshot read = bus::from_words(words);
  for (const bus::InputRegister& r : bus::kInputRegisters) {
    INFO(r.name);
    CHECK(r.get(read) == r.get(shown));
    CHECK(r.get(shown) != 0);
  }
  shown.height_m = 0.35f;  // 0x3eb33333
  CHECK(bus::to_words(shown)[18] == 0x3eb3);
  CHECK(bus::to_words(shown)[19] == 0x3333);
}

TEST_CASE("the registers have names of their own, and the parameters addresses of their own") {
  std::set<std::string_view> names;
  for (const bus::InputRegister& r : bus::kInputRegisters) CHECK(names.insert(r.name).second);
  CHECK(bus::kInputWords == 71);
  CHECK(bus::kLogBase == 512);
  CHECK(bus::kLogWords == 8 * 4);
  CHECK(bus::address_of(*bus::parameter_named("torque_shape")) == 256);
  CHECK(bus::address_of(*bus::parameter_named("leg_damping_nmsprad")) == 256 + 80);
}

TEST_CASE("an entry of the log of faults is four words, and what is not there is 0") {
  const bus::LoggedFault entries[] = {{0x00010002u, 19, 3}, {bus::kNoTick, 4, 2}};
  const auto words = bus::to_words(entries);
  CHECK(std::vector<std::uint16_t>(words.begin(), words.begin() + 9) ==
        std::vector<std::uint16_t>{19, 3, 1, 2, 4, 2, 0xffff, 0xffff, 0});
  const bus::LoggedFault second = bus::logged_fault(std::span(words).subspan(4));
  CHECK(second.fault == 4);
  CHECK(second.starts == 2);
  CHECK(second.tick == bus::kNoTick);
}

TEST_CASE("a board's id is FNV-1a of its name") {
  CHECK(bus::board_id("") == 0x811c9dc5u);  // the published vectors
  CHECK(bus::board_id("a") == 0xe40c292cu);
  CHECK(bus::board_id("foobar") == 0xbf9cf968u);
  CHECK(bus::version_number(1, 2, 3) == 0x00010203u);
}

TEST_CASE("the clutch's stages have the numbers that the register's text gives") {
  using control::ClutchStage;
  CHECK(static_cast<int>(ClutchStage::caught) == 0);
  CHECK(static_cast<int>(ClutchStage::releasing) == 1);
  CHECK(static_cast<int>(ClutchStage::folding) == 2);
  CHECK(static_cast<int>(ClutchStage::homing) == 3);
  CHECK(static_cast<int>(ClutchStage::catching) == 4);
  CHECK(static_cast<int>(ClutchStage::testing) == 5);
  CHECK(static_cast<int>(ClutchStage::aborting) == 6);
}
