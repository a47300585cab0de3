// A node's parameters in two flash slots, through a restart and a power cut.
#include "firmware/store/parameter_slots.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "firmware/app/store.hpp"
#include "furcula/bus/parameter_image.hpp"
#include "tests/firmware/store/flash_model.hpp"

namespace {

using namespace furcula;
using Flash = test::FlashModel<1024>;
using Slots = firmware::ParameterSlots<Flash>;
static_assert(firmware::ParameterStore<Slots>);

}  // namespace

TEST_CASE("a configuration that is saved comes back parameter by parameter, also after a cut save") {
  Flash flash(1);
  control::Config config;
  config.torque.amplitude_nm = 1.25f;
  REQUIRE(Slots(flash).save(bus::to_image(config)) == Status::ok);

  control::Config changed = config;
  changed.torque.amplitude_nm = 1.75f;
  flash.cut_at(Flash::kEraseSteps + 100);
  CHECK_THROWS_AS(Slots(flash).save(bus::to_image(changed)), test::PowerCut);

  std::vector<std::uint8_t> image(bus::kImageBytesMax);
  const Result<std::size_t> size = Slots(flash).load(image);
  REQUIRE(size.ok());
  control::Config seen;
  REQUIRE(bus::from_image(std::span<const std::uint8_t>(image).first(size.value()), seen) == Status::ok);
  CHECK(seen.torque.amplitude_nm == 1.25f);
}

TEST_CASE("nothing saved is no parameters, and a damaged record is an error") {
  Flash flash(1);
  std::vector<std::uint8_t> image(bus::kImageBytesMax);
  REQUIRE(Slots(flash).load(image).ok());
  CHECK(Slots(flash).load(image).value() == 0);
  REQUIRE(Slots(flash).save(std::vector<std::uint8_t>(30, 1)) == Status::ok);
  flash.word(0, 5) ^= 1u;
  CHECK(Slots(flash).load(image).status() == Status::invalid);
}

TEST_CASE("saves are counted over restarts and cut ones, and the memory is worn after as many as it bears") {
  Flash flash(1);
  CHECK_FALSE(Slots(flash).is_worn());
  const std::vector<std::uint8_t> image(30, 1);
  for (std::uint32_t n = 1; n <= 3; ++n) {
    REQUIRE(Slots(flash).save(image) == Status::ok);
    CHECK(firmware::SlotStore(flash, firmware::kParameterRecordVersion).saves() == n);
  }
  flash.cut_at(Flash::kEraseSteps + 10);
  CHECK_THROWS_AS(Slots(flash).save(image), test::PowerCut);
  CHECK(firmware::SlotStore(flash, firmware::kParameterRecordVersion).saves() == 3);
  for (std::uint32_t n = 4; n <= firmware::kSavesMost; ++n) {
    REQUIRE_FALSE(Slots(flash).is_worn());
    REQUIRE(Slots(flash).save(image) == Status::ok);
  }
  CHECK(Slots(flash).is_worn());
  // Each of both sectors was erased half as often: less than the 10,000 times that one bears.
  CHECK(flash.erases(0) + flash.erases(1) == firmware::kSavesMost + 1);
  CHECK(flash.erases(0) < 10'000);
  CHECK(flash.erases(1) < 10'000);
}

TEST_CASE("ten saves in a row, then one each ten minutes, for ever less than one") {
  firmware::SaveLimit limit;
  int taken = 0;
  while (limit.take()) ++taken;
  CHECK(taken == 10);
  for (int ms = 1; ms < 600'000; ++ms) limit.tick();
  CHECK_FALSE(limit.take());
  limit.tick();
  CHECK(limit.take());
  CHECK_FALSE(limit.take());
  // Asked on each tick of a day: 144 times ten minutes.
  taken = 0;
  for (int ms = 0; ms < 86'400'000; ++ms) {
    limit.tick();
    if (limit.take()) ++taken;
  }
  CHECK(taken == 144);
  for (int ms = 0; ms < 20 * 600'000; ++ms) limit.tick();
  for (taken = 0; limit.take(); ++taken) {
  }
  CHECK(taken == 10);  // no more are kept
}
