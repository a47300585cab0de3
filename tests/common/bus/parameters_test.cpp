// The table of parameters: what may be set, what may not, and their image.
#include "furcula/bus/parameters.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "furcula/bus/parameter_image.hpp"

using namespace furcula;

namespace {

bool same(const control::Config& a, const control::Config& b) {
  for (const bus::Parameter& p : bus::kParameters)
    if (p.get(a) != p.get(b)) return false;
  return true;
}

}  // namespace

TEST_CASE(
    "each parameter has a name of its own, a built-in value within its bounds, and its unit in its name") {
  std::set<std::string_view> names;
  const control::Config defaults;
  for (const bus::Parameter& p : bus::kParameters) {
    INFO(p.name);
    CHECK(names.insert(p.name).second);
    CHECK(bus::allows(p, p.get(defaults)));
    CHECK(bus::parameter_named(p.name) == &p);
    CHECK(bus::parameter_numbered(p.number) == &p);
    const std::string name(p.name);
    if (p.unit == "m") CHECK((name.ends_with("_m") || name.ends_with("_per_count")));
    if (p.unit == "s") CHECK(name.ends_with("_s"));
    if (p.unit == "rad") CHECK(name.ends_with("_rad"));
    if (p.unit == "N m") CHECK(name.ends_with("_nm"));
    if (p.unit == "us") CHECK(name.ends_with("_us"));
  }
  CHECK(bus::parameter_named("torque") == nullptr);
  CHECK(bus::parameter_numbered(0) == nullptr);
  CHECK(bus::parameter_numbered(65535) == nullptr);
}

TEST_CASE("each parameter is a place of its own in the configuration") {
  for (const bus::Parameter& p : bus::kParameters) {
    INFO(p.name);
    control::Config config;
    const float other = p.get(config) == p.least ? p.most : p.least;
    p.put(config, other);
    CHECK(p.get(config) == other);
    const control::Config defaults;
    for (const bus::Parameter& q : bus::kParameters)
      if (&q != &p) CHECK(q.get(config) == q.get(defaults));
  }
}

TEST_CASE("what is no number, out of bounds or a fraction of what is whole is not set") {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  for (const bus::Parameter& p : bus::kParameters) {
    INFO(p.name);
    std::vector<float> wrong{
        nan,   infinite, -infinite, std::nextafter(p.least, -infinite), std::nextafter(p.most, infinite),
        3e38f, -3e38f};
    if (p.whole) wrong.push_back(p.least + 0.5f);
    for (const float x : wrong) {
      control::Config config;
      CHECK(bus::set(config, p, x) == Status::invalid);
      CHECK(same(config, control::Config{}));
    }
  }
}

TEST_CASE("a value within its bounds with which the configuration makes no sense is refused") {
  control::Config config;
  config.clutch.fitted = 1;
  const bus::Parameter& play = *bus::parameter_named("tooth_play_m");
  CHECK(bus::set(config, play, 0.006f) == Status::invalid);  // more than the pitch of 4.3 mm
  CHECK(config.clutch.tooth_play_m == 1.4286e-3f);
  CHECK(bus::set(config, play, 0.002f) == Status::ok);
  CHECK(config.clutch.tooth_play_m == 0.002f);
}

TEST_CASE("an image gives back each parameter to the bit, and is laid out as its header says") {
  control::Config config;
  config.torque = {control::ProfileShape::harmonic, 2.0f, 0.3f};
  config.clutch.fitted = 1;
  const bus::ParameterImage image = bus::to_image(config);
  CHECK(image[0] == 1);
  CHECK(image[1] == bus::kParameters.size());
  // The second entry: number 2, amplitude 2.0 = 0x40000000.
  const std::uint8_t entry[] = {2, 0, 0x00, 0x00, 0x00, 0x40};
  CHECK(std::memcmp(image.data() + 2 + 6, entry, sizeof entry) == 0);
  control::Config read;
  REQUIRE(bus::from_image(image, read) == Status::ok);
  CHECK(same(read, config));
}

TEST_CASE("an image with a number that the table does not have is read, one that is wrong changes nothing") {
  control::Config config;
  const std::vector<std::uint8_t> newer{1, 2, 0xe8, 0x03, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0x40};
  REQUIRE(bus::from_image(newer, config) == Status::ok);
  CHECK(config.torque.amplitude_nm == 2.0f);
  const std::vector<std::uint8_t> other_version{2, 0}, too_short{1}, too_long{1, 0, 0},
      torn{1, 1, 2, 0, 0, 0, 0}, out_of_bounds{1, 1, 2, 0, 0, 0, 0x7a, 0x44},
      nan{1, 1, 2, 0, 0, 0, 0xc0, 0x7f};
  for (const auto& image : {other_version, too_short, too_long, torn, out_of_bounds, nan}) {
    CHECK(bus::from_image(image, config) == Status::invalid);
    CHECK(config.torque.amplitude_nm == 2.0f);
  }
  CHECK(bus::from_image({}, config) == Status::invalid);
}
