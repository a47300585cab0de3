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
