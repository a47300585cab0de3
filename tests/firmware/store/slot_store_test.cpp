// The store of the parameters: what was saved is loaded, and a power cut at any step loses nothing.
#include "firmware/store/slot_store.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/firmware/store/flash_model.hpp"

namespace {

using namespace furcula;
using firmware::LoadReason;
using Flash = test::FlashModel<64>;
using Store = firmware::SlotStore<Flash>;
using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kLayout = 7;

static_assert(firmware::SlotFlash<Flash>);

Bytes drawn(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

/// Saves; whether the power was cut meanwhile.
bool is_cut_while_saving(Flash& flash, const Bytes& bytes) {
  Status status = Status::invalid;
  try {
    status = Store(flash, kLayout).save(bytes);
  } catch (const test::PowerCut&) {
    return true;
  }
  REQUIRE(status == Status::ok);
  return false;
}

struct Found {
  LoadReason reason;
  Bytes bytes;
};
Found load(Flash& flash, std::size_t size) {
  Found found{LoadReason::damaged, Bytes(size, 0xee)};
  found.reason = Store(flash, kLayout).load(found.bytes).reason;
  return found;
}

}  // namespace

TEST_CASE("what was saved last is loaded, of any size, through many turns of the two slots") {
  Flash flash(1);
  for (std::uint32_t n = 0; n < 50; ++n) {
    const Bytes bytes = drawn(n, n);
    REQUIRE(Store(flash, kLayout).save(bytes) == Status::ok);
    Bytes seen(n, 0xee);
    const firmware::Loaded loaded = Store(flash, kLayout).load(seen);
    CHECK(loaded.status() == Status::ok);
    CHECK(loaded.slot == n % 2);
    CHECK(loaded.sequence == n + 1);
    CHECK(seen == bytes);
  }
}

TEST_CASE("a power cut at any step of erasing and programming leaves the old record or the new one") {
  const Bytes old_bytes = drawn(101, 10), new_bytes = drawn(101, 11);
  std::size_t cuts = 0, new_ones = 0;
  for (const int saves_before : {1, 2}) {
    std::uint32_t steps = 0;
    for (std::uint32_t step = 1; steps == 0 || step <= steps; ++step) {
      for (std::uint32_t seed = 0; seed < 20; ++seed) {
        Flash flash(seed);
        for (int i = 0; i < saves_before; ++i)
          REQUIRE(Store(flash, kLayout).save(i + 1 == saves_before ? old_bytes : drawn(101, 12)) ==
                  Status::ok);
        const std::uint32_t before = flash.steps();
        flash.cut_at(step);
        const bool cut = is_cut_while_saving(flash, new_bytes);
        if (!cut) steps = flash.steps() - before;
        INFO("cut at step " << step << " after " << saves_before << " saves, seed " << seed);
        const Found found = load(flash, 101);
        REQUIRE(found.reason == LoadReason::loaded);
        if (!cut) {
          CHECK(found.bytes == new_bytes);
          continue;
        }
        ++cuts;
        const bool is_new = found.bytes == new_bytes;
        new_ones += is_new;
        CHECK((is_new || found.bytes == old_bytes));
        // And the memory is not stuck: the next save is taken.
        flash.cut_at(0);
        REQUIRE(Store(flash, kLayout).save(new_bytes) == Status::ok);
        CHECK(load(flash, 101).bytes == new_bytes);
      }
    }
    // 4 words of header, 26 of data and the CRC, four steps each, after the erase's.
    CHECK(steps == Flash::kEraseSteps + 4 * (4 + 26 + 1));
  }
  // All steps were cut, both times; in the very last one the word may have become whole all the same.
  CHECK(cuts == 2 * 20 * (Flash::kEraseSteps + 4 * 31));
  CHECK(new_ones < cuts / 50);
  WARN(cuts << " power cuts, nothing lost; the new record was whole after " << new_ones);
}

TEST_CASE("cuts one after the other, also while repairing, never lose the last record that was whole") {
  std::mt19937 random(3);
  std::size_t cuts = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Flash flash(seed);
    Bytes whole = drawn(60, 1000 + seed);
    REQUIRE(Store(flash, kLayout).save(whole) == Status::ok);
    for (std::uint32_t n = 0; n < 20; ++n) {
      const Bytes next = drawn(60, 2000 + 20 * seed + n);
      flash.cut_at(static_cast<std::uint32_t>(random() % 100));
      if (is_cut_while_saving(flash, next))
        ++cuts;
      else
        whole = next;
      const Found found = load(flash, 60);
      REQUIRE(found.reason == LoadReason::loaded);
      REQUIRE((found.bytes == whole || found.bytes == next));
      whole = found.bytes;
    }
  }
  CHECK(cuts > 2000);
}

TEST_CASE("the first save of all, cut, leaves nothing to load, and says so") {
  for (std::uint32_t step = 1; step <= 8 + 4 * 20; ++step) {
    Flash flash(step);
    flash.cut_at(step);
    CHECK_THROWS_AS(Store(flash, kLayout).save(drawn(60, 1)), test::PowerCut);
    const Found found = load(flash, 60);
    if (found.reason == LoadReason::loaded)
      CHECK(found.bytes == drawn(60, 1));  // the last word's last byte became whole
    else
      CHECK(found.bytes == Bytes(60, 0xee));  // the defaults stay
  }
}

TEST_CASE("a reason is given for what cannot be loaded, and the defaults stay") {
  Flash flash(1);
  CHECK(load(flash, 12).reason == LoadReason::blank);
  REQUIRE(Store(flash, kLayout).save(drawn(12, 1)) == Status::ok);

  Bytes seen(12, 0xee);
  CHECK(Store(flash, kLayout + 1).load(seen).reason == LoadReason::other_layout);
  CHECK(Store(flash, kLayout + 1).load(seen).status() == Status::invalid);
  CHECK(seen == Bytes(12, 0xee));
  CHECK(load(flash, 11).reason == LoadReason::other_layout);
  CHECK(load(flash, 11).bytes == Bytes(11, 0xee));
  // A shorter record than there is room for is loaded, and says how long it is.
  Bytes room(20, 0xee);
  CHECK(Store(flash, kLayout).load(room).bytes == 12);
  CHECK(Bytes(room.begin(), room.begin() + 12) == drawn(12, 1));
  CHECK(Bytes(room.begin() + 12, room.end()) == Bytes(8, 0xee));

  // Any bit that flips in the only record.
  for (std::uint32_t word = 0; word < 4 + 3 + 1; ++word)
    for (int bit = 0; bit < 32; ++bit) {
      flash.word(0, word) ^= 1u << bit;
      REQUIRE(load(flash, 12).reason == LoadReason::damaged);
      REQUIRE(load(flash, 12).bytes == Bytes(12, 0xee));
      flash.word(0, word) ^= 1u << bit;
    }
  CHECK(load(flash, 12).reason == LoadReason::loaded);
}

TEST_CASE("a damaged newest record falls back to the one before") {
  Flash flash(1);
  REQUIRE(Store(flash, kLayout).save(drawn(12, 1)) == Status::ok);
  REQUIRE(Store(flash, kLayout).save(drawn(12, 2)) == Status::ok);
  flash.word(1, 5) &= 0xfffffff0u;
  CHECK(load(flash, 12).bytes == drawn(12, 1));
}

TEST_CASE("the number of a record may wrap") {
  Flash flash(1);
  REQUIRE(Store(flash, kLayout).save(drawn(8, 1)) == Status::ok);
  // The record is given the last number there is, and its CRC anew.
  flash.word(0, 2) = 0xffffffffu;
  Crc32 crc;
  for (std::uint32_t i = 0; i < 6; ++i) crc.add_word(flash.word(0, i));
  flash.word(0, 6) = crc.value();
  REQUIRE(load(flash, 8).reason == LoadReason::loaded);
  REQUIRE(Store(flash, kLayout).save(drawn(8, 2)) == Status::ok);
  CHECK(flash.word(1, 2) == 0);
  CHECK(load(flash, 8).bytes == drawn(8, 2));
}

TEST_CASE("what does not fit, and a memory that refuses, are reported") {
  Flash flash(1);
  CHECK(Store::kMostBytes == 4 * (64 - 5));
  CHECK(Store(flash, kLayout).save(drawn(Store::kMostBytes, 1)) == Status::ok);
  CHECK(Store(flash, kLayout).save(drawn(Store::kMostBytes + 1, 1)) == Status::invalid);
  flash.refuse(true);
  CHECK(Store(flash, kLayout).save(drawn(8, 2)) == Status::disconnected);
  CHECK(load(flash, Store::kMostBytes).bytes == drawn(Store::kMostBytes, 1));
}

TEST_CASE("a memory of any content is loaded from or refused, without reading beyond a slot") {
  std::mt19937 random(5);
  for (int n = 0; n < 2000; ++n) {
    Flash flash(1);
    for (unsigned slot = 0; slot < 2; ++slot)
      for (std::uint32_t i = 0; i < 64; ++i) flash.word(slot, i) = static_cast<std::uint32_t>(random());
    flash.word(0, 0) = Store::kMagic;
    flash.word(0, 3) = static_cast<std::uint32_t>(random() >> (random() % 32));
    CHECK(load(flash, 12).reason == LoadReason::damaged);
  }
}
