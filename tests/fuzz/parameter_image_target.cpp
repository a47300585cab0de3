// The saved image of the parameters: what is read makes sense, and is written as it was read.
#include <vector>

#include "furcula/bus/parameter_image.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  control::Config config;
  if (bus::from_image(bytes, config) != Status::ok) {
    for (const bus::Parameter& p : bus::kParameters)
      require(p.get(config) == p.get(control::Config{}), "a refused image changes nothing");
    return false;
  }
  require(control::check(config) == Status::ok, "what was read makes sense");
  control::Config again;
  require(bus::from_image(bus::to_image(config), again) == Status::ok, "what was read is written");
  for (const bus::Parameter& p : bus::kParameters)
    require(p.get(config) == p.get(again), "and reads back the same");
  return true;
}

}  // namespace furcula::fuzz
